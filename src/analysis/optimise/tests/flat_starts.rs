//! Starts at which all slopes vanish and that are no minima, and starts beside jumps: a search that ends by its slopes looks
//! beside them first.

use super::*;

/// A function with its slopes, a start, and the least value within -3 and 4.
struct Start {
    value: fn(&[f64]) -> f64,
    slopes: fn(&[f64]) -> Vec<f64>,
    from: &'static [f64],
    least: f64,
}

const STARTS: [Start; 6] = [
    // A maximum.
    Start {
        value: |x| x[0].cos(),
        slopes: |x| vec![-x[0].sin()],
        from: &[0.0],
        least: -1.0,
    },
    // A saddle.
    Start {
        value: |x| x[0] * x[0] + (x[1] * x[1] - 1.0).powi(2),
        slopes: |x| vec![2.0 * x[0], 4.0 * x[1] * (x[1] * x[1] - 1.0)],
        from: &[0.0, 0.0],
        least: 0.0,
    },
    // An inflection of the third order.
    Start {
        value: |x| (x[0] - 1.0).powi(3),
        slopes: |x| vec![3.0 * (x[0] - 1.0).powi(2)],
        from: &[1.0],
        least: -64.0,
    },
    // Jumps that the slopes do not tell of.
    Start {
        value: |x| x[0].floor() + 0.5 * (x[0] - x[0].floor()).powi(2),
        slopes: |x| vec![x[0] - x[0].floor()],
        from: &[2.0],
        least: -3.0,
    },
    // The same from a slope that leads down to a jump.
    Start {
        value: |x| x[0].floor() + 0.5 * (x[0] - x[0].floor()).powi(2),
        slopes: |x| vec![x[0] - x[0].floor()],
        from: &[2.3],
        least: -3.0,
    },
    // A minimum is one.
    Start {
        value: |x| x[0].powi(4) + x[1] * x[1],
        slopes: |x| vec![4.0 * x[0].powi(3), 2.0 * x[1]],
        from: &[0.0, 0.0],
        least: 0.0,
    },
];

/// The function as the only peak, without kinks.
struct Peak<'a>(&'a Start);

impl minimax::MinimaxProblem for Peak<'_> {
    fn values_at(&mut self, x: &[f64]) -> Option<minimax::PeakValues> {
        Some(minimax::PeakValues {
            peaks: vec![(self.0.value)(x)],
            limits: Vec::new(),
        })
    }
    fn gradients_at(&mut self, x: &[f64]) -> Option<(minimax::PeakValues, minimax::PeakGradients)> {
        let gradients = minimax::PeakGradients {
            peaks: vec![(self.0.slopes)(x)],
            limits: Vec::new(),
            bend: None,
        };
        Some((self.values_at(x)?, gradients))
    }
}

#[test]
fn searches_leave_flat_places_that_are_no_minima() {
    for (number, start) in STARTS.iter().enumerate() {
        let count = start.from.len();
        let bounds = VariableBounds {
            lower: vec![-3.0; count],
            upper: vec![4.0; count],
        };
        let scales = vec![1.0; count];
        let limits = bfgs::BfgsLimits {
            gradient_tolerance: 1e-9,
            iterations: 200,
            first_step: 0.1,
        };
        let mut function = Function {
            value: start.value,
            gradient: start.slopes,
            calls: 0,
        };
        let newton = bfgs::minimise_bfgs(&mut function, start.from, &scales, &bounds, limits);
        let search = minimax::MinimaxSearch {
            radius: 0.1,
            smallest_radius: 1e-12,
            tolerance: 1e-12,
            iterations: 200,
        };
        let peak =
            minimax::minimise_largest(&mut Peak(start), start.from, &scales, &bounds, search);
        for found in [newton, peak] {
            assert!(
                found.value <= start.least + 1e-6,
                "{number}: {found:?} instead of {}",
                start.least
            );
        }
    }
}
