//! Equations beyond the number of unknowns: nothing is certified that rests on numbers, nothing passes that does not close,
//! and what closes to rounding is said to do so, with a bound.

use crate::driven::{Model, certify_motion, solve};
use crate::program;
use crate::reference::{hard, mechanism, slot, turned};
use mechanim::diag::Source;
use mechanim::kinematics::results::certificate::{Certificate, IntervalCertificate};
use mechanim::kinematics::results::trajectory::{ClosedPose, Trajectory};
use std::f64::consts::FRAC_PI_6;

fn read(text: &str) -> Model {
    let name = "test".to_owned();
    let text = text.to_owned();
    mechanism(&Source { name, text }, &[])
}

/// A Bennett loop of twists 30 and `beta` degrees over a turn; its longer bars are too long by `defect`.
fn bennett_scene(beta: f64, defect: f64) -> String {
    let b = beta.to_radians().sin() / FRAC_PI_6.sin() + defect;
    format!(
        "duration = 1\n[inputs]\nphi = \"1 + 2*pi*t\"\n[loops]\n\
         A = \"Rz(phi) Tx(1) Rx(pi/6) Rz(t2) Tx({b:?}) Rx({beta}*pi/180) Rz(t3) Tx(1) Rx(pi/6) Rz(t4) Tx({b:?}) Rx({beta}*pi/180)\"\n\
         [guess]\nt2 = 2.6\nt3 = -1\nt4 = -2.6\n"
    )
}

/// A parallelogram of cranks of 40 with a third crank in the middle, whose length is a drive.
fn third_crank(length: &str) -> String {
    format!(
        "duration = 4\n[inputs]\nphi = \"0.5 + 0.2*t\"\nl = \"{length}\"\n[loops]\n\
         A = \"Rz(phi) Tx(40) Rz(a - phi) Tx(100) Rz(b - a) Tx(-40) Rz(-b) Tx(-100)\"\n\
         B = \"Rz(phi) Tx(40) Rz(a - phi) Tx(50) Rz(c - a) Tx(-l) Rz(-c) Tx(-50)\"\n\
         [guess]\nb = 0.5\nc = 0.5\n"
    )
}

/// A four-bar linkage with these factors at the end of its chain.
fn four_bar(end: &str) -> String {
    format!(
        "duration = 4\n[inputs]\nphi = \"2*pi*t/4\"\n[loops]\n\
         A = \"Rz(phi) Tx(30) Rz(p) Tx(100) Rz(q) Tx(-80) Rz(r) Tx(-100) {end}\"\n[guess]\np = 0.5\nq = 1\nr = -1.5\n"
    )
}

/// A follower whose height two cams say, which agree at whole times but for rounding.
fn two_cams(difference: &str) -> String {
    format!(
        "duration = 4\n[inputs]\nphi = \"pi/4*t\"\n[loops]\nA = \"Tx(-h) Tx(10 + 2*cos(phi))\"\n\
         [equations]\nsecond = \"h - 10 - 2*cos(phi) - {difference}*sin(4*phi)\"\n[guess]\nh = 12\n"
    )
}

fn word(pose: &ClosedPose) -> &'static str {
    match pose.certificate {
        Certificate::Certified { .. } => "certified",
        Certificate::Consistent { .. } => "consistent",
        Certificate::Locked { .. } => "locked",
        Certificate::Refused { reason } => reason.word(),
    }
}

/// The drive in equal steps, both ends included, with the proofs between.
fn proved(model: &Model, steps: usize) -> (Trajectory, Vec<IntervalCertificate>) {
    let time = |k: usize| model.actuation.duration * (k as f64 / steps as f64);
    let trajectory = solve(model, &(0..=steps).map(time).collect::<Vec<_>>()).unwrap();
    let intervals = certify_motion(model, &trajectory);
    (trajectory, intervals)
}

