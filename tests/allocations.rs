//! Allocations: none for a pose once the buffers stand, a small constant for a sample of a solved motion.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "suite/driven/mod.rs"]
#[allow(dead_code)]
mod driven;

use allocation_counter::measure;
use driven::{Driven, Model, even_times, solve};
use mechanim::diag::Source;
use mechanim::kinematics::certificate::Certifier;

use mechanim::kinematics::solve::branch::BranchWatch;
use mechanim::kinematics::solve::newton::{Corrector, Pace};
use mechanim::kinematics::solve::predictor::{HIGHEST_ORDER, Predictor};

use mechanim::scene::{Overrides, builtin, load_scene};

fn read(source: &Source) -> Model {
    Model::from(load_scene(source, &Overrides::default()).unwrap())
}

fn mechanisms() -> Vec<Model> {
    let bennett = Source {
        name: "Bennett, six equations for three unknowns".into(),
        text: "duration = 1\n[parameters]\na = 1\nb = 1.7320508075688772\n[inputs]\nphi = \"1+t/10\"\n[loops]\n\
               A = \"Rz(phi) Tx(a) Rx(pi/6) Rz(t2) Tx(b) Rx(pi/3) Rz(t3) Tx(a) Rx(pi/6) Rz(t4) Tx(b) Rx(pi/3)\"\n\
               [guess]\nt2 = 2.7\nt3 = -1\nt4 = -2.7\n"
            .into(),
    };
    let formula = Source {
        name: "an equation that is not affine".into(),
        text: "duration = 1\n[inputs]\nphi = \"1+t/10\"\n[loops]\n\
               quad = \"Rz(q) Tx(40) Rz(a) Tx(100) Rz(b) Tx(70) Rz(c) Tx(-90)\"\n\
               [equations]\nhold = \"q - sin(phi)/3\"\n[guess]\nq = 0.3\na = 0.3\nb = -1\n"
            .into(),
    };
    let built_in =
        ["gearshift", "slider-crank", "seven-r"].map(|n| builtin::find_builtin(n).unwrap());
    built_in
        .iter()
        .chain([&bennett, &formula])
        .map(read)
        .collect()
}

#[test]
fn a_pose_allocates_nothing_once_the_buffers_stand() {
    for mechanism in mechanisms() {
        let system = mechanism.system().unwrap();
        let trajectory = solve(&mechanism, &even_times(&mechanism, 60)).unwrap();
        assert_eq!(trajectory.missing(), 0);
        let first = &trajectory.samples[0];
        let mut here = [&first.pose.as_ref().unwrap().unknowns[..], &first.inputs].concat();
        let mut corrector = Corrector::new(&system);
        let mut predictor = Predictor::default();
        let mut watch = BranchWatch::default();
        let mut certifier = Certifier::new(&system);
        let mut state = watch.observe(&system, &mut corrector, &here);
        let (mut certified, mut iterations) = (0, 0);
        let is_formula = mechanism.equations.len() == 1;
        let mut pose = |inputs: &[f64]| {
            predictor.predict(&system, &mut corrector, &mut here, inputs, HIGHEST_ORDER);
            let correction = corrector.correct(&system, &mut here, Pace::Brisk);
            assert!(correction.converged);
            iterations += correction.iterations;
            watch.observe_into(&system, &mut corrector, &here, &mut state);
            // Proofs of formulas are made with intervals, whose lists come and go.
            if !is_formula {
                let certificate = certifier.polish(&mut here, &[], watch.bases(), &corrector);
                certified += u32::from(certificate.bounds().is_some());
            }
        };
        // The buffers grow with the first poses.
        trajectory.samples[1..4]
            .iter()
            .for_each(|s| pose(&s.inputs));
        let counted = measure(|| {
            trajectory.samples[4..].iter().for_each(|s| pose(&s.inputs));
        });
        assert_eq!(counted.count_total, 0, "{}", mechanism.title);
        assert!(iterations >= 59, "{}", mechanism.title);
        let all = trajectory.samples.len() as u32 - 1;
        assert_eq!(
            certified,
            if is_formula { 0 } else { all },
            "{}",
            mechanism.title
        );
    }
}

#[test]
fn a_sample_allocates_no_more_than_it_keeps_and_a_few_buffers() {
    /// Eight lists that a sample keeps, and what they are made from.
    const MOST: u64 = 25;
    // Proofs of formulas are made with intervals, whose lists come and go.
    for mechanism in mechanisms().into_iter().filter(|m| m.equations.is_empty()) {
        let count = |samples: usize| {
            let times = even_times(&mechanism, samples);
            measure(|| drop(solve(&mechanism, &times).unwrap())).count_total
        };
        let (few, many) = (count(100), count(300));
        let each = (many - few) / 200;
        assert!(each <= MOST, "{}: {each} a sample", mechanism.title);
    }
}
