//! Which bodies are neighbours: joined by a single lower pair, so that they touch where it is.
//!
//! The way from one body to the other is a word of fixed poses and elementary motions. It is shortened by what
//! cancels and by the loops, each of which says that a part of it equals the inverse of the rest. Neighbours are bodies
//! between which there remain: no motion at all; one; two rotations without a translation between them (universal
//! joint); a rotation and a translation along the same axis (cylindrical joint, screw); or three rotations without
//! translations between them (ball joint).

use crate::math::Pose;
use crate::model::chain::{Motion, Step};
use crate::model::mechanism::Mechanism;
use glam::DMat3;
use std::collections::HashMap;

/// Fixed poses agree when they differ by less than this, relative to the mechanism's size.
const SAME: f64 = 1e-9;

/// Longest word that is looked at: nothing so far apart is a neighbour unless a loop says so.
const LONGEST: usize = 400;

type Word = Vec<Step>;

fn inverse(word: &[Step]) -> Word {
    word.iter().rev().map(Step::inverse).collect()
}

fn motions(word: &[Step]) -> usize {
    let joints = word.iter().filter(|s| matches!(s, Step::Joint { .. }));
    joints.count()
}

/// Decides neighbourhood in one mechanism.
pub struct Neighbours<'m> {
    mechanism: &'m Mechanism,
    /// Every loop and its inverse, from every joint on, by the argument of that joint.
    loops: HashMap<usize, Vec<Word>>,
}

impl<'m> Neighbours<'m> {
    /// Prepares the loops.
    pub fn new(mechanism: &'m Mechanism) -> Self {
        let mut loops: HashMap<usize, Vec<Word>> = HashMap::new();
        let short = |word: &Word| word.len() <= LONGEST;
        let scene = Self {
            mechanism,
            loops: HashMap::new(),
        };
        for item in &mechanism.loops {
            for word in [item.chain.steps.clone(), inverse(&item.chain.steps)] {
                let word = scene.reduced(&word);
                if !short(&word) {
                    continue;
                }
                for start in 0..word.len() {
                    if let Step::Joint { argument, .. } = word[start] {
                        let turned = [&word[start..], &word[..start]].concat();
                        loops.entry(argument).or_default().push(turned);
                    }
                }
            }
        }
        Self { mechanism, loops }
    }

    fn same(&self, a: &Pose, b: &Pose) -> bool {
        let turn = (a.rotation - b.rotation).to_cols_array();
        let shift = a.translation.distance(b.translation);
        turn.iter().all(|v| v.abs() <= SAME) && shift <= SAME * self.mechanism.size
    }

    fn matches(&self, a: &Step, b: &Step) -> bool {
        match (a, b) {
            (Step::Fixed(a), Step::Fixed(b)) => self.same(a, b),
            (Step::Joint { .. }, Step::Joint { .. }) => a == b,
            _ => false,
        }
    }

    /// Merges fixed poses and cancels motions with their inverses.
    fn reduced(&self, word: &[Step]) -> Word {
        let mut out: Word = Vec::with_capacity(word.len());
        for step in word {
            match step {
                Step::Fixed(pose) => {
                    let merged = match out.last() {
                        Some(Step::Fixed(before)) => {
                            let merged = *before * *pose;
                            out.pop();
                            merged
                        }
                        _ => *pose,
                    };
                    if !self.same(&merged, &Pose::IDENTITY) {
                        out.push(Step::Fixed(merged));
                    }
                }
                joint => {
                    let cancels = out.last().is_some_and(|last| joint.inverse() == *last);
                    if cancels {
                        out.pop();
                    } else {
                        out.push(*joint);
                    }
                }
            }
        }
        out
    }

    /// What loops can make of a word without adding motions.
    fn moves(&self, word: &[Step]) -> Vec<Word> {
        let mut found = Vec::new();
        for (start, step) in word.iter().enumerate() {
            let Step::Joint { argument, .. } = step else {
                continue;
            };
            for item in self.loops.get(argument).into_iter().flatten() {
                let pairs = word[start..].iter().zip(item);
                let mut same = pairs.take_while(|(a, b)| self.matches(a, b)).count();
                // The part ends with a motion; a fixed pose after it may be only half of the loop's.
                while same > 0 && matches!(item[same - 1], Step::Fixed(_)) {
                    same -= 1;
                }
                let replaced = motions(&item[..same]);
                if 2 * replaced < motions(item) {
                    continue;
                }
                let rest = inverse(&item[same..]);
                let new = [&word[..start], &rest, &word[start + same..]].concat();
                found.push(self.reduced(&new));
            }
        }
        found
    }

    /// A word with fewer motions; `None` if no loop, and no loop after a detour of equal length, gives one.
    fn shortened(&self, word: &[Step]) -> Option<Word> {
        let now = motions(word);
        let mut detours = Vec::new();
        for new in self.moves(word) {
            if motions(&new) < now {
                return Some(new);
            }
            detours.push(new);
        }
        let beyond = detours.iter().flat_map(|detour| self.moves(detour));
        let mut shorter = beyond.filter(|new| motions(new) < now);
        shorter.next()
    }

    /// The shortest way found from body `a` to body `b`.
    fn way(&self, a: usize, b: usize) -> Option<Word> {
        let chain = |body: usize| &self.mechanism.bodies[body].world_from_body.steps;
        let word = [inverse(chain(a)), chain(b).clone()].concat();
        let mut word = self.reduced(&word);
        if word.len() > LONGEST {
            return None;
        }
        // Every shortening saves a motion, so this ends.
        while let Some(shorter) = self.shortened(&word) {
            word = shorter;
        }
        Some(word)
    }

    /// Why the bodies are neighbours, or `None` if they are not.
    pub fn joint(&self, a: usize, b: usize) -> Option<&'static str> {
        let way = self.way(a, b)?;
        let is_joint = |step: &&Step| matches!(step, Step::Joint { .. });
        let first = way.iter().position(|s| is_joint(&s));
        let Some(first) = first else {
            return Some("one rigid part");
        };
        let last = way.iter().rposition(|s| is_joint(&s))?;
        let core = &way[first..=last];
        let joints: Vec<(Motion, usize)> = core
            .iter()
            .filter_map(|step| match step {
                Step::Joint { motion, axis, .. } => Some((*motion, *axis)),
                Step::Fixed(_) => None,
            })
            .collect();
        let concentric = core.iter().all(|step| match step {
            Step::Fixed(pose) => pose.translation.length() <= SAME * self.mechanism.size,
            Step::Joint { .. } => true,
        });
        let unturned = core.iter().all(|step| match step {
            Step::Fixed(pose) => pose.rotation.abs_diff_eq(DMat3::IDENTITY, SAME),
            Step::Joint { .. } => true,
        });
        let rotations = joints.iter().filter(|j| j.0 == Motion::Rotation).count();
        match (joints.len(), rotations) {
            (1, 1) => Some("revolute joint"),
            (1, 0) => Some("sliding joint"),
            (2, 2) if concentric => Some("universal joint"),
            (2, 1) if unturned && joints[0].1 == joints[1].1 => Some("cylindrical joint"),
            (3, 3) if concentric => Some("ball joint"),
            _ => None,
        }
    }
}
