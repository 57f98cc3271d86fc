//! The formula language of scene files: tokens, expressions, and products of transforms.
//!
//! Own rather than a crate's, because chains and arguments are one language, every name needs its place in the
//! file for the messages, and the engine wants affine arguments and exact derivatives out of the same tree.

pub mod chain;
pub mod compile;
pub mod expansion;
pub mod expression;
pub mod kinds;
pub mod lexer;
pub mod node;
pub mod written;
