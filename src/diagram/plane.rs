//! The plane of the drawing: from where one looks, and how long a unit is.

use super::scheme::Scheme;
use crate::plot::primitive::Rect;
use glam::{DMat3, DVec3};

/// A point in the drawing: pixels from the top left corner.
pub type DrawnSpot = [f64; 2];

/// A direction that is no longer than this has no direction; a pixel is one.
pub(super) const NO_LENGTH: f64 = 1e-9;

/// A direction, or an offset from another point.
pub fn spot_difference(a: DrawnSpot, b: DrawnSpot) -> DrawnSpot {
    [a[0] - b[0], a[1] - b[1]]
}

/// `a + s d`
pub fn spot_ahead(a: DrawnSpot, d: DrawnSpot, s: f64) -> DrawnSpot {
    [a[0] + s * d[0], a[1] + s * d[1]]
}

/// Length of a direction.
pub fn spot_length(d: DrawnSpot) -> f64 {
    libm::hypot(d[0], d[1])
}

/// The unit vector of a direction; `None` for the zero vector.
pub fn unit_direction(d: DrawnSpot) -> Option<DrawnSpot> {
    let length = spot_length(d);
    (length > NO_LENGTH).then(|| [d[0] / length, d[1] / length])
}

/// A quarter turn from x towards y.
pub fn quarter_turn(d: DrawnSpot) -> DrawnSpot {
    [-d[1], d[0]]
}

/// A parallel projection onto the drawing.
#[derive(Clone, Copy, Debug)]
pub struct DrawingPlane {
    /// Right, up, and towards the viewer.
    axes: DMat3,
    /// Pixels of a unit.
    pub scale: f64,
    /// Where the origin of the world is.
    origin: DrawnSpot,
    /// Pixels.
    pub size: [f64; 2],
}

/// Width of a drawing in pixels unless requested otherwise; lengths in a drawing refer to this width.
pub const USUAL_WIDTH: f64 = 1200.0;

/// Free borders of the drawing in pixels: room for labels.
const BORDER: f64 = 105.0;

/// Least and greatest height of the drawing over its width.
const HEIGHTS: [f64; 2] = [0.34, 0.82];

/// What is drawn extends over at least this share of the mechanism's size: a point has no scale.
const LEAST_EXTENT: f64 = 1e-3;

impl DrawingPlane {
    /// Holds all places of a scheme in a drawing of the given width.
    pub fn fitted(axes: DMat3, scheme: &Scheme, width: f64) -> Self {
        let border = BORDER * width / USUAL_WIDTH;
        let seen = axes.transpose();
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for place in scheme.places().filter(|p| p.is_finite()) {
            let p = seen * place;
            for (k, value) in [p.x, -p.y].into_iter().enumerate() {
                (low[k], high[k]) = (low[k].min(value), high[k].max(value));
            }
        }
        if low[0] > high[0] {
            (low, high) = ([-0.5; 2], [0.5; 2]);
        }
        let least = LEAST_EXTENT * scheme.size;
        let extent = [0, 1].map(|k| (high[k] - low[k]).max(least));
        let free = [width - 2.0 * border, width * HEIGHTS[1] - 2.0 * border];
        let scale = (free[0] / extent[0]).min(free[1] / extent[1]);
        // Points that all coincide need no height of their own.
        let drawn = scale * (high[1] - low[1]);
        let height = (drawn + 2.0 * border).max(width * HEIGHTS[0]);
        let middle = [0, 1].map(|k| 0.5 * (low[k] + high[k]));
        Self {
            axes,
            scale,
            origin: [
                0.5 * width - scale * middle[0],
                0.5 * height - scale * middle[1],
            ],
            size: [width, height],
        }
    }

    /// Where a point in space is drawn.
    pub fn spot(&self, place: DVec3) -> DrawnSpot {
        spot_ahead(self.origin, self.direction(place), self.scale)
    }

    /// A direction of the world in the drawing; shorter than one where it is foreshortened.
    pub fn direction(&self, v: DVec3) -> DrawnSpot {
        [self.axes.x_axis.dot(v), -self.axes.y_axis.dot(v)]
    }

    /// How much of a direction comes towards the viewer.
    pub fn nearness(&self, v: DVec3) -> f64 {
        self.axes.z_axis.dot(v)
    }

    /// Towards the viewer.
    pub fn viewer_direction(&self) -> DVec3 {
        self.axes.z_axis
    }

    /// The whole drawing less a rim.
    pub fn inside(&self, rim: f64) -> Rect {
        Rect {
            left: rim,
            top: rim,
            right: self.size[0] - rim,
            bottom: self.size[1] - rim,
        }
    }
}

/// The axes of a drawing of a plane seen from its front: right and up in the world stay right and up.
pub fn facing_axes(normal: DVec3) -> DMat3 {
    let most = (0..3).max_by(|a, b| normal[*a].abs().total_cmp(&normal[*b].abs()));
    // The axis that points up in the drawing: y, but z where y is seen end-on.
    let (up, right) = match most {
        Some(0) => (DVec3::Z, DVec3::Y),
        Some(1) => (DVec3::Z, DVec3::X),
        _ => (DVec3::Y, DVec3::X),
    };
    let back = normal.normalize_or(DVec3::Z);
    let back = if right.cross(up).dot(back) < 0.0 {
        -back
    } else {
        back
    };
    let right = (right - back * right.dot(back)).normalize_or(DVec3::X);
    DMat3::from_cols(right, back.cross(right), back)
}
