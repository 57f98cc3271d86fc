//! The assemblies of a mechanism for given inputs: several kinds of starts, and the distinct solutions that they lead to.
//!
//! This is a count, not a proof: an assembly that no start leads to remains unknown. The search continues until an estimate
//! says that a random start would hardly lead to anything new (`search`).
//!
//! Two solutions are the same **mode** if all links have the same placement, whatever their angles: full turns, the second
//! set of Euler angles of a ball joint, and the spin of a rod between two balls make no new mode. Modes in which the
//! bodies have the same placement are one **placement** (`alike`). Singular solutions that can be moved continuously are
//! points of one **continuous set**, usually a curve (`sets`).

mod alike;
mod merged;
mod names;
mod search;
mod sets;
mod walk;

pub use names::{Mode, Modes, StartKind, StartResults};
pub use search::{DEFAULT_STARTS, UNSEEN, find_modes};
