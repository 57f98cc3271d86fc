//! Statistical trials: all bars get random directions, and the velocities and conjugate positions are solved for each.
//!
//! Velocities are unbounded, since the determinant can be arbitrarily small: quantiles converge, extreme values do not.
//! Trial n is the same for any number of threads.

use crate::analysis::random::Random;

use crate::intervals::chain::{Directions, DyadChain};
use crate::intervals::sweep::{Projector, RowSweep, SolvedRow};
use crate::jobs::share_work;
use crate::math::sin_cos;
use std::f64::consts::TAU;

/// Which random trials are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrialOptions {
    /// Directions that bars may have.
    pub directions: Directions,
    /// Velocity of the given point.
    pub given: [f64; 2],
    /// Number of trials.
    pub count: usize,
    /// Where random numbers start.
    pub seed: u64,
    /// Worker threads.
    pub threads: usize,
}

/// The results of the trials.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trials {
    /// Trials with a solution.
    pub solved: usize,
    /// Share of trials whose determinant has the sign of the drawn pose.
    pub same_sign: f64,
    /// For every unknown point its velocity components, each in ascending order.
    pub velocities: Vec<[Vec<f64>; 2]>,
    /// The same for positions by the conjugate system.
    pub positions: Vec<[Vec<f64>; 2]>,
    /// The largest speed of a point in every trial, ascending.
    pub speeds: Vec<f64>,
    /// |cos| of the angle between the lever and the velocity of its end, ascending: zero if the lever keeps its length.
    pub lever: Vec<f64>,
}

impl Trials {
    /// The share of trials in which no point is faster.
    pub fn share_below(&self, speed: f64) -> f64 {
        self.speeds.partition_point(|v| *v <= speed) as f64 / self.solved.max(1) as f64
    }
}

/// Trials per unit of work.
const PORTION: usize = 1024;

/// One trial: velocities and positions of all unknown points, and their statistics.
#[derive(Clone, Debug, Default)]
struct TrialRow {
    values: Vec<f64>,
    same_sign: bool,
    speed: f64,
    lever: f64,
}

/// Why there are no trials.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoTrials {
    /// The system needs more parameters than are supported.
    #[error("the dyads are too strongly coupled for trials")]
    Coupled,
    /// The velocity of the given point does not determine the others in the pose.
    #[error(
        "in this pose the given velocity does not determine the others: the equations are singular"
    )]
    Singular,
}

/// Runs the trials.
///
/// # Errors
/// See [`NoTrials`].
pub fn run_trials(chain: &DyadChain, asked: &TrialOptions) -> Result<Trials, NoTrials> {
    let sweep = RowSweep::new(chain).ok_or(NoTrials::Coupled)?;
    let trial = TrialRun::new(chain, &sweep, asked).ok_or(NoTrials::Singular)?;
    let work = |scratch: &mut Scratch, portion: usize| {
        let first = portion * PORTION;
        let items = first..asked.count.min(first + PORTION);
        Some(
            items
                .filter_map(|item| trial.one_trial(item, scratch))
                .collect::<Vec<TrialRow>>(),
        )
    };
    let portions = asked.count.div_ceil(PORTION);
    let list = share_work(portions, asked.threads, Scratch::default, work);
    let rows: Vec<TrialRow> = list.into_iter().flat_map(|(_, rows)| rows).collect();
    Ok(collect_rows(&rows, chain.unknowns().len()))
}

fn collect_rows(rows: &[TrialRow], unknowns: usize) -> Trials {
    let ascending = |of: &dyn Fn(&TrialRow) -> f64| {
        let mut list: Vec<f64> = rows.iter().map(of).collect();
        list.sort_unstable_by(f64::total_cmp);
        list
    };
    let column = |k: usize| ascending(&|row: &TrialRow| row.values[k]);
    let pairs = |first: usize| {
        let pair = |k: usize| [column(first + 2 * k), column(first + 2 * k + 1)];
        (0..unknowns).map(pair).collect()
    };
    let same = rows.iter().filter(|row| row.same_sign).count();
    Trials {
        solved: rows.len(),
        same_sign: same as f64 / rows.len().max(1) as f64,
        velocities: pairs(0),
        positions: pairs(2 * unknowns),
        speeds: ascending(&|row| row.speed),
        lever: ascending(&|row| row.lever),
    }
}

