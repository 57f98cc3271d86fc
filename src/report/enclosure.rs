//! Bands of a motion in words, CSV and JSON. Ends of bands are rounded outwards, so that the printed values are bounds
//! as well.

use super::cells::{aligned_rows, six_digits};
use super::csv::{TableCell, push_header, push_row};
use super::rounded::{at_least_six, at_most_six};
use super::sentences::counted_things;
use crate::analysis::enclosure::{
    AllowedTolerance, BandObstacle, Enclosed, MeasureBand, TolerancePlan, ValueBand, shown_names,
};
use crate::kinematics::results::certificate::Reason;
use crate::model::mechanism::{Kind, Mechanism};
use crate::model::printed::{in_unit, shortest_decimal};
use crate::numbers::interval::Interval;
use crate::numbers::rounding::GROW;
use crate::numbers::scalar::Scalar;
use serde_json::{Map, Value, json};

/// What has no bound.
const UNBOUNDED: &str = "unbounded";

/// The lower (-1) or upper (+1) end of a band in the scene's unit, rounded outwards, so that its shortest decimal is a bound too.
pub fn rounded_end(value: f64, kind: Kind, mechanism: &Mechanism, side: f64) -> f64 {
    let unit = Interval::from_constant(mechanism.unit_of(kind));
    let exact = Interval::point(value) / unit;
    // The shortest decimal is nearer to its f64 than the next one.
    match side < 0.0 {
        true => exact.lo.next_down(),
        false => exact.hi.next_up(),
    }
}

/// The same with six digits, for tables.
pub fn outer_end(value: f64, kind: Kind, mechanism: &Mechanism, side: f64) -> String {
    match bounded_end(value, kind, mechanism, side) {
        None => UNBOUNDED.to_owned(),
        Some(end) if side < 0.0 => at_least_six(end),
        Some(end) => at_most_six(end),
    }
}

/// The word for a sample.
pub fn enclosure_word(enclosed: &Enclosed) -> &'static str {
    match &enclosed.bands {
        Ok(_) => "enclosed",
        Err(BandObstacle::NoPose) => "no-pose",
        Err(BandObstacle::BehindSingularPose { .. }) => "behind-singular-pose",
        Err(BandObstacle::Interrupted) => "interrupted",
        Err(BandObstacle::Test { reason, .. }) => reason.word(),
    }
}

/// Why a sample has no band, with the limiting dimension and the time.
pub fn refusal_text(plan: &TolerancePlan, enclosed: &Enclosed) -> Option<String> {
    match &enclosed.bands {
        Ok(_) => None,
        Err(BandObstacle::NoPose) => Some(format!(
            "t = {} s: no pose was found",
            shortest_decimal(enclosed.time)
        )),
        Err(BandObstacle::BehindSingularPose { time }) => Some(format!(
            "t = {} s: the motion has passed a singular pose near t = {} s, from which pieces may go on in another assembly",
            shortest_decimal(enclosed.time),
            six_digits(*time)
        )),
        Err(BandObstacle::Interrupted) => Some(format!(
            "t = {} s: interrupted",
            shortest_decimal(enclosed.time)
        )),
        Err(BandObstacle::Test { reason, dimension }) => {
            let name = dimension.and_then(|k| plan.dimensions.get(k)).map(|d| {
                format!("; within the tolerances, `{}` brings the mechanism closest to a fold or change point", d.name)
            });
            Some(format!(
                "t = {} s: no box is proved: {}{}",
                shortest_decimal(enclosed.time),
                reason_words(*reason),
                name.unwrap_or_default()
            ))
        }
    }
}

/// Why a box is not proved.
pub const fn reason_words(reason: Reason) -> &'static str {
    match reason {
        Reason::Formula => "a formula has no bounded derivatives there",
        Reason::GimbalLock => "a ball joint is in gimbal lock",
        _ => "a piece may be singular there, or the box is too large to exclude this",
    }
}

