//! Sweeps, tolerances, sensitivities, optimisation and synthesis.

mod abreast;
mod search_pictures;
mod studies;
mod study_verbs;
mod synthesis;
mod targets;
