//! Sums of products of sines, cosines and lengths: the entries of a product of transforms.

use std::collections::BTreeMap;

/// A part of a chain's argument with its sign: `gamma` and `-phi` of `gamma - phi`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct SignedName {
    /// The text without sign.
    pub text: String,
    /// Which of the notation's arguments it is.
    pub argument: usize,
    /// How often it is added.
    pub count: i64,
}

/// A sum of angles, each name once.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct AngleSum(pub Vec<SignedName>);

impl AngleSum {
    /// Adds a name; the sum may cancel it.
    pub fn add(&mut self, name: SignedName) {
        match self.0.iter_mut().find(|known| known.text == name.text) {
            Some(known) => known.count += name.count,
            None => self.0.push(name),
        }
        self.0.retain(|name| name.count != 0);
    }

    /// The sum with a positive first name, and the sign that it had.
    fn oriented(&self) -> (Self, f64) {
        match self.0.first() {
            Some(first) if first.count < 0 => {
                let negated = self.0.iter().map(|name| SignedName {
                    count: -name.count,
                    ..name.clone()
                });
                (Self(negated.collect()), -1.0)
            }
            _ => (self.clone(), 1.0),
        }
    }
}

/// A factor of a product.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Symbol {
    /// A length by its name.
    Length(SignedName),
    /// Cosine of a sum of angles.
    Cos(AngleSum),
    /// Sine of a sum of angles.
    Sin(AngleSum),
}

/// A sum of products, each with its coefficient.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SymbolSum {
    terms: BTreeMap<Vec<Symbol>, f64>,
}

/// Coefficients below this are rounding of the zeros and ones of constant turns.
const NOTHING: f64 = 1e-14;

impl SymbolSum {
    /// A number.
    pub fn number(value: f64) -> Self {
        Self::product(Vec::new(), value)
    }

    fn product(mut symbols: Vec<Symbol>, coefficient: f64) -> Self {
        symbols.sort();
        let mut sum = Self::default();
        sum.add_term(symbols, coefficient);
        sum
    }

    /// A length.
    pub fn length(name: SignedName) -> Self {
        let coefficient = name.count as f64;
        Self::product(
            vec![Symbol::Length(SignedName { count: 1, ..name })],
            coefficient,
        )
    }

    /// Cosine and sine of a sum of angles.
    pub fn turn(angle: &AngleSum) -> [Self; 2] {
        if angle.0.is_empty() {
            return [Self::number(1.0), Self::default()];
        }
        let (angle, sign) = angle.oriented();
        [
            Self::product(vec![Symbol::Cos(angle.clone())], 1.0),
            Self::product(vec![Symbol::Sin(angle)], sign),
        ]
    }

    fn add_term(&mut self, symbols: Vec<Symbol>, coefficient: f64) {
        let sum = self.terms.entry(symbols).or_insert(0.0);
        *sum += coefficient;
        if sum.abs() < NOTHING {
            self.terms.retain(|_, c| c.abs() >= NOTHING);
        }
    }

    /// The sum of both.
    pub fn plus(mut self, other: &Self) -> Self {
        for (symbols, coefficient) in &other.terms {
            self.add_term(symbols.clone(), *coefficient);
        }
        self
    }

    /// This times a number.
    pub fn scaled(&self, by: f64) -> Self {
        let mut sum = Self::default();
        for (symbols, coefficient) in &self.terms {
            sum.add_term(symbols.clone(), coefficient * by);
        }
        sum
    }

    /// The product of both.
    pub fn times(&self, other: &Self) -> Self {
        let mut sum = Self::default();
        for (a, x) in &self.terms {
            for (b, y) in &other.terms {
                let mut symbols = [a.as_slice(), b.as_slice()].concat();
                symbols.sort();
                sum.add_term(symbols, x * y);
            }
        }
        sum
    }

    /// Products with their coefficients, in a fixed order.
    pub fn terms(&self) -> impl ExactSizeIterator<Item = (&[Symbol], f64)> {
        self.terms
            .iter()
            .map(|(symbols, c)| (symbols.as_slice(), *c))
    }

    /// The value, given those of the arguments.
    pub fn value(&self, arguments: &[f64]) -> f64 {
        let angle = |sum: &AngleSum| {
            let parts = sum.0.iter().map(|n| n.count as f64 * arguments[n.argument]);
            parts.sum::<f64>()
        };
        let factor = |symbol: &Symbol| match symbol {
            Symbol::Length(name) => arguments[name.argument],
            Symbol::Cos(sum) => libm::cos(angle(sum)),
            Symbol::Sin(sum) => libm::sin(angle(sum)),
        };
        let term = |(symbols, c): (&[Symbol], f64)| c * symbols.iter().map(factor).product::<f64>();
        self.terms().map(term).sum()
    }
}
