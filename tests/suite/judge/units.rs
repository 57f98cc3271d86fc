//! What a name measures, and which parts of a formula are in the file's unit of angle: "a part of a formula that
//! stands where an angle is wanted and holds no angle itself".

use super::formula::Node;
use std::collections::HashMap;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    Length,
    Angle,
}

pub type Kinds = HashMap<String, Kind>;

/// Notes what the names in `node` measure if the whole is a `wanted`. What is known already stays.
pub fn note(node: &Node, wanted: Option<Kind>, kinds: &mut Kinds) {
    match node {
        Node::Number(_) | Node::Degrees(_) | Node::Radians(_) | Node::Pi => {}
        Node::Name(name) => {
            if let Some(kind) = wanted {
                kinds.entry(name.clone()).or_insert(kind);
            }
        }
        Node::Negative(inner) | Node::FileUnit(inner) => note(inner, wanted, kinds),
        Node::Binary('+' | '-', a, b) => {
            note(a, wanted, kinds);
            note(b, wanted, kinds);
        }
        Node::Binary(sign, a, b) => {
            // Times or over a plain number a quantity stays what it is; other products may be anything.
            note(a, wanted.filter(|_| *sign != '^' && is_plain(b)), kinds);
            note(b, wanted.filter(|_| *sign == '*' && is_plain(a)), kinds);
        }
        Node::Call(function, arguments) => {
            let inner = wanted_inside(function, wanted);
            arguments.iter().for_each(|a| note(a, inner, kinds));
        }
    }
}

/// What a function wants of its arguments where `wanted` is wanted of it.
fn wanted_inside(function: &str, wanted: Option<Kind>) -> Option<Kind> {
    match function {
        "sin" | "cos" | "tan" => Some(Kind::Angle),
        "abs" | "min" | "max" | "mod" | "hypot" => wanted,
        _ => None,
    }
}

fn is_plain(node: &Node) -> bool {
    match node {
        Node::Number(_) => true,
        Node::Negative(inner) => is_plain(inner),
        Node::Binary(_, a, b) => is_plain(a) && is_plain(b),
        _ => false,
    }
}

/// Marks the parts of `node` that are in the file's unit.
pub fn mark(node: Node, wanted: Option<Kind>, kinds: &Kinds) -> Node {
    let boxed = |n: Box<Node>, wanted| Box::new(mark(*n, wanted, kinds));
    let passes_on = match &node {
        Node::Negative(_) | Node::Binary('+' | '-', ..) => true,
        Node::Call(f, _) => wanted_inside(f, Some(Kind::Length)) == Some(Kind::Length),
        _ => false,
    };
    if wanted == Some(Kind::Angle) && !passes_on && !holds_angle(&node, kinds) {
        return Node::FileUnit(boxed(Box::new(node), None));
    }
    match node {
        Node::Negative(inner) => Node::Negative(boxed(inner, wanted)),
        Node::Binary(sign @ ('+' | '-'), a, b) => {
            Node::Binary(sign, boxed(a, wanted), boxed(b, wanted))
        }
        Node::Binary(sign, a, b) => Node::Binary(sign, boxed(a, None), boxed(b, None)),
        Node::Call(function, arguments) => {
            let inner = wanted_inside(&function, wanted);
            let arguments = arguments.into_iter().map(|a| mark(a, inner, kinds));
            Node::Call(function, arguments.collect())
        }
        leaf => leaf,
    }
}

fn holds_angle(node: &Node, kinds: &Kinds) -> bool {
    let holds = |n: &Node| holds_angle(n, kinds);
    match node {
        Node::Number(_) => false,
        Node::Degrees(_) | Node::Radians(_) | Node::Pi | Node::FileUnit(_) => true,
        Node::Name(name) => kinds.get(name) == Some(&Kind::Angle),
        Node::Negative(inner) => holds(inner),
        Node::Binary(_, a, b) => holds(a) || holds(b),
        Node::Call(function, arguments) => match function.as_str() {
            "asin" | "acos" | "atan" | "atan2" => true,
            "sin" | "cos" | "tan" => false,
            _ => arguments.iter().any(holds),
        },
    }
}
