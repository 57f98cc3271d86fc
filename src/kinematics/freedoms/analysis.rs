//! From a mechanism to its [`Structure`]: which equations say something, and in which order they can be solved.
//!
//! Everything here depends on the mechanism only, not on a pose. The order itself is found in
//! [`ordering`](crate::kinematics::structure::ordering), the poses that decide on ranks in [`generic_rank`](super::generic_rank),
//! passive freedoms in [`passive`](super::passive).

use super::generic_rank::{Ranks, closed_poses, random_poses};
use super::passive;
use crate::kinematics::loops::residual::{BlockWorkspace, Want};
use crate::kinematics::structure::block::{Block, Structure, StructureError, block, names};
use crate::kinematics::structure::loop_part::{LoopPart, component_name, components_of};
use crate::kinematics::structure::ordering::{Incidence, Member, of_group, unknowns_of};
use crate::model::mechanism::Mechanism;

/// An equation counts as empty when it stays below this (residuals are scaled, of order one) at all probes.
/// Rounding of a long chain stays far below, a real equation far above.
const EMPTY: f64 = 1e-12;

/// The structure of `mechanism`.
///
/// Ranks are taken at random poses. Loops with more equations than unknowns, and those that seem to lack
/// equations, are judged at closed poses too: an over-constrained loop has its true rank only there, and only
/// there it shows whether a freedom is idle.
pub fn analyse(mechanism: &Mechanism) -> Result<Structure, StructureError> {
    let probes = random_poses(mechanism);
    let (parts, empty_equations) = live_equations(mechanism, &probes)?;
    let incidence = Incidence::new(mechanism, parts);
    let generic = Ranks::new(mechanism, &probes);
    refuse_unheld(mechanism, &incidence, &generic)?;
    let mut structure = Structure {
        blocks: generic.blocks(&incidence, incidence.groups(&[])),
        empty_equations,
        held: Vec::new(),
    };
    let square = |b: &Block| b.rows() == b.unknowns.len();
    if structure
        .blocks
        .iter()
        .all(|b| square(b) && !generic.lacks(b))
    {
        return Ok(structure);
    }
    let poses = poses_of_unsure(mechanism, &structure, &incidence);
    if poses.is_empty() {
        // Nothing closes: solving will say so, unless the mechanism is not determined anyway.
        let lacking = structure.blocks.iter().find(|b| generic.lacks(b));
        return match lacking {
            Some(block) => Err(generic.under_determined(block)),
            None => Ok(structure),
        };
    }
    let closed = Ranks::new(mechanism, &poses);
    structure.blocks = closed.blocks(&incidence, incidence.groups(&[]));
    let held = passive::find(mechanism, &structure, &closed)?;
    if !held.is_empty() {
        let slots: Vec<usize> = held.iter().map(|h| h.unknown).collect();
        structure.blocks = closed.blocks(&incidence, incidence.groups(&slots));
        structure.held = held;
    }
    Ok(structure)
}

/// Closed poses of a mechanism whose blocks are not sure yet: by blocks, else with everything in one.
fn poses_of_unsure(
    mechanism: &Mechanism,
    structure: &Structure,
    incidence: &Incidence,
) -> Vec<Vec<f64>> {
    let poses = closed_poses(mechanism, structure);
    if !poses.is_empty() || structure.blocks.len() < 2 {
        return poses;
    }
    let groups = incidence.merged(&[]);
    let merged = Structure {
        blocks: groups
            .iter()
            .map(|g| of_group(mechanism, incidence, g))
            .collect(),
        ..structure.clone()
    };
    closed_poses(mechanism, &merged)
}

/// An unknown that changes no equation at any pose stands in the formulas only in vain.
fn refuse_unheld(
    mechanism: &Mechanism,
    incidence: &Incidence,
    ranks: &Ranks,
) -> Result<(), StructureError> {
    let mut felt = vec![false; mechanism.unknowns.len()];
    let mut workspace = BlockWorkspace::default();
    for member in 0..incidence.members.len() {
        let block = of_group(mechanism, incidence, &incidence.whole(vec![member], &[]));
        for pose in ranks.poses {
            workspace.evaluate(mechanism, &block, pose, Want::Jacobian);
            let columns = workspace.jacobian.chunks(block.rows().max(1));
            for (unknown, column) in block.unknowns.iter().zip(columns) {
                felt[*unknown] |= column.iter().any(|v| v.abs() > EMPTY || v.is_nan());
            }
        }
    }
    let unheld: Vec<usize> = (0..felt.len()).filter(|u| !felt[*u]).collect();
    if unheld.is_empty() {
        return Ok(());
    }
    let names = names(mechanism, unheld.into_iter());
    Err(StructureError::Unheld { names })
}

type LiveEquations = (Vec<LoopPart>, Vec<(usize, usize)>);

/// Splits every loop's six equations into those that say something and those that always hold.
fn live_equations(
    mechanism: &Mechanism,
    probes: &[Vec<f64>],
) -> Result<LiveEquations, StructureError> {
    let (mut parts, mut empty) = (Vec::new(), Vec::new());
    let mut workspace = BlockWorkspace::default();
    for index in 0..mechanism.loops.len() {
        let whole = LoopPart {
            index,
            components: (0..6).collect(),
        };
        let unknowns = unknowns_of(mechanism, &Member::Loop(whole.clone()));
        let all = block(mechanism, vec![whole], Vec::new(), unknowns);
        let mut live = [false; 6];
        let mut constant = [0.0_f64; 6];
        for probe in probes {
            // Inputs move too: a row that only they change is live, though no unknown can repair it.
            let mut rates = vec![0.0; mechanism.coordinate_count()];
            let inputs = rates[mechanism.unknowns.len()..].iter_mut();
            // Each at a rate of its own, so that they do not cancel.
            inputs
                .zip(1..)
                .for_each(|(rate, k)| *rate = f64::from(k).sqrt());
            workspace.evaluate(mechanism, &all, probe, Want::Drift(&rates));
            for (k, live) in live.iter_mut().enumerate() {
                let row = (0..all.unknowns.len()).map(|j| workspace.jacobian[j * 6 + k].abs());
                let largest = row.fold(workspace.drift.as_flattened()[k].abs(), f64::max);
                *live |= largest > EMPTY || largest.is_nan();
            }
            constant.copy_from_slice(&workspace.residual);
        }
        let wanted = components_of(mechanism, index);
        let components: Vec<usize> = wanted.clone().filter(|k| live[*k]).collect();
        for k in wanted.filter(|k| !live[*k]) {
            if constant[k].abs() > EMPTY {
                let (gap, unit) = if k < 3 {
                    (constant[k], "rad")
                } else {
                    (constant[k] * mechanism.size, mechanism.length_unit.as_str())
                };
                let name = mechanism.loops[index].name.clone();
                return Err(StructureError::Impossible {
                    name,
                    what: component_name(k).to_owned(),
                    gap,
                    unit: unit.to_owned(),
                });
            }
            empty.push((index, k));
        }
        parts.push(LoopPart { index, components });
    }
    Ok((parts, empty))
}
