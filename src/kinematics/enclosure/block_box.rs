//! What a proved block leaves behind for single pieces: the box that holds one pose of each, and what it is mapped by.

use super::mapped::Contraction;

/// A block's box x + S δ ± sides, in which every piece has one pose.
#[derive(Clone, Debug)]
pub struct BlockBox {
    /// R, near the inverse of the Jacobian of the basis, row after row.
    pub inverse: Vec<f64>,
    /// S, unknown after unknown.
    pub rates: Vec<f64>,
    /// Points that the loops are seen about.
    pub about: Vec<[f64; 3]>,
    /// Rows that it is proved on.
    pub basis: Vec<usize>,
    /// |A| over the box.
    pub contraction: Contraction,
    /// Half widths.
    pub sides: Vec<f64>,
}
