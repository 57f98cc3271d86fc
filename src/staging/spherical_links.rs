//! Spherical linkages without bodies: all axes meet in one point, so that a chain gives the joints no places of their own.
//! They are put on a sphere around this point, and links are arcs between them.

use super::joints::PlacedLinks;
use super::sign_solids::{GROUND, MOVER, SEAT, ground_sign, link_colour};
use crate::math::Pose;
use crate::model::chain::{Chain, ChainStep, ElementaryMotion};
use crate::model::mechanism::{Loop, Mechanism};
use crate::model::shape::Solid;
use glam::DVec3;

/// Axes pass through a point if they miss it by less than this fraction of the mechanism's size.
const MISSED: f64 = 1e-9;

/// Joints nearer to the centre than this fraction of the mechanism's size have no place of their own.
const CENTRAL: f64 = 1e-6;

/// Two directions with a smaller sine of the angle between them are parallel.
const PARALLEL: f64 = 1e-6;

/// Longest straight part of an arc, radians.
const PART: f64 = 0.05;

/// Of so many points of an arc one is looked at for the extent of a picture.
const SPARSE: usize = 8;

/// Radius of the line from the centre to a joint, in radii of a pin.
const LINE: f64 = 0.25;

/// Solids in the frame that carries them.
pub struct CarriedSolids {
    /// In this frame.
    pub solids: Vec<Solid>,
    /// World from the frame; `None` for what stands still.
    pub carrier: Option<Chain>,
    /// sRGB.
    pub colour: [u8; 3],
}

/// A joint on the sphere.
struct SphereJoint {
    /// Its place in the world at the first pose.
    place: DVec3,
    /// World from the frames before and behind it at that pose.
    frames: [Pose; 2],
    /// The same as products.
    chains: [Chain; 2],
}

/// A mechanism whose loops turn about axes through one point.
pub struct SphericalLinkage {
    centre: DVec3,
    /// The joints of every loop.
    loops: Vec<Vec<SphereJoint>>,
}

/// An axis at the first pose.
struct TurningLine {
    point: DVec3,
    direction: DVec3,
    frames: [Pose; 2],
    chains: [Chain; 2],
}

impl SphericalLinkage {
    /// The linkage at a pose; `None` if a loop does anything but turn about axes through one point.
    pub fn of(mechanism: &Mechanism, at: &PlacedLinks) -> Option<Self> {
        if !mechanism.bars.is_empty() || !mechanism.contacts.is_empty() {
            return None;
        }
        let lines = mechanism.loops.iter().map(|one| axis_lines(one, at));
        let lines: Vec<Vec<TurningLine>> = lines.collect::<Option<_>>()?;
        let all = || lines.iter().flatten();
        let centre = common_point(all())?;
        let misses = |line: &TurningLine| (centre - line.point).cross(line.direction).length();
        if all().any(|line| misses(line) > MISSED * mechanism.size) {
            return None;
        }
        // Joints that have a place of their own give the radius, else traced points.
        let own = all().map(|line| line.point.distance(centre));
        let traced = mechanism.traces.iter().map(|trace| {
            let chain = &mechanism.bodies[trace.body].world_from_body;
            let place = chain.pose(&at.arguments);
            place.transform_point(trace.point).distance(centre)
        });
        let is_known = |radius: &f64| *radius > CENTRAL * mechanism.size;
        let radius = own.filter(is_known).reduce(f64::max);
        let radius = radius.or_else(|| traced.filter(is_known).reduce(f64::max));
        let radius = radius.unwrap_or(mechanism.size);
        let joint = |line: TurningLine| SphereJoint {
            place: match is_known(&line.point.distance(centre)) {
                true => line.point,
                false => centre + line.direction * radius,
            },
            frames: line.frames,
            chains: line.chains,
        };
        let loops = lines.into_iter();
        Some(Self {
            centre,
            loops: loops
                .map(|lines| lines.into_iter().map(joint).collect())
                .collect(),
        })
    }

    /// Points that pictures of these poses must contain: the centre, the joints, and where the arcs are.
    pub fn extent(&self, poses: &[PlacedLinks]) -> Vec<DVec3> {
        let mut points = vec![self.centre];
        for joints in &self.loops {
            for (k, joint) in joints.iter().enumerate() {
                let here = joint.frames[1].inverse();
                let own = std::iter::once(here.transform_point(joint.place));
                let next = joints.get(k + 1);
                let arc = next.map_or_else(Vec::new, |next| self.arc_behind(joint, next));
                let carried: Vec<DVec3> = own.chain(arc.into_iter().step_by(SPARSE)).collect();
                for at in poses {
                    let frame = joint.chains[1].pose(&at.arguments);
                    points.extend(carried.iter().map(|point| frame.transform_point(*point)));
                }
            }
        }
        points
    }

