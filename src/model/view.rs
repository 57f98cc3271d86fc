//! How a scene wants to be seen: camera direction, ground, labels. Plain data, no pixels.

use glam::DVec3;

/// Which world axis points up in the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum UpAxis {
    X,
    Y,
    Z,
}

/// Kind of projection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ViewProjection {
    /// With the given full vertical angle in radians.
    Perspective {
        /// Full vertical angle in radians.
        fov_y: f64,
    },
    /// Parallel.
    Orthographic,
}

/// A text fixed in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneLabel {
    /// The text.
    pub text: String,
    /// Where it is.
    pub place: LabelPlace,
    /// sRGB colour.
    pub colour: [u8; 3],
    /// Height of a line of text, as a fraction of the picture's height.
    pub size: f64,
}

/// What a label is fixed to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LabelPlace {
    /// A point of a body, moving with it.
    OnBody {
        /// Index of the body.
        body: usize,
        /// The point in its frame.
        point: DVec3,
    },
    /// Where a trace is at the given time; stays there.
    OnTrace {
        /// Index of the trace.
        trace: usize,
        /// Seconds.
        time: f64,
        /// Shift in the world.
        offset: DVec3,
    },
}

/// The view of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Direction from which one looks, in radians about the up axis, 0 along the axis that follows it (x for z up).
    pub azimuth: f64,
    /// Height of the viewer above the horizon in radians.
    pub elevation: f64,
    /// World axis that points up.
    pub up: UpAxis,
    /// Kind of projection.
    pub projection: ViewProjection,
    /// Free border around the motion as a fraction of the picture.
    pub margin: f64,
    /// sRGB background.
    pub background: [u8; 3],
    /// Height of the ground along the up axis; `Auto` puts it below the motion.
    pub ground: GroundPlace,
    /// Frames a second unless asked otherwise.
    pub fps: f64,
    /// Whether title and input values are written in the corners.
    pub captions: bool,
    /// Texts in the world.
    pub labels: Vec<SceneLabel>,
}

/// Where the ground is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GroundPlace {
    /// No ground.
    None,
    /// Just below the lowest point of the motion.
    Auto,
    /// At this coordinate along the up axis.
    At(f64),
}
