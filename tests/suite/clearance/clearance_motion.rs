//! Clearances over the motion: least distances against dense samples, bounds that hold, pairs that are excluded,
//! mutated scenes that fail with the right pair.

use crate::driven::{Driven, Model, check, even_times, frame_times, knots, solve};
use mechanim::clearance::check::{ClearanceReport, Judgement, PairReport};
use mechanim::diag::Source;
use mechanim::distance::bodies::{BodyElements, LeftOut, nearest_bodies};

use mechanim::kinematics::motion::sampling::samples_at;
use mechanim::kinematics::results::trajectory::{ClosedPose, Trajectory};
use mechanim::scene::{Overrides, Scene, load_scene};

fn open(text: &str) -> Scene {
    let source = Source {
        name: "test".into(),
        text: text.into(),
    };
    load_scene(&source, &Overrides::default()).unwrap_or_else(|e| panic!("{:#?}", e.diagnostics))
}

fn builtin(name: &str) -> String {
    mechanim::scene::builtin::find_builtin(name).unwrap().text
}

fn data(name: &str) -> String {
    std::fs::read_to_string(format!("{}/tests/data/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

fn report(scene: &Scene, samples: usize, tolerance: f64) -> ClearanceReport {
    let times = even_times(scene, samples);
    let trajectory = solve(scene, &knots(scene, &times)).unwrap();
    check(scene, &trajectory, tolerance)
}

fn names(scene: &Scene, p: &PairReport) -> [String; 2] {
    p.pair.map(|k| scene.mechanism.bodies[k].name.clone())
}

/// Distance of two bodies at every pose.
fn distances(
    scene: &Scene,
    pair: [usize; 2],
    trajectory: &Trajectory,
) -> impl Iterator<Item = f64> {
    let hulls = pair.map(|k| BodyElements::new(&scene.mechanism.bodies[k]).unwrap());
    let at = move |pose: &ClosedPose| {
        let a_from_b = pose.bodies[pair[0]].inverse() * pose.bodies[pair[1]];
        let found = nearest_bodies(&hulls[0], &hulls[1], &a_from_b, &LeftOut::new()).unwrap();
        found.proximity.distance
    };
    trajectory.poses().map(at)
}

/// Least and largest distance of two bodies over all poses.
fn dense(scene: &Scene, pair: [usize; 2], trajectory: &Trajectory) -> [f64; 2] {
    distances(scene, pair, trajectory).fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], d| {
        [low.min(d), high.max(d)]
    })
}

#[test]
fn bars_of_the_dyad_mechanism_come_as_near_as_known() {
    let scene = open(&data("dyad-bars.toml"));
    for samples in [15, 30, 120] {
        let report = report(&scene, samples, 1e-3);
        let least = &report.judged[0].least;
        // Two radii of 1 less than the distance of the bars' centre lines, 4.710267.
        assert!(
            (least.distance - 2.710_267).abs() < 2e-4,
            "{}",
            least.distance
        );
        assert!(least.is_certified && least.is_refined, "{least:?}");
        assert!(
            least.bound <= 2.710_268 && least.bound > 2.710_267 * 0.99,
            "{least:?}"
        );
    }
}

/// At the frames of the scene, and at so few samples that the branch and bound has all to find.
#[test]
fn bounds_hold_against_dense_samples() {
    let scenes = [
        "gearshift",
        "slider-crank",
        "dyads",
        "sphere-torus",
        "torus-torus",
    ];
    let texts = scenes.map(|name| (name, builtin(name)));
    for (name, text) in texts.into_iter().chain([("bars", data("dyad-bars.toml"))]) {
        let scene = open(&text);
        let truth = solve(&scene, &even_times(&scene, 10_000)).unwrap();
        let touching = &scene.clearance.as_ref().unwrap().touching;
        let reports = [120, 40].map(|samples| report(&scene, samples, 1e-3));
        // Of neighbours some shapes do not count.
        let is_whole = |p: &&PairReport| reports[0].excluded.iter().all(|q| q.pair != p.pair);
        for p in reports[0].judged.iter().filter(is_whole) {
            let [low, high] = dense(&scene, p.pair, &truth);
            let pair = names(&scene, p);
            for report in &reports {
                let p = report.judged.iter().find(|q| q.pair == p.pair).unwrap();
                let least = &p.least;
                assert!(
                    least.bound <= low,
                    "{name} {pair:?}: {} > {low}",
                    least.bound
                );
                if touching.contains(&p.pair) {
                    assert!(least.is_certified, "{name} {pair:?}: {least:?}");
                    assert!(
                        p.known_farthest().unwrap() >= high,
                        "{name} {pair:?}: {p:?}"
                    );
                } else if least.distance > 0.0 {
                    assert!(least.is_certified, "{name} {pair:?}: {least:?}");
                    assert!(least.is_refined, "{name} {pair:?}: {least:?}");
                    assert!(least.bound >= 0.99 * low, "{name} {pair:?}: {least:?}");
                    // The poses of the report are others than those of the dense samples.
                    assert!(least.distance >= least.bound, "{name} {pair:?}: {least:?}");
                    assert!(least.distance <= 1.01 * low, "{name} {pair:?}: {least:?}");
                }
            }
        }
    }
}

/// Every stretch's claims at many poses within it: arguments of joints against a solved motion.
#[test]
fn joints_stay_within_their_bounds() {
    use mechanim::clearance::motion::ProvedMotion;

    let scene = open(&builtin("gearshift"));
    let mechanism = &Model::from(scene.clone());
    let system = mechanism.system().unwrap();
    let times = knots(mechanism, &even_times(mechanism, 120));
    let mut motion = ProvedMotion::new(
        &system,
        &mechanism.actuation,
        &solve(mechanism, &times).unwrap(),
    );
    let (mut proved, mut closest) = (0, 0.0_f64);
    for root in (0..motion.roots).step_by(7) {
        let halves = motion.halves(root).unwrap();
        for k in [root, halves[0], halves[1]] {
            let stretch = motion.stretches[k].clone();
            assert!(stretch.is_certified);
            proved += 1;
            let (from, to) = (stretch.start, stretch.end);
            let times: Vec<f64> = (0..=20)
                .map(|i| from + (to - from) * f64::from(i) / 20.0)
                .collect();
            let start: Vec<f64> = [0.0]
                .into_iter()
                .chain(even_times(mechanism, 480))
                .filter(|t| *t < from)
                .collect();
            let trajectory = solve(mechanism, &[start.clone(), times].concat()).unwrap();
            for sample in &trajectory.samples[start.len()..] {
                let pose = sample.pose.as_ref().unwrap();
                let values =
                    mechanism.argument_values(&[pose.unknowns.as_slice(), &sample.inputs].concat());
                let s = (2.0 * sample.time - from - to) / (to - from);
                for (model, there) in stretch.arguments.iter().zip(&values) {
                    let off = (model.about(s, 1.0)[0] - there.value).abs();
                    let rounding = 1e-13 * (1.0 + there.value.abs());
                    assert!(
                        off <= model.rest + rounding,
                        "{off} at {}: {model:?}",
                        sample.time
                    );
                    closest = closest.max(off / (model.rest + rounding));
                }
            }
        }
    }
    assert!(proved > 20, "{proved}");
    assert!(
        closest > 1e-3,
        "bounds far above the truth prove little: {closest:e}"
    );
}

const THIN_AND_FAST: &str = r#"
title = "A thin arm that flies past a thin pin"
units = { length = "mm", angle = "rad" }
duration = 1
[inputs]
a = "20*t"
b = 0
[[bodies]]
name = "arm"
frame = "Rz(a) Tx(1) Rz(b)"
shapes = [{ capsule = { from = [10, 0, 0], to = [100, 0, 0], radius = 0.2 } }]
[[bodies]]
name = "pin"
frame = "Rz(1.234)"
shapes = [{ capsule = { from = [90, 0, -5], to = [90, 0, 5], radius = 0.2 } }]
[[bodies]]
name = "hub"
shapes = [{ cylinder = { from = [0, 0, -1], to = [0, 0, 1], radius = 5 } }]
[clearance]
minimum = 0.1
"#;

#[test]
fn a_thin_fast_pair_between_two_samples_is_caught() {
    let scene = open(THIN_AND_FAST);
    let report = report(&scene, 5, 1e-3);
    let sampled = report.judged[0]
        .distances
        .iter()
        .copied()
        .fold(f64::INFINITY, f64::min);
    assert!(sampled > 5.0, "the samples miss it: {sampled}");
    let worst = &report.judged[0];
    assert_eq!(worst.judgement, Judgement::Failed);
    assert_eq!(names(&scene, worst), ["arm", "pin"]);
    let passes = [
        1.234 / 20.0,
        (1.234 + std::f64::consts::TAU) / 20.0,
        (1.234 + 2.0 * std::f64::consts::TAU) / 20.0,
    ];
    assert!(
        passes.iter().any(|t| (worst.least.time - t).abs() < 1e-3),
        "{}",
        worst.least.time
    );
    // Two joints lie between arm and hub; pin and hub are one part.
    assert_eq!(report.judged.len(), 2);
    let joints: Vec<_> = report
        .excluded
        .iter()
        .map(|p| p.judgement.clone())
        .collect();
    assert_eq!(joints, [Judgement::Neighbours("one rigid part")]);
}

#[test]
fn neighbours_of_the_gearshift() {
    let scene = open(&builtin("gearshift"));
    let report = report(&scene, 12, 1.0);
    let mut found: Vec<String> = report
        .excluded
        .iter()
        .map(|p| {
            let [a, b] = names(&scene, p);
            let Judgement::Neighbours(joint) = p.judgement else {
                panic!("{p:?}")
            };
            format!("{a} - {b}: {joint}")
        })
        .collect();
    found.sort();
    assert_eq!(
        found,
        [
            "cardan arm - pull rod: revolute joint",
            "coupler - gear lever: revolute joint",
            "coupler - short link: spherical joint",
            "frame - gear lever: spherical joint",
            "frame - rocker: revolute joint",
            "frame - shaft: cylindrical joint",
            "pull rod - rocker: spherical joint",
            "pull rod - short link: universal joint",
            "rocker - coupler: spherical joint",
            "shaft - cardan arm: revolute joint",
        ]
    );
}

/// What is left out from one pose to the next changes nothing: not the distances of judged pairs at any sample, not the least
/// of those at which excluded pairs, which overlap, are looked at.
#[test]
fn distances_are_those_of_every_pose_alone() {
    for (name, samples) in [("gearshift", 24), ("seven-r", 24), ("dyads", 12)] {
        let scene = open(&builtin(name));
        let times = knots(&scene, &even_times(&scene, samples));
        assert!(times.len() >= samples);
        let trajectory = solve(&scene, &times).unwrap();
        let _rules = scene.clearance.as_ref().unwrap();
        let report = check(&scene, &trajectory, 1.0);
        let rounding = 1e-12 * scene.mechanism.size;
        // Of neighbours some shapes do not count.
        let has = |list: &[PairReport], p: &PairReport| list.iter().any(|q| q.pair == p.pair);
        for p in report.judged.iter().filter(|p| !has(&report.excluded, p)) {
            let alone: Vec<f64> = distances(&scene, p.pair, &trajectory).collect();
            assert_eq!(alone.len(), p.distances.len());
            let pairs = alone.iter().zip(&p.distances);
            let off = pairs.fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
            assert!(off < rounding, "{name} {:?}: {off:e}", p.pair);
        }
        for p in report.excluded.iter().filter(|p| !has(&report.judged, p)) {
            // Between the samples they may be deeper: the least that is told is of the whole motion.
            let least = distances(&scene, p.pair, &trajectory).fold(f64::INFINITY, f64::min);
            let allowed = 1e-10 * scene.mechanism.size + rounding;
            assert!(p.least.distance <= least + allowed, "{name} {:?}", p.pair);
        }
        assert!(report.excluded.iter().any(|p| p.least.distance < -1.0));
    }
}

/// What is changed in a scene, and the pair that must fail then.
#[test]
fn mutated_scenes_fail_with_the_right_pair() {
    let swap = |text: &str, from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    };
    let shift = builtin("gearshift");
    let crank = builtin("slider-crank");
    let bars = data("dyad-bars.toml");
    let cases = [
        (
            "rocker's arm thickened",
            swap(
                &shift,
                r#"to = [0, 0, "L5h"], radius = 11"#,
                r#"to = [0, 0, "L5h"], radius = 90"#,
            ),
            ["rocker", "short link"],
            Some(0.70),
        ),
        (
            "rail moved into the coupler's way",
            swap(
                &shift,
                "center = [455, 235, 150], size = [1450, 26, 110]",
                "center = [455, 205, 250], size = [1450, 26, 310]",
            ),
            ["frame", "short link"],
            None,
        ),
        (
            "ignore removed",
            swap(&crank, "ignore = ", "# ignore = "),
            ["frame", "rod"],
            None,
        ),
        (
            "bars thickened",
            bars.replace("radius = 1 ", "radius = 2.4 "),
            ["bar 0-5", "bar 8-9"],
            Some(1.47487),
        ),
        (
            "more room asked for",
            swap(&bars, "minimum = 1", "minimum = 2.8"),
            ["bar 0-5", "bar 8-9"],
            Some(1.47487),
        ),
        (
            "input stretched",
            swap(&shift, "[0.70, -17], [1.45, 17]", "[0.70, -17], [1.45, 26]"),
            ["frame", "coupler"],
            Some(1.45),
        ),
    ];
    for (what, text, pair, time) in cases {
        let text = if what == "input stretched" {
            text.replace("minimum = 0.5", "minimum = 31")
        } else {
            text
        };
        let scene = open(&text);
        let report = report(&scene, 120, 1e-2);
        assert!(!report.is_kept(), "{what}");
        let mut judged = report.judged.iter();
        let worst = judged.find(|p| names(&scene, p) == pair).unwrap();
        assert_eq!(worst.judgement, Judgement::Failed, "{what}");
        assert_eq!(
            report.worst().unwrap().judgement,
            Judgement::Failed,
            "{what}"
        );
        if let Some(time) = time {
            assert!(
                (worst.least.time - time).abs() < 0.02,
                "{what}: {}",
                worst.least.time
            );
        }
    }
    for text in [shift, crank, bars] {
        let scene = open(&text);
        let report = report(&scene, 60, 1e-1);
        assert!(report.is_kept(), "{:?}", report.worst());
        assert!(report.gaps.is_empty());
        assert!(report.warnings.is_empty(), "{:?}", report.warnings);
    }
}

