//! Minimises sums of squares by the method of Levenberg and Marquardt (Moré, Lecture Notes in Mathematics 630, 1978),
//! within bounds: variables are held at a bound if the gradient points outwards. An evaluation may depend on the point
//! from which it starts.

use super::{StopReason, VariableBounds};
use nalgebra::{DMatrix, DVector};

/// Numbers whose squares are summed.
pub trait Residuals {
    /// A point with everything known there.
    type Point;

    /// The point at `x`, reached from another one; `None` if it is rejected.
    fn at(&mut self, from: &Self::Point, x: &[f64]) -> Option<Self::Point>;

    /// The variables of a point.
    fn x<'p>(&self, place: &'p Self::Point) -> &'p [f64];

    /// The numbers there.
    fn values<'p>(&self, place: &'p Self::Point) -> &'p [f64];

    /// Their derivatives, row after row; `None` where there are none.
    fn jacobian(&mut self, place: &Self::Point) -> Option<Vec<f64>>;

    /// Asked after every iteration with the sum of squares; `false` ends the search.
    fn goes_on(&mut self, _sum: f64) -> bool {
        true
    }
}

/// What a search found.
#[derive(Clone, Debug, PartialEq)]
pub struct LeastSquares<P> {
    /// The best point.
    pub place: P,
    /// Sum of the squares there.
    pub sum: f64,
    /// Steps tried.
    pub steps: usize,
    /// Why it ended.
    pub ended: StopReason,
}

/// First damping, as a fraction of the squared columns.
const FIRST_DAMPING: f64 = 1e-3;

/// Damping above which a step is negligibly short.
const MOST_DAMPING: f64 = 1e16;

/// Damping below which steps are Gauss-Newton steps.
const LEAST_DAMPING: f64 = 1e-18;

/// A step whose predicted decrease is below this fraction of the sum gains nothing above rounding.
const LEAST_PROMISE: f64 = 1e-14;

/// Sums below this, relative to the first one, are rounding.
const NOTHING: f64 = 1e-30;

/// Searches from a point, with at most this many steps.
pub fn minimise_squares<R: Residuals>(
    problem: &mut R,
    start: R::Point,
    bounds: &VariableBounds,
    steps: usize,
) -> LeastSquares<R::Point> {
    let mut here = start;
    let mut sum = squares(problem.values(&here));
    let first = sum;
    let mut damping = FIRST_DAMPING;
    let mut growth = 2.0;
    let mut tried = 0;
    let mut model = None;
    let ended = loop {
        if sum <= NOTHING * first || sum == 0.0 {
            break StopReason::Converged;
        }
        if tried >= steps {
            break StopReason::OutOfBudget;
        }
        if model.is_none() {
            if !problem.goes_on(sum) {
                break StopReason::Stopped;
            }
            model = Linearised::new(problem, &here, bounds);
        }
        let Some(linear) = &model else {
            break StopReason::Stalled;
        };
        let before = problem.x(&here);
        let step = linear.step(damping, before, bounds);
        let promise = step.as_ref().map(|step| linear.promise(&step.moves));
        let worth = promise.is_some_and(|promise| promise > LEAST_PROMISE * sum);
        let (Some(step), Some(promise), true) = (&step, promise, worth) else {
            // A step shortened by bounds may predict no decrease where an even shorter one does.
            if step.as_ref().is_some_and(|step| !step.is_cut) {
                break StopReason::Converged;
            }
            damping *= growth;
            growth *= 2.0;
            if damping > MOST_DAMPING {
                break StopReason::Stalled;
            }
            continue;
        };
        let moves = before.iter().zip(&step.moves);
        let mut x: Vec<f64> = moves.map(|(x, s)| x + s).collect();
        bounds.clamp(&mut x);
        tried += 1;
        let next = problem.at(&here, &x);
        let next = next.map(|place| (squares(problem.values(&place)), place));
        match next {
            Some((lower, place)) if lower < sum => {
                // Nielsen's rule: the damping depends on the ratio of actual to predicted decrease.
                let kept = (sum - lower) / promise;
                let share = 1.0 - (2.0 * kept - 1.0).powi(3);
                damping = (damping * share.clamp(1.0 / 9.0, 2.0)).max(LEAST_DAMPING);
                growth = 2.0;
                (here, sum) = (place, lower);
                model = None;
            }
            _ => {
                damping *= growth;
                growth *= 2.0;
                if damping > MOST_DAMPING {
                    break StopReason::Converged;
                }
            }
        }
    };
    LeastSquares {
        place: here,
        sum,
        steps: tried,
        ended,
    }
}

