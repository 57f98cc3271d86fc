//! Parameters varied by a study become inputs of the mechanism, so that everything that holds for inputs, above all
//! sensitivities through the loops, holds for them. Shapes and the view keep the file's values; distances of bodies
//! read them again (`analysis/study/reshaped`), and enclosures follow them by chains (`carried`).

use super::super::file::SceneFile;
use super::super::formula::expansion::Factor;
use super::super::formula::node::{FormulaNode, NodeKind};
use super::joints::FoldedJoints;
use super::names::{Meaning, Names, Parameter};
use super::parsed::{Parsed, ParsedInput};
use super::parsing::{Named, parsed_expression};
use crate::diag::{Diagnostic, Diagnostics};
use crate::model::chain::ElementaryMotion;
use crate::model::mechanism::{Body, Coordinate, Kind, Trace};
use crate::scene::loaded::{KeptIn, KeptParameter};

impl Names {
    /// Whether a slot of coordinates is a varied parameter.
    pub fn rests(&self, slot: usize) -> bool {
        let input = slot.checked_sub(self.unknowns.len());
        self.varied.iter().any(|(_, k)| Some(*k) == input)
    }

    /// Coordinates with the file's values of the varied parameters, otherwise zero.
    pub fn resting_coordinates(&self) -> Vec<f64> {
        let mut coordinates = vec![0.0; self.unknowns.len() + self.inputs.len()];
        for (parameter, input) in &self.varied {
            coordinates[self.unknowns.len() + input] = self.parameters[*parameter].value.number();
        }
        coordinates
    }

    /// The input that represents a varied parameter.
    pub fn varied_input(&self, name: &str) -> Option<usize> {
        let Some(Meaning::Parameter(index)) = self.meaning(name) else {
            return None;
        };
        let varied = self.varied.iter().find(|(p, _)| *p == index);
        varied.map(|(_, input)| *input)
    }

    /// Turns the parameters named in `varied` into inputs, after the file's own; returns their values.
    pub fn promote_parameters(&mut self, varied: &[String]) -> Vec<f64> {
        let mut values = Vec::new();
        for name in varied {
            let Some(Meaning::Parameter(index)) = self.meaning(name) else {
                continue;
            };
            let parameter = &self.parameters[index];
            values.push(parameter.value.number());
            self.varied.push((index, self.inputs.len()));
            self.inputs.push(Coordinate {
                name: name.clone(),
                kind: parameter.kind.unwrap_or(Kind::Number),
            });
        }
        values
    }

    /// The kind of every parameter, if known.
    pub fn parameter_kinds(&self) -> Vec<(String, Kind)> {
        let list = self.parameters.iter();
        list.filter_map(|p| Some((p.name.clone(), p.kind?)))
            .collect()
    }

    /// Parameters that are lengths or angles and given as numbers.
    pub fn dimensions(&self, parsed: &Parsed) -> Vec<String> {
        let is_number = |name: &str| {
            let node = parsed.parameters.iter().find(|(n, _)| n.value == name);
            let mut plain = node.is_some();
            if let Some((_, node)) = node {
                node.visit_names(&mut |_, _| plain = false);
            }
            plain
        };
        let measured =
            |p: &&Parameter| p.is_placed && matches!(p.kind, Some(Kind::Length | Kind::Angle));
        let list = self.parameters.iter().filter(measured);
        list.filter(|p| is_number(&p.name))
            .map(|p| p.name.clone())
            .collect()
    }
}

/// Parameters that are varied, and the formulas of those that depend on them.
pub struct Dependents {
    varied: Vec<String>,
    list: Vec<(String, FormulaNode)>,
}

impl Dependents {
    /// The names in `varied`.
    pub fn new(parsed: &Parsed, names: &Names, varied: &[String]) -> Self {
        Self {
            varied: varied.to_vec(),
            list: dependent_parameters(&parsed.parameters, names, varied),
        }
    }

