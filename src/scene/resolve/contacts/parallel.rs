//! Two cylinders in contact whose axes are parallel in every pose, such as a cam and its roller.
//!
//! They touch along a line. In general position the contact point has a coordinate along each axis (`w1`, `w2`) and the
//! cylinders cross at an angle (`spin`). Here the angle is known, and the point may lie anywhere on the line. It is
//! fixed at the origin of the second surface's frame: `w2` is zero. If nothing translates the frames along the axes,
//! `w1` is known too, and a planar loop remains.

use super::super::super::contacts::ContactSurface;
use super::super::super::formula::expansion::Factor;
use super::super::joints::FoldedJoints;
use super::super::names::Names;
use super::super::parsed::Parsed;
use super::chains::ParsedContact;
use crate::diag::Diagnostics;
use crate::math::Pose;
use crate::model::chain::{ChainStep, ElementaryMotion};
use crate::model::fixed::FixedPose;
use crate::model::joints::EXACT;
use crate::numbers::constant::Constant;
use glam::DVec3;

/// The relative position of two parallel axes.
struct Arrangement {
    /// The z axes of both frames point the same way.
    is_same_way: bool,
    /// Position of the second frame along the first axis; `None` if it is not constant.
    along: Option<Constant>,
}

/// Makes constants of the unknowns of contacts that parallel axes determine.
pub fn settle_parallel(parsed: &Parsed, names: &mut Names) {
    let mut settled: Vec<(String, Constant)> = Vec::new();
    for contact in &parsed.contacts {
        let Some(arrangement) = axis_arrangement(contact, names) else {
            continue;
        };
        let zero = Constant::exact(0.0);
        // The axes never cross: their angle is a half-turn or zero.
        let spin = match arrangement.is_same_way {
            true => Constant::PI,
            false => zero,
        };
        // The point is put at the second frame's origin; along the first axis it is known if nothing slides there.
        let known = [
            ("spin", Some(spin)),
            ("w2", Some(zero)),
            ("w1", arrangement.along),
        ];
        let named = |(what, value): (&str, Option<Constant>)| {
            Some((format!("{}.{what}", contact.name.value), value?))
        };
        settled.extend(known.into_iter().filter_map(named));
    }
    // Only afterwards, since all arrangements are found with the same names.
    for (name, value) in &settled {
        names.settle(name, *value);
    }
}

/// From the frame of one cylinder in contact to that of the other; `None` unless both surfaces are cylinders.
pub fn factors_across(contact: &ParsedContact) -> Option<Vec<Factor>> {
    let [first, second] = &contact.sides;
    let both = [&first.surface, &second.surface];
    let are_cylinders = both
        .iter()
        .all(|s| matches!(s, ContactSurface::Cylinder { .. }));
    let back = first.frame.iter().rev().cloned().map(Factor::inverse);
    are_cylinders.then(|| back.chain(second.frame.iter().cloned()).collect())
}

/// `None` unless both surfaces are cylinders and all rotations from one to the other are about their axes.
fn axis_arrangement(contact: &ParsedContact, names: &Names) -> Option<Arrangement> {
    // Errors in a chain are reported where it is resolved.
    let mut joints = FoldedJoints::new(names);
    let chain = joints.chain(&factors_across(contact)?, &mut Diagnostics::default())?;
    // Rotations about the axis change neither its direction nor the axes of other rotations that are parallel to it.
    // One pose, with all coordinates zero, therefore shows whether all axes are parallel.
    let mut frame = FixedPose::exact(Pose::IDENTITY);
    let (mut is_parallel, mut is_shifted) = (true, false);
    for step in &chain.steps {
        match *step {
            ChainStep::Fixed(pose) => frame = frame * pose,
            ChainStep::Joint { motion, axis, .. } => match motion {
                ElementaryMotion::Rotation => is_parallel &= is_along(frame.rotation.col(axis)),
                ElementaryMotion::Translation => {
                    is_shifted |= frame.rotation.col(axis).z.abs() > EXACT
                }
            },
        }
    }
    let axis = frame.rotation.z_axis;
    (is_parallel && is_along(axis)).then(|| Arrangement {
        is_same_way: axis.z > 0.0,
        along: (!is_shifted)
            .then(|| Constant::within(frame.translation.z, frame.error.translation)),
    })
}

/// Whether a direction is that of the z axis or opposite.
fn is_along(direction: DVec3) -> bool {
    direction.cross(DVec3::Z).length() <= EXACT
}
