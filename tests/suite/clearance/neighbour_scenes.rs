//! Bodies on one joint, and on joints about one axis or point, that cut each other: none of them passes as a neighbour, and
//! none that keeps clear fails.

use crate::driven::{check, even_times, knots, solve};
use mechanim::clearance::check::{ClearanceReport, Judgement};
use mechanim::diag::Source;
use mechanim::scene::{Overrides, builtin, load_scene};

fn report(name: &str, text: String) -> ClearanceReport {
    let source = Source {
        name: name.into(),
        text,
    };
    let scene = load_scene(&source, &Overrides::default());
    let scene = scene.unwrap_or_else(|e| panic!("{name}: {:#?}", e.diagnostics));
    let times = knots(&scene, &even_times(&scene, 41));
    check(&scene, &solve(&scene, &times).unwrap(), 1e-2)
}

/// Whether all that is judged passes, and something is.
fn passes(report: &ClearanceReport) -> bool {
    let kept = |p: &mechanim::clearance::check::PairReport| p.judgement == Judgement::Passed;
    !report.judged.is_empty() && report.judged.iter().all(kept) && report.is_kept()
}

/// Two bodies with a frame and a shape each.
fn two(drives: &str, first: [&str; 2], second: [&str; 2], more: &str) -> String {
    let body = |name: &str, [frame, shape]: [&str; 2]| {
        format!("[[bodies]]\nname = \"{name}\"\nframe = \"{frame}\"\nshapes = [{shape}]\n")
    };
    format!(
        "duration = 2\n[inputs]\n{drives}{}{}[clearance]\nminimum = 0.5\n{more}",
        body("post", first),
        body("crank", second)
    )
}

fn rod(from: &str, to: &str) -> String {
    format!("{{ capsule = {{ from = {from}, to = {to}, radius = 1 }} }}")
}

fn ball(centre: &str, radius: f64) -> String {
    format!("{{ sphere = {{ center = {centre}, radius = {radius} }} }}")
}

#[test]
fn joints_about_one_axis_or_point_hide_nothing() {
    let arm = rod("[0, 0, 0]", "[30, 0, 0]");
    let short = rod("[4, 0, 0]", "[30, 0, 0]");
    let high = rod("[0, 0, 2.6]", "[30, 0, 2.6]");
    let upright = rod("[0, 20, -9]", "[0, 20, 9]");
    let far = ball("[0, 40, 0]", 2.0);
    let near = ball("[0, 29, 0]", 2.0);
    let turn = "u = \"pi*t\"\nv = \"-0.7*pi*t + 1\"\n";
    let slides = "u = \"10*sin(3*t)\"\nv = \"20 - 12*sin(3*t)\"\n";
    let apart = "u = \"10*sin(3*t)\"\nv = \"20 + 10*sin(3*t)\"\n";
    let fold = "u = \"2.9*sin(t)\"\nv = \"0.2*t\"\nw = \"0.1*t\"\n";
    let lift = "u = \"pi*t\"\nv = \"5*sin(4*t)\"\n";
    let box_at = |x: f64| format!("{{ box = {{ center = [{x}, 0, 0], size = [9, 9, 9] }} }}");
    let own = "pairs = [{ pair = [\"post\", \"crank\"], minimum = 0.5 }]\n";
    let pattern = "pairs = [{ pair = [\"po*\", \"crank\"], minimum = 1 }]\n";
    let rows: Vec<(&str, String, bool)> = vec![
        // One joint to the ground, with and without a minimum of the pair's own.
        (
            "post in the way",
            two(turn, ["E", &near], ["Rz(u)", &arm], own),
            false,
        ),
        (
            "post in the way, unnamed",
            two(turn, ["E", &near], ["Rz(u)", &arm], ""),
            false,
        ),
        (
            "post in the way, by pattern",
            two(turn, ["E", &near], ["Rz(u)", &arm], pattern),
            false,
        ),
        (
            "post beyond",
            two(turn, ["E", &far], ["Rz(u)", &arm], own),
            true,
        ),
        (
            "shaft in its hole, asked for",
            two(turn, ["E", &ball("[0, 0, 0]", 2.0)], ["Rz(u)", &arm], own),
            false,
        ),
        // Two driven arms on one shaft, in one plane, above each other, and about another axis beside it.
        (
            "coaxial arms",
            two(turn, ["Rz(u)", &short], ["Rz(v)", &short], ""),
            false,
        ),
        (
            "coaxial arms above each other",
            two(turn, ["Rz(u)", &short], ["Rz(v)", &high], ""),
            true,
        ),
        (
            "arms about parallel axes",
            two(turn, ["Rz(u)", &short], ["Tx(12) Rz(v)", &short], ""),
            false,
        ),
        (
            "arms about far axes",
            two(turn, ["Rz(u)", &short], ["Tx(63) Rz(v)", &short], ""),
            true,
        ),
        // Two carriages on one rail.
        (
            "carriages that meet",
            two(slides, ["Tx(u)", &box_at(0.0)], ["Tx(v)", &box_at(0.0)], ""),
            false,
        ),
        (
            "carriages apart",
            two(apart, ["Tx(u)", &box_at(0.0)], ["Tx(v)", &box_at(0.0)], ""),
            true,
        ),
        // A wrist and a universal joint that fold back.
        (
            "wrist",
            two(
                fold,
                ["E", &rod("[0, 0, -30]", "[0, 0, -5]")],
                ["Rx(u) Ry(v) Rz(w)", &rod("[0, 0, 5]", "[0, 0, 30]")],
                "",
            ),
            false,
        ),
        (
            "wrist, short",
            two(
                fold,
                ["E", &rod("[0, 0, -30]", "[0, 0, -9]")],
                ["Rx(u) Ry(v) Rz(w)", &rod("[0, 0, 1]", "[0, 0, 6]")],
                "",
            ),
            true,
        ),
        (
            "universal joint",
            two(
                fold,
                ["E", &rod("[0, 0, -30]", "[0, 0, -5]")],
                ["Rx(u) Ry(v)", &rod("[0, 0, 5]", "[0, 0, 30]")],
                "",
            ),
            false,
        ),
        // An arm that turns and lifts, and a screw, beside a post.
        (
            "lift arm",
            two(lift, ["E", &upright], ["Rz(u) Tz(v)", &short], ""),
            false,
        ),
        (
            "lift arm, past the post",
            two(
                lift,
                ["E", &rod("[0, 33, -9]", "[0, 33, 9]")],
                ["Rz(u) Tz(v)", &short],
                "",
            ),
            true,
        ),
        (
            "screw",
            two(
                lift,
                ["E", &ball("[0, 25, 1]", 1.0)],
                ["Hz(4, u)", &short],
                "",
            ),
            false,
        ),
        (
            "screw under the post",
            two(
                lift,
                ["E", &ball("[0, 25, 5]", 1.0)],
                ["Hz(4, u)", &short],
                "",
            ),
            true,
        ),
    ];
    for (name, text, is_kept) in rows {
        let report = report(name, text);
        assert_eq!(passes(&report), is_kept, "{name}: {report:#?}");
    }
}

