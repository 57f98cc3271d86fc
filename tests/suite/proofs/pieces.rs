//! Clearances of all pieces within their tolerances: closed forms, random pieces that never come nearer than the bound, and refusals.

use crate::draws::Draws;
use crate::program::Workspace;
use mechanim::analysis::enclosure::{TolerancePlan, enclose_clearances};
use mechanim::analysis::study::ParametricMechanism;
use mechanim::clearance::check::{ClearanceEffort, check_clearance};
use mechanim::clearance::part::{JudgedPart, PieceClearance};
use mechanim::diag::Source;
use mechanim::distance::bodies::{BodyElements, nearest_bodies};
use mechanim::kinematics::motion::continuation::{solve_motion, solve_unproved};
use mechanim::kinematics::motion::sampling::even_times;
use mechanim::kinematics::structure::system::System;
use mechanim::scene::{Overrides, Scene, builtin, load_scene};
use serde_json::Value;
use std::sync::atomic::AtomicBool;

/// A scene with dimensions and tolerances in the file's units, and what is judged in it.
struct Case {
    source: Source,
    tolerances: Vec<(String, f64)>,
    scene: Scene,
    times: Vec<f64>,
    parts: Vec<JudgedPart>,
}

impl Case {
    fn new(source: Source, samples: usize, tolerances: &[(&str, f64)]) -> Self {
        let scene = load_scene(&source, &Overrides::default()).unwrap();
        let system = System::new(scene.mechanism.clone(), &scene.actuation).unwrap();
        let times = even_times(&scene.mechanism, &scene.actuation, samples);
        let motion = solve_motion(&system, &scene.actuation, &times);
        let rules = scene.clearance.clone().unwrap();
        let closely = ClearanceEffort {
            pairs: usize::MAX,
            ..ClearanceEffort::to(1e-3)
        };
        let silent = |_, _| {};
        let report = check_clearance(&system, &scene.actuation, &rules, &motion, closely, &silent);
        let tolerances = tolerances.iter().map(|(n, t)| ((*n).to_owned(), *t));
        Self {
            tolerances: tolerances.collect(),
            source,
            times,
            parts: report.parts,
            scene,
        }
    }

    fn text(text: &str, samples: usize, tolerances: &[(&str, f64)]) -> Self {
        let (name, text) = ("case.toml".to_owned(), text.to_owned());
        Self::new(Source { name, text }, samples, tolerances)
    }

    /// A scene of the program with every length at one tolerance, and every angle.
    fn builtin(name: &str, samples: usize, [length, angle]: [f64; 2]) -> Self {
        let mut case = Self::new(builtin::find_builtin(name).unwrap(), samples, &[]);
        for name in case.scene.dimensions.iter() {
            let kind = case.scene.kinds.iter().find(|(n, _)| n == name).unwrap().1;
            let is_angle = kind == mechanim::model::mechanism::Kind::Angle;
            let tolerance = if is_angle { angle } else { length };
            case.tolerances.push((name.clone(), tolerance));
        }
        case
    }

    fn family(&self) -> ParametricMechanism {
        let names: Vec<String> = self.tolerances.iter().map(|(n, _)| n.clone()).collect();
        let overrides = Overrides {
            carries_shapes: true,
            ..Overrides::default()
        };
        ParametricMechanism::varying(&self.source, &overrides, &names).unwrap()
    }

