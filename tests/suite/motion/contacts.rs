//! Contacts of surfaces: every pair by its geometry, the torus series against the figures in print and its lower-pair
//! twins, sliding and screwing outputs.
// References keep the digits they were given with.
#![allow(clippy::excessive_precision)]

use crate::driven::{Driven, Model, add_derivatives, certify_motion, solve};
use glam::DVec3;
use mechanim::kinematics::results::certificate::Certificate;
use mechanim::kinematics::results::trajectory::EventKind;

use mechanim::kinematics::freedoms::mobility::Mobility;

use mechanim::kinematics::assemblies::{DEFAULT_STARTS, Mode, find_modes};
use mechanim::kinematics::rates::columns::{RateColumns, RateVariable};

use crate::program::Workspace;
use crate::reference::Table;
use crate::reference::scenes::{scene, turned, value, whole, written};
use std::f64::consts::TAU;

/// Outward normal of a surface at the point of it nearest to `p`, and how far `p` is off it; in the surface's frame.
fn normal_at(surface: &str, p: DVec3) -> (DVec3, f64) {
    match surface {
        "plane = {}" => (DVec3::Z, p.z),
        "sphere = { radius = 1.5 }" => (p.normalize(), p.length() - 1.5),
        "cylinder = { radius = 1.2 }" => {
            let out = DVec3::new(p.x, p.y, 0.0);
            (out.normalize(), out.length() - 1.2)
        }
        _ => {
            let out = DVec3::new(p.x, p.y, 0.0);
            let from_ring = p - out.normalize() * 3.0;
            (from_ring.normalize(), from_ring.length() - 0.8)
        }
    }
}

#[test]
fn surfaces_of_every_pair_touch_in_the_point_with_opposite_normals() {
    let surfaces = [
        "torus = { ring = 3, tube = 0.8 }",
        "sphere = { radius = 1.5 }",
        "cylinder = { radius = 1.2 }",
        "plane = {}",
    ];
    for first in surfaces {
        for second in surfaces {
            // Along a line and all over, contact takes one and two freedoms more: the second body may tilt.
            let tilts = match (first, second) {
                ("plane = {}", "plane = {}") => "Rx(a) Ry(e)",
                ("plane = {}", "cylinder = { radius = 1.2 }")
                | ("cylinder = { radius = 1.2 }", "plane = {}") => "Rx(a)",
                _ => "",
            };
            let turned = if second == "plane = {}" {
                "Rx(pi)"
            } else {
                "Rx(1.2)"
            };
            let text = format!(
                "duration = 1\n[inputs]\nb = \"0.4 + 0.3*t\"\n[chains]\none = \"Ry(b) Tx(2) Rx(0.3)\"\n\
                 two = \"Tx(3.4) Tz(z) {turned} {tilts} Ry(0.25)\"\n[contacts.c]\nfirst = {{ {first}, frame = \"one\" }}\n\
                 second = {{ {second}, frame = \"two\" }}\n[guess]\nz = 6\n[[bodies]]\nname = \"one\"\nframe = \"one\"\n\
                 [[bodies]]\nname = \"two\"\nframe = \"two\"\n[outputs]\npx = \"c.point.x\"\npy = \"c.point.y\"\n\
                 pz = \"c.point.z\"\nnx = \"c.normal.x\"\nny = \"c.normal.y\"\nnz = \"c.normal.z\"\n"
            );
            let mechanism = written(&text);
            let trajectory = solve(&mechanism, &[0.0, 0.25, 0.5, 0.75, 1.0]).unwrap();
            assert_eq!(trajectory.missing(), 0, "{first} on {second}");
            for pose in whole(&trajectory) {
                let [point, normal] = [0, 3].map(|k| DVec3::from_slice(&pose.outputs[k..k + 3]));
                for (body, surface, sign) in [(0, first, 1.0), (1, second, -1.0)] {
                    let local = pose.bodies[body].inverse().transform_point(point);
                    let (outward, off) = normal_at(surface, local);
                    let outward = pose.bodies[body].transform_vector(outward);
                    assert!(
                        off.abs() < 1e-12,
                        "{first} on {second}: {off:e} off {surface}"
                    );
                    let error = (outward * sign - normal).length();
                    assert!(
                        error < 1e-12,
                        "{first} on {second}: normal of {surface}, {error:e}"
                    );
                }
            }
        }
    }
}

