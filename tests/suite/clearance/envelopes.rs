//! What bodies sweep, and clearances over boxes of inputs, against closed forms.

use crate::program::Workspace;
use glam::DVec3;
use mechanim::clearance::motion::ProvedMotion;
use mechanim::clearance::swept::Swept;
use mechanim::diag::Source;
use mechanim::kinematics::motion::continuation::solve_motion;
use mechanim::kinematics::structure::system::System;
use mechanim::scene::{Overrides, Scene, load_scene};
use serde_json::Value;
use std::f64::consts::PI;
use std::sync::Arc;

fn open(text: &str) -> Scene {
    let source = Source {
        name: "swept".into(),
        text: text.into(),
    };
    load_scene(&source, &Overrides::default()).unwrap_or_else(|e| panic!("{:#?}", e.diagnostics))
}

fn swept(text: &str, body: usize, seen_from: Option<usize>, cells: u32) -> Swept {
    let scene = open(text);
    let system = System::new(Arc::clone(&scene.mechanism), &scene.actuation).unwrap();
    let times: Vec<f64> = (0..=20)
        .map(|k| scene.actuation.duration * f64::from(k) / 20.0)
        .collect();
    let trajectory = solve_motion(&system, &scene.actuation, &times);
    let motion = ProvedMotion::new(&system, &scene.actuation, &trajectory);
    Swept::new(&motion, body, seen_from, cells).unwrap()
}

/// Every vertex is outside of the true sweep and no farther from it than is said, and the mesh is closed.
fn holds(swept: &Swept, truth: impl Fn(DVec3) -> f64, volume: f64) {
    assert!(swept.mesh.is_closed() && swept.is_certified);
    assert!(swept.mesh.positions.len() > 500);
    for p in &swept.mesh.positions {
        let off = truth(*p);
        assert!(
            off >= -1e-9 && off <= swept.within,
            "{p}: {off}, {}",
            swept.within
        );
    }
    let of = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|k| swept.mesh.positions[k as usize]);
        a.dot(b.cross(c)) / 6.0
    };
    let found: f64 = swept.mesh.triangles.iter().map(of).sum();
    assert!(found > volume && found < volume * 1.7, "{found} {volume}");
}

const STRAIGHT: &str = r#"duration = 2
[inputs]
u = "3*sin(pi*t/4)"
[[bodies]]
name = "ball"
frame = "Tx(u)"
shapes = [{ sphere = { radius = 1 } }]
[[bodies]]
name = "table"
frame = "Tx(u) Tz(2)"
shapes = [{ sphere = { radius = 1 } }]
"#;

#[test]
fn a_ball_on_a_straight_line_sweeps_a_capsule() {
    let capsule = |p: DVec3| p.distance(DVec3::new(p.x.clamp(0.0, 3.0), 0.0, 0.0)) - 1.0;
    for cells in [24, 48] {
        holds(
            &swept(STRAIGHT, 0, None, cells),
            capsule,
            4.0 / 3.0 * PI + 3.0 * PI,
        );
    }
}

#[test]
fn seen_from_a_body_that_moves_along_it_sweeps_itself() {
    let ball = |p: DVec3| p.distance(DVec3::new(0.0, 0.0, -2.0)) - 1.0;
    holds(&swept(STRAIGHT, 0, Some(1), 24), ball, 4.0 / 3.0 * PI);
}

#[test]
fn a_rod_about_its_end_sweeps_a_disc() {
    let text = r#"duration = 2
[inputs]
u = "pi*t"
[[bodies]]
name = "rod"
frame = "Rz(u)"
shapes = [{ capsule = { from = [0, 0, 0], to = [2, 0, 0], radius = 0.3 } }]
"#;
    let disc = |p: DVec3| {
        let out = (p.x.hypot(p.y) - 2.0).max(0.0);
        out.hypot(p.z) - 0.3
    };
    // A disc of 2 x 0.6, and half a torus around it.
    let volume = PI * 4.0 * 0.6 + 0.5 * PI * 0.09 * 2.0 * PI * (2.0 + 4.0 * 0.3 / (3.0 * PI));
    holds(&swept(text, 0, None, 40), disc, volume);
}

#[test]
fn the_program_writes_it_and_says_how_near_it_is() {
    let w = Workspace::new();
    w.write("ball.toml", STRAIGHT);
    let run = w
        .run(&[
            "check",
            "ball.toml",
            "--swept",
            "ball.stl",
            "--body",
            "ball",
        ])
        .exits(0);
    run.says(&["encloses the volume swept by `ball`"]);
    assert!(w.path("ball.stl").is_file());
    w.run(&[
        "check",
        "ball.toml",
        "--swept",
        "ball.stl",
        "--body",
        "nobody",
    ])
    .exits(2);
}

