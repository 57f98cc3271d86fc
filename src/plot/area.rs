//! Where the points of a panel are in the picture.

use super::primitive::Rect;
use super::scale::Scale;

/// Where the values of a panel are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PanelArea {
    /// Edges.
    pub rect: Rect,
    /// From left to right.
    pub x: Scale,
    /// From bottom to top.
    pub y: Scale,
}

impl PanelArea {
    /// The pixel of a point, if it has one.
    pub fn pixel(&self, point: [f64; 2]) -> Option<[f64; 2]> {
        Some([self.x.pixel(point[0])?, self.y.pixel(point[1])?])
    }
}
