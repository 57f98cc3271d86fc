//! Tiles that show what they showed in the frame before are not drawn again.
//!
//! The pixels of a tile depend on its facets, on the contact shadow where it sees the ground, and on whether anything may
//! be below the ground; everything else is the same as long as camera and rows are.

use super::view::RasterView;
use crate::render::contact_shadow::{ContactShadow, SHADOW_SIZE};

const TEXELS: usize = SHADOW_SIZE as usize;

/// The picture drawn last, without what is drawn over it, and what its tiles depend on besides their facets.
#[derive(Clone, Debug, Default)]
pub(super) struct KeptTiles {
    /// Frames drawn one after the other with this camera and these rows.
    frames: usize,
    /// Pixels of the last frame; none before the second, so that a single picture needs no memory.
    bytes: Vec<u8>,
    below_ground: bool,
    /// Whether `bytes` is a frame that is like the next one as far as all tiles are concerned.
    is_alike: bool,
    texels: Vec<u8>,
    /// For each row of the contact shadow's texels those that are others than in the last frame, a bit each.
    changed: Vec<u128>,
}

impl KeptTiles {
    /// Nothing is to be kept: camera or rows are others.
    pub(super) fn forget(&mut self) {
        self.frames = 0;
    }

    /// The bytes of the last frame, `count` of them, to be drawn over where tiles change; `None` if the next frame
    /// is the first of its kind.
    pub(super) fn start(&mut self, view: &RasterView, count: usize) -> Option<Vec<u8>> {
        self.is_alike = self.frames > 1
            && self.bytes.len() == count
            && self.below_ground == view.below_ground
            && view.shade.is_none();
        self.frames += 1;
        if self.frames == 1 {
            self.bytes = Vec::new();
            return None;
        }
        self.below_ground = view.below_ground;
        if let Some(shadow) = view.shadow {
            self.compare_shadow(shadow);
        }
        let mut bytes = std::mem::take(&mut self.bytes);
        bytes.resize(count, 0);
        Some(bytes)
    }

    /// Keeps the bytes of the frame that was drawn.
    pub(super) fn keep(&mut self, bytes: Vec<u8>) {
        self.bytes = bytes;
    }

    /// Whether a tile shows what it showed in the last frame.
    pub(super) fn is_same(&self, view: &RasterView, tile: usize) -> bool {
        self.is_alike && !view.assembly.bins[tile].is_new && !self.is_shadow_new(view, tile)
    }

    fn is_shadow_new(&self, view: &RasterView, tile: usize) -> bool {
        let (Some(_), Some([low, high])) = (view.shadow, view.backdrop.texels(tile)) else {
            return false;
        };
        let columns = (1 << high[0]) | ((1 << high[0]) - (1 << low[0]));
        let rows = self.changed.get(low[1]..=high[1]).unwrap_or(&[]);
        rows.iter().any(|row| row & columns != 0)
    }

    fn compare_shadow(&mut self, shadow: &ContactShadow) {
        self.texels.resize(shadow.texels.len(), 0);
        let rows = shadow.texels.as_chunks::<TEXELS>().0;
        let before = self.texels.as_chunks::<TEXELS>().0;
        self.changed.clear();
        self.changed.extend(rows.iter().zip(before).map(|(now, was)| {
            if now == was {
                return 0;
            }
            let pairs = now.iter().zip(was).enumerate();
            pairs.fold(0, |bits, (k, (now, was))| bits | u128::from(now != was) << k)
        }));
        self.texels.copy_from_slice(&shadow.texels);
    }
}