/// A ball on an arm of two driven turns, 2 and 1 long, and a post; the box of both drives.
fn two_drives(minimum: f64) -> String {
    format!(
        r#"title = "two drives"
units = {{ angle = "deg" }}
duration = 1
[inputs]
u = 0
v = 0
[[bodies]]
name = "ball"
frame = "Rz(u) Tx(2) Rz(v) Tx(1)"
shapes = [{{ sphere = {{ radius = 0.1 }} }}]
[[bodies]]
name = "post"
shapes = [{{ sphere = {{ center = [0, 2.5, 0], radius = 0.1 }} }}]
[clearance]
minimum = {minimum}
pairs = [{{ pair = ["ball", "post"], minimum = {minimum} }}]
"#
    )
}

/// The least over u in [0, 60] and v in [-40, 40], by a grid and the formula.
fn truth() -> f64 {
    let mut least = f64::INFINITY;
    for i in 0..=600 {
        for j in 0..=800 {
            let (u, v) = (
                (0.1 * f64::from(i)).to_radians(),
                (-40.0 + 0.1 * f64::from(j)).to_radians(),
            );
            let (x, y) = (2.0 * u.cos() + (u + v).cos(), 2.0 * u.sin() + (u + v).sin());
            least = least.min(x.hypot(y - 2.5) - 0.2);
        }
    }
    least
}

fn over_the_box(minimum: f64, code: i32) -> Value {
    let w = Workspace::new();
    w.write("two.toml", two_drives(minimum));
    let sides = ["--inputs-box", "u=0:60", "--inputs-box", "v=-40:40"];
    w.run(&[&["check", "two.toml", "--json", "box.json"][..], &sides].concat())
        .exits(code);
    serde_json::from_slice(&w.read("box.json")).unwrap()
}

#[test]
fn a_box_of_two_drives_is_proved_or_broken() {
    let truth = truth();
    let kept = over_the_box(truth - 0.05, 0);
    let pair = &kept["inputs_box"]["pairs"][0];
    assert!(pair["bound"].as_f64().unwrap() <= truth + 1e-4, "{pair}");
    assert!(
        pair["bound"].as_f64().unwrap() >= truth - 0.05 - 1e-6,
        "{pair}"
    );
    assert_eq!(kept["result"], "passed");
    let broken = over_the_box(truth + 0.05, 1);
    let pair = &broken["inputs_box"]["pairs"][0];
    assert_eq!(pair["broken"], true);
    let distance = pair["distance"].as_f64().unwrap();
    assert!(distance >= truth - 1e-4, "{pair}");
    // What other strips keep is no bound of a pair that is broken in one.
    let bound = pair["bound"].as_f64();
    assert!(bound.is_none_or(|bound| bound <= distance), "{pair}");
}

/// Nearer to the truth than the strips can prove: the part of the box that is open is named, and holds the place.
#[test]
fn what_is_not_covered_is_named() {
    let found = over_the_box(truth() - 1e-5, 1);
    let open = found["inputs_box"]["pairs"][0]["uncovered"]
        .as_array()
        .unwrap();
    assert!(!open.is_empty(), "{found}");
    assert_eq!(found["result"].as_str().unwrap(), "not proved");
}

/// A slider-crank whose crank length moves, too: loops are proved for all values of a strip at once.
#[test]
fn a_loop_over_a_box_of_inputs() {
    let text = |minimum: f64| {
        format!(
            r#"title = "slider-crank"
duration = 1
[inputs]
phi = 0.5
r = 20
[loops]
A = "Rz(phi) Tx(r) Rz(alpha) Tx(80) Rz(beta) Tx(-h)"
[guess]
h = 95
[[bodies]]
name = "slider"
frame = "Tx(h)"
shapes = [{{ sphere = {{ radius = 5 }} }}]
[[bodies]]
name = "stop"
shapes = [{{ sphere = {{ center = [130, 0, 0], radius = 5 }} }}]
[clearance]
minimum = {minimum}
pairs = [{{ pair = ["slider", "stop"], minimum = {minimum} }}]
"#
        )
    };
    // Nearest at phi = 0.1 with the longest crank of 24.
    let h = |phi: f64, r: f64| r * phi.cos() + (6400.0 - (r * phi.sin()).powi(2)).sqrt();
    let least = 130.0 - h(0.1, 24.0) - 10.0;
    for (minimum, code) in [(least - 0.5, 0), (least + 0.5, 1)] {
        let w = Workspace::new();
        w.write("crank.toml", text(minimum));
        let sides = ["--inputs-box", "phi=0.1:1.2", "--inputs-box", "r=16:24"];
        w.run(&[&["check", "crank.toml"][..], &sides].concat())
            .exits(code);
    }
}