#[test]
fn contacts_carry_slides_and_screws_as_well_as_turns() {
    // A ball on a crank lifts a plane: a scotch yoke, z = 12 + 3 + 10 sin(beta), by hand.
    let slide = "units = { length = \"mm\" }\nduration = 1\n[inputs]\nbeta = \"2*pi*t\"\n[chains]\n\
        ball = \"Ry(-beta) Tx(10)\"\nyoke = \"Tz(z)\"\n[contacts.c]\n\
        first = { sphere = { radius = 3 }, frame = \"ball\" }\n\
        second = { plane = {}, frame = \"yoke Rx(pi)\" }\n[outputs]\nmu = \"c.pressure_angle\"\nx = \"c.point.x\"\n";
    // The same yoke as a nut on a screw of pitch 8: z = 8 a / (2 pi).
    let screw = slide.replace("Tz(z)", "Hz(8, a)");
    for text in [slide.to_owned(), screw] {
        let mechanism = written(&text);
        let times: Vec<f64> = (0..40).map(|k| 0.025 * k as f64).collect();
        let trajectory = solve(&mechanism, &times).unwrap();
        for (time, pose) in times.iter().zip(whole(&trajectory)) {
            let beta = TAU * time;
            let height = 3.0 + 10.0 * beta.sin();
            let is_screw = mechanism.unknowns.iter().any(|c| c.name == "a");
            let (name, expected) = if is_screw {
                ("a", height * TAU / 8.0)
            } else {
                ("z", height)
            };
            assert!(
                (value(&mechanism, pose, name) - expected).abs() < 1e-11,
                "{time} {name}"
            );
            assert!(
                (value(&mechanism, pose, "x") - 10.0 * beta.cos()).abs() < 1e-11,
                "{time}"
            );
            if !is_screw {
                assert!(
                    value(&mechanism, pose, "mu").abs() < 1e-12,
                    "the plane is pushed straight"
                );
            }
        }
    }
}

/// A scene of the series and the rows of the reference that belong to it.
struct Pair {
    scene: &'static str,
    parameters: &'static [(&'static str, &'static str)],
    mechanism: &'static str,
    /// Column of the pressure angle, where the scene has one.
    pressure: Option<&'static str>,
}

const fn pair(
    scene: &'static str,
    mechanism: &'static str,
    pressure: Option<&'static str>,
) -> Pair {
    Pair {
        scene,
        parameters: &[],
        mechanism,
        pressure,
    }
}

