//! The broad phase: which bodies come near each other at all, by boxes around what they sweep.
//!
//! Over a stretch of the motion no point of a body leaves the box around it in the middle of the stretch, grown by the
//! farthest way of its points. So two bodies whose boxes are apart are as far apart, and that is proved as far as the
//! stretch is.

use super::motion::ProvedMotion;
use super::relative::RelativeChain;
use super::sweep::slack_of_poses;
use super::sweep_and_prune::{AxisBox, near_boxes};
use crate::distance::bodies::BodyElements;
use crate::distance::primitive::Element;
use crate::kinematics::certificate::tube::TaylorModel;
use crate::math::Pose;
use crate::model::chain::Chain;
use glam::DVec3;
use std::collections::HashSet;

/// Steps of the search for a distance that includes as many pairs as should be examined one by one.
const LEVELS: u32 = 64;

/// Halvings of the last step.
const HALVINGS: u32 = 12;

/// The first distance tried, in diagonals of all bodies together.
const FIRST: f64 = 1.0 / 65_536.0;

/// A stretch is swept in one piece if a body moves by no more than this part of its own radius, or of the distance asked, ...
const FINE: f64 = 0.5;

/// ... and else halved as often as this.
const SPLITS: u32 = 4;

/// A body as the broad phase sees it.
pub(super) struct Sweeper {
    /// Index of the body.
    pub(super) body: usize,
    /// Bodies of one part are never compared.
    part: usize,
    chain: RelativeChain,
    ball: (DVec3, f64),
    /// A box in the body's own frame: centre and half edges; `None` if it has no end.
    own: Option<[DVec3; 2]>,
    /// By how much poses may be off.
    slack: f64,
}

/// How far an element reaches along the axes of its body.
fn swept_reach(element: &Element) -> AxisBox {
    let (centre, radius) = element.bounds();
    let along = |n: DVec3| {
        let reach = element.core.support(n).map(|s| s + element.radius);
        reach.unwrap_or_else(|| n.dot(centre) + radius)
    };
    let [x, y, z] = DVec3::AXES;
    AxisBox {
        low: -DVec3::new(along(-x), along(-y), along(-z)),
        high: DVec3::new(along(x), along(y), along(z)),
    }
}

impl Sweeper {
    /// A body of the motion's mechanism, with its hull.
    pub(super) fn new(motion: &ProvedMotion, body: usize, hull: &BodyElements) -> Self {
        let mechanism = motion.system.mechanism();
        let chain = RelativeChain::new(&Chain::default(), &mechanism.bodies[body].world_from_body);
        let (centre, radius) = hull.ball;
        let extent = chain.longest(motion.poses()) + centre.length() + radius;
        let all = hull.elements.iter().map(swept_reach);
        let own = all.reduce(|a, b| a.around(&b)).filter(AxisBox::is_finite);
        Self {
            body,
            part: mechanism.joints.of_body[body],
            slack: slack_of_poses(motion, &chain, extent),
            chain,
            ball: hull.ball,
            // An open mesh does not notice a body inside it: it is examined with every other body.
            own: own
                .filter(|_| !hull.is_open())
                .map(|b| [0.5 * (b.low + b.high), 0.5 * (b.high - b.low)]),
        }
    }

    /// What it sweeps around the place `s` of a stretch, no farther than `half` from it. Parts in which it moves farther than
    /// `fine` are halved.
    fn swept(
        &self,
        arguments: &[TaylorModel],
        [s, half]: [f64; 2],
        fine: f64,
        splits: u32,
    ) -> AxisBox {
        let moved = self.chain.around(arguments, s, half);
        let way = moved.distance(self.ball);
        if way <= fine || splits == 0 || self.own.is_none() {
            return self.placed(&moved.pose, way);
        }
        // In two parts, whose boxes are smaller together.
        let half = 0.5 * half;
        let [first, second] =
            [s - half, s + half].map(|s| self.swept(arguments, [s, half], fine, splits - 1));
        first.around(&second)
    }

