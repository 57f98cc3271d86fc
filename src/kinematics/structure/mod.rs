//! Which loops and equations are solved together, in which order, and how a block is laid out for evaluation.

pub mod block;
pub mod columns;
pub mod empty_equations;
pub mod layout;
pub mod loop_part;
pub mod ordering;
pub mod planned_quadratic;
pub mod proof_chain;
pub mod proof_plan;
pub mod system;
