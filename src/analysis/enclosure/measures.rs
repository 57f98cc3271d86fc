//! Measures for all pieces: what the poses show as affine forms of the dimensions, reduced along the tracks and put into
//! the formulas of the measures.


use super::pose_bands::{Obstacle, enclosed_pose};
use super::plan::{Plan, sized};
use crate::analysis::study::Nominal;
use crate::kinematics::enclosure::pose::Encloser;
use crate::kinematics::solve::pose_solver::PoseSolver;
use crate::model::expression::Expression;
use crate::model::measure::{Measure, MeasureSource, Taking};
use crate::numbers::affine_form::AffineForm;
use crate::numbers::interval::Interval;
use crate::numbers::rounding::GROW;
use crate::numbers::scalar::{Ring, Scalar};

/// The range of a measure over all pieces; nothing is known where it is not bounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasureBand {
    /// No piece is lower.
    pub lo: f64,
    /// No piece is higher.
    pub hi: f64,
}

/// Ranges of all measures, from the poses of the family's tracks with the file's dimensions.
///
/// # Errors
/// The first pose that has no box, counted over all tracks.
pub fn enclose_measures(
    plan: &Plan,
    nominal: &Nominal,
) -> Result<Vec<MeasureBand>, (usize, Obstacle)> {
    sized!(plan.room_for(plan.dimensions.len()), N => measure_bands::<N>(plan, nominal))
}

fn measure_bands<const N: usize>(
    plan: &Plan,
    nominal: &Nominal,
) -> Result<Vec<MeasureBand>, (usize, Obstacle)> {
    let family = plan.family;
    let list = &family.measures.list;
    let rows = family.rows();
    let encloser = Encloser::new(family.system());
    let mut solver = PoseSolver::new(family.system());
    // Values of the formulas at the poses of every measure.
    let mut shown: Vec<Vec<Vec<AffineForm<N>>>> = list
        .iter()
        .map(|m| vec![Vec::new(); measure_formulas(m).len()])
        .collect();
    for (row, (_, poses)) in rows.iter().enumerate() {
        for index in poses.clone() {
            let enclosure = enclosed_pose::<N>(plan, &encloser, &mut solver, &nominal.poses[index]);
            let enclosure = enclosure.map_err(|obstacle| (index, obstacle))?;
            for (measure, values) in list.iter().zip(&mut shown) {
                if row_of(measure, rows.len()) == Some(row) {
                    for (formula, values) in measure_formulas(measure).iter().zip(values) {
                        values.push(enclosure.formula(formula));
                    }
                }
            }
        }
    }
    let mut numbers = plan_inputs::<N>(plan);
    let first = numbers.len();
    for (measure, values) in list.iter().zip(&shown) {
        let form = match &measure.source {
            MeasureSource::Formula(formula) => formula.value(&numbers),
            MeasureSource::Over { per: Some(_), .. } => AffineForm::undefined(),
            MeasureSource::Over { taking, power, .. } => taken_form(*taking, *power, values),
        };
        numbers.push(form);
    }
    let band = |form: &AffineForm<N>| {
        let Interval { lo, hi } = form.range();
        let Interval { lo, hi } = if form.is_finite() {
            Interval { lo, hi }
        } else {
            Interval::ENTIRE
        };
        MeasureBand { lo, hi }
    };
    Ok(numbers[first..].iter().map(band).collect())
}

/// The inputs at the start of the drive, the dimensions moving.
fn plan_inputs<const N: usize>(plan: &Plan) -> Vec<AffineForm<N>> {
    let family = plan.family;
    let unknowns = family.mechanism().unknowns.len();
    let start = family.actuation.inputs_at(0.0);
    let pose = [vec![0.0; unknowns], start.clone()].concat();
    let open = plan.input_open(&pose);
    let pairs = start.iter().zip(open);
    let mut inputs: Vec<AffineForm<N>> = pairs.map(|(v, e)| AffineForm::within(*v, e)).collect();
    for (k, tolerance) in plan.tolerances(&pose).iter().enumerate() {
        let input = &mut inputs[tolerance.slot - unknowns];
        *input = input.moving(k, tolerance.half_width);
    }
    inputs
}

/// The formulas that a measure takes over poses.
fn measure_formulas(measure: &Measure) -> &[Expression] {
    match &measure.source {
        MeasureSource::Over { of, per: None, .. } => of,
        _ => &[],
    }
}

/// Of `rows`, the one whose poses a measure is taken over: its track, or the drive behind them.
fn row_of(measure: &Measure, rows: usize) -> Option<usize> {
    match &measure.source {
        MeasureSource::Formula(_) => None,
        MeasureSource::Over { track, .. } => Some(track.unwrap_or(rows.saturating_sub(1))),
    }
}

