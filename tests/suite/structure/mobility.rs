//! Mobility by count and by rank, idle freedoms, over-constrained loops that move, and the order of solution.

use crate::driven::{Driven, Model, even_times, solve};
use mechanim::diag::Source;
use mechanim::kinematics::freedoms::mobility::Mobility;
use mechanim::kinematics::results::trajectory::{ClosedPose, EventKind, Trajectory};
use mechanim::kinematics::structure::block::StructureError;

use crate::program::Workspace;
use mechanim::model::mechanism::Mechanism;
use mechanim::scene::{Overrides, builtin, load_scene};
use std::f64::consts::PI;

fn read(text: &str) -> Model {
    let source = Source {
        name: "test".into(),
        text: text.into(),
    };
    let scene = load_scene(&source, &Overrides::default());
    Model::from(scene.unwrap_or_else(|e| panic!("{:#?}", e.diagnostics)))
}

fn file(name: &str) -> String {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/mobility");
    std::fs::read_to_string(format!("{folder}/{name}.toml")).unwrap()
}

/// A built-in scene, or one of `tests/data/mobility`.
fn text_of(name: &str) -> String {
    match name {
        // The lecture's own count has a ball joint where the scene has a universal one.
        "gearshift-ball" => gearshift_with_ball(),
        _ => builtin::find_builtin(name).map_or_else(|| file(name), |source| source.text),
    }
}

fn gearshift_with_ball() -> String {
    let text = builtin::find_builtin("gearshift").unwrap().text;
    let ball = text.replace("Tz(-L7) Rx(a13)", "Tz(-L7) Rz(spin) Rx(a13)");
    assert_ne!(ball, text);
    ball
}

fn run(mechanism: &Model, samples: usize) -> Trajectory {
    let trajectory = solve(mechanism, &even_times(mechanism, samples)).unwrap();
    assert_eq!(trajectory.missing(), 0, "{:?}", trajectory.events);
    for pose in trajectory.poses() {
        assert!(pose.closure_error < 1e-14, "{}", pose.closure_error);
        assert_eq!(pose.rank, mechanism.unknowns.len());
        assert!(pose.certificate.bounds().is_some());
    }
    trajectory
}

fn unknown(mechanism: &Mechanism, pose: &ClosedPose, name: &str) -> f64 {
    let index = mechanism.unknowns.iter().position(|u| u.name == name);
    pose.unknowns[index.unwrap()]
}

/// Distance of two angles, whole turns aside.
fn apart(a: f64, b: f64) -> f64 {
    let turns = ((a - b) / (2.0 * PI)).round();
    (a - b - 2.0 * PI * turns).abs()
}

#[test]
fn count_and_rank_of_known_mechanisms() {
    // Name; mobility by count; by rank; redundant equations; idle: what moves.
    let known: [(&str, i64, usize, usize, &[&str]); 10] = [
        ("slider-crank", 1, 1, 0, &[]),
        ("gearshift", 2, 2, 0, &[]),
        ("gearshift-ball", 3, 3, 0, &["a12 spin"]),
        ("rssr-balls", 2, 2, 0, &["a b c d"]),
        ("sphere-on-sphere", 3, 3, 0, &["c d f"]),
        ("bennett", -2, 1, 3, &[]),
        ("goldberg", -1, 1, 2, &[]),
        ("bricard", 0, 1, 1, &[]),
        ("sarrus", 0, 1, 1, &[]),
        ("four-bar-and-bennett", -2, 1, 3, &[]),
    ];
    for (name, count, rank, redundant, idle) in known {
        let mechanism = read(&text_of(name));
        let system = mechanism.system().unwrap_or_else(|e| panic!("{name}: {e}"));
        let mobility = Mobility::new(&system, &mechanism.actuation);
        assert_eq!(mobility.count.freedoms(), count, "{name}");
        assert_eq!(mobility.generic.unwrap().mobility, rank, "{name}");
        assert_eq!(mobility.at_start, mobility.generic, "{name}");
        assert_eq!(mobility.redundant.len(), redundant, "{name}");
        assert!(mobility.conditions.is_empty(), "{name}");
        let moving = mobility.idle.iter().map(|held| {
            let names = held
                .moving
                .iter()
                .map(|u| mechanism.unknowns[*u].name.as_str());
            names.collect::<Vec<_>>().join(" ")
        });
        assert_eq!(moving.collect::<Vec<_>>(), idle, "{name}");
    }
}

/// Mobility of a scene, over-constrained or not, that can be analysed.
fn mobility_of(text: &str) -> Mobility {
    let scene = read(text);
    let system = scene.system().unwrap();
    Mobility::new(&system, &scene.actuation)
}

/// Joint freedoms, what loops cost, other coordinates less equations and couplings; the freedoms that there are.
type ByHand = (&'static str, usize, &'static [usize], i64, usize);

/// R revolute, P prismatic, C cylindrical, U universal, S spherical.
const BUILT_IN: [ByHand; 25] = [
    // 4R
    ("bennett", 4, &[6], 0, 1),
    // 6R
    ("bricard", 6, &[6], 0, 1),
    // 10R between eight links
    ("dyads", 10, &[3, 3, 3], 0, 1),
    // R of the crank, 2P of each of its pin and eight points; the pin is on the crank, 16 bars
    ("dyads-bars", 19, &[2], -16, 1),
    // 3R P
    ("feeder", 4, &[3], 0, 1),
    // 4R
    ("four-bar", 4, &[3], 0, 1),
    // C 4R U 4S: shaft, arm, rod, rocker, lever; foot of the short link; balls
    ("gearshift", 20, &[6, 6, 6], 0, 2),
    ("gearshift-optimised", 20, &[6, 6, 6], 0, 2),
    // C 7R 4U 7S: one revolute more for the torsion shaft, two for the gimbal
    ("gearshift-left", 38, &[6, 6, 6, 6, 6, 6], 0, 2),
    // 4R about one point
    ("hooke-joint", 4, &[3], 0, 1),
    // 3R P; the middle stage of the servo follows the others
    ("lifting-arm", 4, &[3], 0, 1),
    // Six pins, four of which join three bars: 10R between eight bars
    ("peaucellier", 10, &[3, 3, 3], 0, 1),
    // R P R P and the drum's R; the rope's length is one equation
    ("rope-drum", 5, &[3], -1, 1),
    // 4R S
    ("rrsrr", 7, &[6], 0, 1),
    ("rsrrr", 7, &[6], 0, 1),
    // R S U R
    ("rsur", 7, &[6], 0, 1),
    // R U 4R
    ("rurrrr", 7, &[6], 0, 1),
    // R U R U R
    ("rurur", 7, &[6], 0, 1),
    // 6R
    ("sarrus", 6, &[6], 0, 1),
    // 7R
    ("seven-r", 7, &[6], 0, 1),
    // 3R P
    ("slider-crank", 4, &[3], 0, 1),
    // 2R; the distance of the centres is one equation
    ("sphere-sphere", 2, &[], -1, 1),
    // 4R; the sphere's centre closes the loop in a point
    ("sphere-torus", 4, &[3], 0, 1),
    // 7R
    ("torus-torus", 7, &[6], 0, 1),
    // 6R 5U 5S
    ("twin-steer", 31, &[6, 6, 6, 6, 6], 0, 1),
];

