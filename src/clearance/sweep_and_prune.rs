//! Finds the pairs of near boxes among many: they are sorted along an axis, and each is compared with those that it may
//! still meet there (sweep and prune: Cohen, Lin, Manocha and Ponamgi, I-COLLIDE, 1995).

use crate::sorting::sort_by_number;
use glam::DVec3;

/// A box along the axes of the world.
#[derive(Clone, Copy, Debug)]
pub struct AxisBox {
    /// Least coordinates.
    pub low: DVec3,
    /// Greatest coordinates.
    pub high: DVec3,
}

impl AxisBox {
    /// All of space.
    pub const EVERYWHERE: Self = Self {
        low: DVec3::NEG_INFINITY,
        high: DVec3::INFINITY,
    };

    /// The box around two.
    pub fn around(&self, other: &Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    /// Whether it has an end on every side.
    pub fn is_finite(&self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }

    /// Distance of two boxes; zero where they meet.
    pub fn apart(&self, other: &Self) -> f64 {
        let gap = (self.low - other.high).max(other.low - self.high);
        gap.max(DVec3::ZERO).length()
    }
}

/// Calls `meet` with the indices of all pairs of boxes that are at most this far apart, until it returns `false`.
pub fn near_boxes(boxes: &[AxisBox], apart: f64, mut meet: impl FnMut([usize; 2]) -> bool) {
    let axis = widest_axis(boxes);
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    sort_by_number(&mut order, |a| boxes[*a].low[axis]);
    let mut open: Vec<usize> = Vec::new();
    for k in order {
        let here = &boxes[k];
        // Boxes that end before this one begins are dropped.
        open.retain(|j| here.low[axis] - boxes[*j].high[axis] <= apart);
        for &j in &open {
            if boxes[j].apart(here) <= apart && !meet([j, k]) {
                return;
            }
        }
        open.push(k);
    }
}

/// The axis along which boxes lie farthest apart.
fn widest_axis(boxes: &[AxisBox]) -> usize {
    let finite = boxes.iter().filter(|b| b.is_finite()).copied();
    let all = finite.reduce(|a, b| a.around(&b));
    let edges = all.map_or(DVec3::ZERO, |b| b.high - b.low);
    edges.max_position()
}
