//! Where coordinates turn back while the drive goes on, against closed forms; and that a drive which turns back or
//! rests makes no limit positions.

use crate::driven::{Model, add_limits, even_times, solve};
use mechanim::diag::Source;

use mechanim::kinematics::loops::observed::{dependencies, needed_slots, observed_slots};
use mechanim::kinematics::results::trajectory::EventKind;
use mechanim::scene::{Overrides, builtin, load_scene};

use crate::program::Workspace;
use crate::reference::{hard, mechanism, turned};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_6, PI};

/// (input, value, is largest) of the limit positions of a coordinate.
fn limits(mechanism: &Model, samples: usize, coordinate: &str) -> Vec<(f64, f64, bool)> {
    let mut trajectory = solve(mechanism, &even_times(mechanism, samples)).unwrap();
    add_limits(mechanism, &mut trajectory);
    let times: Vec<f64> = trajectory.events.iter().map(|e| e.time).collect();
    assert!(times.is_sorted());
    let events = trajectory.events.iter();
    let limits = events.filter_map(|event| match &event.kind {
        EventKind::LimitPosition {
            name,
            value,
            is_largest,
            ..
        } if name == coordinate => Some((event.inputs[0], *value, *is_largest)),
        _ => None,
    });
    limits.collect()
}

#[test]
fn the_slider_turns_back_at_its_dead_points() {
    for drive in ["0.3 + 4*pi*t/4", "-4*pi*t/4 - 1", "4*pi*t/4", "2*pi*t"] {
        let mut mechanism = hard("h01-slider-crank", &[("input", "phi", drive)]);
        mechanism.actuation.duration = if drive.contains("/4") { 4.0 } else { 2.0 };
        for samples in [5, 80, 1001] {
            let found = limits(&mechanism, samples, "h");
            assert_eq!(found.len(), 4, "{drive} {samples}: {found:?}");
            for (phi, h, is_largest) in found {
                let (place, stroke) = if is_largest { (0.0, 120.0) } else { (PI, 40.0) };
                assert!(turned(phi - place) < 1e-9, "{drive} {samples}: {phi}");
                assert!((h - stroke).abs() < 1e-12, "{h}");
            }
            let rod = limits(&mechanism, samples, "beta");
            assert_eq!(rod.len(), 4, "{drive} {samples}: {rod:?}");
            for (phi, beta, is_largest) in rod {
                let sign = if is_largest { 1.0 } else { -1.0 };
                assert!(turned(phi - sign * FRAC_PI_2) < 1e-9, "{phi}");
                assert!((beta - sign * FRAC_PI_6).abs() < 1e-13);
            }
            assert!(limits(&mechanism, samples, "alpha").is_empty());
        }
    }
}

/// A rocker stands at a limit where crank and coupler are in line, their sum or difference the third side.
#[test]
fn a_rocker_turns_back_where_crank_and_coupler_are_in_line() {
    for [a, b, c, d] in [
        [20.0, 60.0, 50.0, 70.0],
        [30.0, 100.0, 80.0, 90.0],
        [10.0, 40.0, 40.0, 40.0],
    ] {
        let text = format!(
            "duration = 4\n[inputs]\nphi = \"0.1 + 2*pi*t/4\"\n[loops]\n\
             A = \"Rz(phi) Tx({a}) Rz(mu) Tx({b}) Rz(nu) Tx({}) Rz(-theta) Tx({})\"\n[guess]\ntheta = 1.5\n",
            -c, -d
        );
        let name = "rocker".to_owned();
        let rocker = mechanism(&Source { name, text }, &[]);
        let corner =
            |reach: f64| -> f64 { ((d * d + c * c - reach * reach) / (2.0 * d * c)).acos() };
        let found = limits(&rocker, 90, "theta");
        assert_eq!(found.len(), 2, "{found:?}");
        for (phi, theta, _) in found {
            let stretched = [b + a, b - a].map(corner);
            let off = |corner: &f64| turned(turned(theta) - (PI - corner));
            let nearest = stretched.iter().map(off).fold(PI, f64::min);
            assert!(nearest < 1e-12, "{theta}: {nearest:e}");
            // The pin then lies on the line from the crank's bearing to the rocker's end.
            let end = (d + c * theta.cos(), c * theta.sin());
            let line = end.1.atan2(end.0);
            let off = turned(2.0 * (phi - line));
            assert!(off < 1e-9, "{phi}: {off:e}");
        }
    }
}

