//! Sweeps, tolerances, sensitivities, optimisation and synthesis.

mod abreast;
mod dead_centres;
mod frozen;
mod jacobians;
mod kept_limits;
mod kinked;
mod pose_groups;
mod search_pictures;
mod studies;
mod study_verbs;
mod synthesis;
mod targets;
mod verdicts;
