//! Many designs of one mechanism, one row each: the designs, their rows, and the rows as tables.
//!
//! A row depends only on the scene and the number of the design: not on the rows before it, on threads, or on the division
//! of the work.

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
