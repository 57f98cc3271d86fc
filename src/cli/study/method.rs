//! The search that `mechanim optimise` asks for, of one set of variables or of pairs of them.

use crate::analysis::optimise::Ended;
use crate::analysis::study::ParametricMechanism;
use crate::analysis::study::optimum::Method;
use crate::cli::args::study::{MethodArg, OptimiseArgs};

/// Version of the JSON documents.
pub const SCHEMA: u32 = 1;

/// Tolerances where none is asked for: what the common simplex search takes, and what rounding allows.
const SIMPLEX_TOLERANCE: f64 = 1e-4;
const GRADIENT_TOLERANCE: f64 = 1e-9;

/// Ranges of a share of the variables' values, in place of the study's.
pub fn widen_variables(family: &mut ParametricMechanism, share: f64) {
    for variable in &mut family.study.variables {
        let half = share * variable.start.abs();
        if half > 0.0 {
            (variable.lower, variable.upper) = (variable.start - half, variable.start + half);
        }
    }
}

/// The method asked for.
pub fn search_method(args: &OptimiseArgs) -> Method {
    let tolerance = |usual: f64| args.tolerance.unwrap_or(usual);
    match args.method {
        MethodArg::NelderMead => Method::NelderMead {
            tolerance: tolerance(SIMPLEX_TOLERANCE),
        },
        MethodArg::Bfgs => Method::Bfgs {
            tolerance: tolerance(GRADIENT_TOLERANCE),
        },
        MethodArg::Minimax => Method::Minimax {
            tolerance: tolerance(GRADIENT_TOLERANCE),
        },
        MethodArg::Evolution => Method::Evolution {
            tolerance: tolerance(GRADIENT_TOLERANCE),
            seed: args.seed,
        },
    }
}

/// The end of a search in words.
pub fn ending_word(ended: Ended) -> &'static str {
    match ended {
        Ended::Converged => "converged",
        Ended::Stalled => "no step gains any more",
        Ended::OutOfBudget => "iterations used up",
        Ended::Stopped => "interrupted, best so far",
    }
}
