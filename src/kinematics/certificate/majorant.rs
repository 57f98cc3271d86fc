//! The Newton-Kantorovich test, for a pose and for a tube alike.

use crate::numbers::rounding::{DISCRIMINANT, GROW};

/// The results if the test succeeds, radians and sizes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Root {
    /// A root is no farther away than this.
    pub error: f64,
    /// Within this distance the root is the only one.
    pub unique: f64,
}

/// The test: `eta` bounds |R F|, `q` |I - R J| at the centre, and `k` |R F''| within `ball` of it.
///
/// A root exists if `eta + q r + k r²/2 ≤ r` for some r in the ball; the smallest such r is the error. `None` if there is
/// none, or if a bound is NaN.
pub fn root_within(ball: f64, [eta, q, k]: [f64; 3]) -> Option<Root> {
    let slope = 1.0 - q;
    let discriminant = slope * slope * (1.0 - DISCRIMINANT) - 2.0 * k * eta;
    if !(q < 1.0 && discriminant > 0.0) {
        return None;
    }
    // The smaller root of K r²/2 - (1 - q) r + eta = 0, written without cancellation.
    let error = 2.0 * eta / (slope + discriminant.sqrt()) * GROW;
    // The map contracts up to the vertex of the parabola.
    let unique = (slope / k).min(ball) / GROW;
    (error < unique).then_some(Root { error, unique })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::panic)]
    use super::*;

    #[test]
    fn error_is_a_root_of_the_majorant_and_the_ball_holds_it() {
        for [eta, q, k] in [[1e-9, 0.0, 1.0], [0.1, 0.3, 2.0], [0.0, 0.5, 0.0]] {
            let Some(root) = root_within(1.0, [eta, q, k]) else {
                panic!("no root of {eta}, {q}, {k}");
            };
            let Root { error, unique } = root;
            let left = eta + q * error + 0.5 * k * error * error;
            assert!(
                left <= error && error <= 2.0 * eta / (1.0 - q) * 1.001,
                "{error}"
            );
            assert!(q + k * unique <= 1.0 + 1e-12 && unique <= 1.0, "{unique}");
        }
    }

    #[test]
    fn what_has_no_root_or_is_no_number_is_refused() {
        let double = [0.25, 0.0, 2.0];
        for constants in [
            double,
            [0.3, 0.0, 2.0],
            [0.0, 1.0, 0.0],
            [f64::NAN, 0.0, 1.0],
            [1e-9, f64::NAN, 1.0],
            [1e-9, 0.0, f64::NAN],
            [1e-9, 0.0, f64::INFINITY],
        ] {
            assert_eq!(root_within(1.0, constants), None, "{constants:?}");
        }
        // The root lies outside the ball.
        assert_eq!(root_within(0.05, [0.1, 0.0, 1.0]), None);
    }
}
