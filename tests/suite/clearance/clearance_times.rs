//! When a pair is too near: the intervals of a check against times in closed form.

use crate::driven;
use crate::driven::{check, even_times, knots, solve};
use crate::program::Workspace;
use mechanim::clearance::check::{ClearanceEffort, ClearanceReport, Violations};
use mechanim::diag::Source;
use mechanim::scene::{Overrides, Scene, load_scene};

/// A ball of radius 1 above a floor at 0.
fn lift(height: &str, minimum: f64) -> String {
    format!(
        "title = \"lift\"\nduration = 2\nunits = {{ length = \"mm\", angle = \"rad\" }}\n\
         [inputs]\nx = \"0.5*sin(t)\"\nz = {height}\n\
         [[bodies]]\nname = \"floor\"\nshapes = [{{ box = {{ center = [0, 0, -50], size = [400, 400, 100] }} }}]\n\
         [[bodies]]\nname = \"ball\"\nframe = \"Tx(x) Tz(z)\"\nshapes = [{{ sphere = {{ radius = 1 }} }}]\n\
         [clearance]\nminimum = {minimum}\n"
    )
}

fn open(text: &str) -> Scene {
    let source = Source {
        name: "test".into(),
        text: text.into(),
    };
    load_scene(&source, &Overrides::default()).unwrap_or_else(|e| panic!("{:#?}", e.diagnostics))
}

fn report(scene: &Scene, samples: usize) -> ClearanceReport {
    let times = knots(scene, &even_times(scene, samples));
    check(scene, &solve(scene, &times).unwrap(), 1e-2)
}

fn times(text: &str, samples: usize) -> Violations {
    let report = report(&open(text), samples);
    let found = report.judged[0].violations.clone().unwrap();
    for violation in &found.list {
        let within = violation.from..=violation.to;
        assert!(
            within.contains(&violation.time),
            "{text}, {samples}: {violation:?}"
        );
    }
    found
}

/// Heights above contact, and when they are below half a unit; the closest pose of every such time.
#[test]
fn times_are_those_of_the_formula() {
    let half = 0.5_f64;
    let wave = |k: f64| (1.0 + k) / 6.0;
    // 1 + sin(w) < 0.5 between 7 pi / 6 and 11 pi / 6 of every turn, here w = 2 pi t.
    let turns = [[wave(2.5), wave(4.5)], [1.0 + wave(2.5), 1.0 + wave(4.5)]];
    // Height z, the times, and the gap z - 1 of each at its smallest.
    type Row = (&'static str, Vec<[f64; 2]>, &'static [f64]);
    let rows: [Row; 7] = [
        ("\"2 + sin(2*pi*t)\"", turns.to_vec(), &[0.0, 0.0]),
        // The second time less close than the first.
        (
            "\"2 + sin(2*pi*t) + 0.125*floor(t)\"",
            vec![turns[0], {
                let reach = 0.625_f64.asin() / std::f64::consts::TAU;
                [1.5 + reach, 2.0 - reach]
            }],
            &[0.0, 0.125],
        ),
        ("\"2 - t\"", vec![[0.5, 2.0]], &[-1.0]),
        ("\"1.4 + t\"", vec![[0.0, 0.1]], &[0.4]),
        (
            "\"1 + 40*abs(t - 1.0112)\"",
            vec![[1.0112 - half / 40.0, 1.0112 + half / 40.0]],
            &[0.0],
        ),
        (
            "\"1.4 + floor(t + 0.2) - floor(t - 0.3)\"",
            vec![[0.3, 0.8], [1.3, 1.8]],
            &[0.4, 0.4],
        ),
        (
            "{ keys = [[0, 3], [0.52, 1.2], [1.51, 3], [2, 3]], ease = \"step\" }",
            vec![[0.52, 1.51]],
            &[0.2],
        ),
    ];
    for (height, expected, closest) in rows {
        for samples in [5, 12, 41] {
            let text = lift(height, half);
            let found = times(&text, samples);
            let said = format!("{height}, {samples}: {found:?}");
            assert!(found.is_certified, "{said}");
            assert_eq!(found.list.len(), expected.len(), "{said}");
            let all = found.list.iter().zip(expected.iter().copied().zip(closest));
            for (violation, ([from, to], closest)) in all {
                assert!(violation.is_seen, "{said}");
                // Never inside of the truth, and near it.
                let (early, late) = (from - violation.from, violation.to - to);
                assert!((-1e-9..2e-3).contains(&early), "{said} {from}");
                assert!((-1e-9..2e-3).contains(&late), "{said} {to}");
                let off = violation.distance - closest;
                assert!((-1e-9..1e-3).contains(&off), "{said} {closest}");
            }
        }
    }
}

