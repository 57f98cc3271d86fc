//! Round lengths of grids and scales.

/// The nearest of 1, 2, 5 times a power of ten.
pub fn nearest_round_length(step: f64) -> f64 {
    if !(step.is_finite() && step > 0.0) {
        return 0.0;
    }
    let power = libm::pow(10.0, libm::log10(step).floor());
    let mantissa = step / power;
    let rounded = [1.0, 2.0, 5.0, 10.0].into_iter().min_by(|a, b| {
        let far = |x: &f64| libm::log(x / mantissa).abs();
        far(a).total_cmp(&far(b))
    });
    power * rounded.unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grid_steps_are_round() {
        for (step, round) in [(97.0, 100.0), (3.0, 2.0), (0.06, 0.05), (8.0, 10.0)] {
            assert!(
                (nearest_round_length(step) - round).abs() < 1e-12 * round,
                "{step} {}",
                nearest_round_length(step)
            );
        }
        assert_eq!(nearest_round_length(0.0), 0.0);
    }
}
