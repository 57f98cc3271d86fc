//! Measures of the gearshift's study and their exact gradients, against values computed with forty digits.

use crate::program::Workspace;
use mechanim::analysis::study::optimum::Method;
use mechanim::analysis::study::{Evaluator, LoadedStudy, ParametricMechanism};
use mechanim::diag::Source;
use mechanim::scene::{Overrides, builtin};
use std::sync::atomic::AtomicBool;

const DIMENSIONS: [&str; 22] = [
    "L3k", "L4", "L5d", "XR1", "YR1", "ZR1", "L5h", "L6s", "L6v", "L7", "L4v", "L4s", "L6r", "L6h",
    "L8r", "L8s", "XS1", "YS1", "ZS1", "xM", "yM", "zM",
];

fn table(name: &str) -> (Vec<String>, Vec<Vec<String>>) {
    let text = std::fs::read_to_string(format!("tests/data/{name}")).unwrap();
    let mut lines = text.lines();
    let cells = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
    (cells(lines.next().unwrap()), lines.map(cells).collect())
}

fn gearshift(vary: &[&str]) -> ParametricMechanism {
    let source = builtin::find_builtin("gearshift").unwrap();
    let vary: Vec<String> = vary.iter().map(|s| (*s).to_owned()).collect();
    ParametricMechanism::load(&source, &Overrides::default(), &vary)
        .unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn measures_and_gradients_agree_with_forty_digits() {
    let family = gearshift(&DIMENSIONS);
    let mut evaluator = Evaluator::new(&family);
    let stand = evaluator.nominal(family.nominal().unwrap().poses);
    let found = evaluator.gradients(&stand).unwrap();
    let measured = evaluator.measure(&stand).unwrap();
    assert_eq!(measured.measures, found.measures);
    let (heads, values) = table("gearshift_orig_characteristics.csv");
    let (columns, rows) = table("gearshift_orig_sensitivity.csv");
    for (index, measure) in family.measures.list.iter().enumerate() {
        let column = heads.iter().position(|h| *h == measure.name).unwrap();
        let wanted: f64 = values[0][column].parse().unwrap();
        assert!(
            (found.measures[index] - wanted).abs() <= 1e-11 * wanted.abs().max(1.0),
            "{}",
            measure.name
        );
        let column = columns.iter().position(|h| *h == measure.name).unwrap();
        for (variable, row) in rows.iter().enumerate() {
            assert_eq!(row[0], DIMENSIONS[variable]);
            let (wanted, got): (f64, f64) =
                (row[column].parse().unwrap(), found.rows[index][variable]);
            let slack = 1e-9
                * wanted
                    .abs()
                    .max(if measure.name == "F" { 1e-4 } else { 1e-3 });
            assert!(
                (got - wanted).abs() <= slack,
                "d{}/d{}: {got} {wanted}",
                measure.name,
                row[0]
            );
        }
    }
}

#[test]
fn a_stand_with_other_values_has_the_measures_of_the_optimised_lever() {
    let family = gearshift(&["L6s", "ZR1"]);
    let mut evaluator = Evaluator::new(&family);
    let nominal = evaluator.nominal(family.nominal().unwrap().poses);
    let (heads, values) = table("gearshift_opt_characteristics.csv");
    let source = std::fs::read_to_string("tests/data/gearshift_dims.csv").unwrap();
    let of = |name: &str| -> f64 {
        let line = source
            .lines()
            .find(|l| l.starts_with(&format!("{name},")))
            .unwrap();
        line.split(',').nth(2).unwrap().parse().unwrap()
    };
    let stand = evaluator.reach(&nominal, &[of("L6s"), of("ZR1")]).unwrap();
    let measured = evaluator.measure(&stand).unwrap();
    for (measure, got) in family.measures.list.iter().zip(&measured.measures) {
        let column = heads.iter().position(|h| *h == measure.name).unwrap();
        let wanted: f64 = values[0][column].parse().unwrap();
        assert!(
            (got - wanted).abs() <= 1e-10,
            "{}: {got} {wanted}",
            measure.name
        );
    }
}

/// The lecture's optimisation: both methods come to the same optimum, from the file's own values.
#[test]
fn the_slope_is_optimised_by_simplex_and_by_gradients() {
    use mechanim::analysis::optimise::{bfgs, nelder_mead};
    use mechanim::analysis::study::StudySearch;
    let family = gearshift(&["L6s", "ZR1"]);
    let start = family.start();
    let mut search = StudySearch::new(&family, Box::new(|_, _, _| true)).unwrap();
    assert!((search.value() - 5.592044069e-2).abs() < 1e-11);
    let (bounds, scales) = (search.bounds(), search.scales());
    let limits = nelder_mead::NelderMeadLimits {
        x_tolerance: 1e-6,
        value_tolerance: 1e-6,
        evaluations: 1000,
    };
    let simplex = nelder_mead::minimise_nelder_mead(&mut search, &start, &scales, &bounds, limits);
    let mut search = StudySearch::new(&family, Box::new(|_, _, _| true)).unwrap();
    let limits = bfgs::BfgsLimits {
        gradient_tolerance: 1e-9,
        iterations: 200,
        first_step: 0.05,
    };
    let newton = bfgs::minimise_bfgs(&mut search, &start, &scales, &bounds, limits);
    println!("simplex {simplex:?}\nbfgs {newton:?}");
    for found in [&simplex, &newton] {
        assert!((found.value - 6.50998e-5).abs() < 5e-10, "{found:?}");
        assert!(
            (found.x[0] - 62.9127).abs() < 0.05 && (found.x[1] - 236.431).abs() < 0.3,
            "{found:?}"
        );
    }
}

/// Surfaces of contacts, derivatives by inputs, and angles as variables: exact gradients against differences.
#[test]
fn gradients_of_a_contact_agree_with_differences() {
    let source = builtin::find_builtin("torus-torus").unwrap();
    let family = ParametricMechanism::load(&source, &Overrides::default(), &[]).unwrap();
    let mut evaluator = Evaluator::new(&family);
    let stand = evaluator.nominal(family.nominal().unwrap().poses);
    let exact = evaluator.gradients(&stand).unwrap();
    for k in 0..family.study.variables.len() {
        let mut moved = |h: f64| {
            let mut values = family.start();
            values[k] += h;
            let reached = evaluator.reach(&stand, &values).unwrap();
            evaluator.measure(&reached).unwrap().measures
        };
        let h = 1e-6;
        let (up, down) = (moved(h), moved(-h));
        for (m, measure) in family.measures.list.iter().enumerate() {
            let slope = (up[m] - down[m]) / (2.0 * h);
            let found = exact.rows[m][k];
            let name = &family.study.variables[k].name;
            assert!(
                (slope - found).abs() <= 1e-6 * (1.0 + found.abs()),
                "d{}/d{name}: {found} {slope}",
                measure.name
            );
        }
    }
}

/// A Ctrl-C ends the search of a study before the next look, with values that belong to each other, penalties left out.
#[test]
fn a_search_that_is_told_to_end_says_what_it_has() {
    use mechanim::analysis::optimise::{Minimum, StopReason};
    use mechanim::analysis::study::optimum::{Method, find_optimum};
    use std::sync::atomic::Ordering;
    let source = builtin::find_builtin("torus-torus").unwrap();
    let family = ParametricMechanism::load(&source, &Overrides::default(), &[]).unwrap();
    let mut evaluator = Evaluator::new(&family);
    let start = evaluator.nominal(family.nominal().unwrap().poses);
    for method in [
        Method::Bfgs { tolerance: 1e-9 },
        Method::NelderMead { tolerance: 1e-9 },
        Method::Minimax { tolerance: 1e-9 },
    ] {
        let cancel = AtomicBool::new(false);
        let watch = |_: usize, _: &[f64], _: f64| {
            cancel.store(true, Ordering::Relaxed);
            true
        };
        let found = find_optimum(&family, method, 50, Box::new(watch), &cancel).unwrap();
        let minimum = &found.minimum;
        assert_eq!(minimum.ended, StopReason::Stopped, "{method:?}");
        // It ends where a search ends whose watcher says so: nothing is counted from there on, no refusal either.
        let never = AtomicBool::new(false);
        let stop = Box::new(|_: usize, _: &[f64], _: f64| false);
        let asked = find_optimum(&family, method, 50, stop, &never).unwrap();
        assert_eq!(found.refusals, asked.refusals, "{method:?}");
        let counts = |m: &Minimum| (m.x.clone(), m.iterations, m.evaluations);
        assert_eq!(counts(minimum), counts(&asked.minimum), "{method:?}");
        let stand = evaluator.approach(&start, &minimum.x).unwrap();
        let measured = evaluator.measure(&stand).unwrap().measures;
        let value = measured[family.study.objective.unwrap()];
        assert!(
            (minimum.value - value).abs() < 1e-9 * value,
            "{method:?}: {value} {minimum:?}"
        );
    }
}

/// The paper's parameters are far from the least largest deviation; a few linear programmes show it.
#[test]
fn minimax_improves_the_torus_pair_and_keeps_its_pressure_angle() {
    use mechanim::analysis::study::optimum::{Method, find_optimum, verify_optimum};
    let source = builtin::find_builtin("torus-torus").unwrap();
    let family = ParametricMechanism::load(&source, &Overrides::default(), &[]).unwrap();
    let method = Method::Minimax { tolerance: 1e-9 };
    let never = AtomicBool::new(false);
    let found = find_optimum(&family, method, 12, Box::new(|_, _, _| true), &never).unwrap();
    assert!((found.first_value - 0.00903136).abs() < 1e-7);
    assert!(found.minimum.value < 0.004, "{found:?}");
    let units = |k: usize| {
        family
            .mechanism()
            .file_units(family.study.variables[k].kind)
    };
    let parameters: Vec<(String, String)> = (0..found.minimum.x.len())
        .map(|k| {
            let value = found.minimum.x[k] * units(k);
            (family.study.variables[k].name.clone(), format!("{value:?}"))
        })
        .collect();
    let again = verify_optimum(&source, &Overrides::default(), parameters, (&[], false)).unwrap();
    assert_eq!(again.unproved, 0);
    assert!((again.measures[0] - found.minimum.value).abs() < 1e-9);
    assert!(again.measures[2].to_degrees() <= 60.0 + 1e-3);
}

/// At the straightened lever ±0.5 mm are small: random pieces scatter as the linear rule says, and the slopes by about
/// a millimetre.
#[test]
fn small_tolerances_scatter_as_the_linear_rule_says() {
    use mechanim::analysis::tolerance::{
        Distribution, SampleBatch, linear_tolerance, sample_pieces,
    };
    use std::sync::atomic::AtomicBool;
    let source = builtin::find_builtin("gearshift-optimised").unwrap();
    let vary = DIMENSIONS.map(str::to_owned);
    let family = ParametricMechanism::load(&source, &Overrides::default(), &vary).unwrap();
    let mut evaluator = Evaluator::new(&family);
    let stand = evaluator.nominal(family.nominal().unwrap().poses);
    let gradients = evaluator.gradients(&stand).unwrap();
    let tolerances = [0.5; DIMENSIONS.len()];
    let batch = SampleBatch {
        samples: 3000,
        first: 0,
        seed: 1,
        distribution: Distribution::Uniform,
        threads: 2,
    };
    let rule = linear_tolerance(&gradients, &tolerances, batch.distribution);
    let never = AtomicBool::new(false);
    let made = sample_pieces(&family, &stand, &tolerances, batch, &never, &|_| {});
    assert_eq!((made.made, made.failed), (3000, 0));
    let of = |name: &str| {
        let measures = &family.measures.list;
        measures.iter().position(|m| m.name == name).unwrap()
    };
    for (name, wanted) in [("S_R1", 1.00), ("S_23", 1.00), ("S_45", 1.18)] {
        let k = of(name);
        let found = made.scatter(k, &[0.5]).unwrap();
        assert!((rule[k].root_sum_square - wanted).abs() < 0.01, "{name}");
        // 3000 pieces know a deviation to about one per cent.
        let share = found.deviation / rule[k].deviation;
        assert!((share - 1.0).abs() < 0.05, "{name}: {share}");
        assert!((found.mean - gradients.measures[k]).abs() < 0.05, "{name}");
    }
    // An interrupt keeps what was made, as a beginning of the whole.
    let raised = AtomicBool::new(true);
    let none = sample_pieces(&family, &stand, &tolerances, batch, &raised, &|_| {});
    assert_eq!((none.made, none.failed, none.values.len()), (0, 0, 0));
}

/// A four-bar whose crank can turn until the coupler is shorter than 40: then it cannot pass the far side, though all four
/// samples of the track still close on their branch.
#[test]
fn a_motion_that_breaks_between_the_samples_is_torn() {
    use mechanim::analysis::study::Rejection;
    use mechanim::diag::Source;
    let text = "units = { length = \"mm\", angle = \"deg\" }\nduration = 4\n[parameters]\nb = 60\n[inputs]\n\
                phi = \"45 + 360*t/4\"\n[loops]\n\
                A = \"Rz(phi) Tx(20) Rz(mu) Tx(b) Rz(nu) Tx(-50) Rz(-theta) Tx(-70)\"\n[guess]\ntheta = 86\n\
                [tracks]\nturn = { samples = 4, inputs = { phi = [45, 315] } }\n[measures]\n\
                swing = { track = \"turn\", of = \"theta\", take = \"range\" }\n[study]\nminimise = \"swing\"\n\
                [study.variables]\nb = { range = [30, 80] }\n";
    let source = Source {
        name: "four-bar".to_owned(),
        text: text.to_owned(),
    };
    let family = ParametricMechanism::load(&source, &Overrides::default(), &[])
        .unwrap_or_else(|e| panic!("{e}"));
    let mut evaluator = Evaluator::new(&family);
    let stand = evaluator.nominal(family.nominal().unwrap().poses);
    assert_eq!(evaluator.whole(&stand), Ok(()));
    for b in [75.0, 50.0, 42.0, 40.5, 39.5, 38.0, 36.0] {
        let reached = evaluator.reach(&stand, &[b]).unwrap();
        let lost = Rejection::BranchLost {
            track: "turn".to_owned(),
            pose: 3,
        };
        let wanted = if b > 40.0 { Ok(()) } else { Err(lost) };
        assert_eq!(evaluator.whole(&reached), wanted, "{b}");
        let motion = family.with_start(&[b]).whole_motion();
        assert_eq!(motion.is_some(), b > 40.0, "{b}");
    }
}

/// Joints pass through their locked angles, where coordinates leap and bodies do not: that is no tear.
#[test]
fn a_motion_through_locked_angles_is_whole() {
    for name in ["sphere-sphere", "sphere-torus", "torus-torus"] {
        let family = ParametricMechanism::load(
            &builtin::find_builtin(name).unwrap(),
            &Overrides::default(),
            &[],
        )
        .unwrap();
        let mut evaluator = Evaluator::new(&family);
        let stand = evaluator.nominal(family.nominal().unwrap().poses);
        assert_eq!(evaluator.whole(&stand), Ok(()), "{name}");
        let poses = family.clone().assembled().unwrap().whole_motion().unwrap();
        assert_eq!(poses.len(), stand.poses.len(), "{name}");
    }
}

/// Nobody waits for what is not done when the flag is raised: no corner is tried, no band proved, and no number made up for it.
#[test]
fn a_raised_flag_leaves_what_was_not_tried_unknown() {
    let raised = std::sync::Arc::new(std::sync::atomic::AtomicBool::new(true));
    let scene = mechanim::Scene::builtin("gearshift").unwrap();
    let options = mechanim::study::ToleranceOptions {
        tolerance: Some(0.01),
        pieces: 64,
        ..Default::default()
    };
    let study = scene.study().vary(&["L4"]);
    let whole = study.tolerance(&options).unwrap();
    let ended = study.until(&raised).tolerance(&options).unwrap();
    for (whole, ended) in whole.measures().iter().zip(ended.measures()) {
        assert!(whole.band.is_some() && ended.band.is_none());
        assert_eq!(ended.found, [ended.nominal; 2]);
        assert_eq!(ended.nominal, whole.nominal);
    }
}

/// A four-bar; the distance of the crank's end from its axis never changes, that of the coupler's does.
const CONSTANT: &str = "units = { length = \"mm\", angle = \"deg\" }\nduration = 1\n[parameters]\na = 20\nb = 60\n\
                        [inputs]\nphi = \"30 + 120*t\"\n[loops]\n\
                        A = \"Rz(phi) Tx(a) Rz(mu) Tx(b) Rz(nu) Tx(-50) Rz(-theta) Tx(-70)\"\n[guess]\ntheta = 86\n\
                        [[bodies]]\nname = \"crank\"\nframe = \"Rz(phi) Tx(a)\"\n\
                        [[bodies]]\nname = \"coupler\"\nframe = \"Rz(phi) Tx(a) Rz(mu) Tx(b)\"\n\
                        [[traces]]\nname = \"P\"\nbody = \"crank\"\n[[traces]]\nname = \"Q\"\nbody = \"coupler\"\n\
                        [outputs]\nr = \"hypot(P.x, P.y)\"\nq = \"hypot(Q.x, Q.y)\"\n\
                        [measures]\nstill = { of = \"r\", take = \"range\" }\nmoves = { of = \"q\", take = \"range\" }\n";

/// An objective that is zero but for rounding differs from itself when it is measured again; the motion does not.
#[test]
fn an_objective_of_rounding_is_confirmed_by_its_motion() {
    let workspace = Workspace::new();
    for scale in [1e-6, 1.0, 1e6] {
        let scaled = |number: f64| number * scale;
        let text = CONSTANT
            .replace("a = 20", &format!("a = {:e}", scaled(20.3)))
            .replace("b = 60", &format!("b = {:e}", scaled(60.7)))
            .replace("-50", &format!("-{:e}", scaled(50.0)))
            .replace("-70", &format!("-{:e}", scaled(70.0)));
        let ranges = format!(
            "a = {{ range = [{:e}, {:e}] }}\nb = {{ range = [{:e}, {:e}] }}\n",
            scaled(19.0),
            scaled(22.0),
            scaled(58.0),
            scaled(63.0)
        );
        let study = format!("[study]\nminimise = \"still\"\n[study.variables]\n{ranges}");
        workspace.write("still.toml", &(text + &study));
        for method in ["bfgs", "minimax", "nelder-mead", "evolution"] {
            let run = workspace.run(&[
                "optimise",
                "still.toml",
                "--method",
                method,
                "--iterations",
                "20",
            ]);
            assert!(
                !run.text().contains("Not confirmed"),
                "{scale} {method}: {}",
                run.text()
            );
            assert_eq!(run.code, 0, "{scale} {method}");
        }
    }
}

/// A planted fault: the motion of other dimensions does not confirm an optimum.
#[test]
fn another_motion_confirms_nothing() {
    let study = "[study]\nminimise = \"moves\"\n[study.variables]\nb = { range = [58, 63] }\n";
    let source = Source {
        name: "four-bar".to_owned(),
        text: format!("{CONSTANT}{study}"),
    };
    let study =
        LoadedStudy::new(source, Overrides::default(), &[]).unwrap_or_else(|e| panic!("{e}"));
    let method = Method::Bfgs { tolerance: 1e-9 };
    let never = AtomicBool::new(false);
    let found = study
        .search_optimum(method, 50, &mut |_, _| {}, &never)
        .unwrap();
    let best = found.optimum.minimum.x.clone();
    assert!(found.agrees(&study, &study.verify(&best).unwrap()));
    let beside = [if best[0] > 60.5 { 60.0 } else { 61.0 }];
    assert!(!found.agrees(&study, &study.verify(&beside).unwrap()));
}

/// A parallelogram with a track whose middle sample is in line: nothing can be measured there.
#[test]
fn a_search_without_a_value_confirms_nothing() {
    let text = "units = { length = \"mm\", angle = \"deg\" }\nduration = 2\n[parameters]\na = 30\nb = 100\nc = 30\ng = 100\n\
                [inputs]\nphi = \"40 + 10*t\"\n[loops]\n\
                A = \"Rz(phi) Tx(a) Rz(al) Tx(b) Rz(mu) inv(Tx(g) Rz(psi) Tx(c))\"\n\
                [guess]\nal = -40\npsi = 40\nmu = 40\n\
                [tracks]\nT = { samples = 9, inputs = { phi = [40, -40] } }\n\
                [measures]\nm = { track = \"T\", of = \"psi\", take = \"last\" }\n[study]\nminimise = \"m\"\n\
                [study.variables]\nb = { range = [80, 120] }\ng = { range = [80, 120] }\n";
    let workspace = Workspace::new();
    workspace.write("in-line.toml", text);
    for method in ["bfgs", "nelder-mead", "minimax"] {
        let run = workspace.run(&[
            "optimise",
            "in-line.toml",
            "--method",
            method,
            "--json",
            "-",
        ]);
        let document: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap_or_default();
        // A value is found by methods that move away from the singular pose, or there is none.
        let is_found = document["to"].is_number();
        assert!(
            is_found || run.code != 0,
            "{method}: {} {}",
            run.code,
            run.text()
        );
    }
}

/// Without loops no pose is singular, and nothing limits the search.
#[test]
fn open_chains_are_optimised_by_all_methods() {
    let text = "units = { length = \"mm\", angle = \"rad\" }\nduration = 2\n[parameters]\na = 36\nb = 20\nk = 0.3\n\
                [inputs]\nphi = \"0.5*t\"\n[[bodies]]\nname = \"B\"\nframe = \"Rz(phi + k) Tx(a) Rz(k*phi) Tx(b)\"\n\
                [[traces]]\nname = \"M\"\nbody = \"B\"\n[measures]\nm = { of = \"M.y\", take = \"max\" }\n\
                [study]\nminimise = \"m\"\n[study.variables]\na = { range = [30, 40] }\nb = { range = [10, 30] }\n";
    let workspace = Workspace::new();
    workspace.write("open.toml", text);
    // At phi = 1: a sin(1.3) + b sin(1.6), least with the shortest links.
    let right = 30.0 * 1.3_f64.sin() + 10.0 * 1.6_f64.sin();
    for method in ["bfgs", "minimax", "nelder-mead", "evolution"] {
        let run = workspace.run(&["optimise", "open.toml", "--method", method, "--json", "-"]);
        let document: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
        let found = document["to"].as_f64().unwrap_or(f64::NAN);
        assert!(
            (found - right).abs() < 1e-6 * right,
            "{method}: {found} {right}"
        );
        assert_eq!(run.code, 0, "{method}");
    }
    let run = workspace.run(&["synthesise", "open.toml", "--starts", "2"]);
    assert_eq!(run.code, 0, "{}{}", run.text(), run.stderr);
}
