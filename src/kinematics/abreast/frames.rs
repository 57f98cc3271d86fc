//! Frames in eight lanes: fixed steps of a chain, and the residual of a slightly rotated loop.

use crate::model::walk::{Triple, WalkFrame};
use crate::numbers::octet::Octet;
use glam::{DMat3, DVec3};

/// Largest squared sine of a loop's rotation for which the rotation vector is computed by a short series: 0.05 rad, the
/// largest correction. Beyond it a lane has no residual.
const LARGEST_SQUARE: f64 = 2.5e-3;

/// asin(s)/s by powers of s²; the truncation error is below 1e-17.
const ASIN: [f64; 6] = [
    1.0,
    1.0 / 6.0,
    3.0 / 40.0,
    5.0 / 112.0,
    35.0 / 1152.0,
    63.0 / 2816.0,
];

/// The factor of P² in the inverse left Jacobian by powers of the squared angle, with the same error.
const LEFT: [f64; 4] = [1.0 / 12.0, 1.0 / 720.0, 1.0 / 30_240.0, 1.0 / 1_209_600.0];

/// Moves a frame by a fixed vector; most have one entry that is not zero.
#[inline(always)]
pub(super) fn shift_frame(frame: &mut WalkFrame<Octet>, by: &DVec3) {
    for (axis, factor) in frame.axes.iter().zip(by.to_array()) {
        if factor != 0.0 {
            for (own, c) in frame.origin.iter_mut().zip(axis) {
                *own += *c * factor;
            }
        }
    }
}

/// Turns a frame by a fixed rotation; most have entries that are zero.
#[inline(always)]
pub(super) fn turn_frame(frame: &mut WalkFrame<Octet>, by: &DMat3) {
    let before = frame.axes;
    for (own, column) in frame.axes.iter_mut().zip(by.to_cols_array_2d()) {
        *own = [Octet::ZERO; 3];
        for (axis, factor) in before.iter().zip(column) {
            // The same factors in all lanes, so that zeros can be left out.
            if factor != 0.0 {
                for (sum, c) in own.iter_mut().zip(axis) {
                    *sum += *c * factor;
                }
            }
        }
    }
}

/// The rotation vector of a slightly rotated frame; NaN for larger rotations.
#[inline(always)]
pub(super) fn turn_of(axes: &[Triple<Octet>; 3]) -> Triple<Octet> {
    let [x, y, z] = axes;
    let mut skew = [y[2] - z[1], z[0] - x[2], x[1] - y[0]];
    skew.iter_mut().for_each(|s| *s = *s * 0.5);
    let square = dot_product(&skew, &skew);
    // The cosine distinguishes a small rotation from one beyond a right angle.
    let cos = x[0] + y[1] + z[2] - Octet::splat(1.0);
    let is_small = square.at_most(Octet::splat(LARGEST_SQUARE));
    let is_small = is_small.and(Octet::ZERO.at_most(cos));
    let factor = is_small.choose(evaluate_polynomial(&ASIN, square), Octet::splat(f64::NAN));
    skew.iter_mut().for_each(|s| *s = *s * factor);
    skew
}

/// I - P/2 + c P², with P the cross-product matrix of a short rotation vector; rows.
#[inline(always)]
pub(super) fn left_jacobian_inverse(turn: &Triple<Octet>) -> [Triple<Octet>; 3] {
    let square = dot_product(turn, turn);
    let c = evaluate_polynomial(&LEFT, square);
    let rest = Octet::splat(1.0) - c * square;
    let mut rows = [[Octet::ZERO; 3]; 3];
    for (i, row) in rows.iter_mut().enumerate() {
        // P² = φ φᵀ - |φ|² I.
        for (j, entry) in row.iter_mut().enumerate() {
            *entry = c * (turn[i] * turn[j]);
        }
        row[i] += rest;
        // The off-diagonal entries of -P/2 are half the other two components, with either sign.
        row[(i + 1) % 3] += turn[(i + 2) % 3] * 0.5;
        row[(i + 2) % 3] -= turn[(i + 1) % 3] * 0.5;
    }
    rows
}

#[inline(always)]
fn evaluate_polynomial<const N: usize>(coefficients: &[f64; N], x: Octet) -> Octet {
    let highest_first = coefficients.iter().rev();
    highest_first.fold(Octet::ZERO, |sum, c| sum * x + Octet::splat(*c))
}

#[inline(always)]
fn dot_product(a: &Triple<Octet>, b: &Triple<Octet>) -> Octet {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
