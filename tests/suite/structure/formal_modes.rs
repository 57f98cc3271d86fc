//! Assemblies of equations whose roots are known: no more of them than there are, no fewer, and no claim about what was not
//! searched.

use crate::program::Workspace;
use serde_json::Value;

/// An equation in x at u = 0, and all its roots.
struct Row {
    equation: &'static str,
    roots: fn() -> Vec<f64>,
    /// How far a root may be off, relative to the largest; rounding hides the place of a root of higher order.
    near: f64,
}

fn none() -> Vec<f64> {
    Vec::new()
}

/// Bisection of x = a sin(x) from one quarter turn to the next: the roots are the zeros of a function that this file evaluates.
fn wave_roots(a: f64) -> Vec<f64> {
    let value = |x: f64| x - a * x.sin();
    let quarter = std::f64::consts::FRAC_PI_2;
    let mut roots = vec![0.0];
    let mut at = 1e-3;
    while at < a + quarter {
        let (mut low, mut high) = (at, at + 0.01);
        if value(low) * value(high) < 0.0 {
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                match value(low) * value(middle) <= 0.0 {
                    true => high = middle,
                    false => low = middle,
                }
            }
            roots.extend([low, -low]);
        }
        at += 0.01;
    }
    roots
}

const ROWS: [Row; 22] = [
    Row {
        equation: "exp(x) + u",
        roots: none,
        near: 0.0,
    },
    Row {
        equation: "exp(-x^2) + u",
        roots: none,
        near: 0.0,
    },
    Row {
        equation: "1/(1 + x^2) + u",
        roots: none,
        near: 0.0,
    },
    Row {
        equation: "x^-3*exp(-x) + u",
        roots: none,
        near: 0.0,
    },
    Row {
        equation: "x*exp(-x) + u",
        roots: || vec![0.0],
        near: 1e-9,
    },
    Row {
        equation: "(x - 3)*exp(-x) + u",
        roots: || vec![3.0],
        near: 1e-9,
    },
    Row {
        equation: "exp(x) - 2 + u",
        roots: || vec![std::f64::consts::LN_2],
        near: 1e-9,
    },
    Row {
        equation: "x^4 + u",
        roots: || vec![0.0],
        near: 1e-9,
    },
    Row {
        equation: "(x - 1)^3 + u",
        roots: || vec![1.0],
        near: 1e-9,
    },
    Row {
        equation: "x^4 - 4*x^3 + 6*x^2 - 4*x + 1 + u",
        roots: || vec![1.0],
        near: 2e-3,
    },
    Row {
        equation: "x^4 - 1e-12*x^2 + 0*u",
        roots: || vec![-1e-6, 0.0, 1e-6],
        near: 1e-6,
    },
    Row {
        equation: "x - 20*sin(x) + u",
        roots: || wave_roots(20.0),
        near: 1e-9,
    },
    Row {
        equation: "(x - 1e-6)*(x - 1)*(x - 1e6) + 0*u",
        roots: || vec![1e-6, 1.0, 1e6],
        near: 1e-9,
    },
    Row {
        equation: "(x - 1e-3)*(x - 2e-3)*(x - 1e5) + 0*u",
        roots: || vec![1e-3, 2e-3, 1e5],
        near: 1e-9,
    },
    Row {
        equation: "(x + 1e6)*(x - 1e-4)*(x - 3e-4) + 0*u",
        roots: || vec![-1e6, 1e-4, 3e-4],
        near: 1e-9,
    },
    Row {
        equation: "(x - 1e6)*(x - 3e-6) + 0*u",
        roots: || vec![3e-6, 1e6],
        near: 1e-9,
    },
    Row {
        equation: "(x - 1e6/3)*(x - 2e-6/3) + 0*u",
        roots: || vec![2e-6 / 3.0, 1e6 / 3.0],
        near: 1e-9,
    },
    Row {
        equation: "(x - 1e7/3)^2*(x - 2/3) + 0*u",
        roots: || vec![2.0 / 3.0, 1e7 / 3.0],
        near: 1e-6,
    },
    Row {
        equation: "x^4 - 1e-8*x^2 + u",
        roots: || vec![-1e-4, 0.0, 1e-4],
        near: 1e-6,
    },
    // Two that lie close together, and one that is small beside where its sister is.
    Row {
        equation: "(x - 1)*(x - 1.0000001) + 0*u",
        roots: || vec![1.0, 1.0000001],
        near: 1e-9,
    },
    Row {
        equation: "x/(1 + x^2) - 1e-6 + 0*u",
        roots: || {
            let far = 0.5e6 * (1.0 + (1.0 - 4e-12_f64).sqrt());
            vec![1.0 / far, far]
        },
        near: 1e-9,
    },
    Row {
        equation: "x^2 - 2 + u",
        roots: || vec![-(2f64.sqrt()), 2f64.sqrt()],
        near: 1e-9,
    },
];

fn scene(equation: &str) -> String {
    format!(
        "units = {{ length = \"mm\" }}\nduration = 1\n[inputs]\nu = \"t\"\n[equations]\nA = \"{equation}\"\n"
    )
}

