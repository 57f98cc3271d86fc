//! Proofs that a mechanism has no pose at given inputs, whatever its assembly.
//!
//! Two tests, both with enclosures. A loop is a polygon whose sides are its rigid parts: if one is longer than all others
//! together, it does not close; a part with a slide is as short as its distance from the slide's line. That decides four-bars
//! and slider-cranks. Else, of a block with few angles, the cube of all their values is halved until in every piece some
//! equation has no zero. Neither finding anything says nothing.

use crate::kinematics::loops::enclosed::is_open_throughout;
use crate::kinematics::solve::turns::WholeTurns;
use crate::kinematics::structure::block::Block;
use crate::kinematics::structure::system::System;
use crate::model::chain::{Argument, ArgumentValue, ChainStep, ElementaryMotion};
use crate::model::mechanism::{Closes, Equation, Kind, Loop, Mechanism};
use crate::model::outputs::output_arguments;
use crate::model::walk::{Triple, WalkFrame};
use crate::numbers::interval::Interval;
use crate::numbers::scalar::Scalar;
use std::f64::consts::PI;

/// Number of boxes examined: some tenths of a second for a loop.
const MOST_PIECES: usize = 20_000;

/// Largest number of angles that are bisected: with four there are too many boxes.
const MOST_ANGLES: usize = 3;

/// Whether it is proved that no pose exists with these inputs (radians, lengths), read as numbers or as the decimals of
/// a table. `false` proves nothing.
pub fn has_no_pose(system: &System, inputs: &[f64]) -> bool {
    let mechanism = system.mechanism();
    let coordinates = enclosed_inputs(mechanism, inputs);
    let loops = mechanism.loops.iter();
    let mut too_long = loops.map(|item| has_too_long_a_side(mechanism, item, &coordinates));
    if too_long.any(|is| is) {
        return true;
    }
    // Otherwise bisection of the box of all angles of each block.
    let turns = WholeTurns::of(mechanism);
    let blocks = system.blocks().iter();
    let mut halvings = blocks.map(|block| Halving::new(mechanism, block, &turns));
    halvings.any(|halving| halving.finds_nothing(&coordinates))
}

/// Whether an equation is proved to have no zero, or no value, for any of these coordinates.
pub fn is_equation_open(equation: &Equation, coordinates: &[Interval]) -> bool {
    let range = equation.expression.range(coordinates);
    range.is_none_or(|values| !values.holds_zero())
}

/// All coordinates of poses with these inputs, read as numbers or as the decimals that a table prints: of the unknowns nothing
/// is known.
pub fn enclosed_inputs(mechanism: &Mechanism, inputs: &[f64]) -> Vec<Interval> {
    let unknowns = mechanism.unknowns.len();
    let mut numbers = vec![0.0; unknowns];
    numbers.extend(inputs);
    let rests = mechanism.printed_rests(&numbers);
    let read = |(v, rest): (&f64, f64)| Interval::point(*v).hull(Interval::sum_of(*v, rest));
    let given = numbers.iter().zip(rests).skip(unknowns).map(read);
    let free = std::iter::repeat_n(Interval::ENTIRE, unknowns);
    free.chain(given).collect()
}

/// Rigid parts of a loop between freely rotating joints.
struct PolygonSide {
    frame: WalkFrame<Interval>,
    slides: Vec<Triple<Interval>>,
}

impl PolygonSide {
    fn new() -> Self {
        Self {
            frame: WalkFrame::identity(),
            slides: Vec::new(),
        }
    }

    /// All lengths that it can have.
    fn length(&self) -> Interval {
        let origin = self.frame.origin;
        match self.slides[..] {
            [] => vector_norm(origin),
            [along] => Interval::new(vector_norm(cross_product(origin, along)).lo, f64::INFINITY),
            _ => Interval::new(0.0, f64::INFINITY),
        }
    }
}

fn has_too_long_a_side(mechanism: &Mechanism, item: &Loop, coordinates: &[Interval]) -> bool {
    let arguments = output_arguments(mechanism, &item.chain.arguments(), coordinates);
    let lengths: Vec<Interval> = polygon_sides(mechanism, item, &arguments)
        .iter()
        .map(PolygonSide::length)
        .collect();
    // Sums are rounded upwards, so that a positive answer is proved.
    let together = |skipped: usize| {
        let others = lengths.iter().enumerate().filter(|(k, _)| *k != skipped);
        others.fold(0.0, |sum: f64, (_, l)| (sum + l.hi).next_up())
    };
    lengths.iter().enumerate().any(|(k, l)| l.lo > together(k))
}

