//! Where on their axes the hinges of scenes without bodies are: beside the ends of bars that their links carry. A chain
//! determines only the axis.

use crate::model::bar_ends::BarEnds;
use crate::model::joints::{Joint, JointKind, LinkFrame};
use crate::model::mechanism::Mechanism;
use glam::DVec3;

/// The shift of every joint of the table along its axis; none but for hinges of scenes with bars and without bodies.
pub fn axis_shifts(mechanism: &Mechanism) -> Vec<f64> {
    let joints = &mechanism.joints.list;
    let mut shifts = vec![None; joints.len()];
    if mechanism.bars.is_empty() || !mechanism.has_no_shapes() {
        return vec![0.0; joints.len()];
    }
    // Next to the ends of bars first, then next to the hinges that are known.
    let mut places = BarEnds::new(mechanism).carried();
    loop {
        let mut found = Vec::new();
        for (joint, shift) in joints.iter().zip(&mut shifts) {
            if shift.is_none() {
                *shift = nearest_height(joint, &places);
                found.extend(shift.iter().flat_map(|shift| joint_points(joint, *shift)));
            }
        }
        if found.is_empty() {
            return shifts
                .into_iter()
                .map(|shift| shift.unwrap_or(0.0))
                .collect();
        }
        places.extend(found);
    }
}

/// The place of a joint on its links, shifted along its axis.
pub fn joint_points(joint: &Joint, shift: f64) -> [(usize, DVec3); 2] {
    let along = hinge_axis(joint).map_or(DVec3::ZERO, |axis| DVec3::AXES[axis] * shift);
    let place = |frame: &LinkFrame| (frame.link, frame.link_from_here.transform_point(along));
    [place(&joint.before), place(&joint.after)]
}

/// The height above a hinge's frames of the points that its links carry: the least.
fn nearest_height(joint: &Joint, places: &[(usize, DVec3)]) -> Option<f64> {
    let axis = hinge_axis(joint)?;
    let frames = [&joint.before, &joint.after];
    let heights = frames
        .into_iter()
        .filter(|frame| frame.link != 0)
        .flat_map(|frame| {
            let own = places.iter().filter(|(link, _)| *link == frame.link);
            own.map(|(_, place)| frame.link_from_here.inverse().transform_point(*place)[axis])
        });
    heights.min_by(|a, b| a.abs().total_cmp(&b.abs()))
}

/// The axis of a hinge in both of its frames.
fn hinge_axis(joint: &Joint) -> Option<usize> {
    let mut steps = joint.steps.iter().filter_map(|step| step.joint());
    let axis = steps.next().map(|step| step.axis);
    axis.filter(|_| joint.kind == JointKind::Revolute && steps.next().is_none())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::diag::Source;
    use crate::scene::{Overrides, load_scene};
    use std::sync::Arc;

    fn mechanism(chains: &str, bars: &str) -> Arc<Mechanism> {
        let text = format!(
            "units = {{ length = \"mm\", angle = \"deg\" }}\nduration = 1\n[inputs]\nphi = \"30*t\"\n[chains]\n{chains}\n[bars]\n{bars}\n"
        );
        let name = "bars".to_owned();
        let scene = load_scene(&Source { name, text }, &Overrides::default());
        scene.unwrap().mechanism
    }

    /// Hinges of levers in space stand beside the ends of the bars, however the chain is written.
    #[test]
    fn hinges_stand_beside_the_ends_of_bars() {
        let rod = "rod = { from = \"A\", to = \"B\", length = 5 }";
        let cases = [
            (
                "A = \"Rz(phi) Tx(1)\"\nB = \"T(4, 2, 0) Rx(psi) Tz(2.5)\"",
                DVec3::new(4.0, 2.0, 0.0),
            ),
            (
                "A = \"Tz(7) Rz(phi) Tx(1)\"\nB = \"T(4, 1, 7) Rz(psi) Tx(3)\"",
                DVec3::new(4.0, 1.0, 7.0),
            ),
            (
                "A = \"Tz(7) Rz(phi) Tx(1)\"\nB = \"T(4, 1, 0) Rz(psi) Tx(3) Tz(7)\"",
                DVec3::new(4.0, 1.0, 7.0),
            ),
            (
                "A = \"Tx(4) Ry(phi) Tx(1)\"\nB = \"Rz(90) Tx(3) Ry(psi) Tx(2)\"",
                DVec3::new(0.0, 3.0, 0.0),
            ),
        ];
        for (chains, place) in cases {
            let mechanism = mechanism(chains, rod);
            let ends = BarEnds::new(&mechanism);
            assert_eq!(ends.carried().len(), 2, "{chains}");
            let shifts = axis_shifts(&mechanism);
            let joints = mechanism.joints.list.iter().zip(shifts);
            let own = joints.filter(|(joint, _)| !ends.place_joint(joint));
            let grounded = own.map(|(joint, shift)| joint_points(joint, shift));
            let places: Vec<DVec3> = grounded
                .flatten()
                .filter(|(link, _)| *link == 0)
                .map(|(_, at)| at)
                .collect();
            assert!(
                places.iter().any(|at| at.distance(place) < 1e-12),
                "{chains}: {places:?}"
            );
        }
    }

    /// A slider has a guide; a platform without a joint is a body that the ends of three bars belong to.
    #[test]
    fn sliders_and_platforms_are_found() {
        let slider = mechanism(
            "A = \"Rz(phi) Tx(3)\"\nB = \"Ty(1) Tx(x)\"",
            "rod = { from = \"A\", to = \"B\", length = 9 }",
        );
        let ends = BarEnds::new(&slider);
        assert_eq!(
            ends.bars()
                .flatten()
                .filter(|end| ends.guide_of(end).is_some())
                .count(),
            1
        );
        let placed = crate::staging::joints::placed_joints(&slider);
        assert!(
            placed
                .iter()
                .any(|joint| joint.kind == JointKind::Prismatic && joint.grounded)
        );
        // Beside the end, wherever the chain says so.
        for end in [
            "B = \"Ty(-6) Tx(x)\"",
            "B = \"Tx(x) Ty(-6)\"",
            "B = \"T(x, -6, 0)\"",
        ] {
            let chains = format!("A = \"Rz(phi) Tx(3)\"\n{end}");
            let slider = mechanism(&chains, "rod = { from = \"A\", to = \"B\", length = 19 }");
            let placed = crate::staging::joints::placed_joints(&slider);
            let guide = placed
                .iter()
                .find(|joint| joint.kind == JointKind::Prismatic);
            let at = guide.unwrap().before.fixed_place();
            assert!(
                at.distance(DVec3::new(0.0, -6.0, 0.0)) < 1e-12,
                "{end}: {at}"
            );
        }
        let platform = mechanism(
            "A = \"Rz(phi) Tx(3)\"\nP = \"T(x, y, z)\"",
            "a = { from = \"A\", to = \"P Tx(1)\", length = 9 }\nb = { from = [9, 0, 0], to = \"P Rz(120) Tx(1)\", length = 9 }\n\
             c = { from = [0, 9, 0], to = \"P Rz(240) Tx(1)\", length = 9 }",
        );
        let bodies = BarEnds::new(&platform).free_bodies();
        assert_eq!(
            bodies
                .iter()
                .map(|(_, places)| places.len())
                .collect::<Vec<_>>(),
            [3]
        );
        let [a, b] = [bodies[0].1[0], bodies[0].1[1]];
        assert!((a.distance(b) - 3f64.sqrt()).abs() < 1e-12);
    }
}
