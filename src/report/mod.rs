//! Results as tables and documents: CSV, JSON, JUnit. Nothing is solved here, and nothing printed.

pub mod cells;
pub mod clearance;
pub mod events;
pub mod iterates;
pub mod precision;
pub mod sensitivity;
pub mod table;
