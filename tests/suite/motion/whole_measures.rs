//! Smallest and largest values of measures are those of the whole motion, whatever the samples, and their bounds hold: against
//! closed forms and dense values of our own.

use crate::draws::Draws;
use crate::driven::{Driven, even_times, knots, solve};
use mechanim::clearance::extremes::greatest;
use mechanim::clearance::motion::ProvedMotion;
use mechanim::model::measure::MeasureSource;
use mechanim::scene::{Overrides, load_scene};
use mechanim::{Check, CheckOptions, Samples, Scene};
use serde_json::Value;

/// What a check says of its first measure.
struct Said {
    value: f64,
    bound: f64,
    is_certified: bool,
    passed: bool,
}

fn checked(text: &str, samples: usize) -> Check {
    let scene = Scene::parse("measures", text).expect(text);
    let options = CheckOptions {
        samples: Samples::Even(samples),
        ..CheckOptions::default()
    };
    scene.check(&options).expect(text)
}

fn said(text: &str, samples: usize) -> Said {
    let check = checked(text, samples);
    let report: Value = serde_json::from_str(check.to_json()).expect("JSON");
    let measure = &report["measures"][0];
    Said {
        // None where a formula has no value at a pose.
        value: measure["value"].as_f64().unwrap_or(f64::NAN),
        // None where the formula has no value or no slope, which is no proof then.
        bound: measure["bound"].as_f64().unwrap_or(f64::INFINITY),
        is_certified: measure["certified"].as_bool().unwrap_or(false),
        passed: check.passed(),
    }
}

/// An arm that a drive turns; its tip's height is what is measured.
fn arm(drive: &str, take: &str, limit: &str) -> String {
    format!(
        r#"
duration = 2
[inputs]
u = "{drive}"
[chains]
a = "Rz(u) Tx(1)"
[[bodies]]
name = "a"
frame = "a"
shapes = [{{ sphere = {{ radius = 0.1 }} }}]
[[traces]]
name = "M"
body = "a"
[measures]
height = {{ of = "M.y", take = "{take}", {limit} }}
"#
    )
}

/// The greatest of a function of the time over two seconds, on a grid of our own.
fn dense(of: impl Fn(f64) -> f64) -> f64 {
    let times = (0..=400_000).map(|k| k as f64 / 200_000.0);
    times.map(of).fold(f64::NEG_INFINITY, f64::max)
}

#[test]
fn what_happens_between_samples_counts() {
    let waves = |t: f64| 0.1 * t + 0.9 * (std::f64::consts::PI * t).sin();
    let spike = |t: f64| 0.1 * t + (-((t - 1.0123) * 1e3_f64).powi(2)).exp();
    let cases: [(&str, &dyn Fn(f64) -> f64); 2] = [
        ("0.1*t + 0.9*sin(pi*t)", &waves),
        ("0.1*t + exp(-((t-1.0123)*1e3)^2)", &spike),
    ];
    for (drive, of) in cases {
        let truth = dense(|t| of(t).sin());
        for samples in [2, 3, 5, 41] {
            let case = format!("{drive}, {samples} samples");
            let broken = said(&arm(drive, "max", "max = 0.5"), samples);
            assert!(!broken.passed, "{case}");
            assert!(
                (broken.value - truth).abs() < 1e-7,
                "{case}: {} {truth}",
                broken.value
            );
            assert!(broken.is_certified && broken.bound >= truth, "{case}");
            assert!(broken.bound - truth < 1e-5, "{case}: {}", broken.bound);
            assert!(
                said(&arm(drive, "max", "max = 0.9"), samples).passed,
                "{case}"
            );
            let least = said(&arm(drive, "min", "min = -0.9"), samples);
            let deepest = -dense(|t| -of(t).sin());
            assert!(
                least.passed && (least.value - deepest).abs() < 1e-7,
                "{case}"
            );
        }
    }
}

/// Crank, rod and offset of a slider-crank in millimetres.
const CRANK: [f64; 3] = [40.0, 100.0, 10.0];

fn slider(measure: &str) -> String {
    let [r, l, e] = CRANK;
    format!(
        r#"
units = {{ length = "mm", angle = "rad" }}
duration = 2
[inputs]
phi = "0.1 + pi*t"
[loops]
A = "Rz(phi) Tx({r}) Rz(alpha) Tx({l}) Rz(beta) inv(Ty({e}) Tx(h))"
[guess]
h = 120
[[bodies]]
name = "crank"
frame = "Rz(phi)"
[measures]
{measure}
"#
    )
}

