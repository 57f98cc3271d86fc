//! Poses that are moved and differentiated eight at a time, against the solver of single poses.

use mechanim::analysis::random::Random;
use mechanim::kinematics::abreast::pose_group::PoseGroup;
use mechanim::kinematics::loops::forward::closure_error;
use mechanim::kinematics::motion::continuation::solve_motion;
use mechanim::kinematics::motion::sampling::even_times;
use mechanim::kinematics::solve::pose_solver::PoseSolver;
use mechanim::kinematics::structure::system::System;
use mechanim::numbers::octet::LANES;
use mechanim::scene::{Overrides, builtin, load_scene};
use std::sync::Arc;

/// Calls `test` with every built-in scene that moves, and poses of its motion.
fn each_motion(samples: usize, mut test: impl FnMut(&str, &System, &[Vec<f64>])) {
    for scene in &builtin::ALL {
        let source = builtin::find_builtin(scene.name).unwrap();
        let scene = load_scene(&source, &Overrides::default()).unwrap();
        let Ok(system) = System::new(Arc::clone(&scene.mechanism), &scene.actuation) else {
            continue;
        };
        let times = even_times(&scene.mechanism, &scene.actuation, samples);
        let motion = solve_motion(&system, &scene.actuation, &times);
        let samples = motion.samples.iter();
        let poses: Vec<Vec<f64>> = samples
            .filter_map(|sample| {
                Some([sample.pose.as_ref()?.unknowns.as_slice(), &sample.inputs].concat())
            })
            .collect();
        test(&source.name, &system, &poses);
    }
}

/// Inputs of the poses, each changed by up to `share` of itself.
fn moved(poses: &[Vec<f64>], unknowns: usize, share: f64, seed: u64) -> Vec<Vec<f64>> {
    let changed = |(item, pose): (usize, &Vec<f64>)| {
        let mut random = Random::new(seed, 0, item as u64);
        let inputs = pose[unknowns..].iter();
        inputs
            .map(|input| input + share * random.symmetric() * input.abs().max(0.1))
            .collect()
    };
    poses.iter().enumerate().map(changed).collect()
}

/// The poses after one step of groups of `together`; `None` where it is not trusted.
fn stepped(
    group: &mut PoseGroup,
    (poses, inputs): (&[Vec<f64>], &[Vec<f64>]),
    together: usize,
) -> Vec<Option<Vec<f64>>> {
    let groups = poses.chunks(together).zip(inputs.chunks(together));
    let mut found = Vec::new();
    for (poses, inputs) in groups {
        let trusted = group.step(poses, |lane, k| inputs[lane][k], &[0.0; LANES]);
        found.extend((0..poses.len()).map(|lane| trusted.has(lane).then(|| group.pose(lane))));
    }
    found
}

#[test]
fn a_trusted_step_leads_where_many_small_ones_lead() {
    let mut counts = [[0; 2]; 3];
    each_motion(12, |name, system, poses| {
        let unknowns = system.mechanism().unknowns.len();
        let mut group = PoseGroup::new(system);
        let mut solver = PoseSolver::new(system);
        for (k, share) in [1e-3, 0.03, 0.4].into_iter().enumerate() {
            let inputs = moved(poses, unknowns, share, k as u64);
            let found = stepped(&mut group, (poses, &inputs), LANES);
            for ((pose, inputs), found) in poses.iter().zip(&inputs).zip(&found) {
                counts[k][usize::from(found.is_some())] += 1;
                let Some(found) = found else { continue };
                assert_eq!(found[unknowns..], inputs[..], "{name}");
                assert!(closure_error(system.mechanism(), found) <= 1e-11, "{name}");
                // Sixteen steps of the single solver, shorter where it wants them.
                let mut here = pose.clone();
                let from = pose[unknowns..].to_vec();
                for part in 1..=16 {
                    let along = |share: f64| {
                        let share = (f64::from(part) - 1.0 + share) / 16.0;
                        let pairs = from.iter().zip(inputs);
                        pairs.map(|(a, b)| a + share * (b - a)).collect()
                    };
                    let next = solver.followed(&here[..unknowns], along);
                    here = next.unwrap_or_else(|| panic!("{name}: {part} of {share}"));
                }
                let state = solver.observe(&here);
                let apart = solver.apart(found, &here);
                assert!(
                    apart <= 1e-12 / state.sigma_min.min(1.0),
                    "{name}, {share}: {apart}"
                );
                assert_eq!(state.signs, solver.observe(pose).signs, "{name}");
            }
            // A pose has the same bits alone and in any company.
            for together in [1, 3] {
                assert_eq!(stepped(&mut group, (poses, &inputs), together), found);
            }
        }
    });
    // Small steps are refused where blocks are not square or ball joints are locked, large ones more often.
    let [small, _, large] = counts;
    assert!(
        small[1] > 5 * small[0] && large[0] > 2 * small[0] && large[1] > 100,
        "{counts:?}"
    );
}

