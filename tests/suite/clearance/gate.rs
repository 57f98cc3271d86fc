//! `check` as a gate: scenes that bodies keep apart in, and scenes that they do not, whose least distances are formulas.
//! A pair passes only where that is proved; the verdict depends neither on the samples nor on the tolerance.

use crate::driven::{check, even_times, knots, solve};
use crate::solids::{BOX_TRIANGLES, box_corner, stl_text};
use glam::DVec3;
use mechanim::clearance::check::{ClearanceReport, Judgement};
use mechanim::diag::Source;
use mechanim::scene::{Overrides, Scene, builtin, load_scene};
use std::f64::consts::TAU;
use std::path::Path;

/// What the gate must say.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Gate {
    /// Every pair passes, and that is proved.
    Open,
    /// No pair passes that does not keep its minimum.
    Shut,
}

/// A scene with the least distance of its pair; `None` inside a mesh, or where poses are missing.
struct Row {
    name: String,
    text: String,
    truth: Option<f64>,
    gate: Gate,
}

/// A body that moves up and down at a wall: its shape, how high it is, the wall, the minimum.
fn lift(shape: &str, height: &str, wall: &str, minimum: f64) -> String {
    format!(
        "title = \"lift\"\nduration = 2\nunits = {{ length = \"mm\", angle = \"rad\" }}\n\
         [inputs]\nx = \"0.5*sin(t)\"\nz = {height}\n\
         [[bodies]]\nname = \"wall\"\nshapes = [{{ {wall} }}]\n\
         [[bodies]]\nname = \"mover\"\nframe = \"Tx(x) Tz(z)\"\nshapes = [{{ {shape} }}]\n\
         [clearance]\nminimum = {minimum}\n"
    )
}

const BALL: &str = "sphere = { radius = 1 }";
const FLOOR: &str = "box = { center = [0, 0, -50], size = [400, 400, 100] }";

/// A wall whose lower face is at a height.
fn ceiling(height: f64) -> String {
    let centre = height + 50.0;
    format!("box = {{ center = [0, 0, {centre}], size = [400, 400, 100] }}")
}

fn formula(text: &str) -> String {
    format!("\"{text}\"")
}

/// Boxes of triangles: centre and half edge each.
fn stl(boxes: &[(DVec3, DVec3)]) -> String {
    let of_box = |&(centre, half): &(DVec3, DVec3)| {
        BOX_TRIANGLES.map(|t| t.map(|k| centre + half * box_corner(k)))
    };
    stl_text(boxes.iter().flat_map(of_box))
}

fn open(row: &Row, folder: &Path) -> Scene {
    let source = Source {
        name: row.name.clone(),
        text: row.text.clone(),
    };
    let overrides = Overrides {
        folder: folder.to_path_buf(),
        ..Overrides::default()
    };
    load_scene(&source, &overrides).unwrap_or_else(|e| panic!("{}: {:#?}", row.name, e.diagnostics))
}

fn report(scene: &Scene, samples: usize, tolerance: f64) -> ClearanceReport {
    let times = knots(scene, &even_times(scene, samples));
    check(scene, &solve(scene, &times).unwrap(), tolerance)
}

/// Samples and tolerances, none of which may change a verdict.
const WAYS: [(usize, f64); 4] = [(41, 1e-3), (12, 1e-3), (41, 1.0), (90, 1e-2)];

/// The same for meshes beside each other, whose bounds shrink with the time only: a fine tolerance takes minutes.
const COARSE: [(usize, f64); 2] = [(12, 1.0), (41, 1.0)];

/// Reports of one row.
fn judge(row: &Row, folder: &Path, ways: &[(usize, f64)]) {
    let scene = open(row, folder);
    for &(samples, tolerance) in ways {
        let report = report(&scene, samples, tolerance);
        let said = format!("{} at {samples} samples, tolerance {tolerance}", row.name);
        assert_eq!(report.judged.len(), 1, "{said}");
        let pair = &report.judged[0];
        let passes = pair.judgement == Judgement::Passed && report.is_kept();
        let passes = passes && report.gaps.is_empty();
        assert_eq!(
            passes,
            row.gate == Gate::Open,
            "{said}: {pair:?} {:?}",
            report.gaps
        );
        if let Some(truth) = row.truth
            && truth >= 0.0
        {
            // As far as formulas and poses are rounded.
            let rounding = 1e-9 * (1.0 + truth);
            assert!(pair.least.bound <= truth + rounding, "{said}: {pair:?}");
            assert!(pair.least.distance >= truth - rounding, "{said}: {pair:?}");
        }
    }
}

