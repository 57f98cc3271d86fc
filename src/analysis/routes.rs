//! Routes from pose to pose along the drive: closing the loops at every step, or integrating their rates.
//!
//! They exist for comparison only. mechanim itself uses [`continuation`](crate::kinematics::motion::continuation).

use crate::kinematics::loops::residual::{BlockWorkspace, Want};
use crate::kinematics::rates::columns::By;
use crate::kinematics::rates::higher_order::higher_rates;
use crate::kinematics::solve::newton::Corrector;
use crate::kinematics::structure::block::Block;
use crate::kinematics::structure::system::System;
use crate::linalg::pivoted_qr::PivotedQr;
use crate::linalg::svd::RANK_TOLERANCE;
use crate::math::left_jacobian_inverse;
use crate::model::actuation::Actuation;
use glam::{DMat3, DQuat, DVec3};

/// Newton steps after which a pose counts as lost.
const MOST_ITERATIONS: u32 = 30;

/// Closure error aimed at by a projection after an integration step: just above rounding.
pub const TIGHT: f64 = 1e-13;

/// The residual of a loop's rotation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RotationForm {
    /// The rotation vector: zero at the identity only.
    Log,
    /// The skew part of the matrix: it is also zero at half-turns.
    Skew,
}

/// The kind of step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Route {
    /// Prediction, then Newton's method on the loops.
    Position {
        /// Order of the Taylor polynomial used for prediction; 0 starts from the last pose.
        predictor: usize,
        /// Newton ends when no entry of the residual is larger.
        tolerance: f64,
        /// Form of the residual.
        form: RotationForm,
    },
    /// Integration of J q' = -F_t.
    Ode {
        /// Order of the method: 1 for Euler, 4 for the classical Runge-Kutta.
        order: usize,
        /// Newton closes the loops again after every step.
        projected: bool,
    },
}

/// Follows the drive of one mechanism, with buffers shared by all steps.
pub struct Walker<'m> {
    system: &'m System,
    actuation: &'m Actuation,
    corrector: Corrector,
    workspace: BlockWorkspace,
    qr: PivotedQr,
    right_side: Vec<f64>,
    step: Vec<f64>,
    /// Newton iterations of all blocks so far.
    pub iterations: u64,
}

impl<'m> Walker<'m> {
    /// For `system` along `actuation`.
    pub fn new(system: &'m System, actuation: &'m Actuation) -> Self {
        Self {
            system,
            actuation,
            corrector: Corrector::new(system),
            workspace: BlockWorkspace::default(),
            qr: PivotedQr::default(),
            right_side: Vec::new(),
            step: Vec::new(),
            iterations: 0,
        }
    }

    /// From the pose in `coordinates` at time `from` to one at `to`; `None` where Newton does not converge.
    pub fn advance(
        &mut self,
        route: Route,
        coordinates: &mut [f64],
        from: f64,
        to: f64,
    ) -> Option<()> {
        match route {
            Route::Position {
                predictor,
                tolerance,
                form,
            } => {
                self.predict(predictor, coordinates, from, to)?;
                self.close(coordinates, tolerance, form)
            }
            Route::Ode { order, projected } => {
                match order {
                    1 => self.euler(coordinates, from, to),
                    _ => self.runge_kutta(coordinates, from, to),
                }
                // The projection returns to a closed pose, so that errors do not accumulate in the loops.
                if projected {
                    self.close(coordinates, TIGHT, RotationForm::Log)?;
                }
                Some(())
            }
        }
    }

    fn set_inputs(&self, coordinates: &mut [f64], time: f64) {
        let inputs = self.actuation.inputs_at(time);
        coordinates[self.system.mechanism().unknowns.len()..].copy_from_slice(&inputs);
    }

    fn predict(&mut self, order: usize, coordinates: &mut [f64], from: f64, to: f64) -> Option<()> {
        let h = to - from;
        match order {
            0 => {}
            1 => {
                let velocity = self.velocity(coordinates, from);
                coordinates
                    .iter_mut()
                    .zip(velocity)
                    .for_each(|(q, v)| *q += h * v);
            }
            _ => {
                let n = self.system.mechanism().unknowns.len();
                let inputs = By::Time.inputs(self.actuation, &coordinates[n..], from, order);
                // Taylor polynomial of the motion at the last pose.
                let series = higher_rates(self.system, coordinates, &inputs, order)?;
                coordinates
                    .iter_mut()
                    .zip(&series)
                    .for_each(|(q, s)| *q = s.value_at(h));
            }
        }
        self.set_inputs(coordinates, to);
        Some(())
    }

    /// Newton's method, block by block, until the residual is at most `tolerance`.
    fn close(&mut self, coordinates: &mut [f64], tolerance: f64, form: RotationForm) -> Option<()> {
        let structure = self.system.structure();
        for block in &structure.blocks {
            let mut left = MOST_ITERATIONS;
            loop {
                self.workspace.evaluate(
                    self.system.mechanism(),
                    block,
                    coordinates,
                    Want::Jacobian,
                );
                // The other formulation of the residual, for comparison.
                if form == RotationForm::Skew {
                    self.take_skew_part(block);
                }
                let residual = self.workspace.residual_norm();
                if residual <= tolerance || block.unknowns.is_empty() {
                    break;
                }
                left = left.checked_sub(1)?;
                if !residual.is_finite() {
                    return None;
                }
                self.newton_step(block, coordinates);
                self.iterations += 1;
            }
        }
        Some(())
    }

