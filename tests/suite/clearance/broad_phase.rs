//! Pairs of bodies that are settled together, by what they sweep: each of them passes, too, where it is looked at alone, and
//! they take neither time nor lines.

use crate::driven::{check, check_closely, even_times, knots, solve};
use crate::program::Workspace;
use mechanim::clearance::check::{ClearanceEffort, ClearanceReport, Judgement};
use mechanim::diag::Source;
use mechanim::kinematics::results::trajectory::Trajectory;
use mechanim::scene::{Overrides, Scene, builtin, load_scene};
use std::collections::HashMap;
use std::fmt::Write;

const MINIMUM: f64 = 0.5;

/// As few pairs one by one as may be.
const FEWEST: ClearanceEffort = ClearanceEffort {
    tolerance: 1.0,
    pairs: 0,
    times: false,
};

fn open(text: &str) -> Scene {
    let source = Source {
        name: "test".into(),
        text: text.into(),
    };
    load_scene(&source, &Overrides::default()).unwrap_or_else(|e| panic!("{:#?}", e.diagnostics))
}

fn motion(scene: &Scene, samples: usize) -> Trajectory {
    solve(scene, &knots(scene, &even_times(scene, samples))).unwrap()
}

/// The same numbers on every machine.
struct Lots(u64);

impl Lots {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}

const SHAPES: [&str; 6] = [
    "capsule = { from = [0, 0, 0], to = [8, 0, 0], radius = 1 }",
    "sphere = { center = [0, 1, 0], radius = 2 }",
    "box = { size = [12, 1, 3] }",
    "torus = { ring = 4, tube = 0.5 }",
    "cone = { from = [0, 0, 0], to = [0, 6, 0], radius_from = 2, radius_to = 0.5 }",
    "cylinder = { from = [-3, 0, 0], to = [3, 1, 0], radius = 1 }",
];

/// Arms of three joints that stand `apart` from each other, in a row of rows.
fn arms(count: usize, apart: f64, drives: [&str; 3]) -> String {
    let mut lots = Lots(count as u64);
    let mut text = String::from(
        "title = \"arms\"\nduration = 2\nunits = { length = \"mm\", angle = \"rad\" }\n[inputs]\n",
    );
    for (k, drive) in drives.iter().enumerate() {
        writeln!(text, "q{k} = {drive}").unwrap();
    }
    let row = (count as f64).sqrt().ceil() as usize;
    for k in 0..count {
        let (x, y) = ((k % row) as f64 * apart, (k / row) as f64 * apart);
        let rates: Vec<f64> = (0..3).map(|_| lots.between(0.5, 1.5)).collect();
        let shape = SHAPES[k % SHAPES.len()];
        write!(
            text,
            "[[bodies]]\nname = \"b{k}\"\nframe = \"Tx({x}) Ty({y}) Rz({}*q0) Tx(6) Ry({}*q1) Tx({}*q2) Rx(q0)\"\n\
             shapes = [{{ {shape} }}]\n",
            rates[0], rates[1], rates[2]
        )
        .unwrap();
    }
    write!(text, "[clearance]\nminimum = {MINIMUM}\n").unwrap();
    text
}

/// Smooth drives, kinks, jumps and steps.
const DRIVES: [[&str; 3]; 4] = [
    ["\"sin(3*t)\"", "\"2*t\"", "\"4*sin(9*t)\""],
    [
        "\"abs(sin(3*t))\"",
        "\"mod(5*t, 2)\"",
        "\"max(0, 8 - 400*abs(t - 1.013))\"",
    ],
    [
        "{ keys = [[0, 0], [0.7, 3], [2, 0]], ease = \"step\" }",
        "\"t\"",
        "\"6*floor(2.2*t)\"",
    ],
    ["\"40*t\"", "\"sin(50*t)\"", "\"7*exp(-(60*(t-1.0112))^2)\""],
];

/// A report with few pairs one by one against one with all: the same of each that both have, and what is far passes.
fn agree(few: &ClearanceReport, all: &ClearanceReport, said: &str) {
    let judged: HashMap<[usize; 2], &Judgement> =
        few.judged.iter().map(|p| (p.pair, &p.judgement)).collect();
    for p in &all.judged {
        match judged.get(&p.pair) {
            Some(judgement) => assert_eq!(**judgement, p.judgement, "{said}: {:?}", p.pair),
            None => {
                let far = few.far.unwrap();
                assert_eq!(p.judgement, far.judgement(), "{said}: {:?}", p.pair);
                assert!(
                    p.least.distance >= far.apart * (1.0 - 1e-9),
                    "{said}: {:?} {far:?}",
                    p.pair
                );
            }
        }
    }
    assert_eq!(few.is_kept(), all.is_kept(), "{said}");
    assert_eq!(few.judged_count(), all.judged_count(), "{said}");
}

#[test]
fn what_is_far_passes_alone_too() {
    for drives in DRIVES {
        for apart in [22.0, 50.0] {
            let scene = open(&arms(9, apart, drives));
            for samples in [4, 33] {
                let motion = motion(&scene, samples);
                let few = check_closely(&scene, &motion, FEWEST);
                let all = check_closely(&scene, &motion, ClearanceEffort::to(1.0));
                assert!(all.far.is_none() && all.counted.is_empty());
                agree(
                    &few,
                    &all,
                    &format!("{drives:?}, {apart} apart, {samples} samples"),
                );
            }
        }
    }
}

