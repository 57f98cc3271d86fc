//! Routes for linkages of dyads that integrate the velocities of their points, as the source on dyads does: from system
//! (3), whose coefficients have poles where two bars are in line, or from the rows of the bars, which have none there.
//!
//! They exist for comparison only, like the other [`routes`](super::routes).

use super::dyads::PlanarRow;
use crate::intervals::dyad::{dyad_system, j_matrices};
use crate::intervals::formal::solved_numbers;

/// Places or velocities of all points in the plane of the linkage.
pub type PlanePoints = Vec<[f64; 2]>;

/// The equations that determine the velocities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VelocityRows {
    /// u · (v - v') = 0 for every bar with the direction u.
    Bars,
    /// v = J v' + J' v'' for every dyad, solved for a unit angular velocity of the lever and scaled to the crank's.
    Dyads,
}

/// A linkage whose crank turns about a fixed point.
#[derive(Clone, Debug, PartialEq)]
pub struct DrivenLinkage {
    row: PlanarRow,
    /// The moving and the fixed end of the crank.
    crank: [usize; 2],
    /// Its angular velocity for a unit rate of the input.
    ratio: f64,
}

/// Relative difference up to which two angular velocities are the same.
const SAME_RATE: f64 = 1e-9;

impl DrivenLinkage {
    /// The linkage at a pose and at `another` one, with velocities for a unit rate of the input. The crank is a bar from a
    /// fixed point with the same angular velocity in both; `None` without one.
    pub fn new(row: PlanarRow, another: &PlanarRow) -> Option<Self> {
        let turning = |row: &PlanarRow, [end, fixed]: [usize; 2]| {
            let chain = &row.chain;
            let (arm, v) = (
                difference(chain.points[end], chain.points[fixed]),
                chain.velocities[end],
            );
            (arm[0] * v[1] - arm[1] * v[0]) / (arm[0] * arm[0] + arm[1] * arm[1])
        };
        let fixed = |k: &usize| row.chain.fixed.contains(k);
        let bars = row
            .bars
            .iter()
            .filter_map(|[a, b]| match (fixed(a), fixed(b)) {
                (true, false) => Some([*b, *a]),
                (false, true) => Some([*a, *b]),
                _ => None,
            });
        let mut rates = bars.map(|crank| (crank, [&row, another].map(|row| turning(row, crank))));
        let (crank, [ratio, _]) =
            rates.find(|(_, [a, b])| *a != 0.0 && (a - b).abs() <= SAME_RATE * a.abs())?;
        Some(Self { row, crank, ratio })
    }

    /// Places of the points at the pose.
    pub fn points(&self) -> &[[f64; 2]] {
        &self.row.chain.points
    }

    /// Largest difference of a bar's length from that at the pose.
    pub fn length_error(&self, points: &[[f64; 2]]) -> f64 {
        let length = |points: &[[f64; 2]], [a, b]: [usize; 2]| {
            let [x, y] = difference(points[a], points[b]);
            libm::hypot(x, y)
        };
        let bars = self.row.bars.iter();
        let errors = bars.map(|bar| (length(points, *bar) - length(self.points(), *bar)).abs());
        errors.fold(0.0, f64::max)
    }

    /// The points after a step of the classical Runge-Kutta method (`order` 4) or Euler's (1) from time `from` to `to`,
    /// with the input's `rate` as a function of time; `None` where the equations are singular.
    pub fn advance(
        &self,
        (rows, order): (VelocityRows, usize),
        points: &[[f64; 2]],
        [from, to]: [f64; 2],
        rate: &dyn Fn(f64) -> f64,
    ) -> Option<PlanePoints> {
        let h = to - from;
        let slope = |points: &[[f64; 2]], time| self.velocities(rows, points, rate(time));
        let first = slope(points, from)?;
        if order == 1 {
            return Some(moved(points, &first, h));
        }
        let middle = 0.5 * (from + to);
        let second = slope(&moved(points, &first, 0.5 * h), middle)?;
        let third = slope(&moved(points, &second, 0.5 * h), middle)?;
        let fourth = slope(&moved(points, &third, h), to)?;
        let mean = |k: usize| {
            let part = |i: usize| first[k][i] + 2.0 * (second[k][i] + third[k][i]) + fourth[k][i];
            [0, 1].map(|i| part(i) / 6.0)
        };
        let mean: PlanePoints = (0..points.len()).map(mean).collect();
        Some(moved(points, &mean, h))
    }

