//! Round tubes along polylines: rings transported without twist, balls at the corners, round ends.

use super::mesh::Mesh;
use super::primitive;
use super::round::{is_positive, segment_count, upright_frame};
use crate::math::sin_cos;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Points closer than this share of the tube's radius are one point.
const REPEAT: f64 = 1e-9;
/// Sine below which the common perpendicular of two directions is not well defined.
const STRAIGHT: f64 = 1e-12;

/// All points within `radius` of the polyline, as one closed surface.
///
/// At a corner the ring rotates about the corner point: its outer half sweeps the ball that joins the two straight
/// parts; its inner half stays on the bisecting plane, where both parts meet. No facet therefore passes through another
/// one. If the legs are too short for that, the inner half rotates too and stays inside the tube.
pub(super) fn tube_mesh(points: &[DVec3], radius: f64, closed: bool, tolerance: f64) -> Mesh {
    if !is_positive(radius) {
        return Mesh::default();
    }
    let points = distinct_points(points, radius, closed);
    let closed = closed && points.len() >= 3;
    match points.as_slice() {
        [] => Mesh::default(),
        [only] => primitive::ball_mesh(*only, radius, tolerance),
        _ => TubeSweep::new(radius, segment_count(radius, 0.5 * tolerance)).along(&points, closed),
    }
}

/// The polyline without repeated points and without points that are not finite.
fn distinct_points(points: &[DVec3], radius: f64, closed: bool) -> Vec<DVec3> {
    let mut kept: Vec<DVec3> = Vec::with_capacity(points.len());
    for point in points.iter().filter(|p| p.is_finite()) {
        if kept
            .last()
            .is_none_or(|last| last.distance(*point) > REPEAT * radius)
        {
            kept.push(*point);
        }
    }
    while closed && kept.len() > 1 && kept[0].distance(kept[kept.len() - 1]) <= REPEAT * radius {
        kept.pop();
    }
    kept
}

/// Two unit axes of a ring and, implied by them, the direction of the tube, first × second.
#[derive(Clone, Copy)]
pub(super) struct RingFrame {
    pub(super) first: DVec3,
    pub(super) second: DVec3,
}

impl RingFrame {
    pub(super) fn across(direction: DVec3) -> Self {
        let rotation = upright_frame(direction);
        Self {
            first: rotation.x_axis,
            second: rotation.y_axis,
        }
    }

    pub(super) fn direction(&self) -> DVec3 {
        self.first.cross(self.second)
    }

    /// Turned about `axis` (unit) by `angle` radians.
    fn turned(&self, axis: DVec3, angle: f64) -> Self {
        let (sin, cos) = sin_cos(angle);
        let turn = |v: DVec3| v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos));
        let first = turn(self.first).normalize_or_zero();
        let second = turn(self.second);
        Self {
            first,
            second: (second - first * first.dot(second)).normalize_or_zero(),
        }
    }

    /// Axis and angle of the smallest rotation to a new direction of the tube.
    pub(super) fn turn_to(&self, direction: DVec3) -> (DVec3, f64) {
        let own = self.direction();
        let normal = own.cross(direction);
        let angle = libm::atan2(normal.length(), own.dot(direction));
        // Without a change of direction any axis will do, and also for a full reversal.
        let axis = if normal.length() > STRAIGHT {
            normal.normalize()
        } else {
            self.first
        };
        (axis, angle)
    }

    /// The frame with the given direction, reached without twist.
    pub(super) fn carried_to(&self, direction: DVec3) -> Self {
        let (axis, angle) = self.turn_to(direction);
        self.turned(axis, angle)
    }
}

/// Depth relative to the radius above which a vertex belongs to a corner's inner side: vertices on the axis of
/// rotation, which do not move, must be bitwise equal.
const ON_AXIS: f64 = 1e-9;

/// A ring before its vertices are made.
struct TubeRing {
    centre: DVec3,
    frame: RingFrame,
    mitre: Option<Mitre>,
}

