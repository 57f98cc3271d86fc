//! The maps for surfaces in the open, beneath others and in corners.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use super::caster::row_value;
use super::*;
use crate::geometry::mesh_of;
use crate::math::Pose;
use crate::model::shape::Solid;
use crate::render::look::{KEY_DIRECTION, Rim};
use crate::render::{Instance, Projection};

const SIZE: [u32; 2] = [200, 200];

/// Two plates that meet in the plane x = 0, the right one facing the viewer and the left one square to it, so high above the right one.
fn corner(projection: Projection, height: f64) -> (MutualShade, Camera) {
    let plates = [
        (DVec3::new(50.0, 0.0, -5.0), DVec3::new(100.0, 300.0, 10.0)),
        (
            DVec3::new(-5.0, 0.0, 0.5 * height - 5.0),
            DVec3::new(10.0, 300.0, height + 10.0),
        ),
    ];
    let meshes: Vec<StageMesh> = plates
        .iter()
        .map(|(centre, size)| {
            let (centre, size) = (*centre, *size);
            mesh_of(&Solid::Box { centre, size }, 0.1).into()
        })
        .collect();
    let camera = Camera {
        world_from_camera: Pose::from_translation(DVec3::Z * 400.0),
        projection,
        near: 1.0,
        far: 1000.0,
    };
    let stage = Stage {
        meshes: meshes.into(),
        size: SIZE,
        samples: 4,
        camera,
        background: [255; 3],
        rim: Rim::DARK,
        ground: None,
        edges: None,
        mutual_shade: Some([DVec3::splat(-150.0), DVec3::splat(150.0)]),
    };
    let frame = Frame {
        instances: (0..2).map(body).collect(),
        ..Frame::default()
    };
    let mut shade = MutualShade::new(&stage).unwrap();
    shade.cast(&frame, &camera);
    (shade, camera)
}

fn body(mesh: usize) -> Instance {
    Instance {
        mesh,
        world_from_mesh: Pose::IDENTITY,
        colour: [200; 3],
        opacity: 1.0,
        triangles: 0..u32::MAX,
        casts_shadow: true,
        outline: None,
        flat: 0.0,
    }
}

fn on(shade: &MutualShade, camera: &Camera, point: DVec3) -> LightShare {
    let [x, y, _] = camera.project(point, SIZE).unwrap();
    // Of the first of the bodies, which is drawn a little nearer.
    let rows = camera
        .eye(SIZE)
        .camera_from_mesh((&body(0), DVec3::ZERO), 0);
    let place = rows.map(|row| row_value(&row, point.as_vec3().to_array()));
    shade.on([x as f32, y as f32], place, [0.0, 0.0, 1.0])
}

/// In both projections: far from the corner all light arrives, near to it less of that around, and in the shadow of the
/// upright plate nothing of the key light. That plate is 60 high: its shadow ends at `60 * 4 / 4`.
#[test]
fn corners_are_dark_and_shadows_end() {
    for projection in [
        Projection::Orthographic { height: 200.0 },
        Projection::Perspective { fov_y: 0.5 },
    ] {
        let (shade, camera) = corner(projection, 60.0);
        let run = f64::from(-KEY_DIRECTION[0] / KEY_DIRECTION[2]) * 60.0;
        assert!((run - 60.0).abs() < 1e-4);
        let at = |x: f64| on(&shade, &camera, DVec3::new(x, 0.0, 0.0));
        assert_eq!(at(run + 20.0), [1.0; 2], "{projection:?}");
        assert!(at(run - 5.0)[0] < 1e-6, "{projection:?}");
        assert_eq!(at(run + 5.0)[0], 1.0, "{projection:?}");
        // What is seen hides light within its reach, 36 here: a lower plate.
        let (shade, camera) = corner(projection, 20.0);
        let at = |x: f64| on(&shade, &camera, DVec3::new(x, 0.0, 0.0));
        let sky: Vec<f32> = [2.0, 8.0, 20.0, 60.0].map(|x| at(x)[1]).to_vec();
        assert!(sky.is_sorted() && sky[0] < 0.8 && sky[3] == 1.0, "{sky:?}");
    }
}

/// A room without extent, or none, shades nothing.
#[test]
fn without_a_room_there_are_no_shades() {
    let (_, camera) = corner(Projection::Orthographic { height: 200.0 }, 60.0);
    let rooms = [None, Some([DVec3::ONE; 2]), Some([DVec3::NAN, DVec3::ONE])];
    for mutual_shade in rooms {
        let stage = Stage {
            meshes: Vec::new().into(),
            size: SIZE,
            samples: 1,
            camera,
            background: [0; 3],
            rim: Rim::DARK,
            ground: None,
            edges: None,
            mutual_shade,
        };
        assert!(MutualShade::new(&stage).is_none());
    }
}
