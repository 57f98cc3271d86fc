//! Infers the kinds (length, angle, number) of the parts of a formula, and converts its numbers from the file's angle
//! unit to radians.
//!
//! Rule: where an angle is expected, a part that contains no angle itself (`Ry(180)`, `beta + 30`) is in the file's angle
//! unit. An angle is expected where the position says so, and beside the angles of a sum. In a file in radians nothing is
//! converted.

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
        NodeKind::Of(kind, inner) => infer_kind(inner, Some(*kind), note),
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
        NodeKind::Of(kind, _) => PhysicalDimension::of(*kind),
        NodeKind::Name(name) => of_name(name).unwrap_or_default(),
        NodeKind::Negate(inner) => of(inner),
        // Sums have the dimension of their first term that has one; products add dimensions.
        NodeKind::Binary('+' | '-', a, b) => first_measured([of(a), of(b)]),
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
            Function::Asin | Function::Acos | Function::Atan | Function::Atan2 => {
                PhysicalDimension::of(Kind::Angle)
            }
            Function::Abs | Function::Min | Function::Max | Function::Mod | Function::Hypot => {
                first_measured(args.iter().map(of))
            }
            Function::Sqrt => of(&args[0]).half_powers(),
            _ => PhysicalDimension::NUMBER,
        },
    }
}

/// Among terms that are added or compared, the first that is not a plain number, as in `x + 3`.
fn first_measured(parts: impl IntoIterator<Item = PhysicalDimension>) -> PhysicalDimension {
    let mut measured = parts
        .into_iter()
        .filter(|part| *part != PhysicalDimension::NUMBER);
    measured.next().unwrap_or_default()
}

/// Whether a formula is an angle by itself, wherever it stands: all its terms are angles or plain numbers, and one is an
/// angle.
pub fn is_angle_by_itself(node: &FormulaNode, of_name: DimensionOfName) -> bool {
    let angle = PhysicalDimension::of(Kind::Angle);
    let (mut found, mut others) = (false, false);
    visit_terms(node, &mut |term| {
        let dimension = dimension_of(term, of_name);
        found |= dimension == angle;
        others |= dimension != angle && dimension != PhysicalDimension::NUMBER;
    });
    found && !others
}

/// Whether no unit is written in a formula and no name in it is an angle, so that only `pi` can make it one.
pub fn has_plain_angles(node: &FormulaNode, of_name: DimensionOfName) -> bool {
    let plain = |node: &FormulaNode| has_plain_angles(node, of_name);
    match &node.kind {
        NodeKind::Number(_) | NodeKind::Derivative(_) => true,
        NodeKind::Radians(value) => *value == Constant::PI,
        NodeKind::Of(kind, _) => *kind != Kind::Angle,
        NodeKind::Name(name) => of_name(name) != Some(PhysicalDimension::of(Kind::Angle)),
        NodeKind::Negate(inner) => plain(inner),
        NodeKind::Binary(_, a, b) => plain(a) && plain(b),
        NodeKind::Call(_, args) => args.iter().all(plain),
    }
}

/// The kind in which a formula that no position tells the kind of is converted: its own. In a sum of lengths and angles numbers
/// are plain, in any order.
pub fn own_kind(node: &FormulaNode, of_name: DimensionOfName) -> Option<Kind> {
    match dimension_of(node, of_name).kind() {
        Kind::Angle if !is_angle_by_itself(node, of_name) => None,
        kind => Some(kind),
    }
}

/// Calls `visit` on everything that is added or compared in a formula.
fn visit_terms(node: &FormulaNode, visit: &mut dyn FnMut(&FormulaNode)) {
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
    AngleConversion { radians, of_name }.converted(node, wanted)
}

struct AngleConversion<'a> {
    radians: Constant,
    of_name: DimensionOfName<'a>,
}

impl AngleConversion<'_> {
    fn converted(&self, node: FormulaNode, wanted: Option<Kind>) -> FormulaNode {
        let is_sum = is_sum(&node.kind);
        // A sum of angles is one in every position that does not tell.
        let wanted = match wanted {
            None if is_sum && is_angle_by_itself(&node, self.of_name) => Some(Kind::Angle),
            wanted => wanted,
        };
        // An angle is wanted and a plain number found: it is in the file's unit, and is multiplied once, as a whole.
        if wanted == Some(Kind::Angle) && !is_sum && !self.holds_angle(&node) {
            let span = node.span.clone();
            let factor = Box::new(FormulaNode::number(self.radians, span.clone()));
            let inner = Box::new(self.converted(node, None));
            return FormulaNode {
                kind: NodeKind::Binary('*', inner, factor),
                span,
            };
        }
        let boxed = |node: Box<FormulaNode>, kind| Box::new(self.converted(*node, kind));
        // Terms of a sum are of the kind of the sum, and factors are plain or tell their own.
        let kind = match node.kind {
            NodeKind::Negate(inner) => NodeKind::Negate(boxed(inner, wanted)),
            NodeKind::Of(kind, inner) => NodeKind::Of(kind, boxed(inner, Some(kind))),
            NodeKind::Binary(sign @ ('+' | '-'), a, b) => {
                NodeKind::Binary(sign, boxed(a, wanted), boxed(b, wanted))
            }
            NodeKind::Binary(sign, a, b) => NodeKind::Binary(sign, boxed(a, None), boxed(b, None)),
            NodeKind::Call(function, args) => {
                let inner = argument_kind(function, wanted);
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

    fn holds_angle(&self, node: &FormulaNode) -> bool {
        match &node.kind {
            NodeKind::Number(_) | NodeKind::Derivative(_) => false,
            NodeKind::Radians(_) => true,
            NodeKind::Of(kind, _) => *kind == Kind::Angle,
            NodeKind::Name(name) => {
                (self.of_name)(name).is_some_and(PhysicalDimension::holds_angle)
            }
            NodeKind::Negate(inner) => self.holds_angle(inner),
            NodeKind::Binary(_, a, b) => self.holds_angle(a) || self.holds_angle(b),
            NodeKind::Call(function, args) => match function {
                Function::Asin | Function::Acos | Function::Atan | Function::Atan2 => true,
                Function::Sin | Function::Cos | Function::Tan => false,
                _ => args.iter().any(|arg| self.holds_angle(arg)),
            },
        }
    }
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
