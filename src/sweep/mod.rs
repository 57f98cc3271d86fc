//! Many designs of one mechanism, one row each: which designs, what becomes of every one of them, and the rows as tables.
//!
//! A row depends on the scene, the design's number and nothing else: not on the rows before it, on threads, or on how
//! the work is cut.

mod abreast;
pub mod design;
pub mod design_text;
mod permutation;
mod posing;
mod reread;
pub mod row;
pub mod rows;
mod sobol;
pub mod summary;
pub mod swept_scene;
pub mod table;
