//! Searches the optimum of a study by the chosen method, and verifies it afterwards.

use super::family::ParametricMechanism;
use super::family_error::FamilyError;
use super::peaks::Peaks;
use super::search::{Refusals, StudySearch, Watch};
use super::track_poses::{Evaluator, TrackPoses};
use super::whole_limits::{WholeLimit, whole_limits};
use crate::analysis::optimise::{
    LET_PASS, Minimum, Objective, StopReason, bfgs, constraints, evolution, minimax, nelder_mead,
};
use crate::diag::Source;
use crate::scene::{Overrides, load_scene};
use std::sync::atomic::{AtomicBool, Ordering};

/// Length of the first step of a gradient search, as a share of the variables.
const FIRST_STEP: f64 = 0.02;

/// Radius of a trust region, as a fraction of the variables, below which nothing is gained.
const SMALLEST_RADIUS: f64 = 1e-12;

/// Members of a generation for each variable.
const MEMBERS_PER_VARIABLE: usize = 8;

/// The search method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// Simplex.
    NelderMead {
        /// Of the variables, as shares of their sizes, and of the values, as a share of their differences in the first simplexes.
        tolerance: f64,
    },
    /// Quasi-Newton.
    Bfgs {
        /// Of the scaled gradient, relative to the first value.
        tolerance: f64,
    },
    /// Quadratic programmes over every pose, for an objective that is the largest of many values.
    Minimax {
        /// Of the predicted decrease, relative.
        tolerance: f64,
    },
    /// Differential evolution, then quasi-Newton.
    Evolution {
        /// Of the spread of the generation, relative.
        tolerance: f64,
        /// Where random numbers start.
        seed: u64,
    },
}

/// The methods without their tolerances.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum SearchMethod {
    /// Simplex search of Nelder and Mead: values only.
    NelderMead,
    /// Quasi-Newton method with exact gradients.
    #[default]
    Bfgs,
    /// Quadratic programmes over every pose: for an objective that is the largest of many values.
    Minimax,
    /// Differential evolution over the whole ranges, then quasi-Newton from its best.
    Evolution,
}

/// Default tolerances: a simplex search halves its steps twenty times, for the six digits that are printed; those of gradients are set
/// by rounding.
const SIMPLEX_TOLERANCE: f64 = 1e-6;
const GRADIENT_TOLERANCE: f64 = 1e-9;

impl SearchMethod {
    /// The method with `tolerance` or its default; `seed` is for its random numbers.
    pub(crate) fn with_tolerance(self, tolerance: Option<f64>, seed: u64) -> Method {
        let simplex = tolerance.unwrap_or(SIMPLEX_TOLERANCE);
        let tolerance = tolerance.unwrap_or(GRADIENT_TOLERANCE);
        match self {
            Self::NelderMead => Method::NelderMead { tolerance: simplex },
            Self::Bfgs => Method::Bfgs { tolerance },
            Self::Minimax => Method::Minimax { tolerance },
            Self::Evolution => Method::Evolution { tolerance, seed },
        }
    }
}

/// An improvement found by a search.
#[derive(Clone, Debug, PartialEq)]
pub struct Improvement {
    /// Iteration; zero for the start.
    pub iteration: usize,
    /// Values of the variables.
    pub values: Vec<f64>,
    /// The objective.
    pub objective: f64,
}

/// What a search of a study found.
#[derive(Clone, Debug, PartialEq)]
pub struct Optimum {
    /// The minimum; variables in internal units.
    pub minimum: Minimum,
    /// The objective at the file's own values.
    pub first_value: f64,
    /// Candidates that were refused.
    pub refusals: Refusals,
    /// The poses from which the search reached its last points.
    pub poses: TrackPoses,
}

/// Minimises the study's objective within bounds and constraints; ends with the best point so far when `cancel` is
/// raised. The value is infinite if that happens before the first pose.
///
/// # Errors
/// No objective, no poses at the start, or no bounds where the method needs them.
pub fn find_optimum(
    family: &ParametricMechanism,
    method: Method,
    iterations: usize,
    watch: Box<Watch<'_>>,
    cancel: &AtomicBool,
) -> Result<Optimum, FamilyError> {
    let mut optimum = match method {
        Method::Minimax { tolerance } => {
            least_largest(family, tolerance, iterations, watch, cancel)?
        }
        _ => search_optimum(family, method, iterations, watch, cancel)?,
    };
    if cancel.load(Ordering::Relaxed) {
        optimum.minimum.ended = StopReason::Stopped;
    }
    Ok(optimum)
}

