//! Solids beside each other at a joint: what turns about its own axis keeps its distance, and a wall that turns with its body is
//! parted by a plane that turns with it. Distances are formulas of the angle.

use crate::program::Workspace;
use serde_json::Value;
use std::f64::consts::PI;

/// A mover on a turning joint behind a base that moves, and what stands beside the joint.
struct Beside {
    mover: &'static str,
    still: String,
    /// The distance at an angle.
    distance: fn(f64, f64) -> f64,
}

/// A drive, and the angle over the time.
type Angle = (&'static str, fn(f64) -> f64);

const DRIVES: [Angle; 4] = [
    ("6*pi*t", |t| 6.0 * PI * t),
    ("60*pi*t", |t| 60.0 * PI * t),
    ("0.2*sin(40*t)", |t| 0.2 * (40.0 * t).sin()),
    ("t^2 - 3", |t| t * t - 3.0),
];

const BASES: [&str; 3] = ["", "Rz(base) Tx(30)", "Ry(base) Tz(4) Rx(base)"];

/// Half edges of the box that turns, across its axis.
const HALF: [f64; 2] = [4.0, 2.5];

/// How far the turned box reaches along x.
fn reach(phi: f64) -> f64 {
    HALF[0] * phi.cos().abs() + HALF[1] * phi.sin().abs()
}

fn beside(gap: f64) -> Vec<Beside> {
    let largest = HALF[0].hypot(HALF[1]);
    let constant: fn(f64, f64) -> f64 = |_, gap| gap;
    vec![
        Beside {
            mover: "cylinder = { from = [0, 0, -3], to = [0, 0, 3], radius = 5 }",
            still: format!(
                "box = {{ center = [{}, 1, 0], size = [8, 20, 4] }}",
                9.0 + gap
            ),
            distance: constant,
        },
        Beside {
            mover: "torus = { ring = 4, tube = 1 }",
            still: format!("torus = {{ ring = {}, tube = 2 }}", 7.0 + gap),
            distance: constant,
        },
        Beside {
            mover: "box = { center = [9, 0, 0], size = [6, 3, 4] }",
            still: format!(
                "cylinder = {{ from = [0, 0, -9], to = [0, 0, 9], radius = {} }}",
                6.0 - gap
            ),
            distance: constant,
        },
        Beside {
            mover: "box = { size = [8, 5, 4] }",
            still: format!("torus = {{ ring = {}, tube = 2 }}", largest + 2.0 + gap),
            distance: constant,
        },
        Beside {
            mover: "box = { size = [8, 5, 4] }",
            still: format!(
                "box = {{ center = [{}, 0, 0], size = [2, 60, 30] }}",
                largest + 1.0 + gap
            ),
            distance: |phi, gap| HALF[0].hypot(HALF[1]) + gap - reach(phi),
        },
        Beside {
            mover: "box = { size = [8, 5, 4] }",
            still: format!(
                "box = {{ center = [0, 0, {}], size = [30, 20, 2] }}",
                3.0 + gap
            ),
            distance: constant,
        },
    ]
}

#[test]
fn gaps_beside_a_joint_are_proved_whatever_carries_it() {
    let w = Workspace::new();
    for gap in [0.01, 0.6] {
        for (k, case) in beside(gap).iter().enumerate() {
            for (drive, angle) in DRIVES {
                let base = BASES[k % BASES.len()];
                let steps = 200_000;
                let least = (0..=steps).map(|step| {
                    let time = 2.0 * f64::from(step) / f64::from(steps);
                    (case.distance)(angle(time), gap)
                });
                let least = least.fold(f64::INFINITY, f64::min);
                for (share, expected) in [(0.99, "passed"), (1.01, "failed")] {
                    let minimum = share * least;
                    let has_base = if base.is_empty() {
                        ""
                    } else {
                        "base = \"sin(5*t)\""
                    };
                    let frame = match base.is_empty() {
                        true => String::new(),
                        false => format!("frame = \"{base}\""),
                    };
                    w.write(
                        "scene.toml",
                        format!(
                            "duration = 2\nunits = {{ length = \"mm\", angle = \"rad\" }}\n\
                             [inputs]\nu = \"{drive}\"\n{has_base}\n\
                             [[bodies]]\nname = \"still\"\n{frame}\nshapes = [{{ {} }}]\n\
                             [[bodies]]\nname = \"mover\"\nframe = \"{base} Rz(u)\"\n\
                             shapes = [{{ {} }}]\n\
                             [clearance]\nminimum = 0\n\
                             pairs = [{{ pair = [\"still\", \"mover\"], minimum = {minimum} }}]\n",
                            case.still, case.mover
                        ),
                    );
                    let said = w.run(&["check", "scene.toml", "--json", "r.json"]);
                    let Ok(json) = serde_json::from_slice::<Value>(&w.read("r.json")) else {
                        panic!("{}", said.text());
                    };
                    let pair = &json["clearance"]["pairs"][0];
                    let told = format!("{k} {drive} {gap} {share}: {least} {pair}");
                    assert_eq!(pair["verdict"], expected, "{told}");
                    let number = |key: &str| pair[key].as_f64();
                    // As near as the tolerance asks, which is a thousandth of the minimum.
                    let of_pose = |d: f64| d <= least * 1.0011 && d >= least - 1e-5;
                    assert!(number("distance").is_some_and(of_pose), "{told}");
                    if let Some(bound) = number("bound") {
                        assert!(bound <= least + 1e-9, "{told}");
                    }
                }
            }
        }
    }
}
