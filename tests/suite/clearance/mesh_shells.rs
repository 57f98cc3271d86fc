//! What of a mesh encloses space: cracks, facets turned round, flaps, walls inside, and what is no solid.

use crate::solids::{BOX_TRIANGLES, box_corner, v};
use glam::DVec3;
use mechanim::distance::mesh_tree::{MeshTree, ShellEnclosure};
use mechanim::model::shape::TriangleSoup;

type Triangles = Vec<[DVec3; 3]>;

/// A cuboid, outside out; face `k` are triangles 2 k and 2 k + 1.
fn cuboid(low: DVec3, high: DVec3) -> Triangles {
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let at = |k: usize| middle + half * box_corner(k);
    BOX_TRIANGLES.map(|t| t.map(at)).to_vec()
}

fn cube() -> Triangles {
    cuboid(DVec3::splat(-1.0), DVec3::ONE)
}

fn tree(triangles: &Triangles) -> MeshTree {
    MeshTree::new(&TriangleSoup {
        source: "test".to_owned(),
        vertices: triangles.iter().flatten().copied().collect(),
        triangles: (0..triangles.len() as u32)
            .map(|k| [3 * k, 3 * k + 1, 3 * k + 2])
            .collect(),
        is_surface: false,
    })
}

/// Points in the cube and beside it, also next to its faces, edges and what hangs on them.
fn judges_the_cube(mesh: &MeshTree) {
    for x in [-0.999, -0.5, 0.01, 0.7, 0.999] {
        for z in [-0.999, -0.01, 0.3, 0.999] {
            assert!(mesh.encloses(v(x, 0.02, z)), "{x} {z}");
            for outside in [
                v(x, 1.001, z),
                v(1.001, x, z),
                v(x, z, -1.001),
                v(1.2, x, z),
            ] {
                assert!(!mesh.encloses(outside), "{outside}");
            }
        }
    }
}

#[test]
fn flaps_take_nothing_from_a_closed_shell() {
    let corner = DVec3::ONE;
    let cases: Vec<(&str, Triangles, usize)> = vec![
        (
            "on an edge",
            vec![[corner, v(1.0, 1.0, -1.0), v(2.0, 1.5, 0.0)]],
            1,
        ),
        (
            "the other way round",
            vec![[v(1.0, 1.0, -1.0), corner, v(2.0, 1.5, 0.0)]],
            1,
        ),
        (
            "at a corner",
            vec![[corner, v(2.0, 2.0, 1.0), v(2.0, 2.0, 2.0)]],
            1,
        ),
        (
            "free",
            vec![[v(3.0, 0.0, 0.0), v(4.0, 0.0, 0.0), v(3.0, 1.0, 0.0)]],
            1,
        ),
        (
            "inside",
            vec![[v(0.1, 0.2, 0.0), v(0.3, 0.2, 0.1), v(0.1, -0.3, 0.4)]],
            1,
        ),
        (
            "two far from each other",
            vec![
                [v(9.0, 0.0, 0.0), v(9.5, 0.0, 0.0), v(9.0, 0.5, 0.0)],
                [v(-9.0, 0.0, 0.0), v(-9.5, 0.0, 0.0), v(-9.0, 0.5, 0.0)],
            ],
            2,
        ),
        (
            "a wall across",
            vec![
                [v(-1.0, -1.0, -1.0), v(1.0, 1.0, -1.0), v(1.0, 1.0, 1.0)],
                [v(-1.0, -1.0, -1.0), v(1.0, 1.0, 1.0), v(-1.0, -1.0, 1.0)],
            ],
            2,
        ),
    ];
    for (name, extra, count) in cases {
        for turned in [None, Some(0), Some(7)] {
            let mut triangles = cube();
            if let Some(k) = turned {
                triangles[k].swap(0, 1);
            }
            // A flap may stand anywhere in the file.
            triangles.splice(5..5, extra.iter().copied());
            let mesh = tree(&triangles);
            let known = (mesh.enclosure, mesh.flaps, mesh.open_edges);
            assert_eq!(
                known,
                (ShellEnclosure::Solid, count, 0),
                "{name}, {turned:?}"
            );
            assert_eq!(mesh.len(), triangles.len());
            judges_the_cube(&mesh);
        }
    }
}

