//! Continuous sets of solutions: a singular closure that can be moved without opening a loop belongs to one.
//!
//! A curve is followed once in both directions, and all other closures on it belong to the same set. Sets of higher
//! dimension are distinguished by their dimension only.

use super::alike::{Alike, largest_difference};
use super::walk::BranchPath;
use crate::kinematics::loops::residual::{BlockWorkspace, Want};
use crate::kinematics::solve::newton::{Corrector, Pace};
use crate::kinematics::solve::settled_roots::settle_block;
use crate::kinematics::structure::block::Block;
use crate::kinematics::structure::system::System;
use crate::linalg::svd::{jacobian_conditioning, null_space};

/// Below this smallest singular value a mode is called singular: a double solution is found to half its digits only.
pub const SINGULAR: f64 = 1e-6;

/// Length of a step along a set in scaled unknowns.
const STEP: f64 = 0.05;

/// Steps in either direction: about thirty turns of a joint.
const MOST_STEPS: usize = 4000;

/// A singular closure that can be moved by this many steps is not isolated: near a double solution of 1e-6 the residual
/// of a step is a thousand times that allowed for a point of the curve.
const FIRST_STEPS: usize = 3;

/// A point belongs to a curve if it is within this multiple of the distance of the followed points.
const BESIDE: f64 = 1.5;

/// A step moves some link by at least this, in radians or sizes; less is only a change of coordinates.
const SEEN: f64 = 1e-3;

/// A continuous set of solutions.
pub struct Continuum {
    /// Dimensions, one as a rule.
    pub dimension: usize,
    /// Placements of the links along it.
    points: Vec<Vec<f64>>,
    /// How far apart neighbouring points are at most.
    spacing: f64,
}

impl Continuum {
    /// The set of a closed pose; `None` if the pose is isolated.
    pub fn new(system: &System, alike: &Alike<'_>, pose: &[f64]) -> Option<Self> {
        let mut blocks = system.blocks().iter().enumerate();
        blocks.find_map(|(index, block)| {
            let tangents = null_tangents(system, block, pose);
            (!tangents.is_empty()).then_some(())?;
            follow_set(system, alike, index, pose, &tangents)
        })
    }

    /// Whether a pose with the link placements `links` belongs to it; the pose is known to have `dimension` free
    /// directions.
    pub fn holds(&self, links: &[f64], dimension: usize) -> bool {
        let near = |point: &Vec<f64>| {
            point.len() == links.len() && largest_difference(point, links) <= BESIDE * self.spacing
        };
        self.dimension > 1 && dimension == self.dimension || self.points.iter().any(near)
    }
}

/// Number of free directions of all blocks together at a closed pose.
pub fn lost_rank(system: &System, pose: &[f64]) -> usize {
    let blocks = system.blocks().iter();
    blocks
        .map(|block| null_tangents(system, block, pose).len())
        .sum()
}

/// Directions of the scaled unknowns that open no loop to first order.
fn null_tangents(system: &System, block: &Block, pose: &[f64]) -> Vec<Vec<f64>> {
    let (rows, columns) = (block.rows(), block.unknowns.len());
    if columns == 0 {
        return Vec::new();
    }
    let mut workspace = BlockWorkspace::default();
    workspace.evaluate(system.mechanism(), block, pose, Want::Jacobian);
    let conditioning = jacobian_conditioning(&workspace.jacobian, rows, columns);
    if conditioning.sigma_min >= SINGULAR {
        return Vec::new();
    }
    // At a singular pose at least one direction is free, regardless of the tolerance of the rank.
    let rank = conditioning.rank.min(columns - 1);
    null_space(&workspace.jacobian, rows, columns, rank)
}

/// Follows the solutions of a block both ways along the first tangent; later blocks go along.
fn follow_set(
    system: &System,
    alike: &Alike<'_>,
    index: usize,
    pose: &[f64],
    tangents: &[Vec<f64>],
) -> Option<Continuum> {
    let (mechanism, block) = (system.mechanism(), &system.blocks()[index]);
    let mut corrector = Corrector::new(system);
    let first = alike.place(pose).links;
    let (mut points, mut spacing, mut longest) = (vec![first.clone()], 0.0_f64, 0);
    // Predictor and corrector along the set, forwards and backwards, until it closes or ends.
    'ways: for sense in [1.0, -1.0] {
        let turned = tangents
            .iter()
            .map(|t| t.iter().map(|x| sense * x).collect());
        let mut path = BranchPath::of_solutions(mechanism, block, pose, turned.collect());
        let mut last = first.clone();
        let most = if tangents.len() > 1 {
            FIRST_STEPS
        } else {
            MOST_STEPS
        };
        for step in 1..=most {
            if !path.step(STEP)
                || !closes_again(system, &mut corrector, &mut path.coordinates)
                || !is_at_root(system, &path.coordinates)
            {
                break;
            }
            let links = alike.place(&path.coordinates).links;
            let gap = largest_difference(&links, &last);
            if links.len() != last.len() || gap < SEEN * STEP {
                break;
            }
            spacing = spacing.max(gap);
            longest = longest.max(step);
            let is_back = step > FIRST_STEPS && largest_difference(&links, &first) <= spacing;
            last.clone_from(&links);
            points.push(links);
            if is_back {
                break 'ways;
            }
        }
    }
    (longest >= FIRST_STEPS).then_some(Continuum {
        dimension: tangents.len(),
        points,
        spacing,
    })
}

/// Closes all blocks beside a pose that is closed in the followed one.
fn closes_again(system: &System, corrector: &mut Corrector, coordinates: &mut [f64]) -> bool {
    // Singular blocks converge within their rank, and otherwise keep their coordinates.
    corrector
        .correct(system, coordinates, Pace::Patient)
        .converged
}

/// Whether equations are small at a pose because a root is there, not because their terms vanish.
fn is_at_root(system: &System, pose: &[f64]) -> bool {
    let mut pose = pose.to_vec();
    let mut blocks = system.blocks().iter();
    blocks.all(|block| settle_block(system.mechanism(), block, &mut pose))
}
