//! The contact shadow: where it is, how it falls off, and that both lookups agree.
#![allow(clippy::unwrap_used)]
use super::*;
use crate::geometry::mesh_of;
use crate::model::shape::Solid;
use crate::render::look::Rim;
use crate::render::{Camera, Projection};
use glam::{DMat3, DVec3};

/// A ball and a plate over a ground of radius 4 that is tilted against the world.
fn caster() -> (ShadowCaster, Pose) {
    let tilt = Pose::from_axis_rotation(0, 0.7) * Pose::from_translation(DVec3::Z * 3.0);
    let ball = Solid::Sphere {
        centre: DVec3::ZERO,
        radius: 0.4,
    };
    let plate = Solid::Box {
        centre: DVec3::ZERO,
        size: DVec3::new(2.0, 2.0, 0.1),
    };
    let stage = Stage {
        meshes: [&ball, &plate]
            .map(|solid| mesh_of(solid, 1e-3).into())
            .into(),
        size: [64, 64],
        samples: 1,
        camera: Camera {
            world_from_camera: Pose::IDENTITY,
            projection: Projection::Orthographic { height: 1.0 },
            near: 0.1,
            far: 10.0,
        },
        background: [255; 3],
        rim: Rim::DARK,
        edges: None,
        mutual_shade: None,
        ground: Some(Ground {
            centre: tilt.translation,
            normal: tilt.transform_vector(DVec3::Z),
            radius: 4.0,
            grid: 0.0,
            shade: Ground::DARKER,
        }),
    };
    let caster = ShadowCaster::new(&stage).unwrap();
    let axes = caster.axes;
    (
        caster,
        Pose {
            rotation: axes,
            translation: tilt.translation,
        },
    )
}

/// The shadow of one mesh with its origin at a point over the ground.
fn shadow_of(mesh: usize, at: DVec3) -> ContactShadow {
    // Seen from below, the key light is under the ground and casts no shadow on it.
    lit_shadow_of(mesh, at, DMat3::from_rotation_x(std::f64::consts::PI))
}

/// The same with the key light as a camera with these axes over the ground has it.
fn lit_shadow_of(mesh: usize, at: DVec3, camera: DMat3) -> ContactShadow {
    let (mut caster, world_from_ground) = caster();
    let camera = Camera {
        world_from_camera: world_from_ground
            * Pose {
                rotation: camera,
                translation: DVec3::ZERO,
            },
        projection: Projection::Orthographic { height: 1.0 },
        near: 0.1,
        far: 10.0,
    };
    let frame = Frame {
        instances: vec![Instance {
            mesh,
            world_from_mesh: world_from_ground * Pose::from_translation(at),
            colour: [0; 3],
            opacity: 1.0,
            triangles: 0..u32::MAX,
            casts_shadow: true,
            outline: None,
            flat: 0.0,
        }],
        ..Frame::default()
    };
    caster.cast(&frame, &camera).clone()
}

/// The light comes from the upper left of the viewer, so the shadow lies behind and to the right.
#[test]
fn the_key_light_throws_shadows_aslant() {
    let level = DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y);
    let [x, y, z] = KEY_DIRECTION.map(f64::from);
    for height in [0.8, 1.6] {
        let at = DVec3::new(-0.5, -0.5, height);
        let shadow = lit_shadow_of(0, at, level);
        // Camera y is up and camera z points towards the viewer, along -y of the ground.
        let thrown = [at.x - x / y * height, at.y + z / y * height];
        let dark = |[u, v]: [f64; 2]| shadow.sample((u / 4.0) as f32, (v / 4.0) as f32);
        assert!(dark(thrown) > 0.08, "{height}: {}", dark(thrown));
        assert!(dark([at.x + x / y * height, at.y]) < 0.5 * dark(thrown));
    }
    let without = shadow_of(0, DVec3::new(-0.5, -0.5, 2.4));
    let places =
        (0..64 * 64).map(|k| without.sample((k % 64) as f32 / 64.0, (k / 64) as f32 / 64.0));
    assert!(places.fold(0.0, f32::max) < 0.02);
}

#[test]
fn a_body_darkens_what_is_below_it_and_less_from_higher_up() {
    let mut before = 1.1;
    for height in [0.4, 0.6, 1.0, 1.8] {
        let shadow = shadow_of(0, DVec3::new(1.0, -2.0, height));
        let below = shadow.sample(0.25, -0.5);
        assert!(below < before && below > 0.0, "{below} after {before}");
        assert!(shadow.sample(-0.25, 0.5) == 0.0);
        before = below;
    }
    for out_of_reach in [DVec3::Z * 3.0, DVec3::new(9.0, 0.0, 0.4), DVec3::NAN] {
        assert_eq!(shadow_of(0, out_of_reach).dark, None);
    }
}

#[test]
fn coarse_faces_leave_no_holes() {
    // The plate is 32 texels wide; the blur reaches 8 texels inwards.
    let shadow = shadow_of(1, DVec3::Z * 0.05);
    let middle: Vec<u8> = (57..71)
        .flat_map(|y| (57..71).map(move |x| (x, y)))
        .map(|(x, y)| shadow.texels[(y * SHADOW_SIZE + x) as usize])
        .collect();
    let darkest = middle.iter().max().unwrap();
    assert!(middle.iter().all(|t| t == darkest) && *darkest > 180);
}

#[test]
fn the_two_lookups_agree_and_nothing_is_dark_out_of_reach() {
    let shadow = shadow_of(0, DVec3::new(-1.0, 0.5, 0.5));
    let [low, high] = shadow.reach().unwrap();
    for i in 0..400 {
        for j in 0..400 {
            let (u, v) = (f64::from(i) / 200.0 - 1.0, f64::from(j) / 200.0 - 1.0);
            let (u, v) = (u as f32, v as f32);
            let (smooth, quick) = (shadow.sample(u, v), shadow.at(TexelPlace::new(u, v)));
            assert!((smooth - quick).abs() < 2e-3, "{smooth} {quick}");
            if smooth > 0.0 {
                assert!(u >= low[0] && v >= low[1] && u <= high[0] && v <= high[1]);
            }
        }
    }
    let texel = |k: u32| (k as f32 + 0.5) / SHADOW_SIZE as f32 * 2.0 - 1.0;
    let (x, y) = (48, 72);
    let exact = f32::from(shadow.texels[(y * SHADOW_SIZE + x) as usize]) / 255.0;
    assert!(exact > 0.1 && (shadow.sample(texel(x), texel(y)) - exact).abs() < 1e-5);
}
