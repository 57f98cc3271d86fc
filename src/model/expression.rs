//! Compiled expressions: a straight list of operations over numbered slots, with values and exact gradients.
//!
//! Knows no names and no units: angles are radians, lengths are in the scene's unit. Sites that use an
//! expression say what its slots are (coordinates, time, or coordinates and derived scalars).

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
}

/// One operation; operands are the indices of earlier ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Op {
    /// A number.
    Constant(f64),
    /// The value of a slot.
    Slot(usize),
    /// Sign change.
    Negate(usize),
    /// Sum.
    Add(usize, usize),
    /// Difference.
    Subtract(usize, usize),
    /// Product.
    Multiply(usize, usize),
    /// Quotient.
    Divide(usize, usize),
    /// Power.
    Power(usize, usize),
    /// A function; the second operand repeats the first for functions of one argument.
    Call(Function, usize, usize),
}

impl Op {
    /// The same operation where its operands stand `by` places further on.
    pub fn shifted(self, by: usize) -> Self {
        match self {
            Self::Constant(_) | Self::Slot(_) => self,
            Self::Negate(a) => Self::Negate(a + by),
            Self::Add(a, b) => Self::Add(a + by, b + by),
            Self::Subtract(a, b) => Self::Subtract(a + by, b + by),
            Self::Multiply(a, b) => Self::Multiply(a + by, b + by),
            Self::Divide(a, b) => Self::Divide(a + by, b + by),
            Self::Power(a, b) => Self::Power(a + by, b + by),
            Self::Call(f, a, b) => Self::Call(f, a + by, b + by),
        }
    }
}

/// `constant + Σ coefficient·slot`.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Affine {
    /// Value with all slots at zero.
    pub constant: f64,
    /// Slots and their coefficients, ascending, none zero.
    pub terms: Vec<(usize, f64)>,
}

/// A compiled expression. The last operation is its value.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    ops: Vec<Op>,
}

impl Expression {
    /// An expression of the given operations, each of which refers only to earlier ones; empty means zero.
    pub fn new(ops: Vec<Op>) -> Self {
        debug_assert!(
            ops.iter()
                .enumerate()
                .all(|(i, op)| operands(*op).into_iter().flatten().all(|o| o < i))
        );
        Self { ops }
    }

    /// A number.
    pub fn constant(value: f64) -> Self {
        Self {
            ops: vec![Op::Constant(value)],
        }
    }

    /// The operations.
    pub fn ops(&self) -> &[Op] {
        &self.ops
    }

    /// Slots it depends on, ascending.
    pub fn slots(&self) -> Vec<usize> {
        let mut slots: Vec<_> = self
            .ops
            .iter()
            .filter_map(|op| if let Op::Slot(i) = op { Some(*i) } else { None })
            .collect();
        slots.sort_unstable();
        slots.dedup();
        slots
    }

    /// The value at `slots`. Not finite where the formula has no value (1/0, sqrt(-1)).
    pub fn value(&self, slots: &[f64]) -> f64 {
        let mut values = Vec::with_capacity(self.ops.len());
        self.value_with(slots, &mut values)
    }

    /// The value at `slots`, with `values` as scratch so that repeated calls do not allocate.
    pub fn value_with(&self, slots: &[f64], values: &mut Vec<f64>) -> f64 {
        values.clear();
        for op in &self.ops {
            let value = apply(*op, values, slots);
            values.push(value);
        }
        values.last().copied().unwrap_or(0.0)
    }

    /// The value, and `scale` times its gradient added to `gradient` (one entry per slot), by reverse accumulation.
    pub fn add_gradient(
        &self,
        slots: &[f64],
        scale: f64,
        gradient: &mut [f64],
        values: &mut Vec<f64>,
        adjoints: &mut Vec<f64>,
    ) -> f64 {
        let value = self.value_with(slots, values);
        adjoints.clear();
        adjoints.resize(self.ops.len(), 0.0);
        if let Some(last) = adjoints.last_mut() {
            *last = scale;
        }
        for (i, op) in self.ops.iter().enumerate().rev() {
            let adjoint = adjoints[i];
            if adjoint == 0.0 {
                continue;
            }
            if let Op::Slot(slot) = op {
                gradient[*slot] += adjoint;
            }
            let partials = partials(*op, values, values[i]);
            for (operand, partial) in operands(*op).into_iter().zip(partials) {
                if let Some(operand) = operand {
                    adjoints[operand] += adjoint * partial;
                }
            }
        }
        value
    }

