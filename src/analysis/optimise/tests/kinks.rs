//! Functions with kinks that a minimax search is not told of: it sees one derivative only.

use super::*;

/// A value and the derivatives of one side.
type Sided = fn(&[f64]) -> (f64, Vec<f64>);

/// A function and perhaps a limit that hide their kinks.
struct Hidden {
    value: Sided,
    limit: Option<Sided>,
}

impl minimax::MinimaxProblem for Hidden {
    fn values_at(&mut self, x: &[f64]) -> Option<minimax::PeakValues> {
        let peaks = vec![(self.value)(x).0];
        let limits = self.limit.iter().map(|limit| limit(x).0).collect();
        Some(minimax::PeakValues { peaks, limits })
    }
    fn gradients_at(&mut self, x: &[f64]) -> Option<(minimax::PeakValues, minimax::PeakGradients)> {
        let gradients = minimax::PeakGradients {
            peaks: vec![(self.value)(x).1],
            limits: self.limit.iter().map(|limit| limit(x).1).collect(),
            bend: None,
        };
        Some((self.values_at(x)?, gradients))
    }
    fn hides_kinks(&self) -> bool {
        true
    }
}

/// |A - B| + 0.1 |A + B - 1|, least at (0.5, 0.5).
fn valley(x: &[f64]) -> (f64, Vec<f64>) {
    let (a, b) = (x[0] - x[1], x[0] + x[1] - 1.0);
    let (s, t) = (a.signum(), 0.1 * b.signum());
    (a.abs() + 0.1 * b.abs(), vec![s + t, t - s])
}

/// A bent valley, least at (1, 1).
fn bent(x: &[f64]) -> (f64, Vec<f64>) {
    let a = x[1] - x[0] * x[0];
    let s = 10.0 * a.signum();
    let value = 10.0 * a.abs() + (1.0 - x[0]).powi(2);
    (value, vec![-2.0 * s * x[0] - 2.0 * (1.0 - x[0]), s])
}

/// The largest of |x - 0.5| over the coordinates.
fn largest(x: &[f64]) -> (f64, Vec<f64>) {
    let by = |k: &usize| (x[*k] - 0.5).abs();
    let k = (0..x.len())
        .max_by(|a, b| by(a).total_cmp(&by(b)))
        .unwrap_or(0);
    let mut slope = vec![0.0; x.len()];
    slope[k] = (x[k] - 0.5).signum();
    (by(&k), slope)
}

/// A plane as the bottom of a valley, least at the origin.
fn sloping(x: &[f64]) -> (f64, Vec<f64>) {
    let a = x[0] + x[1] - x[2];
    let (s, square) = (a.signum(), x.iter().map(|v| v * v).sum::<f64>());
    let slope = [s, s, -s].into_iter().zip(x).map(|(s, x)| s + 0.1 * x);
    (a.abs() + 0.05 * square, slope.collect())
}

/// A valley that falls without end ...
fn falling(x: &[f64]) -> (f64, Vec<f64>) {
    let a = x[0] - x[1];
    (a.abs() - x[0], vec![a.signum() - 1.0, -a.signum()])
}

/// ... up to a limit with a kink.
fn within_one(x: &[f64]) -> (f64, Vec<f64>) {
    ((x[0] - 2.0).abs() - 1.0, vec![(x[0] - 2.0).signum(), 0.0])
}

/// Seven kinks, least along A = B = 2.
fn many(x: &[f64]) -> (f64, Vec<f64>) {
    let (value, mut slope) = valley(x);
    let (sum, past) = (x[0] + x[1] - 1.0, 0.1 * (x[0] + x[1] - 1.0).signum());
    slope.iter_mut().for_each(|d| *d -= past);
    let mut total = value - 0.1 * sum.abs();
    for (k, x) in x.iter().enumerate() {
        for at in [1.0, 2.0, 3.0] {
            total += 0.1 * (x - at).abs();
            slope[k] += 0.1 * (x - at).signum();
        }
    }
    (total, slope)
}

/// The search goes to the lowest points of narrow valleys, or does not say that it converged.
#[test]
fn a_search_does_not_end_on_the_way_along_a_kink() {
    // From the kink or from beside it; the least value.
    let cases: [(Sided, Option<Sided>, &[f64], f64); 8] = [
        (many, None, &[4.0, 4.0], 0.4),
        (many, None, &[-4.0, 3.0], 0.4),
        (valley, None, &[4.0, 4.0], 0.0),
        (valley, None, &[4.0, 1.0], 0.0),
        (bent, None, &[-1.2, 1.44], 0.0),
        (largest, None, &[3.0, 3.0, 3.0], 0.0),
        (sloping, None, &[3.0, 1.0, 4.0], 0.0),
        (falling, Some(within_one), &[2.0, 2.0], -3.0),
    ];
    for (k, (value, limit, start, least)) in cases.into_iter().enumerate() {
        let mut hidden = Hidden { value, limit };
        let search = minimax::MinimaxSearch {
            radius: 0.02,
            smallest_radius: 1e-12,
            tolerance: 1e-9,
            iterations: 1000,
        };
        let scales = vec![4.0; start.len()];
        let bounds = VariableBounds::none(start.len());
        let found = minimax::minimise_largest(&mut hidden, start, &scales, &bounds, search);
        assert!((found.value - least).abs() < 2e-2, "{k}: {found:?}");
        let is_exact = (found.value - least).abs() < 1e-5;
        assert!(
            is_exact || found.ended != StopReason::Converged,
            "{k}: {found:?}"
        );
    }
}
