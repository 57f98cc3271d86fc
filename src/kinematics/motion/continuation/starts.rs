//! Motions that start on a singular pose, where the tangent is undetermined although poses exist.

use super::recorder::{Recorder, is_singular_start};
use crate::kinematics::motion::tracker::jump_sites::FormulaBehaviour;
use crate::kinematics::motion::tracker::path_tracker::PathPoint;
use crate::kinematics::results::trajectory::EventKind;
use crate::kinematics::solve::assembly::shake_start;
use crate::kinematics::solve::turns::WholeTurns;

/// After a singular start poses are sought at this fraction of the sampling interval: late enough for the branches to
/// have separated.
const BESIDE_START: f64 = 0.1;

/// Number of starts around the singular pose that are tried, and their largest distance from it, in scaled unknowns.
const STARTS: usize = 16;
const AROUND: f64 = 0.2;

/// Beyond this distance from the singular pose, in scaled unknowns, there is another assembly.
const OTHER_ASSEMBLY: f64 = 0.6;

impl Recorder<'_> {
    /// A motion that starts at a fold has no tangent there: the next pose is assembled from the start values, which
    /// select one of the branches that meet there.
    pub(crate) fn leave_start(&mut self, end: &PathPoint, time: f64) -> Option<PathPoint> {
        let is_start = self.samples.len() == 1;
        if !is_start || end.time > self.samples[0].time {
            return None;
        }
        // No tangent exists: assembled anew at the next inputs, no farther than a step may go.
        let time = self.tracker.reach(end, time);
        let inputs = self.tracker.inputs(time).ok()?;
        let start = [self.tracker.actuation().guess.clone(), inputs].concat();
        let found = self.tracker.solver.assembled(&start, None).ok()?;
        self.tracker.solver.iterations += found.iterations;
        let beyond = self.tracker.point(time, found.coordinates);
        // A pose behind what may be a jump of the formulas is not on the way.
        let way = self
            .tracker
            .way_between(&end.coordinates, &beyond.coordinates);
        let is_smooth = matches!(way, FormulaBehaviour::Smooth | FormulaBehaviour::Kink);
        is_smooth.then(|| self.tracker.keep(beyond, &mut self.events))
    }

    /// A motion that starts where branches meet can continue in several ways. Poses just beyond are found from many
    /// starts around; the one nearest to the start values is taken.
    pub(crate) fn leave_singular_start(
        &mut self,
        from: &PathPoint,
        time: f64,
    ) -> Option<PathPoint> {
        let is_start = self.samples.len() == 1;
        if !is_start || !is_singular_start(&from.branch) {
            return None;
        }
        let beside = from.time + BESIDE_START * (time - from.time);
        let beside = self.tracker.reach(from, beside);
        let inputs = self.tracker.inputs(beside).ok()?;
        let mut best: Option<(f64, PathPoint)> = None;
        let mut met: Vec<String> = Vec::new();
        // Of the branches that leave the singular start the one nearest to the start values is taken.
        for attempt in 0..STARTS {
            let Some(beyond) = self.branch_beyond(from, (beside, &inputs), attempt) else {
                continue;
            };
            let guess = &self.tracker.actuation().guess;
            let far = self.tracker.solver.apart(&beyond.coordinates, guess);
            let signature = beyond.branch.signature();
            if self.tracker.is_usable(&beyond.branch) && !met.contains(&signature) {
                met.push(signature);
            }
            if best.as_ref().is_none_or(|(least, _)| far < *least) {
                best = Some((far, beyond));
            }
        }
        let (_, beyond) = best?;
        self.tracker.anchor = Some(beyond.clone());
        if !self.tracker.is_usable(&beyond.branch) {
            return None;
        }
        let taken = beyond.branch.signature();
        met.retain(|other| *other != taken);
        met.sort();
        self.event(from.time, EventKind::BranchChosen { taken, others: met });
        Some(beyond)
    }

    /// A pose at the given time and inputs near the singular pose `from`, assembled from start number `attempt` around
    /// it.
    fn branch_beyond(
        &mut self,
        from: &PathPoint,
        (time, inputs): (f64, &[f64]),
        attempt: usize,
    ) -> Option<PathPoint> {
        let mechanism = self.tracker.system().mechanism();
        let solver = &mut self.tracker.solver;
        let mut start = [&from.coordinates[..mechanism.unknowns.len()], inputs].concat();
        let amplitude = AROUND * attempt as f64 / STARTS as f64;
        shake_start(mechanism, attempt, amplitude, &mut start);
        let mut found = solver.assembled(&start, None).ok()?;
        solver.iterations += found.iterations;
        // Whole turns away from the old pose are not another assembly.
        let turns = WholeTurns::between(mechanism, &from.coordinates, &found.coordinates);
        let pairs = found.coordinates.iter_mut().zip(turns);
        pairs.for_each(|(q, turn)| *q -= turn);
        let is_near = solver.apart(&found.coordinates, &from.coordinates) <= OTHER_ASSEMBLY;
        is_near.then(|| self.tracker.point(time, found.coordinates))
    }
}
