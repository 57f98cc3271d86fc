//! Curves of a panel: their parts between gaps, with as few points as possible, and dots.

use super::area::PanelArea;
use super::chart::{Panel, SeriesStyle};
use super::headings::curve_stroke;
use super::layout::Sizes;
use super::primitive::{DrawnPrimitive, LineStyle};
use super::theme::ChartTheme;
use crate::math::segment_distance;

/// Points of a curve nearer than this to the line through their neighbours are left out, in pixels.
const FLATNESS: f64 = 0.02;

/// Draws all series of a panel.
pub(super) fn draw_curves(
    panel: &Panel,
    area: &PanelArea,
    sizes: &Sizes,
    theme: &ChartTheme,
    list: &mut Vec<DrawnPrimitive>,
) {
    for (index, series) in panel.series.iter().enumerate() {
        let stroke = curve_stroke(panel, index, sizes, theme);
        let dot = |centre| DrawnPrimitive::Circle {
            centre,
            radius: 1.6 * sizes.curve,
            fill: stroke.colour,
            stroke: LineStyle::solid(theme.background, sizes.hair),
        };
        let pixels: Vec<Option<[f64; 2]>> = series
            .points
            .iter()
            .map(|p| p.and_then(|p| area.pixel(p)))
            .collect();
        for points in unbroken_runs(&pixels, &series.breaks) {
            match points.as_slice() {
                [] => {}
                // A point without neighbours has no line, but is drawn.
                [alone] if series.style != SeriesStyle::Dots => list.push(dot(*alone)),
                [_] => {}
                _ => list.push(DrawnPrimitive::Line {
                    points: thin_line(&points),
                    stroke,
                    name: series.name.clone(),
                }),
            }
        }
        if series.style == SeriesStyle::Dots {
            list.extend(pixels.into_iter().flatten().map(dot));
        }
    }
}

/// The parts of a curve between its gaps and breaks.
fn unbroken_runs(pixels: &[Option<[f64; 2]>], breaks: &[usize]) -> Vec<Vec<[f64; 2]>> {
    let mut runs = vec![Vec::new()];
    for (index, pixel) in pixels.iter().enumerate() {
        if pixel.is_none() || breaks.contains(&index) {
            runs.push(Vec::new());
        }
        if let (Some(pixel), Some(run)) = (pixel, runs.last_mut()) {
            run.push(*pixel);
        }
    }
    runs
}

/// Omits points on the straight line between those that are kept.
fn thin_line(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut kept = vec![points[0]];
    let mut start = 0;
    for end in 2..points.len() {
        let (a, b) = (points[start], points[end]);
        let between = &points[start + 1..end];
        // Without a limit, the time for long straight parts would grow with the square of their length.
        let far = between.len() > 64
            || between
                .iter()
                .any(|p| segment_distance(*p, [a, b]) > FLATNESS);
        if far {
            kept.push(points[end - 1]);
            start = end - 1;
        }
    }
    kept.push(points[points.len() - 1]);
    kept
}