#[test]
fn exclusions_that_are_not_needed_are_named() {
    let text = THIN_AND_FAST.to_owned()
        + "ignore = [{ pair = [\"hub\", \"pin\"], reason = \"a bearing\" }, { pair = [\"pin\", \"arm\"], reason = \"a brush\" }]\n";
    let scene = open(&text);
    let report = report(&scene, 40, 1e-2);
    assert_eq!(report.judged.len(), 1);
    assert!(
        report.warnings.iter().any(|w| w.contains("one rigid part")),
        "{:?}",
        report.warnings
    );
    let ignored = report
        .excluded
        .iter()
        .find(|p| p.judgement == Judgement::Ignored("a brush".to_owned()));
    assert!(
        ignored.is_some_and(|p| p.least.distance.is_finite()),
        "{ignored:?}"
    );
}

/// Drives and joints that are general formulas: bounds are proved, and only where a joint's has a kink, or a drive has no rate,
/// estimated, and said to be.
#[test]
fn what_cannot_be_proved_is_called_estimated() {
    let with = |drive: &str, frame: &str| {
        THIN_AND_FAST
            .replace("a = \"20*t\"", &format!("a = \"{drive}\""))
            .replace("Rz(a) Tx(1)", &format!("{frame} Tx(1)"))
            .replace("minimum = 0.1", "minimum = 0.0")
    };
    for (drive, frame, certified) in [
        ("0.5*sin(3*t)", "Rz(a)", true),
        ("floor(3*t)", "Rz(a)", true),
        ("abs(t - 0.3111)", "Rz(a)", true),
        ("sqrt((t - 0.3111)^2)", "Rz(a)", false),
        ("0.5*t", "Rz(a*a)", true),
        ("0.5*t", "Rz(abs(a - 0.2123))", true),
        ("0.5*t", "Rz(sqrt((a - 0.2123)^2))", false),
    ] {
        let scene = open(&with(drive, frame));
        let report = report(&scene, 30, 1e-2);
        let least = &report.judged[0].least;
        assert!(least.distance > 0.0, "{drive} {frame}: {least:?}");
        assert_eq!(least.is_certified, certified, "{drive} {frame}: {least:?}");
    }
}