    /// What it sweeps around the place `s` of a stretch, as finely as the distance `apart` needs it.
    pub(super) fn over(
        &self,
        motion: &ProvedMotion,
        stretch: usize,
        place: [f64; 2],
        apart: f64,
    ) -> AxisBox {
        let fine = FINE * self.ball.1.max(apart);
        self.swept(&motion.stretches[stretch].arguments, place, fine, SPLITS)
    }

    fn placed(&self, pose: &Pose, grown: f64) -> AxisBox {
        let Some([centre, half]) = self.own else {
            return AxisBox::EVERYWHERE;
        };
        let centre = pose.transform_point(centre);
        let columns = [0, 1, 2].map(|k| pose.rotation.col(k).abs());
        // The half sides of a turned box, along the axes.
        let half = columns[0] * half.x + columns[1] * half.y + columns[2] * half.z;
        let half = half + DVec3::splat(grown + self.slack);
        let bounds = AxisBox {
            low: centre - half,
            high: centre + half,
        };
        match bounds.is_finite() {
            true => bounds,
            false => AxisBox::EVERYWHERE,
        }
    }
}

/// The bodies of a motion with shapes, before any two of them are compared.
pub(super) struct BroadPhase<'m> {
    motion: &'m ProvedMotion<'m>,
    bodies: Vec<Sweeper>,
    /// Samples at the end of no stretch.
    alone: Vec<usize>,
}

/// Pairs of bodies that come near each other.
pub(super) struct NearPairs {
    /// Ascending indices, in order.
    pub(super) pairs: Vec<[usize; 2]>,
    /// Lower bound for all other pairs, except those of one part.
    pub(super) apart: f64,
}

impl<'m> BroadPhase<'m> {
    /// All bodies with a hull.
    pub(super) fn new(motion: &'m ProvedMotion<'m>, hulls: &[Option<BodyElements>]) -> Self {
        let with_hull = hulls.iter().enumerate();
        let bodies =
            with_hull.filter_map(|(k, hull)| Some(Sweeper::new(motion, k, hull.as_ref()?)));
        Self {
            motion,
            bodies: bodies.collect(),
            alone: motion.alone(),
        }
    }

    /// All pairs, and those of them that are of one part.
    pub(super) fn counts(&self) -> [usize; 2] {
        let pairs = |n: usize| n * n.saturating_sub(1) / 2;
        let mut parts: Vec<usize> = self.bodies.iter().map(|b| b.part).collect();
        parts.sort_unstable();
        let rigid = parts.chunk_by(|a, b| a == b).map(|part| pairs(part.len()));
        [pairs(self.bodies.len()), rigid.sum()]
    }

    /// The pairs that come nearer than `minimum`, and further ones until they are about as many as `wanted`;
    /// `None` of a motion without poses.
    pub(super) fn near(&self, minimum: f64, wanted: usize) -> Option<NearPairs> {
        if self.moments() == 0 {
            return None;
        }
        let (apart, mut met) = self.level(minimum, wanted);
        for moment in 0..self.moments() {
            self.compare(&self.boxes(moment, apart), apart, |pair| {
                met.insert(pair);
                true
            });
        }
        let mut pairs: Vec<[usize; 2]> = met.into_iter().collect();
        pairs.sort_unstable();
        Some(NearPairs { pairs, apart })
    }

    /// Stretches of the motion, then samples that belong to none.
    fn moments(&self) -> usize {
        self.motion.roots + self.alone.len()
    }

    fn boxes(&self, moment: usize, apart: f64) -> Vec<AxisBox> {
        let motion = self.motion;
        let swept = |body: &Sweeper| match moment.checked_sub(motion.roots) {
            None => body.over(motion, moment, [0.0, 1.0], apart),
            Some(place) => {
                let pose = motion.body_pose(self.alone[place], body.body);
                body.placed(&pose, 0.0)
            }
        };
        self.bodies.iter().map(swept).collect()
    }

