//! Contacts of two surfaces: translated into chains of lower pairs (`chains`), then into loops, equations and named
//! scalars of the mechanism (`closure`).

pub mod chains;
pub mod closure;
pub mod parallel;
