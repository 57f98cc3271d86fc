//! The formula language of scene files: tokens, expressions, and products of transforms.
//!
//! It is our own because chains and arguments are one language, messages need the position of every name in the file,
//! and the engine needs affine arguments and exact derivatives of the same tree.

mod advice;
pub mod chain;
pub mod compile;
pub mod expansion;
pub mod expression;
pub mod kinds;
pub mod lexer;
pub mod node;
pub mod products;
pub mod written;
