//! The verbs on rows of dyads: their matrices and tables, and interval methods on them.

pub mod intervals;
pub mod row;
