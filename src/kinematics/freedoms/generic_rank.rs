//! Random and closed poses at which a mechanism is examined, and ranks of blocks there.

use crate::kinematics::loops::residual::{BlockWorkspace, Want};
use crate::kinematics::solve::assembly::{assemble_pose, shake_start};
use crate::kinematics::solve::newton::{Corrector, Pace};
use crate::kinematics::solve::wishes::assemble_as_meant;
use crate::kinematics::structure::block::Block;
use crate::kinematics::structure::ordering::{BlockGroup, Incidence, of_group};
use crate::kinematics::structure::system::System;
use crate::limits::LimitExceeded;
use crate::linalg::pivoted_qr::PivotedQr;
use crate::linalg::sparse_lu::{LEAST, SparseLu};
use crate::model::actuation::Actuation;
use crate::model::mechanism::{Kind, Mechanism};
use crate::sorting::sort_by;
use std::collections::BTreeSet;

/// Number of random poses at which equations are evaluated, so that nothing vanishes by accident.
const PROBES: usize = 6;

/// Rank tolerance at random and at closed poses, relative to the largest pivot: ranks are clear-cut there.
pub const RANK: f64 = 1e-9;

/// Entries (rotations in radians, lengths over the size) below this are rounding of a long chain; true entries are far
/// larger.
pub const EMPTY: f64 = 1e-12;

/// Rank of rows of numbers; a row with undefined entries is ignored.
pub fn rank_of_rows(entries: &[f64], columns: usize) -> usize {
    if columns == 0 {
        return 0;
    }
    let rows = entries.chunks(columns);
    let known = rows.filter(|row| row.iter().all(|v| v.is_finite()));
    let without_noise = |v: &f64| if v.abs() > EMPTY { *v } else { 0.0 };
    let known: Vec<f64> = known.flatten().map(without_noise).collect();
    if known.is_empty() {
        return 0;
    }
    // Rows one after the other are columns of the transposed matrix, which has the same rank.
    let mut qr = PivotedQr::default();
    qr.factor(&known, columns, known.len() / columns, RANK);
    qr.rank()
}

/// Random coordinates, the same in every run.
pub fn random_poses(mechanism: &Mechanism) -> Vec<Vec<f64>> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut random = move || {
        // Xorshift with a fixed seed: the same poses in every run.
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let mut scaled = |slot: usize| match mechanism.kind_of(slot) {
        Kind::Length => mechanism.scale_of(slot) * random(),
        Kind::Angle | Kind::Number => random(),
    };
    let mut pose = |_| (0..mechanism.coordinate_count()).map(&mut scaled).collect();
    (0..PROBES).map(&mut pose).collect()
}

/// Places on the drive, as fractions of its duration, where closed poses are sought, and shifts of the inputs there
/// (radians, sizes): a constant drive, or one that starts at a singular pose, must not determine ranks.
const PLACES: [(f64, f64); 4] = [(0.0, 0.0), (0.0, 1e-2), (0.37, -7e-3), (0.73, 5e-3)];

/// How often the way to a place is quartered: nets of many cells follow their inputs in small steps only.
const SHORTER: usize = 8;

/// Closed poses (unknowns, then inputs) at some places on the drive, the start first if it has one.
pub fn closed_poses(system: &System, actuation: &Actuation) -> Vec<Vec<f64>> {
    let mechanism = system.mechanism();
    let mut corrector = Corrector::new(system);
    let mut poses: Vec<Vec<f64>> = Vec::new();
    let is_large = system.blocks().iter().any(|b| b.unknowns.len() >= LEAST);
    for (part, shift) in PLACES {
        let mut start =
            poses.first().unwrap_or(&actuation.guess)[..mechanism.unknowns.len()].to_vec();
        let inputs = actuation.inputs_at(part * actuation.duration);
        let slots = mechanism.unknowns.len()..;
        let shifted = slots
            .zip(inputs)
            .map(|(slot, value)| value + shift * mechanism.scale_of(slot));
        start.extend(shifted);
        if !start.iter().all(|v| v.is_finite()) {
            continue;
        }
        // A search is only worth its time once.
        let search = part == 0.0 && shift == 0.0;
        let found = match poses.first() {
            _ if search => {
                let found = assemble_as_meant(system, &mut corrector, &start, &actuation.named);
                found.ok().map(|found| found.coordinates)
            }
            Some(first) if is_large => step_towards(system, &mut corrector, first, &start),
            _ => {
                let found = assemble_pose(system, &mut corrector, &start, false);
                found.ok().map(|found| found.coordinates)
            }
        };
        poses.extend(found);
    }
    poses
}

/// Number of closed poses sought around a singular one, and largest distance of their starts from it, in scaled
/// unknowns.
const AROUND: (usize, f64) = (4, 0.1);

/// Closed poses around `pose` at the same inputs. For an isolated pose they are that pose again, to the square root of
/// rounding, which suffices for the rank next to it; for a freedom they are others of its poses.
pub fn poses_around(system: &System, pose: &[f64]) -> Vec<Vec<f64>> {
    let mut corrector = Corrector::new(system);
    let (count, far) = AROUND;
    let closed = (1..=count).filter_map(|attempt| {
        let mut start = pose.to_vec();
        shake_start(system.mechanism(), attempt, far, &mut start);
        let found = assemble_pose(system, &mut corrector, &start, false);
        Some(found.ok()?.coordinates)
    });
    closed.collect()
}

