//! Resolves tracks and measures: names become indices, formulas refer to poses and earlier measures.

use super::super::file::SceneFile;
use super::super::formula::compile::{CompiledValue, compile_formula, constant_node};
use super::super::formula::kinds::{dimension_of, own_kind, to_radians};
use super::super::formula::node::{FormulaNode, NodeKind};
use super::super::measures::{MeasureFile, MeasureSourceFile, TrackFile};
use super::body_constants::BodyConstants;
use super::names::Names;
use super::outputs::Scope;
use super::parsing::parsed_expression;
use super::range::limits_in_order;
use super::rates::{FoundRates, TIME, find_derivative};
use super::varied::Dependents;
use crate::diag::{Diagnostic, Diagnostics, Span, name_hint, shown_number};
use crate::model::dimension::PhysicalDimension;
use crate::model::expression::Expression;
use crate::model::measure::{Measure, MeasureSource, MeasuredTrack, Taking};
use crate::model::mechanism::Kind;
use crate::scene::reader::Spanned;
use crate::scene::values::FormulaText;

/// Most poses of a track: all are solved whenever measures are evaluated.
const MOST_SAMPLES: f64 = 10_000.0;

/// Power of a norm without `power`.
const DEFAULT_POWER: f64 = 2.0;

/// Resolves the tracks; `start` are the inputs at the start of the drive, which apply to inputs that a track does not
/// mention.
pub fn resolve_tracks(
    file: &SceneFile,
    scope: &Scope,
    start: &[f64],
    diagnostics: &mut Diagnostics,
) -> Vec<MeasuredTrack> {
    let tracks = file.tracks.iter();
    tracks
        .filter_map(|track| resolve_track(track, scope, start, diagnostics))
        .collect()
}

fn resolve_track(
    track: &TrackFile,
    scope: &Scope,
    start: &[f64],
    diagnostics: &mut Diagnostics,
) -> Option<MeasuredTrack> {
    let names = scope.names;
    let constants = BodyConstants { names };
    let text = track.samples.as_ref()?;
    let samples = constants.value(text, diagnostics)?;
    if samples.fract() != 0.0 || !(2.0..=MOST_SAMPLES).contains(&samples) {
        let message = format!(
            "a track has 2 to {MOST_SAMPLES} samples, found {}",
            shown_number(samples)
        );
        diagnostics.push(Diagnostic::error(message).at(text.span.clone()));
        return None;
    }
    // Inputs that the track does not mention stay at the start of the drive.
    let (mut from, mut to) = (start.to_vec(), start.to_vec());
    for (name, ends) in &track.inputs {
        let Some(k) = names
            .inputs
            .iter()
            .position(|input| input.name == name.value)
        else {
            let known = names.inputs.iter().map(|input| input.name.as_str());
            let message = format!("there is no input `{}`", name.value);
            diagnostics.push(
                Diagnostic::error(message)
                    .at(name.span.clone())
                    .suggest(&name.value, known),
            );
            return None;
        };
        let kind = names.inputs[k].kind;
        let [first, last] = ends
            .each_ref()
            .map(|text| fixed_point(text, kind, scope, diagnostics));
        (from[k], to[k]) = (first?, last?);
    }
    Some(MeasuredTrack {
        name: track.name.value.clone(),
        samples: samples as usize,
        from,
        to,
    })
}

/// A constant of a known kind, in internal units.
fn fixed_point(
    text: &FormulaText,
    kind: Kind,
    scope: &Scope,
    diagnostics: &mut Diagnostics,
) -> Option<f64> {
    let node = parsed_expression(text, diagnostics)?;
    let node = scope.names.in_radians(node, Some(kind));
    let value = constant_node(&node, &|n, s| scope.names.constant(n, s));
    value
        .map_err(|diagnostic| diagnostics.push(diagnostic))
        .ok()
}

