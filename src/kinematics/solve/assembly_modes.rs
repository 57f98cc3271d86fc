//! The assemblies of a mechanism at one pose of its inputs: many starts, and what they lead to without repetition.
//!
//! A count, not a proof: an assembly that no start leads to stays unknown. Two closures are the same assembly when
//! all links stand alike, whatever the angles are called: whole turns and the second set of Euler angles of a ball
//! joint make no other assembly.

use super::assembly::{assemble, turns_matter};
use super::branch::BranchWatch;
use super::newton::Corrector;
use crate::jobs::{cores, share};
use crate::kinematics::ball::chart::Chart;
use crate::kinematics::ball::joint::Ball;
use crate::kinematics::loops::forward::{body_poses, closure_error};
use crate::kinematics::structure::system::System;
use crate::math::{Pose, sin_cos};
use crate::model::chain::{ArgumentValue, Chain};
use crate::model::joints::Passage;
use crate::model::mechanism::{Kind, Mechanism};
use std::f64::consts::{PI, TAU};

/// Random starts unless asked otherwise. The rarest of the sixteen assemblies of the known 6R arm is met by one start
/// in 25, the rarest of the gearshift with its 18 unknowns by one in 120.
pub const DEFAULT_STARTS: usize = 1000;

/// Start values of lengths reach this many sizes to either side; a chain of a few links rarely spans more.
const REACH: f64 = 2.0;

/// Largest closure error of an assembly that counts. Rounding leaves about 1e-15; a start that stopped beside a
/// pose leaves far more.
pub const CLOSED: f64 = 1e-12;

/// Link poses (rotation entries, translations over the size) that agree within this are the same: above what
/// rounding leaves at a nearly singular pose, below the distance of assemblies that can be told apart.
const SAME: f64 = 1e-6;

/// Below this smallest singular value a mode is called singular: a double solution is met to half its digits only.
const SINGULAR: f64 = 1e-6;

/// Coordinates that agree within this count as equal when modes are ordered and angles are wrapped.
const EQUAL: f64 = 1e-9;

/// One assembly.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Unknowns, then inputs, radians or the scene's unit; of all names for the pose the one with the smallest angles.
    pub coordinates: Vec<f64>,
    /// One sign per block, comparable between the modes of one search.
    pub branch: String,
    /// Smallest singular value of the scaled Jacobian.
    pub sigma_min: f64,
    /// Assemblies meet here, or it is a point of a continuous set.
    pub is_singular: bool,
    /// Largest gap of any loop relative to the size, by a plain product.
    pub closure_error: f64,
    /// Starts that led to it.
    pub met: usize,
    /// The start values of the scene lead to it.
    pub is_scene: bool,
}

/// What a search has found.
#[derive(Clone, Debug, PartialEq)]
pub struct Modes {
    /// The assemblies, ordered by signature, then coordinates.
    pub list: Vec<Mode>,
    /// Starts that were made: the scene's own and the random ones.
    pub starts: usize,
    /// Starts that led to a closed pose.
    pub closed: usize,
}

/// Searches the assemblies at the inputs of `first` (start values of the unknowns, then inputs), from there and from
/// `starts` random starts.
///
/// The result depends on nothing but the arguments, in particular not on the number of threads. Ends early, with
/// what it has, when `cancelled` says so.
pub fn find_modes(
    system: &System,
    first: &[f64],
    starts: usize,
    cancelled: &(dyn Fn() -> bool + Sync),
) -> Modes {
    let mechanism = system.mechanism();
    let closures = closures(system, first, starts, cancelled);
    let closed = closures.len();
    let mut groups: Vec<Group> = Vec::new();
    for (start, coordinates) in closures {
        let fingerprint = fingerprint(mechanism, &coordinates);
        let known = groups
            .iter_mut()
            .find(|g| same(&g.fingerprint, &fingerprint));
        match known {
            Some(group) => group.meet(mechanism, coordinates),
            None => groups.push(Group {
                fingerprint,
                coordinates,
                met: 1,
                is_scene: start == 0,
            }),
        }
    }
    for group in &mut groups {
        group.rename(mechanism, system.balls());
    }
    Modes {
        list: described(system, groups),
        starts: starts + 1,
        closed,
    }
}

