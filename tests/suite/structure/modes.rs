//! Assemblies found from many starts, against closed forms and published counts.

use crate::driven;
use crate::driven::{Driven, Model};
use crate::reference;
use mechanim::diag::Source;
use mechanim::kinematics::assemblies::{DEFAULT_STARTS, Mode, Modes, find_modes};
use mechanim::kinematics::loops::forward::{body_poses, closure_error};
use mechanim::kinematics::solve::assembly::assemble_pose;
use mechanim::kinematics::solve::newton::Corrector;
use mechanim::math::Pose;

use crate::program::Workspace;
use crate::reference::{Table, mechanism};
use mechanim::model::mechanism::Mechanism;
use mechanim::scene::builtin;
use std::f64::consts::{PI, TAU};

/// Manocha and Canny's arm with sixteen closures, as a user writes it. The hand is the published matrix, its rotation
/// replaced by the nearest orthogonal one and written through Euler angles.
const SIX_R: &str = r#"title = "6R arm"
units = { angle = "rad" }
[inputs]
still = 0
[parameters]
up = "pi/2"
tilt = "pi/180"
[chains]
arm = "Rz(t1+still) Tx(.3) Rx(up)  Rz(t2) Tx(1) Rx(tilt)  Rz(t3) Tz(.2) Rx(up)  Rz(t4) Tx(1.5) Rx(tilt)  Rz(t5) Rx(up)  Rz(t6) Rx(tilt)"
hand = "Tx(-1.140175) Rx(-1.4846808440888652) Ry(0.10244097843035128) Rz(2.4404770232320123)"
[loops]
A = "arm inv(hand)"
[[bodies]]
name = "hand"
frame = "arm"
shapes = [{ sphere = { radius = 0.1 } }]
"#;

fn builtin_scene(name: &str, inputs: &[(&str, &str)]) -> Model {
    mechanism(&builtin::find_builtin(name).unwrap(), inputs)
}

/// All assemblies at the start of the drive; every one of them is checked to close.
fn modes(mechanism: &Model, starts: usize) -> Modes {
    let system = mechanism.system().unwrap();
    let first = mechanism.actuation.start_at(0.0);
    let modes = find_modes(&system, &first, &mechanism.actuation.named, starts, &|| {
        false
    });
    for mode in &modes.list {
        assert!(closure_error(mechanism, &mode.coordinates) <= 1e-12);
        assert_eq!(
            mode.coordinates[mechanism.unknowns.len()..],
            mechanism.actuation.inputs_at(0.0)
        );
    }
    modes
}

fn value(mechanism: &Mechanism, mode: &Mode, name: &str) -> f64 {
    let slot = mechanism.unknowns.iter().position(|c| c.name == name);
    mode.coordinates[slot.unwrap()]
}

fn turned(difference: f64) -> f64 {
    (difference - TAU * (difference / TAU).round()).abs()
}

#[test]
fn the_slider_crank_has_its_two_assemblies() {
    let mechanism = builtin_scene("slider-crank", &[("phi", "0.5")]);
    let modes = modes(&mechanism, DEFAULT_STARTS);
    let mut places: Vec<f64> = modes
        .list
        .iter()
        .map(|mode| value(&mechanism, mode, "h"))
        .collect();
    places.sort_by(f64::total_cmp);
    // h = r cos phi ± sqrt(L² - r² sin² phi)
    let root = (6400.0 - 1600.0 * 0.5_f64.sin().powi(2)).sqrt();
    let expected = [-1.0, 1.0].map(|sign| 40.0 * 0.5_f64.cos() + sign * root);
    assert_eq!(places.len(), 2, "{places:?}");
    for (place, expected) in places.iter().zip(expected) {
        assert!((place - expected).abs() < 1e-11, "{place} {expected}");
    }
    assert_ne!(modes.list[0].branch, modes.list[1].branch);
}

