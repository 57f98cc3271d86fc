//! Picture files in: PNG, APNG and GIF as whole frames, in the order people count in. Draws and writes nothing.

pub mod film;
pub mod order;
mod picture;

pub use film::{FilmFrame, FilmReader, Plays};
pub use order::natural_order;
pub use picture::{ImportError, has_alpha, read_png};
