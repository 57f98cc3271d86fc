//! Assembly as meant: start values that a scene names are wishes, all others are free.
//!
//! The search of [`assembly`](super::assembly) starts at every unknown's start value alike, and the nearest minimum of a
//! residual is not the nearest assembly: a closing angle that nobody named, and that starts at zero, may take the named
//! ones along. Where that happened, more starts are made: the named values are held while the others close the loops as
//! well as they can, from where they are and from anywhere; then all are let go. Of what is found the assembly
//! nearest to the named values is taken.

use super::assembly::{Assembled, NotClosed, assemble_pose, close_block};
use super::closure::closes;
use super::descent::Descent;
use super::newton::{Corrector, Pace};
use super::random_starts::RandomStarts;
use super::turns::WholeTurns;
use crate::kinematics::structure::block::{Block, block_of};
use crate::kinematics::structure::system::System;
use crate::model::mechanism::{Kind, Mechanism};
use std::f64::consts::TAU;

/// A named angle that moved farther than this is another assembly rather than a rough sketch.
const FAR_ANGLE: f64 = 20.0 * TAU / 360.0;

/// The same of lengths and numbers, as a share of the mechanism's size or of what the number amounts to.
const FAR_SHARE: f64 = 0.2;

/// Starts that are made. A loop leaves its free unknowns two or four ways to close while the named ones are held, so
/// most are met many times.
const STARTS: usize = 32;

/// What is nearer by less than this part of a far way is not: equal assemblies differ by rounding.
const NEARER: f64 = 1e-6;

/// The start values that a scene names.
pub struct StartPreferences {
    /// By unknown, ascending.
    list: Vec<StartPreference>,
}

/// One of them.
struct StartPreference {
    unknown: usize,
    value: f64,
    /// How far is far.
    far: f64,
    /// Values that differ by this are the same; infinite where whole turns matter.
    period: f64,
}

impl StartPreferences {
    /// Those unknowns of `start` that are `named`.
    pub fn new(mechanism: &Mechanism, start: &[f64], named: &[bool]) -> Self {
        let turns = WholeTurns::of(mechanism);
        let wish = |unknown: usize| {
            let is_turn = mechanism.unknowns[unknown].kind == Kind::Angle;
            StartPreference {
                unknown,
                value: start[unknown],
                far: match is_turn {
                    true => FAR_ANGLE,
                    false => FAR_SHARE * mechanism.scale_of(unknown),
                },
                // Whole turns do not count where nothing but rotations use the angle.
                period: match is_turn && !turns.matter(unknown) {
                    true => TAU,
                    false => f64::INFINITY,
                },
            }
        };
        let unknowns = 0..mechanism.unknowns.len();
        let named = unknowns.filter(|k| named.get(*k).is_some_and(|named| *named));
        Self {
            list: named.map(wish).collect(),
        }
    }

    /// How far a pose is from every wish: nothing is far up to one.
    fn misses<'a>(&'a self, pose: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        self.list.iter().map(|wish| {
            let off = pose[wish.unknown] - wish.value;
            let turns = match wish.period.is_finite() {
                true => (off / wish.period).round() * wish.period,
                false => 0.0,
            };
            (off - turns).abs() / wish.far
        })
    }

    /// How far a pose is from all wishes together.
    pub fn distance(&self, pose: &[f64]) -> f64 {
        self.misses(pose).map(|far| far * far).sum::<f64>().sqrt()
    }

    /// Whether a pose is far from any wish.
    pub fn are_missed(&self, pose: &[f64]) -> bool {
        self.misses(pose).any(|far| far > 1.0)
    }

    /// The unknown that `other` keeps better than `pose` by most, if by a far way.
    pub fn gained(&self, pose: &[f64], other: &[f64]) -> Option<usize> {
        let gains = self.misses(pose).zip(self.misses(other));
        let gains = gains.map(|(far, near)| far - near).zip(&self.list);
        let (gain, wish) = gains.reduce(|a, b| if b.0 > a.0 { b } else { a })?;
        (gain > 1.0).then_some(wish.unknown)
    }

    fn is_named(&self, unknown: usize) -> bool {
        let place = self.list.binary_search_by_key(&unknown, |w| w.unknown);
        place.is_ok()
    }
}