/// Roots of equations far from their start values, in any unit: what no link bounds is looked for at every magnitude.
#[test]
fn equations_have_all_their_roots() {
    let slider = "[inputs]\nphi = \"30+10*t\"\n[equations]\na = \"(K*40*cos(phi)-h)^2 + (K*40*sin(phi))^2 - (K*80)^2\"\n";
    let sliders = [-1.0, 1.0].map(|sign| 1200_f64.sqrt() + sign * 6000_f64.sqrt());
    let cubic = "[inputs]\nq = \"t\"\n[equations]\na = \"(h - K*10)*(h - K*60)*(h - K*200)/1000\"\n[chains]\nP = \"Tx(h)\"\n[[bodies]]\nname = \"b\"\nframe = \"P\"\n";
    let seven = "[inputs]\nq = \"t\"\n[equations]\na = \"(h-K*1)*(h-K*2)*(h-K*3)*(h-K*4)*(h-K*5)*(h-K*6)*(h-K*7)\"\n";
    let loops = "[inputs]\nphi = \"30+10*t\"\n[loops]\nA = \"Rz(phi) Tx(K*40) Rz(alpha) Tx(K*80) Rz(beta) Tx(-g)\"\n[equations]\nk = \"(h-g)^2 + (K*20)^2 - (K*90)^2\"\n";
    let beside = (90.0_f64.powi(2) - 20.0_f64.powi(2)).sqrt();
    let beside: Vec<f64> = sliders
        .iter()
        .flat_map(|g| [g - beside, g + beside])
        .collect();
    let whole: Vec<f64> = (1..=7).map(f64::from).collect();
    for (text, roots) in [
        (slider, &sliders[..]),
        (cubic, &[10.0, 60.0, 200.0]),
        (seven, &whole),
        (loops, &beside),
    ] {
        for unit in [1e-3, 1.0, 1e3] {
            let text = format!(
                "units = {{ angle = \"deg\" }}\nduration = 1\n{}",
                text.replace('K', &unit.to_string())
            );
            let source = Source {
                name: "roots".to_owned(),
                text,
            };
            let mechanism = mechanism(&source, &[]);
            let found = modes(&mechanism, DEFAULT_STARTS);
            let mut found: Vec<f64> = found
                .list
                .iter()
                .map(|mode| value(&mechanism, mode, "h") / unit)
                .collect();
            found.sort_by(f64::total_cmp);
            let mut roots = roots.to_vec();
            roots.sort_by(f64::total_cmp);
            let pairs = found.iter().zip(&roots);
            let near = pairs
                .into_iter()
                .all(|(a, b)| (a - b).abs() < 1e-6 * b.abs());
            assert!(
                found.len() == roots.len() && near,
                "{unit} {found:?} {roots:?}"
            );
        }
    }
}

/// Two positions of the rocker, of the lever's pin and of the roll about the line between the balls make eight. The
/// short link between its ball and its universal joint can be turned by π about its own axis in each of them, which
/// is another pose of that link and of nothing else. Second Euler angles would make 2⁴ times as many.
#[test]
fn the_gearshift_has_eight_assemblies_in_each_of_which_the_short_link_can_be_turned() {
    let mechanism = builtin_scene("gearshift", &[("p", "0"), ("phi", "0")]);
    let modes = modes(&mechanism, DEFAULT_STARTS);
    assert_eq!(modes.list.len(), 16);
    let turned_link = mechanism.bodies.iter().position(|b| b.name == "short link");
    let others = |mode: &Mode| -> Vec<Pose> {
        let mut poses = body_poses(&mechanism, &mode.coordinates);
        poses.remove(turned_link.unwrap());
        poses
    };
    let mut distinct: Vec<Vec<Pose>> = Vec::new();
    for mode in &modes.list {
        // Its second Euler angles turn the rod's pin by π; no assembly needs that.
        assert!(value(&mechanism, mode, "a2").cos() > 0.0);
        let poses = others(mode);
        let alike = |other: &Vec<Pose>| {
            poses.iter().zip(other).all(|(a, b)| {
                a.rotation.abs_diff_eq(b.rotation, 1e-9)
                    && a.translation.distance(b.translation) < 1e-6
            })
        };
        if !distinct.iter().any(alike) {
            distinct.push(poses);
        }
    }
    assert_eq!(distinct.len(), 8);
    assert_eq!(modes.list.iter().filter(|m| m.is_scene).count(), 1);
}

