//! Eight designs of one structure solved in SIMD lanes: the same blocks in the same order, with different numbers in every
//! lane.
//!
//! Every design starts near a known pose, the [`AnchorPose`](anchor::AnchorPose). The anchor provides the order of
//! elimination, and a comparison with its Jacobians shows that a closed pose is regular and on the same side of all singular
//! poses. A design that does not converge regularly leaves its lane and is solved by
//! [`PoseSolver`](super::solve::pose_solver::PoseSolver). Lanes exchange no data, so that the bits of a design do not depend
//! on its neighbours.

pub mod anchor;
mod block_values;
pub mod closing;
mod factors;
pub mod following;
mod frames;
mod linearised;
mod pivoting;
pub mod pose_group;
mod prediction;
