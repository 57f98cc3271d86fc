//! Translates chains of factors into chains of steps: constants are folded to poses, equal arguments are shared.

use super::super::formula::compile::{compile_formula, exact_constant};
use super::super::formula::expansion::Factor;
use super::super::formula::kinds::own_kind;
use super::super::formula::node::{FormulaNode, NodeKind};
use super::kinds_of_names::kind_of_motion;
use super::names::Names;
use super::parsed::Parsed;
use super::parsing::Named;
use super::range::within_range;
use crate::diag::{Diagnostic, Diagnostics, Span};
use crate::math::Pose;
use crate::model::chain::{Argument, ArgumentValue, Chain, ChainStep, ElementaryMotion};
use crate::model::expression::{Affine, Expression, Function};
use crate::model::fixed::FixedPose;
use crate::model::mechanism::{Closes, Equation, Kind, Loop};
use crate::numbers::constant::Constant;
use glam::DVec3;
use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

/// Most motions of a chain that are not fixed: each is followed by a link whose placement is the chain of all motions
/// before it, so that time and memory grow with the square of their number.
const MOST_MOTIONS: usize = 1000;

/// Compiles chains and keeps the list of their arguments.
pub struct FoldedJoints<'a> {
    pub(super) names: &'a Names,
    /// Every different argument once.
    pub arguments: Vec<Argument>,
    /// Those with the same hash, by number.
    alike: HashMap<u64, Vec<usize>>,
}

impl<'a> FoldedJoints<'a> {
    /// Starts without arguments.
    pub fn new(names: &'a Names) -> Self {
        Self {
            names,
            arguments: Vec::new(),
            alike: HashMap::new(),
        }
    }

    /// The loops of the file.
    pub fn loops(&mut self, parsed: &Parsed, diagnostics: &mut Diagnostics) -> Vec<Loop> {
        let mut resolve = |(name, factors): &Named<Vec<Factor>>| {
            self.closing(&name.value, factors, Closes::Frame, diagnostics)
        };
        parsed.loops.iter().filter_map(&mut resolve).collect()
    }

    /// The loop of that name. Since P X P⁻¹ = E is equivalent to X = E, factors at the beginning that are undone at the
    /// end can be removed. Only a moving P is worth changing the frame of the loop.
    pub fn closing(
        &mut self,
        name: &str,
        factors: &[Factor],
        closes: Closes,
        diagnostics: &mut Diagnostics,
    ) -> Option<Loop> {
        let steps = self.steps(factors, diagnostics)?;
        let [base, core] = Self::parted(factors, &steps, closes);
        Some(Loop {
            name: name.to_owned(),
            base: folded_chain(base.into_iter().map(|k| steps[k])),
            chain: folded_chain(core.into_iter().map(|k| steps[k])),
            closes,
            size: 1.0,
        })
    }

    /// The factors, one step each, of the conjugation and of the loop itself.
    pub fn parted(factors: &[Factor], steps: &[ChainStep], closes: Closes) -> [Vec<usize>; 2] {
        let kept = without_pairs(factors);
        let around = match closes {
            Closes::Frame => kept_around(factors, &kept),
            // For a loop that closes in a point, P X P⁻¹ moves another point than X does.
            Closes::Point => 0,
        };
        let (base, rest) = kept.split_at(around);
        let moves = base.iter().any(|k| steps[*k].joint().is_some());
        match moves {
            true => [base.to_vec(), rest[..rest.len() - around].to_vec()],
            false => [Vec::new(), kept],
        }
    }

    /// The factors of a chain that remain when adjacent inverse factors are cancelled.
    pub fn kept(factors: &[Factor]) -> Vec<usize> {
        without_pairs(factors)
    }

    /// The scalar equations of the file.
    pub fn equations(&self, parsed: &Parsed, diagnostics: &mut Diagnostics) -> Vec<Equation> {
        let mut equations = Vec::new();
        for (name, node) in &parsed.equations {
            let wanted = own_kind(node, &|name| self.names.dimension(name));
            let node = self.names.in_radians(node.clone(), wanted);
            match compile_formula(&node, &|n, s| self.names.coordinate(n, s)) {
                Ok(expression) => equations.push(Equation {
                    name: name.value.clone(),
                    expression,
                    length_exponent: self.length_exponent(&node),
                    weight: 1.0,
                }),
                Err(diagnostic) => diagnostics.push(diagnostic),
            }
        }
        equations
    }

