//! The table of joints, from the folded graph and the groups of motions that form a joint.

use super::joint::{Joint, Joints, Link, LinkFrame, Passage};
use super::links::{Finished, LinkGraph, LinkPath, Paths};
use super::pairs::{MotionRun, PairRows};
use crate::model::chain::{Argument, Chain, ChainStep};
use crate::model::mechanism::Mechanism;
use std::collections::{BTreeMap, BTreeSet};

impl Joints {
    /// The joints of `mechanism`; its own table is not used.
    pub fn new(mechanism: &Mechanism) -> Self {
        let mut graph = LinkGraph::new(mechanism);
        for body in &mechanism.bodies {
            graph.add_body(&body.world_from_body);
        }
        graph.add_loops(&mechanism.loops);
        let mut graph = graph.finished();
        let routes = std::mem::take(&mut graph.routes);
        Self {
            routes,
            ..joint_table(mechanism, &graph)
        }
    }
}

/// The table of a finished graph, without the ways to its links.
fn joint_table(mechanism: &Mechanism, graph: &Finished) -> Joints {
    let rows = PairRows::new(mechanism, graph);
    // Joints are runs of edges; every edge knows its joint and in which direction it runs through it.
    let runs = rows.runs();
    let mut joint_of = vec![None; graph.edges.len()];
    for (index, run) in runs.iter().enumerate() {
        for crossing in &run.crossings {
            joint_of[crossing.edge] = Some((index, crossing.is_inverse));
        }
    }
    let along = |paths: &[LinkPath]| -> Vec<Vec<Passage>> {
        let passages = paths.iter().map(|path| path_passages(path, &joint_of));
        passages.collect()
    };
    // Links that remain between the joints, and the bodies on them.
    let numbers = JointNumbers::new(graph, &rows.within(&runs));
    let mut links = vec![Link::default(); numbers.count];
    for (route, number) in numbers.of.iter().enumerate() {
        if let Some(number) = number {
            links[*number].route = route;
        }
    }
    let of_body = graph.of_body.iter().map(|link| numbers.get(*link));
    let of_body: Vec<usize> = of_body.collect();
    for (body, link) in of_body.iter().enumerate() {
        links[*link].bodies.push(body);
    }
    // Paths of bodies and loops as passages through joints.
    let along_bodies = along(&graph.paths.bodies);
    let along_bases = along(&graph.paths.bases);
    let along_loops = along(&graph.paths.loops);
    let passages = [&along_bodies, &along_bases, &along_loops].map(Vec::as_slice);
    let chains = Chains::new(mechanism, graph, passages);
    let in_loops: BTreeSet<usize> = along_loops.iter().flatten().map(|p| p.joint).collect();
    // A joint in the words of the chain that passes it.
    let joint = |(index, run): (usize, &MotionRun)| {
        let (steps, ends) = chains.spelled_steps(index)?;
        let [before, after] = ends.map(|frame| LinkFrame {
            link: numbers.get(frame.link),
            ..frame
        });
        Some(Joint {
            kind: run.kind,
            is_placed: !in_loops.contains(&index) && has_kinks(mechanism, &steps),
            steps,
            coordinates: rows.coordinates_of(&run.crossings),
            before,
            after,
        })
    };
    let loop_starts = graph.loop_starts.iter().map(|start| LinkFrame {
        link: numbers.get(start.link),
        ..*start
    });
    Joints {
        loop_starts: loop_starts.collect(),
        list: runs.iter().enumerate().filter_map(joint).collect(),
        links,
        routes: Vec::new(),
        of_body,
        along_bodies,
        along_loops,
        closes: graph.closes.clone(),
    }
}

/// Whether a formula with kinks moves one of the steps.
fn has_kinks(mechanism: &Mechanism, steps: &[ChainStep]) -> bool {
    let arguments = steps.iter().filter_map(ChainStep::joint);
    let mut arguments = arguments.map(|joint| &mechanism.arguments[joint.argument]);
    arguments.any(|a| matches!(a, Argument::Formula(formula) if formula.has_kinks()))
}

/// The links that joints connect, renumbered without those inside joints.
struct JointNumbers {
    of: Vec<Option<usize>>,
    count: usize,
}

impl JointNumbers {
    fn new(graph: &Finished, is_within: &[bool]) -> Self {
        // The frame exists even if nothing is joined to it.
        let (mut of, mut count) = (vec![Some(0)], 1);
        for (edges, is_within) in graph.at.iter().zip(is_within).skip(1) {
            let number = (!edges.is_empty() && !is_within).then_some(count);
            count += usize::from(number.is_some());
            of.push(number);
        }
        Self { of, count }
    }

    fn get(&self, link: usize) -> usize {
        self.of[link].unwrap_or(0)
    }
}

/// The joints along a path.
fn path_passages(path: &LinkPath, joint_of: &[Option<(usize, bool)>]) -> Vec<Passage> {
    let mut list: Vec<Passage> = Vec::new();
    let mut edges: Vec<usize> = Vec::new();
    for (step, stride) in path.iter().enumerate() {
        let Some(crossing) = stride.as_ref().map(|stride| stride.crossing) else {
            continue;
        };
        let Some((joint, own)) = joint_of[crossing.edge] else {
            continue;
        };
        let is_inverse = own != crossing.is_inverse;
        // Another edge of the same joint in the same direction continues the passage.
        let goes_on = list.last().is_some_and(|last| {
            (last.joint, last.is_inverse) == (joint, is_inverse) && !edges.contains(&crossing.edge)
        });
        match list.last_mut() {
            Some(last) if goes_on => last.steps.end = step + 1,
            _ => {
                edges.clear();
                list.push(Passage {
                    joint,
                    steps: step..step + 1,
                    is_inverse,
                });
            }
        }
        edges.push(crossing.edge);
    }
    list
}

/// For every joint the first chain that passes it, its path and the passage: chains of bodies come first, then those that
/// carry loops.
struct Chains<'a> {
    first: BTreeMap<usize, (&'a Chain, &'a LinkPath, &'a Passage)>,
}

impl<'a> Chains<'a> {
    fn new(mechanism: &'a Mechanism, graph: &'a Finished, along: [&'a [Vec<Passage>]; 3]) -> Self {
        let chains = mechanism.bodies.iter().map(|b| &b.world_from_body);
        let chains = chains.chain(mechanism.loops.iter().map(|l| &l.base));
        let chains = chains.chain(mechanism.loops.iter().map(|l| &l.chain));
        let Paths {
            bodies,
            bases,
            loops,
        } = &graph.paths;
        let paths = bodies.iter().chain(bases).chain(loops);
        let all = chains.zip(paths).zip(along.into_iter().flatten());
        let mut first = BTreeMap::new();
        for ((chain, path), passages) in all {
            for passage in passages {
                first.entry(passage.joint).or_insert((chain, path, passage));
            }
        }
        Self { first }
    }

    /// The steps of a joint, forwards, as in the first chain that passes it, and the frames before and after them.
    fn spelled_steps(&self, joint: usize) -> Option<(Vec<ChainStep>, [LinkFrame; 2])> {
        let (chain, path, passage) = self.first.get(&joint)?;
        let steps = &chain.steps[passage.steps.clone()];
        let from = path[passage.steps.start]?.from;
        let to = path[passage.steps.end - 1]?.to;
        Some(if passage.is_inverse {
            let steps = steps.iter().rev().map(ChainStep::inverse);
            (steps.collect(), [to, from])
        } else {
            (steps.to_vec(), [from, to])
        })
    }
}