    /// Tolerances times a factor, in internal units.
    fn plan<'f>(&self, family: &'f ParametricMechanism, factor: f64) -> TolerancePlan<'f> {
        let mechanism = family.mechanism();
        let unit = |name: &str| {
            let input = mechanism.inputs.iter().find(|i| i.name == name).unwrap();
            mechanism.unit_of(input.kind).number()
        };
        let own = self.tolerances.iter();
        let own = own.map(|(name, t)| (name.clone(), factor * t * unit(name)));
        TolerancePlan::new(family, &own.collect::<Vec<_>>())
    }

    fn clearances(&self, factor: f64) -> Vec<PieceClearance> {
        let family = self.family();
        let plan = self.plan(&family, factor);
        enclose_clearances(&plan, &self.parts, &self.times, 1e-3, 2)
    }

    /// The distances of all parts of a random piece, each the least at some times of its own; `None` where it does not close.
    /// Solids are those of the scene, read with the piece's dimensions.
    fn piece(&self, family: &ParametricMechanism, draws: &mut Draws) -> Option<Vec<f64>> {
        let mut overrides = Overrides::default();
        let mut values = Vec::new();
        let corner = draws.share() < 0.5;
        for (variable, (name, tolerance)) in family.study.variables.iter().zip(&self.tolerances) {
            assert_eq!(variable.name, *name);
            let place = 2.0 * draws.share() - 1.0;
            let place = if corner { place.signum() } else { place };
            let unit = family.units(variable.kind);
            let value = variable.start * unit + place * tolerance * (1.0 - 1e-9);
            values.push(value / unit);
            overrides
                .parameters
                .push((name.clone(), format!("{value:?}")));
        }
        let own = load_scene(&self.source, &overrides).unwrap();
        let bodies = &own.mechanism.bodies;
        let last = *self.times.last().unwrap();
        let mut times: Vec<f64> = (0..12).map(|_| last * draws.share()).collect();
        times.sort_by(f64::total_cmp);
        times.insert(0, 0.0);
        let piece = family.with_start(&values);
        let motion = solve_unproved(piece.system(), &piece.actuation, &times);
        let mut least = vec![f64::INFINITY; self.parts.len()];
        let mechanism = piece.mechanism();
        for sample in motion.samples {
            let pose = sample.pose?;
            let coordinates = [pose.unknowns.as_slice(), &sample.inputs].concat();
            let arguments = mechanism.argument_values(&coordinates);
            let place = |k: usize| mechanism.bodies[k].world_from_body.pose(&arguments);
            for (part, least) in self.parts.iter().zip(&mut least) {
                let [a, b] = part.bodies;
                let hulls = [a, b].map(|k| BodyElements::new(&bodies[k]).unwrap());
                // What is cut at a joint has other elements; those scenes are judged by their other pairs.
                if hulls[0].elements.len() != part.hulls[0].elements.len()
                    || hulls[1].elements.len() != part.hulls[1].elements.len()
                    || !part.left_out.is_empty()
                {
                    continue;
                }
                let seen = place(a).inverse() * place(b);
                let found = nearest_bodies(&hulls[0], &hulls[1], &seen, &part.left_out);
                *least = least.min(found.unwrap().proximity.distance);
            }
        }
        Some(least)
    }

    /// How many of so many random pieces come nearer than a bound somewhere.
    fn below(&self, bounds: &[PieceClearance], pieces: usize, seed: u64) -> usize {
        let family = self.family();
        let mut draws = Draws(seed);
        let broken = (0..pieces).filter(|_| {
            let least = self
                .piece(&family, &mut draws)
                .expect("a piece does not close");
            let mut pairs = least.iter().zip(bounds);
            pairs.any(|(d, known)| *d < known.bound - 1e-9)
        });
        broken.count()
    }
}

/// Where nobody waits any more nothing is said to be proved.
#[test]
fn clearances_that_nobody_waits_for_are_unknown() {
    let wall = r#"{ box = { center = ["w+20", 0, 0], size = [40, 300, 40] } }"#;
    let case = Case::text(&crank(wall), 9, &[("r", 0.1)]);
    let family = case.family();
    let raised = AtomicBool::new(true);
    let plan = case.plan(&family, 1.0).until(&raised);
    let found = enclose_clearances(&plan, &case.parts, &case.times, 1e-3, 2);
    assert!(!found.is_empty());
    for pair in &found {
        assert_eq!(pair.bound, f64::NEG_INFINITY);
        assert!(pair.refusal.is_some());
    }
}

/// A crank of length r beside a wall at w, which is a plane or a box.
fn crank(wall: &str) -> String {
    format!(
        r#"
units = {{ length = "mm", angle = "rad" }}
duration = 1
[parameters]
r = 40
w = 60
[inputs]
phi = "2*pi*t"
[[bodies]]
name = "wall"
shapes = [{wall}]
[[bodies]]
name = "crank"
frame = "Rz(phi)"
shapes = [{{ capsule = {{ from = [0, 0, 0], to = ["r", 0, 0], radius = 5 }} }}]
[clearance]
minimum = 14.75
"#
    )
}

