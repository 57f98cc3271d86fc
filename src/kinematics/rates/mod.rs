//! Derivatives of closed poses: rates of any order by time or by an input, and mixed second derivatives.

pub mod higher_order;
pub mod variation;