#[test]
fn higher_pairs_and_their_lower_pair_twins_turn_alike() {
    let table = Table::read("torus_ref");
    for case in [
        pair("torus-torus", "torus-torus", Some("mu_deg")),
        pair("seven-r", "torus-torus", Some("mu_deg")),
        pair("sphere-torus", "sphere-torus", Some("mu_drawn_deg")),
        Pair {
            parameters: &[("s1", "0"), ("s2", "8.86")],
            ..pair("sphere-torus", "sphere-torus", Some("mu_deg"))
        },
        pair("rsrrr", "sphere-torus", Some("mu_deg")),
        pair("rurrrr", "sphere-torus", Some("mu_drawn_deg")),
        pair("sphere-sphere", "sphere-sphere", Some("mu_drawn_deg")),
        Pair {
            parameters: &[("s1", "0"), ("s2", "7.89")],
            ..pair("sphere-sphere", "sphere-sphere", Some("mu_deg"))
        },
        Pair {
            parameters: &[("c1", "2.74"), ("c2", "13.26"), ("s1", "0"), ("s2", "7.89")],
            ..pair("sphere-sphere", "sphere-sphere-printed", Some("mu_deg"))
        },
        pair("rsur", "sphere-sphere", Some("mu_deg")),
        pair("rurur", "sphere-sphere", Some("mu_drawn_deg")),
    ] {
        let rows: Vec<usize> = (0..table.len())
            .filter(|r| table.text(*r, "mechanism") == case.mechanism)
            .collect();
        assert_eq!(rows.len(), 72);
        let mechanism = scene(case.scene, case.parameters, &[]);
        let times: Vec<f64> = rows
            .iter()
            .map(|r| table.value(*r, "beta1_deg") / 60.0)
            .collect();
        let mut trajectory = solve(&mechanism, &times).unwrap();
        let columns = RateColumns {
            order: 1,
            by: RateVariable::Input(0),
        };
        add_derivatives(&mechanism, &mut trajectory, columns);
        let ratio = columns
            .headings(&mechanism)
            .iter()
            .position(|(n, _)| n == "d(beta2)/d(beta1)")
            .unwrap();
        for (row, pose) in rows.iter().zip(whole(&trajectory)) {
            let at = format!("{} at {} deg", case.scene, table.value(*row, "beta1_deg"));
            let error = turned(
                value(&mechanism, pose, "beta2") - table.value(*row, "beta2_deg"),
                360.0,
            );
            assert!(error.abs() < 1e-10, "{at}: {error:e}");
            // A distance of two spheres is a general formula, which is not certified.
            if let Certificate::Certified { error_bound, .. } = pose.certificate {
                assert!(error_bound < 1e-10, "{at}: {error_bound:e}");
                let far = error.to_radians().abs() * mechanism.size;
                assert!(far <= error_bound + 1e-13, "{at}: {far:e}");
            } else {
                assert_eq!(case.scene, "sphere-sphere", "{at}");
            }
            let error = pose.derivatives[ratio] - table.value(*row, "k");
            assert!(error.abs() < 1e-12, "{at}, ratio: {error:e}");
            if let Some(column) = case.pressure {
                let error = value(&mechanism, pose, "pressure_angle") - table.value(*row, column);
                assert!(error.abs() < 1e-10, "{at}, pressure angle: {error:e}");
            }
        }
    }
}

/// Largest deviation of the ratio from 0.1 over 180 samples after `start` degrees, largest pressure angle of the turn,
/// and length of the range in which driver and output turn alike.
fn figures(mechanism: &Model, start: usize) -> [f64; 3] {
    let times: Vec<f64> = (0..=1440).map(|k| k as f64 / 240.0).collect();
    let mut trajectory = solve(mechanism, &times).unwrap();
    let columns = RateColumns {
        order: 1,
        by: RateVariable::Input(0),
    };
    add_derivatives(mechanism, &mut trajectory, columns);
    let place = columns
        .headings(mechanism)
        .iter()
        .position(|(n, _)| n == "d(beta2)/d(beta1)")
        .unwrap();
    let poses = whole(&trajectory);
    let ratio = |degrees: usize| poses[4 * (degrees % 360)].derivatives[place];
    let deviation = (1..=180)
        .map(|k| (ratio(start + k) - 0.1).abs())
        .fold(0.0, f64::max);
    let pressure = poses
        .iter()
        .map(|p| value(mechanism, p, "pressure_angle"))
        .fold(0.0, f64::max);
    // Zeros of the ratio by linear interpolation on a grid of a quarter of a degree.
    let quarters = |k: usize| poses[k].derivatives[place];
    let range = (0..1440).map(|k| {
        let (a, b) = (quarters(k), quarters(k + 1));
        match (a > 0.0, b > 0.0) {
            (true, true) => 0.25,
            (true, false) => 0.25 * a / (a - b),
            (false, true) => 0.25 * b / (b - a),
            (false, false) => 0.0,
        }
    });
    [deviation, pressure, range.sum()]
}

