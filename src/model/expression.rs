//! Compiled expressions: a straight list of operations over numbered slots, with values and exact gradients.
//!
//! Knows no names and no units: angles are radians, lengths are in the scene's unit. Sites that use an
//! expression say what its slots are (coordinates, time, or coordinates and derived scalars), and of which kind of
//! [`Scalar`]: numbers, series, enclosures.

pub use super::function::Function;
use crate::numbers::constant::Constant;
use crate::numbers::scalar::Scalar;
use crate::sorting::sort_by_key;

/// One operation; operands are the indices of earlier ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Op {
    /// A number.
    Constant(Constant),
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
        self.mapped(|k| k + by)
    }

    /// Calls `meet` with every operand.
    fn visit_operands(self, mut meet: impl FnMut(usize)) {
        self.mapped(|k| {
            meet(k);
            k
        });
    }

    /// The same operation of other operands.
    fn mapped(self, mut to: impl FnMut(usize) -> usize) -> Self {
        match self {
            Self::Constant(_) | Self::Slot(_) => self,
            Self::Negate(a) => Self::Negate(to(a)),
            Self::Add(a, b) => Self::Add(to(a), to(b)),
            Self::Subtract(a, b) => Self::Subtract(to(a), to(b)),
            Self::Multiply(a, b) => Self::Multiply(to(a), to(b)),
            Self::Divide(a, b) => Self::Divide(to(a), to(b)),
            Self::Power(a, b) => Self::Power(to(a), to(b)),
            Self::Call(f, a, b) => Self::Call(f, to(a), to(b)),
        }
    }
}

const ZERO: Constant = Constant::exact(0.0);
const ONE: Constant = Constant::exact(1.0);

/// `constant + Σ coefficient·slot`.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Affine {
    /// Value with all slots at zero.
    pub constant: Constant,
    /// Slots and their coefficients, ascending, none zero.
    pub terms: Vec<(usize, Constant)>,
}

impl Affine {
    /// Slots and the nearest f64 of their coefficients.
    pub fn numbers(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.terms.iter().map(|(slot, c)| (*slot, c.number()))
    }

    /// The value at `slots`.
    pub fn value<S: Scalar>(&self, slots: &[S]) -> S {
        let terms = self.terms.iter();
        terms.fold(S::from_constant(self.constant), |sum, (slot, c)| {
            sum + S::from_constant(*c) * slots[*slot]
        })
    }

