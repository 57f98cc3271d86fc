//! Drives of the inputs, start values of the unknowns, and the duration of the motion.

use super::super::file::{InputFile, SceneFile};
use super::super::formula::compile::{CompiledValue, compile_formula, constant_node};
use super::super::formula::node::FormulaNode;
use super::names::{Meaning, Names};
use super::parsed::{Parsed, ParsedInput};
use super::parsing::parsed_expression;
use super::words::TIME;
use crate::diag::{Diagnostic, Diagnostics, shown_number};
use crate::model::drive::{Drive, Ease};
use crate::model::mechanism::Kind;
use std::collections::HashMap;

/// The drives and the start of the motion.
pub struct Coordinates {
    pub guess: Vec<f64>,
    /// Which unknowns have a start value.
    pub named: Vec<bool>,
    pub drives: Vec<Drive>,
    pub duration: f64,
}

/// Longest motion accepted, in seconds: more than a year is certainly an error.
const MAX_DURATION: f64 = 3.2e7;

/// Shortest motion accepted, in seconds: fractions of shorter ones could not be told apart.
const MIN_DURATION: f64 = 1e-100;

/// Resolves inputs, guesses and duration.
pub fn resolve_coordinates(
    file: &SceneFile,
    parsed: &Parsed,
    names: &Names,
    diagnostics: &mut Diagnostics,
) -> Option<Coordinates> {
    let mut drives = Vec::new();
    let read = parsed
        .inputs
        .iter()
        .map(|(name, input)| (name.value.as_str(), input));
    let read: HashMap<&str, &ParsedInput> = read.collect();
    // Inputs of the file only: the variables of a study have no drive of their own.
    for (index, coordinate) in names.inputs[..file.inputs.len()].iter().enumerate() {
        let Some(input) = read.get(coordinate.name.as_str()) else {
            continue;
        };
        let wanted = Some(coordinate.kind);
        match resolve_drive(input, &file.inputs[index].1, names, wanted) {
            Ok(drive) => drives.push(drive),
            Err(diagnostic) => diagnostics.push(diagnostic),
        }
    }
    let is_whole = drives.len() == file.inputs.len();
    let (guess, named) = resolve_guess(parsed, names, diagnostics);
    let known_drives = is_whole.then_some(drives.as_slice());
    let duration = resolve_duration(file, names, known_drives, diagnostics)?;
    Some(Coordinates {
        guess,
        named,
        drives,
        duration,
    })
}

fn resolve_drive(
    input: &ParsedInput,
    file: &InputFile,
    names: &Names,
    wanted: Option<Kind>,
) -> Result<Drive, Diagnostic> {
    let radians = |node: &FormulaNode| names.in_radians(node.clone(), wanted);
    match (input, file) {
        (ParsedInput::Keys(keys), InputFile::Keys { keys: place, ease }) => {
            // Keys: an easing, and times that ascend.
            let ease = match ease {
                None => Ease::Linear,
                Some(word) => {
                    let known = Ease::NAMES.iter().find(|(name, _)| *name == word.value);
                    known.map(|(_, ease)| *ease).ok_or_else(|| {
                        Diagnostic::error(format!("unknown easing `{}`", word.value))
                            .at(word.span.clone())
                            .hint(format!(
                                "one of {}",
                                Ease::NAMES.map(|(name, _)| name).join(", ")
                            ))
                    })?
                }
            };
            let (mut times, mut values) = (Vec::new(), Vec::new());
            for [time, value] in keys {
                let time_node = names.in_radians(time.clone(), Some(Kind::Number));
                let at = constant_node(&time_node, &|n, s| names.constant(n, s))?;
                if times.last().is_some_and(|last| at <= *last) {
                    return Err(Diagnostic::error("the times of the keys must ascend")
                        .at(time.span.clone()));
                }
                times.push(at);
                values.push(constant_node(&radians(value), &|n, s| {
                    names.constant(n, s)
                })?);
            }
            if times.is_empty() {
                return Err(
                    Diagnostic::error("an input needs at least one key").at(place.span.clone())
                );
            }
            Ok(Drive::Keys {
                times,
                values,
                ease,
            })
        }
        // A formula of time and constants.
        (ParsedInput::Formula(node), _) => {
            let lookup = |name: &str, span: &_| match name {
                TIME => Ok(CompiledValue::Slot(0)),
                _ => names.constant_of_drive(name, span),
            };
            Ok(Drive::Formula(compile_formula(&radians(node), &lookup)?))
        }
        (ParsedInput::Keys(_), _) => Err(Diagnostic::inherited()),
    }
}

