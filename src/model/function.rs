//! The functions of formulas: their names, their values and their derivatives, for every kind of number.

use crate::numbers::scalar::Scalar;

/// Functions of the formula language.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum Function {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Atan2,
    Sqrt,
    Exp,
    Ln,
    Abs,
    Min,
    Max,
    Hypot,
    Mod,
    Floor,
}

impl Function {
    /// All of them, for messages and documentation.
    pub const ALL: [Self; 16] = [
        Self::Sin,
        Self::Cos,
        Self::Tan,
        Self::Asin,
        Self::Acos,
        Self::Atan,
        Self::Atan2,
        Self::Sqrt,
        Self::Exp,
        Self::Ln,
        Self::Abs,
        Self::Min,
        Self::Max,
        Self::Hypot,
        Self::Mod,
        Self::Floor,
    ];

    /// The name in formulas.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sin => "sin",
            Self::Cos => "cos",
            Self::Tan => "tan",
            Self::Asin => "asin",
            Self::Acos => "acos",
            Self::Atan => "atan",
            Self::Atan2 => "atan2",
            Self::Sqrt => "sqrt",
            Self::Exp => "exp",
            Self::Ln => "ln",
            Self::Abs => "abs",
            Self::Min => "min",
            Self::Max => "max",
            Self::Hypot => "hypot",
            Self::Mod => "mod",
            Self::Floor => "floor",
        }
    }

    /// The function of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|f| f.name() == name)
    }

    /// Whether it can be called with `count` arguments.
    pub const fn accepts(self, count: usize) -> bool {
        match self {
            Self::Atan2 | Self::Hypot | Self::Mod => count == 2,
            Self::Min | Self::Max => count >= 2,
            _ => count == 1,
        }
    }

    /// The number of arguments in words.
    pub const fn arity_text(self) -> &'static str {
        match self {
            Self::Atan2 | Self::Hypot | Self::Mod => "two arguments",
            Self::Min | Self::Max => "two or more arguments",
            _ => "one argument",
        }
    }

    /// The value at `a`, or at `a` and `b`.
    pub fn value<S: Scalar>(self, a: S, b: S) -> S {
        match self {
            Self::Sin => a.sin(),
            Self::Cos => a.cos(),
            Self::Tan => a.tan(),
            Self::Asin => a.asin(),
            Self::Acos => a.acos(),
            Self::Atan => a.atan(),
            Self::Atan2 => a.atan2(b),
            Self::Sqrt => a.sqrt(),
            Self::Exp => a.exp(),
            Self::Ln => a.ln(),
            Self::Abs => a.abs(),
            Self::Min => a.min(b),
            Self::Max => a.max(b),
            Self::Hypot => a.hypot(b),
            Self::Mod => a.modulo(b),
            Self::Floor => a.floor(),
        }
    }

    /// Partial derivatives by `a` and `b` where the value is `r`.
    pub fn partials<S: Scalar>(self, a: S, b: S, r: S) -> [S; 2] {
        let [zero, one] = [0.0, 1.0].map(S::number);
        let over_root = || one / (one - a.square()).sqrt();
        // Where the value itself appears in its derivative, `r` is used: d tan = 1 + tan², d √a = 1 / (2 √a).
        match self {
            Self::Sin => [a.cos(), zero],
            Self::Cos => [-a.sin(), zero],
            Self::Tan => [one + r.square(), zero],
            Self::Asin => [over_root(), zero],
            Self::Acos => [-over_root(), zero],
            Self::Atan => [one / (one + a.square()), zero],
            Self::Atan2 => {
                let square = a.square() + b.square();
                [b / square, -a / square]
            }
            Self::Sqrt => [S::number(0.5) / r, zero],
            Self::Exp => [r, zero],
            Self::Ln => [one / a, zero],
            // Functions with kinks take the derivative of the side that the operands are on.
            Self::Abs => [a.choose(-one, one), zero],
            // Where both are equal the maximum follows the one and the minimum the other: their sum is that of both.
            Self::Min => {
                let above = a - b;
                [above.choose(one, zero), above.choose(zero, one)]
            }
            Self::Max => {
                let above = a - b;
                [above.choose(zero, one), above.choose(one, zero)]
            }
            Self::Hypot => [a / r, b / r],
            Self::Mod => [one, -(a / b).floor()],
            Self::Floor => [zero, zero],
        }
    }
}