#[derive(Clone, Debug, Default)]
struct Scratch {
    along: Vec<Projector>,
    across: Vec<Projector>,
    places: Vec<[[f64; crate::intervals::sweep::MOST_PARAMETERS + 1]; 2]>,
    velocities: SolvedRow,
    positions: SolvedRow,
}

/// What trials share.
struct TrialRun<'c> {
    chain: &'c DyadChain,
    sweep: &'c RowSweep,
    asked: &'c TrialOptions,
    unknowns: Vec<usize>,
    /// Velocities that are known.
    given: Vec<[f64; 2]>,
    /// Directions of both bars of every dyad.
    drawn: Vec<[f64; 2]>,
    sign: f64,
}

impl<'c> TrialRun<'c> {
    fn new(chain: &'c DyadChain, sweep: &'c RowSweep, asked: &'c TrialOptions) -> Option<Self> {
        let mut given = vec![[0.0; 2]; chain.points.len()];
        given[chain.given()] = asked.given;
        let dyads = chain.dyads.iter();
        let drawn: Vec<[f64; 2]> = dyads
            .map(|d| [chain.direction(d), chain.direction(d) + chain.angle(d)])
            .collect();
        let mut run = Self {
            chain,
            sweep,
            asked,
            unknowns: chain.unknowns(),
            given,
            drawn,
            sign: 1.0,
        };
        // The drawn pose itself is the first trial: it gives the sign with which determinants are compared.
        let mut scratch = Scratch::default();
        let own = run.drawn.clone();
        for pair in own {
            run.push_pair(pair, &mut scratch);
        }
        let solved = sweep.solve(
            &scratch.along,
            &run.given,
            &mut scratch.places,
            &mut scratch.velocities,
        );
        run.sign = scratch.velocities.determinant.signum();
        // Singular to rounding, it has no sign.
        solved.then_some(run)
    }

    /// The projectors of a dyad whose bars have these directions, for velocities and for positions.
    fn push_pair(&self, [first, second]: [f64; 2], scratch: &mut Scratch) {
        let ((s12, c12), (s13, c13)) = (sin_cos(first), sin_cos(second));
        let cross = s13 * c12 - c13 * s12;
        scratch.along.push(Projector {
            reads: [c12, s12],
            moves: [s13 / cross, -c13 / cross],
        });
        // Relative velocities are perpendicular to the bars.
        scratch.across.push(Projector {
            reads: [-s12, c12],
            moves: [c13 / cross, s13 / cross],
        });
    }

    fn one_trial(&self, item: usize, scratch: &mut Scratch) -> Option<TrialRow> {
        let mut random = Random::new(self.asked.seed, 0, item as u64);
        scratch.along.clear();
        scratch.across.clear();
        for drawn in &self.drawn {
            let pair = match self.asked.directions {
                Directions::Near(by) => drawn.map(|a| a + by * random.symmetric()),
                Directions::Turned(delta) => {
                    let first = TAU * random.unit();
                    [
                        first,
                        first + delta.lo + (delta.hi - delta.lo) * random.unit(),
                    ]
                }
            };
            self.push_pair(pair, scratch);
        }
        let Scratch {
            along,
            across,
            places,
            velocities,
            positions,
        } = scratch;
        // Velocities along the bars, conjugate positions across them: both from the same linear system.
        let solved = self.sweep.solve(along, &self.given, places, velocities)
            && self
                .sweep
                .solve(across, &self.chain.points, places, positions);
        let mut values: Vec<f64> = Vec::with_capacity(4 * self.unknowns.len());
        values.extend(
            self.unknowns
                .iter()
                .flat_map(|k| velocities.values.get(*k))
                .flatten(),
        );
        values.extend(
            self.unknowns
                .iter()
                .flat_map(|k| positions.values.get(*k))
                .flatten(),
        );
        if !solved || !values.iter().all(|v| v.is_finite()) {
            return None;
        }
        let speed = |k: &usize| libm::hypot(velocities.values[*k][0], velocities.values[*k][1]);
        let [end, pivot] = self.chain.lever;
        let bar = [0, 1].map(|i| positions.values[end][i] - positions.values[pivot][i]);
        let v = velocities.values[end];
        // The cosine between the bar at the given point and its velocity.
        let lever = (bar[0] * v[0] + bar[1] * v[1]).abs()
            / (libm::hypot(bar[0], bar[1]) * libm::hypot(v[0], v[1]));
        Some(TrialRow {
            values,
            same_sign: velocities.determinant * self.sign > 0.0,
            speed: self.unknowns.iter().map(speed).fold(0.0, f64::max),
            lever,
        })
    }
}
