//! Searches return what keeps the limits, look at nothing but the objective and the limits, and do not depend on units.

use crate::program::Workspace;
use serde_json::Value;

/// A point whose coordinates are the variables, so that every optimum is known: A and B are their values.
fn plane(start: [f64; 2], measures: &str, limits: &str) -> String {
    let [a, b] = start;
    format!(
        "units = {{ length = \"mm\", angle = \"deg\" }}\nduration = 1\n[parameters]\na = {a:?}\nb = {b:?}\n\
         [inputs]\nphi = \"360*t\"\n[[bodies]]\nname = \"crank\"\nframe = \"Rz(phi) Tx(a+10) Ty(b+10)\"\n\
         [[traces]]\nname = \"P\"\nbody = \"crank\"\n[measures]\nx0 = {{ of = \"P.x\", take = \"first\" }}\n\
         y0 = {{ of = \"P.y\", take = \"first\" }}\nA = \"x0-10\"\nB = \"y0-10\"\n{measures}\n\
         [study]\nminimise = \"F\"\n[study.variables]\na = {{ range = [-5, 5] }}\nb = {{ range = [-5, 5] }}\n\
         [study.limits]\n{limits}\n"
    )
}

const METHODS: [&str; 4] = ["bfgs", "minimax", "nelder-mead", "evolution"];

/// Where a candidate keeps the limits, the start if no other, one that does is returned, however coarse the search is; only where none
/// does it is said that there is none.
#[test]
fn what_keeps_the_limits_is_returned() {
    let w = Workspace::new();
    // A start, the objective and a limit, and the least value nearby.
    let cases = [
        (
            [3.0, 2.0],
            "F = \"A+B\"\nc = \"A*B\"",
            "c = { min = 1 }",
            2.0,
        ),
        (
            [1.0, -1.0],
            "F = \"A+B\"\nc = \"A*A+B*B\"",
            "c = { max = 2 }",
            -2.0,
        ),
        (
            [3.0, 4.0],
            "F = \"(A-1)^2+B*B\"\nc = \"A+B\"",
            "c = { min = 3 }",
            2.0,
        ),
    ];
    for (k, (start, measures, limits, least)) in cases.into_iter().enumerate() {
        w.write("plane.toml", plane(start, measures, limits));
        for method in METHODS {
            let coarse: [&[&str]; 3] = [&[], &["--convergence", "1e-2"], &["--iterations", "3"]];
            for more in coarse {
                let arguments = ["optimise", "plane.toml", "--method", method];
                let run = w.run(&[&arguments[..], more].concat()).exits(0);
                assert!(!run.text().contains("found no candidate"), "{}", run.text());
            }
            let arguments = ["optimise", "plane.toml", "--method", method, "--json", "-"];
            let report: Value = serde_json::from_slice(&w.run(&arguments).exits(0).stdout).unwrap();
            let found = report["to"].as_f64().unwrap();
            // A search of the whole box may find another valley.
            assert!(found < least + 1e-2, "{k} {method}: {found} {least}");
        }
        let run = w.run(&[
            "optimise",
            "plane.toml",
            "--pairs",
            "--vary",
            "a,b",
            "--method",
            "nelder-mead",
        ]);
        assert!(run.exits(0).text().contains("kept"));
    }
    w.write(
        "plane.toml",
        plane([3.0, 2.0], "F = \"A+B\"\nc = \"A*B\"", "c = { min = 30 }"),
    );
    for method in METHODS {
        let text = w
            .run(&["optimise", "plane.toml", "--method", method])
            .exits(1)
            .text();
        assert!(
            text.contains("found no candidate that keeps all constraints"),
            "{method}: {text}"
        );
    }
}

/// A measure without a derivative, or without a value, that is neither minimised nor limited.
#[test]
fn other_measures_do_not_spoil_an_optimum() {
    let w = Workspace::new();
    let crank = |output: &str, other: &str| {
        format!(
            "units = {{ length = \"mm\", angle = \"deg\" }}\nduration = 4\n[parameters]\nr = 40\nc = 40\n[inputs]\nphi = \"90*t\"\n\
             [[bodies]]\nname = \"b\"\nframe = \"Rz(phi) Tx(r)\"\n[[traces]]\nname = \"P\"\nbody = \"b\"\n\
             [outputs]\nout = \"{output}\"\n[measures]\nrx = {{ of = \"out\", take = \"max\" }}\n\
             other = {other}\n[study]\nminimise = \"rx\"\n[study.variables]\nr = {{ range = [30, 50], tolerance = 0.1 }}\n"
        )
    };
    // The output, the other measure, the least value.
    let cases = [
        (
            "sqrt(P.x+r)",
            "{ of = \"out\", take = \"mean\" }",
            60.0_f64.sqrt(),
        ),
        ("hypot(P.x-c,P.y)", "{ of = \"out\", take = \"min\" }", 70.0),
        ("P.x", "{ of = \"sqrt(P.x)\", take = \"mean\" }", 30.0),
    ];
    for (output, other, least) in cases {
        w.write("crank.toml", crank(output, other));
        for method in METHODS {
            let arguments = ["optimise", "crank.toml", "--method", method, "--json", "-"];
            let report: Value = serde_json::from_slice(&w.run(&arguments).exits(0).stdout).unwrap();
            let found = report["to"].as_f64().unwrap();
            assert!(
                (found - least).abs() < 1e-3,
                "{output} {method}: {found} {least}"
            );
        }
    }
    w.write("crank.toml", crank(cases[0].0, cases[0].1));
    let text = w.run(&["sensitivity", "crank.toml"]).exits(0).text();
    assert!(
        text.contains("Without derivatives by all dimensions: other."),
        "{text}"
    );
    // The objective itself, where it has no derivative: it keeps its value.
    let least = crank("sqrt(P.x+r)", "\"rx\"").replace("\"max\"", "\"min\"");
    w.write("least.toml", least);
    for method in ["bfgs", "minimax"] {
        let text = w
            .run(&["optimise", "least.toml", "--method", method])
            .text();
        assert!(!text.contains("inf"), "{method}: {text}");
    }
}