/// Where the slider is, by the theorem of Pythagoras.
fn slide(time: f64) -> [f64; 2] {
    let [r, l, e] = CRANK;
    let phi = 0.1 + std::f64::consts::PI * time;
    let up = e - r * phi.sin();
    [phi, r * phi.cos() + (l * l - up * up).sqrt()]
}

#[test]
fn a_stroke_is_that_of_its_dead_points() {
    let [r, l, e] = CRANK;
    let stroke = ((l + r).powi(2) - e * e).sqrt() - ((l - r).powi(2) - e * e).sqrt();
    for samples in [3, 7, 60] {
        let found = said(
            &slider("stroke = { of = \"h\", take = \"range\" }"),
            samples,
        );
        assert!(
            (found.value - stroke).abs() < 1e-9,
            "{samples}: {} {stroke}",
            found.value
        );
        assert!(found.is_certified && found.bound >= stroke, "{samples}");
        // A limit at its printed digits is kept or broken by them, not by where the samples are.
        let limits = [
            ("max", 1e-6, true),
            ("max", -1e-6, false),
            ("min", -1e-6, true),
            ("min", 1e-6, false),
        ];
        for (word, off, kept) in limits {
            let limit = stroke + off;
            let measure =
                format!("stroke = {{ of = \"h\", take = \"range\", {word} = {limit:?} }}");
            assert_eq!(
                said(&slider(&measure), samples).passed,
                kept,
                "{samples} {word} {off}"
            );
        }
    }
}

#[test]
fn bounds_hold_for_formulas_with_kinks_and_steps() {
    let mut draws = Draws(77);
    let mut share = 0.0_f64;
    for case in 0..12 {
        let [a, b] = [2.0 * draws.number(), 0.5 + 5.5 * draws.share()];
        let c = 60.0 + 80.0 * draws.share();
        let (formula, of): (String, Box<dyn Fn(f64) -> f64>) = match case % 3 {
            0 => (
                format!("{a}*h + 30*sin({b}*phi)"),
                Box::new(move |t| a * slide(t)[1] + 30.0 * (b * slide(t)[0]).sin()),
            ),
            1 => (
                format!("abs(h - {c}) + {a}*phi"),
                Box::new(move |t| (slide(t)[1] - c).abs() + a * slide(t)[0]),
            ),
            _ => (
                format!("max(h - {c}, {b}*floor(phi))"),
                Box::new(move |t| (slide(t)[1] - c).max(b * slide(t)[0].floor())),
            ),
        };
        let truth = dense(&of);
        let measure = format!("m = {{ of = \"{formula}\", take = \"max\" }}");
        let found = said(&slider(&measure), 4 + case);
        let scale = 1.0 + truth.abs();
        assert!(
            found.bound >= truth - 1e-9 * scale,
            "{formula}: {} {truth}",
            found.bound
        );
        assert!(found.value <= found.bound, "{formula}");
        assert!(found.is_certified, "{formula}");
        assert!(found.bound - truth < 1e-5 * scale, "{formula}");
        share = share.max((truth - found.value) / scale);
        if case % 3 < 2 {
            assert!(
                (found.value - truth).abs() < 1e-6 * scale,
                "{formula}: {} {truth}",
                found.value
            );
        }
    }
    assert!(share < 1e-3, "{share}");
}