    /// Velocities of all points for a rate of the input.
    fn velocities(
        &self,
        rows: VelocityRows,
        points: &[[f64; 2]],
        rate: f64,
    ) -> Option<PlanePoints> {
        match rows {
            VelocityRows::Bars => self.by_bars(points, rate),
            VelocityRows::Dyads => self.by_dyads(points, rate),
        }
    }

    /// The velocity of the crank's end.
    fn crank_velocity(&self, points: &[[f64; 2]], rate: f64) -> [f64; 2] {
        let [end, fixed] = self.crank;
        let [x, y] = difference(points[end], points[fixed]);
        [-y, x].map(|v| v * self.ratio * rate)
    }

    fn by_bars(&self, points: &[[f64; 2]], rate: f64) -> Option<PlanePoints> {
        let chain = &self.row.chain;
        let moving: Vec<usize> = (0..points.len())
            .filter(|k| !chain.fixed.contains(k) && *k != self.crank[0])
            .collect();
        let column = |point: usize| moving.iter().position(|own| *own == point);
        let mut velocities = vec![[0.0; 2]; points.len()];
        velocities[self.crank[0]] = self.crank_velocity(points, rate);
        let (mut matrix, mut sides) = (Vec::new(), Vec::new());
        for bar in &self.row.bars {
            // The crank's own bar holds by its velocity.
            if bar.iter().all(|end| column(*end).is_none()) {
                continue;
            }
            let u = difference(points[bar[0]], points[bar[1]]);
            let (mut line, mut side) = (vec![0.0; 2 * moving.len()], 0.0);
            for (end, sign) in bar.iter().zip([1.0, -1.0]) {
                match column(*end) {
                    Some(k) => [0, 1].map(|i| line[2 * k + i] = sign * u[i]),
                    None => [0, 1].map(|i| side -= sign * u[i] * velocities[*end][i]),
                };
            }
            matrix.push(line);
            sides.push(side);
        }
        let solution = solved_numbers(&matrix, &sides)?;
        for (point, v) in moving.iter().zip(solution.chunks_exact(2)) {
            velocities[*point] = [v[0], v[1]];
        }
        Some(velocities)
    }

    fn by_dyads(&self, points: &[[f64; 2]], rate: f64) -> Option<PlanePoints> {
        let chain = &self.row.chain;
        let [end, fixed] = chain.lever;
        let matrices: Option<Vec<_>> = (chain.dyads.iter())
            .map(|dyad| j_matrices(points[dyad.point], dyad.ends.map(|end| points[end])))
            .collect();
        let moving: Vec<usize> = (0..points.len())
            .filter(|k| !chain.fixed.contains(k) && *k != end)
            .collect();
        // The lever's end moves across the lever, with a velocity to be scaled.
        let [x, y] = difference(points[end], points[fixed]);
        let mut velocities = vec![[0.0; 2]; points.len()];
        velocities[end] = [-y, x];
        let (matrix, sides) = dyad_system(&matrices?, &chain.dyads, &moving, &velocities);
        let solution = solved_numbers(&matrix, &sides)?;
        for (point, v) in moving.iter().zip(solution.chunks_exact(2)) {
            velocities[*point] = [v[0], v[1]];
        }
        let wanted = self.crank_velocity(points, rate);
        let found = velocities[self.crank[0]];
        let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        // At a dead point of the lever the crank moves alone: no factor gives its velocity.
        let factor = dot(wanted, wanted) / dot(wanted, found);
        let scaled = velocities.iter().map(|v| v.map(|v| v * factor));
        factor.is_finite().then(|| scaled.collect())
    }
}

fn difference(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn moved(points: &[[f64; 2]], velocities: &[[f64; 2]], h: f64) -> PlanePoints {
    let pairs = points.iter().zip(velocities);
    pairs
        .map(|(p, v)| [0, 1].map(|i| p[i] + h * v[i]))
        .collect()
}