fn judge_all(rows: Vec<Row>, files: &[(&str, String)]) {
    judge_in(&WAYS, &rows, files);
}

fn judge_in(ways: &[(usize, f64)], rows: &[Row], files: &[(&str, String)]) {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    for row in rows {
        judge(row, folder.path(), ways);
    }
}

fn row(name: impl Into<String>, text: String, truth: Option<f64>, minimum: f64) -> Row {
    let is_kept = truth.is_some_and(|truth| truth >= minimum);
    Row {
        name: name.into(),
        text,
        truth,
        gate: if is_kept { Gate::Open } else { Gate::Shut },
    }
}

/// Strokes with fewer than three samples a cycle: a tip above a floor, radius 1.
#[test]
fn fast_strokes_are_seen_at_their_ends() {
    let mut rows = Vec::new();
    for (stroke, rate, phase) in [
        (15.0, 16.0 * TAU, 3.0),
        (100.0, 102.34, 3.37),
        (40.0, 7.1 * TAU, 0.3),
        (2.0, 33.0 * TAU, 1.0),
        (100.0, 20.5 * TAU, 5.0),
    ] {
        // Above or below the minimum by this.
        for spare in [-0.08, -4e-5, 4e-5, 0.02] {
            for minimum in [0.0, 0.01, 0.5] {
                let height = 1.0 + stroke + minimum + spare;
                let text = format!("{height} + {stroke}*sin({rate}*t + {phase})");
                let text = lift(BALL, &formula(&text), FLOOR, minimum);
                let name = format!("stroke {stroke}, rate {rate}, {spare} from {minimum}");
                rows.push(row(name, text, Some(minimum + spare), minimum));
            }
        }
    }
    judge_all(rows, &[]);
}

/// Kinks and jumps between samples: a ball of radius 1 that rises to 50 below a ceiling.
#[test]
fn kinks_and_jumps_of_drives_are_met() {
    let mut rows = Vec::new();
    for (text, top) in [
        ("max(0, 50 - 20000*abs(t - 1.0112))", 50.0),
        ("50*(floor(t - 0.0112) - floor(t - 0.0122))", 50.0),
        ("50*max(0, 1 - 400*abs(mod(t, 0.5) - 0.2))", 50.0),
        ("-min(0, 30000*abs(t - 0.7777) - 50)", 50.0),
        ("50 - 7*abs(sin(5*t + 0.1))", 50.0),
        ("mod(35.1*t, 50)", 50.0),
        ("50 - mod(61.3*t, 50)", 50.0),
        ("10*floor(2.2*t) + 10", 50.0),
        ("min(50, 30*t)", 50.0),
    ] {
        for spare in [-8.0, -0.01, 0.02, 2.0] {
            let minimum = 0.5;
            let wall = ceiling(top + 1.0 + minimum + spare);
            let text_ = lift(BALL, &formula(text), &wall, minimum);
            rows.push(row(
                format!("{text}, {spare}"),
                text_,
                Some(minimum + spare),
                minimum,
            ));
        }
    }
    // A top that is never reached is kept all the same, and a part of time without poses never passes.
    for text in [
        "sqrt((t - 1.0112)^2 - 1e-6)",
        "0*sqrt(abs(t - 0.3331) - 1e-4)",
        "5*sqrt((t - 0.2)*(t - 0.21))",
    ] {
        let text_ = lift(BALL, &formula(text), &ceiling(100.0), 0.5);
        rows.push(row(text, text_, None, 0.5));
    }
    judge_all(rows, &[]);
}

