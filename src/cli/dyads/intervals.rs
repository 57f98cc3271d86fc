//! `mechanim intervals`: the system of a row of dyads with intervals for the directions of its bars.

use super::row::{OpenRow, open_row};
use crate::analysis::dyads::{NoTrials, TrialOptions, run_trials};
use crate::analysis::random::Random;
use crate::charts::paving::paving_chart;
use crate::cli::args::dyads::{Derivation, IntervalsArgs};
use crate::cli::files::chart::{PlotFormat, write_chart};
use crate::cli::io;
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::intervals::centre::{tolerable_radius, tolerance_at, united_radius};
use crate::intervals::chain::Directions;
use crate::intervals::dyad::tied_cube;
use crate::intervals::formal::{Formal, formal_solution};
use crate::intervals::paving::{PavingWindow, pave_projection, pave_section};
use crate::intervals::regular::spectral_bound;
use crate::intervals::system::{SolutionSet, TernaryAnswer};
use crate::intervals::{IntervalSystem, Kaucher};
use crate::jobs::{core_count, share_work};
use crate::limits::allow_memory;
use crate::report::row_intervals::{
    FormalPair, PavedPoint, TiedReport, centre_document, centre_text, trials_document, trials_text,
};
use clap::ValueEnum;
use serde_json::Value;
use std::f64::consts::PI;

/// Default number of trials.
const TRIALS: usize = 100_000;

/// How often the squares of a paving are halved by default.
const HALVINGS: u32 = 6;

/// Default width of the right-hand sides as a fraction of the given velocity.
const SIDE: f64 = 0.05;

/// Default search range for points as a fraction of the mechanism's size.
const REACH: f64 = 0.1;

/// Number of positions of the other points that are tried for squares inside a projection.
const TRIES: usize = 200;

/// Two angles, in radians, that differ by the rounding of degrees only.
const SAME_ANGLE: f64 = 1e-12;

/// Damping of the subdifferential Newton method: none.
const TAU: f64 = 1.0;

/// What is derived: text, a JSON document, and whether it answers the question.
type Answered = (String, Value, Outcome);

/// Runs the verb.
pub fn run_intervals(args: &IntervalsArgs, term: &Term) -> Result<Outcome, Failure> {
    let reports = [
        ("--out", args.out.as_deref()),
        ("--plot", args.plot.as_deref()),
    ];
    io::refuse_clashes(&[&args.row.scene], &reports)?;
    refuse_unused(args)?;
    let format = args.plot.as_deref().map(PlotFormat::of).transpose()?;
    let row = open_row(&args.row, term)?;
    let (text, document, outcome) = match args.derive {
        Derivation::Trials => run_random(args, &row)?,
        Derivation::Formal => run_formal(args, &row)?,
        Derivation::Centre => run_centre(args, &row)?,
        Derivation::Tied => run_tied(args, &row, format)?,
    };
    if let Some(path) = &args.out {
        io::write_json(&args.row.scene, path, &document)?;
    }
    let text = format!("{}\n{text}", row.report().headline());
    io::print_beside(term, args.out.as_deref(), &text)?;
    Ok(outcome)
}

/// Refuses options that would have no effect.
fn refuse_unused(args: &IntervalsArgs) -> Result<(), Failure> {
    use Derivation::{Centre, Formal, Tied, Trials};
    let options: [(&str, bool, &[Derivation]); 8] = [
        ("--spread", args.spread.is_some(), &[Trials, Formal, Centre]),
        (
            "--velocity",
            args.velocity.is_some(),
            &[Trials, Formal, Centre],
        ),
        ("--side", args.side.is_some(), &[Formal, Centre]),
        ("--about-zero", args.about_zero, &[Centre]),
        ("--trials", args.trials.is_some(), &[Trials]),
        ("--reach", args.reach.is_some(), &[Tied]),
        ("--halvings", args.halvings.is_some(), &[Tied]),
        ("--plot", args.plot.is_some(), &[Tied]),
    ];
    let unused = options
        .iter()
        .find(|(_, given, used)| *given && !used.contains(&args.derive));
    let Some((option, _, used)) = unused else {
        return Ok(());
    };
    let words = used.iter().filter_map(Derivation::to_possible_value);
    let words: Vec<String> = words
        .map(|word| format!("--derive {}", word.get_name()))
        .collect();
    let message = format!("{option} has an effect with {} only", words.join(", "));
    Err(Failure::usage(message, Vec::new()))
}

