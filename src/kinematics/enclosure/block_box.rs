//! The result of a proved block for single pieces: the box that contains one pose of each, and its preconditioner.

use super::mapped::Contraction;

/// A block's box x + S δ ± sides, in which every piece has one pose.
#[derive(Clone, Debug)]
pub struct BlockBox {
    /// R, near the inverse of the Jacobian of the basis, row after row.
    pub inverse: Vec<f64>,
    /// S, unknown after unknown.
    pub rates: Vec<f64>,
    /// Points about which the loops are expressed.
    pub about: Vec<[f64; 3]>,
    /// Rows on which it is proved.
    pub basis: Vec<usize>,
    /// |A| over the box.
    pub contraction: Contraction,
    /// Half widths.
    pub sides: Vec<f64>,
    /// Largest share of the unknowns' range that remains open.
    pub roughness: f64,
}
