//! The search: rounds of starts of several kinds, until an estimate says that nothing is missing.

use super::alike::{Alike, PlacedPoint, same_numbers};
use super::merged::{are_copies, is_blurred};
use super::names::{ModeGroup, Modes, StartKind, StartResults, describe_mode};
use super::sets::{Continuum, lost_rank};
use super::walk::{WIDEST, branch_neighbours};
use crate::jobs::{core_count, share_work};
use crate::kinematics::certificate::regular::RegularPoses;
use crate::kinematics::solve::assembly::assemble_pose;
use crate::kinematics::solve::closure::closes;
use crate::kinematics::solve::newton::Corrector;
use crate::kinematics::solve::pose_solver::PoseSolver;
use crate::kinematics::solve::random_starts::RandomStarts;
use crate::kinematics::structure::system::System;
use crate::model::mechanism::Kind;
use std::collections::VecDeque;

/// Default for the most starts in addition to the scene's own. Dietmaier's platform with its forty placements needs
/// several thousand random ones.
pub const DEFAULT_STARTS: usize = 10_000;

/// The search ends when the probability that a random start leads to a new placement is below this.
pub const UNSEEN: f64 = 1e-3;

/// Least number of random starts: an estimate from fewer is worth little. The rarest assembly of the known 6R arm is
/// found by one in 25, that of the gearshift with its 18 unknowns by one in 120.
const LEAST_RANDOM: usize = 500;

/// If this many random starts lead to something new at least every second time, there are too many placements to list:
/// those of independent loops multiply.
const HOPELESS_AFTER: usize = 1000;

/// The estimate of missing placements above which the search is then given up.
const HOPELESS: f64 = 0.5;

/// No more starts are derived while this many are waiting.
const MOST_WAITING: usize = 1000;

/// Number of random starts in a round, and largest number of others.
const ROUND: usize = 100;

/// One start.
enum Job {
    /// The start values, of which the solver keeps those that the scene names.
    Scene { named: Vec<bool> },
    /// Its number.
    Random(usize),
    /// The values.
    Mirrored(Vec<f64>),
    /// From a pose, in a block.
    Continued {
        pose: Vec<f64>,
        block: usize,
        key: u64,
    },
}

impl Job {
    fn kind(&self) -> StartKind {
        match self {
            Self::Scene { .. } => StartKind::Scene,
            Self::Random(_) => StartKind::Random,
            Self::Mirrored(_) => StartKind::Mirrored,
            Self::Continued { .. } => StartKind::Continued,
        }
    }
}

/// Searches the assemblies at the inputs of `first` (start values of the unknowns, then inputs), from there and from at most
/// `limit` other starts. `named` are the start values that the scene names, as in
/// [`Actuation::named`](crate::model::actuation::Actuation::named): the scene's own assembly is the one where a motion starts.
///
/// The result depends on nothing but the arguments, in particular not on the number of threads. Ends early, with
/// what it has, when `cancelled` says so.
pub fn find_modes(
    system: &System,
    first: &[f64],
    named: &[bool],
    limit: usize,
    cancelled: &(dyn Fn() -> bool + Sync),
) -> Modes {
    let mut search = ModeSearch::new(system);
    let mut jobs = vec![Job::Scene {
        named: named.to_vec(),
    }];
    let (mut left, mut random) = (limit, 0);
    loop {
        // Starts derived in earlier rounds come first, then random ones.
        search.search_round(first, jobs, cancelled);
        if search.is_hopeless() {
            return search.finished(false);
        }
        let others = search.derived.len().min(ROUND).min(left);
        left -= others;
        jobs = search.derived.drain(..others).collect();
        // Good and Turing: the share of unseen assemblies, from those found once.
        let is_exhausted = random >= LEAST_RANDOM && search.unseen_chance() < UNSEEN;
        if cancelled() || is_exhausted && jobs.is_empty() || left == 0 && jobs.is_empty() {
            return search.finished(is_exhausted);
        }
        if !is_exhausted {
            let count = ROUND.min(left);
            left -= count;
            jobs.extend((1..=count).map(|k| Job::Random(random + k)));
            random += count;
        }
    }
}

/// The results so far.
struct ModeSearch<'s> {
    system: &'s System,
    random: RandomStarts<'s>,
    alike: Alike<'s>,
    regular: RegularPoses<'s>,
    groups: Vec<ModeGroup>,
    places: Vec<PlacedPoint>,
    /// For every placement its bodies' positions (nothing for a continuous set), and the random starts that led to it.
    placements: Vec<(Vec<f64>, usize)>,
    sets: Vec<(Continuum, usize)>,
    tallies: [(StartKind, StartResults); 4],
    /// Starts that follow from what was found.
    derived: VecDeque<Job>,
}