#[test]
fn a_drive_that_turns_back_or_rests_makes_no_limit_positions() {
    let text = |keys: &str| {
        let text = format!(
            "[inputs]\nphi = {keys}\n[loops]\nA = \"Rz(phi) Tx(40) Rz(alpha) Tx(80) Rz(beta) Tx(-h)\"\n[guess]\nh = 100\n"
        );
        mechanism(
            &Source {
                name: "keys".to_owned(),
                text,
            },
            &[],
        )
    };
    for keys in [
        "{ keys = [[0, 0.5], [1, 1.2], [2, 0.5]], ease = \"smooth\" }",
        "{ keys = [[0, 0.5], [1, 0.9], [2, 0.9], [3, 1.2]], ease = \"smoother\" }",
    ] {
        let found = limits(&text(keys), 60, "h");
        assert!(found.is_empty(), "{keys}: {found:?}");
    }
}

/// Limit positions of outputs of open chains are those of the formula, whatever other outputs there are beside it, how large or
/// small it is, and whether the drive pauses there; what only rounding changes has none.
#[test]
fn outputs_turn_back_where_their_formulas_do() {
    // (duration, inputs, output `w`, time and value of its limits)
    type Limits = &'static [(f64, f64)];
    let smooth = "q = { keys = [[0, 0], [1, 2], [2, 4]], ease = \"smooth\" }";
    let pause = "q = { keys = [[0, 0], [1, 2], [2, 2], [3, 4]] }";
    let handed = "p = { keys = [[0, 0], [1, 1], [2, 1]] }\nq = { keys = [[0, 0], [1, 0], [2, 1]] }";
    let triangle = "q = { keys = [[0, 0], [1, 2], [2, 0]] }";
    let both = "p = { keys = [[0, 0], [1, 1], [2, 0]] }\nq = { keys = [[0, 0], [1, 2], [2, 0]] }";
    let both_smooth = "p = { keys = [[0, 0], [1, 1], [2, 0]], ease = \"smooth\" }\n\
                       q = { keys = [[0, 0], [1, 2], [2, 0]], ease = \"smooth\" }";
    let cases: &[(f64, &str, &str, Limits)] = &[
        (2.0, "q = \"t\"", "(q-1)^2", &[(1.0, 0.0)]),
        (2.0, "q = \"t\"", "1e-20*(q-1)^2", &[(1.0, 0.0)]),
        (2.0, "q = \"t\"", "1e20*(q-1)^2+3", &[(1.0, 3.0)]),
        (
            2.0,
            "q = \"t\"",
            "3*(q-1)^2*q",
            &[(1.0, 0.0), (1.0 / 3.0, 4.0 / 9.0)],
        ),
        // The drive pauses, or rests for a while, and goes on.
        (2.0, smooth, "(q-2)^2", &[(1.0, 0.0)]),
        (3.0, pause, "(q-2)^2", &[(1.0, 0.0)]),
        // One input hands over to another.
        (2.0, handed, "p-q", &[(1.0, 1.0)]),
        // A kink on a sample.
        (4.0, "q = \"pi*t/2\"", "acos(cos(q))", &[(2.0, PI)]),
        // Kinks and cusps have a value, poles have none.
        (4.0, "q = \"t\"", "abs(q-1.777)", &[(1.777, 0.0)]),
        (
            4.0,
            "q = \"t\"",
            "(abs(q-1.777)+1e-9)^0.5",
            &[(1.777, 3.16228e-5)],
        ),
        (4.0, "q = \"t\"", "1/(q-1.777)^2", &[]),
        (4.0, "q = \"t\"", "1/(q-2)^2", &[]),
        (4.0, "q = \"t\"", "-1/abs(q-1.777)", &[]),
        (4.0, "q = \"t\"", "ln(abs(q-1.777))", &[]),
        (4.0, "q = \"t\"", "tan(q)^2", &[(0.0, 0.0), (PI, 0.0)]),
        (
            4.0,
            "q = \"t\"",
            "sqrt(2+abs(ln(abs(q-0.1))))",
            &[(1.1, std::f64::consts::SQRT_2)],
        ),
        (4.0, "q = \"t\"", "-1/(abs(q-1.777)+1e-6)", &[(1.777, -1e6)]),
        // Limits beside poles, on a sample too, and beside values of other sizes.
        (
            4.0,
            "q = \"t\"",
            "1/(q-2.554)^2+cos(5*q)",
            &[
                (0.004829873313, 1.1535955691452688),
                (0.6173000259701779, -0.7318734834073302),
                (1.2972150741652995, 1.6125967160294437),
                (1.7274915599425806, 0.7581333692984275),
                (3.3377371966802682, 1.071595359761687),
                (3.7187224194460136, 1.7045735329573264),
            ],
        ),
        (
            4.0,
            "q = \"t\"",
            "1/abs(q-0.01)^3+(q-3)^2",
            &[(3.01831463356969, 0.037066212586909)],
        ),
        (4.0, "q = \"t\"", "ln(abs(q-2.6))-q", &[(3.6, -3.6)]),
        (
            4.0,
            "q = \"t\"",
            "exp(20*q)+1e6*cos(5*q)",
            &[
                (8.00012800309e-7, 1000001.000008),
                (0.5639271352846551, -869512.1039496674),
            ],
        ),
        // The drive turns back, and only it.
        (2.0, triangle, "q", &[]),
        (2.0, triangle, "exp(q)", &[]),
        (2.0, both, "p+q", &[]),
        (2.0, both_smooth, "p+2*q", &[]),
        // At an end of the motion formulas that would go on are no limits, those that would turn back are.
        (2.0, "q = \"t\"", "10*(q-sin(q))", &[]),
        (2.0, "q = \"t\"", "q^3", &[]),
        (2.0, "q = \"t\"", "q^9", &[]),
        (2.0, "q = \"t\"", "exp(q^3)", &[]),
        (2.0, "q = \"t\"", "q*abs(q)^3", &[]),
        (2.0, "q = \"t\"", "(q-2)^3", &[]),
        (2.0, "q = \"t\"", "(q-2)^5", &[]),
        (2.0, "q = \"t\"", "q^4", &[(0.0, 0.0)]),
        (2.0, "q = \"t\"", "1-cos(q)", &[(0.0, 0.0)]),
        (2.0, "q = \"t\"", "(q-2)^6", &[(2.0, 0.0)]),
        // Nothing but rounding.
        (4.0, "q = \"t\"", "sin(q)^2+cos(q)^2", &[]),
        (4.0, "q = \"t\"", "sin(q)-cos(pi/2-q)", &[]),
        (2.0, "p = \"t\"\nq = { keys = [[0, 0], [2, 1]] }", "q", &[]),
    ];
    for (duration, inputs, output, expected) in cases {
        for beside in ["0*q", "1e12*q", "tan(q)", "1e-12*q"] {
            let text = format!(
                "units = {{ length = \"mm\", angle = \"rad\" }}\nduration = {duration}\n[inputs]\n{inputs}\n\
                 [outputs]\nbeside = \"{beside}\"\nw = \"{output}\"\n"
            );
            let name = "open".to_owned();
            let open = mechanism(&Source { name, text }, &[]);
            for samples in [6, 81] {
                let mut trajectory = solve(&open, &even_times(&open, samples)).unwrap();
                add_limits(&open, &mut trajectory);
                let events = trajectory.events.iter().filter_map(|e| match &e.kind {
                    EventKind::LimitPosition { name, value, .. } if name == "w" => {
                        Some((e.time, *value))
                    }
                    _ => None,
                });
                let found: Vec<(f64, f64)> = events.collect();
                let what = format!("{inputs}, {output} beside {beside}, {samples}: {found:?}");
                assert_eq!(found.len(), expected.len(), "{what}");
                for (time, value) in *expected {
                    let is_there = |(t, v): &(f64, f64)| {
                        (t - time).abs() < 1e-6 && (v - value).abs() <= 1e-9 * value.abs().max(1.0)
                    };
                    assert!(found.iter().any(is_there), "{what}");
                }
            }
        }
    }
}

