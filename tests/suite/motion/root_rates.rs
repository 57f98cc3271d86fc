//! Rates where a root or a length is zero, against series by hand.

use crate::driven::{add_derivatives, solve};
use crate::reference::scenes::written;
use mechanim::kinematics::rates::columns::{RateColumns, RateVariable};
use mechanim::{CheckOptions, Samples, Scene};

/// Roots and lengths have a kink at their zeros: the rates there are those just after, of any order.
#[test]
fn rates_at_zeros_of_roots_are_those_just_after() {
    // The formula, and the same just after its zero at t = 0.
    type After = fn(f64) -> [f64; 3];
    let cases: [(&str, After); 9] = [
        ("hypot(X, Y)", |_| [5.0, 0.0, 0.0]),
        ("sqrt(X^2 + Y^2)", |_| [5.0, 0.0, 0.0]),
        ("sqrt(X^2)", |_| [3.0, 0.0, 0.0]),
        ("hypot(X, 0)", |_| [3.0, 0.0, 0.0]),
        ("abs(X)", |_| [3.0, 0.0, 0.0]),
        ("hypot(X^2, Y^2)", |_| {
            [0.0, 2.0 * f64::hypot(9.0, 16.0), 0.0]
        }),
        ("sqrt(X^2 + X^3)", |_| [3.0, 9.0, 3.0 * -6.75]),
        ("hypot(M.x, M.y)", |_| [5.0, 0.0, 0.0]),
        ("sqrt(X^4)*X", |_| [0.0, 0.0, 27.0 * 6.0]),
    ];
    for (formula, after) in cases {
        let of = |x: &str, y: &str| formula.replace('X', x).replace('Y', y);
        let is_of_point = formula.contains('M');
        let driven = if is_of_point {
            "t".to_owned()
        } else {
            of("(3*t)", "(4*t)")
        };
        let formula = of("x", "y");
        let scene = written(&format!(
            "duration = 1\n[inputs]\nx = \"3*t\"\ny = \"4*t\"\ndriven = \"{driven}\"\n[[bodies]]\nname = \"b\"\nframe = \"Tx(x) Ty(y)\"\n\
             [[traces]]\nname = \"M\"\nbody = \"b\"\n[outputs]\nr = \"{formula}\"\nv = \"d(r, t)\"\nw = \"d({formula}, t, 2)\"\nu = \"d({formula}, t)\"\n\
             dd = \"d(driven, t)\"\n",
        ));
        let mut trajectory = solve(&scene, &[0.0]).unwrap();
        let pose = trajectory.samples[0].pose.clone().unwrap();
        let [first, second, third] = after(0.0);
        let known = [first, second, first];
        for (found, exact) in pose.outputs[1..4].iter().zip(known) {
            assert!(
                (found - exact).abs() < 1e-12,
                "{formula}: {:?}",
                pose.outputs
            );
        }
        if !is_of_point {
            assert!(
                (pose.outputs[4] - first).abs() < 1e-12,
                "{formula}: {:?}",
                pose.outputs
            );
        }
        // The columns of a table, of three orders at once.
        let columns = RateColumns {
            order: 3,
            by: RateVariable::Time,
        };
        add_derivatives(&scene, &mut trajectory, columns);
        let pose = trajectory.samples[0].pose.as_ref().unwrap();
        let place = columns
            .headings(&scene)
            .iter()
            .position(|(name, _)| name == "d(r)/dt")
            .unwrap();
        for (found, exact) in pose.derivatives[place..place + 3]
            .iter()
            .zip([first, second, third])
        {
            assert!(
                (found - exact).abs() < 1e-11,
                "{formula}: {:?}",
                &pose.derivatives[place..place + 3]
            );
        }
    }
}

/// Roots and powers that begin at zero, or touch it, have their bounds all the same.
#[test]
fn roots_that_begin_at_zero_have_bounds() {
    let mut wrong = Vec::new();
    for (formula, take, most) in [
        ("hypot(x-1.03, sqrt(x))", "min", 0.883_176_086_5),
        ("hypot(x-1.03, sqrt(2-x))", "min", 0.848_528_137_4),
        ("cos(sqrt(x))*sin(5*x)", "max", 0.852_260_299_5),
        ("cos(sqrt(x))", "max", 1.0),
        ("abs(x-1)^0.5", "min", 0.0),
        ("max(0,x-1)^1.5", "min", 0.0),
        ("(1+cos(3*x))^0.5", "max", 2f64.sqrt()),
        ("sqrt(1-cos(x)^2)", "max", 1.0),
        ("x^0.5 + sqrt(2-x)", "max", 2.0),
    ] {
        for samples in [2, 5, 21] {
            let text = format!(
                "duration = 2\n[inputs]\nx = \"t\"\n[equations]\ne = \"y - x\"\n[measures]\nm = {{ of = \"{formula}\", take = \"{take}\", max = 1e9, min = -1e9 }}\n"
            );
            let check = Scene::parse("roots", &text).unwrap().check(&CheckOptions {
                samples: Samples::Even(samples),
                ..CheckOptions::default()
            });
            let check = check.unwrap();
            let report: serde_json::Value = serde_json::from_str(check.to_json()).unwrap();
            let measure = &report["measures"][0];
            let [value, bound] =
                ["value", "bound"].map(|key| measure[key].as_f64().unwrap_or(f64::INFINITY));
            if !check.passed() || (value - most).abs() > 1e-8 || (bound - most).abs() > 1e-6 {
                wrong.push((formula, take, samples, value, bound));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// What has no value keeps its measure without one: no function, and no second argument, makes a number of it.
#[test]
fn what_is_undefined_stays_undefined() {
    let formulas = [
        "1/(1 + abs(ln(u)))",
        "abs(sqrt(u))",
        "exp(-abs(sqrt(u)))",
        "1/(2 + abs(asin(1 - u)))",
        "sin(sqrt(u))",
        "u^0.5",
        "1/(1 + u^1.5)",
        "atan(ln(u))",
        "1/(1 + hypot(ln(u), 1))",
        "max(0, sqrt(u))",
        "min(1, ln(u))",
        "max(sqrt(u), 0)",
        "min(max(ln(u), 0), 1)",
        "cos(acos(1 - u))",
    ];
    for formula in formulas {
        let scene = |drive: &str, measure: &str| {
            format!(
                "duration = 2\n[inputs]\nu = \"{drive}\"\n[equations]\ne = \"y - u\"\n[outputs]\no = \"{formula}\"\n[measures]\n\
                 m = {{ of = \"{formula}\", take = \"{measure}\", max = 1e9, min = -1e9 }}\n"
            )
        };
        // Between two samples, and at one.
        for (drive, samples) in [("(t-1.003)^2-1e-6", 21), ("t-1", 5)] {
            for measure in ["max", "min"] {
                let text = scene(drive, measure);
                let check = Scene::parse("undefined", &text)
                    .unwrap()
                    .check(&CheckOptions {
                        samples: Samples::Even(samples),
                        ..CheckOptions::default()
                    });
                let check = check.unwrap();
                assert!(!check.passed(), "{formula}, {drive}: {}", check.to_json());
            }
        }
        let model = written(&scene("t-1", "max"));
        let trajectory = solve(&model, &[0.0]).unwrap();
        let pose = trajectory.samples[0].pose.as_ref().unwrap();
        assert!(pose.outputs[0].is_nan(), "{formula}: {:?}", pose.outputs);
    }
}
