//! Translates parsed bars into equations, and pins into loops.

use super::super::super::formula::compile::{compile_formula, constant_node};
use super::super::super::formula::expansion::Factor;
use super::super::super::formula::node::{FormulaNode, NodeKind};
use super::super::joints::FoldedJoints;
use super::super::names::{Meaning, Names};
use super::parsed::{ParsedBar, ParsedBars, ParsedEnd};
use crate::diag::{Diagnostic, Diagnostics, shown_number};
use crate::model::chain::ElementaryMotion;
use crate::model::function::Function;
use crate::model::mechanism::{Bar, BarEnd, Closes, Equation, Kind, Loop};
use crate::numbers::constant::Constant;

/// The contribution of bars to the mechanism.
#[derive(Default)]
pub struct ResolvedBars {
    pub loops: Vec<Loop>,
    pub equations: Vec<Equation>,
    pub list: Vec<Bar>,
}

/// Equations and loops of the valid bars.
pub fn resolve_bars(
    parsed: &ParsedBars,
    names: &Names,
    joints: &mut FoldedJoints,
    diagnostics: &mut Diagnostics,
) -> ResolvedBars {
    let mut resolved = ResolvedBars::default();
    for pin in &parsed.pins {
        let closed = joints.closing(&pin.name, &pin.closing, Closes::Point, diagnostics);
        let base = joints.chain(&pin.base, diagnostics);
        if let (Some(closed), Some(base)) = (closed, base) {
            resolved.loops.push(Loop { base, ..closed });
        }
    }
    for bar in &parsed.list {
        if let Some((equation, bar)) = resolve_bar(bar, names, joints, diagnostics) {
            resolved.equations.push(equation);
            resolved.list.push(bar);
        }
    }
    resolved
}

/// The equation of a valid bar.
fn resolve_bar(
    bar: &ParsedBar,
    names: &Names,
    joints: &mut FoldedJoints,
    diagnostics: &mut Diagnostics,
) -> Option<(Equation, Bar)> {
    let fault = fault_of_ends(bar, names);
    let are_sound = fault.is_none();
    fault.into_iter().for_each(|fault| diagnostics.push(fault));
    let length = constant_length(bar, names).map_err(|d| diagnostics.push(d));
    let [from, to] = &bar.ends;
    let ends = [
        bar_end(from, joints, diagnostics)?,
        bar_end(to, joints, diagnostics)?,
    ];
    let length = length.ok().filter(|_| are_sound)?;
    // The equation itself; without a divisor its value is a squared length.
    let gap = names.in_radians(bar_gap(bar, length), Some(Kind::Number));
    let expression = compile_formula(&gap, &|n, s| names.coordinate(n, s));
    let name = bar.name.value.clone();
    let equation = Equation {
        name: name.clone(),
        expression: expression.map_err(|d| diagnostics.push(d)).ok()?,
        length_exponent: if length.is_some() { 1.0 } else { 2.0 },
        weight: 1.0,
    };
    Some((equation, Bar { name, ends, length }))
}

/// Whether a formula contains only parameters, no coordinate.
fn is_fixed(node: &FormulaNode, names: &Names) -> bool {
    let mut fixed = true;
    node.visit_names(&mut |name, _| {
        fixed &= matches!(names.meaning(name), Some(Meaning::Parameter(_)));
    });
    fixed
}

/// Whether nothing that carries an end moves.
fn stands(end: &ParsedEnd, names: &Names) -> bool {
    end.carrier.iter().all(|factor| match factor {
        Factor::Elementary(_, _, node) => is_fixed(node, names),
        Factor::Direction(..) => true,
    })
}

/// A bar must connect two different points, at least one of which can move.
fn fault_of_ends(bar: &ParsedBar, names: &Names) -> Option<Diagnostic> {
    let name = &bar.name.value;
    let [from, to] = &bar.ends;
    let mut pairs = from.place.iter().zip(&to.place);
    if pairs.all(|(a, b)| a.is_alike(b)) {
        let message = format!("bar `{name}` has the same point at both ends");
        let fault = Diagnostic::error(message).at(to.span.clone());
        return Some(fault.hint("a bar connects two points"));
    }
    if !(stands(from, names) && stands(to, names)) {
        return None;
    }
    let message = format!("bar `{name}` is between two fixed points");
    let hint = "it constrains nothing: leave it out, or let an end be an unknown point or a point of a link";
    let fault = Diagnostic::error(message).at(bar.name.span.clone());
    Some(fault.hint(hint))
}

/// The length of a bar, if it is constant. It becomes the divisor of the equation, so it must be positive.
fn constant_length(bar: &ParsedBar, names: &Names) -> Result<Option<f64>, Diagnostic> {
    let node = names.in_radians(bar.length.clone(), Some(Kind::Length));
    if !is_fixed(&node, names) {
        return Ok(None);
    }
    let value = constant_node(&node, &|n, s| names.constant(n, s))?;
    if value > 0.0 {
        return Ok(Some(value));
    }
    let (name, value) = (&bar.name.value, shown_number(value));
    let message = format!("the length of bar `{name}` must be positive, found {value}");
    let hint = "a bar is as long as its points are apart; points that are one are written as one";
    let fault = Diagnostic::error(message).at(bar.length.span.clone());
    Err(fault.hint(hint))
}

/// An end as chains, for drawings and dyads: a carrier, then the coordinates in its frame.
fn bar_end(
    end: &ParsedEnd,
    joints: &mut FoldedJoints,
    diagnostics: &mut Diagnostics,
) -> Option<BarEnd> {
    let motion = ElementaryMotion::Translation;
    let coordinates = end.place.iter().cloned().enumerate();
    let coordinates: Vec<Factor> = coordinates
        .map(|(axis, node)| Factor::Elementary(motion, axis, node))
        .collect();
    Some(BarEnd {
        point: joints.chain(&coordinates, diagnostics)?,
        carrier: joints.chain(&end.carrier, diagnostics)?,
    })
}

/// (d² - L²) / 2 L: to first order, the amount by which the points are too far apart. A variable length is not used as
/// a divisor, and its square is L |L|: no pose has a negative length.
fn bar_gap(bar: &ParsedBar, length: Option<f64>) -> FormulaNode {
    let span = &bar.name.span;
    // The equation is built as a syntax tree: coordinates and length may be any formulas.
    let binary = |sign: char, a: FormulaNode, b: FormulaNode| FormulaNode {
        kind: NodeKind::Binary(sign, Box::new(a), Box::new(b)),
        span: span.clone(),
    };
    let number = |value: f64| FormulaNode::number(Constant::exact(value), span.clone());
    let square = |node: FormulaNode| binary('^', node, number(2.0));
    let [from, to] = &bar.ends;
    let pairs = from.place.iter().zip(&to.place);
    // d², coordinate by coordinate.
    let squares = pairs.map(|(a, b)| square(binary('-', b.clone(), a.clone())));
    let sum = squares.reduce(|sum, next| binary('+', sum, next));
    let sum = sum.unwrap_or_else(|| number(0.0));
    match length {
        Some(length) => {
            // Over 2 L it is a length, near d - L.
            let gap = binary('-', sum, square(bar.length.clone()));
            binary('*', gap, number(0.5 / length))
        }
        None => {
            // Else d² - L |L|, a squared length.
            let kind = NodeKind::Call(Function::Abs, vec![bar.length.clone()]);
            let span = span.clone();
            let size = FormulaNode { kind, span };
            binary('-', sum, binary('*', bar.length.clone(), size))
        }
    }
}
