//! Rows of small dense matrices in groups of four numbers, four at a time.
//!
//! Rows are padded with zeros to whole groups. Sums run in a fixed order, so that results are the same everywhere.

use wide::f64x4;

/// Four neighbours of a row.
pub type Lanes = [f64; 4];

/// The same number in all lanes. Inlined wherever code is made for size, too: `f64x4::splat` is a sixth of a live page's time.
#[inline(always)]
pub fn all_lanes(value: f64) -> f64x4 {
    f64x4::new([value; 4])
}

/// Number of groups in a row of `length` numbers.
#[inline]
pub fn lane_groups(length: usize) -> usize {
    length.div_ceil(4)
}

/// `target += factor · row`.
#[inline]
pub fn add_scaled(target: &mut [Lanes], factor: f64, row: &[Lanes]) {
    let factor = all_lanes(factor);
    for (t, r) in target.iter_mut().zip(row) {
        *t = (f64x4::new(*t) + factor * f64x4::new(*r)).to_array();
    }
}

/// The scalar product.
#[inline]
pub fn dot_lanes(a: &[Lanes], b: &[Lanes]) -> f64 {
    let mut sums = f64x4::ZERO;
    for (a, b) in a.iter().zip(b) {
        sums += f64x4::new(*a) * f64x4::new(*b);
    }
    lane_sum(sums.to_array())
}

/// Sum of the squares of differences, four at a time.
#[inline]
pub fn square_of_difference(a: &[f64], b: &[f64]) -> f64 {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<4>(), b.as_chunks::<4>());
    let mut sums = [f64x4::ZERO; 2];
    for (k, (a, b)) in a.iter().zip(b).enumerate() {
        let difference = f64x4::new(*a) - f64x4::new(*b);
        sums[k % 2] += difference * difference;
    }
    let rest = a_rest.iter().zip(b_rest).map(|(a, b)| (a - b) * (a - b));
    lane_sum((sums[0] + sums[1]).to_array()) + rest.sum::<f64>()
}

/// Adds the squares of a row.
#[inline]
pub fn add_squares(sums: &mut [Lanes], row: &[Lanes]) {
    for (sum, r) in sums.iter_mut().zip(row) {
        let r = f64x4::new(*r);
        *sum = (f64x4::new(*sum) + r * r).to_array();
    }
}

/// `target · factor`.
#[inline]
pub fn scale_lanes(target: &mut [Lanes], factor: f64) {
    let factor = all_lanes(factor);
    for t in target {
        *t = (f64x4::new(*t) * factor).to_array();
    }
}

/// `target = Σ factorₖ · rowₖ` over rows as long as the target.
#[inline]
pub fn combine_rows(target: &mut [Lanes], factors: &[f64], rows: &[Lanes]) {
    // The usual lengths by themselves, so that the sums stay in registers.
    match target.len() {
        1 => combine_fixed::<1>(target, factors, rows),
        2 => combine_fixed::<2>(target, factors, rows),
        3 => combine_fixed::<3>(target, factors, rows),
        4 => combine_fixed::<4>(target, factors, rows),
        length => {
            target.fill([0.0; 4]);
            for (factor, row) in factors.iter().zip(rows.chunks_exact(length.max(1))) {
                add_scaled(target, *factor, row);
            }
        }
    }
}

#[inline(always)]
fn combine_fixed<const G: usize>(target: &mut [Lanes], factors: &[f64], rows: &[Lanes]) {
    // The sums stay in registers.
    let mut sums = [f64x4::ZERO; G];
    for (factor, row) in factors.iter().zip(rows.as_chunks::<G>().0) {
        let factor = all_lanes(*factor);
        for g in 0..G {
            sums[g] += factor * f64x4::new(row[g]);
        }
    }
    for (t, sum) in target.iter_mut().zip(sums) {
        *t = sum.to_array();
    }
}

/// Puts zero into every row's entry `column` and subtracts the pivot's row times what was there.
pub fn clear_column(rows: &mut [Lanes], pivot_row: &[Lanes], column: usize) {
    for row in rows.chunks_exact_mut(pivot_row.len().max(1)) {
        let factor = std::mem::take(&mut row[column / 4][column % 4]);
        add_scaled(row, -factor, pivot_row);
    }
}

/// The sum of a group.
#[inline]
pub fn lane_sum(lanes: Lanes) -> f64 {
    (lanes[0] + lanes[2]) + (lanes[1] + lanes[3])
}

/// A row-major matrix in reusable storage.
#[derive(Clone, Debug, Default)]
pub struct LaneMatrix {
    stride: usize,
    entries: Vec<Lanes>,
}

impl LaneMatrix {
    /// Makes it a matrix of zeros.
    pub fn reset(&mut self, rows: usize, columns: usize) {
        self.stride = lane_groups(columns);
        self.entries.clear();
        self.entries.resize(rows * self.stride, [0.0; 4]);
    }

    /// Sets its shape; its content is then undefined.
    pub fn reshape(&mut self, rows: usize, columns: usize) {
        self.stride = lane_groups(columns);
        self.entries.resize(rows * self.stride, [0.0; 4]);
    }

