//! Where searches start: the scene's own values, random ones in the whole box, random ones near a minimum. Random
//! numbers depend only on seed, start and draw. A draw that cannot be assembled, cannot move or interpenetrates is
//! replaced.

use super::touching::Touching;
use crate::analysis::random::Random;
use crate::analysis::study::{Evaluator, ParametricMechanism, TrackPoses};

/// Most draws for one start.
const MOST_DRAWS: usize = 400;

/// A random start is the best of this many draws that can move: drawing costs little compared with searching.
const CANDIDATES: usize = 8;

/// Distance of a start from the minimum near it, as a fraction of the variables' sizes: drawn log-uniformly between
/// these, because the width of a basin is unknown.
const NEAREST: f64 = 0.03;
const FARTHEST: f64 = 0.5;

/// Where a search started.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StartOrigin {
    /// The scene's own values.
    Scene,
    /// A random point of the box.
    Random,
    /// A random point near the minimum of this start.
    Near(usize),
}

impl StartOrigin {
    /// In words.
    pub fn words(self) -> String {
        match self {
            Self::Scene => "scene".to_owned(),
            Self::Random => "random".to_owned(),
            Self::Near(index) => format!("near {}", index + 1),
        }
    }
}

/// Draws that were rejected, by cause.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rejected {
    /// No pose at the start of the drive.
    pub not_assembled: usize,
    /// The tracks cannot be followed to their ends.
    pub not_moving: usize,
    /// Touching bodies cut into each other.
    pub interpenetrating: usize,
}

impl Rejected {
    /// Adds those of another start.
    pub fn add(&mut self, other: Self) {
        self.not_assembled += other.not_assembled;
        self.not_moving += other.not_moving;
        self.interpenetrating += other.interpenetrating;
    }

    /// All of them.
    pub fn count(&self) -> usize {
        self.not_assembled + self.not_moving + self.interpenetrating
    }
}

/// A start that can move: its family and poses.
pub struct MovingStart {
    /// The family with the start's values as its own.
    pub family: ParametricMechanism,
    /// All its poses.
    pub track_poses: TrackPoses,
}

impl MovingStart {
    /// The objective there; infinite where it has no value.
    fn value(&self) -> f64 {
        let measured = Evaluator::new(&self.family)
            .measure_sought(&self.track_poses)
            .ok();
        let objective = self.family.study.objective;
        let value = measured.and_then(|m| m.measures.get(objective?).copied());
        value.filter(|v| v.is_finite()).unwrap_or(f64::INFINITY)
    }
}

/// Draws a start until one can move, or several if they are random; `near` is the minimum near which it begins, `sizes`
/// are typical sizes of the variables. `ended` is called before every draw but the first.
pub fn begin_starts(
    family: &ParametricMechanism,
    touching: Touching,
    (origin, seed, item): (StartOrigin, u64, u64),
    near: &[f64],
    sizes: &[f64],
    ended: &dyn Fn() -> bool,
) -> (Option<MovingStart>, Rejected) {
    let mut rejected = Rejected::default();
    let mut best: Option<(f64, MovingStart)> = None;
    let (mut wanted, draws) = match origin {
        StartOrigin::Scene => (1, 1),
        StartOrigin::Near(_) => (1, MOST_DRAWS),
        StartOrigin::Random => (CANDIDATES, MOST_DRAWS),
    };
    for draw in 0..draws {
        // The first draw is evaluated in any case.
        if wanted == 0 || (draw > 0 && ended()) {
            break;
        }
        let random = Random::new(seed, item, draw as u64);
        let values = draw_starts(family, origin, random, near, sizes);
        let Some(begun) = assemble_start(family, touching, &values, &mut rejected) else {
            continue;
        };
        wanted -= 1;
        let value = begun.value();
        if best.as_ref().is_none_or(|(least, _)| value < *least) {
            best = Some((value, begun));
        }
    }
    (best.map(|(_, begun)| begun), rejected)
}

fn draw_starts(
    family: &ParametricMechanism,
    origin: StartOrigin,
    mut random: Random,
    near: &[f64],
    sizes: &[f64],
) -> Vec<f64> {
    let reach = NEAREST * libm::pow(FARTHEST / NEAREST, random.unit());
    let variables = family.study.variables.iter().enumerate();
    let values = variables.map(|(k, v)| match origin {
        StartOrigin::Scene => v.start,
        StartOrigin::Random => v.lower + random.unit() * (v.upper - v.lower),
        StartOrigin::Near(_) => {
            let moved = near[k] + reach * sizes[k] * random.normal();
            moved.clamp(v.lower, v.upper)
        }
    });
    values.collect()
}

fn assemble_start(
    family: &ParametricMechanism,
    touching: Touching,
    values: &[f64],
    rejected: &mut Rejected,
) -> Option<MovingStart> {
    let Some(family) = family.with_start(values).assembled() else {
        rejected.not_assembled += 1;
        return None;
    };
    let Some(poses) = family.whole_motion() else {
        rejected.not_moving += 1;
        return None;
    };
    if touching.depth(&family, values, &poses) > 0.0 {
        rejected.interpenetrating += 1;
        return None;
    }
    let track_poses = Evaluator::new(&family).nominal(poses);
    Some(MovingStart {
        family,
        track_poses,
    })
}
