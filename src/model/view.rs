//! How a scene is shown: camera direction, ground, labels. Plain data, without pixels.

use super::camera_path::CameraPath;
use super::mechanism::Mechanism;
use super::section::Section;
use super::shape::Shape;
use super::shown_dimension::ShownDimension;
use super::theme::Theme;
use glam::DVec3;

/// Which world axis points up in the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum UpAxis {
    X,
    Y,
    Z,
}

impl UpAxis {
    /// Names in scene files; the first is the default, here as below.
    pub const NAMES: [(&'static str, Self); 3] = [("z", Self::Z), ("y", Self::Y), ("x", Self::X)];

    /// Its direction.
    pub const fn axis(self) -> DVec3 {
        match self {
            Self::X => DVec3::X,
            Self::Y => DVec3::Y,
            Self::Z => DVec3::Z,
        }
    }
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

impl ViewProjection {
    /// Names in files and options, and whether the rays are parallel.
    pub const NAMES: [(&'static str, bool); 2] = [("perspective", false), ("orthographic", true)];

    /// A perspective of 24 degrees, like that of a telephoto lens, with little distortion.
    pub const DEFAULT: Self = Self::Perspective {
        fov_y: 24.0 * std::f64::consts::PI / 180.0,
    };
}

/// Directions that have a name; all are parallel projections.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NamedView {
    /// All three axes equally foreshortened.
    Iso,
    /// Against the second horizontal axis (y for z up).
    Front,
    /// Against the up axis.
    Top,
    /// Against the first horizontal axis (x for z up).
    Side,
    /// Top, front, side and the scene's own perspective in one picture.
    Four,
}

impl NamedView {
    /// Names in files and options.
    pub const NAMES: [(&'static str, Self); 5] = [
        ("iso", Self::Iso),
        ("front", Self::Front),
        ("top", Self::Top),
        ("side", Self::Side),
        ("four", Self::Four),
    ];
}

/// Earlier poses that stay as translucent bodies.
#[derive(Clone, Debug, PartialEq)]
pub enum Ghosts {
    /// This many, evenly spaced over the motion.
    Count(usize),
    /// At these times in seconds.
    Times(Vec<f64>),
}

/// How traced paths are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Trails {
    /// The whole path, thin and pale, and over it the part travelled so far.
    Whole,
    /// The path travelled since the start of the motion.
    Grow,
    /// The last part only, fading into the background; its length in seconds, a quarter of the motion if `None`.
    Fading(Option<f64>),
    /// Not at all.
    None,
}

impl Trails {
    /// Names in files and options; the length of a fading one is a separate key.
    pub const NAMES: [(&'static str, Self); 4] = [
        ("whole", Self::Whole),
        ("grow", Self::Grow),
        ("fading", Self::Fading(None)),
        ("none", Self::None),
    ];
}

/// Lines between surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EdgeLines {
    /// None.
    None,
    /// Around bodies: silhouettes and where one body meets another.
    Outline,
    /// Also at creases and where the solids of a body meet.
    #[default]
    All,
}

impl EdgeLines {
    /// Names in files and options.
    pub const NAMES: [(&'static str, Self); 3] = [
        ("all", Self::All),
        ("outline", Self::Outline),
        ("none", Self::None),
    ];
}

/// Which frames show their axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum ShownAxes {
    None,
    World,
    Bodies,
    All,
    Corner,
}

impl ShownAxes {
    /// Names in files and options.
    pub const NAMES: [(&'static str, Self); 5] = [
        ("none", Self::None),
        ("world", Self::World),
        ("bodies", Self::Bodies),
        ("all", Self::All),
        ("corner", Self::Corner),
    ];
}

/// What a picture shows in addition to the bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct Decor {
    /// Earlier poses.
    pub ghosts: Ghosts,
    /// Traced paths.
    pub trails: Trails,
    /// Velocity arrows on traced points.
    pub arrows: bool,
    /// Seconds of motion that an arrow is long; `None` suits the fastest arrow to the picture.
    pub arrow_scale: Option<f64>,
    /// Axes of frames.
    pub axes: ShownAxes,
    /// Seconds between the marks on traced paths, if there are any.
    pub ticks: Option<f64>,
    /// A scale bar in a parallel projection, the pitch of the ground's grid in a perspective.
    pub scale: bool,
    /// Gauges of the inputs.
    pub gauge: bool,
    /// Joints drawn by kind, found in the chains.
    pub joints: bool,
}

impl Default for Decor {
    fn default() -> Self {
        Self {
            ghosts: Ghosts::Count(0),
            trails: Trails::Whole,
            arrows: false,
            arrow_scale: None,
            axes: ShownAxes::None,
            ticks: None,
            scale: false,
            gauge: false,
            joints: false,
        }
    }
}

/// A text fixed in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneLabel {
    /// The text.
    pub text: String,
    /// Where it is.
    pub place: LabelPlace,
    /// sRGB colour; the theme's ink if `None`.
    pub colour: Option<[u8; 3]>,
    /// Placed next to its point, with a leader.
    pub leader: bool,
    /// Not drawn while a body hides its point.
    pub hides: bool,
    /// Not drawn where it would cover an earlier label.
    pub yields: bool,
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
    /// The position of a trace at the given time; it stays there.
    OnTrace {
        /// Index of the trace.
        trace: usize,
        /// Seconds.
        time: f64,
        /// Shift in the world.
        offset: DVec3,
    },
}

/// The playback of a film from its first picture to the next round.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Playback {
    /// Forwards, then backwards.
    pub bounce: bool,
    /// Seconds for which its first and its last pose are shown, in addition to the time of their own picture.
    pub pause: f64,
}

impl Playback {
    /// Longest pause in seconds; anything longer is an error.
    pub const LONGEST_PAUSE: f64 = 60.0;
}

/// Shadows, and the ambient light that neighbouring bodies hide from each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shadows {
    /// On the ground only.
    #[default]
    Ground,
    /// On bodies and on the ground.
    All,
    /// None.
    None,
}

impl Shadows {
    /// Names in files and options.
    pub const NAMES: [(&'static str, Self); 3] = [
        ("ground", Self::Ground),
        ("all", Self::All),
        ("none", Self::None),
    ];
}

/// The view of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Direction from which one looks, in radians about the up axis, 0 along the axis that follows it (x for z up).
    pub azimuth: f64,
    /// Height of the viewer above the horizon in radians.
    pub elevation: f64,
    /// Whether the scene or its user gives the direction: if not, a flat mechanism that draws itself is looked at squarely.
    pub is_aimed: bool,
    /// World axis that points up.
    pub up: UpAxis,
    /// Kind of projection.
    pub projection: ViewProjection,
    /// Free border around the motion as a fraction of the picture.
    pub margin: f64,
    /// Whether top, front and side views surround the view described here.
    pub four: bool,
    /// Colours of everything that is not part of the mechanism.
    pub theme: Theme,
    /// No background: for formats that have alpha.
    pub transparent: bool,
    /// sRGB background.
    pub background: [u8; 3],
    /// Lines between surfaces.
    pub edges: EdgeLines,
    /// Shadows on bodies and on the ground.
    pub shadows: Shadows,
    /// Height of the ground along the up axis; `Auto` puts it below the motion.
    pub ground: GroundPlace,
    /// Default number of frames per second.
    pub fps: f64,
    /// How a film runs.
    pub playback: Playback,
    /// Whether title and input values are written in the corners.
    pub captions: bool,
    /// Texts in the world.
    pub labels: Vec<SceneLabel>,
    /// Lengths and angles with their values.
    pub dimensions: Vec<ShownDimension>,
    /// Additions to the bodies.
    pub decor: Decor,
    /// How the camera moves.
    pub camera_path: CameraPath,
    /// Solids that pictures omit.
    pub hidden: Vec<HiddenSolids>,
    /// Where bodies are cut.
    pub section: Option<Section>,
    /// How far bodies are moved apart, relative to the distances of their centres from the common one; 0 not at all.
    pub explode: f64,
}

/// Solids of a body that pictures omit; they move and are measured like the others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HiddenSolids {
    /// Index of the body.
    pub body: usize,
    /// Only those of this kind, by its word; all if `None`.
    pub kind: Option<String>,
}