/// The same mechanism in four units takes the same way.
#[test]
fn a_simplex_search_is_the_same_in_all_units() {
    let w = Workspace::new();
    let four_bar = |unit: &str, factor: f64| {
        let [crank, coupler, rocker, ground, ex, ey] =
            [35.0, 95.0, 80.0, 105.0, 50.0, 45.0].map(|length: f64| length * factor);
        let [low, high] = [80.0 * factor, 110.0 * factor];
        format!(
            "units = {{ length = \"{unit}\", angle = \"deg\" }}\nduration = 4\n[parameters]\ncrank = {crank:e}\ncoupler = {coupler:e}\n\
             rocker = {rocker:e}\nground = {ground:e}\nex = {ex:e}\ney = {ey:e}\n[inputs]\nphi = \"360*t/4\"\n[chains]\n\
             T = \"Rz(phi) Tx(crank) Rz(alpha)\"\n[loops]\nA = \"T Tx(coupler) Rz(mu) inv(Tx(ground) Rz(psi) Tx(rocker))\"\n\
             [guess]\nalpha = 60\npsi = 90\nmu = 70\n[[bodies]]\nname = \"c\"\nframe = \"T\"\n[[traces]]\nname = \"K\"\n\
             body = \"c\"\npoint = [\"ex\", \"ey\", 0]\n[tracks]\nhalf = {{ samples = 10, inputs = {{ phi = [10, 100] }} }}\n[measures]\n\
             bow = {{ track = \"half\", of = [\"K.x\", \"K.y\"], take = \"bow\" }}\n\
             chord = {{ track = \"half\", of = [\"K.x\", \"K.y\"], take = \"chord\" }}\n\
             F = \"bow^2 + (chord - {chord:e})^2\"\n[study]\nminimise = \"F\"\n[study.variables]\n\
             coupler = {{ range = [{low:e}, {high:e}] }}\n",
            chord = 30.0 * factor,
        )
    };
    let mut found: Vec<(f64, f64)> = Vec::new();
    for (unit, factor) in [("mm", 1.0), ("m", 1e-3), ("um", 1e3), ("km", 1e-6)] {
        w.write("four-bar.toml", four_bar(unit, factor));
        let arguments = [
            "optimise",
            "four-bar.toml",
            "--method",
            "nelder-mead",
            "--json",
            "-",
        ];
        let report: Value = serde_json::from_slice(&w.run(&arguments).exits(0).stdout).unwrap();
        let evaluations = report["evaluations"].as_f64().unwrap();
        found.push((
            report["to"].as_f64().unwrap() / (factor * factor),
            evaluations,
        ));
    }
    for (value, evaluations) in &found {
        assert!((value / found[0].0 - 1.0).abs() < 1e-4, "{found:?}");
        assert!((evaluations / found[0].1 - 1.0).abs() < 0.1, "{found:?}");
    }
}

/// The greatest abscissa of a point that goes round lies between two poses of the drive, and so does the corner of its limit.
#[test]
fn limits_along_the_drive_are_kept_between_its_poses() {
    let w = Workspace::new();
    for limits in ["c = { max = 17 }", ""] {
        let own = if limits.is_empty() { ", max = 17" } else { "" };
        let measures =
            format!("F = \"-(A+10)*(B+10)\"\nc = {{ of = \"P.x\", take = \"max\"{own} }}");
        w.write("round.toml", plane([0.1, 0.2], &measures, limits));
        let arguments = [
            "synthesise",
            "round.toml",
            "--starts",
            "2",
            "--json",
            "report.json",
        ];
        let text = w.run(&arguments).exits(0).text();
        // A square in a circle of radius 17.
        let found = text
            .lines()
            .find_map(|line| line.trim().strip_prefix("least F "));
        let found = found.and_then(|rest| rest.split(':').next()?.parse::<f64>().ok());
        let found = found.unwrap_or_else(|| panic!("{text}"));
        assert!((-144.5..-144.4).contains(&found), "{text}");
    }
}
