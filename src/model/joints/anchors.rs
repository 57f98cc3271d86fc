//! Places loops in the graph of links: a loop may begin on any link, and its motions determine which.

use super::joint::LinkFrame;
use super::links::{LinkGraph, Stride};
use super::motions::MotionKey;
use crate::model::chain::ChainStep;
use crate::model::mechanism::{Closes, Loop};
use std::collections::{BTreeMap, BTreeSet};

/// A loop's step, and the position it starts from.
struct JointAnchor {
    step: usize,
    here: LinkFrame,
}

impl LinkGraph {
    /// Places loops where their motions are already: those that match most known motions come first, and one that
    /// matches none begins at the world.
    pub fn add_loops(&mut self, loops: &[Loop]) {
        self.paths.bases = vec![Vec::new(); loops.len()];
        self.paths.loops = vec![Vec::new(); loops.len()];
        self.closes = vec![false; loops.len()];
        self.loop_starts = vec![LinkFrame::WORLD; loops.len()];
        let mut left: BTreeSet<usize> = (0..loops.len()).collect();
        // Loops that are placed or match anything, and by motion those that wait for it.
        let mut known: BTreeSet<usize> = BTreeSet::new();
        let mut waiting: BTreeMap<MotionKey, Vec<usize>> = BTreeMap::new();
        for (index, item) in loops.iter().enumerate() {
            let met = item.chain.steps.iter();
            let met = met.filter_map(|step| Some(self.motions.met(step).ok()?.motion_key()));
            for key in met {
                match self.alike.contains_key(&key) {
                    true => drop(known.insert(index)),
                    false => waiting.entry(key).or_default().push(index),
                }
            }
            if !item.base.steps.is_empty() {
                known.insert(index);
            }
        }
        // The first that is known; else the first.
        while let Some(index) = known.pop_first().or_else(|| left.first().copied()) {
            if !left.remove(&index) {
                continue;
            }
            let before = self.edges.len();
            self.add_loop(index, &loops[index]);
            for edge in &self.edges[before..] {
                let met = waiting.remove(&edge.motion_key()).unwrap_or_default();
                known.extend(met.into_iter().filter(|index| left.contains(index)));
            }
        }
    }

    fn add_loop(&mut self, index: usize, item: &Loop) {
        let before = self.independent_cycles();
        self.size = item.size;
        let steps = &item.chain.steps;
        let (base, path) = self.follow(LinkFrame::WORLD, &item.base.steps);
        self.paths.bases[index] = path;
        let known = match item.base.steps.is_empty() {
            true => self.loop_anchor(item),
            false => None,
        };
        let anchor = known.unwrap_or(JointAnchor {
            step: 0,
            here: base,
        });
        let (ahead, behind) = steps.split_at(anchor.step);
        let back: Vec<ChainStep> = ahead.iter().rev().map(ChainStep::inverse).collect();
        let (start, path_back) = self.follow(anchor.here, &back);
        let (end, path_on) = self.follow(anchor.here, behind);
        let reversed = path_back.into_iter().rev().map(|stride| {
            stride.map(|s| Stride {
                crossing: s.crossing.inverse(),
                from: s.to,
                to: s.from,
            })
        });
        self.paths.loops[index] = reversed.chain(path_on).collect();
        // A loop that closes in a point also ends on a link, which the touching surface belongs to.
        self.loop_ends.extend([start, end]);
        self.loop_starts[index] = start;
        self.closes[index] = match item.closes {
            Closes::Frame => {
                self.join(start, end);
                self.independent_cycles() > before
            }
            // Its three equations are its own.
            Closes::Point => true,
        };
    }

    /// The anchor with the most matching motions; `None` if there is none.
    fn loop_anchor(&self, item: &Loop) -> Option<JointAnchor> {
        let steps = &item.chain.steps;
        let world = JointAnchor {
            step: 0,
            here: LinkFrame::WORLD,
        };
        let mut best = (self.known_steps(item, &world), world);
        for (step, met) in steps.iter().enumerate() {
            let Ok(met) = self.motions.met(met) else {
                continue;
            };
            let alike = self.alike.get(&met.motion_key()).into_iter().flatten();
            for &index in alike.filter(|index| self.merged_edges[**index].is_none()) {
                let edge = &self.edges[index];
                // A single motion matches in both directions. A loop that passes it backwards is then placed upright,
                // not forwards and upside down.
                for is_inverse in [met.is_reversed, !met.is_reversed] {
                    let [from, _] = self.ends(edge, is_inverse);
                    let here = from.moved(met.to_axis.inverse());
                    let anchor = JointAnchor { step, here };
                    let known = self.known_steps(item, &anchor);
                    if known > best.0 {
                        best = (known, anchor);
                    }
                }
            }
        }
        (best.0 > 0).then_some(best.1)
    }

    /// How many successive motions of a loop, on both sides of an anchor, are known.
    fn known_steps(&self, item: &Loop, anchor: &JointAnchor) -> usize {
        let (before, behind) = item.chain.steps.split_at(anchor.step);
        let is_closed = item.closes == Closes::Frame;
        let on = behind.iter().chain(before.iter().filter(|_| is_closed));
        let (ahead, all) = self.known_in_a_row(anchor.here, on.copied());
        if all {
            return ahead;
        }
        let back = before
            .iter()
            .rev()
            .chain(behind.iter().rev().filter(|_| is_closed));
        ahead
            + self
                .known_in_a_row(anchor.here, back.map(ChainStep::inverse))
                .0
    }

    /// How many motions from a position on are known, and whether all are.
    fn known_in_a_row(
        &self,
        here: LinkFrame,
        steps: impl Iterator<Item = ChainStep>,
    ) -> (usize, bool) {
        let (mut here, mut count) = (here, 0);
        for step in steps {
            match self.motions.met(&step) {
                Err(pose) => here = here.moved(pose),
                Ok(met) => match self.known(here, &met) {
                    Some((there, _)) => (here, count) = (there, count + 1),
                    None => return (count, false),
                },
            }
        }
        (count, true)
    }
}
