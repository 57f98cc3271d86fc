//! The legend of a map's colours: a colour bar with numbers, to the right of a drawing.

use super::drawing::Drawing;
use super::primitive::{DrawnPrimitive, Rect, TextAnchor};
use super::scale::{Scale, ScaleKind};
use super::theme::Colour;
use super::ticks::{power_of_ten, scale_ticks};

/// A row of colours for equal ranges of values.
#[derive(Clone, Debug, PartialEq)]
pub struct ColourBar {
    /// What is coloured, with its unit.
    pub label: String,
    /// Smallest value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
    /// From the smallest value to the largest.
    pub colours: Vec<Colour>,
}

/// Width of the bar and of all that is added, in heights of the capitals.
const BAR: f64 = 1.8;
const ROOM: f64 = 12.0;

/// Pixels by which adjacent steps overlap.
const SEAM: f64 = 0.5;

/// Most numbers beside the bar.
const MOST_TICKS: usize = 6;

impl ColourBar {
    /// The colour of a value; the ends for values beyond them.
    pub fn colour(&self, value: f64) -> Option<Colour> {
        let last = self.colours.len().checked_sub(1)?;
        let share = match self.high > self.low {
            true => (value - self.low) / (self.high - self.low),
            false => 0.5,
        };
        let place = (share * self.colours.len() as f64).max(0.0) as usize;
        value.is_finite().then(|| self.colours[place.min(last)])
    }

    /// A drawing with the bar at the right of its first panel.
    pub fn beside(&self, mut drawing: Drawing) -> Drawing {
        let (sizes, text) = (drawing.sizes, drawing.sizes.text);
        let Some(area) = drawing.areas.first().copied() else {
            return drawing;
        };
        let left = f64::from(drawing.size[0]);
        drawing.size[0] += (ROOM * text) as u32;
        if let Some(DrawnPrimitive::Area { rect, .. }) = drawing.primitives.first_mut() {
            rect.right = f64::from(drawing.size[0]);
        }
        let (top, bottom) = (area.rect.top, area.rect.bottom);
        let step = (bottom - top) / self.colours.len().max(1) as f64;
        let steps = self.colours.iter().enumerate();
        let bar = steps.map(|(k, fill)| DrawnPrimitive::Area {
            rect: Rect {
                left,
                right: left + BAR * text,
                // Under the next step, so that no seam is visible.
                top: (bottom - (k + 1) as f64 * step - SEAM).max(top),
                bottom: bottom - k as f64 * step,
            },
            fill: *fill,
        });
        drawing.primitives.extend(bar);
        let scale = Scale {
            kind: ScaleKind::Linear,
            low: self.low,
            high: self.high,
            start: bottom,
            end: top,
        };
        let ticks = scale_ticks(&scale, MOST_TICKS, "");
        let label = match ticks.factor {
            0 => self.label.clone(),
            k => format!("{} · {}", self.label, power_of_ten(k)),
        };
        let mut write = |at: [f64; 2], text: String, anchor| {
            drawing.primitives.push(DrawnPrimitive::Text {
                at,
                text,
                size: sizes.small,
                anchor,
                colour: drawing.theme.text,
            });
        };
        for tick in ticks.list.iter().filter(|tick| scale.holds(tick.value)) {
            if let Some(y) = scale.pixel(tick.value) {
                let at = [left + (BAR + 0.6) * text, y + 0.5 * sizes.small];
                write(at, tick.text.clone(), TextAnchor::Start);
            }
        }
        write([left, top - 1.5 * sizes.gap], label, TextAnchor::Start);
        drawing
    }
}
