//! The mechanisms of the sources against the numbers printed there or computed from their closed forms, and the gallery
//! against its closed forms.
//!
//! `data/*.csv` were computed in 40-digit arithmetic; `docs/sources.md` tells where the print differs.
// References keep the digits they were given with.
#![allow(clippy::excessive_precision)]

use crate::driven::{Driven, Model, add_derivatives, measures, solve};
use crate::reference::scenes::{scene, turned, value, whole, written};
use crate::reference::{Table, drive_by_rows};
use mechanim::kinematics::rates::columns::{RateColumns, RateVariable};
use mechanim::kinematics::results::trajectory::{ClosedPose, EventKind};
use mechanim::kinematics::solve::iterates::record_iterates;
use mechanim::model::mechanism::Kind;
use mechanim::scene::{Overrides, builtin, load_scene};
use std::f64::consts::TAU;

/// A scene, a table that drives it, and the columns that are compared.
struct Case {
    scene: &'static str,
    guess: &'static [(&'static str, &'static str)],
    table: &'static str,
    /// Our name, column of the table, largest difference; angles are compared up to whole turns.
    columns: Vec<(String, String, f64)>,
}

fn same(names: &[&str], tolerance: f64) -> Vec<(String, String, f64)> {
    let named = names
        .iter()
        .map(|n| (n.to_string(), n.to_string(), tolerance));
    named.collect()
}

fn numbered(letter: &str, count: usize, tolerance: f64) -> Vec<(String, String, f64)> {
    let names: Vec<String> = (1..=count).map(|k| format!("{letter}{k}")).collect();
    same(
        &names.iter().map(String::as_str).collect::<Vec<_>>(),
        tolerance,
    )
}

#[test]
fn poses_match_the_tables_at_every_row() {
    let pair =
        |ours: &str, theirs: &str, tolerance| (ours.to_owned(), theirs.to_owned(), tolerance);
    let lever = [("handle_x", "xM"), ("handle_y", "yM")].map(|(a, b)| pair(a, b, 1e-9));
    let wheels =
        ["1L", "1R", "2L", "2R"].map(|w| pair(&format!("wheel_{w}"), &format!("w{w}"), 1e-12));
    let ackermann =
        ["1R", "2L", "2R"].map(|w| pair(&format!("ackermann_{w}"), &format!("ack{w}"), 1e-12));
    let cases = [
        Case {
            scene: "gearshift-left",
            guess: &[],
            table: "gearshift6_30",
            columns: [numbered("a", 36, 1e-11), lever.to_vec()].concat(),
        },
        Case {
            scene: "twin-steer",
            guess: &[],
            table: "twinsteer",
            columns: [
                numbered("b", 30, 1e-12),
                wheels.to_vec(),
                ackermann.to_vec(),
            ]
            .concat(),
        },
        Case {
            scene: "feeder",
            guess: &[],
            table: "feeder_cycle",
            columns: [same(&["psi13"], 1e-13), same(&["p14"], 1e-11)].concat(),
        },
        Case {
            scene: "feeder",
            guess: &[("psi13", "3.3"), ("p14", "-100")],
            table: "feeder_cycle",
            columns: vec![
                pair("psi13", "psi13_crossed", 1e-13),
                pair("p14", "p14_crossed", 1e-11),
            ],
        },
    ];
    for case in cases {
        let table = Table::read(case.table);
        let mut mechanism = scene(case.scene, &[], case.guess);
        let times = drive_by_rows(&mut mechanism, &table);
        let trajectory = solve(&mechanism, &times).unwrap();
        for (row, pose) in whole(&trajectory).into_iter().enumerate() {
            assert_eq!(
                pose.rank,
                mechanism.unknowns.len(),
                "{} row {row}",
                case.scene
            );
            for (ours, theirs, tolerance) in &case.columns {
                let difference = value(&mechanism, pose, ours) - table.value(row, theirs);
                let is_length = mechanism
                    .unknowns
                    .iter()
                    .any(|c| c.name == *ours && c.kind == Kind::Length);
                let error = if is_length {
                    difference
                } else {
                    turned(difference, TAU)
                };
                let place = format!("{} {ours} row {row}", case.scene);
                assert!(error.abs() < *tolerance, "{place}: {error:e}");
            }
        }
    }
}

