//! The entries of `[[plots]]`: quantities with their labels and units.

use super::super::file::SceneFile;
use super::super::formula::compile::constant_node;
use super::super::formula::kinds::is_angle_by_itself;
use super::super::formula::node::{DerivativeNode, FormulaNode, NodeKind};
use super::super::plots::PlotFile;
use super::choices::chosen_angle_unit;
use super::derivative_text::{rate_label, text_part};
use super::outputs::Scope;
use super::parsing::parsed_expression;
use super::rates::TIME;
use crate::diag::{Diagnostic, Diagnostics};
use crate::model::dimension::PhysicalDimension;
use crate::model::mechanism::AngleUnit;
use crate::model::plot::{Abscissa, Plot, PlotCurve, rate_unit};
use crate::model::rate::Per;
use crate::scene::values::FormulaText;

/// The context in which the plots of a scene are resolved.
struct TextSite<'a> {
    scope: &'a Scope<'a>,
    length_unit: &'a str,
    angle_unit: AngleUnit,
}

/// Resolves all plots of the file.
pub fn resolve_plots(file: &SceneFile, scope: &Scope, diagnostics: &mut Diagnostics) -> Vec<Plot> {
    let mut plots = Vec::new();
    for plot in &file.plots {
        let own = plot.angle.as_ref();
        let own = own.and_then(|word| chosen_angle_unit(word, diagnostics));
        let site = TextSite {
            scope,
            length_unit: file.length_unit.as_deref().unwrap_or("m"),
            angle_unit: own.unwrap_or_else(|| scope.unit.clone()),
        };
        plots.extend(site.plot(plot, diagnostics));
    }
    plots
}

impl TextSite<'_> {
    /// `None` after an error, which has been reported.
    fn plot(&self, file: &PlotFile, diagnostics: &mut Diagnostics) -> Option<Plot> {
        // All parts are read before a plot is given up: errors are counted.
        let before = diagnostics.count();
        let x = self.resolve_abscissa(file, diagnostics);
        let y: Vec<PlotCurve> = file
            .y
            .iter()
            .filter_map(|text| self.resolve_curve(text, diagnostics))
            .collect();
        // Numbers with errors are zero meanwhile.
        let numbers = |list: &[FormulaText], diagnostics: &mut Diagnostics| -> Vec<f64> {
            let values = list.iter().map(|text| self.number(text, diagnostics));
            values.map(|v| v.unwrap_or(0.0)).collect()
        };
        let mut marks = Vec::new();
        for mark in &file.marks {
            let v = numbers(mark, diagnostics);
            marks.push([v[0], v[1]]);
        }
        let mut lines = Vec::new();
        for line in &file.lines {
            let v = numbers(line, diagnostics);
            lines.push([[v[0], v[1]], [v[2], v[3]]]);
        }
        let is_whole = diagnostics.count() == before && y.len() == file.y.len();
        is_whole.then_some(Plot {
            title: file.title.clone().unwrap_or_default(),
            x: x?,
            y,
            equal: file.equal,
            marks,
            lines,
        })
    }

    /// The horizontal axis; time by default.
    fn resolve_abscissa(&self, file: &PlotFile, diagnostics: &mut Diagnostics) -> Option<Abscissa> {
        match &file.x {
            None => Some(Abscissa::Time),
            Some(text) if TIME.contains(&text.text.trim()) => Some(Abscissa::Time),
            Some(text) => self
                .resolve_curve(text, diagnostics)
                .map(Abscissa::Quantity),
        }
    }

    /// A constant: parameters may be used.
    fn number(&self, text: &FormulaText, diagnostics: &mut Diagnostics) -> Option<f64> {
        let node = parsed_expression(text, diagnostics)?;
        let names = self.scope.names;
        // What is an angle by itself is shown in the plot's unit; a number is in it.
        let is_angle = is_angle_by_itself(&node, &|name| names.dimension(name));
        let unit = match is_angle {
            true => self.angle_unit.radians.number(),
            false => 1.0,
        };
        let node = names.in_radians(node, None);
        let value = constant_node(&node, &|n, s| names.constant(n, s));
        Some(diagnostics.taken(value)? / unit)
    }

    /// `formula` or `name = formula`, with derivatives `d(formula, input)` or `d(formula, input, order)` as parts of it.
    fn resolve_curve(
        &self,
        text: &FormulaText,
        diagnostics: &mut Diagnostics,
    ) -> Option<PlotCurve> {
        if text.is_unread {
            return None;
        }
        let whole = 0..text.text.len();
        // A label of its own, if there is an equals sign.
        let (name, body) = match text.text.find('=') {
            Some(sign) => (Some(text.text[..sign].trim()), sign + 1..whole.end),
            None => (None, whole),
        };
        let body = text_part(text, body);
        let node = parsed_expression(&body, diagnostics)?;
        // A derivative alone has the unit of a rate.
        let curve = match &node.kind {
            NodeKind::Derivative(parts) => self.derivative_curve(parts, &body),
            _ => self.formula_curve(&node, &body),
        };
        let mut curve = curve.map_err(|d| diagnostics.push(d)).ok()?;
        if let Some(name) = name {
            curve.label = name.to_owned();
        }
        Some(curve)
    }

    /// A formula that may contain derivatives.
    fn formula_curve(
        &self,
        node: &FormulaNode,
        body: &FormulaText,
    ) -> Result<PlotCurve, Diagnostic> {
        let (formula, dimension) = self.scope.compile_rated(node)?;
        let (unit, factor) = self.unit(dimension);
        Ok(PlotCurve {
            label: body.text.trim().to_owned(),
            unit,
            factor,
            expression: formula.expression,
            kind: dimension.kind(),
            rate: None,
            rates: formula.rates,
        })
    }

    /// A derivative alone.
    fn derivative_curve(
        &self,
        parts: &DerivativeNode,
        body: &FormulaText,
    ) -> Result<PlotCurve, Diagnostic> {
        let (expression, rate, dimension) = self.scope.rate(parts)?;
        let of = self.unit(dimension);
        let below = match rate.per {
            Per::Time => ("s".to_owned(), 1.0),
            per @ Per::Input(_) => self.unit(self.scope.dimension_of_per(per)),
        };
        let (unit, factor) = rate_unit((&of.0, of.1), (&below.0, below.1), rate.order);
        // Positions are counted from the start of the text.
        let of = &parts.of.span;
        let quantity = body.text.get(of.start - body.offset..of.end - body.offset);
        Ok(PlotCurve {
            label: rate_label(quantity.unwrap_or("").trim(), &parts.by, rate.order),
            unit,
            factor,
            expression,
            kind: dimension.kind(),
            rate: Some(rate),
            rates: Vec::new(),
        })
    }

    fn unit(&self, dimension: PhysicalDimension) -> (String, f64) {
        let angle = &self.angle_unit;
        dimension.unit_words(self.length_unit, &angle.name, angle.radians.number())
    }
}
