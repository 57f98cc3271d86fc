//! Finding and reading what a verb works on: scenes, tables of inputs, studies.

mod cells;
pub mod inputs_table;
pub mod intervals;
pub mod mode;
mod named_table;
pub mod patterns;
pub mod planned;
pub mod pose;
pub mod scene;
pub mod study;
pub mod sweep;
pub mod target_table;
pub mod tolerance;
