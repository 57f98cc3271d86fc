//! The map of a block's box: what it is mapped by, and bounds that follow where it is mapped into itself.

use crate::numbers::rounding::GROW;

/// How often bounds are put through the contraction that they follow from.
pub const SWEEPS: usize = 6;

/// What the box is mapped by.
pub struct Mapped<F> {
    /// G, unknown after unknown.
    pub g: Vec<F>,
    /// A, row after row.
    pub entries: Vec<F>,
    /// |A|, row after row.
    pub a: Vec<f64>,
    /// η
    pub eta: Vec<f64>,
    /// How far each dimension takes A, summed.
    pub by_dimension: Vec<f64>,
}

/// Largest share of the box that its image takes.
pub fn image_ratio(image: &[f64], box_of: &[f64]) -> f64 {
    let pairs = image.iter().zip(box_of);
    pairs.map(|(y, w)| y / w).fold(0.0, f64::max)
}

impl<F> Mapped<F> {
    /// η + |A| w
    pub fn image(&self, w: &[f64]) -> Vec<f64> {
        let moved = self.times(w);
        let pairs = self.eta.iter().zip(moved);
        pairs.map(|(eta, moved)| (eta + moved) * GROW).collect()
    }

    /// |A| w
    pub fn times(&self, w: &[f64]) -> Vec<f64> {
        let rows = self.a.chunks_exact(w.len().max(1));
        rows.map(|row| row.iter().zip(w).map(|(a, w)| a * w).sum::<f64>() * GROW)
            .collect()
    }

    /// A bound of all y ≥ 0 with y ≤ from + |A| y, where the box is mapped into itself.
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

    /// The dimension that takes A farthest from zero.
    pub fn farthest(&self) -> Option<usize> {
        let all = self.by_dimension.iter().enumerate();
        all.max_by(|a, b| a.1.total_cmp(b.1)).map(|(k, _)| k)
    }
}