#[test]
fn frames_and_ends_of_the_drive_are_all_sampled() {
    let scene = open(&builtin("slider-crank"));
    let times = frame_times(&scene, scene.view.fps);
    let trajectory = solve(&scene, &knots(&scene, &times)).unwrap();
    let report = check(&scene, &trajectory, 1.0);
    assert_eq!(report.times.first(), Some(&0.0));
    assert_eq!(report.times.last(), Some(&scene.actuation.duration));
    // Sums and means are taken over what was asked for.
    let asked = samples_at(&scene.actuation, &trajectory, &times);
    assert!(trajectory.samples.len() > times.len());
    let kept: Vec<f64> = asked.iter().map(|s| s.time).collect();
    assert_eq!(kept, times);
}

const LATE: &str = r#"
title = "Nothing in the first and the last second"
units = { length = "mm", angle = "rad" }
duration = 4
[inputs]
x = "5 + 0*sqrt(t - 1) + 0*sqrt(3 - t)"
z = "0.1*t"
[[bodies]]
name = "A"
shapes = [{ sphere = { radius = 1 } }]
[[bodies]]
name = "B"
frame = "Tx(x) Tz(z)"
shapes = [{ sphere = { radius = 1 } }]
[clearance]
minimum = 0.1
"#;

#[test]
fn what_is_not_looked_at_is_listed_as_a_whole() {
    let report = report(&open(LATE), 9, 1e-3);
    assert_eq!(report.gaps, [[0.0, 1.0], [3.0, 4.0]]);
    assert!(!report.judged[0].least.is_certified);
}
