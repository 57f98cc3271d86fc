//! Bodies deep in each other, rings around them and through them, several shapes a body: no bound above a dense reference,
//! no false verdict, whatever drives them and whatever the unit is.
//!
//! `MECHANIM_SCENES` is how many scenes, `MECHANIM_SEED` where they begin. The reference is dense in time with the exact
//! distances of solids, which are compared with the slow ones of 31 digits at some of the times.

use super::random_drives::{DURATION, Drive, Random, asked, drive, turn};
use crate::dense::golden;
use crate::driven::{Driven, even_times, knots, solve};
use crate::slow_distance::{known, size};
use crate::solids::{capsule, cone, cuboid, cylinder, sphere, torus, v};
use glam::{DMat3, DVec3};
use mechanim::clearance::motion::ProvedMotion;
use mechanim::clearance::sweep::{Least, PairSweep};
use mechanim::diag::Source;
use mechanim::distance::bodies::BodyElements;
use mechanim::distance::pair::signed_distance;
use mechanim::distance::primitive::Element;
use mechanim::math::Pose;
use mechanim::scene::{Overrides, load_scene};

/// Scenes of the suite; more are asked for by hand.
const SCENES: u64 = 80;

/// Places of the dense reference.
const DENSE: usize = 500;

/// How well the reference knows a least distance, in lengths of the pair.
const KNOWN: f64 = 1e-7;

/// A solid as text, and itself.
type Made = (String, Element);

fn list(p: DVec3) -> String {
    format!("[{:?}, {:?}, {:?}]", p.x, p.y, p.z)
}

fn rod(from: DVec3, to: DVec3, r: f64) -> Made {
    let text = format!(
        "{{ capsule = {{ from = {}, to = {}, radius = {r:?} }} }}",
        list(from),
        list(to)
    );
    (text, capsule(from, to, r))
}

fn can(from: DVec3, to: DVec3, r: f64) -> Made {
    let text = format!(
        "{{ cylinder = {{ from = {}, to = {}, radius = {r:?} }} }}",
        list(from),
        list(to)
    );
    (text, cylinder(from, to, r))
}

fn spike(from: DVec3, to: DVec3, [r, s]: [f64; 2]) -> Made {
    let text = format!(
        "{{ cone = {{ from = {}, to = {}, radius_from = {r:?}, radius_to = {s:?} }} }}",
        list(from),
        list(to)
    );
    (text, cone(from, to, r, s))
}

fn block(centre: DVec3, edges: DVec3) -> Made {
    let text = format!(
        "{{ box = {{ center = {}, size = {} }} }}",
        list(centre),
        list(edges)
    );
    (text, cuboid(centre, edges))
}

fn ball(centre: DVec3, r: f64) -> Made {
    let text = format!(
        "{{ sphere = {{ center = {}, radius = {r:?} }} }}",
        list(centre)
    );
    (text, sphere(centre, r))
}

fn ring(centre: DVec3, radius: f64, tube: f64) -> Made {
    let text = format!(
        "{{ torus = {{ center = {}, axis = [0, 0, 1], ring = {radius:?}, tube = {tube:?} }} }}",
        list(centre)
    );
    (text, torus(centre, DVec3::Z, radius, tube))
}

