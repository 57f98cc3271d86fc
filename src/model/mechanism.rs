//! The whole mechanism as resolved: coordinates, loops, bodies, outputs. Immutable; names are for people only.

use super::chain::{Argument, ArgumentValue, Chain, ChainStep, ElementaryMotion};
pub use super::dimension::Kind;
use super::dimension::PhysicalDimension;
use super::distance::Distance;
use super::expression::Expression;
use super::joints::Joints;
use super::rate::{MAX_ORDER, RatedFormula};
use super::shape::Shape;
use crate::numbers::constant::Constant;
use glam::DVec3;
use std::collections::BTreeSet;

/// A joint coordinate: an unknown or an input.
#[derive(Clone, Debug, PartialEq)]
pub struct Coordinate {
    /// Name in the scene.
    pub name: String,
    /// Length or angle (or number, where only formulas use it).
    pub kind: Kind,
}

/// The condition on a loop's product.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Closes {
    /// The identity: six equations.
    Frame,
    /// Any rotation about its origin: three equations, as for a sphere, of which only the centre matters.
    Point,
}

/// A chain that must close.
#[derive(Clone, Debug, PartialEq)]
pub struct Loop {
    /// Name in the scene.
    pub name: String,
    /// From the world to the start of the loop: motions common to both its sides, which closing it does not determine
    /// (the slewing house of an excavator). Without steps if there are none.
    pub base: Chain,
    /// The product.
    pub chain: Chain,
    /// What it must be.
    pub closes: Closes,
    /// Its own unit of length, used for its translation.
    pub size: f64,
}

/// Two cylinders in contact that may cross at any angle; only if they cross do they touch in a point.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisCrossing {
    /// Name of the contact.
    pub contact: String,
    /// From the frame of the first cylinder to that of the second; their axes are z.
    pub across: Chain,
}

/// A formula over the coordinates that must vanish.
#[derive(Clone, Debug, PartialEq)]
pub struct Equation {
    /// Name in the scene.
    pub name: String,
    /// Slots are coordinates.
    pub expression: Expression,
    /// Power of length in its dimension: its natural scale is `size` to this power.
    pub length_exponent: f64,
    /// Factor that makes its value comparable with one: the inverse of the magnitude of its terms.
    pub weight: f64,
}

/// A bar between two points, whose equation has its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    /// Name in the scene.
    pub name: String,
    /// The points.
    pub ends: [BarEnd; 2],
    /// Its length, if it is constant.
    pub length: Option<f64>,
}

impl Bar {
    /// By how much it is too long, where its equation has this value: (d² - L²) / (2 L) for a constant length. `None` for
    /// a variable one, whose equation is one of squares.
    pub fn off_length(&self, value: f64) -> Option<f64> {
        let length = self.length?;
        let squared = length * (length + 2.0 * value);
        // Rounding below zero is none; what has no value keeps none.
        let apart = if squared < 0.0 { 0.0 } else { squared.sqrt() };
        Some(apart - length)
    }
}

/// A point that a bar ends in.
#[derive(Clone, Debug, PartialEq)]
pub struct BarEnd {
    /// Its coordinates, as translations along the axes of the world.
    pub point: Chain,
    /// The chain that carries it, from the world.
    pub carrier: Chain,
}

/// A link: its frame and its appearance.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Name in the scene.
    pub name: String,
    /// The chain whose product is `world_from_body`.
    pub world_from_body: Chain,
    /// Solids fixed to it.
    pub shapes: Vec<Shape>,
}

/// A point of a body whose path is kept.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// Name in the scene.
    pub name: String,
    /// Index of the body.
    pub body: usize,
    /// The point in the body's frame.
    pub point: DVec3,
    /// sRGB colour of its path.
    pub colour: [u8; 3],
    /// Radius of the path as drawn, in the scene's unit; `None` for a default; zero hides it.
    pub radius: Option<f64>,
}

/// A named scalar for tables and plots.
#[derive(Clone, Debug, PartialEq)]
pub struct MechanismOutput {
    /// Name in the scene.
    pub name: String,
    /// Where it comes from.
    pub source: OutputSource,
    /// What it measures.
    pub kind: Kind,
    /// The same with powers and products: a number may be an area.
    pub dimension: PhysicalDimension,
}

/// The definition of an output.
#[derive(Clone, Debug, PartialEq)]
pub enum OutputSource {
    /// Slots: coordinates, then x, y, z of every trace, then earlier outputs.
    Formula(Expression),
    /// The distance of bodies.
    Distance(Distance),
    /// A formula that contains rates: it is defined only along a motion, and only in plain numbers.
    Rated(RatedFormula),
}

