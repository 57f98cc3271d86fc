//! A proof beside a pose: how near the exact closed pose is, and within which radius it is the only one.
//!
//! Newton and Kantorovich with explicit constants. With x the computed pose, R near the inverse of the Jacobian J,
//! F the residual in the form of [`chain`], and all unknowns measured in radians and mechanism sizes:
//!
//! ```text
//! eta >= |R F(x)|    q >= |I - R J(x)|    K >= |R F''| within BALL of x    D = (1-q)² - 2 K eta
//! error bound r = 2 eta / (1 - q + sqrt D),    uniqueness (1-q)/K,    if q < 1, D > 0, r <= BALL
//! ```
//!
//! Rounding is part of eta and q. F is evaluated with 31 digits; what remains is the sine and cosine of f64, assumed
//! right within one unit in the last place, and dimensions that are no whole numbers, taken as known to one unit.
//! The inputs are taken as exactly the numbers of the sample. The skew part of the loop's rotation also vanishes at a
//! half-turn; a positive trace rules it out.
//!
//! Blocks are proved in their order. Of every unknown of an earlier block that enters a later one its Newton step is
//! taken into the later residual, and what is left of its error bound is added to eta through |R times its column|, and
//! to q and eta through the second derivatives.
//!
//! Limits: equations that the structure found empty at random poses are taken as empty. Of an over-determined
//! block the rows fixed for the branch signs are proved; the dropped rows are only checked to be small. Where arguments
//! or equations are no affine forms, the test of [`tube`] with its interval arithmetic takes a pose that stands still:
//! simpler, and a few times less sharp. The motion between poses is proved there too.

pub mod chain;
pub mod double;
pub mod flow;
pub mod interval;
mod kantorovich;
mod system;
pub mod tube;

use super::structure::Structure;
use crate::model::chain::Argument;
use crate::model::expression::Affine;
use crate::model::mechanism::Mechanism;
use chain::ArgumentDouble;
use kantorovich::Earlier;
use system::BlockProof;

/// Radius (radians, mechanism sizes) in which the second derivatives are bounded: larger ones prove no more in
/// practice, and the reach of sliders grows with it.
pub const BALL: f64 = 0.25;

/// What could be proved about a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Certificate {
    /// An exact closed pose exists.
    Certified {
        /// No unknown differs from it by more: lengths in the scene's unit; angles as radians times the
        /// mechanism's size.
        error_bound: f64,
        /// It is the only one within this distance, measured likewise.
        unique_radius: f64,
    },
    /// Nothing was proved.
    Refused {
        /// Why.
        reason: Reason,
    },
}

/// Why a pose has no certificate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// A formula has no bounded derivatives here: a kink, a pole, the end of its range.
    Formula,
    /// Too near a singular pose (or too far from a closed one) for the test to succeed.
    Singular,
    /// A loop is turned by more than a right angle: the skew part cannot tell closed from turned by π.
    HalfTurn,
    /// An equation that the proof leaves out does not hold.
    Open,
    /// Nobody wanted one.
    NotAsked,
}

impl Reason {
    /// The word used in reports.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Formula => "formula",
            Self::Singular => "near-singular",
            Self::HalfTurn => "half-turn",
            Self::Open => "open",
            Self::NotAsked => "not-asked",
        }
    }
}

/// Proves poses of one mechanism.
#[derive(Clone, Debug)]
pub struct Certifier<'m> {
    mechanism: &'m Mechanism,
    structure: &'m Structure,
    /// Affine forms of the arguments, then of the equations; `None` for formulas.
    forms: Vec<Option<Affine>>,
}

impl<'m> Certifier<'m> {
    /// Prepares the proof.
    pub fn new(mechanism: &'m Mechanism, structure: &'m Structure) -> Self {
        let arguments = mechanism.arguments.iter().map(|a| match a {
            Argument::Affine(affine) => Some(affine.clone()),
            Argument::Formula(expression) => expression.affine(),
        });
        let equations = mechanism.equations.iter().map(|e| e.expression.affine());
        Self {
            mechanism,
            structure,
            forms: arguments.chain(equations).collect(),
        }
    }

    /// Tries to prove the pose at `coordinates` (unknowns, then inputs). `bases` are the rows that each block is
    /// proved on, as [`BranchWatch::bases`](super::branch::BranchWatch::bases) has them.
    pub fn certify(&self, coordinates: &[f64], bases: &[Vec<usize>]) -> Certificate {
        let proof = match self.prove(coordinates, bases) {
            Err(Reason::Formula) => tube::pose(self.mechanism, self.structure, coordinates, bases),
            proof => proof,
        };
        match proof {
            Ok((error, radius)) => Certificate::Certified {
                error_bound: error * self.mechanism.size * (1.0 + 1e-12),
                unique_radius: radius * self.mechanism.size * (1.0 - 1e-12),
            },
            Err(reason) => Certificate::Refused { reason },
        }
    }

    /// Error bound and radius of uniqueness in radians and sizes.
    fn prove(&self, coordinates: &[f64], bases: &[Vec<usize>]) -> Result<(f64, f64), Reason> {
        let blank = Affine::default();
        let arguments: Vec<ArgumentDouble> = self.forms[..self.mechanism.arguments.len()]
            .iter()
            .map(|form| ArgumentDouble::new(form.as_ref().unwrap_or(&blank), coordinates))
            .collect();
        let n = self.mechanism.unknowns.len();
        let mut earlier = Earlier {
            step: vec![0.0; n],
            rest: vec![0.0; n],
            largest: 0.0,
        };
        let mut radius = f64::INFINITY;
        for (block, basis) in self.structure.blocks.iter().zip(bases) {
            let used = block
                .arguments
                .iter()
                .copied()
                .chain(self.equations_of(block));
            if used.into_iter().any(|form| self.forms[form].is_none()) {
                return Err(Reason::Formula);
            }
            let proof = BlockProof {
                certifier: self,
                block,
                coordinates,
                arguments: &arguments,
                earlier: &earlier,
            };
            let (block_bounds, unique) = proof.run(basis)?;
            for (unknown, bound) in block.unknowns.iter().zip(block_bounds) {
                earlier.step[*unknown] = bound.step;
                earlier.rest[*unknown] = bound.rest;
                earlier.largest = earlier.largest.max(bound.step.abs() + bound.rest);
            }
            radius = radius.min(unique);
        }
        Ok((earlier.largest, radius))
    }

    /// Where the affine forms of a block's equations stand.
    fn equations_of<'b>(
        &self,
        block: &'b super::structure::Block,
    ) -> impl Iterator<Item = usize> + 'b {
        let first = self.mechanism.arguments.len();
        block.equations.iter().map(move |index| first + index)
    }
}