/// Position of the inner half of a corner's rings.
#[derive(Clone, Copy)]
struct Mitre {
    /// Before the corner.
    frame: RingFrame,
    /// Unit direction from the corner point to its inner side, perpendicular to the leg before.
    inward: DVec3,
    /// Tangent of half the angle.
    slope: f64,
}

impl Mitre {
    /// The place of the vertex whose normal before the corner is `normal`, from the corner point and in radii;
    /// `None` on the outer half.
    fn place(&self, normal: DVec3) -> Option<DVec3> {
        let depth = normal.dot(self.inward);
        (depth > -ON_AXIS).then(|| normal - self.frame.direction() * (self.slope * depth))
    }
}

struct TubeSweep {
    radius: f64,
    around: u32,
    mesh: Mesh,
}

impl TubeSweep {
    fn new(radius: f64, around: u32) -> Self {
        Self {
            radius,
            around,
            mesh: Mesh::default(),
        }
    }

    fn along(mut self, points: &[DVec3], closed: bool) -> Mesh {
        let count = points.len();
        let legs = if closed { count } else { count - 1 };
        let direction =
            |leg: usize| (points[(leg + 1) % count] - points[leg % count]).normalize_or_zero();
        let mut frame = RingFrame::across(direction(0));
        let mut rings = Vec::new();
        // An open line begins with a plain ring.
        if !closed {
            rings.push(TubeRing {
                centre: points[0],
                frame,
                mitre: None,
            });
        }
        let length = |leg: usize| (points[(leg + 1) % count]).distance(points[leg % count]);
        // Rings at the inner corners, in the room that half of the shorter leg leaves.
        for (leg, point) in points.iter().enumerate().take(legs).skip(1) {
            let room = 0.5 * length(leg - 1).min(length(leg));
            frame = self.corner((*point, room), frame, direction(leg), &mut rings);
        }
        if closed {
            let room = 0.5 * length(count - 1).min(length(0));
            frame = self.corner((points[0], room), frame, direction(0), &mut rings);
            // The frame carried around a closed line comes back turned: the angle is spread over all rings.
            let (sin, cos) = {
                let start = RingFrame::across(direction(0));
                (start.second.dot(frame.first), start.first.dot(frame.first))
            };
            self.spread_twist(&mut rings, libm::atan2(sin, cos));
        } else {
            rings.push(TubeRing {
                centre: points[count - 1],
                frame,
                mitre: None,
            });
        }
        // Vertices of all rings, then quadrilaterals between adjacent ones.
        for ring in &rings {
            self.push_ring(ring);
        }
        let rows = rings.len() as u32;
        for row in 1..rows {
            self.join(row - 1, row);
        }
        if closed {
            self.join(rows - 1, 0);
        } else {
            self.round_end(&rings[0], 0, -1.0);
            self.round_end(&rings[rings.len() - 1], rows - 1, 1.0);
        }
        self.mesh
    }

    /// Rings that rotate about the corner until the tube points in `direction`; its inner side may use `room` of the
    /// legs.
    fn corner(
        &self,
        (centre, room): (DVec3, f64),
        frame: RingFrame,
        direction: DVec3,
        rings: &mut Vec<TubeRing>,
    ) -> RingFrame {
        let (axis, angle) = frame.turn_to(direction);
        let step = TAU / f64::from(self.around);
        if angle <= step {
            // Such a slight bend is equivalent to a mitre; its error is within the tolerance of the chords.
            let frame = frame.turned(axis, 0.5 * angle);
            rings.push(TubeRing {
                centre,
                frame,
                mitre: None,
            });
        } else {
            let (sin, cos) = sin_cos(0.5 * angle);
            let mitre = (self.radius * sin <= room * cos).then(|| Mitre {
                frame,
                inward: axis.cross(frame.direction()),
                slope: sin / cos,
            });
            let steps = (angle / step).ceil() as u32;
            for k in 0..=steps {
                let frame = frame.turned(axis, angle * f64::from(k) / f64::from(steps));
                rings.push(TubeRing {
                    centre,
                    frame,
                    mitre,
                });
            }
        }
        frame.turned(axis, angle)
    }