fn resolve_guess(
    parsed: &Parsed,
    names: &Names,
    diagnostics: &mut Diagnostics,
) -> (Vec<f64>, Vec<bool>) {
    let mut guess = vec![0.0; names.unknowns.len()];
    let mut named = vec![false; guess.len()];
    for (name, node) in &parsed.guess {
        let Some(Meaning::Unknown(index)) = names.meaning(&name.value) else {
            // If loops are unreadable, the name may be one of their unknowns.
            if !names.is_complete() {
                continue;
            }
            // Parallel cylinders turn some unknowns of their contact into constants.
            if names.is_settled(&name.value, parsed) {
                let message = format!("the start value of `{}` is not used", name.value);
                let hint = "the axes of the two cylinders are parallel, so that it is constant";
                diagnostics.push(
                    Diagnostic::warning(message)
                        .at(name.span.clone())
                        .hint(hint),
                );
                continue;
            }
            let unknowns = names.unknowns.iter().map(|c| c.name.as_str());
            let message = format!(
                "start value for `{}`, which is not an unknown of any loop",
                name.value
            );
            let diagnostic = Diagnostic::error(message).at(name.span.clone());
            let is_input = names.inputs.iter().any(|input| input.name == name.value);
            diagnostics.push(match is_input {
                true => diagnostic.hint("it is an input, which its drive gives a value"),
                false => names.suggest(diagnostic, &name.value, unknowns),
            });
            continue;
        };
        // Start values are constants in the file's units.
        let wanted = Some(names.unknowns[index].kind);
        let node = names.in_radians(node.clone(), wanted);
        match constant_node(&node, &|n, s| names.constant(n, s)) {
            Ok(value) => (guess[index], named[index]) = (value, true),
            Err(diagnostic) => diagnostics.push(diagnostic),
        }
    }
    (guess, named)
}

/// The `duration` key, else the time of the last keyframe, else one second (nothing moves).
fn resolve_duration(
    file: &SceneFile,
    names: &Names,
    drives: Option<&[Drive]>,
    diagnostics: &mut Diagnostics,
) -> Option<f64> {
    let Some(text) = &file.duration else {
        // Without the key, the last keyframe ends the motion; formulas have no end of their own.
        let drives = drives?;
        let last = drives
            .iter()
            .filter_map(Drive::last_key)
            .fold(0.0, f64::max);
        let moving = drives.iter().position(|d| !d.is_constant());
        if let (true, Some(moving)) = (last == 0.0, moving) {
            let mut diagnostic = Diagnostic::error("the duration of the motion is unknown")
                .hint("add `duration = 2.0` (seconds)");
            if let InputFile::Formula(text) = &file.inputs[moving].1 {
                diagnostic = diagnostic.at(text.span.clone());
            }
            diagnostics.push(diagnostic);
        }
        return Some(if last > 0.0 { last } else { 1.0 });
    };
    // With the key: a constant number of seconds in the accepted range.
    let node = names.in_radians(parsed_expression(text, diagnostics)?, Some(Kind::Number));
    match constant_node(&node, &|n, s| names.constant(n, s)) {
        Ok(value) if (MIN_DURATION..=MAX_DURATION).contains(&value) => Some(value),
        Ok(value) => {
            let value = shown_number(value);
            let message =
                format!("duration must be above 0 and at most {MAX_DURATION:e} s, found {value}");
            diagnostics.push(Diagnostic::error(message).at(text.span.clone()));
            None
        }
        Err(diagnostic) => {
            diagnostics.push(diagnostic);
            None
        }
    }
}