#[test]
fn what_has_a_hole_has_no_inside() {
    let shrunk = |t: &[DVec3; 3], part: f64| {
        let middle = (t[0] + t[1] + t[2]) / 3.0;
        t.map(|p| middle + (p - middle) * part)
    };
    let mut hole = cube();
    hole.pop();
    let mut lid_off = cube();
    for corner in lid_off[2..4].iter_mut().flatten() {
        corner.z += 0.01;
    }
    let apart: Triangles = cube().iter().map(|t| shrunk(t, 0.99)).collect();
    let beside = cuboid(v(3.0, -1.0, -1.0), v(5.0, 1.0, 1.0));
    let beside_apart: Triangles = beside.iter().map(|t| shrunk(t, 0.99)).collect();
    let mut hole_beside = beside;
    hole_beside.pop();
    let shell_and = |other: Triangles| [cube(), other].concat();
    for (name, triangles) in [
        ("a triangle is missing", hole),
        ("the lid stands off", lid_off),
        ("facets of their own", apart),
        ("a closed shell and one with a hole", shell_and(hole_beside)),
        (
            "a closed shell and facets of another",
            shell_and(beside_apart),
        ),
        ("a sheet alone", cube()[..2].to_vec()),
    ] {
        let mesh = tree(&triangles);
        assert_eq!(
            (mesh.enclosure, mesh.flaps),
            (ShellEnclosure::Open, 0),
            "{name}"
        );
        assert!(
            mesh.open_edges > 0 && !mesh.encloses(v(0.1, 0.0, 0.0)),
            "{name}"
        );
    }
}

/// Corners off by what single precision leaves open, and far more.
#[test]
fn cracks_are_closed_as_far_as_a_file_can_be_wrong() {
    for (crack, shift, known) in [
        (1e-7, 0.0, ShellEnclosure::Solid),
        (9e-7, 0.0, ShellEnclosure::Solid),
        (1e-4, 1000.0, ShellEnclosure::Solid),
        (1e-5, 0.0, ShellEnclosure::Open),
        (1e-2, 1000.0, ShellEnclosure::Open),
    ] {
        let mut triangles = cube();
        for (k, t) in triangles.iter_mut().enumerate() {
            for (j, p) in t.iter_mut().enumerate() {
                let off = [0.3, -0.2, 0.1][(k + j) % 3] * crack;
                *p += v(shift + off, shift - off, 0.5 * off);
            }
        }
        let mesh = tree(&triangles);
        assert_eq!(mesh.enclosure, known, "{crack} {shift}");
        let middle = v(shift, shift, 0.0);
        assert_eq!(mesh.encloses(middle), known == ShellEnclosure::Solid);
        assert!(!mesh.encloses(middle + DVec3::X * 1.1));
    }
}

/// The same shell seen from inside.
fn turned(mut triangles: Triangles) -> Triangles {
    triangles.iter_mut().for_each(|t| t.swap(0, 1));
    triangles
}

fn small_cube(middle: DVec3, half: f64) -> Triangles {
    cuboid(middle - half, middle + half)
}

#[test]
fn thousands_of_shells_are_turned_outside_out() {
    let place = |k: usize| v((k % 20) as f64, (k / 20 % 20) as f64, (k / 400) as f64) * 3.0;
    // Beside each other, every other one inside out.
    let beside = (0..8000).flat_map(|k| match k % 2 {
        0 => small_cube(place(k), 1.0),
        _ => turned(small_cube(place(k), 1.0)),
    });
    let mesh = tree(&beside.collect());
    for k in 0..8000 {
        assert!(mesh.encloses(place(k) + v(0.1, 0.3, -0.7)), "{k}");
        assert!(!mesh.encloses(place(k) + v(0.1, 1.5, -0.7)), "{k}");
    }
    // As cavities of one block; in each an island whose triangles are numbered the wrong way round.
    let cavities = (0..1000).flat_map(|k| {
        [
            turned(small_cube(place(k), 1.0)),
            turned(small_cube(place(k), 0.5)),
        ]
        .concat()
    });
    let block = cuboid(DVec3::splat(-2.0), DVec3::splat(60.0));
    let mesh = tree(&block.into_iter().chain(cavities).collect());
    assert_eq!(mesh.enclosure, ShellEnclosure::Solid);
    for k in 0..1000 {
        let judged = [0.3, 0.8, 1.2].map(|x| mesh.encloses(place(k) + v(x, 0.02, -0.03)));
        assert_eq!(judged, [true, false, true], "{k}");
    }
}

/// Thousands of shells in each other have no use but to take time.
#[test]
fn shells_in_each_other_without_end_are_given_up() {
    let in_each_other = |count: usize| {
        let shells = (0..count).flat_map(|k| {
            let cube = small_cube(DVec3::ZERO, 1.0 + k as f64);
            if k % 2 == 0 { cube } else { turned(cube) }
        });
        tree(&shells.collect())
    };
    let few = in_each_other(9);
    assert_eq!(few.enclosure, ShellEnclosure::Solid);
    for k in 0..9 {
        assert_eq!(few.encloses(v(0.5 + k as f64, 0.1, 0.2)), k % 2 == 0, "{k}");
    }
    let many = in_each_other(4000);
    assert_eq!(many.enclosure, ShellEnclosure::Tangled);
    assert!(!many.encloses(DVec3::ZERO));
}

