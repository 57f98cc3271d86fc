//! What is estimated passes only where estimates are enough, and what is below its minimum then neither; drives that jump
//! where a motion begins, or together, need no estimates.

use crate::program::Workspace;
use serde_json::Value;

/// A ball that turns by a drive beside a post, 3 above its circle unless the post is elsewhere.
fn turning(drive: &str, post: &str, minimum: f64) -> String {
    format!(
        r#"
duration = 2
[inputs]
u = "{drive}"
[[bodies]]
name = "ball"
frame = "Rz(u)"
shapes = [{{ sphere = {{ center = [1, 0, 0], radius = 0.1 }} }}]
[[bodies]]
name = "post"
shapes = [{{ sphere = {{ center = {post}, radius = 0.1 }} }}]
[clearance]
minimum = {minimum}
pairs = [{{ pair = ["ball", "post"], minimum = {minimum} }}]
"#
    )
}

/// Exit code, result and verdict of the pair.
fn said(w: &Workspace, options: &[&str]) -> (i32, String, String) {
    let fixed = ["check", "scene.toml", "--json", "r.json"];
    let code = w.run(&[&fixed, options].concat()).code;
    let json: Value = serde_json::from_slice(&w.read("r.json")).expect("JSON");
    let word = |value: &Value| value.as_str().expect("a word").to_owned();
    let pair = &json["clearance"]["pairs"][0];
    (code, word(&json["result"]), word(&pair["verdict"]))
}

#[test]
fn estimates_pass_where_they_are_enough_and_nowhere_else() {
    let w = Workspace::new();
    // Its speed has no bound at 1 s, so that nothing is proved there.
    for (drive, minimum, without, with) in [
        (
            "sqrt(abs(t - 1))",
            0.1,
            (1, "not proved", "estimated"),
            (0, "passed", "estimated"),
        ),
        (
            "sqrt(abs(t - 1))",
            2.97,
            (1, "failed", "failed"),
            (1, "failed", "failed"),
        ),
        (
            "0.5*sin(t)",
            0.1,
            (0, "passed", "passed"),
            (0, "passed", "passed"),
        ),
        (
            "0.5*sin(t)",
            2.97,
            (1, "failed", "failed"),
            (1, "failed", "failed"),
        ),
    ] {
        w.write("scene.toml", turning(drive, "[0, 0, 3]", minimum));
        for (options, expected) in [(&[][..], without), (&["--allow-estimates"], with)] {
            let (code, result, verdict) = said(&w, options);
            let found = (code, result.as_str(), verdict.as_str());
            assert_eq!(found, expected, "{drive}, {minimum}, {options:?}");
        }
    }
}

