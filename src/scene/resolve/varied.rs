//! Parameters that a study varies: they become inputs of the mechanism, so that everything that is known about
//! inputs (sensitivities through the loops above all) holds for them. Shapes and the view keep the file's values.

use super::super::file::SceneFile;
use super::super::formula::chain::Factor;
use super::super::formula::expression::{Node, NodeKind};
use super::joints::Joints;
use super::parsed::{Named, Parsed, expression};
use crate::diag::{Diagnostic, Diagnostics};
use crate::model::chain::Motion;
use crate::model::mechanism::{Body, Trace};

/// Deepest row of parameters defined by parameters that is followed.
const MAX_DEPTH: usize = 100;

/// Replaces every parameter that depends on one of `varied` by its formula, wherever coordinates may stand; what
/// is left of it after that is one of `varied` itself or a constant.
pub fn expand_dependents(parsed: &mut Parsed, varied: &[String], diagnostics: &mut Diagnostics) {
    for name in varied {
        if !parsed.parameters.iter().any(|(n, _)| n.value == *name) {
            let known: Vec<&str> = parsed
                .parameters
                .iter()
                .map(|(n, _)| &n.value[..])
                .collect();
            let message = format!("`{name}` is to be varied, but the scene has no such parameter");
            diagnostics.push(Diagnostic::error(message).suggest(name, known));
        }
    }
    let dependents = dependents(&parsed.parameters, varied);
    if dependents.is_empty() {
        return;
    }
    let expand = |node: &mut Node| substitute(node, &dependents, MAX_DEPTH);
    let loops = parsed.loops.iter_mut().map(|(_, factors)| factors);
    for factor in loops.chain(&mut parsed.frames).flatten() {
        match factor {
            Factor::Elementary(_, _, node) => expand(node),
            Factor::Direction(nodes, _) => nodes.iter_mut().for_each(expand),
        }
    }
    let formulas = parsed.equations.iter_mut().chain(&mut parsed.outputs);
    formulas.for_each(|(_, node)| expand(node));
}

/// Parameters, not varied themselves, whose formulas use a varied one.
fn dependents(parameters: &[Named<Node>], varied: &[String]) -> Vec<(String, Node)> {
    let mut found: Vec<(String, Node)> = Vec::new();
    for (name, node) in parameters {
        let mut depends = false;
        node.visit_names(&mut |used, _| {
            depends |= varied.iter().any(|v| v == used) || found.iter().any(|(d, _)| d == used);
        });
        if depends && !varied.contains(&name.value) {
            let mut node = node.clone();
            substitute(&mut node, &found, MAX_DEPTH);
            found.push((name.value.clone(), node));
        }
    }
    found
}

fn substitute(node: &mut Node, formulas: &[(String, Node)], depth: usize) {
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
        NodeKind::Negate(inner) => substitute(inner, formulas, depth - 1),
        NodeKind::Binary(_, a, b) => {
            substitute(a, formulas, depth - 1);
            substitute(b, formulas, depth - 1);
        }
        NodeKind::Call(_, args) | NodeKind::Measure(_, args) => args
            .iter_mut()
            .for_each(|arg| substitute(arg, formulas, depth - 1)),
    }
}

/// Gives every traced point a frame of its own, whose chain ends with the point: its place may then vary too.
pub fn carry_points(
    file: &SceneFile,
    parsed: &Parsed,
    varied: &[String],
    joints: &mut Joints,
    (bodies, traces): (&mut Vec<Body>, &mut [Trace]),
    diagnostics: &mut Diagnostics,
) {
    let dependents = dependents(&parsed.parameters, varied);
    for (trace, typed) in traces.iter_mut().zip(&file.traces) {
        let Some(point) = &typed.point else { continue };
        let mut factors = parsed.frames[trace.body].clone();
        for (axis, text) in point.iter().enumerate() {
            let Some(mut node) = expression(text, diagnostics) else {
                return;
            };
            substitute(&mut node, &dependents, MAX_DEPTH);
            factors.push(Factor::Elementary(Motion::Translation, axis, node));
        }
        let Some(chain) = joints.chain(&factors, diagnostics) else {
            return;
        };
        bodies.push(Body {
            name: trace.name.clone(),
            world_from_body: chain,
            shapes: Vec::new(),
        });
        trace.body = bodies.len() - 1;
        trace.point = glam::DVec3::ZERO;
    }
}
