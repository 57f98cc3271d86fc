//! Freedoms: ranks at random and closed poses, the structure that follows from them, mobility, and idle freedoms.
//!
//! Depends on `solve`, since closed poses decide on ranks.

pub mod analysis;
pub mod count;
pub mod generic_rank;
pub mod idle;
pub mod mobility;
pub mod twists;