/// A sheet with two sides.
fn two_sided(sheet: Triangles) -> Triangles {
    let back = turned(sheet.clone());
    [sheet, back].concat()
}

/// Programs with two-sided faces write every triangle twice, once on either side. What such a shell encloses is counted once.
#[test]
fn shells_with_two_sides_enclose_what_single_ones_do() {
    let doubled = two_sided(cube());
    let mut mixed = doubled.clone();
    mixed.sort_by_key(|t| (t[0].x + 3.0 * t[1].y + 9.0 * t[2].z).to_bits());
    let halves_turned: Triangles = doubled
        .iter()
        .copied()
        .skip(1)
        .step_by(2)
        .chain(doubled.iter().copied().step_by(2))
        .collect();
    for mesh in [doubled, mixed, halves_turned] {
        let mesh = tree(&mesh);
        assert!(matches!(
            mesh.enclosure,
            ShellEnclosure::Solid | ShellEnclosure::InsideOut
        ));
        assert_eq!((mesh.flaps, mesh.len()), (0, 12));
        judges_the_cube(&mesh);
    }
    // Beside others, whichever of them is doubled.
    let far = cuboid(v(5.0, 5.0, 5.0), v(5.001, 9.0, 9.0));
    for beside in [far.clone(), two_sided(far)] {
        for own in [cube(), two_sided(cube())] {
            let mesh = tree(&[own, beside.clone()].concat());
            judges_the_cube(&mesh);
            assert!(mesh.encloses(v(5.0005, 6.0, 7.0)));
            assert!(!mesh.encloses(v(5.002, 6.0, 7.0)));
        }
    }
}

/// A sheet with two sides encloses nothing, beside a shell or alone.
#[test]
fn sheets_with_two_sides_enclose_nothing() {
    let flat = vec![[v(3.0, 0.0, 0.0), v(4.0, 0.0, 0.0), v(3.0, 1.0, 0.0)]];
    let moved = |t: [DVec3; 3]| t.map(|p| p + v(4.0, 0.0, 0.0));
    let bent: Triangles = cube().into_iter().skip(4).map(moved).collect();
    for sheet in [flat, bent] {
        let sheet = two_sided(sheet);
        let mesh = tree(&[cube(), sheet.clone()].concat());
        assert_eq!(
            (mesh.enclosure, mesh.len()),
            (ShellEnclosure::Solid, 12 + sheet.len())
        );
        judges_the_cube(&mesh);
        assert!(!tree(&sheet).encloses(v(4.0, 0.0, 0.0)));
    }
}

/// Shells that share a face, an edge or a corner, each of them single, doubled or inside out, beside a third one: what either of
/// them encloses counts.
#[test]
fn shells_that_touch_keep_their_insides() {
    let third = cuboid(v(10.0, -1.0, -1.0), v(12.0, 1.0, 1.0));
    let shapes: [fn(Triangles) -> Triangles; 6] = [
        |own| own,
        two_sided,
        turned,
        |own| [two_sided(own.clone()), own].concat(),
        |own| [two_sided(own.clone()), turned(own)].concat(),
        |own| two_sided(two_sided(own)),
    ];
    for (low, high) in [
        (v(1.0, -1.0, -1.0), v(3.0, 1.0, 1.0)),
        (v(1.0, 1.0, -1.0), v(3.0, 3.0, 1.0)),
        (v(1.0, 1.0, 1.0), v(3.0, 3.0, 3.0)),
    ] {
        // Faces that are shared count in both: there only the usual kinds.
        let shapes = &shapes[..if low == v(1.0, -1.0, -1.0) { 3 } else { 6 }];
        for first in shapes {
            for second in shapes {
                let own = [first(cube()), second(cuboid(low, high))].concat();
                for mesh in [own.clone(), [own, third.clone()].concat()] {
                    let mesh = tree(&mesh);
                    let known = (mesh.enclosure, mesh.flaps, mesh.open_edges);
                    assert!(
                        matches!(
                            known,
                            (ShellEnclosure::Solid | ShellEnclosure::InsideOut, 0, 0)
                        ),
                        "{known:?}"
                    );
                    for inside in [v(0.0, 0.1, 0.2), 0.5 * (low + high) + v(0.1, 0.2, 0.3)] {
                        assert!(
                            mesh.encloses(inside),
                            "{low:?} {inside:?} of {} triangles",
                            mesh.len()
                        );
                    }
                    assert!(!mesh.encloses(v(-1.1, 0.0, 0.0)) && !mesh.encloses(v(0.0, 0.0, 3.1)));
                }
            }
        }
    }
}
