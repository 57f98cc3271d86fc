//! Joint symbols by kind: a pin, a ball in a ring, a block on its guide, a screw; and hatched ground under joints of
//! the frame without a body.

use super::bar_symbols;
use super::joint_places::BodyOutlines;
use super::joints::{self, CarriedFrame, PlacedJoint, PlacedLinks};
use super::link_symbols;
use super::sign_solids::{GROUND, MOVER, SEAT, ground_sign, link_colour};
use super::solids::{merged_mesh, sign_instance};
use super::spherical_links::SphericalLinkage;
use crate::kinematics::results::trajectory::Trajectory;
use crate::math::Pose;
use crate::model::bar_ends::BarEnds;
use crate::model::chain::{Chain, ChainStep};
use crate::model::joints::JointKind;
use crate::model::shape::Solid;
use crate::render::{Instance, StageMesh};
use crate::scene::Scene;
use glam::DVec3;

/// Radius of a pin relative to the motion's extent; all symbols are proportional to it.
const RADIUS: f64 = 0.008;

/// Distance from a joint's axis within which a body holds it, in radii of a pin.
const HOLD: f64 = 3.0;

/// Radius of the rod that stands for a link without bodies, over that of a pin.
const ROD: f64 = 0.9;

/// How far a guide goes on beyond its stroke, in radii of a pin.
const GUIDE_END: f64 = 6.0;

/// Facet error over the radius of a pin.
const FACETS: f64 = 0.02;

/// Symbols are outlined like bodies, with numbers after those of the bodies.
const FIRST_OUTLINE: u32 = 1 << 30;

/// One mesh of a symbol and the link that carries it.
struct SignPiece {
    mesh: usize,
    carrier: PieceCarrier,
    colour: [u8; 3],
}

/// What a symbol moves with.
enum PieceCarrier {
    /// It stands still.
    Still,
    /// A frame of a link.
    Link(CarriedFrame),
    /// A bar: the frame at its first end whose z axis points to the other one.
    Bar([Chain; 2]),
    /// The frame at the end of a product: an end of a bar, a link of a spherical linkage.
    End(Chain),
}

impl PieceCarrier {
    /// World from its frame.
    fn pose(&self, at: &PlacedLinks) -> Pose {
        match self {
            Self::Still => Pose::IDENTITY,
            Self::Link(frame) => frame.pose(at),
            Self::Bar(ends) => bar_symbols::frame_along(ends, at),
            Self::End(end) => end.pose(&at.arguments),
        }
    }
}

/// All signs.
#[derive(Default)]
pub struct JointSymbols {
    pieces: Vec<SignPiece>,
    /// Points of the ground's signs and guides.
    still: Vec<DVec3>,
}