const HARD: [ByHand; 25] = [
    ("h01-slider-crank", 4, &[3], 0, 1),
    ("h02-slider-drives", 4, &[3], 0, 1),
    ("h03-change-point", 4, &[3], 0, 1),
    ("h04-parallelogram", 4, &[3], 0, 1),
    ("h05-almost-parallelogram", 4, &[3], 0, 1),
    ("h06-kite", 4, &[3], 0, 1),
    // Two bars on a base
    ("h07-near-tangent-circles", 3, &[3], 0, 0),
    // A point held by two bars: two coordinates, two equations
    ("h08-double-root", 0, &[], 0, 0),
    ("h09-structure", 3, &[3], 0, 0),
    ("h10-four-bar-too-short", 4, &[3], 0, 1),
    ("h10-rod-too-short", 4, &[3], 0, 1),
    ("h11-bennett", 4, &[6], 0, 1),
    ("h13-bricard", 6, &[6], 0, 1),
    ("h15-sarrus", 6, &[6], 0, 1),
    // Eight points (16) less a frame (3) on 16 bars
    ("h16-dixon", 0, &[], -3, 1),
    // S P; one angle more, since at their lock two angles of the ball turn about one axis
    ("h18-gimbal-lock", 4, &[6], 0, 1),
    ("h20-six-r", 6, &[6], 0, 0),
    ("h25-angle-wrap", 4, &[3], 0, 1),
    ("h26-scale", 4, &[3], 0, 1),
    ("h27-mixed-units", 4, &[3], 0, 1),
    ("h28-four-bar-1", 4, &[3], 0, 1),
    // 4R, and 3R for every one that follows
    ("h28-four-bars-10", 31, &[3; 10], 0, 1),
    // Two loops of 5R each. The second is written with angles to the frame of pins that belong to the first: of its 2R at
    // the pin that both share one is the first loop's, another follows; and the drive turns two bars alike.
    ("h29-lazy-tongs-3", 10, &[3, 3], -3, 1),
    // 4R about one point
    ("h30-hooke", 4, &[3], 0, 1),
    // Six legs of U P S and the six coordinates of the plate; one drive for six slides
    ("h31-platform", 42, &[6; 6], -5, 1),
];

#[test]
fn counts_are_those_made_by_hand() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/hard");
    let hard = |name: &str| std::fs::read_to_string(format!("{folder}/{name}.toml")).unwrap();
    let built_in = BUILT_IN.map(|row| (row, text_of(row.0)));
    let files = std::fs::read_dir(folder).unwrap().filter(|f| {
        let path = f.as_ref().unwrap().path();
        path.extension().is_some_and(|e| e == "toml")
    });
    assert_eq!(files.count(), HARD.len());
    assert_eq!(builtin::ALL.len(), BUILT_IN.len());
    for ((name, joints, loops, rest, freedoms), text) in built_in
        .into_iter()
        .chain(HARD.map(|row| (row, hard(row.0))))
    {
        let mobility = mobility_of(&text);
        let count = &mobility.count;
        assert_eq!(count.joints, joints, "{name}");
        let found: Vec<usize> = count.closing().map(|l| l.dimension).collect();
        assert_eq!(found, loops, "{name}");
        let by_hand = (joints as i64) - (loops.iter().sum::<usize>() as i64) + rest;
        assert_eq!(count.freedoms(), by_hand, "{name}");
        assert!(!count.is_by_coordinates, "{name}");
        match mobility.generic {
            Some(numeric) => assert_eq!(numeric.mobility, freedoms, "{name}"),
            None => assert_eq!(name, "h10-four-bar-too-short"),
        }
    }
}

#[test]
fn vector_loops_have_their_dependent_coordinates() {
    for (name, dependent, coordinates) in [("dyads", 6, 7), ("feeder", 2, 3), ("four-bar", 2, 3)] {
        let count = mobility_of(&text_of(name)).count;
        assert_eq!(count.planar_dependents(), Some(dependent), "{name}");
        assert_eq!(count.freedoms() + dependent as i64, coordinates, "{name}");
    }
}

#[test]
fn the_count_does_not_depend_on_the_angles_that_a_loop_is_written_in() {
    let loops = [
        "Rz(a) Tx(40) Rz(b) Tx(90) Rz(c) Tx(-70) Rz(-d) Tx(-100)",
        "Rz(a) Tx(40) Rz(b - a) Tx(90) Rz(d - b) Tx(-70) Rz(-d) Tx(-100)",
        "Rz(a) Tx(40) Rz(-a) Rz(b) Tx(90) Rz(-b) Rz(d) Tx(-70) Rz(-d) Tx(-100)",
        "Tx(-100) Rz(a) Tx(40) Rz(2*b - a) Tx(90) Rz(d - 2*b) Tx(-70) Rz(-d)",
    ];
    for chain in loops {
        let text = format!(
            "duration = 1\n[inputs]\na = \"1 + t\"\n[loops]\nA = \"{chain}\"\n[guess]\nb = 0.3\nd = 1.3\n"
        );
        let mobility = mobility_of(&text);
        assert_eq!(mobility.count.freedoms(), 1, "{chain}");
        assert_eq!(mobility.generic.unwrap().mobility, 1, "{chain}");
    }
}

