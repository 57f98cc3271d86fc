//! Which dimensions have which tolerances.

use crate::analysis::study::ParametricMechanism;
use crate::kinematics::enclosure::region::ToleranceInterval;
use crate::limits::Deadline;
use crate::model::mechanism::Kind;
use crate::model::printed::input_rounding;
use crate::numbers::rounding::{DECIMAL, GROW};
use std::sync::atomic::{AtomicBool, Ordering};

/// Maximum number of dimensions that are enclosed together.
pub const MOST_DIMENSIONS: usize = 128;

/// Maximum size of forms that have room for more than the dimensions.
const MOST_MARKED: usize = 48;

/// A dimension with its tolerance.
#[derive(Clone, Debug, PartialEq)]
pub struct TolerancedDimension {
    /// Name of the parameter, or of the input.
    pub name: String,
    /// What it measures.
    pub kind: Kind,
    /// Half the width of its interval, in internal units.
    pub tolerance: f64,
    /// The coordinate that represents it.
    pub slot: usize,
}

/// A family with tolerances.
#[derive(Clone, Debug)]
pub struct TolerancePlan<'f> {
    /// Its dimensions are inputs.
    pub family: &'f ParametricMechanism,
    /// Those with a tolerance.
    pub dimensions: Vec<TolerancedDimension>,
    /// Raised to cancel the enclosure.
    cancel: Option<&'f AtomicBool>,
    /// The enclosure ends then, with what is proved.
    deadline: Deadline,
}

impl<'f> TolerancePlan<'f> {
    /// The family's variables and its own inputs with the tolerances given by name, in internal units.
    pub fn new(family: &'f ParametricMechanism, tolerances: &[(String, f64)]) -> Self {
        let mechanism = family.mechanism();
        let first = mechanism.unknowns.len();
        let inputs = mechanism.inputs.iter().zip(first..);
        let dimensions = inputs.filter_map(|(input, slot)| {
            let (_, tolerance) = tolerances.iter().find(|(name, _)| *name == input.name)?;
            Some(TolerancedDimension {
                name: input.name.clone(),
                kind: input.kind,
                tolerance: *tolerance,
                slot,
            })
        });
        Self {
            family,
            dimensions: dimensions.collect(),
            cancel: None,
            deadline: Deadline::default(),
        }
    }

    /// The same, cancelled when `cancel` is raised.
    pub fn until(self, cancel: &'f AtomicBool) -> Self {
        Self {
            cancel: Some(cancel),
            ..self
        }
    }

    /// The same, ended at a deadline.
    pub fn by(self, deadline: Deadline) -> Self {
        Self { deadline, ..self }
    }

    /// Whether the enclosure has been cancelled, or its time is over.
    pub fn is_cancelled(&self) -> bool {
        self.cancel.is_some_and(|flag| flag.load(Ordering::Relaxed)) || self.deadline.is_over()
    }

    /// The size of forms for this many dimensions: with room for the sides of the largest block's box, unless that is
    /// too large.
    pub fn room_for(&self, dimensions: usize) -> usize {
        let blocks = self.family.system().blocks().iter();
        let largest = blocks.map(|block| block.unknowns.len()).max();
        match dimensions + largest.unwrap_or(0) {
            all if all <= MOST_MARKED => all,
            _ => dimensions,
        }
    }

    /// The same with all tolerances multiplied by `factor`.
    pub fn scaled(&self, factor: f64) -> Self {
        let mut plan = self.clone();
        for dimension in &mut plan.dimensions {
            dimension.tolerance *= factor;
        }
        plan
    }

    /// The intervals at a pose: they contain the decimal numbers as written, not only the nearest f64.
    pub fn tolerances(&self, pose: &[f64]) -> Vec<ToleranceInterval> {
        let of = |dimension: &TolerancedDimension| ToleranceInterval {
            slot: dimension.slot,
            half_width: (dimension.tolerance * (1.0 + 2.0 * DECIMAL)
                + 2.0 * DECIMAL * pose[dimension.slot].abs())
                * GROW,
        };
        self.dimensions.iter().map(of).collect()
    }

    /// The distance of the inputs as written from their f64 values: the rounding of a printed table.
    pub fn input_open(&self, pose: &[f64]) -> Vec<f64> {
        let mechanism = self.family.mechanism();
        let values = &pose[mechanism.unknowns.len()..];
        let pairs = mechanism.inputs.iter().zip(values);
        pairs
            .map(|(input, value)| input_rounding(*value, mechanism.unit_of(input.kind)))
            .collect()
    }
}