/// Many waves between two samples: each has its own closest pose.
#[test]
fn the_closest_pose_of_every_wave_is_told() {
    for (rate, deep, samples) in [
        (17.5, 2.2, 10),
        (9.1, 2.05, 10),
        (19.9, 2.4, 100),
        (19.9, 2.4, 2),
    ] {
        let found = times(
            &lift(&format!("\"3 + {deep}*cos({rate}*t)\""), 0.1),
            samples,
        );
        let said = format!("{rate}, {deep}, {samples}: {found:?}");
        let waves = (0..).map(|k| (1.0 + 2.0 * f64::from(k)) * std::f64::consts::PI / rate);
        let waves: Vec<f64> = waves.take_while(|time| *time < 2.0).collect();
        assert_eq!(found.list.len(), waves.len(), "{said}");
        for (violation, time) in found.list.iter().zip(waves) {
            assert!((violation.time - time).abs() < 1e-3, "{said}");
            assert!(
                (violation.distance - (2.0 - deep)).abs() < 1e-3 * deep,
                "{said}"
            );
        }
    }
}

/// At a cusp or a jump a stretch may have no more than its end in an interval.
#[test]
fn the_closest_pose_lies_in_its_interval() {
    for height in [
        "1.2 + sqrt(abs(t - 1.2345))",
        "0.8 + 2.2*sqrt(abs(sin(1.6*t + 2.1))) + 0.3*t",
        "1.1 + 2*abs(sin(4*t)) - floor(1.046*t)",
        "min(1.2 + 30*abs(t - 0.7123), 1.3 + sqrt(abs(t - 1.5)))",
    ] {
        for samples in [2, 3, 5, 10, 50] {
            let found = times(&lift(&format!("\"{height}\""), 0.5), samples);
            assert!(!found.list.is_empty(), "{height}, {samples}");
        }
    }
}

/// Solids that pass through each other, whatever the minimum: many pieces of the motion need not be halved as often as the
/// pieces at the ends.
#[test]
fn times_of_deep_overlaps_are_those_of_the_formula() {
    let solids = [
        "box = { size = [2.6, 4, 4] }",
        "cylinder = { from = [-1.3, 0, 0], to = [1.3, 0, 0], radius = 2 }",
        "cylinder = { from = [0, 0, -2], to = [0, 0, 2], radius = 1.3 }",
        "cone = { from = [-1.3, 0, 0], to = [1.3, 0, 0], radius_from = 2, radius_to = 1.5 }",
    ];
    for solid in solids {
        for (minimum, samples) in [
            (0.0, 33),
            (1e-8, 33),
            (1e-8, 129),
            (1e-5, 65),
            (1e-3, 257),
            (0.1, 9),
        ] {
            let text = format!(
                "duration = 1\n[inputs]\nx = \"2.9*sin(2*pi*t)\"\n\
                 [[bodies]]\nname = \"wall\"\nshapes = [{{ box = {{ size = [2, 9, 9] }} }}]\n\
                 [[bodies]]\nname = \"solid\"\nframe = \"Tx(x)\"\nshapes = [{{ {solid} }}]\n\
                 [clearance]\npairs = [{{ pair = [\"wall\", \"solid\"], minimum = {minimum} }}]\n"
            );
            let found = times(&text, samples);
            let said = format!("{solid}, {minimum}, {samples}: {found:?}");
            // Nearer than the minimum while |x| < 2.3 + minimum.
            let end = ((2.3 + minimum) / 2.9_f64).asin() / std::f64::consts::TAU;
            let expected = [[0.0, end], [0.5 - end, 0.5 + end], [1.0 - end, 1.0]];
            assert_eq!(found.list.len(), expected.len(), "{said}");
            let resolution = 4.0 / 1024.0 / (samples - 1) as f64;
            for (violation, [from, to]) in found.list.iter().zip(expected) {
                assert!(violation.is_seen, "{said}");
                let (early, late) = (from - violation.from, violation.to - to);
                assert!((-1e-9..resolution).contains(&early), "{said} {from}");
                assert!((-1e-9..resolution).contains(&late), "{said} {to}");
                // The deepest pose, in the middle, is a sample: 2.3 along x.
                assert!((violation.distance + 2.3).abs() < 1e-6, "{said}");
            }
        }
    }
}

/// Short pulses between two samples are among the times.
#[test]
fn a_pulse_between_samples_has_its_time() {
    let found = times(&lift("\"20 - 19*exp(-(400*(t - 1.0112))^2)\"", 0.5), 6);
    assert_eq!(found.list.len(), 1);
    let [from, to] = [found.list[0].from, found.list[0].to];
    let half = (19.0_f64 / 18.5).ln().sqrt() / 400.0;
    assert!(
        (1.0112 - half - from).abs() < 2e-3 && (to - 1.0112 - half).abs() < 2e-3,
        "{found:?}"
    );
    assert!(from <= 1.0112 - half && to >= 1.0112 + half, "{found:?}");
}