/// Cranks whose angle starts anew every turn: a bar of 50, a post beside its circle.
#[test]
fn cranks_may_start_every_turn_anew() {
    let crank = |angle: &str, spare: f64| {
        let at = 50.0 + 2.0 + 3.0 + spare;
        format!(
            "title = \"crank\"\nduration = 2\nunits = {{ length = \"mm\", angle = \"rad\" }}\n\
             [inputs]\nphi = \"{angle}\"\nb = \"0.3*t\"\n\
             [[bodies]]\nname = \"crank\"\nframe = \"Rz(phi)\"\n\
             shapes = [{{ capsule = {{ from = [0, 0, 0], to = [50, 0, 0], radius = 2 }} }}]\n\
             [[bodies]]\nname = \"post\"\nframe = \"Tx({at}) Rz(b)\"\n\
             shapes = [{{ cylinder = {{ from = [0, 0, -50], to = [0, 0, 50], radius = 3 }} }}]\n\
             [clearance]\nminimum = 0.5\n"
        )
    };
    let mut rows = Vec::new();
    for angle in [
        "mod(7*pi*t, 2*pi)",
        "mod(5.3*pi*t + 1, 2*pi)",
        "7*t - 2*pi*floor(7*t/(2*pi))",
    ] {
        for spare in [2.0, 0.51, 0.49, -1.0] {
            rows.push(row(
                format!("{angle}, {spare}"),
                crank(angle, spare),
                Some(spare),
                0.5,
            ));
        }
    }
    judge_all(rows, &[]);
}

/// Balls that are inside a closed mesh for a while, and never touch it.
#[test]
fn what_jumps_into_a_mesh_is_noticed() {
    let cube = "stl = { file = \"cube.stl\" }";
    let mut rows = Vec::new();
    for (height, is_inside) in [
        (
            "{ keys = [[0, 50], [0.52, 0], [1.51, 50], [2, 50]], ease = \"step\" }",
            true,
        ),
        (
            "{ keys = [[0, 0], [0.52, 50], [1.51, 50], [2, 50]], ease = \"step\" }",
            true,
        ),
        ("\"50 - 50*(floor(t - 0.0112) - floor(t - 0.0122))\"", true),
        ("\"50*floor(1.9*t)\"", true),
        ("\"mod(900*floor(3.1*t), 1000)\"", true),
        (
            "\"25 - 20*(t - 1)/abs(t - 1) + 0*sqrt((t - 1)^2 - 0.01)\"",
            true,
        ),
        ("\"50 - 20*floor(1.9*t/3)\"", true),
        (
            "{ keys = [[0, 50], [0.52, 30], [1.51, 50], [2, 50]], ease = \"step\" }",
            false,
        ),
        ("\"50 - 20*floor(1.3*t/2)\"", false),
    ] {
        let truth = (!is_inside && height.contains("30")).then_some(19.0);
        // Bodies that may touch may still not be in each other.
        for minimum in [0.1, 0.0] {
            let text = lift(BALL, height, cube, minimum);
            let mut row = row(height, text, truth, minimum);
            if height.contains("1.9*t/3") {
                // Never nearer than 30 - 10 - 1: 20 floor(1.27) is 20.
                (row.truth, row.gate) = (Some(19.0), Gate::Open);
            }
            if height.contains("1.3*t/2") {
                (row.truth, row.gate) = (Some(19.0), Gate::Open);
            }
            rows.push(row);
        }
    }
    let cube = stl(&[(DVec3::ZERO, DVec3::splat(10.0))]);
    judge_all(rows, &[("cube.stl", cube)]);
}

/// Of a mesh in several parts one lies in another body all the time, or none does.
#[test]
fn every_shell_of_a_mesh_counts() {
    let far = (DVec3::new(60.0, 0.0, 0.0), DVec3::splat(3.0));
    let farther = (DVec3::new(0.0, 70.0, 0.0), DVec3::splat(3.0));
    let within = (DVec3::ZERO, DVec3::splat(1.0));
    let files = [
        ("room.stl", stl(&[(DVec3::ZERO, DVec3::splat(20.0))])),
        ("last.stl", stl(&[far, within])),
        ("first.stl", stl(&[within, far])),
        ("middle.stl", stl(&[far, within, farther])),
        ("outside.stl", stl(&[far, farther])),
    ];
    let mut rows = Vec::new();
    let solids = [
        "stl = { file = \"room.stl\" }",
        "box = { size = [40, 40, 40] }",
    ];
    for wall in solids {
        for part in ["last", "first", "middle", "outside"] {
            let shape = format!("stl = {{ file = \"{part}.stl\" }}");
            // From 20 to the far part, which begins at 57, moves sideways by up to 0.5 and starts at 0.
            let truth = (part == "outside").then_some(37.0);
            for minimum in [0.1, 0.0] {
                let text = lift(&shape, "\"0.5*t\"", wall, minimum);
                rows.push(row(format!("{part} in {wall}"), text, truth, minimum));
            }
        }
    }
    judge_all(rows, &files);
}