#[test]
fn a_crank_beside_a_wall_keeps_what_its_tolerances_leave() {
    for wall in [
        r#"{ half_space = { point = ["w", 0, 0], normal = [-1, 0, 0], size = 100 } }"#,
        r#"{ box = { center = ["w+20", 0, 0], size = [40, 300, 40] } }"#,
    ] {
        for (tolerances, exact) in [
            (&[("r", 0.1)][..], 14.9),
            (&[("r", 0.1), ("w", 0.05)], 14.85),
            (&[("w", 0.05)], 14.95),
        ] {
            let case = Case::text(&crank(wall), 25, tolerances);
            let found = &case.clearances(1.0)[0];
            assert!((found.nominal - 15.0).abs() < 1e-9, "{found:?}");
            // The nearest piece is found, and the bound is below it by less than a fiftieth of what the tolerances take.
            assert!((found.found - exact).abs() < 1e-6, "{wall} {found:?}");
            let lost = exact - found.bound;
            assert!(
                lost >= -1e-9 && lost < 0.02 * (15.0 - exact) + 0.015,
                "{wall} {found:?}"
            );
            assert!(found.is_kept() && !found.is_broken());
        }
    }
}

/// A radius is a dimension as well.
#[test]
fn solids_grow_with_their_dimensions() {
    let text = crank(r#"{ cylinder = { from = ["w", 0, -9], to = ["w", 0, 9], radius = "q" } }"#);
    let text = text.replace("w = 60", "w = 60\nq = 2");
    let case = Case::text(&text, 25, &[("q", 0.25), ("w", 0.5)]);
    let found = &case.clearances(1.0)[0];
    let exact = 60.0 - 40.0 - 5.0 - 2.0 - 0.75;
    assert!(
        found.bound <= exact + 1e-9 && found.bound > exact - 0.05,
        "{found:?}"
    );
}

/// A four-bar with a post beside its coupler, a slider-crank with a stop, and a rod on a skew crank between two plates.
const SCENES: [(&str, &[(&str, f64)]); 3] = [
    (
        r#"
units = { length = "mm", angle = "rad" }
duration = 2
[parameters]
a = 30
b = 90
c = 70
d = 80
[inputs]
phi = "pi*t"
[loops]
A = "Rz(phi) Tx(a) Rz(u) Tx(b) Rz(v) Tx(-c) Rz(-w) Tx(-d)"
[guess]
u = 0.9
v = 0.6
w = 1.5
[[bodies]]
name = "post"
shapes = [{ cylinder = { from = [30, 95, -20], to = [30, 95, 20], radius = 6 } }, { sphere = { center = ["d+40", 20, 0], radius = 4 } }]
[[bodies]]
name = "crank"
frame = "Rz(phi)"
shapes = [{ capsule = { from = [0, 0, -9], to = ["a", 0, -9], radius = 3 } }]
[[bodies]]
name = "coupler"
frame = "Rz(phi) Tx(a) Rz(u)"
shapes = [{ capsule = { from = [0, 0, 0], to = ["b", 0, 0], radius = 3 } }, { box = { center = ["b/2", 12, 0], size = [20, 8, 5] } }]
[clearance]
minimum = 0.5
"#,
        &[("a", 0.2), ("b", 0.2), ("c", 0.2), ("d", 0.2)],
    ),
    (
        r#"
units = { length = "mm", angle = "rad" }
duration = 1
[parameters]
r = 40
L = 90
s = 145
[inputs]
phi = "2*pi*t"
[loops]
A = "Rz(phi) Tx(r) Rz(u) Tx(L) Rz(v) Tx(-h)"
[guess]
u = 0.1
v = -0.1
h = 130
[[bodies]]
name = "stop"
shapes = [{ box = { center = ["s+5", 0, 0], size = [10, 30, 30] } }, { torus = { center = [20, 62, 0], axis = [0.3, 0.2, 1], ring = 12, tube = 2 } }]
[[bodies]]
name = "slider"
frame = "Tx(h)"
shapes = [{ box = { center = [0, 0, 0], size = [16, 10, 12] } }]
[[bodies]]
name = "rod"
frame = "Rz(phi) Tx(r) Rz(u)"
shapes = [{ cylinder = { from = [-8, 0, 0], to = ["L", 0, 0], radius = 4 } }]
[clearance]
minimum = 0.5
"#,
        &[("r", 0.15), ("L", 0.1), ("s", 0.05)],
    ),
    (
        r#"
units = { length = "mm", angle = "deg" }
duration = 1
[parameters]
r = 25
k = 60
tilt = 20
q = 33
[inputs]
phi = "360*t"
[[bodies]]
name = "plates"
shapes = [{ box = { center = [0, 0, -44], size = [200, 200, 4] } }, { cylinder = { from = ["q", 0, 40], to = ["q", 60, 60], radius = 5 } }]
[[bodies]]
name = "rod"
frame = "Ry(tilt) Rz(phi) Tx(r)"
shapes = [{ capsule = { from = [0, 0, 0], to = ["k", 0, 0], radius = 3 } }, { cylinder = { from = ["k", 0, -4], to = ["k", 0, 4], radius = 6 } }]
[clearance]
minimum = 0.5
"#,
        &[("r", 0.3), ("k", 0.3), ("tilt", 0.4), ("q", 0.3)],
    ),
];

/// No piece of thousands comes nearer than the bound of its pair; without the band of the tolerances many of them do.
#[test]
fn random_pieces_keep_their_bounds() {
    let mut cases: Vec<Case> = SCENES
        .iter()
        .map(|(text, tolerances)| Case::text(text, 41, tolerances))
        .collect();
    cases.push(Case::builtin("four-bar", 25, [0.1, 0.1]));
    cases.push(Case::builtin("slider-crank", 25, [0.1, 0.1]));
    let mut caught = 0;
    for (k, case) in cases.iter().enumerate() {
        let bounds = case.clearances(1.0);
        for known in &bounds {
            assert!(known.refusal.is_none(), "{k} {known:?}");
            assert!(
                known.bound <= known.found && known.found <= known.nominal,
                "{k} {known:?}"
            );
        }
        let pieces = if k < 3 { 700 } else { 120 };
        assert_eq!(case.below(&bounds, pieces, 7 + k as u64), 0, "scene {k}");
        // The planted fault: the motion as drawn, without the band of the tolerances.
        caught += case.below(&case.clearances(0.0), 60, 91 + k as u64);
    }
    assert!(caught > 50, "{caught}");
}

/// Bounds are near the nearest pieces that were found: second order of the tolerances, and solids that are no polytopes, are what is
/// lost.
#[test]
fn bounds_are_near_the_nearest_pieces() {
    for (k, (text, tolerances)) in SCENES.iter().enumerate() {
        for known in Case::text(text, 41, tolerances).clearances(1.0) {
            let (lost, taken) = (known.found - known.bound, known.nominal - known.found);
            println!("{k} {:?} {lost} {taken} {known:?}", known.pair);
            assert!(
                lost < 0.1 * taken + 1.5e-3 * known.found.abs(),
                "{k} {known:?}"
            );
        }
    }
}

/// Exit code, text, JSON and JUnit say the same, whatever comes out.
#[test]
fn the_program_judges_every_piece_by_one_rule() {
    let workspace = Workspace::new();
    let wall = r#"{ half_space = { point = ["w", 0, 0], normal = [-1, 0, 0], size = 100 } }"#;
    workspace.write("crank.toml", crank(wall));
    // Kept, broken by a piece, and between the two: nearer than the bound can be told.
    for (tolerance, code, verdict) in [("0.1", 0, "passed"), ("0.2", 1, "failed")] {
        let run = [
            "check",
            "crank.toml",
            "--made-within",
            tolerance,
            "--vary",
            "r,w",
            "--json",
            "a.json",
            "--junit",
            "a.xml",
        ];
        let output = workspace.command(&run).output().unwrap();
        let text = String::from_utf8(output.stdout).unwrap();
        assert_eq!(output.status.code(), Some(code), "{text}");
        assert!(
            text.contains("every piece      2 dimensions (r, w) within their tolerances"),
            "{text}"
        );
        let document: Value = serde_json::from_slice(&workspace.read("a.json")).unwrap();
        let pair = &document["clearance"]["pieces"]["pairs"][0];
        assert_eq!(pair["verdict"], verdict, "{document}");
        assert_eq!(document["clearance"]["passed"], code == 0);
        assert_eq!(document["result"], verdict);
        let junit = String::from_utf8(workspace.read("a.xml")).unwrap();
        assert!(junit.contains("wall / crank, every piece"), "{junit}");
        assert_eq!(junit.contains("<failure"), code == 1, "{junit}");
    }
    // An interval of its own needs no option.
    let run = ["check", "crank.toml", "--param", "r=40+-0.1"];
    let output = workspace.command(&run).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        output.status.success() && text.contains("1 dimension (r) within its tolerance"),
        "{text}"
    );
}