#[test]
fn the_seven_r_loop_has_the_eight_contacts_of_the_tori() {
    let mechanism = builtin_scene("seven-r", &[("beta1", "0")]);
    let modes = modes(&mechanism, DEFAULT_STARTS);
    // (beta2, theta1, theta2) in degrees, 40-digit arithmetic.
    let contacts = [
        [71.046417200, 29.223336795, 211.695397080],
        [93.305715278, 223.645542287, 230.226716886],
        [138.688320300, 106.840556130, 52.369224506],
        [163.667781238, 141.058967226, 24.190581011],
        [167.233992475, 291.025454975, 217.665752777],
        [168.970046123, 169.108419111, 226.157961968],
        [169.170372644, 197.206592790, 246.108295522],
        [178.562941313, 81.833969204, 146.507584304],
    ];
    for contact in contacts {
        let hits = modes.list.iter().filter(|mode| {
            let names = ["beta2", "theta1", "theta2"];
            names.iter().zip(contact).all(|(name, degrees): (_, f64)| {
                turned(value(&mechanism, mode, name) - degrees.to_radians()) < 1e-9
            })
        });
        assert!(hits.count() >= 1, "{contact:?} of {}", modes.list.len());
    }
}

/// At beta1 = 60 degrees three of eight contacts lie within 0.14 degrees of beta2.
#[test]
fn close_assemblies_of_the_seven_r_loop_are_told_apart() {
    let mechanism = builtin_scene("seven-r", &[("beta1", "60")]);
    let modes = modes(&mechanism, DEFAULT_STARTS);
    let contacts = [
        77.478191864,
        98.459003041,
        126.695076602,
        154.978837835,
        155.013222355,
        155.114629087,
        161.078994243,
        176.423334108,
    ];
    let mut found: Vec<f64> = modes
        .list
        .iter()
        .map(|mode| value(&mechanism, mode, "beta2").to_degrees())
        .collect();
    found.sort_by(f64::total_cmp);
    assert_eq!(found.len(), 8, "{found:?}");
    for (found, contact) in found.iter().zip(contacts) {
        assert!((found - contact).abs() < 2e-9, "{found} {contact}");
    }
}

/// A parallelogram whose rocker is longer by one part in 1e9: where the links lie in line, the two positions of the
/// rocker are 2 · 3.77964472805e-5 apart.
#[test]
fn almost_equal_assemblies_of_a_parallelogram_are_told_apart() {
    let text = "units = { angle = \"rad\" }\n[inputs]\nphi = \"pi\"\n[loops]\n\
                A = \"Rz(phi) Tx(40) Rz(a) Tx(100) Rz(b) Tx(-40*(1+1e-9)) Rz(-theta) Tx(-100)\"\n";
    let source = Source {
        name: "parallelogram".to_owned(),
        text: text.to_owned(),
    };
    let mechanism = mechanism(&source, &[]);
    let modes = modes(&mechanism, DEFAULT_STARTS);
    assert_eq!(modes.list.len(), 2, "{modes:?}");
    let theta = |k: usize| value(&mechanism, &modes.list[k], "theta");
    let apart = turned(theta(0) - theta(1));
    assert!((apart - 2.0 * 3.77964472805e-5).abs() < 1e-10, "{apart:e}");
}

/// Crank and rod of the same length at the change point: both assemblies are one, and singular.
#[test]
fn a_double_assembly_is_called_singular() {
    let text = "units = { angle = \"rad\" }\n[inputs]\nphi = \"pi/2\"\n[loops]\n\
                A = \"Rz(phi) Tx(80) Rz(a) Tx(80) Rz(b) Tx(-h)\"\n";
    let source = Source {
        name: "change point".to_owned(),
        text: text.to_owned(),
    };
    let modes = modes(&mechanism(&source, &[]), 100);
    assert_eq!(modes.list.len(), 1, "{modes:?}");
    assert!(modes.list[0].is_singular);
}

