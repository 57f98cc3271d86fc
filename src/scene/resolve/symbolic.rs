//! The frame of a chain as formulas of the coordinates: for distances and directions that are no joint's.
//!
//! All formulas share one list of operations; zeros and ones are left out as they arise.

use crate::model::chain::{Argument, Chain, Motion, Step};
use crate::model::expression::{Expression, Function, Op};

/// A number, or the result of an operation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Term {
    Constant(f64),
    Op(usize),
}

/// Three terms.
pub type Vector = [Term; 3];

/// A joint met on the way along a chain, in the chain's base frame.
pub struct Drafted {
    pub motion: Motion,
    pub axis: Vector,
    pub origin: Vector,
    /// Index of its argument.
    pub argument: usize,
}

/// The frame at the end of a chain.
pub struct DraftFrame {
    pub axes: [Vector; 3],
    pub origin: Vector,
    pub joints: Vec<Drafted>,
}

/// A growing list of operations over the coordinates.
pub struct Formulas<'a> {
    arguments: &'a [Argument],
    ops: Vec<Op>,
}

impl<'a> Formulas<'a> {
    /// An empty list; chains refer to `arguments`.
    pub fn new(arguments: &'a [Argument]) -> Self {
        Self {
            arguments,
            ops: Vec::new(),
        }
    }

