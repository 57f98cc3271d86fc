//! `--mode`: start values that lead to one of the assemblies.

use crate::cli::args::scene::ModeChoice;
use crate::cli::interrupt::{CANCEL, refuse_interrupted};
use crate::cli::term::outcome::Failure;
use crate::kinematics::assemblies::{DEFAULT_STARTS, Mode, Modes, find_modes};
use crate::kinematics::solve::wishes::StartPreferences;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::report::sentences::counted_things;
use std::sync::atomic::Ordering;

/// Number of starts that show whether an assembly is nearer to the start values: enough unless it is rare.
const FEW_STARTS: usize = 100;

/// The same of mechanisms with more unknowns than so many, of which every start costs as the cube of their number.
const SMALL: usize = 12;
const FEWEST_STARTS: usize = 10;

/// Share of the drive after which the branches are listed that meet at its start.
const BESIDE_START: f64 = 1e-3;

/// An assembly nearer to the start values than the one found.
pub struct NearerAssembly {
    /// Its signature, or its number where others have the same.
    pub mode: String,
    /// The unknown whose start value it fits better by the largest margin.
    pub unknown: usize,
    /// The value of that unknown there.
    pub value: f64,
}

/// Unknowns of a mode at the start of the drive: start values that lead to it.
pub fn start_of(
    system: &System,
    actuation: &Actuation,
    choice: &ModeChoice,
) -> Result<Vec<f64>, Failure> {
    let modes = search_modes(system, actuation, 0.0, DEFAULT_STARTS)?;
    let mut coordinates = match choice {
        ModeChoice::Number(number) => numbered_mode(&modes, *number)?,
        ModeChoice::Signature(signature) => signed_mode(system, actuation, &modes, signature)?,
    };
    coordinates.truncate(system.mechanism().unknowns.len());
    Ok(coordinates)
}

fn numbered_mode(modes: &Modes, number: usize) -> Result<Vec<f64>, Failure> {
    let mode = number.checked_sub(1).and_then(|k| modes.list.get(k));
    mode.map(|mode| mode.coordinates.clone()).ok_or_else(|| {
        Failure::usage(
            format!(
                "there is no mode {number}: {} found at the start of the drive",
                counted_things(modes.list.len(), "mode")
            ),
            vec!["`mechanim modes` lists them".to_owned()],
        )
    })
}

/// The only mode with that signature. Where branches meet at the start, that of the branch right after it.
fn signed_mode(
    system: &System,
    actuation: &Actuation,
    modes: &Modes,
    signature: &str,
) -> Result<Vec<f64>, Failure> {
    if let Some(mode) = only_mode(modes, signature)? {
        return Ok(mode.coordinates.clone());
    }
    if modes.list.iter().any(|mode| mode.is_singular) {
        let beside = search_modes(
            system,
            actuation,
            BESIDE_START * actuation.duration,
            DEFAULT_STARTS,
        )?;
        if let Some(mode) = only_mode(&beside, signature)? {
            return Ok(mode.coordinates.clone());
        }
    }
    let mut known: Vec<&str> = modes.list.iter().map(|m| m.branch.as_str()).collect();
    known.dedup();
    Err(Failure::usage(
        format!("no mode with signature `{signature}` was found at the start of the drive"),
        vec![format!("signatures found: {}", known.join(", "))],
    ))
}

/// The mode with a signature, if there is one; an error if there are several.
fn only_mode<'m>(modes: &'m Modes, signature: &str) -> Result<Option<&'m Mode>, Failure> {
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

/// The assembly nearest to the start preferences, as `--mode` takes it, if `pose` at the start of the drive is far from
/// one of them that this assembly fits, and the unknown concerned.
pub fn nearer_mode(
    system: &System,
    actuation: &Actuation,
    wishes: &StartPreferences,
    pose: &[f64],
) -> Result<Option<NearerAssembly>, Failure> {
    let nearest = |modes: &Modes| {
        let list = modes.list.iter().enumerate();
        let far = list.map(|(k, mode)| (wishes.distance(&mode.coordinates), k));
        let (far, index) = far.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let unknown = wishes.gained(pose, &modes.list[index].coordinates)?;
        (far < wishes.distance(pose)).then_some((index, unknown))
    };
    // The motion's own assembly is known, and starts that keep the wishes were made for it.
    let unnamed = Actuation {
        named: Vec::new(),
        ..actuation.clone()
    };
    let size = system.mechanism().unknowns.len().max(SMALL) / SMALL;
    let starts = (FEW_STARTS / (size * size)).max(FEWEST_STARTS);
    if nearest(&search_modes(system, &unnamed, 0.0, starts)?).is_none() {
        return Ok(None);
    }
    let modes = search_modes(system, actuation, 0.0, DEFAULT_STARTS)?;
    let Some((index, unknown)) = nearest(&modes) else {
        return Ok(None);
    };
    let mode = &modes.list[index];
    let name = match only_mode(&modes, &mode.branch) {
        Ok(Some(_)) => mode.branch.clone(),
        _ => (index + 1).to_string(),
    };
    Ok(Some(NearerAssembly {
        mode: name,
        unknown,
        value: mode.coordinates[unknown],
    }))
}

/// The assemblies at the inputs of a time, from this number of starts.
///
/// Errors: an input without a value there; Ctrl-C.
pub fn search_modes(
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
    let modes = find_modes(system, &first, &actuation.named, starts, &cancelled);
    refuse_interrupted()?;
    Ok(modes)
}
