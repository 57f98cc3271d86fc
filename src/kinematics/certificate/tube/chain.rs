//! A loop over a stretch of motion: its residual, the columns of its Jacobian, and bounds of second derivatives.
//!
//! The residual is that of the certificate of a pose, the skew part of the rotation and the translation over the size,
//! and so are the formulas; see [`chain`](super::super::chain). What is a number there is a series here.

use super::super::interval::Interval;
use super::form::Change;
use super::series::Series;
use crate::math::Pose;
use crate::model::chain::{Motion, Step};

type Vector = [Series; 3];

/// Relative to its own size: entries of a fixed rotation that was folded from a few rounded factors, and of the
/// translations that went through it.
const FOLDED: f64 = 2e-15;

/// Value, sine and cosine of an argument.
#[derive(Clone, Copy, Debug)]
pub struct ArgumentSeries {
    value: Series,
    sin: Series,
    cos: Series,
}

impl From<Series> for ArgumentSeries {
    fn from(value: Series) -> Self {
        let (sin, cos) = value.sin_cos();
        Self { value, sin, cos }
    }
}

/// A joint of the loop.
pub struct Joint {
    motion: Motion,
    /// Index of its argument.
    pub argument: usize,
    axis: Vector,
    origin: Vector,
}

/// A loop over the stretch.
pub struct LoopSeries {
    rotation: [Vector; 3],
    translation: Vector,
    /// Joints in order.
    pub joints: Vec<Joint>,
    size: Interval,
}

fn combine(a: &Vector, x: &Series, b: &Vector, y: &Series) -> Vector {
    [0, 1, 2].map(|k| a[k] * *x + b[k] * *y)
}

/// Entries of a fixed pose with what folding may have changed.
fn fixed_entries(pose: &Pose) -> ([[Interval; 3]; 3], [Interval; 3]) {
    let columns = [0, 1, 2].map(|j| pose.rotation.col(j).to_array());
    let quarter_turns = columns.as_flattened().iter().all(|v| v.fract() == 0.0);
    let length = pose.translation.length();
    let open = |v: f64, by: f64| Interval::point(v) + Interval::around_zero(by);
    let entry = |v: f64| match quarter_turns {
        true => Interval::point(v),
        false => open(v, FOLDED),
    };
    let place = |v: f64| match quarter_turns {
        true => Interval::decimal(v),
        false => open(v, FOLDED * length),
    };
    (
        columns.map(|column| column.map(entry)),
        pose.translation.to_array().map(place),
    )
}

impl LoopSeries {
    /// Multiplies the steps.
    pub fn new(steps: &[Step], arguments: &[Option<ArgumentSeries>], size: f64) -> Self {
        let one = Series::constant(Interval::ONE);
        let mut rotation = [[Series::ZERO; 3]; 3];
        (0..3).for_each(|k| rotation[k][k] = one);
        let mut here = Self {
            rotation,
            translation: [Series::ZERO; 3],
            joints: Vec::new(),
            size: Interval::point(size),
        };
        for step in steps {
            match step {
                Step::Fixed(pose) => here.fixed(pose),
                Step::Joint {
                    motion,
                    axis,
                    argument,
                    sign,
                } => {
                    let sign = Interval::point(*sign);
                    here.joints.push(Joint {
                        motion: *motion,
                        argument: *argument,
                        axis: here.rotation[*axis].map(|entry| entry.scale(sign)),
                        origin: here.translation,
                    });
                    match (motion, &arguments[*argument]) {
                        (_, None) => here.translation = [Series::ENTIRE; 3],
                        (Motion::Translation, Some(a)) => here.shift(*axis, &a.value.scale(sign)),
                        (Motion::Rotation, Some(a)) => {
                            here.rotate(*axis, &a.sin.scale(sign), &a.cos);
                        }
                    }
                }
            }
        }
        here
    }

    fn shift(&mut self, axis: usize, by: &Series) {
        for k in 0..3 {
            self.translation[k] = self.translation[k] + self.rotation[axis][k] * *by;
        }
    }

