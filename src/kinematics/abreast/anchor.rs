//! A known closed pose near which eight designs are solved, and the test whether a nearby pose is regular and on the
//! same side of all singular poses.

use super::factors::{LARGEST_BLOCK, PivotOrder};
use crate::kinematics::solve::newton::Corrector;
use crate::kinematics::structure::system::System;
use crate::numbers::octet::{LaneMask, Octet};

/// Largest distance of a Jacobian from the anchor's, as a fraction of the distance to a singular one.
const MOST_CHANGE: f64 = 0.9;

/// A closed, regular pose.
#[derive(Clone, Debug, PartialEq)]
pub struct AnchorPose {
    /// Unknowns, then inputs.
    pub(super) coordinates: Vec<f64>,
    pub(super) blocks: Vec<BlockAnchor>,
}

/// Data of one block of an anchor, for the designs near it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BlockAnchor {
    pub order: PivotOrder,
    /// By the block's scaled unknowns, column-major.
    jacobian: Vec<f64>,
    /// A row an unknown.
    inverse: Vec<f64>,
    /// Smallest singular value.
    sigma: f64,
}

impl AnchorPose {
    /// An anchor at a closed pose; `None` if a block is singular, over-determined or large, and near a locked ball
    /// joint.
    pub fn new(system: &System, coordinates: &[f64]) -> Option<Self> {
        if system
            .balls()
            .iter()
            .any(|b| b.is_nearly_locked(coordinates))
        {
            return None;
        }
        let mut corrector = Corrector::new(system);
        let mut parts = Vec::new();
        let keep = |index: usize, jacobian: &[f64], sigma: f64| {
            let block = &system.blocks()[index];
            let n = block.unknowns.len();
            (block.rows() == n && n <= LARGEST_BLOCK && sigma > 0.0)
                .then(|| (jacobian.to_vec(), sigma))
        };
        corrector.conditions(system, coordinates, |index, jacobian, c, _| {
            parts.push(keep(index, jacobian, c.sigma_min));
        });
        let blocks = parts.into_iter().enumerate().map(|(index, part)| {
            let (jacobian, sigma) = part?;
            let n = system.blocks()[index].unknowns.len();
            let inverse = corrector.inverse(index)?;
            // Column-major, like the Jacobians with which they are compared.
            let entry = |k: usize| inverse.at(k % n, k / n);
            Some(BlockAnchor {
                order: PivotOrder::of(&jacobian, n)?,
                inverse: (0..n * n).map(entry).collect(),
                jacobian,
                sigma,
            })
        });
        Some(Self {
            blocks: blocks.collect::<Option<_>>()?,
            coordinates: coordinates.to_vec(),
        })
    }
}

impl BlockAnchor {
    /// The members of `lanes` whose Jacobian is regular, with the sign of the anchor's determinant and a smallest
    /// singular value of at least a tenth of the anchor's: no matrix on the line between the two is singular if their
    /// difference is below the smallest singular value (Weyl), or its product with the inverse below one.
    pub fn beside(&self, jacobian: &[Octet], lanes: LaneMask) -> LaneMask {
        let n = self.order.len();
        let pairs = jacobian.iter().zip(&self.jacobian);
        let change = |(new, old): (&Octet, &f64)| *new - Octet::splat(*old);
        let square = pairs.clone().map(change);
        let square = square.fold(Octet::ZERO, |sum, d| sum + d * d);
        let most = MOST_CHANGE * self.sigma;
        let near = lanes.and(square.at_most(Octet::splat(most * most)));
        // The cheap test by Weyl's inequality decides most lanes; the product with the inverse the others.
        if !lanes.without(near).any() {
            return near;
        }
        let changes: Vec<Octet> = pairs.map(change).collect();
        let mut square = Octet::ZERO;
        for column in changes.chunks_exact(n.max(1)) {
            for row in self.inverse.chunks_exact(n.max(1)) {
                let products = row.iter().zip(column);
                let entry = products.fold(Octet::ZERO, |sum, (a, d)| sum + *d * *a);
                square += entry * entry;
            }
        }
        let by_inverse = square.at_most(Octet::splat(MOST_CHANGE * MOST_CHANGE));
        near.or(lanes.and(by_inverse))
    }
}
