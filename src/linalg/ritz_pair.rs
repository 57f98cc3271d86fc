//! The largest eigenvalue of a symmetric matrix whose second largest is near it, by iteration of two vectors.
//!
//! Rayleigh-Ritz on the span of two vectors gives values θ₁ ≥ θ₂ and the residual ρ of both together. Let C be the matrix
//! compressed to the complement of the span. By the pinching inequality, tr C⁴ ≤ tr G⁴ - θ₁⁴ - θ₂⁴, whose fourth root c
//! bounds the eigenvalues of C. The largest eigenvalue of G is then at most that of the 2 × 2 matrix (θ₁ ρ; ρ c), which is at
//! most θ₁ + ρ² / (θ₁ - c). The second eigenvalue need not be known.

use super::lanes::{LaneMatrix, Lanes, add_scaled, combine_rows, dot_lanes, scale_lanes};

/// Most iterations: where the third eigenvalue is near as well, a decomposition is cheaper.
const MOST_ITERATIONS: usize = 24;

/// Two vectors, kept as the start of the next search.
#[derive(Clone, Debug, Default)]
pub struct RitzPair {
    vectors: [Vec<Lanes>; 2],
    images: [Vec<Lanes>; 2],
}

impl RitzPair {
    /// The two largest Ritz values of the symmetric matrix G, the first of which is its largest eigenvalue to a relative error of
    /// `error` at most; `None` if it is not found. It starts near `first`, or where the last search ended. `fourth` is the sum of
    /// the fourth powers of all eigenvalues, and the third one is less than `share` of the first.
    pub fn largest(
        &mut self,
        gram: &LaneMatrix,
        first: Option<&[Lanes]>,
        fourth: f64,
        [share, error]: [f64; 2],
    ) -> Option<[f64; 2]> {
        let size = gram.rows().len();
        if let Some(first) = first {
            self.vectors[0].clear();
            self.vectors[0].extend_from_slice(first);
        }
        if self.vectors[0].len() != gram.stride() {
            return None;
        }
        self.start(size);
        for _ in 0..MOST_ITERATIONS {
            for (image, vector) in self.images.iter_mut().zip(&self.vectors) {
                image.resize(vector.len(), [0.0; 4]);
                combine_rows(image, &vector.as_flattened()[..size], gram.groups());
            }
            let ([u, w], [of_u, of_w]) = (&self.vectors, &self.images);
            let (a, b, d) = (dot_lanes(u, of_u), dot_lanes(u, of_w), dot_lanes(w, of_w));
            // Ritz values, and the cosine and sine of the turn to their vectors.
            let (middle, half) = (0.5 * (a + d), (0.25 * (a - d) * (a - d) + b * b).sqrt());
            let (high, low) = (middle + half, middle - half);
            let squares = dot_lanes(of_u, of_u) + dot_lanes(of_w, of_w);
            // By Pythagoras, rounding included.
            let residual =
                (squares - (high * high + low * low)).abs() + 8.0 * f64::EPSILON * squares;
            let others = (fourth - high.powi(4) - low.powi(4)).max(0.0).sqrt().sqrt();
            if !(high > 0.0 && residual.is_finite()) {
                return None;
            }
            if others <= share * high && residual <= error * high * (high - others) {
                return Some([high, low]);
            }
            let cosine = match half > 0.0 {
                true => (0.5 + 0.25 * (a - d) / half).max(0.0).sqrt(),
                false => 1.0,
            };
            let sine = (1.0 - cosine * cosine).max(0.0).sqrt().copysign(b);
            self.turn([cosine, sine]);
        }
        None
    }

    /// The second vector is that of the last search where it is usable.
    fn start(&mut self, size: usize) {
        let [u, w] = &mut self.vectors;
        let is_known = w.len() == u.len() && dot_lanes(w, w) > 0.5;
        if !is_known {
            // Any vector that is not the first.
            w.clone_from(u);
            let entries = &mut w.as_flattened_mut()[..size];
            entries.reverse();
            entries.iter_mut().step_by(2).for_each(|v| *v = -*v);
        }
        self.separate();
    }

    /// The images, turned to the directions of the Ritz vectors, become the vectors.
    fn turn(&mut self, [cosine, sine]: [f64; 2]) {
        let ([u, w], [of_u, of_w]) = (&mut self.vectors, &self.images);
        for (target, factors) in [(u, [cosine, sine]), (w, [-sine, cosine])] {
            target.fill([0.0; 4]);
            add_scaled(target, factors[0], of_u);
            add_scaled(target, factors[1], of_w);
        }
        self.separate();
    }

    /// Makes both vectors unit vectors and the second one perpendicular to the first, twice for the sake of rounding.
    fn separate(&mut self) {
        let [u, w] = &mut self.vectors;
        let unit = |v: &mut Vec<Lanes>| {
            let length = dot_lanes(v, v).sqrt();
            scale_lanes(v, 1.0 / length);
        };
        unit(u);
        for _ in 0..2 {
            unit(w);
            let along = dot_lanes(u, w);
            add_scaled(w, -along, u);
        }
        unit(w);
    }
}
