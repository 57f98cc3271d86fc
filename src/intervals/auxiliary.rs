//! Auxiliary systems, "compress and inflate": if the formal solution is improper, that of a system with a narrower
//! matrix or a wider right-hand side may be proper. It proves something about the auxiliary system; about the original
//! system only if the test with outward rounding succeeds.

use super::formal::{Formal, formal_solution};
use super::kaucher::Kaucher;
use super::system::{IntervalSystem, SolutionSet, TernaryAnswer};

/// One auxiliary system: the radii of A times `of_a`, those of b times `of_b`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AuxiliaryPlan {
    /// At most one.
    pub of_a: f64,
    /// At least one.
    pub of_b: f64,
}

/// The result of a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct AuxiliaryResult {
    /// The plan.
    pub plan: AuxiliaryPlan,
    /// The formal solution of its system for the set asked for.
    pub formal: Formal,
    /// Whether a proper solution lies in the set of the original system.
    pub holds: TernaryAnswer,
}

/// Solves the auxiliary systems of `plans` formally for the united or tolerable set. Boxes whose test says
/// [`TernaryAnswer::Yes`] lie in the set, and so does their union.
pub fn auxiliary_solutions(
    system: &IntervalSystem,
    kind: &SolutionSet,
    plans: &[AuxiliaryPlan],
    tau: f64,
) -> Vec<AuxiliaryResult> {
    let of_plan = |plan: &AuxiliaryPlan| {
        let changed = IntervalSystem {
            a: (system.a.iter())
                .map(|row| {
                    row.iter()
                        .map(|a| resized_interval(*a, plan.of_a))
                        .collect()
                })
                .collect(),
            b: system
                .b
                .iter()
                .map(|b| resized_interval(*b, plan.of_b))
                .collect(),
        };
        // The formal solution of the changed system is tested against the original one.
        let formal = formal_solution(&changed.inclusion(kind), tau);
        let holds = match &formal {
            Formal::Solved { x, improper, .. } if improper.is_empty() => system.holds_box(x, kind),
            _ => TernaryAnswer::Open,
        };
        AuxiliaryResult {
            plan: *plan,
            formal,
            holds,
        }
    };
    plans.iter().map(of_plan).collect()
}

fn resized_interval(interval: Kaucher, factor: f64) -> Kaucher {
    let (middle, radius) = (interval.middle(), interval.radius() * factor);
    Kaucher::new(middle - radius, middle + radius)
}