/// An output that is an unknown turns back where the unknown does, in every built-in scene.
#[test]
fn an_output_turns_back_with_the_unknown_that_it_is() {
    let mut compared = 0;
    for item in builtin::ALL {
        let model = mechanism(&builtin::find_builtin(item.name).unwrap(), &[]);
        let mut trajectory = solve(&model, &even_times(&model, 60)).unwrap();
        add_limits(&model, &mut trajectory);
        let found = |wanted: &str| {
            let events = trajectory.events.iter();
            let limits = events.filter_map(|event| match &event.kind {
                EventKind::LimitPosition {
                    name, is_largest, ..
                } if name == wanted => Some((event.time, *is_largest)),
                _ => None,
            });
            limits.collect::<Vec<_>>()
        };
        let poses: Vec<_> = trajectory
            .samples
            .iter()
            .filter_map(|s| s.pose.as_ref())
            .collect();
        for (k, output) in model.outputs.iter().enumerate() {
            let is_it = |u: usize| poses.iter().all(|pose| pose.outputs[k] == pose.unknowns[u]);
            let Some(unknown) = (0..model.unknowns.len()).find(|u| is_it(*u)) else {
                continue;
            };
            let (of_output, of_unknown) =
                (found(&output.name), found(&model.unknowns[unknown].name));
            assert_eq!(
                of_output.len(),
                of_unknown.len(),
                "{}: {}",
                item.name,
                output.name
            );
            for (a, b) in of_output.iter().zip(&of_unknown) {
                assert!(
                    (a.0 - b.0).abs() < 1e-9 && a.1 == b.1,
                    "{}: {}",
                    item.name,
                    output.name
                );
            }
            compared += 1;
        }
    }
    assert!(compared > 10, "{compared}");
}

