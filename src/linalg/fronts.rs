//! Ranks of large sparse matrices whose columns come in groups: dense factors of one group at a time.
//!
//! Every group has a front: the rows that begin in it. A pivoted QR on the group's own columns takes as many pivots as
//! there are independent ones; the remaining rows concern later groups only, and pass on to the front of the first of
//! them (Davis, Algorithm 915: SuiteSparseQR, ACM TOMS 38, 2011). The pivots' rows are kept in echelon form, so that
//! further rows can be reduced by them.

use super::pivoted_qr::PivotedQr;
use crate::sorting::sort_by_key;
use std::collections::BTreeMap;

/// Column and value of the entries of a row.
pub type SparseRow = Vec<(usize, f64)>;

/// The row space of a matrix.
#[derive(Clone, Debug)]
pub struct Fronts {
    /// Front of every column; rows pass from lower fronts to higher ones.
    front_of: Vec<usize>,
    /// Numbers below this count as zero.
    least: f64,
    /// Index of each column's pivot.
    pivot_of: Vec<Option<usize>>,
    /// Entries of the pivots' rows beside the pivots, which are one.
    rows: Vec<SparseRow>,
    qr: PivotedQr,
}

/// The rows of a front, dense.
struct DenseFront {
    /// Its own columns, then those of later fronts.
    columns: Vec<usize>,
    /// Number of its own columns.
    own: usize,
    /// Column-major.
    entries: Vec<f64>,
    rows: usize,
}

impl Fronts {
    /// The space of `rows`, whose columns belong to the fronts `front_of`. Pivots are at least `tolerance` times the
    /// longest row. Rows with NaN are ignored.
    pub fn new(rows: Vec<SparseRow>, front_of: Vec<usize>, tolerance: f64) -> Self {
        let known = |row: &SparseRow| row.iter().all(|(_, v)| v.is_finite());
        let rows: Vec<SparseRow> = rows.into_iter().filter(known).collect();
        let longest = rows.iter().map(|row| length_of(row)).fold(0.0, f64::max);
        let count = front_of.iter().max().map_or(0, |last| last + 1);
        let mut fronts = Self {
            pivot_of: vec![None; front_of.len()],
            front_of,
            least: tolerance * longest,
            rows: Vec::new(),
            qr: PivotedQr::default(),
        };
        let mut waiting = vec![Vec::new(); count];
        fronts.distribute_rows(rows, &mut waiting);
        // Multifrontal elimination: the rows that a front cannot eliminate pass on to a later one.
        for front in 0..count {
            let rows = std::mem::take(&mut waiting[front]);
            let left = fronts.eliminate_front(front, &rows);
            fronts.distribute_rows(left, &mut waiting);
        }
        fronts
    }

    /// Number of independent rows so far.
    pub fn rank(&self) -> usize {
        self.rows.len()
    }

    /// Adds a row; returns whether it is independent of those before it.
    pub fn add(&mut self, row: &[(usize, f64)]) -> bool {
        if !row.iter().all(|(_, v)| v.is_finite()) {
            return false;
        }
        let rest = self.reduced_row(row);
        // The largest remaining entry becomes the pivot; a row without one is dependent.
        let largest = rest.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        let Some(&(column, pivot)) = largest.filter(|e| e.1.abs() > self.least) else {
            return false;
        };
        let others = rest.iter().filter(|e| e.0 != column);
        self.keep_pivot(column, others.map(|(c, v)| (*c, v / pivot)).collect());
        true
    }

    fn keep_pivot(&mut self, column: usize, others: SparseRow) {
        self.pivot_of[column] = Some(self.rows.len());
        self.rows.push(others);
    }