/// Resolves the measures in the order of the file; in a study they are differentiated by its variables.
pub fn resolve_measures(
    file: &SceneFile,
    (scope, dependents): (&Scope, &Dependents),
    (tracks, is_studied): (&[MeasuredTrack], bool),
    diagnostics: &mut Diagnostics,
) -> Vec<Measure> {
    let mut measures: Vec<Measure> = Vec::new();
    for item in &file.measures {
        let among = (tracks, measures.as_slice(), is_studied);
        let scopes = (scope, dependents);
        if let Some(measure) = resolve_measure(item, file, scopes, among, diagnostics) {
            measures.push(measure);
        }
    }
    measures
}

fn resolve_measure(
    item: &MeasureFile,
    file: &SceneFile,
    (scope, dependents): (&Scope, &Dependents),
    (tracks, earlier, is_studied): (&[MeasuredTrack], &[Measure], bool),
    diagnostics: &mut Diagnostics,
) -> Option<Measure> {
    // A formula of earlier measures, or values over poses that are reduced to one.
    let (source, dimension) = match item.source.as_ref()? {
        MeasureSourceFile::Formula(text) => {
            let scopes = (scope, dependents);
            measure_formula(text, file, scopes, earlier, diagnostics)?
        }
        source @ MeasureSourceFile::Over { .. } => {
            let scopes = (scope, dependents);
            resolve_over(source, file, scopes, (tracks, is_studied), diagnostics)?
        }
    };
    let kind = dimension.kind();
    // Limits are constants of the same kind: `None` after an error, `Some(None)` for no limit.
    let [min, max] = item.limits.each_ref().map(|text| match text {
        None => Some(None),
        Some(text) => fixed_point(text, kind, scope, diagnostics).map(Some),
    });
    let (min, max) = (min?, max?);
    diagnostics.taken(limits_in_order(&item.name.value, [min, max], &item.limits))?;
    Some(Measure {
        name: item.name.value.clone(),
        kind,
        dimension,
        source,
        min,
        max,
        why: item.why.clone(),
        size: match kind {
            Kind::Angle => 1.0,
            Kind::Length | Kind::Number => 0.0,
        },
    })
}

fn resolve_over(
    source: &MeasureSourceFile,
    file: &SceneFile,
    (scope, dependents): (&Scope, &Dependents),
    (tracks, is_studied): (&[MeasuredTrack], bool),
    diagnostics: &mut Diagnostics,
) -> Option<(MeasureSource, PhysicalDimension)> {
    let MeasureSourceFile::Over {
        track,
        of,
        per,
        take,
        power,
    } = source
    else {
        return None;
    };
    // Which poses: those of a track, or of the drive.
    let track = match track {
        None => None,
        Some(name) => Some(track_index(name, file, tracks, diagnostics)?),
    };
    // How the values are reduced, and of which formulas.
    let taking = resolve_taking(take, of.len(), diagnostics)?;
    let nodes = of.iter().map(|text| parsed_expression(text, diagnostics));
    let mut nodes: Vec<FormulaNode> = nodes.collect::<Option<_>>()?;
    nodes.iter_mut().for_each(|node| dependents.expand(node));
    // Derivatives by a single input are written as `per`, whether or not the file does so.
    let per = match per {
        None => derived_by_all(&mut nodes, scope.names),
        Some(name) => Some(input_index(name, scope.names, diagnostics)?),
    };
    // The formulas, with the rates they contain; some positions do not allow rates.
    let mut whole = PhysicalDimension::NUMBER;
    let (mut formulas, mut rates) = (Vec::new(), FoundRates::default());
    for node in &nodes {
        let compiled = scope.compile_beside(node, &mut rates).and_then(|compiled| {
            let place = RatePlace {
                is_track: track.is_some(),
                is_derived: per.is_some(),
                is_studied,
            };
            place.refuse(node, &compiled.0, scope)?;
            Ok(compiled)
        });
        let compiled = compiled.map_err(|d| diagnostics.push(d));
        let (formula, dimension) = compiled.ok()?;
        whole = dimension;
        formulas.push(formula);
    }
    // A share of the poses is a number.
    if taking == Taking::Positive {
        whole = PhysicalDimension::NUMBER;
    } else if let Some(input) = per {
        whole = whole - PhysicalDimension::of(scope.names.inputs[input].kind);
    }
    let source = MeasureSource::Over {
        winds: formulas
            .iter()
            .any(|formula| scope.holds_coordinate_angle(formula)),
        track,
        of: formulas,
        rates: rates.list,
        per,
        taking,
        power: resolve_power(power.as_ref(), scope, diagnostics)?,
    };
    Some((source, whole))
}

