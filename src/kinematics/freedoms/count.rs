//! The mobility count of Grübler and Kutzbach: of joints between links, whatever coordinates describe them.
//!
//! Joint freedoms, plus coordinates that appear in equations only; minus the dimension of every loop's group of motions
//! (6; 3 for planar and spherical loops, wherever their plane or centre lies); minus the equations; minus the joints
//! that share coordinates with others. Some sharing costs nothing: the angles of bars relative to the frame are shared
//! by the joints at both their ends, so that the rotations of the loop close by themselves. The count therefore uses
//! the shared coordinates minus those that close by themselves.

use super::generic_rank::{RANK, random_poses, rank_of_rows};
use crate::math::Pose;
use crate::model::chain::{Argument, ArgumentValue, ElementaryMotion};
use crate::model::joints::{Joint, Joints};
use crate::model::mechanism::{Closes, Loop, Mechanism};
use crate::model::walk::walk_chain;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// The motions that a loop's joints can perform together.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopSpace {
    /// Name of the loop.
    pub name: String,
    /// Largest number of conditions for closing it: the dimension of the span of all its joints' twists over all poses.
    /// None if the loops before it close it already.
    pub dimension: usize,
    /// All rotations are about one direction, and all translations perpendicular to it.
    pub is_planar: bool,
}

/// The terms of the count.
#[derive(Clone, Debug, PartialEq)]
pub struct JointCount {
    /// Freedoms of the joints: those of loops, and those of bodies that move by coordinates of their own.
    pub joints: usize,
    /// Freedoms of coordinates in equations that no joint has: coordinates that appear in equations only, and all but
    /// one of a sum that moves a joint.
    pub free: usize,
    /// Every loop.
    pub loops: Vec<LoopSpace>,
    /// Scalar equations.
    pub equations: usize,
    /// Joints coupled to others by shared coordinates.
    pub shared: usize,
    /// Whether it was counted by coordinates instead of joints, because some coordinates are shared in more than one
    /// way at once.
    pub is_by_coordinates: bool,
}

impl JointCount {
    /// Counts a mechanism's joints.
    pub fn new(mechanism: &Mechanism) -> Self {
        let poses = random_poses(mechanism);
        let (counted, span) = counted_joints(mechanism);
        let list = &mechanism.joints.list;
        let freedoms: usize = counted.iter().map(|j| list[*j].kind.freedoms()).sum();
        let arguments = counted.iter().flat_map(|j| list[*j].arguments());
        let independent = telling_pose(mechanism, &poses).map_or(0, |pose| {
            independent_arguments(mechanism, &arguments.collect::<Vec<_>>(), pose)
        });
        let spaces = loop_spaces(mechanism, &poses);
        let by_themselves: usize = spaces.iter().map(|s| s.joints - s.coordinates).sum();
        // Freedoms that joints of several loops have in common must not be counted twice.
        let shared = (freedoms - independent).checked_sub(by_themselves);
        let is_by_coordinates = shared.is_none();
        let of_loop = |(item, space): (&Loop, Space)| LoopSpace {
            name: item.name.clone(),
            dimension: match is_by_coordinates {
                true => space.coordinates,
                false => space.joints,
            },
            is_planar: space.is_planar,
        };
        Self {
            joints: match is_by_coordinates {
                true => independent,
                false => freedoms,
            },
            free: beside_joints(mechanism, span),
            loops: mechanism.loops.iter().zip(spaces).map(of_loop).collect(),
            equations: mechanism.equations.len(),
            shared: shared.unwrap_or(0),
            is_by_coordinates,
        }
    }

    /// The freedoms: fewer than the true ones if loops are over-constrained.
    pub fn freedoms(&self) -> i64 {
        let loops: usize = self.loops.iter().map(|l| l.dimension).sum();
        let cost = loops + self.equations + self.shared;
        (self.joints + self.free) as i64 - cost as i64
    }

    /// Dependent coordinates of a planar mechanism written as vector loops with angles relative to the frame: two
    /// equations per loop and one per equation, d = 2k + s1. `None` if it is not planar.
    pub fn planar_dependents(&self) -> Option<usize> {
        let mut closing = self.closing().peekable();
        closing.peek()?;
        let (mut loops, mut is_planar) = (0, true);
        closing.for_each(|l| (loops, is_planar) = (loops + 1, is_planar && l.is_planar));
        is_planar.then_some(2 * loops + self.equations)
    }

