//! Drawings over a finished picture: labels, their plates, and the border of a picture without a pose.
//!
//! Works on the pixels of either renderer, so that both show the same text, and uses only table look-ups and correctly
//! rounded arithmetic, so that the bytes are the same on every machine.

pub mod border;
mod paint;
mod patch;
mod plate;
mod stroke;

use super::text::{FontFace, PHASES, Setting, set_text};
use super::{Camera, Frame, Label, LabelAnchor};
use image::RgbaImage;
use paint::OverlayPainter;
pub use plate::plate_padding;

/// Greatest height of capitals in pixels; larger labels are drawn at this size (no picture needs them, and a
/// mask takes memory with its square).
const LARGEST_SIZE: f64 = 1024.0;

/// Draws labels; keeps the glyphs it has rasterised.
pub struct Overlay {
    face: FontFace,
    plate_colour: [u8; 3],
    /// Left, top, right and bottom of the labels drawn so far in this frame.
    taken: Vec<[f64; 4]>,
}

impl Overlay {
    /// An overlay whose plates have the sRGB colour `background` (the stage's background).
    pub fn new(background: [u8; 3]) -> Self {
        Self {
            face: FontFace::new(),
            plate_colour: background,
            taken: Vec::new(),
        }
    }

    /// Draws the border (if the frame has no pose), the patches, the strokes and the labels of `frame` over `image`, in
    /// their order.
    ///
    /// Parts outside the picture are clipped. A label is omitted if its anchor lies behind the camera or is not finite,
    /// or if its size is not positive. Alpha is not changed.
    pub fn draw(&mut self, frame: &Frame, camera: &Camera, image: &mut RgbaImage) {
        self.paint(frame, camera, &mut OverlayPainter::new(image));
    }

    /// The same in the rows from `first` on of a picture `height` pixels high.
    pub fn draw_strip(
        &mut self,
        frame: &Frame,
        camera: &Camera,
        [first, height]: [u32; 2],
        image: &mut RgbaImage,
    ) {
        let mut painter = OverlayPainter::on_strip(image, first, height);
        self.paint(frame, camera, &mut painter);
    }

    fn paint(&mut self, frame: &Frame, camera: &Camera, painter: &mut OverlayPainter) {
        if frame.no_pose {
            border::draw_border(painter);
        }
        let picture = painter.size().map(f64::from);
        for patch in &frame.patches {
            patch::draw_patch(painter, patch, picture);
        }
        for stroke in &frame.strokes {
            stroke::draw_stroke(painter, stroke);
        }
        self.taken.clear();
        for label in &frame.labels {
            self.draw_label(label, camera, painter);
        }
    }

    /// The texts of a frame with their rectangles (left, top, right, bottom in pixels) in a picture of `size`.
    pub fn text_rectangles(
        frame: &Frame,
        camera: &Camera,
        size: [u32; 2],
    ) -> Vec<(String, [f64; 4])> {
        let face = FontFace::new();
        let labels = frame.labels.iter().filter_map(|label| {
            let setting = set_text(&face, &label.text, label.size.min(LARGEST_SIZE));
            let [left, top] = place_label(label, &setting, camera, size)?;
            let own = [left, top, left + setting.width, top + setting.height];
            Some((label.text.clone(), own))
        });
        labels.collect()
    }

    fn draw_label(&mut self, label: &Label, camera: &Camera, painter: &mut OverlayPainter) {
        if label.size.is_nan() || label.size <= 0.0 {
            return;
        }
        let setting = set_text(&self.face, &label.text, label.size.min(LARGEST_SIZE));
        let size = painter.size();
        let Some([left, top]) = place_label(label, &setting, camera, size) else {
            return;
        };
        let own = [left, top, left + setting.width, top + setting.height];
        if label.yields && self.taken.iter().any(|other| boxes_overlap(&own, other)) {
            return;
        }
        self.taken.push(own);
        if let LabelAnchor::Beside(point)
        | LabelAnchor::Placed {
            point, line: true, ..
        } = label.anchor
            && let Some([x, y, _]) = camera.project(point, size)
        {
            // From the nearest point of the text, with a gap.
            let foot = [
                x.clamp(own[0] - AIR, own[2] + AIR),
                y.clamp(own[1] - AIR, own[3] + AIR),
            ];
            patch::draw_leader(painter, [[x, y], foot], label.colour);
        }
        if label.plate && !setting.glyphs.is_empty() {
            let corner = [left, top].map(|c| c.round() as i32);
            plate::draw_plate(painter, &setting, corner, self.plate_colour);
        }
        let in_world = !matches!(label.anchor, LabelAnchor::Screen(_));
        if in_world && !label.plate {
            // A halo in the background's colour keeps the text readable in front of dark bodies.
            for shift in SEAM {
                let place = [left + shift[0], top + shift[1]];
                self.draw_glyphs(&setting, place, self.plate_colour, painter);
            }
        }
        self.draw_glyphs(&setting, [left, top], label.colour, painter);
    }

