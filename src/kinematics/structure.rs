//! Which equations say something, and in which order loops can be solved: blocks of loops that share unknowns.
//!
//! Everything here depends on the mechanism only, not on a pose; it is made once before the first solve.

use super::closure::{BlockWorkspace, Want};
use super::qr::PivotedQr;
use crate::model::mechanism::{Closes, Kind, Mechanism};

/// The part of a loop that a block solves.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopPart {
    /// Index of the loop.
    pub index: usize,
    /// Its equations that are not empty: 0 to 2 rotation about x, y, z; 3 to 5 translation.
    pub components: Vec<usize>,
}

/// A group of loops and equations that is solved together.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Loops and their equations.
    pub loops: Vec<LoopPart>,
    /// Scalar equations.
    pub equations: Vec<usize>,
    /// Unknowns it determines.
    pub unknowns: Vec<usize>,
    /// Column of each coordinate in the block's Jacobian, if it is one of its unknowns.
    pub column_of: Vec<Option<usize>>,
    /// Arguments that its loops use.
    pub arguments: Vec<usize>,
}

impl Block {
    /// Number of equations.
    pub fn rows(&self) -> usize {
        self.loops
            .iter()
            .map(|part| part.components.len())
            .sum::<usize>()
            + self.equations.len()
    }
}

/// The order of solution.
#[derive(Clone, Debug, PartialEq)]
pub struct Structure {
    /// Each block needs only unknowns of earlier ones.
    pub blocks: Vec<Block>,
    /// Equations that hold at every pose, as (loop, component).
    pub empty_equations: Vec<(usize, usize)>,
}

/// A mechanism that no pose can solve, or that is not determined.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StructureError {
    /// A loop has the same gap at every pose.
    #[error("loop `{name}` cannot close at any pose: {what} always differs by {gap:.6} {unit}")]
    Impossible {
        /// Name of the loop.
        name: String,
        /// The equation in words.
        what: String,
        /// Its constant value.
        gap: f64,
        /// Unit of the gap: radians or the scene's length unit.
        unit: String,
    },
    /// More unknowns than independent equations.
    #[error("{freedoms} more coordinate(s) are free than the inputs drive: {}", names.join(", "))]
    UnderDetermined {
        /// How many.
        freedoms: usize,
        /// Unknowns that can move while the inputs stand still.
        names: Vec<String>,
    },
}

/// Poses at which equations are probed: random ones, so that nothing vanishes by accident.
const PROBES: usize = 6;

/// An equation counts as empty when it stays below this (residuals are scaled, of order one) at all probes.
/// Rounding of a long chain stays far below, a real equation far above.
const EMPTY: f64 = 1e-12;

/// Rank tolerance at random poses, relative to the largest pivot: generic ranks are clear-cut.
const GENERIC_RANK: f64 = 1e-9;

impl Structure {
    /// Analyses `mechanism`.
    pub fn new(mechanism: &Mechanism) -> Result<Self, StructureError> {
        let probes = probes(mechanism);
        let (parts, empty_equations) = live_equations(mechanism, &probes)?;
        let mut blocks = order(mechanism, parts);
        if blocks.len() > 1
            && blocks
                .iter()
                .any(|b| generic_rank(mechanism, b, &probes) < b.unknowns.len())
        {
            // A group that is square by counting but not by rank needs the equations of the others.
            let loops = blocks.iter().flat_map(|b| b.loops.clone()).collect();
            let equations = blocks.iter().flat_map(|b| b.equations.clone()).collect();
            let unknowns = (0..mechanism.unknowns.len()).collect();
            blocks = vec![block(mechanism, loops, equations, unknowns)];
        }
        for block in &blocks {
            let rank = generic_rank(mechanism, block, &probes);
            if rank < block.unknowns.len() {
                return Err(under_determined(mechanism, block, rank, &probes));
            }
        }
        Ok(Self {
            blocks,
            empty_equations,
        })
    }

