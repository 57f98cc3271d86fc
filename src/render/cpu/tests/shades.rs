//! Bodies that shade each other: where shadows end, what has none, and that nothing flickers.

use super::*;
use crate::render::look::KEY_DIRECTION;

const SIDE: u32 = 240;
const GREY: [u8; 3] = [170; 3];

/// The room of all scenes here; a texel of the key light's map is about a pixel in it.
const ROOM: [DVec3; 2] = [
    DVec3::new(-120.0, -120.0, -40.0),
    DVec3::new(120.0, 120.0, 80.0),
];

fn picture(bodies: Vec<(Shape, Pose)>, shades: bool) -> RgbaImage {
    let (solids, poses): (Vec<_>, Vec<_>) = bodies.into_iter().unzip();
    let meshes = solids.iter().map(|solid| mesh_of(solid, 0.1)).collect();
    let stage = Stage {
        mutual_shade: shades.then_some(ROOM),
        ..flat_stage([SIDE; 2], 4, meshes)
    };
    let placed = poses.into_iter().enumerate().map(|(mesh, pose)| Instance {
        world_from_mesh: pose,
        flat: 0.0,
        ..instance(mesh, GREY)
    });
    let instances = placed.collect();
    draw(stage, instances)
}

fn plate() -> (Shape, Pose) {
    let size = DVec3::new(230.0, 230.0, 20.0);
    let centre = DVec3::new(0.0, 0.0, -10.0);
    (Shape::Box { centre, size }, Pose::IDENTITY)
}

fn ball(centre: DVec3, radius: f64) -> (Shape, Pose) {
    let centre_of = DVec3::ZERO;
    let solid = Shape::Sphere {
        centre: centre_of,
        radius,
    };
    (solid, Pose::from_translation(centre))
}

/// The point of the plate's face in the middle of a pixel.
fn on_plate(x: u32, y: u32) -> DVec3 {
    let half = f64::from(SIDE) / 2.0;
    DVec3::new(f64::from(x) + 0.5 - half, half - 0.5 - f64::from(y), 0.0)
}

/// Distance of a point from the ray of light through it that comes nearest to `centre`.
fn off_the_light(point: DVec3, centre: DVec3) -> f64 {
    let light = DVec3::from(KEY_DIRECTION.map(f64::from));
    (centre - point).cross(light).length()
}

/// A ball throws an ellipse on a plate: half the darkness lies within a pixel and a half of where the light grazes it,
/// all of it three pixels further in, none three further out.
#[test]
fn the_shadow_of_a_ball_ends_where_light_grazes_it() {
    let (centre, radius) = (DVec3::new(-20.0, 40.0, 45.0), 22.0);
    let bodies = || vec![plate(), ball(centre, radius)];
    let (shaded, open) = (picture(bodies(), true), picture(bodies(), false));
    let darkness = |x: u32, y: u32| {
        let [a, b] = [&shaded, &open].map(|image| f64::from(image.get_pixel(x, y).0[0]));
        b - a
    };
    let middle = centre
        - DVec3::from(KEY_DIRECTION.map(f64::from)) * (centre.z / f64::from(KEY_DIRECTION[2]));
    let full = darkness((middle.x + 120.0) as u32, (120.0 - middle.y) as u32);
    assert!(full > 25.0, "{full}");
    let (mut inside, mut border) = (0, 0);
    for (x, y) in (10..SIDE - 10).flat_map(|x| (10..SIDE - 10).map(move |y| (x, y))) {
        let point = on_plate(x, y);
        // Pixels that show the ball itself, and those that it keeps the light around from.
        if (point - centre).truncate().length() < radius + 26.0 {
            continue;
        }
        let out = off_the_light(point, centre) - radius;
        let dark = darkness(x, y) / full;
        match out {
            // Across the plate a pixel may be farther off than across the light.
            _ if out < -3.0 => {
                inside += 1;
                assert!(dark > 0.95, "{x} {y}: {out} {dark}");
            }
            _ if out > 3.0 => assert!(dark == 0.0, "{x} {y}: {out} {dark}"),
            _ if out.abs() > 1.5 => {
                border += 1;
                assert_eq!(dark > 0.5, out < 0.0, "{x} {y}: {out} {dark}");
            }
            _ => {}
        }
    }
    assert!(inside > 500 && border > 60, "{inside} {border}");
}