#[test]
fn all_sixteen_closures_of_the_six_r_arm_are_found() {
    let source = Source {
        name: "six-r".to_owned(),
        text: SIX_R.to_owned(),
    };
    let mechanism = mechanism(&source, &[]);
    let modes = modes(&mechanism, DEFAULT_STARTS);
    let table = Table::read("hard_6r16");
    assert_eq!((modes.list.len(), table.len()), (16, 16));
    for row in 0..16 {
        let distance = |mode: &Mode| {
            let errors = (1..=6).map(|k| {
                let expected = table.value(row, &format!("theta{k}_rad"));
                turned(value(&mechanism, mode, &format!("t{k}")) - expected)
            });
            errors.fold(0.0, f64::max)
        };
        let nearest = modes.list.iter().map(distance).fold(PI, f64::min);
        assert!(nearest < 1e-12, "row {row}: {nearest:e}");
    }
}

/// The placements of a scene's text from the default starts.
fn written(text: &str) -> (Model, Modes) {
    let model = reference::scenes::written(text);
    let modes = modes(&model, DEFAULT_STARTS);
    assert!(modes.is_exhausted, "{text}");
    (model, modes)
}

/// A rod between two ball joints: its spin and the second angles of its balls are names. The output's angle has the two
/// values of a cos psi + b sin psi = c.
#[test]
fn the_textbook_rssr_has_two_assemblies() {
    let (model, found) = written(
        "units = { angle = \"deg\" }\n[inputs]\nphi = 40\n[loops]\n\
         A = \"Rz(phi) Tx(30) Rx(a) Ry(b) Rz(c) Tx(100) Rx(d) Ry(e) Rz(f) inv(Tx(80) Ty(20) Rx(90) Rz(psi) Tx(60))\"\n",
    );
    assert_eq!((found.list.len(), found.placements()), (2, 2));
    let right = rocker_cosine(100.0);
    let off = |cosine: f64| {
        let modes = found.list.iter().map(|mode| value(&model, mode, "psi"));
        modes
            .map(|psi| (psi.cos() - cosine).abs())
            .fold(0.0, f64::max)
    };
    assert!(off(right) < 1e-11);
    // Planted: a coupler that is too long by a tenth of a micrometre.
    assert!(off(rocker_cosine(100.0001)) > 1e-7);
}

/// The ball on the rocker is at (80 + 60 cos psi, 20, 60 sin psi), that on the crank in the plane z = 0.
fn rocker_cosine(coupler: f64) -> f64 {
    let crank = [
        30.0 * 40_f64.to_radians().cos(),
        30.0 * 40_f64.to_radians().sin(),
    ];
    let [x, y] = [80.0 - crank[0], 20.0 - crank[1]];
    (coupler * coupler - x * x - y * y - 3600.0) / (120.0 * x)
}

/// A platform on six legs. Lengths are those at which the plate stands level over the base at `home`.
fn platform(feet: [[f64; 3]; 6], pins: [[f64; 3]; 6], home: [f64; 3], leg: &str) -> String {
    let shift = |p: [f64; 3]| format!("Tx({}) Ty({}) Tz({})", p[0], p[1], p[2]);
    let (mut inputs, mut chains, mut loops) = (String::new(), String::new(), String::new());
    for (k, (foot, pin)) in feet.into_iter().zip(pins).enumerate() {
        let way = [0, 1, 2].map(|i| home[i] + pin[i] - foot[i]);
        let length = way.iter().map(|w| w * w).sum::<f64>().sqrt();
        let own = leg.replace('#', &k.to_string());
        inputs += &format!("l{k} = {length}\n");
        chains += &format!("leg{k} = \"{} {own}\"\n", shift(foot));
        loops += &format!("L{k} = \"leg{k} inv(plate {})\"\n", shift(pin));
    }
    format!(
        "units = {{ angle = \"rad\" }}\n[inputs]\n{inputs}[chains]\n\
         plate = \"Tx(x) Ty(y) Tz(z) Rz(yaw) Ry(pitch) Rx(roll)\"\n{chains}[loops]\n{loops}\
         [[bodies]]\nname = \"plate\"\nframe = \"plate\"\nshapes = [{{ sphere = {{ radius = 0.1 }} }}]\n"
    )
}

const SPS: &str = "Rx(a#) Ry(b#) Rz(c#) Tz(l#) Rx(d#) Ry(e#) Rz(f#)";
const UPS: &str = "Rx(a#) Ry(b#) Tz(l#) Rx(d#) Ry(e#) Rz(f#)";