#[test]
fn dimensions_of_the_scenes_are_those_of_the_tables() {
    for (name, file) in [
        ("gearshift-left", "gearshift6_dims"),
        ("twin-steer", "twinsteer_dims"),
    ] {
        let table = Table::read(file);
        let text = builtin::find_builtin(name).unwrap().text;
        for row in 0..table.len() {
            let wanted = table.text(row, "name");
            let line = text
                .lines()
                .find(|l| l.split('=').next().is_some_and(|n| n.trim() == wanted));
            let line = line.unwrap_or_else(|| panic!("{name} has no {wanted}"));
            let number = line.split('=').nth(1).unwrap().split('#').next().unwrap();
            let number: f64 = number.trim().parse().unwrap();
            assert_eq!(number, table.value(row, "value"), "{name} {wanted}");
        }
    }
}

#[test]
fn loops_and_unknowns_are_as_many_as_the_sources_say() {
    for (name, loops, unknowns, blocks) in [
        ("gearshift-left", 6, 36, 4),
        ("twin-steer", 5, 30, 5),
        ("feeder", 1, 2, 1),
    ] {
        let mechanism = scene(name, &[], &[]);
        assert_eq!(
            (mechanism.loops.len(), mechanism.unknowns.len()),
            (loops, unknowns),
            "{name}"
        );
        let system = mechanism.system().unwrap();
        assert_eq!(system.structure().equation_count(), unknowns, "{name}");
        assert_eq!(system.blocks().len(), blocks, "{name}");
    }
}

#[test]
fn gate_shapes_are_measured_as_defined() {
    for (name, file) in [
        ("gearshift", "gearshift_orig_characteristics"),
        ("gearshift-optimised", "gearshift_opt_characteristics"),
    ] {
        let table = Table::read(file);
        // The optimised dimensions are rounded to four digits behind the point in the scene; so they are in the table.
        let mechanism = scene(name, &[], &[]);
        let trajectory = solve(&mechanism, &[0.0]).unwrap();
        let values = measures(&mechanism, &trajectory);
        for (measure, value) in mechanism.measures.list.iter().zip(&values) {
            let expected = table.value(0, &measure.name);
            let error = value.unwrap() - expected;
            let tolerance = if measure.name == "F" {
                1e-12 * expected
            } else {
                1e-10
            };
            assert!(
                error.abs() < tolerance,
                "{name} {}: {error:e}",
                measure.name
            );
        }
        assert_eq!(values.len(), 10);
    }
}

#[test]
fn a_measure_of_a_motion_with_a_gap_has_no_value() {
    let text = builtin::find_builtin("lifting-arm").unwrap().text;
    let text = text.replace(
        "[outputs]",
        "[measures]\nhighest = { of = \"C.y\", take = \"max\" }\n[outputs]",
    );
    for (last, expected) in [("2.3", true), ("3.3", false)] {
        let highest = "[\"cycle/2\", 2.3]";
        assert!(text.contains(highest));
        let mechanism = written(&text.replace(highest, &highest.replace("2.3", last)));
        let times: Vec<f64> = (0..=40).map(|k| 0.1 * k as f64).collect();
        let trajectory = solve(&mechanism, &times).unwrap();
        assert_eq!(trajectory.missing() == 0, expected);
        assert_eq!(measures(&mechanism, &trajectory)[0].is_some(), expected);
    }
}