    /// The affine form, if it has one.
    pub fn affine(&self) -> Option<Affine> {
        let mut forms: Vec<Affine> = Vec::with_capacity(self.ops.len());
        for op in &self.ops {
            forms.push(affine_of(*op, &forms)?);
        }
        Some(forms.pop().unwrap_or_default())
    }
}

fn operands(op: Op) -> [Option<usize>; 2] {
    match op {
        Op::Constant(_) | Op::Slot(_) => [None, None],
        Op::Negate(a) => [Some(a), None],
        Op::Add(a, b)
        | Op::Subtract(a, b)
        | Op::Multiply(a, b)
        | Op::Divide(a, b)
        | Op::Power(a, b) => [Some(a), Some(b)],
        Op::Call(f, a, b) => [Some(a), if f.accepts(2) { Some(b) } else { None }],
    }
}

fn apply(op: Op, v: &[f64], slots: &[f64]) -> f64 {
    match op {
        Op::Constant(c) => c,
        Op::Slot(i) => slots[i],
        Op::Negate(a) => -v[a],
        Op::Add(a, b) => v[a] + v[b],
        Op::Subtract(a, b) => v[a] - v[b],
        Op::Multiply(a, b) => v[a] * v[b],
        Op::Divide(a, b) => v[a] / v[b],
        Op::Power(a, b) => power(v[a], v[b]),
        Op::Call(f, a, b) => call(f, v[a], v[b]),
    }
}

/// Small whole exponents by multiplication: exact for squares, and defined for negative bases.
fn power(base: f64, exponent: f64) -> f64 {
    if exponent.fract() == 0.0 && exponent.abs() <= 16.0 {
        let mut result = 1.0;
        for _ in 0..exponent.abs() as u32 {
            result *= base;
        }
        if exponent < 0.0 { 1.0 / result } else { result }
    } else {
        libm::pow(base, exponent)
    }
}

fn call(f: Function, a: f64, b: f64) -> f64 {
    match f {
        Function::Sin => libm::sin(a),
        Function::Cos => libm::cos(a),
        Function::Tan => libm::tan(a),
        Function::Asin => libm::asin(a),
        Function::Acos => libm::acos(a),
        Function::Atan => libm::atan(a),
        Function::Atan2 => libm::atan2(a, b),
        Function::Sqrt => a.sqrt(),
        Function::Exp => libm::exp(a),
        Function::Ln => libm::log(a),
        Function::Abs => a.abs(),
        Function::Min => {
            if b < a {
                b
            } else {
                a
            }
        }
        Function::Max => {
            if b > a {
                b
            } else {
                a
            }
        }
        Function::Hypot => libm::hypot(a, b),
        Function::Mod => a - b * (a / b).floor(),
        Function::Floor => a.floor(),
    }
}

/// Partial derivatives with respect to the two operands; `r` is the operation's value.
fn partials(op: Op, v: &[f64], r: f64) -> [f64; 2] {
    match op {
        Op::Constant(_) | Op::Slot(_) => [0.0, 0.0],
        Op::Negate(_) => [-1.0, 0.0],
        Op::Add(..) => [1.0, 1.0],
        Op::Subtract(..) => [1.0, -1.0],
        Op::Multiply(a, b) => [v[b], v[a]],
        Op::Divide(_, b) => [1.0 / v[b], -r / v[b]],
        Op::Power(a, b) => {
            let by_base = if v[b] == 0.0 {
                0.0
            } else {
                v[b] * power(v[a], v[b] - 1.0)
            };
            let by_exponent = if v[a] > 0.0 { r * libm::log(v[a]) } else { 0.0 };
            [by_base, by_exponent]
        }
        Op::Call(f, a, b) => call_partials(f, v[a], v[b], r),
    }
}

