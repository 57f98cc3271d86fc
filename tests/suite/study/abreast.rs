//! Designs solved eight at a time: each is, bit by bit, what it is in any other company, and within rounding what the
//! ordinary solver makes of it.

use mechanim::analysis::random::Random;
use mechanim::analysis::study::{
    AT_A_TIME, Evaluator, LaneEvaluator, MeasureValues, ParametricMechanism, PoseAnchors,
    Rejection, TrackPoses,
};
use mechanim::analysis::tolerance::{Distribution, SampleBatch, sample_pieces, values_of};
use mechanim::diag::Source;
use mechanim::kinematics::abreast::anchor::AnchorPose;
use mechanim::kinematics::abreast::closing::LaneSolver;
use mechanim::kinematics::loops::forward::closure_error;
use mechanim::kinematics::motion::continuation::solve_motion;
use mechanim::kinematics::motion::sampling::even_times;
use mechanim::kinematics::solve::newton::Pace;
use mechanim::kinematics::solve::pose_solver::PoseSolver;
use mechanim::kinematics::structure::system::System;
use mechanim::numbers::octet::{LANES, LaneMask, Octet};
use mechanim::scene::{Overrides, builtin, load_scene};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

fn varied(source: &Source, names: &[String]) -> ParametricMechanism {
    ParametricMechanism::load(source, &Overrides::default(), names)
        .unwrap_or_else(|e| panic!("{e}"))
}

fn gearshift() -> ParametricMechanism {
    let source = builtin::find_builtin("gearshift").unwrap();
    let dimensions = load_scene(&source, &Overrides::default())
        .unwrap()
        .dimensions;
    varied(&source, &dimensions)
}

fn stand_of(family: &ParametricMechanism) -> TrackPoses {
    Evaluator::new(family).nominal(family.nominal().unwrap().poses)
}

/// Pieces whose dimensions are off by up to `tolerance`.
fn pieces(stand: &TrackPoses, tolerance: f64, count: usize) -> Vec<Vec<f64>> {
    let batch = SampleBatch {
        samples: count,
        first: 0,
        seed: 11,
        distribution: Distribution::Uniform,
        threads: 1,
    };
    let tolerances = vec![tolerance; stand.values.len()];
    let one = |item| values_of(stand, &tolerances, batch, item);
    (0..count).map(one).collect()
}

type Found = Result<MeasureValues, Rejection>;

fn bits(found: &Found) -> Option<Vec<u64>> {
    let measures = found.as_ref().ok()?.measures.iter();
    Some(measures.map(|v| v.to_bits()).collect())
}

/// All designs, so many at a time; and how many were posed by themselves.
fn in_company(
    family: &ParametricMechanism,
    stand: &TrackPoses,
    designs: &[Vec<f64>],
    together: usize,
) -> (Vec<Found>, usize) {
    let anchors = PoseAnchors::new(&Evaluator::new(family), stand);
    let mut lanes = LaneEvaluator::new(Evaluator::new(family), &anchors);
    let groups = designs.chunks(together);
    let found = groups.flat_map(|group| lanes.measure(group)).collect();
    (found, lanes.alone)
}

#[test]
fn a_design_has_the_same_bits_alone_and_in_any_company() {
    let family = gearshift();
    let stand = stand_of(&family);
    // Small ones, some that need several steps, and one that cannot be assembled: some leave their lanes.
    let mut designs = pieces(&stand, 0.5, 40);
    designs.extend(pieces(&stand, 8.0, 40));
    let mut apart = stand.values.clone();
    apart[0] += 5000.0;
    designs.insert(13, apart);
    let (alone, _) = in_company(&family, &stand, &designs, 1);
    assert!(alone[13].is_err());
    for together in [2, 3, 7, AT_A_TIME] {
        let (found, _) = in_company(&family, &stand, &designs, together);
        for (k, (a, b)) in found.iter().zip(&alone).enumerate() {
            assert_eq!(bits(a), bits(b), "{k} of {together}");
        }
    }
    // In another order, so that everybody has other neighbours in other lanes.
    let order: Vec<usize> = (0..designs.len()).map(|k| k * 32 % designs.len()).collect();
    let moved: Vec<Vec<f64>> = order.iter().map(|k| designs[*k].clone()).collect();
    let (found, left) = in_company(&family, &stand, &moved, AT_A_TIME);
    for (k, found) in order.iter().zip(&found) {
        assert_eq!(bits(found), bits(&alone[*k]), "{k}");
    }
    assert!(
        (1..designs.len() / 2).contains(&left),
        "{left} left their lanes"
    );
}