    /// The dimension of a formula as a power of length, if the kinds of its names are known.
    fn length_exponent(&self, node: &FormulaNode) -> f64 {
        match &node.kind {
            NodeKind::Number(_) | NodeKind::Radians(_) | NodeKind::Derivative(_) => 0.0,
            NodeKind::Name(name) => f64::from(self.names.kind(name) == Some(Kind::Length)),
            NodeKind::Of(kind, _) => f64::from(*kind == Some(Kind::Length)),
            NodeKind::Negate(inner) => self.length_exponent(inner),
            // Products and quotients add exponents; terms of a sum should agree, so the largest is taken.
            NodeKind::Binary(sign, a, b) => {
                let (x, y) = (self.length_exponent(a), self.length_exponent(b));
                match (sign, &b.kind) {
                    ('*', _) => x + y,
                    ('/', _) => x - y,
                    ('^', NodeKind::Number(power)) => x * power.number(),
                    _ => x.max(y),
                }
            }
            NodeKind::Call(function, args) => {
                let largest = args
                    .iter()
                    .map(|a| self.length_exponent(a))
                    .fold(f64::NEG_INFINITY, f64::max);
                match function {
                    Function::Abs
                    | Function::Min
                    | Function::Max
                    | Function::Hypot
                    | Function::Mod => largest,
                    Function::Sqrt => 0.5 * largest,
                    _ => 0.0,
                }
            }
        }
    }

    /// Compiles one chain; `None` after an error, which has been reported.
    pub fn chain(&mut self, factors: &[Factor], diagnostics: &mut Diagnostics) -> Option<Chain> {
        let steps = self.steps(factors, diagnostics)?;
        let kept = without_pairs(factors).into_iter();
        Some(folded_chain(kept.map(|k| steps[k])))
    }

    /// A step for every factor.
    pub fn steps(
        &mut self,
        factors: &[Factor],
        diagnostics: &mut Diagnostics,
    ) -> Option<Vec<ChainStep>> {
        let mut steps: Vec<ChainStep> = Vec::new();
        // All factors are read, so that all errors are reported.
        for factor in factors {
            match self.step(factor) {
                Ok(step) => steps.push(step),
                Err(diagnostic) => diagnostics.push(diagnostic),
            }
        }
        // Time and memory grow with the square of the moving factors.
        let is_sound = steps.len() == factors.len();
        let moving = steps.iter().filter(|step| step.joint().is_some()).count();
        if moving > MOST_MOTIONS {
            diagnostics.push(
                Diagnostic::error(format!(
                    "a chain has {moving} motions that are not fixed, at most {MOST_MOTIONS} are analysed"
                ))
                .at(factors[0].place()),
            );
            return None;
        }
        is_sound.then_some(steps)
    }

    /// A chain that may contain only parameters, as a pose.
    pub fn constant_pose(
        &mut self,
        factors: &[Factor],
        place: &Span,
        diagnostics: &mut Diagnostics,
    ) -> Option<Pose> {
        let before = self.arguments.len();
        let chain = self.chain(factors, diagnostics)?;
        // Shapes keep the file's values of the variables of a study.
        let resting = self.names.resting_coordinates();
        let rests = |a: &usize| {
            let mut slots = self.arguments[*a].coordinates().into_iter();
            slots.all(|slot| self.names.rests(slot))
        };
        let moving = !chain.arguments().iter().all(rests);
        let mut scratch = Vec::new();
        let values = self.arguments.iter();
        let values: Vec<ArgumentValue> = values
            .map(|a| ArgumentValue::new(a.value(&resting, &mut scratch)))
            .collect();
        self.arguments.truncate(before);
        if moving {
            diagnostics.push(
                Diagnostic::error("a shape's frame must be constant")
                    .at(place.clone())
                    .hint("put the motion into the body's frame"),
            );
            return None;
        }
        Some(chain.pose(&values))
    }

    fn step(&mut self, factor: &Factor) -> Result<ChainStep, Diagnostic> {
        match factor {
            Factor::Direction(nodes, back) => self.direction(nodes, *back).map(ChainStep::Fixed),
            Factor::Elementary(motion, axis, node) => self.elementary_factor(*motion, *axis, node),
        }
    }

    fn direction(&self, nodes: &[FormulaNode; 3], back: bool) -> Result<FixedPose, Diagnostic> {
        let mut direction = [Constant::default(); 3];
        for (k, node) in nodes.iter().enumerate() {
            let node = self.names.in_radians(node.clone(), Some(Kind::Number));
            direction[k] = exact_constant(&node, &|n, s| self.names.constant(n, s))?;
        }
        if DVec3::from(direction.map(Constant::number))
            .try_normalize()
            .is_none()
        {
            let span = nodes[0].span.start..nodes[2].span.end;
            return Err(Diagnostic::error("the axis of a rotation has no direction").at(span));
        }
        let pose = FixedPose::z_axis(direction);
        Ok(if back { pose.inverse() } else { pose })
    }

