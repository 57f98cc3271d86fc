//! A loop over a time interval: its residual, the columns of its Jacobian, and bounds of second derivatives.
//!
//! Residual and formulas are those of the certificate of a pose, the skew part of the rotation and the translation over
//! the size; see [`chain`](crate::kinematics::certificate::pose::chain). Instead of numbers there are polynomials in s,
//! with one bound for the whole rotation (Frobenius norm) and one for the translation: an elementary rotation is
//! orthogonal, so that such a bound is passed on from joint to joint and does not grow.

use super::form::FormChange;
use super::taylor_model::{
    Polynomial, TERMS, TaylorModel, Turn, polynomial_size, tail_sums, truncated_part,
};
use crate::linalg::lanes::all_lanes;
use crate::model::chain::{ChainStep, ElementaryMotion};
use crate::model::fixed::FixedPose;
use crate::model::walk::{Carried, walk_chain};
use crate::numbers::rounding::{GROW, OPERATION, is_exact};
use wide::f64x4;

/// A vector as a polynomial in s; the fourth lane is zero.
type TubeVector = [f64x4; TERMS];

/// Roundings of a sum of all products that contribute to one coefficient.
const PRODUCTS: f64 = (2 * TERMS + 4) as f64 * OPERATION;

/// Norm of the difference of the columns of two rotations, over the largest difference of their entries.
const PAIR: f64 = 1.5;

/// For a closed loop the derivative of the skew part is the axis itself; ratio of its error to the error of the
/// rotation.
const OPEN_SKEW: f64 = 1.5;

/// An argument of a joint over the interval.
#[derive(Clone, Copy, Debug)]
pub struct ArgumentModel {
    value: TaylorModel,
    turn: Turn,
}

impl From<TaylorModel> for ArgumentModel {
    fn from(value: TaylorModel) -> Self {
        let turn = Turn::new(&value);
        Self { value, turn }
    }
}

/// A joint of the loop.
#[derive(Clone, Copy, Debug)]
pub struct TubeJoint {
    motion: ElementaryMotion,
    /// Index of its argument.
    pub argument: usize,
    axis: TubeVector,
    origin: TubeVector,
    /// Error bounds of axis and origin.
    rests: [f64; 2],
}

/// A loop over the stretch.
#[derive(Clone, Debug)]
pub struct LoopModel {
    rotation: [TubeVector; 3],
    translation: TubeVector,
    /// Error bounds of rotation and translation.
    rests: [f64; 2],
    /// Joints in order.
    pub joints: Vec<TubeJoint>,
    size: f64,
}

const ZERO: TubeVector = [f64x4::ZERO; TERMS];

fn to_lanes(v: [f64; 3]) -> f64x4 {
    f64x4::new([v[0], v[1], v[2], 0.0])
}

#[inline]
fn squared_norm(v: f64x4) -> f64 {
    (v * v).reduce_add()
}

/// Lengths of the coefficients.
#[inline]
fn squared_lengths(v: &TubeVector) -> Polynomial {
    std::array::from_fn(|k| squared_norm(v[k]).sqrt())
}

#[inline]
fn add_product(sum: &mut TubeVector, v: &TubeVector, factor: &Polynomial) {
    for j in 0..TERMS {
        let factor = all_lanes(factor[j]);
        for k in 0..TERMS - j {
            sum[j + k] += v[k] * factor;
        }
    }
}

/// Component `k`.
fn vector_entry(v: &TubeVector, k: usize) -> Polynomial {
    std::array::from_fn(|j| v[j].to_array()[k])
}

impl LoopModel {
    /// Multiplies the steps. Joints whose argument is constant are omitted from `joints`; see `moves`.
    pub fn new(
        steps: &[ChainStep],
        arguments: &[Option<ArgumentModel>],
        moves: impl Fn(usize) -> bool,
        size: f64,
    ) -> Self {
        let mut rotation = [ZERO; 3];
        for (k, column) in rotation.iter_mut().enumerate() {
            let mut unit = [0.0; 3];
            unit[k] = 1.0;
            column[0] = to_lanes(unit);
        }
        let mut here = Self {
            rotation,
            translation: ZERO,
            rests: [0.0; 2],
            joints: Vec::new(),
            size,
        };
        let mut joints = Vec::with_capacity(steps.len());
        walk_chain(steps, &mut here, arguments, |here, joint| {
            // Axis and origin of each moving joint, as Taylor models over the stretch.
            if moves(joint.argument) {
                joints.push(TubeJoint {
                    motion: joint.motion,
                    argument: joint.argument,
                    axis: here.rotation[joint.axis].map(|c| c * all_lanes(joint.sign)),
                    origin: here.translation,
                    rests: here.rests,
                });
            }
        });
        here.joints = joints;
        here
    }