/// A built-in scene with another shape in its frame.
fn with_shape(scene: &str, shape: &str) -> String {
    let text = builtin::find_builtin(scene).unwrap().text;
    let (before, after) = text.split_once("name = \"frame\"").unwrap();
    let after = after.replacen("shapes = [", &format!("shapes = [\n  {shape},"), 1);
    format!("{before}name = \"frame\"{after}")
}

#[test]
fn what_stands_in_the_way_of_a_built_in_scene_is_seen() {
    let block =
        |x: f64, y: f64| format!("{{ box = {{ center = [{x}, {y}, 0], size = [20, 20, 60] }} }}");
    let stay = |aside: f64| {
        format!(
            "{{ box = {{ center = [\"XK1+380\", \"YK+{aside}\", \"ZK\"], size = [200, 170, 260] }} }}"
        )
    };
    for (scene, shape, pair) in [
        // In the way of the crank and of its pin; out of reach.
        ("slider-crank", block(0.0, 35.0), Some("crank")),
        ("slider-crank", block(-45.0, 0.0), Some("crank")),
        ("slider-crank", block(45.0, 35.0), Some("crank")),
        ("slider-crank", block(0.0, 90.0), None),
        // In the way of the steered wheel; beside it.
        ("twin-steer", stay(350.0), Some("knuckle 1 left")),
        ("twin-steer", stay(300.0), Some("knuckle 1 left")),
        ("twin-steer", stay(900.0), None),
    ] {
        let text = with_shape(scene, &shape);
        let source = Source {
            name: scene.into(),
            text: text.clone(),
        };
        let names: Vec<String> = {
            let scene = load_scene(&source, &Overrides::default()).unwrap();
            scene
                .mechanism
                .bodies
                .iter()
                .map(|b| b.name.clone())
                .collect()
        };
        let report = report(scene, text);
        let failed = report
            .judged
            .iter()
            .filter(|p| p.judgement == Judgement::Failed);
        let found: Vec<[&str; 2]> = failed.map(|p| p.pair.map(|k| names[k].as_str())).collect();
        match pair {
            Some(body) => assert!(found.contains(&["frame", body]), "{shape}: {found:?}"),
            None => assert!(found.is_empty(), "{shape}: {found:?}"),
        }
    }
}

/// Scenes whose pairs all are neighbours are judged where they do not touch at a joint.
#[test]
fn scenes_of_neighbours_are_judged() {
    for scene in [
        "hooke-joint",
        "rope-drum",
        "twin-steer",
        "slider-crank",
        "four-bar",
    ] {
        let text = builtin::find_builtin(scene).unwrap().text;
        let report = report(scene, text.to_string());
        assert!(!report.judged.is_empty(), "{scene}");
    }
}
