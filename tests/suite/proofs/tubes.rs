//! The proof of the motion between samples: it holds what it claims, joins whole turns, and ends where it must.

use crate::draws::Draws;
use crate::driven::{Driven, Model, certify_motion, solve};
use mechanim::diag::Source;
use mechanim::kinematics::certificate::tube::{Prover, Tube};
use mechanim::kinematics::results::certificate::{IntervalCertificate, ProofObstacle, Reason};

use crate::reference::mechanism;
use mechanim::kinematics::results::trajectory::Trajectory;
use mechanim::model::mechanism::{Kind, Mechanism};
use mechanim::scene::{Overrides, builtin, load_scene};
use std::f64::consts::{PI, TAU};

fn read(text: &str) -> Model {
    let source = Source {
        name: "test".into(),
        text: text.into(),
    };
    mechanism(&source, &[])
}

fn scene(name: &str) -> Model {
    let source = builtin::find_builtin(name).unwrap();
    Model::from(load_scene(&source, &Overrides::default()).unwrap())
}

fn slider_crank(r: f64, l: f64) -> Model {
    read(&format!(
        "duration = 4\n[parameters]\nr = {r}\nL = {l}\n[inputs]\nphi = \"2*pi*t/4\"\n\
         [loops]\nA = \"Rz(phi) Tx(r) Rz(alpha) Tx(L) Rz(beta) Tx(-h)\"\n[guess]\nh = {}\n",
        r + l
    ))
}

/// Rocker of length `c`, crank 40, rod and frame 100; in line at half a second and two seconds later.
fn parallelogram(c: f64) -> Model {
    read(&format!(
        "duration = 4\n[inputs]\nphi = \"2*pi*(t - 0.5)/4\"\n\
         [loops]\nA = \"Rz(phi) Tx(40) Rz(a - phi) Tx(100) Rz(b - a) Tx(-{c}) Rz(-b) Tx(-100)\"\n[guess]\nb = -0.785\n"
    ))
}

/// The whole drive in equal steps, both ends included.
fn steps(mechanism: &Model, count: usize) -> Trajectory {
    let time = |k: usize| mechanism.actuation.duration * (k as f64 / count as f64);
    solve(mechanism, &(0..=count).map(time).collect::<Vec<_>>()).unwrap()
}

fn certificates(mechanism: &Model, count: usize) -> Vec<IntervalCertificate> {
    certify_motion(mechanism, &steps(mechanism, count))
}

fn all_certified(certificates: &[IntervalCertificate]) -> usize {
    let refused: Vec<_> = certificates.iter().filter_map(|c| c.refused).collect();
    assert!(refused.is_empty(), "{refused:?}");
    certificates.iter().map(|c| c.tubes).sum()
}

#[test]
fn turns_and_drives_are_certified_as_wholes() {
    let dyads = certificates(&scene("dyads"), 45);
    assert_eq!((dyads.len(), all_certified(&dyads)), (45, 45));
    assert!(
        dyads
            .iter()
            .all(|c| c.radius < 0.25 && c.unique_radius > 0.7)
    );
    all_certified(&certificates(&scene("gearshift"), 120));
    all_certified(&certificates(&slider_crank(40.0, 80.0), 80));
    all_certified(&certificates(&scene("seven-r"), 120));
    // A Bennett loop is over-determined: the rows of its basis are proved.
    let bennett = read(
        "duration = 1\n[parameters]\na = 1\nb = 1.7320508075688772\n[inputs]\nphi = \"1 + t\"\n[loops]\n\
         A = \"Rz(phi) Tx(a) Rx(pi/6) Rz(t2) Tx(b) Rx(pi/3) Rz(t3) Tx(a) Rx(pi/6) Rz(t4) Tx(b) Rx(pi/3)\"\n\
         [guess]\nt2 = 2.7\nt3 = -1\nt4 = -2.7\n",
    );
    all_certified(&certificates(&bennett, 20));
}

