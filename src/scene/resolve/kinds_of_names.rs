//! Infers the kind of every name of a scene (length, angle or number) from its uses.

use super::super::file::SceneFile;
use super::super::formula::expansion::Factor;
use super::super::formula::kinds::infer_kind;
use super::super::formula::node::{FormulaNode, NodeKind};
use super::super::formula::products::lengths_in_products;
use super::names::Names;
use super::parsed::{Parsed, ParsedInput};
use super::parsing::parsed_expression;
use super::solid_formulas::SolidFormulas;
use super::words::TIME;
use crate::diag::{Diagnostic, Diagnostics};
use crate::model::chain::ElementaryMotion;
use crate::model::dimension::PhysicalDimension;
use crate::model::mechanism::Kind;

impl Names {
    /// Infers the kind of every name from its uses; a contradiction is an error.
    pub fn infer_kinds(&mut self, parsed: &Parsed, diagnostics: &mut Diagnostics) {
        let mut sites: Vec<(&FormulaNode, Option<Kind>)> = Vec::new();
        // Uses that determine a kind: coordinates of rotations are angles, those of translations lengths.
        for factor in parsed
            .loops
            .iter()
            .flat_map(|(_, f)| f)
            .chain(parsed.contacts.iter().flat_map(|c| c.factors()))
            .chain(parsed.bars.factors())
            .chain(parsed.frames.iter().flatten())
        {
            if let Factor::Elementary(motion, _, node) = factor {
                sites.push((node, Some(kind_of_motion(*motion))));
            }
        }
        // Equations and outputs require no kind of their own, but relate the kinds of their terms.
        sites.extend(
            parsed
                .equations
                .iter()
                .chain(&parsed.outputs)
                .map(|(_, node)| (node, None)),
        );
        // The radii of two spheres appear in no chain.
        let pairs = parsed.contacts.iter().filter(|c| c.is_of_spheres());
        let radii = pairs.flat_map(|c| c.sides.iter().flat_map(|side| side.surface.sizes()));
        sites.extend(radii.map(|(_, node)| (node, Some(Kind::Length))));
        let lengths = parsed.bars.lengths();
        sites.extend(lengths.map(|node| (node, Some(Kind::Length))));
        sites.extend(parsed.points.iter().map(|node| (node, Some(Kind::Length))));
        sites.extend(parsed.solids.iter().map(|node| (node, None)));
        let lengths = sites
            .iter()
            .filter(|(_, wanted)| *wanted == Some(Kind::Length));
        let lengths: Vec<&FormulaNode> = lengths.map(|(node, _)| *node).collect();
        for (node, wanted) in sites {
            self.note(node, wanted, diagnostics);
            self.note_place(node, wanted);
        }
        for node in &parsed.solids {
            self.note_place(node, Some(Kind::Length));
        }
        // Drives, start values and parameters take the kind of their name.
        for (name, input) in &parsed.inputs {
            let wanted = self.kind(&name.value);
            match input {
                ParsedInput::Formula(node) => self.note(node, wanted, diagnostics),
                ParsedInput::Keys(keys) => keys
                    .iter()
                    .for_each(|[_, value]| self.note(value, wanted, diagnostics)),
            }
        }
        for (name, node) in &parsed.guess {
            self.note(node, self.kind(&name.value), diagnostics);
        }
        // A parameter is used only after its definition, so going backwards every use is met before the definition.
        for (name, node) in parsed.parameters.iter().rev() {
            self.note(node, self.kind(&name.value), diagnostics);
            for (k, kind) in [Kind::Length, Kind::Angle].into_iter().enumerate() {
                if self.stands_in[k].contains(&name.value) {
                    self.note_place(node, Some(kind));
                }
            }
        }
        self.infer_products(&lengths, parsed);
        self.store_kinds();
    }

    /// The kinds that products tell: what nothing else is known of, in a product that is a length beside numbers and angles.
    fn infer_products(&mut self, lengths: &[&FormulaNode], parsed: &Parsed) {
        let mut found = Vec::new();
        for node in lengths {
            // The time of a drive is not unknown.
            let of_name = |name: &str| match name == TIME {
                true => Some(PhysicalDimension::TIME),
                false => self.dimension(name),
            };
            lengths_in_products(node, &of_name, &mut |name, span| {
                found.push((name.to_owned(), span.clone()));
            });
        }
        // What also stands in angles is a number, and so may be what is computed: a quotient of lengths.
        found.retain(|(name, _)| {
            let mut definitions = parsed
                .parameters
                .iter()
                .filter(|(own, _)| own.value == *name);
            let is_plain = definitions.all(|(_, node)| is_plain_number(node));
            is_plain && !self.stands_in[1].contains(name)
        });
        for (name, span) in found {
            self.kinds.entry(name).or_insert((Kind::Length, span));
        }
        for (name, node) in parsed.parameters.iter().rev() {
            self.note_unknown(node, self.kind(&name.value));
        }
    }

