//! A proof beside a pose: how near the exact closed pose is, and within which radius it is the only one.
//!
//! Newton and Kantorovich with explicit constants. With x the computed pose, R near the inverse of the Jacobian J,
//! F the residual in the form of [`chain`](pose::chain), and all unknowns measured in radians and mechanism sizes:
//!
//! ```text
//! eta >= |R F(x)|    q >= |I - R J(x)|    K >= |R F''| within BALL of x    D = (1-q)² - 2 K eta
//! error bound r = 2 eta / (1 - q + sqrt D),    uniqueness (1-q)/K,    if q < 1, D > 0, r <= BALL
//! ```
//!
//! Rounding is part of eta and q. F is evaluated with 23 digits, sine and cosine with 20 (`circle`), so that no function
//! of the platform is trusted; constants come with their error. The inputs are the numbers of the sample, or the decimals
//! that a table prints for them. The skew part of the loop's rotation also vanishes at a
//! half-turn; a positive trace rules it out.
//!
//! The Newton step of the proof is known far better than f64 can say where the pose is. So a pose can be moved by it to
//! the nearest numbers, and what is left of its error bound is little more than their rounding.
//!
//! Blocks are proved in their order. Of every unknown of an earlier block that enters a later one its Newton step is
//! taken into the later residual, and what is left of its error bound is added to eta through |R times its column|, and
//! to q and eta through the second derivatives.
//!
//! Limits: equations that the structure found empty at random poses are taken as empty. Of an over-determined
//! block the rows fixed for the branch signs are proved; the dropped rows are only checked to be small. Where arguments
//! or equations are no affine forms, the test of [`tube`] with its interval arithmetic takes a pose that stands still:
//! simpler, and a few times less sharp. The motion between poses is proved there too.

pub mod neighbourhood;
pub mod pose;
pub mod tube;

use super::results::certificate::{Certificate, Reason};
use super::solve::newton::Corrector;
use crate::kinematics::structure::system::System;
use crate::model::chain::Argument;
use crate::model::expression::Affine;
use crate::numbers::double_double::DoubleDouble;
use crate::numbers::rounding::U;
use pose::chain::ArgumentDouble;
use pose::kantorovich::{Earlier, Kantorovich};
use pose::system::BlockSystem;

/// Proves poses of one mechanism. Laid out once; proving allocates nothing unless formulas are
/// involved.
#[derive(Clone, Debug)]
pub struct Certifier<'m> {
    system: &'m System,
    forms: Vec<Option<Affine>>,
    systems: Vec<BlockSystem>,
    kantorovich: Kantorovich,
    arguments: Vec<ArgumentDouble>,
    earlier: Earlier,
}

impl<'m> Certifier<'m> {
    /// Prepares the proof.
    pub fn new(system: &'m System) -> Self {
        let mechanism = system.mechanism();
        let structure = system.structure();
        let arguments = mechanism.arguments.iter().map(|a| match a {
            Argument::Affine(affine) => Some(affine.clone()),
            Argument::Formula(expression) => expression.affine(),
        });
        let equations = mechanism.equations.iter().map(|e| e.expression.affine());
        let forms: Vec<Option<Affine>> = arguments.chain(equations).collect();
        let blocks = structure.blocks.iter();
        Self {
            system,
            systems: blocks
                .map(|block| BlockSystem::new(mechanism, block, &forms))
                .collect(),
            forms,
            kantorovich: Kantorovich::default(),
            arguments: Vec::new(),
            earlier: Earlier::default(),
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
        match self.prove([coordinates, rests], bases, None) {
            Ok(radius) => self.certificate(self.earlier.largest, radius),
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
        let radius = match self.prove([coordinates, rests], bases, Some(corrector)) {
            Ok(radius) => radius,
            Err(Reason::Formula) => return self.certify_formulas([coordinates, rests], bases),
            Err(reason) => return Certificate::Refused { reason },
        };
        let (mut error, mut moved) = (0.0_f64, 0.0_f64);
        for system in &self.systems {
            for &slot in &system.unknowns {
                let scale = self.system.mechanism().scale_of(slot);
                let (step, rest) = (self.earlier.step[slot], self.earlier.rest[slot]);
                let old = coordinates[slot];
                let new = old - scale * step;
                let made = DoubleDouble::sum(old, -new).hi / scale;
                // The difference of neighbours is exact or rounded once, as is the quotient.
                let rounding = 4.0 * U * (made.abs() + step.abs());
                error = error.max((made - step).abs() + rounding + rest);
                moved = moved.max(made.abs() + rounding);
                coordinates[slot] = new;
            }
        }
        self.certificate(error, radius - moved)
    }

    /// The proof where arguments or equations are no affine forms.
    fn certify_formulas(&self, place: [&[f64]; 2], bases: &[Vec<usize>]) -> Certificate {
        match tube::pose(self.system, place, bases) {
            Ok((error, radius)) => self.certificate(error, radius),
            Err(reason) => Certificate::Refused { reason },
        }
    }

    /// From radians and sizes, so that both hold for every unknown in its own unit.
    fn certificate(&self, error: f64, radius: f64) -> Certificate {
        let [least, largest] = self.system.mechanism().distance_units();
        Certificate::Certified {
            error_bound: error * largest * (1.0 + 1e-12),
            unique_radius: radius * least * (1.0 - 1e-12),
        }
    }

    /// Fills `earlier` with the bounds of all unknowns; the radius of uniqueness in radians and sizes.
    fn prove(
        &mut self,
        [coordinates, rests]: [&[f64]; 2],
        bases: &[Vec<usize>],
        corrector: Option<&Corrector>,
    ) -> Result<f64, Reason> {
        let blank = Affine::default();
        self.arguments.clear();
        let arguments = self.forms[..self.system.mechanism().arguments.len()].iter();
        self.arguments.extend(
            arguments.map(|form| {
                ArgumentDouble::new(form.as_ref().unwrap_or(&blank), coordinates, rests)
            }),
        );
        self.earlier.reset(self.system.mechanism().unknowns.len());
        let mut radius = f64::INFINITY;
        for (index, (system, basis)) in self.systems.iter_mut().zip(bases).enumerate() {
            if system.has_formula {
                return Err(Reason::Formula);
            }
            system.evaluate(
                self.system.mechanism(),
                [coordinates, rests],
                &self.arguments,
            )?;
            if system.left_out_rows_are_open(basis) {
                return Err(Reason::Open);
            }
            let inverse = corrector.and_then(|c| c.inverse(index)).filter(|inverse| {
                inverse.rows().len() == basis.len() && system.rows.len() == basis.len()
            });
            let (unique, error) =
                self.kantorovich
                    .prove(system, basis, inverse, &mut self.earlier)?;
            if system.may_be_half_turned(error.max(self.earlier.largest)) {
                return Err(Reason::HalfTurn);
            }
            radius = radius.min(unique);
        }
        Ok(radius)
    }
}