#[test]
fn wheels_follow_ackermann_as_closely_as_computed() {
    let mut mechanism = scene("twin-steer", &[], &[]);
    let times = drive_by_rows(&mut mechanism, &Table::read("twinsteer"));
    let trajectory = solve(&mechanism, &times).unwrap();
    for (wheel, degrees) in [("1R", 0.333), ("2L", 0.644), ("2R", 0.575)] {
        let errors = whole(&trajectory).into_iter();
        let errors = errors.map(|p| {
            value(&mechanism, p, &format!("error_{wheel}"))
                .to_degrees()
                .abs()
        });
        let largest = errors.fold(0.0, f64::max);
        assert!((largest - degrees).abs() < 5e-4, "{wheel}: {largest}");
    }
}

#[test]
fn feeder_has_the_derivatives_of_its_closed_form() {
    let table = Table::read("feeder_cycle");
    let mut mechanism = scene("feeder", &[], &[]);
    let times = drive_by_rows(&mut mechanism, &table);
    let mut trajectory = solve(&mechanism, &times).unwrap();
    let columns = RateColumns {
        order: 2,
        by: RateVariable::Input(0),
    };
    add_derivatives(&mechanism, &mut trajectory, columns);
    let headings = columns.headings(&mechanism);
    for (row, pose) in whole(&trajectory).into_iter().enumerate() {
        for (heading, column) in [
            ("d(psi13)/d(psi12)", "dpsi13"),
            ("d(p14)/d(psi12)", "dp14"),
            ("d2(psi13)/d(psi12)2", "ddpsi13"),
            ("d2(p14)/d(psi12)2", "ddp14"),
        ] {
            let k = headings
                .iter()
                .position(|(name, _)| name == heading)
                .unwrap();
            let error = pose.derivatives[k] - table.value(row, column);
            assert!(error.abs() < 1e-11, "{heading} row {row}: {error:e}");
        }
    }
}

#[test]
fn rope_turns_the_drum_as_the_closed_form_says_and_its_start_is_named_singular() {
    let table = Table::read("drum");
    let mechanism = scene("rope-drum", &[], &[]);
    let mut trajectory = solve(&mechanism, &table.column("t")).unwrap();
    let columns = RateColumns {
        order: 2,
        by: RateVariable::Time,
    };
    add_derivatives(&mechanism, &mut trajectory, columns);
    let headings = columns.headings(&mechanism);
    let place = |name: &str| headings.iter().position(|(n, _)| n == name).unwrap();
    let (first, second) = (place("d(phi)/dt"), place("d2(phi)/dt2"));
    // The rope leaves the rim on the side of its start values.
    let [event, chosen] = trajectory.events.as_slice() else {
        panic!("{:?}", trajectory.events)
    };
    assert!(matches!(chosen.kind, EventKind::BranchChosen { .. }));
    assert_eq!((&event.kind, event.time), (&EventKind::StartSingular, 0.0));
    for (row, pose) in whole(&trajectory).into_iter().enumerate() {
        let phi = value(&mechanism, pose, "phi");
        assert!((phi - table.value(row, "phi")).abs() < 1e-13, "row {row}");
        if row == 0 {
            // Infinite at the rim: no number is given; the speed is finite there.
            assert!(pose.derivatives[second].is_nan());
            assert_eq!(table.text(0, "alpha"), "-inf");
            let error = pose.derivatives[first] - table.value(0, "omega");
            assert!(error.abs() < 1e-11, "omega at the rim: {error:e}");
            continue;
        }
        // Near the rim the acceleration grows like 1/sqrt(t), and its rounding with it.
        for (k, column) in [(first, "omega"), (second, "alpha")] {
            let error = pose.derivatives[k] - table.value(row, column);
            assert!(error.abs() < 1e-11, "{column} row {row}: {error:e}");
        }
    }
}

