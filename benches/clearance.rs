//! Time of one distance query for pairs of solids, and of the whole check of a scene. `cargo bench --bench clearance`.
//!
//! `cargo bench --bench clearance -- FILE` times the pairs of a file instead, so that other programs can be given the same
//! ones: a line each of a case's name, the exact distance, and two solids; a solid is `sphere R`, `capsule R HALF` (along
//! its z axis) or `torus RING TUBE` (about its z axis), and the twelve numbers of its pose, row by row.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../tests/suite/driven/mod.rs"]
#[allow(dead_code)]
mod driven;

#[path = "../tests/suite/solids/parry.rs"]
mod parry;

use driven::{check, frame_times, knots, solve};
use glam::{DMat3, DVec3};

use mechanim::analysis::random::Random;
use mechanim::clearance::sweep_and_prune::{AxisBox, near_boxes};
use mechanim::diag::Source;
use mechanim::distance::mesh_tree::MeshTrees;
use mechanim::distance::pair::signed_distance;
use mechanim::distance::primitive::{Element, shape_elements};

use mechanim::math::Pose;
use mechanim::model::shape::{Shape, Solid, TriangleSoup};
use mechanim::scene::{Overrides, load_scene};
use parry::Peer;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};
use std::f64::consts::{PI, TAU};
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

/// Queries of each kind.
const QUERIES: usize = 20_000;

/// Rounds; the fastest counts.
const ROUNDS: usize = 7;

/// A peer that is slower is given fewer queries: as many as take about so long a round, its preparation included.
const PEER_SECONDS: f64 = 0.5;

fn element(solid: Solid) -> Element {
    let shape = Shape {
        solid,
        body_from_shape: Pose::IDENTITY,
        colour: [0; 3],
        opacity: 1.0,
    };
    shape_elements(&[shape], &mut MeshTrees::default()).remove(0)
}

/// A pose on a path that passes through all kinds of positions.
fn pose(k: usize) -> Pose {
    let t = k as f64 * 0.377;
    let turn = Pose::from_axis_rotation(0, t) * Pose::from_axis_rotation(2, 1.7 * t);
    Pose::from_translation(DVec3::new(3.0 * t.sin(), 2.0 * (1.3 * t).cos(), 2.6)) * turn
}

/// The same queries of parry, each a distance and, of solids that overlap, a depth; `None` for shapes that it has not.
fn parry_micros(a: &Solid, b: &Solid, queries: usize) -> Option<f64> {
    let first = Peer::new(a, &Pose::IDENTITY)?;
    let start = Instant::now();
    black_box(first.distance(&Peer::new(b, &pose(0))?));
    let fitting = PEER_SECONDS / start.elapsed().as_secs_f64();
    let queries = queries.min(1 + fitting as usize);
    let placed: Option<Vec<Peer>> = (0..queries).map(|k| Peer::new(b, &pose(k))).collect();
    let placed = placed?;
    let round = |_| {
        let start = Instant::now();
        for other in &placed {
            black_box(black_box(&first).distance(other));
        }
        start.elapsed().as_secs_f64() * 1e6 / queries as f64
    };
    Some((0..ROUNDS).map(round).fold(f64::INFINITY, f64::min))
}

fn micros(a: &Element, b: &Element, queries: usize) -> f64 {
    let placed: Vec<Element> = (0..queries).map(|k| b.moved(&pose(k))).collect();
    let round = |_| {
        let start = Instant::now();
        for other in &placed {
            black_box(signed_distance(black_box(a), other));
        }
        start.elapsed().as_secs_f64() * 1e6 / queries as f64
    };
    (0..ROUNDS).map(round).fold(f64::INFINITY, f64::min)
}

/// A line of the table: ours beside parry's.
fn pair(name: &str, a: &Solid, b: &Solid, queries: usize) {
    let ours = micros(&element(a.clone()), &element(b.clone()), queries);
    let parry = parry_micros(a, b, queries).map(|time| format!(", parry {time:>8.3}"));
    println!(
        "{name:<20} {ours:>8.3} us a query{}",
        parry.unwrap_or_default()
    );
}