    /// Trace of the rotation.
    pub fn trace(&self) -> TaylorModel {
        let [x, y, z] = [0, 1, 2].map(|k| vector_entry(&self.rotation[k], k));
        let c: Polynomial = std::array::from_fn(|k| x[k] + y[k] + z[k]);
        TaylorModel {
            rest: 2.0 * self.rests[0] + 4.0 * OPERATION * polynomial_size(&c) + 4.0 * OPERATION,
            c,
        }
    }

    /// The closure error of the loop over the interval: norm of the rotation minus the identity, length of the
    /// translation.
    pub fn open(&self) -> [f64; 2] {
        let mut turned: Polynomial = [0.0; TERMS];
        for (k, turned) in turned.iter_mut().enumerate() {
            let mut sum = 0.0;
            for (j, column) in self.rotation.iter().enumerate() {
                let mut entries = column[k].to_array();
                // Less the identity, which is constant.
                if k == 0 {
                    entries[j] -= 1.0;
                }
                sum += squared_norm(f64x4::new(entries));
            }
            *turned = sum.sqrt();
        }
        let moved = polynomial_size(&squared_lengths(&self.translation));
        [
            polynomial_size(&turned) + self.rests[0],
            moved + self.rests[1],
        ]
        .map(|v| v * GROW)
    }

    /// Entry `component` of the residual.
    pub fn residual(&self, component: usize) -> TaylorModel {
        if component >= 3 {
            let c = vector_entry(&self.translation, component - 3);
            return TaylorModel {
                c,
                rest: self.rests[1],
            }
            .scaled(1.0 / self.size);
        }
        let (b, c) = ((component + 1) % 3, (component + 2) % 3);
        let (first, second) = (
            vector_entry(&self.rotation[b], c),
            vector_entry(&self.rotation[c], b),
        );
        // Skew part of the rotation: half the difference of opposite entries.
        let c: Polynomial = std::array::from_fn(|k| 0.5 * (first[k] - second[k]));
        TaylorModel {
            rest: self.rests[0] * GROW + OPERATION * polynomial_size(&c),
            c,
        }
    }

    /// Derivatives of rotation and translation rows by the joint's own motion, all six. `open` is from
    /// [`open`](Self::open).
    pub fn column(&self, joint: &TubeJoint, open: [f64; 2]) -> [TaylorModel; 6] {
        let scale = 1.0 / self.size;
        let [axis_rest, origin_rest] = joint.rests;
        let axis = [0, 1, 2].map(|k| vector_entry(&joint.axis, k));
        // A slide: the axis itself, no rotation.
        if joint.motion == ElementaryMotion::Translation {
            let moved = axis.map(|c| {
                let rest = axis_rest;
                TaylorModel { c, rest }.scaled(scale)
            });
            return [
                TaylorModel::ZERO,
                TaylorModel::ZERO,
                TaylorModel::ZERO,
                moved[0],
                moved[1],
                moved[2],
            ];
        }
        // A rotation: the axis for the rotation rows, axis × arm for the translation.
        let turned = axis.map(|c| TaylorModel {
            c,
            rest: (axis_rest + OPEN_SKEW * open[0]) * GROW,
        });
        // The arm from the joint to the loop's end, which is at the origin except for the closure error.
        let origin = [0, 1, 2].map(|k| vector_entry(&joint.origin, k));
        let (axes, origins) = (squared_lengths(&joint.axis), squared_lengths(&joint.origin));
        let (whole, tails) = (polynomial_size(&axes), tail_sums(&origins));
        let rest = axis_rest * tails[0]
            + origin_rest
            + open[1]
            + truncated_part(&axes, &tails)
            + 2.0 * PRODUCTS * whole * tails[0];
        // The cross product of two polynomials, truncated at the highest power; the truncation error is in `rest`.
        let arm = [0, 1, 2].map(|k| {
            let (b, c) = ((k + 1) % 3, (k + 2) % 3);
            let mut sum = [0.0; TERMS];
            for i in 0..TERMS {
                for j in 0..TERMS - i {
                    sum[i + j] += axis[c][i] * origin[b][j] - axis[b][i] * origin[c][j];
                }
            }
            let rest = rest * GROW;
            TaylorModel { c: sum, rest }.scaled(scale)
        });
        [turned[0], turned[1], turned[2], arm[0], arm[1], arm[2]]
    }
}

impl Carried for LoopModel {
    /// `None` if nothing is known about it.
    type Argument = Option<ArgumentModel>;

    fn shift(&mut self, axis: usize, sign: f64, by: &Self::Argument) {
        let Some(ArgumentModel { value: by, .. }) = by else {
            self.rests = [f64::INFINITY; 2];
            return;
        };
        let c = by.c.map(|c| c * sign);
        let column = &self.rotation[axis];
        add_product(&mut self.translation, column, &c);
        let (lengths, sizes) = (squared_lengths(column), c.map(f64::abs));
        let (whole, tails) = (polynomial_size(&lengths), tail_sums(&sizes));
        let rounding = PRODUCTS
            * (whole * tails[0] + polynomial_size(&self::squared_lengths(&self.translation)));
        // The error of the rotation times the distance, the distance's own error, and the truncation after degree
        // seven.
        self.rests[1] += (self.rests[0] * tails[0] + by.rest + truncated_part(&lengths, &tails))
            * GROW
            + rounding;
    }

