//! Bodies far from their origins: the slack of a pair is relative to the pair, and what large coordinates cost by rounding never
//! passes a pair.

use crate::driven::{check, even_times, knots, solve};
use mechanim::clearance::check::Judgement;
use mechanim::diag::Source;
use mechanim::scene::{Overrides, load_scene};

/// A ball that slides sideways above a wall, both at a place far away: across the gap, or along it.
fn scene(radius: f64, place: f64, is_along: bool, top: f64, middle: f64, minimum: f64) -> String {
    let [x, z] = if is_along { [0.0, place] } else { [place, 0.0] };
    let half = 5.0 * radius;
    let (wall, ball) = (top - half, middle);
    let [x, wall, ball] = match is_along {
        true => [x, wall, ball],
        false => [x, wall - z, ball - z],
    };
    format!(
        "title = \"far\"\nduration = 2\n[inputs]\nx = \"{radius}*sin(t)\"\n\
         [[bodies]]\nname = \"wall\"\n\
         shapes = [{{ box = {{ center = [{x:?}, 0, {wall:?}], size = [{0:?}, {0:?}, {1:?}] }} }}]\n\
         [[bodies]]\nname = \"ball\"\nframe = \"Tx(x)\"\n\
         shapes = [{{ sphere = {{ center = [{x:?}, 0, {ball:?}], radius = {radius:?} }} }}]\n\
         [clearance]\nminimum = 0\n\
         pairs = [{{ pair = [\"wall\", \"ball\"], minimum = {minimum:?} }}]\n",
        40.0 * radius,
        2.0 * half
    )
}

#[test]
fn far_coordinates_pass_no_pair_that_is_too_near() {
    // Radius, place, and the minimum, in lengths that no unit of the scene is told.
    for (radius, minimum) in [(1.0, 0.11), (1e-3, 0.11e-3), (250.0, 0.0)] {
        for far in [0.0, 1e2, 1e4, 1e6, 1e8] {
            for is_along in [false, true] {
                let place = far * radius;
                for off in [-2e-3, -1e-5, -1e-7, 1e-9, 2e-3] {
                    let base = if is_along { place } else { 0.0 };
                    let (top, middle) = (base, base + radius * (1.0 + off) + minimum);
                    // What the coordinates as numbers leave.
                    let truth = (middle - top) - radius;
                    let text = scene(radius, place, is_along, top, middle, minimum);
                    let source = Source {
                        name: "far".into(),
                        text: text.clone(),
                    };
                    let scene = match load_scene(&source, &Overrides::default()) {
                        Ok(scene) => scene,
                        Err(e) => panic!("{text}: {:#?}", e.diagnostics),
                    };
                    let times = knots(&scene, &even_times(&scene, 9));
                    let Ok(motion) = solve(&scene, &times) else {
                        panic!("{text}");
                    };
                    let report = check(&scene, &motion, 1e-3);
                    let [pair] = report.judged.as_slice() else {
                        panic!("{text}");
                    };
                    let told = format!("{radius} {far:e} {is_along} {off:e}: {truth} {pair:?}");
                    let own = radius.max(minimum);
                    assert!(pair.slack <= 1.001e-9 * own, "{told}");
                    let passes = pair.judgement == Judgement::Passed;
                    assert!(!passes || truth >= minimum - 2e-9 * own, "{told}");
                    // Rounding takes little, and is no reason to fail what is clear.
                    assert!(passes || truth < minimum + 1e-3 * radius, "{told}");
                    let rounding = 1e-15 * place;
                    assert!(pair.least.bound <= truth + 1e-15 + rounding, "{told}");
                    if far <= 1e2 && off >= 0.0 {
                        assert!(passes, "{told}");
                    }
                }
            }
        }
    }
}
