//! Every built-in scene passes its own check, and bodies in contact stay in contact.

use crate::driven::{check, even_times, knots, solve};
use mechanim::clearance::check::{BETWEEN_SAMPLES, ClearanceReport, Judgement};
use mechanim::diag::Source;
use mechanim::distance::bodies::BodyElements;

use mechanim::scene::{Overrides, Scene, builtin, load_scene};
use std::process::Command;

fn open(text: &str) -> Scene {
    let source = Source {
        name: "test".into(),
        text: text.into(),
    };
    load_scene(&source, &Overrides::default()).unwrap_or_else(|e| panic!("{:#?}", e.diagnostics))
}

fn report(scene: &Scene, samples: usize) -> ClearanceReport {
    let times = even_times(scene, samples);
    let trajectory = solve(scene, &knots(scene, &times)).unwrap();
    check(scene, &trajectory, 1e-2)
}

/// Scenes of which a check cannot prove all: the rope starts where it leaves the drum, at a singular pose.
const NOT_PROVED: [(&str, &str); 1] = [(
    "rope-drum",
    "not proved: pose certificates, least_wrap, frame / drum, frame / trolley",
)];

#[test]
fn every_built_in_scene_passes_its_check() {
    let names: Vec<String> = builtin::ALL.map(|s| s.name.to_owned()).to_vec();
    assert!(names.len() >= 20, "{names:?}");
    for name in names {
        let output = Command::new(env!("CARGO_BIN_EXE_mechanim"))
            .args(["check", &name, "--bound-tolerance", "0.01"])
            .output()
            .unwrap();
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        let known = NOT_PROVED.iter().find(|(scene, _)| *scene == name);
        let (code, result) = known.map_or((0, "passed"), |(_, result)| (1, result));
        assert_eq!(output.status.code(), Some(code), "{name}: {text}");
        let line = format!("  result           {result}\n");
        assert!(text.ends_with(&line), "{name}: {text}");
        assert!(text.contains("pairs judged"), "{name} checks no clearances");
        let warnings = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!warnings.contains("need no `ignore`"), "{name}: {warnings}");
    }
}

#[test]
fn surfaces_in_contact_neither_part_nor_cut() {
    for name in ["sphere-sphere", "sphere-torus", "torus-torus"] {
        let scene = open(&builtin::find_builtin(name).unwrap().text);
        let pair = scene.clearance.as_ref().unwrap().touching[0];
        let report = report(&scene, 1000);
        let found = report.judged.iter().find(|p| p.pair == pair).unwrap();
        assert_eq!(found.distances.len(), report.times.len());
        let off = found.distances.iter().fold(0.0, |m: f64, d| m.max(d.abs()));
        assert!(off < 1e-10, "{name}: {off:e}");
        assert_eq!(found.judgement, Judgement::Passed, "{name}");
        // Between the samples, as near as is asked.
        let allowed = BETWEEN_SAMPLES * scene.mechanism.size;
        assert!(found.least.is_certified, "{name}");
        assert!(found.least.bound >= -allowed, "{name}: {found:?}");
        assert!(
            found.known_farthest().unwrap() <= allowed,
            "{name}: {found:?}"
        );
    }
}

const BOUNCING: &str = r#"
title = "A ball that bounces between the samples"
units = { length = "mm", angle = "rad" }
duration = 1
[inputs]
away = "HEIGHT * (1 - cos(10 * pi * t))"
[[bodies]]
name = "floor"
shapes = [{ sphere = { radius = 1 } }]
[[bodies]]
name = "ball"
frame = "Tx(2) Tx(away)"
shapes = [{ sphere = { radius = 1 } }]
[clearance]
minimum = 0
touching = [{ pair = ["floor", "ball"] }]
"#;

/// Five times a second it touches, and it is sampled then only.
#[test]
fn bodies_that_part_between_the_samples_are_not_in_contact() {
    for height in ["0.1", "-0.1", "0.001"] {
        let scene = open(&BOUNCING.replace("HEIGHT", height));
        let report = report(&scene, 5);
        let pair = &report.judged[0];
        assert!(pair.distances.iter().all(|d| d.abs() < 1e-12), "{pair:?}");
        assert_eq!(pair.judgement, Judgement::Failed, "{height}");
        let height: f64 = height.parse().unwrap();
        let worst = pair.worst_moment();
        let found = worst.distance / (2.0 * height);
        assert!(found > 0.01 && found <= 1.0 + 1e-9, "{height}: {pair:?}");
        assert!(worst.time % 0.2 > 1e-3, "{height}: {pair:?}");
    }
}

