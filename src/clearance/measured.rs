//! The least distance that a measure asks for: over the whole motion, with a bound, not only at the samples.

use super::motion::Motion;
use super::sweep::{Least, PairSweep};
use crate::distance::bodies::Hull;
use crate::distance::solids::left_out;
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::distance::{Distance, Gap};
use crate::model::expression::{Expression, Op};
use crate::model::measure::{Measure, MeasureSource, Taking};
use crate::model::mechanism::{Mechanism, OutputSource};

/// The least of a distance over the motion.
#[derive(Clone, Debug)]
pub struct LeastDistance {
    /// Where it is, and what it never is below.
    pub least: Least,
    /// By how much the bound may stay below a limit that is kept: rounding of the poses.
    pub slack: f64,
}

/// The distance of which a measure takes the least over the drive.
pub fn distance_of<'m>(mechanism: &'m Mechanism, measure: &Measure) -> Option<&'m Distance> {
    let MeasureSource::Over {
        track: None,
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
        OutputSource::Formula(_) => None,
    });
    let found = asked.find(|(k, _)| *formula == Expression::new(vec![Op::Slot(base + k)]));
    found.map(|(_, distance)| distance)
}

/// The least of a distance over a motion of certified poses, with its bound as near as `tolerance` asks; `limit` is
/// what it must not fall below, zero if anything goes.
pub fn least_distance(
    (system, actuation): (&System, &Actuation),
    trajectory: &Trajectory,
    distance: &Distance,
    limit: f64,
    tolerance: f64,
) -> Option<LeastDistance> {
    let mut motion = Motion::new(system, actuation, trajectory);
    let of = |gap: &Gap| of_pair(&mut motion, gap, limit, tolerance);
    let found: Option<Vec<LeastDistance>> = distance.gaps.iter().map(of).collect();
    let (mut slack, mut bound, mut is_certified) = (0.0_f64, f64::INFINITY, true);
    let mut least: Option<Least> = None;
    for next in found? {
        slack = slack.max(next.slack);
        bound = bound.min(next.least.bound);
        is_certified &= next.least.is_certified;
        if least
            .as_ref()
            .is_none_or(|least| next.least.distance < least.distance)
        {
            least = Some(next.least);
        }
    }
    let least = least?;
    Some(LeastDistance {
        least: Least {
            bound,
            is_certified,
            ..least
        },
        slack,
    })
}

fn of_pair(motion: &mut Motion, gap: &Gap, limit: f64, tolerance: f64) -> Option<LeastDistance> {
    let bodies = gap.bodies.map(|k| &motion.system.mechanism().bodies[k]);
    let hulls = [Hull::new(bodies[0])?, Hull::new(bodies[1])?];
    let hulls = hulls.each_ref();
    let left_out = left_out(hulls, &gap.shapes);
    let sweep = PairSweep::new(motion, gap.bodies, hulls, tolerance, limit).without(&left_out);
    let least = sweep.least_over(motion, &mut Vec::new())?;
    let slack = sweep.slack();
    Some(LeastDistance { least, slack })
}