#[test]
fn lifting_arm_is_exact_where_it_exists_and_25_samples_do_not() {
    let table = Table::read("lifting_arm");
    let mut mechanism = scene("lifting-arm", &[], &[]);
    let mut rows = drive_by_rows(&mut mechanism, &table);
    rows.truncate(table.len());
    let trajectory = solve(&mechanism, &rows).unwrap();
    assert_eq!(trajectory.samples.len(), 101);
    assert_eq!(trajectory.missing(), 25, "impossible samples of the source");
    for (row, sample) in trajectory.samples.iter().enumerate() {
        let exists = table.text(row, "phi") != "nan";
        assert_eq!(sample.pose.is_some(), exists, "row {row}");
        let Some(pose) = &sample.pose else { continue };
        let error = value(&mechanism, pose, "phi") - table.value(row, "phi");
        // At the ends of the range the pose is a double root and loses half its digits.
        assert!(error.abs() < 1e-12, "row {row}: {error:e}");
        for (axis, column) in [(0, "xC"), (1, "yC")] {
            let error = pose.traces[0][axis] - table.value(row, column);
            assert!(error.abs() < 4e-12, "row {row} {column}: {error:e}");
        }
        let mu = table.value(row, "mu");
        let error = value(&mechanism, pose, "transmission") / mu - 1.0;
        assert!(error.abs() < 1e-11, "row {row} mu: {error:e}");
    }
}

#[test]
fn lifting_arm_ends_where_its_triangle_does() {
    let text = builtin::find_builtin("lifting-arm").unwrap();
    let overrides = Overrides {
        inputs: vec![("l".to_owned(), "4*L*(t/T)*(1 - t/T)".to_owned())],
        ..Overrides::default()
    };
    let mechanism = Model::from(load_scene(&text, &overrides).unwrap());
    let times: Vec<f64> = (0..=80).map(|k| 0.1 + 0.01 * k as f64).collect();
    let trajectory = solve(&mechanism, &times).unwrap();
    let ends: Vec<f64> = trajectory
        .events
        .iter()
        .filter(|e| matches!(e.kind, EventKind::MotionEnds(_)))
        .map(|e| e.time)
        .collect();
    let [end] = ends.as_slice() else {
        panic!("{:?}", trajectory.events)
    };
    assert!((end - 0.84249948671333249).abs() < 1e-9, "{end}");
    assert!(trajectory.samples.iter().all(|s| {
        let inside = (0.15750051328666751..=0.84249948671333249).contains(&s.time);
        s.pose.is_some() == inside
    }));
}

#[test]
fn gallery_keeps_its_closed_forms() {
    let at = |name: &str| {
        let mechanism = scene(name, &[], &[]);
        let times: Vec<f64> = (0..96)
            .map(|k| mechanism.actuation.duration * k as f64 / 96.0)
            .collect();
        let trajectory = solve(&mechanism, &times).unwrap();
        let rows: Vec<(f64, ClosedPose)> = trajectory
            .samples
            .iter()
            .map(|s| (s.inputs[0], s.pose.clone().expect(name)))
            .collect();
        (mechanism, rows)
    };
    let (mechanism, rows) = at("peaucellier");
    for (_, pose) in &rows {
        assert!(value(&mechanism, pose, "offset").abs() < 1e-12 * 110.0);
    }
    let (mechanism, rows) = at("hooke-joint");
    for (t1, pose) in &rows {
        let t2 = value(&mechanism, pose, "t2").to_radians();
        let expected = (t1.sin() * 30f64.to_radians().cos()).atan2(t1.cos());
        assert!(turned(t2 - expected, TAU).abs() < 1e-13, "{t1}");
    }
    let (mechanism, rows) = at("bennett");
    for (t1, pose) in &rows {
        let [t2, t3, t4] = ["t2", "t3", "t4"].map(|n| value(&mechanism, pose, n));
        let expected = 2.0 * ((1.0 + 3f64.sqrt()) * (t1 / 2.0).cos()).atan2((t1 / 2.0).sin());
        for error in [t2 - expected, t3 + t1, t4 + t2] {
            assert!(turned(error, TAU).abs() < 1e-12, "{t1}: {error:e}");
        }
    }
    let (mechanism, rows) = at("bricard");
    let (c, s) = (60f64.to_radians().cos(), 60f64.to_radians().sin());
    for (t1, pose) in &rows {
        let [t2, t3, t4, t5, t6] =
            ["t2", "t3", "t4", "t5", "t6"].map(|n| value(&mechanism, pose, n).to_radians());
        let (c1, c2) = (t1.cos(), t2.cos());
        let open =
            c * c + s * s * (c1 + c2) + (1.0 + c * c) * c1 * c2 - 2.0 * c * t1.sin() * t2.sin();
        for error in [open, t3 - t1, t5 - t1, t4 - t2, t6 - t2] {
            assert!(turned(error, TAU).abs() < 1e-12, "{t1}: {error:e}");
        }
    }
    let (mechanism, rows) = at("sarrus");
    for (t1, pose) in &rows {
        let error = value(&mechanism, pose, "height") - 100.0 * t1.sin();
        assert!(error.abs() < 1e-12 * 100.0, "{t1}: {error:e}");
    }
    let (mechanism, rows) = at("four-bar");
    for (phi, pose) in &rows {
        // The diagonal from the crank's pin to the rocker's pivot, by the law of cosines from both sides.
        let mu = value(&mechanism, pose, "mu").to_radians();
        let (crank, coupler, rocker, ground) = (35.0_f64, 95.0, 80.0, 105.0);
        let square = crank * crank + ground * ground - 2.0 * crank * ground * phi.cos();
        let from_coupler = coupler * coupler + rocker * rocker - 2.0 * coupler * rocker * mu.cos();
        assert!((square - from_coupler).abs() < 1e-9, "{phi}");
    }
}

