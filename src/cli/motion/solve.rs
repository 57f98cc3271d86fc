//! `mechanim solve`: the motion as a table.

use super::{certify, event_messages};
use crate::cli::args::motion::{CertifyArg, SolveArgs, TableFormat};
use crate::cli::interrupt::refuse_interrupted;
use crate::cli::io;
use crate::cli::open::scene::OpenScene;
use crate::cli::open::{inputs_table, scene as open_scene};
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::diag::shown_number;
use crate::export::Output;
use crate::kinematics::motion::limits::add_limits;
use crate::kinematics::motion::sampling::{even_times, frame_times};
use crate::kinematics::rates::columns::{RateColumns, RateVariable, add_derivatives};
use crate::kinematics::solve::iterates::record_iterates;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::mechanism::{Kind, Mechanism};
use crate::report::proof::{MotionProof, PoseProofs, table_status};
use crate::report::table::{TableColumns, empty_rates, write_csv, write_json};
use crate::report::{freedoms, iterates as iterate_table};
use crate::scene::Scene;
use std::path::Path;

/// Runs the verb.
pub fn run_solve(args: &SolveArgs, term: &Term) -> Result<Outcome, Failure> {
    let format = table_format(args)?;
    io::refuse_input(&args.scene, &args.out)?;
    if args.at.is_some() && args.certify == CertifyArg::Motion {
        let hints = vec!["leave out --at: the table has the times in its first column".to_owned()];
        return Err(Failure::usage(
            "a single instant has no motion to certify",
            hints,
        ));
    }
    let OpenScene { scene, system, .. } = open_scene::open_scene(&args.scene, term)?;
    let actuation = &scene.actuation;
    let derivatives = rate_columns(args, &scene.mechanism)?;
    let times = row_times(args, &scene)?;
    let mut output = io::open_output(&args.out)?;
    if args.trace_iterations {
        return trace_iterations(&system, actuation, format, output, term);
    }
    let mut trajectory = certify::certify_motion(&system, actuation, &times, args.certify)?;
    refuse_interrupted()?;
    event_messages::note_moved_start(&system, actuation, &mut trajectory)?;
    if args.events {
        add_limits(&system, actuation, &mut trajectory);
    }
    if args.at.is_some() {
        trajectory.samples.drain(..trajectory.samples.len() - 1);
    }
    let told = event_messages::tell_events(&system, actuation, &trajectory, term)?;
    let proves_motion = args.certify == CertifyArg::Motion;
    let proof = proves_motion.then(|| MotionProof::of(&trajectory));
    if let Some(proof) = proof.as_ref().filter(|p| !p.is_whole()) {
        term.warning(&format!(
            "motion: {}",
            proof.sentence(&scene.mechanism, actuation)
        ));
    }
    let asked = args.certify != CertifyArg::None;
    let poses = PoseProofs::of(&system, &trajectory, asked);
    if poses.open > 0 {
        term.warning(&format!(
            "{} of {} samples are open: redundant equations do not hold, by more than rounding and the digits of the dimensions explain",
            poses.open,
            trajectory.samples.len()
        ));
    }
    let outcome = told.worse(table_status(&poses, proof.as_ref()).into());
    for held in &system.structure().held {
        let idle = freedoms::idle_sentence(&scene.mechanism, held);
        term.note(&format!("idle: {idle} at its start value"));
    }
    if let Some(wanted) = derivatives {
        tell_unit(wanted, &scene.mechanism, term);
        for sentence in empty_rates(&scene.mechanism, wanted.order) {
            term.warning(&sentence);
        }
        add_derivatives(&system, actuation, &mut trajectory, wanted);
    }
    let columns = TableColumns {
        rates: args.rates,
        derivatives,
        motion: proves_motion,
        redundant: system.redundant_rows() > 0,
        bounds: args.bounds,
    };
    let written = match format {
        TableFormat::Csv => write_csv(&scene.mechanism, &trajectory, columns, output.as_mut()),
        TableFormat::Json => write_json(&scene.mechanism, &trajectory, columns, output.as_mut()),
    };
    let written = written.and_then(|()| output.commit());
    io::unless_reader_left(written.map_err(Failure::from))?;
    Ok(outcome)
}

