//! Rows of numbers four lanes at a time: a few groups taken out, added up, put back.

use crate::linalg::lanes::{Lanes, all_lanes};
use wide::f64x4;

/// `G` groups of a row.
#[inline(always)]
pub(super) fn row_part<const G: usize>(row: &[Lanes], first: usize) -> [f64x4; G] {
    let mut groups = [f64x4::ZERO; G];
    for (group, lanes) in groups.iter_mut().zip(&row[first..first + G]) {
        *group = f64x4::new(*lanes);
    }
    groups
}

/// Puts groups back into a row.
#[inline(always)]
pub(super) fn put_groups<const G: usize>(row: &mut [Lanes], first: usize, groups: [f64x4; G]) {
    for (lanes, group) in row[first..first + G].iter_mut().zip(groups) {
        *lanes = group.to_array();
    }
}

/// Adds a multiple of groups to those of a row.
#[inline(always)]
pub(super) fn add_part<const G: usize>(
    row: &mut [Lanes],
    first: usize,
    add: &[f64x4; G],
    factor: f64,
) {
    for (lanes, group) in row[first..first + G].iter_mut().zip(add) {
        *lanes = (f64x4::new(*lanes) + *group * all_lanes(factor)).to_array();
    }
}

/// `sums += factor · |groups|`.
#[inline(always)]
pub(super) fn add_sizes<const G: usize>(sums: &mut [f64x4; G], groups: &[f64x4; G], factor: f64) {
    for (sum, group) in sums.iter_mut().zip(groups) {
        *sum += group.abs() * all_lanes(factor);
    }
}