/// Points of a circle at some degrees.
fn circle(radius: f64, degrees: [f64; 6]) -> [[f64; 3]; 6] {
    degrees.map(|d| {
        [
            radius * d.to_radians().cos(),
            radius * d.to_radians().sin(),
            0.0,
        ]
    })
}

/// Where the plate's frame and two more of its points stand, ordered.
fn plates(model: &Model, found: &Modes) -> Vec<[i64; 9]> {
    let mut list: Vec<[i64; 9]> = Vec::new();
    for mode in &found.list {
        let pose = body_poses(model, &mode.coordinates)[0];
        let numbers = [pose.translation, pose.rotation.x_axis, pose.rotation.y_axis];
        let mut numbers = numbers.iter().flat_map(|v| v.to_array());
        list.push([0; 9].map(|_: i64| (numbers.next().unwrap() * 1e5).round() as i64));
    }
    list.sort_unstable();
    list.dedup();
    list
}

/// Whichever joints the legs have, the plate has the same placements; a home pose that random starts hardly meet, and its
/// mirror image below the base, are among them.
#[test]
fn a_six_three_platform_has_the_same_placements_on_any_legs() {
    let feet = circle(1.0, [-10.0, 10.0, 110.0, 130.0, 230.0, 250.0]);
    let pins = circle(0.6, [-60.0, 60.0, 60.0, 180.0, 180.0, 300.0]);
    let mut all = Vec::new();
    for leg in [SPS, UPS] {
        let (model, found) = written(&platform(feet, pins, [0.0, 0.0, 1.0], leg));
        let plates = plates(&model, &found);
        assert_eq!((found.bodies.len(), plates.len()), (1, found.placements()));
        for side in [1, -1] {
            let home = [0, 0, side * 100_000, 100_000, 0, 0, 0, 100_000, 0];
            assert!(plates.contains(&home), "{plates:?}");
        }
        // A leg with two balls has an idle spin, which is no mode; a turned universal joint is one.
        let modes = found.list.len();
        assert_eq!(modes > found.placements(), leg == UPS, "{modes}");
        all.push(plates);
    }
    assert_eq!(all[0], all[1]);
    assert_eq!(all[0].len(), 8);
}

/// Four placements of the hand's centre by arm and elbow, and two sets of angles of the wrist: names, unless its parts
/// are bodies.
#[test]
fn a_wrist_gives_two_names_to_each_of_four_assemblies() {
    let arm = "Rz(t1+still) Tz(0.6) Rx(-90) Rz(t2) Tx(0.5) Rz(t3) Tx(0.05) Rx(90) Tz(0.45)";
    let text = format!(
        "units = {{ angle = \"deg\" }}\n[inputs]\nstill = 0\n[chains]\narm = \"{arm}\"\n\
         hand = \"Tx(0.35) Ty(0.25) Tz(0.55) Rz(30) Ry(50) Rx(20)\"\n[loops]\n\
         A = \"arm Rz(t4) Ry(t5) Rz(t6) inv(hand)\"\n"
    );
    let (_, bare) = written(&text);
    assert_eq!((bare.placements(), bare.names()), (4, 8));
    let parts = ["arm Rz(t4)", "arm Rz(t4) Ry(t5)"].map(|frame| {
        format!(
            "[[bodies]]\nname = \"{frame}\"\nframe = \"{frame}\"\nshapes = [{{ sphere = {{ radius = 0.1 }} }}]\n"
        )
    });
    let (_, parts) = written(&(text + &parts.concat()));
    assert_eq!((parts.placements(), parts.names()), (8, 8));
}

/// Six equal bonds at the tetrahedral angle, as in cyclohexane: two chairs, and the boats, which are a curve.
#[test]
fn a_ring_has_two_isolated_assemblies_and_a_curve() {
    let turn = (1.0_f64 / 3.0).acos();
    let bonds = (1..=6).map(|k| {
        let still = if k == 1 { "+still" } else { "" };
        format!("Rx(t{k}{still}) Tx(1) Rz({turn})")
    });
    let bonds: Vec<String> = bonds.collect();
    let text = format!(
        "units = {{ angle = \"rad\" }}\n[inputs]\nstill = 0\n[loops]\nA = \"{}\"\n",
        bonds.join(" ")
    );
    let (model, found) = written(&text);
    let counts = (found.isolated(), found.curves(), found.larger_sets());
    assert_eq!((counts, found.list.len()), ((2, 1, 0), 3));
    for mode in found.list.iter().filter(|mode| mode.dimension == 0) {
        let torsion = value(&model, mode, "t2").abs();
        assert!((torsion - PI / 3.0).abs() < 1e-9 && !mode.is_singular);
    }
    let w = Workspace::new();
    w.write("ring.toml", text);
    let text = w.run(&["modes", "ring.toml"]).exits(0).text();
    assert!(
        text.contains("2 isolated assemblies and 1 curve of solutions found"),
        "{text}"
    );
}