#[test]
fn equations_have_the_roots_that_they_have() {
    let folder = Workspace::new();
    let mut wrong = Vec::new();
    for Row {
        equation,
        roots,
        near,
    } in &ROWS
    {
        let mut known = roots();
        known.sort_by(f64::total_cmp);
        folder.write("modes.toml", scene(equation));
        let run = folder.run(&["modes", "modes.toml", "--json", "m.json"]);
        let report: Value = serde_json::from_slice(&folder.read("m.json")).unwrap();
        let list = report["modes"].as_array().unwrap();
        let mut found: Vec<f64> = list
            .iter()
            .map(|mode| mode["unknowns"]["x"].as_f64().unwrap())
            .collect();
        found.sort_by(f64::total_cmp);
        let is_near = |(a, b): (&f64, &f64)| {
            (a - b).abs() <= near * b.abs().max(if *b == 0.0 { 1.0 } else { 0.0 })
        };
        let sets = report["curves"].as_u64().unwrap() + report["larger_sets"].as_u64().unwrap();
        if found.len() != known.len() || !found.iter().zip(&known).all(is_near) || sets > 0 {
            wrong.push(format!("{equation}: {found:?} for {known:?}, {sets} sets"));
        }
        let farthest = known
            .iter()
            .fold(0.0_f64, |most, root| most.max(root.abs()));
        let reach = report["searched_up_to"]["x"].as_f64();
        assert!(reach >= Some(farthest), "{report:#}");
        // What was searched is said wherever an estimate is given.
        let text = run.text();
        assert!(
            !text.contains("Good-Turing") || text.contains("Random starts took"),
            "{text}"
        );
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Roots that are certified are regular, however small their slopes are beside the start values' scale; roots of higher order are not.
#[test]
fn only_roots_of_higher_order_are_called_singular() {
    let folder = Workspace::new();
    for (equation, singular) in [
        ("(x - 1)*(x - 1.0000001) + 0*u", 0),
        ("x/(1 + x^2) - 1e-6 + 0*u", 0),
        ("(x - 3)*exp(-x) + u", 0),
        ("(x - 1)^2*(x + 4) + 0*u", 1),
        ("(x - 1)^3 + u", 1),
    ] {
        folder.write("modes.toml", scene(equation));
        let run = folder.run(&["modes", "modes.toml", "--json", "m.json"]);
        let report: Value = serde_json::from_slice(&folder.read("m.json")).unwrap();
        let list = report["modes"].as_array().unwrap();
        let found = list.iter().filter(|mode| mode["singular"] == true).count();
        assert_eq!(found, singular, "{equation}: {report:#}");
        assert_eq!(
            run.text().contains("assemblies meet"),
            singular > 0,
            "{equation}"
        );
    }
}

/// An infinite slope at the start, or a formula that is flat there, is no lack of equations.
#[test]
fn equations_are_not_refused_for_the_slopes_at_their_start() {
    let folder = Workspace::new();
    for (equation, guess, words) in [
        ("sqrt(x - 1)*(x - 5) + 0*u", "2", None),
        ("sqrt(x) - x + 0*u", "0", None),
        ("sqrt(x) + 0*u", "1", None),
        (
            "exp(-(x - 50)^2) - 0.5 + 0*u",
            "20",
            Some("start nearer to its solution"),
        ),
    ] {
        folder.write(
            "start.toml",
            scene(equation) + &format!("[guess]\nx = {guess}\n"),
        );
        let run = folder.run(&["check", "start.toml"]);
        assert!(
            !run.stderr.contains("free than the inputs"),
            "{equation}: {}",
            run.stderr
        );
        assert_eq!(
            words.is_some(),
            run.stderr.contains("no equation determines"),
            "{equation}"
        );
        assert!(
            run.stderr.contains(words.unwrap_or_default()),
            "{equation}: {}",
            run.stderr
        );
    }
}

/// There are tens of thousands: more than are listed, and it is said.
#[test]
fn very_many_roots_are_called_so() {
    let folder = Workspace::new();
    folder.write("modes.toml", scene("x - 1e5*sin(x) + u"));
    let text = folder.run(&["modes", "modes.toml"]).text();
    assert!(
        text.contains("more --starts may find more")
            || text.contains("There are far more placements"),
        "{text:.2000}"
    );
}

/// A motion does not start, and none is reported, where the terms of an equation only become small.
#[test]
fn small_terms_are_no_pose() {
    let folder = Workspace::new();
    for equation in ["exp(x) + u", "exp(-x^2) + u", "exp(-x)/(1 + x^2) + u"] {
        let still = scene(equation).replace("\"t\"", "\"0*t\"");
        for text in [scene(equation), still] {
            folder.write("small.toml", text);
            let run = folder.run(&["check", "small.toml"]);
            assert_ne!(run.code, 0, "{equation}\n{}", run.text());
            assert!(
                !run.text().contains("samples"),
                "{equation}\n{}",
                run.text()
            );
            assert!(
                !run.stderr.contains("to 0.000000000"),
                "{equation}\n{}",
                run.stderr
            );
        }
    }
}
