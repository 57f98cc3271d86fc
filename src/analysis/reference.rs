//! Poses that are better than any route's: solved, proved, and corrected once more with a residual of 31 digits.

use crate::kinematics::certificate::Certificate;
use crate::kinematics::certificate::chain::{ArgumentDouble, evaluate};
use crate::kinematics::closure::{BlockWorkspace, Want};
use crate::kinematics::continuation::solve;
use crate::kinematics::qr::PivotedQr;
use crate::kinematics::rank::RANK_TOLERANCE;
use crate::kinematics::structure::{Block, Structure, StructureError};
use crate::model::chain::Argument;
use crate::model::expression::Affine;
use crate::model::mechanism::Mechanism;

/// The true motion at some instants, as well as f64 can say it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reference {
    /// Seconds.
    pub times: Vec<f64>,
    /// Unknowns, then inputs, at these times; `None` where the mechanism cannot be closed.
    pub poses: Vec<Option<Vec<f64>>>,
    /// Worst proved error of the poses before the last correction, in the scene's unit; `None` where any has no proof.
    pub bound: Option<f64>,
}

impl Reference {
    /// Solves `mechanism` at `times`.
    ///
    /// # Errors
    /// Only where the mechanism itself is ill-posed.
    pub fn new(
        mechanism: &Mechanism,
        structure: &Structure,
        times: Vec<f64>,
    ) -> Result<Self, StructureError> {
        let trajectory = solve(mechanism, &times)?;
        let mut bound = Some(0.0_f64);
        let mut poses = Vec::with_capacity(times.len());
        for sample in &trajectory.samples {
            let Some(pose) = &sample.pose else {
                poses.push(None);
                continue;
            };
            bound = match (bound, pose.certificate) {
                (Some(worst), Certificate::Certified { error_bound, .. }) => {
                    Some(worst.max(error_bound))
                }
                _ => None,
            };
            let mut coordinates = [pose.unknowns.as_slice(), &sample.inputs].concat();
            refine(mechanism, structure, &mut coordinates);
            poses.push(Some(coordinates));
        }
        Ok(Self {
            times,
            poses,
            bound,
        })
    }
}

/// One Newton step with the residual to 31 digits, block by block. Of blocks that are no loops of affine arguments the
/// residual is only known in f64.
fn refine(mechanism: &Mechanism, structure: &Structure, coordinates: &mut [f64]) {
    let (mut workspace, mut qr) = (BlockWorkspace::default(), PivotedQr::default());
    for block in &structure.blocks {
        let (rows, columns) = (block.rows(), block.unknowns.len());
        workspace.evaluate(mechanism, block, coordinates, Want::Jacobian);
        qr.factor(&workspace.jacobian, rows, columns, RANK_TOLERANCE);
        if qr.rank() < columns {
            continue;
        }
        let precise = residual(mechanism, block, coordinates);
        let mut right_side = precise.unwrap_or_else(|| workspace.residual.clone());
        let mut step = vec![0.0; columns];
        right_side.iter_mut().for_each(|r| *r = -*r);
        qr.solve(&mut right_side, &mut step);
        for (unknown, step) in block.unknowns.iter().zip(&step) {
            coordinates[*unknown] += mechanism.scale_of(*unknown) * step;
        }
    }
}

/// The block's residual, rounded once at the end; `None` where it cannot be had.
fn residual(mechanism: &Mechanism, block: &Block, coordinates: &[f64]) -> Option<Vec<f64>> {
    if !block.equations.is_empty() {
        return None;
    }
    let unused = Affine::default();
    let mut forms: Vec<&Affine> = vec![&unused; mechanism.arguments.len()];
    for index in &block.arguments {
        forms[*index] = match &mechanism.arguments[*index] {
            Argument::Affine(affine) => affine,
            Argument::Formula(_) => return None,
        };
    }
    let arguments: Vec<ArgumentDouble> = forms
        .into_iter()
        .map(|form| ArgumentDouble::new(form, coordinates))
        .collect();
    let mut residual = Vec::with_capacity(block.rows());
    for part in &block.loops {
        let steps = &mechanism.loops[part.index].chain.steps;
        let item = evaluate(steps, &arguments, |_| 0.0, mechanism.size);
        residual.extend(part.components.iter().map(|c| item.residual[*c]));
    }
    Some(residual)
}
