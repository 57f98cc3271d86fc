//! Angles that begin anew after a turn: there a curve is interrupted.

/// Whether an angle begins anew, a turn less or more, between a value and the one before: the step is more than half a turn, but
/// not without that turn, as a step beside it. An angle that turns fast has no such place.
pub(super) fn is_wrap(value: impl Fn(usize) -> Option<f64>, place: usize, half_turn: f64) -> bool {
    let step = |place: usize| Some(value(place)? - value(place.checked_sub(1)?)?);
    let Some(own) = step(place).filter(|own| own.abs() > half_turn) else {
        return false;
    };
    let beside = [place.checked_sub(1).and_then(step), step(place + 1)];
    let beside = beside.into_iter().flatten();
    let Some(usual) = beside.min_by(|a, b| a.abs().total_cmp(&b.abs())) else {
        return true;
    };
    let turned = own - (2.0 * half_turn).copysign(own);
    turned.abs() <= half_turn && usual.abs() <= half_turn
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_wrap_where_a_turn_is_lost_and_nowhere_else() {
        let wrapped = |rate: f64| move |k: usize| ((rate * k as f64 + 170.0) % 360.0) - 180.0;
        let fast = |k: usize| 800.0 * k as f64;
        let swift = |k: usize| 9000.0 * (0.3 * k as f64).sin();
        let count = |at: &dyn Fn(usize) -> f64| {
            let value = |k: usize| (k < 100).then(|| at(k));
            (1..100).filter(|k| is_wrap(value, *k, 180.0)).count()
        };
        assert_eq!(count(&wrapped(7.0)), 2);
        assert_eq!(count(&wrapped(100.0)), 27);
        assert_eq!(count(&wrapped(-7.0)), 1);
        assert_eq!(count(&fast), 0);
        assert_eq!(count(&swift), 0);
    }
}
