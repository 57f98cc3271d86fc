//! Motions: poses, rates, events and endings against references that are not ours.

mod accuracy;
mod bars;
mod change_points;
mod contacts;
mod dense_nets;
mod derived_outputs;
mod driven_excursions;
mod dyads;
mod endings;
mod excursions;
mod fold_rates;
mod gimbal;
mod hard_cases;
mod hard_motions;
mod hard_rows;
mod kinks;
mod limit_positions;
mod motion_events;
mod random_starts;
mod rates;
mod singular_starts;
mod solve_references;
mod sources;
mod torus_figures;
mod unlike_lengths;
mod whole_measures;