#[test]
fn jumps_where_a_motion_begins_and_jumps_together_are_proved() {
    let w = Workspace::new();
    for (drive, u_at) in [
        // From the value of the first instant at once to another one.
        ("floor(1 - 1.6*t)", [1.0, 0.0, -1.0, -2.0, -3.0].as_slice()),
        ("-floor(-t/2)", &[0.0, 1.0]),
        ("-floor(-3*t)", &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
        ("1 - mod(-2*t, 1.5)", &[1.0, -0.5]),
        // What jumps in two places at once.
        (
            "floor(3*t) + 0.1*floor(3*t)",
            &[0.0, 1.1, 2.2, 3.3, 4.4, 5.5],
        ),
    ] {
        for samples in ["2", "7", "40"] {
            w.write("scene.toml", turning(drive, "[0, 0, 3]", 0.1));
            let found = said(&w, &["--samples", samples]);
            assert_eq!(
                found,
                (0, "passed".into(), "passed".into()),
                "{drive}, {samples}"
            );
            // A post where the ball is before and after a jump: that of one instant counts as well.
            for u in u_at {
                let post = format!("[{}, {}, 0]", f64::cos(*u), f64::sin(*u));
                w.write("scene.toml", turning(drive, &post, 0.1));
                let (code, result, _) = said(&w, &["--samples", samples]);
                assert_eq!(
                    (code, result.as_str()),
                    (1, "failed"),
                    "{drive}, {samples}, {u}"
                );
            }
        }
    }
}

/// What kinks or jumps of what kinks or jumps, at any number of samples.
#[test]
fn jumps_of_jumps_and_of_kinks_are_proved() {
    let w = Workspace::new();
    for (drive, u_at) in [
        ("mod(floor(8.1603*t), 2)", [0.0, 1.0].as_slice()),
        ("floor(floor(3*t)/2)", &[0.0, 1.0, 2.0, 3.0]),
        ("3 - mod(floor(3*t), 3)", &[1.0, 2.0, 3.0]),
        // An argument that turns back on a whole number, or rests there.
        ("floor(10*abs(t - 1))/2", &[0.0, 2.5, 4.5, 5.0]),
        ("floor(max(0, 3*t - 2))", &[0.0, 1.0, 3.0, 4.0]),
        ("floor(min(2, 3*t))", &[0.0, 1.0, 2.0]),
        ("-floor(max(-2, -3*t))", &[0.0, 1.0, 2.0]),
        ("mod(abs(t - 1.2), 0.3)", &[0.0, 0.15, 0.29999]),
        // At one instant, by different functions.
        ("mod(t, 0.3) + mod(t, 0.4)", &[0.0, 0.5, 0.69999]),
        ("(floor(3*t) - floor(6*t))/4", &[0.0, -0.25, -1.25, -1.5]),
        ("floor(2*t)*mod(2*t, 1)/2", &[0.0, 0.49999, 1.0, 1.49999]),
        // Short beside the way from sample to sample.
        ("exp(-(1000*(t - 1.0112))^2)", &[0.0, 0.5, 1.0]),
    ] {
        for samples in ["2", "3", "7", "40"] {
            w.write("scene.toml", turning(drive, "[0, 0, 3]", 0.1));
            let found = said(&w, &["--samples", samples]);
            let passed = (0, "passed".into(), "passed".into());
            assert_eq!(found, passed, "{drive}, {samples}");
            for u in u_at {
                let post = format!("[{}, {}, 0]", f64::cos(*u), f64::sin(*u));
                w.write("scene.toml", turning(drive, &post, 0.1));
                let (code, result, _) = said(&w, &["--samples", samples]);
                assert_eq!((code, &*result), (1, "failed"), "{drive}, {samples}, {u}");
            }
        }
    }
}

/// A four-bar whose crank goes there and back within some milliseconds.
#[test]
fn a_pulse_of_a_loop_is_proved_at_any_samples() {
    let w = Workspace::new();
    // The post is ahead of the crank's end where that turns back, so far from it.
    let scene = |ahead: f64| {
        let angle: f64 = 2.2 + 2.0 * f64::asin(ahead / 1.2);
        format!(
            r#"
duration = 2
[inputs]
phi = "1.2 + exp(-(300*(t - 1.2607))^2)"
[loops]
l = "Rz(phi) Tx(0.6) Rz(al - phi) Tx(2) inv(Tx(1.8) Rz(psi) Tx(1.6) Rz(al - psi))"
[guess]
al = 0.5
psi = 1.5
[[bodies]]
name = "coupler"
frame = "Rz(phi) Tx(0.6) Rz(al - phi)"
shapes = [{{ sphere = {{ radius = 0.1 }} }}]
[[bodies]]
name = "post"
shapes = [{{ sphere = {{ center = [{}, {}, 0], radius = 0.1 }} }}]
[clearance]
minimum = 0.1
"#,
            0.6 * angle.cos(),
            0.6 * angle.sin()
        )
    };
    for samples in ["2", "3", "40"] {
        w.write("scene.toml", scene(0.31));
        let passed = (0, "passed".into(), "passed".into());
        assert_eq!(said(&w, &["--samples", samples]), passed, "{samples}");
        w.write("scene.toml", scene(0.29));
        assert_eq!(said(&w, &["--samples", samples]).0, 1, "{samples}");
    }
}

#[test]
fn two_drives_that_jump_together_are_proved() {
    let w = Workspace::new();
    let scene = |v: &str, post: &str| {
        turning("0.5*floor(t + 0.5)", post, 0.1)
            .replace(
                "[[bodies]]\nname = \"ball\"",
                &format!("v = \"{v}\"\n[[bodies]]\nname = \"ball\""),
            )
            .replace("\"Rz(u)\"", "\"Rz(u) Tx(v)\"")
    };
    w.write("scene.toml", scene("2*floor(t + 0.5)", "[0, 0, 3]"));
    assert_eq!(said(&w, &[]).0, 0);
    // Where the ball would be if one of the drives jumped before the other: it never is there.
    for (u, v) in [(0.5_f64, 0.0), (0.0, 2.0)] {
        let post = format!("[{}, {}, 0]", (1.0 + v) * u.cos(), (1.0 + v) * u.sin());
        w.write("scene.toml", scene("2*floor(t + 0.5)", &post));
        assert_eq!(said(&w, &[]).0, 0, "{u} {v}");
    }
    // By another function, but at the same instant.
    for same in ["2*floor(3*t - 0.5)", "2*floor(t/0.5) - floor(2*t)"] {
        w.write("scene.toml", scene(same, "[0, 0, 3]"));
        assert_eq!(said(&w, &[]).0, 0, "{same}");
    }
    // Of jumps about that time, but not at it, it is not known which comes first.
    for other in ["2*floor(t + 0.5 + 1e-14)", "2*floor(t + 0.5 - 1e-14)"] {
        w.write("scene.toml", scene(other, "[0, 0, 3]"));
        assert_eq!(said(&w, &[]).0, 1, "{other}");
    }
}

/// A saw comes as near as may be before it jumps back, and never all the way.
#[test]
fn what_is_only_approached_before_a_jump_counts() {
    let w = Workspace::new();
    for (drive, falls) in [
        ("-mod(3.5999*t, 0.2876)", 0.2876),
        ("mod(-3.5999*t, 0.2876) - 0.2876", 0.2876),
        ("-0.3*t + 0.6*floor(0.9*t)", 1.0 / 3.0),
    ] {
        for (off, expected) in [(1e-6, (1, "failed")), (-1e-6, (0, "passed"))] {
            let scene = turning(drive, "[1, 0, -3]", 2.8 - falls + off).replace("Rz(u)", "Tz(u)");
            for samples in ["3", "40"] {
                w.write("scene.toml", &scene);
                let (code, result, _) = said(&w, &["--samples", samples]);
                assert_eq!(
                    (code, result.as_str()),
                    expected,
                    "{drive}, {off}, {samples}"
                );
            }
        }
    }
}

/// A cube of triangles as STL text.
fn cube() -> String {
    let corner = |k: usize| [1, 2, 4].map(|bit| if k & bit == 0 { -10.0 } else { 10.0 });
    let sides = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let triangles = sides
        .into_iter()
        .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let facet = |triangle: [usize; 3]| {
        let vertices = triangle
            .map(corner)
            .map(|[x, y, z]| format!("vertex {x} {y} {z}\n"));
        format!(
            "facet normal 0 0 0\nouter loop\n{}endloop\nendfacet\n",
            vertices.concat()
        )
    };
    format!(
        "solid cube\n{}endsolid cube\n",
        triangles.map(facet).collect::<String>()
    )
}

/// With a minimum of nothing a mesh that is cut fails: not only is it open whether it passes.
#[test]
fn a_mesh_that_is_cut_fails_where_only_an_overlap_is_forbidden() {
    let w = Workspace::new();
    w.write("cube.stl", cube());
    for (shape, height, expected) in [
        ("sphere = { radius = 1 }", "10.5 + 0.2*t", (1, "failed")),
        (
            "sphere = { radius = 1 }",
            "12 - 3*sin(1.5*t)",
            (1, "failed"),
        ),
        ("box = { size = [30, 2, 1] }", "9 + t", (1, "failed")),
        (
            "stl = { file = \"cube.stl\" }",
            "19.5 + 0.1*t",
            (1, "failed"),
        ),
        ("sphere = { radius = 1 }", "11.001 + t", (0, "passed")),
        ("stl = { file = \"cube.stl\" }", "20.01 + t", (0, "passed")),
    ] {
        let scene = turning("0", "[0, 0, 0]", 0.0)
            .replace("u = \"0\"", &format!("u = \"{height}\""))
            .replace("Rz(u)", "Tx(0.3) Ty(0.2) Tz(u)")
            .replacen("sphere = { center = [1, 0, 0], radius = 0.1 }", shape, 1)
            .replace(
                "sphere = { center = [0, 0, 0], radius = 0.1 }",
                "stl = { file = \"cube.stl\" }",
            );
        w.write("scene.toml", scene);
        let (code, result, _) = said(&w, &[]);
        assert_eq!((code, result.as_str()), expected, "{shape} at {height}");
    }
}

/// An estimated bound is one; a value without any bound passes only where nothing is to be proved.
#[test]
fn measures_without_a_bound_do_not_pass_as_estimates() {
    let w = Workspace::new();
    let measured = "[outputs]\ngap = { distance = [\"ball\", \"post\"] }\n[measures]\nm = { of = \"gap\", take = \"max\", max = 50 }\n";
    let scene = turning("0.5*sin(t)", "[0, 0, 3]", 0.1);
    w.write("scene.toml", scene.clone() + measured);
    for (options, code) in [
        (&[][..], 1),
        (&["--allow-estimates"], 1),
        (&["--certify", "none"], 0),
    ] {
        let line = [&["check", "scene.toml"][..], options].concat();
        let run = w.run(&line).exits(code);
        assert!(run.text().contains("no bound"), "{options:?}");
    }
}