    /// The same as an expression.
    pub fn formula(&self) -> Expression {
        let mut ops = vec![Op::Constant(self.constant)];
        for (slot, factor) in &self.terms {
            let sum = ops.len() - 1;
            ops.extend([
                Op::Constant(*factor),
                Op::Slot(*slot),
                Op::Multiply(sum + 1, sum + 2),
                Op::Add(sum, sum + 3),
            ]);
        }
        Expression::new(ops)
    }
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
                .all(|(i, op)| operand_places(*op).into_iter().flatten().all(|o| o < i))
        );
        Self { ops }
    }

    /// A number.
    pub fn constant(value: Constant) -> Self {
        Self {
            ops: vec![Op::Constant(value)],
        }
    }

    /// The operations.
    pub fn ops(&self) -> &[Op] {
        &self.ops
    }

    /// Slots that it uses outside of sine, cosine and tangent, which do not show how often an angle has turned.
    pub fn slots_outside_waves(&self) -> Vec<usize> {
        let mut is_met = vec![false; self.ops.len()];
        for op in &self.ops {
            if !matches!(
                op,
                Op::Call(Function::Sin | Function::Cos | Function::Tan, ..)
            ) {
                op.visit_operands(|k| is_met[k] = true);
            }
        }
        // The last operation is the value.
        is_met.last_mut().into_iter().for_each(|met| *met = true);
        let met = self.ops.iter().zip(is_met).filter(|(_, met)| *met);
        let slots = met.filter_map(|(op, _)| match op {
            Op::Slot(slot) => Some(*slot),
            _ => None,
        });
        slots.collect()
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

    /// The same with `slots`, which are all of its own, numbered in their order.
    pub fn renumbered_slots(&self, slots: &[usize]) -> Self {
        let ops = self.ops.iter().map(|op| match op {
            Op::Slot(slot) => Op::Slot(slots.partition_point(|s| s < slot)),
            op => *op,
        });
        Self { ops: ops.collect() }
    }

    /// The value at `slots`. Not finite where the formula has no value (1/0, sqrt(-1)).
    pub fn value<S: Scalar>(&self, slots: &[S]) -> S {
        let mut values = Vec::with_capacity(self.ops.len());
        self.value_with(slots, &mut values)
    }

    /// The value at `slots`, with `values` as scratch so that repeated calls do not allocate.
    pub fn value_with<S: Scalar>(&self, slots: &[S], values: &mut Vec<S>) -> S {
        values.clear();
        for op in &self.ops {
            let value = apply_op(*op, values, slots);
            values.push(value);
        }
        values.last().copied().unwrap_or(S::number(0.0))
    }

    /// The derivatives by all slots.
    pub fn gradient<S: Scalar>(&self, slots: &[S]) -> Vec<S> {
        let mut gradient = vec![S::number(0.0); slots.len()];
        let (one, mut values, mut adjoints) = (S::number(1.0), Vec::new(), Vec::new());
        self.add_gradient(slots, one, &mut gradient, &mut values, &mut adjoints);
        gradient
    }

    /// The value, and `scale` times its gradient added to `gradient` (one entry per slot), by reverse accumulation.
    pub fn add_gradient<S: Scalar>(
        &self,
        slots: &[S],
        scale: S,
        gradient: &mut [S],
        values: &mut Vec<S>,
        adjoints: &mut Vec<S>,
    ) -> S {
        let value = self.value_with(slots, values);
        adjoints.clear();
        adjoints.resize(self.ops.len(), S::number(0.0));
        if let Some(last) = adjoints.last_mut() {
            *last = scale;
        }
        for (i, op) in self.ops.iter().enumerate().rev() {
            let adjoint = adjoints[i];
            if adjoint == S::number(0.0) {
                continue;
            }
            if let Op::Slot(slot) = op {
                gradient[*slot] = gradient[*slot] + adjoint;
            }
            let partials = self.partials(i, values);
            for (operand, partial) in operand_places(*op).into_iter().zip(partials) {
                // Beside nothing an infinite slope is none: that of the root of `max(x, 0)` below zero. Beside a slope that is
                // zero only here it is unknown: that of the root of `x^2`.
                let is_flat = partial == S::number(0.0) && self.stays_flat(*op);
                if let Some(operand) = operand.filter(|_| !is_flat) {
                    adjoints[operand] = adjoints[operand] + adjoint * partial;
                }
            }
        }
        value
    }

    /// Partial derivatives of operation `i` by its two operands; `v` are the values of all operations.
    fn partials<S: Scalar>(&self, i: usize, v: &[S]) -> [S; 2] {
        let [zero, one] = [0.0, 1.0].map(S::number);
        match self.ops[i] {
            Op::Constant(_) | Op::Slot(_) => [zero, zero],
            Op::Negate(_) => [-one, zero],
            Op::Add(..) => [one, one],
            Op::Subtract(..) => [one, -one],
            Op::Multiply(a, b) => [v[b], v[a]],
            Op::Divide(_, b) => [one / v[b], -v[i] / v[b]],
            Op::Power(a, b) => {
                let by_exponent = match self.ops[b] {
                    Op::Constant(_) => zero,
                    _ => v[i] * v[a].slope_by_exponent(),
                };
                [power_slope(v[a], v[b]), by_exponent]
            }
            Op::Call(f, a, b) => f.partials(v[a], v[b], v[i]),
        }
    }

    /// Whether a slope of zero is not zero only here: the operation selects an operand or a number, or multiplies by a constant.
    fn stays_flat(&self, op: Op) -> bool {
        use Function::{Floor, Max, Min, Mod};
        let is_constant = |k: usize| matches!(self.ops[k], Op::Constant(_));
        match op {
            Op::Multiply(a, b) => is_constant(a) || is_constant(b),
            op => matches!(op, Op::Call(Floor | Max | Min | Mod, ..)),
        }
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

fn operand_places(op: Op) -> [Option<usize>; 2] {
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

/// The value of an operation; unknown if an operand may have none, whatever the operation would make of it.
fn apply_op<S: Scalar>(op: Op, v: &[S], slots: &[S]) -> S {
    let lacks = |k: usize| v[k].may_lack_value();
    let may_lack = match op {
        Op::Divide(_, b) => lacks(b),
        Op::Multiply(a, b) | Op::Power(a, b) => lacks(a) || lacks(b),
        Op::Call(f, a, b) => lacks(a) || f.accepts(2) && lacks(b),
        _ => false,
    };
    match may_lack {
        true => S::undefined(),
        false => extended_op(op, v, slots),
    }
}

/// The same where the operands have values, which may be beyond all bounds.
fn extended_op<S: Scalar>(op: Op, v: &[S], slots: &[S]) -> S {
    match op {
        Op::Constant(c) => S::from_constant(c),
        Op::Slot(i) => slots[i],
        Op::Negate(a) => -v[a],
        Op::Add(a, b) => v[a] + v[b],
        Op::Subtract(a, b) => v[a] - v[b],
        Op::Multiply(a, b) if a == b => v[a].square(),
        Op::Multiply(a, b) => v[a] * v[b],
        Op::Divide(a, b) => v[a].over(v[b]),
        Op::Power(a, b) => v[a].existing_power(v[b]),
        Op::Call(f, a, b) => f.value(v[a], v[b]),
    }
}

/// The derivative of a power by its base.
fn power_slope<S: Scalar>(base: S, exponent: S) -> S {
    if exponent == S::number(0.0) {
        return exponent;
    }
    // A whole exponent stays one number, or a negative base would have no power.
    let less = match exponent.as_number() {
        Some(e) if (e - 1.0) + 1.0 == e => S::number(e - 1.0),
        _ => exponent - S::number(1.0),
    };
    exponent * base.power(less)
}

fn affine_of(op: Op, forms: &[Affine]) -> Option<Affine> {
    let constant = |form: &Affine| form.terms.is_empty().then_some(form.constant);
    Some(match op {
        Op::Constant(c) => Affine {
            constant: c,
            terms: Vec::new(),
        },
        Op::Slot(i) => Affine {
            constant: ZERO,
            terms: vec![(i, ONE)],
        },
        Op::Negate(a) => combine_affine(&forms[a], -ONE, &Affine::default(), ZERO),
        Op::Add(a, b) => combine_affine(&forms[a], ONE, &forms[b], ONE),
        Op::Subtract(a, b) => combine_affine(&forms[a], ONE, &forms[b], -ONE),
        // A product or quotient is affine only if one side is constant.
        Op::Multiply(a, b) => match (constant(&forms[a]), constant(&forms[b])) {
            (Some(c), _) => combine_affine(&forms[b], c, &Affine::default(), ZERO),
            (_, Some(c)) => combine_affine(&forms[a], c, &Affine::default(), ZERO),
            _ => return None,
        },
        Op::Divide(a, b) => {
            let divisor = constant(&forms[b])?;
            let scaled = |v: Constant| v / divisor;
            Affine {
                constant: scaled(forms[a].constant),
                terms: forms[a]
                    .terms
                    .iter()
                    .map(|(s, c)| (*s, scaled(*c)))
                    .collect(),
            }
        }
        // Powers and functions are affine only as constants.
        Op::Power(a, b) => {
            let value = constant(&forms[a])?.power(constant(&forms[b])?);
            Affine {
                constant: value,
                terms: Vec::new(),
            }
        }
        Op::Call(f, a, b) => {
            let value = f.value(constant(&forms[a])?, constant(&forms[b])?);
            Affine {
                constant: value,
                terms: Vec::new(),
            }
        }
    })
}

/// `x·a + y·b`, terms merged by slot and zeros dropped.
fn combine_affine(a: &Affine, x: Constant, b: &Affine, y: Constant) -> Affine {
    let mut terms: Vec<_> = a.terms.iter().map(|(s, c)| (*s, x * *c)).collect();
    for (slot, c) in &b.terms {
        match terms.iter_mut().find(|(s, _)| s == slot) {
            Some(term) => term.1 = term.1 + y * *c,
            None => terms.push((*slot, y * *c)),
        }
    }
    // A coefficient that cancels to 31 digits is taken as zero only if it is.
    terms.retain(|(_, c)| *c != ZERO);
    sort_by_key(&mut terms, |(s, _)| *s);
    Affine {
        constant: x * a.constant + y * b.constant,
        terms,
    }
}

mod angle_cut;
mod branches;
mod composed;
pub mod continuity;
mod domain;
mod fault;
mod instants;
pub mod jumps;
mod kink_side;
pub mod pieces;
pub mod quadratic;
pub mod sides;

#[cfg(test)]
mod tests;
