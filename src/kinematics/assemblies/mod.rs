//! The assemblies of a mechanism at one pose of its inputs: starts of several kinds, and what they lead to without
//! repetition.
//!
//! A count, not a proof: an assembly that no start leads to stays unknown. The search goes on until an estimate of what is
//! unseen says that hardly a random start would lead to anything new (`search`).
//!
//! Two closures are the same **mode** when all links stand alike, whatever the angles are called: whole turns, the second
//! set of Euler angles of a ball joint, and the spin of a rod between two balls make no other mode. Modes in which the
//! bodies stand alike are one **placement** (`alike`). Singular closures that can be moved on are points of one
//! **continuous set**, a curve as a rule (`sets`).

mod alike;
mod names;
mod search;
mod sets;
mod walk;

pub use names::{Mode, Modes, StartKind, Tally};
pub use search::{DEFAULT_STARTS, UNSEEN, find_modes};