#[test]
fn built_in_scenes_have_the_same_verdict_by_either_way() {
    for name in [
        "gearshift",
        "twin-steer",
        "dyads",
        "feeder",
        "sphere-torus",
        "rope-drum",
    ] {
        let scene = open(&builtin::find_builtin(name).unwrap().text);
        let motion = motion(&scene, 20);
        let all = check_closely(
            &scene,
            &motion,
            ClearanceEffort {
                pairs: 1000,
                ..FEWEST
            },
        );
        let few = check_closely(&scene, &motion, FEWEST);
        agree(&few, &all, name);
    }
}

/// What the scene says of a pair counts however far it is; parts of one body, and patterns, are only counted.
#[test]
fn pairs_that_the_scene_names_are_listed() {
    let text = arms(30, 60.0, DRIVES[0]);
    let parts = "[[bodies]]\nname = \"part A\"\nframe = \"Tz(q2) Tz(500)\"\nshapes = [{ sphere = { radius = 1 } }]\n\
        [[bodies]]\nname = \"part B\"\nframe = \"Tz(q2) Tz(500)\"\nshapes = [{ sphere = { radius = 1 } }]\n[clearance]";
    let rules = "pairs = [{ pair = [\"b0\", \"b29\"], minimum = 100000 }]\n\
        ignore = [{ pair = [\"b1\", \"b20\"], reason = \"one\" }, { pair = [\"part *\", \"b*\"], reason = \"many\" }]\n\
        touching = [{ pair = [\"b2\", \"b25\"] }]\n";
    let scene = open(&(text.replace("[clearance]", parts) + rules));
    let report = check(&scene, &motion(&scene, 20), 1e-2);
    let judged = |pair: [usize; 2]| {
        let found = report.judged.iter().find(|p| p.pair == pair);
        &found.unwrap_or_else(|| panic!("{pair:?}")).judgement
    };
    assert_eq!(*judged([0, 29]), Judgement::Failed);
    assert_eq!(*judged([2, 25]), Judgement::Failed);
    assert!(report.excluded.iter().any(|p| p.pair == [1, 20]));
    let counted = |word: &str| {
        let of = |j: &Judgement| match j {
            Judgement::Neighbours(words) => *words == word,
            Judgement::Ignored(reason) => reason == word,
            _ => false,
        };
        report
            .counted
            .iter()
            .find(|(j, _)| of(j))
            .map(|(_, count)| *count)
    };
    assert_eq!(counted("one rigid part"), Some(1));
    assert_eq!(counted("many"), Some(60));
    assert!(report.far.unwrap().count > 100);
}

/// Surfaces without an end, and meshes without an inside, are near to everything.
#[test]
fn what_has_no_end_is_near_to_everything() {
    let text = arms(25, 60.0, DRIVES[0]);
    let floor = "[[bodies]]\nname = \"floor\"\nshapes = [{ half_space = { point = [0, 0, -15], normal = [0, 0, 1], size = 9 } }]\n[clearance]";
    let scene = open(&text.replace("[clearance]", floor));
    let report = check_closely(&scene, &motion(&scene, 20), FEWEST);
    let with_floor = report.judged.iter().filter(|p| p.pair[1] == 25);
    assert_eq!(with_floor.count(), 25);
    assert!(report.far.unwrap().count > 200);
}

/// Bodies that stand alone have a number of near pairs that grows with their number only.
#[test]
fn near_pairs_grow_with_the_bodies() {
    for count in [50, 200, 400] {
        let scene = open(&arms(count, 80.0, DRIVES[0]));
        let report = check(&scene, &motion(&scene, 21), 1.0);
        assert!(
            report.judged.len() <= 200 + 4 * count,
            "{count}: {}",
            report.judged.len()
        );
        assert!(report.far.unwrap().apart > 10.0, "{:?}", report.far);
    }
}

#[test]
fn every_report_tells_of_far_pairs() {
    let w = Workspace::new();
    w.write("arms.toml", arms(40, 80.0, DRIVES[0]));
    let run = w.run(&["check", "arms.toml", "--json", "r.json", "--junit", "r.xml"]);
    let text = run.exits(0).text();
    assert!(
        text.contains("780 pairs judged") && text.contains(" pairs far apart"),
        "{text}"
    );
    let json: serde_json::Value =
        serde_json::from_slice(&std::fs::read(w.path("r.json")).unwrap()).unwrap();
    let (far, pairs) = (
        &json["clearance"]["far"],
        json["clearance"]["pairs"].as_array().unwrap(),
    );
    assert_eq!(far["pairs"].as_u64().unwrap() + pairs.len() as u64, 780);
    assert_eq!(json["clearance"]["judged"], 780);
    assert!(
        far["bound"].as_f64().unwrap() > MINIMUM
            && far["certified"] == true
            && far["verdict"] == "passed"
    );
    let junit = std::fs::read_to_string(w.path("r.xml")).unwrap();
    assert!(
        junit.contains("pairs far apart") && junit.contains("never below"),
        "{junit}"
    );
    let all = w
        .run(&["check", "arms.toml", "--rows", "780"])
        .exits(0)
        .text();
    assert!(
        !all.contains("far apart") && all.contains("b0 / b39"),
        "{all}"
    );
}
