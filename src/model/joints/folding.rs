//! Folding of the graph of links (Stallings): positions that are identified, and the edges and links that become one with them.

use super::joint::LinkFrame;
use super::links::{LinkGraph, LoopCrossing};
use std::collections::BTreeSet;

impl LinkGraph {
    /// Identifies two positions, and folds the consequences.
    pub(super) fn join(&mut self, a: LinkFrame, b: LinkFrame) {
        let mut same = vec![[a, b]];
        while let Some([a, b]) = same.pop() {
            let [a, b] = [self.resolved(a), self.resolved(b)];
            // Frames on one link either agree already, or the loops contradict each other, which the solver will
            // report.
            if a.link == b.link {
                continue;
            }
            // The older link stays, so that the world is always itself.
            let [a, b] = if a.link < b.link { [a, b] } else { [b, a] };
            self.merged_links[b.link] = Some(a.moved(b.link_from_here.inverse()));
            self.merged[0] += 1;
            let edges = std::mem::take(&mut self.at[b.link]);
            let known: BTreeSet<usize> = self.at[a.link].iter().copied().collect();
            let new = edges.iter().filter(|edge| !known.contains(edge));
            self.at[a.link].extend(new);
            self.fold(a.link, &edges.into_iter().collect(), &mut same);
        }
    }

    /// Merges edges at a link that are the same motion, and the links they lead to. Only `new` edges at the link can
    /// equal others.
    fn fold(&mut self, link: usize, new: &BTreeSet<usize>, same: &mut Vec<[LinkFrame; 2]>) {
        let (mut k, mut is_new_before) = (0, false);
        while k < self.at[link].len() {
            let index = self.at[link][k];
            let is_new = new.contains(&index);
            if !is_new && !is_new_before {
                k += 1;
                continue;
            }
            // Earlier edges of this link with the same motion, one of them new.
            let before = self.at[link][..k].iter();
            let mut others = before.filter(|other| {
                self.edges[**other].motion_key() == self.edges[index].motion_key()
                    && (is_new || new.contains(other))
            });
            let twin = others.find_map(|other| self.twin(link, *other, index));
            match twin {
                Some((crossing, ends)) => {
                    // The twin takes the place of this edge, which leaves both of its links.
                    self.merged_edges[index] = Some(crossing);
                    self.merged[1] += 1;
                    let [before, after] = self.edges[index].ends.map(|e| self.resolved(e).link);
                    self.at[before].retain(|edge| *edge != index);
                    self.at[after].retain(|edge| *edge != index);
                    same.push(ends);
                }
                None => (k, is_new_before) = (k + 1, is_new_before || is_new),
            }
        }
    }

    /// Edge `other` as a passage of edge `known`, which has the same combination of coordinates, if it is the same
    /// motion from the link; and two positions that are the same frame after it.
    fn twin(
        &self,
        link: usize,
        known: usize,
        other: usize,
    ) -> Option<(LoopCrossing, [LinkFrame; 2])> {
        let (one, two) = (&self.edges[known], &self.edges[other]);
        let ways = [[false, false], [false, true], [true, false], [true, true]];
        ways.into_iter().find_map(|[first, second]| {
            let ([from, to], [from_other, to_other]) =
                (self.ends(one, first), self.ends(two, second));
            if from.link != link || from_other.link != link {
                return None;
            }
            // The same motion if the frames before it differ by a pose that commutes with it.
            let apart = from.link_from_here.inverse() * from_other.link_from_here;
            if !self.commutes_with(one.motion, &apart) {
                return None;
            }
            // The frames after it then differ by a constant: on one link it must be the identity, two links become
            // one.
            let behind = to.moved(apart);
            let gap = behind.link_from_here * to_other.link_from_here.inverse();
            if behind.link == to_other.link && !self.is_identity(&gap) {
                return None;
            }
            let crossing = LoopCrossing {
                edge: known,
                is_inverse: first != second,
            };
            Some((crossing, [behind, to_other]))
        })
    }
}
