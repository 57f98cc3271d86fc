//! Motion of the points of one body relative to another one, around the middle of a time interval.

use crate::distance::primitive::Circle;
use crate::kinematics::certificate::tube::TaylorModel;
use crate::math::{Pose, skew_matrix};
use crate::model::chain::{ArgumentValue, Chain, ChainStep, ElementaryMotion};
use crate::model::fixed::FixedPose;
use crate::model::walk::{Carried, walk_chain};
use crate::numbers::rounding::GROW;
use glam::{DMat3, DVec3};

/// Bounds of a few operations are widened by this factor for their rounding, far more than they lose, ...
pub(super) const WIDER: f64 = 1.0 + 1e-9;

/// ... and by this where numbers of order one are subtracted from each other.
pub(super) const LOST: f64 = 1e-12;

/// The chain from one body to another, without their common part.
#[derive(Clone, Debug)]
pub struct RelativeChain {
    steps: Vec<ChainStep>,
}

/// Motion of a body relative to another one, from the middle of a short interval to its ends: every point x moves to
/// x + u X(x) + u² Y(x), -1 ≤ u ≤ 1, with affine X and Y, to within a bound.
#[derive(Clone, Copy, Debug)]
pub struct RelativeMove {
    /// `a_from_b` in the middle.
    pub pose: Pose,
    /// X at a's origin, in a's frame.
    pub shift: DVec3,
    /// X as a spin: X(x) = shift + spin × x.
    pub spin: DVec3,
    /// Y at a's origin.
    pub bend: DVec3,
    /// Y(x) = bend + twist x.
    pub twist: DMat3,
    /// Norms of the spin and of the twist per unit of length.
    turning: [f64; 2],
    /// Bound on the deviation of every point ...
    off: f64,
    /// ... plus this for each unit of length from b's origin.
    off_by_reach: f64,
}

