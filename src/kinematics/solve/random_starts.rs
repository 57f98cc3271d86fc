//! Random start values that depend on the number of the start only.

use crate::model::mechanism::{Kind, Mechanism};
use std::f64::consts::PI;

/// Start values of lengths reach this many sizes to either side; a chain of a few links rarely spans more.
const REACH: f64 = 2.0;

/// Start values of numbers reach this many of their magnitudes.
const FAR: f64 = 1e4;

/// Largest closure error of an assembly that counts. Rounding leaves about 1e-15; a start that stopped beside a
/// pose leaves far more.
pub const CLOSED: f64 = 1e-12;

/// Start values and inputs: the given ones for start 0, else random numbers that depend on the start's number only.
pub fn start_values(mechanism: &Mechanism, first: &[f64], start: usize) -> Vec<f64> {
    if start == 0 {
        return first.to_vec();
    }
    let unknowns = mechanism.unknowns.iter().enumerate();
    let shaken = unknowns.map(|(slot, unknown)| {
        let random = random_unit(start as u64, slot as u64);
        match unknown.kind {
            Kind::Angle => PI * random,
            Kind::Length => REACH * mechanism.scale_of(slot) * random,
            Kind::Number => {
                let tenfold = random_unit(start as u64, (slot + mechanism.unknowns.len()) as u64);
                mechanism.scale_of(slot) * spread(random, tenfold)
            }
        }
    });
    let inputs = &first[mechanism.unknowns.len()..];
    shaken.chain(inputs.iter().copied()).collect()
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
