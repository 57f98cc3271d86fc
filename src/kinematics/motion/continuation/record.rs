//! What is kept of an accepted pose: bodies, traces, outputs, rates, and the proof beside them.

use super::{Follower, Stand};
use crate::kinematics::loops::forward;
use crate::kinematics::results::trajectory::{ClosedPose, Sample};

/// Half width, in seconds relative to the interval, of the difference that gives the drive's rate.
const RATE_STEP: f64 = 1e-6;

impl Follower<'_> {
    pub(crate) fn record_missing(&mut self, time: f64) {
        let inputs = self.actuation.inputs_at(time);
        self.trajectory.samples.push(Sample {
            time,
            inputs,
            pose: None,
        });
    }

    pub(crate) fn record(&mut self, stand: &Stand) {
        let pose = self.closed_pose(stand);
        let n = self.system.mechanism().unknowns.len();
        self.trajectory.samples.push(Sample {
            time: stand.time,
            inputs: stand.coordinates[n..].to_vec(),
            pose,
        });
    }

    /// Everything that is kept of a pose; `None` if any body's place is not a number.
    pub(crate) fn closed_pose(&mut self, stand: &Stand) -> Option<ClosedPose> {
        let n = self.system.mechanism().unknowns.len();
        let mut coordinates = stand.coordinates.clone();
        let certificate = self.certified(&mut coordinates);
        let coordinates = &coordinates;
        let bodies = forward::body_poses(self.system.mechanism(), coordinates);
        let traces = forward::trace_points(self.system.mechanism(), &bodies);
        let outputs = forward::outputs(self.system.mechanism(), coordinates, &traces);
        let closure_error = forward::closure_error(self.system.mechanism(), coordinates);
        let finite = bodies.iter().all(|p| p.is_finite()) && closure_error.is_finite();
        if !finite {
            return None;
        }
        Some(ClosedPose {
            unknowns: coordinates[..n].to_vec(),
            bodies,
            traces,
            outputs,
            rates: self.rates(stand),
            derivatives: Vec::new(),
            closure_error,
            sigma_min: stand.branch.sigma_min,
            condition: stand.branch.condition,
            // Holding an idle freedom is an equation more.
            rank: stand.branch.rank + self.system.structure().held.len(),
            branch: stand.branch.signature(),
            certificate,
            iterations: self.iterations,
        })
    }

    /// Rates of the unknowns per second: the tangent along the drive's own rate.
    pub(crate) fn rates(&mut self, stand: &Stand) -> Vec<f64> {
        let n = self.system.mechanism().unknowns.len();
        let h = RATE_STEP * self.actuation.duration;
        let (before, after) = (
            self.actuation.inputs_at(stand.time - h),
            self.actuation.inputs_at(stand.time + h),
        );
        let mut rates = vec![0.0; stand.coordinates.len()];
        for k in 0..before.len() {
            rates[n + k] = (after[k] - before[k]) / (2.0 * h);
        }
        if self
            .rates_in_chart(&stand.coordinates, &mut rates)
            .is_none()
        {
            self.corrector
                .tangent(self.system, &stand.coordinates, &mut rates);
        }
        rates.truncate(n);
        rates
    }
}