/// The bands as CSV.
pub fn enclosure_csv(plan: &TolerancePlan, motion: &[Enclosed], searched: bool) -> String {
    let mechanism = plan.family.mechanism();
    let mut text = String::new();
    push_header(&mut text, &enclosure_header(plan, searched));
    for enclosed in motion {
        let cells = enclosure_cells(mechanism, plan, enclosed, searched);
        push_row(&mut text, cells);
    }
    text
}

/// Names of the columns.
fn enclosure_header(plan: &TolerancePlan, searched: bool) -> Vec<String> {
    let mechanism = plan.family.mechanism();
    let own = mechanism.inputs.iter().take(plan.family.own_inputs());
    let mut names = vec!["time".to_owned()];
    names.extend(own.map(|input| input.name.clone()));
    for (name, _) in shown_names(mechanism) {
        names.extend([name.clone(), format!("{name}.lo"), format!("{name}.hi")]);
        if searched {
            names.extend([format!("{name}.least"), format!("{name}.greatest")]);
        }
    }
    names.push("status".to_owned());
    names
}

fn enclosure_cells(
    mechanism: &Mechanism,
    plan: &TolerancePlan,
    enclosed: &Enclosed,
    searched: bool,
) -> Vec<TableCell> {
    let inputs = mechanism.inputs.iter().zip(&enclosed.inputs);
    let number = |value, kind| TableCell::Number(in_unit(value, mechanism.unit_of(kind)));
    let end = |value, kind, side| TableCell::of(bounded_end(value, kind, mechanism, side));
    let mut cells = vec![TableCell::Number(enclosed.time)];
    cells.extend(
        inputs
            .take(plan.family.own_inputs())
            .map(|(input, v)| TableCell::Number(mechanism.file_value(input.kind, *v))),
    );
    let names = shown_names(mechanism);
    let each = if searched { 5 } else { 3 };
    match &enclosed.bands {
        Err(_) => cells.resize(cells.len() + each * names.len(), TableCell::Empty),
        Ok(bands) => {
            for (band, (_, kind)) in bands.list.iter().zip(&names) {
                cells.push(number(band.nominal, *kind));
                cells.push(end(band.lo, *kind, -1.0));
                cells.push(end(band.hi, *kind, 1.0));
                if searched {
                    cells.extend(band.found.map(|v| number(v, *kind)));
                }
            }
        }
    }
    cells.push(TableCell::text(enclosure_word(enclosed)));
    cells
}

/// An end, if there is one.
pub(super) fn bounded_end(value: f64, kind: Kind, mechanism: &Mechanism, side: f64) -> Option<f64> {
    let is_bounded = value.is_finite();
    is_bounded.then(|| rounded_end(value, kind, mechanism, side))
}

/// The bands as one JSON document.
pub fn enclosure_document(
    plan: &TolerancePlan,
    motion: &[Enclosed],
    measures: Option<&[MeasureBand]>,
    searched: bool,
) -> Value {
    let mechanism = plan.family.mechanism();
    let names = enclosure_header(plan, searched);
    let rows = motion.iter().map(|enclosed| {
        let cells = enclosure_cells(mechanism, plan, enclosed, searched).into_iter();
        Value::Object(
            names
                .iter()
                .cloned()
                .zip(cells.map(TableCell::json))
                .collect(),
        )
    });
    let dimensions: Map<String, Value> = plan
        .dimensions
        .iter()
        .map(|d| {
            let tolerance = in_unit(d.tolerance, mechanism.unit_of(d.kind));
            (d.name.clone(), json!(tolerance))
        })
        .collect();
    let refusals = motion.iter().filter_map(|e| refusal_text(plan, e));
    let mut document = json!({
        "schema": "mechanim-enclosure/1",
        "title": mechanism.title,
        "units": { "length": mechanism.length_unit, "angle": mechanism.angle_unit.name, "time": "s" },
        "tolerances": dimensions,
        "columns": names,
        "samples": rows.collect::<Vec<_>>(),
        "refusals": refusals.collect::<Vec<_>>(),
    });
    if let Some(bands) = measures {
        let list = plan.family.measures.list.iter().zip(bands);
        let list: Map<String, Value> = list
            .map(|(measure, band)| {
                let side = |v: f64, side: f64| bounded_end(v, measure.kind, mechanism, side);
                let ends = json!({
                    "lo": side(band.lo, -1.0),
                    "hi": side(band.hi, 1.0),
                    "at_all_times": band.at_all_times,
                });
                (measure.name.clone(), ends)
            })
            .collect();
        document["measures"] = Value::Object(list);
    }
    document
}