/// If all formulas are first derivatives by the same input, the input and the formulas themselves: `of = "d(h, phi)"`
/// is equivalent to `of = "h"` with `per`, which studies support better.
fn derived_by_all(nodes: &mut [FormulaNode], names: &Names) -> Option<usize> {
    let by = |node: &FormulaNode| match &node.kind {
        NodeKind::Derivative(parts) if parts.order == 1 => {
            let mut inputs = names.inputs.iter();
            inputs.position(|input| input.name == parts.by)
        }
        _ => None,
    };
    let first = by(nodes.first()?)?;
    // A formula with a derivative inside is rejected as written.
    let is_plain = |node: &FormulaNode| match &node.kind {
        NodeKind::Derivative(parts) => find_derivative(&parts.of, &|_| true).is_none(),
        _ => false,
    };
    if !nodes
        .iter()
        .all(|node| by(node) == Some(first) && is_plain(node))
    {
        return None;
    }
    // The derivative is taken off each formula; the caller takes it of all of them.
    for node in nodes {
        if let NodeKind::Derivative(parts) = &node.kind {
            *node = parts.of.clone();
        }
    }
    Some(first)
}

/// The position of a measure's formula, which determines the rates it may contain.
struct RatePlace {
    is_track: bool,
    is_derived: bool,
    is_studied: bool,
}

impl RatePlace {
    fn refuse(
        &self,
        node: &FormulaNode,
        formula: &Expression,
        scope: &Scope,
    ) -> Result<(), Diagnostic> {
        // Rates may be written in the formula itself or be hidden in an output that it uses.
        let slots = formula.slots();
        let own = find_derivative(node, &|_| true);
        let timed = find_derivative(node, &|parts| {
            let is_input = scope.names.inputs.iter().any(|i| i.name == parts.by);
            !is_input && TIME.contains(&parts.by.as_str())
        });
        let uses_timed = slots.iter().any(|slot| scope.is_timed(*slot));
        let holds = own.is_some() || slots.iter().any(|slot| scope.is_rated(*slot));
        let at = |found: Option<&FormulaNode>| found.unwrap_or(node).span.clone();
        // A track has no time, so that rates by time do not exist there.
        if self.is_track && (timed.is_some() || uses_timed) {
            return Err(Diagnostic::error("a track has no time to differentiate by")
                .at(at(timed))
                .hint("differentiate by an input, or measure along the drive: without `track`"));
        }
        // A derivative of a derivative would have to be of higher order.
        if self.is_derived && holds {
            return Err(Diagnostic::error(
                "`per` cannot differentiate a formula that contains a derivative",
            )
            .at(at(own))
            .hint("a derivative of higher order is written `d(quantity, input, order)`"));
        }
        // The derivatives of rates by parameters are not implemented.
        if self.is_studied && holds {
            return Err(Diagnostic::error(
                "studies cannot differentiate a formula that contains a derivative",
            )
            .at(at(own))
            .hint("a whole `of = \"d(quantity, input)\"` of the first order can be studied"));
        }
        Ok(())
    }
}

/// What a measure of this many formulas takes of the values.
fn resolve_taking(
    take: &Spanned<String>,
    found: usize,
    diagnostics: &mut Diagnostics,
) -> Option<Taking> {
    // The word must be known, and fit the number of formulas.
    let known = Taking::NAMES.iter().find(|(name, _)| *name == take.value);
    let Some((_, taking)) = known else {
        let names = Taking::NAMES.map(|(name, _)| name);
        diagnostics.push(
            Diagnostic::error(format!("`{}` cannot be taken", take.value))
                .at(take.span.clone())
                .hint(name_hint(&take.value, names)),
        );
        return None;
    };
    let wanted = taking.width();
    if found != wanted {
        let name = &take.value;
        let message = format!("formulas in `of`: {found}, but `{name}` takes {wanted}");
        diagnostics.push(Diagnostic::error(message).at(take.span.clone()));
        return None;
    }
    Some(*taking)
}

