//! The order in which loops are solved: groups of loops and equations, each with as many equations as new unknowns.
//!
//! Loops whose other coordinates are known are taken one by one. In the rest every unknown is matched to a loop with a
//! free equation, and loops that need each other's unknowns form a group: strongly connected components. The work grows
//! with the number of occurrences of unknowns, not with its square.

use super::block::{Block, block_of};
use super::loop_part::LoopPart;
use crate::limits::{LimitExceeded, allow_memory};
use crate::model::mechanism::Mechanism;
use std::collections::{BTreeSet, VecDeque};

/// Number of matrices of a block in memory at once, as measured: seven to solve it (Jacobians at this pose and the last
/// one, factors, inverses, a trial), fifteen to prove its poses.
const MATRICES: f64 = 22.0;

/// A loop part or an equation, before grouping.
#[derive(Clone, Debug, PartialEq)]
pub enum Member {
    /// A loop with its equations that are not empty.
    Loop(LoopPart),
    /// A scalar equation.
    Equation(usize),
}

/// Loops and equations, and the unknowns that each uses.
#[derive(Clone, Debug)]
pub struct Incidence {
    /// All loops, then all equations.
    pub members: Vec<Member>,
    /// Unknowns of each member, ascending.
    uses: Vec<Vec<usize>>,
    /// Members that use an unknown, ascending.
    users: Vec<Vec<usize>>,
    rows: Vec<usize>,
}

/// Members that are solved together, and the unknowns that they determine.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BlockGroup {
    /// Ascending.
    pub members: Vec<usize>,
    /// Ascending.
    pub unknowns: Vec<usize>,
}

impl Incidence {
    /// Collects who uses what.
    pub fn new(mechanism: &Mechanism, parts: Vec<LoopPart>) -> Self {
        let equations = (0..mechanism.equations.len()).map(Member::Equation);
        let members: Vec<Member> = parts
            .into_iter()
            .map(Member::Loop)
            .chain(equations)
            .collect();
        let uses: Vec<Vec<usize>> = members.iter().map(|m| unknowns_of(mechanism, m)).collect();
        let mut users = vec![Vec::new(); mechanism.unknowns.len()];
        // The same incidence the other way round: from unknowns to members.
        for (member, uses) in uses.iter().enumerate() {
            uses.iter().for_each(|u| users[*u].push(member));
        }
        let rows = members.iter().map(|member| match member {
            Member::Loop(part) => part.components.len(),
            Member::Equation(_) => 1,
        });
        Self {
            rows: rows.collect(),
            members,
            uses,
            users,
        }
    }

    /// Groups in the order of their solution. Unknowns in `held` are treated as known.
    pub fn groups(&self, held: &[usize]) -> Vec<BlockGroup> {
        let mut known = vec![false; self.users.len()];
        held.iter().for_each(|u| known[*u] = true);
        let mut done = vec![false; self.members.len()];
        // First what can be solved alone, then strongly connected components of the matching.
        let mut groups = self.peel(&mut known, &mut done);
        for rest in self.components(&known, &done) {
            groups.extend(match self.matched_groups(&rest, &known) {
                Some(nodes) => self.sorted_nodes(nodes),
                None => vec![self.whole(rest, &known)],
            });
        }
        groups
    }

    /// The groups, if the matrices of the largest fit into memory.
    pub fn allowed(&self, groups: Vec<BlockGroup>) -> Result<Vec<BlockGroup>, LimitExceeded> {
        let size = |group: &BlockGroup| {
            let rows: usize = group.members.iter().map(|m| self.rows[*m]).sum();
            (rows.saturating_mul(group.unknowns.len()), rows)
        };
        let (entries, rows) = groups.iter().map(size).max().unwrap_or_default();
        let bytes = MATRICES * entries as f64 * std::mem::size_of::<f64>() as f64;
        let who = format!("solving and proving {rows} coupled equations together");
        allow_memory(bytes, &who)?;
        Ok(groups)
    }

    /// Joins group `index` with all groups that use its unknowns. `None` if there are no such groups.
    pub fn joined(&self, groups: &[BlockGroup], index: usize) -> Option<Vec<BlockGroup>> {
        let owned = &groups[index].unknowns;
        let uses = |group: &BlockGroup| {
            let mut all = group.members.iter().flat_map(|m| &self.uses[*m]);
            all.any(|u| owned.binary_search(u).is_ok())
        };
        // The group itself and all that use its unknowns become one.
        let mut one = BlockGroup::default();
        let mut others = Vec::new();
        for (k, group) in groups.iter().enumerate() {
            if k == index || uses(group) {
                one.members.extend(&group.members);
                one.unknowns.extend(&group.unknowns);
            } else {
                others.push(group.clone());
            }
        }
        if others.len() + 1 == groups.len() {
            return None;
        }
        one.members.sort_unstable();
        one.unknowns.sort_unstable();
        others.push(one);
        Some(self.sorted_nodes(others))
    }