/// One number of `values[formula][pose]`.
fn taken_form<const N: usize>(
    taking: Taking,
    power: f64,
    values: &[Vec<AffineForm<N>>],
) -> AffineForm<N> {
    let [Some(first), second] = [values.first(), values.get(1)] else {
        return AffineForm::undefined();
    };
    let (Some(begin), Some(end)) = (first.first(), first.last()) else {
        return AffineForm::undefined();
    };
    if !values.iter().flatten().all(|v| v.is_finite()) {
        return AffineForm::undefined();
    }
    let sum = || first.iter().fold(AffineForm::ZERO, |sum, v| sum + *v);
    match taking {
        Taking::First => *begin,
        Taking::Last => *end,
        Taking::Change => *end - *begin,
        Taking::Min => -greatest_form(first.iter().map(|v| -*v)),
        Taking::Max => greatest_form(first.iter().copied()),
        Taking::Range => {
            greatest_form(first.iter().copied()) + greatest_form(first.iter().map(|v| -*v))
        }
        Taking::Largest => greatest_form(first.iter().flat_map(|v| [*v, -*v])),
        Taking::Sum => sum(),
        Taking::Mean => sum() / AffineForm::number(first.len() as f64),
        Taking::Norm => power_norm(first, power),
        // The share of a polyline above zero has a kink wherever a value is zero.
        Taking::Positive => AffineForm::undefined(),
        Taking::Chord => match second {
            Some(second) => chord_deviation(first, second).0,
            None => AffineForm::undefined(),
        },
        Taking::Bow => match second {
            Some(second) => bow_height(first, second),
            None => AffineForm::undefined(),
        },
    }
}

/// The greatest of functions: the one that is so at δ = 0, and what others can exceed it by.
fn greatest_form<const N: usize>(
    list: impl Iterator<Item = AffineForm<N>> + Clone,
) -> AffineForm<N> {
    let best = list.clone().max_by(|a, b| a.value.total_cmp(&b.value));
    let Some(best) = best else {
        return AffineForm::undefined();
    };
    let excess = list.map(|form| (form - best).range().hi.max(0.0));
    let excess = excess.fold(0.0, f64::max);
    best + AffineForm::of_interval(Interval::new(0.0, excess * GROW))
}

/// (Σ |v|ᵖ)^(1/p)
fn power_norm<const N: usize>(values: &[AffineForm<N>], power: f64) -> AffineForm<N> {
    let p = AffineForm::number(power);
    let sum = values.iter().fold(AffineForm::ZERO, |sum, v| {
        let size = match v.is_below_zero() {
            Some(true) => -*v,
            Some(false) => *v,
            None => AffineForm::of_interval(Interval::new(0.0, v.magnitude())),
        };
        sum + size.power(p)
    });
    match power == 2.0 {
        true => sum.sqrt(),
        false => sum.real_power(1.0 / power),
    }
}

/// Distance from the first to the last point of a path, and the vector.
fn chord_deviation<const N: usize>(
    x: &[AffineForm<N>],
    y: &[AffineForm<N>],
) -> (AffineForm<N>, [AffineForm<N>; 2]) {
    match (x, y) {
        ([a, .., b], [c, .., d]) => {
            let (along, up) = (*b - *a, *d - *c);
            (along.hypot(up), [along, up])
        }
        _ => (AffineForm::undefined(), [AffineForm::undefined(); 2]),
    }
}

/// Signed distance from the chord of the point that is farthest from it.
fn bow_height<const N: usize>(x: &[AffineForm<N>], y: &[AffineForm<N>]) -> AffineForm<N> {
    let (length, [a, b]) = chord_deviation(x, y);
    let distance = |k: usize| ((y[k] - y[0]) * a - (x[k] - x[0]) * b) / length;
    let all: Vec<AffineForm<N>> = (0..x.len().min(y.len())).map(distance).collect();
    if !all.iter().all(|form| form.is_finite()) {
        return AffineForm::undefined();
    }
    let nominal = all
        .iter()
        .max_by(|p, q| p.value.abs().total_cmp(&q.value.abs()));
    let Some(nominal) = nominal else {
        return AffineForm::undefined();
    };
    // Those that may be the farthest of some piece.
    let least = |form: &AffineForm<N>| (form.value.abs() - form.deviation()).max(0.0);
    let needed = all.iter().map(least).fold(0.0, f64::max);
    let rivals = all.iter().filter(|form| form.magnitude() >= needed);
    let apart = rivals.map(|form| (*form - *nominal).magnitude());
    let apart = apart.fold(0.0, f64::max);
    *nominal + AffineForm::within(0.0, apart)
}
