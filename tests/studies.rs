//! Measures of the gearshift's study and their exact gradients, against values computed with forty digits.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use mechanim::analysis::study::{Evaluator, Family};
use mechanim::scene::{Overrides, builtin};

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

fn gearshift(vary: &[&str]) -> Family {
    let source = builtin::find("gearshift").unwrap();
    let vary: Vec<String> = vary.iter().map(|s| (*s).to_owned()).collect();
    Family::load(&source, &Overrides::default(), &vary).unwrap_or_else(|e| panic!("{e}"))
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
    for (index, measure) in family.mechanism.measures.iter().enumerate() {
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
    for (measure, got) in family.mechanism.measures.iter().zip(&measured.measures) {
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
    use mechanim::analysis::study::Search;
    let family = gearshift(&["L6s", "ZR1"]);
    let start = family.start();
    let mut search = Search::new(&family, Box::new(|_, _, _| true)).unwrap();
    assert!((search.value() - 5.592044069e-2).abs() < 1e-11);
    let (bounds, scales) = (search.bounds(), search.scales());
    let limits = nelder_mead::Limits {
        x_tolerance: 1e-4,
        value_tolerance: 1e-4,
        evaluations: 1000,
    };
    let simplex = nelder_mead::minimise(&mut search, &start, &bounds, limits);
    let mut search = Search::new(&family, Box::new(|_, _, _| true)).unwrap();
    let limits = bfgs::Limits {
        gradient_tolerance: 1e-9,
        iterations: 200,
        first_step: 0.05,
    };
    let newton = bfgs::minimise(&mut search, &start, &scales, &bounds, limits);
    println!("simplex {simplex:?}\nbfgs {newton:?}");
    for found in [&simplex, &newton] {
        assert!((found.value - 6.50998e-5).abs() < 5e-10, "{found:?}");
        assert!(
            (found.x[0] - 62.9127).abs() < 0.05 && (found.x[1] - 236.431).abs() < 0.3,
            "{found:?}"
        );
    }
}
