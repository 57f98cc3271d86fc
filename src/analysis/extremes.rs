//! The extreme values of every measure found among pieces within their tolerances: at the corner indicated by the signs
//! of the gradient, then at the corner indicated there, and so on.

use super::study::{Evaluator, Gradients, TrackPoses};
use std::sync::atomic::{AtomicBool, Ordering};

/// Maximum number of corners visited on the way to an extreme.
const ROUNDS: usize = 4;

/// The least and greatest value found for every measure, starting with the nominal piece; those found before `cancel`
/// is raised.
pub fn found_extremes(
    evaluator: &mut Evaluator,
    nominal: &TrackPoses,
    gradients: &Gradients,
    tolerances: &[f64],
    cancel: &AtomicBool,
) -> Vec<[f64; 2]> {
    let mut found: Vec<[f64; 2]> = gradients.measures.iter().map(|v| [*v; 2]).collect();
    for index in 0..found.len() {
        for sign in [-1.0, 1.0] {
            let mut row = gradients.rows[index].clone();
            let mut last: Vec<f64> = Vec::new();
            for _ in 0..ROUNDS {
                if !row.iter().all(|slope| slope.is_finite()) {
                    break;
                }
                let corner = steepest_corner(nominal, &row, tolerances, sign);
                if corner == last || cancel.load(Ordering::Relaxed) {
                    break;
                }
                let Ok(track_poses) = evaluator.piece(nominal, &corner) else {
                    break;
                };
                let track_poses = evaluator.settled(track_poses);
                let Ok(there) = evaluator.gradients_with_gaps(&track_poses) else {
                    break;
                };
                // A corner may be extreme for other measures as well; what has no value there changes nothing.
                for (known, value) in found.iter_mut().zip(&there.measures) {
                    *known = [known[0].min(*value), known[1].max(*value)];
                }
                row.clone_from(&there.rows[index]);
                last = corner;
            }
        }
    }
    found
}

/// The corner of the tolerances in whose direction `sign` times a function with this gradient grows.
fn steepest_corner(
    nominal: &TrackPoses,
    gradient: &[f64],
    tolerances: &[f64],
    sign: f64,
) -> Vec<f64> {
    let parts = nominal.values.iter().zip(gradient).zip(tolerances);
    parts
        .map(|((value, slope), tolerance)| value + tolerance * (sign * slope).signum())
        .collect()
}