    /// Replaces every dependent parameter by its formula.
    pub fn expand(&self, node: &mut FormulaNode) {
        substitute_names(node, &self.list, MAX_DEPTH);
    }

    /// The same in a motion of a chain.
    pub fn expand_factor(&self, factor: &mut Factor) {
        match factor {
            Factor::Elementary(_, _, node) => self.expand(node),
            Factor::Direction(nodes, _) => nodes.iter_mut().for_each(|node| self.expand(node)),
        }
    }

    /// Adds the numbers of the varied parameters that an expanded formula uses.
    pub fn note_used(&self, node: &FormulaNode, used: &mut Vec<usize>) {
        node.visit_names(&mut |name, _| {
            let number = self.varied.iter().position(|v| v == name);
            used.extend(number.filter(|k| !used.contains(k)));
        });
    }

    /// A varied parameter that an expanded formula uses.
    pub fn used_in(&self, node: &FormulaNode) -> Option<String> {
        let mut used = None;
        node.visit_names(&mut |name, _| {
            if self.varied.iter().any(|v| v == name) {
                used = Some(name.to_owned());
            }
        });
        used
    }
}

/// Deepest nesting of parameters defined by parameters that is followed.
const MAX_DEPTH: usize = 100;

/// Replaces every parameter that depends on one of `varied` by its formula, wherever coordinates may appear; the names
/// that remain are those in `varied` and constants.
pub fn expand_dependents(
    parsed: &mut Parsed,
    names: &Names,
    varied: &[String],
    diagnostics: &mut Diagnostics,
) {
    // Every name on the list must be a parameter of the file.
    for name in varied {
        if !parsed.parameters.iter().any(|(n, _)| n.value == *name) {
            let known: Vec<&str> = parsed
                .parameters
                .iter()
                .map(|(n, _)| &n.value[..])
                .collect();
            let message = format!("`{name}` cannot be varied: the scene has no such parameter");
            diagnostics.push(Diagnostic::error(message).suggest(name, known));
        }
    }
    // Loops, frames, bars, contacts, equations and outputs follow the variables.
    let dependents = Dependents::new(parsed, names, varied);
    if dependents.list.is_empty() {
        return;
    }
    let expand = |node: &mut FormulaNode| dependents.expand(node);
    let expand_factor = |factor: &mut Factor| dependents.expand_factor(factor);
    let loops = parsed.loops.iter_mut().map(|(_, factors)| factors);
    let chains = loops.chain(&mut parsed.frames).flatten();
    chains.for_each(expand_factor);
    parsed.bars.change(&expand_factor, &expand);
    for contact in &mut parsed.contacts {
        contact.visit_factors(&expand_factor);
        contact.visit_sizes(&expand);
    }
    let formulas = parsed.equations.iter_mut().chain(&mut parsed.outputs);
    formulas.for_each(|(_, node)| expand(node));
}

/// Varied parameters whose file values are still used somewhere: in drives, tracks, axes of rotations, limits of measures and clearances,
/// powers of norms, ranges of variables and the duration. Results for a motion or a measure hold for these values only.
pub fn kept_parameters(parsed: &Parsed, names: &Names, varied: &[String]) -> Vec<KeptParameter> {
    let dependents = dependent_parameters(&parsed.parameters, names, varied);
    let mut kept: Vec<KeptParameter> = Vec::new();
    // Records which variables a formula uses, directly or through a computed parameter.
    let mut note = |node: &FormulaNode, place: KeptIn| {
        let mut node = node.clone();
        substitute_names(&mut node, &dependents, MAX_DEPTH);
        node.visit_names(&mut |name, _| {
            let item = KeptParameter {
                name: name.to_owned(),
                place,
            };
            if varied.iter().any(|v| v == name) && !kept.contains(&item) {
                kept.push(item);
            }
        });
    };
    for (_, input) in &parsed.inputs {
        match input {
            ParsedInput::Formula(node) => note(node, KeptIn::Drive),
            ParsedInput::Keys(keys) => {
                let nodes = keys.iter().flatten();
                nodes.for_each(|node| note(node, KeptIn::Drive));
            }
        }
    }
    let fixed = parsed.fixed.iter();
    fixed.for_each(|(place, node)| note(node, *place));
    let loops = parsed.loops.iter().map(|(_, factors)| factors);
    let pins = parsed.bars.pins.iter().map(|pin| &pin.closing);
    for factor in loops.chain(pins).chain(&parsed.frames).flatten() {
        if let Factor::Direction(nodes, _) = factor {
            nodes.iter().for_each(|node| note(node, KeptIn::Direction));
        }
    }
    kept
}

