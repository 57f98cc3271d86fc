//! The actuation of a mechanism: the motion of every input over time, and the start values of the first pose.
//!
//! It is not part of the mechanism. One mechanism is solved with many of these: the scene's own drives, a table of
//! inputs, the tracks of its measures, a sweep.

use super::drive::{Drive, Ease};
use super::expression::continuity::Jumps;

/// Instants of a motion at which the size of its numbers is learned, as fractions of its duration.
pub const INSTANTS: [f64; 5] = [0.0, 0.21, 0.47, 0.73, 1.0];

/// Drives of all inputs, their duration, and start values of the unknowns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Actuation {
    /// Motion of each input, in the order of the mechanism's inputs.
    pub drives: Vec<Drive>,
    /// Length of the motion in seconds.
    pub duration: f64,
    /// Start values of the unknowns: radians, or the scene's length unit.
    pub guess: Vec<f64>,
    /// Which of these the scene names: preferences for the first pose. The others, and missing ones, are free.
    pub named: Vec<bool>,
}

impl Actuation {
    /// All inputs move linearly `from` one set of values `to` another within a second; the unknowns start at `guess`.
    pub fn straight(from: &[f64], to: &[f64], guess: Vec<f64>) -> Self {
        let pairs = from.iter().zip(to);
        let drives = pairs.map(|(from, to)| Drive::Keys {
            times: vec![0.0, 1.0],
            values: vec![*from, *to],
            ease: Ease::Linear,
        });
        Self {
            drives: drives.collect(),
            duration: 1.0,
            guess,
            named: Vec::new(),
        }
    }

    /// Merges instants of keys and jumps of different drives that differ by rounding only, such as 0.3 s and 0.1 s +
    /// 0.2 s. Between them one drive would have jumped and the other not.
    pub fn join_instants(&mut self) {
        let keys = self.drives.iter().flat_map(Drive::keys);
        let mut all: Vec<f64> = keys.copied().collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        let jumping = |time: f64| self.drives.iter().any(|drive| drive.jumps_at(time));
        // The instant that each key is moved to: that of a formula, whose numbers have more digits, otherwise the first
        // one.
        let mut joined: Vec<[f64; 2]> = Vec::new();
        for time in all {
            let first = joined.last().filter(|[last, _]| last.next_up() == time);
            let known = match first {
                Some([_, to]) => *to,
                None => {
                    let about = [time, time.next_up(), time.next_down()];
                    about.into_iter().find(|t| jumping(*t)).unwrap_or(time)
                }
            };
            joined.push([time, known]);
        }
        joined.retain(|[time, known]| time != known);
        let to = |time: f64| {
            let place = joined.binary_search_by(|[from, _]| from.total_cmp(&time));
            place.map_or(time, |k| joined[k][1])
        };
        for keys in self.drives.iter_mut().map(Drive::keys_mut) {
            for k in 0..keys.len() {
                let known = to(keys[k]);
                // Times of one drive stay separate.
                let beside = [k.checked_sub(1), Some(k + 1)].into_iter().flatten();
                if !beside
                    .filter_map(|k| keys.get(k))
                    .any(|other| *other == known)
                {
                    keys[k] = known;
                }
            }
        }
    }

    /// Where any input jumps between two instants, both included.
    pub fn jumps_between(&self, from: f64, to: f64) -> Jumps {
        let jumps = self
            .drives
            .iter()
            .map(|drive| drive.jumps_between(from, to));
        jumps.fold(Jumps::default(), Jumps::and)
    }

    /// Values of the inputs at `time`; not finite where a drive has no value.
    pub fn inputs_at(&self, time: f64) -> Vec<f64> {
        self.values_at(time).collect()
    }

    /// Values of the inputs at a part of the way between two instants; a part of one is exactly the second instant.
    pub fn inputs_along(&self, [from, until]: [f64; 2], part: f64) -> Vec<f64> {
        self.inputs_at(match part < 1.0 {
            true => from + part * (until - from),
            false => until,
        })
    }

    /// Values of the inputs at `time`, one after the other.
    pub fn values_at(&self, time: f64) -> impl Iterator<Item = f64> + '_ {
        self.drives.iter().map(move |drive| drive.value(time))
    }

    /// Rates of the inputs per second at `time`; not finite where a drive has none.
    pub fn rates_at(&self, time: f64) -> Vec<f64> {
        self.drives.iter().map(|drive| drive.rate(time)).collect()
    }

    /// Start values of all coordinates: the guess, then the inputs at `time`.
    pub fn start_at(&self, time: f64) -> Vec<f64> {
        [self.guess.clone(), self.inputs_at(time)].concat()
    }
}
