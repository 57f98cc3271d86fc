//! Infers the kinds (length, angle, number) of the parts of a formula, and converts its numbers from the file's angle
//! unit to radians.
//!
//! Rules: where the position expects an angle, a part that contains no angle itself (`Ry(180)`, `beta + 30`) is in the file's
//! angle unit. Where no position tells, or in a product of an angle, a number beside an angle in a sum is (`2*(beta - 30)`), but
//! no function and no ratio, which are in radians as in `beta - sin(beta)`. A sum inside a product, a power or a function is looked at
//! by itself (`R*(beta - 30)` is an arc), whatever stands around it. Sines, cosines and tangents take mere numbers in the file's unit, and
//! ratios in radians. In a file in radians nothing is converted at all.

use super::node::{FormulaNode, NodeKind};
use crate::diag::Span;
use crate::model::dimension::PhysicalDimension;
use crate::model::expression::Function;
use crate::model::mechanism::Kind;
use crate::numbers::constant::Constant;

/// What a name measures, if that is known.
pub type DimensionOfName<'a> = &'a dyn Fn(&str) -> Option<PhysicalDimension>;

/// Reports to `note` the kind of each name in `node`, if the position requires the kind `wanted`.
pub fn infer_kind(
    node: &FormulaNode,
    wanted: Option<Kind>,
    note: &mut dyn FnMut(&str, Kind, &Span),
) {
    match &node.kind {
        NodeKind::Number(_) | NodeKind::Radians(_) => {}
        NodeKind::Name(name) => {
            if let Some(kind) = wanted {
                note(name, kind, &node.span);
            }
        }
        NodeKind::Negate(inner) => infer_kind(inner, wanted, note),
        NodeKind::Of(kind, inner) => infer_kind(inner, *kind, note),
        NodeKind::Binary('+' | '-', a, b) => {
            infer_kind(a, wanted, note);
            infer_kind(b, wanted, note);
        }
        NodeKind::Binary(sign, a, b) => {
            // A literal factor leaves the kind to the other factor; any other product determines nothing.
            let keeps_a = is_literal(b) && *sign != '^';
            let keeps_b = is_literal(a) && *sign == '*';
            infer_kind(a, wanted.filter(|_| keeps_a), note);
            infer_kind(b, wanted.filter(|_| keeps_b), note);
        }
        NodeKind::Derivative(parts) => infer_kind(&parts.of, None, note),
        NodeKind::Call(function, args) => {
            let inner = argument_kind(*function, wanted);
            args.iter().for_each(|arg| infer_kind(arg, inner, note));
        }
    }
}

/// The kinds of a function's arguments if its own position requires `wanted`.
fn argument_kind(function: Function, wanted: Option<Kind>) -> Option<Kind> {
    match function {
        Function::Sin | Function::Cos | Function::Tan => Some(Kind::Angle),
        Function::Abs | Function::Min | Function::Max | Function::Mod | Function::Hypot => wanted,
        _ => None,
    }
}

fn is_literal(node: &FormulaNode) -> bool {
    match &node.kind {
        NodeKind::Number(_) => true,
        NodeKind::Negate(inner) => is_literal(inner),
        NodeKind::Binary(_, a, b) => is_literal(a) && is_literal(b),
        _ => false,
    }
}