/// Closures that are one assembly.
struct Group {
    fingerprint: Vec<f64>,
    coordinates: Vec<f64>,
    met: usize,
    is_scene: bool,
}

impl Group {
    /// Another closure of the same assembly: its coordinates are kept if its angles are smaller.
    fn meet(&mut self, mechanism: &Mechanism, coordinates: Vec<f64>) {
        self.met += 1;
        if angles(mechanism, &coordinates) < angles(mechanism, &self.coordinates) - EQUAL {
            self.coordinates = coordinates;
        }
    }

    /// Replaces second Euler angles by first ones where that makes the angles smaller and moves no link.
    fn rename(&mut self, mechanism: &Mechanism, balls: &[Ball]) {
        for ball in balls {
            let mut other = self.coordinates.clone();
            ball.rename(&mut other);
            wrap(mechanism, &mut other);
            if angles(mechanism, &other) < angles(mechanism, &self.coordinates) - EQUAL
                && closure_error(mechanism, &other) <= CLOSED
                && same(&fingerprint(mechanism, &other), &self.fingerprint)
            {
                self.coordinates = other;
            }
        }
        wrap(mechanism, &mut self.coordinates);
    }
}

/// All closed poses, in the order of their starts.
fn closures(
    system: &System,
    first: &[f64],
    starts: usize,
    cancelled: &(dyn Fn() -> bool + Sync),
) -> Vec<(usize, Vec<f64>)> {
    let mechanism = system.mechanism();
    let found = share(
        starts + 1,
        cores(),
        || (),
        |(), start| {
            if cancelled() {
                return None;
            }
            let mut values = start_values(mechanism, first, start);
            for held in &system.structure().held {
                values[held.unknown] = first[held.unknown];
            }
            // Buffers of its own: what another start has left in them must not show in the last digits.
            let mut corrector = Corrector::new(system);
            let pose = assemble(system, &mut corrector, &values, false).ok();
            let pose = pose.map(|pose| pose.coordinates);
            Some(pose.filter(|pose| closure_error(mechanism, pose) <= CLOSED))
        },
    );
    let closed = |(start, pose): (usize, Option<Vec<f64>>)| Some((start, pose?));
    found.into_iter().filter_map(closed).collect()
}

/// Start values and inputs: the given ones for start 0, else random numbers that depend on the start's number only.
pub fn start_values(mechanism: &Mechanism, first: &[f64], start: usize) -> Vec<f64> {
    if start == 0 {
        return first.to_vec();
    }
    let unknowns = mechanism.unknowns.iter().enumerate();
    let shaken = unknowns.map(|(slot, unknown)| {
        let random = random(start as u64, slot as u64);
        match unknown.kind {
            Kind::Angle => PI * random,
            Kind::Length => REACH * mechanism.scale_of(slot) * random,
            Kind::Number => REACH * random,
        }
    });
    let inputs = &first[mechanism.unknowns.len()..];
    shaken.chain(inputs.iter().copied()).collect()
}

