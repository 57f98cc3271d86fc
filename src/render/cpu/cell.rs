//! Depths and facets of the samples of one cell.

use super::samples::LANES;

/// No facet: the backdrop is visible.
pub(super) const NOTHING: i32 = -1;

/// The samples of one cell, `G` vectors.
#[derive(Clone, Copy, Debug)]
pub(super) struct PixelCell<const G: usize> {
    pub(super) depth: [[f32; LANES]; G],
    pub(super) facet: [[i32; LANES]; G],
}

impl<const G: usize> PixelCell<G> {
    pub(super) const BARE: Self = Self {
        depth: [[f32::NEG_INFINITY; LANES]; G],
        facet: [[NOTHING; LANES]; G],
    };
}

/// Facets of the `S` samples of a pixel of a tile.
#[inline(always)]
pub(super) fn facets_of<const S: usize, const G: usize>(
    cells: &[PixelCell<G>],
    pixel: usize,
) -> [i32; S] {
    let lane = pixel * S;
    let cell = &cells[lane / (LANES * G)];
    let lanes = cell.facet.as_flattened();
    std::array::from_fn(|s| lanes[(lane + s) % (LANES * G)])
}