    /// The argument of a motion, without adding it to the list.
    pub fn argument(
        &self,
        motion: ElementaryMotion,
        node: &FormulaNode,
    ) -> Result<Argument, Diagnostic> {
        let expression = self.expression(motion, node)?;
        let affine = expression.affine().map(Argument::Affine);
        Ok(affine.unwrap_or(Argument::Formula(expression)))
    }

    fn expression(
        &self,
        motion: ElementaryMotion,
        node: &FormulaNode,
    ) -> Result<Expression, Diagnostic> {
        let wanted = Some(kind_of_motion(motion));
        let converted = self.names.in_radians(node.clone(), wanted);
        compile_formula(&converted, &|n, s| self.names.coordinate(n, s))
    }

    fn elementary_factor(
        &mut self,
        motion: ElementaryMotion,
        axis: usize,
        node: &FormulaNode,
    ) -> Result<ChainStep, Diagnostic> {
        let expression = self.expression(motion, node)?;
        match expression.affine() {
            // Without any coordinate it is a constant pose.
            Some(affine) if affine.terms.is_empty() => {
                let value = affine.constant;
                within_range(value.number(), &node.span)?;
                Ok(ChainStep::Fixed(match motion {
                    ElementaryMotion::Translation => FixedPose::translation(axis, value),
                    ElementaryMotion::Rotation => FixedPose::rotation(axis, value),
                }))
            }
            // Affine arguments may share sine and cosine with their inverse.
            Some(affine) => Ok(self.joint(motion, axis, affine)),
            // Any other formula is an argument as it is.
            None => {
                let argument = self.shared_argument(Argument::Formula(expression));
                Ok(ChainStep::Joint {
                    motion,
                    axis,
                    argument,
                    sign: 1.0,
                })
            }
        }
    }

    /// Factors a leading minus out of the argument, so that a motion and its inverse share sine and cosine.
    fn joint(&mut self, motion: ElementaryMotion, axis: usize, mut affine: Affine) -> ChainStep {
        let is_negative = affine.terms[0].1.number() < 0.0;
        let sign = if is_negative { -1.0 } else { 1.0 };
        if is_negative {
            affine.constant = -affine.constant;
            affine.terms.iter_mut().for_each(|(_, c)| *c = -*c);
        }
        let argument = self.shared_argument(Argument::Affine(affine));
        ChainStep::Joint {
            motion,
            axis,
            argument,
            sign,
        }
    }

    fn shared_argument(&mut self, argument: Argument) -> usize {
        let alike = self.alike.entry(argument_mark(&argument)).or_default();
        // Later ones may have been removed again.
        let known = alike
            .iter()
            .find(|k| self.arguments.get(**k) == Some(&argument));
        if let Some(index) = known {
            return *index;
        }
        alike.push(self.arguments.len());
        self.arguments.push(argument);
        self.arguments.len() - 1
    }
}

/// The same hash for equal arguments; other arguments rarely share it.
fn argument_mark(argument: &Argument) -> u64 {
    let mut mark = DefaultHasher::new();
    // Adding zero makes -0 into 0.
    let bits = |number: f64| (number + 0.0).to_bits();
    match argument {
        Argument::Affine(affine) => {
            bits(affine.constant.number()).hash(&mut mark);
            for (slot, coefficient) in affine.numbers() {
                (slot, bits(coefficient)).hash(&mut mark);
            }
        }
        Argument::Formula(formula) => formula.slots().hash(&mut mark),
    }
    mark.finish()
}

/// Indices of the factors that remain when adjacent inverse factors are cancelled repeatedly.
fn without_pairs(factors: &[Factor]) -> Vec<usize> {
    let mut kept: Vec<usize> = Vec::new();
    for (k, factor) in factors.iter().enumerate() {
        match kept.last() {
            Some(last) if factors[*last].undoes_factor(factor) => _ = kept.pop(),
            _ => kept.push(k),
        }
    }
    kept
}

/// The number of factors in `kept` that begin the product and are undone at its end.
fn kept_around(factors: &[Factor], kept: &[usize]) -> usize {
    let ends = kept.iter().zip(kept.iter().rev());
    let ends = ends.take(kept.len() / 2);
    let undone =
        |(first, last): &(&usize, &usize)| factors[**first].undoes_factor(&factors[**last]);
    ends.take_while(undone).count()
}

/// Merges adjacent constant poses of a chain.
fn folded_chain(steps: impl Iterator<Item = ChainStep>) -> Chain {
    let mut chain = Chain::default();
    for step in steps {
        match (chain.steps.last_mut(), step) {
            (Some(ChainStep::Fixed(last)), ChainStep::Fixed(pose)) => *last = *last * pose,
            _ => chain.steps.push(step),
        }
    }
    chain
}
