//! The layout of the proof of a mechanism's blocks: the rows of the equations, and the unknowns and forms in each.
//!
//! First the rows of the block. Then those that were found empty at random poses without a known reason: they are
//! bounded at every pose, like every row beyond the number of unknowns.

use super::block::{Block, Structure};
use super::proof_chain::LoopPlan;
use crate::model::chain::{Argument, ChainStep, ElementaryMotion};
use crate::model::expression::Affine;
use crate::model::expression::quadratic::QuadraticFormula;
use crate::model::mechanism::{Closes, Mechanism};
use std::ops::Range;

/// The rows of a block's loops.
#[derive(Clone, Debug, Default)]
pub struct ProofRows {
    /// For every loop: its equations (0 to 2 rotation, 3 to 5 translation) and their rows.
    pub loops: Vec<Vec<(usize, usize)>>,
    /// The first row of the block's scalar equations.
    pub first_equation: usize,
    /// Number of all rows.
    pub count: usize,
}

impl ProofRows {
    /// Of a block of the structure.
    pub fn new(structure: &Structure, block: &Block) -> Self {
        let mut rows = Self::default();
        // The components of the loops that the block solves come first, in its own order.
        for part in &block.loops {
            let first = rows.first_equation;
            rows.first_equation += part.components.len();
            rows.loops
                .push(part.components.iter().copied().zip(first..).collect());
        }
        rows.count = block.rows();
        // Behind them the equations that are redundant at all poses: they are proved, not solved.
        for (part, of_loop) in block.loops.iter().zip(&mut rows.loops) {
            let unproved = structure.unproved_equations.iter();
            for (_, component) in unproved.filter(|(l, _)| *l == part.index) {
                of_loop.push((*component, rows.count));
                rows.count += 1;
            }
        }
        rows
    }
}

/// A form that the block uses: an argument, or one that an equation is made of.
#[derive(Clone, Debug)]
pub struct FormUse {
    /// Rate by each unknown of the block in scaled form, as (column, rate).
    pub own: Vec<(usize, f64)>,
    /// Rate by unknowns of earlier blocks, as (place in [`ProofBlock::before`], scaled rate).
    pub before: Vec<(usize, f64)>,
    /// Largest change by the block's unknowns.
    pub own_rate: f64,
    /// Largest change by all unknowns.
    pub rate: f64,
    /// The only rows that depend on it.
    pub rows: Range<usize>,
}

impl FormUse {
    fn reaches(&mut self, rows: Range<usize>) {
        self.rows = match self.rows.is_empty() {
            true => rows,
            false => self.rows.start.min(rows.start)..self.rows.end.max(rows.end),
        };
    }
}

/// An equation of the block.
#[derive(Clone, Debug)]
pub struct EquationRow {
    /// The index of the first of its forms: its affine part, then its factors.
    pub first_form: usize,
    /// Its formula.
    pub formula: QuadraticFormula,
    /// What its value is multiplied by.
    pub scale: f64,
}

impl EquationRow {
    /// The places of its forms.
    pub fn forms(&self) -> Range<usize> {
        self.first_form..self.first_form + 1 + self.formula.factors.len()
    }
}

/// A loop of the block.
#[derive(Clone, Debug)]
pub struct LoopRows {
    /// Its chain.
    pub plan: LoopPlan,
    /// Its equations and their rows, those of the block first.
    pub rows: Vec<(usize, usize)>,
    /// How many of them are the block's.
    of_block: usize,
    /// Whether it closes in a point, so that its rotation is arbitrary.
    pub may_turn: bool,
    /// Unit of its translation.
    pub size: f64,
}

/// A block, laid out for its proof.
#[derive(Clone, Debug, Default)]
pub struct ProofBlock {
    /// Unknowns in the order of the columns.
    pub unknowns: Vec<usize>,
    /// Unknowns of earlier blocks that enter.
    pub before: Vec<usize>,
    /// Arguments of the loops, then what the equations are made of.
    pub forms: Vec<FormUse>,
    /// Index of each argument among those of the mechanism.
    pub arguments: Vec<usize>,
    /// An argument that is not affine is among them, or an equation of more than second degree.
    pub has_formula: bool,
    /// Its loops.
    pub loops: Vec<LoopRows>,
    /// Its scalar equations.
    pub equations: Vec<EquationRow>,
    /// The row of the first of them.
    pub first_equation: usize,
    /// Number of rows.
    pub rows: usize,
}

/// An argument as the loops use it.
#[derive(Clone, Debug, Default)]
pub struct ProofArgument {
    /// Its value; unused for formulas.
    pub form: Affine,
    /// Whether it moves a joint of a loop. Arguments of bodies only are not part of a proof.
    pub is_used: bool,
    /// One of these joints is a rotation.
    pub turns: bool,
}

/// All blocks of a mechanism, laid out for the proof of poses.
#[derive(Clone, Debug)]
pub struct ProofPlan {
    /// All arguments of the mechanism.
    pub arguments: Vec<ProofArgument>,
    /// In the order of their solution.
    pub blocks: Vec<ProofBlock>,
    /// Number of equations beyond the unknowns that cannot be proved: they are only bounded.
    pub redundant_rows: usize,
}

