//! Bars to equations: the square of the distance of two points, less that of the length.
//!
//! An end that chains only shift has coordinates that are sums of what shifts it. Where rotations carry it around, its
//! coordinates become unknowns of their own, called `BAR.from.x` and so on, and a loop that closes in a point (a pin) says where
//! they are. So the equation of a bar is of second degree in its coordinates, whatever carries its ends.

mod ends;
mod pins;

use super::super::bars::{BarFile, EndFile};
use super::super::file::SceneFile;
use super::super::formula::compile::{compile_formula, constant_node};
use super::super::formula::expansion::Factor;
use super::super::formula::kinds::to_radians;
use super::super::formula::node::{FormulaNode, NodeKind};
use super::super::reader::Spanned;
use super::joints::FoldedJoints;
use super::names::{Meaning, Names};
use super::parsing::{NamedChains, parsed_expression};
use crate::diag::{Diagnostic, Diagnostics, Span, shown_number};
use crate::model::chain::ElementaryMotion;
use crate::model::mechanism::{AngleUnit, Bar, BarEnd, Closes, Equation, Kind, Loop};
use crate::numbers::constant::Constant;
use ends::{are_alike, end_factors, end_span, plain_axes, shift_along, trimmed_factors};
use pins::ParsedPin;

/// A bar, parsed.
pub struct ParsedBar {
    pub name: Spanned<String>,
    ends: [ParsedEnd; 2],
    length: FormulaNode,
}

/// An end of a bar.
struct ParsedEnd {
    /// From the world to the point, without what turns about it.
    carrier: Vec<Factor>,
    place: [FormulaNode; 3],
    span: Span,
}

/// All bars of a file.
#[derive(Default)]
pub struct ParsedBars {
    pub list: Vec<ParsedBar>,
    pub pins: Vec<ParsedPin>,
}

/// What bars add to the mechanism.
#[derive(Default)]
pub struct ResolvedBars {
    pub loops: Vec<Loop>,
    pub equations: Vec<Equation>,
    pub list: Vec<Bar>,
}

impl ParsedBars {
    /// Parses all bars of `file`; what fails is reported and left out.
    pub fn parse(file: &SceneFile, chains: &NamedChains, diagnostics: &mut Diagnostics) -> Self {
        let mut bars = Self::default();
        for bar in &file.bars {
            let parsed = bars.parse_bar(bar, file, chains, diagnostics);
            bars.list.extend(parsed);
        }
        bars
    }

    fn parse_bar(
        &mut self,
        bar: &BarFile,
        file: &SceneFile,
        chains: &NamedChains,
        diagnostics: &mut Diagnostics,
    ) -> Option<ParsedBar> {
        let parts = bar.parts.as_ref()?;
        let mut carrier = |end: &EndFile| {
            let factors = end_factors(end, file, chains, diagnostics)?;
            Some((trimmed_factors(factors), end_span(end)))
        };
        let [from, to] = [carrier(&parts.ends[0]), carrier(&parts.ends[1])];
        let length = parsed_expression(&parts.length, diagnostics);
        let name = &bar.name.value;
        let ends = [
            self.end(format!("{name}.from"), from?),
            self.end(format!("{name}.to"), to?),
        ];
        Some(ParsedBar {
            name: bar.name.clone(),
            ends,
            length: length?,
        })
    }

    /// The end of that name, with a pin where its coordinates are no sums of what stands in its chain.
    fn end(&mut self, name: String, (carrier, span): (Vec<Factor>, Span)) -> ParsedEnd {
        let known = self
            .pins
            .iter()
            .find(|pin| are_alike(&pin.carrier, &carrier));
        let place = match (known, plain_axes(&carrier)) {
            (Some(pin), _) => pin.place.clone(),
            (None, [true, true, true]) => [0, 1, 2].map(|axis| shift_along(&carrier, axis, &span)),
            (None, plain) => {
                let pin = ParsedPin::new(name, &carrier, plain, &span);
                let place = pin.place.clone();
                self.pins.push(pin);
                place
            }
        };
        ParsedEnd {
            carrier,
            place,
            span,
        }
    }

    /// Every factor in which unknowns may stand.
    pub fn factors(&self) -> impl Iterator<Item = &Factor> {
        self.pins.iter().flat_map(|pin| &pin.closing)
    }

    /// Every length in which unknowns may stand.
    pub fn lengths(&self) -> impl Iterator<Item = &FormulaNode> {
        self.list.iter().flat_map(|bar| {
            let places = bar.ends.iter().flat_map(|end| &end.place);
            places.chain([&bar.length])
        })
    }

    /// Changes every factor and every formula.
    pub fn change(&mut self, factor: &dyn Fn(&mut Factor), length: &dyn Fn(&mut FormulaNode)) {
        for bar in &mut self.list {
            for end in &mut bar.ends {
                end.carrier.iter_mut().for_each(factor);
                end.place.iter_mut().for_each(length);
            }
            length(&mut bar.length);
        }
        for pin in &mut self.pins {
            pin.closing.iter_mut().for_each(factor);
        }
    }

