//! Meshes over random motions: bounds hold against dense samples, and what is clear, or cut, is said to be.

use crate::draws::Draws;
use crate::driven::{Driven, check, even_times, knots, solve};
use crate::program::is_full;
use mechanim::clearance::check::{Judgement, PairReport};
use mechanim::diag::Source;
use mechanim::distance::bodies::{BodyElements, LeftOut, nearest_bodies};
use mechanim::scene::{Overrides, Scene, load_scene};
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;

/// Facets of a closed surface over a grid that joins its ends, as the text of an STL file.
fn facets(rows: u32, columns: u32, at: impl Fn(f64, f64) -> [f64; 3]) -> String {
    let mut text = String::from("solid s\n");
    let corner = |i: u32, j: u32| {
        let angle = |k: u32, n: u32| TAU * f64::from(k % n) / f64::from(n);
        at(angle(i, rows), angle(j, columns)).map(|x| x as f32)
    };
    for (i, j) in (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))) {
        let [a, b, c, d] =
            [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| corner(i, j));
        for t in [[a, b, c], [a, c, d]] {
            text += "facet normal 0 0 0\nouter loop\n";
            for [x, y, z] in t {
                writeln!(text, "vertex {x} {y} {z}").unwrap();
            }
            text += "endloop\nendfacet\n";
        }
    }
    text + "endsolid\n"
}

/// A ring with bumps, coarse and fine: other meshes and rods go through it.
fn write_rings(folder: &Path) {
    for (name, rows, columns) in [("coarse", 9, 4), ("fine", 60, 24)] {
        let text = facets(rows, columns, |u, v| {
            let thick = 3.0 + 0.5 * (5.0 * u + 2.0 * v).sin();
            let across = 20.0 + thick * v.cos();
            [across * u.cos(), across * u.sin(), thick * v.sin()]
        });
        std::fs::write(folder.join(format!("{name}.stl")), text).unwrap();
    }
}

const SHAPES: [&str; 6] = [
    "stl = { file = \"coarse.stl\" }",
    "stl = { file = \"fine.stl\" }",
    "box = { center = [0, 0, 0], size = [8, 6, 30] }",
    "cylinder = { from = [0, 0, -20], to = [0, 0, 20], radius = 4 }",
    "capsule = { from = [0, 0, -20], to = [0, 0, 20], radius = 4 }",
    "torus = { center = [0, 0, 0], axis = [0, 0, 1], ring = 18, tube = 3 }",
];

/// A mesh and another body, both of which turn; the second one swings, too.
fn text(draws: &mut Draws, k: usize, minimum: f64) -> String {
    let mut number = |size: f64| size * draws.number();
    let [fast, late, wide] = [4.0 + number(3.0), number(3.0), number(12.0)];
    let (near, tilt) = ([2.0, 14.0, 45.0][k % 3], number(1.5));
    format!(
        "duration = 1\nunits = {{ length = \"mm\" }}\n[inputs]\np = \"{fast}*t\"\nq = \"1.5*sin({fast}*t+{late})\"\n\
         d = \"{wide}*sin({fast}*t-{late})\"\n\
         [[bodies]]\nname = \"a\"\nframe = \"Tx(1) Rz(p)\"\nshapes = [{{ {} }}]\n\
         [[bodies]]\nname = \"b\"\nframe = \"Tx({near}) Tz({}) Ty(d) Rx({tilt}) Ry(q)\"\nshapes = [{{ {} }}]\n\
         [clearance]\nminimum = {minimum}\n",
        SHAPES[k % 2],
        number(20.0),
        SHAPES[k / 2 % 6],
    )
}

fn open(folder: &Path, text: &str) -> Scene {
    let source = Source {
        name: "test".to_owned(),
        text: text.to_owned(),
    };
    let overrides = Overrides {
        folder: folder.to_owned(),
        ..Overrides::default()
    };
    load_scene(&source, &overrides).unwrap_or_else(|e| panic!("{:#?}", e.diagnostics))
}

/// The least distance of many poses.
fn dense(scene: &Scene) -> f64 {
    let hulls = [0, 1].map(|k| BodyElements::new(&scene.mechanism().bodies[k]).unwrap());
    let trajectory = solve(scene, &knots(scene, &even_times(scene, 600))).unwrap();
    let distances = trajectory.poses().map(|pose| {
        let a_from_b = pose.bodies[0].inverse() * pose.bodies[1];
        let found = nearest_bodies(&hulls[0], &hulls[1], &a_from_b, &LeftOut::new());
        found.unwrap().proximity.distance
    });
    distances.fold(f64::INFINITY, f64::min)
}

fn judged(scene: &Scene) -> PairReport {
    let trajectory = solve(scene, &knots(scene, &even_times(scene, 21))).unwrap();
    check(scene, &trajectory, 1e-3).judged.remove(0)
}

#[test]
fn meshes_over_random_motions_are_judged_rightly() {
    let folder = tempfile::tempdir().unwrap();
    write_rings(folder.path());
    let (mut clear, mut cut) = (0, 0);
    let scenes = if is_full() { 96 } else { 32 };
    for k in 0..scenes {
        let scene = |minimum| open(folder.path(), &text(&mut Draws(k as u64), k, minimum));
        let least = dense(&scene(0.0));
        let pair = judged(&scene(0.9 * least));
        let said = format!("{k}: {least} {pair:?}");
        if least == 0.0 {
            cut += 1;
            assert!(!pair.judgement.is_kept(), "{said}");
            continue;
        }
        // The rings come near each other between the dense samples, too, by at most this.
        assert!(
            pair.least.bound <= least && pair.least.distance <= least + 1e-3 * least,
            "{said}"
        );
        if pair.judgement == Judgement::Passed {
            clear += 1;
            assert!(
                pair.least.is_refined && pair.least.bound >= 0.9 * least,
                "{said}"
            );
        } else {
            assert!(pair.least.distance < 0.9 * least, "{said}");
        }
        let asked = judged(&scene(1.01 * least));
        assert_eq!(asked.judgement, Judgement::Failed, "{said}");
    }
    assert!(3 * clear > scenes && 18 * cut > scenes, "{clear} {cut}");
}
