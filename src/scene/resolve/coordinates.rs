//! Drives of the inputs, start values of the unknowns, and the duration of the motion.

use super::super::file::{InputFile, SceneFile};
use super::super::formula::compile::{CompiledValue, compile_formula, constant_node};
use super::super::formula::node::FormulaNode;
use super::super::reader::Spanned;
use super::choices::unknown_word;
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
    match (input, file) {
        (ParsedInput::Keys(keys), InputFile::Keys { keys: place, ease }) => {
            let ease = resolve_ease(ease.as_ref())?;
            let (times, values) = resolve_keys(keys, names, wanted)?;
            if times.is_empty() {
                let message = "an input needs at least one key";
                return Err(Diagnostic::error(message).at(place.span.clone()));
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
            let node = names.in_radians(node.clone(), wanted);
            Ok(Drive::Formula(compile_formula(&node, &lookup)?))
        }
        (ParsedInput::Keys(_), _) => Err(Diagnostic::inherited()),
    }
}

fn resolve_ease(word: Option<&Spanned<String>>) -> Result<Ease, Diagnostic> {
    let Some(word) = word else {
        return Ok(Ease::Linear);
    };
    let mut known = Ease::NAMES.iter();
    let known = known.find(|(name, _)| *name == word.value);
    let names = || Ease::NAMES.map(|(name, _)| name);
    known
        .map(|(_, ease)| *ease)
        .ok_or_else(|| unknown_word(word, "easing", names()))
}

/// Times that ascend, and the values at them.
fn resolve_keys(
    keys: &[[FormulaNode; 2]],
    names: &Names,
    wanted: Option<Kind>,
) -> Result<(Vec<f64>, Vec<f64>), Diagnostic> {
    let constant = |node: &FormulaNode, kind| {
        let node = names.in_radians(node.clone(), kind);
        constant_node(&node, &|n, s| names.constant(n, s))
    };
    let (mut times, mut values) = (Vec::new(), Vec::new());
    for [time, value] in keys {
        let at = constant(time, Some(Kind::Number))?;
        if times.last().is_some_and(|last| at <= *last) {
            let message = "the times of the keys must ascend";
            return Err(Diagnostic::error(message).at(time.span.clone()));
        }
        times.push(at);
        values.push(constant(value, wanted)?);
    }
    Ok((times, values))
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
            if names.is_complete() {
                diagnostics.push(unused_guess(name, parsed, names));
            }
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

/// What is wrong with a start value of something that is not an unknown.
fn unused_guess(name: &Spanned<String>, parsed: &Parsed, names: &Names) -> Diagnostic {
    let (word, place) = (&name.value, name.span.clone());
    // Parallel cylinders turn some unknowns of their contact into constants.
    if names.is_settled(word, parsed) {
        let message = format!("the start value of `{word}` is not used");
        let hint = "the axes of the two cylinders are parallel, so that it is constant";
        return Diagnostic::warning(message).at(place).hint(hint);
    }
    let message = format!("start value for `{word}`, which is not an unknown of any loop");
    let diagnostic = Diagnostic::error(message).at(place);
    if names.inputs.iter().any(|input| input.name == *word) {
        return diagnostic.hint("it is an input, which its drive gives a value");
    }
    let unknowns = names.unknowns.iter().map(|c| c.name.as_str());
    names.suggest(diagnostic, word, unknowns)
}

/// The `duration` key, else the time of the last keyframe, else one second (nothing moves).
fn resolve_duration(
    file: &SceneFile,
    names: &Names,
    drives: Option<&[Drive]>,
    diagnostics: &mut Diagnostics,
) -> Option<f64> {
    let Some(text) = &file.duration else {
        return Some(duration_of_drives(file, drives?, diagnostics));
    };
    // With the key: a constant number of seconds in the accepted range.
    let node = names.in_radians(parsed_expression(text, diagnostics)?, Some(Kind::Number));
    let value = constant_node(&node, &|n, s| names.constant(n, s));
    let value = value.map_err(|d| diagnostics.push(d)).ok()?;
    if (MIN_DURATION..=MAX_DURATION).contains(&value) {
        return Some(value);
    }
    let value = shown_number(value);
    let message = format!("duration must be above 0 and at most {MAX_DURATION:e} s, found {value}");
    diagnostics.push(Diagnostic::error(message).at(text.span.clone()));
    None
}

/// The time of the last keyframe; formulas have no end of their own.
fn duration_of_drives(file: &SceneFile, drives: &[Drive], diagnostics: &mut Diagnostics) -> f64 {
    let last = drives.iter().filter_map(Drive::last_key);
    let last = last.fold(0.0, f64::max);
    if last > 0.0 {
        return last;
    }
    if let Some(moving) = drives.iter().position(|d| !d.is_constant()) {
        let mut diagnostic = Diagnostic::error("the duration of the motion is unknown")
            .hint("add `duration = 2.0` (seconds)");
        if let InputFile::Formula(text) = &file.inputs[moving].1 {
            diagnostic = diagnostic.at(text.span.clone());
        }
        diagnostics.push(diagnostic);
    }
    1.0
}
