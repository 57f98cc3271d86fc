//! The map of a block's box, and bounds that follow if the box is mapped into itself.

use crate::numbers::rounding::GROW;

/// How often bounds are improved by the contraction.
pub const SWEEPS: usize = 6;

/// The map of the box.
pub struct Mapped<F> {
    /// G, unknown after unknown.
    pub g: Vec<F>,
    /// A, row after row.
    pub entries: Vec<F>,
    /// |A|
    pub a: Contraction,
    /// η
    pub eta: Vec<f64>,
}

/// |A|, row after row: bounds the image of the difference of two poses in the box.
#[derive(Clone, Debug)]
pub struct Contraction(pub Vec<f64>);

/// Largest share of the box that its image takes.
pub fn image_ratio(image: &[f64], box_of: &[f64]) -> f64 {
    let pairs = image.iter().zip(box_of);
    pairs.map(|(y, w)| y / w).fold(0.0, f64::max)
}

impl Contraction {
    /// η + |A| w
    pub fn image(&self, eta: &[f64], w: &[f64]) -> Vec<f64> {
        let moved = self.times(w);
        let pairs = eta.iter().zip(moved);
        pairs.map(|(eta, moved)| (eta + moved) * GROW).collect()
    }

    /// |A| w
    pub fn times(&self, w: &[f64]) -> Vec<f64> {
        let rows = self.0.chunks_exact(w.len().max(1));
        rows.map(|row| row.iter().zip(w).map(|(a, w)| a * w).sum::<f64>() * GROW)
            .collect()
    }

    /// A bound of all y ≥ 0 with y ≤ from + |A| y, if the box is mapped into itself.
    pub fn solved(&self, from: &[f64], box_of: &[f64]) -> Vec<f64> {
        let contraction = image_ratio(&self.times(box_of), box_of);
        let share = image_ratio(from, box_of) / (1.0 - contraction) * GROW;
        let first: Vec<f64> = box_of.iter().map(|w| share * w * GROW).collect();
        (0..SWEEPS).fold(first, |y, _| {
            let moved = self.times(&y);
            let next = from.iter().zip(moved).zip(&y);
            next.map(|((from, moved), y)| ((from + moved) * GROW).min(*y))
                .collect()
        })
    }
}