/// The dimension of a formula, from the leaves to the root; names that `of_name` does not know are plain numbers.
pub fn dimension_of(node: &FormulaNode, of_name: DimensionOfName) -> PhysicalDimension {
    let of = |node: &FormulaNode| dimension_of(node, of_name);
    match &node.kind {
        NodeKind::Number(_) | NodeKind::Derivative(_) => PhysicalDimension::NUMBER,
        NodeKind::Radians(_) => PhysicalDimension::of(Kind::Angle),
        NodeKind::Of(kind, _) => kind.map_or(PhysicalDimension::NUMBER, PhysicalDimension::of),
        NodeKind::Name(name) => of_name(name).unwrap_or_default(),
        NodeKind::Negate(inner) => of(inner),
        // Sums have the dimension of their terms that have one, in whatever order; products add dimensions.
        NodeKind::Binary('+' | '-', ..) => {
            let mut terms = Vec::new();
            visit_terms(node, &mut |term| terms.push(of(term)));
            common_dimension(terms)
        }
        NodeKind::Binary('*', a, b) => of(a) + of(b),
        NodeKind::Binary('/', a, b) => of(a) - of(b),
        // Only whole powers have a dimension.
        NodeKind::Binary(_, base, power) => match power.kind {
            NodeKind::Number(power) if power.number().fract() == 0.0 => {
                of(base) * power.number().clamp(-99.0, 99.0) as i32
            }
            _ => PhysicalDimension::NUMBER,
        },
        NodeKind::Call(function, args) => match function {
            _ if gives_angle(*function) => PhysicalDimension::of(Kind::Angle),
            Function::Abs | Function::Min | Function::Max | Function::Mod | Function::Hypot => {
                common_dimension(args.iter().map(of))
            }
            Function::Sqrt => of(&args[0]).half_powers(),
            _ => PhysicalDimension::NUMBER,
        },
    }
}

/// The dimension of terms that are added or compared: that of those that are no plain numbers, as in `x + 3`. Where they differ
/// it is that of a length among them.
fn common_dimension(parts: impl IntoIterator<Item = PhysicalDimension>) -> PhysicalDimension {
    let measured = |part: &PhysicalDimension| *part != PhysicalDimension::NUMBER;
    let either = |a: PhysicalDimension, b: PhysicalDimension| match [a.kind(), b.kind()] {
        [Kind::Length, _] => a,
        [_, Kind::Length] => b,
        _ if a == b => a,
        _ => PhysicalDimension::NUMBER,
    };
    let parts = parts.into_iter().filter(measured);
    parts.reduce(either).unwrap_or_default()
}

/// Whether a formula is an angle by itself, where no position tells: one of its terms is an angle, and none is anything else. `pi`
/// alone makes a number an angle only where one is expected.
pub fn is_angle_by_itself(node: &FormulaNode, of_name: DimensionOfName) -> bool {
    let angle = PhysicalDimension::of(Kind::Angle);
    let (mut found, mut others) = (false, false);
    visit_terms(node, &mut |term| {
        let dimension = dimension_of(term, of_name);
        found |= dimension == angle && !has_plain_angles(term, of_name);
        others |= dimension != angle && dimension != PhysicalDimension::NUMBER;
    });
    found && !others
}

/// Whether numbers stand beside an angle in a sum: one of its terms is an angle, and none is a length. Terms of other dimensions,
/// such as products of angles, change nothing.
fn has_angle_term(node: &FormulaNode, of_name: DimensionOfName) -> bool {
    let (mut found, mut lengths) = (false, false);
    visit_terms(node, &mut |term| {
        let dimension = dimension_of(term, of_name);
        let is_angle = dimension == PhysicalDimension::of(Kind::Angle);
        found |= is_angle && !has_plain_angles(term, of_name);
        lengths |= dimension.kind() == Kind::Length;
    });
    found && !lengths
}

/// Whether the definition of a parameter makes it an angle: a sum of angles and mere numbers, a single term such as `pi/2`, or a
/// multiple of what has an explicit unit.
pub fn defines_angle(node: &FormulaNode, of_name: DimensionOfName) -> bool {
    let angle = PhysicalDimension::of(Kind::Angle);
    let (mut terms, mut others) = (0, false);
    visit_terms(node, &mut |term| {
        terms += 1;
        others |= dimension_of(term, of_name) != angle && !is_mere_number(term, of_name);
    });
    let is_known = !has_unknown(node, of_name) || !has_plain_angles(node, of_name);
    let is_single = terms == 1 && dimension_of(node, of_name) == angle && is_known;
    !others && (is_single || is_angle_by_itself(node, of_name))
}

