//! The facets that a tile has to draw.

use super::super::mask::PixelMask;

/// Facets of one tile, as indices into the assembly's list.
#[derive(Clone, Debug)]
pub struct TileBin {
    pub opaque: Vec<u32>,
    pub translucent: Vec<u32>,
    /// The pixels of facets that were not in the frame before, or are no more.
    pub changed: PixelMask,
}

impl TileBin {
    pub(super) const NEW: Self = Self {
        opaque: Vec::new(),
        translucent: Vec::new(),
        changed: PixelMask::ALL,
    };

    /// Whether there is nothing but the background.
    pub fn is_empty(&self) -> bool {
        self.opaque.is_empty() && self.translucent.is_empty()
    }
}
