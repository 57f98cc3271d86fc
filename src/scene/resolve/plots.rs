//! The entries of `[[plots]]`: quantities with their labels and units.

use super::super::file::SceneFile;
use super::super::formula::compile::constant_node;
use super::super::plots::PlotFile;
use super::derivative_text::{
    TIME, derivative_order, derivative_parts, derivative_range, moved_diagnostic, placeholder_name,
    rate_label, text_part,
};
use super::outputs::{ExtraSlot, Scope};
use super::parsing::parsed_expression;
use crate::diag::{Diagnostic, Diagnostics};
use crate::model::dimension::Dimension;
use crate::model::mechanism::AngleUnit;
use crate::model::plot::{Abscissa, Per, Plot, PlotCurve, Rate, rate_unit};
use crate::scene::values::FormulaText;

/// What the plots of a scene are resolved with.
struct TextSite<'a> {
    scope: &'a Scope<'a>,
    length_unit: &'a str,
    angle_unit: AngleUnit,
}

/// Resolves all plots of the file.
pub fn resolve_plots(file: &SceneFile, scope: &Scope, diagnostics: &mut Diagnostics) -> Vec<Plot> {
    let mut plots = Vec::new();
    for plot in &file.plots {
        let site = TextSite {
            scope,
            length_unit: file.length_unit.as_deref().unwrap_or("m"),
            angle_unit: angle_unit(plot, scope.unit, diagnostics),
        };
        plots.extend(site.plot(plot, diagnostics));
    }
    plots
}

fn angle_unit(plot: &PlotFile, scene: &AngleUnit, diagnostics: &mut Diagnostics) -> AngleUnit {
    let Some(name) = &plot.angle else {
        return scene.clone();
    };
    AngleUnit::from_name(&name.value).unwrap_or_else(|| {
        diagnostics.push(
            Diagnostic::error(format!("unknown angle unit `{}`", name.value))
                .at(name.span.clone())
                .hint("rad or deg"),
        );
        scene.clone()
    })
}

