//! The meaning and kind of every name of a scene, and the values of the parameters.

use super::super::file::SceneFile;
use super::super::formula::compile::{CompiledValue, exact_constant};
use super::super::formula::expansion::Factor;
use super::super::formula::kinds::{defines_angle, has_plain_angles, has_unknown, to_radians};
use super::super::formula::node::FormulaNode;
use super::parsed::Parsed;
use super::words::{TIME, refuse_double_and_reserved};
use crate::diag::{Diagnostic, Diagnostics, Span};
use crate::model::dimension::PhysicalDimension;
use crate::model::mechanism::{AngleUnit, Coordinate, Kind};
use crate::numbers::constant::Constant;
use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

/// A parameter, its kind if known, and its value (radians for angles).
pub struct Parameter {
    pub name: String,
    pub kind: Option<Kind>,
    /// Whether a use tells its kind, in a chain for example, and not only its definition.
    pub is_placed: bool,
    pub value: Constant,
}

/// The names of a scene.
pub struct Names {
    pub parameters: Vec<Parameter>,
    pub inputs: Vec<Coordinate>,
    pub unknowns: Vec<Coordinate>,
    /// The first position of each unknown.
    pub unknown_places: Vec<Span>,
    pub(super) kinds: BTreeMap<String, (Kind, Span)>,
    /// Parameters and outputs whose own formula has errors: formulas that use them are not checked.
    broken: BTreeSet<String>,
    /// All loops could be read, so that every unknown is known.
    is_complete: bool,
    traces: BTreeSet<String>,
    /// The meaning of each name; of equal names the first one counts.
    meanings: HashMap<String, Meaning>,
    /// How many more undefined names are compared with all others.
    suggestions: Cell<usize>,
    /// Parameters that are inputs in a study, as (parameter, input).
    pub varied: Vec<(usize, usize)>,
    /// The file's unit of angles.
    radians: Constant,
    /// Parameters that appear where a length is expected, and those where an angle is.
    pub(super) stands_in: [BTreeSet<String>; 2],
}

/// Most undefined names for which a similar one is sought: more than are shown, and few enough for a file of nothing
/// else.
const MOST_SUGGESTIONS: usize = 100;

/// The meaning of a name in a formula of coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Meaning {
    Parameter(usize),
    Input(usize),
    Unknown(usize),
}

impl Names {
    /// Collects all names: parameters and inputs are defined; every other name in a loop is an unknown.
    pub fn collect(
        file: &SceneFile,
        parsed: &Parsed,
        unit: &AngleUnit,
        diagnostics: &mut Diagnostics,
    ) -> Self {
        refuse_double_and_reserved(file, diagnostics);
        let coordinate = |name: &str| Coordinate {
            name: name.to_owned(),
            kind: Kind::Number,
        };
        let mut names = Self {
            parameters: file
                .parameters
                .iter()
                .map(|(name, _)| Parameter {
                    name: name.value.clone(),
                    kind: None,
                    is_placed: true,
                    value: Constant::default(),
                })
                .collect(),
            inputs: file
                .inputs
                .iter()
                .map(|(name, _)| coordinate(&name.value))
                .collect(),
            unknowns: Vec::new(),
            unknown_places: Vec::new(),
            kinds: BTreeMap::new(),
            broken: broken_names(file, parsed),
            is_complete: parsed.is_complete,
            traces: file.traces.iter().map(|t| t.name.value.clone()).collect(),
            meanings: HashMap::new(),
            suggestions: Cell::new(MOST_SUGGESTIONS),
            varied: Vec::new(),
            radians: unit.radians,
            stands_in: Default::default(),
        };
        // Unknowns: every undefined name in an equation, in the order of first appearance.
        names.index();
        let mut found: Vec<(String, Span)> = Vec::new();
        let mut known: HashSet<String> = HashSet::new();
        let mut gather = |name: &str, span: &Span| {
            if names.meaning(name).is_none() && known.insert(name.to_owned()) {
                found.push((name.to_owned(), span.clone()));
            }
        };
        // Loops, contacts, equations and bars can all introduce unknowns.
        parsed
            .loops
            .iter()
            .flat_map(|(_, f)| f)
            .for_each(|f| visit_factor(f, &mut gather));
        parsed
            .contacts
            .iter()
            .flat_map(|contact| contact.factors())
            .for_each(|f| visit_factor(f, &mut gather));
        parsed
            .equations
            .iter()
            .for_each(|(_, node)| node.visit_names(&mut gather));
        let bars = &parsed.bars;
        bars.lengths()
            .for_each(|node| node.visit_names(&mut gather));
        bars.factors().for_each(|f| visit_factor(f, &mut gather));
        // Names must be indexed again, since the unknowns are part of the list now.
        names.unknowns = found.iter().map(|(name, _)| coordinate(name)).collect();
        names.unknown_places = found.into_iter().map(|(_, span)| span).collect();
        names.index();
        names.refuse_undefined_in_frames(parsed, diagnostics);
        names.refuse_time(diagnostics);
        names.refuse_taken_unknowns(file, diagnostics);
        names
    }