/// A number in -1..1 from a key and a counter: the finaliser of SplitMix64 (Steele, Lea, Flood 2014), twice.
fn random(key: u64, counter: u64) -> f64 {
    let mix = |mut z: u64| {
        z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    let bits = mix(mix(key).wrapping_add(counter));
    (bits >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// Everything that tells assemblies apart: poses of links and bodies, and unknowns that move neither.
fn fingerprint(mechanism: &Mechanism, coordinates: &[f64]) -> Vec<f64> {
    let arguments = mechanism.argument_values(coordinates);
    let mut numbers = Vec::new();
    let mut note = |pose: &Pose, size: f64| {
        numbers.extend(pose.rotation.to_cols_array());
        numbers.extend((pose.translation / size).to_array());
    };
    for (item, passages) in mechanism.loops.iter().zip(&mechanism.joints.along_loops) {
        let mut of_loop = |pose: &Pose| note(pose, item.size);
        links(&item.chain, passages, &arguments, &mut of_loop);
    }
    let bodies = body_poses(mechanism, coordinates);
    bodies.iter().for_each(|pose| note(pose, mechanism.size));
    for slot in outside_chains(mechanism) {
        match mechanism.unknowns[slot].kind {
            Kind::Angle => numbers.extend(<[f64; 2]>::from(sin_cos(coordinates[slot]))),
            Kind::Length | Kind::Number => {
                numbers.push(coordinates[slot] / mechanism.scale_of(slot));
            }
        }
    }
    numbers
}

/// Poses of the links behind the joints of a chain.
fn links(
    chain: &Chain,
    passages: &[Passage],
    arguments: &[ArgumentValue],
    note: &mut impl FnMut(&Pose),
) {
    let mut pose = Pose::IDENTITY;
    let mut ends = passages.iter().map(|p| p.steps.end).peekable();
    for (k, step) in chain.steps.iter().enumerate() {
        step.advance(&mut pose, arguments);
        if ends.next_if_eq(&(k + 1)).is_some() {
            note(&pose);
        }
    }
}

/// Unknowns that stand in formulas only.
fn outside_chains(mechanism: &Mechanism) -> Vec<usize> {
    let mut used = vec![false; mechanism.coordinate_count()];
    for argument in mechanism.chains().flat_map(Chain::arguments) {
        for slot in mechanism.arguments[argument].coordinates() {
            used[slot] = true;
        }
    }
    (0..mechanism.unknowns.len())
        .filter(|slot| !used[*slot])
        .collect()
}

fn same(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= SAME)
}

/// Sum of the angles' magnitudes: of several names for a pose the one with the smallest sum is shown.
fn angles(mechanism: &Mechanism, coordinates: &[f64]) -> f64 {
    let pairs = mechanism.unknowns.iter().zip(coordinates);
    pairs
        .filter(|(unknown, _)| unknown.kind == Kind::Angle)
        .map(|(_, value)| value.abs())
        .sum()
}

/// Brings angles whose turns do not matter to -π (exclusive) … π.
fn wrap(mechanism: &Mechanism, coordinates: &mut [f64]) {
    for (slot, unknown) in mechanism.unknowns.iter().enumerate() {
        let value = coordinates[slot];
        let outside = value > PI + EQUAL || value <= -PI + EQUAL;
        if unknown.kind == Kind::Angle && outside && !turns_matter(mechanism, slot) {
            let turns = ((value - PI - EQUAL) / TAU).ceil();
            coordinates[slot] = value - TAU * turns;
        }
    }
}

/// Signatures and singular values, and the order of the table.
fn described(system: &System, groups: Vec<Group>) -> Vec<Mode> {
    let mechanism = system.mechanism();
    let mut watch = BranchWatch::default();
    let mut corrector = Corrector::new(system);
    let chart = Chart::new(system);
    let mut list: Vec<Mode> = Vec::new();
    for group in groups {
        let coordinates = &group.coordinates;
        let state = match &chart {
            // Next to gimbal-locked angles signs and singular values are those of the rotations.
            Some(chart) if chart.is_needed(coordinates) => {
                let (own, mut corrector) = (chart.base(coordinates), Corrector::new(chart.system));
                watch.observe(chart.system, &mut corrector, &own)
            }
            _ => {
                let mut state = watch.observe(system, &mut corrector, coordinates);
                for ball in system.balls() {
                    state.signs[ball.block] *= ball.orientation(coordinates);
                }
                state
            }
        };
        list.push(Mode {
            branch: state.signature(),
            sigma_min: state.sigma_min,
            is_singular: state.sigma_min < SINGULAR,
            closure_error: closure_error(mechanism, &group.coordinates),
            met: group.met,
            is_scene: group.is_scene,
            coordinates: group.coordinates,
        });
    }
    // Rounded, so that coordinates that differ by rounding only do not decide.
    let key = |mode: &Mode| -> Vec<i64> {
        let unknowns = 0..mechanism.unknowns.len();
        unknowns
            .map(|k| (mode.coordinates[k] / mechanism.scale_of(k) / SAME).round() as i64)
            .collect()
    };
    list.sort_by_cached_key(|mode| (mode.branch.clone(), key(mode)));
    list
}
