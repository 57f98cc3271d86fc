//! `mechanim modes`: the assemblies at one pose of the inputs as a numbered table; and `--mode`, which starts from one.

use crate::cli::args::motion::ModesArgs;
use crate::cli::args::scene::ModeChoice;
use crate::cli::interrupt::CANCEL;
use crate::cli::io;
use crate::cli::open::scene as open_scene;
use crate::cli::open::scene::OpenScene;
use crate::cli::report::events as report;
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::kinematics::solve::assembly_modes::{DEFAULT_STARTS, Mode, Modes, find_modes};
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::mechanism::{Coordinate, Kind, Mechanism};
use serde_json::{Map, Value, json};
use std::sync::atomic::Ordering;

/// Runs the verb.
pub fn run(args: &ModesArgs, term: &Term) -> Result<Outcome, Failure> {
    if args.scene.mode.is_some() {
        return Err(Failure::usage(
            "`modes` lists all assemblies; --mode chooses one in render, solve and check",
            Vec::new(),
        ));
    }
    let OpenScene { scene, system } = open_scene::open(&args.scene, term)?;
    let (mechanism, actuation) = (&scene.mechanism, &scene.actuation);
    if !(0.0..=actuation.duration).contains(&args.at) {
        return Err(Failure::usage(
            format!(
                "the motion lasts from 0 to {} s, {} is outside",
                actuation.duration, args.at
            ),
            Vec::new(),
        ));
    }
    let modes = search(&system, actuation, args.at, args.starts)?;
    let inputs = &actuation.inputs_at(args.at);
    if let Some(path) = &args.json {
        io::write_json(
            &args.scene,
            path,
            &document(mechanism, inputs, args.at, &modes),
        )?;
    }
    io::print_beside(
        args.json.as_deref(),
        &text(mechanism, inputs, args.at, &modes),
    )?;
    Ok(if modes.list.is_empty() {
        Outcome::NotClosed
    } else {
        Outcome::Done
    })
}

/// Share of the drive after which the branches are listed that meet at its start.
const BESIDE_START: f64 = 1e-3;

/// Unknowns of a mode at the start of the drive: start values that lead to it.
pub fn start_of(
    system: &System,
    actuation: &Actuation,
    choice: &ModeChoice,
) -> Result<Vec<f64>, Failure> {
    let modes = search(system, actuation, 0.0, DEFAULT_STARTS)?;
    let mut coordinates = match choice {
        ModeChoice::Number(number) => numbered(&modes, *number)?,
        ModeChoice::Signature(signature) => signed(system, actuation, &modes, signature)?,
    };
    coordinates.truncate(system.mechanism().unknowns.len());
    Ok(coordinates)
}

fn numbered(modes: &Modes, number: usize) -> Result<Vec<f64>, Failure> {
    let mode = number.checked_sub(1).and_then(|k| modes.list.get(k));
    mode.map(|mode| mode.coordinates.clone()).ok_or_else(|| {
        Failure::usage(
            format!(
                "there is no mode {number}: {} found at the start of the drive",
                count(modes)
            ),
            vec!["`mechanim modes` lists them".to_owned()],
        )
    })
}

/// The only mode with that signature. Where branches meet at the start, that of the branch right after it.
fn signed(
    system: &System,
    actuation: &Actuation,
    modes: &Modes,
    signature: &str,
) -> Result<Vec<f64>, Failure> {
    if let Some(mode) = only(modes, signature)? {
        return Ok(mode.coordinates.clone());
    }
    if modes.list.iter().any(|mode| mode.is_singular) {
        let beside = search(
            system,
            actuation,
            BESIDE_START * actuation.duration,
            DEFAULT_STARTS,
        )?;
        if let Some(mode) = only(&beside, signature)? {
            return Ok(mode.coordinates.clone());
        }
    }
    let mut known: Vec<&str> = modes.list.iter().map(|m| m.branch.as_str()).collect();
    known.dedup();
    Err(Failure::usage(
        format!("no mode with signature `{signature}` was found at the start of the drive"),
        vec![format!("found were: {}", known.join(", "))],
    ))
}

/// The mode with a signature, if there is one; an error if there are several.
fn only<'m>(modes: &'m Modes, signature: &str) -> Result<Option<&'m Mode>, Failure> {
    let has_it = |mode: &Mode| mode.branch == signature && !mode.is_singular;
    let numbered = modes.list.iter().enumerate();
    let fitting: Vec<usize> = numbered
        .filter(|(_, m)| has_it(m))
        .map(|(k, _)| k)
        .collect();
    match fitting[..] {
        [] => Ok(None),
        [one] => Ok(Some(&modes.list[one])),
        _ => {
            let numbers: Vec<String> = fitting.iter().map(|k| (k + 1).to_string()).collect();
            Err(Failure::usage(
                format!("several modes have the signature `{signature}`"),
                vec![format!("choose one by its number: {}", numbers.join(", "))],
            ))
        }
    }
}