    /// Copies the transpose of the first `rows` × `columns` entries of a matrix.
    pub fn copy_transposed(&mut self, a: &Self, rows: usize, columns: usize) {
        self.reset(columns, rows);
        for i in 0..rows {
            for j in 0..columns {
                *self.at_mut(j, i) = a.at(i, j);
            }
        }
    }

    /// Copies another matrix without new storage.
    pub fn copy(&mut self, other: &Self) {
        self.stride = other.stride;
        self.entries.clear();
        self.entries.extend_from_slice(&other.entries);
    }

    /// Takes over a column-major matrix.
    pub fn copy_columns(&mut self, a: &[f64], rows: usize, columns: usize) {
        self.reset(rows, columns);
        self.copy_columns_into(&a[..rows * columns], rows);
    }

    /// Writes the columns of a column-major matrix over its own first ones.
    pub fn copy_columns_into(&mut self, a: &[f64], rows: usize) {
        for (j, column) in a.chunks_exact(rows.max(1)).enumerate() {
            let groups = self.entries[j / 4..].iter_mut().step_by(self.stride);
            for (group, value) in groups.zip(column) {
                group[j % 4] = *value;
            }
        }
    }

    /// Takes over a row-major matrix: the transpose of a column-major one.
    pub fn copy_rows(&mut self, a: &[f64], rows: usize, columns: usize) {
        if columns.is_multiple_of(4) {
            self.reshape(rows, columns);
            self.entries
                .as_flattened_mut()
                .copy_from_slice(&a[..rows * columns]);
            return;
        }
        self.reset(rows, columns);
        let stride = self.stride.max(1);
        let targets = self.entries.chunks_exact_mut(stride);
        for (target, row) in targets.zip(a.chunks_exact(columns.max(1))) {
            target.as_flattened_mut()[..columns].copy_from_slice(row);
        }
    }

    /// An entry.
    #[inline]
    pub fn at(&self, row: usize, column: usize) -> f64 {
        self.entries[row * self.stride + column / 4][column % 4]
    }

    /// A place to write an entry.
    #[inline]
    pub fn at_mut(&mut self, row: usize, column: usize) -> &mut f64 {
        &mut self.entries[row * self.stride + column / 4][column % 4]
    }

    /// A row.
    #[inline]
    pub fn row(&self, row: usize) -> &[Lanes] {
        &self.entries[row * self.stride..(row + 1) * self.stride]
    }

    /// A row to change.
    #[inline]
    pub fn row_mut(&mut self, row: usize) -> &mut [Lanes] {
        &mut self.entries[row * self.stride..(row + 1) * self.stride]
    }

    /// The rows in order.
    #[inline]
    pub fn rows(&self) -> std::slice::ChunksExact<'_, Lanes> {
        self.entries.chunks_exact(self.stride.max(1))
    }

    /// The rows in order, to change.
    #[inline]
    pub fn rows_mut(&mut self) -> std::slice::ChunksExactMut<'_, Lanes> {
        self.entries.chunks_exact_mut(self.stride.max(1))
    }

    /// The rows of a matrix whose stride is `G`.
    #[inline]
    pub fn fixed_rows<const G: usize>(&mut self) -> &mut [[Lanes; G]] {
        self.entries.as_chunks_mut().0
    }

    /// All rows, one after the other.
    #[inline]
    pub fn groups(&self) -> &[Lanes] {
        &self.entries
    }

    /// The same to change.
    #[inline]
    pub fn groups_mut(&mut self) -> &mut [Lanes] {
        &mut self.entries
    }

    /// The rows up to `row`, and those from it on.
    #[inline]
    pub fn split_at_row(&mut self, row: usize) -> (&mut [Lanes], &mut [Lanes]) {
        self.entries.split_at_mut(row * self.stride)
    }

    /// Groups in a row.
    #[inline]
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// Exchanges two columns.
    pub fn swap_columns(&mut self, a: usize, b: usize) {
        for row in self.entries.chunks_exact_mut(self.stride) {
            let left = row[a / 4][a % 4];
            row[a / 4][a % 4] = row[b / 4][b % 4];
            row[b / 4][b % 4] = left;
        }
    }

    /// Exchanges two rows.
    pub fn swap_rows(&mut self, a: usize, b: usize) {
        if a != b {
            let (low, high) = (a.min(b), a.max(b));
            let stride = self.stride;
            let (upper, lower) = self.split_at_row(high);
            upper[low * stride..(low + 1) * stride].swap_with_slice(&mut lower[..stride]);
        }
    }

    /// The product with a vector, row by row.
    #[inline]
    pub fn times<'a>(&'a self, x: &'a [Lanes]) -> impl Iterator<Item = f64> + 'a {
        self.rows().map(move |row| dot_lanes(row, x))
    }
}

/// Writes numbers into padded groups.
#[inline]
pub fn pack_lanes(target: &mut Vec<Lanes>, values: impl Iterator<Item = f64>) {
    target.clear();
    for (k, value) in values.enumerate() {
        if k % 4 == 0 {
            target.push([0.0; 4]);
        }
        if let Some(last) = target.last_mut() {
            last[k % 4] = value;
        }
    }
}
