//! All formulas and chains of a file, parsed. No names are looked up here.

use super::super::file::{InputFile, SceneFile};
use super::super::formula::chain::{Item, parse_chain};
use super::super::formula::expansion::Factor;
use super::super::formula::node::FormulaNode;
use super::super::measures::MeasureSourceFile;
use super::bars::parsed::ParsedBars;
use super::contacts::chains::{ContactItems, ParsedContact};
use super::parsing::{Named, NamedChains, note_diagnostic, parsed_expression};
use super::solid_formulas::formulas_of_solids;
use crate::diag::Diagnostics;
use crate::scene::loaded::KeptIn;
use crate::scene::reader::Spanned;
use crate::scene::values::FormulaText;

/// The parsed formulas of a file.
pub struct Parsed {
    /// Definitions of the file that the command line replaces.
    pub replaced: Vec<(String, FormulaNode)>,
    /// Formulas of points, sizes and directions of solids.
    pub solids: Vec<FormulaNode>,
    pub parameters: Vec<Named<FormulaNode>>,
    pub inputs: Vec<Named<ParsedInput>>,
    pub loops: Vec<Named<Vec<Factor>>>,
    pub equations: Vec<Named<FormulaNode>>,
    pub guess: Vec<Named<FormulaNode>>,
    pub outputs: Vec<Named<FormulaNode>>,
    pub bars: ParsedBars,
    /// Surface contacts.
    pub contacts: Vec<ParsedContact>,
    /// One per body of the file; empty for a body that is fixed to the world.
    pub frames: Vec<Vec<Factor>>,
    /// Coordinates of the traced points.
    pub points: Vec<FormulaNode>,
    /// Formulas whose values are those of the file, whatever is varied.
    pub fixed: Vec<(KeptIn, FormulaNode)>,
    /// Named chains, for placing shapes.
    pub chains: NamedChains,
    /// Every loop and equation could be read; only then are the unknowns known.
    pub is_complete: bool,
}

/// The drive of an input.
pub enum ParsedInput {
    Formula(FormulaNode),
    Keys(Vec<[FormulaNode; 2]>),
}

impl Parsed {
    /// Parses everything; invalid parts are reported and skipped.
    pub fn new(file: &SceneFile, diagnostics: &mut Diagnostics) -> Self {
        // Chains first: everything else may refer to them. An unreadable one keeps its name.
        let mut chains: Vec<Named<Vec<Item>>> = file
            .chains
            .iter()
            .map(|(name, text)| {
                let items = note_diagnostic(parse_chain, text, diagnostics);
                (name.clone(), items.unwrap_or_else(|| vec![Item::Broken]))
            })
            .collect();
        let contacts: Vec<ContactItems> = file
            .contacts
            .iter()
            .filter_map(|contact| ContactItems::parse(contact, diagnostics))
            .collect();
        // The frame of a contact is a chain that others may use.
        for contact in &contacts {
            chains.extend(contact.frame().map(|items| (contact.name.clone(), items)));
        }
        let chains = NamedChains::new(chains);
        let contacts: Vec<ParsedContact> = contacts
            .into_iter()
            .filter_map(|contact| contact.expand(&chains, diagnostics))
            .collect();
        // Loops and frames with all references expanded.
        let loops: Vec<Named<Vec<Factor>>> = file
            .loops
            .iter()
            .filter_map(|(name, text)| {
                Some((name.clone(), expanded_chains(text, &chains, diagnostics)?))
            })
            .collect();
        let frames = file
            .bodies
            .iter()
            .map(|body| {
                body.frame
                    .as_ref()
                    .and_then(|text| expanded_chains(text, &chains, diagnostics))
                    .unwrap_or_default()
            })
            .collect();
        // Sections that map names to formulas.
        let mut named = |list: &[(Spanned<String>, FormulaText)]| -> Vec<Named<FormulaNode>> {
            list.iter()
                .filter_map(|(name, text)| {
                    Some((name.clone(), parsed_expression(text, diagnostics)?))
                })
                .collect()
        };
        let (parameters, equations) = (named(&file.parameters), named(&file.equations));
        let (guess, outputs) = (named(&file.guess), named(&file.outputs));
        let bars = ParsedBars::parse(file, &chains, diagnostics);
        // Only if every loop and equation was read is an undefined name certainly an error.
        let is_complete = loops.len() == file.loops.len()
            && equations.len() == file.equations.len()
            && bars.list.len() == file.bars.len()
            && contacts.len() == file.contacts.len();
        let inputs = file
            .inputs
            .iter()
            .filter_map(|(name, input)| Some((name.clone(), parse_input(input, diagnostics)?)))
            .collect();
        // Chains that nothing refers to have not been checked yet.
        chains.judge_all(diagnostics);
        let points = file.traces.iter().flat_map(|trace| trace.point.iter());
        let replaced = file.replaced.iter();
        let replaced = replaced.filter_map(|(name, text)| {
            let node = parsed_expression(text, &mut Diagnostics::default())?;
            Some((name.clone(), node))
        });
        Self {
            replaced: replaced.collect(),
            solids: formulas_of_solids(file),
            points: unreported_nodes(points.flatten()),
            fixed: fixed_formulas(file),
            parameters,
            inputs,
            loops,
            equations,
            bars,
            contacts,
            guess,
            outputs,
            frames,
            chains,
            is_complete,
        }
    }