#[test]
fn every_pose_and_interval_gets_the_word_that_is_true() {
    let (consistent, certified) = ("consistent", "certified");
    // Name, scene, steps, word of the samples, whether the intervals hold.
    let cases = [
        ("bennett", bennett_scene(87.0, 0.0), 80, consistent, true),
        (
            "wide bennett",
            bennett_scene(60.0, 0.0),
            40,
            consistent,
            true,
        ),
        (
            "long bennett",
            bennett_scene(87.0, 1e-12),
            80,
            "open",
            false,
        ),
        (
            "short bennett",
            bennett_scene(87.0, -1e-12),
            20,
            "open",
            false,
        ),
        ("third crank", third_crank("40"), 20, consistent, true),
        // Too long between the samples: by as much as a solver sees, and by less.
        (
            "open crank",
            third_crank("40 + sin(pi*t)^2"),
            4,
            consistent,
            false,
        ),
        (
            "long crank",
            third_crank("40 + 1e-10*sin(pi*t)^2"),
            4,
            consistent,
            false,
        ),
        (
            "decimal crank",
            third_crank("40.1 - 0.1 + 1e-10*sin(pi*t)^2"),
            4,
            consistent,
            false,
        ),
        ("cams", two_cams("0"), 4, consistent, true),
        ("open cams", two_cams("0.001"), 4, consistent, false),
        ("almost cams", two_cams("1e-11"), 4, consistent, false),
        ("four-bar", four_bar(""), 20, certified, true),
        (
            "decimal four-bar",
            four_bar("Tx(0.1) Tx(-0.1)"),
            20,
            certified,
            true,
        ),
        ("flat four-bar", four_bar("Tz(0)"), 20, certified, true),
        ("lifted four-bar", four_bar("Tz(1e-11)"), 20, "open", false),
        (
            "lifted by folding",
            four_bar("Tz(100.00000000001) Tz(-100)"),
            20,
            "open",
            false,
        ),
        // Closed but for the digits of its dimensions, which no axis says.
        (
            "turned four-bar",
            four_bar("Rx(0.3) Rx(-0.1) Rx(-0.2)"),
            20,
            consistent,
            true,
        ),
    ];
    for (name, scene, steps, expected, holds) in cases {
        let (trajectory, intervals) = proved(&read(&scene), steps);
        assert_eq!(trajectory.missing(), 0, "{name}: {:?}", trajectory.events);
        for (sample, pose) in trajectory.samples.iter().zip(trajectory.poses()) {
            // Where a Bennett loop lies flat, it closes with bars of any length.
            let flat = name.ends_with("bennett") && sample.inputs[0].sin().abs() < 0.1;
            let allowed = word(pose) == expected || (flat && word(pose) == consistent);
            assert!(
                allowed,
                "{name}: {} {:?}",
                sample.inputs[0], pose.certificate
            );
        }
        for interval in &intervals {
            assert_eq!(interval.refused.is_none(), holds, "{name}: {interval:?}");
            assert!(
                !holds || interval.word() == expected,
                "{name}: {interval:?}"
            );
        }
    }
}

/// tan(t1/2) tan(t2/2) = sin((beta + alpha)/2) / sin((beta - alpha)/2), opposite angles are equal.
#[test]
fn consistent_poses_of_bennett_are_those_of_its_closed_form() {
    let (alpha, beta) = (FRAC_PI_6, 87.0_f64.to_radians());
    let model = read(&bennett_scene(87.0, 0.0));
    let (trajectory, intervals) = proved(&model, 80);
    let ratio = (0.5 * (beta + alpha)).sin() / (0.5 * (beta - alpha)).sin();
    let t2 = slot(&model, "t2");
    for sample in &trajectory.samples {
        let (sin, cos) = (0.5 * sample.inputs[0]).sin_cos();
        let exact = 2.0 * (ratio * cos).atan2(sin);
        let pose = sample.pose.as_ref().unwrap();
        assert!(turned(pose.unknowns[t2] - exact) < 1e-13);
        let closes_to = pose.certificate.closes_to().unwrap();
        assert!((1e-17..1e-13).contains(&closes_to), "{closes_to:e}");
    }
    for interval in &intervals {
        let closes_to = interval.closes_to.unwrap();
        assert!((1e-17..2e-11).contains(&closes_to), "{closes_to:e}");
    }
}

#[test]
fn overconstrained_rings_are_consistent_all_the_way() {
    for (scene, steps) in [("h11-bennett", 90), ("h13-bricard", 90), ("h15-sarrus", 40)] {
        let (trajectory, intervals) = proved(&hard(scene, &[]), steps);
        for pose in trajectory.poses() {
            let word = word(pose);
            assert!(
                word == "consistent" || pose.sigma_min < 1e-4,
                "{scene}: {word}"
            );
        }
        let proved = intervals.iter().filter(|i| i.refused.is_none()).count();
        assert!(proved + 2 >= steps, "{scene}: {proved} of {steps}");
    }
}

/// A gap that is far below what closing asks for fails the check, and the table says so.
#[test]
fn open_rows_fail_the_check_and_stand_in_the_table() {
    let workspace = program::Workspace::new();
    for (name, scene, code, status) in [
        ("good.toml", bennett_scene(87.0, 0.0), 0, "consistent"),
        ("long.toml", bennett_scene(87.0, 1e-12), 1, "open"),
        ("flat.toml", four_bar(""), 0, "ok"),
        ("lifted.toml", four_bar("Tz(1e-11)"), 1, "open"),
    ] {
        workspace.write(name, scene);
        for certify in ["pose", "motion"] {
            let check = ["check", name, "--samples", "12", "--certify", certify];
            workspace.run(&check).exits(code);
        }
        let table = workspace.run(&["solve", name, "--samples", "5", "-o", "-"]);
        let table = match status {
            "open" => table.says(&["5 of 5 samples are open: redundant equations do not hold"]),
            _ => table.says_nothing(),
        };
        let text = table.exits(code).text();
        let mut rows = text
            .lines()
            .filter(|l| l.starts_with(|c: char| c.is_ascii_digit()));
        assert!(rows.all(|l| l.ends_with(status)), "{text}");
        assert_eq!(text.contains("closes_to"), status != "ok", "{text}");
    }
}