#[test]
fn tubes_get_thin_with_the_eighth_power_of_the_step() {
    let mechanism = scene("dyads");
    let radius = |count: usize| {
        let list = certificates(&mechanism, count);
        assert_eq!(all_certified(&list), count);
        list.iter().map(|c| c.radius).fold(0.0, f64::max)
    };
    let order = (radius(30) / radius(60)).log2();
    // The ninth power and more while the test itself needs a part of the radius.
    assert!((7.5..10.5).contains(&order), "{order}");
}

/// Largest distance of a pose from a tube's path, over the tube's radius.
fn share_of_radius(mechanism: &Mechanism, tube: &Tube, truth: &Trajectory) -> f64 {
    let mut largest = 0.0_f64;
    for sample in &truth.samples {
        let pose = sample.pose.as_ref().unwrap();
        for (k, value) in pose.unknowns.iter().enumerate() {
            let mut off = (value - tube.centre(k, sample.time)) / mechanism.scale_of(k);
            if mechanism.unknowns[k].kind == Kind::Angle {
                // A start counts its turns anew.
                off -= TAU * (off / TAU).round();
            }
            largest = largest.max(off.abs() / tube.radius);
        }
    }
    largest
}

/// The start of the first tube, then random times of every tube and its end.
fn moments(tubes: &[Tube], draws: &mut Draws) -> Vec<f64> {
    let mut times = vec![tubes[0].start];
    for tube in tubes {
        let mut inside = vec![tube.end];
        for _ in 0..12 {
            inside.push(tube.start + (tube.end - tube.start) * draws.share());
        }
        inside.sort_by(f64::total_cmp);
        times.extend(inside);
    }
    times
}

/// The motion of many small steps, on the branch that the coarse one is on, at random times of every tube.
#[test]
fn motion_lies_within_its_tubes() {
    // A slotted lever: a slider inside the chain. A cam: a formula of an unknown. A rope and a curve: equations.
    let lever = "duration = 4\n[inputs]\nphi = \"2*pi*t/4\"\n[loops]\n\
                 A = \"Rz(phi) Tx(40) Rz(b - phi) Tx(-s) Rz(-b) Tx(70)\"\n[guess]\ns = 110\n";
    let cam = "duration = 2\n[inputs]\nphi = \"3*t\"\n[loops]\n\
               A = \"Tx(-h) Tx(10 + 2*cos(q) + hypot(sin(q), 1)) Rz(q) Rz(-phi)\"\n[guess]\nh = 13\n";
    let curve = "duration = 2\n[inputs]\nphi = \"sin(t)\"\nl = \"1 + 0.2*t\"\n[loops]\n\
                 A = \"Rz(phi) Rz(q)\"\n[equations]\ncurve = \"r^2 - l^2*(2 + cos(q))\"\n\
                 rope = \"s - 0.5*r*q - 2*l\"\n[guess]\nr = 1.7\n";
    let built_in = ["dyads", "gearshift", "slider-crank", "seven-r"].map(|n| (n, scene(n)));
    let written = [("lever", lever), ("cam", cam), ("curve", curve)].map(|(n, s)| (n, read(s)));
    let mut closest = 0.0_f64;
    for ((name, mechanism), count) in built_in
        .into_iter()
        .chain(written)
        .zip([20, 40, 12, 60, 16, 10, 10])
    {
        let mut closest_here = 0.0_f64;
        let coarse = steps(&mechanism, count);
        let system = mechanism.system().unwrap();
        let mut prover = Prover::new(&system, &mechanism.actuation);
        let mut draws = Draws(0x5eed);
        let mut start = mechanism.clone();
        for pair in coarse.samples.windows(2) {
            let (certificate, tubes) = prover.interval(pair);
            assert!(certificate.refused.is_none(), "{name}");
            assert_eq!(tubes[0].start, pair[0].time);
            assert_eq!(tubes[tubes.len() - 1].end, pair[1].time);
            start.actuation.guess = pair[0].pose.as_ref().unwrap().unknowns.clone();
            let times = moments(&tubes, &mut draws);
            let truth = solve(&start, &times).unwrap();
            let mut rest = truth.samples.as_slice();
            for tube in &tubes {
                let end = rest.partition_point(|s| s.time <= tube.end);
                let inside = Trajectory {
                    samples: rest[..end].to_vec(),
                    ..Trajectory::default()
                };
                rest = &rest[end..];
                let share = share_of_radius(&mechanism, tube, &inside);
                assert!(share <= 1.0, "{name} at {}: {share}", tube.start);
                closest_here = closest_here.max(share);
            }
        }
        assert!(closest_here > 1e-4, "{name}: {closest_here:e}");
        closest = closest.max(closest_here);
    }
    assert!(
        closest > 1e-2,
        "radii far above the truth prove little: {closest:e}"
    );
}

