//! The data stored for an accepted pose: bodies, traces, outputs, rates, and its proof.

use super::recorder::Recorder;
use crate::kinematics::certificate::Certifier;
use crate::kinematics::loops::forward::Observation;
use crate::kinematics::motion::tracker::path_tracker::PathPoint;
use crate::kinematics::rates::rated::fill_rated_outputs;
use crate::kinematics::results::certificate::{Certificate, Reason};
use crate::kinematics::results::trajectory::{ClosedPose, Sample};
use crate::kinematics::solve::branch::best_rows;
use crate::kinematics::solve::newton::Corrector;
use crate::model::printed::InputReading;

impl Recorder<'_> {
    pub(crate) fn record_missing(&mut self, time: f64) {
        let inputs = self.tracker.actuation().inputs_at(time);
        self.samples.push(Sample {
            time,
            inputs,
            pose: None,
        });
    }

    pub(crate) fn record(&mut self, point: &PathPoint) {
        let sample = self.sample(point);
        self.samples.push(sample);
    }

    /// Stores a pose at which the motion ends or resumes, on request.
    pub(super) fn keep_edge(&mut self, point: &PathPoint) {
        if self.edges.is_some() {
            let sample = self.sample(point);
            self.edges
                .iter_mut()
                .for_each(|edges| edges.push(sample.clone()));
        }
    }

    fn sample(&mut self, point: &PathPoint) -> Sample {
        Sample {
            time: point.time,
            inputs: point.coordinates[self.tracker.unknowns()..].to_vec(),
            pose: self.closed_pose(point),
        }
    }

    /// All data of a pose; `None` if any body's position is not a number.
    pub(crate) fn closed_pose(&mut self, point: &PathPoint) -> Option<ClosedPose> {
        let system = self.tracker.system();
        let mechanism = system.mechanism();
        let mut coordinates = point.coordinates.to_vec();
        let certificate = self.certified(&mut coordinates);
        let mut seen = Observation::new(mechanism, &coordinates);
        let is_finite = seen.bodies.iter().all(|p| p.is_finite());
        if !(is_finite && seen.closure_error.is_finite()) {
            return None;
        }
        let driven = (self.tracker.actuation(), point.time);
        fill_rated_outputs(system, driven, &coordinates, &mut seen);
        coordinates.truncate(mechanism.unknowns.len());
        Some(ClosedPose {
            unknowns: coordinates,
            bodies: seen.bodies,
            traces: seen.traces,
            outputs: seen.outputs,
            rates: self.tracker.rates(point),
            derivatives: Vec::new(),
            closure_error: seen.closure_error,
            sigma_min: point.branch.sigma_min,
            condition: point.branch.condition,
            // Holding an idle freedom adds an equation.
            rank: point.branch.rank + system.structure().held.len(),
            branch: point.branch.signature(),
            certificate,
            iterations: self.tracker.solver.iterations,
        })
    }

    /// The certificate of a pose, which may move it within its error; failures due to locked angles alone have their
    /// own name.
    fn certified(&mut self, coordinates: &mut [f64]) -> Certificate {
        let Some((certifier, reading)) = &mut self.proof else {
            return Certificate::Refused {
                reason: Reason::NotAsked,
            };
        };
        let solver = &mut self.tracker.solver;
        let rests = match reading {
            InputReading::Numbers => Vec::new(),
            InputReading::Decimals => solver.system().mechanism().printed_rests(coordinates),
        };
        // At gimbal lock the angles have no proof; the rotations may have one.
        let chart = solver.chart().filter(|c| c.is_needed(coordinates));
        let (bases, corrector) = solver.proof_basis(coordinates);
        let certificate = certifier.polish(coordinates, &rests, bases, corrector);
        let is_singular = Certificate::Refused {
            reason: Reason::Singular,
        };
        match chart {
            Some(chart) if certificate == is_singular => {
                let own = chart.base(coordinates);
                let mut corrector = Corrector::new(chart.system);
                let rows = best_rows(chart.system, &mut corrector, &own);
                locked_certificate(Certifier::new(chart.system).certify(&own, &rests, &rows))
            }
            _ => certificate,
        }
    }
}

/// The certificate of a pose whose angles are too nearly locked to have one, from that of the joints' rotations.
fn locked_certificate(certificate: Certificate) -> Certificate {
    match certificate.bounds() {
        Some([error_bound, unique_radius]) => Certificate::Locked {
            error_bound,
            unique_radius,
            closes_to: certificate.closes_to(),
        },
        None => Certificate::Refused {
            reason: Reason::GimbalLock,
        },
    }
}
