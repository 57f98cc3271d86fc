//! Idle freedoms: motions that turn single links about lines through their own joints and change nothing else, like
//! the spin of a rod between two ball joints. They are found, named and held; any other free motion is under-determined.
//!
//! A free motion is a null vector of the Jacobian at closed poses. It is idle if within every loop the links that
//! move rotate about one common line between links at rest, while no other body, no traced point and no
//! output moves, nor any coordinate that an equation contains. Elimination gives every idle freedom a line of its own.
//!
//! One unknown of each is held at its start value: if possible the one that rotates about the line itself (the
//! last angle of a ball joint, say), since holding it then never stops the motion at any pose.

use super::generic_rank::{EMPTY, RANK, Ranks, random_poses};
use super::twists::{PluckerLine, STILL, Twist, TwistWalk, common_axis, line_of, same_line};
use crate::kinematics::loops::observed::observed_values;
use crate::kinematics::loops::residual::{BlockWorkspace, Want};
use crate::kinematics::structure::block::{
    Block, HeldFreedom, StructureError, block_of, slot_names,
};
use crate::kinematics::structure::system::System;
use crate::linalg::pivoted_qr::PivotedQr;
use crate::linalg::svd::null_space;
use crate::model::mechanism::{Kind, Mechanism};
use crate::numbers::series::TaylorSeries;
use crate::sorting::sort_by_key;

/// Preference for an unknown that always rotates about the line itself over one that does so only at this pose.
const IMPURE: f64 = 0.05;

/// How much more the last unknown weighs than the first: enough to decide between equals, and nothing else.
const LATER: f64 = 1e-3;

/// Sizes above this share of another are equal within rounding.
const EQUAL: f64 = 1.0 - 1e-9;

/// The idle freedoms of all blocks; a mechanism with other freedoms is rejected.
pub fn find_idle(system: &System, closed: &Ranks) -> Result<Vec<HeldFreedom>, StructureError> {
    let mechanism = system.mechanism();
    let structure = system.structure();
    let mut list = Vec::new();
    for block in structure.blocks.iter().filter(|b| closed.lacks(b)) {
        list.extend(of_block(mechanism, block, closed)?);
    }
    sort_by_key(&mut list, |held| held.unknown);
    Ok(list)
}

/// A block at a pose.
#[derive(Clone, Copy)]
struct FreedomSite<'a> {
    mechanism: &'a Mechanism,
    block: &'a Block,
    pose: &'a [f64],
}

/// A motion of the block's unknowns: rates of the scaled unknowns.
struct FreeMotion<'a> {
    mechanism: &'a Mechanism,
    block: &'a Block,
    pose: &'a [f64],
    rates: &'a [f64],
}