#[test]
fn nothing_is_certified_across_change_points() {
    let singular = ProofObstacle::Test(Reason::Singular);
    for (mechanism, at) in [
        (slider_crank(80.0, 80.0), [1.0, 3.0]),
        (parallelogram(40.0), [0.5, 2.5]),
    ] {
        // Samples on the change points, and beside them.
        for count in [80, 81, 83] {
            for (k, certificate) in certificates(&mechanism, count).iter().enumerate() {
                let step = mechanism.actuation.duration / count as f64;
                let (from, to) = (k as f64 * step, (k + 1) as f64 * step);
                let near = |t: f64| t >= from - 1e-9 && t <= to + 1e-9;
                let crosses = at.into_iter().any(near);
                let refusal = certificate.refused;
                assert_eq!(refusal.is_some(), crosses, "{count} {k}: {refusal:?}");
                if let Some(refusal) = refusal {
                    assert_eq!(refusal.obstacle, singular, "{count} {k}");
                    assert!(at.iter().any(|t| (refusal.time - t).abs() <= 1.1 * step));
                }
            }
        }
    }
}

#[test]
fn close_assemblies_are_told_apart() {
    // How far the rocker is from half a turn at half a turn of the crank, on either assembly.
    for (defect, apart) in [
        (1e-3, 0.037_776_031_398_6),
        (1e-6, 0.001_195_227_963_34),
        (1e-9, 3.779_644_728_05e-5),
    ] {
        let almost = parallelogram(40.0 * (1.0 + defect));
        let trajectory = steps(&almost, 80);
        let certificates = certify_motion(&almost, &trajectory);
        let tubes = all_certified(&certificates);
        assert!(
            tubes > 80,
            "{defect}: the narrow places need short tubes: {tubes}"
        );
        let pose = trajectory.samples[50].pose.as_ref().unwrap();
        let b = pose.unknowns[1].rem_euclid(TAU) - PI;
        assert!((b.abs() - apart).abs() < 1e-9, "{defect}: {b}");
    }
}

#[test]
fn jumps_between_certified_samples_are_seen() {
    let mechanism = scene("slider-crank");
    let mut trajectory = steps(&mechanism, 60);
    // The crossed assembly at the same inputs.
    let phi = trajectory.samples[20].inputs[0];
    let beta = PI - (0.5 * phi.sin()).asin();
    let mut other = mechanism.clone();
    other.actuation.guess = vec![-phi - beta, beta, -40.0];
    let there = solve(&other, &[trajectory.samples[20].time]).unwrap();
    let crossed = there.samples[0].clone();
    assert!(crossed.pose.as_ref().unwrap().unknowns[2] < 0.0);
    trajectory.samples[20] = crossed;
    let certificates = certify_motion(&mechanism, &trajectory);
    let refused: Vec<usize> = (0..60)
        .filter(|k| certificates[*k].refused.is_some())
        .collect();
    assert_eq!(refused, [19, 20]);
}

