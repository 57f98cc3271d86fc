//! Two bodies that are meant to touch are judged by their own size, whatever else the mechanism has far away.

use crate::program::Workspace;

/// Two balls on one crank, `g` apart, and a body without solids far away.
fn balls(gap: &str, far: &str) -> String {
    let ball = "shapes = [{ sphere = { center = [1, 0, 0], radius = 0.5 } }]";
    format!(
        "units = {{ length = \"mm\", angle = \"rad\" }}\nduration = 1\n[inputs]\nphi = \"2*pi*t\"\ng = \"{gap}\"\n\
         [[bodies]]\nname = \"A\"\nframe = \"Rz(phi)\"\n{ball}\n\
         [[bodies]]\nname = \"B\"\nframe = \"Rz(phi) Tx(1) Tx(g)\"\n{ball}\n\
         [[bodies]]\nname = \"C\"\nframe = \"Tx({far}) Rz(phi)\"\n\
         [clearance]\nminimum = 0\ntouching = [{{ pair = [\"A\", \"B\"] }}]\n"
    )
}

#[test]
fn bodies_in_contact_are_judged_by_their_own_size() {
    let folder = Workspace::new();
    for far in ["1", "1000", "1000000", "1000000000"] {
        for (gap, touches) in [
            ("0*t", true),
            ("0.4*sin(20*pi*t)^2", false),
            ("0.005*sin(20*pi*t)^2", false),
            ("0.001", false),
        ] {
            folder.write("balls.toml", balls(gap, far));
            let run = folder.run(&["check", "balls.toml"]);
            let said = format!("{gap}, {far} away: {} {}", run.code, run.text());
            assert_eq!(run.code, i32::from(!touches), "{said}");
        }
    }
}
