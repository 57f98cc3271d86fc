//! The simplex method on a dense table, with Bland's rule against cycling: small programmes in plain f64.

/// What a programme gives.
#[derive(Clone, Debug, PartialEq)]
pub enum ProgrammeResult {
    /// No point satisfies all rows.
    Infeasible,
    /// The objective is unbounded.
    Unbounded,
    /// The greatest value and its point.
    Optimal {
        /// Of the objective.
        value: f64,
        /// The point.
        x: Vec<f64>,
    },
}

/// Entries below this, relative to the largest of all, are rounding.
const SMALL: f64 = 1e-11;

/// The tableau of a programme: rows of constraints, the objective last; right-hand sides in the last column.
struct SimplexTable {
    cells: Vec<Vec<f64>>,
    basis: Vec<usize>,
    slack: f64,
}

/// The greatest `objective` · x for x ≥ 0 with `rows` · x ≤ `sides`.
pub fn maximise(objective: &[f64], rows: &[Vec<f64>], sides: &[f64]) -> ProgrammeResult {
    let (n, m) = (objective.len(), rows.len());
    let largest = rows
        .iter()
        .flatten()
        .chain(sides)
        .fold(1.0_f64, |s, v| s.max(v.abs()));
    // One more variable is subtracted from every row: when it equals the largest violation, the point is feasible.
    let mut table = SimplexTable {
        cells: Vec::with_capacity(m + 1),
        basis: (n..n + m).collect(),
        slack: SMALL * largest,
    };
    let width = n + m + 2;
    for (i, (row, side)) in rows.iter().zip(sides).enumerate() {
        let mut cells = vec![0.0; width];
        cells[..n].copy_from_slice(row);
        cells[n + i] = 1.0;
        cells[n + m] = -1.0;
        cells[width - 1] = *side;
        table.cells.push(cells);
    }
    let worst = (0..m).min_by(|i, j| sides[*i].total_cmp(&sides[*j]));
    if let Some(worst) = worst.filter(|i| sides[*i] < 0.0) {
        let mut shortage = vec![0.0; width];
        shortage[n + m] = 1.0;
        table.cells.push(shortage);
        table.exchange_pivot(worst, n + m);
        if !table.run(width - 1) {
            return ProgrammeResult::Infeasible;
        }
        let left = table
            .cells
            .pop()
            .and_then(|row| row.last().copied())
            .unwrap_or(0.0);
        if left.abs() > table.slack {
            return ProgrammeResult::Infeasible;
        }
        table.drive_out(n + m);
    }
    let mut last: Vec<f64> = objective.iter().map(|c| -c).collect();
    last.resize(width, 0.0);
    for (i, column) in table.basis.iter().enumerate() {
        let factor = last[*column];
        if factor != 0.0 {
            last.iter_mut()
                .zip(&table.cells[i])
                .for_each(|(l, c)| *l -= factor * c);
        }
    }
    table.cells.push(last);
    // The shortage stays out.
    if !table.run(n + m) {
        return ProgrammeResult::Unbounded;
    }
    let mut x = vec![0.0; n];
    for (i, column) in table.basis.iter().enumerate() {
        if *column < n {
            x[*column] = table.cells[i][width - 1];
        }
    }
    let value = objective.iter().zip(&x).map(|(c, x)| c * x).sum();
    ProgrammeResult::Optimal { value, x }
}

impl SimplexTable {
    /// Improves the objective by the first `columns`; false if it is unbounded.
    fn run(&mut self, columns: usize) -> bool {
        let m = self.basis.len();
        loop {
            let objective = &self.cells[m];
            let scale = objective.iter().fold(1.0_f64, |s, v| s.max(v.abs()));
            // Bland's rule: the first column that improves the objective, ...
            let entering = (0..columns).find(|j| objective[*j] < -SMALL * scale);
            let Some(entering) = entering else {
                return true;
            };
            let side = self.cells[m].len() - 1;
            let rows = (0..m).filter(|i| self.cells[*i][entering] > self.slack);
            let ratio = |i: &usize| self.cells[*i][side] / self.cells[*i][entering];
            // ... and among rows with equal ratios the one whose variable has the lowest number.
            let leaving = rows.min_by(|i, j| {
                let order = ratio(i).total_cmp(&ratio(j));
                order.then(self.basis[*i].cmp(&self.basis[*j]))
            });
            let Some(leaving) = leaving else { return false };
            self.exchange_pivot(leaving, entering);
        }
    }

    fn exchange_pivot(&mut self, row: usize, column: usize) {
        let by = self.cells[row][column];
        self.cells[row].iter_mut().for_each(|c| *c /= by);
        let pivot = self.cells[row].clone();
        for (i, cells) in self.cells.iter_mut().enumerate() {
            let factor = cells[column];
            if i != row && factor != 0.0 {
                cells
                    .iter_mut()
                    .zip(&pivot)
                    .for_each(|(c, p)| *c -= factor * p);
            }
        }
        self.basis[row] = column;
    }

    /// Takes a variable that is zero out of the basis.
    fn drive_out(&mut self, column: usize) {
        if let Some(row) = self.basis.iter().position(|b| *b == column) {
            let entering = (0..column).find(|j| self.cells[row][*j].abs() > self.slack);
            if let Some(entering) = entering {
                self.exchange_pivot(row, entering);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_programmes_are_solved() {
        let rows = vec![vec![1.0, 1.0], vec![1.0, 3.0]];
        let found = maximise(&[3.0, 2.0], &rows, &[4.0, 6.0]);
        assert_eq!(
            found,
            ProgrammeResult::Optimal {
                value: 12.0,
                x: vec![4.0, 0.0]
            }
        );
        // x ≥ 1, x ≤ 3, least x.
        let rows = vec![vec![-1.0], vec![1.0]];
        let found = maximise(&[-1.0], &rows, &[-1.0, 3.0]);
        assert_eq!(
            found,
            ProgrammeResult::Optimal {
                value: -1.0,
                x: vec![1.0]
            }
        );
        assert_eq!(
            maximise(&[1.0], &rows, &[-4.0, 3.0]),
            ProgrammeResult::Infeasible
        );
        assert_eq!(
            maximise(&[1.0], &[vec![-1.0]], &[-1.0]),
            ProgrammeResult::Unbounded
        );
    }
}
