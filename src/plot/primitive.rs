//! The primitives of all writers: areas, lines, circles, texts, at positions in pixels from the top left corner.

use super::theme::{Colour, Dashes};

/// The anchor of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextAnchor {
    /// It begins there.
    Start,
    /// Its middle is there.
    Middle,
    /// It ends there.
    End,
}

/// A line's look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineStyle {
    /// Colour.
    pub colour: Colour,
    /// Pixels.
    pub width: f64,
    /// Interruptions.
    pub dashes: Dashes,
}

impl LineStyle {
    /// A line without interruptions.
    pub fn solid(colour: Colour, width: f64) -> Self {
        Self {
            colour,
            width,
            dashes: Dashes::None,
        }
    }
}

/// An axis-parallel rectangle in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Rect {
    /// Left edge.
    pub left: f64,
    /// Top edge.
    pub top: f64,
    /// Right edge.
    pub right: f64,
    /// Bottom edge.
    pub bottom: f64,
}

impl Rect {
    /// Width in pixels.
    pub fn width(&self) -> f64 {
        self.right - self.left
    }

    /// Height in pixels.
    pub fn height(&self) -> f64 {
        self.bottom - self.top
    }

    /// Whether a point is inside or on the edge.
    pub fn contains(&self, [x, y]: [f64; 2]) -> bool {
        (self.left..=self.right).contains(&x) && (self.top..=self.bottom).contains(&y)
    }
}

/// One thing to draw.
#[derive(Clone, Debug, PartialEq)]
pub enum DrawnPrimitive {
    /// A filled rectangle.
    Area {
        /// Where.
        rect: Rect,
        /// Colour.
        fill: Colour,
    },
    /// Joined straight pieces.
    Line {
        /// Corners.
        points: Vec<[f64; 2]>,
        /// Look.
        stroke: LineStyle,
        /// Name of the curve it belongs to; empty for axes, grid and the like.
        name: String,
    },
    /// A filled polygon.
    Region {
        /// Corners in order.
        points: Vec<[f64; 2]>,
        /// Colour.
        fill: Colour,
    },
    /// A circle, filled and outlined.
    Circle {
        /// Centre.
        centre: [f64; 2],
        /// Pixels.
        radius: f64,
        /// Inside.
        fill: Colour,
        /// Outline.
        stroke: LineStyle,
    },
    /// A text on its baseline.
    Text {
        /// Place of the baseline.
        at: [f64; 2],
        /// The text, one line.
        text: String,
        /// Height of the capitals in pixels.
        size: f64,
        /// How it hangs on its place.
        anchor: TextAnchor,
        /// Colour.
        colour: Colour,
    },
}