fn search_optimum(
    family: &ParametricMechanism,
    method: Method,
    iterations: usize,
    watch: Box<Watch<'_>>,
    cancel: &AtomicBool,
) -> Result<Optimum, FamilyError> {
    let mut search = StudySearch::new(family, watch)?.until(cancel);
    let (bounds, scales) = (search.bounds(), search.scales());
    let finite = bounds
        .lower
        .iter()
        .chain(&bounds.upper)
        .all(|b| b.is_finite());
    if matches!(method, Method::Evolution { .. }) && !finite {
        let message = "evolution searches a box: give every variable a range";
        return Err(FamilyError::Lacks(message.to_owned()));
    }
    let first_value = search.value();
    let limits = search.constraint_scales();
    // The minimiser without constraints; those with limits call it in rounds.
    let mut run = |objective: &mut dyn Objective, x: &[f64]| -> Minimum {
        let newton = |objective: &mut dyn Objective, x: &[f64], tolerance: f64| {
            let limits = bfgs::BfgsLimits {
                gradient_tolerance: tolerance,
                iterations,
                first_step: FIRST_STEP,
            };
            bfgs::minimise_bfgs(objective, x, &scales, &bounds, limits)
        };
        match method {
            Method::NelderMead { tolerance } => {
                let limits = nelder_mead::NelderMeadLimits {
                    x_tolerance: tolerance,
                    value_tolerance: tolerance,
                    evaluations: 4 * iterations,
                };
                nelder_mead::minimise_nelder_mead(objective, x, &scales, &bounds, limits)
            }
            Method::Bfgs { tolerance } | Method::Minimax { tolerance } => {
                newton(objective, x, tolerance)
            }
            Method::Evolution { tolerance, seed } => {
                let limits = evolution::EvolutionLimits {
                    members: MEMBERS_PER_VARIABLE * x.len() + 4,
                    generations: iterations,
                    seed,
                    value_tolerance: tolerance,
                };
                let found = evolution::minimise_by_evolution(objective, x, &bounds, limits);
                // Differential evolution finds the valley, BFGS its bottom.
                let refined = newton(objective, &found.x, tolerance);
                let total = Minimum {
                    iterations: found.iterations + refined.iterations,
                    evaluations: found.evaluations + refined.evaluations,
                    ..refined
                };
                if total.value <= found.value {
                    total
                } else {
                    found
                }
            }
        }
    };
    // Augmented Lagrangian where there are limits.
    let start = family.start();
    let mut minimum = if limits.is_empty() {
        run(&mut search, &start)
    } else {
        constraints::minimise_constrained(&mut search, &start, &limits, LET_PASS, &mut run)
    };
    // A cancelled line search passes through its remaining trials without evaluating them.
    minimum.evaluations = minimum.evaluations.min(search.evaluations());
    Ok(Optimum {
        minimum,
        first_value,
        poses: search.poses().clone(),
        refusals: search.refusals,
    })
}

fn least_largest(
    family: &ParametricMechanism,
    tolerance: f64,
    iterations: usize,
    watch: Box<Watch<'_>>,
    cancel: &AtomicBool,
) -> Result<Optimum, FamilyError> {
    // A search without iterations gives bounds, scales and the first value.
    let quiet = StudySearch::new(family, Box::new(|_, _, _| true))?;
    let (bounds, scales, first_value) = (quiet.bounds(), quiet.scales(), quiet.value());
    let mut evaluator = Evaluator::new(family).until(cancel);
    let start = evaluator.nominal(family.nominal()?.poses);
    let mut peaks = Peaks::new(family, evaluator, start, watch)?;
    let search = minimax::MinimaxSearch {
        radius: FIRST_STEP,
        smallest_radius: SMALLEST_RADIUS,
        tolerance,
        iterations,
    };
    let minimum = minimax::minimise_largest(&mut peaks, &family.start(), &scales, &bounds, search);
    Ok(Optimum {
        minimum,
        first_value,
        poses: peaks.poses().clone(),
        refusals: peaks.refusals,
    })
}

/// The result of an independent motion along the tracks with the optimised values.
#[derive(Clone, Debug, PartialEq)]
pub struct Verified {
    /// Every measure.
    pub measures: Vec<f64>,
    /// Its poses.
    pub track_poses: TrackPoses,
    /// Largest certified error of a coordinate.
    pub error_bound: f64,
    /// Poses without a certificate.
    pub unproved: usize,
    /// Number of poses.
    pub poses: usize,
    /// Largest violation of a constraint, as a share of its bound; zero or less inside.
    pub violation: f64,
    /// The limited measures of the drive over the whole motion, between those poses too.
    pub whole: Vec<WholeLimit>,
}

/// Reads the scene again with the values as its parameters, follows the tracks from the start of the drive, and
/// measures. `passes_singular` says whether the motion with the file's values passes a singular pose.
///
/// # Errors
/// The values cannot be assembled, or not along the way from the start values; the way passes a singular pose that it did not pass
/// before, from where it may go on in another assembly.
pub fn verify_optimum(
    source: &Source,
    overrides: &Overrides,
    parameters: Vec<(String, String)>,
    (vary, passes_singular): (&[String], bool),
) -> Result<Verified, FamilyError> {
    let overrides = Overrides {
        parameters,
        ..overrides.clone()
    };
    // Nothing of the search is reused: neither its poses nor its branch.
    let family = ParametricMechanism::load(source, &overrides, vary)?;
    let nominal = family.nominal()?;
    if let Some(passage) = nominal.singular.filter(|_| !passes_singular) {
        let (track, pose) = family.place_of(passage.behind);
        return Err(FamilyError::Lacks(format!(
            "the motion passes a singular pose before pose {pose} of {track}, which that of the file's values does not: it may go \
             on in another assembly"
        )));
    }
    let (error_bound, unproved, poses) =
        (nominal.error_bound, nominal.unproved, nominal.poses.len());
    let mut evaluator = Evaluator::new(&family);
    let track_poses = evaluator.nominal(nominal.poses);
    let measured = evaluator.measure_sought(&track_poses);
    let measures = measured
        .map_err(|r| FamilyError::Lacks(r.to_string()))?
        .measures;
    let pairs = family.measures.list.iter().zip(&measures);
    let mut scene = load_scene(source, &overrides).map_err(Box::new)?;
    scene.keep_limits_of_study();
    // Negative inside of all limits.
    let violations = pairs.map(|(m, value)| m.violation(*value));
    let violation = violations.fold(f64::NEG_INFINITY, f64::max);
    Ok(Verified {
        measures,
        track_poses,
        error_bound,
        unproved,
        poses,
        violation,
        whole: whole_limits(&scene)?,
    })
}