/// Directions that the bars may have.
fn asked_directions(args: &IntervalsArgs, row: &OpenRow) -> Directions {
    match args.spread {
        Some(degrees) => Directions::Near(degrees.to_radians()),
        None => Directions::Turned(row.delta),
    }
}

/// Velocity of the given point.
fn given_velocity(args: &IntervalsArgs, row: &OpenRow) -> [f64; 2] {
    let chain = &row.row.chain;
    args.velocity.unwrap_or(chain.velocities[chain.given()])
}

fn speed_of([x, y]: [f64; 2]) -> f64 {
    libm::hypot(x, y)
}

fn run_random(args: &IntervalsArgs, row: &OpenRow) -> Result<Answered, Failure> {
    let chain = &row.row.chain;
    let numbers = 4 * chain.unknowns().len() + 4;
    let count = args.trials.unwrap_or(TRIALS);
    // Stored once per trial, and once sorted.
    let bytes = 2.0 * (count * numbers * std::mem::size_of::<f64>()) as f64;
    allow_memory(bytes, &format!("{count} trials"))?;
    let asked = TrialOptions {
        directions: asked_directions(args, row),
        given: given_velocity(args, row),
        count,
        seed: args.seed,
        threads: args.threads.unwrap_or_else(core_count),
    };
    let trials = run_trials(chain, &asked).map_err(|why| {
        let (message, hints) = (why.to_string(), vec!["see `mechanim dyads`".to_owned()]);
        match why {
            NoTrials::Coupled => Failure::usage(message, hints),
            NoTrials::Singular => Failure::Undecided { message, hints },
        }
    })?;
    let size = speed_of(asked.given);
    let outcome = match trials.solved > 0 {
        true => Outcome::Done,
        false => Outcome::CheckFailed,
    };
    Ok((
        trials_text(&row.row, &trials, count, size),
        trials_document(&row.row, &trials, size),
        outcome,
    ))
}

/// The system with intervals for its coefficients.
fn asked_system(args: &IntervalsArgs, row: &OpenRow) -> Result<(IntervalSystem, f64), Failure> {
    let given = given_velocity(args, row);
    let side = args.side.unwrap_or(SIDE * speed_of(given));
    let system = row
        .row
        .chain
        .interval_system(asked_directions(args, row), given, side);
    let system = system.ok_or_else(|| {
        Failure::usage(
            "the bars of a dyad can be in line within these directions: its coefficients have no bounds",
            vec!["choose narrower ones with --delta or --spread".to_owned()],
        )
    })?;
    Ok((system, side))
}

fn run_formal(args: &IntervalsArgs, row: &OpenRow) -> Result<Answered, Failure> {
    let (system, _) = asked_system(args, row)?;
    let judged = |kind: &SolutionSet| {
        let formal = formal_solution(&system.inclusion(kind), TAU);
        let is_inside = match &formal {
            Formal::Solved { x, improper, .. } if improper.is_empty() => {
                system.holds_box(x, kind) == TernaryAnswer::Yes
            }
            _ => false,
        };
        (formal, is_inside)
    };
    let tolerable = judged(&SolutionSet::Tolerable);
    let united = judged(&SolutionSet::United);
    let pair = FormalPair {
        tolerable: (&tolerable.0, tolerable.1),
        united: (&united.0, united.1),
        spectral: spectral_bound(&system),
    };
    let outcome = match pair.proves() {
        true => Outcome::Done,
        false => Outcome::CheckFailed,
    };
    Ok((pair.text(&row.row), pair.document(), outcome))
}