#[test]
fn derivatives_are_those_of_the_single_solver() {
    let mut compared = 0;
    each_motion(12, |name, system, poses| {
        let mechanism = system.mechanism();
        let inputs: Vec<usize> = (0..mechanism.inputs.len()).collect();
        let unknowns = mechanism.unknowns.len();
        let mut group = PoseGroup::new(system);
        let found = group.sensitivities(poses, &inputs);
        for (pose, found) in poses.iter().zip(&found) {
            let right = group.sensitivity(pose, &inputs);
            let sigma = group.solver.observe(pose).sigma_min;
            // In scaled unknowns, rounding is as large as the least singular value lets it be.
            let scaled = |column: &[f64]| -> Vec<f64> {
                let entries = column.iter().enumerate();
                entries.map(|(k, d)| d / mechanism.scale_of(k)).collect()
            };
            for (a, b) in found.chunks(unknowns).zip(right.chunks(unknowns)) {
                let (a, b) = (scaled(a), scaled(b));
                let size = b.iter().fold(1.0, |m: f64, v| m.max(v.abs()));
                for (a, b) in a.iter().zip(&b) {
                    let is_same = (a - b).abs() <= 1e-13 * size / (sigma * sigma.min(1.0));
                    assert!(is_same || (a.is_nan() && b.is_nan()), "{name}: {a} {b}");
                    compared += 1;
                }
            }
        }
        let alone: Vec<Vec<f64>> = poses
            .iter()
            .flat_map(|pose| group.sensitivities(std::slice::from_ref(pose), &inputs))
            .collect();
        let bits =
            |all: &[Vec<f64>]| -> Vec<u64> { all.iter().flatten().map(|v| v.to_bits()).collect() };
        assert_eq!(bits(&found), bits(&alone), "{name}");
    });
    assert!(compared > 2000, "{compared}");
}

/// A pose counts as regular only if its smallest singular value is at least what is asked for.
#[test]
fn poses_near_singular_ones_are_left_out() {
    let mut counts = [0; 2];
    each_motion(12, |name, system, poses| {
        let unknowns = system.mechanism().unknowns.len();
        let (mut group, mut solver) = (PoseGroup::new(system), PoseSolver::new(system));
        for (item, poses) in poses.chunks(LANES).enumerate() {
            let inputs = moved(poses, unknowns, 1e-3, 7);
            let mut random = Random::new(3, 1, item as u64);
            let sigmas = poses.iter().map(|pose| solver.observe(pose).sigma_min);
            let least: Vec<f64> = sigmas.map(|s| s * 1.5 * random.unit()).collect();
            let trusted = group.step(poses, |lane, k| inputs[lane][k], &least);
            for (lane, least) in least.iter().enumerate() {
                counts[usize::from(trusted.has(lane))] += 1;
                if trusted.has(lane) {
                    let sigma = solver.observe(&group.pose(lane)).sigma_min;
                    assert!(sigma >= least * (1.0 - 1e-6), "{name}: {sigma} {least}");
                }
            }
        }
    });
    assert!(counts.iter().all(|count| *count > 50), "{counts:?}");
}

/// The planar four-bar with these bars folds where crank and coupler are in line; a step over the fold and poses there are
/// left to the single solver.
#[test]
fn folds_are_not_stepped_over() {
    let text = "units = { length = \"mm\", angle = \"rad\" }\nduration = 1\n[inputs]\nphi = \"t\"\n[loops]\n\
                A = \"Rz(phi) Tx(60) Rz(mu) Tx(30) Rz(nu) Tx(-40) Rz(-theta) Tx(-50)\"\n[guess]\nmu = -2\ntheta = 2\n";
    let source = mechanim::diag::Source {
        name: "rocker".to_owned(),
        text: text.to_owned(),
    };
    let scene = load_scene(&source, &Overrides::default()).unwrap_or_else(|e| panic!("{e}"));
    let system = System::new(Arc::clone(&scene.mechanism), &scene.actuation).unwrap();
    let mut solver = PoseSolver::new(&system);
    // Crank and coupler, rocker and ground close a triangle at this angle at most.
    let fold =
        f64::acos((60.0_f64.powi(2) + 50.0_f64.powi(2) - 70.0_f64.powi(2)) / (2.0 * 60.0 * 50.0));
    let start = [scene.actuation.guess.as_slice(), &[0.9 * fold]].concat();
    let start = solver.assembled(&start, None).unwrap().coordinates;
    let unknowns = start.len() - 1;
    let mut group = PoseGroup::new(&system);
    for before in [1e-2, 1e-4, 1e-6, 1e-8, 1e-10] {
        let near = fold * (1.0 - before);
        let along = |share: f64| vec![start[unknowns] + share * (near - start[unknowns])];
        let Some(pose) = solver.followed(&start[..unknowns], along) else {
            assert!(before < 1e-5, "{before}");
            continue;
        };
        let poses = vec![pose; LANES];
        // Every lane goes further, the last ones beyond the fold.
        let input = |lane: usize| near + fold * before * 0.4 * lane as f64;
        let trusted = group.step(&poses, |lane, _| input(lane), &[0.0; LANES]);
        for lane in 3..LANES {
            assert!(!trusted.has(lane), "{before}: lane {lane}");
        }
        for lane in (0..3).filter(|lane| trusted.has(*lane)) {
            let found = group.pose(lane);
            assert_eq!(
                solver.observe(&found).signs,
                solver.observe(&poses[0]).signs
            );
        }
    }
}
