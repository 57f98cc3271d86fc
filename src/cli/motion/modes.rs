//! `mechanim modes`: the assemblies at one pose of the inputs as a numbered table.

use crate::cli::args::motion::ModesArgs;
use crate::cli::io;
use crate::cli::open::mode::{count, search};
use crate::cli::open::scene as open_scene;
use crate::cli::open::scene::OpenScene;
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::kinematics::solve::assembly_modes::{Mode, Modes};
use crate::model::mechanism::{Coordinate, Mechanism};
use crate::report::sentences;
use serde_json::{Map, Value, json};

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
        term,
        args.json.as_deref(),
        &text(mechanism, inputs, args.at, &modes),
    )?;
    Ok(if modes.list.is_empty() {
        Outcome::NotClosed
    } else {
        Outcome::Done
    })
}

/// The table, and what it is worth.
fn text(mechanism: &Mechanism, inputs: &[f64], time: f64, modes: &Modes) -> String {
    let inputs = sentences::inputs(mechanism, inputs);
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
    match mechanism.unit_name(unknown.kind) {
        "" => unknown.name.clone(),
        unit => format!("{}/{unit}", unknown.name),
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
