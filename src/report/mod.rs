//! Results in words, as tables and as documents: text, CSV, JSON, JUnit. Nothing is printed here.

pub mod assemblies;
pub mod cells;
pub mod check;
pub mod clearance;
mod clearance_json;
pub mod closure;
pub mod enclosure;
pub mod enclosure_stretches;
pub mod events;
pub mod freedoms;
pub mod inputs_box;
pub mod iterates;
pub mod junit;
pub mod measures;
pub mod motion_check;
pub mod optimum;
pub mod precision;
pub mod proof;
pub mod rounded;
pub mod schema;
pub mod sensitivity;
pub mod sentences;
pub mod synthesis;
pub mod synthesis_document;
pub mod table;
pub mod tolerance;
pub mod verdict;
