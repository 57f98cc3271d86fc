//! The inverse of the Jacobian as a polynomial along a path.

use super::proof::Workspace;
use crate::linalg::lanes::{Lanes, combine_rows, lane_groups};

impl Workspace {
    /// R₀ and, from it, R₁ = -R₀ J₁ R₀ and R₂ = -R₀ (J₂ R₀ + J₁ R₁).
    pub(super) fn follow_inverse(&mut self) {
        let (n, width) = (self.n, lane_groups(self.n));
        let all = self.inverse_terms * n;
        let mut factors = vec![0.0; n * all];
        for (i, row) in factors.chunks_exact_mut(all).enumerate() {
            row[..n].copy_from_slice(&self.inverse.row(i).as_flattened()[..n]);
        }
        if self.terms == 1 {
            // A constant matrix has one inverse.
            self.factors = factors;
            return;
        }
        let mut product = vec![[0.0; 4]; self.stride];
        let times = |row: &[f64], k: usize, product: &mut Vec<Lanes>| {
            combine_rows(product, row, &self.coefficients_from(k)[..n * self.stride]);
        };
        let mut first = vec![[0.0; 4]; n * width];
        let mut sum = vec![[0.0; 4]; width];
        let mut bent = vec![0.0; 2 * n];
        for i in 0..n {
            let row: Vec<f64> = factors[i * all..i * all + n].to_vec();
            times(&row, 1, &mut product);
            combine_rows(
                &mut sum,
                &product.as_flattened()[..n],
                self.inverse.groups(),
            );
            first[i * width..(i + 1) * width].copy_from_slice(&sum);
            for (f, s) in factors[i * all + n..].iter_mut().zip(sum.as_flattened()) {
                *f = -s;
            }
            // The next coefficient needs R₁ as a whole.
            factors[i * all + 2 * n..(i + 1) * all].fill(0.0);
        }
        let mut both = Vec::with_capacity(2 * n * width);
        both.extend_from_slice(self.inverse.groups());
        both.extend(first.iter().map(|g| g.map(|v| -v)));
        for i in 0..n {
            let row: Vec<f64> = factors[i * all..i * all + n].to_vec();
            times(&row, 2, &mut product);
            bent[..n].copy_from_slice(&product.as_flattened()[..n]);
            times(&row, 1, &mut product);
            bent[n..].copy_from_slice(&product.as_flattened()[..n]);
            combine_rows(&mut sum, &bent, &both);
            for (f, s) in factors[i * all + 2 * n..(i + 1) * all]
                .iter_mut()
                .zip(sum.as_flattened())
            {
                *f = -s;
            }
        }
        self.factors = factors;
    }
}
