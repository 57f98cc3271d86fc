//! Start values that are orders of magnitude away: results are those of the equations, whatever the motion starts from.

use crate::program::Workspace;
use serde_json::Value;

/// An equation in v and u, its value, and its solution by hand.
struct Row {
    equation: &'static str,
    value: fn(f64, f64) -> f64,
    solution: fn(f64) -> f64,
}

/// The real root of v³ + v = u, by the formula of Cardano with both parts of one sign.
fn cardano(u: f64) -> f64 {
    let root = (u * u / 4.0 + 1.0 / 27.0).sqrt();
    let large = (u / 2.0 + root).cbrt();
    large - 1.0 / (3.0 * large)
}

const ROWS: [Row; 5] = [
    Row {
        equation: "v^3 + v - u",
        value: |v, u| v * v * v + v - u,
        solution: cardano,
    },
    Row {
        equation: "v^-4 - u",
        value: |v, u| v.powi(-4) - u,
        solution: |u| u.powf(-0.25),
    },
    Row {
        equation: "1/(v^2 + 1e-9) - u",
        value: |v, u| 1.0 / (v * v + 1e-9) - u,
        solution: |u| (1.0 / u - 1e-9).sqrt(),
    },
    Row {
        equation: "v^5 - 1e-3*u",
        value: |v, u| v.powi(5) - 1e-3 * u,
        solution: |u| (1e-3 * u).powf(0.2),
    },
    Row {
        equation: "exp(v) - u",
        value: |v, u| v.exp() - u,
        solution: f64::ln,
    },
];

const GUESSES: [f64; 7] = [1e-5, 1e-3, 0.3, 1.0, 40.0, 1e4, 1e7];

fn scene(row: &Row, guess: f64) -> String {
    format!(
        "duration = 1\n[inputs]\nu = \"0.1 + 0.1*t\"\n[equations]\ne = \"{}\"\n[guess]\nv = {guess:e}\n\
         [measures]\nlast = {{ of = \"v\", take = \"last\" }}\n",
        row.equation
    )
}

#[test]
fn poses_and_ranks_do_not_depend_on_how_far_the_start_is() {
    let folder = Workspace::new();
    for row in &ROWS {
        let mut sigmas: Vec<f64> = Vec::new();
        for guess in GUESSES {
            // An exponential function of so much is beyond all numbers.
            if row.equation.starts_with("exp") && guess > 100.0 {
                continue;
            }
            folder.write("far.toml", scene(row, guess));
            let label = format!("{} from {guess:e}", row.equation);
            let run = folder.run(&["check", "far.toml", "--samples", "2", "--json", "r.json"]);
            assert_eq!(run.code, 0, "{label}\n{}", run.text());
            let report: Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
            let found = report["measures"]["last"]["value"].as_f64().unwrap();
            // Even powers have a solution of either sign.
            let known = (row.solution)(0.2);
            let off = (found.abs() - known.abs()).abs();
            assert!(off < 1e-13 * known.abs(), "{label}: {found} for {known}");
            assert_eq!(report["between"]["proved"], true, "{label}");
            sigmas.push(report["sigma_min"].as_f64().unwrap());
        }
        // Singular values are relative to magnitudes that are known to a power or two of ten.
        let [least, largest] = [f64::min as fn(f64, f64) -> f64, f64::max]
            .map(|pick| sigmas.iter().copied().reduce(pick).unwrap());
        assert!(least > 1e-3 * largest, "{}: {sigmas:?}", row.equation);
    }
}

/// A pose that is offered is judged by the equation near a solution, not by its terms at the start.
#[test]
fn wrong_poses_are_open_whatever_the_start() {
    let folder = Workspace::new();
    for row in &ROWS {
        for guess in GUESSES {
            if row.equation.starts_with("exp") && guess > 100.0 {
                continue;
            }
            folder.write("far.toml", scene(row, guess));
            let known = (row.solution)(0.2);
            for (offered, code) in [
                (known, 0),
                (known * 1.001, 1),
                (known * 3.0, 1),
                (known * 40.0, 1),
            ] {
                let value = (row.value)(offered, 0.2);
                let pose = format!("v={offered:?}");
                let run = folder.run(&["check", "far.toml", "--input", "u=0.2", "--pose", &pose]);
                assert_eq!(
                    run.code,
                    code,
                    "{} = {value:e} at {offered} from {guess:e}\n{}",
                    row.equation,
                    run.text()
                );
            }
        }
    }
}
