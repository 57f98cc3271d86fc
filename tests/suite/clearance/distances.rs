//! Distances of bodies as outputs, measures and what studies vary, against closed forms.

use crate::program::Workspace;
use mechanim::diag::Source;
use mechanim::kinematics::measures::values_along;
use mechanim::kinematics::structure::system::System;
use mechanim::scene::{Overrides, load_scene};
use mechanim::{CheckOptions, Samples, Scene};
use serde_json::Value;
use std::sync::Arc;

/// A ball of 0.3 on a crank of 2 beside a ball of r at (4, 1, 0); the drive has a pulse between the samples.
const CRANK: &str = r#"title = "ball beside ball"
duration = 2
[parameters]
r = 0.5
a = 2
[inputs]
u = "1.2 + 0.1*t - EXTRA*exp(-(200*(t - 1.013))^2)"
[[bodies]]
name = "crank"
frame = "Rz(u) Tx(a)"
shapes = [{ sphere = { radius = 0.3 } }]
[[bodies]]
name = "post"
shapes = [{ sphere = { center = [4, 1, 0], radius = "r" } }, { sphere = { center = [0, 0, 90], radius = 1 } }]
[outputs]
gap = { distance = ["crank", "post"] }
far = { distance = ["crank", "post"], shapes = [[1, 2]] }
twice = "2*gap"
[measures]
least = { of = "gap", take = "min", min = LIMIT }
miss = "(least - 1)^2"
[study]
minimise = "miss"
[study.variables]
r = { range = [0.1, 3] }
"#;

fn scene(extra: f64, limit: f64) -> String {
    CRANK
        .replace("EXTRA", &extra.to_string())
        .replace("LIMIT", &limit.to_string())
}

fn between(u: f64, a: f64, r: f64) -> f64 {
    (a * u.cos() - 4.0).hypot(a * u.sin() - 1.0) - 0.3 - r
}

#[test]
fn an_output_is_the_distance_of_two_bodies_at_every_pose() {
    let scene = Scene::parse("balls", &scene(0.7, 0.0)).unwrap();
    let motion = scene.solve(Samples::Even(31)).unwrap();
    let mut poses = 0;
    for pose in motion.poses() {
        let u = pose.value("u").unwrap();
        let gap = between(u, 2.0, 0.5);
        assert!((pose.value("gap").unwrap() - gap).abs() < 1e-12);
        assert!((pose.value("twice").unwrap() - 2.0 * gap).abs() < 1e-12);
        let far = 8104.0_f64.sqrt() - 1.3;
        assert!((pose.value("far").unwrap() - far).abs() < 1e-12);
        poses += 1;
    }
    assert_eq!(poses, 31);
}

#[test]
fn its_derivative_is_that_of_the_formula_and_higher_ones_are_none() {
    let source = Source {
        name: "balls".into(),
        text: scene(0.0, 0.0),
    };
    let scene = load_scene(&source, &Overrides::default()).unwrap();
    let system = System::new(Arc::clone(&scene.mechanism), &scene.actuation).unwrap();
    for u in [0.1, 0.9, 2.0, -1.3] {
        let series = values_along(&system, &[u], &[0], 2).unwrap();
        let gap = series[1].coefficients();
        let rate = (between(u + 1e-6, 2.0, 0.5) - between(u - 1e-6, 2.0, 0.5)) / 2e-6;
        assert!((gap[0] - between(u, 2.0, 0.5)).abs() < 1e-12);
        assert!((gap[1] - rate).abs() < 1e-8, "{u}: {} {rate}", gap[1]);
        assert!(gap[2].is_nan());
    }
}

/// The drive comes within 0.5 rad of the ball in a pulse of 10 ms that no sample sees.
#[test]
fn a_least_distance_is_that_of_the_whole_motion() {
    let calm = between(1.2, 2.0, 0.5);
    let deep = between(1.2 + 0.1013 - 0.7, 2.0, 0.5);
    assert!(deep < calm - 0.3);
    let options = CheckOptions {
        samples: Samples::Even(12),
        ..CheckOptions::default()
    };
    let check = |extra: f64, limit: f64| {
        let scene = Scene::parse("balls", &scene(extra, limit)).unwrap();
        scene.check(&options).unwrap()
    };
    let middle = 0.5 * (calm + deep);
    assert!(
        !check(0.7, middle).passed(),
        "{}",
        check(0.7, middle).text()
    );
    assert!(
        check(0.7, deep - 0.01).passed(),
        "{}",
        check(0.7, deep - 0.01).text()
    );
    assert!(check(0.0, middle).passed());
    let document: Value = serde_json::from_str(check(0.7, deep - 0.01).to_json()).unwrap();
    let least = &document["measures"][0];
    assert!(least["bound"].as_f64().unwrap() <= deep + 1e-6, "{least}");
    assert!(
        (least["value"].as_f64().unwrap() - deep).abs() < 1e-3,
        "{least}"
    );
    assert_eq!(least["certified"], true);
}

#[test]
fn a_study_makes_a_clearance_what_is_asked_though_it_varies_the_shape() {
    let w = Workspace::new();
    w.write("balls.toml", scene(0.0, 0.0));
    w.run(&["optimise", "balls.toml", "--out", "better.toml"])
        .exits(0);
    let text = String::from_utf8(w.read("better.toml")).unwrap();
    let line = text.lines().find(|line| line.starts_with("r = ")).unwrap();
    let r: f64 = line[4..]
        .split_whitespace()
        .next()
        .unwrap()
        .trim_matches('"')
        .parse()
        .unwrap();
    // Least at the end of the drive nearest to the post's direction.
    let least = (0..=2000).map(|k| between(1.2 + 1e-4 * f64::from(k), 2.0, r));
    let least = least.fold(f64::INFINITY, f64::min);
    assert!((least - 1.0).abs() < 1e-3, "{r}: {least}");
}

#[test]
fn what_is_no_distance_is_refused() {
    for (asked, why) in [
        ("[\"crank\", \"nobody\"]", "nobody"),
        ("[\"crank\"]", "two bodies"),
        ("[\"crank\", \"crank\"]", "itself"),
    ] {
        let text = scene(0.0, 0.0).replacen("[\"crank\", \"post\"]", asked, 1);
        let error = Scene::parse("balls", &text).expect_err(asked).to_string();
        assert!(error.contains(why), "{asked}: {error}");
    }
}
