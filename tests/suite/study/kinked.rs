//! Objectives with kinks: minimax searches go on along them, and sensitivities say what does not move a measure.

use crate::program::Workspace;
use serde_json::Value;

/// A point whose coordinates A and B are the variables.
fn plane(start: [f64; 2], formula: &str) -> String {
    let [a, b] = start;
    format!(
        "units = {{ length = \"mm\", angle = \"deg\" }}\nduration = 1\n[parameters]\na = {a:?}\nb = {b:?}\n\
         [inputs]\nphi = \"360*t\"\n[[bodies]]\nname = \"crank\"\nframe = \"Rz(phi) Tx(a+10) Ty(b+10)\"\n\
         [[traces]]\nname = \"P\"\nbody = \"crank\"\n[measures]\nx0 = {{ of = \"P.x\", take = \"first\" }}\n\
         y0 = {{ of = \"P.y\", take = \"first\" }}\nA = \"x0-10\"\nB = \"y0-10\"\nD = \"abs(A-B)\"\n{formula}\n\
         [study]\nminimise = \"F\"\n[study.variables]\na = {{ range = [-5, 5] }}\nb = {{ range = [-5, 5] }}\n"
    )
}

/// Kinks of a formula, of a formula in it, of the quantity of a pose, and more of them than are taken apart.
#[test]
fn minimax_searches_follow_kinks_to_the_optimum() {
    let w = Workspace::new();
    let many = "F = \"abs(A-B) + 0.1*(abs(A-1)+abs(A-2)+abs(A-3)+abs(B-1)+abs(B-2)+abs(B-3))\"";
    let cases = [
        ([4.0, 4.0], "F = \"abs(A-B) + 0.1*abs(A+B-1)\"", 0.0),
        ([4.0, 1.0], "F = \"D + 0.1*abs(A+B-1)\"", 0.0),
        ([4.0, 4.0], "F = \"max(abs(A-B), abs(A-1), abs(B-1))\"", 0.0),
        (
            [4.0, 4.0],
            "F = { of = \"abs(P.x-P.y) + 0.1*abs(P.x+P.y-21)\", take = \"first\" }",
            0.0,
        ),
        ([-4.0, -3.0], "F = \"-min(B-A, A-B) - min(A, 2)\"", -2.0),
        ([4.0, 4.0], many, 0.4),
    ];
    for (start, formula, least) in cases {
        w.write("plane.toml", plane(start, formula));
        for verb in [
            &["optimise", "plane.toml", "--method", "minimax"][..],
            &["synthesise", "plane.toml", "--starts", "1"],
        ] {
            let run = w.run(&[verb, &["--json", "r.json"]].concat()).exits(0);
            let text = run.text();
            // `F: … to VALUE (…)` or `least F VALUE: …`
            let line = text.lines().find_map(|line| {
                let line = line.trim();
                line.strip_prefix("least F ")
                    .or_else(|| line.strip_prefix("F: ")?.split(" to ").nth(1))
            });
            let value = line.and_then(|rest| rest.split([' ', ':']).next()?.parse::<f64>().ok());
            let value = value.unwrap_or_else(|| panic!("{text}"));
            assert!((value - least).abs() < 1e-4, "{formula}: {text}");
        }
    }
}

/// The pressure angle of a four-bar linkage, as the greater of two deviations from a right angle.
#[test]
fn the_best_transmission_angle_is_found() {
    let w = Workspace::new();
    let text = "units = { length = \"mm\", angle = \"deg\" }\nduration = 4\n[parameters]\ncrank = 35\ncoupler = 95\nrocker = 80\n\
                ground = 105\n[inputs]\nphi = \"360*t/4\"\n[loops]\n\
                A = \"Rz(phi) Tx(crank) Rz(alpha) Tx(coupler) Rz(mu) inv(Tx(ground) Rz(psi) Tx(rocker))\"\n\
                [guess]\nalpha = 60\npsi = 90\nmu = 70\n[measures]\nmumin = { of = \"mu\", take = \"min\" }\n\
                mumax = { of = \"mu\", take = \"max\" }\nswing = { of = \"psi\", take = \"range\" }\n\
                H = \"max(abs(mumin-pi/2),abs(mumax-pi/2))\"\n[study]\nminimise = \"H\"\n[study.variables]\n\
                crank = { range = [5, 100] }\ncoupler = { range = [70, 130] }\nrocker = { range = [60, 110] }\n\
                [study.limits]\nswing = { min = 50 }\nmumin = { min = 40 }\n";
    w.write("four-bar.toml", text);
    let arguments = [
        "optimise",
        "four-bar.toml",
        "--method",
        "minimax",
        "--json",
        "-",
    ];
    let report: Value = serde_json::from_slice(&w.run(&arguments).exits(0).stdout).unwrap();
    let found = report["to"].as_f64().unwrap();
    assert!(found < 29.62, "{found}");
}

