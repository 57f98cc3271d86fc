//! The motion of the camera: keys over time and a rotation about the up axis. Plain data and their interpolation;
//! `staging` decides what the camera includes.

use glam::DVec3;

/// A key of a camera's path; `None` is interpolated between the keys that have a value.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CameraKey {
    /// Seconds.
    pub time: f64,
    /// Radians, as for [`View::azimuth`](super::view::View::azimuth); values more than a turn apart mean a rotation by
    /// that angle.
    pub azimuth: Option<f64>,
    /// Radians, as of [`View::elevation`](super::view::View::elevation).
    pub elevation: Option<f64>,
    /// Size of the mechanism in the picture; at 1 the whole motion just fits.
    pub zoom: Option<f64>,
    /// Distance of the eye from the target in the scene's unit; takes precedence over `zoom`.
    pub distance: Option<f64>,
    /// The point in the middle of the picture.
    pub target: Option<DVec3>,
}

/// A camera that moves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CameraPath {
    /// In ascending order of time.
    pub keys: Vec<CameraKey>,
    /// Radians that the camera rotates about the up axis during the motion, in addition to the keys.
    pub orbit: f64,
}

/// A camera path at an instant; `None` if no key has a value.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct CameraInstant {
    pub azimuth: Option<f64>,
    pub elevation: Option<f64>,
    pub zoom: Option<f64>,
    pub distance: Option<f64>,
    pub target: Option<DVec3>,
}

impl CameraPath {
    /// Whether the camera keeps the view's direction.
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty() && self.orbit == 0.0
    }

    /// The path without its azimuths, or without its elevations, which are given elsewhere.
    pub fn forget(&mut self, azimuth: bool, elevation: bool) {
        for key in &mut self.keys {
            key.azimuth = key.azimuth.filter(|_| !azimuth);
            key.elevation = key.elevation.filter(|_| !elevation);
        }
    }

    /// The camera at `time` by the keys, without the orbit.
    pub fn at(&self, time: f64) -> CameraInstant {
        let along = |pick: &dyn Fn(&CameraKey) -> Option<f64>| {
            let said = self
                .keys
                .iter()
                .filter_map(|key| Some((key.time, pick(key)?)));
            interpolate_points(&said.collect::<Vec<_>>(), time)
        };
        let part = |axis: usize| along(&|key| key.target.map(|target| target[axis]));
        let target = [part(0), part(1), part(2)];
        CameraInstant {
            azimuth: along(&|key| key.azimuth),
            elevation: along(&|key| key.elevation),
            zoom: along(&|key| key.zoom),
            distance: along(&|key| key.distance),
            target: match target {
                [Some(x), Some(y), Some(z)] => Some(DVec3::new(x, y, z)),
                _ => None,
            },
        }
    }
}

/// The value at `time` of a curve through points in ascending order of time, constant before the first and after the
/// last. `None` without points.
///
/// A piecewise cubic with the slopes of Fritsch and Carlson (SIAM J. Numer. Anal. 17, 1980) in the harmonic form of
/// Fritsch and Butland: the speed has no jumps, and the curve stays between neighbouring points. It rests at both ends.
fn interpolate_points(points: &[(f64, f64)], time: f64) -> Option<f64> {
    let next = points.partition_point(|point| point.0 <= time);
    if next == 0 {
        return points.first().map(|point| point.1);
    }
    let Some(&(end, to)) = points.get(next) else {
        return points.last().map(|point| point.1);
    };
    let (start, from) = points[next - 1];
    let span = end - start;
    let share = (time - start) / span;
    let [leaving, arriving] = [next - 1, next].map(|k| point_slope(points, k) * span);
    let rest = 1.0 - share;
    // Hermite's basis.
    Some(
        from * rest * rest * (1.0 + 2.0 * share)
            + to * share * share * (3.0 - 2.0 * share)
            + leaving * share * rest * rest
            - arriving * share * share * rest,
    )
}

/// Speed of the curve at point `k`; 0 at the ends and where the curve reverses.
fn point_slope(points: &[(f64, f64)], k: usize) -> f64 {
    if k == 0 || k + 1 == points.len() {
        return 0.0;
    }
    let chord = |a: usize| (points[a + 1].1 - points[a].1) / (points[a + 1].0 - points[a].0);
    let (before, after) = (chord(k - 1), chord(k));
    if before * after <= 0.0 {
        return 0.0;
    }
    let spans = [points[k].0 - points[k - 1].0, points[k + 1].0 - points[k].0];
    let weights = [2.0 * spans[1] + spans[0], spans[1] + 2.0 * spans[0]];
    (weights[0] + weights[1]) / (weights[0] / before + weights[1] / after)
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINTS: [(f64, f64); 5] = [(0.0, 1.0), (1.0, 2.0), (1.5, 7.0), (4.0, 7.5), (5.0, -2.0)];

    #[test]
    fn the_curve_meets_its_points_and_stands_still_beyond_them() {
        for (time, value) in POINTS {
            assert_eq!(interpolate_points(&POINTS, time), Some(value));
        }
        assert_eq!(interpolate_points(&POINTS, -3.0), Some(1.0));
        assert_eq!(interpolate_points(&POINTS, 9.0), Some(-2.0));
        assert_eq!(interpolate_points(&[(2.0, 5.0)], 0.0), Some(5.0));
        assert_eq!(interpolate_points(&[], 0.0), None);
    }

    #[test]
    fn the_curve_stays_between_neighbours_and_its_speed_has_no_jumps() {
        let step = 1e-4;
        let at = |k: i32| interpolate_points(&POINTS, f64::from(k) * step).unwrap_or(f64::NAN);
        for pair in POINTS.windows(2) {
            let first = (pair[0].0 / step).round() as i32;
            let last = (pair[1].0 / step).round() as i32;
            let [low, high] = [pair[0].1.min(pair[1].1), pair[0].1.max(pair[1].1)];
            assert!((first..=last).all(|k| at(k) >= low - 1e-12 && at(k) <= high + 1e-12));
        }
        // The steepest chord is 10 a second within half a second: bends beyond that would be jumps.
        let bend = |k: i32| (at(k + 1) - 2.0 * at(k) + at(k - 1)).abs() / step;
        assert!((-20_000..70_000).all(|k| bend(k) < 0.05));
    }

    #[test]
    fn every_quantity_follows_the_keys_that_say_it() {
        let key = |time, azimuth, target| CameraKey {
            time,
            azimuth,
            target,
            ..CameraKey::default()
        };
        let path = CameraPath {
            keys: vec![
                key(0.0, Some(0.0), None),
                key(1.0, None, Some(DVec3::X)),
                key(2.0, Some(4.0), None),
            ],
            orbit: 0.0,
        };
        let middle = path.at(1.0);
        assert_eq!(middle.azimuth, Some(2.0));
        assert_eq!(middle.target, Some(DVec3::X));
        assert_eq!((middle.elevation, middle.zoom), (None, None));
    }
}
