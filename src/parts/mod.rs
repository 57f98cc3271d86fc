//! Studies in parts: work on numbered items that is cut into units, done anywhere in any order, and put together again to
//! the same bytes.
//!
//! Knows no mechanism: an item gives a row of numbers, and the same row wherever it is made. A study is a folder:
//! `plan.json` says what is done, `parts/` holds a file for every unit that is done, `leases/` one for every unit that
//! somebody works on. A part exists whole or not at all; a lease saves time and decides nothing.

pub mod error;
pub mod folder;
pub mod identity;
mod lease;
pub mod merge;
mod part;
pub mod plan;
pub mod ranges;
pub mod work;

pub use error::PartsError;
