//! Contacts of two surfaces: as chains of lower pairs (`chains`), then as loops, equations and named scalars of the
//! mechanism (`closure`).

pub mod chains;
pub mod closure;
pub mod parallel;
