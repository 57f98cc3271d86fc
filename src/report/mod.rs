//! Results as tables and documents: CSV, JSON, JUnit. Nothing is solved here, and nothing printed.

pub mod clearance;
pub mod events;
pub mod iterates;
pub mod precision;
pub mod table;