impl<'s> ModeSearch<'s> {
    fn new(system: &'s System) -> Self {
        let kinds = [
            StartKind::Scene,
            StartKind::Random,
            StartKind::Mirrored,
            StartKind::Continued,
        ];
        Self {
            system,
            random: RandomStarts::new(system.mechanism()),
            alike: Alike::new(system),
            regular: RegularPoses::new(system),
            groups: Vec::new(),
            places: Vec::new(),
            placements: Vec::new(),
            sets: Vec::new(),
            tallies: kinds.map(|kind| (kind, StartResults::default())),
            derived: VecDeque::new(),
        }
    }

    /// Performs some starts and sorts their results, in order.
    fn search_round(
        &mut self,
        first: &[f64],
        jobs: Vec<Job>,
        cancelled: &(dyn Fn() -> bool + Sync),
    ) {
        let system = self.system;
        let work = |(): &mut (), index: usize| {
            let is_on = !cancelled();
            let random = &self.random;
            is_on.then(|| search_closures(system, random, first, &jobs[index], cancelled))
        };
        let found = share_work(jobs.len(), core_count(), || (), work);
        // In the order of the starts, regardless of the threads.
        for (index, closures) in found {
            let kind = jobs[index].kind();
            let tally = self.tally_of(kind);
            tally.starts += 1;
            tally.closed += usize::from(!closures.is_empty());
            for (number, pose) in closures.into_iter().enumerate() {
                let group = self.sort_pose(pose, kind);
                // Of the scene's start the first is where its motion starts.
                self.groups[group].is_scene |= kind == StartKind::Scene && number == 0;
            }
        }
    }

    fn tally_of(&mut self, kind: StartKind) -> &mut StartResults {
        &mut self.tallies[kind as usize].1
    }

    /// Adds a closed pose to its group, and returns its number.
    fn sort_pose(&mut self, pose: Vec<f64>, kind: StartKind) -> usize {
        let place = self.alike.place(&pose);
        let known = self.known_group(&pose, &place);
        // A known mode, else a point of a known continuous set or a copy of a singular pose, else a new one.
        let group = known
            .or_else(|| self.set_of(&pose, &place))
            .or_else(|| self.copied_group(&pose));
        let index = group.unwrap_or(self.groups.len());
        match group {
            Some(group) => {
                let group = &mut self.groups[group];
                match group.dimension {
                    0 => group.meet(self.system.mechanism(), pose),
                    _ => group.met += 1,
                }
            }
            None => self.add(pose, place, kind),
        }
        if kind == StartKind::Random {
            self.placements[self.groups[index].placement].1 += 1;
        }
        index
    }

    /// The group with the placement of a pose that is not proved to be another.
    fn known_group(&mut self, pose: &[f64], place: &PlacedPoint) -> Option<usize> {
        let (groups, regular) = (&self.groups, &mut self.regular);
        let mut known = self.places.iter().zip(groups);
        known.position(|(other, group)| {
            same_numbers(&other.links, &place.links) && !regular.are_apart(&group.coordinates, pose)
        })
    }

    /// The known placement of the bodies at a pose, none of whose modes is proved to be another.
    fn known_placement(&mut self, pose: &[f64], place: &PlacedPoint) -> Option<usize> {
        let (groups, regular) = (&self.groups, &mut self.regular);
        (0..self.placements.len()).find(|number| {
            let mut own = groups.iter().filter(|group| group.placement == *number);
            same_numbers(&self.placements[*number].0, &place.bodies)
                && !own.any(|group| regular.are_apart(&group.coordinates, pose))
        })
    }

    /// The group of the known continuous set on which a pose lies.
    fn set_of(&self, pose: &[f64], place: &PlacedPoint) -> Option<usize> {
        if self.sets.is_empty() {
            return None;
        }
        let dimension = lost_rank(self.system, pose);
        let mut sets = self.sets.iter();
        let own =
            |(set, _): &&(Continuum, usize)| dimension > 0 && set.holds(&place.links, dimension);
        sets.find(own).map(|(_, group)| *group)
    }

    /// The group of an isolated singular pose of which this one is a copy.
    fn copied_group(&self, pose: &[f64]) -> Option<usize> {
        if !is_blurred(self.system, pose) {
            return None;
        }
        let mut groups = self.groups.iter();
        groups.position(|group| {
            group.dimension == 0 && are_copies(self.system, &group.coordinates, pose)
        })
    }

