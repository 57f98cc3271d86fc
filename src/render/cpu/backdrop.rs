//! The picture behind all bodies: background, ground, grid and contact shadow.
//!
//! Everything except the shadow is the same in every frame and computed once, for the rows that are drawn.

use super::window::pitch;
use crate::render::colour::ToneCurve;
use crate::render::contact_shadow::{ContactShadow, TexelPlace};
use crate::render::ground::{GroundRow, GroundView};
use crate::render::look::{self, Rgb};
use crate::render::{Camera, Stage};
use std::ops::Range;

/// Pixels of a row whose ground is computed at once.
const LANES: usize = 8;

/// The ground in one pixel.
#[derive(Clone, Copy, Debug, Default)]
struct ShadowSpot {
    /// Factor on the background without shadow.
    factor: f32,
    /// How much the darkest shadow would take away; 0 off the ground.
    shadow: f32,
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
    spots: Vec<ShadowSpot>,
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
            spots: Vec::new(),
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
        self.codes.clear();
        self.codes.resize(self.width * self.rows.len(), self.bare);
        self.spots.clear();
        self.reach.clear();
        let ground = stage.ground.as_ref();
        self.view = ground.and_then(|ground| GroundView::new(ground, camera, stage.size));
        if let (Some(view), Some(ground)) = (self.view, ground) {
            self.lay_ground(&view, ground.shade, ToneCurve::shared());
        }
    }

    fn lay_ground(&mut self, view: &GroundView, shade: [f32; 2], curve: &ToneCurve) {
        let width = self.width;
        let none = ShadowSpot {
            factor: 1.0,
            ..ShadowSpot::default()
        };
        self.spots.resize(width * self.rows.len(), none);
        let pitch = self.pitch;
        let columns = width.div_ceil(pitch);
        // Tiles of which the first and the last may be held in part.
        let first_tile = self.rows.start / pitch;
        let tile_rows = self.rows.end.div_ceil(pitch) - first_tile;
        self.reach.resize(columns * tile_rows, None);
        let tile_of: Vec<usize> = (0..width).map(|x| x / pitch).collect();
        // Many pixels are as bright as their neighbours.
        let mut known = (1.0, self.bare);
        for y in self.rows.clone() {
            let start = (y - self.rows.start) * width;
            let tiles = (y / pitch - first_tile) * columns;
            for first in (0..width).step_by(LANES) {
                let row = view.row(
                    std::array::from_fn(|k| (first + k) as f64 + 0.5),
                    y as f64 + 0.5,
                );
                let factors = look_of(&row, shade);
                for x in first..(first + LANES).min(width) {
                    // The point of the ground behind the middle of the pixel, if there is one.
                    let Some(point) = row.point(x - first) else {
                        continue;
                    };
                    let factor = factors[x - first];
                    if factor != known.0 {
                        let [r, g, b] = self.background.map(|c| curve.encode(c * factor));
                        known = (factor, [r, g, b, 255]);
                    }
                    let [u, v] = point.at;
                    self.spots[start + x] = ShadowSpot {
                        factor,
                        shadow: point.fade * look::SHADOW_DARKNESS,
                        place: TexelPlace::new(u, v),
                    };
                    self.codes[start + x] = known.1;
                    // The rectangle of shadow coordinates that each tile sees, for skipping tiles without shadow.
                    let reach = &mut self.reach[tiles + tile_of[x]];
                    let [low, high] = reach.unwrap_or([point.at, point.at]);
                    *reach = Some([
                        [look::smaller_of(low[0], u), look::smaller_of(low[1], v)],
                        [look::larger_of(high[0], u), look::larger_of(high[1], v)],
                    ]);
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

    /// Columns and rows of the shadow's texels, first and last, that the ground in a tile depends on. Tiles are counted
    /// from the first that is held on.
    pub(super) fn texels(&self, tile: usize) -> Option<[[usize; 2]; 2]> {
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

    /// Linear colour of a pixel, with the shadow where there is one, and whether the shadow changes it.
    #[inline(always)]
    pub(super) fn linear(&self, x: usize, y: usize, shadow: Option<&ContactShadow>) -> (Rgb, bool) {
        let Some(spot) = self.spots.get(self.index(x, y)) else {
            return (self.background, false);
        };
        let darkness = shadow.map_or(0.0, |shadow| shadow.at(spot.place)) * spot.shadow;
        let factor = spot.factor * (1.0 - darkness);
        let [r, g, b] = self.background;
        ([r * factor, g * factor, b * factor], darkness > 0.0)
    }
}

/// The factors on the background that pixels of a row show, without shadow.
#[inline(always)]
fn look_of(row: &GroundRow<LANES>, shade: [f32; 2]) -> [f32; LANES] {
    std::array::from_fn(|k| look::ground_factor(row.fade[k], row.lines[k], 0.0, shade))
}