    /// Everything, as one group per connected part.
    pub fn merged(&self, held: &[usize]) -> Vec<BlockGroup> {
        let mut known = vec![false; self.users.len()];
        held.iter().for_each(|u| known[*u] = true);
        let done = vec![false; self.members.len()];
        let parts = self.components(&known, &done);
        parts.into_iter().map(|p| self.whole(p, &known)).collect()
    }

    /// Members one by one that have as many equations as unknown coordinates.
    fn peel(&self, known: &mut [bool], done: &mut [bool]) -> Vec<BlockGroup> {
        // How many unknowns of a member are not known yet.
        let mut open: Vec<usize> = self
            .uses
            .iter()
            .map(|uses| uses.iter().filter(|u| !known[**u]).count())
            .collect();
        let all = 0..self.members.len();
        // A member with no more open unknowns than equations can be solved.
        let mut ready: BTreeSet<usize> = all.filter(|m| open[*m] <= self.rows[*m]).collect();
        let mut groups = Vec::new();
        while let Some(member) = ready.pop_first() {
            done[member] = true;
            let group = self.whole(vec![member], known);
            // Its unknowns are known from here on; this may make their other users solvable.
            for unknown in &group.unknowns {
                known[*unknown] = true;
                for user in self.users[*unknown].iter().filter(|user| !done[**user]) {
                    open[*user] -= 1;
                    if open[*user] <= self.rows[*user] {
                        ready.insert(*user);
                    }
                }
            }
            groups.push(group);
        }
        groups
    }

    /// One group of the given members with all their unknowns that are not known; where `known` ends, none is.
    pub fn whole(&self, mut members: Vec<usize>, known: &[bool]) -> BlockGroup {
        members.sort_unstable();
        let all = members.iter().flat_map(|m| self.uses[*m].iter().copied());
        let is_known = |u: &usize| known.get(*u).copied().unwrap_or(false);
        let mut unknowns: Vec<usize> = all.filter(|u| !is_known(u)).collect();
        unknowns.sort_unstable();
        unknowns.dedup();
        BlockGroup { members, unknowns }
    }

    /// Members that are not done, divided into those that share open unknowns.
    fn components(&self, known: &[bool], done: &[bool]) -> Vec<Vec<usize>> {
        let mut seen = done.to_vec();
        let mut list = Vec::new();
        for first in 0..self.members.len() {
            if std::mem::replace(&mut seen[first], true) {
                continue;
            }
            // Breadth-first search along shared open unknowns.
            let mut part = vec![first];
            let mut next = 0;
            while next < part.len() {
                for unknown in self.uses[part[next]].iter().filter(|u| !known[**u]) {
                    for user in &self.users[*unknown] {
                        if !std::mem::replace(&mut seen[*user], true) {
                            part.push(*user);
                        }
                    }
                }
                next += 1;
            }
            part.sort_unstable();
            list.push(part);
        }
        list
    }

    /// Assigns every open unknown of `rest` to a member with a free equation, if possible: one group per member.
    fn matched_groups(&self, rest: &[usize], known: &[bool]) -> Option<Vec<BlockGroup>> {
        let whole = self.whole(rest.to_vec(), known);
        let mut owned = vec![Vec::new(); self.members.len()];
        for unknown in whole.unknowns {
            self.augmenting_path(unknown, &mut owned)?;
        }
        let group = |member: &usize| {
            let mut unknowns = std::mem::take(&mut owned[*member]);
            unknowns.sort_unstable();
            BlockGroup {
                members: vec![*member],
                unknowns,
            }
        };
        Some(rest.iter().map(group).collect())
    }

    /// Finds an owner for `unknown`, reassigning others along a shortest path.
    fn augmenting_path(&self, unknown: usize, owned: &mut [Vec<usize>]) -> Option<()> {
        // The unknown from which each member was reached.
        let mut reached: Vec<Option<usize>> = vec![None; self.members.len()];
        let mut owner_of: Vec<Option<usize>> = vec![None; self.users.len()];
        let mut queue = VecDeque::from([unknown]);
        while let Some(wanting) = queue.pop_front() {
            for &member in &self.users[wanting] {
                if reached[member].is_some() {
                    continue;
                }
                reached[member] = Some(wanting);
                if owned[member].len() < self.rows[member] {
                    return self.shift(member, &reached, &owner_of, owned);
                }
                for other in &owned[member] {
                    owner_of[*other] = Some(member);
                    queue.push_back(*other);
                }
            }
        }
        None
    }

    /// Reassigns unknowns along the path that ends at `member`.
    fn shift(
        &self,
        mut member: usize,
        reached: &[Option<usize>],
        owner_of: &[Option<usize>],
        owned: &mut [Vec<usize>],
    ) -> Option<()> {
        loop {
            let unknown = reached[member]?;
            owned[member].push(unknown);
            let Some(before) = owner_of[unknown] else {
                return Some(());
            };
            owned[before].retain(|u| *u != unknown);
            member = before;
        }
    }