/// Whether a formula consists of numbers, and parameters that are numbers, alone.
fn is_mere_number(node: &FormulaNode, of_name: DimensionOfName) -> bool {
    let is_mere = |node: &FormulaNode| is_mere_number(node, of_name);
    let is_number = |dimension| dimension == PhysicalDimension::NUMBER;
    match &node.kind {
        NodeKind::Number(_) => true,
        NodeKind::Name(name) => of_name(name).is_none_or(is_number),
        NodeKind::Of(kind, _) => kind.is_none_or(|kind| kind == Kind::Number),
        NodeKind::Negate(inner) => is_mere(inner),
        NodeKind::Binary(_, a, b) => is_mere(a) && is_mere(b),
        NodeKind::Radians(_) | NodeKind::Derivative(_) => false,
        NodeKind::Call(function, args) => !gives_angle(*function) && args.iter().all(is_mere),
    }
}

/// Whether no unit is written in a formula and no name in it is an angle, so that only `pi` can make it one.
pub fn has_plain_angles(node: &FormulaNode, of_name: DimensionOfName) -> bool {
    let plain = |node: &FormulaNode| has_plain_angles(node, of_name);
    match &node.kind {
        NodeKind::Number(_) | NodeKind::Derivative(_) => true,
        NodeKind::Radians(value) => *value == Constant::PI,
        NodeKind::Of(kind, _) => *kind != Some(Kind::Angle),
        NodeKind::Name(name) => !of_name(name).is_some_and(PhysicalDimension::holds_angle),
        NodeKind::Negate(inner) => plain(inner),
        NodeKind::Binary(_, a, b) => plain(a) && plain(b),
        NodeKind::Call(function, args) => !gives_angle(*function) && args.iter().all(plain),
    }
}

/// Whether nothing is known of a name in a formula.
pub fn has_unknown(node: &FormulaNode, of_name: DimensionOfName) -> bool {
    let mut unknown = false;
    node.visit_names(&mut |name, _| unknown |= of_name(name).is_none());
    unknown
}

/// The kind in which a formula that no position tells the kind of is converted; `None` if numbers in it may stand beside angles.
pub fn own_kind(node: &FormulaNode, of_name: DimensionOfName) -> Option<Kind> {
    let kind = dimension_of(node, of_name).kind();
    (kind == Kind::Length).then_some(kind)
}

/// Calls `visit` on everything that is added or compared in a formula.
pub fn visit_terms(node: &FormulaNode, visit: &mut dyn FnMut(&FormulaNode)) {
    match &node.kind {
        NodeKind::Negate(inner) => visit_terms(inner, visit),
        NodeKind::Binary('+' | '-', a, b) => {
            visit_terms(a, visit);
            visit_terms(b, visit);
        }
        NodeKind::Call(_, args) if is_sum(&node.kind) => {
            args.iter().for_each(|arg| visit_terms(arg, visit));
        }
        _ => visit(node),
    }
}

/// Converts angles from the file's unit to radians: `radians` is the size of one unit, `of_name` tells what names measure.
pub fn to_radians(
    node: FormulaNode,
    wanted: Option<Kind>,
    radians: Constant,
    of_name: DimensionOfName,
) -> FormulaNode {
    if radians == Constant::exact(1.0) {
        return node;
    }
    AngleConversion { radians, of_name }.converted(node, Expected::of(wanted))
}

/// What a plain number is in a place of a formula.
#[derive(Clone, Copy, PartialEq)]
enum Expected {
    /// An angle in the file's unit, and so is everything without an angle.
    Angle,
    /// An angle in the file's unit if it is a mere number: it stands beside angles.
    BesideAngles,
    /// The same if it is written out: it stands beside angles and what is none, such as products of angles.
    BesideOthers,
    /// A number, but in a sum that is an angle by itself: a factor, or the base of a power.
    Factor,
    /// A number, and so are the numbers added to it.
    Number,
    /// What its surroundings make it.
    Open,
}

impl Expected {
    fn of(wanted: Option<Kind>) -> Self {
        match wanted {
            None => Self::Open,
            Some(Kind::Angle) => Self::Angle,
            Some(Kind::Length | Kind::Number) => Self::Number,
        }
    }
}