#[test]
fn open_chains_and_joints_that_move_alike_are_counted() {
    let bodies = |frames: &[&str]| -> String {
        let body = |(k, frame): (usize, &&str)| {
            format!("[[bodies]]\nname = \"b{k}\"\nframe = \"{frame}\"\n")
        };
        frames.iter().enumerate().map(body).collect()
    };
    let inputs = "duration = 1\n[inputs]\nu = \"t\"\nv = 0.1\n";
    // Two driven joints in a row; a wheel that is geared to another one is placed by it.
    let arm = bodies(&["Rz(u)", "Rz(u) Tx(50) Rz(v)"]);
    let gears = bodies(&["Rz(u)", "Tx(50) Rz(-2*u)", "Tx(90) Rz(v)"]);
    // A five-bar whose cranks are geared: five revolutes, a loop, a pair of gears.
    let five = "[loops]\nA = \"Rz(u) Tx(40) Rz(a) Tx(90) Rz(b) Tx(-90) Rz(c) Tx(-40) Rz(u - v) Tx(-60)\"\n[guess]\na = 0.2\nb = 1\n";
    for (text, joints, shared, freedoms) in [
        (format!("{inputs}{arm}"), 2, 0, 2),
        (format!("{inputs}{gears}"), 2, 0, 2),
        (format!("{inputs}{five}"), 5, 0, 2),
        (
            format!(
                "duration = 1\n[inputs]\nu = \"t\"\n{}",
                five.replace("u - v", "u")
            ),
            5,
            1,
            1,
        ),
    ] {
        let mobility = mobility_of(&text);
        let count = &mobility.count;
        assert_eq!((count.joints, count.shared), (joints, shared), "{text}");
        assert_eq!(count.freedoms(), freedoms, "{text}");
        if let Some(numeric) = mobility.generic {
            assert_eq!(numeric.mobility as i64, freedoms, "{text}");
        }
    }
}

/// Sums and differences of coordinates are freedoms of their own as long as they are independent, in whatever order.
#[test]
fn joints_driven_by_sums_of_coordinates_are_counted() {
    for (frames, freedoms) in [
        (&["Tx(20*(u+v)) Ty(20*(u-v))"][..], 2),
        (&["Rz((u+v)/2) Rx((u-v)/2)"], 2),
        (&["Rz(u+v+w) Rx(u-v) Rz(w-v)"], 3),
        (&["Rz(v-u)", "Tx(30) Rz(u)"], 2),
        (&["Rz(u)", "Tx(30) Rz(v-u)"], 2),
        (&["Ry(v-u) Ry(u)"], 2),
        // The third follows the other two.
        (&["Rz(u)", "Tx(30) Rz(v)", "Tx(60) Rz(u+2*v)"], 2),
    ] {
        let mut text = "duration = 1\n[inputs]\nu = \"t\"\nv = 0.1\nw = 0.2\n".to_owned();
        for (k, frame) in frames.iter().enumerate() {
            text += &format!("[[bodies]]\nname = \"b{k}\"\nframe = \"{frame}\"\n");
        }
        assert_eq!(mobility_of(&text).count.freedoms(), freedoms, "{text}");
    }
}

/// A joint that a sum of coordinates moves has one freedom, and what equations know of its terms beside it is counted too:
/// the count is the rank, however the angles are written.
#[test]
fn terms_of_a_sum_that_moves_a_joint_are_counted_in_equations() {
    let planet = |frame: &str| {
        format!(
            "inputs = {{ q = \"t\" }}\nequations = {{ gear = \"20*p - 50*q\" }}\n\
             bodies = [ {{ name = \"carrier\", frame = \"Tx(0)\" }}, {{ name = \"planet\", frame = \"Tx(30) {frame}\" }} ]\n"
        )
    };
    let crank = |angle: &str, inputs: &str, equations: &str| {
        format!(
            "units = {{ angle = \"rad\" }}\ninputs = {{ {inputs} }}\nequations = {{ {equations} }}\n\
             loops = {{ L = \"Rz({angle}) Tx(30) Rz(b) Tx(90) Rz(c) Tx(-s)\" }}\nguess = {{ b = -0.7, c = 0.2, s = 110 }}\n"
        )
    };
    let cases = [
        (planet("Rz(p)"), 1),
        (planet("Rz(p+q)"), 1),
        (planet("Rz(p-q)"), 1),
        (planet("Rz(p+q) Tx(5) Rz(p)"), 1),
        (
            planet("Rz(p+q+w)").replace("q = \"t\"", "q = \"t\", w = 0.1"),
            2,
        ),
        (crank("p", "q = \"0.2+t/3\"", "e = \"p - 3*q\""), 1),
        (crank("p+q", "q = \"0.2+t/3\"", "e = \"p - 2*q\""), 1),
        (
            crank("p-u", "q = \"0.2+t/3\"", "e = \"p - 2*q\", f = \"u - q/2\""),
            1,
        ),
        (
            crank(
                "atan2(y,x)",
                "a = \"0.5+t\"",
                "e = \"x - cos(a)\", f = \"y - sin(a)\"",
            )
            .replace("guess = {", "guess = { x = 0.8, y = 0.5,"),
            1,
        ),
        // At some random poses an arc sine has no value.
        (
            crank("asin(3*y)", "a = \"0.5+0.1*t\"", "f = \"3*y - sin(a)\""),
            1,
        ),
    ];
    for (text, freedoms) in cases {
        let mobility = mobility_of(&format!("duration = 1\n{text}"));
        assert_eq!(mobility.count.freedoms(), freedoms, "{text}");
    }
}

/// Rounding of an equation that always holds is no rank.
#[test]
fn a_parallelogram_whose_loop_always_closes_has_its_freedom() {
    let text = "duration = 1\n[inputs]\nphi = \"0.5 + t\"\n[loops]\n\
        A = \"Rz(phi) Tx(60) Rz(-phi) Tx(80) Rz(phi) Tx(-60) Rz(-phi) Tx(-80)\"\n";
    let mobility = mobility_of(text);
    assert_eq!(mobility.count.freedoms(), 1);
    let numeric = mobility.generic.unwrap();
    assert_eq!((numeric.mobility, numeric.rank), (1, 0));
}

/// A six-bar whose first loop is written from another joint, and the other way round: it lies where it lay.
#[test]
fn the_count_does_not_depend_on_where_a_loop_begins() {
    let ring = [
        "Rz(phi)", "Tx(35)", "Rz(al)", "Tx(95)", "Rz(mu)", "Tx(-80)", "Rz(-psi)", "Tx(-105)",
    ];
    let reversed = [
        "Tx(105)", "Rz(psi)", "Tx(80)", "Rz(-mu)", "Tx(-95)", "Rz(-al)", "Tx(-35)", "Rz(-phi)",
    ];
    for ring in [ring, reversed] {
        for first in 0..ring.len() {
            let turned = [&ring[first..], &ring[..first]].concat().join(" ");
            let text = format!(
                "duration = 1\n[inputs]\nphi = \"0.5 + 0.2*t\"\n[loops]\nA = \"{turned}\"\n\
                B = \"Rz(phi) Tx(35) Rz(al) Tx(45) Ty(40) Rz(b1) Tx(90) Rz(b2) Tx(-90) Rz(-b3) Ty(-60) Tx(-120)\"\n\
                [guess]\nal = 0.4\npsi = 1.5\nmu = 1\nb1 = 0.4\nb2 = 2\nb3 = 1.6\n\
                [[bodies]]\nname = \"crank\"\nframe = \"Rz(phi)\"\n"
            );
            let count = mobility_of(&text).count;
            assert_eq!(
                (count.joints, count.shared, count.freedoms()),
                (7, 0, 1),
                "{turned}"
            );
        }
    }
}

