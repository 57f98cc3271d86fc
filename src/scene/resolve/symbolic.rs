//! The frame at the end of a chain as formulas of the coordinates, for distances and directions that no joint
//! represents.
//!
//! A [`SymbolicTerm`] is a number type: computing with it appends operations to a shared list. Zeros and ones are
//! simplified immediately.

use crate::model::chain::{
    Argument, ArgumentValue, Chain, ChainJoint, ChainStep, ElementaryMotion,
};
use crate::model::expression::{Affine, Expression, Function, Op};
use crate::model::walk::{Triple, WalkFrame, walk_chain};
use crate::numbers::constant::Constant;
use crate::numbers::scalar::Ring;
use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};

const ZERO: Constant = Constant::exact(0.0);
const ONE: Constant = Constant::exact(1.0);

/// A growing list of operations over the coordinates.
#[derive(Default)]
pub struct Formulas {
    ops: RefCell<Vec<Op>>,
}

/// A number, or the result of an operation of a list.
#[derive(Clone, Copy)]
pub enum SymbolicTerm<'l> {
    Constant(Constant),
    Op(&'l Formulas, usize),
}

/// A joint on the way along a chain, in the base frame of the chain.
pub struct Drafted<'l> {
    pub motion: ElementaryMotion,
    pub axis: Triple<SymbolicTerm<'l>>,
    pub origin: Triple<SymbolicTerm<'l>>,
    /// Index of its argument.
    pub argument: usize,
}

impl Formulas {
    /// The frame at the end of `chain`, whose joints refer to `arguments`, and the joints on the way to it.
    pub fn walk(
        &self,
        chain: &Chain,
        arguments: &[Argument],
    ) -> (WalkFrame<SymbolicTerm<'_>>, Vec<Drafted<'_>>) {
        let values = self.values(chain, arguments);
        let (mut frame, mut joints) = (WalkFrame::identity(), Vec::new());
        walk_chain(&chain.steps, &mut frame, &values, |here, joint| {
            joints.push(Drafted {
                motion: joint.motion,
                axis: here.axes[joint.axis].map(|c| c.scale(joint.sign)),
                origin: here.origin,
                argument: joint.argument,
            });
        });
        (frame, joints)
    }

    /// The arguments of a chain's joints; the others stay zero.
    fn values(
        &self,
        chain: &Chain,
        arguments: &[Argument],
    ) -> Vec<ArgumentValue<SymbolicTerm<'_>>> {
        let zero = SymbolicTerm::Constant(ZERO);
        let none = ArgumentValue {
            value: zero,
            sin: zero,
            cos: zero,
        };
        let mut values = vec![none; arguments.len()];
        let mut is_known = vec![false; arguments.len()];
        let mut turns = vec![false; arguments.len()];
        for ChainJoint {
            motion, argument, ..
        } in chain.steps.iter().filter_map(ChainStep::joint)
        {
            let value = &mut values[argument];
            if !is_known[argument] {
                value.value = self.argument_term(&arguments[argument]);
                is_known[argument] = true;
            }
            // Sine and cosine once for all rotations with the same argument.
            if motion == ElementaryMotion::Rotation && !turns[argument] {
                value.cos = self.call_term(Function::Cos, value.value);
                value.sin = self.call_term(Function::Sin, value.value);
                turns[argument] = true;
            }
        }
        values
    }

    fn argument_term(&self, argument: &Argument) -> SymbolicTerm<'_> {
        match argument {
            Argument::Formula(expression) => self.inline(expression),
            Argument::Affine(Affine { constant, terms }) => {
                let terms = terms.iter();
                terms.fold(
                    SymbolicTerm::Constant(*constant),
                    |sum, (slot, coefficient)| {
                        sum + self.push(Op::Slot(*slot)).scale_by(*coefficient)
                    },
                )
            }
        }
    }

    /// A formula of the coordinates as a term.
    pub fn inline(&self, expression: &Expression) -> SymbolicTerm<'_> {
        if let [Op::Constant(value)] = expression.ops() {
            return SymbolicTerm::Constant(*value);
        }
        let mut ops = self.ops.borrow_mut();
        let start = ops.len();
        ops.extend(expression.ops().iter().map(|op| op.shifted(start)));
        SymbolicTerm::Op(self, ops.len() - 1)
    }

    /// `term` as a formula of its own.
    pub fn expression(&self, term: SymbolicTerm) -> Expression {
        match term {
            SymbolicTerm::Constant(value) => Expression::constant(value),
            SymbolicTerm::Op(_, last) => Expression::new(self.ops.borrow()[..=last].to_vec()),
        }
    }

    /// |a|
    pub fn length<'l>(&'l self, a: Triple<SymbolicTerm<'l>>) -> SymbolicTerm<'l> {
        self.call_term(Function::Sqrt, dot_product(a, a))
    }

    /// The angle in 0..90 degrees whose tangent is across / |along|.
    pub fn angle_of<'l>(&'l self, across: SymbolicTerm<'l>, along: SymbolicTerm<'l>) -> Expression {
        let along = self.call_term(Function::Abs, along);
        let (a, b) = (self.place(across), self.place(along));
        self.expression(self.push(Op::Call(Function::Atan2, a, b)))
    }

    fn call_term<'l>(&'l self, function: Function, a: SymbolicTerm<'l>) -> SymbolicTerm<'l> {
        let a = self.place(a);
        self.push(Op::Call(function, a, a))
    }

    /// The index of a term in the list.
    fn place(&self, term: SymbolicTerm) -> usize {
        match term {
            SymbolicTerm::Op(_, place) => place,
            SymbolicTerm::Constant(value) => {
                let mut ops = self.ops.borrow_mut();
                ops.push(Op::Constant(value));
                ops.len() - 1
            }
        }
    }

    fn push(&self, op: Op) -> SymbolicTerm<'_> {
        let mut ops = self.ops.borrow_mut();
        ops.push(op);
        SymbolicTerm::Op(self, ops.len() - 1)
    }
}

