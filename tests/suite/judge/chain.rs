//! Chains as typed, expanded to elementary parts, and the frames that they lead to.

use super::formula::{Node, Reader};
use super::number::{Number, Precise};
use super::value::Formula;
use std::collections::HashMap;

/// A factor of a chain as typed.
#[derive(Clone, Debug)]
pub enum Item {
    Part(Part),
    Name(String),
    Inverse(Vec<Item>),
}

/// One motion, with its argument.
#[derive(Clone, Debug)]
pub enum Part {
    Shift(usize, Node),
    Turn(usize, Node),
    /// A turn about a constant direction.
    About([Node; 3], Node),
    /// A turn with so much advance per turn.
    Screw(usize, Node, Node),
}

pub type Chains = HashMap<String, Vec<Item>>;

/// Reads `T12 Tx(r) inv(T45)`.
pub fn parse(text: &str) -> Vec<Item> {
    let mut reader = Reader::new(text);
    let items = items(&mut reader);
    assert!(
        reader.rest().is_empty(),
        "`{}` is left of `{text}`",
        reader.rest()
    );
    items
}

fn items(reader: &mut Reader) -> Vec<Item> {
    let mut all = Vec::new();
    while let Some(name) = reader.name() {
        if reader.sign(&['(']).is_none() {
            all.extend((name != "E").then(|| Item::Name(name.to_owned())));
        } else if name == "inv" {
            all.push(Item::Inverse(items(reader)));
            reader.must(')');
        } else {
            all.extend(
                transform(name, reader.arguments())
                    .into_iter()
                    .map(Item::Part),
            );
        }
        reader.sign(&['*', '·', '×']);
    }
    all
}

fn transform(name: &str, arguments: Vec<Node>) -> Vec<Part> {
    let (motion, axis) = name.split_at(1);
    let axis = ["x", "y", "z"].iter().position(|a| *a == axis);
    match (motion, axis, arguments.as_slice()) {
        ("T", Some(axis), [length]) => vec![Part::Shift(axis, length.clone())],
        ("R", Some(axis), [angle]) => vec![Part::Turn(axis, angle.clone())],
        ("T", None, [_, _, _]) => arguments
            .into_iter()
            .enumerate()
            .map(|(k, a)| Part::Shift(k, a))
            .collect(),
        ("R", None, [x, y, z, angle]) => {
            vec![Part::About([x, y, z].map(Clone::clone), angle.clone())]
        }
        ("H", Some(axis), [pitch, angle]) => vec![Part::Screw(axis, pitch.clone(), angle.clone())],
        _ => panic!("no transform {name} of {}", arguments.len()),
    }
}

/// Appends the parts of `items`; `inverted` means those of the inverse product.
pub fn expand(items: &[Item], chains: &Chains, inverted: bool, parts: &mut Vec<Part>) {
    let ordered: Vec<&Item> = match inverted {
        true => items.iter().rev().collect(),
        false => items.iter().collect(),
    };
    for item in ordered {
        match item {
            Item::Part(part) if inverted => parts.push(inverse(part)),
            Item::Part(part) => parts.push(part.clone()),
            Item::Inverse(inner) => expand(inner, chains, !inverted, parts),
            Item::Name(name) => expand(&chains[name], chains, inverted, parts),
        }
    }
}

fn inverse(part: &Part) -> Part {
    let negative = |node: &Node| Node::Negative(Box::new(node.clone()));
    match part {
        Part::Shift(axis, length) => Part::Shift(*axis, negative(length)),
        Part::Turn(axis, angle) => Part::Turn(*axis, negative(angle)),
        Part::About(direction, angle) => Part::About(direction.clone(), negative(angle)),
        Part::Screw(axis, pitch, angle) => Part::Screw(*axis, pitch.clone(), negative(angle)),
    }
}

/// A part over numbered coordinates.
#[derive(Clone, Debug)]
pub struct Step {
    pub motion: Motion,
    pub argument: Formula,
    /// Sine and cosine of a constant angle.
    pub known: Option<[Precise; 2]>,
}

#[derive(Clone, Debug)]
pub enum Motion {
    Shift(usize),
    Turn(usize),
    About([Precise; 3]),
    /// The pitch is an advance per turn.
    Screw(usize, Formula),
}

