//! Solves the system of a sequence of dyads point by point, which makes a trial of random directions cheap.
//!
//! v = v'' + J (v' - v''), and J is a product of two vectors, n eᵀ / (e × f). A few points are parameters, so that all
//! others follow one after the other as affine functions of them; the remaining dyads close the system.

use super::chain::DyadChain;
use super::dyad::Dyad;

/// Most parameters: two for every point from which the others are computed.
pub const MOST_PARAMETERS: usize = 8;

/// Columns of an affine function: its parameters, then the constant.
const WIDTH: usize = MOST_PARAMETERS + 1;

/// A point as an affine function of the parameters.
type AffinePlace = [[f64; WIDTH]; 2];

/// The two vectors of a dyad's matrix: e, and n over e × f.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Projector {
    /// Along the first bar, which reads the difference of the ends.
    pub reads: [f64; 2],
    /// Perpendicular to the second, along which the point differs from its end.
    pub moves: [f64; 2],
}

/// The order in which the points of a sequence are computed.
#[derive(Clone, Debug, PartialEq)]
pub struct RowSweep {
    dyads: Vec<Dyad>,
    /// Points that are parameters.
    free: Vec<usize>,
    /// Dyads that determine a point, in order.
    steps: Vec<usize>,
    /// Dyads whose points are already known: closing equations.
    checks: Vec<usize>,
    count: usize,
}

/// A solved trial.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SolvedRow {
    /// Every point.
    pub values: Vec<[f64; 2]>,
    /// Determinant of the closing equations: that of the whole system up to a constant sign.
    pub determinant: f64,
}

impl RowSweep {
    /// Orders a sequence; `None` if more parameters are needed than [`MOST_PARAMETERS`].
    pub fn new(chain: &DyadChain) -> Option<Self> {
        let count = chain.points.len();
        let mut known: Vec<bool> = (0..count).map(|k| chain.fixed.contains(&k)).collect();
        let (given, lever) = (chain.given(), chain.lever[0]);
        known[given] = true;
        let mut free = Vec::new();
        if !std::mem::replace(&mut known[lever], true) {
            free.push(lever);
        }
        let (mut steps, mut checks) = (Vec::new(), Vec::new());
        let mut open: Vec<usize> = (0..chain.dyads.len()).collect();
        while !open.is_empty() {
            let ready = |d: &usize| chain.dyads[*d].ends.iter().all(|end| known[*end]);
            if let Some(place) = open.iter().position(ready) {
                let dyad = open.remove(place);
                let point = chain.dyads[dyad].point;
                match std::mem::replace(&mut known[point], true) {
                    true => checks.push(dyad),
                    false => steps.push(dyad),
                }
                continue;
            }
            // The point that most of the others need.
            let waits = |point: usize| {
                let ends = open.iter().flat_map(|d| chain.dyads[*d].ends);
                ends.filter(|end| *end == point).count()
            };
            let unknown = (0..count).filter(|k| !known[*k]);
            let next = unknown.max_by_key(|k| (waits(*k), std::cmp::Reverse(*k)))?;
            known[next] = true;
            free.push(next);
        }
        let fits = 2 * free.len() <= MOST_PARAMETERS && checks.len() == free.len();
        fits.then(|| Self {
            dyads: chain.dyads.clone(),
            free,
            steps,
            checks,
            count,
        })
    }

    /// Solves for all points; those that are not computed have their `values`. False if the system is singular.
    pub fn solve(
        &self,
        projectors: &[Projector],
        values: &[[f64; 2]],
        places: &mut Vec<AffinePlace>,
        swept: &mut SolvedRow,
    ) -> bool {
        let width = 2 * self.free.len();
        places.clear();
        places.resize(self.count, [[0.0; WIDTH]; 2]);
        for (place, value) in places.iter_mut().zip(values) {
            (place[0][width], place[1][width]) = (value[0], value[1]);
        }
        for (k, point) in self.free.iter().enumerate() {
            places[*point] = [[0.0; WIDTH]; 2];
            places[*point][0][2 * k] = 1.0;
            places[*point][1][2 * k + 1] = 1.0;
        }
        for &index in &self.steps {
            places[self.dyads[index].point] = self.carried_point(index, projectors, places, width);
        }
        // The residuals of the remaining dyads.
        let mut rows = [[0.0; WIDTH]; MOST_PARAMETERS];
        for (k, &index) in self.checks.iter().enumerate() {
            let made = self.carried_point(index, projectors, places, width);
            let own = &places[self.dyads[index].point];
            for axis in 0..2 {
                for c in 0..=width {
                    rows[2 * k + axis][c] = made[axis][c] - own[axis][c];
                }
            }
        }
        let Some((solution, determinant)) = solve_closing(&mut rows, width) else {
            return false;
        };
        swept.determinant = determinant;
        swept.values.clear();
        swept.values.extend(places.iter().map(|place| {
            [0, 1].map(|axis| {
                let terms = place[axis][..width].iter().zip(&solution);
                terms.fold(place[axis][width], |sum, (c, p)| sum + c * p)
            })
        }));
        true
    }

    /// v'' + n (e · (v' - v''))
    fn carried_point(
        &self,
        index: usize,
        projectors: &[Projector],
        places: &[AffinePlace],
        width: usize,
    ) -> AffinePlace {
        let [first, second] = self.dyads[index].ends.map(|end| &places[end]);
        let Projector { reads, moves } = projectors[index];
        // v = v'' + n (e · (v' - v'')), for every column of the affine functions.
        let mut made = *second;
        for c in 0..=width {
            let along =
                reads[0] * (first[0][c] - second[0][c]) + reads[1] * (first[1][c] - second[1][c]);
            made[0][c] += moves[0] * along;
            made[1][c] += moves[1] * along;
        }
        made
    }
}

/// A pivot below this share of the largest coefficient is rounding: the directions determine nothing, or hardly.
const LEAST_PIVOT: f64 = 1e-13;

/// Solves rows · (p, 1) = 0 by elimination with pivots; the parameters and the determinant. `None` if the rows are singular to
/// rounding.
fn solve_closing(
    rows: &mut [[f64; WIDTH]; MOST_PARAMETERS],
    n: usize,
) -> Option<([f64; MOST_PARAMETERS], f64)> {
    let mut determinant = 1.0;
    let coefficients = rows.iter().take(n).flat_map(|row| &row[..n]);
    let largest = coefficients.fold(0.0, |most: f64, c| most.max(c.abs()));
    for k in 0..n {
        // Partial pivoting; every exchange of rows changes the sign of the determinant.
        let place = (k..n).max_by(|i, j| rows[*i][k].abs().total_cmp(&rows[*j][k].abs()))?;
        if place != k {
            rows.swap(place, k);
            determinant = -determinant;
        }
        let pivot = rows[k];
        determinant *= pivot[k];
        if !(pivot[k].abs() > LEAST_PIVOT * largest && determinant.is_finite()) {
            return None;
        }
        // Elimination below the pivot, in the column of constants, too.
        for row in rows.iter_mut().take(n).skip(k + 1) {
            let factor = row[k] / pivot[k];
            for c in k..=n {
                row[c] -= factor * pivot[c];
            }
        }
    }
    // Back substitution: the constants go to the right side, with the opposite sign.
    let mut solution = [0.0; MOST_PARAMETERS];
    for k in (0..n).rev() {
        let known = (k + 1..n).map(|c| rows[k][c] * solution[c]).sum::<f64>();
        solution[k] = -(rows[k][n] + known) / rows[k][k];
    }
    Some((solution, determinant))
}
