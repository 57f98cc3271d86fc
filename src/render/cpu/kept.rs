//! Pixels that show what they showed in the frame before are not drawn again.
//!
//! A pixel depends on the facets around it, on the contact shadow where it shows the ground, and on whether anything may be
//! below the ground; everything else is the same as long as camera and rows are.

use super::mask::{PixelMask, TilePart};
use super::view::RasterView;
use super::window::Window;
use crate::render::contact_shadow::{ContactShadow, SHADOW_SIZE};

const TEXELS: usize = SHADOW_SIZE as usize;

/// The picture drawn last, without what is drawn over it, and what its pixels depend on besides their facets.
#[derive(Clone, Debug, Default)]
pub(super) struct KeptTiles {
    /// Frames drawn one after the other with this camera and these rows.
    frames: usize,
    /// Pixels of the last frame; none before the second, so that a single picture needs no memory.
    bytes: Vec<u8>,
    tiles: Vec<KeptTile>,
    below_ground: bool,
    /// Whether pixels whose facets and shadow are those of the last frame are as they were.
    is_alike: bool,
    texels: Vec<u8>,
    /// For each row of the contact shadow's texels those that are others than in the last frame, or whose neighbours to the
    /// right or below are; a bit each.
    changed: Vec<u128>,
}

#[derive(Clone, Copy, Debug)]
struct KeptTile {
    /// Pixels that show something of the backdrop, and those that show nothing else.
    seen_backdrop: PixelMask,
    bare: PixelMask,
}

impl KeptTiles {
    /// Nothing is to be kept: camera or rows are others.
    pub(super) fn forget(&mut self) {
        self.frames = 0;
    }

    /// The bytes of the last frame, `count` of them, to be drawn over where something changes; `None` if the next frame
    /// is the first of its kind.
    pub(super) fn start(&mut self, view: &RasterView, count: usize) -> Option<Vec<u8>> {
        self.is_alike = self.frames > 1
            && self.bytes.len() == count
            && self.below_ground == view.below_ground
            && view.shade.is_none();
        self.frames += 1;
        if self.frames == 1 {
            self.bytes = Vec::new();
            self.tiles = Vec::new();
            return None;
        }
        self.below_ground = view.below_ground;
        let none = KeptTile {
            seen_backdrop: PixelMask::NONE,
            bare: PixelMask::NONE,
        };
        self.tiles.resize(view.assembly.bins.len(), none);
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

    /// The pixels `inner` of a tile that are to be drawn, and those that show nothing but the backdrop in another shadow.
    pub(super) fn changed(&self, view: &RasterView, tile: usize, inner: &Window) -> [TilePart; 2] {
        let window = view.assembly.with_apron(view.assembly.window(tile));
        let part = |pixels| TilePart { window, pixels };
        let kept = self.tiles.get(tile).filter(|_| self.is_alike);
        let Some(kept) = kept else {
            let all = PixelMask::of(window.corner(), inner);
            return [all, PixelMask::NONE].map(part);
        };
        // Most tiles are as they were.
        let changed = &view.assembly.bins[tile].changed;
        if changed.is_empty() && !self.is_shaded_anew(view, tile) {
            return [PixelMask::NONE; 2].map(part);
        }
        // Lines reach beyond the surfaces that they follow.
        let all = PixelMask::of(window.corner(), inner);
        let changed = changed.grown(view.assembly.apron).and(&all);
        let rest = part(kept.seen_backdrop.and(&all).without(&changed));
        let shaded = self.shaded(view, tile, &rest);
        let bare = shaded.and(&kept.bare);
        [changed.or(&shaded.without(&bare)), bare].map(part)
    }

    /// Remembers where drawn pixels of a tile show the backdrop.
    pub(super) fn renew(
        &mut self,
        tile: usize,
        drawn: &TilePart,
        seen_backdrop: PixelMask,
        bare: PixelMask,
    ) {
        if let Some(kept) = self.tiles.get_mut(tile) {
            let drawn = &drawn.pixels;
            kept.seen_backdrop = kept.seen_backdrop.without(drawn).or(&seen_backdrop);
            kept.bare = kept.bare.without(drawn).or(&bare);
        }
    }

    /// Whether the shadow of any pixel of a tile may be another than in the last frame.
    fn is_shaded_anew(&self, view: &RasterView, tile: usize) -> bool {
        let (Some(_), Some([low, high])) = (view.shadow, view.backdrop.texels(tile)) else {
            return false;
        };
        let columns = (1 << high[0]) | ((1 << high[0]) - (1 << low[0]));
        let rows = self.changed.get(low[1]..=high[1]).unwrap_or(&[]);
        rows.iter().any(|row| row & columns != 0)
    }

    /// The pixels of a part of a tile whose shadow may be another than in the last frame.
    fn shaded(&self, view: &RasterView, tile: usize, part: &TilePart) -> PixelMask {
        let mut shaded = PixelMask::NONE;
        if self.is_shaded_anew(view, tile) {
            part.for_each(|pixel, x, y| {
                let [column, row] = view.backdrop.texel(x as usize, y as usize);
                if self.changed[row] >> column & 1 != 0 {
                    shaded.insert(pixel);
                }
            });
        }
        shaded
    }

    fn compare_shadow(&mut self, shadow: &ContactShadow) {
        self.texels.resize(shadow.texels.len(), 0);
        let rows = shadow.texels.as_chunks::<TEXELS>().0;
        let before = self.texels.as_chunks::<TEXELS>().0;
        self.changed.clear();
        self.changed
            .extend(rows.iter().zip(before).map(|(now, was)| {
                if now == was {
                    return 0;
                }
                let pairs = now.iter().zip(was).enumerate();
                pairs.fold(0, |bits, (k, (now, was))| {
                    bits | u128::from(now != was) << k
                })
            }));
        let mut below = 0;
        for row in self.changed.iter_mut().rev() {
            let own = *row | *row >> 1;
            *row = own | std::mem::replace(&mut below, own);
        }
        self.texels.copy_from_slice(&shadow.texels);
    }
}
