//! Paths of the traced points of random pieces around the nominal paths.

use super::study::{Evaluator, ParametricMechanism, TrackPoses};
use super::tolerance::{SampleBatch, values_of};
use glam::DVec3;
use std::sync::atomic::{AtomicBool, Ordering};

/// Paths of one traced point along one track.
#[derive(Clone, Debug, PartialEq)]
pub struct PathCloud {
    /// Name of the track, or of the drive.
    pub track: String,
    /// Name of the traced point.
    pub trace: String,
    /// sRGB colour of its path.
    pub colour: [u8; 3],
    /// The path with the file's values, one point per pose, in world coordinates.
    pub nominal: Vec<DVec3>,
    /// Those of the random pieces that can be assembled, in their order.
    pub pieces: Vec<Vec<DVec3>>,
}

/// A cloud in the coordinates of its nominal path: lengths along it and deviations across it.
#[derive(Clone, Debug, PartialEq)]
pub struct CloudSpread {
    /// Length of the nominal path up to every pose.
    pub along: Vec<f64>,
    /// For every piece the deviation at every pose, in the direction across the path with the largest scatter.
    pub across: Vec<Vec<f64>>,
}

/// Paths of all traced points along all tracks, with those of the batch's pieces; `None` if `cancel` was raised.
///
/// Empty without traced points. Piece n is that of [`super::tolerance::sample_pieces`].
pub fn path_clouds(
    family: &ParametricMechanism,
    nominal: &TrackPoses,
    tolerances: &[f64],
    batch: SampleBatch,
    cancel: &AtomicBool,
) -> Option<Vec<PathCloud>> {
    let mut evaluator = Evaluator::new(family);
    let mut clouds = Vec::new();
    let traces = &family.mechanism().traces;
    for (track, poses) in family.rows() {
        for (index, trace) in traces.iter().enumerate() {
            let cloud = PathCloud {
                track: track.clone(),
                trace: trace.name.clone(),
                colour: trace.colour,
                nominal: family.path(&nominal.poses[poses.clone()], index),
                pieces: Vec::with_capacity(batch.samples),
            };
            clouds.push((poses.clone(), index, cloud));
        }
    }
    // One random piece after the other; the statistics use the same pieces.
    for item in 0..batch.samples {
        if cancel.load(Ordering::Relaxed) {
            return None;
        }
        let values = values_of(nominal, tolerances, batch, item);
        let Ok(track_poses) = evaluator.piece(nominal, &values) else {
            continue;
        };
        for (poses, trace, cloud) in &mut clouds {
            cloud
                .pieces
                .push(family.path(&track_poses.poses[poses.clone()], *trace));
        }
    }
    Some(clouds.into_iter().map(|(_, _, cloud)| cloud).collect())
}

impl PathCloud {
    /// The cloud in the coordinates of its nominal path.
    pub fn spread(&self) -> CloudSpread {
        let mut along = vec![0.0];
        for pair in self.nominal.windows(2) {
            along.push(along[along.len() - 1] + pair[0].distance(pair[1]));
        }
        along.truncate(self.nominal.len());
        let directions = self.directions();
        let across = self.pieces.iter().map(|piece| {
            let points = piece.iter().zip(&self.nominal).zip(&directions);
            points.map(|((p, n), d)| (*p - *n).dot(*d)).collect()
        });
        CloudSpread {
            across: across.collect(),
            along,
        }
    }

    /// For every pose the unit vector across the path in which the pieces scatter most; its sign is continuous along
    /// the path.
    fn directions(&self) -> Vec<DVec3> {
        let mut directions: Vec<DVec3> = Vec::with_capacity(self.nominal.len());
        for k in 0..self.nominal.len() {
            let first = path_tangent(&self.nominal, k).any_orthonormal_vector();
            let second = path_tangent(&self.nominal, k).cross(first);
            let (mut a, mut b, mut c) = (0.0, 0.0, 0.0);
            for piece in &self.pieces {
                let off = piece[k] - self.nominal[k];
                let (x, y) = (off.dot(first), off.dot(second));
                (a, b, c) = (a + x * x, b + x * y, c + y * y);
            }
            // The major axis of the scatter matrix [a b; b c].
            let angle = 0.5 * libm::atan2(2.0 * b, a - c);
            let mut direction = first * libm::cos(angle) + second * libm::sin(angle);
            let before = directions.last();
            if before.is_some_and(|before| before.dot(direction) < 0.0) {
                direction = -direction;
            }
            directions.push(direction);
        }
        directions
    }

    /// The factor, 1, 2 or 5 times a power of ten, that magnifies deviations to about `share` of the path's extent; one
    /// if they are that large already or zero.
    pub fn enlargement(&self, share: f64) -> f64 {
        let far = |p: &[DVec3]| {
            let pairs = p.iter().zip(&self.nominal);
            pairs.map(|(p, n)| p.distance(*n)).fold(0.0, f64::max)
        };
        let mut all: Vec<f64> = self.pieces.iter().map(|p| far(p)).collect();
        all.sort_unstable_by(f64::total_cmp);
        let usual = all.get(all.len() / 2).copied().unwrap_or(0.0);
        let ends = self
            .nominal
            .iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| {
                (low.min(*p), high.max(*p))
            });
        let wanted = share * (ends.1 - ends.0).length() / usual;
        if !(wanted.is_finite() && wanted > 1.0) {
            return 1.0;
        }
        let decade = libm::pow(10.0, libm::floor(libm::log10(wanted)));
        let step = [5.0, 2.0, 1.0].into_iter().find(|s| s * decade <= wanted);
        step.unwrap_or(1.0) * decade
    }
}

/// The unit tangent at point `k`, by central differences; z where the point does not move.
fn path_tangent(path: &[DVec3], k: usize) -> DVec3 {
    let (before, after) = (k.saturating_sub(1), (k + 1).min(path.len() - 1));
    (path[after] - path[before])
        .try_normalize()
        .unwrap_or(DVec3::Z)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cloud() -> PathCloud {
        let at = |k: usize, y: f64, z: f64| DVec3::new(10.0 * k as f64, y, z);
        let line = |y: f64, z: f64| (0..5).map(|k| at(k, y, z)).collect::<Vec<_>>();
        PathCloud {
            track: "t".to_owned(),
            trace: "M".to_owned(),
            colour: [0; 3],
            nominal: line(0.0, 0.0),
            pieces: vec![line(3.0, 4.0), line(-6.0, -8.0), line(0.4, -0.3)],
        }
    }

    #[test]
    fn deviations_are_taken_where_the_pieces_scatter_most() {
        let spread = cloud().spread();
        assert_eq!(spread.along, [0.0, 10.0, 20.0, 30.0, 40.0]);
        let sense = spread.across[0][0].signum();
        for k in 0..5 {
            let wanted = [5.0, -10.0, 0.0].map(|d| sense * d);
            for (piece, wanted) in spread.across.iter().zip(wanted) {
                assert!((piece[k] - wanted).abs() < 0.05, "{piece:?} {wanted}");
            }
        }
    }

    #[test]
    fn enlargements_are_round_and_never_shrink() {
        // The second piece deviates by 5 on a path of length 40.
        assert_eq!(cloud().enlargement(0.05), 1.0);
        assert_eq!(cloud().enlargement(0.6), 2.0);
        assert_eq!(cloud().enlargement(8.0), 50.0);
        let mut none = cloud();
        none.pieces.clear();
        assert_eq!(none.enlargement(0.5), 1.0);
    }
}
