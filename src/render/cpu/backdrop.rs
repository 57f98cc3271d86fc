//! The picture behind all bodies: background, ground, grid and contact shadow.
//!
//! Everything except the shadow is the same in every frame of a still camera and computed once, for the rows that are drawn.

use super::window::pitch;
use crate::render::colour::ToneCurve;
use crate::render::contact_shadow::{ContactShadow, TexelPlace};
use crate::render::ground::{GroundRow, GroundView};
use crate::render::look::{self, Rgb};
use crate::render::{Camera, Stage};
use std::ops::Range;

/// Pixels of a row whose ground is computed at once.
const LANES: usize = 8;

/// The shadow's place in one pixel.
#[derive(Clone, Copy, Debug, Default)]
struct ShadowSpot {
    /// How much the darkest shadow would take away; 0 off the ground.
    darkest: f32,
    /// Where the shadow is looked up.
    place: TexelPlace,
}

/// The picture without bodies.
#[derive(Clone, Debug)]
pub(super) struct Backdrop {
    width: usize,
    /// The rows of the picture that are held.
    rows: Range<usize>,
    /// Pixels from tile to tile.
    pitch: usize,
    background: Rgb,
    /// Code of the background.
    bare: [u8; 4],
    /// Codes without shadow, row by row from the first that is held on.
    codes: Vec<[u8; 4]>,
    /// Factors on the background without shadow.
    factors: Vec<f32>,
    /// Laid tile by tile, where a shadow falls for the first time.
    spots: Vec<ShadowSpot>,
    has_spots: Vec<bool>,
    /// Range of the ground's coordinates in each tile of these rows, `None` where it shows no ground.
    reach: Vec<Option<[[f32; 2]; 2]>>,
    pub(super) view: Option<GroundView>,
}

impl Backdrop {
    /// The picture of a stage without bodies, of which no row is held yet.
    pub(super) fn new(stage: &Stage) -> Self {
        let curve = ToneCurve::shared();
        let background = curve.decode_rgb(stage.background);
        let [r, g, b] = stage.background;
        Self {
            width: stage.size[0] as usize,
            rows: 0..0,
            pitch: pitch(stage) as usize,
            background,
            bare: [r, g, b, 255],
            codes: Vec::new(),
            factors: Vec::new(),
            spots: Vec::new(),
            has_spots: Vec::new(),
            reach: Vec::new(),
            view: None,
        }
    }

    /// The rows that are held.
    pub(super) fn rows(&self) -> &Range<usize> {
        &self.rows
    }

    /// Recomputes everything for another camera or other rows.
    pub(super) fn see(&mut self, stage: &Stage, camera: &Camera, rows: Range<usize>) {
        self.rows = rows;
        self.codes.resize(self.width * self.rows.len(), self.bare);
        self.factors.clear();
        self.reach.clear();
        self.has_spots.clear();
        let ground = stage.ground.as_ref();
        self.view = ground.and_then(|ground| GroundView::new(ground, camera, stage.size));
        match (self.view, ground) {
            (Some(view), Some(ground)) => self.lay_ground(&view, ground.shade),
            _ => self.codes.fill(self.bare),
        }
    }

    fn lay_ground(&mut self, view: &GroundView, shade: [f32; 2]) {
        let width = self.width;
        self.factors.resize(width * self.rows.len(), 1.0);
        for tile in 0..self.columns() * self.tile_rows().len() {
            let [x, y] = self.pixels(tile);
            let ends = |range: Range<usize>| [range.start as f64 + 0.5, range.end as f64 - 0.5];
            self.reach.push(view.reach(ends(x), ends(y)));
        }
        self.has_spots.resize(self.reach.len(), false);
        let rows = self.factors.chunks_exact_mut(width);
        let rows = rows.zip(self.codes.chunks_exact_mut(width));
        for (y, (factors, codes)) in self.rows.clone().zip(rows) {
            let parts = factors.chunks_mut(LANES).zip(codes.chunks_mut(LANES));
            for (first, (factors, codes)) in (0..).step_by(LANES).zip(parts) {
                let row = view.row(centres(first), y as f64 + 0.5);
                if row.seen == [false; LANES] {
                    factors.fill(1.0);
                    codes.fill(self.bare);
                    continue;
                }
                let own = factors_of(view, &row, shade);
                let own_codes = codes_of(own, self.background, self.bare);
                factors.copy_from_slice(&own[..factors.len()]);
                codes.copy_from_slice(&own_codes[..codes.len()]);
            }
        }
    }

    /// Tiles in a row.
    fn columns(&self) -> usize {
        self.width.div_ceil(self.pitch)
    }

    /// Rows of tiles, of which the first and the last may be held in part.
    fn tile_rows(&self) -> Range<usize> {
        self.rows.start / self.pitch..self.rows.end.div_ceil(self.pitch)
    }

    /// Columns and rows of the pixels of a tile that are held. Tiles are counted from the first that is held on.
    fn pixels(&self, tile: usize) -> [Range<usize>; 2] {
        let [left, top] = [
            tile % self.columns(),
            self.tile_rows().start + tile / self.columns(),
        ]
        .map(|k| k * self.pitch);
        let rows = top.max(self.rows.start)..(top + self.pitch).min(self.rows.end);
        [left..(left + self.pitch).min(self.width), rows]
    }

