//! The walls of the house: which room may use which rooms and which libraries, that no files go round in a circle,
//! how large files get, that each says what it holds.

mod bounds;
mod face;
mod graph;
mod lock;
mod names;
mod paths;
mod rooms;
pub mod source;
mod walls;