    /// Arcs, pins with their axes, and ground below the joints of the frame. `r` is the radius of a pin, `rod` that of a link.
    pub fn solids(&self, up: DVec3, [r, rod]: [f64; 2]) -> Vec<CarriedSolids> {
        let mut all = vec![CarriedSolids {
            solids: vec![Solid::Sphere {
                centre: self.centre,
                radius: r,
            }],
            carrier: None,
            colour: SEAT,
        }];
        let mut drawn: Vec<(&Chain, DVec3)> = Vec::new();
        for joints in &self.loops {
            for (k, joint) in joints.iter().enumerate() {
                let next = joints.get(k + 1);
                // Loops with a common beginning share their first links.
                let key = (&joint.chains[1], next.map_or(joint.place, |n| n.place));
                if drawn.contains(&key) {
                    continue;
                }
                drawn.push(key);
                all.extend(self.pin(joint, r));
                if k == 0 || next.is_none() {
                    all.push(CarriedSolids {
                        solids: ground_sign(joint.place, up, r),
                        carrier: None,
                        colour: GROUND,
                    });
                }
                if let Some(next) = next {
                    let known = drawn
                        .iter()
                        .position(|(chain, _)| *chain == &joint.chains[1]);
                    all.push(CarriedSolids {
                        solids: self.arc(joint, next, rod),
                        carrier: Some(joint.chains[1].clone()),
                        colour: link_colour(known.unwrap_or_default()),
                    });
                }
            }
        }
        all
    }

    /// Both sides of a joint, and its axis down to the centre.
    fn pin(&self, joint: &SphereJoint, r: f64) -> [CarriedSolids; 2] {
        let sides = [(2.0, 1.6, SEAT, 0), (3.0, 1.0, MOVER, 1)];
        sides.map(|(length, width, colour, side)| {
            let here = joint.frames[side].inverse();
            let (place, centre) = (
                here.transform_point(joint.place),
                here.transform_point(self.centre),
            );
            let outward = (place - centre).normalize_or_zero();
            let pin = Solid::Cylinder {
                from: place - outward * (length * r),
                to: place + outward * (length * r),
                radius: width * r,
            };
            let line = Solid::Capsule {
                from: centre,
                to: place,
                radius: LINE * r,
            };
            CarriedSolids {
                solids: match side {
                    0 => vec![pin],
                    _ => vec![pin, line],
                },
                carrier: Some(joint.chains[side].clone()),
                colour,
            }
        })
    }

    /// The link between two joints, in the frame behind the first.
    fn arc(&self, from: &SphereJoint, to: &SphereJoint, radius: f64) -> Vec<Solid> {
        if from.place.distance(to.place) <= radius {
            return Vec::new();
        }
        vec![Solid::Tube {
            points: self.arc_behind(from, to),
            radius,
            closed: false,
        }]
    }

    /// Its middle line.
    fn arc_behind(&self, from: &SphereJoint, to: &SphereJoint) -> Vec<DVec3> {
        let here = from.frames[1].inverse();
        let [centre, a, b] =
            [self.centre, from.place, to.place].map(|point| here.transform_point(point));
        let points = arc_points([a - centre, b - centre]).into_iter();
        points.map(|p| centre + p).collect()
    }
}

/// Points from one place to another around the origin; the distance from it changes evenly.
fn arc_points([a, b]: [DVec3; 2]) -> Vec<DVec3> {
    let first = a.normalize_or_zero();
    let across = b - first * b.dot(first);
    // Opposite places: any way round.
    let second = match across.length() > PARALLEL * b.length() {
        true => across.normalize(),
        false => first.any_orthonormal_vector(),
    };
    let angle = libm::atan2(b.dot(second), b.dot(first));
    let parts = ((angle.abs() / PART).ceil()).max(1.0);
    let point = |k: u32| {
        let share = f64::from(k) / parts;
        let (sin, cos) = crate::math::sin_cos(share * angle);
        let length = a.length() + share * (b.length() - a.length());
        (first * cos + second * sin) * length
    };
    (0..=parts as u32).map(point).collect()
}

/// The axes of a loop; `None` if something slides.
fn axis_lines(one: &Loop, at: &PlacedLinks) -> Option<Vec<TurningLine>> {
    let steps = [&one.base.steps[..], &one.chain.steps[..]].concat();
    let chain = |end: usize| Chain {
        steps: steps[..end].to_vec(),
    };
    let mut lines = Vec::new();
    for (k, step) in steps.iter().enumerate() {
        let ChainStep::Joint { motion, axis, .. } = step else {
            continue;
        };
        if *motion != ElementaryMotion::Rotation {
            return None;
        }
        let chains = [chain(k), chain(k + 1)];
        let frames = [chains[0].pose(&at.arguments), chains[1].pose(&at.arguments)];
        lines.push(TurningLine {
            point: frames[0].translation,
            direction: frames[0].rotation.col(*axis),
            frames,
            chains,
        });
    }
    Some(lines)
}

