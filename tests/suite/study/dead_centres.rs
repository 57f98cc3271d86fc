//! Pieces near a dead centre: those that move are counted, and only those.

use crate::program::Workspace;
use serde_json::Value;

/// A slider-crank with an offset of 1 turns fully if and only if the rod is longer than the crank by the offset.
fn crank(r: f64, rod: f64) -> String {
    format!(
        r#"units = {{ length = "mm" }}
duration = 4
[parameters]
r = {r:?}
L = {rod:?}
[inputs]
phi = "2*pi*t/4"
[chains]
crank = "Rz(phi) Tx(r)"
rod = "Rz(alpha) Tx(L)"
slide = "Rz(beta) Ty(-1) Tx(-h)"
[loops]
A = "crank rod slide"
[guess]
h = 150
[measures]
m = {{ of = "h", take = "max", min = 10 }}
"#
    )
}

#[test]
fn pieces_that_move_are_counted_whatever_the_nominal_one_is_next_to() {
    let w = Workspace::new();
    for (rod, tolerance) in [
        (78.501, 3.0),
        (78.52, 1.0),
        (78.6, 2.0),
        (80.0, 3.0),
        (84.0, 2.0),
    ] {
        w.write("s.toml", crank(77.5, rod));
        let tolerance_text = tolerance.to_string();
        let arguments = [
            "tolerance",
            "s.toml",
            "--vary",
            "L",
            "--tolerance",
            &tolerance_text,
        ];
        let more = ["--pieces", "800", "--json", "-", "--csv", "p.csv"];
        let run = w.run(&[&arguments[..], &more].concat()).exits(0);
        let report: Value = serde_json::from_slice(&run.stdout).unwrap();
        let failed = report["failed"].as_u64().unwrap();
        // As many as the closed form says, but for what 800 draws scatter by: four standard deviations.
        let share = ((78.5 - rod + tolerance) / (2.0 * tolerance)).clamp(0.0, 1.0);
        let scatter = 4.0 * (800.0 * share * (1.0 - share)).sqrt();
        let off = (failed as f64 - 800.0 * share).abs();
        assert!(off <= scatter, "{rod}: {failed} of 800, {share}");
        // Those that move are long enough: at phi = 0 the slider is at r + sqrt(L² - 1). Poses at 180 places miss dead centres
        // between them.
        let table = String::from_utf8(w.read("p.csv")).unwrap();
        let values = table
            .lines()
            .skip(1)
            .filter_map(|line| line.split(',').nth(1)?.parse::<f64>().ok());
        let mut moved = 0;
        for value in values {
            assert!((value - 77.5).hypot(1.0) > 78.49, "{rod}: {value}");
            moved += 1;
        }
        assert_eq!(moved + failed, 800);
    }
}