    /// Loops that are not closed by the loops before them.
    pub fn closing(&self) -> impl Iterator<Item = &LoopSpace> {
        self.loops.iter().filter(|l| l.dimension > 0)
    }
}

/// The joints of loops, and those of the others that add a freedom: a joint whose coordinates belong to other joints
/// already (a gear, a stage of a telescope) adds none. Returned with the coordinates they change.
fn counted_joints(mechanism: &Mechanism) -> (Vec<usize>, TwistSpan) {
    let Joints {
        list, along_loops, ..
    } = &mechanism.joints;
    let mut counted: Vec<usize> = along_loops.iter().flatten().map(|p| p.joint).collect();
    counted.sort_unstable();
    counted.dedup();
    // All others are judged by the arguments: sums and differences of known coordinates add nothing, new combinations
    // of coordinates do.
    let mut span = TwistSpan::default();
    let poses = random_poses(mechanism);
    let Some(pose) = telling_pose(mechanism, &poses) else {
        return (counted, span);
    };
    for joint in &counted {
        adds_freedom(mechanism, &mut span, &list[*joint], pose);
    }
    let in_loops = counted.len();
    for (index, joint) in list.iter().enumerate() {
        let is_in_loop = counted[..in_loops].binary_search(&index).is_ok();
        if !is_in_loop && adds_freedom(mechanism, &mut span, joint, pose) {
            counted.push(index);
        }
    }
    (counted, span)
}

/// The pose with the fewest undefined arguments: an arc sine may be undefined at a random one.
fn telling_pose<'p>(mechanism: &Mechanism, poses: &'p [Vec<f64>]) -> Option<&'p [f64]> {
    let unknown = |pose: &&Vec<f64>| {
        let arguments = mechanism.arguments.iter();
        let has_none = |a: &&Argument| a.gradient(pose).iter().any(|(_, rate)| !rate.is_finite());
        arguments.filter(has_none).count()
    };
    poses.iter().min_by_key(unknown).map(Vec::as_slice)
}

/// Whether a joint's motions are independent of `span`; they are added to it.
fn adds_freedom(mechanism: &Mechanism, span: &mut TwistSpan, joint: &Joint, pose: &[f64]) -> bool {
    let arguments = joint.arguments();
    let added = arguments.filter(|a| span.add(&gradient_of(mechanism, *a, pose)));
    added.count() > 0
}

/// Rates of an argument by the coordinates in their units, normalised to a largest rate of one.
fn gradient_of(mechanism: &Mechanism, argument: usize, pose: &[f64]) -> Vec<(usize, f64)> {
    let rates = mechanism.arguments[argument].gradient(pose).into_iter();
    let rates: Vec<(usize, f64)> = rates
        .map(|(slot, rate)| (slot, rate * mechanism.scale_of(slot)))
        .collect();
    let largest = rates.iter().fold(0.0_f64, |m, (_, v)| m.max(v.abs()));
    let unit = largest.max(f64::MIN_POSITIVE);
    rates
        .iter()
        .map(|(slot, rate)| (*slot, rate / unit))
        .collect()
}

/// A space of rows with few entries, each row with a pivot of its own.
#[derive(Default)]
struct TwistSpan {
    rows: BTreeMap<usize, BTreeMap<usize, f64>>,
}

impl TwistSpan {
    /// Adds a row; returns whether it is independent of the earlier ones.
    fn add(&mut self, row: &[(usize, f64)]) -> bool {
        let mut row: BTreeMap<usize, f64> = row.iter().copied().filter(|e| e.1 != 0.0).collect();
        // Every row of the span begins at its pivot: one pass from left to right leaves none of them.
        let mut from = 0;
        while let Some((slot, value)) = row.range(from..).next().map(|(s, v)| (*s, *v)) {
            from = slot + 1;
            if value.abs() <= RANK || !value.is_finite() {
                row.remove(&slot);
                continue;
            }
            let Some(known) = self.rows.get(&slot) else {
                row.retain(|other, _| *other >= slot);
                self.rows.insert(slot, row);
                return true;
            };
            let factor = value / known[&slot];
            for (other, entry) in known {
                *row.entry(*other).or_insert(0.0) -= factor * entry;
            }
            row.remove(&slot);
        }
        false
    }
}

