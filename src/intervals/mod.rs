//! Interval linear systems A x = b: Kaucher arithmetic, solution sets for any choice of quantifiers, formal solutions,
//! and boxes inside and around the sets; and the sequence of dyads whose velocities are the solution of such a system.
//!
//! Whether a point or a box belongs to a set is decided with outward rounding; hulls and best centres are computed by
//! linear programmes in plain f64 and are no bounds. After S. P. Shary (Reliable Computing 8, 2002; the
//! subdifferential Newton method: SIAM J. Numer. Anal. 32, 1995) and the Russian source of the scene `dyads`.

pub mod auxiliary;
pub mod centre;
pub mod chain;
pub mod dyad;
pub mod formal;
pub mod hull;
pub mod kaucher;
pub mod paving;
pub mod peeling;
pub mod regular;
mod simplex;
pub mod sweep;
pub mod system;

pub use kaucher::Kaucher;
pub use system::{IntervalSystem, Quantifier};
