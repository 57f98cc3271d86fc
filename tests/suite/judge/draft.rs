//! A scene's chains expanded to their parts, with names; what the names measure follows from where they stand.

use super::chain::{self, Part};
use super::contact::{self, Closure};
use super::file::File;
use super::formula::Node;
use super::units::{Kind, Kinds, note};

/// Chains written out.
pub fn expanded(items: &[chain::Item], file: &File) -> Vec<Part> {
    let mut parts = Vec::new();
    chain::expand(items, &file.chains, false, &mut parts);
    parts
}

/// Everything that closes, with names.
#[derive(Default)]
pub struct Draft {
    pub loops: Vec<Vec<Part>>,
    pub points: Vec<Vec<Part>>,
    pub distances: Vec<([Vec<Part>; 2], Node)>,
}

impl Draft {
    pub fn new(file: &File) -> Self {
        let mut draft = Self {
            loops: file
                .loops
                .iter()
                .map(|items| expanded(items, file))
                .collect(),
            ..Self::default()
        };
        for (ends, length) in &file.bars {
            let ends = ends.each_ref().map(|items| expanded(items, file));
            draft.distances.push((ends, length.clone()));
        }
        for (name, sides) in &file.contacts {
            match contact::closure(name, sides) {
                Closure::Frame(items) => draft.loops.push(expanded(&items, file)),
                Closure::Point(items) => draft.points.push(expanded(&items, file)),
                Closure::Distance(sides, sum) => {
                    let sides = sides.map(|items| expanded(&items, file));
                    draft.distances.push((sides, sum));
                }
            }
        }
        draft
    }

    pub fn parts(&self) -> impl Iterator<Item = &Part> {
        let distances = self
            .distances
            .iter()
            .flat_map(|(sides, _)| sides.iter().flatten());
        self.loops
            .iter()
            .chain(&self.points)
            .flatten()
            .chain(distances)
    }

    /// What every name measures, from where it stands.
    pub fn kinds(&self, file: &File) -> Kinds {
        let mut kinds = Kinds::new();
        let frames: Vec<Part> = file
            .frames
            .iter()
            .filter(|items| is_known(items, file))
            .flat_map(|items| expanded(items, file))
            .collect();
        for part in self.parts().chain(&frames) {
            let (node, kind) = match part {
                Part::Shift(_, node) => (node, Kind::Length),
                Part::Turn(_, node) | Part::About(_, node) | Part::Screw(_, _, node) => {
                    (node, Kind::Angle)
                }
            };
            note(node, Some(kind), &mut kinds);
        }
        file.equations
            .iter()
            .chain(file.outputs.iter().map(|(_, node)| node))
            .for_each(|node| note(node, None, &mut kinds));
        let sums = self.distances.iter().map(|(_, sum)| sum);
        sums.for_each(|node| note(node, Some(Kind::Length), &mut kinds));
        let drives = file
            .inputs
            .iter()
            .flat_map(|(name, nodes)| nodes.iter().map(move |n| (name, n)));
        let guesses = file.guess.iter().map(|(name, node)| (name, node));
        // A parameter is used below its definition: upwards every use comes before the definition.
        let parameters = file
            .parameters
            .iter()
            .rev()
            .map(|(name, node)| (name, node));
        for (name, node) in drives.chain(guesses).chain(parameters) {
            let kind = kinds.get(name).copied();
            note(node, kind, &mut kinds);
        }
        kinds
    }
}

/// Whether all names in a body's frame are chains (a contact's frame bears the contact's name).
pub fn is_known(items: &[chain::Item], file: &File) -> bool {
    items.iter().all(|item| match item {
        chain::Item::Part(_) => true,
        chain::Item::Inverse(inner) => is_known(inner, file),
        chain::Item::Name(name) => file
            .chains
            .get(name)
            .is_some_and(|inner| is_known(inner, file)),
    })
}
