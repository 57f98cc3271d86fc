//! Two valleys of a distance side by side on a large ring, one of them deeper: the deeper one counts.

use crate::dense::golden;
use crate::solids::{Random, cone, cuboid, torus, v};
use glam::{DMat3, DQuat, DVec3};
use mechanim::distance::pair::signed_distance;
use mechanim::distance::primitive::Element;
use mechanim::math::Pose;
use std::f64::consts::TAU;

const R: f64 = 100.0;

/// So thin that it does not matter.
const TUBE: f64 = 3e-4;

fn turn(angle: f64) -> Pose {
    Pose {
        rotation: DMat3::from_rotation_z(angle),
        translation: DVec3::ZERO,
    }
}

/// The least of a function of a small angle: dense, then finely around the three lowest places.
fn dense(reach: f64, f: impl Fn(f64) -> f64) -> f64 {
    let at = |k: i32| reach * f64::from(k) / 4000.0;
    let mut order: Vec<(f64, i32)> = (-4000..=4000).map(|k| (f(at(k)), k)).collect();
    order.sort_by(|p, q| p.0.total_cmp(&q.0));
    let near = order[..3]
        .iter()
        .map(|(_, k)| golden(at(k - 1), at(k + 1), &f).1);
    near.fold(order[0].0, f64::min)
}

/// A ring cuts the plane of a thin sheet twice, 1 to 2 degrees apart; the sheet's edge lies between, beside the first cut.
#[test]
fn a_ring_that_passes_by_the_edge_of_a_sheet_is_seen_to_pierce_it() {
    let ring = torus(DVec3::ZERO, DVec3::Z, R, TUBE);
    for part in 0..128 {
        for side in [1.0, -1.0] {
            for [cut, edge, half] in [
                [0.015, 1.3, 2e-3],
                [0.018, 1.6, 2e-3],
                [0.01, 0.8, 1e-3],
                [0.02, 1.85, 2e-3],
                [0.003, 0.27, 1e-4],
            ] {
                let middle = TAU * (f64::from(part) + 0.5) / 128.0;
                let out = R * f64::cos(cut);
                let sheet = cuboid(
                    v(out, side * 0.5 * (50.0 - edge), 0.0),
                    v(2.0 * half, 50.0 + edge, 20.0),
                );
                let found = signed_distance(&ring, &sheet.moved(&turn(middle))).distance;
                // In the sheet's plane: the profile is a rectangle.
                let truth = dense(0.025, |angle| {
                    let (x, y) = (R * angle.cos() - out, side * R * angle.sin());
                    let [dx, dy] = [x.abs() - half, (-edge - y).max(y - 50.0)];
                    dx.max(0.0).hypot(dy.max(0.0)) + dx.max(dy).min(0.0)
                }) - TUBE;
                assert!(
                    (found - truth).abs() < 1e-8,
                    "{part} {side} {cut}: {found} {truth}"
                );
            }
        }
    }
}

fn least_of_rings(first: &Element, second: &Element) -> f64 {
    signed_distance(first, second).distance + 2.0 * TUBE
}

/// A ring that fits into another one and grazes it from inside, tilted a little: they cross in two valleys side by side.
#[test]
fn rings_that_graze_each_other_are_seen_to_meet() {
    let outer = torus(DVec3::ZERO, DVec3::Z, R, TUBE);
    for part in 0..64 {
        for (r, beyond, tilt) in [
            (60.0, 0.01, 1e-3),
            (90.0, 2e-3, -1e-3),
            (20.0, 5e-3, 3e-3),
            (97.0, 1e-3, 1e-4),
        ] {
            let middle = TAU * (f64::from(part) + 0.5) / 64.0;
            let out = DVec3::X * (R - r + beyond);
            // About the direction outwards, as seen from a place beside that in which they would touch.
            let aside = 0.7 * (2.0 * beyond * r * R / (R - r)).sqrt();
            let rotation = DMat3::from_quat(DQuat::from_rotation_x(tilt));
            let tilted = Pose {
                rotation,
                translation: out - rotation * v(0.0, aside, 0.0) + v(0.0, aside, 0.0),
            };
            let inner = torus(DVec3::ZERO, DVec3::Z, r, TUBE).moved(&(turn(middle) * tilted));
            let found = least_of_rings(&outer, &inner);
            let truth = dense(0.15, |angle| {
                let p = tilted.transform_point(v(r * angle.cos(), r * angle.sin(), 0.0));
                (p.x.hypot(p.y) - R).hypot(p.z)
            });
            assert!((found - truth).abs() < 1e-8, "{part} {r}: {found} {truth}");
        }
    }
}

