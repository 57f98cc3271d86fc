//! Singular poses that nearly are something else: two folds that face each other over a narrow gap, folds on which the
//! drive turns back, starts where branches meet. Against closed forms.

use crate::driven::{Model, even_times, feasible_inputs, solve};
use mechanim::kinematics::results::certificate::Certificate;
use mechanim::model::mechanism::Mechanism;

use mechanim::kinematics::results::trajectory::EventKind;

use crate::reference::scenes::written;
use crate::reference::{slot, turned};
use std::f64::consts::PI;

fn unknown(mechanism: &Mechanism, unknowns: &[f64], name: &str) -> f64 {
    unknowns[slot(mechanism, name)]
}

/// A crank longer than its rod by a share `excess`.
fn slider_crank(excess: f64) -> Model {
    written(&format!(
        "duration = 4\n[parameters]\nL = 80\nr = \"L*(1 + {excess})\"\n[inputs]\nphi = \"2*pi*t/4\"\n[loops]\n\
         A = \"Rz(phi) Tx(r) Rz(a) Tx(L) Rz(b) Tx(-h)\"\n[guess]\nh = 160\n"
    ))
}

#[test]
fn a_narrow_gap_is_no_passage() {
    for excess in [1e-2, 1e-4, 1e-6, 1e-8, 1e-9, 1e-10] {
        let mechanism = slider_crank(excess);
        // sin phi <= L/r; the half width of the gap from its cosine, which keeps its digits.
        let half = (excess * (2.0 + excess)).sqrt().atan();
        for samples in [360, 361, 80] {
            let trajectory = solve(&mechanism, &even_times(&mechanism, samples)).unwrap();
            assert_eq!(
                trajectory.gaps.len(),
                2,
                "{excess} {samples}: {:?}",
                trajectory.events
            );
            for (gap, middle) in trajectory.gaps.iter().zip([PI / 2.0, 1.5 * PI]) {
                let (from, until) = (gap.from.as_ref().unwrap(), gap.until.as_ref().unwrap());
                // Steps end where a pose closes to 1e-11, which is farther from narrow gaps' ends.
                let allowed = 1e-9 + 2e-11 / half;
                assert!(
                    (from.inputs[0] - (middle - half)).abs() < allowed,
                    "{excess} {gap:?}"
                );
                assert!(
                    (until.inputs[0] - (middle + half)).abs() < allowed,
                    "{excess} {gap:?}"
                );
            }
            for sample in &trajectory.samples {
                let (sin, cos) = sample.inputs[0].sin_cos();
                let Some(pose) = &sample.pose else {
                    assert!(sin.abs() > 1.0 / (1.0 + excess), "{excess} {}", sample.time);
                    continue;
                };
                let r = 80.0 * (1.0 + excess);
                let rod = ((80.0 - r * sin) * (80.0 + r * sin)).max(0.0).sqrt();
                let error = unknown(&mechanism, &pose.unknowns, "h") - (r * cos + rod);
                assert!(error.abs() < 1e-7, "{excess} {}: {error:e}", sample.time);
            }
        }
    }
    // Equal lengths have none: the slider goes straight through.
    let trajectory = solve(&slider_crank(0.0), &even_times(&slider_crank(0.0), 361)).unwrap();
    assert!(trajectory.gaps.is_empty() && trajectory.missing() == 0);
}

#[test]
fn a_drive_that_turns_back_on_a_dead_point_takes_the_motion_with_it() {
    for samples in [80, 81, 90, 360] {
        let mechanism = written(
            "units = { length = \"mm\", angle = \"deg\" }\nduration = 4\n[inputs]\nh = \"80 + 40*cos(360*t/4)\"\n\
             [loops]\nA = \"Rz(phi) Tx(40) Rz(a) Tx(80) Rz(b) Tx(-h)\"\n[guess]\nphi = 10\n",
        );
        let trajectory = solve(&mechanism, &even_times(&mechanism, samples)).unwrap();
        assert_eq!(
            trajectory.missing(),
            0,
            "{samples}: {:?}",
            trajectory.events
        );
        assert!(
            trajectory.gaps.is_empty(),
            "{samples}: {:?}",
            trajectory.gaps
        );
        for (sample, pose) in trajectory.samples.iter().zip(trajectory.poses()) {
            let h = sample.inputs[0];
            let cosine = (1600.0 + h * h - 6400.0) / (80.0 * h);
            let phi = cosine.clamp(-1.0, 1.0).acos();
            let error = turned(unknown(&mechanism, &pose.unknowns, "phi") - phi);
            assert!(error < 3e-6, "{samples} {}: {error:e}", sample.time);
        }
        let met = trajectory
            .events
            .iter()
            .filter(|e| e.kind == EventKind::SingularPoseMet);
        let on_a_sample = trajectory.samples.iter().any(|s| s.time == 2.0);
        assert_eq!(
            met.count(),
            usize::from(on_a_sample),
            "{:?}",
            trajectory.events
        );
    }
}

#[test]
fn feasible_inputs_are_found_from_far_and_from_links_in_line() {
    for start in [500.0, 20_000.0, -500.0] {
        let mechanism = written(&format!(
            "[inputs]\nh = {start}\n[loops]\nA = \"Rz(phi) Tx(40) Rz(a) Tx(80) Rz(b) Tx(-h)\"\n"
        ));
        let found = feasible_inputs(&mechanism);
        let stretches = &found[0].stretches;
        assert!(!stretches.is_empty(), "{start}");
        for [from, to] in stretches {
            let (low, high) = if *from < 0.0 {
                (-120.0, -40.0)
            } else {
                (40.0, 120.0)
            };
            assert!(
                (from - low).abs() < 1e-6 && (to - high).abs() < 1e-6,
                "{start}: {from} {to}"
            );
        }
    }
}

