//! Formulas over numbered coordinates and their values.

use super::formula::Node;
use super::number::{Number, Precise};

/// What a name stands for.
pub enum Meaning {
    Constant(Precise),
    Coordinate(usize),
}

/// A formula whose constants are known.
#[derive(Clone, Debug)]
pub enum Formula {
    Constant(Precise),
    Coordinate(usize),
    Negative(Box<Formula>),
    Binary(char, Box<Formula>, Box<Formula>),
    Power(Box<Formula>, i64),
    Call(String, Vec<Formula>),
}

impl Formula {
    /// Looks up names; `file_unit` is the size of the file's unit of angle in radians.
    pub fn new(node: &Node, file_unit: &Precise, lookup: &dyn Fn(&str) -> Meaning) -> Self {
        let boxed = |n: &Node| Box::new(Self::new(n, file_unit, lookup));
        let constant = |text: &str| Self::Constant(Precise::of_decimal(text));
        let formula = match node {
            Node::Number(text) | Node::Radians(text) => constant(text),
            Node::Degrees(text) => {
                let degree = Precise::pi().over(&Precise::of(180.0));
                Self::Constant(Precise::of_decimal(text).times(&degree))
            }
            Node::Pi => Self::Constant(Precise::pi()),
            Node::Name(name) => match lookup(name) {
                Meaning::Constant(value) => Self::Constant(value),
                Meaning::Coordinate(index) => Self::Coordinate(index),
            },
            Node::Negative(inner) => Self::Negative(boxed(inner)),
            Node::Binary('^', a, b) => match (boxed(a), boxed(b)) {
                (a, b) if b.whole().is_some() => Self::Power(a, b.whole().unwrap()),
                (a, b) => Self::Binary('^', a, b),
            },
            Node::Binary(sign, a, b) => Self::Binary(*sign, boxed(a), boxed(b)),
            Node::Call(function, arguments) => {
                let arguments = arguments.iter().map(|a| Self::new(a, file_unit, lookup));
                Self::Call(function.clone(), arguments.collect())
            }
            Node::FileUnit(inner) => {
                let unit = Box::new(Self::Constant(file_unit.clone()));
                Self::Binary('*', boxed(inner), unit)
            }
        };
        if formula.is_constant() {
            Self::Constant(formula.at::<Precise>(&[]))
        } else {
            formula
        }
    }

    /// The value of a constant formula.
    pub fn constant(&self) -> Option<&Precise> {
        match self {
            Self::Constant(value) => Some(value),
            _ => None,
        }
    }

    fn whole(&self) -> Option<i64> {
        let value = self.constant()?.rounded();
        (value.fract() == 0.0 && value.abs() <= 64.0).then_some(value as i64)
    }

    fn is_constant(&self) -> bool {
        match self {
            Self::Constant(_) => true,
            Self::Coordinate(_) => false,
            Self::Negative(a) | Self::Power(a, _) => a.is_constant(),
            Self::Binary(_, a, b) => a.is_constant() && b.is_constant(),
            Self::Call(_, all) => all.iter().all(Self::is_constant),
        }
    }

    /// The value at `coordinates`, angles in radians.
    pub fn at<N: Number>(&self, coordinates: &[N]) -> N {
        match self {
            Self::Constant(value) => N::of_precise(value),
            Self::Coordinate(index) => coordinates[*index].clone(),
            Self::Negative(inner) => inner.at(coordinates).negative(),
            Self::Power(base, exponent) => base.at(coordinates).raised(*exponent),
            Self::Binary(sign, a, b) => {
                let (a, b) = (a.at(coordinates), b.at(coordinates));
                match sign {
                    '+' => a.plus(&b),
                    '-' => a.minus(&b),
                    '*' => a.times(&b),
                    '/' => a.over(&b),
                    _ => a.ln().times(&b).exp(),
                }
            }
            Self::Call(function, all) => {
                let all: Vec<N> = all.iter().map(|a| a.at(coordinates)).collect();
                call(function, &all)
            }
        }
    }
}

fn call<N: Number>(function: &str, all: &[N]) -> N {
    let one = N::of_precise(&Precise::of(1.0));
    let x = &all[0];
    // sqrt(1 - x²) as a product, which keeps its digits at |x| = 1.
    let beside = || one.minus(x).times(&one.plus(x)).root();
    let lesser = |a: N, b: &N| if b.is_below(&a) { b.clone() } else { a };
    let greater = |a: N, b: &N| if a.is_below(b) { b.clone() } else { a };
    match (function, all.len()) {
        ("sin", 1) => x.sin_cos().0,
        ("cos", 1) => x.sin_cos().1,
        ("tan", 1) => {
            let (sine, cosine) = x.sin_cos();
            sine.over(&cosine)
        }
        ("asin", 1) => x.atan2(&beside()),
        ("acos", 1) => beside().atan2(x),
        ("atan", 1) => x.atan2(&one),
        ("atan2", 2) => x.atan2(&all[1]),
        ("sqrt", 1) => x.root(),
        ("exp", 1) => x.exp(),
        ("ln", 1) => x.ln(),
        ("abs", 1) if x.is_negative() => x.negative(),
        ("abs", 1) => x.clone(),
        ("floor", 1) => x.floor(),
        ("min", _) => all[1..].iter().fold(x.clone(), lesser),
        ("max", _) => all[1..].iter().fold(x.clone(), greater),
        ("hypot", 2) => x.times(x).plus(&all[1].times(&all[1])).root(),
        // The remainder has the sign of the divisor.
        ("mod", 2) => x.minus(&all[1].times(&x.over(&all[1]).floor())),
        _ => panic!("unknown function {function} of {}", all.len()),
    }
}