/// A bound on the norm of a matrix.
fn operator_norm(m: &DMat3) -> f64 {
    m.to_cols_array().iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// The matrix of a × (b ×).
fn cross_twice(a: DVec3, b: DVec3) -> DMat3 {
    let along = a.dot(b);
    DMat3::from_cols(b * a.x, b * a.y, b * a.z) - DMat3::from_diagonal(DVec3::splat(along))
}

/// Arguments in the middle of a stretch.
fn centres(arguments: &[TaylorModel]) -> Vec<ArgumentValue> {
    let values = arguments.iter().map(|model| ArgumentValue::new(model.c[0]));
    values.collect()
}

/// Zero times an infinite length is zero.
fn rate_times(rate: f64, length: f64) -> f64 {
    if rate == 0.0 { 0.0 } else { rate * length }
}

impl RelativeMove {
    /// Nothing is known but the pose in the middle.
    fn unknown(pose: Pose) -> Self {
        Self {
            pose,
            shift: DVec3::ZERO,
            spin: DVec3::ZERO,
            bend: DVec3::ZERO,
            twist: DMat3::ZERO,
            turning: [0.0; 2],
            off: f64::INFINITY,
            off_by_reach: f64::INFINITY,
        }
    }

    /// Whether all of it are numbers: where bounds overflow, their differences are none, and comparisons would pass over them.
    fn is_known(&self) -> bool {
        let vectors = [self.shift, self.spin, self.bend];
        let bounds = [self.off, self.off_by_reach];
        vectors.iter().all(|v| v.is_finite())
            && self.twist.is_finite()
            && bounds.iter().all(|b| b.is_finite())
    }

    /// X of a point in a's frame.
    pub fn rate(&self, point: DVec3) -> DVec3 {
        self.shift + self.spin.cross(point)
    }

    /// Y of a point in a's frame.
    pub fn bend_of(&self, point: DVec3) -> DVec3 {
        self.bend + self.twist * point
    }

    /// Norms of the linear parts of X and Y.
    pub fn turning(&self) -> [f64; 2] {
        self.turning
    }

    /// The same motion of a circle (in a's frame) that also turns about its own axis, by `turn` times u: the set of its points
    /// moves as before.
    pub fn with_own_turn(&self, circle: &Circle, turn: f64) -> Self {
        // The point c + r turns to c + r + u ω × r + u² ω × (ω × r) / 2, which X and Y move.
        let own = circle.axis * turn;
        let second = skew_matrix(self.spin) * skew_matrix(own) + cross_twice(own, own) * 0.5;
        let (spin, twist) = (self.spin + own, self.twist + second);
        let (angle, [speed, bending]) = (turn.abs(), self.turning);
        let third = angle.powi(3) / 6.0 + 0.5 * speed * angle * angle + bending * angle;
        Self {
            shift: self.shift - own.cross(circle.centre),
            spin,
            bend: self.bend - second * circle.centre,
            twist,
            turning: [spin.length(), operator_norm(&twist)],
            off: self.off + third * circle.radius * GROW,
            ..*self
        }
    }

    /// Nothing of a ball of b (centre and radius in b's frame) deviates from the two terms by more.
    pub fn deviation(&self, (centre, radius): (DVec3, f64)) -> f64 {
        (self.off + rate_times(self.off_by_reach, centre.length() + radius)) * GROW
    }

    /// How far Y takes the points of a ball.
    pub fn bending(&self, (centre, radius): (DVec3, f64)) -> f64 {
        let centre = self.bend_of(self.pose.transform_point(centre));
        (centre.length() + rate_times(self.turning[1], radius)) * GROW
    }

    /// No point of a ball of b moves farther.
    pub fn distance(&self, ball: (DVec3, f64)) -> f64 {
        let centre = self.rate(self.pose.transform_point(ball.0));
        let linear = centre.length() + rate_times(self.turning[0], ball.1);
        linear * GROW + self.bending(ball) + self.deviation(ball)
    }
}

/// The motion of the frame that a walk has reached, over the surroundings of a place.
struct MovingBody {
    s: f64,
    half: f64,
    moved: RelativeMove,
    /// Of the joints before: their turns, ...
    turned: f64,
    /// ... the linear parts of these, ...
    linear: f64,
    /// ... the length from the first joint to here, ...
    length: f64,
    /// ... and what each turns too much or too little, times the length from the first joint to it.
    off_by_length: f64,
}

impl Carried for MovingBody {
    type Argument = TaylorModel;

    fn fix(&mut self, fixed: &FixedPose) {
        self.length += fixed.translation.length();
        self.moved.pose.fix(fixed);
    }

    fn shift(&mut self, axis: usize, sign: f64, by: &TaylorModel) {
        let by = by.around(self.s, self.half);
        let way = by.way.abs();
        let play = way + by.bend.abs() + by.off;
        let (moved, turned) = (&mut self.moved, self.turned);
        let unit = moved.pose.rotation.col(axis) * sign;
        let speed = unit * by.way;
        moved.bend += unit * by.bend + moved.spin.cross(speed);
        moved.shift += speed;
        moved.off += by.off + (turned * play - self.linear * way) + 0.5 * turned * turned * play;
        self.length += by.value.abs() + play;
        moved.pose.translation += unit * by.value;
    }

    fn turn(&mut self, axis: usize, sign: f64, by: &TaylorModel) {
        // The angle over the part: linear term, second-order term, and error.
        let by = by.around(self.s, self.half);
        let way = by.way.abs();
        let play = way + by.bend.abs() + by.off;
        let (moved, turned) = (&mut self.moved, self.turned);
        let unit = moved.pose.rotation.col(axis) * sign;
        let spin = unit * by.way;
        let origin = moved.pose.translation;
        // The rotation to second order, and a bound of all higher ones.
        let before = moved.spin + spin * 0.5;
        let second = skew_matrix(unit * by.bend) + cross_twice(before, spin);
        moved.twist += second;
        moved.bend -= second * origin;
        moved.spin += spin;
        moved.shift += origin.cross(spin);
        let third = ((turned + play).powi(3) - turned.powi(3)) / 6.0;
        let second_order = 0.5 * (play * play - way * way) + (turned * play - self.linear * way);
        let off = by.off + second_order + third;
        moved.off_by_reach += off;
        self.off_by_length += off * self.length;
        self.turned += play;
        self.linear += way;
        moved.pose.turn(axis, sign, &ArgumentValue::new(by.value));
    }
}

impl RelativeChain {
    /// The chain whose product is `a_from_b`.
    pub fn new(world_from_a: &Chain, world_from_b: &Chain) -> Self {
        let both = world_from_a.steps.iter().zip(&world_from_b.steps);
        let common = both.take_while(|(a, b)| a == b).count();
        let back = world_from_a.steps[common..]
            .iter()
            .rev()
            .map(ChainStep::inverse);
        let forth = world_from_b.steps[common..].iter().copied();
        Self {
            steps: back.chain(forth).collect(),
        }
    }

    /// By the joint that connects two links of a table, from a frame of the one to a frame of the other.
    pub fn of_joint(steps: &[ChainStep], [before, after]: [Pose; 2]) -> Self {
        let ends = [before, after].map(|pose| ChainStep::Fixed(pose.into()));
        let mut list = vec![ends[0]];
        list.extend(steps);
        list.push(ends[1]);
        Self { steps: list }
    }

    /// The chain the other way round.
    pub fn back(&self) -> Self {
        Self {
            steps: self.steps.iter().rev().map(ChainStep::inverse).collect(),
        }
    }

    /// How many joints stand between the bodies.
    pub fn joints(&self) -> usize {
        self.steps.iter().filter(|s| s.joint().is_some()).count()
    }

    /// Length of the chain: of its constant parts, and of its translations where they are largest.
    pub fn longest<'a>(&self, poses: impl Iterator<Item = &'a Vec<ArgumentValue>> + Clone) -> f64 {
        let length = |step: &ChainStep| match *step {
            ChainStep::Fixed(pose) => pose.translation.length(),
            ChainStep::Joint {
                motion: ElementaryMotion::Translation,
                argument,
                ..
            } => {
                let values = poses.clone().map(|pose| pose[argument].value.abs());
                values.fold(0.0, f64::max)
            }
            ChainStep::Joint { .. } => 0.0,
        };
        self.steps.iter().map(length).sum()
    }

    /// The steps from one body to the other.
    pub fn steps(&self) -> &[ChainStep] {
        &self.steps
    }

    /// Arguments of its joints.
    pub fn arguments(&self) -> impl Iterator<Item = usize> + '_ {
        self.steps
            .iter()
            .filter_map(|step| Some(step.joint()?.argument))
    }

    /// By how much b's view of a direction of a changes, at most: |(R - R₀)ᵀ n|. Turning about the direction itself changes nothing.
    pub fn turned(&self, arguments: &[TaylorModel], n: DVec3) -> f64 {
        let mut here = Pose::IDENTITY;
        let mut turned = 0.0;
        let middle: Vec<ArgumentValue> = centres(arguments);
        walk_chain(&self.steps, &mut here, &middle, |here: &Pose, joint| {
            if joint.motion == ElementaryMotion::Rotation {
                // Seen after the joints before, the direction is off by what these turned it.
                let across = here.rotation.col(joint.axis).cross(n).length() + turned;
                turned += arguments[joint.argument].size_of_change() * across;
            }
        });
        turned * WIDER + if turned > 0.0 { LOST } else { 0.0 }
    }

    /// How far the line from a's origin to b's may turn as seen from a.
    pub fn tilt(&self, arguments: &[TaylorModel], middle: &[ArgumentValue]) -> f64 {
        if self.joints() == 0 {
            return 0.0;
        }
        let span = self.pose(middle).translation;
        let mut here = Pose::IDENTITY;
        // Translations move its end along known directions, what turns anywhere.
        let (mut across, mut along) = (0.0, 0.0);
        let mut turns = false;
        walk_chain(&self.steps, &mut here, middle, |here: &Pose, joint| {
            let off = arguments[joint.argument].size_of_change();
            turns |= joint.motion == ElementaryMotion::Rotation;
            let axis = here.rotation.col(joint.axis);
            across += off * axis.cross(span).length() / span.length();
            along += off;
        });
        if turns || !across.is_finite() {
            across = self
                .around(arguments, 0.0, 1.0)
                .distance((DVec3::ZERO, 0.0));
            along = across;
        }
        match across {
            0.0 => 0.0,
            across if along < span.length() => across / (span.length() - along),
            _ => f64::INFINITY,
        }
    }

    /// The pose `a_from_b`.
    pub fn pose(&self, arguments: &[ArgumentValue]) -> Pose {
        let mut pose = Pose::IDENTITY;
        walk_chain(&self.steps, &mut pose, arguments, |_, _| {});
        pose
    }

    /// The motion within `half` of the position `s` in a stretch.
    ///
    /// With ξᵢ the twist of joint i, which moves by wayᵢ u + bendᵢ u² to within offᵢ, the two terms are those of
    /// Π exp(ξᵢ (wayᵢ u + bendᵢ u²)). The rest is bounded joint by joint: a derivative by several joints is no larger
    /// than the reach from the last of them to the point.
    pub fn around(&self, arguments: &[TaylorModel], s: f64, half: f64) -> RelativeMove {
        let mut moving = MovingBody {
            s,
            half,
            moved: RelativeMove {
                off: 0.0,
                off_by_reach: 0.0,
                ..RelativeMove::unknown(Pose::IDENTITY)
            },
            turned: 0.0,
            linear: 0.0,
            length: 0.0,
            off_by_length: 0.0,
        };
        walk_chain(&self.steps, &mut moving, arguments, |_, _| {});
        // A joint's reach is the whole length less that before it.
        let mut moved = moving.moved;
        moved.turning = [moved.spin.length(), operator_norm(&moved.twist)];
        let whole = moved.off_by_reach * moving.length;
        moved.off += (whole - moving.off_by_length).max(0.0) + LOST * whole;
        match moved.is_known() {
            true => moved,
            false => RelativeMove::unknown(moved.pose),
        }
    }
    /// What the bounds of the arguments alone let the points of a ball deviate by at the place `s`, however short the time.
    pub fn blur(&self, arguments: &[TaylorModel], s: f64, ball: (DVec3, f64)) -> f64 {
        self.around(arguments, s, 0.0).deviation(ball)
    }
}