/// The kinds of starts are told apart, and what they found adds up.
#[test]
fn every_placement_was_new_to_one_kind_of_start() {
    let mechanism = builtin_scene("gearshift", &[("p", "0"), ("phi", "0")]);
    let found = modes(&mechanism, DEFAULT_STARTS);
    let new: usize = found.tallies.iter().map(|(_, tally)| tally.new).sum();
    assert_eq!((new, found.placements()), (16, 16));
    assert!(found.is_exhausted && found.unseen < 1e-3);
    let few = modes(&mechanism, 40);
    assert!(!few.is_exhausted && few.starts() <= 41);
}

#[test]
fn the_result_is_the_same_twice_and_grows_with_the_starts() {
    let mechanism = builtin_scene("slider-crank", &[("phi", "0.5")]);
    assert_eq!(modes(&mechanism, 40), modes(&mechanism, 40));
    let only_the_scene = modes(&mechanism, 0);
    assert_eq!((only_the_scene.starts(), only_the_scene.list.len()), (1, 1));
    assert!(only_the_scene.list[0].is_scene);
}

#[test]
fn a_mechanism_that_does_not_reach_has_no_assembly() {
    let source = Source {
        name: "short".to_owned(),
        text: "[inputs]\nphi = 0\n[loops]\nA = \"Rz(phi) Tx(50) Rz(a) Tx(60) Rz(b) Tx(30) Rz(c) Tx(-150)\"\n"
            .to_owned(),
    };
    let modes = modes(&mechanism(&source, &[]), 50);
    assert_eq!((modes.list.len(), modes.closed()), (0, 0));
}

#[test]
fn the_verb_prints_a_count_and_the_option_starts_from_one() {
    let w = Workspace::new();
    let arguments = ["modes", "slider-crank", "--input", "phi=0.5"];
    let text = w.run(&arguments).exits(0).text();
    assert!(text.contains("2 placements of the bodies found"), "{text}");
    assert!(text.contains("a count, not a proof"), "{text}");
    assert!(
        text.contains("112.77081") && text.contains("-42.56420"),
        "{text}"
    );
    let json = [&arguments[..], &["--json", "-"]].concat();
    let document: serde_json::Value =
        serde_json::from_slice(&w.run(&json).exits(0).stdout).unwrap();
    for (k, mode) in document["modes"].as_array().unwrap().iter().enumerate() {
        let number = (k + 1).to_string();
        let solve = ["solve", "slider-crank", "--input", "phi=0.5", "--out", "-"];
        let chosen = [&solve[..], &["--format", "json", "--mode", &number]].concat();
        let table: serde_json::Value =
            serde_json::from_slice(&w.run(&chosen).exits(0).stdout).unwrap();
        let (a, b) = (&mode["unknowns"]["h"], &table["samples"][0]["h"]);
        assert!((a.as_f64().unwrap() - b.as_f64().unwrap()).abs() < 1e-11);
    }
    let third = [&arguments[1..], &["--mode", "3"]].concat();
    let third = [&["check"], &third[..]].concat();
    w.run(&third)
        .exits(2)
        .says(&["there is no mode 3", "2 modes"]);
    w.run(&[&arguments[..], &["--mode", "1"]].concat()).exits(2);
}

/// Unknowns of the first pose as a scene starts, degrees.
fn first_pose(model: &Model, name: &str) -> f64 {
    let trajectory = driven::solve(model, &[0.0]).unwrap();
    let pose = trajectory.samples[0].pose.as_ref().unwrap();
    let slot = model.unknowns.iter().position(|c| c.name == name);
    pose.unknowns[slot.unwrap()].to_degrees()
}