/// Kinks of kinks, of outputs, at the greatest value itself; jumps to both sides.
#[test]
fn kinks_and_jumps_are_bounded_as_near_as_anything_else() {
    let saw = |x: f64, y: f64| x - y * (x / y).floor();
    type Case = (&'static str, &'static str, fn([f64; 2]) -> f64);
    let cases: [Case; 11] = [
        ("atan2(sin(3*phi + 1), cos(3*phi + 1))", "max", |[p, _]| {
            (3.0 * p + 1.0).sin().atan2((3.0 * p + 1.0).cos())
        }),
        ("atan2(sin(3*phi + 1), cos(3*phi + 1))", "min", |[p, _]| {
            (3.0 * p + 1.0).sin().atan2((3.0 * p + 1.0).cos())
        }),
        ("h/20 - atan2(h - 100, -phi - 1)", "max", |[p, h]| {
            h / 20.0 - (h - 100.0).atan2(-p - 1.0)
        }),
        ("-abs(h - 101.3)", "max", |[_, h]| -(h - 101.3).abs()),
        ("abs(abs(h - 95) - 20)", "max", |[_, h]| {
            ((h - 95.0).abs() - 20.0).abs()
        }),
        ("abs(abs(h - 95) - 20)", "min", |[_, h]| {
            ((h - 95.0).abs() - 20.0).abs()
        }),
        ("min(h - 80, 30*cos(phi))", "max", |[p, h]| {
            (h - 80.0).min(30.0 * p.cos())
        }),
        ("max(max(h - 120, 30*sin(phi)), 3*phi)", "min", |[p, h]| {
            (h - 120.0).max(30.0 * p.sin()).max(3.0 * p)
        }),
        (
            "sqrt(1 + abs(h - 100)) - 0.4*abs(cos(3*phi))",
            "min",
            |[p, h]| (1.0 + (h - 100.0).abs()).sqrt() - 0.4 * (3.0 * p).cos().abs(),
        ),
        ("10*floor(h/7) - h", "max", |[_, h]| {
            10.0 * (h / 7.0).floor() - h
        }),
        ("abs(floor(phi) - 2.5)*3 + 0.01*h", "max", |[p, h]| {
            (p.floor() - 2.5).abs() * 3.0 + 0.01 * h
        }),
    ];
    for (formula, take, of) in cases {
        for is_output in [false, true] {
            let shown = if is_output { "shown" } else { formula };
            let measure = format!(
                "m = {{ of = \"{shown}\", take = \"{take}\" }}\n[outputs]\nshown = \"{formula}\""
            );
            let sign = if take == "max" { 1.0 } else { -1.0 };
            let truth = sign * dense(|t| sign * of(slide(t)));
            let found = said(&slider(&measure), 9);
            let case = format!(
                "{take} of {formula}: {} {} {truth}",
                found.value, found.bound
            );
            assert!(found.is_certified, "{case}");
            assert!(sign * (found.bound - truth) >= -1e-9, "{case}");
            // A grid of 400000 places misses a kink by half a step.
            assert!(sign * (found.bound - truth) < 2e-3, "{case}");
            assert!((found.value - found.bound).abs() < 2e-3, "{case}");
        }
    }
    // A saw comes as near to its height as may be, and has it nowhere.
    let found = said(&slider("m = { of = \"mod(h, 30)\", take = \"max\" }"), 9);
    let truth = dense(|t| saw(slide(t)[1], 30.0));
    assert!(
        found.is_certified && found.bound >= truth,
        "{}",
        found.bound
    );
    assert!(found.bound <= 30.0 + 1e-6, "{}", found.bound);
}

/// A minimum that is met at a singular pose has no proof: a limit below it is not passed on an estimate, wherever rounding puts
/// that.
#[test]
fn minima_at_singular_poses_pass_no_limit_unproved() {
    for start in ["17", "30.3", "45", "61.7"] {
        for of in ["M.x", "abs(M.y)", "M.y^2"] {
            let text = format!(
                "units = {{ length = \"mm\", angle = \"deg\" }}\nduration = 1\n[inputs]\nphi = \"{start}+360*t\"\n\
                 [loops]\nA = \"Rz(phi) Tx(40) Rz(mu) Tx(80) Rz(nu) Tx(-40) Rz(-theta) Tx(-80)\"\n[guess]\ntheta = 30\n\
                 [[bodies]]\nname = \"R\"\nframe = \"Tx(80) Rz(theta)\"\n\
                 [[traces]]\nname = \"M\"\nbody = \"R\"\npoint = [40, 0, 0]\n\
                 [measures]\nm = {{ of = \"{of}\", take = \"min\", min = -30 }}\n"
            );
            let said = said(&text, 21);
            assert!(said.bound <= said.value, "{of} from {start}");
            assert!(said.is_certified || !said.passed, "{of} from {start}");
        }
    }
}

/// Peaks that are reached again and again, of values that are small differences of large ones: no better bound than rounding
/// allows is searched for, whatever the dimensions are.
#[test]
fn extremes_as_near_as_rounding_allows_need_few_parts() {
    let source = mechanim::scene::builtin::find_builtin("twin-steer").unwrap();
    for shift in [0.0, 0.3, 0.9, 1.6, -1.1, 1.92] {
        let overrides = Overrides {
            parameters: vec![("XP".to_owned(), (480.0 + shift).to_string())],
            ..Overrides::default()
        };
        let scene = load_scene(&source, &overrides).unwrap();
        let trajectory = solve(&scene, &knots(&scene, &even_times(&scene, 121))).unwrap();
        let system = scene.system().unwrap();
        let mut motion = ProvedMotion::new(&system, &scene.actuation, &trajectory);
        assert!(motion.is_certified());
        for measure in &scene.measures.list {
            let MeasureSource::Over { of, .. } = &measure.source else {
                panic!("{}", measure.name);
            };
            for sign in [1.0, -1.0] {
                let found = greatest(&mut motion, &of[0], sign).unwrap();
                // Angles are added up to 1 rad.
                assert!(
                    found.is_certified && found.bound <= found.value + 1e-10,
                    "{found:?}"
                );
                assert!(found.parts < 1500, "{} {shift}: {found:?}", measure.name);
            }
        }
    }
}