    /// Merges groups that need each other's unknowns, and sorts the rest so that each needs earlier ones only: Tarjan's
    /// strongly connected components (SIAM J. Comput. 1, 1972), without recursion.
    fn sorted_nodes(&self, nodes: Vec<BlockGroup>) -> Vec<BlockGroup> {
        // Every unknown belongs to one node; a node needs those that own the unknowns it uses.
        let mut owner = vec![usize::MAX; self.users.len()];
        for (k, node) in nodes.iter().enumerate() {
            node.unknowns.iter().for_each(|u| owner[*u] = k);
        }
        let needs: Vec<Vec<usize>> = nodes
            .iter()
            .enumerate()
            .map(|(k, node)| {
                let used = node.members.iter().flat_map(|m| &self.uses[*m]);
                let owners = used.map(|u| owner[*u]);
                let mut list: Vec<usize> = owners.filter(|o| *o != k && *o != usize::MAX).collect();
                list.sort_unstable();
                list.dedup();
                list
            })
            .collect();
        // A strongly connected component is one block.
        let join = |component: Vec<usize>| {
            let mut group = BlockGroup::default();
            for k in component {
                group.members.extend(&nodes[k].members);
                group.unknowns.extend(&nodes[k].unknowns);
            }
            group.members.sort_unstable();
            group.unknowns.sort_unstable();
            group
        };
        strong_components(&needs).into_iter().map(join).collect()
    }
}

/// Strongly connected components of a graph, those that are needed before those that need them.
fn strong_components(needs: &[Vec<usize>]) -> Vec<Vec<usize>> {
    const UNSEEN: usize = usize::MAX;
    let mut index = vec![UNSEEN; needs.len()];
    let mut low = vec![0; needs.len()];
    let mut open = vec![false; needs.len()];
    let (mut stack, mut list, mut count) = (Vec::new(), Vec::new(), 0);
    for root in 0..needs.len() {
        let mut path: Vec<(usize, usize)> = Vec::new();
        if index[root] == UNSEEN {
            path.push((root, 0));
        }
        // Tarjan's algorithm with an explicit stack: `low` is the earliest node that can be reached back.
        while let Some((node, child)) = path.pop() {
            if child == 0 {
                (index[node], low[node]) = (count, count);
                count += 1;
                stack.push(node);
                open[node] = true;
            } else {
                low[node] = low[node].min(low[needs[node][child - 1]]);
            }
            let next = (child..needs[node].len()).find(|c| {
                let other = needs[node][*c];
                if index[other] != UNSEEN && open[other] {
                    low[node] = low[node].min(index[other]);
                }
                index[other] == UNSEEN
            });
            if let Some(c) = next {
                path.push((node, c + 1));
                path.push((needs[node][c], 0));
            } else if low[node] == index[node] {
                // A node that reaches no earlier one closes a component.
                let start = stack.iter().rposition(|n| *n == node).unwrap_or(0);
                let component = stack.split_off(start);
                component.iter().for_each(|n| open[*n] = false);
                list.push(component);
            }
        }
    }
    list
}

/// Unknowns that a member uses, ascending.
pub fn unknowns_of(mechanism: &Mechanism, member: &Member) -> Vec<usize> {
    let mut slots: Vec<usize> = match member {
        Member::Loop(part) => {
            let used = mechanism.loops[part.index].chain.arguments();
            let slots = used
                .iter()
                .flat_map(|a| mechanism.arguments[*a].coordinates());
            slots.collect()
        }
        Member::Equation(index) => mechanism.equations[*index].expression.slots(),
    };
    slots.retain(|slot| *slot < mechanism.unknowns.len());
    slots.sort_unstable();
    slots.dedup();
    slots
}

/// The block of a group.
pub fn of_group(mechanism: &Mechanism, incidence: &Incidence, group: &BlockGroup) -> Block {
    let (mut loops, mut equations) = (Vec::new(), Vec::new());
    for member in &group.members {
        match &incidence.members[*member] {
            Member::Loop(part) => loops.push(part.clone()),
            Member::Equation(index) => equations.push(*index),
        }
    }
    block_of(mechanism, loops, equations, group.unknowns.clone())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn components_come_in_the_order_of_need() {
        // 0 needs 1, 1 and 2 need each other, 2 needs 3; 4 stands alone.
        let found = strong_components(&[vec![1], vec![2], vec![1, 3], vec![], vec![]]);
        assert_eq!(found, vec![vec![3], vec![1, 2], vec![0], vec![4]]);
        // A long chain needs no deep stack.
        let chain: Vec<Vec<usize>> = (0..200_000)
            .map(|k| if k > 0 { vec![k - 1] } else { vec![] })
            .collect();
        assert_eq!(strong_components(&chain).len(), 200_000);
        let back: Vec<Vec<usize>> = (0..200_000).map(|k| vec![(k + 1) % 200_000]).collect();
        assert_eq!(strong_components(&back).len(), 1);
    }
}