#[test]
fn nine_figures_of_the_torus_paper_come_out() {
    let spheres = [("s1", "0"), ("s2", "8.86")];
    let spheres2 = [("s1", "0"), ("s2", "7.89")];
    type Figures<'a> = (&'a str, &'a [(&'a str, &'a str)], usize, [f64; 3]);
    let cases: [Figures; 3] = [
        ("torus-torus", &[], 70, [0.00818, 53.9366, 236.674]),
        ("sphere-torus", &spheres, 118, [0.01512, 59.7165, 230.890]),
        ("sphere-sphere", &spheres2, 38, [0.03385, 60.1216, 232.152]),
    ];
    for (name, parameters, start, expected) in cases {
        let found = figures(&scene(name, parameters, &[]), start);
        for ((found, expected), digit) in found.iter().zip(expected).zip([1e-5, 1e-3, 1e-3]) {
            // Within a unit of the last digit given; the largest pressure angle lies between grid points.
            assert!(
                (found - expected).abs() < digit,
                "{name}: {found} {expected}"
            );
        }
    }
}

#[test]
fn motion_of_contacts_is_proved_between_the_samples() {
    for name in ["torus-torus", "sphere-torus", "sphere-sphere"] {
        let mechanism = scene(name, &[], &[]);
        let times: Vec<f64> = (0..120).map(|k| 0.05 * k as f64).collect();
        let trajectory = solve(&mechanism, &times).unwrap();
        let proved = certify_motion(&mechanism, &trajectory);
        let refused = proved.iter().filter(|i| i.refused.is_some());
        assert_eq!((proved.len(), refused.count()), (119, 0), "{name}");
    }
}

#[test]
fn contacts_leave_the_driver_as_the_only_freedom() {
    for name in ["torus-torus", "sphere-torus", "sphere-sphere"] {
        let mechanism = scene(name, &[], &[]);
        let system = mechanism.system().unwrap();
        let mobility = Mobility::new(&system, &mechanism.actuation);
        assert_eq!(mobility.generic.map(|n| n.mobility), Some(1), "{name}");
    }
}

/// On the near side of the torus' ring always two, on its far side two more from -0.392 to 160.113 degrees.
#[test]
fn nearest_and_farthest_normals_are_assemblies() {
    for (name, degrees, count) in [
        ("sphere-torus", 90.0_f64, 4),
        ("sphere-torus", 159.0, 4),
        ("sphere-torus", 161.0, 2),
        ("sphere-torus", 270.0, 2),
        ("sphere-sphere", 0.0, 2),
    ] {
        let mechanism = scene(name, &[], &[]);
        let system = mechanism.system().unwrap();
        let inputs = [degrees.to_radians()];
        let first = [&mechanism.actuation.guess[..], &inputs].concat();
        let found = find_modes(&system, &first, &[], DEFAULT_STARTS, &|| false);
        assert_eq!(found.list.len(), count, "{name} at {degrees}");
    }
}

#[test]
fn torus_pair_has_eight_assemblies_at_the_start() {
    let mechanism = scene("torus-torus", &[], &[]);
    let system = mechanism.system().unwrap();
    let found = find_modes(
        &system,
        &mechanism.actuation.start_at(0.0),
        &[],
        DEFAULT_STARTS,
        &|| false,
    );
    let k = mechanism
        .unknowns
        .iter()
        .position(|c| c.name == "beta2")
        .unwrap();
    let degrees = |mode: &Mode| mode.coordinates[k].to_degrees().rem_euclid(360.0);
    let mut angles: Vec<f64> = found.list.iter().map(degrees).collect();
    angles.sort_by(f64::total_cmp);
    let expected = [
        71.046417200,
        93.305715278,
        138.688320300,
        163.667781238,
        167.233992475,
        168.970046123,
        169.170372644,
        178.562941313,
    ];
    assert_eq!(angles.len(), expected.len(), "{angles:?}");
    for (found, expected) in angles.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-8, "{found} {expected}");
    }
}

