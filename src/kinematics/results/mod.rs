//! Result types of solving and proving.

pub mod certificate;
pub mod columns;
pub mod passed;
pub mod printed;
pub mod trajectory;
