//! From a mechanism to a [`System`]: which equations are effective, and in which order they can be solved.
//!
//! Everything here depends on the mechanism only, not on a pose. The order is found in
//! [`ordering`](crate::kinematics::structure::ordering), the poses at which ranks are determined in
//! [`generic_rank`](super::generic_rank), idle freedoms in [`idle`].

use super::generic_rank::{EMPTY, Ranks, closed_poses, poses_around, random_poses};
use super::idle;
use crate::kinematics::ball::chart::chart_system;
use crate::kinematics::loops::enclosed::is_open_throughout;
use crate::kinematics::loops::residual::{BlockWorkspace, Want};
use crate::kinematics::solve::assembly::assemble_pose;
use crate::kinematics::solve::newton::Corrector;
use crate::kinematics::structure::block::{
    Block, HeldFreedom, Structure, StructureError, block_of, slot_names,
};
use crate::kinematics::structure::empty_equations::unproved_of;
use crate::kinematics::structure::loop_part::{LoopPart, component_name, components_of};
use crate::kinematics::structure::ordering::{Incidence, Member, of_group, unknowns_of};
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::chain::{ChainStep, ElementaryMotion};
use crate::model::mechanism::{Kind, Mechanism};
use crate::model::outputs::output_arguments;
use crate::numbers::interval::Interval;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Largest length of a mechanism; products of two are still finite.
const LONGEST: f64 = 1e150;

impl System {
    /// Analyses `mechanism` and prepares it for solving.
    ///
    /// Ranks are determined at random poses. Loops with more equations than unknowns, those that seem to lack
    /// equations, and mechanisms that start at a singular pose are also judged at closed poses on `actuation`: only
    /// there an over-constrained loop has its true rank, and an idle freedom can be recognised.
    ///
    /// # Errors
    /// A loop that closes nowhere, undetermined unknowns, more coupled equations than memory allows.
    pub fn new(mechanism: Arc<Mechanism>, actuation: &Actuation) -> Result<Self, StructureError> {
        Ok(analyse_system(mechanism, actuation)?.with_ball_joints(chart_system))
    }
}

fn analyse_system(
    mechanism: Arc<Mechanism>,
    actuation: &Actuation,
) -> Result<System, StructureError> {
    let probes = random_poses(&mechanism);
    let (parts, empty_equations) = live_equations(&mechanism, &probes)?;
    let unproved_equations = unproved_of(&mechanism, &empty_equations);
    let incidence = Incidence::new(&mechanism, parts);
    let generic = Ranks::new(&mechanism, &probes);
    // An exponential function is nothing at random poses beside what it is near its solution.
    let start = actuation.start_at(0.0);
    let start = start.iter().all(|v| v.is_finite()).then_some(start);
    let felt_at: Vec<&Vec<f64>> = generic.poses.iter().chain(&start).collect();
    refuse_unheld(&mechanism, &incidence, &felt_at)?;
    let trial = |blocks: Vec<Block>, held: Vec<HeldFreedom>| {
        let structure = Structure {
            blocks,
            empty_equations: empty_equations.clone(),
            unproved_equations: unproved_equations.clone(),
            held,
        };
        System::bare(Arc::clone(&mechanism), structure)
    };
    let system = trial(
        generic.blocks(&incidence, incidence.groups(&[]))?,
        Vec::new(),
    );
    let is_sure = |b: &Block| b.rows() == b.unknowns.len() && !generic.lacks(b);
    let is_square = system.blocks().iter().all(is_sure);
    if is_square && !starts_singular(&system, actuation) {
        return Ok(system);
    }
    // Closed poses by blocks, otherwise with everything in one block.
    let mut poses = closed_poses(&system, actuation);
    if is_square && let Some(pose) = poses.first() {
        // Regular at random poses and singular at this closed one: a singular pose, or a freedom that exists at closed
        // poses only.
        poses.extend(poses_around(&system, &pose.clone()));
    }
    if poses.is_empty() && system.blocks().len() > 1 {
        let groups = incidence.allowed(incidence.merged(&[]))?;
        let merged = groups.iter().map(|g| of_group(&mechanism, &incidence, g));
        poses = closed_poses(&trial(merged.collect(), Vec::new()), actuation);
    }
    if poses.is_empty() {
        // Nothing closes: the solver will report it, unless the mechanism is not determined anyway. A spin is idle in
        // open loops, too.
        return with_spins_held(system, &incidence, &generic, trial);
    }
    let closed = Ranks::new(&mechanism, &poses);
    let system = trial(
        closed.blocks(&incidence, incidence.groups(&[]))?,
        Vec::new(),
    );
    with_spins_held(system, &incidence, &closed, trial)
}

/// The system, with its idle freedoms held.
fn with_spins_held(
    system: System,
    incidence: &Incidence,
    ranks: &Ranks,
    trial: impl Fn(Vec<Block>, Vec<HeldFreedom>) -> System,
) -> Result<System, StructureError> {
    let held = idle::find_idle(&system, ranks)?;
    if held.is_empty() {
        return Ok(system);
    }
    let slots: Vec<usize> = held.iter().map(|h| h.unknown).collect();
    Ok(trial(
        ranks.blocks(incidence, incidence.groups(&slots))?,
        held,
    ))
}

/// Whether the pose at which the drive starts lacks rank.
fn starts_singular(system: &System, actuation: &Actuation) -> bool {
    let start = actuation.start_at(0.0);
    if !start.iter().all(|v| v.is_finite()) {
        return false;
    }
    let mut corrector = Corrector::new(system);
    // Only at a closed pose are ranks meaningful.
    let Ok(found) = assemble_pose(system, &mut corrector, &start, false) else {
        return false;
    };
    let poses = [found.coordinates];
    let ranks = Ranks::new(system.mechanism(), &poses);
    system.blocks().iter().any(|b| ranks.lacks(b))
}

