//! Finding and reading what a verb works on: scenes, tables of inputs, studies.

pub mod inputs_table;
pub mod mode;
pub mod scene;
pub mod study;
