//! Jumps, told by the formulas and not by their size: of an input, over which the drive gives no way on though poses exist,
//! and of what stands in the loops and equations, at which the motion ends.

use super::path_tracker::{PathPoint, PathTracker, SMALLEST_STEP, Unwatched};
use crate::model::actuation::Actuation;
use crate::model::chain::{Argument, ChainStep, ElementaryMotion};
use crate::model::expression::Expression;
use crate::model::mechanism::Mechanism;
use crate::numbers::constant::Constant;

/// A jump that changes by a larger share on the way may vanish at its place, as that of `floor(phi)*(phi - 1)` does.
const SAME_JUMP: f64 = 0.5;

/// A formula of a loop or an equation that may jump.
#[derive(Clone, Debug)]
pub(crate) struct JumpSite {
    formula: Expression,
    /// It is the angle of a rotation: whole turns are no jump.
    is_angle: bool,
    /// The loop or equation.
    name: String,
}

impl JumpSite {
    /// Those of a mechanism.
    pub fn all(mechanism: &Mechanism) -> Vec<Self> {
        let mut sites = Vec::new();
        for equation in mechanism
            .equations
            .iter()
            .filter(|e| e.expression.has_jumps())
        {
            sites.push(Self {
                formula: equation.expression.clone(),
                is_angle: false,
                name: equation.name.clone(),
            });
        }
        for item in &mechanism.loops {
            for step in &item.chain.steps {
                let ChainStep::Joint {
                    motion, argument, ..
                } = step
                else {
                    continue;
                };
                if let Argument::Formula(formula) = &mechanism.arguments[*argument]
                    && formula.has_jumps()
                {
                    sites.push(Self {
                        formula: formula.clone(),
                        is_angle: *motion == ElementaryMotion::Rotation,
                        name: item.name.clone(),
                    });
                }
            }
        }
        sites
    }

    /// By how much it jumps between two places, as it is at either.
    fn jump(&self, from: &[f64], to: &[f64]) -> Option<[f64; 2]> {
        let jump = self.formula.jump_on_way(from, to)?;
        let sizes = jump.map(|jump| {
            let turn = Constant::PI * Constant::exact(2.0);
            let rest = match self.is_angle {
                true => jump - turn * Constant::exact((jump / turn).number().round()),
                false => jump,
            };
            let is_rounding = rest.number().abs() <= rest.error();
            if is_rounding { 0.0 } else { rest.number() }
        });
        (sizes != [0.0; 2]).then_some(sizes)
    }
}

/// What formulas do on the way from one pose to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Way<'t> {
    /// They do not jump.
    Smooth,
    /// One may, or may not.
    Open,
    /// That of this loop or equation jumps.
    Jumps(&'t str),
}

impl PathTracker<'_> {
    /// What the formulas of loops and equations do on the way between two poses.
    pub(crate) fn way_between(&self, from: &[f64], to: &[f64]) -> Way<'_> {
        let mut way = Way::Smooth;
        for site in self.jump_sites.iter() {
            let Some([a, b]) = site.jump(from, to) else {
                continue;
            };
            let is_same = a.abs().min(b.abs()) >= SAME_JUMP * a.abs().max(b.abs());
            if is_same && (a < 0.0) == (b < 0.0) {
                return Way::Jumps(&site.name);
            }
            way = Way::Open;
        }
        way
    }

    /// Whether no formula is seen to jump between two poses.
    pub(crate) fn is_smooth(&self, from: &PathPoint, to: &PathPoint) -> bool {
        let way = self.way_between(&from.coordinates, &to.coordinates);
        !matches!(way, Way::Jumps(_))
    }

    /// The inputs right after a pose, and the time then, if the drive jumps there.
    pub fn jump_after(&self, point: &PathPoint) -> Option<(f64, Vec<f64>)> {
        let step = (4.0 * SMALLEST_STEP * self.interval).max(4.0 * f64::EPSILON * point.time.abs());
        let time = point.time + step;
        let inputs = self.inputs(time).ok()?;
        let jumps = self.actuation().jumps_between(point.time, time);
        jumps.is_any().then_some((time, inputs))
    }

    /// Over a jump of the drive the motion is followed as if the inputs went straight from their old values to the new;
    /// not beyond `last`.
    pub fn leap(&mut self, point: &PathPoint, last: f64) -> Option<PathPoint> {
        let (mut time, mut inputs) = self.jump_after(point)?;
        if time > last {
            time = last;
            inputs = self.inputs(time).ok()?;
        }
        if time <= point.time {
            return None;
        }
        // Across a jump the inputs are led along a straight line.
        let n = self.unknowns();
        let guess = self.actuation().guess.clone();
        let bridge = Actuation::straight(&point.coordinates[n..], &inputs, guess);
        let cancelled = || self.is_cancelled();
        let mut tracker = PathTracker::new(self.system(), &bridge, &cancelled);
        let begin = tracker.point(0.0, point.coordinates.clone());
        let begin = tracker.keep(begin, &mut Unwatched);
        let end = tracker.follow(begin, 1.0, &mut Unwatched);
        let iterations = tracker.solver.iterations;
        let end = end.ok()?;
        let mut coordinates = end.coordinates.to_vec();
        coordinates[n..].copy_from_slice(&inputs);
        self.solver.iterations += iterations;
        Some(self.point(time, coordinates))
    }
}