struct AngleConversion<'a> {
    radians: Constant,
    of_name: DimensionOfName<'a>,
}

impl AngleConversion<'_> {
    fn converted(&self, node: FormulaNode, expected: Expected) -> FormulaNode {
        let is_a_sum = is_sum(&node.kind);
        let expected = match expected {
            Expected::Open if is_a_sum => self.expected_in_sum(&node),
            Expected::Factor if is_a_sum => match is_angle_by_itself(&node, self.of_name) {
                true => Expected::BesideAngles,
                false if has_angle_term(&node, self.of_name) => Expected::BesideOthers,
                false => Expected::Number,
            },
            expected => expected,
        };
        let is_number = match expected {
            Expected::Angle => !is_a_sum && !self.holds_angle(&node),
            Expected::BesideAngles => !is_a_sum && is_mere_number(&node, self.of_name),
            Expected::BesideOthers => !is_a_sum && is_literal(&node),
            Expected::Factor | Expected::Number | Expected::Open => false,
        };
        // It is in the file's unit, and is multiplied once, as a whole.
        if is_number {
            let span = node.span.clone();
            let factor = Box::new(FormulaNode::number(self.radians, span.clone()));
            let inner = Box::new(self.converted(node, Expected::Number));
            return FormulaNode {
                kind: NodeKind::Binary('*', inner, factor),
                span,
            };
        }
        let boxed = |node: Box<FormulaNode>, expected| Box::new(self.converted(*node, expected));
        let kind = match node.kind {
            NodeKind::Negate(inner) => NodeKind::Negate(boxed(inner, expected)),
            NodeKind::Of(kind, inner) => NodeKind::Of(kind, boxed(inner, Expected::of(kind))),
            NodeKind::Binary(sign @ ('+' | '-'), a, b) => {
                NodeKind::Binary(sign, boxed(a, expected), boxed(b, expected))
            }
            NodeKind::Binary(sign, a, b) => {
                let inner = match expected {
                    Expected::Open => expected,
                    _ => Expected::Factor,
                };
                // A multiple of a sum is what the sum is: `1*(phi + 30)`.
                let multiple = |other: &FormulaNode, own: &FormulaNode, may: bool| {
                    may && is_literal(other) && is_multiple_of_sum(own)
                };
                let of_a = match multiple(&b, &a, sign != '^') {
                    true => expected,
                    false => inner,
                };
                let of_b = match multiple(&a, &b, sign == '*') {
                    true => expected,
                    false => inner,
                };
                NodeKind::Binary(sign, boxed(a, of_a), boxed(b, of_b))
            }
            NodeKind::Call(function, args) => {
                let inner = match function {
                    // `sin(30)` is that of an angle, but `sin(s/R)` that of a ratio.
                    Function::Sin | Function::Cos | Function::Tan => Expected::BesideAngles,
                    _ if is_a_sum => expected,
                    _ => Expected::Open,
                };
                let args = args.into_iter().map(|arg| self.converted(arg, inner));
                NodeKind::Call(function, args.collect())
            }
            leaf => leaf,
        };
        FormulaNode {
            kind,
            span: node.span,
        }
    }

    /// What numbers are in a sum in a position that does not tell: a sum of lengths, or without an angle, is no sum of angles.
    fn expected_in_sum(&self, node: &FormulaNode) -> Expected {
        if is_angle_by_itself(node, self.of_name) {
            return Expected::BesideAngles;
        }
        if has_angle_term(node, self.of_name) {
            return Expected::BesideOthers;
        }
        let mut is_measured = false;
        visit_terms(node, &mut |term| {
            is_measured |= dimension_of(term, self.of_name) != PhysicalDimension::NUMBER;
        });
        match is_measured {
            true => Expected::Number,
            false => Expected::Open,
        }
    }

    fn holds_angle(&self, node: &FormulaNode) -> bool {
        match &node.kind {
            NodeKind::Number(_) | NodeKind::Derivative(_) => false,
            NodeKind::Radians(_) => true,
            NodeKind::Of(kind, _) => *kind == Some(Kind::Angle),
            NodeKind::Name(name) => {
                (self.of_name)(name).is_some_and(PhysicalDimension::holds_angle)
            }
            NodeKind::Negate(inner) => self.holds_angle(inner),
            NodeKind::Binary(_, a, b) => self.holds_angle(a) || self.holds_angle(b),
            NodeKind::Call(function, args) => match function {
                _ if gives_angle(*function) => true,
                Function::Sin | Function::Cos | Function::Tan => false,
                _ => args.iter().any(|arg| self.holds_angle(arg)),
            },
        }
    }
}