impl JointSymbols {
    /// Adds the meshes of bars that no body shows, and of all joints if `are_shown`; nothing without any pose.
    pub fn new(
        (scene, are_shown): (&Scene, bool),
        trajectory: &Trajectory,
        (extent, up): (f64, DVec3),
        meshes: &mut Vec<StageMesh>,
    ) -> Self {
        let mechanism = &scene.mechanism;
        if !are_shown && mechanism.bars.is_empty() {
            return Self::default();
        }
        let poses = PlacedLinks::over_motion(mechanism, trajectory);
        let Some(first) = poses.first() else {
            return Self::default();
        };
        let radius = RADIUS * extent;
        let mut signs = Self::default();
        let mut guides = Vec::new();
        // A piece of a symbol: its mesh, and what it moves with.
        let mut add = |solids: Vec<Solid>, carrier: PieceCarrier, colour| {
            if solids.is_empty() {
                return;
            }
            let mesh = merged_mesh(&solids, FACETS * radius);
            if matches!(carrier, PieceCarrier::Still) {
                signs.still.extend(&mesh.positions);
            }
            meshes.push(mesh.into());
            signs.pieces.push(SignPiece {
                mesh: meshes.len() - 1,
                carrier,
                colour,
            });
        };
        // Joints that have no places of their own get some.
        let spherical = match mechanism.has_no_shapes() {
            true => SphericalLinkage::of(mechanism, first),
            false => None,
        };
        if let Some(spherical) = spherical {
            for piece in spherical.solids(up, [radius, ROD * radius]) {
                let carrier = piece.carrier.map_or(PieceCarrier::Still, PieceCarrier::End);
                add(piece.solids, carrier, piece.colour);
            }
            return signs;
        }
        // Without bodies links are drawn as rods, and bars wherever no body shows them.
        let mut count = 0;
        if mechanism.has_no_shapes() {
            let links = link_symbols::drawn_links(mechanism, ROD * radius);
            count = links.len();
            for link in links {
                let frame = CarriedFrame::of_link(link.link);
                add(link.solids, PieceCarrier::Link(frame), link.colour);
            }
            for (frame, to) in joints::inner_links(mechanism) {
                let rods = link_symbols::rods_between(&[DVec3::ZERO, to], ROD * radius);
                add(rods, PieceCarrier::Link(frame), link_colour(count));
                count += 1;
            }
            for (chain, places) in BarEnds::new(mechanism).free_bodies() {
                let rods = link_symbols::rods_between(&places, ROD * radius);
                add(rods, PieceCarrier::End(chain.clone()), MOVER);
            }
        }
        let alone = bar_symbols::bars_without_bodies(mechanism, &poses);
        let bars = bar_symbols::drawn_bars(mechanism, &poses, ROD * radius);
        for drawn in bars.into_iter().filter(|drawn| alone[drawn.bar]) {
            let colour = link_colour(count + drawn.bar);
            add(drawn.solids, PieceCarrier::Bar(drawn.ends), colour);
        }
        if !are_shown {
            return signs;
        }
        // A ball at every end of a bar; ground below fixed ones where no body shows it.
        for (end, is_fixed) in bar_symbols::bar_ends(mechanism) {
            let ball = bar_symbols::end_ball(radius);
            add(ball, PieceCarrier::End(end.point.clone()), SEAT);
            if is_fixed && mechanism.has_no_shapes() {
                let place = end.point.pose(&first.arguments).translation;
                add(ground_sign(place, up, radius), PieceCarrier::Still, GROUND);
            }
        }
        // Joints: each side moves with its own link, shifted along the axis to where the bodies are.
        let outlines = BodyOutlines::new((mechanism, &scene.view), &poses);
        for joint in joints::placed_joints(mechanism) {
            let place = outlines.place(&joint, HOLD * radius);
            let shift = DVec3::AXES[joint.axis] * place.shift;
            let strokes = poses.iter().map(|at| joint.stroke(at));
            let stroke = strokes.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], s| {
                [low.min(s), high.max(s)]
            });
            let ram = Ram::of(&joint, stroke).filter(|_| mechanism.has_no_shapes());
            let (seat, mover) = match ram {
                Some(ram) => ram.solids(DVec3::AXES[joint.axis], radius),
                None => joint_solids(&joint, radius, stroke),
            };
            if joint.grounded && joint.kind == JointKind::Prismatic {
                let at = joint.before.pose(first) * Pose::from_translation(shift);
                let ends = [
                    stroke[0] - GUIDE_END * radius,
                    stroke[1] + GUIDE_END * radius,
                ];
                let along = at.rotation.col(joint.axis);
                guides.extend(ends.map(|end| at.translation + along * end));
            }
            let carried = |frame| PieceCarrier::Link(shifted_frame(frame, shift));
            add(seat, carried(&joint.before), SEAT);
            add(mover, carried(&joint.after), MOVER);
            // The ground's sign where no body of the frame shows it; below the middle of a slider's stroke.
            if joint.grounded && !place.held {
                let at = joint.before.pose(first) * Pose::from_translation(shift);
                let slides = joint.kind == JointKind::Prismatic;
                let middle = if slides {
                    at.rotation.col(joint.axis) * (0.5 * (stroke[0] + stroke[1]))
                } else {
                    DVec3::ZERO
                };
                add(
                    ground_sign(at.translation + middle, up, radius),
                    PieceCarrier::Still,
                    GROUND,
                );
            }
        }
        signs.still.extend(guides);
        signs
    }

    /// Points that the camera must hold: the ground's signs and guides.
    pub fn still_points(&self) -> &[DVec3] {
        &self.still
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.pieces.is_empty()
    }

    /// The symbols at a pose.
    pub fn instances(&self, at: &PlacedLinks, meshes: &[StageMesh]) -> Vec<Instance> {
        let pieces = self.pieces.iter();
        pieces
            .map(|piece| {
                let carrier = piece.carrier.pose(at);
                let mut instance = sign_instance(piece.mesh, meshes, carrier, piece.colour, 0.0);
                instance.casts_shadow = true;
                instance.outline = Some(FIRST_OUTLINE + piece.mesh as u32);
                instance
            })
            .collect()
    }
}