    /// Equations and loops of the bars that are sound.
    pub fn resolve(
        &self,
        (names, unit): (&Names, &AngleUnit),
        joints: &mut FoldedJoints,
        diagnostics: &mut Diagnostics,
    ) -> ResolvedBars {
        let mut resolved = ResolvedBars::default();
        for pin in &self.pins {
            let closed = joints.closing(&pin.name, &pin.closing, Closes::Point, diagnostics);
            let base = joints.chain(&pin.base, diagnostics);
            if let (Some(closed), Some(base)) = (closed, base) {
                resolved.loops.push(Loop { base, ..closed });
            }
        }
        for bar in &self.list {
            if let Some((equation, bar)) = bar.resolve((names, unit), joints, diagnostics) {
                resolved.equations.push(equation);
                resolved.list.push(bar);
            }
        }
        resolved
    }
}

impl ParsedBar {
    fn resolve(
        &self,
        (names, unit): (&Names, &AngleUnit),
        joints: &mut FoldedJoints,
        diagnostics: &mut Diagnostics,
    ) -> Option<(Equation, Bar)> {
        let name = &self.name.value;
        let mut refuse = |message: String, span: &Span, hint: &str| {
            let message = Diagnostic::error(message).at(span.clone());
            diagnostics.push(message.hint(hint));
        };
        let [from, to] = &self.ends;
        let is_fixed = |node: &FormulaNode| {
            let mut fixed = true;
            node.visit_names(&mut |name, _| {
                fixed &= matches!(names.meaning(name), Some(Meaning::Parameter(_)));
            });
            fixed
        };
        let stands = |end: &ParsedEnd| {
            end.carrier.iter().all(|factor| match factor {
                Factor::Elementary(_, _, node) => is_fixed(node),
                Factor::Direction(..) => true,
            })
        };
        let pairs = from.place.iter().zip(&to.place);
        let mut is_sound = true;
        if pairs.into_iter().all(|(a, b)| a.is_alike(b)) {
            let message = format!("bar `{name}` has the same point at both ends");
            refuse(message, &to.span, "a bar connects two points");
            is_sound = false;
        } else if stands(from) && stands(to) {
            let message = format!("bar `{name}` is between two fixed points");
            let hint = "it holds nothing that moves: leave it out, or let an end be an unknown point or a point of a link";
            refuse(message, &self.name.span, hint);
            is_sound = false;
        }
        let mut length = None;
        let length_node = to_radians(
            self.length.clone(),
            Some(Kind::Length),
            unit.radians,
            &|n| names.is_angle(n),
        );
        if is_fixed(&length_node) {
            match constant_node(&length_node, &|n, s| names.constant(n, s)) {
                Ok(value) if value > 0.0 => length = Some(value),
                Ok(value) => {
                    let value = shown_number(value);
                    let message =
                        format!("the length of bar `{name}` must be positive, found {value}");
                    let hint = "a bar is as long as its points are apart; points that are one are written as one";
                    refuse(message, &self.length.span, hint);
                    is_sound = false;
                }
                Err(diagnostic) => {
                    diagnostics.push(diagnostic);
                    is_sound = false;
                }
            }
        }
        let mut end = |end: &ParsedEnd| {
            let motion = ElementaryMotion::Translation;
            let coordinates = end.place.iter().cloned().enumerate();
            let coordinates: Vec<Factor> = coordinates
                .map(|(axis, node)| Factor::Elementary(motion, axis, node))
                .collect();
            Some(BarEnd {
                point: joints.chain(&coordinates, diagnostics)?,
                carrier: joints.chain(&end.carrier, diagnostics)?,
            })
        };
        let ends = [end(from)?, end(to)?];
        if !is_sound {
            return None;
        }
        let gap = to_radians(self.gap(length), None, unit.radians, &|n| names.is_angle(n));
        match compile_formula(&gap, &|n, s| names.coordinate(n, s)) {
            Ok(expression) => {
                let equation = Equation {
                    name: name.clone(),
                    expression,
                    length_exponent: if length.is_some() { 1.0 } else { 2.0 },
                    magnitude: 1.0,
                };
                let name = name.clone();
                Some((equation, Bar { name, ends, length }))
            }
            Err(diagnostic) => {
                diagnostics.push(diagnostic);
                None
            }
        }
    }

    /// (d² - L²) / 2 L: by how much the points are too far apart, to the first order. A length that changes divides nothing.
    fn gap(&self, length: Option<f64>) -> FormulaNode {
        let span = &self.name.span;
        let binary = |sign: char, a: FormulaNode, b: FormulaNode| FormulaNode {
            kind: NodeKind::Binary(sign, Box::new(a), Box::new(b)),
            span: span.clone(),
        };
        let number = |value: f64| FormulaNode::number(Constant::exact(value), span.clone());
        let square = |node: FormulaNode| binary('^', node, number(2.0));
        let [from, to] = &self.ends;
        let pairs = from.place.iter().zip(&to.place);
        let squares = pairs.map(|(a, b)| square(binary('-', b.clone(), a.clone())));
        let sum = squares.reduce(|sum, next| binary('+', sum, next));
        let sum = sum.unwrap_or_else(|| number(0.0));
        let gap = binary('-', sum, square(self.length.clone()));
        match length {
            Some(length) => binary('*', gap, number(0.5 / length)),
            None => gap,
        }
    }
}