/// Meshes that are cut, at rest, on the way, right through, or only at one instant: they have no depth, and none passes
/// for that, though nothing but an overlap is forbidden.
#[test]
fn cut_meshes_pass_nowhere() {
    let cube = "stl = { file = \"cube.stl\" }";
    let rod = "capsule = { from = [0, 0, -40], to = [0, 0, 40], radius = 1 }";
    let plate = "box = { size = [60, 60, 1] }";
    let mut rows = Vec::new();
    for (shape, height) in [
        (BALL, "10"),
        (BALL, "10 + 0*t"),
        (BALL, "10.5 + 0.2*t"),
        (BALL, "30 - 20*sin(1.5*t)"),
        (BALL, "10.9995 + 2000*(t - 1.003)^2"),
        (rod, "3*t"),
        (plate, "1"),
        (plate, "9.4 + 5*t"),
        (cube, "7"),
        (cube, "2*t"),
        (cube, "19.999 + 3*t"),
    ] {
        let text = lift(shape, &formula(height), cube, 0.0);
        rows.push(row(format!("{shape} at {height}"), text, None, 0.0));
    }
    let cube = stl(&[(DVec3::ZERO, DVec3::splat(10.0))]);
    judge_in(&COARSE, &rows, &[("cube.stl", cube)]);
}

/// Boxes of triangles that run along each other at a constant distance.
#[test]
fn meshes_that_slide_are_proved() {
    let files = [
        ("carriage.stl", stl(&[(DVec3::ZERO, DVec3::splat(10.0))])),
        (
            "rail.stl",
            stl(&[(DVec3::new(0.0, 0.0, -20.0), DVec3::new(500.0, 15.0, 5.0))]),
        ),
    ];
    let carriage = "stl = { file = \"carriage.stl\" }";
    let mut rows = Vec::new();
    for rail in [
        "stl = { file = \"rail.stl\" }",
        "box = { center = [0, 0, -20], size = [1000, 30, 10] }",
    ] {
        for (height, truth) in [
            ("1e-3*t", 5.0),
            ("-4.4 + 1e-3*t", 0.6),
            ("-4.6 + 1e-3*t", 0.4),
        ] {
            let text =
                lift(carriage, &formula(height), rail, 0.5).replace("0.5*sin(t)", "400*t - 400");
            rows.push(row(format!("{height} over {rail}"), text, Some(truth), 0.5));
        }
    }
    judge_in(&COARSE, &rows, &files);
}

/// Files whose triangles do not fit: an inside is found, or the check fails, or the scene says that there is none.
#[test]
fn meshes_without_an_inside_fail() {
    let cube = || stl(&[(DVec3::ZERO, DVec3::splat(10.0))]);
    let facet = |text: &str, k: usize| {
        let parts: Vec<&str> = text.split("facet normal").collect();
        parts[k].trim_end_matches("end").to_owned()
    };
    // The corners of one triangle the other way round.
    let flipped = {
        let text = cube();
        let mut lines: Vec<&str> = text.lines().collect();
        lines.swap(3, 4);
        lines.join("\n") + "\n"
    };
    let cracked = cube().replacen("vertex -10 -10 -10", "vertex -10.000002 -10 -10", 1);
    let holed = cube().replace(&format!("facet normal{}", facet(&cube(), 1)), "");
    let flap = cube().replace(
        "endsolid",
        "facet normal 0 0 0\nouter loop\nvertex 10 10 10\nvertex 10 10 -10\nvertex 14 14 0\nendloop\nendfacet\nendsolid",
    );
    let files = [
        ("flipped.stl", flipped),
        ("cracked.stl", cracked),
        ("holed.stl", holed),
        ("flap.stl", flap),
    ];
    assert!(files[2].1.matches("vertex").count() == 33, "{}", files[2].1);
    let mut rows = Vec::new();
    for (name, is_mended) in [
        ("flipped", true),
        ("cracked", true),
        ("holed", false),
        ("flap", true),
    ] {
        let mesh = |key: &str| format!("stl = {{ file = \"{name}.stl\"{key} }}");
        let inside = |key| lift(BALL, "\"0.1*t\"", &mesh(key), 0.1);
        let above = |key| lift(BALL, "\"30 + 0.1*t\"", &mesh(key), 0.1);
        rows.push(row(format!("in {name}"), inside(""), None, 0.1));
        rows.push(row(
            format!("above {name}"),
            above(""),
            is_mended.then_some(19.0),
            0.1,
        ));
        rows.push(row(
            format!("above {name}, a surface"),
            above(", surface = true"),
            Some(19.0),
            0.1,
        ));
        // A surface has no inside: what is in it is as far from it as from its faces, 10 - 1 - 0.5 at x.
        let mut row = row(
            format!("in {name}, a surface"),
            inside(", surface = true"),
            None,
            0.1,
        );
        row.gate = Gate::Open;
        rows.push(row);
    }
    judge_all(rows, &files);
}