impl View {
    /// The solids of a body of `mechanism` that pictures show.
    pub fn shown_shapes<'m>(
        &self,
        mechanism: &'m Mechanism,
        body: usize,
    ) -> impl Iterator<Item = &'m Shape> + use<'m, '_> {
        let shapes = mechanism.bodies[body].shapes.iter();
        shapes.filter(move |shape| {
            let mut hidden = self.hidden.iter().filter(|hidden| hidden.body == body);
            let is_meant = |kind: &str| kind == shape.solid.word();
            !hidden.any(|hidden| hidden.kind.as_deref().is_none_or(is_meant))
        })
    }

    /// Sets a named direction. `Four` keeps the direction, which one of the four views shows.
    pub fn look_from(&mut self, named: NamedView) {
        let iso = libm::atan(std::f64::consts::FRAC_1_SQRT_2);
        let quarter = std::f64::consts::FRAC_PI_2;
        let (azimuth, elevation) = match named {
            NamedView::Iso => (-0.5 * quarter, iso),
            NamedView::Front => (-quarter, 0.0),
            NamedView::Top => (-quarter, quarter),
            NamedView::Side => (0.0, 0.0),
            NamedView::Four => {
                self.four = true;
                return;
            }
        };
        self.four = false;
        self.camera_path = CameraPath::default();
        (self.azimuth, self.elevation) = (azimuth, elevation);
        self.is_aimed = true;
        self.projection = ViewProjection::Orthographic;
    }
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
