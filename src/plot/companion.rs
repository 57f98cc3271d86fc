//! A chart next to or below an animation, with the playhead at the sample of the frame. The chart is drawn once.

use super::chart::Chart;
use super::drawing::{Drawing, draw_chart};
use super::playhead::playhead_marks;
use super::raster::ChartPainter;
use super::theme::ChartTheme;
use image::RgbaImage;
use image::imageops::replace;

/// Pictures that are at least this much wider than high have the chart next to the animation, others below it.
const BESIDE: f64 = 1.5;

/// Share of the picture's width, or height, that the chart takes.
const SHARE_BESIDE: f64 = 0.44;
const SHARE_BELOW: f64 = 0.4;

/// Smallest readable size of a panel in pixels.
const LEAST_PANEL: [f64; 2] = [230.0, 120.0];

/// A picture divided between an animation and a chart.
#[derive(Clone, Debug)]
pub struct Companion {
    /// Pixels left to the animation.
    pub animation: [u32; 2],
    /// Where the chart's top left corner is.
    corner: [u32; 2],
    drawing: Drawing,
    picture: RgbaImage,
    frames: Chart,
}

/// As many panels as can be read in `size` pixels, without notes.
fn reduce_chart(chart: &Chart, size: [u32; 2]) -> Chart {
    let [columns, rows] = [0, 1].map(|k| ((f64::from(size[k]) / LEAST_PANEL[k]) as usize).max(1));
    Chart {
        panels: chart.panels.iter().take(columns * rows).cloned().collect(),
        notes: Vec::new(),
        ..chart.clone()
    }
}

/// Pixels of animation and chart in a picture of `size`, and the chart's corner.
fn divide_picture([width, height]: [u32; 2]) -> [[u32; 2]; 3] {
    if f64::from(width) >= BESIDE * f64::from(height) {
        let chart = ((f64::from(width) * SHARE_BESIDE) as u32).clamp(1, width.max(2) - 1);
        let left = width.saturating_sub(chart).max(1);
        [[left, height], [chart, height], [left, 0]]
    } else {
        let chart = ((f64::from(height) * SHARE_BELOW) as u32).clamp(1, height.max(2) - 1);
        let top = height.saturating_sub(chart).max(1);
        [[width, top], [width, chart], [0, top]]
    }
}

impl Companion {
    /// Draws `chart` into its part of a picture of `size` pixels, on `background`. `frames` is the same chart at the
    /// samples of the animation, for the playhead.
    pub fn new(chart: &Chart, frames: Chart, size: [u32; 2], background: [u8; 3]) -> Self {
        let [animation, own, corner] = divide_picture(size);
        let chart = &reduce_chart(chart, own);
        let [r, g, b] = background;
        let is_dark = u32::from(r) + u32::from(g) + u32::from(b) < 3 * 110;
        let theme = ChartTheme {
            background: [r, g, b, 255],
            ..if is_dark {
                ChartTheme::DARK
            } else {
                ChartTheme::LIGHT
            }
        };
        let drawing = draw_chart(chart, own, theme);
        let picture = ChartPainter::default().picture(&drawing);
        Self {
            animation,
            corner,
            drawing,
            picture,
            frames,
        }
    }

    /// Draws the picture of the animation and the chart with its playhead at `sample` into `image`, which has the full
    /// size.
    pub fn compose_frame(
        &self,
        animation: &RgbaImage,
        sample: usize,
        painter: &mut ChartPainter,
        image: &mut RgbaImage,
    ) {
        let mut chart = self.picture.clone();
        painter.paint_primitives(
            &playhead_marks(&self.frames, &self.drawing, sample),
            &mut chart,
        );
        replace(image, animation, 0, 0);
        replace(
            image,
            &chart,
            i64::from(self.corner[0]),
            i64::from(self.corner[1]),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parts_make_up_the_picture() {
        for size in [
            [640, 480],
            [1280, 720],
            [1, 1],
            [2, 2],
            [3, 1],
            [1, 7],
            [16384, 2],
        ] {
            let [animation, chart, corner] = divide_picture(size);
            assert!(
                animation.iter().chain(&chart).all(|side| *side > 0),
                "{size:?}"
            );
            let axis = usize::from(corner[0] == 0);
            let together = animation[axis] + chart[axis];
            assert!(together == size[axis] || size[axis] == 1, "{size:?}");
            assert_eq!(animation[1 - axis], size[1 - axis]);
        }
    }
}