/// A pair is judged by its own size: a body far away, and a coarse tolerance, let nothing pass.
#[test]
fn far_bodies_and_coarse_tolerances_let_nothing_pass() {
    let mut rows = Vec::new();
    for far in ["1e4", "1e6", "1e8"] {
        for spare in [-0.09, 0.09] {
            let text = format!("{} + 15*sin(40*t)", 1.0 + 15.0 + 0.1 + spare);
            let text = lift(BALL, &formula(&text), FLOOR, 0.1);
            let ignored = "ignore = [\
                { pair = [\"far\", \"wall\"], reason = \"far\" }, \
                { pair = [\"far\", \"mover\"], reason = \"far\" }]\n";
            let body = format!(
                "[[bodies]]\nname = \"far\"\nframe = \"Tx({far})\"\nshapes = [{{ sphere = {{ radius = 1 }} }}]\n[clearance]"
            );
            let text = text.replace("[clearance]", &body) + ignored;
            rows.push(row(
                format!("{far} away, {spare}"),
                text,
                Some(0.1 + spare),
                0.1,
            ));
        }
    }
    judge_all(rows, &[]);
}

/// Built-in scenes have one verdict, whatever the samples and the tolerance are.
#[test]
fn verdicts_depend_neither_on_samples_nor_on_tolerance() {
    for (name, fewest) in [
        ("four-bar", 10),
        ("slider-crank", 10),
        ("sphere-torus", 40),
        ("torus-torus", 40),
    ] {
        let scene =
            load_scene(&builtin::find_builtin(name).unwrap(), &Overrides::default()).unwrap();
        for (samples, tolerance) in [(fewest, 1e-2), (40, 1e-2), (40, 1.0), (101, 1.0)] {
            let report = report(&scene, samples, tolerance);
            let words: Vec<&Judgement> = report.judged.iter().map(|p| &p.judgement).collect();
            let pass = words.iter().all(|word| **word == Judgement::Passed);
            assert!(
                pass && report.is_kept(),
                "{name} {samples} {tolerance}: {words:?}"
            );
        }
    }
}

/// Two links on a joint about z: shapes of the arm and of the frame.
fn joined(arm: &str, frame: &str, minimum: f64) -> String {
    format!(
        "title = \"joined\"\nduration = 2\n[inputs]\nu = \"pi*t\"\n\
         [[bodies]]\nname = \"arm\"\nframe = \"Rz(u)\"\nshapes = [{arm}]\n\
         [[bodies]]\nname = \"frame\"\nshapes = [{frame}]\n[clearance]\nminimum = {minimum}\n"
    )
}

