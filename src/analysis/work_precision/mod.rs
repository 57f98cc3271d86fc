//! Work-precision diagrams: the same instants of one motion computed by many routes, each with its time and true error.
//!
//! Every route delivers the same poses; one with smaller steps in between takes longer. Times are measured and depend
//! on the machine; errors do not.

mod linkage;
mod row;

use super::observer::{largest_distance, marked_positions};
use super::reference::Reference;
use super::routes::{RotationForm, Route, Walker};
use crate::diag::decimals_of;
use crate::kinematics::loops::forward;
use crate::kinematics::motion::continuation::solve_motion;
use crate::kinematics::motion::sampling::is_cyclic;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::mechanism::Mechanism;
use linkage::LinkageBench;
pub use row::PrecisionRow;
use row::fastest_run;

/// A motion returns if its start and end differ by no more, relative to the size.
const RETURNS: f64 = 1e-9;

/// Steps of the integrations in the drift table, per turn.
pub const DRIFT_STEPS: usize = 180;

/// The drift of a route after some turns.
#[derive(Clone, Debug, PartialEq)]
pub struct Drift {
    /// Name of the route.
    pub name: &'static str,
    /// Turns.
    pub turns: usize,
    /// Largest coordinate difference to the pose at the start.
    pub error: f64,
    /// Closure error there.
    pub closure: f64,
}

/// The whole study.
#[derive(Clone, Debug, PartialEq)]
pub struct PrecisionStudy {
    /// Instants compared, the start not counted.
    pub poses: usize,
    /// Unknowns of the mechanism.
    pub unknowns: usize,
    /// Worst proved error of an unknown in the reference, in the scene's unit; `None` where any has no proof.
    pub reference_bound: Option<f64>,
    /// One per route and setting.
    pub rows: Vec<PrecisionRow>,
    /// Empty where the motion does not return to its start.
    pub drift: Vec<Drift>,
}

/// Why there is no study.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// Routes can only be compared if the motion has poses throughout.
    #[error(
        "the motion has no pose at t = {} s: routes are compared on motions without gaps",
        decimals_of(*time, 9)
    )]
    Gap {
        /// Seconds.
        time: f64,
    },
}

/// A mechanism with its reference.
struct Bench<'m> {
    system: &'m System,
    actuation: &'m Actuation,
    reference: Reference,
    /// Positions of the reference at its times.
    truth: Vec<Vec<f64>>,
    start: Vec<f64>,
}

/// Compares routes on `system` along `actuation` at `poses` instants after the start, and drifts over up to `turns` turns.
///
/// # Errors
/// See [`StudyError`].
pub fn study_precision(
    system: &System,
    actuation: &Actuation,
    poses: usize,
    turns: usize,
) -> Result<PrecisionStudy, StudyError> {
    let mechanism = system.mechanism();
    let times = even_instants(actuation.duration, poses);
    // The reference: proved poses, and the points that are compared.
    let reference = Reference::new(system, actuation, times);
    let mut truth = Vec::with_capacity(poses + 1);
    for (time, pose) in reference.times.iter().zip(&reference.poses) {
        let Some(pose) = pose else {
            return Err(StudyError::Gap { time: *time });
        };
        truth.push(marked_positions(mechanism, pose));
    }
    let start = reference.poses[0].clone().unwrap_or_default();
    let bench = Bench {
        system,
        actuation,
        reference,
        truth,
        start,
    };
    let mut rows = vec![bench.own_row()];
    let settings = route_settings().into_iter();
    rows.extend(settings.map(|(family, route, factor)| bench.row(family, route, poses * factor)));
    rows.extend(
        LinkageBench::new(bench.system, bench.actuation, &bench.reference)
            .iter()
            .flat_map(LinkageBench::rows),
    );
    Ok(PrecisionStudy {
        poses,
        unknowns: mechanism.unknowns.len(),
        reference_bound: bench.reference.bound,
        rows,
        drift: bench.drift(turns),
    })
}

/// `count` equal steps from the start to the end of the drive.
fn even_instants(duration: f64, count: usize) -> Vec<f64> {
    let share = |k: usize| k as f64 / count as f64;
    (0..=count).map(|k| duration * share(k)).collect()
}

/// Families, routes, and steps per pose.
fn route_settings() -> Vec<(&'static str, Route, usize)> {
    let position = |predictor, tolerance, form| Route::Position {
        predictor,
        tolerance,
        form,
    };
    // Predictors of order 0 to 3, corrected to four tolerances.
    let mut list = Vec::new();
    let families = [
        "Newton from the last pose",
        "tangent + Newton",
        "Taylor 2 + Newton",
        "Taylor 3 + Newton",
    ];
    for (predictor, family) in families.into_iter().enumerate() {
        for tolerance in [1e-4, 1e-7, 1e-10, 1e-13] {
            list.push((family, position(predictor, tolerance, RotationForm::Log), 1));
        }
    }
    // One setting with smaller steps, and the residual that accepts half-turns.
    list.push((families[1], position(1, 1e-13, RotationForm::Log), 4));
    for predictor in 0..2 {
        list.push((
            "skew residual",
            position(predictor, 1e-13, RotationForm::Skew),
            1,
        ));
    }
    // Integration of the rates, without and with projection onto the closed poses.
    let ode = |order, projected| Route::Ode { order, projected };
    for factor in [1, 4, 40] {
        list.push(("Euler", ode(1, false), factor));
    }
    for factor in [1, 2, 4, 16, 40] {
        list.push(("Runge-Kutta 4", ode(4, false), factor));
    }
    for factor in [1, 2] {
        list.push(("Runge-Kutta 4 + Newton", ode(4, true), factor));
    }
    list
}

