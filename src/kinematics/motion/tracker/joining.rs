//! The poses that join two others across a singular one. Two folds that face each other over a gap have none.

use super::path_tracker::{PathPoint, PathTracker};
use crate::kinematics::certificate::absence::is_equation_open;
use crate::kinematics::solve::newton::Pace;
use crate::numbers::interval::Interval;

/// Where poses between two others are looked for, as shares of the time. No two are alike as seen from both ends: a gap whose
/// ends are mirror images may hold a single pose in its middle.
const BETWEEN: [f64; 5] = [0.11, 0.29, 0.5, 0.67, 0.83];

/// How often the two neighbours of the least regular instant so far are looked at more closely: a gap that is narrow beside
/// the way across it lies where the singular value is least. So many rounds come down to less than 1e-11 of that way.
const ROUNDS: usize = 44;

/// Where between two instants the next one lies. Not in the middle, for the same reason as above.
const NEXT: f64 = 0.45;

/// What counts as the rounding of an equation: its value if every coordinate is off by this share of itself, and by the last
/// digit of its scale. About a flat singular pose all terms are small, and so must be what they leave.
const ROUNDING: f64 = 1e-13;

/// A correction may end at the residual's own floor, where small terms are not yet balanced: so many follow, as many as halve
/// the error of a double root down to rounding.
const MOST_CORRECTIONS: usize = 50;

/// A pose on the way from one to another, at a share of the time between them.
struct IntermediatePose {
    share: f64,
    pose: Vec<f64>,
    sigma_min: f64,
}

impl PathTracker<'_> {
    /// Poses between two others, if there is one at every instant that is looked at.
    pub(super) fn joining(&mut self, a: &PathPoint, b: &PathPoint) -> Option<Vec<Vec<f64>>> {
        let ends = [(0.0, a), (1.0, b)].map(|(share, end)| IntermediatePose {
            share,
            pose: end.coordinates.to_vec(),
            sigma_min: end.branch.sigma_min,
        });
        let mut found = Vec::from(ends);
        // A few instants first: a wide gap is met at once.
        for share in BETWEEN {
            self.look_between([a.time, b.time], share, &mut found)?;
        }
        // Then ever nearer to where the poses are least regular.
        for _ in 0..ROUNDS {
            let least = (0..found.len())
                .min_by(|&i, &j| found[i].sigma_min.total_cmp(&found[j].sigma_min))?;
            let here = found[least].share;
            let beside = [least.wrapping_sub(1), least + 1];
            let shares = beside.map(|i| Some(here + NEXT * (found.get(i)?.share - here)));
            for share in shares.into_iter().flatten() {
                self.look_between([a.time, b.time], share, &mut found)?;
            }
        }
        found.pop();
        Some(found.into_iter().skip(1).map(|b| b.pose).collect())
    }

    /// Adds the pose at a share of the time between two instants, found from its neighbours; `None` if there is none.
    fn look_between(
        &mut self,
        [from, to]: [f64; 2],
        share: f64,
        found: &mut Vec<IntermediatePose>,
    ) -> Option<()> {
        let time = from + share * (to - from);
        let inputs = self.inputs(time).ok()?;
        let place = found.partition_point(|b| b.share < share);
        let [before, behind] = [found.get(place.checked_sub(1)?)?, found.get(place)?];
        let way = (share - before.share) / (behind.share - before.share);
        // At an inflection what lies between two poses is worse than either.
        let pose = [way, 0.0, 1.0].into_iter().find_map(|way| {
            let pairs = before.pose.iter().zip(&behind.pose).take(self.unknowns());
            let unknowns = pairs.map(|(a, b)| a + way * (b - a));
            self.closed_to_rounding(unknowns.chain(inputs.iter().copied()).collect())
        })?;
        let sigma_min = self.solver.observe(&pose).sigma_min;
        found.insert(
            place,
            IntermediatePose {
                share,
                pose,
                sigma_min,
            },
        );
        Some(())
    }

    /// A pose next to another that closes to rounding.
    fn closed_to_rounding(&mut self, mut pose: Vec<f64>) -> Option<Vec<f64>> {
        // Each correction ends where the whole system closes; the small terms may not be balanced there.
        for _ in 0..MOST_CORRECTIONS {
            if !self.solver.closed(&mut pose, Pace::Patient) {
                return None;
            }
            if self.is_closed_to_rounding(&pose) {
                return Some(pose);
            }
        }
        None
    }

    /// Whether the equations close to the rounding of their own terms.
    fn is_closed_to_rounding(&self, pose: &[f64]) -> bool {
        let mechanism = self.system().mechanism();
        let about = |(slot, value): (usize, &f64)| {
            let digit = f64::EPSILON * mechanism.scale_of(slot);
            Interval::point(*value) + Interval::around_zero(ROUNDING * value.abs() + digit)
        };
        let place: Vec<Interval> = pose.iter().enumerate().map(about).collect();
        let mut equations = mechanism.equations.iter();
        equations.all(|equation| !is_equation_open(equation, &place))
    }
}
