//! Random start values that depend on the number of the start only.

use crate::model::mechanism::{Equation, Kind, Mechanism};
use std::collections::BTreeSet;
use std::f64::consts::PI;

/// Start values of lengths reach this many sizes to either side; a chain of a few links rarely spans more.
const REACH: f64 = 2.0;

/// Start values of unknowns that stand in equations alone reach this many of their magnitudes.
const FAR: f64 = 1e6;

/// Start values and inputs: the given ones for start 0, else random numbers that depend on the start's number only.
pub fn start_values(mechanism: &Mechanism, first: &[f64], start: usize) -> Vec<f64> {
    if start == 0 {
        return first.to_vec();
    }
    let unknowns = mechanism.unknowns.iter().enumerate();
    let formal = formal_unknowns(mechanism);
    let shaken = unknowns.map(|(slot, unknown)| {
        let random = random_unit(start as u64, slot as u64);
        if unknown.kind == Kind::Angle {
            return PI * random;
        }
        let scale = mechanism.scale_of(slot);
        match formal.contains(&slot) {
            true => {
                let magnitude = random_unit(start as u64, (slot + mechanism.unknowns.len()) as u64);
                scale * spread(random, magnitude)
            }
            false => REACH * scale * random,
        }
    });
    let inputs = &first[mechanism.unknowns.len()..];
    shaken.chain(inputs.iter().copied()).collect()
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
    formal.filter(|slot| !of_links.contains(slot)).collect()
}

/// A number about zero, or, half of the time, of any magnitude up to [`FAR`]: what stands in equations alone may be far from the
/// start value, as the roots of a polynomial are. Both arguments are random in -1..1.
fn spread(random: f64, magnitude: f64) -> f64 {
    match magnitude < 0.0 {
        true => REACH * random,
        false => random.signum() * libm::pow(FAR, magnitude),
    }
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