/// The power of a norm.
fn resolve_power(
    power: Option<&FormulaText>,
    scope: &Scope,
    diagnostics: &mut Diagnostics,
) -> Option<f64> {
    let Some(text) = power else {
        return Some(DEFAULT_POWER);
    };
    let power = BodyConstants { names: scope.names }.value(text, diagnostics)?;
    if power >= 1.0 {
        return Some(power);
    }
    let found = shown_number(power);
    let message = format!("the power of a norm must be at least 1, found {found}");
    diagnostics.push(Diagnostic::error(message).at(text.span.clone()));
    None
}

fn input_index(
    name: &Spanned<String>,
    names: &Names,
    diagnostics: &mut Diagnostics,
) -> Option<usize> {
    let found = names.inputs.iter().position(|i| i.name == name.value);
    if found.is_none() {
        let known = names.inputs.iter().map(|i| i.name.as_str());
        let message = format!(
            "derivatives are taken with respect to an input, and `{}` is not one",
            name.value
        );
        diagnostics.push(
            Diagnostic::error(message)
                .at(name.span.clone())
                .suggest(&name.value, known),
        );
    }
    found
}

fn track_index(
    name: &Spanned<String>,
    file: &SceneFile,
    tracks: &[MeasuredTrack],
    diagnostics: &mut Diagnostics,
) -> Option<usize> {
    let found = tracks.iter().position(|t| t.name == name.value);
    let declared = file.tracks.iter().any(|t| t.name.value == name.value);
    if found.is_none() && !declared {
        let known = tracks.iter().map(|t| t.name.as_str());
        let message = format!("there is no track `{}`", name.value);
        diagnostics.push(
            Diagnostic::error(message)
                .at(name.span.clone())
                .suggest(&name.value, known),
        );
    }
    found
}

/// A formula of earlier measures and parameters.
fn measure_formula(
    text: &FormulaText,
    file: &SceneFile,
    (scope, dependents): (&Scope, &Dependents),
    earlier: &[Measure],
    diagnostics: &mut Diagnostics,
) -> Option<(MeasureSource, PhysicalDimension)> {
    let names = scope.names;
    let mut node = parsed_expression(text, diagnostics)?;
    dependents.expand(&mut node);
    // What it measures follows from the measures that it uses.
    let of_name = |used: &str| {
        let measure = earlier.iter().find(|m| m.name == used);
        measure.map_or_else(|| names.dimension(used), |m| Some(m.dimension))
    };
    let dimension = dimension_of(&node, &of_name);
    let wanted = own_kind(&node, &of_name);
    let node = to_radians(node, wanted, scope.unit.radians, &of_name);
    // Slots are the inputs, then the earlier measures.
    let lookup = |used: &str, span: &Span| {
        if let Some(slot) = earlier.iter().position(|m| m.name == used) {
            return Ok(CompiledValue::Slot(names.inputs.len() + slot));
        }
        // Only earlier ones have a value, so that there are no circles.
        if file.measures.iter().any(|m| m.name.value == used) {
            return Err(Diagnostic::error(format!(
                "measure `{used}` is defined further down, or invalid"
            ))
            .at(span.clone())
            .hint("a measure may use only earlier ones"));
        }
        if let Some(input) = names.varied_input(used) {
            return Ok(CompiledValue::Slot(input));
        }
        names.constant(used, span).map_err(|d| {
            d.suggest(used, earlier.iter().map(|m| m.name.as_str()))
                .hint("a value of single poses is measured over a track or the drive: { of = …, take = … }")
        })
    };
    let formula = diagnostics.taken(compile_formula(&node, &lookup))?;
    Some((MeasureSource::Formula(formula), dimension))
}