/// The band of a quantity over the whole motion.
struct BandSummary {
    below: f64,
    above: f64,
    found: [f64; 2],
    ratio: f64,
    time: f64,
}

/// The summary: how far every quantity can be below and above the nominal motion, and was found to be.
pub fn enclosure_summary(plan: &TolerancePlan, motion: &[Enclosed], searched: bool) -> String {
    let mechanism = plan.family.mechanism();
    let done = motion.iter().filter(|e| e.bands.is_ok()).count();
    let mut text = format!(
        "{}\n  {}, {done} of {} samples enclosed\n\n",
        mechanism.title,
        counted_things(plan.dimensions.len(), "dimension"),
        motion.len()
    );
    let mut rows = vec![vec!["relative to the nominal motion".to_owned()]];
    rows[0].extend(["never below", "never above"].map(str::to_owned));
    if searched {
        rows[0].extend(["least found", "greatest found", "bound/found"].map(str::to_owned));
    }
    rows[0].push("widest at [s]".to_owned());
    for (index, (name, kind)) in shown_names(mechanism).into_iter().enumerate() {
        let Some(all) = over_motion(motion, index, mechanism.natural_size(kind)) else {
            continue;
        };
        let unit = mechanism.file_units(kind);
        let mut row = vec![
            name,
            outer_text(-all.below * unit),
            outer_text(all.above * unit),
        ];
        if searched {
            let ratio = if all.ratio.is_finite() {
                format!("{:.4}", all.ratio)
            } else {
                "-".to_owned()
            };
            // Quantities without a bound are not searched.
            let is_bounded = all.below.is_finite() || all.above.is_finite();
            let found = |value: f64| match is_bounded {
                true => six_digits(value * unit),
                false => "-".to_owned(),
            };
            row.extend([found(-all.found[0]), found(all.found[1]), ratio]);
        }
        row.push(six_digits(all.time));
        rows.push(row);
    }
    text.push_str(&aligned_rows(&rows));
    text
}

/// Six digits, rounded away from zero.
fn outer_text(value: f64) -> String {
    match value {
        value if !value.is_finite() => UNBOUNDED.to_owned(),
        value if value < 0.0 => at_least_six(value),
        value => at_most_six(value),
    }
}

/// The band of quantity `index`, of which `size` is neither large nor small.
fn over_motion(motion: &[Enclosed], index: usize, size: f64) -> Option<BandSummary> {
    let mut all: Option<BandSummary> = None;
    for enclosed in motion {
        let Ok(bands) = &enclosed.bands else { continue };
        let band = bands.list.get(index)?;
        let one = of_band(band, enclosed.time, size);
        all = Some(match all {
            None => one,
            Some(before) => BandSummary {
                below: before.below.max(one.below),
                above: before.above.max(one.above),
                found: [0, 1].map(|k| before.found[k].max(one.found[k])),
                ratio: before.ratio.max(one.ratio),
                time: match one.below + one.above > before.below + before.above {
                    true => one.time,
                    false => before.time,
                },
            },
        });
    }
    all
}

/// What moves less than this fraction of its size is bounded by rounding alone.
const STILL: f64 = 1e-9;

fn of_band(band: &ValueBand, time: f64, size: f64) -> BandSummary {
    if !band.nominal.is_finite() {
        return BandSummary {
            below: f64::INFINITY,
            above: f64::INFINITY,
            found: [0.0; 2],
            ratio: f64::INFINITY,
            time,
        };
    }
    let width = band.found[1] - band.found[0];
    let still = STILL * band.nominal.abs().max(size);
    let ratio = if width > still {
        (band.hi - band.lo) / width
    } else {
        f64::NEG_INFINITY
    };
    BandSummary {
        below: (band.nominal - band.lo) * GROW,
        above: (band.hi - band.nominal) * GROW,
        found: [band.nominal - band.found[0], band.found[1] - band.nominal],
        ratio,
        time,
    }
}