impl Bench<'_> {
    fn mechanism(&self) -> &Mechanism {
        self.system.mechanism()
    }

    fn row(&self, family: &'static str, route: Route, steps: usize) -> PrecisionRow {
        let poses = self.reference.times.len() - 1;
        let mut walker = Walker::new(self.system, self.actuation);
        let (found, time) = fastest_run(|| {
            walker.iterations = 0;
            self.walk(&mut walker, route, steps)
        });
        PrecisionRow {
            family,
            route: Some(route),
            steps,
            time: time * 1e6 / poses as f64,
            iterations: walker.iterations as f64 / poses as f64,
            ..self.judged(&found)
        }
    }

    /// The poses at all instants after the start; those after a failure are missing.
    fn walk(&self, walker: &mut Walker, route: Route, steps: usize) -> Vec<Vec<f64>> {
        let poses = self.reference.times.len() - 1;
        let each = steps / poses;
        let mut coordinates = self.start.clone();
        let mut found = Vec::with_capacity(poses);
        // Times are computed from their index, never summed up.
        let time = |k: usize| self.actuation.duration * (k as f64 / steps as f64);
        for k in 0..steps {
            let done = walker.advance(route, &mut coordinates, time(k), time(k + 1));
            if done.is_none() {
                break;
            }
            if (k + 1) % each == 0 {
                found.push(coordinates.clone());
            }
        }
        found
    }

    /// Errors of the poses at the instants after the start.
    fn judged(&self, found: &[Vec<f64>]) -> PrecisionRow {
        let truth = &self.truth[1..];
        // The position error at each instant, against the reference.
        let errors: Vec<f64> = found
            .iter()
            .zip(truth)
            .map(|(pose, truth)| largest_distance(&marked_positions(self.mechanism(), pose), truth))
            .collect();
        // The closure error needs no reference: it is small in any assembly.
        let closures = found
            .iter()
            .map(|pose| forward::closure_error(self.mechanism(), pose));
        PrecisionRow::new(
            &errors,
            closures,
            (self.truth.len() - 1, self.mechanism().size),
        )
    }

    /// What `mechanim solve` does: steps as long as possible, branch checks, every pose proved.
    fn own_row(&self) -> PrecisionRow {
        let times = &self.reference.times;
        let poses = times.len() - 1;
        let (trajectory, time) = fastest_run(|| solve_motion(self.system, self.actuation, times));
        let samples = trajectory.samples[1..].iter();
        let found: Vec<Vec<f64>> = samples
            .filter_map(|s| Some([s.pose.as_ref()?.unknowns.as_slice(), &s.inputs].concat()))
            .collect();
        // The reference consists of these very poses; their error is estimated by another Newton step.
        let judged = PrecisionRow {
            error: self.reference.moved,
            end_error: self.reference.moved_at_end,
            ..self.judged(&found)
        };
        let iterations: u32 = trajectory.poses().skip(1).map(|p| p.iterations).sum();
        PrecisionRow {
            family: "mechanim solve",
            steps: poses,
            time: time * 1e6 / poses as f64,
            iterations: f64::from(iterations) / poses as f64,
            ..judged
        }
    }

    /// Errors after 1, 10, 100 … turns, as far as `turns`.
    fn drift(&self, turns: usize) -> Vec<Drift> {
        let (first, last) = (&self.truth[0], &self.truth[self.truth.len() - 1]);
        // Drift is measured where a motion returns: over any number of turns the pose should be the same.
        let returns = largest_distance(first, last) <= RETURNS * self.mechanism().size;
        if !returns || !is_cyclic(self.mechanism(), self.actuation) {
            return Vec::new();
        }
        let newton = Route::Position {
            predictor: 1,
            tolerance: super::routes::TIGHT,
            form: RotationForm::Log,
        };
        let ode = |projected| Route::Ode {
            order: 4,
            projected,
        };
        let routes = [
            ("Runge-Kutta 4", ode(false)),
            ("Runge-Kutta 4 + Newton", ode(true)),
            ("tangent + Newton", newton),
        ];
        let mut list = Vec::new();
        for (name, route) in routes {
            self.drift_of(name, route, turns, &mut list);
        }
        list
    }

    fn drift_of(&self, name: &'static str, route: Route, turns: usize, list: &mut Vec<Drift>) {
        let mut walker = Walker::new(self.system, self.actuation);
        let mut coordinates = self.start.clone();
        // The drive is cyclic: times are counted anew in every turn.
        let time = |k: usize| self.actuation.duration * (k as f64 / DRIFT_STEPS as f64);
        let mut next = 1;
        for turn in 1..=turns {
            // One turn; each step starts from the pose before it, so that errors accumulate.
            for k in 0..DRIFT_STEPS {
                if walker
                    .advance(route, &mut coordinates, time(k), time(k + 1))
                    .is_none()
                {
                    return;
                }
            }
            // After 1, 10, 100 ... turns: the exact pose is that of the start, so that the difference is the drift.
            if turn == next {
                next *= 10;
                let here = marked_positions(self.mechanism(), &coordinates);
                list.push(Drift {
                    name,
                    turns: turn,
                    error: largest_distance(&here, &self.truth[0]),
                    closure: forward::closure_error(self.mechanism(), &coordinates),
                });
            }
        }
    }
}
