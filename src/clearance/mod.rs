//! Clearance: signed distances of solids, their smallest values over the motion with a bound, and the pairs that may touch.
//!
//! Functions take and return values; nothing prints.

mod asked;
mod branch_and_bound;
mod broad_phase;
pub mod check;
pub mod closer;
mod contact;
pub mod covered;
mod covering;
mod curved;
mod excluded;
pub mod extremes;
mod followed;
mod found;
mod gap;
pub mod inputs_box;
mod joint_locus;
mod joint_region;
mod line_turn;
mod look;
pub mod measured;
pub mod meeting;
pub mod mesh_cut;
mod mesh_faults;
mod mesh_meeting;
pub mod motion;
mod near_part;
pub mod neighbours;
mod one_joint;
mod pair_look;
pub mod part;
mod piece_corners;
pub mod piece_gap;
mod relative;
mod slab;
pub mod sweep;
pub mod sweep_and_prune;
pub mod swept;
pub mod touching;
mod track;
mod undefined;
mod violations;