/// Σ v²; infinite if an entry is not a number.
fn squares(values: &[f64]) -> f64 {
    let sum: f64 = values.iter().map(|v| v * v).sum();
    if sum.is_nan() { f64::INFINITY } else { sum }
}

/// A step within the bounds.
struct BoundedStep {
    moves: Vec<f64>,
    /// A bound stopped one of the variables.
    is_cut: bool,
}

/// The numbers to the first order at a point.
struct Linearised {
    jacobian: DMatrix<f64>,
    values: DVector<f64>,
    free: Vec<bool>,
}

impl Linearised {
    fn new<R: Residuals>(
        problem: &mut R,
        place: &R::Point,
        bounds: &VariableBounds,
    ) -> Option<Self> {
        let rates = problem.jacobian(place)?;
        let values = DVector::from_column_slice(problem.values(place));
        let x = problem.x(place);
        let jacobian = DMatrix::from_row_slice(values.len(), x.len(), &rates);
        let slope = jacobian.transpose() * &values;
        // Variables at a bound are held if the gradient points outwards.
        let free = x.iter().enumerate().map(|(k, x)| {
            let pushes_down = *x <= bounds.lower[k] && slope[k] > 0.0;
            let pushes_up = *x >= bounds.upper[k] && slope[k] < 0.0;
            !(pushes_down || pushes_up)
        });
        let free: Vec<bool> = free.collect();
        let finite = slope.iter().chain(jacobian.iter()).all(|v| v.is_finite());
        finite.then_some(Self {
            jacobian,
            values,
            free,
        })
    }

    /// The damped step within the bounds: variables that would leave them stop there, and the others are solved again.
    /// `None` if there is no step.
    fn step(&self, damping: f64, x: &[f64], bounds: &VariableBounds) -> Option<BoundedStep> {
        let mut fixed: Vec<Option<f64>> = self.free.iter().map(|f| (!f).then_some(0.0)).collect();
        let mut is_cut = false;
        loop {
            let moves = self.unbounded_step(damping, &fixed)?;
            let mut all_inside = true;
            for (k, by) in moves.iter().enumerate().filter(|(k, _)| self.free[*k]) {
                let (low, high) = (bounds.lower[k] - x[k], bounds.upper[k] - x[k]);
                if fixed[k].is_none() && !(low..=high).contains(by) {
                    fixed[k] = Some(by.clamp(low, high));
                    all_inside = false;
                }
            }
            if all_inside {
                return Some(BoundedStep { moves, is_cut });
            }
            is_cut = true;
        }
    }

    /// The damped step in which some variables move as given, by an orthogonal factorisation of the derivatives with
    /// the damping appended.
    fn unbounded_step(&self, damping: f64, fixed: &[Option<f64>]) -> Option<Vec<f64>> {
        let (rows, count) = self.jacobian.shape();
        let columns = self.jacobian.column_iter();
        let sizes: Vec<f64> = columns.map(|c| c.norm_squared()).collect();
        let largest = sizes.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let given = DVector::from_iterator(count, fixed.iter().map(|f| f.unwrap_or(0.0)));
        let mut matrix = DMatrix::zeros(rows + count, count);
        matrix.rows_mut(0, rows).copy_from(&self.jacobian);
        let mut right = DVector::zeros(rows + count);
        let left = -(&self.values + &self.jacobian * &given);
        right.rows_mut(0, rows).copy_from(&left);
        for k in 0..count {
            if fixed[k].is_some() {
                matrix.column_mut(k).fill(0.0);
            }
            // Columns with hardly any effect are damped like small ones.
            let size = sizes[k].max(LEAST_PROMISE * largest);
            matrix[(rows + k, k)] = (damping * size).sqrt();
        }
        let factors = matrix.qr();
        factors.q_tr_mul(&mut right);
        let step = factors
            .r()
            .solve_upper_triangular(&right.rows(0, count).into_owned())?;
        let moves = step.iter().zip(fixed);
        let moves: Vec<f64> = moves.map(|(s, fixed)| fixed.unwrap_or(*s)).collect();
        moves.iter().all(|s| s.is_finite()).then_some(moves)
    }

