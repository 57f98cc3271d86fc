//! Which bodies are neighbours: two bodies that one joint connects touch where it is, and are not judged.
//!
//! A body that belongs to a link between two others parts them, however near their axes are: they must clear each other.

use crate::model::joints::Joints;

/// Why two bodies are neighbours, or `None` if they are not.
pub fn neighbours(joints: &Joints, [a, b]: [usize; 2]) -> Option<&'static str> {
    if joints.are_rigid(a, b) {
        return Some("one rigid part");
    }
    joints.between(a, b).map(|joint| joint.kind.words())
}