/// Tolerances are proposed for dimensions that move a measure; of the others it is said that they do not.
#[test]
fn tolerances_are_those_of_dimensions_with_an_influence() {
    let w = Workspace::new();
    w.write(
        "plane.toml",
        plane([4.0, 1.0], "F = \"A\"\nstep = \"floor(A/7)\""),
    );
    let rows = [
        (
            "F",
            "except those that do not change it to first order: b.\n",
            [true, false],
        ),
        (
            "D",
            "every dimension adds as much to a scatter of 1.00000 of D.\n",
            [true, true],
        ),
        (
            "step",
            "To first order no dimension changes step",
            [false, false],
        ),
    ];
    for (measure, said, is_given) in rows {
        let scatter = format!("{measure}=1");
        let arguments = [
            "sensitivity",
            "plane.toml",
            "--scatter",
            &scatter,
            "--out",
            "s.json",
        ];
        let text = w.run(&arguments).exits(0).text();
        assert!(
            text.contains(said) && !text.contains("inf"),
            "{measure}: {text}"
        );
        assert_eq!(text.contains("adds as much"), is_given[0], "{text}");
        let report: Value = serde_json::from_slice(&w.read("s.json")).unwrap();
        for (name, is_given) in ["a", "b"].into_iter().zip(is_given) {
            let rows = report["dimensions"].as_array().unwrap();
            let row = rows.iter().find(|row| row["dimension"] == name).unwrap();
            assert_eq!(row["tolerance"].is_number(), is_given, "{measure} {row}");
        }
    }
}

/// At A = 0 the roots of squares have kinks, not slopes of zero: no derivative is told, and no search calls the greatest value the
/// least. Beside them, what is constant for a while has a derivative, whatever is made of it.
#[test]
fn roots_of_what_is_zero_have_no_derivative() {
    let w = Workspace::new();
    let rows = [
        ("10 - sqrt(A*A)", false),
        ("10 - sqrt(A^2)", false),
        ("10 - (A^4)^0.25", false),
        ("10 - hypot(A, 0)", false),
        ("10 - sqrt(2*A*A)", false),
        ("10 - sqrt(max(A, 0)*A)", false),
        ("10 - A - sqrt(max(A-1, 0))", true),
        ("10 - A - sqrt(floor(A/7+0.5))", true),
        ("10 - A - sqrt(0*A)", true),
    ];
    for (formula, has_derivative) in rows {
        w.write("p.toml", plane([0.0, 1.0], &format!("F = \"{formula}\"")));
        let asked = ["sensitivity", "p.toml", "--vary", "a", "--out", "s.json"];
        let text = w.run(&asked).exits(0).text();
        let report: Value = serde_json::from_slice(&w.read("s.json")).unwrap();
        let slope = report["dimensions"][0]["derivatives"]["F"].as_f64();
        let said = format!("{formula}: {text} {report:#}");
        assert_eq!(slope.is_some(), has_derivative, "{said}");
        assert!(
            slope.is_none_or(|slope| (slope + 1.0).abs() < 1e-9),
            "{said}"
        );
        for method in ["bfgs", "minimax"] {
            let asked = ["optimise", "p.toml", "--method", method, "--json", "-"];
            let report: Value = serde_json::from_slice(&w.run(&asked).stdout).unwrap();
            let found = report["to"].as_f64().unwrap();
            let is_least = found < 6.0;
            assert!(
                is_least || report["ended"] != "converged",
                "{formula} {method}: {report:#}"
            );
        }
    }
}
