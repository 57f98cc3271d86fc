//! Measures of a whole motion or track, not only of its samples: smallest distances, minima and maxima
//! of formulas, each with a bound on the other side.

use super::extremes::greatest;
use super::motion::ProvedMotion;
use super::sweep::{Least, PairSweep};
use crate::distance::bodies::BodyElements;
use crate::distance::solids::left_out;
use crate::model::distance::{Distance, SolidPair};
use crate::model::expression::{Expression, Op};
use crate::model::measure::{Measure, MeasureSource, Taking};
use crate::model::mechanism::{Mechanism, OutputSource};

/// A measure of the whole motion lies between `value` and `bound`.
#[derive(Clone, Copy, Debug)]
pub struct BoundedMeasure {
    /// Found at solved poses, in internal units.
    pub value: f64,
    /// Its bound, if certified; never on the other side of the value. Infinite where parts of the motion are unknown.
    pub bound: f64,
    /// Whether the bound is above the value: of all but minima.
    pub is_upper: bool,
    /// The time at which it occurs, in seconds; a range has none.
    pub time: Option<f64>,
    /// Whether the bound is proved.
    pub is_certified: bool,
    /// Whether the motion has a pose at all times; nothing is known about times without one.
    pub is_whole: bool,
    /// Whether the time of the run ended the search: more of it gives a nearer bound.
    pub is_cut_off: bool,
    /// How far value and bound may exceed a limit that holds: rounding of the poses.
    pub slack: f64,
    /// One body is inside the other somewhere: the distance alone is not sufficient.
    pub is_enclosed: bool,
    /// It is a distance of bodies.
    pub is_distance: bool,
    /// It is a formula of such distances, of which only the least is bounded.
    pub uses_distances: bool,
}

/// Whether a measure is taken over the whole motion, which requires certified poses.
pub fn is_of_whole_motion(mechanism: &Mechanism, measure: &Measure) -> bool {
    formula_of(mechanism, measure).is_some() || distance_of(mechanism, measure).is_some()
}

/// Bounds a measure over a motion with certified poses, that of the drive or of the measure's track; `None` if it is a measure
/// of the samples, or undefined at some of them. Smallest distances are found to `tolerance`.
pub fn known(
    motion: &mut ProvedMotion,
    measure: &Measure,
    tolerance: f64,
) -> Option<BoundedMeasure> {
    let found = bounded(motion, measure, tolerance)?;
    let bound = match (motion.gaps.is_empty(), found.is_upper) {
        (true, _) => found.bound,
        (false, true) => f64::INFINITY,
        (false, false) => f64::NEG_INFINITY,
    };
    Some(BoundedMeasure {
        bound,
        is_cut_off: std::mem::take(&mut motion.is_cut_off),
        ..found
    })
}

/// The same over what is known of the motion.
fn bounded(motion: &mut ProvedMotion, measure: &Measure, tolerance: f64) -> Option<BoundedMeasure> {
    let mechanism = motion.system.mechanism();
    if let Some(distance) = distance_of(mechanism, measure) {
        return least_distance(motion, distance, measure.min.unwrap_or(0.0), tolerance);
    }
    let (formula, taking) = formula_of(mechanism, measure)?;
    let mut end = |sign: f64| greatest(motion, formula, sign);
    // Maxima are searched; a minimum is the maximum of the negative.
    let (found, sign) = match taking {
        Taking::Max => (end(1.0)?, 1.0),
        Taking::Min => (end(-1.0)?, -1.0),
        Taking::Largest => (end(1.0)?.or(end(-1.0)?), 1.0),
        _ => (end(1.0)?.plus(end(-1.0)?), 1.0),
    };
    Some(BoundedMeasure {
        value: sign * found.value,
        bound: sign * found.bound.max(found.value),
        is_upper: sign > 0.0,
        time: found.time,
        is_certified: found.is_certified,
        is_whole: motion.gaps.is_empty(),
        is_cut_off: false,
        slack: measure.slack(found.value),
        is_enclosed: false,
        is_distance: false,
        uses_distances: motion.system.mechanism().uses_distances(formula),
    })
}

/// The formula whose extreme value a measure takes; formulas with rates are evaluated at samples only.
fn formula_of<'m>(mechanism: &Mechanism, measure: &'m Measure) -> Option<(&'m Expression, Taking)> {
    let MeasureSource::Over {
        of,
        rates,
        per: None,
        taking: taking @ (Taking::Max | Taking::Min | Taking::Largest | Taking::Range),
        ..
    } = &measure.source
    else {
        return None;
    };
    let formula = of.first()?;
    let is_plain = rates.is_empty() && !mechanism.uses_rates(formula);
    is_plain.then_some((formula, *taking))
}

/// The distance whose minimum a measure takes.
pub fn distance_of<'m>(mechanism: &'m Mechanism, measure: &Measure) -> Option<&'m Distance> {
    let MeasureSource::Over {
        of,
        per: None,
        taking: Taking::Min,
        ..
    } = &measure.source
    else {
        return None;
    };
    let base = mechanism.coordinate_count() + 3 * mechanism.traces.len();
    let [formula] = of.as_slice() else {
        return None;
    };
    let outputs = mechanism.outputs.iter().enumerate();
    let mut asked = outputs.filter_map(|(k, output)| match &output.source {
        OutputSource::Distance(distance) => Some((k, distance)),
        OutputSource::Formula(_) | OutputSource::Rated(_) => None,
    });
    let found = asked.find(|(k, _)| *formula == Expression::new(vec![Op::Slot(base + k)]));
    found.map(|(_, distance)| distance)
}

/// The least of a distance over a motion, with its bound as near as `tolerance` asks; `limit` is what it must not fall below,
/// zero if anything goes.
fn least_distance(
    motion: &mut ProvedMotion,
    distance: &Distance,
    limit: f64,
    tolerance: f64,
) -> Option<BoundedMeasure> {
    let of = |gap: &SolidPair| of_pair(motion, gap, limit, tolerance);
    let found: Option<Vec<BoundedMeasure>> = distance.gaps.iter().map(of).collect();
    found?.into_iter().reduce(|a, b| {
        let nearest = if b.value < a.value { b } else { a };
        BoundedMeasure {
            bound: a.bound.min(b.bound),
            is_certified: a.is_certified && b.is_certified,
            slack: a.slack.max(b.slack),
            is_enclosed: a.is_enclosed || b.is_enclosed,
            ..nearest
        }
    })
}

fn of_pair(
    motion: &mut ProvedMotion,
    gap: &SolidPair,
    limit: f64,
    tolerance: f64,
) -> Option<BoundedMeasure> {
    let bodies = gap.bodies.map(|k| &motion.system.mechanism().bodies[k]);
    // The solids of both bodies; pairs of them that the distance does not name are left out.
    let hulls = [BodyElements::new(bodies[0])?, BodyElements::new(bodies[1])?];
    let hulls = hulls.each_ref();
    let left_out = left_out(hulls, &gap.shapes);
    // Branch and bound over the motion for the least distance.
    let sweep = PairSweep::new(motion, gap.bodies, hulls, tolerance, limit).without(&left_out);
    let Least {
        distance,
        time,
        bound,
        is_certified,
        is_enclosed,
        ..
    } = sweep.settled_least(motion)?;
    // A lower bound, which must not exceed the distance found.
    Some(BoundedMeasure {
        value: distance,
        bound: bound.min(distance),
        is_upper: false,
        time: Some(time),
        is_certified,
        is_whole: motion.gaps.is_empty(),
        is_cut_off: false,
        slack: sweep.slack(),
        is_enclosed,
        is_distance: true,
        uses_distances: false,
    })
}