/// Angle unit of a scene file.
#[derive(Clone, Debug, PartialEq)]
pub struct AngleUnit {
    /// `rad` or `deg`.
    pub name: String,
    /// Radians in one unit.
    pub radians: Constant,
}

impl AngleUnit {
    /// Names in scene files.
    pub const NAMES: [&'static str; 2] = ["rad", "deg"];

    /// The unit called `rad` or `deg`.
    pub fn from_name(name: &str) -> Option<Self> {
        let radians = match name {
            "rad" => Constant::exact(1.0),
            "deg" => Constant::PI / Constant::exact(180.0),
            _ => return None,
        };
        let name = name.to_owned();
        Some(Self { name, radians })
    }
}

impl Default for AngleUnit {
    fn default() -> Self {
        Self {
            name: "rad".to_owned(),
            radians: Constant::exact(1.0),
        }
    }
}

/// A mechanism ready to be solved.
#[derive(Clone, Debug, PartialEq)]
pub struct Mechanism {
    /// Title of the scene.
    pub title: String,
    /// Name of the length unit (`mm`); lengths are never converted.
    pub length_unit: String,
    /// Unit of angles in files and tables.
    pub angle_unit: AngleUnit,
    /// What the loops determine.
    pub unknowns: Vec<Coordinate>,
    /// What is driven.
    pub inputs: Vec<Coordinate>,
    /// Arguments of all joints. Slots: unknowns, then inputs.
    pub arguments: Vec<Argument>,
    /// Which of them only move along an axis: no sine is needed of these. Those without an entry may turn something.
    pub sliding: Vec<bool>,
    /// Chains that must be the identity.
    pub loops: Vec<Loop>,
    /// Scalar equations.
    pub equations: Vec<Equation>,
    /// Those equations that are bars.
    pub bars: Vec<Bar>,
    /// Names of the loops and equations that are contacts of surfaces.
    pub contacts: Vec<String>,
    /// Contacts of cylinders that may cross at any angle.
    pub crossings: Vec<AxisCrossing>,
    /// Links.
    pub bodies: Vec<Body>,
    /// Traced points.
    pub traces: Vec<Trace>,
    /// Named scalars.
    pub outputs: Vec<MechanismOutput>,
    /// Its chains as joints and links.
    pub joints: Joints,
    /// Characteristic length of the whole: no loop's own is larger.
    pub size: f64,
    /// The scale of a coordinate: for a length the unit of its loops, for a number its magnitude, for an angle one.
    pub scales: Vec<f64>,
}

impl Mechanism {
    /// Whether a formula of slots uses outputs that contain rates, directly or through other outputs.
    pub fn uses_rates(&self, formula: &Expression) -> bool {
        self.uses(formula, |source| matches!(source, OutputSource::Rated(_)))
    }

    /// The same of distances of bodies.
    pub fn uses_distances(&self, formula: &Expression) -> bool {
        self.uses(formula, |source| {
            matches!(source, OutputSource::Distance(_))
        })
    }

    fn uses(&self, formula: &Expression, is_such: impl Fn(&OutputSource) -> bool) -> bool {
        let first = self.coordinate_count() + 3 * self.traces.len();
        let mut held: Vec<bool> = Vec::with_capacity(self.outputs.len());
        for output in &self.outputs {
            let source = &output.source;
            held.push(match source {
                OutputSource::Formula(formula) => uses_any(formula, first, &held),
                _ => is_such(source),
            });
        }
        uses_any(formula, first, &held)
    }

    /// Whether all outputs follow from a pose alone: none contains rates, or distances of bodies.
    pub fn has_plain_outputs(&self) -> bool {
        let mut outputs = self.outputs.iter();
        outputs.all(|output| matches!(output.source, OutputSource::Formula(_)))
    }

    /// Number of coordinates: unknowns and inputs.
    pub fn coordinate_count(&self) -> usize {
        self.unknowns.len() + self.inputs.len()
    }

    /// All chains: of loops, of what carries them, of bodies.
    pub fn chains(&self) -> impl Iterator<Item = &Chain> {
        let loops = self.loops.iter().flat_map(|item| [&item.base, &item.chain]);
        loops.chain(self.bodies.iter().map(|b| &b.world_from_body))
    }

