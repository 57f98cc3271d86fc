//! Where searches start: the scene's own values, random ones of the whole box, random ones near a minimum. Random
//! numbers depend on seed, start and draw only. What does not assemble, does not turn or interpenetrates is drawn anew.

use super::touching::Touching;
use crate::analysis::random::Random;
use crate::analysis::study::{Evaluator, Family, Stand};
use crate::kinematics::continuation::solve_unproved;

/// Most draws for one start.
const MOST_DRAWS: usize = 400;

/// How far a start near a minimum lies from it, as a share of the variables' sizes: drawn between these, every order of
/// magnitude as often, because nobody knows beforehand how wide a basin is.
const NEAREST: f64 = 0.03;
const FARTHEST: f64 = 0.5;

/// Where a search started.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The scene's own values.
    Scene,
    /// A random point of the box.
    Random,
    /// A random point near the minimum of this start.
    Near(usize),
}

impl Origin {
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

/// A start that moves: its family, and where that stands.
pub struct Begun {
    /// The family with the start's values as its own.
    pub family: Family,
    /// All its poses.
    pub stand: Stand,
}

/// Draws a start until one moves; `near` is the minimum that it is near to, `sizes` are typical sizes of the variables. `ended` is asked before every draw.
pub fn begin(
    family: &Family,
    touching: Touching,
    (origin, seed, item): (Origin, u64, u64),
    near: &[f64],
    sizes: &[f64],
    ended: &dyn Fn() -> bool,
) -> (Option<Begun>, Rejected) {
    let mut rejected = Rejected::default();
    let draws = if origin == Origin::Scene {
        1
    } else {
        MOST_DRAWS
    };
    for draw in 0..draws {
        if ended() {
            break;
        }
        let mut random = Random::new(seed, item, draw as u64);
        let reach = NEAREST * libm::pow(FARTHEST / NEAREST, random.unit());
        let variables = family.study.variables.iter().enumerate();
        let values: Vec<f64> = variables
            .map(|(k, v)| match origin {
                Origin::Scene => v.start,
                Origin::Random => v.lower + random.unit() * (v.upper - v.lower),
                Origin::Near(_) => {
                    let moved = near[k] + reach * sizes[k] * random.normal();
                    moved.clamp(v.lower, v.upper)
                }
            })
            .collect();
        if let Some(begun) = assemble(family, touching, &values, &mut rejected) {
            return (Some(begun), rejected);
        }
    }
    (None, rejected)
}

fn assemble(
    family: &Family,
    touching: Touching,
    values: &[f64],
    rejected: &mut Rejected,
) -> Option<Begun> {
    let family = family.with_start(values);
    let start = solve_unproved(&family.mechanism, &[0.0]).ok()?;
    if start.missing() > 0 {
        rejected.not_assembled += 1;
        return None;
    }
    let Ok(nominal) = family.nominal() else {
        rejected.not_moving += 1;
        return None;
    };
    if touching.depth(&family, values, &nominal.poses) > 0.0 {
        rejected.interpenetrating += 1;
        return None;
    }
    let mut evaluator = Evaluator::new(&family);
    let stand = evaluator.nominal(nominal.poses);
    if evaluator.whole(&stand).is_err() {
        rejected.not_moving += 1;
        return None;
    }
    Some(Begun { family, stand })
}
