//! Reports show lengths in any unit: the same mechanism in millimetres, metres and kilometres has the same digits.

use crate::program::Workspace;

const UNITS: [f64; 4] = [1.0, 1e-3, 1e-6, 1e3];

/// A slider-crank whose lengths are in this unit, with a ball on its slider and one that it comes near to.
fn slider(unit: f64) -> String {
    let length = |value: f64| format!("{:e}", value * unit);
    format!(
        "duration = 2\n[inputs]\nphi = \"0.5*sin(t)\"\n[chains]\nsl = \"Tx(s)\"\n[loops]\n\
         l = \"Rz(phi) Tx({crank}) Rz(x) Tx({rod}) Rz(-x-phi) Tx(-s)\"\n[guess]\ns = {start}\n\
         [[bodies]]\nname = \"a\"\nframe = \"sl\"\nshapes = [{{ sphere = {{ radius = {radius} }} }}]\n\
         [[bodies]]\nname = \"b\"\nshapes = [{{ sphere = {{ center = [{place}, 0, 0], radius = {radius} }} }}]\n\
         [clearance]\nminimum = {least}\npairs = [{{ pair = [\"a\", \"b\"], minimum = {least} }}]\n",
        crank = length(0.2),
        rod = length(2.35),
        start = length(2.5),
        radius = length(0.1),
        place = length(4.25),
        least = length(0.5),
    )
}

/// Distance, bound and minimum of the row of the only pair, over the unit.
fn row_of(text: &str, unit: f64) -> [f64; 3] {
    let row = text.lines().find(|line| line.ends_with("a / b"));
    let cells: Vec<&str> = row.expect(text).split_whitespace().collect();
    [0, 1, 2].map(|k| cells[k].parse::<f64>().expect(text) / unit)
}

#[test]
fn a_table_of_clearances_shows_lengths_in_any_unit() {
    let w = Workspace::new();
    for unit in UNITS {
        w.write("s.toml", slider(unit));
        let text = w.run(&["check", "s.toml"]).exits(0).text();
        let [distance, bound, minimum] = row_of(&text, unit);
        assert!((distance - 1.5).abs() < 1e-3, "{unit:e}: {text}");
        assert!((0.495..=1.5).contains(&bound), "{unit:e}: {text}");
        assert!((minimum - 0.5).abs() < 1e-3, "{unit:e}: {text}");
    }
}

#[test]
fn a_table_of_modes_shows_lengths_in_any_unit_and_no_negative_zero() {
    let w = Workspace::new();
    for unit in UNITS {
        w.write("s.toml", slider(unit));
        let text = w.run(&["modes", "s.toml"]).exits(0).text();
        let heads = text.lines().find(|line| line.contains("sigma_min"));
        let heads: Vec<&str> = heads.expect(&text).split_whitespace().collect();
        let place = heads
            .iter()
            .rposition(|head| *head == "s" || head.starts_with("s/"));
        let from_end = heads.len() - place.expect(&text);
        let rows = text
            .lines()
            .filter(|line| line.contains("e-") || line.contains("e0"));
        let cells = rows.filter_map(|row| row.split_whitespace().nth_back(from_end - 1));
        let values: Vec<f64> = cells.filter_map(|cell| cell.parse().ok()).collect();
        // The slider is before or behind the crank: at the start 2.55 or -2.15 from it.
        for wanted in [2.55, -2.15] {
            let is_met = values.iter().any(|v| (v / unit - wanted).abs() < 2e-3);
            assert!(is_met, "{wanted} of {values:?}, {unit:e}: {text}");
        }
        let zeros = text
            .split_whitespace()
            .filter(|cell| cell.starts_with("-0.000000"));
        assert_eq!(zeros.count(), 0, "{unit:e}: {text}");
    }
}
