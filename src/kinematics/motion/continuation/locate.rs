//! Where exactly a singular pose was passed: the smallest singular value, with the determinant's sign, goes through
//! zero there as a smooth function of time. It is read off at some distance, where poses still have their digits.

use super::{Follower, Stand};
use crate::kinematics::results::trajectory::EventKind;
use crate::kinematics::solve::newton::Pace;
use crate::linalg::svd::{Conditioning, conditioning};

/// Nodes on either side of the singular pose.
const SIDE: usize = 3;

/// The nodes come closer by this factor from one round to the next.
const CLOSER: f64 = 0.125;

/// Rounds end when the nearest node's singular value falls below this share of the best one: at a share s a pose is
/// known to about u / s, and what the interpolation leaves out is of the order of s to the power 2 SIDE.
const NEAR_ENOUGH: f64 = 3e-3;

/// Most rounds; each takes three binary digits off the distance.
const ROUNDS: usize = 12;

/// Largest correction of a pose between two known ones, in scaled unknowns.
const MAX_CORRECTION: f64 = 0.05;

/// A crossing that waits for a pose behind it.
#[derive(Clone, Debug)]
pub(crate) struct Crossing {
    /// The event that says so.
    event: usize,
    /// A regular pose before it.
    before: Stand,
}

/// A place on the path with the tangent there.
struct Node {
    stand: Stand,
    rates: Vec<f64>,
    /// Signed singular value.
    value: f64,
}

impl Follower<'_> {
    /// The drive turned back on the singular pose of a sample, and the motion with it.
    pub(crate) fn left_singular_sample(&mut self) {
        if let Some(time) = self.singular_sample.take() {
            self.event(time, EventKind::SingularPoseMet);
        }
    }

    /// A singular pose near `time` has been passed.
    pub(crate) fn passed(&mut self, time: f64) {
        self.singular_sample = None;
        self.event(time, EventKind::SingularPosePassed);
        self.crossing = self.anchor.clone().map(|before| Crossing {
            event: self.trajectory.events.len() - 1,
            before,
        });
    }

    /// Locates the last crossing, now that there is a regular pose behind it.
    pub(crate) fn locate_crossing(&mut self, after: &Stand) {
        let Some(crossing) = self.crossing.take() else {
            return;
        };
        let Some(time) = self.zero_between(crossing.before, after.clone()) else {
            return;
        };
        let inputs = self.actuation.inputs_at(time);
        if let Some(event) = self.trajectory.events.get_mut(crossing.event) {
            event.time = time;
            event.inputs = inputs;
        }
    }

    /// Time at which the determinant of a block vanishes between two poses; `None` where none changes its sign, or
    /// where poses between them cannot be found.
    fn zero_between(&mut self, before: Stand, after: Stand) -> Option<f64> {
        let mut pairs = before.branch.signs.iter().zip(&after.branch.signs);
        let block = pairs.position(|(a, b)| a * b < 0)?;
        let (mut low, mut high) = (self.node(before, block), self.node(after, block));
        let mut zero = low.stand.time
            + (high.stand.time - low.stand.time) * low.value / (low.value - high.value);
        let mut spread = CLOSER * (high.stand.time - low.stand.time);
        for _ in 0..ROUNDS {
            let room = (zero - low.stand.time).min(high.stand.time - zero) / SIDE as f64;
            spread = spread.min(room);
            let mut nodes = Vec::with_capacity(2 * SIDE);
            for k in 1..=SIDE {
                for sign in [-1.0, 1.0] {
                    let time = zero + sign * spread * k as f64;
                    nodes.push(self.between(&low, &high, time, block)?);
                }
            }
            zero = inverse_at_zero(&nodes)?;
            let near = nodes
                .iter()
                .map(|n| n.value.abs())
                .fold(f64::INFINITY, f64::min);
            if near < NEAR_ENOUGH * self.best_sigma {
                return Some(zero);
            }
            for node in nodes {
                if node.stand.time < zero && node.stand.time > low.stand.time {
                    low = node;
                } else if node.stand.time > zero && node.stand.time < high.stand.time {
                    high = node;
                }
            }
            spread *= CLOSER;
        }
        None
    }

    fn node(&mut self, stand: Stand, block: usize) -> Node {
        let value = f64::from(stand.branch.signs[block]) * self.exact_sigma(&stand, block);
        let rates = self.rates(&stand);
        Node {
            stand,
            rates,
            value,
        }
    }

    /// Smallest singular value of a block to all digits: those of every pose are iterated, to a millionth, which would
    /// be seen in the place.
    fn exact_sigma(&mut self, stand: &Stand, block: usize) -> f64 {
        let mut sigma = stand.branch.sigma_min;
        let is_charted = self
            .chart
            .as_ref()
            .is_some_and(|c| c.is_needed(&stand.coordinates));
        if is_charted {
            return sigma;
        }
        let system = self.system;
        let structure = system.structure();
        let (rows, columns) = (
            structure.blocks[block].rows(),
            structure.blocks[block].unknowns.len(),
        );
        let exact = |index: usize, jacobian: &[f64], _: Conditioning, _: i8| {
            if index == block {
                sigma = conditioning(jacobian, rows, columns).sigma_min;
            }
        };
        let coordinates = &stand.coordinates;
        self.corrector.conditions(system, coordinates, exact);
        sigma
    }

    /// The pose at `time`, from the cubic through two others.
    fn between(&mut self, low: &Node, high: &Node, time: f64, block: usize) -> Option<Node> {
        let width = high.stand.time - low.stand.time;
        let s = (time - low.stand.time) / width;
        let (a, b) = (s * s * (3.0 - 2.0 * s), s * (1.0 - s));
        let inputs = self.inputs(time).ok()?;
        let n = self.system.mechanism().unknowns.len();
        let mut coordinates: Vec<f64> = (0..n)
            .map(|k| {
                let (p, q) = (low.stand.coordinates[k], high.stand.coordinates[k]);
                let bend = b * width * ((1.0 - s) * low.rates[k] - s * high.rates[k]);
                p + a * (q - p) + bend
            })
            .collect();
        coordinates.extend(inputs);
        let correction = self.correct(&mut coordinates, Pace::Brisk);
        if !correction.converged || correction.first_step > MAX_CORRECTION {
            return None;
        }
        let stand = self.stand(time, coordinates);
        Some(self.node(stand, block))
    }
}

/// Time at value zero of the polynomial through (value, time): Neville's scheme.
fn inverse_at_zero(nodes: &[Node]) -> Option<f64> {
    let x: Vec<f64> = nodes.iter().map(|n| n.value).collect();
    let mut p: Vec<f64> = nodes.iter().map(|n| n.stand.time).collect();
    for level in 1..nodes.len() {
        for i in 0..nodes.len() - level {
            p[i] = (x[i + level] * p[i] - x[i] * p[i + 1]) / (x[i + level] - x[i]);
        }
    }
    p[0].is_finite().then_some(p[0])
}