    /// Parses and expands a chain outside the `[chains]` section.
    pub fn factors(
        &self,
        text: &FormulaText,
        diagnostics: &mut Diagnostics,
    ) -> Option<Vec<Factor>> {
        expanded_chains(text, &self.chains, diagnostics)
    }
}

/// Formulas whose errors are reported where they are resolved.
fn unreported_nodes<'t>(texts: impl Iterator<Item = &'t FormulaText>) -> Vec<FormulaNode> {
    let mut silent = Diagnostics::default();
    texts
        .filter_map(|text| parsed_expression(text, &mut silent))
        .collect()
}

fn parse_input(input: &InputFile, diagnostics: &mut Diagnostics) -> Option<ParsedInput> {
    match input {
        InputFile::Unread => None,
        InputFile::Formula(text) => {
            Some(ParsedInput::Formula(parsed_expression(text, diagnostics)?))
        }
        InputFile::Keys { keys, .. } => {
            let mut nodes = Vec::with_capacity(keys.value.len());
            for [time, value] in &keys.value {
                nodes.push([
                    parsed_expression(time, diagnostics)?,
                    parsed_expression(value, diagnostics)?,
                ]);
            }
            Some(ParsedInput::Keys(nodes))
        }
    }
}

fn expanded_chains(
    text: &FormulaText,
    chains: &NamedChains,
    diagnostics: &mut Diagnostics,
) -> Option<Vec<Factor>> {
    let items = note_diagnostic(parse_chain, text, diagnostics)?;
    chains.expand(&items, diagnostics)
}

/// Tracks, limits, powers of norms, the duration, clearances, and the ranges of variables.
fn fixed_formulas(file: &SceneFile) -> Vec<(KeptIn, FormulaNode)> {
    let ends = file.tracks.iter().flat_map(|track| &track.inputs);
    let ends = ends.flat_map(|(_, ends)| ends);
    let tracks = ends.chain(
        file.tracks
            .iter()
            .filter_map(|track| track.samples.as_ref()),
    );
    let limits = file.measures.iter().flat_map(|measure| &measure.limits);
    let of_study = file.study.iter().flat_map(|study| &study.limits);
    let limits = limits
        .chain(of_study.flat_map(|(_, limits)| limits))
        .flatten();
    let powers = file
        .measures
        .iter()
        .filter_map(|measure| match &measure.source {
            Some(MeasureSourceFile::Over { power, .. }) => power.as_ref(),
            _ => None,
        });
    let mut list = Vec::new();
    let mut add = |place: KeptIn, texts: Vec<FormulaNode>| {
        list.extend(texts.into_iter().map(|node| (place, node)));
    };
    add(KeptIn::Track, unreported_nodes(tracks));
    add(KeptIn::Limit, unreported_nodes(limits));
    add(KeptIn::Power, unreported_nodes(powers));
    add(KeptIn::Duration, unreported_nodes(file.duration.iter()));
    let clearance = file.clearance.iter();
    let minima = clearance.flat_map(|rules| {
        let pairs = rules.pairs.iter().map(|(_, minimum)| minimum);
        let depths = rules
            .ignored
            .iter()
            .filter_map(|pair| pair.down_to.as_ref());
        rules.minimum.iter().chain(pairs).chain(depths)
    });
    add(KeptIn::Clearance, unreported_nodes(minima));
    let variables = file.study.iter().flat_map(|study| &study.variables);
    let ranges = variables.flat_map(|(_, variable)| {
        let ends = variable.range.iter().flatten();
        ends.chain(&variable.tolerance)
    });
    add(KeptIn::Range, unreported_nodes(ranges));
    list
}
