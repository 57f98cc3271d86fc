//! How far inputs move within a step: a pose at its end says nothing about a drive that has gone elsewhere and come back, or
//! about two singular poses that a crank passes within one turn.

use super::path_tracker::{PathPoint, PathTracker};
use crate::model::actuation::Actuation;
use crate::model::drive::Drive;
use crate::model::mechanism::Kind;
use crate::numbers::interval::Interval;
use std::f64::consts::FRAC_PI_2;

/// A step turns no input farther than this, radians: linkages flatten at every half turn.
const FARTHEST_TURN: f64 = FRAC_PI_2;

/// Within a step an input may leave the range between its ends by this much, radians or mechanism sizes.
const STRAY: f64 = 0.01;

/// Parts of a step over which a drive is bounded, since bounds of a formula that has its time in several places are too wide.
const PARTS: usize = 8;

/// The drives that may turn back: all but constant ones and those that are straight in time.
pub(super) fn turning_drives(actuation: &Actuation) -> Vec<usize> {
    let may_turn = |drive: &Drive| match drive {
        Drive::Formula(formula) => formula.affine().is_none(),
        Drive::Keys { .. } => !drive.is_constant(),
    };
    let drives = actuation.drives.iter().enumerate();
    let turning = drives.filter(|(_, drive)| may_turn(drive));
    turning.map(|(index, _)| index).collect()
}

/// The values of a drive between two instants; `None` if it may have none.
fn drive_range(drive: &Drive, times: Interval) -> Option<Interval> {
    match drive {
        Drive::Formula(formula) => formula.range(&[times]),
        Drive::Keys { .. } => {
            let keys = drive.keys().iter().copied();
            let inside = keys.filter(|t| times.lo < *t && *t < times.hi);
            let all = [times.lo, times.hi].into_iter().chain(inside);
            all.map(|t| Interval::point(drive.value(t)))
                .reduce(Interval::hull)
        }
    }
}

impl PathTracker<'_> {
    /// Whether inputs move farther between a pose and the instant of other inputs than a single step may take them.
    pub(crate) fn strays(&self, here: &PathPoint, time: f64, inputs: &[f64]) -> bool {
        let mechanism = self.system().mechanism();
        let from = &here.coordinates[self.unknowns()..];
        let kinds = mechanism.inputs.iter().map(|input| input.kind);
        let mut turns = kinds.zip(from.iter().zip(inputs));
        if turns.any(|(kind, (a, b))| kind == Kind::Angle && (b - a).abs() > FARTHEST_TURN) {
            return true;
        }
        let mut turning = self.turning.iter();
        turning.any(|index| {
            let unit = match mechanism.inputs[*index].kind {
                Kind::Angle => 1.0,
                Kind::Length | Kind::Number => mechanism.size,
            };
            let ends = Interval::point(from[*index]).hull(Interval::point(inputs[*index]));
            let allowed = ends + Interval::around_zero(STRAY * unit);
            let drive = &self.actuation().drives[*index];
            let within = |[a, b]: [f64; 2]| {
                let times = Interval::point(a).hull(Interval::point(b));
                let range = drive_range(drive, times);
                range.is_none_or(|range| allowed.lo <= range.lo && range.hi <= allowed.hi)
            };
            let at = |k: usize| match k {
                0 => here.time,
                PARTS => time,
                k => here.time + (time - here.time) * (k as f64 / PARTS as f64),
            };
            !within([here.time, time]) && !(0..PARTS).all(|k| within([at(k), at(k + 1)]))
        })
    }
}