/// The measures: proved bounds, compared with their limits.
pub fn measure_lines(plan: &TolerancePlan, bands: &[MeasureBand]) -> String {
    let mechanism = plan.family.mechanism();
    let mut rows = vec![vec![
        "measure".to_owned(),
        "never below".to_owned(),
        "never above".to_owned(),
        "limits".to_owned(),
    ]];
    for (measure, band) in plan.family.measures.list.iter().zip(bands) {
        let unit = mechanism.file_units(measure.kind);
        let shown = |end: f64, side: f64| {
            let end = bounded_end(end, measure.kind, mechanism, side);
            end.map_or_else(|| "not bounded".to_owned(), shortest_decimal)
        };
        let limits = [
            measure
                .min
                .map(|v| format!("at least {}", six_digits(v * unit))),
            measure
                .max
                .map(|v| format!("at most {}", six_digits(v * unit))),
        ];
        let limits: Vec<String> = limits.into_iter().flatten().collect();
        let kept = measure.allows(band.lo) && measure.allows(band.hi);
        let verdict = match (limits.is_empty(), kept) {
            (true, _) => String::new(),
            (false, true) => {
                let when = match band.at_all_times {
                    true => "at all times",
                    false => "at these poses",
                };
                format!("{}: kept by every piece {when}", limits.join(", "))
            }
            (false, false) => format!("{}: not proved", limits.join(", ")),
        };
        let ends = [shown(band.lo, -1.0), shown(band.hi, 1.0)];
        rows.push([std::slice::from_ref(&measure.name), &ends[..], &[verdict]].concat());
    }
    aligned_rows(&rows)
}

/// What `--allow` found.
pub fn allowed_lines(
    plan: &TolerancePlan,
    name: &str,
    limit: f64,
    found: &AllowedTolerance,
) -> String {
    let mechanism = plan.family.mechanism();
    let mut text = mechanism.title.clone();
    if found.factor == 0.0 {
        text += &format!(
            "\n  no tolerances are proved to keep `{name}` within {}\n",
            six_digits(limit)
        );
        return text;
    }
    text += &format!(
        "\n  at {} every piece keeps `{name}` within {} of the nominal motion with these tolerances (its bound is {})\n",
        counted_things(found.poses, "pose"),
        six_digits(limit),
        bound_text(found.bound, limit)
    );
    if found.is_open_beyond {
        text += "  with larger ones nothing is proved, whatever the limit: a singular pose may be near\n";
    }
    text.push('\n');
    let rows: Vec<Vec<String>> = plan
        .dimensions
        .iter()
        .map(|d| {
            let value = d.tolerance * found.factor * mechanism.file_units(d.kind);
            vec![
                d.name.clone(),
                format!("+-{}", at_least_six(value)),
                mechanism.unit_name(d.kind).to_owned(),
            ]
        })
        .collect();
    text.push_str(&aligned_rows(&rows));
    text
}

/// An upper bound that does not read as more than the limit that it keeps.
fn bound_text(bound: f64, limit: f64) -> String {
    let shown = at_most_six(bound);
    match shown.parse::<f64>() {
        Ok(reads) if reads > limit => six_digits(limit),
        _ => shown,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A band in any unit of length has the ratio of its width to the one found.
    #[test]
    fn what_moves_does_not_depend_on_the_unit_of_length() {
        for size in [1e-9, 1.0, 1e6] {
            let band = ValueBand {
                nominal: 0.0,
                lo: -2e-3 * size,
                hi: 2e-3 * size,
                found: [-1e-3 * size, 1e-3 * size],
            };
            let ratio = of_band(&band, 0.0, size).ratio;
            assert!((ratio - 2.0).abs() < 1e-12, "{size:e}: {ratio}");
        }
    }
}
