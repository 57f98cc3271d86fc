//! Extremes along the drive at all times: the poses of the measures give one end of their range, what is proved between the
//! samples gives the other.

use super::measures::MeasureBand;
use super::motion::{SpanBands, shown_names};
use super::plan::TolerancePlan;
use crate::kinematics::enclosure::pose::PoseEnclosure;
use crate::model::expression::Expression;
use crate::model::measure::{MeasureSource, Taking};
use crate::numbers::affine_form::AffineForm;
use crate::numbers::interval::Interval;
use crate::numbers::rounding::GROW;
use crate::numbers::scalar::Scalar;

/// The formula of a measure that is an extreme along the drive.
fn extreme_formula(source: &MeasureSource) -> Option<(&Expression, Taking)> {
    match source {
        MeasureSource::Over {
            track: None,
            of,
            rates,
            per: None,
            taking: taking @ (Taking::Min | Taking::Max | Taking::Range | Taking::Largest),
            ..
        } if rates.is_empty() => Some((of.first()?, *taking)),
        _ => None,
    }
}

/// Ranges of the formulas of all extremes along the drive, in the order of the measures.
pub(super) fn extreme_ranges(plan: &TolerancePlan, enclosure: &PoseEnclosure) -> Vec<[f64; 2]> {
    let list = plan.family.measures.list.iter();
    let formulas = list.filter_map(|measure| extreme_formula(&measure.source));
    let slots: Vec<AffineForm> = (0..enclosure.len())
        .map(|slot| enclosure.form(slot))
        .collect();
    let range = |(formula, _): (&Expression, Taking)| {
        // By its derivatives, which a kink may lack, and by the ranges of its operands.
        let forms = [enclosure.formula(formula).0, formula.value(&slots)];
        let known = forms.iter().filter(|form| form.is_finite());
        known.fold([f64::NEG_INFINITY, f64::INFINITY], |[lo, hi], form| {
            let range = form.range();
            [lo.max(range.lo), hi.min(range.hi)]
        })
    };
    formulas.map(range).collect()
}

/// The bands of measures at their poses, extended to all times where the measures are extremes along the drive, or formulas of
/// those. `spans` are the stretches between samples; unless they cover the drive nothing changes.
pub fn measures_at_all_times(
    plan: &TolerancePlan,
    at_poses: Vec<MeasureBand>,
    spans: &[SpanBands],
) -> Vec<MeasureBand> {
    let duration = plan.family.actuation.duration;
    let covers = spans.first().is_some_and(|span| span.from == 0.0)
        && spans.last().is_some_and(|span| span.until == duration);
    if !covers {
        return at_poses;
    }
    let shown = shown_names(plan.family.mechanism()).len();
    let over_drive = |extreme: usize| {
        let of_span = |span: &SpanBands| match &span.bands {
            Ok(bands) => bands.get(shown + extreme).copied(),
            Err(_) => None,
        };
        let ranges = spans.iter().map(|span| {
            let [lo, hi] = of_span(span).unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
            Interval::new(lo, hi)
        });
        ranges.reduce(Interval::hull).unwrap_or(Interval::ENTIRE)
    };
    let inputs = inputs_at_start(plan);
    let mut extremes = 0..;
    let mut whole: Vec<MeasureBand> = Vec::with_capacity(at_poses.len());
    for (measure, band) in plan.family.measures.list.iter().zip(at_poses) {
        let at_all_times = match &measure.source {
            MeasureSource::Formula(formula) => {
                let used = formula.slots();
                let is_changed = |slot: &usize| {
                    let earlier = slot.checked_sub(inputs.len());
                    earlier.is_some_and(|k| whole[k].at_all_times)
                };
                used.iter().any(is_changed).then(|| {
                    let known = whole.iter().map(|band| Interval::new(band.lo, band.hi));
                    let slots: Vec<Interval> = inputs.iter().copied().chain(known).collect();
                    let range = formula.value(&slots);
                    match range.is_finite() {
                        true => range,
                        false => Interval::ENTIRE,
                    }
                })
            }
            source => extreme_formula(source).map(|(_, taking)| {
                let over = over_drive(extremes.next().unwrap_or_default());
                let Interval { lo, hi } = over;
                // No pose of the measure is beyond its extreme over all times.
                match taking {
                    Taking::Min => Interval::new(lo.min(band.lo), band.hi),
                    Taking::Max => Interval::new(band.lo, hi.max(band.hi)),
                    Taking::Largest => Interval::new(band.lo, over.magnitude().max(band.hi)),
                    _ => Interval::new(band.lo, ((hi - lo) * GROW).max(band.hi)),
                }
            }),
        };
        whole.push(match at_all_times {
            Some(Interval { lo, hi }) => MeasureBand {
                lo,
                hi,
                at_all_times: true,
            },
            None => band,
        });
    }
    whole
}

/// The inputs at the start of the drive, for every piece.
fn inputs_at_start(plan: &TolerancePlan) -> Vec<Interval> {
    let unknowns = plan.family.mechanism().unknowns.len();
    let start = plan.family.actuation.inputs_at(0.0);
    let pose = [vec![0.0; unknowns], start.clone()].concat();
    let open = plan.input_open(&pose).into_iter();
    let drawn = start.iter().zip(open);
    let mut inputs: Vec<Interval> = drawn
        .map(|(value, open)| Interval::point(*value) + Interval::around_zero(open))
        .collect();
    for tolerance in plan.tolerances(&pose) {
        let input = &mut inputs[tolerance.slot - unknowns];
        *input = *input + Interval::around_zero(tolerance.half_width);
    }
    inputs
}
