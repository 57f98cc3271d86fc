//! Results in words, as tables and as documents: text, CSV, JSON, JUnit. Nothing is printed here.

pub mod cells;
pub mod clearance;
pub mod events;
pub mod freedoms;
pub mod iterates;
pub mod measures;
pub mod precision;
pub mod proof;
pub mod sensitivity;
pub mod sentences;
pub mod synthesis;
pub mod table;