#[test]
fn drives_that_jump_or_have_no_rate_are_refused_there_and_only_there() {
    let base =
        "[loops]\nA = \"Rz(phi) Tx(40) Rz(alpha) Tx(80) Rz(beta) Tx(-h)\"\n[guess]\nh = 120\n";
    let with = |drive: &str| read(&format!("duration = 2\n[inputs]\nphi = {drive}\n{base}"));
    for (drive, refused) in [
        (
            "{ keys = [[0, 0], [0.95, 1], [2, 0.4]], ease = \"linear\" }",
            None,
        ),
        (
            "{ keys = [[0, 0], [0.95, 1], [2, 0.4]], ease = \"smooth\" }",
            None,
        ),
        (
            "{ keys = [[0, 0], [0.95, 1], [2, 0.4]], ease = \"smoother\" }",
            None,
        ),
        (
            "\"0.5*sin(3*t) + 0.1*exp(-t) + sqrt(t + 1) + atan2(t, 2) + ln(t + 2)\"",
            None,
        ),
        (
            "\"hypot(t, 1) + 0.1*cos(t)^3 + tan(t/4) + asin(t/4) - acos(t/5) + 2^t\"",
            None,
        ),
        (
            "{ keys = [[0, 0], [0.95, 0.001], [2, 0.4]], ease = \"step\" }",
            Some((9, 0.95)),
        ),
        ("\"abs(t - 0.95)\"", None),
        ("\"max(t, 0.95)\"", None),
        ("\"sqrt((t - 0.95)^2)\"", Some((9, 0.95))),
        ("\"0.001*mod(t, 0.95)\"", Some((9, 0.95))),
    ] {
        let mechanism = with(drive);
        let certificates = certificates(&mechanism, 20);
        let list: Vec<(usize, f64)> = (0..20)
            .filter_map(|k| certificates[k].refused.map(|r| (k, r.time)))
            .collect();
        match refused {
            None => assert!(list.is_empty(), "{drive}: {list:?}"),
            Some((interval, time)) => {
                assert!(
                    matches!(list[..], [(k, t), ..] if k == interval && (t - time).abs() < 1e-3),
                    "{drive}: {list:?}"
                );
                let obstacle = certificates[interval].refused.unwrap().obstacle;
                assert_eq!(obstacle, ProofObstacle::Drive, "{drive}");
            }
        }
    }
}

#[test]
fn missing_poses_and_formulas_are_named() {
    // The rod is shorter than the crank: no pose from 48.6 to 131.4 degrees.
    let mechanism = slider_crank(80.0, 60.0);
    let trajectory = steps(&mechanism, 40);
    let certificates = certify_motion(&mechanism, &trajectory);
    for (k, certificate) in certificates.iter().enumerate() {
        let both = (k..k + 2).all(|i| trajectory.samples[i].pose.is_some());
        let refusal = certificate.refused.map(|r| r.obstacle);
        let expected = (!both).then_some(ProofObstacle::NoPose);
        assert_eq!(refusal, expected, "{k}");
    }
    // A cam: the follower's lift is a formula of its angle.
    let cam = |lift: &str| {
        read(&format!(
            "duration = 2\n[inputs]\nphi = \"3*t\"\n[loops]\nA = \"Tx(-h) Tx({lift}) Rz(q) Rz(-phi)\"\n[guess]\nh = 12\n"
        ))
    };
    all_certified(&certificates_of(&cam("10 + 2*cos(q)")));
    let kinked = certificates_of(&cam("10 + 2*abs(sin(q))"));
    let refused: Vec<usize> = (0..20).filter(|k| kinked[*k].refused.is_some()).collect();
    assert_eq!(
        refused,
        [0, 10],
        "q starts on a kink, and half a turn lies between 3.0 and 3.3"
    );
    let reason = kinked[10].refused.unwrap().obstacle;
    assert_eq!(reason, ProofObstacle::Test(Reason::Formula));
}

fn certificates_of(mechanism: &Model) -> Vec<IntervalCertificate> {
    certificates(mechanism, 20)
}

/// The pose in the middle of a long stretch may be far from the line between its ends; the motion leads there all the same.
#[test]
fn long_stretches_of_regular_motions_are_followed() {
    let model = read(
        "duration = 2\n[inputs]\nphi = \"4*t + 0.3\"\n[loops]\n\
         A = \"Rz(phi) Tx(0.7804) Rz(al) Tx(0.8194) Rz(be) Tx(-h)\"\n[guess]\nh = 1.53\n",
    );
    for samples in 2..=12 {
        let time = |k: usize| 2.0 * k as f64 / (samples - 1) as f64;
        let trajectory = solve(&model, &(0..samples).map(time).collect::<Vec<_>>()).unwrap();
        assert_eq!(trajectory.missing(), 0);
        for interval in certify_motion(&model, &trajectory) {
            assert!(interval.refused.is_none(), "{samples}: {interval:?}");
        }
    }
}
