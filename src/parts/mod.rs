//! Studies in parts: work on numbered items that is divided into units, processed anywhere in any order, and merged to
//! the same bytes.
//!
//! Independent of mechanisms: an item is a row of numbers that is the same wherever it is computed. A study is a folder:
//! `plan.json` describes the work, `parts/` contains a file for every finished unit, `leases/` one for every unit that
//! a worker is processing. A part is never incomplete; a lease only saves time and decides nothing.

pub mod error;
pub mod folder;
pub mod identity;
mod lease;
pub mod merge;
mod part;
pub mod plan;
pub mod ranges;
mod stored;
pub mod work;

pub use error::PartsError;
