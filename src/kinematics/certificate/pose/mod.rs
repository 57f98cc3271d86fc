//! The proof of a single pose: residual in double-double, Jacobian, and the Newton-Kantorovich test.

pub mod block_rows;
pub mod chain;
mod equation;
pub mod kantorovich;
mod lane_rows;
pub mod product;
pub mod prover;
