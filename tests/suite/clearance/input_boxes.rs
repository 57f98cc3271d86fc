//! Boxes of inputs: the least distance found is that of the whole box, and no bound is above it.

use crate::program::Workspace;
use serde_json::Value;

/// An arm of two links, 100 and 80 mm long, beside a post.
const ARM: &str = r#"
units = { length = "mm", angle = "deg" }
duration = 1
[inputs]
q1 = "10*t"
q2 = "30"
[[bodies]]
name = "fore"
frame = "Rz(q1) Tx(100) Rz(q2)"
shapes = [{ capsule = { from = [0, 0, 0], to = [80, 0, 0], radius = 5 } }]
[[bodies]]
name = "post"
shapes = [{ capsule = { from = [60, 170, -50], to = [60, 170, 50], radius = 8 } }]
[clearance]
minimum = 2
"#;

/// Distance of the forearm from the post, from plane geometry.
fn distance(q1: f64, q2: f64) -> f64 {
    let [a, b] = [q1.to_radians(), (q1 + q2).to_radians()];
    let elbow = [100.0 * a.cos(), 100.0 * a.sin()];
    let along = [b.cos(), b.sin()];
    let to_post = [60.0 - elbow[0], 170.0 - elbow[1]];
    let share = (to_post[0] * along[0] + to_post[1] * along[1]).clamp(0.0, 80.0);
    (to_post[0] - share * along[0]).hypot(to_post[1] - share * along[1]) - 13.0
}

#[test]
fn the_least_distance_of_a_box_is_found() {
    let w = Workspace::new();
    w.write("arm.toml", ARM);
    for ([from1, to1], [from2, to2]) in [
        ([0.0, 40.0], [0.0, 40.0]),
        ([0.0, 40.0], [0.0, 60.0]),
        ([-20.0, 35.0], [10.0, 100.0]),
        ([0.0, 60.0], [-90.0, -10.0]),
    ] {
        let sides = [format!("q1={from1}:{to1}"), format!("q2={from2}:{to2}")];
        let run = w.run(&[
            "check",
            "arm.toml",
            "--inputs-box",
            &sides[0],
            "--inputs-box",
            &sides[1],
            "--json",
            "r.json",
        ]);
        let report: Value = serde_json::from_slice(&w.read("r.json")).unwrap();
        let pair = &report["inputs_box"]["pairs"][0];
        let [found, bound] = ["distance", "bound"].map(|key| pair[key].as_f64().unwrap());
        let steps = 400;
        let place = |from: f64, to: f64, k: usize| from + (to - from) * k as f64 / steps as f64;
        let grid = (0..=steps).flat_map(|i| (0..=steps).map(move |j| [i, j]));
        let least = grid
            .map(|[i, j]| distance(place(from1, to1, i), place(from2, to2, j)))
            .fold(f64::INFINITY, f64::min);
        // The grid is up to a hundredth of a millimetre above the least distance.
        assert!(
            found < least + 1e-3 && found > least - 0.05,
            "{sides:?}: {found} {least}\n{}",
            run.text()
        );
        assert!(bound <= found, "{sides:?}: {bound} {found}");
    }
}
