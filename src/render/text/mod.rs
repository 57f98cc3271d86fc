//! Glyphs of the embedded face as coverage masks, and the layout of texts in lines.
//!
//! Blending is done by the overlay. The face is Noto Sans, reduced to the characters that labels of mechanisms use
//! (Latin with the Central European letters, Greek, arrows and mathematical signs); its licence is in `OFL.txt` in the
//! same folder.

mod face;
mod layout;
mod mask;

pub use face::{FontFace, PHASES, missing_glyphs};
pub use layout::{Glyph, Setting, set_text};
pub use mask::Mask;