/// The value of a measure, and not only its bound, is that of the whole motion: also of large values that vary by little, of small
/// ones beside others of many magnitudes, and of distances. Drive of `u`, formula, take, and the value in closed form.
#[test]
fn values_do_not_depend_on_the_samples_at_any_magnitude() {
    // The least of 3 sin(2t) + t is where 6 cos(2t) = -1.
    let turn = std::f64::consts::PI - 0.5 * (-1.0_f64 / 6.0).acos();
    let low = 3.0 * (2.0 * turn).sin() + turn;
    let rows: [(&str, &str, &str, f64); 10] = [
        ("3*sin(2*t)+t", "exp(u^3)", "min", low.powi(3).exp()),
        ("3*sin(2*t)+t", "u^3", "min", low.powi(3)),
        ("t", "exp(20*sin(7*u))", "min", (-20.0_f64).exp()),
        ("t", "exp(20*sin(7*u))", "max", 20.0_f64.exp()),
        ("t", "1e9+sin(20*u)", "range", 2.0),
        ("t", "1e6+1e-3*sin(20*u)", "range", 2e-3),
        ("t", "1e12+sin(20*u)", "max", 1e12 + 1.0),
        ("t", "-1e-9*cos(20*u)", "max", 1e-9),
        ("t", "(sin(7*u)+1.0001)^9", "min", 1e-36),
        ("t", "3+(u-0.4321)^2*100", "min", 3.0),
    ];
    for (drive, formula, take, exact) in rows {
        for samples in [10, 81] {
            let text = format!(
                "units = {{ length = \"m\", angle = \"rad\" }}\nduration = 3\n[inputs]\nu = \"{drive}\"\n\
                 [outputs]\no = \"{formula}\"\n[measures]\nm = {{ of = \"o\", take = \"{take}\" }}\n"
            );
            let said = said(&text, samples);
            // A range of large values is the difference of two that are rounded.
            let size = if formula.starts_with("1e9") || formula.starts_with("1e6") {
                1e9
            } else {
                0.0
            };
            let off = (said.value - exact).abs();
            assert!(
                off <= 1e-8 * exact.abs() + 4.0 * f64::EPSILON * size,
                "{take} of {formula}: {} instead of {exact}, {samples} samples",
                said.value
            );
        }
    }
    for samples in [10, 81] {
        let text = "units = { length = \"m\", angle = \"rad\" }\nduration = 1\n[inputs]\nu = \"t\"\n\
                    [[bodies]]\nname = \"A\"\nshapes = [{ sphere = { radius = 1 } }]\n\
                    [[bodies]]\nname = \"B\"\nframe = \"Tx(3+(u-0.4321)^2*100)\"\nshapes = [{ sphere = { radius = 1 } }]\n\
                    [outputs]\no = { distance = [\"A\", \"B\"] }\n[measures]\nm = { of = \"o\", take = \"min\" }\n";
        let said = said(text, samples);
        assert!((said.value - 1.0).abs() < 2e-9, "{} {samples}", said.value);
    }
}

