//! Where a motion has no pose between two samples that have one: formulas of drives without a value, loops that do not close.

use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::sorting::sort_by_number;

/// Even parts of an interval at whose ends a value is asked for, ...
const PARTS: u32 = 64;

/// ... and how often its beginning is halved for more of them: a proof ends right before the place where values do.
const HALVINGS: i32 = 20;

/// Steps that find an edge to all digits of a time.
const BISECTIONS: u32 = 60;

/// More gaps in one interval are one.
const MOST: usize = 16;

/// Stretches of an interval without a pose, in their order: those known of its loops, and those of its drives. There are values
/// at both of its ends.
pub(super) fn gaps(
    system: &System,
    actuation: &Actuation,
    [from, to]: [f64; 2],
    lacking: &[[f64; 2]],
) -> Vec<[f64; 2]> {
    // Loops: their known gaps, cut at the ends of the interval.
    let is_within = |gap: &&[f64; 2]| gap[0] < to && gap[1] > from;
    let known = lacking.iter().filter(is_within);
    let mut found: Vec<[f64; 2]> = known
        .map(|gap| gap.map(|time| time.clamp(from, to)))
        .collect();
    // Drives: one gap after another by sampling and bisection; the last that is allowed takes the rest.
    let mut at = from;
    for k in 0..MOST {
        let Some([off, on]) = first_gap(system, actuation, [at, to]) else {
            break;
        };
        let on = if k + 1 == MOST { to } else { on };
        found.push([off, on]);
        at = on;
    }
    // The union of both: gaps that overlap become one.
    sort_by_number(&mut found, |p| p[0]);
    let mut apart: Vec<[f64; 2]> = Vec::new();
    for [off, on] in found {
        match apart.last_mut() {
            Some(last) if off <= last[1] => last[1] = last[1].max(on),
            _ => apart.push([off, on]),
        }
    }
    apart
}

/// The first stretch without a value that is found, between the last instant before and one behind that have one.
fn first_gap(system: &System, actuation: &Actuation, [from, to]: [f64; 2]) -> Option<[f64; 2]> {
    let near = (1..=HALVINGS).map(|k| 0.5_f64.powi(k));
    let even = (1..PARTS).map(|k| f64::from(k) / f64::from(PARTS));
    let times = near.chain(even).map(|share| from + share * (to - from));
    let missing = times.filter(|time| !has_value(system, actuation, *time));
    let inside = missing.min_by(f64::total_cmp)?;
    // Between an instant with a value and one without.
    let edge = |mut with: f64, mut without: f64| {
        for _ in 0..BISECTIONS {
            let middle = 0.5 * with + 0.5 * without;
            match has_value(system, actuation, middle) {
                true => with = middle,
                false => without = middle,
            }
        }
        with
    };
    Some([edge(from, inside), edge(to, inside)])
}

/// Whether all drives have a value, and the joints of a chain without loops, which are known by the drives alone.
fn has_value(system: &System, actuation: &Actuation, time: f64) -> bool {
    let inputs = actuation.inputs_at(time);
    let mechanism = system.mechanism();
    let is_known = || {
        let arguments = mechanism.argument_values(&inputs);
        arguments.iter().all(|argument| argument.value.is_finite())
    };
    inputs.iter().all(|value| value.is_finite()) && (!mechanism.unknowns.is_empty() || is_known())
}