fn off(a: f64, b: f64) -> f64 {
    ((a - b) - 360.0 * ((a - b) / 360.0).round()).abs()
}

#[test]
fn a_rocker_guessed_at_its_angle_is_there() {
    // Crank, coupler, rocker, ground; the coupler's angles are not named.
    let bars = [
        [1.0, 3.2, 2.5, 4.0],
        [1.0, 3.0, 3.0, 4.0],
        [2.0, 4.0, 3.0, 3.5],
        [2.5, 3.0, 3.5, 1.0],
    ];
    let (mut seen, mut elsewhere) = (0, 0);
    for [crank, coupler, rocker, ground] in bars {
        for (step, side) in (0..24).flat_map(|step| [(step, 1.0), (step, -1.0)]) {
            let phi = f64::from(15 * step).to_radians();
            // Where the circles of coupler and rocker meet.
            let pin = [crank * phi.cos(), crank * phi.sin()];
            let to = [ground - pin[0], -pin[1]];
            let away = to[0].hypot(to[1]);
            let along = (coupler * coupler - rocker * rocker + away * away) / (2.0 * away);
            let aside = side * (coupler * coupler - along * along).sqrt();
            if aside.is_nan() || aside.abs() <= 0.1 {
                continue;
            }
            let [x, y] = [to[0] / away, to[1] / away];
            let meet = [
                pin[0] + along * x - aside * y,
                pin[1] + along * y + aside * x,
            ];
            let angle = meet[1].atan2(meet[0] - ground).to_degrees();
            let text = format!(
                "units = {{ angle = \"deg\" }}\n[inputs]\nphi = {}\n[loops]\n\
                 A = \"Rz(phi) Tx({crank}) Rz(k) Tx({coupler}) Rz(q) inv(Tx({ground}) Rz(p) Tx({rocker}))\"\n\
                 [guess]\np = {angle}\n",
                15 * step
            );
            let model = reference::scenes::written(&text);
            assert!(off(first_pose(&model, "p"), angle) < 1e-9, "{text}");
            seen += 1;
            let system = model.system().unwrap();
            let start = model.actuation.start_at(0.0);
            let slot = model.unknowns.iter().position(|c| c.name == "p").unwrap();
            let near = assemble_pose(&system, &mut Corrector::new(&system), &start, true).unwrap();
            elsewhere += usize::from(off(near.coordinates[slot].to_degrees(), angle) > 1.0);
        }
    }
    // A search from the start values alone is often elsewhere.
    assert!(seen > 100 && elsewhere > 10, "{seen} {elsewhere}");
}

/// A scissor lift of two stages whose bars are 600 long.
fn scissors(ground: f64, guess: &str) -> String {
    format!(
        "units = {{ angle = \"deg\" }}\n[inputs]\nd = {ground}\n[chains]\nA1 = \"Rz(a1)\"\nB1 = \"Tx(d) Rz(b1)\"\n\
         A2 = \"B1 Tx(600) Rz(a2)\"\nB2 = \"A1 Tx(600) Rz(b2)\"\n[loops]\none = \"A1 Tx(300) Rz(x1) inv(B1 Tx(300))\"\n\
         two = \"A2 Tx(300) Rz(x2) inv(B2 Tx(300))\"\n[guess]\na1 = 20\nb1 = 160\n{guess}\n"
    )
}

#[test]
fn a_scissor_lift_stands_as_it_was_sketched() {
    for ground in [150.0, 300.0, 450.0, 560.0_f64] {
        // Half the ground line and half a bar.
        let lean = (ground / 600.0).acos().to_degrees();
        let fold = 180.0 - 2.0 * lean;
        for stage in [1.0, -1.0] {
            // The second stage stands on the first, or hangs down in front of it.
            let [a2, b2] = match stage > 0.0 {
                true => [-fold, fold],
                false => [180.0, 180.0],
            };
            let text = scissors(ground, &format!("a2 = {}\nb2 = {}", a2 - 3.0, b2 + 4.0));
            let model = reference::scenes::written(&text);
            for (name, exact) in [("a1", lean), ("b1", 180.0 - lean), ("a2", a2), ("b2", b2)] {
                let found = first_pose(&model, name);
                assert!(off(found, exact) < 1e-9, "{text}: {name} is {found}");
            }
        }
    }
}