/// A closed chain has no first side: the part before its first free rotation continues that after the last.
fn polygon_sides(
    mechanism: &Mechanism,
    item: &Loop,
    arguments: &[ArgumentValue<Interval>],
) -> Vec<PolygonSide> {
    let unknowns = mechanism.unknowns.len();
    let is_free = |argument: usize| {
        let slots = mechanism.arguments[argument].coordinates();
        slots.iter().any(|slot| *slot < unknowns)
    };
    let turns_freely = |step: &ChainStep| matches!(step, ChainStep::Joint { motion: ElementaryMotion::Rotation, argument, .. } if is_free(*argument));
    let steps = &item.chain.steps;
    // A closed chain may be started at any joint; starting with a rotation cuts no side in two.
    let first = match item.closes {
        Closes::Frame => steps.iter().position(turns_freely).unwrap_or(0),
        Closes::Point => 0,
    };
    let mut sides = vec![PolygonSide::new()];
    for step in steps[first..].iter().chain(&steps[..first]) {
        if turns_freely(step) {
            sides.push(PolygonSide::new());
            continue;
        }
        let Some(side) = sides.last_mut() else {
            continue;
        };
        match *step {
            ChainStep::Joint {
                motion: ElementaryMotion::Translation,
                axis,
                argument,
                ..
            } if is_free(argument) => side.slides.push(side.frame.axes[axis]),
            _ => step.advance(&mut side.frame, arguments),
        }
    }
    sides
}

fn cross_product(a: Triple<Interval>, b: Triple<Interval>) -> Triple<Interval> {
    [0, 1, 2].map(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        a[i] * b[j] - a[j] * b[i]
    })
}

fn vector_norm(v: Triple<Interval>) -> Interval {
    let [x, y, z] = v.map(Scalar::square);
    (x + y + z).sqrt()
}

/// The box of a block's angles, bisected until nothing remains.
struct Halving<'m> {
    mechanism: &'m Mechanism,
    block: &'m Block,
    /// Unknowns with a range of one turn.
    angles: Vec<usize>,
}

impl<'m> Halving<'m> {
    fn new(mechanism: &'m Mechanism, block: &'m Block, turns: &WholeTurns) -> Self {
        let angles = block.unknowns.iter().copied().filter(|slot| {
            let is_angle = mechanism.unknowns[*slot].kind == Kind::Angle;
            is_angle && !turns.matter(*slot)
        });
        Self {
            mechanism,
            block,
            angles: angles.collect(),
        }
    }

    /// Whether it is proved that the block has no solution; other unknowns may have any value.
    fn finds_nothing(&self, coordinates: &[Interval]) -> bool {
        let mut whole = coordinates.to_vec();
        for slot in &self.angles {
            whole[*slot] = Interval::around_zero(PI.next_up());
        }
        if self.angles.len() > MOST_ANGLES {
            return self.is_excluded(&whole);
        }
        let mut pieces = vec![whole];
        for _ in 0..MOST_PIECES {
            let Some(piece) = pieces.pop() else {
                return true;
            };
            // Boxes that cannot be excluded are bisected.
            if !self.is_excluded(&piece) {
                match self.halves(piece) {
                    Some(halves) => pieces.extend(halves),
                    None => return false,
                }
            }
        }
        false
    }

    fn halves(&self, piece: Vec<Interval>) -> Option<[Vec<Interval>; 2]> {
        let width = |slot: &usize| piece[*slot].hi - piece[*slot].lo;
        let widest = self
            .angles
            .iter()
            .copied()
            .max_by(|a, b| width(a).total_cmp(&width(b)))?;
        // Bisection of the widest angle.
        let Interval { lo, hi } = piece[widest];
        let middle = piece[widest].middle();
        let mut halves = [piece.clone(), piece];
        halves[0][widest] = Interval::new(lo, middle);
        halves[1][widest] = Interval::new(middle, hi);
        Some(halves)
    }

    /// Some equation has no zero here, or a formula is undefined.
    fn is_excluded(&self, piece: &[Interval]) -> bool {
        let Mechanism {
            loops, equations, ..
        } = self.mechanism;
        let used = &self.block.arguments;
        let arguments = output_arguments(self.mechanism, used, piece);
        let mut parts = self.block.loops.iter();
        let mut scalars = self.block.equations.iter();
        let mut values = used.iter();
        parts.any(|part| is_open_throughout(&loops[part.index], &arguments))
            || scalars.any(|k| is_equation_open(&equations[*k], piece))
            || values.any(|k| match &self.mechanism.arguments[*k] {
                Argument::Affine(_) => false,
                Argument::Formula(formula) => formula.range(piece).is_none(),
            })
    }
}