    fn rotate(&mut self, axis: usize, sin: &Series, cos: &Series) {
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        let (x, y) = (self.rotation[b], self.rotation[c]);
        self.rotation[b] = combine(&x, cos, &y, sin);
        self.rotation[c] = combine(&y, cos, &x, &-*sin);
    }

    fn fixed(&mut self, pose: &Pose) {
        let (turn, shift) = fixed_entries(pose);
        let old = self.rotation;
        let times = |v: &[Interval; 3]| -> Vector {
            let term = |j: usize, k: usize| old[j][k].scale(v[j]);
            [0, 1, 2].map(|k| term(0, k) + term(1, k) + term(2, k))
        };
        let moved = times(&shift);
        (0..3).for_each(|k| self.translation[k] = self.translation[k] + moved[k]);
        if pose.rotation != glam::DMat3::IDENTITY {
            self.rotation = turn.map(|column| times(&column));
        }
    }

    /// Trace of the rotation.
    pub fn trace(&self) -> Series {
        self.rotation[0][0] + self.rotation[1][1] + self.rotation[2][2]
    }

    /// Entry `component` of the residual.
    pub fn residual(&self, component: usize) -> Series {
        if component >= 3 {
            let scale = Interval::ONE / self.size;
            return self.translation[component - 3].scale(scale);
        }
        let (b, c) = ((component + 1) % 3, (component + 2) % 3);
        let skew = self.rotation[b][c] - self.rotation[c][b];
        skew.scale(Interval::point(0.5))
    }

    /// Derivative of entry `component` of the residual by the joint's own motion.
    pub fn column(&self, joint: &Joint, component: usize) -> Series {
        let (axis, scale) = (&joint.axis, Interval::ONE / self.size);
        match joint.motion {
            Motion::Translation if component >= 3 => axis[component - 3].scale(scale),
            Motion::Translation => Series::ZERO,
            Motion::Rotation if component >= 3 => {
                let (b, c) = ((component + 1) % 3, (component + 2) % 3);
                let arm = |k: usize| self.translation[k] - joint.origin[k];
                (axis[b] * arm(c) - axis[c] * arm(b)).scale(scale)
            }
            Motion::Rotation => {
                // The rate of the skew part for a spin is half of (trace - R) times it.
                let r = &self.rotation;
                let (x, y, z) = (r[0][component], r[1][component], r[2][component]);
                let turned = x * axis[0] + y * axis[1] + z * axis[2];
                let whole = self.trace() * axis[component];
                (whole - turned).scale(Interval::point(0.5))
            }
        }
    }
}

/// How far loops can reach and bend: bounds that hold for every value of the revolute joints.
pub struct Reaches {
    joints: Vec<(Motion, usize, f64)>,
    size: f64,
}

impl Reaches {
    /// `farthest(a)` bounds the magnitude of argument `a`, where it is a length.
    pub fn new(steps: &[Step], farthest: impl Fn(usize) -> f64, size: f64) -> Self {
        let (mut joints, mut reach) = (Vec::new(), 0.0);
        for step in steps.iter().rev() {
            match step {
                Step::Fixed(pose) => reach += pose.translation.length() / size,
                Step::Joint {
                    motion, argument, ..
                } => {
                    joints.push((*motion, *argument, reach * (1.0 + 1e-12)));
                    if *motion == Motion::Translation {
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
    pub fn second_derivatives(&self, change: impl Fn(usize) -> Change) -> [f64; 2] {
        let (mut turned, mut bent, mut translation) = (0.0, 0.0, 0.0);
        for (motion, argument, reach) in &self.joints {
            let Change { rate, bend } = change(*argument);
            match motion {
                Motion::Rotation => {
                    translation += reach * (rate * (rate + 2.0 * turned) + bend);
                    turned += rate;
                    bent += bend;
                }
                Motion::Translation => translation += (2.0 * turned * rate + bend) / self.size,
            }
        }
        [turned * turned + bent, translation]
    }

    /// By how much the rotation can turn along a direction.
    pub fn turn(&self, rate: impl Fn(usize) -> f64) -> f64 {
        let turning = self.joints.iter().filter(|j| j.0 == Motion::Rotation);
        turning.map(|(_, argument, _)| rate(*argument)).sum()
    }
}