/// Number of coordinates of equations that change something the joints do not, each in addition to those before it: a
/// joint moved by a sum of two has one freedom, while the equations contain both.
fn beside_joints(mechanism: &Mechanism, mut span: TwistSpan) -> usize {
    let equations = mechanism.equations.iter();
    let slots: BTreeSet<usize> = equations.flat_map(|e| e.expression.slots()).collect();
    let added = slots.into_iter().filter(|slot| span.add(&[(*slot, 1.0)]));
    added.count()
}

/// How many of the arguments change independently of each other.
fn independent_arguments(mechanism: &Mechanism, arguments: &[usize], pose: &[f64]) -> usize {
    let mut span = TwistSpan::default();
    let rows = arguments.iter().map(|a| gradient_of(mechanism, *a, pose));
    rows.filter(|row| span.add(row)).count()
}

/// Dimensions of a loop's motions.
struct Space {
    /// Generated by its joints, each moving independently.
    joints: usize,
    /// Generated by its coordinates: less if some equations of the loop always hold.
    coordinates: usize,
    is_planar: bool,
}

/// Spans of the loops' twists over random poses, closed or not: the groups that the joints generate.
fn loop_spaces(mechanism: &Mechanism, poses: &[Vec<f64>]) -> Vec<Space> {
    let loops = mechanism.loops.iter().zip(&mechanism.joints.closes);
    let values = poses.iter().map(|pose| mechanism.argument_values(pose));
    let values: Vec<Vec<ArgumentValue>> = values.collect();
    let of_loop = |(item, closes): (&Loop, &bool)| {
        let (mut joints, mut turns, mut coordinates) = (Vec::new(), Vec::new(), Vec::new());
        for (pose, arguments) in poses.iter().zip(&values) {
            let mut columns: BTreeMap<usize, [f64; 6]> = BTreeMap::new();
            each_twist(item, arguments, |argument, unit, twist| {
                joints.extend(twist);
                turns.extend(&twist[..3]);
                for (slot, rate) in mechanism.arguments[argument].gradient(pose) {
                    let rate = rate * mechanism.scale_of(slot) / unit;
                    let column = columns.entry(slot).or_default().iter_mut().zip(twist);
                    column.for_each(|(c, t)| *c += rate * t);
                }
            });
            coordinates.extend(columns.into_values().flatten());
        }
        // Where a point closes the loop, its three coordinates are all that counts.
        let most = match (closes, item.closes) {
            (false, _) => 0,
            (true, Closes::Frame) => 6,
            (true, Closes::Point) => 3,
        };
        let dimension = rank_of_rows(&joints, 6);
        Space {
            joints: dimension.min(most),
            coordinates: rank_of_rows(&coordinates, 6).min(most),
            is_planar: dimension == 3 && rank_of_rows(&turns, 3) == 1,
        }
    };
    loops.map(of_loop).collect()
}

/// Calls `each` with every motion's argument, its unit (radian, size) and its twist for a rate of one unit: angular
/// velocity, and velocity at the origin over the loop's size; for a loop that closes in a point, only the velocity of
/// that point.
fn each_twist(
    item: &Loop,
    arguments: &[ArgumentValue],
    mut each: impl FnMut(usize, f64, [f64; 6]),
) {
    let size = item.size;
    // Of a loop that closes in a point only the velocity of that point counts.
    let point = match item.closes {
        Closes::Frame => None,
        Closes::Point => Some(item.chain.pose(arguments).translation),
    };
    let mut end = Pose::IDENTITY;
    walk_chain(&item.chain.steps, &mut end, arguments, |here, joint| {
        let axis = here.rotation.col(joint.axis) * joint.sign;
        // Twist in Plücker form: the velocity of the point at the origin, over the loop's size.
        let (unit, turn, speed) = match (joint.motion, point) {
            (ElementaryMotion::Rotation, None) => (1.0, axis, here.translation.cross(axis) / size),
            (ElementaryMotion::Rotation, Some(point)) => {
                let arm = point - here.translation;
                (1.0, DVec3::ZERO, axis.cross(arm) / size)
            }
            (ElementaryMotion::Translation, _) => (size, DVec3::ZERO, axis),
        };
        let twist = [turn.x, turn.y, turn.z, speed.x, speed.y, speed.z];
        each(joint.argument, unit, twist);
    });
}
