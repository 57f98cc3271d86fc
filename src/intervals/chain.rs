//! A sequence of dyads at a pose: its matrices, and the linear systems of its velocities, of its positions, and of both
//! in intervals.

use super::dyad::{
    Coefficients, Dyad, conjugate_coefficients, corner_ranges, dyad_system, exact_ranges,
    j_matrices,
};
use super::formal::solved_numbers;
use super::kaucher::Kaucher;
use super::system::IntervalSystem;

/// A sequence of dyads with a lever driven from outside: one degree of freedom.
#[derive(Clone, Debug, PartialEq)]
pub struct DyadChain {
    /// Places of all points.
    pub points: Vec<[f64; 2]>,
    /// Their velocities.
    pub velocities: Vec<[f64; 2]>,
    /// Points that stand still.
    pub fixed: Vec<usize>,
    /// The dyads; the last has the point whose velocity is given.
    pub dyads: Vec<Dyad>,
    /// A moving point and the fixed point of its bar.
    pub lever: [usize; 2],
}

/// Which directions the bars may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Directions {
    /// Each direction within this angle (radians) of its own.
    Near(f64),
    /// The first bar of a dyad in any direction, the second rotated from it by an angle in this interval (radians).
    Turned(Kaucher),
}

/// Any direction.
pub const WHOLE_TURN: Kaucher = Kaucher::new(0.0, std::f64::consts::TAU);

/// Coefficients of both matrices of a dyad as intervals.
pub type IntervalMatrices = [[Kaucher; 4]; 2];

impl DyadChain {
    /// The point whose velocity is given: that of the last dyad.
    pub fn given(&self) -> usize {
        self.dyads.last().map_or(0, |dyad| dyad.point)
    }

    /// The points whose velocities are unknown, in the order of the columns.
    pub fn unknowns(&self) -> Vec<usize> {
        let is_unknown = |k: &usize| !self.fixed.contains(k) && *k != self.given();
        (0..self.points.len()).rev().filter(is_unknown).collect()
    }

    /// J and J' of every dyad; `None` if its bars are collinear.
    pub fn matrices(&self) -> Option<Vec<[Coefficients; 2]>> {
        let of = |dyad: &Dyad| {
            j_matrices(
                self.points[dyad.point],
                dyad.ends.map(|end| self.points[end]),
            )
        };
        self.dyads.iter().map(of).collect()
    }

    /// The direction of a dyad's first bar, radians.
    pub fn direction(&self, dyad: &Dyad) -> f64 {
        let (p, q) = (self.points[dyad.point], self.points[dyad.ends[0]]);
        libm::atan2(p[1] - q[1], p[0] - q[0])
    }

    /// The angle from a dyad's first bar to its second, as lines: radians from 0 to π.
    pub fn angle(&self, dyad: &Dyad) -> f64 {
        let p = self.points[dyad.point];
        let [e, f] = dyad.ends.map(|end| {
            let q = self.points[end];
            libm::atan2(p[1] - q[1], p[0] - q[0])
        });
        (f - e).rem_euclid(std::f64::consts::PI)
    }

    /// The system (3) of the velocities: rows and right-hand sides.
    pub fn velocity_system(&self) -> Option<(Vec<Vec<f64>>, Vec<f64>)> {
        let matrices = self.matrices()?;
        Some(dyad_system(
            &matrices,
            &self.dyads,
            &self.unknowns(),
            &self.velocities,
        ))
    }

    /// Positions by the conjugate system, in the order of [`Self::unknowns`]; with the signs as `printed` they are
    /// those of a reflection, which is wrong.
    pub fn conjugate_positions(&self, printed: bool) -> Option<Vec<[f64; 2]>> {
        let conjugate = |j: Coefficients| {
            let [a, b, c, d] = conjugate_coefficients(j);
            if printed {
                [a, -b, -c, d]
            } else {
                [a, b, c, d]
            }
        };
        let matrices: Vec<_> = (self.matrices()?.iter())
            .map(|both| both.map(conjugate))
            .collect();
        let (rows, sides) = dyad_system(&matrices, &self.dyads, &self.unknowns(), &self.points);
        let solution = solved_numbers(&rows, &sides)?;
        Some(solution.chunks_exact(2).map(|p| [p[0], p[1]]).collect())
    }

    /// The ranges of the coefficients of every dyad; `None` if its bars can be collinear.
    pub fn ranges(&self, dyad: &Dyad, directions: Directions) -> Option<IntervalMatrices> {
        let first = match directions {
            Directions::Turned(delta) => exact_ranges(WHOLE_TURN, delta)?,
            Directions::Near(by) => {
                let about = |angle: f64| Kaucher::new(angle - by, angle + by);
                let first = self.direction(dyad);
                corner_ranges(about(first), about(first + self.angle(dyad)))?
            }
        };
        let one = Kaucher::point(1.0);
        let second = [one - first[0], -first[1], -first[2], one - first[3]];
        Some([first, second])
    }

    /// The system of the velocities with all coefficients varying independently in their ranges, another velocity of
    /// the given point, and all right-hand sides widened by `side` on both sides.
    pub fn interval_system(
        &self,
        directions: Directions,
        given: [f64; 2],
        side: f64,
    ) -> Option<IntervalSystem> {
        let dyads = self.dyads.iter();
        let matrices: Option<Vec<_>> = dyads.map(|d| self.ranges(d, directions)).collect();
        let mut values = vec![[Kaucher::default(); 2]; self.points.len()];
        values[self.given()] = given.map(Kaucher::point);
        let (a, b) = dyad_system(&matrices?, &self.dyads, &self.unknowns(), &values);
        let wide = Kaucher::new(-side, side);
        Some(IntervalSystem {
            a,
            b: b.iter().map(|b| *b + wide).collect(),
        })
    }
}
