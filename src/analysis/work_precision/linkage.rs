//! Routes of a linkage of dyads that move its points, beside those that move the mechanism's coordinates.

use super::row::{PrecisionRow, fastest_run};
use crate::analysis::dyads::{PlanarRow, planar_row};
use crate::analysis::observer::largest_distance;
use crate::analysis::point_routes::{DrivenLinkage, PlanePoints, VelocityRows};
use crate::analysis::reference::Reference;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;

/// A linkage whose points are moved by their velocities.
pub(super) struct LinkageBench<'b> {
    actuation: &'b Actuation,
    linkage: DrivenLinkage,
    /// Places of the points at the instants after the start.
    truth: Vec<PlanePoints>,
    /// The unit of the input's rate.
    unit: f64,
    /// The mechanism's.
    size: f64,
}

impl<'b> LinkageBench<'b> {
    /// The mechanism as a linkage of dyads with a crank; `None` if it is none, or not at every instant.
    pub fn new(system: &System, actuation: &'b Actuation, reference: &Reference) -> Option<Self> {
        let mechanism = system.mechanism();
        let [input] = mechanism.inputs.as_slice() else {
            return None;
        };
        let poses = reference.poses.iter();
        let rows: Option<Vec<PlanarRow>> = poses
            .map(|pose| planar_row(system, pose.as_ref()?, 0).ok())
            .collect();
        let rows = rows?;
        let is_same = rows.iter().all(|row| row.names == rows[0].names);
        let truth = rows[1..].iter().map(|row| row.chain.points.clone());
        let truth = truth.collect();
        let linkage = DrivenLinkage::new(rows[0].clone(), rows.get(1)?)?;
        is_same.then(|| Self {
            actuation,
            linkage,
            truth,
            unit: mechanism.unit_of(input.kind).number(),
            size: mechanism.size,
        })
    }

    /// All settings.
    pub fn rows(&self) -> Vec<PrecisionRow> {
        let settings: [(&'static str, VelocityRows, usize, &[usize]); 4] = [
            ("Euler on the bars", VelocityRows::Bars, 1, &[1, 4]),
            (
                "Runge-Kutta 4 on the bars",
                VelocityRows::Bars,
                4,
                &[1, 2, 4, 16],
            ),
            ("Euler on system (3)", VelocityRows::Dyads, 1, &[1, 4]),
            (
                "Runge-Kutta 4 on system (3)",
                VelocityRows::Dyads,
                4,
                &[1, 2, 4, 16],
            ),
        ];
        let rows = settings
            .into_iter()
            .flat_map(|(family, rows, order, factors)| {
                let one = move |factor: &usize| self.row(family, (rows, order), *factor);
                factors.iter().map(one)
            });
        rows.collect()
    }

    fn row(
        &self,
        family: &'static str,
        method: (VelocityRows, usize),
        factor: usize,
    ) -> PrecisionRow {
        let (found, time) = fastest_run(|| self.walk(method, factor));
        let pairs = found.iter().zip(&self.truth);
        let errors = pairs
            .map(|(points, truth)| largest_distance(points.as_flattened(), truth.as_flattened()));
        let errors: Vec<f64> = errors.collect();
        let closures = found
            .iter()
            .map(|points| self.linkage.length_error(points) / self.size);
        PrecisionRow {
            family,
            steps: self.truth.len() * factor,
            time: time * 1e6 / self.truth.len() as f64,
            ..PrecisionRow::new(&errors, closures, (self.truth.len(), self.size))
        }
    }

    /// The points at all instants after the start; those after a failure are missing.
    fn walk(&self, method: (VelocityRows, usize), factor: usize) -> Vec<PlanePoints> {
        let drive = &self.actuation.drives[0];
        let rate = |time: f64| drive.series(time, 1).coefficients()[1] / self.unit;
        let steps = self.truth.len() * factor;
        let time = |k: usize| self.actuation.duration * (k as f64 / steps as f64);
        let mut points = self.linkage.points().to_vec();
        let mut found = Vec::with_capacity(self.truth.len());
        for k in 0..steps {
            let next = (self.linkage).advance(method, &points, [time(k), time(k + 1)], &rate);
            let Some(next) = next else { break };
            points = next;
            if (k + 1) % factor == 0 {
                found.push(points.clone());
            }
        }
        found
    }
}