#[test]
fn tables_and_reports_have_the_stretches_without_a_pose() {
    let w = Workspace::new();
    let scene = format!(
        "{}/tests/hard/h10-rod-too-short.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    let limit = 0.75_f64.asin().to_degrees();
    let solve = ["solve", &scene, "--out", "-", "--format", "json"];
    for arguments in [&solve[..], &["check", &scene, "--json", "-"]] {
        let run = w.run(arguments).exits(4).says(&[
            "48.590377891 deg",
            "loop `A` does not close",
            "leaves 20.000000 mm",
        ]);
        let document: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
        let gaps = document["gaps"].as_array().unwrap();
        assert_eq!(gaps.len(), 2);
        for (end, exact) in [("from", limit), ("until", 180.0 - limit)] {
            let found = gaps[0][end]["inputs"]["phi"].as_f64().unwrap();
            assert!((found - exact).abs() < 5e-8, "{found}");
        }
        assert_eq!(gaps[0]["widest"]["loop"], "A");
    }
    let never = ["check", &scene, "--input", "phi=90"];
    w.run(&never)
        .exits(4)
        .says(&["poses were found for `phi` from -48.590377891 deg to 48.590377891 deg"]);
}

#[test]
fn the_table_has_them_when_asked() {
    let w = Workspace::new();
    let arguments = ["solve", "slider-crank", "--out", "-", "--format", "json"];
    let events = |more: &[&str]| {
        let run = w.run(&[&arguments[..], more].concat()).exits(0);
        let document: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
        document["events"].as_array().unwrap().clone()
    };
    assert!(events(&[]).is_empty());
    let limits = events(&["--events"]);
    let of_h: Vec<_> = limits.iter().filter(|e| e["coordinate"] == "h").collect();
    assert_eq!(of_h.len(), 2, "{limits:?}");
    assert_eq!(of_h[1]["kind"], "limit-position");
    assert_eq!(of_h[1]["extreme"], "smallest");
    assert!((of_h[1]["value"].as_f64().unwrap() - 40.0).abs() < 1e-12);
}

/// A place where a value turns back is no place where it is least or greatest of all: the sentence says so.
#[test]
fn turning_back_is_a_local_word() {
    let w = Workspace::new();
    for (output, kinds) in [
        (
            "sin(3*phi) + 0.3*sin(phi)",
            ["local minimum", "local maximum"],
        ),
        (
            "psi + 0.001*sin(2000*phi)",
            ["local minimum", "local maximum"],
        ),
    ] {
        let scene = format!(
            "duration = 4\nunits = {{ length = \"mm\", angle = \"deg\" }}\n[inputs]\nphi = \"30 + 200*t/4\"\n[chains]\n\
             T13 = \"Rz(phi) Tx(35) Rz(alpha)\"\nT14 = \"Tx(105) Rz(psi)\"\n[loops]\n\
             A = \"T13 Tx(95) Rz(mu) inv(T14 Tx(80))\"\n[guess]\nalpha = 60\npsi = 90\nmu = 70\n\
             [outputs]\no = \"{output} + 0*psi\"\n"
        );
        w.write("local.toml", scene);
        let run = w.run(&[
            "solve",
            "local.toml",
            "--events",
            "--samples",
            "41",
            "--out",
            "x.csv",
        ]);
        let run = run.exits(0);
        let lines = run.stderr.lines().filter(|line| line.contains("`o`"));
        let mut count = 0;
        for line in lines {
            count += 1;
            assert!(line.contains("turns back at"), "{line}");
            assert!(kinds.iter().any(|kind| line.contains(kind)), "{line}");
            assert!(
                !line.contains("smallest") && !line.contains("largest"),
                "{line}"
            );
        }
        assert!(count >= 2, "{}", run.stderr);
    }
}

/// A gap is of the motion that is followed: another assembly that closes inside is neither denied nor measured.
#[test]
fn words_of_a_gap_leave_room_for_other_assemblies() {
    let w = Workspace::new();
    w.write(
        "contact.toml",
        "units = { length = \"mm\", angle = \"deg\" }\nduration = 1\n[inputs]\nu = \"360*t\"\n[chains]\n\
         a = \"Rz(u)\"\ns2 = \"Rz(u) Ty(0.4) Tx(h)\"\n[contacts.c]\n\
         first = { torus = { ring = 3, tube = 1 }, frame = \"Rx(90)\" }\n\
         second = { sphere = { radius = 0.5 }, frame = \"s2\" }\n[parameters]\nk = 1\n",
    );
    let run = w.run(&["check", "contact.toml"]).exits(4);
    let run = run.says(&[
        "the motion has no pose between",
        "contact `c` cannot be made",
        "other assemblies may have one",
    ]);
    assert!(
        !run.stderr.contains("no pose exists there"),
        "{}",
        run.stderr
    );
    // They do.
    let modes = w.run(&["modes", "contact.toml", "--at", "0.1"]).exits(0);
    assert!(
        modes.text().contains("2 assemblies found"),
        "{}",
        modes.text()
    );
}

/// What an output depends on, through other outputs and traced points, is enough for its value.
#[test]
fn needed_slots_are_those_of_all() {
    let text = format!(
        "{}[[traces]]\nname = \"tip\"\nbody = \"crank\"\npoint = [40, 0, 0]\n\
         [outputs]\na = \"tip.x + h\"\nb = \"2*h\"\nc = \"a*a\"\nd = \"b + c\"\ne = \"phi\"\n",
        crate::program::moving()
    );
    let name = "s.toml".to_owned();
    let scene = load_scene(&Source { name, text }, &Overrides::default()).unwrap();
    let mechanism = &scene.mechanism;
    let coordinates: Vec<f64> = (1..=mechanism.coordinate_count())
        .map(|k| 0.3 * k as f64)
        .collect();
    let all = observed_slots(mechanism, &coordinates);
    let first = all.len() - 5;
    // Traced points and outputs on which each output depends, itself included.
    for (output, count) in [4, 1, 5, 7, 1].into_iter().enumerate() {
        let needed = dependencies(mechanism, &[first + output]);
        let some = needed_slots(mechanism, &coordinates, |slot| needed[slot]);
        assert_eq!(some[first + output], all[first + output], "{output}");
        let computed = &some[coordinates.len()..];
        let computed = computed.iter().filter(|value| !value.is_nan()).count();
        assert_eq!(computed, count, "{output}");
    }
}