/// The closed pose that Newton's method reaches directly from a closed one at other inputs.
fn step_towards(
    system: &System,
    corrector: &mut Corrector,
    first: &[f64],
    goal: &[f64],
) -> Option<Vec<f64>> {
    let unknowns = system.mechanism().unknowns.len();
    let mut share = 1.0;
    (0..SHORTER).find_map(|_| {
        let mut pose = first.to_vec();
        let inputs = pose.iter_mut().zip(goal).skip(unknowns);
        inputs.for_each(|(from, to)| *from += share * (to - *from));
        // Newton's method fails: a quarter of the way.
        share *= 0.25;
        let found = corrector.correct(system, &mut pose, Pace::Brisk);
        found.converged.then_some(pose)
    })
}

/// Measures ranks.
#[derive(Default)]
struct Gauge {
    qr: PivotedQr,
    sparse: SparseLu,
}

impl Gauge {
    /// Rank of a column-major matrix, and its smallest pivot.
    fn measure(&mut self, a: &[f64], rows: usize, columns: usize) -> (usize, f64) {
        // Sparse elimination accepts only matrices far from singular.
        let regular = match rows == columns {
            true => self.sparse.factor_columns(a, rows),
            false => self.sparse.factor_tall(a, [rows, columns]),
        };
        if let Some(pivots) = regular {
            return (columns, pivots.smallest);
        }
        self.qr.factor(a, rows, columns, RANK);
        (self.qr.rank(), self.qr.smallest_pivot())
    }
}

/// Ranks of blocks, the largest of several poses.
pub struct Ranks<'a> {
    mechanism: &'a Mechanism,
    /// Unknowns, then inputs.
    pub poses: &'a [Vec<f64>],
}

impl<'a> Ranks<'a> {
    /// Ranks at `poses`.
    pub fn new(mechanism: &'a Mechanism, poses: &'a [Vec<f64>]) -> Self {
        Self { mechanism, poses }
    }

    /// Largest rank of the block's Jacobian over the poses. A pose at which a slope is not a number tells nothing; if all do, the
    /// rank is taken to be full: whether the equations can be solved is left to the solver.
    pub fn of(&self, block: &Block) -> usize {
        let mut workspace = BlockWorkspace::default();
        let mut gauge = Gauge::default();
        let (rows, columns) = (block.rows(), block.unknowns.len());
        let mut largest = 0;
        let mut is_known = self.poses.is_empty();
        for pose in self.poses {
            workspace.evaluate(self.mechanism, block, pose, Want::Jacobian);
            if !workspace.jacobian.iter().all(|slope| slope.is_finite()) {
                continue;
            }
            is_known = true;
            largest = largest.max(gauge.measure(&workspace.jacobian, rows, columns).0);
            // The rank cannot grow any more.
            if largest == rows.min(columns) {
                break;
            }
        }
        if is_known { largest } else { rows.min(columns) }
    }

    /// The poses at which the block has its largest rank, the most regular one first.
    pub fn regular(&self, block: &Block) -> Vec<&'a [f64]> {
        let mut workspace = BlockWorkspace::default();
        let mut gauge = Gauge::default();
        let (rows, columns) = (block.rows(), block.unknowns.len());
        let largest = self.of(block);
        let mut list: Vec<(f64, &'a [f64])> = Vec::new();
        for pose in self.poses {
            workspace.evaluate(self.mechanism, block, pose, Want::Jacobian);
            let (rank, pivot) = gauge.measure(&workspace.jacobian, rows, columns);
            if rank == largest {
                list.push((pivot, pose));
            }
        }
        // The larger the smallest pivot, the farther from a loss of rank.
        sort_by(&mut list, |a, b| b.0.total_cmp(&a.0));
        list.into_iter().map(|(_, pose)| pose).collect()
    }

    /// Whether the equations do not determine the block's unknowns.
    pub fn lacks(&self, block: &Block) -> bool {
        self.of(block) < block.unknowns.len()
    }

    /// Blocks of the groups. A group that is square by counting but not by rank needs equations of others.
    ///
    /// Errors: some must be solved together and need more memory than there is.
    pub fn blocks(
        &self,
        incidence: &Incidence,
        groups: Vec<BlockGroup>,
    ) -> Result<Vec<Block>, LimitExceeded> {
        let mut groups = incidence.allowed(groups)?;
        // Each unchanged group is evaluated only once, however often others are merged.
        let mut settled: BTreeSet<Vec<usize>> = BTreeSet::new();
        let mut k = 0;
        while k < groups.len() {
            if settled.contains(&groups[k].members) {
                k += 1;
                continue;
            }
            let joined = self
                .lacks(&of_group(self.mechanism, incidence, &groups[k]))
                .then(|| incidence.joined(&groups, k));
            match joined.flatten() {
                Some(joined) => (groups, k) = (incidence.allowed(joined)?, 0),
                None => drop(settled.insert(groups[k].members.clone())),
            }
        }
        let blocks = groups.iter();
        Ok(blocks
            .map(|g| of_group(self.mechanism, incidence, g))
            .collect())
    }
}