    /// The glyphs from `left`, `top` on, in quarters of a pixel: a label that moves slowly does not jump.
    fn draw_glyphs(
        &mut self,
        setting: &Setting,
        corner: [f64; 2],
        colour: [u8; 3],
        painter: &mut OverlayPainter,
    ) {
        let phases = PHASES as i32;
        let quarters = corner.map(|c| (c * f64::from(phases)).round() as i32);
        for glyph in &setting.glyphs {
            let x = quarters[0] + glyph.phase as i32;
            let phase = [x, quarters[1]].map(|q| q.rem_euclid(phases) as u32);
            let mask = self.face.mask(glyph.id, setting.size, phase);
            let origin = [
                x.div_euclid(phases).saturating_add(glyph.column),
                quarters[1]
                    .div_euclid(phases)
                    .saturating_add(glyph.baseline),
            ];
            painter.blend_mask(mask, origin, colour);
        }
    }
}

fn boxes_overlap(a: &[f64; 4], b: &[f64; 4]) -> bool {
    a[0] <= b[2] && b[0] <= a[2] && a[1] <= b[3] && b[1] <= a[3]
}

/// Room between a text and the line that leads to it, in pixels.
const AIR: f64 = 2.5;

/// Room between a placed text and the border of the picture, in pixels.
const BORDER: f64 = 3.0;

/// How far right of and above its point a label with a line stands, in heights of its capitals.
const BESIDE: [f64; 2] = [2.2, 2.2];

/// Shifts in pixels that draw a halo around a text.
const SEAM: [[f64; 2]; 8] = [
    [-1.0, -1.0],
    [0.0, -1.0],
    [1.0, -1.0],
    [-1.0, 0.0],
    [1.0, 0.0],
    [-1.0, 1.0],
    [0.0, 1.0],
    [1.0, 1.0],
];

/// Top left pixel of a label's text; `None` when it cannot be seen.
fn place_label(
    label: &Label,
    setting: &Setting,
    camera: &Camera,
    size: [u32; 2],
) -> Option<[f64; 2]> {
    let picture = size.map(f64::from);
    let corner = match label.anchor {
        LabelAnchor::World(point) => {
            let [x, y, _] = camera.project(point, size)?;
            [x - 0.5 * setting.width, y - 0.5 * setting.height]
        }
        LabelAnchor::Beside(point) => {
            let [x, y, _] = camera.project(point, size)?;
            let away = BESIDE.map(|n| n * setting.size);
            // Kept inside the picture, so that the text can be read when its point is near the border.
            let left = (x + away[0]).min(picture[0] - setting.width - 2.0);
            [left, (y - away[1] - 0.5 * setting.height).max(2.0)]
        }
        LabelAnchor::Placed { point, offset, .. } => {
            let [x, y, _] = camera.project(point, size)?;
            let within = |middle: f64, extent: f64, limit: f64| {
                let low = (limit - BORDER - extent).min(middle - 0.5 * extent);
                low.max(BORDER)
            };
            [
                within(x + offset[0], setting.width, picture[0]),
                within(y + offset[1], setting.height, picture[1]),
            ]
        }
        LabelAnchor::Screen([x, y]) => {
            let inset = if label.plate {
                plate::plate_padding(setting.size)
            } else {
                0.0
            };
            [x * picture[0] + inset, y * picture[1] + inset]
        }
    };
    // Far outside it is invisible; this keeps the conversion to i32 exact.
    let reach = 4.0 * (picture[0] + picture[1] + setting.width + setting.height) + 1e4;
    let near = |c: f64| c.abs() <= reach.min(1e9);
    (near(corner[0]) && near(corner[1])).then_some(corner)
}

#[cfg(test)]
mod tests;