    /// The meaning of `name` in a formula of coordinates.
    pub fn meaning(&self, name: &str) -> Option<Meaning> {
        self.meanings.get(name).copied()
    }

    /// Updates the meaning of every name; to be called after one is added or removed.
    fn index(&mut self) {
        let names = |list: &[Coordinate]| list.iter().map(|c| c.name.clone()).collect::<Vec<_>>();
        let parameters = self.parameters.iter().map(|p| p.name.clone());
        let parameters = parameters
            .enumerate()
            .map(|(k, n)| (n, Meaning::Parameter(k)));
        let inputs = names(&self.inputs).into_iter().enumerate();
        let unknowns = names(&self.unknowns).into_iter().enumerate();
        let coordinates = inputs.map(|(k, n)| (n, Meaning::Input(k)));
        let all = parameters.chain(coordinates);
        let all = all.chain(unknowns.map(|(k, n)| (n, Meaning::Unknown(k))));
        let mut meanings = HashMap::new();
        for (name, meaning) in all {
            meanings.entry(name).or_insert(meaning);
        }
        self.meanings = meanings;
    }

    /// Every defined name, for suggestions.
    pub fn all(&self) -> impl Iterator<Item = &str> {
        let coordinates = self
            .inputs
            .iter()
            .chain(&self.unknowns)
            .map(|c| c.name.as_str());
        self.parameters
            .iter()
            .map(|p| p.name.as_str())
            .chain(coordinates)
    }

    /// The message about an undefined `name`.
    pub fn undefined(&self, name: &str, span: &Span) -> Diagnostic {
        let diagnostic = Diagnostic::error(format!("`{name}` is not defined"))
            .at(span.clone())
            .label("no parameter, no input, and no loop determines it");
        if name == TIME {
            return diagnostic.hint("the time is known in the formulas of inputs only");
        }
        self.suggest(diagnostic, name, self.all())
    }

