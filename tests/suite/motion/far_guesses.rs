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
            let found = report["measures"][0]["value"].as_f64().unwrap();
            // Even powers have a solution of either sign.
            let known = (row.solution)(0.2);
            let off = (found.abs() - known.abs()).abs();
            assert!(off < 1e-11 * known.abs(), "{label}: {found} for {known}");
            let bound = report["error_bound"].as_f64().unwrap();
            assert!(off <= bound + 1e-15 * known.abs(), "{label}: {off} {bound}");
            assert_eq!(report["between"]["proved"], true, "{label}");
            sigmas.push(report["sigma_min"].as_f64().unwrap());
        }
        // Singular values are relative to magnitudes, which start values within a factor of 64 of a solution determine.
        let [least, largest] = [f64::min as fn(f64, f64) -> f64, f64::max]
            .map(|pick| sigmas.iter().copied().reduce(pick).unwrap());
        assert!(least > 1e-4 * largest, "{}: {sigmas:?}", row.equation);
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

/// Falling terms, roots, cubics with one root, exponential functions: proved from exact starts, near ones and far ones.
#[test]
fn equations_of_every_shape_are_proved_whatever_the_start() {
    let folder = Workspace::new();
    // Drive, equation, solution at the start, starts.
    let rows: [(&str, &str, f64, &[f64]); 7] = [
        (
            "t",
            "1/x - 0.01*(2 + u)",
            50.0,
            &[50.0, 49.0, 45.0, 30.0, 3.0],
        ),
        ("t", "1/x - 2e3*(1 + u)", 5e-4, &[5e-4, 4e-4, 1e-3, 1.0]),
        (
            "200 + 100*t",
            "1/x + 1/u - 1/50",
            200.0 / 3.0,
            &[66.0, 40.0, 200.0 / 3.0],
        ),
        (
            "t",
            "sqrt(x) - 0.001*(2 + u)",
            4e-6,
            &[1e-3, 0.01, 0.1, 1.0],
        ),
        (
            "0.08 + 2*t",
            "x^3 + x/35.5 - u",
            0.409_114_955_928_655_2,
            &[0.4, 5.0, 724.0],
        ),
        (
            "1 + t",
            "exp(x) - 1e8*u",
            18.420680743952367,
            &[18.420680743952367, 18.0, 20.0, 28.0],
        ),
        ("1 + t", "10^x - 1e9*u", 9.0, &[9.0, 8.0, 10.0]),
    ];
    for (drive, equation, solution, starts) in rows {
        for start in starts {
            folder.write(
                "e.toml",
                format!(
                    "duration = 1\n[inputs]\nu = \"{drive}\"\n[equations]\ne = \"{equation}\"\n[guess]\nx = {start:?}\n\
                     [measures]\nfirst = {{ of = \"x\", take = \"first\" }}\n"
                ),
            );
            let run = folder.run(&["check", "e.toml", "--json", "r.json"]);
            assert_eq!(
                run.code,
                0,
                "{equation} from {start}\n{}{}",
                run.text(),
                run.stderr
            );
            let report: Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
            let found = report["measures"][0]["value"].as_f64().unwrap();
            assert!(
                (found / solution - 1.0).abs() < 1e-4,
                "{equation} from {start}: {found}"
            );
            assert_eq!(report["between"]["proved"], true, "{equation} from {start}");
            let bound = report["error_bound"].as_f64().unwrap();
            assert!(
                bound < 1e-12 * solution.max(1.0),
                "{equation} from {start}: {bound}"
            );
        }
    }
}

/// Terms that grow by many orders along the drive say nothing about a pose at its start.
#[test]
fn offered_poses_are_judged_by_the_terms_of_their_own_instant() {
    let folder = Workspace::new();
    /// A pose, and the exit code of its check.
    type Offer = (&'static str, i32);
    let rows: [(&str, &str, &[Offer]); 7] = [
        (
            "e1 = \"y - 10^(4*u)\"\ne2 = \"x*y^3 - y^3 - 1\"",
            "x = 2\ny = 1",
            &[("x=2,y=1", 0), ("x=2.5,y=1", 1), ("x=2.001,y=1", 1)],
        ),
        (
            "e = \"x - 10^(9*u)\"",
            "x = 1",
            &[("x=1", 0), ("x=100", 1), ("x=1.01", 1)],
        ),
        (
            "e = \"x^5 - (1 + 1e10*u)\"",
            "x = 1",
            &[("x=1", 0), ("x=1.1", 1)],
        ),
        (
            "e = \"x - 1000*exp(10*u)\"",
            "x = 1000",
            &[("x=1000", 0), ("x=1000.015", 1)],
        ),
        // Constants are terms as well: what is rounding beside them is none of the pose.
        (
            "e = \"x + 0.1 + 0.2 - 0.3 - u\"",
            "x = 0",
            &[("x=0", 0), ("x=1e-11", 0), ("x=1e-6", 1)],
        ),
        (
            "e = \"100*(cos(x) - 1 + y)\"\nf = \"y - u\"",
            "x = 0.1\ny = 0",
            &[("x=0,y=0", 0), ("x=1e-7,y=0", 0), ("x=1e-3,y=0", 1)],
        ),
        (
            "e = \"(3e4 - x)/(2e2 + u)\"",
            "x = 1e4",
            &[("x=30000", 0), ("x=30000.00000001", 0), ("x=30001", 1)],
        ),
    ];
    for (equations, guess, poses) in rows {
        folder.write(
            "p.toml",
            format!(
                "duration = 1\n[inputs]\nu = \"t\"\n[equations]\n{equations}\n[guess]\n{guess}\n"
            ),
        );
        for (pose, code) in poses {
            let run = folder.run(&["check", "p.toml", "--pose", pose]);
            assert_eq!(run.code, *code, "{equations} {pose}\n{}", run.text());
        }
    }
}
