//! What solving and proving give, as values.

pub mod certificate;
pub mod columns;
pub mod trajectory;