impl<'a> FreedomSite<'a> {
    fn with(self, rates: &'a [f64]) -> FreeMotion<'a> {
        FreeMotion {
            mechanism: self.mechanism,
            block: self.block,
            pose: self.pose,
            rates,
        }
    }
}

/// The line about which links rotate, for every loop of a block in which some do, in the base frame of the loop.
type AxisLines = Vec<Option<PluckerLine>>;

fn of_block(
    mechanism: &Mechanism,
    block: &Block,
    closed: &Ranks,
) -> Result<Vec<HeldFreedom>, StructureError> {
    let columns = block.unknowns.len();
    let freedoms = columns - closed.of(block);
    let poses = closed.regular(block);
    let pose = poses[0];
    // A basis of the motions that the loops allow, by elimination.
    let mut null = null_vectors(mechanism, block, pose, freedoms);
    eliminate_vectors(&mut null, |_| 1.0);
    let site = FreedomSite {
        mechanism,
        block,
        pose,
    };
    // An idle motion rotates every body about a fixed line; any other freedom needs a drive.
    let lines: Vec<Option<AxisLines>> = null.iter().map(|r| site.with(r).idle_lines()).collect();
    let driven = lines.iter().zip(&null).filter(|(lines, _)| lines.is_none());
    refuse_freedom(mechanism, block, driven.map(|(_, rates)| rates.as_slice()))?;
    let lines: Vec<AxisLines> = lines.into_iter().flatten().collect();
    let is_pure = |column: usize| {
        let mut rates = vec![0.0; columns];
        rates[column] = 1.0;
        site.with(&rates).turns_about(&lines)
    };
    let pure: Vec<bool> = (0..columns).map(is_pure).collect();
    // Pivots: the unknowns to hold, preferring those that rotate about the line itself.
    let weight = |j: usize| {
        // Of equals the last one: the first angles of a joint are considered its main ones.
        let last = 1.0 + LATER * (j as f64 / columns as f64);
        if pure[j] { last } else { IMPURE * last }
    };
    let pivots = eliminate_vectors(&mut null, weight);
    // At the other poses the same unknowns must release nothing else.
    for pose in poses.into_iter().skip(1) {
        let others: Vec<Vec<f64>> = released_slots(mechanism, block, pose, &pivots);
        let site = FreedomSite { pose, ..site };
        let moves = |rates: &&Vec<f64>| site.with(rates).idle_lines().is_none();
        refuse_freedom(
            mechanism,
            block,
            others.iter().filter(moves).map(Vec::as_slice),
        )?;
    }
    let held = pivots.iter().zip(&null).map(|(pivot, rates)| {
        let lines = site.with(rates).idle_lines().unwrap_or_default();
        let turning = lines.iter().position(Option::is_some);
        HeldFreedom {
            unknown: block.unknowns[*pivot],
            moving: moving_slots(block, rates),
            turning: turning.map(|k| block.loops[k].index),
        }
    });
    Ok(held.collect())
}

/// An error if there are motions that are not idle.
fn refuse_freedom<'a>(
    mechanism: &Mechanism,
    block: &Block,
    motions: impl Iterator<Item = &'a [f64]>,
) -> Result<(), StructureError> {
    let (mut freedoms, mut slots) = (0, Vec::new());
    for rates in motions {
        freedoms += 1;
        slots.extend(moving_slots(block, rates));
    }
    if freedoms == 0 {
        return Ok(());
    }
    slots.sort_unstable();
    slots.dedup();
    let names = slot_names(mechanism, slots.into_iter());
    Err(StructureError::UnderDetermined { freedoms, names })
}

/// Unknowns that take part.
fn moving_slots(block: &Block, rates: &[f64]) -> Vec<usize> {
    let pairs = block.unknowns.iter().zip(rates);
    pairs
        .filter(|(_, r)| r.abs() > STILL)
        .map(|(u, _)| *u)
        .collect()
}

fn null_vectors(
    mechanism: &Mechanism,
    block: &Block,
    pose: &[f64],
    freedoms: usize,
) -> Vec<Vec<f64>> {
    let mut workspace = BlockWorkspace::default();
    workspace.evaluate(mechanism, block, pose, Want::Jacobian);
    let (rows, columns) = (block.rows(), block.unknowns.len());
    null_space(&workspace.jacobian, rows, columns, columns - freedoms)
}

/// Makes each vector one at its own pivot and zero at those of the others; entries are weighted for the choice. Returns
/// the pivots.
fn eliminate_vectors(vectors: &mut [Vec<f64>], weight: impl Fn(usize) -> f64) -> Vec<usize> {
    let mut pivots: Vec<usize> = Vec::new();
    for k in 0..vectors.len() {
        let (mut best, mut pivot, mut row) = (0.0, 0, k);
        for (i, vector) in vectors.iter().enumerate().skip(k) {
            let longest = vector.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            for (j, value) in vector.iter().enumerate() {
                let size = value.abs() / longest * weight(j);
                // Of equals within rounding the later one.
                if size > best * EQUAL && !pivots.contains(&j) {
                    (best, pivot, row) = (size.max(best), j, i);
                }
            }
        }
        vectors.swap(k, row);
        pivots.push(pivot);
        let value = vectors[k][pivot];
        vectors[k].iter_mut().for_each(|v| *v /= value);
        let lead = vectors[k].clone();
        for (_, other) in vectors.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let factor = other[pivot];
            other
                .iter_mut()
                .zip(&lead)
                .for_each(|(o, l)| *o -= factor * l);
        }
    }
    pivots
}

