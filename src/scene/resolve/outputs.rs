//! Named scalars: formulas over coordinates, traced points and earlier outputs.

use super::super::file::SceneFile;
use super::super::formula::compile::{CompiledValue, compile_formula};
use super::super::formula::expression::{FormulaNode, NodeKind};
use super::super::formula::kinds::to_radians;
use super::body_constants::BodyConstants;
use super::clearance::asked_distance;
use super::contacts::closure::Contacts;
use super::names::Names;
use super::parsed::Parsed;
use crate::diag::{Diagnostic, Diagnostics, Span};
use crate::model::expression::{Expression, Function};
use crate::model::mechanism::{AngleUnit, Body, Kind, MechanismOutput, OutputSource, Trace};
use std::collections::HashMap;

/// What formulas of poses may use.
pub struct Scope<'a> {
    pub names: &'a Names,
    pub traces: &'a [Trace],
    pub contacts: &'a Contacts,
    pub unit: &'a AngleUnit,
    /// Outputs so far.
    pub outputs: Vec<MechanismOutput>,
    /// Their places by name; none for a faulty one.
    places: HashMap<String, Option<usize>>,
}

impl<'a> Scope<'a> {
    /// Resolves the outputs in the order of the file.
    pub fn resolve(
        (file, parsed): (&SceneFile, &Parsed),
        bodies: &[Body],
        names: &'a Names,
        traces: &'a [Trace],
        contacts: &'a Contacts,
        unit: &'a AngleUnit,
        diagnostics: &mut Diagnostics,
    ) -> Self {
        let mut scope = Self {
            names,
            traces,
            contacts,
            unit,
            outputs: Vec::new(),
            places: HashMap::new(),
        };
        let constants = BodyConstants { names };
        for item in &file.distances {
            let distance = asked_distance(item, &constants, bodies, diagnostics);
            scope.note(&item.name.value, distance.is_some());
            scope
                .outputs
                .extend(distance.map(|distance| MechanismOutput {
                    name: item.name.value.clone(),
                    source: OutputSource::Distance(distance),
                    kind: Kind::Length,
                }));
        }
        for (name, node) in &parsed.outputs {
            let name = &name.value;
            let compiled = scope.compile(node);
            scope.note(name, compiled.is_ok());
            match compiled {
                Ok((expression, kind)) => scope.outputs.push(MechanismOutput {
                    name: name.clone(),
                    source: OutputSource::Formula(expression),
                    kind,
                }),
                Err(diagnostic) => diagnostics.push(diagnostic),
            }
        }
        scope
    }

    /// Notes the place of the next output, if it is one that can be used; of equal names the first one counts.
    fn note(&mut self, name: &str, is_usable: bool) {
        let place = is_usable.then_some(self.outputs.len());
        let earlier = self.places.entry(name.to_owned()).or_insert(place);
        *earlier = earlier.or(place);
    }

    /// A formula over coordinates, traced points and the outputs so far, and what it measures.
    pub fn compile(&self, node: &FormulaNode) -> Result<(Expression, Kind), Diagnostic> {
        let known = |used: &str| {
            let place = self.places.get(used).copied().flatten();
            let earlier = place.map(|place| self.outputs[place].kind);
            earlier.or_else(|| self.contacts.scalar(used).map(|(_, kind, _)| *kind))
        };
        let kind = kind_of(node, self.names, &known);
        let is_angle = |n: &str| self.names.is_angle(n) || known(n) == Some(Kind::Angle);
        let node = to_radians(node.clone(), Some(kind), self.unit.radians, &is_angle);
        let formula = compile_formula(&node, &|used, span| self.lookup(used, span))?;
        Ok((formula, kind))
    }

    fn lookup(&self, used: &str, span: &Span) -> Result<CompiledValue, Diagnostic> {
        let (names, traces) = (self.names, self.traces);
        let coordinates = names.unknowns.len() + names.inputs.len();
        if let Some(slot) = trace_slot(used, traces) {
            return Ok(CompiledValue::Slot(coordinates + slot));
        }
        if let Some(Some(earlier)) = self.places.get(used) {
            return Ok(CompiledValue::Slot(
                coordinates + 3 * traces.len() + earlier,
            ));
        }
        if let Some((_, _, scalar)) = self.contacts.scalar(used) {
            return match scalar {
                Ok(formula) => Ok(CompiledValue::Formula(formula.clone())),
                Err(why) => {
                    let message = format!("`{used}` has no value here: {why}");
                    Err(Diagnostic::error(message).at(span.clone()))
                }
            };
        }
        let trace = used.rsplit_once('.').map_or("", |(trace, _)| trace);
        if names.declares_trace(trace) && !traces.iter().any(|t| t.name == trace) {
            return Err(Diagnostic::inherited());
        }
        if self.places.contains_key(used) {
            return Err(Diagnostic::inherited());
        }
        names.coordinate(used, span).map_err(|d| {
            let points: Vec<String> = traces
                .iter()
                .flat_map(|t| ["x", "y", "z"].map(|c| format!("{}.{c}", t.name)))
                .collect();
            let scalars = self.contacts.scalars.iter().map(|(name, ..)| name.as_str());
            let known = points.iter().map(String::as_str).chain(scalars);
            names
                .suggest(d, used, known)
                .label("no parameter, input, unknown, traced point, contact or earlier output")
        })
    }
}

/// `M.x` to 3·index + component.
fn trace_slot(name: &str, traces: &[Trace]) -> Option<usize> {
    let (trace, component) = name.rsplit_once('.')?;
    let component = ["x", "y", "z"].iter().position(|c| *c == component)?;
    let index = traces.iter().position(|t| t.name == trace)?;
    Some(3 * index + component)
}

/// What a formula measures, from the bottom up.
pub fn kind_of(node: &FormulaNode, names: &Names, output: &dyn Fn(&str) -> Option<Kind>) -> Kind {
    match &node.kind {
        NodeKind::Number(_) => Kind::Number,
        NodeKind::Radians(_) | NodeKind::Angle(_) => Kind::Angle,
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
