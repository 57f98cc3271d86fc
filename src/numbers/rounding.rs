//! Rounding errors of single operations: the constants used by all proofs. The errors of sums and series are derived
//! where they are computed.
//!
//! Arithmetic is IEEE 754 in double precision, to nearest. Only three things are assumed: that operations and square
//! roots are rounded correctly, that functions of `libm` are accurate to one unit in the last place, and that numbers
//! read from tables are those as written to one unit in the last place, exactly if they are whole. Constants of a scene
//! are read and folded with 31 digits: see [`constant`](super::constant).

/// Unit roundoff: an operation returns the exact result times 1 + e, |e| ≤ U.
pub const U: f64 = f64::EPSILON / 2.0;

/// One operation, doubled so that the rounding of the bound itself is covered. Also a unit in the last place, relative to
/// the smallest number that has such a unit.
pub const OPERATION: f64 = 2.0 * U;

/// Relative error of a number that was rounded to f64 and is not whole: one unit in the last place.
pub const DECIMAL: f64 = 2.0 * U;

/// An operation with sums of two f64, relative.
pub const LONG_OPERATION: f64 = 1.0 / (1u128 << 99) as f64;

/// A function of such a sum, relative to a value of about one.
pub const LONG_FUNCTION: f64 = 1e-28;

/// Error of a product close to underflow: a few of the smallest numbers of f64.
pub const SMALLEST: f64 = 1e-322;

/// Relative widening of an interval after one operation: U, and U² for the widening itself, rounded up.
pub const WIDENING: f64 = 2.3e-16;

/// Relative widening after a function of `libm`: one unit in the last place is at most 2 U of the value (2.23e-16), and the
/// same for the widening itself.
pub const FUNCTION_WIDENING: f64 = 4.7e-16;

/// Covers underflow in a product. Large enough to avoid slow subnormal numbers.
pub const UNDERFLOW: f64 = 1e-200;

/// Error of sums of up to nine thousand terms, relative to the sum of their magnitudes: every term takes part in at
/// most that many operations.
pub const SUMS: f64 = 1e-12;

/// Compensates the rounding of sums of positive terms in bounds themselves.
pub const GROW: f64 = 1.0 + SUMS;

/// The same for bounds from below.
pub const SHRINK: f64 = 1.0 - SUMS;

/// Error of a sine or a cosine of [`super::sin_cos`], and so of the angle they represent (radians): only the rest's
/// cube over six matters, computed in f64 to five units in the last place.
pub const SIN_COS: f64 = 4e-21;

/// Rounding of one step of a product with 23 digits (radians, sizes): each of six entries loses at most 11 × 2^-80, a
/// translation no more of itself.
pub const LONG_STEP: f64 = 3e-23;

/// One factor of a chain in f64, or one step of a distance behind it (radians; lengths, relative to the chain's): an entry
/// loses at most a unit of its sine (2 U), two products and two sums, and as much once more for what it carries on.
pub const CHAIN_FACTOR: f64 = 9.0 * U;

/// The Newton-Kantorovich discriminant, relative to (1 - q)²: nine operations at most, including eta's last sum.
pub const DISCRIMINANT: f64 = 16.0 * U;

/// A joint's column of a Jacobian in f64, relative: a dozen operations on numbers that carry its last bit.
pub const COLUMN: f64 = 64.0 * U;

/// A derivative of a formula in f64, relative to its terms: a few operations on numbers that carry its last bit.
pub const SLOPE: f64 = 16.0 * U;

/// Up to here every whole number is one of f64.
const LARGEST_WHOLE: f64 = (1u64 << 53) as f64;

/// Whether a number that was rounded to f64 is exact: whole numbers are, as long as f64 has them all.
#[inline]
pub const fn is_exact(value: f64) -> bool {
    // The conversion is faster than a call that rounds.
    value as i64 as f64 == value && value.abs() <= LARGEST_WHOLE
}

/// Bound on the difference between a number that was rounded to f64 and the number as written.
#[inline]
pub const fn of_decimal(value: f64) -> f64 {
    if is_exact(value) {
        0.0
    } else {
        DECIMAL * value.abs()
    }
}

/// The largest of `values`, none of which is negative; NaN if one of them is.
pub fn largest_or_nan(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |a: f64, b| if b.is_nan() || b > a { b } else { a })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_are_exact_as_long_as_there_are_all() {
        for value in [0.0, -0.0, 1.0, -7.0, LARGEST_WHOLE] {
            assert_eq!(of_decimal(value), 0.0);
        }
        // 2^53 + 1 and 1e23 are none of f64.
        for value in [0.1, 2.5, 2.0 * LARGEST_WHOLE, 1e23, f64::INFINITY, f64::NAN] {
            assert!(!is_exact(value), "{value}");
        }
        assert_eq!(of_decimal(-0.5), f64::EPSILON / 2.0);
    }
}