/// The motions at a pose when the held columns `pivots` are released one after the other.
fn released_slots(
    mechanism: &Mechanism,
    block: &Block,
    pose: &[f64],
    pivots: &[usize],
) -> Vec<Vec<f64>> {
    let mut workspace = BlockWorkspace::default();
    workspace.evaluate(mechanism, block, pose, Want::Jacobian);
    let (rows, columns) = (block.rows(), block.unknowns.len());
    let column = |j: usize| &workspace.jacobian[j * rows..(j + 1) * rows];
    let rest: Vec<usize> = (0..columns).filter(|j| !pivots.contains(j)).collect();
    let matrix: Vec<f64> = rest.iter().flat_map(|j| column(*j)).copied().collect();
    let mut qr = PivotedQr::default();
    qr.factor(&matrix, rows, rest.len(), RANK);
    // A unit rate of the released column; the others follow by least squares.
    let motion = |pivot: &usize| {
        let mut right_side: Vec<f64> = column(*pivot).iter().map(|v| -v).collect();
        let mut step = vec![0.0; rest.len()];
        qr.solve(&mut right_side, &mut step);
        let mut rates = vec![0.0; columns];
        rates[*pivot] = 1.0;
        rest.iter().zip(step).for_each(|(j, s)| rates[*j] = s);
        rates
    };
    pivots.iter().map(motion).collect()
}

/// The idle spins of a system, whose lines are known at any closed pose.
pub struct Spins {
    /// Blocks with their held unknowns among the others, and the columns of these.
    blocks: Vec<(Block, Vec<usize>)>,
}

impl Spins {
    /// The spins of links that a system holds.
    pub fn new(system: &System) -> Self {
        let (mechanism, structure) = (system.mechanism(), system.structure());
        let widened = |whole: &Block| {
            let is_own =
                |held: &&HeldFreedom| held.moving.iter().any(|u| whole.unknowns.contains(u));
            let turning = structure.held.iter().filter(|held| held.turning.is_some());
            let own = turning.filter(is_own).map(|held| held.unknown);
            let unknowns: Vec<usize> = whole.unknowns.iter().copied().chain(own).collect();
            let columns = whole.unknowns.len()..unknowns.len();
            let (loops, equations) = (whole.loops.clone(), whole.equations.clone());
            // The block with its held spins as columns once more.
            let block = block_of(mechanism, loops, equations, unknowns);
            (!columns.is_empty()).then(|| (block, columns.collect()))
        };
        Self {
            blocks: structure.blocks.iter().filter_map(widened).collect(),
        }
    }

    /// By link: the line about which it spins in the world (its moment over the size), if it does.
    pub fn lines(&self, mechanism: &Mechanism, pose: &[f64]) -> Vec<Option<PluckerLine>> {
        let links = &mechanism.joints.links;
        let mut lines = vec![None; links.len()];
        for (block, columns) in &self.blocks {
            let site = FreedomSite {
                mechanism,
                block,
                pose,
            };
            for rates in released_slots(mechanism, block, pose, columns) {
                let physical = site.with(&rates).physical_rates();
                let walk = TwistWalk::new(mechanism, pose, &physical, mechanism.size);
                for (link, line) in lines.iter_mut().enumerate() {
                    // A link that spins has a twist without pitch: its axis is the line.
                    let twist = walk.whole(&mechanism.joints.world_from_link(link));
                    *line = line.or_else(|| line_of(twist));
                }
            }
        }
        lines
    }
}