#[test]
fn the_branch_taken_from_a_change_point_is_said() {
    for (theta, others) in [(0.0, ["-"]), (-0.2, ["+"])] {
        let mechanism = written(&format!(
            "duration = 4\n[inputs]\nphi = \"2*pi*t/4\"\n[loops]\n\
             A = \"Rz(phi) Tx(40) Rz(mu) Tx(100) Rz(nu) Tx(-40) Rz(-theta) Tx(-100)\"\n[guess]\ntheta = {theta}\n\
             mu = {theta}\n"
        ));
        let trajectory = solve(&mechanism, &even_times(&mechanism, 40)).unwrap();
        let chosen = trajectory.events.iter().find_map(|e| match &e.kind {
            EventKind::BranchChosen { taken, others } => {
                Some((e.time, taken.clone(), others.clone()))
            }
            _ => None,
        });
        let (time, taken, found) = chosen.unwrap();
        assert_eq!((time, &found[..]), (0.0, &others.map(String::from)[..]));
        assert_eq!(trajectory.poses().nth(1).unwrap().branch, taken);
    }
}

#[test]
fn the_bound_of_plain_numbers_holds_in_their_own_unit() {
    // Two circles and a diagonal, as equations only: nothing says what a unit is.
    for scale in [f64::exp2(-30.0), 1.0, f64::exp2(28.0)] {
        // All digits of a power of two: the decimal number is the binary one.
        let mechanism = written(&format!(
            "duration = 4\n[parameters]\nk = {scale:.30e}\n[inputs]\nx = \"60*k + 30*k*t/4\"\n[equations]\n\
             c = \"x^2 + y^2 - (100*k)^2\"\nd = \"z - 2*y\"\n[guess]\ny = \"100*k\"\nz = \"80*k\"\n"
        ));
        let trajectory = solve(&mechanism, &even_times(&mechanism, 81)).unwrap();
        for (sample, pose) in trajectory.samples.iter().zip(trajectory.poses()) {
            let Certificate::Certified { error_bound, .. } = pose.certificate else {
                panic!("{:?}", pose.certificate)
            };
            let (x, y) = (sample.inputs[0], unknown(&mechanism, &pose.unknowns, "y"));
            // What x² + y² misses, with the parts that rounding takes off its products.
            let (r, square) = (100.0 * scale, |v: f64| (v * v, v.mul_add(v, -(v * v))));
            let ((xx, dx), (yy, dy), (rr, dr)) = (square(x), square(y), square(r));
            let off = ((yy - (rr - xx)) + (dx + dy - dr)).abs() / (2.0 * y);
            assert!(
                off <= error_bound * (1.0 + 1e-6),
                "{scale}: {off:e} {error_bound:e}"
            );
            assert!(error_bound < 1e-12 * r);
        }
    }
}

#[test]
fn a_small_gap_is_measured_as_well_as_a_large_one() {
    // Two bars of 50 over a base that is longer than both by a share.
    for share in [1e-1, 1e-4, 1e-6, 1e-8] {
        let mechanism = written(&format!(
            "[loops]\nA = \"Rz(a) Tx(50) Rz(b) Tx(50) Rz(c) Tx(-100*(1 + {share}))\"\n[guess]\na = 0.1\nb = -0.2\n"
        ));
        let trajectory = solve(&mechanism, &[0.0]).unwrap();
        let distance = trajectory.events.iter().find_map(|e| match e.kind {
            EventKind::StartNotClosed { distance, .. } => Some(distance),
            _ => None,
        });
        let error = distance.unwrap() / (100.0 * share) - 1.0;
        assert!(error.abs() < 1e-3, "{share}: {error:e}");
    }
}

#[test]
fn the_end_of_a_formula_is_no_singular_pose_that_was_passed() {
    for (equation, last, word) in [
        ("y - sqrt(c)", 0.0, "no-value"),
        ("ln(y) - y + c + 1", 0.0, "fold"),
        ("y - asin(1 - c)", 0.0, "no-value"),
    ] {
        let mechanism = written(&format!(
            "duration = 4\n[inputs]\nc = \"1 - t/2\"\n[equations]\ne = \"{equation}\"\n[guess]\ny = 2\n"
        ));
        let trajectory = solve(&mechanism, &even_times(&mechanism, 81)).unwrap();
        let kinds: Vec<&EventKind> = trajectory.events.iter().map(|e| &e.kind).collect();
        let [EventKind::MotionEnds(ending)] = kinds[..] else {
            panic!("{equation}: {kinds:?}")
        };
        assert_eq!(ending.word(), word, "{equation}");
        let gap = trajectory.gaps[0].from.as_ref().unwrap();
        assert!(
            (gap.inputs[0] - last).abs() < 1e-9,
            "{equation}: {}",
            gap.inputs[0]
        );
        for sample in &trajectory.samples {
            assert_eq!(
                sample.pose.is_some(),
                sample.inputs[0] >= last,
                "{equation} {}",
                sample.time
            );
        }
    }
}