/// A ring that lies nearly flat on a box, or on the end of a cylinder, and overhangs the edge a little: the nearest points are two valleys
/// beside the place of symmetry.
#[test]
fn a_ring_that_overhangs_a_face_is_as_near_as_its_valleys() {
    let tube = 0.01;
    let slab = cuboid(v(0.0, 0.0, -0.5), v(6.0, 2.0, 1.0));
    for tilt in [0.0, 1e-6, 1e-5, 5e-5, 1.5e-4, 2e-4, 3e-4, 1e-3, 1e-2] {
        for over in [0.0, 2e-5, 3e-5, 7e-5, 1e-4, 2e-4, 1e-3] {
            for height in [0.0105, 0.02, 0.03, 0.2] {
                let placed = Pose {
                    rotation: DMat3::from_quat(DQuat::from_rotation_x(tilt)),
                    translation: v(0.0, -over, height),
                };
                let ring = torus(DVec3::ZERO, DVec3::Z, 1.0, tube).moved(&placed);
                let found = signed_distance(&slab, &ring).distance;
                // The lower half of the ring, from its lowest place.
                let truth = dense(1.5, |angle| {
                    let y = -angle.cos();
                    let z = height + y * f64::sin(tilt);
                    let y = y * f64::cos(tilt) - over;
                    (y.abs() - 1.0).max(0.0).hypot(z.max(0.0))
                }) - tube;
                assert!(
                    (found - truth).abs() < 1e-10,
                    "{tilt} {over} {height}: {found} {truth}"
                );
            }
        }
    }
}

/// How far a point is from a cone around z, from its profile, a convex polygon: negative inside.
fn off_cone(point: DVec3, [low, high]: [f64; 2], half: f64) -> f64 {
    let p = [point.x.hypot(point.y), point.z];
    let corners = [[0.0, -half], [low, -half], [high, half], [0.0, half]];
    let mut outside = f64::INFINITY;
    let mut inside = f64::NEG_INFINITY;
    for k in 0..3 {
        let [a, b] = [corners[k], corners[k + 1]];
        let [along, to] = [[b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]];
        let length = along[0].hypot(along[1]);
        let share = ((to[0] * along[0] + to[1] * along[1]) / length.powi(2)).clamp(0.0, 1.0);
        let off = (to[0] - share * along[0]).hypot(to[1] - share * along[1]);
        outside = outside.min(off);
        inside = inside.max((to[0] * along[1] - to[1] * along[0]) / length);
    }
    if inside > 0.0 { outside } else { inside }
}

/// A ring around a cone, hardly tilted, bent or off its axis: the distance hardly changes along the ring, and a search may end
/// before it is known. Nothing is nearer than what it then tells.
#[test]
fn nothing_is_nearer_to_a_ring_than_is_told() {
    let mut random = Random(7);
    let (mut cut_off, mut wide) = (0, 0.0_f64);
    for round in 0..600 {
        let size = 10f64.powf(random.range(-3.0, 3.0));
        let (low, high) = (size * random.range(0.3, 2.0), size * random.range(0.0, 2.0));
        let (half, ring) = (size * random.range(0.3, 2.0), size * random.range(0.3, 3.0));
        let tube = 1e-4 * size;
        let off = 10f64.powf(random.range(-12.0, -0.5));
        let placed = Pose {
            rotation: DMat3::from_quat(DQuat::from_scaled_axis(random.vector(off))),
            translation: size * (DVec3::Z * random.range(-2.5, 2.5) + random.vector(off)),
        };
        let tapered = cone(DVec3::Z * -half, DVec3::Z * half, low, high);
        let found = signed_distance(
            &tapered,
            &torus(DVec3::ZERO, DVec3::Z, ring, tube).moved(&placed),
        );
        let truth = dense(TAU / 2.0, |angle| {
            let p = v(ring * angle.cos(), ring * angle.sin(), 0.0);
            off_cone(placed.transform_point(p), [low, high], half)
        }) - tube;
        let reach = ring + placed.translation.length() + size;
        assert!(
            found.lowest() <= truth + 3e-11 * reach && found.distance >= truth - 1e-13 * reach,
            "{round}: {found:?} {truth}"
        );
        cut_off += usize::from(found.missed > 0.0);
        wide = wide.max(found.missed / ring);
    }
    assert!(cut_off > 20 && wide < 1e-3, "{cut_off} {wide}");
}