/// Whether a formula is a sum, or one times or over a number.
fn is_multiple_of_sum(node: &FormulaNode) -> bool {
    match &node.kind {
        NodeKind::Binary('*', a, b) if is_literal(a) => is_multiple_of_sum(b),
        NodeKind::Binary('*' | '/', a, b) if is_literal(b) => is_multiple_of_sum(a),
        kind => is_sum(kind),
    }
}

/// Functions whose values are angles.
fn gives_angle(function: Function) -> bool {
    use Function::{Acos, Asin, Atan, Atan2};
    matches!(function, Asin | Acos | Atan | Atan2)
}

/// Operations whose operands all have the kind of the result.
fn is_sum(kind: &NodeKind) -> bool {
    match kind {
        NodeKind::Negate(_) | NodeKind::Binary('+' | '-', ..) => true,
        NodeKind::Call(function, _) => {
            argument_kind(*function, Some(Kind::Length)) == Some(Kind::Length)
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::compile::{CompiledValue, compile_formula};
    use super::super::expression::parse_expression;
    use super::*;

    /// Value of `text` in the position of an angle, in a file in degrees, where `a` is an angle of 1 rad and `n` is 3.
    fn in_degrees(text: &str) -> f64 {
        let node = to_radians(
            parse_expression(text, 0).unwrap(),
            Some(Kind::Angle),
            Constant::PI / Constant::exact(180.0),
            &|n| (n == "a").then_some(PhysicalDimension::of(Kind::Angle)),
        );
        let lookup = |name: &str, _: &Span| {
            Ok(CompiledValue::Constant(Constant::exact(if name == "a" {
                1.0
            } else {
                3.0
            })))
        };
        compile_formula(&node, &lookup).unwrap().value(&[])
    }

    #[test]
    fn numbers_in_angle_places_are_degrees_and_others_are_not() {
        let degree = std::f64::consts::PI / 180.0;
        for (text, radians) in [
            ("90", 90.0 * degree),
            ("180 - a", 180.0 * degree - 1.0),
            ("2*a", 2.0),
            ("n*15", 45.0 * degree),
            ("pi/2", 90.0 * degree),
            ("30rad", 30.0),
            ("atan2(1, 1)", 45.0 * degree),
            ("2*sin(30)", 2.0 * 0.5 * degree),
            ("-(n + 10)", -13.0 * degree),
            // A sum with an angle is one, in a product as well.
            ("2*(a - 10)", 2.0 * (1.0 - 10.0 * degree)),
            ("(max(a, 5) - 10)/2", 0.5 * (1.0 - 10.0 * degree)),
            ("n*(10 + 20)", 90.0 * degree),
        ] {
            assert!(
                (in_degrees(text) - radians).abs() < 1e-12,
                "{text}: {} {radians}",
                in_degrees(text)
            );
        }
    }

    #[test]
    fn kinds_follow_from_places() {
        let mut seen = Vec::new();
        infer_kind(
            &parse_expression("a + 2*b - c*d + sin(e)", 0).unwrap(),
            Some(Kind::Length),
            &mut |n, k, _| seen.push((n.to_owned(), k)),
        );
        let want = [("a", Kind::Length), ("b", Kind::Length), ("e", Kind::Angle)];
        assert_eq!(seen, want.map(|(n, k)| (n.to_owned(), k)));
    }
}
