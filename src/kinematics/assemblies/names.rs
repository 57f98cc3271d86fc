//! Modes as values: the preferred coordinates of a pose, branch signature, singular value, and their order.

use super::alike::SAME;
use super::sets::SINGULAR;
use crate::kinematics::ball::chart::BallChart;
use crate::kinematics::ball::joint::Ball;
use crate::kinematics::certificate::regular::RegularPoses;
use crate::kinematics::loops::forward::closure_error;
use crate::kinematics::solve::branch::BranchWatch;
use crate::kinematics::solve::closure::closes;
use crate::kinematics::solve::newton::Corrector;
use crate::kinematics::solve::turns::WholeTurns;
use crate::kinematics::structure::system::System;
use crate::model::mechanism::{Kind, Mechanism};
use crate::sorting::sort_by_key;
use std::f64::consts::{PI, TAU};

/// Coordinates that agree within this count as equal when modes are ordered and angles are wrapped.
const EQUAL: f64 = 1e-9;

/// One assembly: a set of placements of the links.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Unknowns, then inputs, radians or the scene's unit; of all equivalent coordinates those with the smallest
    /// angles.
    pub coordinates: Vec<f64>,
    /// One sign per block, comparable between the modes of one search.
    pub branch: String,
    /// Smallest singular value of the scaled Jacobian.
    pub sigma_min: f64,
    /// Whether assemblies meet here, or it belongs to a continuous set.
    pub is_singular: bool,
    /// Largest closure error of any loop relative to the size, by a plain product.
    pub closure_error: f64,
    /// Number of starts that led to it, or to any point of its continuous set.
    pub met: usize,
    /// Whether the start values of the scene lead to it.
    pub is_scene: bool,
    /// Number of the placement, from 1 in the order of the list.
    pub placement: usize,
    /// Dimension of its continuous set; zero if it is isolated.
    pub dimension: usize,
    /// Ball joints whose second set of Euler angles gives the same pose.
    pub renamed_balls: Vec<usize>,
}

impl Mode {
    /// Equivalent coordinates of the pose: sets of Euler angles in all combinations.
    pub fn names(&self) -> u64 {
        let balls = u32::try_from(self.renamed_balls.len()).unwrap_or(u32::MAX);
        2_u64.saturating_pow(balls)
    }
}

/// The kinds of starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StartKind {
    /// The start values of the scene.
    Scene,
    /// Random values.
    Random,
    /// A known mode with the coordinates of some block reversed.
    Mirrored,
    /// A walk from a known mode along a curve that leads to others.
    Continued,
}

/// The results of one kind of starts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StartResults {
    /// Starts.
    pub starts: usize,
    /// Those that led to a closed pose.
    pub closed: usize,
    /// Number of new placements among them.
    pub new: usize,
}

/// The result of a search.
#[derive(Clone, Debug, PartialEq)]
pub struct Modes {
    /// The modes, by placement, then signature, then coordinates; a continuous set is represented by one.
    pub list: Vec<Mode>,
    /// Bodies whose placements are counted; without any it is the links.
    pub bodies: Vec<usize>,
    /// What the starts of every kind led to.
    pub tallies: Vec<(StartKind, StartResults)>,
    /// Good and Turing's estimate of the probability that one more random start leads to a new placement.
    pub unseen: f64,
    /// Unknowns that no link limits, and how far from zero the random starts of each reached.
    pub reaches: Vec<(usize, f64)>,
    /// Placements that no random start led to.
    pub unlikely: usize,
    /// Whether the search ended because hardly anything seems to be missing, not because the starts were used up.
    pub is_exhausted: bool,
    /// Whether most random starts lead to new placements: there are too many to list.
    pub is_hopeless: bool,
}

impl Modes {
    /// Starts that were made, of all kinds.
    pub fn starts(&self) -> usize {
        self.tallies.iter().map(|(_, tally)| tally.starts).sum()
    }

    /// Starts that led to a closed pose.
    pub fn closed(&self) -> usize {
        self.tallies.iter().map(|(_, tally)| tally.closed).sum()
    }

    /// Placements: isolated ones and continuous sets.
    pub fn placements(&self) -> usize {
        let numbers = self.list.iter().map(|mode| mode.placement);
        numbers.max().unwrap_or(0)
    }

    /// Names of all modes.
    pub fn names(&self) -> u64 {
        let names = self.list.iter().map(Mode::names);
        names.fold(0, u64::saturating_add)
    }

    /// Isolated placements.
    pub fn isolated(&self) -> usize {
        let mut numbers: Vec<usize> = self.of_dimension(|d| d == 0).collect();
        numbers.dedup();
        numbers.len()
    }

    /// Curves of solutions.
    pub fn curves(&self) -> usize {
        self.of_dimension(|d| d == 1).count()
    }

    /// Sets of solutions with more dimensions.
    pub fn larger_sets(&self) -> usize {
        self.of_dimension(|d| d > 1).count()
    }

    fn of_dimension(&self, fits: impl Fn(usize) -> bool) -> impl Iterator<Item = usize> {
        let fitting = self.list.iter().filter(move |mode| fits(mode.dimension));
        fitting.map(|mode| mode.placement)
    }
}

