//! Bodies between the motions of a joint part what the joint connects: the outer bodies are judged, and cuts are found.

use crate::driven::{check, even_times, knots, solve};
use crate::program::Workspace;
use mechanim::clearance::check::{ClearanceReport, Judgement};
use mechanim::diag::Source;
use mechanim::scene::{Overrides, Scene, load_scene};

/// Forearm, yoke, cross and hand about one point: the hand folds back onto the forearm.
const WRIST: &str = r#"title = "wrist"
units = { length = "mm", angle = "deg" }
duration = 1
inputs = { a = 0, b = "175*t", c = 0 }
chains = { Y = "Rz(a)", C = "Y Rx(b)", H = "C Rz(c)" }
bodies = [
  { name = "forearm", shapes = [{ capsule = { from = [0, 0, -100], to = [0, 0, -40], radius = 10 } }] },
  { name = "yoke", frame = "Y", shapes = [{ box = { center = [25, 0, 0], size = [6, 6, 6] } }] },
  { name = "cross", frame = "C", shapes = [{ box = { size = [6, 6, 6] } }] },
  { name = "hand", frame = "H", shapes = [{ capsule = { from = [0, 0, 40], to = [0, 0, 100], radius = 10 } }] },
]
clearance = { minimum = 1 }
"#;

fn open(text: &str) -> Scene {
    let source = Source {
        name: "test".into(),
        text: text.into(),
    };
    load_scene(&source, &Overrides::default())
        .unwrap_or_else(|e| panic!("{text}\n{:#?}", e.diagnostics))
}

fn report(scene: &Scene) -> ClearanceReport {
    let trajectory = solve(scene, &knots(scene, &even_times(scene, 41))).unwrap();
    check(scene, &trajectory, 1e-2)
}

#[test]
fn a_hand_that_folds_into_its_forearm_fails() {
    let w = Workspace::new();
    w.write("wrist.toml", WRIST);
    let run = w.run(&["check", "wrist.toml", "--json", "r.json"]);
    let text = run.exits(1).text();
    assert!(text.contains("failed     forearm / hand"), "{text}");
    let json = std::fs::read(w.path("r.json")).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&json).unwrap();
    let pair = &json["clearance"]["pairs"][0];
    assert_eq!(pair["bodies"], serde_json::json!(["forearm", "hand"]));
    assert!(
        (pair["distance"].as_f64().unwrap() + 16.5104).abs() < 1e-3,
        "{pair}"
    );
}

/// A joint of two or three motions between two bodies that come to cut each other.
struct Case {
    word: &'static str,
    inputs: &'static str,
    /// Frames behind its motions, one after the other, and what each motion is by itself.
    frames: &'static [[&'static str; 2]],
    /// Shapes of the first and the last body.
    outer: [&'static str; 2],
}

const BLOCK: &str = "{ box = { center = [20, 0, 0], size = [6, 6, 6] } }";

const CASES: [Case; 5] = [
    Case {
        word: "universal joint",
        inputs: r#"a = 0.1, b = "3*t""#,
        frames: &[
            ["Rz(a)", "revolute joint"],
            ["Rz(a) Rx(b)", "revolute joint"],
        ],
        outer: [
            "{ capsule = { from = [0, 0, -100], to = [0, 0, -40], radius = 10 } }",
            "{ capsule = { from = [0, 0, 40], to = [0, 0, 100], radius = 10 } }",
        ],
    },
    Case {
        word: "spherical joint",
        inputs: r#"a = 0.1, b = "3*t", c = 0.2"#,
        frames: &[
            ["Rz(a)", "revolute joint"],
            ["Rz(a) Rx(b)", "revolute joint"],
            ["Rz(a) Rx(b) Rz(c)", "revolute joint"],
        ],
        outer: [
            "{ capsule = { from = [0, 0, -100], to = [0, 0, -40], radius = 10 } }",
            "{ capsule = { from = [0, 0, 40], to = [0, 0, 100], radius = 10 } }",
        ],
    },
    Case {
        word: "cylindrical joint",
        inputs: r#"a = "t", d = "-50*t""#,
        frames: &[
            ["Rz(a - 1)", "revolute joint"],
            ["Rz(a - 1) Tz(d)", "prismatic joint"],
        ],
        outer: [
            BLOCK,
            "{ box = { center = [20, 0, 50], size = [6, 6, 6] } }",
        ],
    },
    Case {
        word: "helical joint",
        inputs: r#"a = "2*pi*t""#,
        frames: &[
            ["Rz(a)", "revolute joint"],
            ["Hz(-50, a)", "prismatic joint"],
        ],
        outer: [
            BLOCK,
            "{ box = { center = [20, 0, 50], size = [6, 6, 6] } }",
        ],
    },
    Case {
        word: "planar joint",
        inputs: r#"x = "-50*t", y = "-30*t", c = 0.1"#,
        frames: &[
            ["Tx(x)", "prismatic joint"],
            ["Tx(x) Ty(y)", "prismatic joint"],
            ["Tx(x) Ty(y) Rz(c)", "revolute joint"],
        ],
        outer: [
            BLOCK,
            "{ box = { center = [70, 30, 0], size = [20, 20, 20] } }",
        ],
    },
];

