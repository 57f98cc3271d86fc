//! Numbers as tables print them: in the scene's unit, as the shortest decimal that reads back as the same f64.
//!
//! A table's `40` degrees is not the f64 that was computed with. Bounds that stand beside printed numbers count the
//! difference: of an input all its digits ([`printing_error`]), of everything else a bound ([`printing_unit`]).

use crate::numbers::constant::Constant;
use crate::numbers::double_double::DoubleDouble;
use crate::numbers::rounding::{GROW, SMALLEST, U};

/// How the inputs of a sample are read where its pose is proved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputReading {
    /// As the f64 they are, in radians: for those who compute with them.
    Numbers,
    /// As the decimals that a table prints: for those who read it.
    Decimals,
}

/// The f64 in a table: `unit` is what one of the scene's units is inside the program.
pub fn in_unit(value: f64, unit: Constant) -> f64 {
    value * (1.0 / unit.number())
}

/// The shortest decimal that reads back as the same number.
pub fn shortest_decimal(value: f64) -> String {
    let magnitude = value.abs();
    if magnitude != 0.0 && !(1e-4..1e15).contains(&magnitude) && value.is_finite() {
        format!("{value:e}")
    } else {
        format!("{value}")
    }
}

/// What the printed decimal says less `value`; zero for what is no number.
pub fn printing_error(value: f64, unit: Constant) -> f64 {
    let printed = in_unit(value, unit);
    let Some(size) = Constant::decimal(&shortest_decimal(printed.abs())) else {
        return 0.0;
    };
    let meant = if printed < 0.0 { -size } else { size } * unit;
    (meant - Constant::exact(value)).number()
}

/// The printed decimal is no farther from `value`: what the conversion loses, and half a unit in the last place of the
/// decimal.
pub fn printing_unit(value: f64, unit: Constant) -> f64 {
    let converted = unit.value() * in_unit(value, unit) - DoubleDouble::from(value);
    (converted.hi.abs() + U * value.abs() + SMALLEST) * GROW
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn numbers_read_back_exactly() {
        for value in [
            0.0,
            -0.1,
            1e-17,
            112.77081077023263,
            6.02e23,
            f64::MIN_POSITIVE,
            -1.5e15,
        ] {
            assert_eq!(shortest_decimal(value).parse::<f64>().unwrap(), value);
        }
    }

    /// The rest is that of 31 digits, and never above its bound; both are met.
    #[test]
    fn what_printing_leaves_out_is_known() {
        let degree = Constant::PI / Constant::exact(180.0);
        let mut closest = [0.0_f64; 2];
        for (k, unit) in [Constant::exact(1.0), degree].into_iter().enumerate() {
            for step in -500..500 {
                let value = f64::from(step) * 0.0137;
                let (rest, bound) = (printing_error(value, unit), printing_unit(value, unit));
                assert!(rest.abs() <= bound, "{value}: {rest:e} above {bound:e}");
                closest[k] = closest[k].max(rest.abs() / bound);
                assert!(bound <= 6.0 * U * value.abs() + 1e-300);
            }
        }
        assert!(closest.iter().all(|c| *c > 0.85), "{closest:?}");
        // 40 degrees, computed as anybody would, and the decimal 40.
        let forty = 40.0 * degree.number();
        let meant = (degree * Constant::exact(40.0) - Constant::exact(forty)).number();
        assert_eq!(printing_error(forty, degree), meant);
        assert_eq!(printing_error(0.5, Constant::exact(1.0)), 0.0);
        assert_eq!(printing_error(f64::NAN, degree), 0.0);
    }
}