/// Closes all loops from the unknowns in `start` (unknowns, then inputs), trying perturbed starts where that fails, and
/// more starts where an unknown that is `named` would end far from its start value.
///
/// # Errors
/// The pose that comes nearest to closing.
pub fn assemble_as_meant(
    system: &System,
    corrector: &mut Corrector,
    start: &[f64],
    named: &[bool],
) -> Result<Assembled, NotClosed> {
    let mut best = assemble_pose(system, corrector, start, true)?;
    let wishes = StartPreferences::new(system.mechanism(), start, named);
    if !wishes.are_missed(&best.coordinates) {
        return Ok(best);
    }
    let held = with_wishes_held(system, &wishes);
    let first = wishes.distance(&best.coordinates);
    let mut least = first;
    let is_all_named = held.iter().all(|block| block.unknowns.is_empty());
    let random = RandomStarts::new(system.mechanism());
    for attempt in 0..if is_all_named { 1 } else { STARTS } {
        let start = free_start(system, start, &wishes, random.values(start, attempt));
        let Some(found) = let_go(system, &held, start) else {
            continue;
        };
        for names in spelled_poses(system, found) {
            let distance = wishes.distance(&names);
            if distance < least - NEARER {
                (best.coordinates, best.start, least) = (names, 0, distance);
            }
        }
    }
    if least < first {
        // What the corrector has in store is of this pose.
        let last = corrector.correct(system, &mut best.coordinates, Pace::Patient);
        best.iterations += last.iterations;
    }
    Ok(best)
}

/// The blocks without the named unknowns.
fn with_wishes_held(system: &System, wishes: &StartPreferences) -> Vec<Block> {
    let free = |whole: &Block| {
        let unknowns = whole.unknowns.iter().copied();
        let free = unknowns.filter(|unknown| !wishes.is_named(*unknown));
        let (loops, equations) = (whole.loops.clone(), whole.equations.clone());
        block_of(system.mechanism(), loops, equations, free.collect())
    };
    system.blocks().iter().map(free).collect()
}

/// The values of a start, the scene's own where something is named or held.
fn free_start(
    system: &System,
    start: &[f64],
    wishes: &StartPreferences,
    mut values: Vec<f64>,
) -> Vec<f64> {
    for wish in &wishes.list {
        values[wish.unknown] = wish.value;
    }
    for held in &system.structure().held {
        values[held.unknown] = start[held.unknown];
    }
    values
}

/// A closed pose from a start, first with the named unknowns held, then without.
fn let_go(system: &System, held: &[Block], mut values: Vec<f64>) -> Option<Vec<f64>> {
    let mut descent = Descent::default();
    for block in held {
        descent.minimise(system.mechanism(), block, &mut values);
    }
    // Buffers of its own: what another start has left in them must not show in the last digits.
    let mut corrector = Corrector::new(system);
    close_block(system, &mut corrector, &mut values, &mut 0).ok()?;
    Some(values)
}

/// The pose, and the same with the other angles of a ball joint where nothing else depends on them.
fn spelled_poses(system: &System, pose: Vec<f64>) -> Vec<Vec<f64>> {
    let mut all = vec![pose];
    for ball in system.balls() {
        let mut other = all[0].clone();
        ball.rename(&mut other);
        let mut held = system.structure().held.iter();
        let is_kept = held.all(|held| other[held.unknown] == all[0][held.unknown]);
        // The second set of angles must leave held coordinates and the closure as they are.
        if is_kept && closes(system.mechanism(), &other) {
            all.push(other);
        }
    }
    all
}
