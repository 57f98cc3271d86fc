//! A drawing under construction: primitives, the lines that labels keep clear of, and labels waiting for a place.

use super::bins::SpatialBins;
use super::plane::{
    DrawnSpot, quarter_turn, spot_ahead, spot_difference, spot_length, unit_direction,
};
use crate::plot::primitive::{DrawnPrimitive, LineStyle, Rect, TextAnchor};
use crate::plot::theme::{ChartTheme, Colour, Dashes};

/// A label to be placed.
#[derive(Clone, Debug, PartialEq)]
pub struct WantedLabel {
    /// Its text.
    pub text: String,
    /// What it belongs to.
    pub anchor: DrawnSpot,
    /// Preferred direction from there; any length.
    pub wish: DrawnSpot,
    /// Height of the capitals.
    pub size: f64,
    /// Colour of the text.
    pub colour: Colour,
    /// In a circle.
    pub ringed: bool,
    /// Pixels from the anchor that it keeps at least.
    pub least: f64,
}

/// A drawing that grows.
pub struct Ink {
    /// From back to front.
    pub primitives: Vec<DrawnPrimitive>,
    /// Lines that labels had better not cover, and boxes that they must not.
    pub bins: SpatialBins,
    /// Labels, the first placed first.
    pub labels: Vec<WantedLabel>,
    /// Texts with a fixed middle: text, place, cap height, colour.
    pub letters: Vec<(String, DrawnSpot, f64, Colour)>,
    /// Colours.
    pub theme: ChartTheme,
    /// Lengths in pixels are multiples of this.
    pub unit: f64,
}

/// Length and half width of an arrow's head.
const HEAD: [f64; 2] = [9.0, 2.8];

impl Ink {
    /// A line of a width, which labels avoid.
    pub fn line(&mut self, points: &[DrawnSpot], colour: Colour, width: f64, dashes: Dashes) {
        if points.len() < 2 {
            return;
        }
        for ends in points.windows(2) {
            self.bins.push_line([ends[0], ends[1]]);
        }
        self.mark(points, colour, width, dashes);
    }

    /// A line that labels need not avoid.
    pub fn mark(&mut self, points: &[DrawnSpot], colour: Colour, width: f64, dashes: Dashes) {
        let width = width * self.unit;
        self.primitives.push(DrawnPrimitive::Line {
            points: points.to_vec(),
            stroke: LineStyle {
                colour,
                width,
                dashes,
            },
            name: String::new(),
        });
    }

    /// A filled shape with an outline.
    pub fn shape(&mut self, points: &[DrawnSpot], fill: Colour, colour: Colour, width: f64) {
        self.primitives.push(DrawnPrimitive::Region {
            points: points.to_vec(),
            fill,
        });
        let closed: Vec<DrawnSpot> = points.iter().chain(points.first()).copied().collect();
        self.mark(&closed, colour, width, Dashes::None);
    }

    /// A circle of a radius in units of the drawing.
    pub fn circle(
        &mut self,
        centre: DrawnSpot,
        radius: f64,
        fill: Colour,
        colour: Colour,
        width: f64,
    ) {
        self.primitives.push(DrawnPrimitive::Circle {
            centre,
            radius: radius * self.unit,
            fill,
            stroke: LineStyle::solid(colour, width * self.unit),
        });
    }

    /// The head of an arrow at `tip` that points along `direction`.
    pub fn head(&mut self, tip: DrawnSpot, direction: DrawnSpot, colour: Colour) {
        let Some(d) = unit_direction(direction) else {
            return;
        };
        let back = spot_ahead(tip, d, -HEAD[0] * self.unit);
        let side = quarter_turn(d);
        let half = HEAD[1] * self.unit;
        self.primitives.push(DrawnPrimitive::Region {
            points: vec![
                tip,
                spot_ahead(back, side, half),
                spot_ahead(back, side, -half),
            ],
            fill: colour,
        });
    }

    /// A line with a head at its end.
    pub fn arrow(&mut self, points: &[DrawnSpot], colour: Colour, width: f64) {
        let [.., before, tip] = points else { return };
        let direction = spot_difference(*tip, *before);
        self.line(points, colour, width, Dashes::None);
        self.head(*tip, direction, colour);
    }

    /// A text at a fixed place.
    pub fn text(
        &mut self,
        at: DrawnSpot,
        text: &str,
        size: f64,
        anchor: TextAnchor,
        colour: Colour,
    ) {
        self.primitives.push(DrawnPrimitive::Text {
            at,
            text: text.to_owned(),
            size,
            anchor,
            colour,
        });
    }

    /// Keeps labels out of a circle.
    pub fn reserve_circle(&mut self, at: DrawnSpot, radius: f64) {
        let r = radius * self.unit;
        self.bins.push_box(Rect {
            left: at[0] - r,
            top: at[1] - r,
            right: at[0] + r,
            bottom: at[1] + r,
        });
    }

    /// Length of the part of a line that runs along, or close to, what is already drawn; pixels.
    pub fn covered(&self, [a, b]: [DrawnSpot; 2], within: f64) -> f64 {
        let step = 5.0 * self.unit;
        let length = spot_length(spot_difference(b, a));
        let count = ((length / step).ceil() as usize).clamp(1, 400);
        let near = |at: DrawnSpot| self.bins.is_line_within(at, within);
        let inside = |[x, y]: DrawnSpot| {
            let here = Rect {
                left: x,
                right: x,
                top: y,
                bottom: y,
            };
            self.bins.any_box(&here, |r| r.contains([x, y]))
        };
        let hits = (0..=count).filter(|k| {
            let at = spot_ahead(a, spot_difference(b, a), *k as f64 / count as f64);
            near(at) || inside(at)
        });
        hits.count() as f64 * length / (count + 1) as f64
    }
}