/// A roller on a rocker that an eccentric disc moves: FIRST and SECOND are the surfaces and turn their frames.
const CAM: &str = "units = { angle = \"deg\" }\nduration = 2\n[inputs]\nphi = \"180*t\"\nw = \"5*t\"\n[chains]\n\
    cam = \"Ry(phi) Tx(12) CAM\"\nroller = \"Tx(80) Tz(10) Ry(psi) Tx(-70) Tz(40) ROLLER\"\n[contacts.k]\n\
    first = { SURFACE = { radius = 30 }, frame = \"cam\" }\nsecond = { SURFACE = { radius = 10 }, frame = \"roller\" }\n\
    [guess]\npsi = -8\n[[bodies]]\nname = \"roller\"\nframe = \"roller\"\n[outputs]\nx = \"k.point.x\"\nz = \"k.point.z\"\n\
    mu = \"k.pressure_angle\"\n";

/// The rocker's angle where its roller's centre is 40 from the disc's: a circle about the pivot cut by one about the disc's
/// centre.
fn rocker(phi: f64) -> f64 {
    let centre = [12.0 * phi.cos() - 80.0, -12.0 * phi.sin() - 10.0];
    let (away, arm) = (centre[0].hypot(centre[1]), 70f64.hypot(40.0));
    let corner = (arm * arm + away * away - 40.0 * 40.0) / (2.0 * arm * away);
    // Turning about y takes x towards -z.
    40f64.atan2(-70.0) - centre[1].atan2(centre[0]) + corner.acos()
}

#[test]
fn parallel_cylinders_are_a_planar_contact() {
    let cam = |surface: &str, first: &str, second: &str| {
        let text = CAM.replace("SURFACE", surface).replace("ROLLER", second);
        written(&text.replace("CAM", first))
    };
    let times: Vec<f64> = (0..81).map(|k| 0.025 * k as f64).collect();
    let spheres = cam("sphere", "E", "E");
    let of_spheres = solve(&spheres, &times).unwrap();
    // Axes the same way and the opposite way, shifted along, shifted while they turn.
    let turns = [
        ("Rx(90)", "Rx(90)", true),
        ("Rx(90)", "Rx(-90)", true),
        ("Rx(-90)", "Rx(90) Tz(3)", true),
        ("Rx(90) Rz(20) Tz(-5)", "R(1, 0, 0, -90) Rz(35) Tz(7)", true),
        ("Ty(w) Rx(90)", "Rx(90) Tz(-2)", false),
    ];
    for (first, second, is_planar) in turns {
        let case = format!("{first} on {second}");
        let model = cam("cylinder", first, second);
        let trajectory = solve(&model, &times).unwrap();
        for ((time, pose), sphere) in times.iter().zip(whole(&trajectory)).zip(whole(&of_spheres)) {
            // Shifts along the axes cancel by their numbers, not by the axes alone.
            let is_proved = match pose.certificate {
                Certificate::Certified { .. } => true,
                Certificate::Consistent { .. } => case.contains("Tz") || case.contains("Rz"),
                _ => false,
            };
            assert!(is_proved, "{case} at {time}: {:?}", pose.certificate);
            let exact = rocker(180.0 * time * TAU / 360.0).to_degrees();
            let error = turned(value(&model, pose, "psi") - exact, 360.0);
            assert!(error.abs() < 1e-11, "{case} at {time}: {error:e}");
            for name in ["psi", "x", "z", "mu"] {
                let error = value(&model, pose, name) - value(&spheres, sphere, name);
                assert!(error.abs() < 2e-12, "{case} at {time}: {name} {error:e}");
            }
        }
        let mobility = Mobility::new(&model.system().unwrap(), &model.actuation);
        let freedoms = if is_planar { 1 } else { 2 };
        assert_eq!(mobility.count.freedoms(), freedoms as i64, "{case}");
        assert_eq!(
            mobility.generic.map(|n| n.mobility),
            Some(freedoms),
            "{case}"
        );
        assert_eq!(
            mobility.count.planar_dependents().is_some(),
            is_planar,
            "{case}"
        );
    }
}