/// A drive that is elsewhere at one sample only, and formulas that lose all digits there: no bound is below the value, computed by hand.
#[test]
fn bounds_hold_at_a_pose_that_stands_alone() {
    let drives = [
        // At the last instant, at the first, and behind each whole second.
        (r#"{ keys = [[0, 0], [4, 1]], ease = "step" }"#, 1.0),
        (r#""max(0, 1+floor(-t))""#, 1.0),
        (r#""floor(t)""#, 4.0),
    ];
    type Exact = fn(f64) -> f64;
    let formulas: [(&str, Exact); 5] = [
        ("(1e17*u+7*u)-1e17*u", |u| 7.0 * u),
        ("(1e8*u+0.1*u)^2-1e16*u^2-2e7*u^2", |u| 0.01 * u * u),
        ("1e9*((1e8+u/7)-1e8)", |u| 1e9 * u / 7.0),
        // What may be undefined there has no bound.
        ("(1e17*u+7*u)-1e17*u+0*atan2(u-1, u-1)", |u| 7.0 * u),
        // √((10⁶ + u/7)² + 9) - 10⁶, but for less than 1e-15.
        ("hypot(1e6+u/7, 3)-1e6", |u| u / 7.0 + 4.5 / (1e6 + u / 7.0)),
    ];
    for (drive, last) in drives {
        for (formula, exact) in formulas {
            let text = format!(
                "duration = 4\n[inputs]\nu = {drive}\n[[bodies]]\nname = \"a\"\nframe = \"Tx(u)\"\n\
                 shapes = [{{ sphere = {{ radius = 1 }} }}]\n\
                 [measures]\na = {{ of = \"{formula}\", take = \"max\", max = {:?} }}\n",
                0.9 * exact(last)
            );
            for samples in [2, 5, 40] {
                let case = format!("{drive} {formula} {samples}");
                let said = said(&text, samples);
                assert!(
                    said.bound >= exact(last) * (1.0 - 1e-15),
                    "{case}: {}",
                    said.bound
                );
                assert!(!said.passed, "{case}");
            }
        }
    }
}

/// What is found of a measure does not depend on those before it, however much these had to look at.
#[test]
fn measures_do_not_depend_on_each_other() {
    let scene = |measures: &[(&str, &str)]| {
        let list = measures
            .iter()
            .map(|(name, of)| format!("{name} = {{ of = \"{of}\", take = \"min\" }}\n"));
        format!(
            "duration = 3\n[inputs]\nx = \"(-7*abs(sin(2*pi*t/3)))+(10*min(abs(t-0.3),abs(t-0.3)))\"\ny = \"(3*abs(sin(2*pi*t/3)))\"\n\
             [[bodies]]\nname = \"ball\"\nframe = \"Tx(x) Ty(y)\"\n[measures]\n{}",
            list.collect::<String>()
        )
    };
    let all = [
        ("a", "min(x,y)"),
        ("b", "x*y"),
        ("c", "abs(x)-abs(y)"),
        ("d", "x*y - 3"),
        ("e", "abs(x)-2*abs(y)"),
    ];
    let check = checked(&scene(&all), 21);
    let report: Value = serde_json::from_str(check.to_json()).expect("JSON");
    for (k, measure) in all.into_iter().enumerate() {
        let together = report["measures"][k]["value"].as_f64().expect("value");
        let alone = said(&scene(&[measure]), 21);
        assert_eq!(together, alone.value, "{measure:?}");
        // Our own values are never below it, nor far above.
        let dense = (0..=300_000).map(|k| {
            let t = 3.0 * f64::from(k) / 300_000.0;
            let wave = (2.0 * std::f64::consts::PI * t / 3.0).sin().abs();
            let (x, y) = (-7.0 * wave + 10.0 * (t - 0.3).abs(), 3.0 * wave);
            match measure.0 {
                "a" => x.min(y),
                "b" => x * y,
                "c" => x.abs() - y.abs(),
                "d" => x * y - 3.0,
                _ => x.abs() - 2.0 * y.abs(),
            }
        });
        let least = dense.fold(f64::INFINITY, f64::min);
        assert!(
            (together - least).abs() < 1e-4 && together <= least + 1e-9,
            "{measure:?}: {together} {least}"
        );
    }
}

/// A formula that touches its kink, or rests at it, has a bound there.
#[test]
fn touched_kinks_have_bounds() {
    for (drive, formula, most) in [
        ("3+sin(pi*t)^2", "max(u,3)", 4.0),
        ("3+sin(pi*t)^2", "abs(u-3)", 1.0),
        ("40*sin(6*pi*t)", "max(u,u)", 40.0),
        ("3-max(0,t-1)^2", "min(u,3)", 3.0),
        ("max(1,t)", "abs(u-1)", 1.0),
        ("2-t", "max(u,max(u,1))", 2.0),
    ] {
        for samples in [2, 3, 5, 20, 21] {
            let text = format!(
                "duration = 2\n[inputs]\nu = \"{drive}\"\n[[bodies]]\nname = \"b\"\nframe = \"Tx(u)\"\n[measures]\nm = {{ of = \"{formula}\", take = \"max\", max = {} }}\n",
                most + 1e-3
            );
            let said = said(&text, samples);
            let is_right = said.is_certified
                && said.passed
                && (said.bound - most).abs() < 1e-6
                && (said.value - most).abs() < 1e-9;
            assert!(
                is_right,
                "{drive}, {formula}, {samples} samples: {} {}",
                said.value, said.bound
            );
        }
    }
}
