//! The proof of a pose: a bound on the distance to the exact closed pose, and the radius within which it is the only one.
//!
//! The Newton-Kantorovich theorem with explicit constants. x is the computed pose, R an approximate inverse of the Jacobian
//! J, F the residual in the form of [`chain`](pose::chain); all unknowns are measured in radians and mechanism sizes:
//!
//! ```text
//! eta >= |R F(x)|    q >= |I - R J(x)|    K >= |R F''| within BALL of x    D = (1-q)² - 2 K eta
//! error bound r = 2 eta / (1 - q + sqrt D),    uniqueness (1-q)/K,    if q < 1, D > 0, r <= BALL
//! ```
//!
//! Rounding is included in eta and q. F is evaluated with 23 digits, sine and cosine with 20 (`circle`), so that no function
//! of the platform needs to be trusted; constants carry their error. The inputs are the numbers of the sample, or the
//! decimals that a table prints for them. The skew part of the loop's rotation also vanishes at a
//! half-turn; a positive trace excludes it.
//!
//! The Newton step of the proof is known much more accurately than f64 can represent the pose. The pose is therefore moved
//! by this step to the nearest numbers, and the remaining error bound is little more than their rounding.
//!
//! Blocks are proved in their order. If an unknown of an earlier block enters a later one, its Newton step is
//! included in the later residual, and the rest of its error bound is added to eta through |R times its column|, and
//! to q and eta through the second derivatives.
//!
//! In a block with more equations than unknowns, as many rows are proved as there are unknowns. The others cannot be proved:
//! whether they hold at the same pose depends on the dimensions, which are known to a few digits only. Each of them is
//! bounded at the exact pose of the proved rows, by the same test with the same digits. If it is open by more than rounding
//! and the digits of the dimensions explain, the pose is refused; otherwise the bound is part of the certificate. The same
//! applies to equations that were found empty at random poses, unless they vanish by the axes of the chain (`proof_plan`).
//!
//! If arguments or equations are not affine, the interval test of [`tube`] is applied to a constant pose: simpler, and a few
//! times less sharp. [`tube`] also proves the motion between poses.

pub mod absence;
pub mod gaps;
pub mod majorant;
pub mod neighbourhood;
pub mod observed;
pub mod pose;
pub mod regular;
pub mod tube;

use super::results::certificate::{Certificate, Reason};
use super::solve::newton::Corrector;
use crate::kinematics::structure::system::System;
use crate::numbers::double_double::DoubleDouble;
use crate::numbers::rounding::{GROW, SHRINK, U};
use pose::prover::PoseProver;
use tube::Standing;

/// Proves poses of one mechanism. Its layout is computed once; proofs allocate memory only for formulas.
#[derive(Clone, Debug)]
pub struct Certifier<'m> {
    system: &'m System,
    prover: PoseProver<'m>,
    /// The prover for formulas, created when needed.
    standing: Option<Standing<'m>>,
}

impl<'m> Certifier<'m> {
    /// Prepares the proof.
    pub fn new(system: &'m System) -> Self {
        Self {
            system,
            prover: PoseProver::new(system),
            standing: None,
        }
    }

    /// Tries to prove the pose at `coordinates` (unknowns, then inputs), where the inputs are `coordinates + rests`: they may be
    /// meant to more digits than f64 has. Rests that are not there are zero. `bases` are the rows that each block is
    /// proved on, as [`BranchWatch::bases`](super::solve::branch::BranchWatch::bases) has them.
    pub fn certify(
        &mut self,
        coordinates: &[f64],
        rests: &[f64],
        bases: &[Vec<usize>],
    ) -> Certificate {
        match self.prover.prove([coordinates, rests], bases, None) {
            Ok(radius) => self.certificate(
                self.prover.earlier.largest,
                radius,
                self.prover.earlier.closes_to,
            ),
            Err(Reason::Formula) => self.certify_formulas([coordinates, rests], bases),
            Err(reason) => Certificate::Refused { reason },
        }
    }

    /// Like [`certify`](Self::certify), and moves the unknowns by the Newton step of the proof to the nearest numbers:
    /// the certificate is then of the pose so moved. A refused pose stays, as does one with formulas. The inverses of `corrector` serve the proof;
    /// if they are of another pose, it is loose or fails.
    pub fn polish(
        &mut self,
        coordinates: &mut [f64],
        rests: &[f64],
        bases: &[Vec<usize>],
        corrector: &Corrector,
    ) -> Certificate {
        let radius = match self
            .prover
            .prove([coordinates, rests], bases, Some(corrector))
        {
            Ok(radius) => radius,
            Err(Reason::Formula) => return self.certify_formulas([coordinates, rests], bases),
            Err(reason) => return Certificate::Refused { reason },
        };
        // One Newton step from the proof; its rounding is added to the bound.
        let (mut error, mut moved) = (0.0_f64, 0.0_f64);
        for block in &self.prover.blocks {
            for &slot in &block.of.unknowns {
                let scale = self.system.mechanism().scale_of(slot);
                let (step, rest) = (
                    self.prover.earlier.step[slot],
                    self.prover.earlier.rest[slot],
                );
                let old = coordinates[slot];
                let new = old - scale * step;
                let made = DoubleDouble::sum(old, -new).hi / scale;
                // The difference of neighbouring numbers is exact or rounded once, as is the quotient.
                let rounding = 4.0 * U * (made.abs() + step.abs());
                error = error.max((made - step).abs() + rounding + rest);
                moved = moved.max(made.abs() + rounding);
                coordinates[slot] = new;
            }
        }
        self.certificate(error, radius - moved, self.prover.earlier.closes_to)
    }

    /// The proof if arguments or equations are not affine.
    fn certify_formulas(&mut self, place: [&[f64]; 2], bases: &[Vec<usize>]) -> Certificate {
        let system = self.system;
        let standing = self.standing.get_or_insert_with(|| Standing::new(system));
        match standing.prove(place, bases) {
            Ok((error, radius, closes_to)) => self.certificate(error, radius, closes_to),
            Err(reason) => Certificate::Refused { reason },
        }
    }

    /// Converts from radians and sizes, so that both hold for every unknown in its own unit.
    fn certificate(&self, error: f64, radius: f64, closes_to: f64) -> Certificate {
        let [least, largest] = self.system.mechanism().distance_units();
        let error_bound = error * largest * GROW;
        let unique_radius = radius * least * SHRINK;
        if self.system.redundant_rows() > 0 {
            return Certificate::Consistent {
                error_bound,
                unique_radius,
                closes_to: closes_to * largest * GROW,
            };
        }
        Certificate::Certified {
            error_bound,
            unique_radius,
        }
    }
}
