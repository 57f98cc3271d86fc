//! `mechanim dyads`: decomposes a planar linkage into dyads.

use crate::analysis::dyads::{PlanarRow, planar_row};
use crate::cli::args::dyads::{DyadsArgs, RowArgs};
use crate::cli::io;
use crate::cli::open::scene::{OpenScene, open_scene};
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::diag::list_names;
use crate::intervals::Kaucher;
use crate::kinematics::motion::continuation::solve_motion;
use crate::report::dyads::DyadReport;
use crate::report::sentences::input_sentence;
use std::path::Path;

/// A scene whose row of dyads is known.
pub struct OpenRow {
    /// The scene with its mechanism.
    pub open: OpenScene,
    /// The row at the requested pose.
    pub row: PlanarRow,
    /// Description of that pose.
    pub place: String,
    /// `--delta` in radians.
    pub delta: Kaucher,
}

impl OpenRow {
    /// The requested parts of the report.
    pub fn report(&self) -> DyadReport<'_> {
        DyadReport {
            mechanism: &self.open.scene.mechanism,
            row: &self.row,
            place: self.place.clone(),
            delta: self.delta,
        }
    }
}

/// Runs the verb.
pub fn run_dyads(args: &DyadsArgs, term: &Term) -> Result<Outcome, Failure> {
    if let Some(path) = &args.out {
        io::refuse_input(&args.row.scene, path)?;
        refuse_kind(path)?;
    }
    let row = open_row(&args.row, term)?;
    let report = row.report();
    if let Some(path) = &args.out {
        let scene = &args.row.scene;
        match file_extension(path).as_str() {
            "csv" => io::write_text(scene, path, &report.csv())?,
            "md" => io::write_text(scene, path, &report.markdown_table())?,
            "tex" => io::write_text(scene, path, &report.latex())?,
            _ => io::write_json(scene, path, &report.document())?,
        }
    }
    io::print_beside(term, args.out.as_deref(), &report.text())?;
    Ok(match report.is_determined() {
        true => Outcome::Done,
        false => Outcome::CheckFailed,
    })
}

fn file_extension(path: &Path) -> String {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    extension.unwrap_or_default()
}

fn refuse_kind(path: &Path) -> Result<(), Failure> {
    let is_known = path == Path::new("-")
        || ["csv", "md", "tex", "json"].contains(&file_extension(path).as_str());
    match is_known {
        true => Ok(()),
        false => {
            let known = "known kinds: .csv, .md, .tex and .json";
            Err(Failure::unknown_kind(path, "table", known))
        }
    }
}

/// Reads the scene, solves for its pose and decomposes it.
pub fn open_row(args: &RowArgs, term: &Term) -> Result<OpenRow, Failure> {
    let open = open_scene(&args.scene, term)?;
    let (mechanism, actuation) = (&open.scene.mechanism, &open.scene.actuation);
    let last = actuation.duration;
    if !(0.0..=last).contains(&args.at) {
        let message = format!("--at {}: the motion lasts from 0 to {last} s", args.at);
        return Err(Failure::usage(message, Vec::new()));
    }
    let moving = moving_input(args, &open)?;
    let times: &[f64] = if args.at > 0.0 {
        &[0.0, args.at]
    } else {
        &[0.0]
    };
    let motion = solve_motion(&open.system, actuation, times);
    let is_undecided = motion.is_undecided();
    let sample = motion
        .samples
        .last()
        .and_then(|s| Some((s, s.pose.as_ref()?)));
    let Some((sample, pose)) = sample else {
        let hints = vec!["`mechanim check` shows where the motion ends".to_owned()];
        let message = format!("there is no pose at t = {} s", args.at);
        return Err(Failure::without_pose(is_undecided, message, hints));
    };
    let coordinates = [pose.unknowns.as_slice(), &sample.inputs].concat();
    let row = planar_row(&open.system, &coordinates, moving.unwrap_or(0))
        .map_err(|error| Failure::usage(error.to_string(), Vec::new()))?;
    let moving = moving.ok_or_else(|| {
        let hint = list_names(mechanism.inputs.iter().map(|i| i.name.as_str()));
        let message = "the scene has several inputs: name one with --per";
        Failure::usage(message, vec![hint])
    })?;
    let place = format!(
        "at t = {} s ({}); velocities for {} at unit rate",
        args.at,
        input_sentence(mechanism, &sample.inputs),
        mechanism.inputs[moving].name
    );
    let delta = args.delta.map(f64::to_radians);
    Ok(OpenRow {
        place,
        row,
        delta: Kaucher::new(delta[0], delta[1]),
        open,
    })
}

/// The input to which the velocities refer; `None` if there are several and none is named.
fn moving_input(args: &RowArgs, open: &OpenScene) -> Result<Option<usize>, Failure> {
    let inputs = &open.scene.mechanism.inputs;
    let names: Vec<&str> = inputs.iter().map(|i| i.name.as_str()).collect();
    match &args.per {
        Some(name) => names
            .iter()
            .position(|n| n == name)
            .map(Some)
            .ok_or_else(|| Failure::unknown_name("input", name, names.iter().copied())),
        None if inputs.len() == 1 => Ok(Some(0)),
        None if inputs.is_empty() => Err(Failure::usage(
            "nothing moves: the scene has no input",
            Vec::new(),
        )),
        None => Ok(None),
    }
}
