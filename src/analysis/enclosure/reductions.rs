//! The reductions of measures (maximum, range, length …) along a track, with derivatives.

use super::tracked::Tracked;
use crate::model::measure::Taking;
use crate::numbers::affine_form::AffineForm;
use crate::numbers::interval::Interval;
use crate::numbers::rounding::GROW;
use crate::numbers::scalar::{Ring, Scalar};

/// One number of `values[formula][pose]`, which depend on `count` dimensions.
pub(super) fn taken_number<'r>(
    taking: Taking,
    power: f64,
    values: &[Vec<Tracked<'r>>],
    count: usize,
) -> Tracked<'r> {
    let unknown = || Tracked::undefined(count);
    let [Some(first), second] = [values.first(), values.get(1)] else {
        return unknown();
    };
    let (Some(begin), Some(end)) = (first.first(), first.last()) else {
        return unknown();
    };
    if !values.iter().flatten().all(|v| v.form.is_finite()) {
        return unknown();
    }
    let opposite = || first.iter().map(Tracked::negative);
    let sum = || (first[1..].iter()).fold(begin.clone(), |sum, v| sum.plus(v));
    match taking {
        Taking::First => begin.clone(),
        Taking::Last => end.clone(),
        Taking::Change => end.minus(begin),
        Taking::Min => greatest_of(&opposite().collect::<Vec<_>>()).negative(),
        Taking::Max => greatest_of(first),
        Taking::Range => greatest_of(first).plus(&greatest_of(&opposite().collect::<Vec<_>>())),
        Taking::Largest => {
            let both: Vec<Tracked<'r>> = first.iter().cloned().chain(opposite()).collect();
            greatest_of(&both)
        }
        Taking::Sum => sum(),
        Taking::Mean => {
            let share = AffineForm::number(1.0) / AffineForm::number(first.len() as f64);
            let sum = sum();
            Tracked::through(sum.form * share, &[(share, &sum)])
        }
        Taking::Norm => power_norm(first, power),
        // The positive share of a polyline has a kink where a value is zero.
        Taking::Positive => unknown(),
        Taking::Chord => match second {
            Some(second) => chord(first, second).map_or_else(unknown, |(length, _)| length),
            None => unknown(),
        },
        Taking::Bow => match second {
            Some(second) => bow_height(first, second).unwrap_or_else(unknown),
            None => unknown(),
        },
    }
}

/// The maximum of functions: the one that is greatest at δ = 0, and by how much others can exceed it.
fn greatest_of<'r>(list: &[Tracked<'r>]) -> Tracked<'r> {
    let best = list
        .iter()
        .max_by(|a, b| a.form.value.total_cmp(&b.form.value));
    let Some(best) = best else {
        return Tracked::undefined(0);
    };
    // The maximum is the form of the largest nominal value plus what any other can exceed it by.
    let others = || list.iter().filter(|other| !std::ptr::eq(*other, best));
    let beyond = |other: &Tracked<'r>| (other.form - best.form).range().hi;
    let excess = others().map(beyond).fold(0.0, f64::max);
    let form = match excess > 0.0 {
        true => best.form + AffineForm::of_interval(Interval::new(0.0, excess * GROW)),
        false => best.form,
    };
    best.rivalled(form, others().filter(|other| beyond(other) >= 0.0))
}

/// (Σ |v|ᵖ)^(1/p)
fn power_norm<'r>(values: &[Tracked<'r>], power: f64) -> Tracked<'r> {
    let (p, less) = (AffineForm::number(power), AffineForm::number(power - 1.0));
    let raised = |v: &Tracked<'r>| {
        // |v| where the sign is known; otherwise the range of the magnitude, and a slope between 0 and 1.
        let (size, sign) = match v.form.is_below_zero() {
            Some(true) => (-v.form, AffineForm::number(-1.0)),
            Some(false) => (v.form, AffineForm::number(1.0)),
            None => {
                let size = AffineForm::of_interval(Interval::new(0.0, v.form.magnitude()));
                (size, AffineForm::within(0.0, 1.0))
            }
        };
        let slope = p * size.power(less) * sign;
        Tracked::through(size.power(p), &[(slope, v)])
    };
    let count = values.first().map_or(0, |v| v.rates.len());
    let zero = Tracked {
        form: AffineForm::ZERO,
        rates: vec![AffineForm::ZERO; count],
    };
    let sum = values.iter().fold(zero, |sum, v| sum.plus(&raised(v)));
    // The root of the sum, with its slope by the chain rule.
    let root = match power == 2.0 {
        true => sum.form.sqrt(),
        false => sum.form.real_power(1.0 / power),
    };
    let slope = root / (p * sum.form);
    Tracked::through(root, &[(slope, &sum)])
}

/// Distance from the first to the last point of a path, and the vector.
fn chord<'r>(x: &[Tracked<'r>], y: &[Tracked<'r>]) -> Option<(Tracked<'r>, [Tracked<'r>; 2])> {
    match (x, y) {
        ([a, .., b], [c, .., d]) => {
            let (along, up) = (b.minus(a), d.minus(c));
            Some((along.hypotenuse(&up), [along, up]))
        }
        _ => None,
    }
}

/// Signed distance from the chord to the point farthest from it.
fn bow_height<'r>(x: &[Tracked<'r>], y: &[Tracked<'r>]) -> Option<Tracked<'r>> {
    let (length, [a, b]) = chord(x, y)?;
    let distance = |k: usize| {
        let across = y[k].minus(&y[0]).times(&a);
        let along = x[k].minus(&x[0]).times(&b);
        across.minus(&along).over(&length)
    };
    let all: Vec<Tracked<'r>> = (0..x.len().min(y.len())).map(distance).collect();
    if !all.iter().all(|number| number.form.is_finite()) {
        return None;
    }
    let size = |number: &Tracked<'r>| number.form.value.abs();
    let nominal = all.iter().max_by(|p, q| size(p).total_cmp(&size(q)))?;
    // The points that may be the farthest for some piece.
    let least = |number: &Tracked<'r>| (size(number) - number.form.deviation()).max(0.0);
    let needed = all.iter().map(least).fold(0.0, f64::max);
    let rivals = || {
        let others = all.iter().filter(|other| !std::ptr::eq(*other, nominal));
        others.filter(|number| number.form.magnitude() >= needed)
    };
    let apart = rivals().map(|number| (number.form - nominal.form).magnitude());
    let apart = apart.fold(0.0, f64::max);
    let form = nominal.form + AffineForm::within(0.0, apart);
    // If all are on one side of the chord, the maximum is continuous; from one side to the other it jumps.
    let side = nominal.form.is_below_zero();
    let on_one_side = side.is_some() && rivals().all(|rival| rival.form.is_below_zero() == side);
    Some(match on_one_side {
        true => nominal.rivalled(form, rivals()),
        false => Tracked::without_rates(form, nominal.rates.len()),
    })
}