/// The point nearest to two axes that are not parallel.
fn common_point<'l>(mut lines: impl Iterator<Item = &'l TurningLine>) -> Option<DVec3> {
    let first = lines.next()?;
    let crossed = |line: &&TurningLine| first.direction.cross(line.direction).length() > PARALLEL;
    let second = lines.find(crossed)?;
    let normal = first.direction.cross(second.direction);
    let between = second.point - first.point;
    let along = between.cross(second.direction).dot(normal) / normal.length_squared();
    Some(first.point + first.direction * along)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::diag::Source;
    use crate::kinematics::motion::continuation::solve_motion;
    use crate::kinematics::motion::sampling::even_times;
    use crate::kinematics::structure::system::System;
    use crate::scene::{Overrides, load_scene};
    use std::sync::Arc;

    fn poses(loops: &str, guess: &str) -> (Arc<Mechanism>, Vec<PlacedLinks>) {
        let text = format!(
            "units = {{ angle = \"deg\" }}\nduration = 1\n[inputs]\nphi = \"40*t\"\n[loops]\n{loops}\n[guess]\n{guess}\n"
        );
        let name = "sphere".to_owned();
        let scene = load_scene(&Source { name, text }, &Overrides::default()).unwrap();
        let system = System::new(Arc::clone(&scene.mechanism), &scene.actuation).unwrap();
        let times = even_times(&scene.mechanism, &scene.actuation, 5);
        let motion = solve_motion(&system, &scene.actuation, &times);
        assert!(motion.is_whole());
        let poses = PlacedLinks::over_motion(&scene.mechanism, &motion);
        (scene.mechanism, poses)
    }

    /// Wherever the centre is, joints stay on their sphere and links keep their angle; planar loops and loops in space are none.
    #[test]
    fn links_are_arcs_of_their_angles() {
        let four = "Rz(phi) Rx(30) Rz(a1) Rx(60) Rz(a2) Rx(70) Rz(a3) Rx(80)";
        let guess = "a1 = 60\na2 = 120\na3 = -90";
        let moved = format!("T(5, 1, 2) {four} T(-5, -1, -2)");
        for (text, centre) in [(four, DVec3::ZERO), (&moved, DVec3::new(5.0, 1.0, 2.0))] {
            let (mechanism, poses) = poses(&format!("A = \"{text}\""), guess);
            let known = SphericalLinkage::of(&mechanism, &poses[0]).unwrap();
            assert!(known.centre.distance(centre) < 1e-9, "{}", known.centre);
            let joints = &known.loops[0];
            for at in &poses {
                let places = joints.iter().map(|joint| {
                    let own = joint.frames[0].inverse().transform_point(joint.place);
                    joint.chains[0].pose(&at.arguments).transform_point(own) - centre
                });
                let places: Vec<DVec3> = places.collect();
                let radius = places[0].length();
                for (k, angle) in [30.0, 60.0, 70.0, 80.0].into_iter().enumerate() {
                    let [a, b] = [places[k], places[(k + 1) % 4]];
                    assert!((a.length() / radius - 1.0).abs() < 1e-9);
                    let found = (a.dot(b) / (radius * radius)).acos().to_degrees();
                    assert!((found - angle).abs() < 1e-6, "{k}: {found}");
                }
            }
            let drawn = known.extent(&poses);
            let farthest = drawn.iter().map(|p| p.distance(centre)).fold(0.0, f64::max);
            assert!((farthest / joints[0].place.distance(centre) - 1.0).abs() < 1e-9);
        }
        for (text, guess) in [
            (
                "A = \"Rz(phi) Tx(40) Rz(alpha) Tx(80) Rz(beta) Tx(-h)\"",
                "h = 120",
            ),
            (
                "A = \"Rz(phi) Tx(30) Rz(a) Tx(50) Rz(b) Tx(50) Rz(c) Tx(-60)\"",
                "a = 60\nb = 100",
            ),
        ] {
            let (mechanism, poses) = poses(text, guess);
            assert!(
                SphericalLinkage::of(&mechanism, &poses[0]).is_none(),
                "{text}"
            );
        }
    }

    #[test]
    fn arcs_lead_from_place_to_place() {
        let rows = [
            [DVec3::X, DVec3::Y],
            [DVec3::X * 2.0, -DVec3::X],
            [DVec3::new(1.0, 1.0, 0.0), DVec3::new(1.0, 1.0, 1e-3)],
        ];
        for [a, b] in rows {
            let points = arc_points([a, b]);
            let last = points.len() - 1;
            assert!(points[0].distance(a) < 1e-12 && points[last].distance(b) < 1e-12);
            let longest = points
                .windows(2)
                .map(|pair| pair[0].distance(pair[1]))
                .fold(0.0, f64::max);
            assert!(
                longest <= 1.5 * PART * a.length().max(b.length()),
                "{longest}"
            );
        }
    }
}