    /// Distributes the twist accumulated along a closed line evenly over its length.
    fn spread_twist(&self, rings: &mut [TubeRing], twist: f64) {
        let centres: Vec<DVec3> = rings.iter().map(|ring| ring.centre).collect();
        let Some(last) = centres.last() else { return };
        // The length along the line up to every ring; each ring takes its share of the twist.
        let mut travelled = vec![0.0];
        for pair in centres.windows(2) {
            travelled.push(travelled[travelled.len() - 1] + pair[0].distance(pair[1]));
        }
        let length = travelled[travelled.len() - 1] + last.distance(centres[0]);
        for (ring, way) in rings.iter_mut().zip(travelled) {
            let share = if length > 0.0 { way / length } else { 0.0 };
            let untwisted = |frame: RingFrame| frame.turned(frame.direction(), -twist * share);
            ring.frame = untwisted(ring.frame);
            if let Some(mitre) = &mut ring.mitre {
                mitre.frame = untwisted(mitre.frame);
            }
        }
    }

    fn push_ring(&mut self, ring: &TubeRing) {
        for k in 0..self.around {
            let (sin, cos) = sin_cos(TAU * f64::from(k) / f64::from(self.around));
            let around = |frame: &RingFrame| frame.first * cos + frame.second * sin;
            let normal = around(&ring.frame);
            let inner = ring.mitre.and_then(|m| m.place(around(&m.frame)));
            let place = ring.centre + inner.unwrap_or(normal) * self.radius;
            self.mesh.push_vertex(place, normal);
        }
    }

    /// Facets between the rings number `from` and `to`.
    fn join(&mut self, from: u32, to: u32) {
        for k in 0..self.around {
            let next = (k + 1) % self.around;
            let [a, b] = [from * self.around + k, from * self.around + next];
            let [d, c] = [to * self.around + k, to * self.around + next];
            for triangle in [[a, b, c], [a, c, d]] {
                let [p, q, r] = triangle.map(|i| self.mesh.positions[i as usize]);
                // The inner sides of a corner's rings are one line.
                if p != q && q != r && r != p {
                    self.mesh.triangles.push(triangle);
                }
            }
        }
    }

    /// Half a ball beyond a ring; `side` is +1 at the end and -1 at the start of the line.
    fn round_end(&mut self, ring: &TubeRing, row: u32, side: f64) {
        let outward = ring.frame.direction() * side;
        let steps = (self.around / 4).max(2);
        let mut base = row * self.around;
        // Circles of latitude from the ring to the pole, each joined to the one before.
        for step in 1..steps {
            let (sin, cos) = sin_cos(FRAC_PI_2 * f64::from(step) / f64::from(steps));
            let next = self.mesh.positions.len() as u32;
            for k in 0..self.around {
                let (s, c) = sin_cos(TAU * f64::from(k) / f64::from(self.around));
                let normal = (ring.frame.first * c + ring.frame.second * s) * cos + outward * sin;
                self.mesh
                    .push_vertex(ring.centre + normal * self.radius, normal);
            }
            for k in 0..self.around {
                let j = (k + 1) % self.around;
                self.facet([base + k, base + j, next + j], side);
                self.facet([base + k, next + j, next + k], side);
            }
            base = next;
        }
        let pole = self
            .mesh
            .push_vertex(ring.centre + outward * self.radius, outward);
        // The last circle closes at the pole.
        for k in 0..self.around {
            self.facet([base + k, base + (k + 1) % self.around, pole], side);
        }
    }

    fn facet(&mut self, [a, b, c]: [u32; 3], side: f64) {
        self.mesh
            .triangles
            .push(if side > 0.0 { [a, b, c] } else { [a, c, b] });
    }
}
