//! Picture files in: PNG row by row, APNG and GIF frame by frame, in the order people count in. Draws and writes nothing.

pub mod film;
pub mod order;
mod picture;
pub mod rows;

pub use film::{FilmFrame, FilmReader, Plays};
pub use order::natural_order;
pub use picture::{ImportError, read_png};
pub use rows::{FramePicture, PictureRows};
