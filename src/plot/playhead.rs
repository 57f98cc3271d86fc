//! The playhead: marks the current sample on the curves of a drawing. Redrawn for every frame of an animation.

use super::chart::Chart;
use super::drawing::Drawing;
use super::primitive::{DrawnPrimitive, LineStyle};

/// A line at the sample's place on the horizontal axis, and a dot on every curve.
pub fn playhead_marks(chart: &Chart, drawing: &Drawing, sample: usize) -> Vec<DrawnPrimitive> {
    let (sizes, theme) = (&drawing.sizes, &drawing.theme);
    let mut list = Vec::new();
    for (panel, area) in chart.panels.iter().zip(&drawing.areas) {
        let place = panel.samples.get(sample).and_then(|x| area.x.pixel(*x));
        // On a path in a plane a vertical line would be meaningless.
        if let Some(x) = place.filter(|_| !panel.equal) {
            list.push(DrawnPrimitive::Line {
                points: vec![[x, area.rect.top], [x, area.rect.bottom]],
                stroke: LineStyle::solid(theme.faint_text, sizes.hair),
                name: String::new(),
            });
        }
        for (index, series) in panel.series.iter().enumerate() {
            let point = series.points.get(sample).copied().flatten();
            if let Some(centre) = point.and_then(|p| area.pixel(p)) {
                list.push(DrawnPrimitive::Circle {
                    centre,
                    radius: 2.4 * sizes.curve,
                    fill: theme.colour(index),
                    stroke: LineStyle::solid(theme.background, 1.2 * sizes.hair),
                });
            }
        }
    }
    list
}
