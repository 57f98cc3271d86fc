//! Lines between surfaces.

use super::*;

fn lined(mut stage: Stage, creases: bool) -> Stage {
    stage.edges = Some(EdgeStyle {
        creases,
        ink: BLACK,
    });
    stage
}

/// A line runs along the border of a body, to both sides, and nowhere else; it does not depend on the tiles.
#[test]
fn lines_follow_the_borders_of_bodies() {
    let square = rectangle([-30.0, -20.0], [30.0, 20.0], 0.0);
    for samples in [1, 2, 4, 8, 16] {
        let stage = lined(flat_stage([100, 80], samples, vec![square.clone()]), true);
        let body = Instance {
            outline: Some(0),
            ..instance(0, [240, 200, 40])
        };
        let image = draw(stage, vec![body]);
        for (x, y, pixel) in image.enumerate_pixels() {
            let (dx, dy) = (
                (f64::from(x) - 49.5).abs() - 30.0,
                (f64::from(y) - 39.5).abs() - 20.0,
            );
            // Beside a corner the border is as far as the corner.
            let off = match dx > 0.0 && dy > 0.0 {
                true => dx.hypot(dy),
                false => dx.max(dy).abs(),
            };
            let own = if dx.max(dy) < 0.0 {
                [240, 200, 40]
            } else {
                WHITE
            };
            if off > 1.6 {
                assert_eq!(pixel.0[..3], own, "{samples}: {x} {y}");
            } else if off < 0.6 && dx.min(dy) < -1.0 {
                // At a corner the line thins out.
                assert!(pixel.0[0] < own[0] - 20, "{samples}: {x} {y} {pixel:?}");
            }
        }
    }
}

/// A veil that is all but clear and draws no line takes none away: neither under it nor where its own border parts the
/// samples of a pixel.
#[test]
fn a_clear_veil_leaves_lines_as_they_are() {
    let square = rectangle([-30.0, -20.0], [30.0, 20.0], 0.0);
    let veil = rectangle([-40.0, 10.3], [-29.6, 30.0], 1.0);
    for samples in [1, 2, 4, 8, 16] {
        let stage = || {
            let stage = flat_stage([100, 80], samples, vec![square.clone(), veil.clone()]);
            lined(stage, true)
        };
        let body = Instance {
            outline: Some(0),
            ..instance(0, [240, 200, 40])
        };
        let clear = Instance {
            opacity: 1e-3,
            ..instance(1, WHITE)
        };
        let bare = draw(stage(), vec![body.clone()]);
        let veiled = draw(stage(), vec![body, clear]);
        for ((x, y, bare), veiled) in bare.enumerate_pixels().zip(veiled.pixels()) {
            let off = bare.0.iter().zip(veiled.0).map(|(a, b)| a.abs_diff(b));
            assert!(
                off.max() <= Some(2),
                "{samples}: {x} {y} {bare:?} {veiled:?}"
            );
        }
    }
}

#[test]
fn what_has_no_outline_takes_no_line_and_bodies_of_one_group_have_none_between_them() {
    let left = rectangle([-30.0, -20.0], [0.0, 20.0], 0.0);
    let right = rectangle([0.0, -20.0], [30.0, 20.0], 0.0);
    let colour = [240, 200, 40];
    let part = |mesh, outline| Instance {
        outline,
        ..instance(mesh, colour)
    };
    let middle = |creases, outlines: [Option<u32>; 2]| {
        let stage = flat_stage([100, 80], 4, vec![left.clone(), right.clone()]);
        let parts = vec![part(0, outlines[0]), part(1, outlines[1])];
        *draw(lined(stage, creases), parts).get_pixel(50, 40)
    };
    assert_eq!(middle(true, [None, None]).0[..3], colour);
    assert_eq!(middle(false, [Some(3), Some(3)]).0[..3], colour);
    for dark in [
        middle(false, [Some(3), Some(4)]),
        middle(true, [Some(3), Some(3)]),
    ] {
        // As much darker as on any border.
        assert!(dark.0[0] < colour[0] - 30, "{dark:?}");
    }
}

/// The parts of a cut face are one surface, whichever lines are drawn; solids of a body are one only in outlines.
#[test]
fn stripes_of_a_cut_face_have_no_lines() {
    use crate::render::edges::FIRST_CUT;
    let halves = || vec![-30.0, 0.0].into_iter();
    let halves = || halves().map(|x| rectangle([x, -20.0], [x + 30.0, 20.0], 0.0));
    for (outline, creases, expected) in [
        (FIRST_CUT, true, false),
        (FIRST_CUT, false, false),
        (3, true, true),
        (3, false, false),
    ] {
        let stage = lined(flat_stage([100, 80], 4, halves().collect()), creases);
        let bodies = [0, 1].map(|mesh| Instance {
            outline: Some(outline),
            ..instance(mesh, [240, 200, 40])
        });
        let image = draw(stage, bodies.into());
        let has_line = (45..55).any(|x| image.get_pixel(x, 40).0[0] < 200);
        assert_eq!(has_line, expected, "{outline} {creases}");
        assert!((15..25).any(|x| image.get_pixel(x, 40).0[0] < 200));
    }
}
