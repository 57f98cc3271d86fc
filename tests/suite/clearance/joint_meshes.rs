//! What meets at a joint: meshes, which have no depth, and what is deep in a ring beside the joint.

use crate::driven::{check, even_times, knots, solve};
use crate::solids::{BOX_TRIANGLES, box_corner, stl_text, v};
use glam::DVec3;
use mechanim::clearance::check::{ClearanceReport, Judgement};
use mechanim::diag::Source;
use mechanim::scene::{Overrides, load_scene};
use std::path::Path;

/// Boxes of triangles: lowest and highest corner of each.
fn boxes(list: &[[DVec3; 2]]) -> String {
    let of_box = |&[low, high]: &[DVec3; 2]| {
        let (centre, half) = (0.5 * (low + high), 0.5 * (high - low));
        BOX_TRIANGLES.map(|t| t.map(|k| centre + half * box_corner(k)))
    };
    stl_text(list.iter().flat_map(of_box))
}

fn report(folder: &Path, text: &str, samples: usize) -> ClearanceReport {
    let source = Source {
        name: "test".into(),
        text: text.into(),
    };
    let overrides = Overrides {
        folder: folder.to_path_buf(),
        ..Overrides::default()
    };
    let scene = load_scene(&source, &overrides).unwrap_or_else(|e| panic!("{:#?}", e.diagnostics));
    let trajectory = solve(&scene, &knots(&scene, &even_times(&scene, samples))).unwrap();
    check(&scene, &trajectory, 1e-2)
}

/// Two links, one on the other, that turn on each other; the upper one has a nose beside the lower one.
fn links(folder: &Path, lift: f64, nose: f64, from: f64, to: f64) -> String {
    let lower = boxes(&[[v(-5.0, -5.0, -5.0), v(100.0, 5.0, 5.0)]]);
    let upper = boxes(&[
        [v(-5.0, -5.0, 5.0 + lift), v(100.0, 5.0, 15.0)],
        [v(60.0, -5.0, 5.0 - nose), v(70.0, 5.0, 10.0)],
    ]);
    std::fs::write(folder.join("lower.stl"), lower).unwrap();
    std::fs::write(folder.join("upper.stl"), upper).unwrap();
    format!(
        "duration = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\n[inputs]\nu = \"{from} + ({to} - {from})*t\"\n\
         [[bodies]]\nname = \"lower\"\nshapes = [{{ stl = {{ file = \"lower.stl\" }} }}]\n\
         [[bodies]]\nname = \"upper\"\nframe = \"Rz(u)\"\nshapes = [{{ stl = {{ file = \"upper.stl\" }} }}]\n\
         [clearance]\nminimum = 0.5\n"
    )
}

/// Links that slide on each other, overlap as modelled or have play are neighbours; one that folds into the other fails.
#[test]
fn a_mesh_that_folds_into_its_neighbour_is_seen() {
    let folder = tempfile::tempdir().unwrap();
    for (lift, nose, from, to, is_kept) in [
        // No nose: they slide on each other, overlap by 1, have play of 0.2.
        (0.0, 0.0, 90.0, 0.0, true),
        (-1.0, 0.0, 90.0, 0.0, true),
        (0.2, 0.0, 90.0, 0.0, true),
        // The nose stays away.
        (0.0, 10.0, 90.0, 30.0, true),
        // It cuts deep into the lower link, at the end or on the way.
        (0.0, 10.0, 90.0, 0.0, false),
        (0.2, 10.0, 90.0, 0.0, false),
        (-1.0, 10.0, 90.0, -90.0, false),
    ] {
        let text = links(folder.path(), lift, nose, from, to);
        for samples in [3, 20] {
            let report = report(folder.path(), &text, samples);
            let told = format!("{lift} {nose} {from} {to} {samples}: {report:#?}");
            assert_eq!(report.is_kept(), is_kept, "{told}");
            let failed = report
                .judged
                .iter()
                .find(|p| p.judgement == Judgement::Failed);
            assert_eq!(failed.is_some(), !is_kept, "{told}");
            assert_eq!(report.excluded.len(), usize::from(is_kept), "{told}");
        }
    }
}

/// A can across the tube of a ring that turns with it, beside the joint: whichever way out of the tube is taken for the
/// shortest, the can is not at the joint.
#[test]
fn what_is_deep_in_a_ring_beside_the_joint_is_judged() {
    let folder = tempfile::tempdir().unwrap();
    for (axis, start) in [
        ("Rz", 0.0),
        ("Rz", 1.0),
        ("Rx", 0.0),
        ("Ry", 0.3),
        ("Rx", 2.0),
    ] {
        for angle in [0.0, 0.1, 0.5, std::f64::consts::FRAC_PI_2, 2.0, 3.0] {
            let text = format!(
                "duration = 1\n[inputs]\nu = \"{angle} + t\"\n\
                 [[bodies]]\nname = \"ring\"\nframe = \"{axis}({start})\"\nshapes = [{{ torus = {{ ring = 1.7, tube = 3.43 }} }}]\n\
                 [[bodies]]\nname = \"link\"\nframe = \"{axis}({start}) Rz(u)\"\n\
                 shapes = [{{ cylinder = {{ from = [1.7, -0.55, 0], to = [1.7, 0.55, 0], radius = 0.4 }} }}]\n\
                 [clearance]\nminimum = 0\n"
            );
            let report = report(folder.path(), &text, 3);
            let told = format!("{axis} {start} {angle}: {report:#?}");
            assert_eq!(report.judged.len(), 1, "{told}");
            assert_eq!(report.judged[0].judgement, Judgement::Failed, "{told}");
            assert!(
                (report.judged[0].least.distance + 3.83).abs() < 1e-9,
                "{told}"
            );
        }
    }
}

/// A depth that is allowed of two balls says nothing of a ball that lies in a mesh.
#[test]
fn what_lies_in_a_mesh_is_seen_beside_what_may_be_deep() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("cube.stl"),
        boxes(&[[v(9.0, -1.0, -1.0), v(11.0, 1.0, 1.0)]]),
    )
    .unwrap();
    for (place, is_kept) in [(10.0, false), (14.0, true)] {
        let text = format!(
            "duration = 1\n[inputs]\nu = \"0.1*sin(t)\"\nw = \"0*t\"\n\
             [[bodies]]\nname = \"a\"\nshapes = [{{ sphere = {{ radius = 1 }} }}, {{ stl = {{ file = \"cube.stl\" }} }}]\n\
             [[bodies]]\nname = \"b\"\nframe = \"Tx(u) Ry(w) Rz(w)\"\nshapes = [{{ sphere = {{ center = [0, 0, 1.5], radius = 1 }} }}, \
             {{ sphere = {{ center = [{place}, 0, 0], radius = 0.3 }} }}]\n\
             [clearance]\nignore = [{{ pair = [\"a\", \"b\"], reason = \"balls\", down_to = -0.7 }}]\n"
        );
        let report = report(folder.path(), &text, 5);
        assert_eq!(report.is_kept(), is_kept, "{place}: {report:#?}");
    }
}