    /// The argument with that index.
    pub fn argument(&self, index: usize) -> &'a Argument {
        &self.arguments[index]
    }

    /// `term` as a formula of its own.
    pub fn expression(&self, term: Term) -> Expression {
        match term {
            Term::Constant(value) => Expression::constant(value),
            Term::Op(last) => Expression::new(self.ops[..=last].to_vec()),
        }
    }

    /// The frame at the end of `chain`.
    pub fn walk(&mut self, chain: &Chain) -> DraftFrame {
        let unit = |k: usize| [0, 1, 2].map(|i| Term::Constant(if i == k { 1.0 } else { 0.0 }));
        let mut frame = DraftFrame {
            axes: [unit(0), unit(1), unit(2)],
            origin: [Term::Constant(0.0); 3],
            joints: Vec::new(),
        };
        for step in &chain.steps {
            match *step {
                Step::Fixed(pose) => {
                    let shift = self.combined(&frame.axes, pose.translation.to_array());
                    frame.origin = self.sum(frame.origin, shift);
                    let columns = [
                        pose.rotation.x_axis,
                        pose.rotation.y_axis,
                        pose.rotation.z_axis,
                    ];
                    frame.axes =
                        columns.map(|column| self.combined(&frame.axes, column.to_array()));
                }
                Step::Joint {
                    motion,
                    axis,
                    argument,
                    sign,
                } => {
                    let signed = frame.axes[axis].map(|c| self.multiply(c, Term::Constant(sign)));
                    frame.joints.push(Drafted {
                        motion,
                        axis: signed,
                        origin: frame.origin,
                        argument,
                    });
                    let value = self.argument_value(argument);
                    match motion {
                        Motion::Translation => {
                            let shift = signed.map(|c| self.multiply(c, value));
                            frame.origin = self.sum(frame.origin, shift);
                        }
                        Motion::Rotation => self.turn(&mut frame.axes, axis, value, sign),
                    }
                }
            }
        }
        frame
    }

    /// Turns two of the axes about the third.
    fn turn(&mut self, axes: &mut [Vector; 3], axis: usize, angle: Term, sign: f64) {
        let cos = self.call(Function::Cos, angle);
        let sin = self.call(Function::Sin, angle);
        let sin = self.multiply(sin, Term::Constant(sign));
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let (a, b) = (axes[i], axes[j]);
        for k in 0..3 {
            let (ac, bs) = (self.multiply(a[k], cos), self.multiply(b[k], sin));
            let (bc, as_) = (self.multiply(b[k], cos), self.multiply(a[k], sin));
            axes[i][k] = self.add(ac, bs);
            axes[j][k] = self.subtract(bc, as_);
        }
    }

    fn argument_value(&mut self, index: usize) -> Term {
        match &self.arguments[index] {
            Argument::Affine(affine) => {
                let mut sum = Term::Constant(affine.constant);
                for (slot, coefficient) in &affine.terms {
                    let coordinate = self.push(Op::Slot(*slot));
                    let share = self.multiply(coordinate, Term::Constant(*coefficient));
                    sum = self.add(sum, share);
                }
                sum
            }
            Argument::Formula(expression) => self.inline(expression),
        }
    }

    /// A formula of the coordinates as a term.
    pub fn inline(&mut self, expression: &Expression) -> Term {
        if let [Op::Constant(value)] = expression.ops() {
            return Term::Constant(*value);
        }
        let start = self.ops.len();
        self.ops
            .extend(expression.ops().iter().map(|op| op.shifted(start)));
        Term::Op(self.ops.len() - 1)
    }

    /// Σ of the axes by constant weights.
    fn combined(&mut self, axes: &[Vector; 3], weights: [f64; 3]) -> Vector {
        let mut sum = [Term::Constant(0.0); 3];
        for (axis, weight) in axes.iter().zip(weights) {
            let share = axis.map(|c| self.multiply(c, Term::Constant(weight)));
            sum = self.sum(sum, share);
        }
        sum
    }

    /// a + b
    pub fn sum(&mut self, a: Vector, b: Vector) -> Vector {
        [0, 1, 2].map(|k| self.add(a[k], b[k]))
    }

    /// a - b
    pub fn difference(&mut self, a: Vector, b: Vector) -> Vector {
        [0, 1, 2].map(|k| self.subtract(a[k], b[k]))
    }

    /// a · b
    pub fn dot(&mut self, a: Vector, b: Vector) -> Term {
        let mut sum = Term::Constant(0.0);
        for (x, y) in a.into_iter().zip(b) {
            let product = self.multiply(x, y);
            sum = self.add(sum, product);
        }
        sum
    }

    /// a × b
    pub fn cross(&mut self, a: Vector, b: Vector) -> Vector {
        [0, 1, 2].map(|k| {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let (plus, minus) = (self.multiply(a[i], b[j]), self.multiply(a[j], b[i]));
            self.subtract(plus, minus)
        })
    }

    /// |a|
    pub fn length(&mut self, a: Vector) -> Term {
        let square = self.dot(a, a);
        self.call(Function::Sqrt, square)
    }

    /// The angle in 0..90 degrees whose tangent is across / |along|.
    pub fn angle_of(&mut self, across: Term, along: Term) -> Expression {
        let along = self.call(Function::Abs, along);
        let (a, b) = (self.as_op(across), self.as_op(along));
        let angle = self.push(Op::Call(Function::Atan2, a, b));
        self.expression(angle)
    }

    /// a + b
    pub fn add(&mut self, a: Term, b: Term) -> Term {
        match (a, b) {
            (Term::Constant(x), Term::Constant(y)) => Term::Constant(x + y),
            (Term::Constant(0.0), other) | (other, Term::Constant(0.0)) => other,
            _ => self.binary(Op::Add, a, b),
        }
    }

    /// a - b
    pub fn subtract(&mut self, a: Term, b: Term) -> Term {
        match (a, b) {
            (Term::Constant(x), Term::Constant(y)) => Term::Constant(x - y),
            (other, Term::Constant(0.0)) => other,
            _ => self.binary(Op::Subtract, a, b),
        }
    }

    /// a b
    pub fn multiply(&mut self, a: Term, b: Term) -> Term {
        match (a, b) {
            (Term::Constant(x), Term::Constant(y)) => Term::Constant(x * y),
            (Term::Constant(0.0), _) | (_, Term::Constant(0.0)) => Term::Constant(0.0),
            (Term::Constant(1.0), other) | (other, Term::Constant(1.0)) => other,
            _ => self.binary(Op::Multiply, a, b),
        }
    }

    /// a / b
    pub fn divide(&mut self, a: Term, b: Term) -> Term {
        self.binary(Op::Divide, a, b)
    }

    fn call(&mut self, function: Function, a: Term) -> Term {
        let a = self.as_op(a);
        self.push(Op::Call(function, a, a))
    }

    fn binary(&mut self, op: fn(usize, usize) -> Op, a: Term, b: Term) -> Term {
        let (a, b) = (self.as_op(a), self.as_op(b));
        self.push(op(a, b))
    }

    fn as_op(&mut self, term: Term) -> usize {
        match term {
            Term::Op(index) => index,
            Term::Constant(value) => {
                self.ops.push(Op::Constant(value));
                self.ops.len() - 1
            }
        }
    }

    fn push(&mut self, op: Op) -> Term {
        self.ops.push(op);
        Term::Op(self.ops.len() - 1)
    }
}