#[test]
fn a_start_value_that_another_mode_keeps_is_warned_about() {
    // Closing angles that are named, and wrong, leave nothing free: the lift collapses.
    let w = Workspace::new();
    w.write(
        "lift.toml",
        scissors(560.0, "a2 = -140\nb2 = 140\nx1 = 0\nx2 = 0"),
    );
    let warning = "the start value `a2` = -140.000000000 deg led to 180.000000000 deg";
    w.run(&["check", "lift.toml"])
        .exits(0)
        .says(&[warning, "--mode=++ has -137.92"]);
    let json = w
        .run(&["solve", "lift.toml", "--out", "lift.json"])
        .exits(0);
    json.says(&[warning]);
    let table = String::from_utf8(w.read("lift.json")).unwrap();
    assert!(
        table.contains("\"start-moved\"") && table.contains("\"mode\": \"++\""),
        "{table:.3000}"
    );
    w.run(&["check", "lift.toml", "--mode=++"])
        .exits(0)
        .says_nothing();
    // A rough sketch is no reason to speak: no assembly is nearer.
    w.run(&["check", "slider-crank"]).exits(0).says_nothing();
}

/// The coordinates of the starred mode are those where the motion starts, or place every body alike.
fn is_starred(model: &Model) -> bool {
    let (Ok(system), Ok(trajectory)) = (model.system(), driven::solve(model, &[0.0])) else {
        return true;
    };
    let Some(pose) = &trajectory.samples[0].pose else {
        return true;
    };
    let (first, named) = (model.actuation.start_at(0.0), &model.actuation.named);
    let modes = find_modes(&system, &first, named, 0, &|| false);
    let starred: Vec<&Mode> = modes.list.iter().filter(|m| m.is_scene).collect();
    let [mode] = starred[..] else {
        return false;
    };
    let slots = 0..model.unknowns.len();
    let same = slots.map(|k| turned(mode.coordinates[k] - pose.unknowns[k]) / model.scale_of(k));
    let bodies = body_poses(model, &mode.coordinates);
    let mut placed = bodies.iter().zip(&pose.bodies);
    let is_alike = |(a, b): (&Pose, &Pose)| {
        a.rotation.abs_diff_eq(b.rotation, 1e-6)
            && a.translation.distance(b.translation) < 1e-6 * model.size
    };
    mode.dimension > 0
        || same.fold(0.0, f64::max) < 1e-6
        || (!bodies.is_empty() && placed.all(is_alike))
}

/// Where start values are wishes the star stands at what is nearest to them, as in `solve`.
#[test]
fn the_starred_mode_is_where_the_motion_starts() {
    let rocker = |start: f64| {
        format!(
            "units = {{ length = \"mm\" }}\n[inputs]\nphi = 1\n[loops]\n\
             A = \"Rz(phi) Tx(35) Rz(al) Tx(95) Rz(mu) Tx(-80) Rz(-psi) Tx(-105)\"\n[guess]\npsi = {start}\n"
        )
    };
    let lift = scissors(560.0, "a2 = -140\nb2 = 140");
    let mut models: Vec<(String, Model)> = [lift, rocker(-2.3), rocker(1.6), rocker(0.0)]
        .into_iter()
        .map(|text| (text.clone(), reference::scenes::written(&text)))
        .collect();
    for scene in builtin::ALL {
        models.push((scene.name.to_owned(), builtin_scene(scene.name, &[])));
    }
    let folder = format!("{}/tests/hard", env!("CARGO_MANIFEST_DIR"));
    for file in std::fs::read_dir(folder).unwrap() {
        let path = file.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        if path.extension().is_some_and(|e| e == "toml") {
            models.push((name.to_owned(), reference::hard(name, &[])));
        }
    }
    assert!(models.len() > 50, "{}", models.len());
    let wrong = models.iter().filter(|(_, model)| !is_starred(model));
    let wrong: Vec<&String> = wrong.map(|(name, _)| name).collect();
    assert!(wrong.is_empty(), "{wrong:?}");
}