#[test]
fn cylinders_whose_axes_become_parallel_are_named() {
    // A parallelogram keeps its coupler upright, which its chain does not show.
    let text = "units = { angle = \"deg\" }\nduration = 1\n[inputs]\na = \"30 + 20*t\"\n[chains]\n\
        coupler = \"Rx(a) Ty(100) Rx(b)\"\nslide = \"Ty(60) Tx(s) TILT\"\n[loops]\n\
        P = \"coupler Tz(50) Rx(d) inv(Tz(50) Rx(c) Ty(100))\"\n[contacts.k]\n\
        first = { cylinder = { radius = 30 }, frame = \"coupler\" }\n\
        second = { cylinder = { radius = 10 }, frame = \"slide\" }\n[guess]\nb = -30\nc = 30\nd = 0\ns = 60\n\
        [[bodies]]\nname = \"slide\"\nframe = \"slide\"\n";
    for (tilt, is_parallel) in [("E", true), ("Rx(5)", false)] {
        let model = written(&text.replace("TILT", tilt));
        let trajectory = solve(&model, &[0.0, 0.5]).unwrap();
        let mut kinds = trajectory.events.iter().map(|e| &e.kind);
        let named =
            kinds.any(|k| matches!(k, EventKind::AxesParallel { contact } if contact == "k"));
        assert_eq!(named, is_parallel, "{tilt}");
    }
}

#[test]
fn spheres_on_a_turntable_do_not_feel_it() {
    // The centres are 5 apart: a triangle with sides 4, 5 and the slider.
    let text = "duration = 1\n[inputs]\na = \"0.4 + t\"\nswing = \"2*t\"\n[chains]\ntable = \"Rx(swing) Tz(2)\"\n\
        [contacts.k]\nfirst = { sphere = { radius = 3 }, frame = \"table Rz(a) Tx(4)\" }\n\
        second = { sphere = { radius = 2 }, frame = \"table Tx(s)\" }\n[guess]\ns = 8\n\
        [[bodies]]\nname = \"slider\"\nframe = \"table Tx(s)\"\n";
    let model = written(text);
    let swing = model.unknowns.len() + 1;
    assert!(!model.equations[0].expression.slots().contains(&swing));
    let trajectory = solve(&model, &[0.0, 0.5, 1.0]).unwrap();
    for sample in &trajectory.samples {
        let (sin, cos) = sample.inputs[0].sin_cos();
        let pose = sample.pose.as_ref().unwrap();
        let exact = 4.0 * cos + (25.0 - 16.0 * sin * sin).sqrt();
        assert!((value(&model, pose, "s") - exact).abs() < 1e-13);
    }
}

/// A scene of nothing but contacts has no length in a loop: its own radii tell how large it is.
#[test]
fn contacts_alone_are_judged_alike_at_any_scale() {
    let folder = Workspace::new();
    for power in -9..=9 {
        let scale = format!("1e{power}");
        let text = format!(
            "duration = 1\n[inputs]\nphi = \"{scale}*(3 + sin(2*t))\"\n[chains]\ncam = \"Ty(phi)\"\nroller = \"Ty(-3*{scale}) Tx(x)\"\n\
             [contacts.c]\nfirst = {{ sphere = {{ radius = 4e{power} }}, frame = \"cam\" }}\n\
             second = {{ sphere = {{ radius = 5e{power} }}, frame = \"roller\" }}\n[guess]\nx = 6e{power}\n"
        );
        folder.write("contact.toml", text);
        let run = folder
            .run(&["check", "contact.toml", "--json", "-"])
            .exits(0);
        let report: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
        let size = report["size"].as_f64().unwrap() / 10f64.powi(power);
        assert!((1.0..30.0).contains(&size), "{power}: {size}");
        assert_eq!(report["between"]["proved"], true, "{power}");
    }
}