    fn newton_step(&mut self, block: &Block, coordinates: &mut [f64]) {
        let (rows, columns) = (block.rows(), block.unknowns.len());
        self.qr
            .factor(&self.workspace.jacobian, rows, columns, RANK_TOLERANCE);
        self.right_side.clear();
        self.right_side
            .extend(self.workspace.residual.iter().map(|r| -r));
        self.step.clear();
        self.step.resize(columns, 0.0);
        self.qr.solve(&mut self.right_side, &mut self.step);
        for (unknown, step) in block.unknowns.iter().zip(&self.step) {
            coordinates[*unknown] += self.system.mechanism().scale_of(*unknown) * step;
        }
    }

    /// Replaces the rotation vector and its derivatives by the skew part of the rotation.
    fn take_skew_part(&mut self, block: &Block) {
        let mut row = 0;
        for part in &block.loops {
            let turns: Vec<usize> = part.components.iter().copied().filter(|c| *c < 3).collect();
            // Components are in order, rotation first; missing ones are zero at every pose.
            let at = |list: &[f64], first: usize| {
                let mut vector = [0.0; 3];
                for (k, component) in turns.iter().enumerate() {
                    vector[*component] = list[first + k];
                }
                DVec3::from_array(vector)
            };
            let (skew, skew_from_log) = skew_of(at(&self.workspace.residual, row));
            for column in 0..block.unknowns.len() {
                let first = column * block.rows() + row;
                let rate = skew_from_log * at(&self.workspace.jacobian, first);
                for (k, component) in turns.iter().enumerate() {
                    self.workspace.jacobian[first + k] = rate[*component];
                }
            }
            for (k, component) in turns.iter().enumerate() {
                self.workspace.residual[row + k] = skew[*component];
            }
            row += part.components.len();
        }
    }

    /// Rates per second of all coordinates at `time`; those of the inputs come from the drive.
    fn velocity(&mut self, coordinates: &[f64], time: f64) -> Vec<f64> {
        let mut velocity = vec![0.0; coordinates.len()];
        let n = self.system.mechanism().unknowns.len();
        for (rate, input) in velocity[n..].iter_mut().zip(&self.actuation.drives) {
            *rate = input.series(time, 1).derivative(1);
        }
        self.corrector
            .tangent(self.system, coordinates, &mut velocity);
        velocity
    }

    fn euler(&mut self, coordinates: &mut [f64], from: f64, to: f64) {
        let velocity = self.velocity(coordinates, from);
        coordinates
            .iter_mut()
            .zip(velocity)
            .for_each(|(q, v)| *q += (to - from) * v);
        self.set_inputs(coordinates, to);
    }

    /// The classical method of fourth order. Inputs follow the drive at every stage, so that only the unknowns drift.
    fn runge_kutta(&mut self, coordinates: &mut [f64], from: f64, to: f64) {
        let h = to - from;
        let middle = from + 0.5 * h;
        let mut sum = vec![0.0; coordinates.len()];
        let mut slope = vec![0.0; coordinates.len()];
        let mut stage = coordinates.to_vec();
        for (time, reach, weight) in [
            (from, 0.0, 1.0),
            (middle, 0.5, 2.0),
            (middle, 0.5, 2.0),
            (to, 1.0, 1.0),
        ] {
            // Stage k from the slope of the one before.
            for (k, q) in stage.iter_mut().enumerate() {
                *q = coordinates[k] + reach * h * slope[k];
            }
            self.set_inputs(&mut stage, time);
            slope = self.velocity(&stage, time);
            sum.iter_mut()
                .zip(&slope)
                .for_each(|(s, v)| *s += weight * v);
        }
        coordinates
            .iter_mut()
            .zip(&sum)
            .for_each(|(q, s)| *q += h / 6.0 * s);
        self.set_inputs(coordinates, to);
    }
}

/// Skew part of the rotation exp(w), and the map from rates of w to rates of it.
///
/// With R' = s × R, column by column, the skew part changes by (tr(R) I - R) s / 2; w' is the inverse left Jacobian
/// times s.
fn skew_of(w: DVec3) -> (DVec3, DMat3) {
    let angle = w.length();
    let rotation = DMat3::from_quat(DQuat::from_scaled_axis(w));
    let trace = rotation.x_axis.x + rotation.y_axis.y + rotation.z_axis.z;
    let skew_from_spin = (DMat3::from_diagonal(DVec3::splat(trace)) - rotation) * 0.5;
    let skew = if angle > 0.0 {
        w * (libm::sin(angle) / angle)
    } else {
        w
    };
    (skew, skew_from_spin * left_jacobian_inverse(w).inverse())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_skew_parts_derivative_is_that_of_differences() {
        for w in [
            [0.3, -0.2, 0.5],
            [0.0, 0.0, 2.9],
            [1e-3, 0.0, 0.0],
            [-1.0, 1.5, 0.7],
        ] {
            let (w, h) = (DVec3::from_array(w), 1e-6);
            let (_, map) = skew_of(w);
            for (axis, step) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().enumerate() {
                let difference = (skew_of(w + step * h).0 - skew_of(w - step * h).0) / (2.0 * h);
                assert!((map.col(axis) - difference).length() < 1e-8, "{w} {axis}");
            }
        }
    }
}
