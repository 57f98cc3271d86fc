//! `mechanim modes`: the assemblies at one pose of the inputs as a numbered table.

use crate::cli::args::motion::ModesArgs;
use crate::cli::io;
use crate::cli::open::mode::search_modes;
use crate::cli::open::scene as open_scene;
use crate::cli::open::scene::OpenScene;
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::diag::shown_number;
use crate::kinematics::assemblies::{Mode, Modes};
use crate::kinematics::certificate::absence::has_no_pose;
use crate::kinematics::structure::system::System;
use crate::model::mechanism::{Coordinate, Kind, Mechanism};
use crate::numbers::decimal::fixed;
use crate::report::lengths::LengthForm;
use crate::report::{assemblies, sentences};
use serde_json::{Map, Value, json};

/// Decimals of the coordinates in the table.
const DECIMALS: usize = 6;

/// Runs the verb.
pub fn run_modes(args: &ModesArgs, term: &Term) -> Result<Outcome, Failure> {
    if args.scene.mode.is_some() {
        return Err(Failure::usage(
            "`modes` lists all assemblies; --mode chooses one in the other verbs",
            Vec::new(),
        ));
    }
    let OpenScene { scene, system, .. } = open_scene::open_scene(&args.scene, term)?;
    let actuation = &scene.actuation;
    if !(0.0..=actuation.duration).contains(&args.at) {
        return Err(Failure::usage(
            format!(
                "the motion lasts from 0 to {} s, {} is outside",
                actuation.duration,
                shown_number(args.at)
            ),
            Vec::new(),
        ));
    }
    let modes = search_modes(&system, actuation, args.at, args.starts)?;
    let inputs = &actuation.inputs_at(args.at);
    if let Some(path) = &args.json {
        io::write_json(
            &args.scene,
            path,
            &modes_document(&system, inputs, args.at, &modes),
        )?;
    }
    let is_refuted = modes.list.is_empty() && has_no_pose(&system, inputs);
    io::print_beside(
        term,
        args.json.as_deref(),
        &modes_text(&system, (inputs, args.at), &modes, is_refuted),
    )?;
    if !modes.list.is_empty() {
        return Ok(Outcome::Done);
    }
    if is_refuted {
        term.note("no pose exists (proved)");
        return Ok(Outcome::NotClosed);
    }
    term.note("it is not proved that no pose exists");
    Ok(Outcome::Undecided)
}

/// The table, and what it is worth, unless it is proved that there is nothing to find.
fn modes_text(
    system: &System,
    (inputs, time): (&[f64], f64),
    modes: &Modes,
    is_refuted: bool,
) -> String {
    let mechanism = system.mechanism();
    let inputs = sentences::input_sentence(mechanism, inputs);
    let mut text = format!(
        "{}\n{} found at t = {time} s ({inputs})\n",
        mechanism.title,
        assemblies::modes_headline(mechanism, modes)
    );
    if !modes.list.is_empty() {
        text.push_str(&modes_table(mechanism, modes));
    }
    text.push('\n');
    if is_refuted {
        return text;
    }
    for line in assemblies::mode_remarks(system, modes) {
        text.push_str(&line);
        text.push('\n');
    }
    text
}

/// Rows of aligned cells: number, that of the placement where they differ, signature, singular value, hits, coordinates
/// with their units.
fn modes_table(mechanism: &Mechanism, modes: &Modes) -> String {
    let has_names = modes.list.len() > modes.placements();
    let mut headings = vec!["mode", "placement", "branch", "sigma_min", "met"];
    headings.retain(|heading| has_names || *heading != "placement");
    let mut rows = vec![headings.into_iter().map(str::to_owned).collect::<Vec<_>>()];
    rows[0].extend(
        mechanism
            .unknowns
            .iter()
            .map(|c| unknown_heading(mechanism, c)),
    );
    let forms = length_forms(mechanism, modes);
    for (k, mode) in modes.list.iter().enumerate() {
        let mark = if mode.is_scene { "* " } else { "" };
        let set = if mode.dimension > 0 { "~ " } else { "" };
        let mut row = vec![format!("{mark}{set}{}", k + 1)];
        if has_names {
            row.push(mode.placement.to_string());
        }
        row.extend([
            mode.branch.clone(),
            format!("{:.3e}", mode.sigma_min),
            mode.met.to_string(),
        ]);
        let values = in_file(mechanism, mode).map(|(_, v)| v);
        row.extend(values.zip(&forms).map(|(v, form)| match form {
            Some(form) => form.length(v),
            None => fixed(v, DECIMALS),
        }));
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

/// The form of each unknown that is a length, from its values in all modes.
fn length_forms(mechanism: &Mechanism, modes: &Modes) -> Vec<Option<LengthForm>> {
    let unknowns = mechanism.unknowns.iter().enumerate();
    let form = |(index, unknown): (usize, &Coordinate)| {
        let values = modes.list.iter().map(|mode| mode.coordinates[index]);
        let values: Vec<f64> = values.collect();
        (unknown.kind == Kind::Length).then(|| LengthForm::of(&values, mechanism.size, DECIMALS))
    };
    unknowns.map(form).collect()
}

fn unknown_heading(mechanism: &Mechanism, unknown: &Coordinate) -> String {
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

fn modes_document(system: &System, inputs: &[f64], time: f64, modes: &Modes) -> Value {
    let mechanism = system.mechanism();
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
                "placement": mode.placement,
                "branch": mode.branch,
                "sigma_min": mode.sigma_min,
                "singular": mode.is_singular,
                "closure_error": mode.closure_error,
                "dimension": mode.dimension,
                "met": mode.met,
                "names": mode.names(),
                "scene": mode.is_scene,
                "unknowns": unknowns,
            })
        })
        .collect();
    let bodies: Vec<&str> = modes
        .bodies
        .iter()
        .map(|body| mechanism.bodies[*body].name.as_str())
        .collect();
    let kinds: Map<String, Value> = modes
        .tallies
        .iter()
        .map(|(kind, tally)| {
            let tally = json!({ "starts": tally.starts, "closed": tally.closed, "new": tally.new });
            (assemblies::kind_words(*kind).replace("of the ", ""), tally)
        })
        .collect();
    // What no link bounds is looked for up to these distances from zero.
    let reaches: Map<String, Value> = modes
        .reaches
        .iter()
        .map(|(slot, reach)| {
            let unknown = &mechanism.unknowns[*slot];
            let reach = reach * mechanism.file_units(unknown.kind);
            (unknown.name.clone(), json!(reach))
        })
        .collect();
    json!({
        "schema": "mechanim-modes/1",
        "title": mechanism.title,
        "units": { "length": mechanism.length_unit, "angle": mechanism.angle_unit.name, "time": "s" },
        "time": time,
        "inputs": inputs,
        "bodies": bodies,
        "placements": modes.placements(),
        "isolated": modes.isolated(),
        "curves": modes.curves(),
        "larger_sets": modes.larger_sets(),
        "names": modes.names(),
        "starts": modes.starts(),
        "closed": modes.closed(),
        "kinds": kinds,
        "unseen": modes.unseen,
        "unlikely": modes.unlikely,
        "exhausted": modes.is_exhausted,
        "searched_up_to": reaches,
        "proof": false,
        "modes": list,
    })
}