/// A sphere of triangles, `rings` from pole to pole and twice as many around.
fn sphere_mesh(rings: u32, radius: f64) -> Solid {
    let around = 2 * rings;
    let vertex = |i: u32, j: u32| {
        let (polar, turn) = (
            PI * f64::from(i) / f64::from(rings),
            TAU * f64::from(j) / f64::from(around),
        );
        let across = radius * polar.sin();
        DVec3::new(
            across * turn.cos(),
            across * turn.sin(),
            radius * polar.cos(),
        )
    };
    let poles = [DVec3::Z * radius, DVec3::NEG_Z * radius];
    let between = (1..rings).flat_map(|i| (0..around).map(move |j| vertex(i, j)));
    let vertices: Vec<DVec3> = poles.into_iter().chain(between).collect();
    let at = |i: u32, j: u32| match i {
        0 => 0,
        i if i == rings => 1,
        _ => 2 + (i - 1) * around + j % around,
    };
    let mut triangles = Vec::new();
    for i in 0..rings {
        for j in 0..around {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            if i + 1 < rings {
                triangles.push([a, b, c]);
            }
            if i > 0 {
                triangles.push([a, c, d]);
            }
        }
    }
    Solid::Triangles(Arc::new(TriangleSoup {
        source: String::new(),
        vertices,
        triangles,
        is_surface: false,
    }))
}

/// Meshes against solids and against each other, at fewer poses; `benches/peers/clearance.py` has the same pairs.
fn mesh_pairs(solids: [(&str, &Solid); 3]) {
    for rings in [16, 50, 158] {
        let mesh = sphere_mesh(rings, 1.0);
        let count = 4 * rings * (rings - 1);
        for (name, solid) in solids.into_iter().chain([("mesh", &mesh)]) {
            pair(&format!("{name}-mesh {count}"), solid, &mesh, 500);
        }
    }
}

/// Two elements and their distance.
type Known = (Element, Element, f64);

/// Time a query and largest error over pairs whose distance is known.
fn known(name: &str, pairs: &[Known]) {
    let round = |_| {
        let start = Instant::now();
        for (a, b, _) in pairs {
            black_box(signed_distance(black_box(a), black_box(b)));
        }
        start.elapsed().as_secs_f64() * 1e6 / pairs.len() as f64
    };
    let best = (0..50).map(round).fold(f64::INFINITY, f64::min);
    let off = pairs
        .iter()
        .map(|(a, b, exact)| (signed_distance(a, b).distance - exact).abs());
    let worst = off.fold(0.0, f64::max);
    println!("{name:<20} {best:>8.3} us a query, error at most {worst:.1e}");
}

fn ring(ring: f64, tube: f64) -> Element {
    let (centre, axis) = (DVec3::ZERO, DVec3::Z);
    element(Solid::Torus {
        centre,
        axis,
        ring,
        tube,
    })
}