/// A pose that was found.
pub struct ModeGroup {
    /// Unknowns, then inputs.
    pub coordinates: Vec<f64>,
    /// Starts that led to it.
    pub met: usize,
    /// The scene's own start did.
    pub is_scene: bool,
    /// Placements in the order in which they were found.
    pub placement: usize,
    /// Of its continuous set.
    pub dimension: usize,
}

impl ModeGroup {
    /// Another closure of the same mode: its coordinates are kept if their angles are smaller.
    pub fn meet(&mut self, mechanism: &Mechanism, coordinates: Vec<f64>) {
        self.met += 1;
        if angle_sum(mechanism, &coordinates) < angle_sum(mechanism, &self.coordinates) - EQUAL {
            self.coordinates = coordinates;
        }
    }

    /// Replaces second Euler angles by first ones if that makes the angles smaller and moves no link; returns the ball
    /// joints that have second ones.
    fn rename(
        &mut self,
        mechanism: &Mechanism,
        balls: &[Ball],
        alike: impl Fn(&[f64], &[f64]) -> bool,
    ) -> Vec<usize> {
        let mut renamed = Vec::new();
        for (index, ball) in balls.iter().enumerate() {
            let mut other = self.coordinates.clone();
            ball.rename(&mut other);
            wrap_angles(mechanism, &mut other);
            if !closes(mechanism, &other) || !alike(&other, &self.coordinates) {
                continue;
            }
            renamed.push(index);
            // Of the two sets of Euler angles of a rotation the smaller one is kept.
            if angle_sum(mechanism, &other) < angle_sum(mechanism, &self.coordinates) - EQUAL {
                self.coordinates = other;
            }
        }
        wrap_angles(mechanism, &mut self.coordinates);
        renamed
    }
}

/// Sum of the angles' magnitudes: of equivalent coordinates those with the smallest sum are shown.
fn angle_sum(mechanism: &Mechanism, coordinates: &[f64]) -> f64 {
    let pairs = mechanism.unknowns.iter().zip(coordinates);
    pairs
        .filter(|(unknown, _)| unknown.kind == Kind::Angle)
        .map(|(_, value)| value.abs())
        .sum()
}

/// Brings angles whose turns do not matter to -π (exclusive) … π.
fn wrap_angles(mechanism: &Mechanism, coordinates: &mut [f64]) {
    let whole = WholeTurns::of(mechanism);
    for (slot, unknown) in mechanism.unknowns.iter().enumerate() {
        let value = coordinates[slot];
        let outside = value > PI + EQUAL || value <= -PI + EQUAL;
        if unknown.kind == Kind::Angle && outside && !whole.matter(slot) {
            let turns = ((value - PI - EQUAL) / TAU).ceil();
            coordinates[slot] = value - TAU * turns;
        }
    }
}

/// Preferred coordinates, signatures and singular values, and the order of the table.
pub fn describe_mode(
    system: &System,
    groups: Vec<ModeGroup>,
    alike: impl Fn(&[f64], &[f64]) -> bool,
) -> Vec<Mode> {
    let mechanism = system.mechanism();
    let mut watch = BranchWatch::default();
    let mut corrector = Corrector::new(system);
    let chart = BallChart::new(system);
    let mut regular = RegularPoses::new(system);
    let mut list: Vec<Mode> = Vec::new();
    for mut group in groups {
        let renamed_balls = group.rename(mechanism, system.balls(), &alike);
        let coordinates = &group.coordinates;
        // Signs and singular values tell which branch this assembly is on.
        let state = match &chart {
            // Near gimbal lock signs and singular values are those of the rotations.
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
            // However small: its scale may be far from the unknown's.
            is_singular: state.sigma_min < SINGULAR
                && regular.error_bound(&group.coordinates).is_none(),
            closure_error: closure_error(mechanism, &group.coordinates),
            met: group.met,
            is_scene: group.is_scene,
            placement: group.placement,
            dimension: group.dimension,
            renamed_balls,
            coordinates: group.coordinates,
        });
    }
    order_modes(mechanism, list)
}

/// By signature and coordinates; modes of one placement are adjacent, and placements are numbered in order of
/// appearance.
fn order_modes(mechanism: &Mechanism, mut list: Vec<Mode>) -> Vec<Mode> {
    // Rounded, so that differences due to rounding do not affect the order.
    let key = |mode: &Mode| -> Vec<i64> {
        let unknowns = 0..mechanism.unknowns.len();
        unknowns
            .map(|k| (mode.coordinates[k] / mechanism.scale_of(k) / SAME).round() as i64)
            .collect()
    };
    list.sort_by_cached_key(|mode| (mode.branch.clone(), key(mode)));
    let mut order: Vec<usize> = Vec::new();
    for mode in &mut list {
        let known = order.iter().position(|p| *p == mode.placement);
        mode.placement = 1 + known.unwrap_or_else(|| {
            order.push(mode.placement);
            order.len() - 1
        });
    }
    sort_by_key(&mut list, |mode| mode.placement);
    list
}
