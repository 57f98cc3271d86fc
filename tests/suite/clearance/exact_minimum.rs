//! Bodies that keep exactly their minimum while they slide over faces and beyond their edges.

use mechanim::{CheckOptions, Scene};

/// The end of a rod (a capsule with another direction and place) passes over the flat top of a pin, `gap` above it.
fn over_a_pin(spin: f64, rod: [[f64; 2]; 2], gap: f64, minimum: f64) -> String {
    let [[x, y], [u, v]] = rod;
    let height = 7.0 + 4.5 + gap;
    format!(
        r#"
units = {{ length = "mm" }}
duration = 2
[inputs]
phi = "pi*t"
[[bodies]]
name = "frame"
shapes = [{{ cylinder = {{ from = [40, 0, -20], to = [40, 0, 7], radius = 5 }} }}]
[[bodies]]
name = "bar"
frame = "Tx(40) Rz(phi) Tx(20) Rz({spin:?}*phi) Tx(-20)"
shapes = [{{ capsule = {{ from = [{x:?}, {y:?}, {height:?}], to = [{u:?}, {v:?}, {height:?}], radius = 4.5 }} }}]
[clearance]
minimum = {minimum:?}
"#
    )
}

/// A block slides along a shelf and beyond its end, `gap` above it.
fn along_a_shelf(way: f64, gap: f64, minimum: f64) -> String {
    let low = 3.0 + gap;
    format!(
        r#"
units = {{ length = "mm" }}
duration = 1
[inputs]
s = "{way:?}*t"
[[bodies]]
name = "shelf"
shapes = [{{ cylinder = {{ from = [0, 0, 0], to = [0, 0, 3], radius = 20 }} }}]
[[bodies]]
name = "block"
frame = "R(0, 0, 1, 0.3) Tx(s)"
shapes = [{{ capsule = {{ from = [-5, 1, {height:?}], to = [4, -2, {height:?}], radius = 2 }} }}]
[clearance]
minimum = {minimum:?}
"#,
        height = low + 2.0
    )
}

fn passes(text: &str) -> bool {
    let scene = Scene::parse("exact", text).unwrap();
    scene.check(&CheckOptions::default()).unwrap().passed()
}

#[test]
fn what_slides_beyond_an_edge_keeps_exactly_its_minimum() {
    let rods = [[[-22.0, 1.0], [22.0, 2.0]], [[-30.0, 0.3], [5.0, -3.0]]];
    for spin in [-2.1, -1.7, -1.3, -3.3, -0.4, 0.9, 2.6] {
        for rod in rods {
            for minimum in [0.5, 0.3, 2.75] {
                let text = over_a_pin(spin, rod, minimum, minimum);
                assert!(passes(&text), "{spin} {rod:?} {minimum}");
                // With a little less, or nearer by a little, it does not pass.
                let text = over_a_pin(spin, rod, minimum, minimum * (1.0 + 1e-5));
                assert!(!passes(&text), "{spin} {rod:?} {minimum}");
            }
        }
    }
    for way in [60.0, 41.0, -73.0] {
        assert!(passes(&along_a_shelf(way, 0.25, 0.25)), "{way}");
        assert!(!passes(&along_a_shelf(way, 0.25, 0.25001)), "{way}");
    }
}

/// A linkage whose coupler passes above the frame's pin.
#[test]
fn no_design_of_a_linkage_with_exact_gaps_stays_undecided() {
    let scene = Scene::builtin("four-bar").unwrap();
    for k in 0..80 {
        let crank = 20.0 + 0.25 * f64::from(k);
        let design = scene.with_parameter("crank", crank).unwrap();
        let check = design.check(&CheckOptions::default()).unwrap();
        assert_eq!(check.passed(), crank < 39.75, "{crank}");
    }
}
