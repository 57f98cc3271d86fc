//! Dimensions drawn into pictures: a length or an angle between moving points, with its value.

use glam::DVec3;

/// The carrier of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlaceOf {
    /// A body, with which it moves.
    Body(usize),
    /// A traced point.
    Trace(usize),
    /// The world.
    World,
}

/// A point in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DimensionEnd {
    /// What it belongs to.
    pub of: PlaceOf,
    /// Its place in the frame of the body; for a traced point its shift in the world.
    pub point: DVec3,
}

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DimensionKind {
    /// From one end to the other; the line is drawn shifted by `offset`, in the world.
    Length {
        /// Shift of the line.
        offset: DVec3,
    },
    /// Between the directions to both ends.
    Angle {
        /// Where both directions begin.
        at: DimensionEnd,
        /// Counted counter-clockwise about this axis of the world, from 0 to a full turn; else from 0 to half of one.
        axis: Option<DVec3>,
        /// Radius of the arc; a share of the motion's extent if `None`.
        radius: Option<f64>,
    },
}

/// A dimension in the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct ShownDimension {
    /// What is measured.
    pub kind: DimensionKind,
    /// From where to where.
    pub ends: [DimensionEnd; 2],
    /// Its text, with `{}` for the value; the value alone if `None`.
    pub text: Option<String>,
    /// Decimals; as for inputs if `None`.
    pub digits: Option<usize>,
    /// sRGB colour; the theme's ink if `None`.
    pub colour: Option<[u8; 3]>,
}

impl ShownDimension {
    /// The position of the value in the text.
    pub const VALUE: &'static str = "{}";
}