#[test]
fn lanes_give_what_the_ordinary_solver_gives() {
    for name in ["gearshift", "gearshift-optimised"] {
        let source = builtin::find_builtin(name).unwrap();
        let scene = load_scene(&source, &Overrides::default()).unwrap();
        let family = varied(&source, &scene.dimensions);
        let stand = stand_of(&family);
        for tolerance in [0.01, 0.5, 5.0] {
            let designs = pieces(&stand, tolerance, 200);
            let (found, alone) = in_company(&family, &stand, &designs, AT_A_TIME);
            assert!(
                tolerance > 1.0 || alone == 0,
                "{name}: {alone} of {tolerance}"
            );
            let mut evaluator = Evaluator::new(&family);
            for (values, found) in designs.iter().zip(&found) {
                let right = evaluator
                    .approach(&stand, values)
                    .and_then(|there| evaluator.measure(&there));
                let (Ok(found), Ok(right)) = (found, &right) else {
                    assert_eq!(found, &right);
                    continue;
                };
                for (a, b) in found.measures.iter().zip(&right.measures) {
                    // Both close to rounding; measures are differences of coordinates of about 1000 mm.
                    assert!((a - b).abs() <= 1e-11 * b.abs().max(1.0), "{name}: {a} {b}");
                }
            }
        }
    }
}

#[test]
fn pieces_do_not_depend_on_threads_and_cuts() {
    let family = gearshift();
    let stand = stand_of(&family);
    let tolerances = vec![0.5; stand.values.len()];
    let never = AtomicBool::new(false);
    let made = |first: usize, samples: usize, threads: usize| {
        let batch = SampleBatch {
            samples,
            first,
            seed: 5,
            distribution: Distribution::Normal,
            threads,
        };
        sample_pieces(&family, &stand, &tolerances, batch, &never, &|_| {})
    };
    let whole = made(0, 333, 1);
    for threads in [2, 7] {
        assert_eq!(made(0, 333, threads), whole);
    }
    let (one, other) = (made(0, 101, 2), made(101, 232, 1));
    assert_eq!([one.values, other.values].concat(), whole.values);
    assert_eq!(one.digest.wrapping_add(other.digest), whole.digest);
}

/// A four-bar with its coupler as an input: too short a one does not close, and nobody beside it notices.
#[test]
fn a_design_that_does_not_close_leaves_its_neighbours_alone() {
    let text = "units = { length = \"mm\", angle = \"deg\" }\nduration = 4\n[parameters]\nb = 60\n[inputs]\n\
                phi = \"45 + 360*t/4\"\n[loops]\n\
                A = \"Rz(phi) Tx(20) Rz(mu) Tx(b) Rz(nu) Tx(-50) Rz(-theta) Tx(-70)\"\n[guess]\ntheta = 86\n\
                [tracks]\nturn = { samples = 7, inputs = { phi = [45, 315] } }\n[measures]\n\
                swing = { track = \"turn\", of = \"theta\", take = \"range\" }\n[study]\nminimise = \"swing\"\n\
                [study.variables]\nb = { range = [30, 80] }\n";
    let source = Source {
        name: "four-bar".to_owned(),
        text: text.to_owned(),
    };
    let family = varied(&source, &[]);
    let stand = stand_of(&family);
    let group = |odd: f64| -> Vec<Vec<f64>> {
        let value = |k: usize| if k == 3 { odd } else { 60.0 + 0.1 * k as f64 };
        (0..AT_A_TIME).map(|k| vec![value(k)]).collect()
    };
    let (usual, alone) = in_company(&family, &stand, &group(60.3), AT_A_TIME);
    assert_eq!(alone, 0);
    for odd in [5.0, 41.0, 131.0, f64::NAN, f64::INFINITY, -60.0] {
        let (found, alone) = in_company(&family, &stand, &group(odd), AT_A_TIME);
        assert_eq!(alone, 1, "{odd}");
        let mut evaluator = Evaluator::new(&family);
        let own = evaluator
            .approach(&stand, &[odd])
            .and_then(|there| evaluator.measure(&there));
        assert_eq!(bits(&found[3]), bits(&own), "{odd}");
        for k in (0..AT_A_TIME).filter(|k| *k != 3) {
            assert_eq!(bits(&found[k]), bits(&usual[k]), "{odd}: {k}");
        }
    }
    assert!(in_company(&family, &stand, &group(5.0), AT_A_TIME).0[3].is_err());
}

