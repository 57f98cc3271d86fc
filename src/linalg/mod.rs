//! Matrices without a mechanism: lanes, elimination, pivoted QR, singular values, ranks of sparse ones.

pub mod fronts;
pub mod gauss_jordan;
pub mod lanes;
pub mod pivoted_qr;
pub mod singular_values;
pub mod sparse_lu;
pub mod svd;