fn known_pairs() {
    let up = |height: f64| Pose::from_translation(DVec3::Z * height);
    let ball = |radius| {
        let centre = DVec3::ZERO;
        element(Solid::Sphere { centre, radius })
    };
    let rod = |along: DVec3, radius| {
        let (from, to) = (-along, along);
        element(Solid::Capsule { from, to, radius })
    };
    let share = |k: usize| k as f64 / 359.0;
    let spheres: Vec<_> = (0..360)
        .map(|k| {
            let d = 0.4 + 3.6 * share(k);
            let place = Pose::from_translation(DVec3::new(0.6 * d, 0.8 * d, 0.0));
            (ball(1.0), ball(0.7).moved(&place), d - 1.7)
        })
        .collect();
    let crossed: Vec<_> = (0..360)
        .map(|k| {
            let height = 0.1 + 2.0 * share(k);
            let turn = Pose::from_axis_rotation(2, 0.3 + 2.5 * share(k));
            let second = rod(DVec3::X * 0.4, 0.15).moved(&(up(height) * turn));
            (rod(DVec3::X * 0.5, 0.2), second, height - 0.35)
        })
        .collect();
    let tori: Vec<_> = (0..360)
        .map(|k| {
            let height = 2.0 * (k as f64).to_radians().sin();
            let exact = 1.5_f64.hypot(height) - 0.9;
            (ring(3.0, 0.5), ring(1.5, 0.4).moved(&up(height)), exact)
        })
        .collect();
    let deep: Vec<_> = (0..40)
        .map(|k| {
            let height = 0.001 * f64::from(k);
            let exact = 0.7_f64.hypot(height) - 0.9;
            (ring(3.0, 0.5), ring(2.3, 0.4).moved(&up(height)), exact)
        })
        .collect();
    known("spheres", &spheres);
    known("crossed capsules", &crossed);
    known("coaxial tori", &tori);
    known("overlapping tori", &deep);
}

/// A solid and its pose from the words of a line.
fn read_solid<'w>(words: &mut impl Iterator<Item = &'w str>) -> Element {
    let kind = words.next().unwrap();
    let mut number = || words.next().unwrap().parse::<f64>().unwrap();
    let centre = DVec3::ZERO;
    let solid = match kind {
        "sphere" => Solid::Sphere {
            centre,
            radius: number(),
        },
        "capsule" => {
            let radius = number();
            let end = DVec3::Z * number();
            Solid::Capsule {
                from: -end,
                to: end,
                radius,
            }
        }
        _ => Solid::Torus {
            centre,
            axis: DVec3::Z,
            ring: number(),
            tube: number(),
        },
    };
    let rows: [[f64; 4]; 3] = std::array::from_fn(|_| std::array::from_fn(|_| number()));
    let column = |k: usize| DVec3::new(rows[0][k], rows[1][k], rows[2][k]);
    element(solid).moved(&Pose {
        rotation: DMat3::from_cols(column(0), column(1), column(2)),
        translation: column(3),
    })
}

fn pairs_of_a_file(path: &str) {
    let text = std::fs::read_to_string(path).unwrap();
    let mut cases: Vec<(String, Vec<Known>)> = Vec::new();
    for line in text.lines() {
        let mut words = line.split_whitespace();
        let name = words.next().unwrap();
        let exact = words.next().unwrap().parse().unwrap();
        let pair = (read_solid(&mut words), read_solid(&mut words), exact);
        match cases.last_mut() {
            Some((last, pairs)) if last == name => pairs.push(pair),
            _ => cases.push((name.to_owned(), vec![pair])),
        }
    }
    for (name, pairs) in &cases {
        known(name, pairs);
    }
}

fn check_scene(path: &str) -> f64 {
    let text = std::fs::read_to_string(path).unwrap();
    let source = Source {
        name: path.to_owned(),
        text,
    };
    let scene = load_scene(&source, &Overrides::default()).unwrap();
    let times = frame_times(&scene, scene.view.fps);
    let start = Instant::now();
    let trajectory = solve(&scene, &knots(&scene, &times)).unwrap();
    black_box(check(&scene, &trajectory, 1e-3));
    start.elapsed().as_secs_f64() * 1e3
}

/// Boxes of random edges at random places, the same in every run.
fn random_boxes(count: usize, room: DVec3, edge: f64) -> Vec<AxisBox> {
    let mut random = Random::new(1, 0, count as u64);
    let mut vector = || DVec3::from_array([0, 1, 2].map(|_| random.unit()));
    let one = |_| {
        let (centre, half) = (room * vector(), 0.5 * edge * vector());
        AxisBox {
            low: centre - half,
            high: centre + half,
        }
    };
    (0..count).map(one).collect()
}

