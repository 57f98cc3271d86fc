//! The keys of `[view]` that move the camera.

use super::super::views::{CameraKeyFile, ViewFile};
use super::body_constants::BodyConstants;
use crate::diag::{Diagnostic, Diagnostics, shown_number};
use crate::model::camera_path::{CameraKey, CameraPath};

/// Largest orbit in degrees.
pub const MOST_ORBIT: f64 = 36_000.0;

/// Largest azimuth of a key in degrees: a hundred turns.
const MOST_AZIMUTH: f64 = 36_000.0;

/// Least and greatest zoom.
const ZOOMS: [f64; 2] = [0.01, 100.0];

/// Resolves them; errors are reported and skipped.
pub fn resolve_camera(
    view: &ViewFile,
    constants: &BodyConstants,
    diagnostics: &mut Diagnostics,
) -> CameraPath {
    let turns = [-MOST_ORBIT, MOST_ORBIT];
    let orbit = constants.angle_within("orbit", &view.orbit, turns, diagnostics);
    let mut keys: Vec<CameraKey> = Vec::new();
    // Keys are interpolated in time: all but a single one need a time, in ascending order.
    let alone = view.camera_path.len() == 1;
    for file in &view.camera_path {
        let Some(key) = camera_key(file, alone, constants, diagnostics) else {
            continue;
        };
        if let Some(last) = keys.last().filter(|last| last.time >= key.time) {
            let [last, time] = [last.time, key.time].map(shown_number);
            let message = format!("camera keys must ascend in time: {time} comes after {last}");
            let place = file.t.as_ref().map_or(&file.span, |t| &t.span);
            diagnostics.push(Diagnostic::error(message).at(place.clone()));
            continue;
        }
        keys.push(key);
    }
    CameraPath {
        keys,
        orbit: orbit.unwrap_or(0.0),
    }
}

fn camera_key(
    file: &CameraKeyFile,
    alone: bool,
    constants: &BodyConstants,
    diagnostics: &mut Diagnostics,
) -> Option<CameraKey> {
    let all = [-f64::MAX, f64::MAX];
    let time = constants.within("t", &file.t, all, diagnostics);
    // A single key needs no time: the camera stays there.
    if file.t.is_none() && !alone {
        let message = "a camera key needs `t`, its time in seconds";
        diagnostics.push(Diagnostic::error(message).at(file.span.clone()));
        return None;
    }
    let [turns, heights] = [MOST_AZIMUTH, 90.0].map(|most| [-most, most]);
    let azimuth = constants.angle_within("azimuth", &file.azimuth, turns, diagnostics);
    let elevation = constants.angle_within("elevation", &file.elevation, heights, diagnostics);
    let zoom = constants.within("zoom", &file.zoom, ZOOMS, diagnostics);
    let distance = file.distance.as_ref();
    // Both determine the distance of the eye.
    if let (Some(_), Some(distance)) = (&file.zoom, distance) {
        let message = "a camera key has a `zoom` or a `distance`, not both";
        diagnostics.push(Diagnostic::error(message).at(distance.span.clone()));
    }
    let distance = distance.and_then(|d| constants.positive("distance", d, diagnostics));
    let target = file.target.as_ref();
    let target = target.and_then(|target| constants.vector(target, diagnostics));
    Some(CameraKey {
        time: time.unwrap_or(0.0),
        azimuth,
        elevation,
        zoom,
        distance,
        target,
    })
}