impl ProofPlan {
    /// Lays out the blocks of `structure`.
    pub fn new(mechanism: &Mechanism, structure: &Structure) -> Self {
        let arguments = mechanism.arguments.iter().map(Argument::affine);
        let arguments: Vec<Option<Affine>> = arguments.collect();
        let blocks = structure.blocks.iter();
        let blocks = blocks.map(|block| ProofBlock::new(mechanism, structure, block, &arguments));
        let blocks: Vec<ProofBlock> = blocks.collect();
        // A block with more rows than unknowns proves as many as it has unknowns and bounds the others.
        let beyond = blocks
            .iter()
            .map(|b| b.rows.saturating_sub(b.unknowns.len()));
        let redundant_rows = beyond.sum();
        let mut arguments: Vec<ProofArgument> = arguments
            .into_iter()
            .map(|form| ProofArgument {
                form: form.unwrap_or_default(),
                ..ProofArgument::default()
            })
            .collect();
        for index in blocks.iter().flat_map(|block| &block.arguments) {
            arguments[*index].is_used = true;
        }
        let steps = mechanism.loops.iter().flat_map(|item| &item.chain.steps);
        for joint in steps.filter_map(ChainStep::joint) {
            arguments[joint.argument].turns |= joint.motion == ElementaryMotion::Rotation;
        }
        Self {
            arguments,
            blocks,
            redundant_rows,
        }
    }
}

impl ProofBlock {
    /// Lays out a block.
    fn new(
        mechanism: &Mechanism,
        structure: &Structure,
        block: &Block,
        arguments: &[Option<Affine>],
    ) -> Self {
        let rows = ProofRows::new(structure, block);
        let mut laid_out = Self {
            first_equation: rows.first_equation,
            rows: rows.count,
            unknowns: block.unknowns.clone(),
            arguments: block.arguments.clone(),
            ..Self::default()
        };
        for index in &block.arguments {
            laid_out.has_formula |= arguments[*index].is_none();
            let blank = Affine::default();
            laid_out.add_form(
                mechanism,
                block,
                arguments[*index].as_ref().unwrap_or(&blank),
            );
        }
        // A loop refers to arguments by their place in the block.
        for (part, of_loop) in block.loops.iter().zip(rows.loops) {
            let place = |a: usize| block.arguments.binary_search(&a).unwrap_or(0);
            let steps = &mechanism.loops[part.index].chain.steps;
            laid_out.loops.push(LoopRows {
                plan: LoopPlan::new(steps, place),
                rows: of_loop,
                of_block: part.components.len(),
                may_turn: mechanism.loops[part.index].closes == Closes::Point,
                size: mechanism.loops[part.index].size,
            });
        }
        // An equation of second degree is a sum of products of linear forms, each of which is laid out like an
        // argument.
        for index in &block.equations {
            let formula = mechanism.equations[*index].expression.quadratic();
            laid_out.has_formula |= formula.is_none();
            let formula = formula.unwrap_or_default();
            let first_form = laid_out.forms.len();
            for form in [&formula.rest].into_iter().chain(&formula.factors) {
                laid_out.add_form(mechanism, block, form);
            }
            laid_out.equations.push(EquationRow {
                first_form,
                formula,
                scale: mechanism.equations[*index].weight,
            });
        }
        laid_out.note_rows();
        laid_out
    }

    /// Records which rows of the block depend on each form.
    fn note_rows(&mut self) {
        let mut row = 0;
        for item in &self.loops {
            let end = row + item.of_block;
            for argument in item.plan.arguments() {
                self.forms[argument].reaches(row..end);
            }
            row = end;
        }
        for equation in &self.equations {
            for form in equation.forms() {
                self.forms[form].reaches(row..row + 1);
            }
            row += 1;
        }
    }

    fn add_form(&mut self, mechanism: &Mechanism, block: &Block, form: &Affine) {
        let (mut own, mut before) = (Vec::new(), Vec::new());
        // Own unknowns by column, those of earlier blocks by their place in `before`; inputs have no part in the
        // derivatives.
        for (slot, c) in form.numbers() {
            if let Some(column) = block.columns.of(slot) {
                own.push((column, c * mechanism.scale_of(slot)));
            } else if slot < mechanism.unknowns.len() {
                let known = self.before.iter().position(|s| *s == slot);
                let place = known.unwrap_or_else(|| {
                    self.before.push(slot);
                    self.before.len() - 1
                });
                before.push((place, c * mechanism.scale_of(slot)));
            }
        }
        let sum = |rates: &[(usize, f64)]| rates.iter().map(|(_, c)| c.abs()).sum::<f64>();
        self.forms.push(FormUse {
            own_rate: sum(&own),
            rate: sum(&own) + sum(&before),
            own,
            before,
            rows: 0..0,
        });
    }
}