impl FreeMotion<'_> {
    /// `None` if it is not idle, otherwise the lines about which links rotate.
    fn idle_lines(&self) -> Option<AxisLines> {
        let walk = TwistWalk::new(
            self.mechanism,
            self.pose,
            &self.physical_rates(),
            self.size(),
        );
        let common = |twists: Vec<Twist>| -> Option<Option<PluckerLine>> {
            twists.into_iter().try_fold(None, common_axis)
        };
        let parts = self.block.loops.iter();
        let lines: Option<AxisLines> = parts
            .map(|part| common(walk.links(self.mechanism, part.index)))
            .collect();
        let lines = lines?;
        let bodies = self.mechanism.bodies.iter();
        let of_bodies = common(bodies.map(|b| walk.whole(&b.world_from_body)).collect())?;
        // A body that moves without any link of a loop is not an idle spin of a link.
        let is_seen = of_bodies.is_some() && lines.iter().all(Option::is_none);
        (!is_seen && self.leaves_equations() && self.is_unseen()).then_some(lines)
    }

    /// Whether no moving coordinate appears in an equation: whatever an equation constrains is a part of the
    /// mechanism, like the free end of a hanging bar, even without a body there.
    fn leaves_equations(&self) -> bool {
        let equations = &self.block.plan.equations;
        if equations.is_empty() {
            return true;
        }
        let moving = moving_slots(self.block, self.rates);
        // At a closed pose a slope may be zero by chance, as that of z^2 at z = 0; at random poses none is.
        random_poses(self.mechanism).iter().all(|pose| {
            equations.iter().all(|planned| {
                let expression = &self.mechanism.equations[planned.index].expression;
                let gradient = expression.gradient(pose.as_slice());
                let slope = |u: &usize| gradient[*u] * planned.scale * self.mechanism.scale_of(*u);
                moving.iter().all(|u| slope(u).abs() <= EMPTY)
            })
        })
    }

    /// Whether no traced point and no output changes.
    fn is_unseen(&self) -> bool {
        let rates = self.physical_rates();
        let pairs = self.pose.iter().zip(&rates);
        let series = pairs.map(|(q, r)| TaylorSeries::linear(*q, *r, 1));
        let series: Vec<_> = series.collect();
        let seen = &observed_values(self.mechanism, &series)[self.mechanism.unknowns.len()..];
        let lengths = 3 * self.mechanism.traces.len();
        seen.iter().enumerate().all(|(k, series)| {
            let output = k.checked_sub(lengths).map(|k| &self.mechanism.outputs[k]);
            let is_length = output.is_none_or(|o| o.kind == Kind::Length);
            let scale = if is_length { self.size() } else { 1.0 };
            let rate = series.derivative(1).abs() / scale;
            // An output without a value is ignored.
            rate.is_nan() || rate <= STILL
        })
    }

    /// The unit of lengths of the block: motion relative to it counts, however large other loops are.
    fn size(&self) -> f64 {
        let loops = self.block.loops.iter();
        let sizes = loops.map(|part| self.mechanism.loops[part.index].size);
        let largest = sizes.reduce(f64::max);
        largest.unwrap_or(self.mechanism.size)
    }

    /// Rates of all coordinates in their own units.
    fn physical_rates(&self) -> Vec<f64> {
        let mut rates = vec![0.0; self.pose.len()];
        for (unknown, rate) in self.block.unknowns.iter().zip(self.rates) {
            rates[*unknown] = rate * self.mechanism.scale_of(*unknown);
        }
        rates
    }

    /// Whether every joint that takes part rotates about a line of one of the motions.
    fn turns_about(&self, motions: &[AxisLines]) -> bool {
        let walk = TwistWalk::new(
            self.mechanism,
            self.pose,
            &self.physical_rates(),
            self.size(),
        );
        let mut some = false;
        for (k, part) in self.block.loops.iter().enumerate() {
            for twist in walk.joints(&self.mechanism.loops[part.index].chain) {
                let Some(line) = line_of(twist) else {
                    return false;
                };
                // Each joint that moves must turn about the spin's own line.
                let mut known = motions.iter().filter_map(|lines| lines[k].as_ref());
                if !known.any(|other| same_line(&line, other)) {
                    return false;
                }
                some = true;
            }
        }
        some
    }
}