/// Parameters that are not varied themselves but use a varied one in their formulas.
fn dependent_parameters(
    parameters: &[Named<FormulaNode>],
    names: &Names,
    varied: &[String],
) -> Vec<(String, FormulaNode)> {
    let mut found: Vec<(String, FormulaNode)> = Vec::new();
    for (name, node) in parameters {
        let mut depends = false;
        node.visit_names(&mut |used, _| {
            depends |= varied.iter().any(|v| v == used) || found.iter().any(|(d, _)| d == used);
        });
        if depends && !varied.contains(&name.value) {
            let mut node = node.clone();
            substitute_names(&mut node, &found, MAX_DEPTH);
            // In its own kind, wherever it is used.
            let kind = names.kind(&name.value);
            let span = node.span.clone();
            let kind = NodeKind::Of(kind, Box::new(node));
            found.push((name.value.clone(), FormulaNode { kind, span }));
        }
    }
    found
}

fn substitute_names(node: &mut FormulaNode, formulas: &[(String, FormulaNode)], depth: usize) {
    if depth == 0 {
        return;
    }
    match &mut node.kind {
        NodeKind::Number(_) | NodeKind::Radians(_) => {}
        NodeKind::Name(name) => {
            if let Some((_, formula)) = formulas.iter().find(|(n, _)| n == name) {
                node.kind = formula.kind.clone();
            }
        }
        NodeKind::Negate(inner) | NodeKind::Of(_, inner) => {
            substitute_names(inner, formulas, depth - 1)
        }
        NodeKind::Binary(_, a, b) => {
            substitute_names(a, formulas, depth - 1);
            substitute_names(b, formulas, depth - 1);
        }
        NodeKind::Derivative(parts) => substitute_names(&mut parts.of, formulas, depth - 1),
        NodeKind::Call(_, args) => args
            .iter_mut()
            .for_each(|arg| substitute_names(arg, formulas, depth - 1)),
    }
}

/// Gives every traced point a frame of its own, whose chain ends at the point, so that its position may vary too.
pub fn carry_points(
    file: &SceneFile,
    parsed: &Parsed,
    varied: &[String],
    joints: &mut FoldedJoints,
    (bodies, traces): (&mut Vec<Body>, &mut [Trace]),
    diagnostics: &mut Diagnostics,
) {
    let dependents = Dependents::new(parsed, joints.names, varied);
    for (trace, typed) in traces.iter_mut().zip(&file.traces) {
        let Some(point) = &typed.point else { continue };
        let mut factors = parsed.frames[trace.body].clone();
        // The chain of the point: that of its body, then its coordinates in the body's frame.
        for (axis, text) in point.iter().enumerate() {
            let Some(mut node) = parsed_expression(text, diagnostics) else {
                return;
            };
            dependents.expand(&mut node);
            factors.push(Factor::Elementary(
                ElementaryMotion::Translation,
                axis,
                node,
            ));
        }
        let Some(chain) = joints.chain(&factors, diagnostics) else {
            return;
        };
        // A body without shapes carries the point, which is its origin.
        bodies.push(Body {
            name: trace.name.clone(),
            world_from_body: chain,
            shapes: Vec::new(),
        });
        trace.body = bodies.len() - 1;
        trace.point = glam::DVec3::ZERO;
    }
}
