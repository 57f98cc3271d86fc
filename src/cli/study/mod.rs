//! The verbs on studies: sensitivity, tolerance, optimisation, synthesis, accuracy.

pub mod accuracy;
pub mod enclose;
pub mod optimise;
pub mod pairs;
pub mod search_film;
pub mod sensitivity;
pub mod synthesise;
pub mod tolerance;