/// Two bodies that are made to meet: what they are and how, with every length times `s`.
type Row = (&'static str, fn(&mut Random, f64) -> [Vec<Made>; 2]);

const ROWS: [Row; 10] = [
    ("a rod in a torus", |random, s| {
        let (r, tube) = (s * random.range(0.8, 2.0), s * random.range(0.05, 0.9));
        let end = DVec3::X * (r * random.range(0.2, 1.4));
        let thin = s * random.range(0.01, 0.3);
        [
            vec![ring(DVec3::ZERO, r, tube)],
            vec![rod(DVec3::ZERO, end, thin)],
        ]
    }),
    ("a can in a spindle torus", |random, s| {
        let (r, tube) = (s * random.range(0.3, 1.0), s * random.range(1.0, 2.0));
        let side = v(0.0, s * random.range(0.1, 0.6), 0.0);
        let out = DVec3::X * r;
        [
            vec![ring(DVec3::ZERO, r, tube)],
            vec![can(out - side, out + side, 0.3 * s)],
        ]
    }),
    ("links of a chain", |random, s| {
        let [r, q] = [(); 2].map(|()| s * random.range(0.5, 1.5));
        let [t, u] = [(); 2].map(|()| s * random.range(0.02, 0.3));
        [
            vec![ring(DVec3::ZERO, r, t)],
            vec![ring(DVec3::X * (0.8 * r), q, u)],
        ]
    }),
    ("a ring pierced by a sheet", |random, s| {
        let thin = s * random.range(1e-4, 3e-2);
        let edges = v(thin, s * random.range(0.3, 2.0), s * random.range(0.3, 2.0));
        let out = v(random.range(0.9, 1.1), random.range(-0.3, 0.3), 0.0) * s;
        [
            vec![ring(DVec3::ZERO, s, 1e-3 * s)],
            vec![block(out, edges)],
        ]
    }),
    ("a shaft in its ring", |random, s| {
        let half = DVec3::Z * (s * random.range(0.1, 2.0));
        let r = s * random.range(0.6, 1.05);
        [
            vec![ring(DVec3::ZERO, s, 0.02 * s)],
            vec![can(-half, half, r)],
        ]
    }),
    ("blocks", |random, s| {
        let mut edges = || {
            v(
                random.range(0.05, 2.0),
                random.range(0.05, 2.0),
                random.range(0.05, 2.0),
            ) * s
        };
        [
            vec![block(DVec3::ZERO, edges())],
            vec![block(DVec3::ZERO, edges())],
        ]
    }),
    ("cans and spikes", |random, s| {
        let half = DVec3::Z * (s * random.range(0.05, 1.5));
        let ends = [s * random.range(0.0, 0.8), s * random.range(0.1, 0.8)];
        [
            vec![can(-half, half, s * random.range(0.1, 1.0))],
            vec![spike(-half, half * 0.7, ends)],
        ]
    }),
    ("balls in a block", |random, s| {
        let edges = v(1.0, random.range(0.3, 2.0), random.range(0.3, 2.0)) * s;
        let r = s * random.range(0.01, 1.5);
        [
            vec![ball(DVec3::ZERO, r), ball(DVec3::X * s, 0.5 * r)],
            vec![block(DVec3::ZERO, edges)],
        ]
    }),
    ("a frame around an arm", |random, s| {
        let corner = |x: f64, y: f64| v(x, y, 0.0) * s;
        let ways = [
            [-1.0, -1.0],
            [1.0, -1.0],
            [1.0, 1.0],
            [-1.0, 1.0],
            [-1.0, -1.0],
        ];
        let thick = s * random.range(0.02, 0.3);
        let sides = ways
            .windows(2)
            .map(|w| rod(corner(w[0][0], w[0][1]), corner(w[1][0], w[1][1]), thick));
        let tip = v(
            random.range(0.0, 1.2),
            random.range(0.0, 1.2),
            random.range(-0.5, 0.5),
        ) * s;
        let arm = vec![
            rod(DVec3::ZERO, tip, 0.1 * s),
            ball(tip, 0.2 * s),
            ring(DVec3::ZERO, 0.6 * s, 0.05 * s),
        ];
        [sides.collect(), arm]
    }),
    ("needles", |random, s| {
        let thin = s * random.range(1e-5, 1e-3);
        let half = DVec3::X * s;
        [
            vec![rod(-half, half, thin), spike(-half, half, [thin, 0.0])],
            vec![can(-half, half * 0.5, thin), block(half, v(s, thin, thin))],
        ]
    }),
];

/// One scene: its text, its bodies, the pose of the second one as seen from the first.
struct Case {
    name: &'static str,
    text: String,
    bodies: [Vec<Element>; 2],
    place: Box<dyn Fn(f64) -> Pose>,
    places: Vec<f64>,
    samples: usize,
    unit: f64,
}

fn case(number: u64) -> Case {
    let mut random = Random(number.wrapping_mul(0x9e37_79b9_7f4a_7c15) + 77);
    let (name, make) = ROWS[(number % ROWS.len() as u64) as usize];
    let unit = [1.0, 1.0, 1e-6, 1e4][random.pick(4)];
    let made = make(&mut random, unit);
    let mut drives = [(); 3].map(|()| drive(&mut random));
    // Many turns between few samples.
    if random.pick(4) == 0 {
        let rate = random.range(20.0, 60.0);
        drives[0] = Drive {
            text: format!("{rate}*t"),
            value: Box::new(move |t| rate * t),
            places: vec![],
        };
    }
    let axes = [random.pick(3), random.pick(3), random.pick(3)];
    let (arm, foot) = (unit * random.range(0.0, 0.5), random.vector(0.4) * unit);
    let slide = unit * [0.0, 0.1, 1.0][random.pick(3)];
    // Far from the origin, where both are: what is common to two bodies counts for nothing.
    let far = unit * [0.0, 0.0, 1e5][random.pick(3)];
    let letter = |axis: usize| ["x", "y", "z"][axis];
    let shapes = |k: usize| {
        made[k]
            .iter()
            .map(|(text, _)| text.clone())
            .collect::<Vec<_>>()
            .join(", ")
    };
    let text = format!(
        "duration = {DURATION}\n[inputs]\nu = {}\nv = {}\nw = {}\n\
         [[bodies]]\nname = \"a\"\nframe = \"Tx({far:?})\"\nshapes = [{}]\n\
         [[bodies]]\nname = \"b\"\nframe = \"Tx({far:?}) Tx({:?}) Ty({:?}) Tz({:?}) R{}(u) Tx({arm:?}) R{}(v) T{}({slide:?}*w)\"\nshapes = [{}]\n\
",
        drives[0].toml(),
        drives[1].toml(),
        drives[2].toml(),
        shapes(0),
        foot.x,
        foot.y,
        foot.z,
        letter(axes[0]),
        letter(axes[1]),
        letter(axes[2]),
        shapes(1),
    );
    let places = drives.iter().flat_map(|d| d.places.clone()).collect();
    let [u, v, w] = drives.map(|d| d.value);
    let place = move |t: f64| {
        let (first, second) = (turn(axes[0], u(t)), turn(axes[1], v(t)));
        let rotation: DMat3 = first * second;
        let translation =
            foot + first * (DVec3::X * arm) + rotation * (DVec3::AXES[axes[2]] * (slide * w(t)));
        Pose {
            rotation,
            translation,
        }
    };
    Case {
        name,
        text,
        bodies: made.map(|list| list.into_iter().map(|(_, element)| element).collect()),
        place: Box::new(place),
        places,
        samples: [2, 2, 5, 40][random.pick(4)],
        unit,
    }
}

impl Case {
    fn at(&self, t: f64) -> f64 {
        let pose = (self.place)(t);
        let placed: Vec<Element> = self.bodies[1].iter().map(|e| e.moved(&pose)).collect();
        let pairs = self.bodies[0]
            .iter()
            .flat_map(|a| placed.iter().map(move |b| (a, b)));
        pairs
            .map(|(a, b)| signed_distance(a, b).distance)
            .fold(f64::INFINITY, f64::min)
    }

    /// The least distance, and when.
    fn least(&self) -> (f64, f64) {
        let mut times: Vec<f64> = (0..=DENSE)
            .map(|k| DURATION * k as f64 / DENSE as f64)
            .collect();
        for place in &self.places {
            let near = (-5..=5).map(|k| place + 4e-3 * f64::from(k));
            times.extend(near.chain([place - 1e-9, *place, place + 1e-9]));
        }
        times.retain(|t| (0.0..=DURATION).contains(t));
        times.sort_by(f64::total_cmp);
        let values: Vec<f64> = times.iter().map(|t| self.at(*t)).collect();
        let mut order: Vec<usize> = (0..times.len()).collect();
        order.sort_by(|p, q| values[*p].total_cmp(&values[*q]));
        let mut least = (times[order[0]], values[order[0]]);
        for k in order.into_iter().take(4) {
            let [low, high] = [k.saturating_sub(1), (k + 1).min(times.len() - 1)].map(|k| times[k]);
            let found = golden(low, high, &|t| self.at(t));
            least = if found.1 < least.1 { found } else { least };
        }
        least
    }

    /// The slow reference agrees with the distances of all elements at a time.
    fn is_known_at(&self, t: f64) {
        let pose = (self.place)(t);
        for a in &self.bodies[0] {
            for b in self.bodies[1].iter().map(|e| e.moved(&pose)) {
                let (found, truth) = (signed_distance(a, &b).distance, known(a, &b));
                let off = truth.misses(found) / size(a, &b);
                assert!(
                    off <= 1e-11,
                    "{} at {t}: {found} {truth:?}\n{a:?}\n{b:?}",
                    self.name
                );
            }
        }
    }

    /// What is found for a minimum, which may be negative, and whether the motion is proved.
    fn found(&self, minimum: f64) -> (Least, bool) {
        let source = Source {
            name: self.name.into(),
            text: self.text.clone(),
        };
        let scene = load_scene(&source, &Overrides::default());
        let scene = scene.unwrap_or_else(|e| panic!("{:#?}\n{}", e.diagnostics, self.text));
        let trajectory = solve(&scene, &knots(&scene, &even_times(&scene, self.samples))).unwrap();
        let system = scene.system().unwrap();
        let mut motion = ProvedMotion::new(&system, &scene.actuation, &trajectory);
        let is_certified = motion.is_certified();
        let hulls = [0, 1].map(|k| BodyElements::new(&scene.mechanism.bodies[k]).unwrap());
        let sweep = PairSweep::new(&motion, [0, 1], hulls.each_ref(), 1e-3, minimum);
        let least = sweep.least_over(&mut motion, &mut Vec::new()).unwrap();
        (least, is_certified)
    }
}

#[derive(Default, Debug)]
struct StartResults {
    kept: usize,
    broken: usize,
    undecided: usize,
    deep: usize,
    close: usize,
}

fn judge(number: u64, tally: &mut StartResults) {
    let case = case(number);
    let (time, truth) = case.least();
    case.is_known_at(time);
    case.is_known_at(0.37 * DURATION);
    let mut random = Random(number ^ 0x1357);
    let off = case.unit * [0.1, 1e-2, 1e-4][random.pick(3)] * [1.0, -1.0][random.pick(2)];
    let minimum = truth + off;
    let (least, is_certified) = case.found(minimum);
    let told = format!(
        "scene {number}, {}: true {truth} at {time}, minimum {minimum}, {} samples, {least:?}\n{}",
        case.name, case.samples, case.text
    );
    let rounding = KNOWN * case.unit;
    // What the program has found counts where it is a distance of the reference, too; at a jump either side counts.
    let own = [-1e-9, 0.0, 1e-9].map(|off| case.at(least.time + off));
    let is_there = own
        .iter()
        .any(|own| (own - least.distance).abs() < rounding);
    assert!(is_there, "no such distance, {own:?}: {told}");
    let truth = truth.min(least.distance);
    assert!(is_certified, "not proved: {told}");
    assert!(
        least.bound <= truth + rounding,
        "bound above the truth: {told}"
    );
    assert!(least.is_certified || least.distance < 0.0, "{told}");
    match (least.bound >= minimum, least.distance < minimum) {
        (true, _) => tally.kept += 1,
        (_, true) => tally.broken += 1,
        _ => {
            tally.undecided += 1;
            println!("undecided: {told}");
        }
    }
    tally.deep += usize::from(truth < 0.0);
    tally.close += usize::from(truth - least.bound < 1e-2 * case.unit);
}

#[test]
fn bodies_in_each_other_are_judged_rightly() {
    let (count, seed) = (asked("MECHANIM_SCENES", SCENES), asked("MECHANIM_SEED", 0));
    let mut tally = StartResults::default();
    for number in seed..seed + count {
        judge(number, &mut tally);
    }
    println!("{count} scenes: {tally:?}");
    assert!(
        tally.kept as u64 > count / 5 && tally.broken as u64 > count / 5,
        "{tally:?}"
    );
    assert!(tally.deep as u64 > count / 2, "{tally:?}");
}
