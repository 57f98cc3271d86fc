//! What `check` prints for the torus pair, its simpler forms and their twins, against the paper's figures as a computation with
//! 40 digits gives them for the printed parameters.

use crate::program::Workspace;
use serde_json::Value;

/// Deviation, K, largest pressure angle with its place, range with equal sense; degrees.
type Figures = ([f64; 5], [&'static str; 2]);

const FIGURES: [Figures; 3] = [
    (
        [0.00818, 0.016493, 53.9366, 40.14, 236.674],
        ["torus-torus", "seven-r"],
    ),
    (
        [0.01512, 0.027241, 59.7165, 70.56, 230.890],
        ["sphere-torus", "rsrrr"],
    ),
    (
        [0.03385, 0.067346, 60.1216, 329.52, 232.152],
        ["sphere-sphere", "rsur"],
    ),
];

/// Half a unit of the last digit that is given.
const HALF_UNITS: [f64; 5] = [5.1e-6, 5.1e-7, 5.1e-5, 5.1e-3, 5.1e-4];

fn measure<'v>(report: &'v Value, name: &str) -> &'v Value {
    let list = report["measures"].as_array().unwrap();
    list.iter().find(|m| m["name"] == name).unwrap()
}

#[test]
fn check_prints_the_figures_of_the_torus_paper() {
    let w = Workspace::new();
    for (expected, scenes) in FIGURES {
        for scene in scenes {
            let run = w.run(&["check", scene, "--json", "-"]).exits(0);
            let report: Value = serde_json::from_str(&run.text()).unwrap();
            let value = |name: &str| measure(&report, name)["value"].as_f64().unwrap();
            let steepest = measure(&report, "steepest");
            let found = [
                value("deviation"),
                value("K"),
                value("steepest"),
                steepest["inputs"]["beta1"].as_f64().unwrap(),
                value("range"),
            ];
            for ((found, expected), half) in found.iter().zip(expected).zip(HALF_UNITS) {
                assert!(
                    (found - expected).abs() < half,
                    "{scene}: {found} {expected}"
                );
            }
            // Located between the samples, and bounded there.
            assert_eq!(steepest["certified"], true, "{scene}");
            let bound = steepest["bound"].as_f64().unwrap();
            assert!(
                (0.0..1e-6).contains(&(bound - found[2])),
                "{scene}: {bound}"
            );
        }
    }
}

/// Forty samples a turn or a thousand: what is the largest along a track does not depend on them.
#[test]
fn extremes_along_a_track_do_not_depend_on_its_samples() {
    let w = Workspace::new();
    let scene = std::fs::read_to_string("scenes/seven-r.toml").unwrap();
    let turn = "turn = { samples = 361, inputs = { beta1 = [0, 360] } }";
    assert!(scene.contains(turn));
    for samples in ["40", "97", "1000"] {
        let text = turn.replace("361", samples);
        w.write("turn.toml", scene.replace(turn, &text));
        let run = w.run(&["check", "turn.toml", "--json", "-"]).exits(0);
        let report: Value = serde_json::from_str(&run.text()).unwrap();
        let steepest = measure(&report, "steepest");
        let place = steepest["inputs"]["beta1"].as_f64().unwrap();
        let value = steepest["value"].as_f64().unwrap();
        assert!((value - 53.936_603).abs() < 1e-6, "{samples}: {value}");
        assert!((place - 40.1437).abs() < 1e-3, "{samples}: {place}");
        assert_eq!(steepest["certified"], true, "{samples}");
        // Crossings are located, too.
        let share = measure(&report, "range")["value"].as_f64().unwrap();
        assert!((share - 236.674).abs() < 0.02, "{samples}: {share}");
    }
}