/// Drives and frames with kinks and jumps: no piece is left out where they are, for however short a time.
#[test]
fn pieces_are_looked_at_between_kinks_and_jumps() {
    let w = Workspace::new();
    let pulse = "2*(floor(t - 0.513) - floor(t - 0.522))";
    let peak = "max(0, 2 - 400*abs(t - 1.013))";
    let keys = "{ keys = [[0, 0], [0.513, 2], [0.522, 0], [2, 0]], ease = \"step\" }";
    // Only at the last instant.
    let last = "{ keys = [[0, 0], [1, 0.5], [2, 2]], ease = \"step\" }";
    for (drive, frame) in [
        (last.to_owned(), "Tx(L + u)"),
        ("\"2*floor(t/2)\"".to_owned(), "Tx(L + u)"),
        (format!("\"{pulse}\""), "Tx(L + u)"),
        (format!("\"{peak}\""), "Tx(L + u)"),
        (keys.to_owned(), "Tx(L + u)"),
        (
            "\"t\"".to_owned(),
            "Tx(L + 2*(floor(u - 0.513) - floor(u - 0.522)))",
        ),
        ("\"t\"".to_owned(), "Tx(L + max(0, 2 - 400*abs(u - 1.013)))"),
    ] {
        // At the top 9 - 3 - 2 - 1 - 1, and by 0.05 nearer.
        for (minimum, passes) in [(1.9, true), (1.96, false), (1.99, false)] {
            let text = format!(
                "duration = 2\n[parameters]\nL = 3\n[inputs]\nu = {drive}\n\
                 [[bodies]]\nname = \"a\"\nframe = \"{frame}\"\nshapes = [{{ sphere = {{ radius = 1 }} }}]\n\
                 [[bodies]]\nname = \"b\"\nframe = \"Tx(9)\"\nshapes = [{{ sphere = {{ radius = 1 }} }}]\n\
                 [clearance]\nminimum = 0\npairs = [{{ pair = [\"a\", \"b\"], minimum = {minimum} }}]\n"
            );
            w.write("case.toml", text);
            let said = w.run(&["check", "case.toml", "--made-within", "0.05"]);
            let told = format!("{frame} of {drive}: {}", said.text());
            // A frame that jumps may be undecided, which is no pass.
            match passes {
                true if frame == "Tx(L + u)" => assert_eq!(said.code, 0, "{told}"),
                true => {}
                false => assert_eq!(said.code, 1, "{told}"),
            }
        }
    }
}

