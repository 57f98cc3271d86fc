//! The mechanism as resolved: immutable, without names to look up or units to convert.

pub mod shape;