/// A convex body alone looks as it does without shades: no light that is there is taken away, at no slope.
#[test]
fn a_convex_body_does_not_shade_itself() {
    let cylinder = Shape::Cylinder {
        from: DVec3::new(-60.0, 0.0, 0.0),
        to: DVec3::new(60.0, 0.0, 0.0),
        radius: 20.0,
    };
    let slab = Shape::Box {
        centre: DVec3::ZERO,
        size: DVec3::new(140.0, 120.0, 30.0),
    };
    let capsule = Shape::Capsule {
        from: DVec3::new(-50.0, 10.0, 0.0),
        to: DVec3::new(50.0, -10.0, 20.0),
        radius: 6.0,
    };
    let round = Shape::Sphere {
        centre: DVec3::ZERO,
        radius: 70.0,
    };
    for solid in [cylinder, slab, capsule, round] {
        for step in 0..12 {
            let turn = step as f64 * 0.53;
            let pose = Pose::from_axis_rotation(step % 3, turn)
                * Pose::from_axis_rotation(1, 0.3 + 0.2 * turn);
            let bodies = || vec![(solid.clone(), pose)];
            let (shaded, open) = (picture(bodies(), true), picture(bodies(), false));
            let other = shaded
                .enumerate_pixels()
                .zip(open.pixels())
                .find(|((_, _, a), b)| a != b);
            assert!(other.is_none(), "{solid:?} {step}: {other:?}");
        }
    }
}

/// A block that stands on a plate: its shadow begins at its foot, a lift of one texel away at most.
#[test]
fn a_shadow_begins_at_the_foot_of_what_throws_it() {
    let block = Shape::Box {
        centre: DVec3::new(-30.0, 30.0, 30.0),
        size: DVec3::new(60.0, 40.0, 60.0),
    };
    let bodies = || vec![plate(), (block.clone(), Pose::IDENTITY)];
    let (shaded, open) = (picture(bodies(), true), picture(bodies(), false));
    // Light comes from the upper left: below the foot, which ends at y = 10, and right of it, at x = 0.
    for (x, y) in (-10..-3).map(|x| (x, 7)).chain((10..25).map(|y| (3, y))) {
        let [a, b] = [&shaded, &open].map(|image| {
            let pixel = image.get_pixel((x + 120) as u32, (120 - y) as u32);
            f64::from(pixel.0[0])
        });
        assert!(b - a > 25.0, "{x} {y}: {a} {b}");
    }
}

/// Where nothing is near to what moves, no pixel changes.
#[test]
fn what_moves_elsewhere_changes_nothing_here() {
    let scene = |moved: f64| {
        let still = ball(DVec3::new(-60.0, 50.0, 18.0), 16.0);
        let moving = ball(DVec3::new(70.0 + moved, -40.0 + 0.7 * moved, 14.0), 12.0);
        picture(vec![plate(), still, moving], true)
    };
    let first = scene(0.0);
    for moved in [0.31, 1.7, 9.0] {
        let other = scene(moved);
        let mut changed = 0;
        for ((x, y, a), b) in first.enumerate_pixels().zip(other.pixels()) {
            changed += usize::from(a != b);
            let near = (on_plate(x, y) - DVec3::new(80.0, -60.0, 0.0)).length() < 70.0;
            assert!(near || a == b, "{moved}: {x} {y}");
        }
        assert!(changed > 20, "{moved}: {changed}");
    }
}