/// Explains that rates by an angle in degrees are per degree: the column names contain quantities, not units.
fn tell_unit(columns: RateColumns, mechanism: &Mechanism, term: &Term) {
    let RateVariable::Input(index) = columns.by else {
        return;
    };
    let input = &mechanism.inputs[index];
    let unit = mechanism.unit_name(input.kind);
    if input.kind == Kind::Angle && mechanism.file_units(input.kind) != 1.0 {
        let name = &input.name;
        term.note(&format!(
            "rates of order n by `{name}` are per {unit}^n, like all angles of this scene"
        ));
    }
}

/// Newton's iterates from the start values, as a table.
fn trace_iterations(
    system: &System,
    actuation: &Actuation,
    format: TableFormat,
    mut output: Box<dyn Output>,
    term: &Term,
) -> Result<Outcome, Failure> {
    let mechanism = system.mechanism();
    let (list, closed) = record_iterates(system, &actuation.start_at(0.0));
    match format {
        TableFormat::Csv => iterate_table::write_csv(mechanism, &list, output.as_mut())?,
        TableFormat::Json => iterate_table::write_json(mechanism, &list, closed, output.as_mut())?,
    }
    output.commit()?;
    if closed {
        return Ok(Outcome::Done);
    }
    term.warning("plain Newton does not close from these start values; the solver, which damps its steps, may");
    Ok(Outcome::Undecided)
}

fn row_times(args: &SolveArgs, scene: &Scene) -> Result<Vec<f64>, Failure> {
    let (mechanism, actuation) = (&scene.mechanism, &scene.actuation);
    if let Some(at) = args.at {
        let frames = frame_times(mechanism, actuation, scene.view.fps);
        return up_to(at, actuation.duration, &frames);
    }
    Ok(match args.samples {
        Some(count) => even_times(mechanism, actuation, count),
        None if args.scene.table.is_some() => inputs_table::row_times(actuation),
        None if actuation.drives.iter().all(|d| d.is_constant()) => vec![0.0],
        None => frame_times(mechanism, actuation, scene.view.fps),
    })
}

/// The frames before `at`, then `at` itself: the branch at `at` is the one that the motion reaches.
pub fn up_to(at: f64, duration: f64, frames: &[f64]) -> Result<Vec<f64>, Failure> {
    if !(0.0..=duration).contains(&at) {
        return Err(Failure::usage(
            format!(
                "the motion lasts from 0 to {duration} s, {} is outside",
                shown_number(at)
            ),
            Vec::new(),
        ));
    }
    let mut times: Vec<f64> = frames.iter().copied().filter(|t| *t < at).collect();
    times.push(at);
    Ok(times)
}

/// The rates requested with `--order` and `--per`.
fn rate_columns(args: &SolveArgs, mechanism: &Mechanism) -> Result<Option<RateColumns>, Failure> {
    let Some(order) = args.order else {
        return Ok(None);
    };
    let Some(name) = &args.per else {
        let by = RateVariable::Time;
        return Ok(Some(RateColumns { order, by }));
    };
    let inputs = mechanism.inputs.iter();
    let Some(index) = inputs.clone().position(|input| input.name == *name) else {
        let names = inputs.map(|input| input.name.as_str());
        return Err(Failure::unknown_name("input", name, names));
    };
    let by = RateVariable::Input(index);
    Ok(Some(RateColumns { order, by }))
}

fn table_format(args: &SolveArgs) -> Result<TableFormat, Failure> {
    if let Some(format) = args.format {
        return Ok(format);
    }
    let extension = args
        .out
        .extension()
        .map(|e| e.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some("csv") => Ok(TableFormat::Csv),
        Some("json") => Ok(TableFormat::Json),
        None if args.out == Path::new("-") => Ok(TableFormat::Csv),
        _ => {
            let known = "known kinds: .csv and .json; or use --format csv";
            Err(Failure::unknown_kind(&args.out, "table", known))
        }
    }
}
