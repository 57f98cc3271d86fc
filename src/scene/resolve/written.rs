//! The chains of a scene as written, for drawings and matrices.

use super::super::file::SceneFile;
use super::super::formula::compile::constant_node;
use super::super::formula::expansion::Factor;
use super::super::formula::node::{FormulaNode, NodeKind};
use super::super::formula::written::written_formula;
use super::contacts::chains::{ContactClosure, ContactSide};
use super::joints::FoldedJoints;
use super::names::Names;
use super::parsed::Parsed;
use super::parsing::parsed_expression;
use crate::diag::Diagnostics;
use crate::model::chain::{Argument, ChainStep, ElementaryMotion};
use crate::model::mechanism::{Closes, Mechanism};
use crate::model::notation::{
    Notation, WrittenChain, WrittenContact, WrittenFactor, WrittenLength, WrittenSurface,
    WrittenTerm,
};
use std::collections::HashMap;

/// Everything in a scene that is written as a chain; errors were reported when the mechanism was resolved.
pub fn resolve_notation(
    file: &SceneFile,
    parsed: &Parsed,
    names: &Names,
    mechanism: &Mechanism,
) -> Notation {
    let mut writer = ChainWriter {
        joints: FoldedJoints::new(names),
        names,
        terms: TermList::default(),
    };
    // Loops: those of the file, the closing chains of contacts, and the pins of bars.
    let closing = closing_chains(parsed);
    let texts = file.loops.iter();
    let texts = named(texts.map(|(name, text)| (name.value.as_str(), text)));
    let loops = mechanism.loops.iter().map(|item| {
        let factors = closing.get(item.name.as_str()).copied().unwrap_or(&[]);
        let mut chain = writer.written_chain(&item.name, factors);
        let text = texts.get(item.name.as_str());
        chain.text = text.map_or_else(String::new, |text| text.text.clone());
        writer.place_loop(&mut chain, factors, item.closes);
        chain
    });
    let loops = loops.collect();
    // Bodies: their frames, with factors related to the steps of the mechanism's chains.
    let places = file.bodies.iter().zip(0..file.bodies.len());
    let places = named(places.map(|(body, place)| (body.name.value.as_str(), place)));
    let bodies = mechanism.bodies.iter().map(|body| {
        let own = places.get(body.name.as_str()).copied();
        let factors = own.map_or(&[][..], |k| parsed.frames[k].as_slice());
        let mut chain = writer.written_chain(&body.name, factors);
        let frame = own.and_then(|k| file.bodies[k].frame.as_ref());
        chain.text = frame.map_or_else(String::new, |frame| frame.text.clone());
        let kept = FoldedJoints::kept(factors);
        place_steps(&mut chain, &kept);
        chain
    });
    let bodies = bodies.collect();
    // Named chains, as they are; their errors have been reported.
    let chains = file.chains.iter().filter_map(|(name, text)| {
        let factors = parsed.factors(text, &mut Diagnostics::default())?;
        let mut chain = writer.written_chain(&name.value, &factors);
        chain.text.clone_from(&text.text);
        Some(chain)
    });
    let chains = chains.collect();
    // Traced points: translations along the axes of the body's frame.
    let traces = named(file.traces.iter().map(|t| (t.name.value.as_str(), t)));
    let points = mechanism.traces.iter().map(|trace| {
        let own = traces.get(trace.name.as_str());
        let texts = own.and_then(|t| t.point.as_ref());
        let nodes = texts
            .into_iter()
            .flatten()
            .map(|text| parsed_expression(text, &mut Diagnostics::default()));
        let factors: Vec<Factor> = nodes
            .enumerate()
            .filter_map(|(axis, node)| {
                Some(Factor::Elementary(
                    ElementaryMotion::Translation,
                    axis,
                    node?,
                ))
            })
            .collect();
        writer.written_chain(&trace.name, &factors)
    });
    let points = points.collect();
    // Contacts: a chain for each surface.
    let contacts = parsed.contacts.iter().map(|contact| WrittenContact {
        name: contact.name.value.clone(),
        sides: contact.sides.each_ref().map(|side| writer.surface(side)),
    });
    let bars = parsed.bars.list.iter();
    let bar_lengths = bars.map(|bar| WrittenLength {
        text: written_formula(&bar.length),
        has_name: formula_has_name(&bar.length),
    });
    Notation {
        contacts: contacts.collect(),
        bar_lengths: bar_lengths.collect(),
        loops,
        bodies,
        chains,
        points,
        arguments: writer.joints.arguments,
        terms: writer.terms.0,
    }
}

/// What each name means; the first of equal names counts.
fn named<'n, T>(list: impl DoubleEndedIterator<Item = (&'n str, T)>) -> HashMap<&'n str, T> {
    list.rev().collect()
}

/// The factors of every loop by its name: loops of the file come before contacts, contacts before pins.
fn closing_chains(parsed: &Parsed) -> HashMap<&str, &[Factor]> {
    let loops = parsed.loops.iter();
    let loops = loops.map(|(name, factors)| (name.value.as_str(), factors.as_slice()));
    let contacts = parsed.contacts.iter().filter_map(|c| match &c.closure {
        ContactClosure::Frame(factors) | ContactClosure::Point(factors) => {
            Some((c.name.value.as_str(), factors.as_slice()))
        }
        _ => None,
    });
    let pins = parsed.bars.pins.iter();
    let pins = pins.map(|pin| (pin.name.as_str(), &pin.closing[..]));
    named(loops.chain(contacts).chain(pins))
}

