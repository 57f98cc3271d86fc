//! Measures of a motion: values over the poses of the drive or of a track, and formulas of them.

use super::continuation::solve;
use super::structure::StructureError;
use super::trajectory::{Sample, Trajectory};
use crate::model::drive::{Drive, Ease};
use crate::model::measure::{MeasureSource, Taking, Track};
use crate::model::mechanism::Mechanism;

/// Values of all measures in internal units, in the order of the mechanism; `None` where a pose is missing on the way
/// or a formula has no value. `trajectory` is the motion along the drive.
///
/// # Errors
/// Only where the mechanism itself is ill-posed.
pub fn measures(
    mechanism: &Mechanism,
    trajectory: &Trajectory,
) -> Result<Vec<Option<f64>>, StructureError> {
    let tracks = mechanism.tracks.iter().map(|track| along(mechanism, track));
    let tracks: Vec<Vec<Sample>> = tracks.collect::<Result<_, _>>()?;
    let mut values: Vec<Option<f64>> = Vec::new();
    for measure in &mechanism.measures {
        let value = match &measure.source {
            MeasureSource::Formula(formula) => {
                // A slot that has no value spoils what uses it.
                let slots: Vec<f64> = values.iter().map(|v| v.unwrap_or(f64::NAN)).collect();
                Some(formula.value(&slots))
            }
            MeasureSource::Over { track, of, taking } => {
                let samples = track.map_or(&trajectory.samples, |k| &tracks[k]);
                let rows: Option<Vec<Vec<f64>>> = samples
                    .iter()
                    .map(|sample| {
                        let pose = sample.pose.as_ref()?;
                        let mut slots = [pose.unknowns.as_slice(), &sample.inputs].concat();
                        slots.extend(pose.traces.iter().flat_map(|p| p.to_array()));
                        slots.extend(&pose.outputs);
                        Some(of.iter().map(|formula| formula.value(&slots)).collect())
                    })
                    .collect();
                rows.and_then(|rows| taken(*taking, &rows))
            }
        };
        values.push(value.filter(|v| v.is_finite()));
    }
    Ok(values)
}

/// The poses of a track. The motion goes there from the start of the drive, so that it stays on the branch.
fn along(mechanism: &Mechanism, track: &Track) -> Result<Vec<Sample>, StructureError> {
    let start = mechanism.inputs_at(0.0);
    let count = track.samples;
    let times: Vec<f64> = (0..=count).map(|k| k as f64).collect();
    let drives = start.iter().zip(track.from.iter().zip(&track.to));
    let drives = drives.map(|(start, (from, to))| {
        let steps = (0..count).map(|k| from + (to - from) * k as f64 / (count - 1) as f64);
        Drive::Keys {
            times: times.clone(),
            values: std::iter::once(*start).chain(steps).collect(),
            ease: Ease::Linear,
        }
    });
    let moved = Mechanism {
        drives: drives.collect(),
        duration: count as f64,
        ..mechanism.clone()
    };
    let mut samples = solve(&moved, &times)?.samples;
    samples.remove(0);
    Ok(samples)
}

/// One number of the rows; `None` if there are none.
fn taken(taking: Taking, rows: &[Vec<f64>]) -> Option<f64> {
    let (first, last) = (rows.first()?, rows.last()?);
    let values = || rows.iter().map(|row| row[0]);
    let min = || values().fold(f64::INFINITY, f64::min);
    let max = || values().fold(f64::NEG_INFINITY, f64::max);
    Some(match taking {
        Taking::First => first[0],
        Taking::Last => last[0],
        Taking::Change => last[0] - first[0],
        Taking::Min => min(),
        Taking::Max => max(),
        Taking::Range => max() - min(),
        Taking::Largest => values().fold(0.0, |largest, v| v.abs().max(largest)),
        Taking::Mean => values().sum::<f64>() / rows.len() as f64,
        Taking::Chord => libm::hypot(last[0] - first[0], last[1] - first[1]),
        Taking::Bow => {
            let (dx, dy) = (last[0] - first[0], last[1] - first[1]);
            let chord = libm::hypot(dx, dy);
            let distances = rows
                .iter()
                .map(|row| ((row[1] - first[1]) * dx - (row[0] - first[0]) * dy) / chord);
            distances.fold(0.0, |bow: f64, d| if d.abs() > bow.abs() { d } else { bow })
        }
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn numbers_are_taken_as_named() {
        let path = [[0.0, 0.0], [1.0, 2.0], [4.0, -1.0], [3.0, 4.0]].map(|p| p.to_vec());
        let expected = [0.0, 3.0, 3.0, 0.0, 4.0, 4.0, 4.0, 2.0, 5.0, -19.0 / 5.0];
        for ((name, taking), expected) in Taking::NAMES.into_iter().zip(expected) {
            assert!(
                (taken(taking, &path).unwrap() - expected).abs() < 1e-15,
                "{name}"
            );
        }
        assert_eq!(taken(Taking::Mean, &[]), None);
    }
}
