//! Named scalars: formulas over coordinates, traced points and earlier outputs.

use super::super::formula::compile::{Value, compile};
use super::super::formula::expression::{Node, NodeKind};
use super::super::formula::kinds::to_radians;
use super::contacts::closure::Contacts;
use super::names::Names;
use super::parsed::Parsed;
use crate::diag::{Diagnostic, Diagnostics, Span};
use crate::model::expression::Function;
use crate::model::mechanism::{AngleUnit, Kind, Output, Trace};

/// Resolves the outputs in the order of the file.
pub fn resolve(
    parsed: &Parsed,
    names: &Names,
    traces: &[Trace],
    contacts: &Contacts,
    unit: &AngleUnit,
    diagnostics: &mut Diagnostics,
) -> Vec<Output> {
    let coordinates = names.unknowns.len() + names.inputs.len();
    let mut outputs: Vec<Output> = Vec::new();
    let mut failed: Vec<&str> = Vec::new();
    for (name, node) in &parsed.outputs {
        let known = |used: &str| {
            let earlier = outputs.iter().find(|o| o.name == used).map(|o| o.kind);
            earlier.or_else(|| contacts.scalar(used).map(|(_, kind, _)| *kind))
        };
        let kind = kind_of(node, names, &known);
        let is_angle = |n: &str| names.is_angle(n) || known(n) == Some(Kind::Angle);
        let node = to_radians(node.clone(), Some(kind), unit.radians, &is_angle);
        let lookup = |used: &str, span: &Span| {
            if let Some(slot) = trace_slot(used, traces) {
                return Ok(Value::Slot(coordinates + slot));
            }
            if let Some(earlier) = outputs.iter().position(|o| o.name == used) {
                return Ok(Value::Slot(coordinates + 3 * traces.len() + earlier));
            }
            if let Some((_, _, scalar)) = contacts.scalar(used) {
                return match scalar {
                    Ok(formula) => Ok(Value::Formula(formula.clone())),
                    Err(why) => Err(Diagnostic::error(format!(
                        "`{used}` has no value here: {why}"
                    ))
                    .at(span.clone())),
                };
            }
            let trace = used.rsplit_once('.').map_or("", |(trace, _)| trace);
            if names.declares_trace(trace) && !traces.iter().any(|t| t.name == trace) {
                return Err(Diagnostic::inherited());
            }
            if failed.contains(&used) {
                return Err(Diagnostic::inherited());
            }
            names.coordinate(used, span).map_err(|d| {
                let points: Vec<String> = traces
                    .iter()
                    .flat_map(|t| ["x", "y", "z"].map(|c| format!("{}.{c}", t.name)))
                    .collect();
                let scalars = contacts.scalars.iter().map(|(name, ..)| name.as_str());
                d.suggest(used, points.iter().map(String::as_str).chain(scalars))
                    .label("no parameter, input, unknown, traced point, contact or earlier output")
            })
        };
        match compile(&node, &lookup) {
            Ok(expression) => outputs.push(Output {
                name: name.value.clone(),
                expression,
                kind,
            }),
            Err(diagnostic) => {
                diagnostics.push(diagnostic);
                failed.push(&name.value);
            }
        }
    }
    outputs
}

/// `M.x` to 3·index + component.
fn trace_slot(name: &str, traces: &[Trace]) -> Option<usize> {
    let (trace, component) = name.rsplit_once('.')?;
    let component = ["x", "y", "z"].iter().position(|c| *c == component)?;
    let index = traces.iter().position(|t| t.name == trace)?;
    Some(3 * index + component)
}

/// What a formula measures, from the bottom up.
fn kind_of(node: &Node, names: &Names, output: &dyn Fn(&str) -> Option<Kind>) -> Kind {
    match &node.kind {
        NodeKind::Number(_) => Kind::Number,
        NodeKind::Radians(_) => Kind::Angle,
        NodeKind::Name(name) => names
            .kind(name)
            .or_else(|| output(name))
            .or_else(|| name.contains('.').then_some(Kind::Length))
            .unwrap_or(Kind::Number),
        NodeKind::Negate(inner) => kind_of(inner, names, output),
        NodeKind::Binary(sign, a, b) => {
            let (x, y) = (kind_of(a, names, output), kind_of(b, names, output));
            match (sign, x, y) {
                ('+' | '-' | '*', Kind::Number, other)
                | ('+' | '-' | '*' | '/', other, Kind::Number) => other,
                ('+' | '-', x, _) => x,
                _ => Kind::Number,
            }
        }
        NodeKind::Call(function, args) => match function {
            Function::Asin | Function::Acos | Function::Atan | Function::Atan2 => Kind::Angle,
            Function::Abs | Function::Min | Function::Max | Function::Mod | Function::Hypot => {
                kind_of(&args[0], names, output)
            }
            _ => Kind::Number,
        },
    }
}
