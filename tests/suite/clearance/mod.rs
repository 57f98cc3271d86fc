//! Distances of shapes, at poses and over motions, and what `check` says of them.

mod broad_phase;
mod clearance_cli;
mod clearance_half_space;
mod clearance_mesh_motion;
mod clearance_meshes;
mod clearance_motion;
mod clearance_pairs;
mod clearance_parry;
mod clearance_reference;
mod clearance_scenes;
mod clearance_times;
mod deep_clearances;
mod distances;
mod envelopes;
mod estimates;
mod exclusions;
mod gate;
mod grazing;
mod joint_jumps;
mod joint_meshes;
mod mesh_shells;
mod narrow_gaps;
mod neighbour_scenes;
mod random_clearances;
mod random_drives;
mod told_bounds;