    /// A new group.
    fn add(&mut self, pose: Vec<f64>, place: PlacedPoint, kind: StartKind) {
        let set = Continuum::new(self.system, &self.alike, &pose);
        let known = match set {
            Some(_) => None,
            None => self.known_placement(&pose, &place),
        };
        let placement = known.unwrap_or(self.placements.len());
        if known.is_none() {
            self.tally_of(kind).new += 1;
            if set.is_none() && self.derived.len() < MOST_WAITING {
                self.derive_starts(&pose);
            }
            // Only a set can be equal to a set.
            let bodies = match set {
                Some(_) => vec![f64::NAN],
                None => place.bodies.clone(),
            };
            self.placements.push((bodies, 0));
        }
        let dimension = set.as_ref().map_or(0, |set| set.dimension);
        self.sets.extend(set.map(|set| (set, self.groups.len())));
        self.groups.push(ModeGroup {
            coordinates: pose,
            met: 1,
            is_scene: false,
            placement,
            dimension,
        });
        self.places.push(place);
    }

    /// Starts that follow from a new placement.
    fn derive_starts(&mut self, pose: &[f64]) {
        let mechanism = self.system.mechanism();
        let structure = self.system.structure();
        for (index, block) in structure.blocks.iter().enumerate() {
            if block.unknowns.is_empty() {
                continue;
            }
            for kinds in [&[Kind::Angle][..], &[Kind::Angle, Kind::Length]] {
                let mut values = pose.to_vec();
                let of_kind = |slot: &&usize| kinds.contains(&mechanism.unknowns[**slot].kind);
                for slot in block.unknowns.iter().filter(of_kind) {
                    values[*slot] = -values[*slot];
                }
                self.derived.push_back(Job::Mirrored(values));
            }
            // An over-determined block has no curve when some equations are released.
            let is_square = block.rows() == block.unknowns.len();
            if is_square && block.rows() > 1 && block.rows() <= WIDEST {
                let key = self.placements.len() as u64;
                let pose = pose.to_vec();
                self.derived.push_back(Job::Continued {
                    pose,
                    block: index,
                    key,
                });
            }
        }
    }

    /// Good and Turing's estimate of the probability that one more random start leads to a new placement: the share of
    /// starts whose placement was found once. A start that does not close counts like any other outcome.
    fn unseen_chance(&self) -> f64 {
        let once = self.placements.iter().filter(|(_, met)| *met == 1).count();
        let random = self.tallies[StartKind::Random as usize].1.starts;
        once as f64 / (random as f64).max(1.0)
    }

    /// Whether there are too many placements to be listed.
    fn is_hopeless(&self) -> bool {
        let random = self.tallies[StartKind::Random as usize].1.starts;
        random >= HOPELESS_AFTER && self.unseen_chance() > HOPELESS
    }

    fn finished(self, is_exhausted: bool) -> Modes {
        let unseen = match self.tallies[StartKind::Random as usize].1.starts {
            0 => 1.0,
            _ => self.unseen_chance(),
        };
        let alike = |a: &[f64], b: &[f64]| {
            let [a, b] = [a, b].map(|pose| self.alike.place(pose).links);
            same_numbers(&a, &b)
        };
        Modes {
            unlikely: self.placements.iter().filter(|(_, met)| *met == 0).count(),
            tallies: self.tallies.to_vec(),
            unseen,
            is_exhausted,
            is_hopeless: self.is_hopeless(),
            bodies: self.alike.bodies().to_vec(),
            reaches: self.random.reaches().collect(),
            list: describe_mode(self.system, self.groups, alike),
        }
    }
}

/// The closed poses to which a start leads.
fn search_closures(
    system: &System,
    random: &RandomStarts,
    first: &[f64],
    job: &Job,
    cancelled: &(dyn Fn() -> bool + Sync),
) -> Vec<Vec<f64>> {
    let mechanism = system.mechanism();
    let starts = match job {
        // If the named values are not kept, the start leads to an assembly of its own.
        Job::Scene { .. } => vec![first.to_vec()],
        Job::Random(number) => vec![random.values(first, *number)],
        Job::Mirrored(values) => vec![values.clone()],
        Job::Continued { pose, block, key } => {
            branch_neighbours(mechanism, &system.blocks()[*block], pose, *key, cancelled)
        }
    };
    let meant = match job {
        Job::Scene { named } => PoseSolver::new(system).assembled(first, Some(named)).ok(),
        _ => None,
    };
    let closed = starts.into_iter().filter_map(|mut values| {
        for held in &system.structure().held {
            values[held.unknown] = first[held.unknown];
        }
        // Separate buffers: the last digits must not depend on previous starts.
        let mut corrector = Corrector::new(system);
        let pose = assemble_pose(system, &mut corrector, &values, false).ok()?;
        Some(pose.coordinates)
    });
    // Mostly the plain start ends where the meant one does.
    let meant: Vec<Vec<f64>> = meant.into_iter().map(|pose| pose.coordinates).collect();
    let is_other = |pose: &Vec<f64>| !meant.iter().any(|known| same_numbers(known, pose));
    let others: Vec<Vec<f64>> = closed.filter(is_other).collect();
    meant
        .into_iter()
        .chain(others)
        .filter(|pose| closes(mechanism, pose))
        .collect()
}
