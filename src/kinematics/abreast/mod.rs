//! Eight designs of one structure solved side by side: the same blocks in the same order, other numbers in every lane.
//!
//! Every design begins beside a known pose, the [`Anchor`](anchor::Anchor): of it the order of elimination is taken, and
//! against its Jacobians a closed pose is shown to be regular and on the same side of all singular ones. What does not
//! go smoothly leaves its lane and is left to [`PoseSolver`](super::solve::pose_solver::PoseSolver); nothing is ever taken
//! from a neighbour, so that the bits of a design do not depend on its company.

pub mod anchor;
mod block_values;
pub mod closing;
mod factors;
pub mod following;
mod frames;
mod pivoting;