/// a - b
pub fn vector_difference<'l>(
    a: Triple<SymbolicTerm<'l>>,
    b: Triple<SymbolicTerm<'l>>,
) -> Triple<SymbolicTerm<'l>> {
    [0, 1, 2].map(|k| a[k] - b[k])
}

/// a · b
pub fn dot_product<'l>(
    a: Triple<SymbolicTerm<'l>>,
    b: Triple<SymbolicTerm<'l>>,
) -> SymbolicTerm<'l> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a × b
pub fn cross_product<'l>(
    a: Triple<SymbolicTerm<'l>>,
    b: Triple<SymbolicTerm<'l>>,
) -> Triple<SymbolicTerm<'l>> {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| a[i] * b[j] - a[j] * b[i])
}

impl<'l> SymbolicTerm<'l> {
    /// The operation on two terms, or `known` of two numbers.
    fn with(
        self,
        other: Self,
        op: fn(usize, usize) -> Op,
        known: fn(Constant, Constant) -> Constant,
    ) -> Self {
        let list = match (self, other) {
            (Self::Constant(a), Self::Constant(b)) => return Self::Constant(known(a, b)),
            (Self::Op(list, _), _) | (_, Self::Op(list, _)) => list,
        };
        let (a, b) = (list.place(self), list.place(other));
        list.push(op(a, b))
    }
}

impl Add for SymbolicTerm<'_> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        match (self, other) {
            (Self::Constant(ZERO), term) | (term, Self::Constant(ZERO)) => term,
            _ => self.with(other, Op::Add, |a, b| a + b),
        }
    }
}

impl Sub for SymbolicTerm<'_> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        match other {
            Self::Constant(ZERO) => self,
            _ => self.with(other, Op::Subtract, |a, b| a - b),
        }
    }
}

impl Mul for SymbolicTerm<'_> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        match (self, other) {
            (Self::Constant(ZERO), _) | (_, Self::Constant(ZERO)) => Self::Constant(ZERO),
            (Self::Constant(ONE), term) | (term, Self::Constant(ONE)) => term,
            _ => self.with(other, Op::Multiply, |a, b| a * b),
        }
    }
}

impl Div for SymbolicTerm<'_> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        self.with(other, Op::Divide, |a, b| a / b)
    }
}

impl Neg for SymbolicTerm<'_> {
    type Output = Self;
    fn neg(self) -> Self {
        Self::Constant(-ONE) * self
    }
}

impl Ring for SymbolicTerm<'_> {
    fn number(value: f64) -> Self {
        Self::Constant(Constant::exact(value))
    }

    fn scale(self, factor: f64) -> Self {
        self.scale_by(Constant::exact(factor))
    }

    fn scale_by(self, factor: Constant) -> Self {
        self * Self::Constant(factor)
    }
}