impl TextSite<'_> {
    /// `None` where anything of it is wrong, which is reported then.
    fn plot(&self, file: &PlotFile, diagnostics: &mut Diagnostics) -> Option<Plot> {
        let before = diagnostics.count();
        let x = self.resolve_abscissa(file, diagnostics);
        let y: Vec<PlotCurve> = file
            .y
            .iter()
            .filter_map(|text| self.resolve_curve(text, diagnostics))
            .collect();
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

    /// The horizontal axis; the time by default.
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
        match constant_node(&node, &|n, s| names.constant(n, s)) {
            Ok(value) => Some(value),
            Err(diagnostic) => {
                diagnostics.push(diagnostic);
                None
            }
        }
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
        let (name, body) = match text.text.find('=') {
            Some(sign) => (Some(text.text[..sign].trim()), sign + 1..whole.end),
            None => (None, whole),
        };
        let body = text_part(text, body);
        let mut curve = match derivative_parts(&body) {
            Some(parts) => self.derivative_curve(&parts, &body, diagnostics)?,
            None => self.formula_curve(&body, diagnostics)?,
        };
        if let Some(name) = name {
            curve.label = name.to_owned();
        }
        Some(curve)
    }

    /// A formula that may have derivatives in it. Each stands there under a name of the same length, so that mistakes keep
    /// their places.
    fn formula_curve(
        &self,
        body: &FormulaText,
        diagnostics: &mut Diagnostics,
    ) -> Option<PlotCurve> {
        let (mut text, mut rates) = (body.clone(), Vec::new());
        let mut extra: Vec<ExtraSlot> = Vec::new();
        while let Some(range) = derivative_range(&text.text) {
            let part = text_part(&text, range.clone());
            let parts = derivative_parts(&part)?;
            let rate = self.derivative_curve(&parts, body, diagnostics)?;
            let name = placeholder_name(range.len(), extra.len());
            text.text.replace_range(range, &name);
            let slot = self.scope.slot_count() + extra.len();
            let dimension = self.rate_dimension(&rate);
            extra.push(ExtraSlot {
                name,
                slot,
                dimension,
            });
            rates.push((rate.expression, rate.rate?));
        }
        let curve = self.compiled_curve(&text, &extra, diagnostics)?;
        Some(PlotCurve {
            label: body.text.trim().to_owned(),
            rates,
            ..curve
        })
    }

    /// What a rate measures.
    fn rate_dimension(&self, curve: &PlotCurve) -> Dimension {
        let whole = Dimension::of(curve.kind);
        match curve.rate {
            None => whole,
            Some(Rate { per, order }) => {
                let below = match per {
                    Per::Time => Dimension::TIME,
                    Per::Input(k) => Dimension::of(self.scope.names.inputs[k].kind),
                };
                whole - below * order as i32
            }
        }
    }

    /// `d(formula, input, order)`, whose parts these are.
    fn derivative_curve(
        &self,
        parts: &[FormulaText],
        body: &FormulaText,
        diagnostics: &mut Diagnostics,
    ) -> Option<PlotCurve> {
        if !(2..=3).contains(&parts.len()) {
            let diagnostic = Diagnostic::error("a derivative is written `d(quantity, input)`");
            let hint = "or `d(quantity, input, order)`; `t` in place of an input is the time";
            diagnostics.push(moved_diagnostic(diagnostic, body).hint(hint));
            return None;
        }
        let quantity = self.compiled_curve(&parts[0], &[], diagnostics)?;
        let (per, unit) = self.per(&parts[1], diagnostics)?;
        let order = match parts.get(2) {
            None => 1,
            Some(text) => derivative_order(text, diagnostics)?,
        };
        let below = (unit.0.as_str(), unit.1);
        let (unit, factor) = rate_unit((&quantity.unit, quantity.factor), below, order);
        let label = rate_label(parts[0].text.trim(), parts[1].text.trim(), order);
        Some(PlotCurve {
            label,
            unit,
            factor,
            rate: Some(Rate { per, order }),
            ..quantity
        })
    }

    /// The curve of a formula without derivatives; `extra` names are known in it, too.
    fn compiled_curve(
        &self,
        text: &FormulaText,
        extra: &[ExtraSlot],
        diagnostics: &mut Diagnostics,
    ) -> Option<PlotCurve> {
        let node = parsed_expression(text, diagnostics)?;
        let compiled = self.scope.compile_with(&node, extra);
        let (expression, dimension) = compiled.map_err(|d| diagnostics.push(d)).ok()?;
        let (unit, factor) = self.unit(dimension);
        Some(PlotCurve {
            label: text.text.trim().to_owned(),
            unit,
            factor,
            expression,
            kind: dimension.kind(),
            rate: None,
            rates: Vec::new(),
        })
    }

    fn unit(&self, dimension: Dimension) -> (String, f64) {
        let angle = &self.angle_unit;
        dimension.unit_words(self.length_unit, &angle.name, angle.radians.number())
    }

    /// What a derivative is taken by, with its unit and factor.
    fn per(
        &self,
        text: &FormulaText,
        diagnostics: &mut Diagnostics,
    ) -> Option<(Per, (String, f64))> {
        let name = text.text.trim();
        let inputs = &self.scope.names.inputs;
        if let Some(index) = inputs.iter().position(|c| c.name == name) {
            return Some((
                Per::Input(index),
                self.unit(Dimension::of(inputs[index].kind)),
            ));
        }
        if TIME.contains(&name) {
            return Some((Per::Time, ("s".to_owned(), 1.0)));
        }
        let names = inputs.iter().map(|c| c.name.as_str());
        let diagnostic = Diagnostic::error(format!("`{name}` is not an input"))
            .label("derivatives are taken by an input, or by `t`")
            .suggest(name, names);
        diagnostics.push(moved_diagnostic(diagnostic, text));
        None
    }
}