/// One body that stands still, how the other one moves, and its shape. The size is that of the second body's way.
const SLIDING: [[&str; 4]; 10] = [
    [
        "ball on a table",
        "box = { center = [0, 0, -1], size = [40, 40, 2] }",
        "Tx(5*sin(a)) Ty(3*cos(a)) Tz(1)",
        "sphere = { radius = 1 }",
    ],
    [
        "ball around a pin",
        "cylinder = { from = [0, 0, -9], to = [0, 0, 9], radius = 2 }",
        "Rz(a) Tx(3) Tz(2*sin(a))",
        "sphere = { radius = 1 }",
    ],
    [
        "rods that cross",
        "capsule = { from = [-20, 0, 0], to = [20, 0, 0], radius = 1 }",
        "Tx(5*sin(a)) Rz(0.7*cos(a)) Tz(2)",
        "capsule = { from = [0, -9, 0], to = [0, 9, 0], radius = 1 }",
    ],
    [
        "rod that rolls on a table",
        "box = { center = [0, 0, -1], size = [60, 40, 2] }",
        "Tx(x) Tz(1) Ry(a)",
        "capsule = { from = [0, -5, 0], to = [0, 5, 0], radius = 1 }",
    ],
    [
        "rod in a ring that is larger",
        "torus = { ring = 12, tube = 11 }",
        "Tz(sin(a)) Rz(a)",
        "capsule = { from = [0, 0, -9], to = [0, 0, 9], radius = 1 }",
    ],
    [
        "ring on a pin that is longer",
        "cylinder = { from = [0, 0, -20], to = [0, 0, 20], radius = 2 }",
        "Rz(a) Tz(5*sin(a)) Tx(1)",
        "torus = { ring = 4, tube = 1 }",
    ],
    [
        "ring that rolls on a table",
        "box = { center = [0, 0, -1], size = [80, 80, 2] }",
        "Tx(5*x) Tz(5) Ry(a) Rx(0.5*pi)",
        "torus = { ring = 4, tube = 1 }",
    ],
    [
        "disc that turns on a table",
        "box = { center = [0, 0, -1], size = [40, 40, 2] }",
        "Tx(3*sin(a)) Rz(a)",
        "cylinder = { from = [0, 0, 0], to = [0, 0, 3], radius = 2 }",
    ],
    [
        "cylinder that turns on an equal one",
        "cylinder = { from = [0, 0, -3], to = [0, 0, 0], radius = 2 }",
        "Rz(a)",
        "cylinder = { from = [0, 0, 0], to = [0, 0, 3], radius = 2 }",
    ],
    [
        "ball in a bowl",
        "torus = { ring = 9, tube = 4 }",
        "Rz(a) Tx(9) Ry(0.4*sin(a) - 1.2) Tx(5)",
        "sphere = { radius = 1 }",
    ],
];

#[test]
fn solids_that_slide_and_roll_stay_in_contact() {
    for [name, still, frame, shape] in SLIDING {
        let text = format!(
            r#"
title = "{name}"
units = {{ length = "mm", angle = "rad" }}
duration = 1
[inputs]
a = "2*pi*t"
x = "2*pi*t"
[[bodies]]
name = "still"
shapes = [{{ {still} }}]
[[bodies]]
name = "moving"
frame = "{frame}"
shapes = [{{ {shape} }}]
[clearance]
minimum = 0
touching = [{{ pair = ["still", "moving"] }}]
"#
        );
        let scene = open(&text);
        let pair = &report(&scene, 60).judged[0];
        assert_eq!(pair.judgement, Judgement::Passed, "{name}: {pair:?}");
        assert!(pair.least.is_certified, "{name}: {pair:?}");
        // Ten radii of the smaller body, or the size if that is between one and ten.
        let radii = scene.mechanism.bodies.iter().map(|body| {
            let elements = BodyElements::new(body).unwrap();
            elements.ball.1
        });
        let radius = radii.fold(f64::INFINITY, f64::min);
        let scale = scene.mechanism.size.clamp(radius, 10.0 * radius);
        let allowed = BETWEEN_SAMPLES * scale;
        assert!(pair.least.bound >= -allowed, "{name}: {pair:?}");
        assert!(
            pair.known_farthest().unwrap() <= allowed,
            "{name}: {pair:?}"
        );
    }
}

#[test]
fn surfaces_of_another_size_are_not_in_contact() {
    let text = builtin::find_builtin("torus-torus").unwrap().text;
    for (tube, sign) in [("s2 + 1e-6", -1.0), ("s2 - 1e-6", 1.0)] {
        let other = text.replace(
            r#"[{ torus = { ring = "r2", tube = "s2" }"#,
            &format!(r#"[{{ torus = {{ ring = "r2", tube = "{tube}" }}"#),
        );
        assert_ne!(other, text);
        let report = report(&open(&other), 60);
        let worst = report.worst().unwrap();
        assert_eq!(worst.judgement, Judgement::Failed);
        assert!(
            (worst.worst_moment().distance - sign * 1e-6).abs() < 1e-10,
            "{worst:?}"
        );
    }
}

const ROPE: &str = r#"
title = "A row of beads"
units = { length = "mm", angle = "rad" }
duration = 1
[inputs]
a = "t"
b = 0
[[bodies]]
name = "bead 1"
shapes = [{ sphere = { radius = 1 } }]
[[bodies]]
name = "bead 2"
frame = "Rz(a) Tx(1) Rz(b)"
shapes = [{ sphere = { radius = 1 } }]
[[bodies]]
name = "wall"
frame = "Tx(5) Rz(a) Tx(1) Rz(b)"
shapes = [{ sphere = { radius = 1 } }]
[clearance]
minimum = 0.5
ignore = [{ pair = ["bead *", "NAME"], reason = "strung" }]
"#;

#[test]
fn a_star_stands_for_the_rest_of_a_name() {
    let excluded = |name: &str| {
        let report = report(&open(&ROPE.replace("NAME", name)), 5);
        report.excluded.iter().map(|p| p.pair).collect::<Vec<_>>()
    };
    assert_eq!(excluded("bead *"), [[0, 1]]);
    assert_eq!(excluded("*"), [[0, 1], [0, 2], [1, 2]]);
    assert_eq!(excluded("wall"), [[0, 2], [1, 2]]);
    let source = Source {
        name: "test".into(),
        text: ROPE.replace("NAME", "pearl *"),
    };
    let errors = load_scene(&source, &Overrides::default()).unwrap_err();
    assert!(format!("{:?}", errors.diagnostics).contains("begins with `pearl `"));
}