    /// Adds "did you mean" to the first few messages about undefined names.
    pub fn suggest<'a>(
        &self,
        diagnostic: Diagnostic,
        name: &str,
        known: impl IntoIterator<Item = &'a str>,
    ) -> Diagnostic {
        let left = self.suggestions.get();
        self.suggestions.set(left.saturating_sub(1));
        match left {
            0 => diagnostic,
            _ => diagnostic.suggest(name, known),
        }
    }

    /// Whether all unknowns are known; otherwise an undefined name may be one.
    pub fn is_complete(&self) -> bool {
        self.is_complete
    }

    /// Whether the file has a trace of that name, even an invalid one.
    pub fn declares_trace(&self, name: &str) -> bool {
        self.traces.contains(name)
    }

    /// Looks up a constant: parameters only.
    pub fn constant(&self, name: &str, span: &Span) -> Result<CompiledValue, Diagnostic> {
        if self.broken.contains(name) {
            return Err(Diagnostic::inherited());
        }
        match self.meaning(name) {
            Some(Meaning::Parameter(i)) => Ok(CompiledValue::Constant(self.parameters[i].value)),
            Some(meaning) => {
                let message = format!("`{name}` varies, but a constant is required here");
                let diagnostic = Diagnostic::error(message).at(span.clone());
                // A misspelt parameter is taken for an unknown.
                let parameters = self.parameters.iter().map(|p| p.name.as_str());
                Err(match meaning {
                    Meaning::Unknown(_) => diagnostic
                        .label("no parameter has this name, so that loops determine it")
                        .did_you_mean(name, parameters),
                    _ => diagnostic,
                })
            }
            None => Err(self.undefined(name, span)),
        }
    }

    /// Looks up a constant in the formula of an input, which may also use the time.
    pub fn constant_of_drive(&self, name: &str, span: &Span) -> Result<CompiledValue, Diagnostic> {
        let parameters = self.parameters.iter().map(|p| p.name.as_str());
        let known = std::iter::once(TIME).chain(parameters);
        match self.meaning(name) {
            Some(Meaning::Parameter(_)) => self.constant(name, span),
            _ if self.broken.contains(name) => Err(Diagnostic::inherited()),
            Some(_) => {
                let message = format!(
                    "`{name}` varies: formulas of inputs are of the time `{TIME}` and parameters"
                );
                let diagnostic = Diagnostic::error(message).at(span.clone());
                Err(diagnostic.did_you_mean(name, known))
            }
            None => {
                let diagnostic = Diagnostic::error(format!("`{name}` is not defined"))
                    .at(span.clone())
                    .label(format!("neither the time `{TIME}` nor a parameter"));
                Err(self.suggest(diagnostic, name, known))
            }
        }
    }

    /// Looks up a coordinate or parameter; slots are unknowns, then inputs.
    pub fn coordinate(&self, name: &str, span: &Span) -> Result<CompiledValue, Diagnostic> {
        if self.broken.contains(name) {
            return Err(Diagnostic::inherited());
        }
        match self.meaning(name) {
            Some(Meaning::Parameter(i)) => Ok(match self.varied.iter().find(|(p, _)| *p == i) {
                Some((_, input)) => CompiledValue::Slot(self.unknowns.len() + input),
                None => CompiledValue::Constant(self.parameters[i].value),
            }),
            Some(Meaning::Unknown(i)) => Ok(CompiledValue::Slot(i)),
            Some(Meaning::Input(i)) => Ok(CompiledValue::Slot(self.unknowns.len() + i)),
            None if !self.is_complete => Err(Diagnostic::inherited()),
            None => Err(self.undefined(name, span)),
        }
    }

    /// A formula with its angles in radians, in a position that expects `wanted`.
    pub fn in_radians(&self, node: FormulaNode, wanted: Option<Kind>) -> FormulaNode {
        to_radians(node, wanted, self.radians, &|name| self.dimension(name))
    }

    /// What `name` measures, if known; coordinates of traced points are lengths.
    pub fn dimension(&self, name: &str) -> Option<PhysicalDimension> {
        match self.kind(name) {
            None if name.contains('.') => Some(PhysicalDimension::of(Kind::Length)),
            kind => kind.map(PhysicalDimension::of),
        }
    }

    /// The kind of `name`, if known.
    pub fn kind(&self, name: &str) -> Option<Kind> {
        self.kinds.get(name).map(|(kind, _)| *kind)
    }

    /// Turns an unknown into a constant.
    pub fn settle(&mut self, name: &str, value: Constant) {
        let Some(Meaning::Unknown(index)) = self.meaning(name) else {
            return;
        };
        self.unknown_places.remove(index);
        let Coordinate { name, kind } = self.unknowns.remove(index);
        self.parameters.push(Parameter {
            name,
            kind: Some(kind),
            is_placed: true,
            value,
        });
        self.index();
    }

    /// Whether a name is that of an unknown that was turned into a constant.
    pub fn is_settled(&self, name: &str, parsed: &Parsed) -> bool {
        let is_own = parsed.parameters.iter().any(|(own, _)| own.value == name);
        !is_own && matches!(self.meaning(name), Some(Meaning::Parameter(_)))
    }

    /// A parameter whose uses do not tell its kind is an angle if its definition is one, or that of the file which another value
    /// replaces: `30deg`, or a sum with an angle. `pi` times something is a length where a length is expected.
    fn take_kind_of_definition(
        &mut self,
        own: usize,
        node: &FormulaNode,
        replaced: Option<&FormulaNode>,
    ) {
        let parameter = &self.parameters[own];
        if parameter.kind.is_some() {
            return;
        }
        let name = parameter.name.clone();
        let of_name = |used: &str| self.dimension(used);
        let [lengths, angles] = &self.stands_in;
        let is_length = lengths.contains(&name) && !angles.contains(&name);
        let is_open =
            |node: &FormulaNode| has_plain_angles(node, &of_name) || has_unknown(node, &of_name);
        let is_angle =
            |node: &FormulaNode| defines_angle(node, &of_name) && !(is_length && is_open(node));
        let kind = match is_angle(node) || replaced.is_some_and(is_angle) {
            true => Kind::Angle,
            // In a product of a length numbers are plain.
            false if is_length => Kind::Number,
            false => return,
        };
        self.kinds.insert(name, (kind, node.span.clone()));
        if kind == Kind::Angle {
            self.parameters[own].kind = Some(kind);
            self.parameters[own].is_placed = false;
        }
    }

    /// Evaluates the parameters in order.
    pub fn evaluate_parameters(&mut self, parsed: &Parsed, diagnostics: &mut Diagnostics) {
        for (name, node) in &parsed.parameters {
            let Some(Meaning::Parameter(own)) = self.meaning(&name.value) else {
                continue;
            };
            // A parameter may use earlier parameters only; each wrong use has its own message.
            let replaced = parsed.replaced.iter().find(|(n, _)| *n == name.value);
            self.take_kind_of_definition(own, node, replaced.map(|(_, node)| node));
            let node = self.in_radians(node.clone(), self.kind(&name.value));
            let place = |used: &str| match self.meaning(used) {
                Some(Meaning::Parameter(index)) => Some(index),
                _ => None,
            };
            let lookup = |used: &str, span: &Span| match place(used) {
                Some(i) if i == own => {
                    Err(Diagnostic::error(format!("`{used}` is defined by itself"))
                        .at(span.clone()))
                }
                _ if self.broken.contains(used) => Err(Diagnostic::inherited()),
                Some(i) if i < own => Ok(CompiledValue::Constant(self.parameters[i].value)),
                Some(_) => Err(
                    Diagnostic::error(format!("`{used}` is defined further down"))
                        .at(span.clone())
                        .hint("a parameter may use only earlier ones: move the definition up"),
                ),
                None => {
                    let message = format!("`{used}` is not a parameter");
                    let earlier = self.parameters[..own].iter().map(|p| p.name.as_str());
                    Err(self.suggest(Diagnostic::error(message).at(span.clone()), used, earlier))
                }
            };
            // Errors are not repeated for parameters that use an invalid one.
            match exact_constant(&node, &lookup) {
                Ok(value) => self.parameters[own].value = value,
                Err(diagnostic) => {
                    diagnostics.push(diagnostic);
                    self.broken.insert(name.value.clone());
                }
            }
        }
    }
}

pub(super) fn visit_factor(factor: &Factor, visit: &mut dyn FnMut(&str, &Span)) {
    match factor {
        Factor::Elementary(_, _, node) => node.visit_names(visit),
        Factor::Direction(nodes, _) => nodes.iter().for_each(|node| node.visit_names(visit)),
    }
}

/// Parameters and outputs whose formula could not be read.
fn broken_names(file: &SceneFile, parsed: &Parsed) -> BTreeSet<String> {
    let lists = [
        (&file.parameters, &parsed.parameters),
        (&file.outputs, &parsed.outputs),
    ];
    let faulty = lists.into_iter().flat_map(|(all, read)| {
        let all = all.iter().map(|(name, _)| &name.value);
        let read: HashSet<&str> = read.iter().map(|(name, _)| name.value.as_str()).collect();
        all.filter(move |name| !read.contains(name.as_str()))
    });
    faulty.cloned().collect()
}
