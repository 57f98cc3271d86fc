//! Three rotations in a row with constants between them: their axes, and the point in which these meet.

use crate::math::Pose;
use crate::model::chain::{ChainStep, ElementaryMotion};
use crate::model::joints::EXACT;
use glam::{DMat3, DVec3};

/// Three successive rotations with the constant poses between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RotationRun {
    /// Axis, argument and sign.
    pub turns: [(usize, usize, f64); 3],
    pub between: [Pose; 2],
}

impl RotationRun {
    /// The run of these steps, from its first rotation to its last.
    pub fn of(steps: &[ChainStep]) -> Option<Self> {
        let mut turns = Vec::with_capacity(3);
        let mut between = [Pose::IDENTITY; 2];
        for step in steps {
            match *step {
                ChainStep::Joint {
                    motion: ElementaryMotion::Rotation,
                    axis,
                    argument,
                    sign,
                } => turns.push((axis, argument, sign)),
                ChainStep::Fixed(pose) => {
                    // Fixed poses before the first rotation and after the third belong to the links.
                    let gap = turns.len().checked_sub(1)?;
                    let before = between.get_mut(gap)?;
                    *before = *before * pose;
                }
                ChainStep::Joint { .. } => return None,
            }
        }
        let turns = turns.try_into().ok()?;
        Some(Self { turns, between })
    }

    pub fn inverse(&self) -> Self {
        let [first, second, third] = self
            .turns
            .map(|(axis, argument, sign)| (axis, argument, -sign));
        let [one, other] = self.between.map(|pose| pose.inverse());
        Self {
            turns: [third, second, first],
            between: [other, one],
        }
    }

    /// Whether both are the same joint.
    pub fn is(&self, other: &Self, size: f64) -> bool {
        let pairs = self.between.iter().zip(&other.between);
        let mut gaps = pairs.map(|(a, b)| {
            let turned = (a.rotation - b.rotation).to_cols_array();
            let moved = (a.translation - b.translation).length() / size;
            turned.iter().fold(moved, |m, v| m.max(v.abs()))
        });
        self.turns == other.turns && gaps.all(|gap| gap <= EXACT)
    }

    pub fn arguments(&self) -> [usize; 3] {
        self.turns.map(|(_, argument, _)| argument)
    }
}

/// C and mu of a run, as [`joint`](super::joint) has them.
pub(super) struct BallAxes {
    pub frame: DMat3,
    pub mu: f64,
}

/// `None` unless each axis is at right angles to the next.
pub(super) fn axes_of(run: &RotationRun) -> Option<BallAxes> {
    let own = run.turns.map(|(axis, _, _)| DVec3::AXES[axis]);
    let [first, second] = run.between.map(|pose| pose.rotation);
    let (u1, u2, u3) = (own[0], first * own[1], first * second * own[2]);
    if u1.dot(u2).abs() > EXACT || u2.dot(u3).abs() > EXACT {
        return None;
    }
    // With the first two axes at right angles, the third lies in the plane perpendicular to the second.
    let third = u1.cross(u2);
    Some(BallAxes {
        frame: DMat3::from_cols(u1, u2, third),
        mu: libm::atan2(u3.dot(u1), u3.dot(third)),
    })
}

/// The point where the three axes meet, from the frame after the last; `None` if they do not.
///
/// A constant translation along the axis before it or after it does not move an axis off the point.
pub(super) fn ball_centre(run: &RotationRun, size: f64) -> Option<DVec3> {
    let own = run.turns.map(|(axis, _, _)| DVec3::AXES[axis]);
    let [first, second] = run.between;
    let second_axis = first.rotation * own[1];
    let (along, back) = (
        first.translation.dot(own[0]),
        first.translation.dot(second_axis),
    );
    let off_first = first.translation - own[0] * along - second_axis * back;
    // The point of the second axis where it meets the first, in the frame after the second rotation.
    let meets = own[1] * -back;
    let last_axis = second.rotation * own[2];
    let way = meets - second.translation;
    let onward = way.dot(last_axis);
    let off_last = way - last_axis * onward;
    let misses = off_first.length().max(off_last.length()) / size;
    (misses <= EXACT).then(|| own[2] * onward)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_that_miss_each_other_or_a_right_angle_are_no_ball() {
        let shift = |x: f64, y: f64, z: f64| Pose::from_translation(DVec3::new(x, y, z));
        let turn = |axis, angle| Pose::from_axis_rotation(axis, angle);
        let run = |between: [Pose; 2]| RotationRun {
            turns: [(0, 0, 1.0), (1, 1, 1.0), (2, 2, 1.0)],
            between,
        };
        // Along the axes before and behind a constant nothing is moved apart.
        let met = run([shift(3.0, -2.0, 0.0), shift(0.0, 2.0, 5.0)]);
        assert_eq!(ball_centre(&met, 1.0), Some(DVec3::new(0.0, 0.0, -5.0)));
        for [one, other] in [
            [shift(0.0, 0.0, 1.0), Pose::IDENTITY],
            [Pose::IDENTITY, shift(1.0, 0.0, 0.0)],
            [shift(3.0, -2.0, 0.0), shift(0.0, 0.0, 5.0)],
        ] {
            assert_eq!(ball_centre(&run([one, other]), 1.0), None);
        }
        assert!(axes_of(&run([turn(2, 0.5), Pose::IDENTITY])).is_none());
        assert!(axes_of(&run([turn(0, 0.5), turn(1, 0.7)])).is_some());
    }
}
