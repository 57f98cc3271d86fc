//! How well loops can be closed: the effect of the rounding of angles after many turns.

use crate::kinematics::structure::block::Block;
use crate::model::mechanism::{Kind, Mechanism};

/// Largest residual of a returned pose, relative to the mechanism's size. Rounding leaves about 1e-15; anything above
/// this has not converged.
pub const CLOSURE_TOLERANCE: f64 = 1e-11;

/// Largest accepted effect of the rounding of angles; above it a pose means little. It is reached after some million
/// turns.
const COARSEST: f64 = 1e-8;

/// Half a spacing of f64 for an angle's own rounding, as much for that of the joint's value, and links that reach a few
/// sizes.
const SPACINGS: f64 = 4.0;

/// The effect of the rounding of a block's angles: beyond 131 072 rad adjacent f64 are farther apart than the
/// tolerance.
pub fn angle_rounding(mechanism: &Mechanism, block: &Block, coordinates: &[f64]) -> f64 {
    let slots = block.unknowns.iter().chain(&block.plan.outer);
    let all = mechanism.unknowns.iter().chain(&mechanism.inputs);
    let kinds: Vec<Kind> = all.map(|c| c.kind).collect();
    let angles = slots.filter(|slot| kinds[**slot] == Kind::Angle);
    let sum: f64 = angles.map(|slot| coordinates[*slot].abs()).sum();
    SPACINGS * f64::EPSILON * sum
}

/// Whether a block with this residual is closed as well as its angles permit.
pub(super) fn is_closed(
    mechanism: &Mechanism,
    block: &Block,
    coordinates: &[f64],
    residual: f64,
) -> bool {
    residual <= CLOSURE_TOLERANCE
        || residual <= angle_rounding(mechanism, block, coordinates).min(COARSEST)
}

/// Whether the angles of some block leave a larger closure error by their rounding than a pose may have.
pub fn are_angles_too_large(mechanism: &Mechanism, blocks: &[Block], coordinates: &[f64]) -> bool {
    let mut open = blocks
        .iter()
        .map(|b| angle_rounding(mechanism, b, coordinates));
    open.any(|rounding| rounding > COARSEST)
}
