//! Reports in words and as JSON.

pub mod events;
pub mod freedoms;
pub mod measures;
pub mod synthesis;
