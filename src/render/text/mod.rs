//! Glyphs of the embedded face as coverage masks, and how a text is set in lines of them.
//!
//! Holds no colours and no picture: blending is the overlay's work. The face is Noto Sans, cut down to the
//! characters that labels of mechanisms use (Latin with the Central European letters, Greek, arrows and
//! mathematical signs); its licence lies beside it in `OFL.txt`.

mod face;
mod layout;
mod mask;

pub use face::{Face, PHASES, missing_glyphs};
pub use layout::{Glyph, Setting, set_text};
pub use mask::Mask;