    /// Notes that the names of a formula appear where a length or an angle is expected.
    fn note_place(&mut self, node: &FormulaNode, wanted: Option<Kind>) {
        let [lengths, angles] = &mut self.stands_in;
        let place = match wanted {
            Some(Kind::Length) => lengths,
            Some(Kind::Angle) => angles,
            _ => return,
        };
        node.visit_names(&mut |name, _| {
            place.insert(name.to_owned());
        });
    }

    /// The kinds of names that no other use has told, from formulas of these kinds.
    pub fn infer_more_kinds(&mut self, nodes: &[(FormulaNode, Kind)], parsed: &Parsed) {
        for (node, kind) in nodes {
            self.note_unknown(node, Some(*kind));
        }
        for (name, node) in parsed.parameters.iter().rev() {
            self.note_unknown(node, self.kind(&name.value));
        }
        self.store_kinds();
    }

    /// Notes the kinds of names that have none.
    fn note_unknown(&mut self, node: &FormulaNode, wanted: Option<Kind>) {
        let kinds = &mut self.kinds;
        infer_kind(node, wanted, &mut |name, kind, span| {
            if name != TIME {
                let known = kinds.entry(name.to_owned());
                known.or_insert_with(|| (kind, span.clone()));
            }
        });
    }

    fn note(&mut self, node: &FormulaNode, wanted: Option<Kind>, diagnostics: &mut Diagnostics) {
        let kinds = &mut self.kinds;
        infer_kind(
            node,
            wanted,
            &mut |name, kind, span| match kinds.get(name) {
                // The time of a drive is a number of seconds in every position.
                _ if name == TIME => {}
                None => {
                    kinds.insert(name.to_owned(), (kind, span.clone()));
                }
                Some((known, _)) if *known == kind => {}
                Some((known, first)) => diagnostics.push(
                    Diagnostic::error(format!(
                        "`{name}` is used both as {} {} and as {} {}",
                        kind_article(*known),
                        known.word(),
                        kind_article(kind),
                        kind.word()
                    ))
                    .at(span.clone())
                    .label(format!("here as {} {}", kind_article(kind), kind.word()))
                    .with_related(
                        first.clone(),
                        format!("here as {} {}", kind_article(*known), known.word()),
                    ),
                ),
            },
        );
    }

    fn store_kinds(&mut self) {
        let kinds = &self.kinds;
        let kind = |name: &str| kinds.get(name).map(|(kind, _)| *kind);
        for parameter in &mut self.parameters {
            parameter.kind = kind(&parameter.name);
        }
        for coordinate in self.inputs.iter_mut().chain(&mut self.unknowns) {
            coordinate.kind = kind(&coordinate.name).unwrap_or(Kind::Number);
        }
    }
}

/// Whether a definition is a number alone.
fn is_plain_number(node: &FormulaNode) -> bool {
    match &node.kind {
        NodeKind::Number(_) => true,
        NodeKind::Negate(inner) => is_plain_number(inner),
        _ => false,
    }
}

/// The formulas of solids whose kind is known: those of their points and sizes, and the motions of their frames.
pub fn dimensions_of_solids(file: &SceneFile, parsed: &Parsed) -> Vec<(FormulaNode, Kind)> {
    let shapes = file.bodies.iter().flat_map(|body| &body.shapes);
    let mut nodes = Vec::new();
    // Errors in them are reported where the solids are resolved.
    let silent = &mut Diagnostics::default();
    for shape in shapes {
        let typed = SolidFormulas::new(&shape.solid);
        let texts = typed.points.iter().flat_map(|point| point.iter());
        let lengths = texts
            .chain(typed.sizes.iter().copied())
            .filter_map(|text| parsed_expression(text, silent));
        nodes.extend(lengths.map(|node| (node, Kind::Length)));
        let frame = shape.frame.as_ref();
        let factors = frame.and_then(|text| parsed.factors(text, silent));
        nodes.extend(
            factors
                .into_iter()
                .flatten()
                .filter_map(|factor| match factor {
                    Factor::Elementary(motion, _, node) => Some((node, kind_of_motion(motion))),
                    Factor::Direction(..) => None,
                }),
        );
    }
    nodes
}

/// The kind of a joint's argument.
pub fn kind_of_motion(motion: ElementaryMotion) -> Kind {
    match motion {
        ElementaryMotion::Translation => Kind::Length,
        ElementaryMotion::Rotation => Kind::Angle,
    }
}

fn kind_article(kind: Kind) -> &'static str {
    if kind == Kind::Angle { "an" } else { "a" }
}
