//! A scene as equations over numbered coordinates: names looked up, units converted, parameters computed.

use super::chain::{Motion, Part, Step, normalised};
use super::draft::{Draft, expanded, is_known};
use super::file::File;
use super::formula::Node;
use super::number::{Number, Precise};
use super::units::{Kind, Kinds, mark};
use super::value::{Formula, Meaning};
use std::collections::HashMap;

/// What the coordinates must fulfil. Coordinates are the unknowns, then the inputs; angles in radians.
pub struct Scene {
    pub unknowns: Vec<Coordinate>,
    pub inputs: Vec<Coordinate>,
    /// Products that are the identity.
    pub loops: Vec<Vec<Step>>,
    /// Products that leave the origin where it is.
    pub points: Vec<Vec<Step>>,
    /// Two chains whose ends are so far apart.
    pub distances: Vec<([Vec<Step>; 2], Formula)>,
    /// Formulas that are zero.
    pub equations: Vec<Formula>,
    /// Traced points and outputs.
    pub shown: Vec<Shown>,
}

/// What is computed from a pose. Slots are the coordinates and what is shown before it.
pub struct Shown {
    pub name: String,
    /// Radians or lengths per printed unit.
    pub unit: Precise,
    pub what: What,
}

pub enum What {
    /// A coordinate of the end of a chain.
    Place(Vec<Step>, usize),
    Value(Formula),
    /// It stands on a contact, whose frame the judge does not know.
    Unknown,
}

pub struct Coordinate {
    pub name: String,
    /// Radians or lengths per printed unit.
    pub unit: Precise,
    pub is_angle: bool,
    /// The start value, in radians or lengths.
    pub guess: Precise,
}

impl Scene {
    pub fn read(text: &str) -> Self {
        Self::read_with(text, &[])
    }

    /// `angles` are the outputs that are angles.
    pub fn read_with(text: &str, angles: &[String]) -> Self {
        let file = File::parse(text);
        let draft = Draft::new(&file);
        let mut kinds = draft.kinds(&file);
        kinds.extend(angles.iter().map(|name| (name.clone(), Kind::Angle)));
        let mut resolver = Resolver::new(&file, kinds, &draft);
        let mut scene = resolver.scene(&file, &draft);
        scene.shown = resolver.shown(&file);
        scene
    }
}

/// Turns nodes into formulas.
struct Resolver {
    kinds: Kinds,
    file_unit: Precise,
    parameters: HashMap<String, Precise>,
    /// Unknowns, then inputs.
    coordinates: Vec<String>,
    unknowns: usize,
}

impl Resolver {
    fn new(file: &File, kinds: Kinds, draft: &Draft) -> Self {
        let degree = Precise::pi().over(&Precise::of(180.0));
        let mut resolver = Self {
            kinds,
            file_unit: if file.is_in_degrees {
                degree
            } else {
                Precise::of(1.0)
            },
            parameters: HashMap::new(),
            coordinates: Vec::new(),
            unknowns: 0,
        };
        for (name, node) in &file.parameters {
            let formula = resolver.formula(node, resolver.kinds.get(name).copied());
            let value = formula.constant().unwrap().clone();
            resolver.parameters.insert(name.clone(), value);
        }
        let is_input = |name: &str| file.inputs.iter().any(|(n, _)| n == name);
        let mut gather = |node: &Node| {
            node.visit_names(&mut |name| {
                let is_new = !resolver.coordinates.iter().any(|n| n == name);
                if is_new && !is_input(name) && !resolver.parameters.contains_key(name) {
                    resolver.coordinates.push(name.to_owned());
                }
            });
        };
        for part in draft.parts() {
            match part {
                Part::Shift(_, node) | Part::Turn(_, node) => gather(node),
                Part::About(direction, node) => {
                    direction.iter().chain([node]).for_each(&mut gather)
                }
                Part::Screw(_, pitch, node) => [pitch, node].into_iter().for_each(&mut gather),
            }
        }
        file.equations.iter().for_each(&mut gather);
        resolver.unknowns = resolver.coordinates.len();
        resolver
            .coordinates
            .extend(file.inputs.iter().map(|(name, _)| name.clone()));
        resolver
    }