/// The broad phase at one instant, where all boxes are new: ours beside parry's tree, built and traversed.
fn near_pairs(name: &str, boxes: &[AxisBox]) {
    const APART: f64 = 1.0;
    let ours = || {
        let mut met = 0;
        near_boxes(boxes, APART, |_| {
            met += 1;
            true
        });
        met
    };
    let mut workspace = BvhWorkspace::default();
    let mut theirs = || {
        let grown = DVec3::splat(0.5 * APART);
        let leaves = boxes
            .iter()
            .map(|b| Aabb::new(b.low - grown, b.high + grown));
        let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves.collect::<Vec<_>>());
        let mut met = 0;
        tree.traverse_bvtt_single_tree::<false>(&mut workspace, &mut |a, b| {
            met += usize::from(boxes[a as usize].apart(&boxes[b as usize]) <= APART);
        });
        met
    };
    assert_eq!(ours(), theirs(), "{name}");
    let rounds = (20_000 / boxes.len()).max(1);
    let [own, parry] = [fastest(rounds, ours), fastest(rounds, theirs)];
    println!(
        "near pairs of {:>5} boxes in {name:<12} {own:>8.1} us, parry {parry:>8.1}",
        boxes.len()
    );
}

/// Microseconds of the fastest of some runs of so many calls.
fn fastest(calls: usize, mut call: impl FnMut() -> usize) -> f64 {
    let times = (0..ROUNDS).map(|_| {
        let start = Instant::now();
        for _ in 0..calls {
            black_box(call());
        }
        1e6 * start.elapsed().as_secs_f64() / calls as f64
    });
    times.fold(f64::INFINITY, f64::min)
}

fn main() {
    let mut words = std::env::args().skip(1);
    if let Some(path) = words.find(|word| !word.starts_with("--")) {
        return pairs_of_a_file(&path);
    }
    let (o, z) = (DVec3::ZERO, DVec3::Z);
    let torus = Solid::Torus {
        centre: o,
        axis: z,
        ring: 2.0,
        tube: 0.2,
    };
    let capsule = Solid::Capsule {
        from: -z,
        to: z,
        radius: 0.3,
    };
    let cylinder = Solid::Cylinder {
        from: -z,
        to: z,
        radius: 0.3,
    };
    let cuboid = Solid::Box {
        centre: o,
        size: DVec3::new(1.0, 0.7, 0.5),
    };
    for (name, a, b) in [
        ("torus-torus", &torus, &torus),
        ("torus-capsule", &torus, &capsule),
        ("capsule-capsule", &capsule, &capsule),
        ("capsule-box", &capsule, &cuboid),
        ("box-cylinder", &cuboid, &cylinder),
        ("box-box", &cuboid, &cuboid),
        ("cylinder-cylinder", &cylinder, &cylinder),
    ] {
        pair(name, a, b, QUERIES);
    }
    mesh_pairs([
        ("capsule", &capsule),
        ("box", &cuboid),
        ("cylinder", &cylinder),
    ]);
    known_pairs();
    for (name, count, room, edge) in [
        ("a mechanism", 22, DVec3::splat(300.0), 100.0),
        ("a cube", 300, DVec3::splat(1000.0), 60.0),
        ("a slide", 1000, DVec3::new(1e4, 50.0, 50.0), 8.0),
        ("a cube", 1000, DVec3::splat(1000.0), 40.0),
        ("a cube", 10_000, DVec3::splat(1000.0), 20.0),
    ] {
        near_pairs(name, &random_boxes(count, room, edge));
    }
    for scene in ["gearshift", "slider-crank", "seven-r"] {
        let path = format!("{}/scenes/{scene}.toml", env!("CARGO_MANIFEST_DIR"));
        let best = (0..3)
            .map(|_| check_scene(&path))
            .fold(f64::INFINITY, f64::min);
        println!("check {scene:<14} {best:>8.1} ms");
    }
}