impl Step {
    pub fn new(motion: Motion, argument: Formula) -> Self {
        let angle = argument
            .constant()
            .filter(|_| !matches!(motion, Motion::Shift(_)));
        let known = angle.map(|a| <[Precise; 2]>::from(a.sin_cos()));
        Self {
            motion,
            argument,
            known,
        }
    }
}

/// Where a frame stands: the columns of its rotation, and its origin.
#[derive(Clone)]
pub struct Frame<N> {
    pub columns: [[N; 3]; 3],
    pub origin: [N; 3],
}

impl<N: Number> Frame<N> {
    /// The frame at the end of a chain.
    pub fn at(steps: &[Step], coordinates: &[N]) -> Self {
        let of = |v: f64| N::of_precise(&Precise::of(v));
        let unit = |k: usize| [0, 1, 2].map(|i| of(f64::from(u8::from(i == k))));
        let mut frame = Self {
            columns: [0, 1, 2].map(unit),
            origin: [0.0; 3].map(of),
        };
        steps.iter().for_each(|step| frame.go(step, coordinates));
        frame
    }

    fn go(&mut self, step: &Step, coordinates: &[N]) {
        let argument = || step.argument.at(coordinates);
        let sin_cos = || match &step.known {
            Some([sine, cosine]) => (N::of_precise(sine), N::of_precise(cosine)),
            None => argument().sin_cos(),
        };
        match &step.motion {
            Motion::Shift(axis) => self.shift(*axis, &argument()),
            Motion::Turn(axis) => self.turn(*axis, sin_cos()),
            Motion::About(direction) => self.about(direction, sin_cos()),
            Motion::Screw(axis, pitch) => {
                let turns = argument()
                    .over(&N::of_precise(&Precise::pi()))
                    .over(&N::of_precise(&Precise::of(2.0)));
                self.shift(*axis, &turns.times(&pitch.at(coordinates)));
                self.turn(*axis, sin_cos());
            }
        }
    }

    fn shift(&mut self, axis: usize, length: &N) {
        for (place, direction) in self.origin.iter_mut().zip(&self.columns[axis]) {
            *place = place.plus(&direction.times(length));
        }
    }

    fn turn(&mut self, axis: usize, (sine, cosine): (N, N)) {
        let (first, second) = ((axis + 1) % 3, (axis + 2) % 3);
        for i in 0..3 {
            let (a, b) = (
                self.columns[first][i].clone(),
                self.columns[second][i].clone(),
            );
            self.columns[first][i] = a.times(&cosine).plus(&b.times(&sine));
            self.columns[second][i] = b.times(&cosine).minus(&a.times(&sine));
        }
    }

    /// Rodrigues: each row v of the rotation becomes v cos + (v × u) sin + u (u·v)(1 - cos), its transpose turning back.
    fn about(&mut self, direction: &[Precise; 3], (sine, cosine): (N, N)) {
        let u = direction.each_ref().map(N::of_precise);
        let versed = N::of_precise(&Precise::of(1.0)).minus(&cosine);
        for i in 0..3 {
            let v = [0, 1, 2].map(|k| self.columns[k][i].clone());
            let along = dot(&u, &v).times(&versed);
            let across = cross(&v, &u);
            for k in 0..3 {
                let turned = v[k].times(&cosine).plus(&across[k].times(&sine));
                self.columns[k][i] = turned.plus(&u[k].times(&along));
            }
        }
    }
}

pub fn dot<N: Number>(a: &[N; 3], b: &[N; 3]) -> N {
    let [x, y, z] = [0, 1, 2].map(|k| a[k].times(&b[k]));
    x.plus(&y).plus(&z)
}

pub fn cross<N: Number>(a: &[N; 3], b: &[N; 3]) -> [N; 3] {
    [0, 1, 2].map(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        a[i].times(&b[j]).minus(&a[j].times(&b[i]))
    })
}

/// The direction with length one.
pub fn normalised(v: [Precise; 3]) -> [Precise; 3] {
    let length = dot(&v, &v).root();
    v.map(|c| c.over(&length))
}
