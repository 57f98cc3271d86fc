//! Named scalars: formulas over coordinates, traced points and earlier outputs.

use super::super::file::SceneFile;
use super::super::formula::compile::{CompiledValue, compile_formula};
use super::super::formula::kinds::{dimension_of, own_kind, to_radians};
use super::super::formula::node::FormulaNode;
use super::body_constants::BodyConstants;
use super::clearance::asked_distance;
use super::contacts::closure::Contacts;
use super::names::Names;
use super::parsed::Parsed;
use crate::diag::{Diagnostic, Diagnostics, Span};
use crate::model::dimension::PhysicalDimension;
use crate::model::expression::Expression;
use crate::model::mechanism::{AngleUnit, Body, Kind, MechanismOutput, OutputSource, Trace};
use crate::model::rate::{Per, RateOrder, RatedFormula};
use std::collections::HashMap;

/// The names that formulas of poses may use.
pub struct Scope<'a> {
    pub names: &'a Names,
    pub traces: &'a [Trace],
    pub contacts: &'a Contacts,
    pub unit: &'a AngleUnit,
    /// Outputs so far.
    pub outputs: Vec<MechanismOutput>,
    /// Their slots by name; none for an invalid output.
    places: HashMap<String, Option<usize>>,
    /// What they measure.
    dimensions: HashMap<String, PhysicalDimension>,
    /// Slots of outputs that contain rates, and whether one of the rates is by time.
    rated: HashMap<usize, bool>,
}

/// A further number that a formula may use in addition to those of a pose.
pub struct ExtraSlot {
    pub name: String,
    pub slot: usize,
    pub dimension: PhysicalDimension,
}