    /// What is left of a row in columns without a pivot. A pivot's row has entries in columns of later pivots only.
    fn reduced_row(&self, row: &[(usize, f64)]) -> SparseRow {
        let mut left = BTreeMap::new();
        let mut free = BTreeMap::new();
        let mut add = |column: usize, value: f64, left: &mut BTreeMap<usize, f64>| match self
            .pivot_of[column]
        {
            Some(pivot) => *left.entry(pivot).or_insert(0.0) += value,
            None => *free.entry(column).or_insert(0.0) += value,
        };
        row.iter().for_each(|(c, v)| add(*c, *v, &mut left));
        // Pivots in ascending order: each can only bring entries of later ones.
        while let Some((pivot, value)) = left.pop_first() {
            let others = self.rows[pivot].iter().filter(|_| value != 0.0);
            others.for_each(|(c, v)| add(*c, -value * v, &mut left));
        }
        free.into_iter().collect()
    }

    /// Assigns every row to its front.
    fn distribute_rows(&self, rows: Vec<SparseRow>, waiting: &mut [Vec<SparseRow>]) {
        for mut row in rows {
            row.retain(|(_, v)| v.abs() > self.least);
            let begins = row.iter().map(|(column, _)| self.front_of[*column]).min();
            if let Some(front) = begins {
                waiting[front].push(row);
            }
        }
    }

    /// Eliminates the pivots of a front; the remaining rows have entries in later fronts only.
    fn eliminate_front(&mut self, front: usize, rows: &[SparseRow]) -> Vec<SparseRow> {
        let dense = DenseFront::new(rows, |column| self.front_of[column] == front);
        let height = dense.rows;
        let own = &dense.entries[..height * dense.own];
        let squares = own.chunks(height.max(1));
        let longest = squares.map(|c| c.iter().map(|v| v * v).sum::<f64>().sqrt());
        let longest = longest.fold(0.0, f64::max);
        if longest <= self.least {
            return Vec::new();
        }
        // Householder QR of its own columns; the tolerance is relative to the longest of them.
        self.qr.factor(own, height, dense.own, self.least / longest);
        let rank = self.qr.rank();
        let order = self.qr.column_order()[..rank].to_vec();
        let mut kept = vec![Vec::new(); rank];
        let mut left = vec![Vec::new(); height - rank];
        let (mut right_side, mut solution) = (Vec::new(), vec![0.0; dense.own]);
        let pivots: Vec<bool> = (0..dense.own).map(|j| order.contains(&j)).collect();
        for (j, column) in dense.columns.iter().enumerate() {
            if pivots.get(j).is_some_and(|is_pivot| *is_pivot) {
                continue;
            }
            right_side.clear();
            right_side.extend_from_slice(&dense.entries[j * height..(j + 1) * height]);
            self.qr.solve(&mut right_side, &mut solution);
            for (row, place) in kept.iter_mut().zip(&order) {
                if solution[*place] != 0.0 {
                    row.push((*column, solution[*place]));
                }
            }
            // Nothing remains of its own columns.
            for (row, value) in left.iter_mut().zip(&right_side[rank..]) {
                if j >= dense.own {
                    row.push((*column, *value));
                }
            }
        }
        for (row, place) in kept.into_iter().zip(&order) {
            self.keep_pivot(dense.columns[*place], row);
        }
        left
    }
}

impl DenseFront {
    fn new(rows: &[SparseRow], is_own: impl Fn(usize) -> bool) -> Self {
        let mut columns: Vec<usize> = rows.iter().flatten().map(|entry| entry.0).collect();
        sort_by_key(&mut columns, |column| (!is_own(*column), *column));
        columns.dedup();
        // The front's own columns come first.
        let own = columns.partition_point(|column| is_own(*column));
        let place: BTreeMap<usize, usize> = columns.iter().copied().zip(0..).collect();
        let mut entries = vec![0.0; rows.len() * columns.len()];
        for (i, row) in rows.iter().enumerate() {
            for (column, value) in row {
                entries[place[column] * rows.len() + i] = *value;
            }
        }
        Self {
            columns,
            own,
            entries,
            rows: rows.len(),
        }
    }
}