/// An unknown that changes no equation at any pose has no effect in formulas, unless it rotates links of a loop: then
/// it is a freedom of joints, which may be idle.
fn refuse_unheld(
    mechanism: &Mechanism,
    incidence: &Incidence,
    poses: &[&Vec<f64>],
) -> Result<(), StructureError> {
    let mut felt = vec![false; mechanism.unknowns.len()];
    let mut workspace = BlockWorkspace::default();
    for member in 0..incidence.members.len() {
        let block = of_group(mechanism, incidence, &incidence.whole(vec![member], &[]));
        for pose in poses {
            workspace.evaluate(mechanism, &block, pose, Want::Jacobian);
            // Rows of loops have one magnitude; that of an equation may be any other at a pose.
            let largest = workspace.jacobian.iter().map(|v| v.abs());
            let unit = match block.loops.is_empty() {
                true => largest.fold(0.0, f64::max).min(1.0),
                false => 1.0,
            };
            let columns = workspace.jacobian.chunks(block.rows().max(1));
            for (unknown, column) in block.unknowns.iter().zip(columns) {
                // A column that is zero at every random pose, and at the start, is zero everywhere.
                felt[*unknown] |= column.iter().any(|v| v.abs() > EMPTY * unit || v.is_nan());
            }
        }
    }
    let turning = turning_unknowns(mechanism);
    let unheld = (0..felt.len()).filter(|unknown| !felt[*unknown] && !turning.contains(unknown));
    let unheld: Vec<usize> = unheld.collect();
    if unheld.is_empty() {
        return Ok(());
    }
    let names = slot_names(mechanism, unheld.into_iter());
    Err(StructureError::Unheld { names })
}

/// Angles that turn a joint of a loop.
fn turning_unknowns(mechanism: &Mechanism) -> BTreeSet<usize> {
    let pose = vec![0.0; mechanism.coordinate_count()];
    let steps = mechanism.loops.iter().flat_map(|item| &item.chain.steps);
    let turned = steps.filter_map(|step| match step {
        ChainStep::Joint {
            motion: ElementaryMotion::Rotation,
            argument,
            ..
        } => Some(mechanism.arguments[*argument].gradient(&pose)),
        _ => None,
    });
    let is_angle = |unknown: &usize| {
        let unknown = mechanism.unknowns.get(*unknown);
        unknown.is_some_and(|unknown| unknown.kind == Kind::Angle)
    };
    let slots = turned.flatten().map(|(slot, _)| slot);
    slots.filter(is_angle).collect()
}

/// Whether a loop is proved to be open at all poses whose lengths are numbers.
fn is_open_everywhere(mechanism: &Mechanism, index: usize) -> bool {
    let slots = 0..mechanism.coordinate_count();
    let everywhere = slots.map(|slot| match mechanism.kind_of(slot) {
        Kind::Angle => Interval::ENTIRE,
        Kind::Length | Kind::Number => Interval::around_zero(LONGEST),
    });
    let everywhere: Vec<Interval> = everywhere.collect();
    let item = &mechanism.loops[index];
    let arguments = output_arguments(mechanism, &item.chain.arguments(), &everywhere);
    is_open_throughout(item, &arguments)
}

type LiveEquations = (Vec<LoopPart>, Vec<(usize, usize)>);

/// Splits every loop's six equations into effective ones and those that always hold.
fn live_equations(
    mechanism: &Mechanism,
    probes: &[Vec<f64>],
) -> Result<LiveEquations, StructureError> {
    let (mut parts, mut empty) = (Vec::new(), Vec::new());
    let mut workspace = BlockWorkspace::default();
    // Inputs move too: a row that only they change is effective, although no unknown can satisfy it.
    let mut rates = vec![0.0; mechanism.coordinate_count()];
    let inputs = rates[mechanism.unknowns.len()..].iter_mut();
    // Each at a different rate, so that they do not cancel.
    inputs
        .zip(1..)
        .for_each(|(rate, k)| *rate = f64::from(k).sqrt());
    for index in 0..mechanism.loops.len() {
        let whole = LoopPart {
            index,
            components: (0..6).collect(),
        };
        let unknowns = unknowns_of(mechanism, &Member::Loop(whole.clone()));
        let all = block_of(mechanism, vec![whole], Vec::new(), unknowns);
        let mut live = [false; 6];
        let mut constant = [0.0_f64; 6];
        for probe in probes {
            workspace.evaluate(mechanism, &all, probe, Want::Drift(&rates));
            for (k, live) in live.iter_mut().enumerate() {
                let row = (0..all.unknowns.len()).map(|j| workspace.jacobian[j * 6 + k].abs());
                let largest = row.fold(workspace.drift.as_flattened()[k].abs(), f64::max);
                *live |= largest > EMPTY || largest.is_nan();
            }
            constant.copy_from_slice(&workspace.residual);
        }
        let wanted = components_of(mechanism, index);
        // Equations that differ at the examined poses, without proof that they differ at all others, must be solved.
        if wanted
            .clone()
            .any(|k| !live[k] && constant[k].abs() > EMPTY)
            && !is_open_everywhere(mechanism, index)
        {
            (0..6).for_each(|k| live[k] |= constant[k].abs() > EMPTY);
        }
        let components: Vec<usize> = wanted.clone().filter(|k| live[*k]).collect();
        for k in wanted.filter(|k| !live[*k]) {
            if constant[k].abs() > EMPTY {
                let (gap, unit) = if k < 3 {
                    (constant[k], "rad")
                } else {
                    (
                        constant[k] * mechanism.loops[index].size,
                        mechanism.length_unit.as_str(),
                    )
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
