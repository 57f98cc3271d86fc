//! Parsed bars: their ends, and pins for ends that rotations carry. No names are looked up here.

use super::super::super::bars::{BarFile, EndFile};
use super::super::super::file::SceneFile;
use super::super::super::formula::expansion::Factor;
use super::super::super::formula::node::FormulaNode;
use super::super::super::reader::Spanned;
use super::super::parsing::{NamedChains, parsed_expression};
use super::ends::{are_alike, end_factors, end_span, plain_axes, shift_along, trimmed_factors};
use super::pins::ParsedPin;
use crate::diag::{Diagnostics, Span};

/// A bar, parsed.
pub struct ParsedBar {
    pub name: Spanned<String>,
    pub ends: [ParsedEnd; 2],
    pub length: FormulaNode,
}

/// An end of a bar.
pub struct ParsedEnd {
    /// From the world to the point, without rotations about it.
    pub carrier: Vec<Factor>,
    pub place: [FormulaNode; 3],
    pub span: Span,
}

/// All bars of a file.
#[derive(Default)]
pub struct ParsedBars {
    pub list: Vec<ParsedBar>,
    pub pins: Vec<ParsedPin>,
}

impl ParsedBars {
    /// Parses all bars of `file`; invalid ones are reported and skipped.
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
        let mut carrier = |end: &Option<EndFile>| {
            let end = end.as_ref()?;
            let factors = end_factors(end, file, chains, diagnostics)?;
            Some((trimmed_factors(factors), end_span(end)))
        };
        // All parts are looked at before one that is missing ends it.
        let [from, to] = bar.parts.ends.each_ref().map(&mut carrier);
        let length = bar.parts.length.as_ref();
        let length = length.and_then(|text| parsed_expression(text, diagnostics));
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

    /// The end of that name, with a pin if its coordinates are not sums of displacements.
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

    /// Every factor that may contain unknowns.
    pub fn factors(&self) -> impl Iterator<Item = &Factor> {
        self.pins.iter().flat_map(|pin| &pin.closing)
    }

    /// Every length that may contain unknowns.
    pub fn lengths(&self) -> impl Iterator<Item = &FormulaNode> {
        self.list.iter().flat_map(|bar| {
            let places = bar.ends.iter().flat_map(|end| &end.place);
            places.chain([&bar.length])
        })
    }

    /// Transforms every factor and every formula.
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
}