/// A length that nothing but a solid has is a dimension like all others.
#[test]
fn lengths_of_solids_alone_are_dimensions() {
    let w = Workspace::new();
    // The balls come within 5 - 3 - 1 - 0.5 as drawn, and by 0.05 of both lengths nearer.
    for (minimum, code) in [(0.39, 0), (0.41, 1)] {
        w.write(
            "case.toml",
            format!(
                "duration = 2\n[parameters]\nL = 3\nhalf = 0.25\nr = \"2*half\"\n[inputs]\nu = \"1.1*t\"\n\
                 [[bodies]]\nname = \"a\"\nframe = \"Rz(u) Tx(L)\"\nshapes = [{{ sphere = {{ radius = \"r\" }} }}]\n\
                 [[bodies]]\nname = \"b\"\nframe = \"Ty(5)\"\nshapes = [{{ sphere = {{ radius = 1 }} }}]\n\
                 [clearance]\nminimum = {minimum}\n"
            ),
        );
        let said = w.run(&[
            "check",
            "case.toml",
            "--param",
            "L=3+-0.05",
            "--param",
            "half=0.25+-0.025",
        ]);
        assert!(said.text().contains("2 dimensions"), "{}", said.text());
        said.exits(code);
        w.write(
            "plain.toml",
            String::from_utf8(w.read("case.toml"))
                .unwrap()
                .replace("half = 0.25\nr = \"2*half\"", "r = 0.5"),
        );
        let said = w.run(&["check", "plain.toml", "--made-within", "0.05"]);
        assert!(said.text().contains("2 dimensions"), "{}", said.text());
        // Standard input can be read only once.
        let text = w.read("plain.toml");
        let piped = w.run_with(&["check", "-", "--made-within", "0.05"], &text);
        assert_eq!(piped.text(), said.text());
        said.exits(code);
        piped.exits(code);
    }
}

