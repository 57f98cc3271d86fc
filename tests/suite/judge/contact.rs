//! Contacts of surfaces as chains, from what docs/scene-format.md says of their unknowns: a frame in the contact point
//! with x along the normal, reached from both sides.

use super::chain::{Item, Part};
use super::formula::Node;

/// A surface with its sizes and the chain to its frame.
pub struct Side {
    pub shape: Shape,
    pub frame: Vec<Item>,
}

pub enum Shape {
    Torus { ring: Node, tube: Node },
    Cylinder { radius: Node },
    Sphere { radius: Node },
    Plane,
}

/// What must hold where two surfaces touch.
pub enum Closure {
    /// The product is the identity.
    Frame(Vec<Item>),
    /// The product leaves the origin where it is.
    Point(Vec<Item>),
    /// The origins are so far apart.
    Distance([Vec<Item>; 2], Node),
}

/// The closure of the contact `name`.
pub fn closure(name: &str, sides: &[Side; 2]) -> Closure {
    let frames = || sides.each_ref().map(|side| side.frame.clone());
    let half_turn = |axis| part(Part::Turn(axis, Node::Pi));
    match sides.each_ref().map(|side| &side.shape) {
        [Shape::Sphere { radius: a }, Shape::Sphere { radius: b }] => {
            Closure::Distance(frames(), sum(a, b))
        }
        [_, Shape::Sphere { radius }] => Closure::Point(to_centre(name, sides, 0, radius)),
        [Shape::Sphere { radius }, _] => Closure::Point(to_centre(name, sides, 1, radius)),
        [Shape::Plane, Shape::Plane] => {
            let [mut items, second] = frames();
            items.extend(slides(name, 0));
            items.extend([
                part(Part::Turn(2, unknown(name, "spin"))),
                half_turn(0),
                Item::Inverse(second),
            ]);
            Closure::Frame(items)
        }
        _ => {
            let mut items = to_surface(name, sides, 0, None);
            items.extend([part(Part::Turn(0, unknown(name, "spin"))), half_turn(1)]);
            items.push(Item::Inverse(to_surface(name, sides, 1, None)));
            Closure::Frame(items)
        }
    }
}

/// From the centre of a sphere of `radius` on `side` to the frame of the sphere.
fn to_centre(name: &str, sides: &[Side; 2], side: usize, radius: &Node) -> Vec<Item> {
    let mut items = vec![Item::Inverse(to_surface(name, sides, side, Some(radius)))];
    items.extend(sides[1 - side].frame.iter().cloned());
    items
}

/// From the world to a point of a surface, or so far beyond it; x along the outward normal.
fn to_surface(name: &str, sides: &[Side; 2], side: usize, beyond: Option<&Node>) -> Vec<Item> {
    let own = |what: &str| unknown(name, &format!("{what}{}", side + 1));
    let out = |size: &Node| {
        part(Part::Shift(
            0,
            beyond.map_or(size.clone(), |more| sum(size, more)),
        ))
    };
    let mut items = sides[side].frame.clone();
    match &sides[side].shape {
        Shape::Torus { ring, tube } => items.extend([
            part(Part::Turn(2, own("theta"))),
            part(Part::Shift(0, ring.clone())),
            part(Part::Turn(1, own("phi"))),
            out(tube),
        ]),
        Shape::Cylinder { radius } => {
            items.push(part(Part::Turn(2, own("theta"))));
            if !matches!(sides[1 - side].shape, Shape::Plane) {
                items.push(part(Part::Shift(2, own("w"))));
            }
            items.push(out(radius));
        }
        Shape::Plane => {
            // Its normal is z.
            items.extend(slides(name, side));
            items.push(part(Part::Turn(1, Node::Degrees("-90".to_owned()))));
            items.extend(beyond.map(|more| part(Part::Shift(0, more.clone()))));
        }
        Shape::Sphere { .. } => {}
    }
    items
}

fn slides(name: &str, side: usize) -> [Item; 2] {
    [("u", 0), ("v", 1)].map(|(what, axis)| {
        part(Part::Shift(
            axis,
            unknown(name, &format!("{what}{}", side + 1)),
        ))
    })
}

fn unknown(contact: &str, what: &str) -> Node {
    Node::Name(format!("{contact}.{what}"))
}

fn sum(a: &Node, b: &Node) -> Node {
    Node::Binary('+', Box::new(a.clone()), Box::new(b.clone()))
}

fn part(part: Part) -> Item {
    Item::Part(part)
}