    /// The arguments of translations that are not those of a rotation as well.
    pub fn sliding_arguments(&self) -> Vec<bool> {
        let ends = self.bars.iter().flat_map(|bar| &bar.ends);
        let ends = ends.flat_map(|end| [&end.point, &end.carrier]);
        let across = self.crossings.iter().map(|crossing| &crossing.across);
        let steps = self.chains().chain(ends).chain(across);
        let joints = steps.flat_map(|chain| chain.steps.iter().filter_map(ChainStep::joint));
        let mut moves = vec![[false; 2]; self.arguments.len()];
        for joint in joints {
            let turns = joint.motion == ElementaryMotion::Rotation;
            moves[joint.argument][usize::from(turns)] = true;
        }
        moves
            .into_iter()
            .map(|[slides, turns]| slides && !turns)
            .collect()
    }

    /// Values of all arguments at the given coordinates (unknowns, then inputs).
    pub fn argument_values(&self, coordinates: &[f64]) -> Vec<ArgumentValue> {
        let mut scratch = Vec::new();
        let mut value_of = |(k, argument): (usize, &Argument)| {
            let value = argument.value(coordinates, &mut scratch);
            match self.sliding.get(k) {
                Some(true) => ArgumentValue {
                    value,
                    ..ArgumentValue::default()
                },
                _ => ArgumentValue::new(value),
            }
        };
        self.arguments
            .iter()
            .enumerate()
            .map(&mut value_of)
            .collect()
    }

    /// Whether no body has a shape, so that pictures show joints, links and bars instead.
    pub fn has_no_shapes(&self) -> bool {
        self.bodies.iter().all(|body| body.shapes.is_empty())
    }

    /// How far an equation of this value is from holding: of a bar of constant length, by which length.
    pub fn equation_gap(&self, equation: &Equation, value: f64) -> f64 {
        let bar = self.bars.iter().find(|bar| bar.name == equation.name);
        let off = bar.and_then(|bar| bar.off_length(value));
        off.unwrap_or(value).abs()
    }

    /// Scale of a coordinate (unknowns, then inputs): its loops' unit for a length, its magnitude for a number, else one.
    pub fn scale_of(&self, slot: usize) -> f64 {
        self.scales.get(slot).copied().unwrap_or(1.0)
    }

    /// Unknown angles whose turns an equation counts, since they stand in it outside of sines and cosines.
    pub fn counted_angles(&self) -> BTreeSet<usize> {
        let equations = self.equations.iter();
        let slots = equations.flat_map(|e| e.expression.slots_outside_waves());
        let is_angle = |slot: &usize| {
            let unknown = self.unknowns.get(*slot);
            unknown.is_some_and(|unknown| unknown.kind == Kind::Angle)
        };
        slots.filter(is_angle).collect()
    }

    /// What a coordinate (unknowns, then inputs) measures.
    pub fn kind_of(&self, slot: usize) -> Kind {
        let input = slot.wrapping_sub(self.unknowns.len());
        let known = self.unknowns.get(slot).or_else(|| self.inputs.get(input));
        known.map_or(Kind::Number, |c| c.kind)
    }

    /// Least and largest scale of an unknown, with the size for an angle: bounds of the distance of two poses in scaled
    /// unknowns relative to the difference of an unknown.
    pub fn distance_units(&self) -> [f64; 2] {
        let unit = |index: usize| match self.unknowns[index].kind {
            Kind::Angle => self.size,
            Kind::Length | Kind::Number => self.scale_of(index),
        };
        let units = (0..self.unknowns.len()).map(unit);
        let range = units.map(|unit| [unit, unit]);
        range
            .reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
            .unwrap_or([self.size; 2])
    }

    /// Up to which order the rates of outputs are computed: none of formulas that contain rates themselves, the first of distances,
    /// and as many of a formula as of the outputs it uses.
    pub fn output_rate_orders(&self) -> Vec<usize> {
        let first = self.coordinate_count() + 3 * self.traces.len();
        let mut known: Vec<usize> = Vec::with_capacity(self.outputs.len());
        for output in &self.outputs {
            known.push(match &output.source {
                OutputSource::Formula(formula) => {
                    let slots = formula.slots().into_iter();
                    let earlier = slots.filter_map(|s| known.get(s.checked_sub(first)?).copied());
                    earlier.fold(MAX_ORDER, usize::min)
                }
                OutputSource::Distance(_) => 1,
                OutputSource::Rated(_) => 0,
            });
        }
        known
    }
}

/// Whether a formula uses one of the outputs, from slot `first` on, that are marked.
fn uses_any(formula: &Expression, first: usize, told: &[bool]) -> bool {
    let outputs = formula.slots().into_iter();
    let mut outputs = outputs.filter_map(|slot| slot.checked_sub(first));
    outputs.any(|output| told.get(output) == Some(&true))
}