/// Writes chains factor by factor.
struct ChainWriter<'a> {
    joints: FoldedJoints<'a>,
    names: &'a Names,
    terms: TermList,
}

/// The terms of all sums, without repetition.
#[derive(Default)]
struct TermList(Vec<Argument>);

impl TermList {
    /// The terms of an argument.
    fn of(
        &mut self,
        joints: &FoldedJoints,
        motion: ElementaryMotion,
        node: &FormulaNode,
    ) -> Vec<WrittenTerm> {
        let mut parts = Vec::new();
        signed_parts(node, false, &mut parts);
        let written = parts.into_iter().filter_map(|(part, is_negative)| {
            let argument = joints.argument(motion, part).ok()?;
            let known = self.0.iter().position(|known| *known == argument);
            Some(WrittenTerm {
                text: written_formula(part),
                is_negative,
                argument: known.unwrap_or_else(|| {
                    self.0.push(argument);
                    self.0.len() - 1
                }),
            })
        });
        written.collect()
    }
}

/// The terms of a sum, and whether each is subtracted.
fn signed_parts<'n>(
    node: &'n FormulaNode,
    is_negative: bool,
    parts: &mut Vec<(&'n FormulaNode, bool)>,
) {
    match &node.kind {
        NodeKind::Negate(inner) => signed_parts(inner, !is_negative, parts),
        NodeKind::Binary(sign @ ('+' | '-'), a, b) => {
            signed_parts(a, is_negative, parts);
            signed_parts(b, is_negative != (*sign == '-'), parts);
        }
        _ => parts.push((node, is_negative)),
    }
}

impl ChainWriter<'_> {
    fn written_chain(&mut self, name: &str, factors: &[Factor]) -> WrittenChain {
        // Errors have been reported where the chain was resolved; after one there is nothing to write.
        let steps = self.joints.steps(factors, &mut Diagnostics::default());
        let steps = steps.unwrap_or_default();
        let written = factors
            .iter()
            .zip(steps)
            .map(|(factor, step)| WrittenFactor {
                motion: match factor {
                    Factor::Elementary(motion, axis, _) => Some((*motion, *axis)),
                    Factor::Direction(..) => None,
                },
                text: factor_text(factor),
                step,
                // The terms of its sum, which may have arguments of their own.
                terms: match factor {
                    Factor::Elementary(motion, _, node) => {
                        self.terms.of(&self.joints, *motion, node)
                    }
                    Factor::Direction(..) => Vec::new(),
                },
                // A named constant is a dimension of the mechanism.
                is_dimension: step.joint().is_none() && has_name(factor),
                place: None,
            });
        WrittenChain {
            name: name.to_owned(),
            factors: written.collect(),
            ..WrittenChain::default()
        }
    }

    /// The steps of the mechanism's loop that each factor became.
    fn place_loop(&self, chain: &mut WrittenChain, factors: &[Factor], closes: Closes) {
        let steps: Vec<ChainStep> = chain.factors.iter().map(|f| f.step).collect();
        if steps.len() != factors.len() {
            return;
        }
        let [base, core] = FoldedJoints::parted(factors, &steps, closes);
        chain.before = base.last().map_or(0, |last| last + 1);
        place_steps(chain, &core);
    }

    fn surface(&mut self, side: &ContactSide) -> WrittenSurface {
        let sizes = side.surface.sizes().into_iter().map(|(_, node)| {
            let value = constant_node(node, &|n, s| self.names.constant(n, s));
            (written_formula(node), value.unwrap_or(0.0))
        });
        WrittenSurface {
            word: side.surface.word(),
            sizes: sizes.collect(),
            frame: self.written_chain("", &side.frame),
        }
    }
}

fn factor_text(factor: &Factor) -> String {
    match factor {
        Factor::Elementary(_, _, node) => written_formula(node),
        Factor::Direction(nodes, back) => {
            let nodes: Vec<String> = nodes.iter().map(written_formula).collect();
            let sign = if *back { "-" } else { "" };
            format!("{sign}{}", nodes.join(", "))
        }
    }
}

fn has_name(factor: &Factor) -> bool {
    match factor {
        Factor::Elementary(_, _, node) => formula_has_name(node),
        Factor::Direction(..) => false,
    }
}

fn formula_has_name(node: &FormulaNode) -> bool {
    let mut found = false;
    node.visit_names(&mut |_, _| found = true);
    found
}

/// Numbers the moving factors of `kept` by their steps after adjacent constants are merged.
fn place_steps(chain: &mut WrittenChain, kept: &[usize]) {
    let (mut next, mut was_fixed) = (0, false);
    for k in kept {
        let Some(factor) = chain.factors.get_mut(*k) else {
            return;
        };
        let is_fixed = factor.step.joint().is_none();
        if is_fixed && was_fixed {
            continue;
        }
        factor.place = (!is_fixed).then_some(next);
        next += 1;
        was_fixed = is_fixed;
    }
}