/// A crank that does not get round with the shortest of its tolerances: no bound, and why.
#[test]
fn intervals_that_reach_a_fold_are_refused() {
    let workspace = Workspace::new();
    let (text, _) = SCENES[1];
    workspace.write(
        "stop.toml",
        text.replace("L = 90", "L = 40.2")
            .replace("h = 130", "h = 80"),
    );
    let run = [
        "check",
        "stop.toml",
        "--made-within",
        "0.2",
        "--samples",
        "24",
    ];
    let output = workspace.command(&run).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(
        text.contains("undecided") && text.contains("no bound from t ="),
        "{text}"
    );
    assert!(text.contains("within the tolerances, `"), "{text}");
}

/// What cannot be true of other pieces is said before anything is solved.
#[test]
fn what_no_tolerance_can_follow_is_refused() {
    let workspace = Workspace::new();
    let wall = r#"{ half_space = { point = [60, 0, 0], normal = [-1, "w/600", 0], size = 100 } }"#;
    workspace.write("crank.toml", crank(wall));
    let plain = crank(wall).replace("\"w/600\"", "0");
    workspace.write("bare.toml", plain.split("[clearance]").next().unwrap());
    for (run, message) in [
        (
            &[
                "check",
                "crank.toml",
                "--made-within",
                "0.1",
                "--vary",
                "r,w",
            ][..],
            "determines the direction or the scale of a solid",
        ),
        (
            &["check", "bare.toml", "--made-within", "0.1", "--vary", "r"],
            "--made-within reports clearances, but the scene has no section [clearance]",
        ),
        (
            &["check", "crank.toml", "--vary", "r"],
            "no tolerance is given",
        ),
        (
            &["check", "crank.toml", "--param", "r=41..40"],
            "is above the upper end",
        ),
        (
            &[
                "check",
                "crank.toml",
                "--pose",
                "phi=0",
                "--param",
                "r=40+-1",
            ],
            "is an interval",
        ),
    ] {
        let output = workspace.command(run).output().unwrap();
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{run:?} {text}");
        assert!(text.contains(message), "{run:?} {text}");
    }
}

/// `all` takes every length and angle that shapes depend on: of their points, sizes and frames.
#[test]
fn dimensions_of_frames_of_solids_vary() {
    let folder = Workspace::new();
    // The right face of the box is at 1 + s + size/2 and turns with `a`; the ball stands at 9.
    let text = "units = { length = \"mm\", angle = \"deg\" }\nduration = 1\n[inputs]\nx = \"t\"\n[parameters]\ns = 2\na = 0\n\
                [[bodies]]\nname = \"block\"\nframe = \"Tx(x)\"\n\
                shapes = [{ box = { size = [2, 2, 2] }, frame = \"Tx(s) Rz(a)\" }]\n\
                [[bodies]]\nname = \"ball\"\nshapes = [{ sphere = { center = [9, 0, 0], radius = 1 } }]\n[clearance]\nminimum = 3.5\n";
    folder.write("frame.toml", text);
    for vary in [None, Some("s,a"), Some("all")] {
        let mut args = vec![
            "check",
            "frame.toml",
            "--made-within",
            "0.6",
            "--json",
            "r.json",
        ];
        args.extend(vary.into_iter().flat_map(|names| ["--vary", names]));
        // 9 - 1 - (1 + 2 + 1) = 4 as drawn; 3.4 for a piece with s = 2.6.
        let run = folder.run(&args).exits(1);
        let report: Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
        let dimensions = report["clearance"]["pieces"]["dimensions"].as_array();
        assert_eq!(dimensions.map(Vec::len), Some(2), "{vary:?} {report}");
        assert!(run.text().contains("2 dimensions"), "{}", run.text());
    }
}
