//! The verbs on studies: sensitivity, tolerance, optimisation, synthesis, accuracy, sweeps and their units.

pub mod accuracy;
pub mod enclose;
mod found_files;
pub mod optimise;
pub mod pairs;
mod row_file;
pub mod search_film;
pub mod search_map;
pub mod search_paths;
pub mod sensitivity;
pub mod submit;
pub mod sweep;
mod sweep_plot;
pub mod synthesise;
mod target;
pub mod tolerance;
mod tolerance_units;
pub mod units;
