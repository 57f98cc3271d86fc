//! Matrices without a mechanism: lanes, elimination, pivoted QR, normal equations, singular values, ranks of sparse ones.

pub mod fronts;
pub mod gauss_jordan;
pub mod lanes;
pub mod normal_equations;
pub mod pivoted_qr;
mod ritz_pair;
pub mod singular_values;
pub mod sparse_lu;
pub mod svd;
