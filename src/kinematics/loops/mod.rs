//! Residuals and Jacobians of loops, and the plain products that check them.

pub mod enclosed;
pub mod forward;
pub mod joint_lanes;
pub mod observed;
pub mod residual;