    /// A distance within which at most the wanted number of pairs lie at the beginning; the nearest pairs if there is none.
    /// It is never below `minimum`, however many pairs are within.
    fn level(&self, minimum: f64, wanted: usize) -> (f64, HashSet<[usize; 2]>) {
        let boxes = self.boxes(0, 0.0);
        let within = |apart: f64| {
            let mut met = HashSet::new();
            self.compare(&boxes, apart, |pair| {
                met.insert(pair);
                met.len() <= wanted
            });
            met
        };
        let finite = boxes.iter().filter(|b| b.is_finite()).copied();
        let all = finite.reduce(|a, b| a.around(&b));
        let diagonal = all.map_or(0.0, |b| (b.high - b.low).length());
        let (mut low, mut high) = (minimum, minimum.max(FIRST * diagonal));
        let mut more = within(high);
        // Doubled until too many pairs are within, then halved in between.
        for _ in 0..LEVELS {
            if more.len() > wanted || high == 0.0 {
                break;
            }
            low = high;
            high *= 2.0;
            more = within(high);
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            let met = within(middle);
            match met.len() > wanted {
                true => (high, more) = (middle, met),
                false => low = middle,
            }
        }
        let fewer = within(low);
        match fewer.is_empty() {
            true => (low, more),
            false => (low, fewer),
        }
    }

    /// Pairs of bodies whose boxes are at most this far apart, until `meet` returns `false`.
    fn compare(&self, boxes: &[AxisBox], apart: f64, mut meet: impl FnMut([usize; 2]) -> bool) {
        near_boxes(boxes, apart, |pair| {
            let [a, b] = pair.map(|k| &self.bodies[k]);
            a.part == b.part || meet([a.body.min(b.body), a.body.max(b.body)])
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::chain::{ArgumentValue, ChainStep, ElementaryMotion};

    /// A ball at the end of an arm that turns and grows: the box holds it at all places of the piece, however that is split.
    #[test]
    fn no_body_leaves_the_box_around_what_it_sweeps() {
        let joint = |motion, axis, argument| ChainStep::Joint {
            motion,
            axis,
            argument,
            sign: 1.0,
        };
        let turn = |axis, argument| joint(ElementaryMotion::Rotation, axis, argument);
        let steps = vec![
            turn(2, 0),
            joint(ElementaryMotion::Translation, 0, 1),
            turn(1, 2),
            joint(ElementaryMotion::Translation, 1, 1),
        ];
        let chain = RelativeChain::new(&Chain::default(), &Chain { steps });
        let (centre, radius) = (DVec3::new(0.7, -0.2, 0.4), 0.05);
        let sweeper = Sweeper {
            body: 0,
            part: 0,
            chain: chain.clone(),
            ball: (centre, radius),
            own: Some([centre, DVec3::splat(radius)]),
            slack: 0.0,
        };
        let mut tightest = f64::INFINITY;
        for round in 0..400 {
            let model = |k: usize| {
                let phase = (round * 3 + k) as f64;
                let mut model = TaylorModel::constant(2.0 * phase.sin());
                (model.c[1], model.c[2]) = (1.5 * (1.7 * phase).sin(), 0.4 * (2.3 * phase).sin());
                model
            };
            let models = [0, 1, 2].map(model);
            let (half, splits) = ([1.0, 0.3, 0.02][round % 3], (round % 5) as u32);
            let swept = sweeper.swept(&models, [0.0, half], 0.01, splits);
            for place in -16..=16 {
                let u = half * f64::from(place) / 16.0;
                let value =
                    |m: &TaylorModel| ArgumentValue::new(m.c[0] + u * (m.c[1] + u * m.c[2]));
                let pose = chain.pose(&models.each_ref().map(value));
                let at = pose.transform_point(centre);
                let inside = (at - radius - swept.low).min(swept.high - at - radius);
                assert!(
                    inside.min_element() >= -1e-12,
                    "{round} {place}: {at} {swept:?}"
                );
                tightest = tightest.min(inside.min_element() / half);
            }
        }
        // It is not made up by far too large a box.
        assert!(tightest < 0.3, "{tightest}");
    }
}
