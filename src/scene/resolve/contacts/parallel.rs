//! Two cylinders in contact whose axes are parallel in every pose: the cam and its roller.
//!
//! They touch along a line. In general position the contact point has a place along each axis (`w1`, `w2`) and the
//! cylinders cross at an angle (`spin`); here the angle is known, and the point may lie anywhere along the line. It is put
//! where the second surface's frame stands: `w2` is zero. If nothing shifts the frames along the axes, `w1` is known too,
//! and what is left is a planar loop.

use super::super::super::contacts::Surface;
use super::super::super::formula::chain::Factor;
use super::super::joints::Joints;
use super::super::names::Names;
use super::super::parsed::Parsed;
use super::chains::ParsedContact;
use crate::diag::Diagnostics;
use crate::math::Pose;
use crate::model::chain::{ArgumentValue, Motion};
use crate::model::joints::EXACT;
use crate::model::mechanism::AngleUnit;
use crate::model::walk::walk;
use glam::DVec3;
use std::f64::consts::PI;

/// How two parallel axes lie to each other.
struct Arrangement {
    /// The z axes of both frames point the same way.
    is_same_way: bool,
    /// Place of the second frame along the first axis; `None` if it changes.
    along: Option<f64>,
}

/// Makes constants of those unknowns of contacts that parallel axes leave no choice.
pub fn settle(parsed: &Parsed, names: &mut Names, unit: &AngleUnit) {
    let mut settled: Vec<(String, f64)> = Vec::new();
    for contact in &parsed.contacts {
        let Some(arrangement) = arrangement(contact, names, unit) else {
            continue;
        };
        let spin = if arrangement.is_same_way { PI } else { 0.0 };
        let known = [
            ("spin", Some(spin)),
            ("w2", Some(0.0)),
            ("w1", arrangement.along),
        ];
        let named = |(what, value): (&str, Option<f64>)| {
            Some((format!("{}.{what}", contact.name.value), value?))
        };
        settled.extend(known.into_iter().filter_map(named));
    }
    for (name, value) in &settled {
        names.settle(name, *value);
    }
}

/// From the frame of one cylinder in contact to that of the other; `None` unless both surfaces are cylinders.
pub fn across(contact: &ParsedContact) -> Option<Vec<Factor>> {
    let [first, second] = &contact.sides;
    let both = [&first.surface, &second.surface];
    let are_cylinders = both.iter().all(|s| matches!(s, Surface::Cylinder { .. }));
    let back = first.frame.iter().rev().cloned().map(Factor::inverse);
    are_cylinders.then(|| back.chain(second.frame.iter().cloned()).collect())
}

/// `None` unless both surfaces are cylinders and all rotations from one to the other are about their axes.
fn arrangement(contact: &ParsedContact, names: &Names, unit: &AngleUnit) -> Option<Arrangement> {
    // What is wrong with a chain is said where it is resolved.
    let mut joints = Joints::new(names, unit);
    let chain = joints.chain(&across(contact)?, &mut Diagnostics::default())?;
    // Rotations about the axis change neither its direction nor those of the other rotations' axes along it, so one pose
    // shows whether all are along it.
    let at_zero = vec![ArgumentValue::new(0.0); joints.arguments.len()];
    let (mut frame, mut is_parallel, mut is_shifted) = (Pose::IDENTITY, true, false);
    walk(&chain.steps, &mut frame, &at_zero, |here, joint| {
        let axis = here.rotation.col(joint.axis);
        match joint.motion {
            Motion::Rotation => is_parallel &= axis.cross(DVec3::Z).length() <= EXACT,
            Motion::Translation => is_shifted |= axis.z.abs() > EXACT,
        }
    });
    let axis = frame.rotation.z_axis;
    is_parallel &= axis.cross(DVec3::Z).length() <= EXACT;
    is_parallel.then(|| Arrangement {
        is_same_way: axis.z > 0.0,
        along: (!is_shifted).then_some(frame.translation.z),
    })
}