/// What touches at the first pose is left out near the joint only, and down to its depth there.
#[test]
fn what_touches_at_a_joint_is_judged_where_it_does_more() {
    let far = ", { sphere = { center = [0, 0, 9], radius = 0.1 } }";
    let capsule =
        |to: &str| format!("{{ capsule = {{ from = [0, 0, 0], to = {to}, radius = 0.1 }} }}{far}");
    let arm = capsule("[2, 0, 0]");
    let boxed = |centre: &str, size: &str| {
        format!("{{ box = {{ center = {centre}, size = {size} }} }}{far}")
    };
    let rows = [
        // Two bars that fold onto each other, the shallowest angle 0 and 60 degrees.
        ("folds", arm.clone(), capsule("[-2, 0, 0]"), Gate::Shut),
        // A wall beside an arm, nearer than the minimum at the first pose.
        ("wall", boxed("[0.9, 0, 0]", "[2, 0.2, 0.2]"), boxed("[0, -0.62, 0]", "[4, 1, 0.2]"), Gate::Shut),
        // A square shaft whose corners cut into a wall.
        ("shaft", boxed("[0, 0, 0]", "[1, 1, 1]"), boxed("[1.02, 0, 0]", "[1, 1, 1]"), Gate::Shut),
        // A pin in its bearing.
        (
            "pin",
            format!("{{ cylinder = {{ from = [0, 0, -1], to = [0, 0, 1], radius = 0.2 }} }}{far}"),
            "{ box = { center = [0, 0, 0], size = [1, 1, 1] } }, { sphere = { center = [9, 0, 0], radius = 1 } }".into(),
            Gate::Open,
        ),
    ];
    for (name, arm, frame, gate) in rows {
        let row = Row {
            name: name.into(),
            text: joined(&arm, &frame, 0.05),
            truth: None,
            gate,
        };
        let report = report(&open(&row, Path::new(".")), 41, 1e-2);
        let passed = report
            .judged
            .iter()
            .all(|p| p.judgement == Judgement::Passed);
        let far = report
            .judged
            .iter()
            .any(|p| p.judgement == Judgement::Failed);
        match gate {
            Gate::Open => assert!(passed, "{name}: {report:#?}"),
            Gate::Shut => assert!(far, "{name}: {report:#?}"),
        }
        assert!(
            report.excluded.iter().all(|p| !p.left_out.is_empty()),
            "{name}"
        );
    }
}

/// `ignore` of some shapes leaves the row of the joint in the report.
#[test]
fn nothing_is_left_out_in_silence() {
    let arm = "{ box = { center = [0.9, 0, 0], size = [2, 0.2, 0.2] } }, { sphere = { center = [0, 0, 3], radius = 0.1 } }";
    let frame = "{ box = { center = [0, -0.62, 0], size = [4, 1, 0.2] } }, { sphere = { center = [0, 0, 3.05], radius = 0.1 } }";
    let text = joined(arm, frame, 0.05)
        + "ignore = [{ pair = [\"arm\", \"frame\"], shapes = [[2, 2]], reason = \"ball bearing\" }]\n";
    let row = Row {
        name: "bearing".into(),
        text,
        truth: None,
        gate: Gate::Shut,
    };
    let report = report(&open(&row, Path::new(".")), 41, 1e-2);
    assert!(
        report
            .judged
            .iter()
            .any(|p| p.judgement == Judgement::Failed),
        "{report:#?}"
    );
}

/// A least distance that is below the minimum by less than the tolerance asks for fails all the same.
#[test]
fn a_minimum_a_little_above_the_least_distance_fails() {
    let far = 2.5 - 0.5 - 1.0 - 0.1;
    for above in [1e-7, 1.5e-8, 1e-6] {
        let text = format!(
            "duration = 2\n[inputs]\nu = \"2.89*t + 1.79\"\n\
             [[bodies]]\nname = \"a\"\nframe = \"Rz(u)\"\nshapes = [{{ sphere = {{ center = [1,0,0], radius = 0.1 }} }}]\n\
             [[bodies]]\nname = \"b\"\nshapes = [{{ box = {{ center = [2.5,0.3,0.2], size = [1,1,1] }} }}]\n\
             [clearance]\nminimum = 0\npairs = [{{ pair = [\"a\", \"b\"], minimum = {} }}]\n",
            far + above
        );
        let row = Row {
            name: "near".into(),
            text,
            truth: None,
            gate: Gate::Shut,
        };
        let report = report(&open(&row, Path::new(".")), 41, 1e-3);
        let pair = &report.judged[0];
        assert_eq!(pair.judgement, Judgement::Failed, "{above}: {pair:#?}");
        assert!(pair.least.distance < far + above);
    }
}