#[test]
fn loops_that_close_in_a_point_are_counted_with_their_three_equations() {
    for name in ["sphere-torus", "sphere-sphere", "torus-torus"] {
        let mechanism = read(&text_of(name));
        let system = mechanism.system().unwrap();
        let mobility = Mobility::new(&system, &mechanism.actuation);
        let inputs = mechanism.inputs.len();
        assert_eq!(mobility.at_start.unwrap().mobility, inputs, "{name}");
        assert_eq!(mobility.count.freedoms(), inputs as i64, "{name}");
        assert!(mobility.redundant.is_empty(), "{name}");
    }
}

#[test]
fn planar_mechanisms_are_counted_as_vector_loops_wherever_their_plane_lies() {
    let tilted = "duration = 1\n[inputs]\nphi = \"t\"\n[loops]\n\
        A = \"R(1, 2, 3, 0.7) Rz(phi) Tx(40) Rz(a) Tx(80) Rz(b) Tx(-h) R(1, 2, 3, -0.7)\"\n[guess]\nh = 120\n";
    for text in [text_of("slider-crank"), tilted.to_owned()] {
        let mechanism = read(&text);
        let system = mechanism.system().unwrap();
        let mobility = Mobility::new(&system, &mechanism.actuation);
        assert_eq!(
            (
                mobility.count.freedoms(),
                mobility.count.planar_dependents()
            ),
            (1, Some(2))
        );
    }
}

#[test]
fn a_ball_joint_more_moves_nothing_else() {
    let (plain, ball) = (read(&text_of("gearshift")), read(&gearshift_with_ball()));
    let (a, b) = (run(&plain, 60), run(&ball, 60));
    for (a, b) in a.poses().zip(b.poses()) {
        for (name, value) in plain.unknowns.iter().map(|u| &u.name).zip(&a.unknowns) {
            assert!((unknown(&ball, b, name) - value).abs() < 1e-12, "{name}");
        }
        assert_eq!(unknown(&ball, b, "spin"), 0.0);
    }
}

#[test]
fn rods_between_ball_joints_are_solved_and_certified() {
    // Closed form: the ends of the rod stay its length apart, here by the bodies' own frames.
    let mechanism = read(&file("rssr-balls"));
    for pose in run(&mechanism, 200).poses() {
        let (phi_end, g) = (pose.bodies[0].translation, unknown(&mechanism, pose, "g"));
        let base = glam::DVec3::new(30.0, 50.0, 70.0);
        let rocker = base + glam::DVec3::new(0.0, 60.0 * g.cos(), -60.0 * g.sin());
        assert!(((rocker - phi_end).length() - 100.0).abs() < 1e-11);
    }
    let mechanism = read(&file("sphere-on-sphere"));
    let trajectory = run(&mechanism, 50);
    for (sample, pose) in trajectory.samples.iter().zip(trajectory.poses()) {
        let across: f64 = sample.inputs.iter().map(|v| v * v).sum();
        let height = unknown(&mechanism, pose, "h");
        assert!((height - (2500.0 - across).sqrt()).abs() < 1e-12);
    }
}

#[test]
fn two_rods_have_two_idle_freedoms_and_a_missing_input_is_still_named() {
    // A platform on a slider held by one rod, and a second rod beside it; the platform's turn about y is free to z.
    let rod = |k: usize, x: f64| {
        format!(
            "R{k} = \"Tx({x}) Rx(a{k}) Ry(b{k}) Rz(c{k}) Tz(50) Rx(d{k}) Ry(e{k}) Rz(f{k}) Tx(-{x}) Ry(-turn) Tz(-h) Tx(-s)\"\n"
        )
    };
    let loops = format!("[loops]\n{}{}[guess]\nh = 45\n", rod(1, 0.0), rod(2, 30.0));
    let mechanism = read(&format!(
        "duration = 1\n[inputs]\ns = \"10 + 5*t\"\n{loops}"
    ));
    let system = mechanism.system().unwrap();
    let name = |u: usize| mechanism.unknowns[u].name.as_str();
    let held: Vec<&str> = system
        .structure()
        .held
        .iter()
        .map(|h| name(h.unknown))
        .collect();
    assert_eq!(held, ["c1", "c2"]);
    run(&mechanism, 20);
    // With `s` an unknown the parallelogram moves: that is no spin of a link.
    let error = read(&format!("duration = 1\n{loops}"))
        .system()
        .unwrap_err();
    let StructureError::UnderDetermined { freedoms, names } = error else {
        panic!("{error:?}")
    };
    assert_eq!(freedoms, 1);
    assert!(names.contains(&"s".to_owned()), "{names:?}");
}

#[test]
fn what_a_trace_or_an_output_shows_is_not_idle() {
    let text = file("rssr-balls");
    for seen in [
        "[[traces]]\nname = \"P\"\nbody = \"rod\"\npoint = [50, 5, 0]\n",
        "[outputs]\nspin = \"d\"\n",
    ] {
        let mechanism = read(&format!("{text}\n{seen}"));
        let error = mechanism.system().unwrap_err();
        let StructureError::UnderDetermined { freedoms, .. } = error else {
            panic!("{error:?}")
        };
        assert_eq!(freedoms, 1);
    }
    // A point on the line itself stays where it is.
    let on_line = "[[traces]]\nname = \"P\"\nbody = \"rod\"\npoint = [50, 0, 0]\n";
    run(&read(&format!("{text}\n{on_line}")), 20);
}