fn run_centre(args: &IntervalsArgs, row: &OpenRow) -> Result<Answered, Failure> {
    let (system, side) = asked_system(args, row)?;
    let chain = &row.row.chain;
    let velocities = chain
        .unknowns()
        .into_iter()
        .flat_map(|k| chain.velocities[k]);
    let share = if args.about_zero { 0.0 } else { 1.0 };
    let centre: Vec<f64> = velocities.map(|v| share * v).collect();
    let (tolerance, radius) = (
        tolerance_at(&system, &centre),
        tolerable_radius(&system, &centre),
    );
    // The functional is evaluated in floating point; the cube is tested with outward rounding before it is claimed.
    let radius = proved_radius(&system, &centre, radius);
    let united = united_radius(&system, &centre);
    let outcome = match radius > 0.0 {
        true => Outcome::Done,
        false => Outcome::CheckFailed,
    };
    let half_widths = system.b.iter().map(|b| 0.5 * (b.hi - b.lo).abs());
    let sides = [side, half_widths.fold(side, f64::max)];
    Ok((
        centre_text(tolerance, radius, united, sides),
        centre_document(&centre, tolerance, (radius, united), sides),
        outcome,
    ))
}

/// The largest of several slightly reduced radii whose cube is proved to be tolerable; not positive if none is.
fn proved_radius(system: &IntervalSystem, centre: &[f64], radius: f64) -> f64 {
    /// Reductions that allow for rounding.
    const SHARES: [f64; 4] = [1e-14, 1e-12, 1e-9, 1e-6];
    if radius <= 0.0 {
        return radius;
    }
    let fits = |r: &f64| {
        let cube = centre.iter().map(|c| Kaucher::new(c - r, c + r));
        let cube: Vec<Kaucher> = cube.collect();
        system.holds_box(&cube, &SolutionSet::Tolerable) == TernaryAnswer::Yes
    };
    let smaller = SHARES.map(|share| radius * (1.0 - share));
    smaller.into_iter().find(fits).unwrap_or(0.0)
}

fn run_tied(
    args: &IntervalsArgs,
    row: &OpenRow,
    format: Option<PlotFormat>,
) -> Result<Answered, Failure> {
    let (chain, mechanism) = (&row.row.chain, &row.open.scene.mechanism);
    // These are undirected lines: an angle and its supplement are equivalent.
    let [least, beyond] = [row.delta.lo, PI - row.delta.hi];
    let is_symmetric = (least - beyond).abs() <= SAME_ANGLE;
    if !(least > 0.0 && least < 0.5 * PI && is_symmetric) {
        return Err(Failure::usage(
            "--derive tied takes --delta from an angle to its supplement, such as 5..175",
            Vec::new(),
        ));
    }
    let window = PavingWindow {
        least,
        reach: args.reach.unwrap_or(REACH * mechanism.size),
        halvings: args.halvings.unwrap_or(HALVINGS),
    };
    let still = [chain.fixed.clone(), vec![chain.given()]].concat();
    let moving: Vec<usize> = (0..chain.points.len())
        .filter(|k| !chain.fixed.contains(k))
        .collect();
    let work = |_: &mut (), index: usize| {
        let point = moving[index];
        let mut random = Random::new(args.seed, 0, point as u64);
        Some(PavedPoint {
            point,
            section: pave_section(chain, point, window),
            projection: pave_projection(chain, point, window, TRIES, || random.symmetric()),
        })
    };
    let threads = args.threads.unwrap_or_else(core_count);
    let paved = share_work(moving.len(), threads, || (), work);
    let report = TiedReport {
        row: &row.row,
        window,
        velocities: tied_cube(&chain.velocities, &still, &chain.dyads, least),
        positions: tied_cube(&chain.points, &chain.fixed, &chain.dyads, least),
        paved: paved.into_iter().map(|(_, p)| p).collect(),
        unit: mechanism.length_unit.clone(),
    };
    if let (Some(path), Some(format)) = (&args.plot, format) {
        let chart = paving_chart(&row.row, &mechanism.title, &report.unit, &report.paved);
        let mut output = io::open_output(path)?;
        let written = write_chart(&chart, format, None, args.theme, output.as_mut());
        io::unless_reader_left(written.and_then(|()| Ok(output.commit()?)))?;
    }
    let outcome = match report.positions > 0.0 {
        true => Outcome::Done,
        false => Outcome::CheckFailed,
    };
    Ok((report.text(), report.document(), outcome))
}
