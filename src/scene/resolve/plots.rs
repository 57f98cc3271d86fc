//! The entries of `[[plots]]`: quantities with their labels and units.

use super::super::file::SceneFile;
use super::super::formula::compile::constant_node;
use super::super::plots::PlotFile;
use super::outputs::Scope;
use super::parsing::parsed_expression;
use crate::diag::{Diagnostic, Diagnostics};
use crate::model::mechanism::{AngleUnit, Kind};
use crate::model::plot::{Abscissa, MAX_ORDER, Per, Plot, PlotCurve, Rate, rate_unit};
use crate::scene::values::FormulaText;

/// Names of the time on an axis.
const TIME: [&str; 2] = ["time", "t"];

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
    /// `None` where anything of it is wrong, which is said then.
    fn plot(&self, file: &PlotFile, diagnostics: &mut Diagnostics) -> Option<Plot> {
        let before = diagnostics.count();
        let x = self.abscissa(file, diagnostics);
        let y: Vec<PlotCurve> = file
            .y
            .iter()
            .filter_map(|text| self.curve(text, diagnostics))
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

    /// The horizontal axis; the time if nothing is said.
    fn abscissa(&self, file: &PlotFile, diagnostics: &mut Diagnostics) -> Option<Abscissa> {
        match &file.x {
            None => Some(Abscissa::Time),
            Some(text) if TIME.contains(&text.text.trim()) => Some(Abscissa::Time),
            Some(text) => self.curve(text, diagnostics).map(Abscissa::Quantity),
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

    /// `formula`, `name = formula`, and in place of a formula `d(formula, input)` or `d(formula, input, order)`.
    fn curve(&self, text: &FormulaText, diagnostics: &mut Diagnostics) -> Option<PlotCurve> {
        if text.is_unread {
            return None;
        }
        let whole = 0..text.text.len();
        let (name, body) = match text.text.find('=') {
            Some(sign) => (Some(text.text[..sign].trim()), sign + 1..whole.end),
            None => (None, whole),
        };
        let body = text_part(text, body);
        let Some(parts) = derivative_parts(&body) else {
            let node = parsed_expression(&body, diagnostics)?;
            let mut curve = self.quantity(&node, &body, diagnostics)?;
            curve.label = name.unwrap_or(body.text.trim()).to_owned();
            return Some(curve);
        };
        if !(2..=3).contains(&parts.len()) {
            let diagnostic = Diagnostic::error("a derivative is written `d(quantity, input)`");
            let hint = "or `d(quantity, input, order)`; `t` in place of an input is the time";
            diagnostics.push(moved_diagnostic(diagnostic, &body).hint(hint));
            return None;
        }
        let node = parsed_expression(&parts[0], diagnostics)?;
        let quantity = self.quantity(&node, &parts[0], diagnostics)?;
        let (per, unit) = self.per(&parts[1], diagnostics)?;
        let order = match parts.get(2) {
            None => 1,
            Some(text) => derivative_order(text, diagnostics)?,
        };
        let below = (unit.0.as_str(), unit.1);
        let (unit, factor) = rate_unit((&quantity.unit, quantity.factor), below, order);
        let label = rate_label(parts[0].text.trim(), parts[1].text.trim(), order);
        Some(PlotCurve {
            label: name.map_or(label, str::to_owned),
            unit,
            factor,
            rate: Some(Rate { per, order }),
            ..quantity
        })
    }

    fn quantity(
        &self,
        node: &super::super::formula::expression::FormulaNode,
        text: &FormulaText,
        diagnostics: &mut Diagnostics,
    ) -> Option<PlotCurve> {
        let (expression, kind) = match self.scope.compile(node) {
            Ok(compiled) => compiled,
            Err(diagnostic) => {
                diagnostics.push(diagnostic);
                return None;
            }
        };
        let (unit, factor) = self.unit(kind);
        Some(PlotCurve {
            label: text.text.trim().to_owned(),
            unit,
            factor,
            expression,
            kind,
            rate: None,
        })
    }

    fn unit(&self, kind: Kind) -> (String, f64) {
        match kind {
            Kind::Length => (self.length_unit.to_owned(), 1.0),
            Kind::Angle => (
                self.angle_unit.name.clone(),
                1.0 / self.angle_unit.radians.number(),
            ),
            Kind::Number => (String::new(), 1.0),
        }
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
            return Some((Per::Input(index), self.unit(inputs[index].kind)));
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

/// Order of a derivative.
fn derivative_order(text: &FormulaText, diagnostics: &mut Diagnostics) -> Option<usize> {
    let order = text.text.trim().parse::<usize>().ok();
    let order = order.filter(|k| (1..=MAX_ORDER).contains(k));
    if order.is_none() {
        let message = format!("the order of a derivative is a whole number from 1 to {MAX_ORDER}");
        diagnostics.push(moved_diagnostic(Diagnostic::error(message), text));
    }
    order
}

/// The formulas between the parentheses of `d(…)`; `None` for another formula.
fn derivative_parts(text: &FormulaText) -> Option<Vec<FormulaText>> {
    let trimmed = text.text.trim_end();
    let start = trimmed.len() - trimmed.trim_start().len();
    let inside = trimmed[start..].strip_prefix('d')?.trim_start();
    let inside = inside.strip_prefix('(')?;
    let first = trimmed.len() - inside.len();
    let (mut depth, mut cuts) = (1_usize, vec![first]);
    for (k, character) in inside.char_indices() {
        match character {
            '(' => depth += 1,
            ')' => depth -= 1,
            ',' if depth == 1 => cuts.push(first + k + 1),
            _ => {}
        }
        if depth == 0 {
            // Something behind the parenthesis makes it a formula, in which `d` is not known.
            let is_end = first + k + 1 == trimmed.len();
            cuts.push(first + k + 1);
            let ranges = cuts.windows(2).map(|w| text_part(text, w[0]..w[1] - 1));
            return is_end.then(|| ranges.collect());
        }
    }
    None
}

/// A part of a text, with its place.
fn text_part(text: &FormulaText, range: std::ops::Range<usize>) -> FormulaText {
    // A text with escapes has no byte-for-byte place, and keeps that of the whole.
    let has_places = text.offset != text.span.start && !text.is_outside();
    let skipped = text.text[range.clone()].len() - text.text[range.clone()].trim_start().len();
    let offset = if has_places {
        text.offset + range.start + skipped
    } else {
        text.offset
    };
    FormulaText {
        text: text.text[range].trim().to_owned(),
        offset,
        span: text.span.clone(),
        is_unread: false,
    }
}

/// Puts a message at a part of a text.
fn moved_diagnostic(diagnostic: Diagnostic, text: &FormulaText) -> Diagnostic {
    if text.is_outside() {
        let message = format!(
            "in `{}`, which is not from the file: {}",
            text.text, diagnostic.message
        );
        return Diagnostic {
            message,
            ..diagnostic
        };
    }
    let span = if text.offset == text.span.start {
        text.span.clone()
    } else {
        text.offset..text.offset + text.text.len()
    };
    diagnostic.at(span)
}

/// `d²h/dphi²`.
fn rate_label(quantity: &str, per: &str, order: usize) -> String {
    let is_name = quantity
        .chars()
        .all(|c| c.is_alphanumeric() || "._'".contains(c));
    let quantity = if is_name {
        quantity.to_owned()
    } else {
        format!("({quantity})")
    };
    let per = if TIME.contains(&per) { "t" } else { per };
    let power = ["", "²", "³", "⁴"]
        .get(order - 1)
        .map_or_else(|| format!("^{order}"), |p| (*p).to_owned());
    format!("d{power}{quantity}/d{per}{power}")
}