impl<'a> Scope<'a> {
    /// Whether a formula contains an angle that is a coordinate, not only its sine or cosine, or an output that does.
    pub fn holds_coordinate_angle(&self, formula: &Expression) -> bool {
        let coordinates = || self.names.unknowns.iter().chain(&self.names.inputs);
        let count = coordinates().count();
        let first = count + 3 * self.traces.len();
        let mut slots = formula.slots_outside_waves().into_iter();
        slots.any(|slot| match slot.checked_sub(first) {
            Some(index) => match self.outputs.get(index).map(|output| &output.source) {
                Some(OutputSource::Formula(formula)) => self.holds_coordinate_angle(formula),
                _ => false,
            },
            None => coordinates()
                .nth(slot)
                .is_some_and(|c| c.kind == Kind::Angle),
        })
    }

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
            dimensions: HashMap::new(),
            rated: HashMap::new(),
        };
        let constants = BodyConstants { names };
        // Distances first: formulas may use them.
        for item in &file.distances {
            let distance = asked_distance(item, &constants, bodies, diagnostics);
            scope.note(&item.name.value, distance.is_some());
            scope
                .outputs
                .extend(distance.map(|distance| MechanismOutput {
                    name: item.name.value.clone(),
                    source: OutputSource::Distance(distance),
                    kind: Kind::Length,
                    dimension: PhysicalDimension::of(Kind::Length),
                }));
        }
        // Formulas in order: each may use the outputs before it.
        for (name, node) in &parsed.outputs {
            let name = &name.value;
            let compiled = scope.compile_rated(node);
            scope.note(name, compiled.is_ok());
            match compiled {
                Ok((formula, dimension)) => {
                    scope.dimensions.insert(name.clone(), dimension);
                    scope.note_rates(&formula);
                    scope.outputs.push(MechanismOutput {
                        name: name.clone(),
                        source: match formula.rates.is_empty() {
                            true => OutputSource::Formula(formula.expression),
                            false => OutputSource::Rated(formula),
                        },
                        kind: dimension.kind(),
                        dimension,
                    });
                }
                Err(diagnostic) => diagnostics.push(diagnostic),
            }
        }
        scope
    }

    /// Registers the next output, if it is valid; of equal names the first one counts.
    fn note(&mut self, name: &str, is_usable: bool) {
        let place = is_usable.then_some(self.outputs.len());
        let earlier = self.places.entry(name.to_owned()).or_insert(place);
        *earlier = earlier.or(place);
    }

    /// Records whether the next output contains rates.
    fn note_rates(&mut self, formula: &RatedFormula) {
        let is_timed = |(_, rate): &(Expression, RateOrder)| rate.per == Per::Time;
        let own = formula.rates.iter().map(is_timed);
        let used = formula.expression.slots();
        let used = used.iter().filter_map(|slot| self.rated.get(slot).copied());
        if let Some(timed) = own.chain(used).reduce(|a, b| a || b) {
            self.rated.insert(self.slot_count(), timed);
        }
    }

    /// Whether a slot is an output that contains rates.
    pub fn is_rated(&self, slot: usize) -> bool {
        self.rated.contains_key(&slot)
    }

    /// Whether a slot is an output that contains rates by time.
    pub fn is_timed(&self, slot: usize) -> bool {
        self.rated.get(&slot) == Some(&true)
    }

    /// A formula of coordinates, traced points and earlier outputs, and its kind.
    pub fn compile(
        &self,
        node: &FormulaNode,
    ) -> Result<(Expression, PhysicalDimension), Diagnostic> {
        self.compile_with(node, &[])
    }

    /// The same with additional names.
    pub fn compile_with(
        &self,
        node: &FormulaNode,
        more: &[ExtraSlot],
    ) -> Result<(Expression, PhysicalDimension), Diagnostic> {
        let extra = |used: &str| more.iter().find(|extra| extra.name == used);
        // The dimensions of names: additional ones, outputs, then scalars of contacts.
        let known = |used: &str| {
            let place = self.places.get(used).copied().flatten();
            let earlier = place.map(|place| match self.dimensions.get(used) {
                Some(dimension) => *dimension,
                None => PhysicalDimension::of(self.outputs[place].kind),
            });
            let contact = || {
                self.contacts
                    .scalar(used)
                    .map(|(_, kind, _)| PhysicalDimension::of(*kind))
            };
            let extra = extra(used).map(|extra| extra.dimension);
            extra.or(earlier).or_else(contact)
        };
        let of_name = |used: &str| {
            let own = self.names.kind(used).map(PhysicalDimension::of);
            own.or_else(|| known(used))
                .or_else(|| self.names.dimension(used))
        };
        let dimension = dimension_of(node, &of_name);
        // Angles of the file's unit become radians before the formula is compiled.
        let wanted = own_kind(node, &of_name);
        let node = to_radians(node.clone(), wanted, self.unit.radians, &of_name);
        // Slots: those of additional names are given, others are found by name.
        let formula = compile_formula(&node, &|used, span| match extra(used) {
            Some(extra) => Ok(CompiledValue::Slot(extra.slot)),
            None => self.lookup(used, span),
        })?;
        Ok((formula, dimension))
    }

    /// Number of slots that formulas of poses have, including the outputs so far.
    pub fn slot_count(&self) -> usize {
        let coordinates = self.names.unknowns.len() + self.names.inputs.len();
        coordinates + 3 * self.traces.len() + self.outputs.len()
    }

    fn lookup(&self, used: &str, span: &Span) -> Result<CompiledValue, Diagnostic> {
        let (names, traces) = (self.names, self.traces);
        let coordinates = names.unknowns.len() + names.inputs.len();
        // Slots behind the coordinates: x, y, z of every trace, then the outputs.
        if let Some(slot) = trace_slot(used, traces) {
            return Ok(CompiledValue::Slot(coordinates + slot));
        }
        if let Some(Some(earlier)) = self.places.get(used) {
            return Ok(CompiledValue::Slot(
                coordinates + 3 * traces.len() + earlier,
            ));
        }
        // Scalars of contacts have no slots: their formulas are inserted.
        if let Some((_, _, scalar)) = self.contacts.scalar(used) {
            return match scalar {
                Ok(formula) => Ok(CompiledValue::Formula(formula.clone())),
                Err(why) => {
                    let message = format!("`{used}` has no value here: {why}");
                    Err(Diagnostic::error(message).at(span.clone()))
                }
            };
        }
        // What is declared and invalid has been reported already.
        let trace = used.rsplit_once('.').map_or("", |(trace, _)| trace);
        if names.declares_trace(trace) && !traces.iter().any(|t| t.name == trace) {
            return Err(Diagnostic::inherited());
        }
        if self.places.contains_key(used) {
            return Err(Diagnostic::inherited());
        }
        // Else a parameter, an input or an unknown, or an error that knows all of these names.
        names.coordinate(used, span).map_err(|d| {
            let points: Vec<String> = traces
                .iter()
                .flat_map(|t| ["x", "y", "z"].map(|c| format!("{}.{c}", t.name)))
                .collect();
            let scalars = self.contacts.scalars.iter().map(|(name, ..)| name.as_str());
            let outputs = self.outputs.iter().map(|output| output.name.as_str());
            let known = names.all().chain(points.iter().map(String::as_str));
            names
                .suggest(d, used, known.chain(scalars).chain(outputs))
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
