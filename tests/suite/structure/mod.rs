//! What a mechanism is before it moves: joints, mobility, modes of assembly, redundant equations.

mod fixed_poses;
mod formal_modes;
mod joint_bodies;
mod matrices;
mod mobility;
mod models;
mod modes;
mod redundant;
mod walks;