    /// Finds out where pixels look up the shadow, in the tiles where it falls.
    pub(super) fn lay_spots(&mut self, shadow: Option<&ContactShadow>) {
        let Some(view) = self.view.filter(|_| shadow.is_some()) else {
            return;
        };
        self.spots.resize(self.codes.len(), ShadowSpot::default());
        for tile in 0..self.has_spots.len() {
            if self.has_spots[tile] || !self.shaded(tile, shadow) {
                continue;
            }
            self.has_spots[tile] = true;
            let [columns, rows] = self.pixels(tile);
            for y in rows {
                let start = self.index(columns.start, y);
                let spots = &mut self.spots[start..start + columns.len()];
                for (first, spots) in columns.clone().step_by(LANES).zip(spots.chunks_mut(LANES)) {
                    let row = view.row(centres(first), y as f64 + 0.5);
                    spots.copy_from_slice(&spots_of(&row)[..spots.len()]);
                }
            }
        }
    }

    /// Whether any pixel of a tile may be in the shadow. Tiles are counted from the first that is held on.
    pub(super) fn shaded(&self, tile: usize, shadow: Option<&ContactShadow>) -> bool {
        let reach = self.reach.get(tile).copied().flatten();
        let (Some([low, high]), Some(shadow)) = (reach, shadow) else {
            return false;
        };
        let Some([least, greatest]) = shadow.reach() else {
            return false;
        };
        (0..2).all(|k| low[k] <= greatest[k] && high[k] >= least[k])
    }

    /// Columns and rows of the shadow's texels, first and last, that the ground in a tile depends on; `None` where no
    /// shadow has fallen yet. Tiles are counted from the first that is held on.
    pub(super) fn texels(&self, tile: usize) -> Option<[[usize; 2]; 2]> {
        self.has_spots.get(tile).filter(|has| **has)?;
        let [low, high] = self.reach.get(tile).copied().flatten()?;
        let corner = |[u, v]: [f32; 2]| TexelPlace::new(u, v).corner();
        Some([corner(low), corner(high).map(|c| c + 1)])
    }

    /// Column and row of the shadow's texel that a pixel of the ground depends on, with the next ones.
    #[inline(always)]
    pub(super) fn texel(&self, x: usize, y: usize) -> [usize; 2] {
        let spot = self.spots.get(self.index(x, y)).copied();
        spot.unwrap_or_default().place.corner()
    }

    /// Where a pixel of the rows that are held is stored.
    #[inline(always)]
    fn index(&self, x: usize, y: usize) -> usize {
        (y - self.rows.start) * self.width + x
    }

    /// Codes of a row of pixels without shadow.
    pub(super) fn codes(&self, x: usize, y: usize, count: usize) -> &[[u8; 4]] {
        let start = self.index(x, y);
        &self.codes[start..start + count]
    }

    /// Code of a pixel that the shadow changes.
    #[inline(always)]
    pub(super) fn shaded_code(
        &self,
        x: usize,
        y: usize,
        shadow: Option<&ContactShadow>,
    ) -> Option<[u8; 4]> {
        let (rgb, is_shaded) = self.linear(x, y, shadow);
        is_shaded.then(|| {
            let [r, g, b] = ToneCurve::shared().encode_all(rgb);
            [r, g, b, 255]
        })
    }

    /// Linear colour of a pixel, with the shadow where there is one, and whether the shadow changes it.
    #[inline(always)]
    pub(super) fn linear(&self, x: usize, y: usize, shadow: Option<&ContactShadow>) -> (Rgb, bool) {
        let index = self.index(x, y);
        let Some(factor) = self.factors.get(index) else {
            return (self.background, false);
        };
        let darkness = match (shadow, self.spots.get(index)) {
            (Some(shadow), Some(spot)) => shadow.at(spot.place) * spot.darkest,
            _ => 0.0,
        };
        let factor = factor * (1.0 - darkness);
        let [r, g, b] = self.background;
        ([r * factor, g * factor, b * factor], darkness > 0.0)
    }
}

/// The middles of pixels from the column `first` on.
#[inline(always)]
fn centres(first: usize) -> [f64; LANES] {
    let mut centres = [first as f64 + 0.5; LANES];
    for (k, centre) in centres.iter_mut().enumerate() {
        *centre += k as f64;
    }
    centres
}

/// The factors on the background that pixels of a row show, without shadow; 1 off the ground.
#[inline(always)]
fn factors_of(view: &GroundView, row: &GroundRow<LANES>, shade: [f32; 2]) -> [f32; LANES] {
    let (fade, lines) = (row.fade(), view.lines(row));
    let mut factors = [1.0; LANES];
    for k in 0..LANES {
        let factor = look::ground_factor(fade[k], lines[k], 0.0, shade);
        factors[k] = if row.seen[k] { factor } else { 1.0 };
    }
    factors
}

/// The codes of pixels with these factors; `bare` is that of the background.
#[inline(always)]
fn codes_of(factors: [f32; LANES], background: Rgb, bare: [u8; 4]) -> [[u8; 4]; LANES] {
    let curve = ToneCurve::shared();
    let mut codes = [[255; 4]; LANES];
    for (channel, own) in background.into_iter().enumerate() {
        let mut values = factors;
        values.iter_mut().for_each(|value| *value *= own);
        for (code, value) in codes.iter_mut().zip(curve.encode_all(values)) {
            code[channel] = value;
        }
    }
    for (code, factor) in codes.iter_mut().zip(factors) {
        if factor == 1.0 {
            *code = bare;
        }
    }
    codes
}

/// Where pixels of a row look up the shadow.
#[inline(always)]
fn spots_of(row: &GroundRow<LANES>) -> [ShadowSpot; LANES] {
    let fade = row.fade();
    let mut spots = [ShadowSpot::default(); LANES];
    for (k, spot) in spots.iter_mut().enumerate().filter(|(k, _)| row.seen[*k]) {
        let [u, v] = row.at(k);
        *spot = ShadowSpot {
            darkest: fade[k] * look::SHADOW_DARKNESS,
            place: TexelPlace::new(u, v),
        };
    }
    spots
}