/// Solves an over-constrained scene and compares every sample with `truth`, which names unknowns and their values
/// for an input.
fn compare(name: &str, mechanism: &Model, truth: impl Fn(f64) -> Vec<(&'static str, f64)>) {
    let trajectory = run(mechanism, 121);
    for (sample, pose) in trajectory.samples.iter().zip(trajectory.poses()) {
        for (unknown_name, value) in truth(sample.inputs[0]) {
            let error = apart(unknown(mechanism, pose, unknown_name), value);
            assert!(error < 2e-13, "{name}: {unknown_name} off by {error:e}");
        }
    }
}

#[test]
fn overconstrained_loops_move_as_their_closed_forms_say() {
    let half = |k: f64, t: f64| 2.0 * (k / (0.5 * t).tan()).atan();
    let k1 = 1.0 + 3f64.sqrt();
    compare("bennett", &read(&file("bennett")), |t1| {
        let t2 = half(k1, t1);
        vec![("t2", t2), ("t3", -t1), ("t4", -t2)]
    });
    let k2 = (37.5f64.to_radians().sin()) / (-7.5f64.to_radians()).sin();
    compare("goldberg", &read(&file("goldberg")), |t1| {
        let t2 = half(k1, t1);
        let u1 = 2.0 * (k2 * (0.5 * t2).tan()).atan();
        vec![
            ("t2", t2),
            ("s", u1 - t1 - PI),
            ("u2", PI - t2),
            ("u3", -u1),
        ]
    });
    compare("sarrus", &read(&file("sarrus")), |q| {
        vec![
            ("a", 2.0 * q),
            ("b", -q),
            ("c", q),
            ("d", -2.0 * q),
            ("e", q),
        ]
    });
}

#[test]
fn bricard_loops_of_60_and_90_degrees_keep_their_symmetry() {
    for (angle, drive) in [(60.0_f64, "120 - 100*t/4"), (90.0, "80 + 9*t")] {
        let text = file("bricard").replace("A = 60", &format!("A = {angle}"));
        let guess = if angle == 60.0 {
            (0.0, 120.0)
        } else {
            (98.5, 80.0)
        };
        let text = text.replace("120 - 100*t/4", drive);
        let text = text.split("[guess]").next().unwrap().to_owned()
            + &format!(
                "[guess]\nt2 = {0}\nt3 = {1}\nt4 = {0}\nt5 = {1}\nt6 = {0}\n",
                guess.0, guess.1
            );
        let mechanism = read(&text);
        let trajectory = run(&mechanism, 101);
        let (s, c) = angle.to_radians().sin_cos();
        for (sample, pose) in trajectory.samples.iter().zip(trajectory.poses()) {
            let of = |name| unknown(&mechanism, pose, name);
            let (t1, t2) = (sample.inputs[0], of("t2"));
            for (name, value) in [("t3", t1), ("t5", t1), ("t4", t2), ("t6", t2)] {
                assert!(apart(of(name), value) < 1e-12, "{angle}: {name}");
            }
            let (c1, c2) = (t1.cos(), t2.cos());
            let open =
                c * c + s * s * (c1 + c2) + (1.0 + c * c) * c1 * c2 - 2.0 * c * t1.sin() * t2.sin();
            assert!(open.abs() < 1e-13, "{angle}: {open:e}");
        }
        if angle == 90.0 {
            let t2 = unknown(&mechanism, trajectory.poses().next().unwrap(), "t2");
            assert!((t2 - 1.719297435178).abs() < 1e-12, "{t2}");
        }
    }
}

/// Output k of 100 four-bars drives the next.
fn four_bars(count: usize) -> String {
    let name = |k: usize| {
        if k == 0 {
            "phi".to_owned()
        } else {
            format!("o{k}")
        }
    };
    let mut text = "duration = 1\n[inputs]\nphi = \"1 + t\"\n[loops]\n".to_owned();
    for k in 0..count {
        text += &format!(
            "L{k} = \"Rz({}) Tx(100) Rz(a{k}) Tx(90) Rz(b{k}) Tx(-80) Rz(-{}) Tx(-40)\"\n",
            name(k),
            name(k + 1)
        );
    }
    text
}

/// Cells of a lazy tongs with bars of 100 that cross in the middle: the width w drives the first cell, each cell the
/// next. The lower left pin of a cell is its base.
fn scissors(count: usize) -> String {
    let mut text = "duration = 1\n[inputs]\nw0 = \"50 + 10*t\"\n[loops]\n".to_owned();
    let mut guess = "[guess]\n".to_owned();
    for k in 0..count {
        text += &format!(
            "L{k} = \"Rz(u{k}) Tx(50) Rz(v{k}) Tx(-50) Rz(x{k}) Ty(-w{k})\"\n\
             R{k} = \"Rz(u{k}) Tx(50) Rz(v{k}) Tx(50) Rz(y{k}) Ty(w{0}) Rz(z{k}) Tx(-100) Rz(-u{k})\"\n",
            k + 1
        );
        guess += &format!(
            "u{k} = 0.5\nv{k} = -1\nx{k} = 0.5\ny{k} = 0.5\nz{k} = 0.5\nw{} = 50\n",
            k + 1
        );
    }
    text + &guess
}

#[test]
fn long_chains_of_loops_are_blocks_of_one_loop_each() {
    let mechanism = read(&four_bars(100));
    let system = mechanism.system().unwrap();
    assert_eq!(system.blocks().len(), 100);
    assert!(
        system
            .blocks()
            .iter()
            .all(|b| b.rows() == 3 && b.unknowns.len() == 3)
    );
    // Written the other way round the order is found all the same.
    let text = four_bars(100);
    let (head, loops) = text.split_once("[loops]\n").unwrap();
    let back: Vec<&str> = loops.lines().rev().collect();
    let mechanism = read(&format!("{head}[loops]\n{}\n", back.join("\n")));
    let system = mechanism.system().unwrap();
    assert_eq!(system.blocks().len(), 100);
    assert_eq!(system.blocks()[0].loops[0].index, 99);
}

#[test]
fn a_hundred_scissor_cells_are_two_hundred_blocks_and_keep_their_digits() {
    let mechanism = read(&scissors(100));
    assert_eq!(mechanism.system().unwrap().blocks().len(), 200);
    let trajectory = solve(&mechanism, &[0.0, 0.5, 1.0]).unwrap();
    assert_eq!(trajectory.missing(), 0);
    for (sample, pose) in trajectory.samples.iter().zip(trajectory.poses()) {
        let width = sample.inputs[0];
        assert!((unknown(&mechanism, pose, "w100") - width).abs() < 1e-11);
        let turn = (width / 100.0).asin();
        assert!((unknown(&mechanism, pose, "u99") - turn).abs() < 1e-13 * 100.0);
    }
}

#[test]
fn a_long_chain_of_coupled_pairs_is_as_many_blocks() {
    // Two loops of each stage need each other, and the stage before.
    let mut text = "duration = 1\n[inputs]\nw0 = \"1 + t\"\n[equations]\n".to_owned();
    for k in 0..100 {
        text += &format!(
            "p{k} = \"u{k} + 0.5*v{k} - w{k}\"\nq{k} = \"u{k}*v{k} - 0.1*w{k}\"\nr{k} = \"w{0} - u{k} - 2*v{k}\"\n",
            k + 1
        );
    }
    let system = read(&text).system().unwrap();
    let sizes: Vec<usize> = system.blocks().iter().map(|b| b.unknowns.len()).collect();
    assert_eq!(sizes.iter().filter(|n| **n == 2).count(), 100);
    assert_eq!(sizes.iter().filter(|n| **n == 1).count(), 100);
}

#[test]
fn mechanisms_of_any_size_take_the_same_steps() {
    for (scale, text) in [(1e-9, "1e-9"), (1e6, "1e6")] {
        for name in ["gearshift", "rssr-balls", "slider-crank"] {
            let plain = read(&text_of(name));
            let scaled = scaled(&plain, scale);
            let (a, b) = (run(&plain, 40), run(&scaled, 40));
            for (a, b) in a.poses().zip(b.poses()) {
                assert_eq!(a.iterations, b.iterations, "{name} times {text}");
                assert!((a.sigma_min / b.sigma_min - 1.0).abs() < 1e-9);
                let values = a.unknowns.iter().zip(&b.unknowns).enumerate();
                for (k, (x, y)) in values {
                    let (x, y) = (x / plain.scale_of(k), y / scaled.scale_of(k));
                    assert!((x - y).abs() < 1e-12, "{name} times {text}: {x} {y}");
                }
            }
        }
    }
}

/// The mechanism with all lengths multiplied.
fn scaled(mechanism: &Model, scale: f64) -> Model {
    use mechanim::model::chain::{Argument, ChainStep, ElementaryMotion};
    use mechanim::model::drive::Drive;
    use mechanim::model::mechanism::Kind;
    let mut other = mechanism.clone();
    other.size *= scale;
    other.loops.iter_mut().for_each(|l| l.size *= scale);
    for slot in 0..mechanism.coordinate_count() {
        if mechanism.kind_of(slot) == Kind::Length {
            other.scales[slot] *= scale;
        }
    }
    (other.bodies, other.traces, other.outputs) = (Vec::new(), Vec::new(), Vec::new());
    for step in other.loops.iter_mut().flat_map(|l| &mut l.chain.steps) {
        match step {
            ChainStep::Fixed(fixed) => fixed.pose.translation *= scale,
            ChainStep::Joint {
                motion: ElementaryMotion::Translation,
                argument,
                ..
            } => {
                let Argument::Affine(affine) = &mechanism.arguments[*argument] else {
                    panic!("a formula")
                };
                assert_eq!(affine.constant.number(), 0.0);
            }
            ChainStep::Joint { .. } => {}
        }
    }
    for (guess, unknown) in other.actuation.guess.iter_mut().zip(&mechanism.unknowns) {
        *guess *= if unknown.kind == Kind::Length {
            scale
        } else {
            1.0
        };
    }
    for (drive, input) in other.actuation.drives.iter_mut().zip(&mechanism.inputs) {
        if let (Drive::Keys { values, .. }, Kind::Length) = (drive, input.kind) {
            values.iter_mut().for_each(|v| *v *= scale);
        }
    }
    other
}

#[test]
fn a_motion_that_starts_where_assemblies_meet_says_so() {
    let text = "duration = 1\n[inputs]\nphi = \"pi*t\"\n[loops]\n\
        A = \"Rz(phi) Tx(40) Rz(a) Tx(100) Rz(b) Tx(-40) Rz(-psi) Tx(-100)\"\n";
    let mechanism = read(text);
    let trajectory = solve(&mechanism, &[0.0]).unwrap();
    assert_eq!(trajectory.missing(), 0);
    let kinds: Vec<&EventKind> = trajectory.events.iter().map(|e| &e.kind).collect();
    assert_eq!(kinds, [&EventKind::StartSingular]);
    // A guess at a singular pose that is not closed is only a start.
    let crank = "duration = 1\n[inputs]\nphi = \"1 + t\"\n[loops]\n\
        A = \"Rz(phi) Tx(40) Rz(a) Tx(80) Rz(b) Tx(-h)\"\n";
    let trajectory = run(&read(crank), 5);
    assert!(trajectory.events.is_empty(), "{:?}", trajectory.events);
}

#[test]
fn odd_loops_are_solved_or_refused_and_always_said() {
    let crank = "Rz(phi) Tx(40) Rz(a) Tx(80) Rz(b) Tx(-h)";
    let back = "Tx(h) Rz(-b) Tx(-80) Rz(-a) Tx(-40) Rz(-phi)";
    let scene = |inputs: &str, loops: &str| {
        format!("duration = 1\n[inputs]\n{inputs}\n[loops]\n{loops}\n[guess]\nh = 110\n")
    };
    let one = "phi = \"0.5 + t\"";
    let two = "phi = \"0.5 + t\"\npsi = \"0.5 + t\"";
    // Inputs and loops; the exit code; what is said.
    let cases: [(String, i32, &[&str]); 8] = [
        (
            scene(one, &format!("A = \"{crank}\"\nB = \"{crank}\"")),
            0,
            &[
                "warning: loop `B` is the same as loop `A`",
                "remove one of them",
            ],
        ),
        (
            scene(one, &format!("A = \"{crank}\"\nB = \"{back}\"")),
            0,
            &["loop `B` is the same as loop `A`"],
        ),
        (
            scene(one, &format!("A = \"{crank}\"\nB = \"Tx(2) Tx(-2)\"")),
            0,
            &["nothing moves in loop `B`"],
        ),
        (
            scene(one, &format!("A = \"{crank}\"\nB = \"Tx(2) Tx(-3)\"")),
            4,
            &[
                "loop `B` cannot close",
                "the translation along x always differs by -1",
            ],
        ),
        (
            scene(two, &format!("A = \"{crank}\"\nB = \"Rz(phi) Rz(-psi)\"")),
            0,
            &["loop `B` contains no unknown, only inputs"],
        ),
        (
            scene(
                "phi = \"0.5 + t\"\npsi = \"0.7 + t\"",
                &format!("A = \"{crank}\"\nB = \"Rz(phi) Rz(-psi)\""),
            ),
            4,
            &[
                "loop `B` does not close",
                "0.200000 rad",
                "inputs phi, psi contradict each other",
            ],
        ),
        (
            scene(
                two,
                "A = \"Rz(phi) Tx(40) Rz(a) Tx(80) Rz(h) Tx(60) Rz(psi) Tx(-90)\"",
            ),
            4,
            &["`A` has 3 equations and 2 unknowns", "phi, psi contradict"],
        ),
        (
            scene(one, &format!("A = \"{crank} Rx(c - c)\"")),
            2,
            &["no loop and no equation determines `c`"],
        ),
    ];
    let workspace = Workspace::new();
    for (text, code, said) in cases {
        workspace.write("odd.toml", &text);
        let run = workspace.run(&["check", "odd.toml"]);
        assert_eq!(run.code, code, "{text}\n{}", run.stderr);
        run.says(said);
    }
}

/// A rod's spin stands where it starts, to the last bit, whatever that is and wherever the others start.
#[test]
fn what_is_held_is_held_at_its_start_value() {
    for spin in [0.0, 0.7, -2.0] {
        let mut model = read(&gearshift_with_ball());
        let held = model.system().unwrap().structure().held[0].unknown;
        assert_eq!(model.unknowns[held].name, "spin");
        model.actuation.guess[held] = spin;
        let trajectory = solve(&model, &even_times(&model, 9)).unwrap();
        assert_eq!(trajectory.missing(), 0, "{:?}", trajectory.events);
        for pose in trajectory.poses() {
            assert_eq!(pose.unknowns[held], spin);
        }
    }
}

#[test]
fn the_report_names_what_is_held_and_what_is_redundant() {
    let workspace = Workspace::new();
    workspace.write("ball.toml", gearshift_with_ball());
    let text = workspace.run(&["check", "ball.toml"]).exits(0).text();
    // The same without a file of its own: a chain is replaced like a parameter.
    let ball = "T74=Tz(-L7) Rz(spin) Rx(a13) Ry(a14) Ty(L4v) Tx(-L4s)";
    let replaced = workspace.run(&["check", "gearshift", "--param", ball]);
    assert_eq!(replaced.exits(0).text(), text);
    let broken = workspace.run(&["check", "gearshift", "--param", "T74=Tz(-L7) Rq(a13)"]);
    broken.exits(2).says(&["Rq"]);
    for part in [
        "3 by count (21 joint freedoms - 6 of loop A - 6 of loop B - 6 of loop C)",
        "3 by the rank 18 of 21 coordinates; 2 inputs, 1 idle freedom",
        "a link of loop B can spin about the line of its own joints (a12, spin); `spin` is held",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    let run = workspace.run(&["solve", "ball.toml", "--samples", "3", "--out", "-"]);
    run.exits(0).says(&[
        "idle: a link of loop B",
        "`spin` is held at its start value",
    ]);
    workspace.write("bennett.toml", file("bennett"));
    let json = workspace
        .run(&["check", "bennett.toml", "--json", "-"])
        .exits(0)
        .text();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let mobility = &json["mobility"];
    assert_eq!(
        (&mobility["count"], &mobility["numeric"]),
        (&(-2).into(), &1.into())
    );
    assert_eq!(mobility["redundant"].as_array().unwrap().len(), 3);
    assert_eq!(mobility["redundant"][0]["loop"], "A");
    // Equations and bars are named as well.
    for (scene, said) in [
        (
            "[inputs]\nphi = \"t\"\n[equations]\ne1 = \"x - phi\"\ne2 = \"2*x - 2*phi\"\n",
            "equation e2: implied",
        ),
        (
            "[inputs]\nphi = \"t\"\n[loops]\nA = \"Rz(phi) Rz(c) Tz(3) Tz(-x)\"\n[equations]\nfix = \"phi + c\"\n",
            "equation fix: implied",
        ),
    ] {
        workspace.write("twice.toml", format!("duration = 1\n{scene}"));
        let text = workspace.run(&["check", "twice.toml"]).exits(0).text();
        assert!(text.contains(said), "{text}");
    }
}

/// Three loops, each in a frame that moves: HOUSE carries them all.
const EXCAVATOR: &str = r#"units = { length = "m", angle = "deg" }
duration = 2
[parameters]
h = 1.4
[inputs]
INPUTS
c1 = "1.55 + 0.15*t"
c2 = "2.2 + 0.15*t"
c3 = "1.3 + 0.1*t"
[chains]
house = "HOUSE"
boom = "house Tz(h) Ry(-b)"
stick = "boom Tx(4) Ry(-s)"
bucket = "stick Tx(2) Ry(-k)"
[loops]
lift = "LIFT"
draw = "boom T(1.6, 0, 0.5) Ry(-u2) Tx(c2) Ry(-v2) inv(stick Tx(-0.6))"
dig = "stick T(0.6, 0, 0.4) Ry(-u3) Tx(c3) Ry(-v3) inv(bucket Tz(0.35))"
[guess]
b = 30
s = -60
k = -40
u1 = 60
[[bodies]]
name = "bucket"
frame = "bucket"
"#;

const LIFT: &str = "house T(0.6, 0, 0.5) Ry(-u1) Tx(c1) Ry(-v1) inv(boom Tx(1.5))";

#[test]
fn what_carries_a_loop_is_no_part_of_it() {
    let excavator = |house: &str, inputs: &str, lift: &str| {
        let text = EXCAVATOR.replace("HOUSE", house);
        text.replace("INPUTS", inputs).replace("LIFT", lift)
    };
    let plain_text = excavator("E", "", LIFT);
    let plain = read(&plain_text);
    let (counted, poses) = (mobility_of(&plain_text), run(&plain, 9));
    assert_eq!(counted.count.freedoms(), 3);
    assert_eq!(counted.count.planar_dependents(), Some(6));
    let swing = "swing = \"60*t\"";
    let houses: [(&str, &str, usize); 5] = [
        ("Rz(swing)", swing, 1),
        ("T(1, 2, 0.3) Rz(swing) Tx(0.1)", swing, 1),
        ("Rx(-2*swing + 3)", swing, 1),
        ("Hz(0.2, swing)", swing, 1),
        (
            "Tx(drive) R(1, 2, 3, swing)",
            "swing = \"60*t\"\ndrive = \"2*t\"",
            2,
        ),
    ];
    let lifts = [
        LIFT,
        // The other way round, from the middle on, spelled out, and with a common end.
        "boom Tx(1.5) inv(house T(0.6, 0, 0.5) Ry(-u1) Tx(c1) Ry(-v1))",
        "Ry(-u1) Tx(c1) Ry(-v1) inv(boom Tx(1.5)) house T(0.6, 0, 0.5)",
        "inv(inv(house)) Tx(0.6) Tz(0.5) Ry(-u1) Tx(c1) Ry(-v1) Tx(-1.5) Ry(b) Tz(-h) inv(house)",
        "house T(0.6, 0, 0.5) Ry(-u1) Tx(c1) Ry(-v1) house inv(boom Tx(1.5) house)",
    ];
    let cases = houses
        .into_iter()
        .flat_map(|house| lifts.map(|lift| (house, lift)));
    for ((house, inputs, more), lift) in cases {
        let text = excavator(house, inputs, lift);
        let model = read(&text);
        let case = format!("{house}: {lift}");
        let bodies = text.find("[[bodies]]").unwrap();
        for text in [&text[..], &text[..bodies]] {
            let mobility = mobility_of(text);
            assert_eq!(mobility.count.loops, counted.count.loops, "{case}");
            assert_eq!(mobility.count.freedoms(), 3 + more as i64, "{case}");
            assert_eq!(mobility.count.planar_dependents(), Some(6), "{case}");
            assert_eq!(mobility.generic.unwrap().mobility, 3 + more, "{case}");
            assert_eq!(mobility.inputs, 3 + more, "{case}");
            assert!(mobility.redundant.is_empty(), "{case}");
            assert!(mobility.conditions.is_empty(), "{case}");
        }
        // The house turns on the ground, whatever it carries.
        let slot = model.unknowns.len();
        let mut joints = model.joints.list.iter();
        assert!(joints.any(|j| j.coordinates == [slot]), "{case}");
        let trajectory = run(&model, 9);
        for (pose, plain_pose) in trajectory.poses().zip(poses.poses()) {
            for coordinate in &plain.unknowns {
                let name = &coordinate.name;
                let error = unknown(&model, pose, name) - unknown(&plain, plain_pose, name);
                assert!(error.abs() < 1e-13, "{case}: {name} {error:e}");
            }
        }
    }
}

#[test]
fn a_point_is_closed_where_it_is() {
    // Beside a sphere a loop may turn about the sphere's centre: what carries both sides is cancelled between them only.
    let text = "duration = 1\n[inputs]\na = \"0.3 + t\"\nb = \"0.2*t\"\n[chains]\nbase = \"Tx(3) Rz(a)\"\n\
        ball = \"base Tx(2) Ry(b) Tx(1)\"\ntable = \"base Tz(z)\"\n[contacts.c]\nfirst = { plane = {}, frame = \"table\" }\n\
        second = { sphere = { radius = 0.5 }, frame = \"ball\" }\n[guess]\nz = -1\n[[bodies]]\nname = \"ball\"\nframe = \"ball\"\n";
    let model = read(text);
    let trajectory = run(&model, 5);
    for sample in &trajectory.samples {
        let pose = sample.pose.as_ref().unwrap();
        let height = -sample.inputs[1].sin() - 0.5;
        assert!((unknown(&model, pose, "z") - height).abs() < 1e-14);
    }
    let mobility = mobility_of(text);
    assert_eq!(mobility.generic.unwrap().mobility, 2);
}

/// A rod between two balls spins, in whatever angles it is written, with a body on it or without.
#[test]
fn the_spin_of_a_rod_is_idle_in_whatever_angles_it_is_written() {
    let begin = "Rz(a) Tx(30) Rz(b1) Ry(b2)";
    let end = "Ry(c2) Rz(c3) Ty(-40) Rx(-d) Tx(-60) Tz(20)";
    let rod = "[[bodies]]\nname = \"rod\"\nframe = \"Rz(a) Tx(30) Rz(b1) Ry(b2) Rx(b3)\"\n";
    let mut poses = Vec::new();
    for middle in [
        "Rx(b3) Tx(50) Rx(c1)",
        "Rx(b3) Tx(50) Rx(c1-b3)",
        "Rx(b3) Tx(50) Rx(2*c1-b3/2)",
    ] {
        for body in ["", rod] {
            let text = format!(
                "duration = 1\nunits = {{ angle = \"rad\" }}\ninputs = {{ a = \"0.5+0.3*t\" }}\n\
                 loops = {{ L = \"{begin} {middle} {end}\" }}\nguess = {{ b1 = 0.1, b2 = 0.2 }}\n{body}"
            );
            let model = crate::reference::scenes::written(&text);
            let system = model.system().unwrap_or_else(|e| panic!("{text}: {e}"));
            assert_eq!(system.structure().held.len(), 1, "{text}");
            let trajectory = crate::driven::solve(&model, &[0.0, 0.5, 1.0]).unwrap();
            let rocker = crate::reference::slot(&model, "d");
            let whole = crate::reference::scenes::whole(&trajectory);
            poses.push(
                whole
                    .iter()
                    .map(|p| p.unknowns[rocker])
                    .collect::<Vec<f64>>(),
            );
        }
    }
    for other in &poses[1..] {
        let apart = other.iter().zip(&poses[0]).map(|(a, b)| (a - b).abs());
        assert!(apart.fold(0.0, f64::max) < 1e-12, "{poses:?}");
    }
}

/// What does not close has no freedom too many because a link of it spins.
#[test]
fn a_rod_that_is_too_short_does_not_close_and_its_spin_is_idle() {
    let w = crate::program::Workspace::new();
    let scene = |length: f64, more: &str| {
        format!(
            "duration = 4\n[inputs]\nphi = \"2*pi*t/4\"\n[loops]\n\
             A = \"Rz(phi) Tx(20) Rx(a) Ry(b) Rz(c) Tx({length}) Rx(d) Ry(e) Rz(f) Ty(-60) Rx(g) {more} T(-30, -50, -70)\"\n\
             [guess]\nb = 0.3\n"
        )
    };
    w.write("short.toml", scene(10.0, ""));
    w.run(&["solve", "short.toml", "--samples", "3", "-o", "-"])
        .exits(4)
        .says(&["loop `A` does not close", "no pose exists (proved)"]);
    // A freedom that wants a drive is still named.
    w.write("loose.toml", scene(10.0, "Tx(5) Rz(h)"));
    w.run(&["solve", "loose.toml", "--samples", "3", "-o", "-"])
        .exits(2)
        .says(&[" free than the inputs drive"]);
}

/// What an equation says something of is a part of the mechanism, though no body shows it: if it is free to move, the
/// mechanism wants a drive, and nothing is held for it.
#[test]
fn what_an_equation_says_of_is_not_idle() {
    let hanging = [
        (
            "a bar from the end of a crank",
            "[chains]\ncrank = \"Rz(phi) Tx(50)\"\nP = \"T(x, y, 0)\"\n\
             [bars]\nrod = { from = \"crank\", to = \"P\", length = 80 }\n",
        ),
        (
            "a bar in space",
            "[chains]\ncrank = \"Rz(phi) Tx(50)\"\nP = \"T(x, y, z)\"\n[bars]\n\
             a = { from = \"crank\", to = \"P\", length = 80 }\n\
             b = { from = [90, 0, 0], to = \"P\", length = 70 }\n",
        ),
        (
            "two bars, one after the other",
            "[chains]\nP = \"T(x, y, 0)\"\nQ = \"T(u, v, 0)\"\n[bars]\n\
             a = { from = [0, 0], to = \"P\", length = 80 }\n\
             b = { from = \"P\", to = \"Q\", length = 70 }\n\
             [equations]\nc = \"x - 50*cos(phi)\"\n",
        ),
        ("a sum", "[equations]\ne = \"x + y - 10*phi\"\n"),
        (
            "an angle that the other one follows",
            "[equations]\ne = \"cos(a) - cos(b)*phi/2\"\n",
        ),
    ];
    for (what, text) in hanging {
        let text = format!(
            "duration = 1\nunits = {{ length = \"mm\" }}\n[inputs]\nphi = \"0.5 + t\"\n{text}"
        );
        match read(&text).system() {
            Err(error) => assert!(error.to_string().contains("drive"), "{what}: {error}"),
            Ok(system) => panic!("{what}: held {:?}", system.structure().held),
        }
    }
}