/// The frame with a translation behind it.
fn shifted_frame(frame: &CarriedFrame, by: DVec3) -> CarriedFrame {
    if by == DVec3::ZERO {
        return frame.clone();
    }
    let shift = ChainStep::Fixed(Pose::from_translation(by).into());
    frame.clone().then(&[shift])
}

/// A driven length between two links without bodies: a barrel at one end, and a rod at the other that always ends in it.
struct Ram {
    /// On which side of the joint's frame it lies.
    sense: f64,
    /// Lengths from the frame.
    barrel: f64,
    rod: f64,
}

impl Ram {
    /// Share of the shortest length that the barrel takes, and of it that the rod stays in the barrel.
    const BARREL: f64 = 0.9;
    const OVERLAP: f64 = 0.05;

    /// `None` for what is no length: a slider of the frame, or one that passes its own frame.
    fn of(joint: &PlacedJoint, [low, high]: [f64; 2]) -> Option<Self> {
        let is_length = joint.kind == JointKind::Prismatic && !joint.grounded && low * high > 0.0;
        let [shortest, longest] = [low.abs().min(high.abs()), low.abs().max(high.abs())];
        let barrel = Self::BARREL * shortest;
        is_length.then_some(Self {
            sense: low.signum(),
            barrel,
            rod: longest - barrel + Self::OVERLAP * shortest,
        })
    }

    /// Those of the two links, along `axis`, with the radius `r` of a pin.
    fn solids(&self, axis: DVec3, r: f64) -> (Vec<Solid>, Vec<Solid>) {
        let barrel = rod_solid(axis, 0.0, self.sense * self.barrel, 1.6 * r);
        let rod = rod_solid(axis, 0.0, -self.sense * self.rod, 0.8 * r);
        (vec![barrel], vec![rod])
    }
}

/// A cylinder from one height above the origin to another.
fn rod_solid(axis: DVec3, from: f64, to: f64, radius: f64) -> Solid {
    Solid::Cylinder {
        from: axis * from,
        to: axis * to,
        radius,
    }
}

/// The parts in the frames on both sides of a joint with pin radius `r`; a translation ranges from `low` to `high`.
fn joint_solids(joint: &PlacedJoint, r: f64, [low, high]: [f64; 2]) -> (Vec<Solid>, Vec<Solid>) {
    let axis = DVec3::AXES[joint.axis];
    let guide = rod_solid(axis, low - GUIDE_END * r, high + GUIDE_END * r, 0.7 * r);
    match joint.kind {
        JointKind::Revolute => (
            vec![rod_solid(axis, -2.0 * r, 2.0 * r, 1.6 * r)],
            vec![rod_solid(axis, -3.0 * r, 3.0 * r, r)],
        ),
        JointKind::Universal => (
            vec![rod_solid(axis, -3.0 * r, 3.0 * r, r)],
            vec![rod_solid(
                DVec3::AXES[joint.last_axis],
                -3.0 * r,
                3.0 * r,
                r,
            )],
        ),
        JointKind::Spherical => {
            let ring = Solid::Torus {
                centre: DVec3::ZERO,
                axis,
                ring: 1.85 * r,
                tube: 0.45 * r,
            };
            let ball = Solid::Sphere {
                centre: DVec3::ZERO,
                radius: 2.0 * r,
            };
            (vec![ring], vec![ball])
        }
        JointKind::Prismatic => {
            let block = Solid::Box {
                centre: DVec3::ZERO,
                size: DVec3::splat(3.2 * r) + axis * (1.6 * r),
            };
            (vec![guide], vec![block])
        }
        JointKind::Cylindrical => (
            vec![guide],
            vec![rod_solid(axis, -3.0 * r, 3.0 * r, 1.7 * r)],
        ),
        JointKind::Planar => {
            // A puck on a table; the table is a guide in the direction of the first motion.
            let puck = rod_solid(DVec3::AXES[joint.last_axis], -0.8 * r, 0.8 * r, 2.4 * r);
            (vec![guide], vec![puck])
        }
        JointKind::Helical => {
            let turns = ((high - low) / (1.2 * r)) as u32 + 10;
            let thread = (0..turns.min(200)).map(|k| Solid::Torus {
                centre: axis * (low - 6.0 * r + 1.2 * r * f64::from(k)),
                axis,
                ring: 0.8 * r,
                tube: 0.35 * r,
            });
            let nut = rod_solid(axis, -1.6 * r, 1.6 * r, 1.9 * r);
            (std::iter::once(guide).chain(thread).collect(), vec![nut])
        }
    }
}