    fn formula(&self, node: &Node, wanted: Option<Kind>) -> Formula {
        let marked = mark(node.clone(), wanted, &self.kinds);
        Formula::new(
            &marked,
            &self.file_unit,
            &|name| match self.parameters.get(name) {
                Some(value) => Meaning::Constant(value.clone()),
                None => {
                    let index = self.coordinates.iter().position(|n| n == name);
                    Meaning::Coordinate(index.unwrap_or_else(|| panic!("`{name}` is not known")))
                }
            },
        )
    }

    fn steps(&self, parts: &[Part]) -> Vec<Step> {
        let constant = |node: &Node| self.formula(node, None).constant().unwrap().clone();
        let step = |part: &Part| match part {
            Part::Shift(axis, length) => Step::new(
                Motion::Shift(*axis),
                self.formula(length, Some(Kind::Length)),
            ),
            Part::Turn(axis, angle) => {
                Step::new(Motion::Turn(*axis), self.formula(angle, Some(Kind::Angle)))
            }
            Part::About(direction, angle) => {
                let direction = normalised(direction.each_ref().map(constant));
                Step::new(
                    Motion::About(direction),
                    self.formula(angle, Some(Kind::Angle)),
                )
            }
            Part::Screw(axis, pitch, angle) => {
                let pitch = self.formula(pitch, Some(Kind::Length));
                Step::new(
                    Motion::Screw(*axis, pitch),
                    self.formula(angle, Some(Kind::Angle)),
                )
            }
        };
        parts.iter().map(step).collect()
    }

    fn scene(&self, file: &File, draft: &Draft) -> Scene {
        let all = |chains: &[Vec<Part>]| chains.iter().map(|parts| self.steps(parts)).collect();
        let distances = draft.distances.iter().map(|(sides, sum)| {
            let sides = sides.each_ref().map(|parts| self.steps(parts));
            (sides, self.formula(sum, Some(Kind::Length)))
        });
        let coordinate = |name: &String| {
            let kind = self.kinds.get(name).copied();
            let is_angle = kind == Some(Kind::Angle);
            let guess = file.guess.iter().find(|(n, _)| n == name);
            let guess = guess.map(|(_, node)| self.formula(node, kind).constant().unwrap().clone());
            Coordinate {
                name: name.clone(),
                unit: if is_angle {
                    self.file_unit.clone()
                } else {
                    Precise::of(1.0)
                },
                is_angle,
                guess: guess.unwrap_or_else(|| Precise::of(0.0)),
            }
        };
        let (unknowns, inputs) = self.coordinates.split_at(self.unknowns);
        Scene {
            unknowns: unknowns.iter().map(coordinate).collect(),
            inputs: inputs.iter().map(coordinate).collect(),
            loops: all(&draft.loops),
            points: all(&draft.points),
            distances: distances.collect(),
            equations: file
                .equations
                .iter()
                .map(|node| self.formula(node, None))
                .collect(),
            shown: Vec::new(),
        }
    }

    /// Traced points and outputs. Their names become slots behind the coordinates.
    fn shown(&mut self, file: &File) -> Vec<Shown> {
        let mut all = Vec::new();
        for (name, frame, point) in &file.traces {
            let steps = is_known(frame, file).then(|| {
                let mut parts = expanded(frame, file);
                parts.extend((0..3).map(|k| Part::Shift(k, point[k].clone())));
                self.steps(&parts)
            });
            for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
                all.push(Shown {
                    name: format!("{name}.{axis}"),
                    unit: Precise::of(1.0),
                    what: steps.clone().map_or(What::Unknown, |s| What::Place(s, k)),
                });
            }
        }
        self.coordinates.extend(all.iter().map(|s| s.name.clone()));
        for (name, node) in &file.outputs {
            let kind = self.kinds.get(name).copied();
            let mut is_known = true;
            node.visit_names(&mut |used| {
                let unknown = all
                    .iter()
                    .any(|s| s.name == used && matches!(s.what, What::Unknown));
                let found = self.coordinates.iter().any(|n| n == used)
                    || self.parameters.contains_key(used);
                is_known &= found && !unknown;
            });
            let formula = is_known.then(|| self.formula(node, kind));
            all.push(Shown {
                name: name.clone(),
                unit: match kind {
                    Some(Kind::Angle) => self.file_unit.clone(),
                    _ => Precise::of(1.0),
                },
                what: formula.map_or(What::Unknown, What::Value),
            });
            self.coordinates.push(name.clone());
        }
        all
    }
}