fn length_of(row: &[(usize, f64)]) -> f64 {
    row.iter().map(|(_, v)| v * v).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOLERANCE: f64 = 1e-9;

    /// Numbers in -1..1, the same in every run.
    fn random_numbers(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
        move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
    }

    /// Rows that begin in groups of three columns and end in the last ones, every fifth a sum of others.
    fn dependent_rows(count: usize, columns: usize, seed: u64) -> Vec<SparseRow> {
        let mut number = random_numbers(seed);
        let mut list: Vec<SparseRow> = Vec::new();
        for k in 0..count {
            let row: SparseRow = if k % 5 == 4 {
                let mut sum = BTreeMap::new();
                for (other, factor) in [(k - 1, 0.7), (k - 3, -1.3)] {
                    for (c, v) in &list[other] {
                        *sum.entry(*c).or_insert(0.0) += factor * v;
                    }
                }
                sum.into_iter().collect()
            } else {
                let first = 3 * (k / 4) % columns;
                let places = [
                    first,
                    first + 1,
                    first + 2,
                    (first + 7) % columns,
                    columns - 1,
                ];
                let mut places: Vec<usize> = places.map(|c| c.min(columns - 1)).to_vec();
                places.sort_unstable();
                places.dedup();
                places.into_iter().map(|c| (c, number())).collect()
            };
            list.push(row);
        }
        list
    }

    fn dense_rank(rows: &[SparseRow], columns: usize) -> usize {
        let mut all = vec![0.0; rows.len() * columns];
        for (i, row) in rows.iter().enumerate() {
            row.iter().for_each(|(c, v)| all[i * columns + c] += v);
        }
        let mut qr = PivotedQr::default();
        qr.factor(&all, columns, rows.len(), TOLERANCE);
        qr.rank()
    }

    #[test]
    fn the_rank_is_that_of_the_dense_matrix_whatever_the_groups() {
        for seed in 1..60 {
            let columns = 6 + (seed as usize * 5) % 30;
            let rows = dependent_rows(5 + (seed as usize * 7) % 60, columns, seed);
            let wanted = dense_rank(&rows, columns);
            for width in [1, 3, 8, 100] {
                let front_of = (0..columns).map(|c| c / width).collect();
                let found = Fronts::new(rows.clone(), front_of, TOLERANCE).rank();
                assert_eq!(found, wanted, "{seed} {width}");
            }
            let backward = (0..columns).map(|c| (columns - c) / 3).collect();
            assert_eq!(
                Fronts::new(rows.clone(), backward, TOLERANCE).rank(),
                wanted
            );
        }
    }

    #[test]
    fn rows_one_by_one_are_judged_as_all_at_once() {
        for seed in 1..60 {
            let columns = 6 + (seed as usize * 5) % 30;
            let rows = dependent_rows(40, columns, seed);
            let first = 10 + seed as usize % 20;
            let front_of = (0..columns).map(|c| c / 3).collect();
            let mut fronts = Fronts::new(rows[..first].to_vec(), front_of, TOLERANCE);
            for count in first..rows.len() {
                let before = dense_rank(&rows[..count], columns);
                let is_new = dense_rank(&rows[..=count], columns) > before;
                assert_eq!(fronts.rank(), before, "{seed} {count}");
                assert_eq!(fronts.add(&rows[count]), is_new, "{seed} {count}");
            }
        }
    }

    #[test]
    fn what_is_no_number_or_nothing_has_no_rank() {
        let rows = vec![vec![(0, f64::NAN), (1, 1.0)], vec![], vec![(1, 0.0)]];
        let mut fronts = Fronts::new(rows, vec![0, 1], TOLERANCE);
        assert_eq!(fronts.rank(), 0);
        assert!(!fronts.add(&[(0, f64::INFINITY)]));
        assert!(fronts.add(&[(0, 1e-3)]) && !fronts.add(&[(0, 2.0)]));
    }
}
