//! The joints and links of a mechanism: one table, made once while resolving, that everybody reads.
//!
//! A chain is a product of elementary motions. What these are as joints is decided here and nowhere else:
//!
//! * A **link** is what moves as one rigid part. Positions in different chains lie on one link when the motions from the
//!   world to them are the same, by the chains or by closed loops (`links`).
//! * A **joint** is what connects two links: one elementary motion (revolute, prismatic), or a run of two or three of
//!   them (`pairs`). A run is one joint only if no body's frame and no loop ends between its motions, nothing else
//!   branches off there, and its coordinates stand nowhere else: not in an equation, not in another joint. A coordinate that
//!   does so tells single angles apart, and with them the parts between.
//! * **Inputs** may take part. That a drive moves an axis of a universal joint does not part the two bodies that it
//!   connects. Where runs compete for a motion, those of unknowns come first.
//!
//! Loops that close in a point (a contact of surfaces) join no links: nothing is known of how their ends are turned.

mod anchors;
mod folding;
mod joint;
mod links;
mod motions;
mod pairs;
mod table;

pub use joint::{EXACT, Joint, JointKind, Joints, Link, LinkFrame, Passage, RoutePart};

#[cfg(test)]
mod tests;
