//! Colours and solids that the symbols of joints, links and ground have in common.

use crate::math::Pose;
use crate::model::shape::Solid;
use glam::DVec3;

/// Colours of the base side of a joint, of the moving side, and of the ground.
pub const SEAT: [u8; 3] = [0x4c, 0x55, 0x62];
pub const MOVER: [u8; 3] = [0xd9, 0xdd, 0xe3];
pub const GROUND: [u8; 3] = [0x6e, 0x77, 0x85];

/// Colours of links, distinguishable by lightness too (Okabe and Ito, Color Universal Design, 2008).
const COLOURS: [[u8; 3]; 7] = [
    [0x00, 0x72, 0xb2],
    [0xe6, 0x9f, 0x00],
    [0x00, 0x9e, 0x73],
    [0xcc, 0x79, 0xa7],
    [0x56, 0xb4, 0xe9],
    [0xd5, 0x5e, 0x00],
    [0xf0, 0xe4, 0x42],
];

/// The colour of a link or bar by its number.
pub fn link_colour(number: usize) -> [u8; 3] {
    COLOURS[number % COLOURS.len()]
}

/// A pedestal on a plate with hatching below, under a joint at `at`.
pub fn ground_sign(at: DVec3, up: DVec3, r: f64) -> Vec<Solid> {
    let axes = Pose::from_z_axis(up).rotation;
    let (right, ahead) = (axes.x_axis, axes.y_axis);
    let foot = at - up * (5.0 * r);
    let mut solids = vec![
        Solid::Cone {
            from: at - up * (1.2 * r),
            to: foot,
            radius_from: 1.1 * r,
            radius_to: 2.6 * r,
        },
        Solid::Cylinder {
            from: foot,
            to: foot - up * (0.6 * r),
            radius: 4.2 * r,
        },
    ];
    // Parallel strokes look like hatching from every side.
    let strokes = 10;
    for k in 0..strokes {
        let angle = std::f64::consts::TAU * f64::from(k) / f64::from(strokes);
        let (sin, cos) = crate::math::sin_cos(angle);
        let outward = right * cos + ahead * sin;
        let along = ahead * cos - right * sin;
        let from = foot - up * (0.6 * r) + outward * (3.7 * r);
        solids.push(Solid::Capsule {
            from,
            to: from - up * (1.5 * r) - along * (1.3 * r),
            radius: 0.28 * r,
        });
    }
    solids
}