    /// Predicted decrease of the sum, to first order.
    fn promise(&self, step: &[f64]) -> f64 {
        let after = &self.values + &self.jacobian * DVector::from_column_slice(step);
        self.values.norm_squared() - after.norm_squared()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// Numbers that are formulas of the variables.
    struct Plain<F, J>(F, J);

    impl<F: Fn(&[f64]) -> Vec<f64>, J: Fn(&[f64]) -> Vec<f64>> Residuals for Plain<F, J> {
        type Point = [Vec<f64>; 2];

        fn at(&mut self, _from: &Self::Point, x: &[f64]) -> Option<Self::Point> {
            Some([x.to_vec(), self.0(x)])
        }

        fn x<'p>(&self, place: &'p Self::Point) -> &'p [f64] {
            &place[0]
        }

        fn values<'p>(&self, place: &'p Self::Point) -> &'p [f64] {
            &place[1]
        }

        fn jacobian(&mut self, place: &Self::Point) -> Option<Vec<f64>> {
            Some(self.1(&place[0]))
        }
    }

    fn rosenbrock() -> impl Residuals<Point = [Vec<f64>; 2]> {
        Plain(
            |x: &[f64]| vec![10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]],
            |x: &[f64]| vec![-20.0 * x[0], 10.0, -1.0, 0.0],
        )
    }

    #[test]
    fn the_valley_of_rosenbrock_is_followed_to_its_end() {
        let mut problem = rosenbrock();
        let start = problem.at(&[vec![], vec![]], &[-1.2, 1.0]).unwrap();
        let found = minimise_squares(&mut problem, start, &VariableBounds::none(2), 200);
        assert_eq!(found.ended, StopReason::Converged);
        assert!(
            found.sum < 1e-24 && (found.place[0][0] - 1.0).abs() < 1e-10,
            "{found:?}"
        );
        assert!(found.steps < 40, "{found:?}");
    }

    /// A step to the bounds without predicted decrease does not end the search: x + y = 3 and x - 9 y = 0, with y at
    /// most 0.1.
    #[test]
    fn steps_that_bounds_cut_short_go_on() {
        let mut problem = Plain(
            |x: &[f64]| vec![100.0 * (x[0] + x[1] - 3.0), x[0] * x[0] - 9.0 * x[1]],
            |x: &[f64]| vec![100.0, 100.0, 2.0 * x[0], -9.0],
        );
        let bounds = VariableBounds {
            lower: vec![-4.0, -4.0],
            upper: vec![4.0, 0.1],
        };
        for start in [[-4.0, 0.1], [4.0, -4.0], [0.0, 0.0], [-4.0, -4.0]] {
            let place = problem.at(&[vec![], vec![]], &start).unwrap();
            let found = minimise_squares(&mut problem, place, &bounds, 200);
            let [x, _] = &found.place;
            assert_eq!(x[1], 0.1, "{found:?}");
            assert!((x[0] - 2.9).abs() < 0.01, "{found:?}");
        }
    }

    #[test]
    fn bounds_are_kept_and_left_again() {
        let mut problem = rosenbrock();
        let bounds = VariableBounds {
            lower: vec![-2.0, -2.0],
            upper: vec![0.5, 2.0],
        };
        let start = problem.at(&[vec![], vec![]], &[0.5, 2.0]).unwrap();
        let found = minimise_squares(&mut problem, start, &bounds, 200);
        // The minimum on the edge is x = 0.5, y = 0.25.
        assert!((found.place[0][1] - 0.25).abs() < 1e-9, "{found:?}");
        assert!((found.sum - 0.25).abs() < 1e-12);
        let start = problem.at(&[vec![], vec![]], &[-2.0, 2.0]).unwrap();
        let found = minimise_squares(&mut problem, start, &VariableBounds::none(2), 200);
        assert!(found.sum < 1e-20, "{found:?}");
    }

    /// Two lines that do not intersect: the residual is their distance.
    #[test]
    fn what_cannot_vanish_is_least() {
        let mut problem = Plain(
            |x: &[f64]| vec![x[0] + x[1] - 1.0, x[0] + x[1] + 1.0],
            |_: &[f64]| vec![1.0; 4],
        );
        let start = problem.at(&[vec![], vec![]], &[3.0, 4.0]).unwrap();
        let found = minimise_squares(&mut problem, start, &VariableBounds::none(2), 100);
        assert!((found.sum - 2.0).abs() < 1e-12, "{found:?}");
    }
}