/// Only who asks is told.
#[test]
fn times_are_found_on_request() {
    let scene = open(&lift("\"2 - t\"", 0.5));
    let motion = solve(&scene, &knots(&scene, &even_times(&scene, 5))).unwrap();
    let report = driven::check_closely(&scene, &motion, ClearanceEffort::to(1e-2));
    assert!(report.judged[0].violations.is_none());
}

#[test]
fn every_report_says_when() {
    let w = Workspace::new();
    w.write("lift.toml", lift("\"2 - t\"", 0.5));
    let args = [
        "check",
        "lift.toml",
        "--json",
        "r.json",
        "--junit",
        "r.xml",
        "--plot",
        "r.svg",
        "--matrix",
        "m.svg",
    ];
    let text = w.run(&args).exits(1).text();
    // Times are rounded away from the stretch in which the minimum is broken: it begins at 0.5 s.
    let words = "below its minimum at t = 0.499999";
    assert!(
        text.contains(words) && text.contains("to 2.000000 s; kept at all other times (proved)"),
        "{text}"
    );
    let read = |name: &str| std::fs::read_to_string(w.path(name)).unwrap();
    let json: serde_json::Value = serde_json::from_str(&read("r.json")).unwrap();
    let times = &json["clearance"]["pairs"][0]["violations"];
    assert_eq!(times["certified"], true);
    let first = &times["intervals"][0];
    assert!(first["seen"] == true && first["to"] == 2.0, "{times}");
    assert!(read("r.xml").contains(words));
    let plot = read("r.svg");
    for words in [
        "floor / ball",
        "the depth of the overlap has no bound",
        "the minimum is 0.5",
    ] {
        assert!(plot.contains(words), "{words}: {plot}");
    }
    let matrix = read("m.svg");
    for words in ["floor", "ball", "1 below", "0 near", "0 clear"] {
        assert!(matrix.contains(words), "{words}: {matrix}");
    }
}

/// A ball on an arm that turns many times between two samples: no interval is short enough for a bound of its own.
fn spun(apart: f64, rate: &str, minimum: f64) -> String {
    format!(
        "units = {{ length = \"mm\" }}\nduration = 1000\n[inputs]\nu = \"{rate}\"\n\
         [[bodies]]\nname = \"a\"\nframe = \"Tx({apart})\"\nshapes = [{{ sphere = {{ radius = 1 }} }}]\n\
         [[bodies]]\nname = \"b\"\nframe = \"Rz(u)\"\nshapes = [{{ sphere = {{ center = [2, 0, 0], radius = 1 }} }}]\n\
         [clearance]\nminimum = {minimum}\n"
    )
}

#[test]
fn what_fast_bodies_sweep_bounds_them() {
    // The nearest they come is apart - 4. Over longer intervals the second formula has no bound itself.
    for (rate, samples) in [("600*t", 100), ("600*t", 5000), ("7*sin(60*t)", 20_001)] {
        let report = report(&open(&spun(1000.0, rate, 0.1)), samples);
        let pair = &report.judged[0];
        assert!(
            pair.judgement.is_kept(),
            "{rate} {samples}: {:?}",
            pair.least
        );
        assert!((0.1..=996.0).contains(&pair.least.bound));
    }
    // Swept volumes that meet prove nothing: the bodies may overlap between the samples.
    for apart in [3.5, 4.5] {
        let report = report(&open(&spun(apart, "600*t", 0.1)), 400);
        let least = &report.judged[0].least;
        assert!(least.bound <= apart - 4.0, "{apart}: {least:?}");
    }
}

#[test]
fn the_distance_is_the_least_of_all_that_were_seen() {
    // Undecided or failed, what an interval of violation has seen counts for the pair.
    for offset in [0.0, 1e5, 1e6] {
        let text = format!(
            "units={{length=\"mm\"}}\nduration=1\n[inputs]\nu=\"9*sin(48.8*t)\"\nv=\"7*max(sin(49.5*t),cos(65*t))\"\n\
             [[bodies]]\nname=\"a\"\nframe=\"T({offset},4.22,0)\"\nshapes=[{{sphere={{radius=1}}}}]\n\
             [[bodies]]\nname=\"b\"\nframe=\"T({offset},0,0) Rx(v) Rz(u)\"\nshapes=[{{box={{center=[1,0,0],size=[2,1,0.5]}}}}]\n\
             [clearance]\nminimum=1.1\n"
        );
        let report = report(&open(&text), 5);
        let pair = &report.judged[0];
        for violation in pair.violations.iter().flat_map(|v| &v.list) {
            assert!(
                pair.least.distance <= violation.distance,
                "{offset}: {violation:?}"
            );
        }
    }
}