    /// Number of equations that are solved.
    pub fn equation_count(&self) -> usize {
        self.blocks.iter().map(Block::rows).sum()
    }
}

/// Random coordinates, the same in every run.
fn probes(mechanism: &Mechanism) -> Vec<Vec<f64>> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut random = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let coordinates: Vec<Kind> = mechanism
        .unknowns
        .iter()
        .chain(&mechanism.inputs)
        .map(|c| c.kind)
        .collect();
    (0..PROBES)
        .map(|_| {
            let scale = |kind: &Kind| {
                if *kind == Kind::Length {
                    mechanism.size
                } else {
                    1.0
                }
            };
            coordinates
                .iter()
                .map(|kind| scale(kind) * random())
                .collect()
        })
        .collect()
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
        let all = block(
            mechanism,
            vec![whole],
            Vec::new(),
            (0..mechanism.unknowns.len()).collect(),
        );
        let mut live = [false; 6];
        let mut constant = [0.0_f64; 6];
        for probe in probes {
            // Inputs move too: a row that only they change is live, though no unknown can repair it.
            let mut rates = vec![0.0; mechanism.coordinate_count()];
            rates[mechanism.unknowns.len()..].fill(1.0);
            workspace.evaluate(mechanism, &all, probe, Want::Drift(&rates));
            for (k, live) in live.iter_mut().enumerate() {
                let row = (0..all.unknowns.len()).map(|j| workspace.jacobian[j * 6 + k].abs());
                let largest = row.fold(workspace.drift[k].abs(), f64::max);
                *live |= largest > EMPTY || largest.is_nan();
            }
            constant.copy_from_slice(&workspace.residual);
        }
        let wanted = match mechanism.loops[index].closes {
            Closes::Frame => 0..6,
            Closes::Point => 3..6,
        };
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

/// An equation of a loop in words.
pub fn component_name(component: usize) -> &'static str {
    [
        "the rotation about x",
        "the rotation about y",
        "the rotation about z",
        "the translation along x",
        "the translation along y",
        "the translation along z",
    ][component]
}

/// A loop part or an equation, before grouping.
#[derive(Clone)]
enum Member {
    Loop(LoopPart),
    Equation(usize),
}

impl Member {
    fn rows(&self) -> usize {
        match self {
            Self::Loop(part) => part.components.len(),
            Self::Equation(_) => 1,
        }
    }

    fn unknowns(&self, mechanism: &Mechanism) -> Vec<usize> {
        let slots: Vec<usize> = match self {
            Self::Loop(part) => {
                let used = mechanism.loops[part.index].chain.arguments();
                used.iter()
                    .flat_map(|a| mechanism.arguments[*a].coordinates())
                    .collect()
            }
            Self::Equation(index) => mechanism.equations[*index].expression.slots(),
        };
        slots
            .into_iter()
            .filter(|slot| *slot < mechanism.unknowns.len())
            .collect()
    }
}

/// Largest group that is searched for; what is entangled more than this is solved as one block.
const LARGEST_SEARCHED_GROUP: usize = 3;

/// Groups members so that each block has at least as many equations as new unknowns.
fn order(mechanism: &Mechanism, parts: Vec<LoopPart>) -> Vec<Block> {
    let mut rest: Vec<(Member, Vec<usize>)> = parts
        .into_iter()
        .map(Member::Loop)
        .chain((0..mechanism.equations.len()).map(Member::Equation))
        .map(|member| {
            let unknowns = member.unknowns(mechanism);
            (member, unknowns)
        })
        .collect();
    let mut known = vec![false; mechanism.unknowns.len()];
    let mut blocks = Vec::new();
    while !rest.is_empty() {
        let group = smallest_group(&rest, &known).unwrap_or_else(|| (0..rest.len()).collect());
        let mut unknowns: Vec<usize> = group
            .iter()
            .flat_map(|g| rest[*g].1.iter().copied())
            .filter(|u| !known[*u])
            .collect();
        unknowns.sort_unstable();
        unknowns.dedup();
        unknowns.iter().for_each(|u| known[*u] = true);
        let (mut loops, mut equations) = (Vec::new(), Vec::new());
        for g in &group {
            match &rest[*g].0 {
                Member::Loop(part) => loops.push(part.clone()),
                Member::Equation(index) => equations.push(*index),
            }
        }
        blocks.push(block(mechanism, loops, equations, unknowns));
        let mut position = 0;
        rest.retain(|_| {
            position += 1;
            !group.contains(&(position - 1))
        });
    }
    blocks
}