#[test]
fn iterates_of_the_feeder_are_those_of_the_exercise() {
    let table = Table::read("feeder_nrs_iterates");
    let overrides = Overrides {
        inputs: vec![("psi12".to_owned(), "60deg".to_owned())],
        ..Overrides::default()
    };
    let mechanism =
        Model::from(load_scene(&builtin::find_builtin("feeder").unwrap(), &overrides).unwrap());
    let system = mechanism.system().unwrap();
    let start = [
        mechanism.actuation.guess.clone(),
        mechanism.actuation.inputs_at(0.0),
    ]
    .concat();
    let (list, closed) = record_iterates(&system, &start);
    assert!(closed);
    let slot = |name: &str| {
        mechanism
            .unknowns
            .iter()
            .position(|c| c.name == name)
            .unwrap()
    };
    for (row, iterate) in list.iter().enumerate() {
        for (name, tolerance) in [("psi13", 1e-14), ("p14", 1e-12)] {
            let error = iterate.unknowns[slot(name)] - table.value(row, name);
            assert!(error.abs() < tolerance, "{name} {row}: {error:e}");
            if let Some(next) = list.get(row + 1) {
                let sum = iterate.unknowns[slot(name)] + iterate.corrections[slot(name)];
                assert_eq!(sum, next.unknowns[slot(name)]);
            }
        }
        let item = &iterate.loops[0];
        for (axis, column) in [(0, "f1"), (1, "f2")] {
            let error = item.gap[axis] - table.value(row, column);
            assert!(error.abs() < 1e-12 * 200.0, "{column} {row}: {error:e}");
        }
        // The opened polygon: pivot, crank's end, rod's end, and what is missing to the origin.
        let sides: Vec<f64> = item
            .polygon
            .windows(2)
            .map(|p| p[0].distance(p[1]))
            .collect();
        let lengths = [50.0, 60.0, 180.0, iterate.unknowns[slot("p14")]];
        assert_eq!(sides.len(), lengths.len());
        assert!(
            sides
                .iter()
                .zip(lengths)
                .all(|(a, b)| (a - b).abs() < 1e-12 * 200.0),
            "{sides:?}"
        );
        assert!(item.polygon.last().unwrap().distance(item.gap) < 1e-12 * 200.0);
    }
    assert!((4..=7).contains(&list.len()), "{}", list.len());
}
