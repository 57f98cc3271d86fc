//! The poses at which stretches part: at the breaks of the drive, and where a stretch is halved.

use super::drive::keys_between;
use super::prover::Prover;
use super::stretches::Station;
use crate::kinematics::results::certificate::{Obstacle, Refusal};
use crate::kinematics::solve::newton::Pace;

impl Prover<'_> {
    /// The interval's end and the breaks of the drive before it, the first one last.
    pub(super) fn by_keyframes(
        &mut self,
        start: &Station,
        end: Station,
    ) -> Result<Vec<Station>, Refusal> {
        let mut ahead = Vec::new();
        for time in keys_between(&self.actuation.drives, start.time, end.time) {
            let place = self.pose_between(start, &end, time).ok_or(Refusal {
                time: start.time,
                obstacle: Obstacle::NotJoined,
            })?;
            ahead.push(place);
        }
        ahead.push(end);
        ahead.reverse();
        Ok(ahead)
    }

    /// A closed pose at `time`, corrected from the straight line between two others; where that line leads to none, the
    /// motion is followed from the first one. Which assembly it is of is found out by the proof.
    pub(super) fn pose_between(&mut self, a: &Station, b: &Station, time: f64) -> Option<Station> {
        let share = (time - a.time) / (b.time - a.time);
        let actuation = &self.actuation;
        let inputs = actuation.inputs_at(time);
        let ends = [&a.unknowns[..], &b.unknowns[..]];
        let on_the_line = self.solver.between(ends, share, &inputs, Pace::Brisk);
        let found = on_the_line.or_else(|| {
            let inputs = |part: f64| match part < 1.0 {
                true => actuation.inputs_at(a.time + part * (time - a.time)),
                false => inputs.clone(),
            };
            self.solver.followed(&a.unknowns, inputs)
        });
        let mut unknowns = found?;
        unknowns.truncate(a.unknowns.len());
        Some(Station {
            time,
            unknowns,
            rates: None,
            sample: None,
        })
    }
}
