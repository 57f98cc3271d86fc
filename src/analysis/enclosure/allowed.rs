//! The inverse problem: the largest tolerances for which every piece stays near the nominal motion.

use super::measures::enclose_measures;
use super::motion::{enclose_motion, shown_names};
use super::plan::TolerancePlan;
use crate::analysis::study::{FamilyError, Nominal};
use crate::model::mechanism::Kind;

/// Tolerances that keep a limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AllowedTolerance {
    /// Factor on the plan's tolerances that is proved to be small enough; zero if none was found.
    pub factor: f64,
    /// A factor for which the bound violates the limit.
    pub too_large: f64,
    /// Bound of the deviation from the nominal motion with the first factor, in the file's unit.
    pub bound: f64,
    /// With the larger factor nothing is proved: that, not the limit, is what ends the tolerances.
    pub is_open_beyond: bool,
    /// At how many poses of the motion.
    pub poses: usize,
}

/// Relative accuracy of the bisection between a factor that is small enough and one that is too large.
const SHARPNESS: f64 = 1e-4;

/// Factors that are tried lie between these.
const SHARES: [f64; 2] = [1e-12, 1e6];

/// A step by the ratio multiplies the factor by no less and no more than this: every step must change something, and far
/// from a factor its bound tells little.
const STEPS_UP: [f64; 2] = [1.001, 100.0];
const STEPS_DOWN: [f64; 2] = [0.01, 0.999];

/// The step down from a factor for which there is no bound.
const FAR_DOWN: f64 = 0.1;

/// Divides the limit instead of a bound of zero.
const NOT_ZERO: f64 = 1e-300;

/// Covers the rounding of a conversion to the file's unit.
const CONVERTED: f64 = 1.0 + 1e-14;

/// The largest factor on the plan's tolerances for which the quantity `name` (an unknown, a traced point, one of its
/// coordinates, an output, a measure) stays within `limit`, in the file's unit, of its nominal value; `None` if there
/// is no such quantity.
///
/// # Errors
/// A track that has no pose with the file's dimensions.
pub fn allowed_motion(
    plan: &TolerancePlan,
    name: &str,
    limit: f64,
    times: &[f64],
    threads: usize,
) -> Result<Option<AllowedTolerance>, FamilyError> {
    let names = shown_names(plan.family.mechanism());
    let part = format!("{name}.");
    let wanted: Vec<(usize, Kind)> = names
        .iter()
        .enumerate()
        .filter(|(_, (n, _))| n == name || n.starts_with(&part))
        .map(|(k, (_, kind))| (k, *kind))
        .collect();
    let mut measures = plan.family.measures.list.iter();
    let measure = measures.position(|m| m.name == name);
    // Largest deviation of the output with all tolerances multiplied by a factor.
    if !wanted.is_empty() {
        let reach = |factor| of_motion(&plan.scaled(factor), &wanted, times, threads);
        return Ok(Some(search_allowed(&reach, limit, times.len())));
    }
    let Some(index) = measure else {
        return Ok(None);
    };
    let nominal = plan.family.nominal()?;
    let reach = |factor| of_measure(&plan.scaled(factor), &nominal, index);
    Ok(Some(search_allowed(&reach, limit, nominal.poses.len())))
}

/// The largest factor that keeps the limit at so many poses.
fn search_allowed(reach: &dyn Fn(f64) -> f64, limit: f64, poses: usize) -> AllowedTolerance {
    let (mut low, mut at_low) = (0.0, 0.0);
    let (mut high, mut at_high) = (f64::INFINITY, 0.0);
    let mut share = 1.0;
    loop {
        let here = reach(share);
        if here <= limit {
            (low, at_low) = (share, here);
        } else {
            (high, at_high) = (share, here);
        }
        if high - low <= SHARPNESS * low || !(SHARES[0]..=SHARES[1]).contains(&share) {
            break;
        }
        // The bound is nearly proportional: first a step by the ratio, then bisection.
        share = match (low > 0.0, high.is_finite()) {
            (true, true) => 0.5 * (low + high),
            (true, false) => share * (limit / here.max(NOT_ZERO)).clamp(STEPS_UP[0], STEPS_UP[1]),
            (false, _) if here.is_finite() => {
                share * (limit / here).clamp(STEPS_DOWN[0], STEPS_DOWN[1])
            }
            (false, _) => FAR_DOWN * share,
        };
    }
    AllowedTolerance {
        factor: low,
        too_large: high,
        bound: at_low,
        is_open_beyond: !at_high.is_finite(),
        poses,
    }
}

/// Largest deviation of the bands from the nominal motion, in the file's unit; infinite if a sample has no band.
fn of_motion(plan: &TolerancePlan, wanted: &[(usize, Kind)], times: &[f64], threads: usize) -> f64 {
    let mechanism = plan.family.mechanism();
    let mut reach = 0.0_f64;
    for enclosed in enclose_motion(plan, times, threads, false) {
        let Ok(bands) = enclosed.bands else {
            return f64::INFINITY;
        };
        for (index, kind) in wanted {
            // The farther end of the band, in the file's unit.
            let band = &bands.list[*index];
            let unit = mechanism.file_units(*kind) * CONVERTED;
            let apart = (band.hi - band.nominal).max(band.nominal - band.lo) * unit;
            if apart.is_nan() {
                return f64::INFINITY;
            }
            reach = reach.max(apart);
        }
    }
    reach
}

/// The same for a measure: half the width of its band plus the offset of its centre.
fn of_measure(plan: &TolerancePlan, nominal: &Nominal, index: usize) -> f64 {
    // The measure's own band without tolerances contains its nominal value: the widest difference counts.
    let still = plan.scaled(0.0);
    let (Ok(bands), Ok(own)) = (
        enclose_measures(plan, nominal),
        enclose_measures(&still, nominal),
    ) else {
        return f64::INFINITY;
    };
    let mechanism = plan.family.mechanism();
    let unit = mechanism.file_units(plan.family.measures.list[index].kind) * CONVERTED;
    let (band, own) = (bands[index], own[index]);
    let apart = (band.hi - own.lo).max(own.hi - band.lo) * unit;
    if apart.is_nan() { f64::INFINITY } else { apart }
}
