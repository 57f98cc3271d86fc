//! The verbs on rows of dyads: their matrices and tables, and what intervals make of them.

pub mod intervals;
pub mod row;