impl Case {
    /// The scene, with bodies far away after the motions of these numbers.
    fn scene(&self, between: &[usize]) -> Scene {
        let body = |name: &str, frame: &str, shape: &str| {
            format!("  {{ name = \"{name}\", frame = \"{frame}\", shapes = [{shape}] }},\n")
        };
        let mut bodies = body("first", "Tx(0)", self.outer[0]);
        for k in between {
            let far = format!(
                "{{ sphere = {{ center = [{}, 300, 0], radius = 3 }} }}",
                500 * (k + 1)
            );
            bodies += &body(&format!("part {k}"), self.frames[*k][0], &far);
        }
        bodies += &body("last", self.frames[self.frames.len() - 1][0], self.outer[1]);
        open(&format!(
            "duration = 1\nunits = {{ length = \"mm\", angle = \"rad\" }}\ninputs = {{ {} }}\nbodies = [\n{bodies}]\nclearance = {{ minimum = 1 }}\n",
            self.inputs
        ))
    }

    /// What is said of the outer bodies.
    fn verdict(&self, between: &[usize]) -> (Judgement, f64) {
        let scene = self.scene(between);
        let report = report(&scene);
        let outer = [0, scene.mechanism.bodies.len() - 1];
        let mut pairs = report.judged.iter().chain(&report.excluded);
        let pair = pairs.find(|p| p.pair == outer).unwrap();
        (pair.judgement.clone(), pair.least.distance)
    }
}

#[test]
fn outer_bodies_of_a_joint_are_neighbours_unless_a_body_is_between() {
    for case in &CASES {
        let outer = case.scene(&[]);
        let joint = outer.mechanism.joints.between(0, 1);
        assert_eq!(joint.map(|joint| joint.kind.words()), Some(case.word));
        let inner = case.frames.len() - 1;
        for k in 0..inner {
            let (judgement, depth) = case.verdict(&[k]);
            assert_eq!(judgement, Judgement::Failed, "{}, part {k}", case.word);
            assert!(depth < -1.0, "{}: {depth}", case.word);
        }
        let all: Vec<usize> = (0..inner).collect();
        assert_eq!(case.verdict(&all).0, Judgement::Failed, "{}", case.word);
    }
}

#[test]
fn parts_of_a_joint_are_neighbours_of_what_they_touch() {
    for case in &CASES {
        let inner: Vec<usize> = (0..case.frames.len() - 1).collect();
        let scene = case.scene(&inner);
        for k in 0..=inner.len() {
            let joint = scene.mechanism.joints.between(k, k + 1);
            let word = joint.map(|joint| joint.kind.words());
            assert_eq!(word, Some(case.frames[k][1]), "{}", case.word);
        }
    }
}

/// A contact whose surface belongs to a part between is a part between.
#[test]
fn a_contact_between_the_motions_of_a_joint_parts_its_bodies() {
    for case in CASES.iter().filter(|case| case.word != "helical joint") {
        for k in 0..case.frames.len() - 1 {
            let text = format!(
                "duration = 1\nunits = {{ length = \"mm\", angle = \"rad\" }}\ninputs = {{ {} }}\n\
                [contacts.touch]\nfirst = {{ sphere = {{ radius = 1 }}, frame = \"{} T(20, 0, 0)\" }}\n\
                second = {{ plane = {{}}, frame = \"Tz(-z)\" }}\n[guess]\nz = 30\n\
                [[bodies]]\nname = \"first\"\nshapes = [{}]\n\
                [[bodies]]\nname = \"last\"\nframe = \"{}\"\nshapes = [{}]\n[clearance]\nminimum = 1\n",
                case.inputs,
                case.frames[k][0],
                case.outer[0],
                case.frames[case.frames.len() - 1][0],
                case.outer[1],
            );
            let scene = open(&text);
            let joint = scene.mechanism.joints.between(0, 1);
            assert!(joint.is_none(), "{}, part {k}: {joint:?}", case.word);
        }
    }
}

/// Two rotations by one coordinate are geared, not a joint; a translation by a formula of an angle is a cam, not a screw.
#[test]
fn motions_that_are_coupled_otherwise_than_a_screw_are_joints_of_their_own() {
    for frame in [
        "Rz(a) Rx(2*a)",
        "Rz(a) Rx(a + 0.5)",
        "Rz(sin(a)) Rx(cos(a))",
        "Rz(a) Tz(5*sin(a))",
    ] {
        let scene = open(&format!(
            "duration = 1\ninputs = {{ a = \"t\" }}\nbodies = [\n\
            {{ name = \"first\", shapes = [{BLOCK}] }},\n\
            {{ name = \"last\", frame = \"{frame}\", shapes = [{BLOCK}] }},\n]\nclearance = {{ minimum = 1 }}\n"
        ));
        assert!(scene.mechanism.joints.between(0, 1).is_none(), "{frame}");
    }
}

#[test]
fn a_check_that_judges_no_pair_warns_and_does_not_pass() {
    let w = Workspace::new();
    let two = format!(
        "inputs = {{ a = 0 }}\nbodies = [\n{{ name = \"first\", shapes = [{BLOCK}] }},\n\
        {{ name = \"last\", frame = \"Tx(1)\", shapes = [{BLOCK}] }},\n]\nclearance = {{ minimum = 1 }}\n"
    );
    w.write("two.toml", two);
    let run = w.run(&["check", "two.toml", "--json", "r.json"]);
    run.exits(1)
        .says(&["no pair of bodies was judged: the only one is excluded"]);
    let json = std::fs::read(w.path("r.json")).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&json).unwrap();
    assert_eq!(json["clearance"]["judged"], 0);
    assert_eq!(json["clearance"]["excluded"][0]["reason"], "one rigid part");
}