/// Every built-in scene at poses of its motion, with inputs that are off in every lane: closed as by the ordinary solver.
#[test]
fn all_scenes_close_in_lanes() {
    let mut solved = 0;
    for scene in &builtin::ALL {
        let source = builtin::find_builtin(scene.name).unwrap();
        let scene = load_scene(&source, &Overrides::default()).unwrap();
        let Ok(system) = System::new(Arc::clone(&scene.mechanism), &scene.actuation) else {
            continue;
        };
        let times = even_times(&scene.mechanism, &scene.actuation, 5);
        let motion = solve_motion(&system, &scene.actuation, &times);
        for (item, sample) in motion.samples.iter().enumerate() {
            let Some(pose) = &sample.pose else { continue };
            let coordinates = [pose.unknowns.as_slice(), &sample.inputs].concat();
            solved += close_beside(&system, &coordinates, item as u64, &source.name);
        }
    }
    assert!(solved > 200, "{solved}");
}

/// Closes eight poses beside one; the number of lanes that did.
fn close_beside(system: &System, coordinates: &[f64], item: u64, name: &str) -> usize {
    let Some(anchor) = AnchorPose::new(system, coordinates) else {
        return 0;
    };
    let mechanism = system.mechanism();
    let n = mechanism.unknowns.len();
    let mut starts = vec![coordinates.to_vec(); LANES];
    for (lane, start) in starts.iter_mut().enumerate() {
        let mut random = Random::new(2, lane as u64, item);
        for input in &mut start[n..] {
            *input += 1e-3 * random.symmetric() * input.abs().max(0.1);
        }
    }
    let lane = |k: usize| Octet::new(std::array::from_fn(|lane| starts[lane][k]));
    let mut octets: Vec<Octet> = (0..coordinates.len()).map(lane).collect();
    let closed = LaneSolver::new(system).close(&anchor, &mut octets, LaneMask::first(LANES));
    let mut solver = PoseSolver::new(system);
    let mut count = 0;
    for (lane, start) in starts.iter_mut().enumerate() {
        if !closed.lanes.has(lane) {
            continue;
        }
        count += 1;
        let found: Vec<f64> = octets.iter().map(|c| c.lane(lane)).collect();
        assert!(closure_error(mechanism, &found) <= 1e-11, "{name}");
        assert!(solver.correct(start, Pace::Brisk).converged, "{name}");
        // Two poses whose loops close to rounding are as far apart as the least singular value lets them.
        let sigma = solver.observe(start).sigma_min;
        let apart = solver.apart(&found, start);
        assert!(
            apart <= 1e-13 / sigma.min(1.0),
            "{name}: {apart} with {sigma}"
        );
        assert_eq!(
            solver.observe(start).signs,
            solver.observe(coordinates).signs,
            "{name}"
        );
    }
    count
}

/// A planted fault: an anchor of the other assembly. What closes is then beyond a singular pose, and no lane may say that it
/// is beside its anchor.
#[test]
fn a_pose_on_the_other_side_is_not_taken() {
    let source = builtin::find_builtin("four-bar").unwrap();
    let scene = load_scene(&source, &Overrides::default()).unwrap();
    let system = System::new(Arc::clone(&scene.mechanism), &scene.actuation).unwrap();
    let motion = solve_motion(&system, &scene.actuation, &[0.0]);
    let pose = motion.poses().next().unwrap();
    let own = [pose.unknowns.as_slice(), &scene.actuation.inputs_at(0.0)].concat();
    let mut solver = PoseSolver::new(&system);
    let sign = solver.observe(&own).signs;
    let n = pose.unknowns.len();
    let mut other = None;
    for item in 0..200 {
        let mut random = Random::new(4, 0, item);
        let mut start = own.clone();
        start[..n]
            .iter_mut()
            .for_each(|u| *u += 3.0 * random.symmetric());
        if solver.closed(&mut start, Pace::Patient) && solver.observe(&start).signs != sign {
            other = Some(start);
        }
    }
    let other = other.expect("a four-bar has two assemblies");
    let mut lanes = LaneSolver::new(&system);
    for (anchor, pose) in [(&own, &other), (&other, &own)] {
        let wrong = AnchorPose::new(&system, anchor).unwrap();
        let right = AnchorPose::new(&system, pose).unwrap();
        let octets = || pose.iter().map(|c| Octet::splat(*c)).collect::<Vec<_>>();
        let all = LaneMask::first(LANES);
        assert!(!lanes.close(&wrong, &mut octets(), all).lanes.any());
        assert!(lanes.close(&right, &mut octets(), all).lanes.has(7));
    }
}