fn search(
    system: &System,
    actuation: &Actuation,
    time: f64,
    starts: usize,
) -> Result<Modes, Failure> {
    let first = actuation.start_at(time);
    let (_, inputs) = first.split_at(actuation.guess.len());
    if let Some(k) = inputs.iter().position(|v| !v.is_finite()) {
        let name = &system.mechanism().inputs[k].name;
        return Err(Failure::usage(
            format!("input `{name}` has no value at t = {time} s"),
            Vec::new(),
        ));
    }
    let cancelled = || CANCEL.load(Ordering::Relaxed);
    let modes = find_modes(system, &first, starts, &cancelled);
    crate::cli::interrupt::refuse_interrupted()?;
    Ok(modes)
}

fn count(modes: &Modes) -> String {
    match modes.list.len() {
        1 => "1 assembly".to_owned(),
        n => format!("{n} assemblies"),
    }
}

/// The table, and what it is worth.
fn text(mechanism: &Mechanism, inputs: &[f64], time: f64, modes: &Modes) -> String {
    let inputs = report::inputs(mechanism, inputs);
    let mut text = format!(
        "{}\n{} found at t = {time} s ({inputs})\n",
        mechanism.title,
        count(modes)
    );
    if !modes.list.is_empty() {
        text.push_str(&table(mechanism, modes));
    }
    text.push_str(&format!(
        "\nThis is a count, not a proof: {} of {} starts closed",
        modes.closed, modes.starts
    ));
    if let Some(rarest) = modes.list.iter().map(|m| m.met).min() {
        text.push_str(&format!(
            ", the rarest assembly was met by {rarest}; more --starts may find more"
        ));
    }
    text.push_str(".\n");
    if modes.list.iter().any(|m| m.is_scene) {
        text.push_str("* is where the scene's start values lead.\n");
    }
    let singular = modes.list.iter().filter(|m| m.is_singular);
    let singular = singular.count();
    if singular > 0 {
        text.push_str(&format!(
            "{singular} of them are singular: assemblies meet there, or they are points of a continuous set.\n"
        ));
    }
    text
}

/// Rows of aligned cells: number, signature, singular value, hits, coordinates with their units.
fn table(mechanism: &Mechanism, modes: &Modes) -> String {
    let mut rows = vec![vec![
        "mode".to_owned(),
        "branch".to_owned(),
        "sigma_min".to_owned(),
        "met".to_owned(),
    ]];
    rows[0].extend(mechanism.unknowns.iter().map(|c| heading(mechanism, c)));
    for (k, mode) in modes.list.iter().enumerate() {
        let mark = if mode.is_scene { "* " } else { "" };
        let mut row = vec![
            format!("{mark}{}", k + 1),
            mode.branch.clone(),
            format!("{:.3e}", mode.sigma_min),
            mode.met.to_string(),
        ];
        row.extend(in_file(mechanism, mode).map(|(_, v)| format!("{v:.6}")));
        rows.push(row);
    }
    let widths: Vec<usize> = (0..rows[0].len())
        .map(|j| rows.iter().map(|r| r[j].chars().count()).max().unwrap_or(0))
        .collect();
    let mut text = String::new();
    for row in rows {
        let cells = row.iter().zip(&widths).map(|(c, w)| format!("{c:>w$}"));
        text.push_str(&format!("  {}\n", cells.collect::<Vec<_>>().join("  ")));
    }
    text
}

fn heading(mechanism: &Mechanism, unknown: &Coordinate) -> String {
    match unknown.kind {
        Kind::Angle => format!("{}/{}", unknown.name, mechanism.angle_unit.name),
        Kind::Length => format!("{}/{}", unknown.name, mechanism.length_unit),
        Kind::Number => unknown.name.clone(),
    }
}

/// Names of the unknowns and their values in the scene's units.
fn in_file<'a>(
    mechanism: &'a Mechanism,
    mode: &'a Mode,
) -> impl Iterator<Item = (&'a str, f64)> + 'a {
    let pairs = mechanism.unknowns.iter().zip(&mode.coordinates);
    pairs.map(|(c, v)| (c.name.as_str(), v * mechanism.file_units(c.kind)))
}

fn document(mechanism: &Mechanism, inputs: &[f64], time: f64, modes: &Modes) -> Value {
    let inputs: Map<String, Value> = mechanism
        .inputs
        .iter()
        .zip(inputs)
        .map(|(c, v)| (c.name.clone(), json!(v * mechanism.file_units(c.kind))))
        .collect();
    let list: Vec<Value> = modes
        .list
        .iter()
        .enumerate()
        .map(|(k, mode)| {
            let unknowns: Map<String, Value> = in_file(mechanism, mode)
                .map(|(name, v)| (name.to_owned(), json!(v)))
                .collect();
            json!({
                "mode": k + 1,
                "branch": mode.branch,
                "sigma_min": mode.sigma_min,
                "singular": mode.is_singular,
                "closure_error": mode.closure_error,
                "met": mode.met,
                "scene": mode.is_scene,
                "unknowns": unknowns,
            })
        })
        .collect();
    json!({
        "schema": "mechanim-modes/1",
        "title": mechanism.title,
        "units": { "length": mechanism.length_unit, "angle": mechanism.angle_unit.name, "time": "s" },
        "time": time,
        "inputs": inputs,
        "starts": modes.starts,
        "closed": modes.closed,
        "proof": false,
        "modes": list,
    })
}