/// The first smallest group with at least as many equations as open unknowns.
fn smallest_group(rest: &[(Member, Vec<usize>)], known: &[bool]) -> Option<Vec<usize>> {
    let closed = |group: &[usize]| {
        let mut open: Vec<usize> = group
            .iter()
            .flat_map(|g| rest[*g].1.iter().copied())
            .filter(|u| !known[*u])
            .collect();
        open.sort_unstable();
        open.dedup();
        open.len() <= group.iter().map(|g| rest[*g].0.rows()).sum()
    };
    let shares = |a: usize, b: usize| {
        rest[a]
            .1
            .iter()
            .any(|u| !known[*u] && rest[b].1.contains(u))
    };
    let mut groups: Vec<Vec<usize>> = (0..rest.len()).map(|g| vec![g]).collect();
    for size in 1..=LARGEST_SEARCHED_GROUP.min(rest.len()) {
        if let Some(group) = groups.iter().find(|group| closed(group)) {
            return Some(group.clone());
        }
        if size < LARGEST_SEARCHED_GROUP {
            // Only members that share an open unknown can help each other.
            let mut larger = Vec::new();
            for group in &groups {
                let last = group[group.len() - 1];
                for next in last + 1..rest.len() {
                    if group.iter().any(|g| shares(*g, next)) {
                        larger.push([group.as_slice(), &[next]].concat());
                    }
                }
            }
            groups = larger;
        }
    }
    None
}

fn block(
    mechanism: &Mechanism,
    loops: Vec<LoopPart>,
    equations: Vec<usize>,
    unknowns: Vec<usize>,
) -> Block {
    let mut column_of = vec![None; mechanism.coordinate_count()];
    for (column, unknown) in unknowns.iter().enumerate() {
        column_of[*unknown] = Some(column);
    }
    let mut arguments: Vec<usize> = loops
        .iter()
        .flat_map(|part| mechanism.loops[part.index].chain.arguments())
        .collect();
    arguments.sort_unstable();
    arguments.dedup();
    Block {
        loops,
        equations,
        unknowns,
        column_of,
        arguments,
    }
}

/// Largest rank of the block's Jacobian over the probes.
fn generic_rank(mechanism: &Mechanism, block: &Block, probes: &[Vec<f64>]) -> usize {
    let mut workspace = BlockWorkspace::default();
    let mut qr = PivotedQr::default();
    let ranks = probes.iter().map(|probe| {
        workspace.evaluate(mechanism, block, probe, Want::Jacobian);
        qr.factor(
            &workspace.jacobian,
            block.rows(),
            block.unknowns.len(),
            GENERIC_RANK,
        );
        qr.rank()
    });
    ranks.max().unwrap_or(0)
}

/// Names the unknowns that move while all equations hold.
fn under_determined(
    mechanism: &Mechanism,
    block: &Block,
    rank: usize,
    probes: &[Vec<f64>],
) -> StructureError {
    let mut workspace = BlockWorkspace::default();
    workspace.evaluate(mechanism, block, &probes[0], Want::Jacobian);
    let free = super::rank::free_columns(
        &workspace.jacobian,
        block.rows(),
        block.unknowns.len(),
        rank,
    );
    let names = free
        .iter()
        .map(|column| mechanism.unknowns[block.unknowns[*column]].name.clone())
        .collect();
    StructureError::UnderDetermined {
        freedoms: block.unknowns.len() - rank,
        names,
    }
}
