//! Sweeps, tolerances, sensitivities, optimisation and synthesis.

mod studies;
mod study_verbs;
mod synthesis;