    fn turn(&mut self, axis: usize, sign: f64, by: &Self::Argument) {
        let Some(ArgumentModel { turn: by, .. }) = by else {
            self.rests = [f64::INFINITY; 2];
            return;
        };
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        let (x, y) = (self.rotation[b], self.rotation[c]);
        let sin = by.sin.map(|v| v * sign);
        let (mut first, mut second) = (ZERO, ZERO);
        add_product(&mut first, &x, &by.cos);
        add_product(&mut first, &y, &sin);
        add_product(&mut second, &y, &by.cos);
        add_product(&mut second, &x, &sin.map(|v| -v));
        // The columns beside the axis turn in their plane.
        self.rotation[b] = first;
        self.rotation[c] = second;
        let pairs: Polynomial =
            std::array::from_fn(|k| (squared_norm(x[k]) + squared_norm(y[k])).sqrt());
        // Orthogonal: the earlier error is unchanged, and only the truncation at this joint is added.
        let tails = tail_sums(&by.sizes);
        let moving = polynomial_size(&pairs) * tails[0] - pairs[0];
        let rounding = 4.0 * OPERATION + PRODUCTS * moving.max(0.0);
        let rest = self.rests[0];
        self.rests[0] += ((1.0 + rest) * PAIR * by.rest + truncated_part(&pairs, &tails)) * GROW
            + PAIR * rounding;
    }

    fn fix(&mut self, pose: &FixedPose) {
        let error = pose.error;
        let old = self.rotation;
        let times = |v: [f64; 3]| -> TubeVector {
            let v = v.map(all_lanes);
            std::array::from_fn(|k| old[0][k] * v[0] + old[1][k] * v[1] + old[2][k] * v[2])
        };
        let length = pose.translation.length();
        let sizes: f64 = old
            .iter()
            .map(|v| polynomial_size(&squared_lengths(v)))
            .sum();
        if length > 0.0 {
            let moved = times(pose.translation.to_array());
            for (t, m) in self.translation.iter_mut().zip(moved) {
                *t += m;
            }
            let rounding = 4.0
                * OPERATION
                * (sizes * length + polynomial_size(&squared_lengths(&self.translation)));
            self.rests[1] += (self.rests[0] * length + error.translation) * GROW + rounding;
        }
        if pose.rotation != glam::DMat3::IDENTITY {
            let turns = pose.rotation;
            self.rotation = [0, 1, 2].map(|k| times(turns.col(k).to_array()));
            self.rests[0] += (1.0 + self.rests[0]) * error.rotation * GROW;
            // Products with zeros and ones are exact.
            if !turns.to_cols_array().into_iter().all(is_exact) {
                self.rests[0] += 8.0 * OPERATION * sizes;
            }
        }
    }
}

/// The reach and curvature of loops: bounds that hold for every value of the revolute joints.
pub struct Reaches {
    joints: Vec<(ElementaryMotion, usize, f64)>,
    size: f64,
}

impl Reaches {
    /// `farthest(a)` bounds the magnitude of argument `a`, where it is a length.
    pub fn new(steps: &[ChainStep], farthest: impl Fn(usize) -> f64, size: f64) -> Self {
        let (mut joints, mut reach) = (Vec::new(), 0.0);
        for step in steps.iter().rev() {
            match step {
                ChainStep::Fixed(pose) => reach += pose.translation.length() / size,
                ChainStep::Joint {
                    motion, argument, ..
                } => {
                    joints.push((*motion, *argument, reach * GROW));
                    if *motion == ElementaryMotion::Translation {
                        reach += farthest(*argument) / size;
                    }
                }
            }
        }
        joints.reverse();
        Self { joints, size }
    }

    /// Bounds of the second derivative of rotation and translation rows along two directions in which argument `a`
    /// changes as `change(a)` says.
    pub fn second_derivatives(&self, change: impl Fn(usize) -> FormChange) -> [f64; 2] {
        let (mut turned, mut bent, mut translation) = (0.0, 0.0, 0.0);
        for (motion, argument, reach) in &self.joints {
            let FormChange { rate, bend } = change(*argument);
            match motion {
                ElementaryMotion::Rotation => {
                    // Second derivative of a point that turns: rates multiply, arms are at most the reach.
                    translation += reach * (rate * (rate + 2.0 * turned) + bend);
                    turned += rate;
                    bent += bend;
                }
                ElementaryMotion::Translation => {
                    translation += (2.0 * turned * rate + bend) / self.size
                }
            }
        }
        [turned * turned + bent, translation]
    }

    /// Bound of the rotation along a direction.
    pub fn turn(&self, rate: impl Fn(usize) -> f64) -> f64 {
        let turning = self
            .joints
            .iter()
            .filter(|j| j.0 == ElementaryMotion::Rotation);
        turning.map(|(_, argument, _)| rate(*argument)).sum()
    }
}