fn call_partials(f: Function, a: f64, b: f64, r: f64) -> [f64; 2] {
    match f {
        Function::Sin => [libm::cos(a), 0.0],
        Function::Cos => [-libm::sin(a), 0.0],
        Function::Tan => [1.0 + r * r, 0.0],
        Function::Asin => [1.0 / (1.0 - a * a).sqrt(), 0.0],
        Function::Acos => [-1.0 / (1.0 - a * a).sqrt(), 0.0],
        Function::Atan => [1.0 / (1.0 + a * a), 0.0],
        Function::Atan2 => {
            let square = a * a + b * b;
            [b / square, -a / square]
        }
        Function::Sqrt => [0.5 / r, 0.0],
        Function::Exp => [r, 0.0],
        Function::Ln => [1.0 / a, 0.0],
        Function::Abs => [if a < 0.0 { -1.0 } else { 1.0 }, 0.0],
        Function::Min => {
            if b < a {
                [0.0, 1.0]
            } else {
                [1.0, 0.0]
            }
        }
        Function::Max => {
            if b > a {
                [0.0, 1.0]
            } else {
                [1.0, 0.0]
            }
        }
        Function::Hypot => [a / r, b / r],
        Function::Mod => [1.0, -(a / b).floor()],
        Function::Floor => [0.0, 0.0],
    }
}

fn affine_of(op: Op, forms: &[Affine]) -> Option<Affine> {
    let constant = |form: &Affine| form.terms.is_empty().then_some(form.constant);
    Some(match op {
        Op::Constant(c) => Affine {
            constant: c,
            terms: Vec::new(),
        },
        Op::Slot(i) => Affine {
            constant: 0.0,
            terms: vec![(i, 1.0)],
        },
        Op::Negate(a) => combine(&forms[a], -1.0, &Affine::default(), 0.0),
        Op::Add(a, b) => combine(&forms[a], 1.0, &forms[b], 1.0),
        Op::Subtract(a, b) => combine(&forms[a], 1.0, &forms[b], -1.0),
        Op::Multiply(a, b) => match (constant(&forms[a]), constant(&forms[b])) {
            (Some(c), _) => combine(&forms[b], c, &Affine::default(), 0.0),
            (_, Some(c)) => combine(&forms[a], c, &Affine::default(), 0.0),
            _ => return None,
        },
        Op::Divide(a, b) => {
            let divisor = constant(&forms[b])?;
            let scaled = |v: f64| v / divisor;
            Affine {
                constant: scaled(forms[a].constant),
                terms: forms[a]
                    .terms
                    .iter()
                    .map(|(s, c)| (*s, scaled(*c)))
                    .collect(),
            }
        }
        Op::Power(a, b) => {
            let value = power(constant(&forms[a])?, constant(&forms[b])?);
            Affine {
                constant: value,
                terms: Vec::new(),
            }
        }
        Op::Call(f, a, b) => {
            let value = call(f, constant(&forms[a])?, constant(&forms[b])?);
            Affine {
                constant: value,
                terms: Vec::new(),
            }
        }
    })
}

/// `x·a + y·b`, terms merged by slot and zeros dropped.
fn combine(a: &Affine, x: f64, b: &Affine, y: f64) -> Affine {
    let mut terms: Vec<(usize, f64)> = a.terms.iter().map(|(s, c)| (*s, x * c)).collect();
    for (slot, c) in &b.terms {
        match terms.iter_mut().find(|(s, _)| s == slot) {
            Some(term) => term.1 += y * c,
            None => terms.push((*slot, y * c)),
        }
    }
    terms.retain(|(_, c)| *c != 0.0);
    terms.sort_unstable_by_key(|(s, _)| *s);
    Affine {
        constant: x * a.constant + y * b.constant,
        terms,
    }
}

mod fault;

#[cfg(test)]
mod tests;
