//! Twists of links along chains for given rates of the coordinates, and the lines of pure rotations.

use crate::math::Pose;
use crate::model::chain::{Argument, ArgumentValue, Chain, ElementaryMotion};
use crate::model::mechanism::Mechanism;
use crate::model::walk::walk_chain;
use glam::DVec3;

/// Below this fraction of the fastest coordinate (radians, sizes) a rate counts as zero. Null vectors at closed poses
/// are accurate to about ten digits, and so are the twists computed from them.
pub const STILL: f64 = 1e-6;

/// A line in space: direction and moment about the origin over the size.
pub type PluckerLine = (DVec3, DVec3);

/// Angular velocity, and velocity at the origin over the size.
pub type Twist = (DVec3, DVec3);

/// Combines a link's twist with the line found so far: `None` if it is neither zero nor a rotation about that line.
pub fn common_axis(found: Option<PluckerLine>, twist: Twist) -> Option<Option<PluckerLine>> {
    if twist.0.length() <= STILL && twist.1.length() <= STILL {
        return Some(found);
    }
    let line = line_of(twist)?;
    let fits = found.is_none_or(|known| same_line(&line, &known));
    fits.then_some(Some(line))
}

/// The line of a pure rotation.
pub fn line_of((turn, speed): Twist) -> Option<PluckerLine> {
    let rate = turn.length();
    let is_pure = rate > STILL && turn.dot(speed).abs() <= STILL * rate;
    is_pure.then(|| (turn / rate, speed / rate))
}

/// Whether two lines are the same, regardless of their direction.
pub fn same_line(a: &PluckerLine, b: &PluckerLine) -> bool {
    let sign = a.0.dot(b.0).signum();
    (a.0 - b.0 * sign).length() <= STILL && (a.1 - b.1 * sign).length() <= STILL
}

/// Twists along chains for one motion, in the frame in which a chain begins; speeds over the size.
pub struct TwistWalk {
    arguments: Vec<ArgumentValue>,
    rates: Vec<f64>,
    size: f64,
}

impl TwistWalk {
    /// The motion with the given rates of all coordinates, in their own units; speeds are told over `size`.
    pub fn new(mechanism: &Mechanism, pose: &[f64], rates: &[f64], size: f64) -> Self {
        let rate_of = |argument: &Argument| {
            let gradient = argument.gradient(pose).into_iter();
            gradient.map(|(slot, g)| g * rates[slot]).sum()
        };
        Self {
            arguments: mechanism.argument_values(pose),
            rates: mechanism.arguments.iter().map(rate_of).collect(),
            size,
        }
    }

    /// The joints of a chain in order, each with its own twist.
    fn chain_twists(&self, chain: &Chain) -> Vec<Twist> {
        let mut twists = Vec::new();
        let mut end = Pose::IDENTITY;
        walk_chain(&chain.steps, &mut end, &self.arguments, |here, joint| {
            // Twist of the joint at its rate, in the frame where the chain begins.
            let axis = here.rotation.col(joint.axis) * (joint.sign * self.rates[joint.argument]);
            twists.push(match joint.motion {
                ElementaryMotion::Rotation => (axis, here.translation.cross(axis) / self.size),
                ElementaryMotion::Translation => (DVec3::ZERO, axis / self.size),
            });
        });
        twists
    }

    /// Twists of the links after the joints of a loop.
    pub fn links(&self, mechanism: &Mechanism, index: usize) -> Vec<Twist> {
        let chain = &mechanism.loops[index].chain;
        let passages = mechanism.joints.along_loops[index].iter();
        let mut ends = passages.map(|passage| passage.steps.end).peekable();
        let (mut turn, mut speed, mut list) = (DVec3::ZERO, DVec3::ZERO, Vec::new());
        let mut twists = self.chain_twists(chain).into_iter();
        for (k, step) in chain.steps.iter().enumerate() {
            if let Some((t, s)) = step.joint().and_then(|_| twists.next()) {
                // Velocities of links are sums of the twists before them.
                turn += t;
                speed += s;
            }
            if ends.next_if_eq(&(k + 1)).is_some() {
                list.push((turn, speed));
            }
        }
        list
    }

    /// Twists of the single joints that take part.
    pub fn joints(&self, chain: &Chain) -> Vec<Twist> {
        let mut list = self.chain_twists(chain);
        list.retain(|(t, s)| t.length() > STILL || s.length() > STILL);
        list
    }

    /// Twist of the end of the chain.
    pub fn whole(&self, chain: &Chain) -> Twist {
        let twists = self.chain_twists(chain).into_iter();
        twists.fold((DVec3::ZERO, DVec3::ZERO), |sum, own| {
            (sum.0 + own.0, sum.1 + own.1)
        })
    }
}
