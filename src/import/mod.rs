//! Reading of picture files: PNG row by row, APNG and GIF frame by frame, file names in numerical order. Draws and writes
//! nothing.

mod apng;
pub mod film;
pub mod order;
mod picture;
pub mod rows;

pub use film::{FilmFrame, FilmReader, Plays};
pub use order::natural_order;
pub use picture::{ImportError, read_png};
pub use rows::{FramePicture, PictureRows};
