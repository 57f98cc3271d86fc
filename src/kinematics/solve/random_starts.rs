//! Random start values that depend on the number of the start only.

use crate::model::equation_terms::finite_or_zero;
use crate::model::expression::Op;
use crate::model::mechanism::{Equation, Kind, Mechanism};
use std::collections::BTreeSet;
use std::f64::consts::PI;

/// Start values of lengths reach this many sizes to either side; a chain of a few links rarely spans more.
const REACH: f64 = 2.0;

/// Start values of unknowns that stand in equations alone reach this many times their magnitude, or the largest number in these
/// equations if that is more.
const FAR: f64 = 1e6;

/// The same of angles: every turn may hold a root, and starts that are far apart miss them.
const FAR_ANGLE: f64 = 1e3;

/// What random starts are made of, for one mechanism.
pub struct RandomStarts<'m> {
    mechanism: &'m Mechanism,
    /// By unknown: the least and the largest magnitude of those that no link limits.
    spreads: Vec<Option<[f64; 2]>>,
}

impl<'m> RandomStarts<'m> {
    /// For the unknowns of a mechanism.
    pub fn new(mechanism: &'m Mechanism) -> Self {
        let mut spreads = vec![None; mechanism.unknowns.len()];
        let counted = mechanism.counted_angles();
        for slot in formal_unknowns(mechanism) {
            let is_angle = mechanism.kind_of(slot) == Kind::Angle;
            // An angle that stands in sines and cosines alone has one turn.
            if !is_angle || counted.contains(&slot) {
                spreads[slot] = Some(spread_of(mechanism, slot, is_angle));
            }
        }
        Self { mechanism, spreads }
    }

    /// Start values and inputs: the given ones for start 0, else random numbers that depend on the start's number only.
    pub fn values(&self, first: &[f64], start: usize) -> Vec<f64> {
        if start == 0 {
            return first.to_vec();
        }
        let count = self.mechanism.unknowns.len();
        let unknowns = self.mechanism.unknowns.iter().enumerate();
        let shaken = unknowns.map(|(slot, unknown)| {
            let random = random_unit(start as u64, slot as u64);
            let usual = match unknown.kind {
                Kind::Angle => PI * random,
                Kind::Length | Kind::Number => REACH * self.mechanism.scale_of(slot) * random,
            };
            let Some([least, most]) = self.spreads[slot] else {
                return usual;
            };
            // About zero, or, half of the time, of any magnitude: what stands in equations alone may be far from the start value,
            // as the roots of a polynomial are.
            let magnitude = random_unit(start as u64, (slot + count) as u64);
            match magnitude < 0.0 {
                true => usual,
                false => random.signum() * least * libm::pow(most / least, magnitude),
            }
        });
        let inputs = &first[count..];
        shaken.chain(inputs.iter().copied()).collect()
    }

    /// The unknowns that no link limits, and how far from zero they start at most.
    pub fn reaches(&self) -> impl Iterator<Item = (usize, f64)> {
        let spreads = self.spreads.iter().enumerate();
        spreads.filter_map(|(slot, spread)| Some((slot, (*spread)?[1])))
    }
}

/// The least and the largest magnitude of start values: those of the unknown and of all numbers in its equations, and far more.
fn spread_of(mechanism: &Mechanism, slot: usize, is_angle: bool) -> [f64; 2] {
    let usual = if is_angle {
        PI
    } else {
        mechanism.scale_of(slot)
    };
    let equations = mechanism.equations.iter();
    let own = equations.filter(|e| e.expression.slots().contains(&slot));
    let ops = own.flat_map(|equation| equation.expression.ops());
    let numbers = ops.filter_map(|op| match op {
        Op::Constant(value) => Some(finite_or_zero(value.number())),
        _ => None,
    });
    let numbers = numbers.filter(|value| value.is_normal());
    let [least, most] = numbers.fold([usual; 2], |[a, b], n| [a.min(n), b.max(n)]);
    let far = if is_angle { FAR_ANGLE } else { FAR };
    // What is smaller than an angle's turn is met without.
    let least = if is_angle { usual } else { least };
    [least, (far * most).min(f64::MAX)]
}

/// Unknowns of equations that no loop and no bar contains: no link tells how far they reach.
fn formal_unknowns(mechanism: &Mechanism) -> BTreeSet<usize> {
    let steps = mechanism.loops.iter().flat_map(|l| l.chain.arguments());
    let of_loops = steps.flat_map(|argument| mechanism.arguments[argument].coordinates());
    let is_bar = |e: &&Equation| mechanism.bars.iter().any(|bar| bar.name == e.name);
    let (bars, others): (Vec<_>, Vec<_>) = mechanism.equations.iter().partition(is_bar);
    let slots = |e: &Equation| e.expression.slots();
    let of_bars = bars.into_iter().flat_map(slots);
    let of_links: BTreeSet<usize> = of_loops.chain(of_bars).collect();
    let formal = others.into_iter().flat_map(slots);
    let is_unknown = |slot: &usize| *slot < mechanism.unknowns.len();
    formal
        .filter(|slot| is_unknown(slot) && !of_links.contains(slot))
        .collect()
}

/// A number in -1..1 from a key and a counter: the finaliser of SplitMix64 (Steele, Lea, Flood 2014), twice.
pub(crate) fn random_unit(key: u64, counter: u64) -> f64 {
    let mix = |mut z: u64| {
        z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    let bits = mix(mix(key).wrapping_add(counter));
    (bits >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}
