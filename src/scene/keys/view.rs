//! The keys of `[view]` in scenes, and those of them that a list of pictures may replace.

use super::Holds::{Colour, Flag, Formula, Formulas, Tables, Word};
use super::{Key, Keys, words};
use crate::model::theme::Theme;
use crate::model::view::{
    EdgeLines, NamedView, Shadows, ShownAxes, Trails, UpAxis, ViewProjection,
};

static UP_WORDS: [&str; UpAxis::NAMES.len()] = words(&UpAxis::NAMES);
static PROJECTION_WORDS: [&str; ViewProjection::NAMES.len()] = words(&ViewProjection::NAMES);
static FROM_WORDS: [&str; NamedView::NAMES.len()] = words(&NamedView::NAMES);
static THEME_WORDS: [&str; Theme::NAMES.len()] = words(&Theme::NAMES);
static EDGES_WORDS: [&str; EdgeLines::NAMES.len()] = words(&EdgeLines::NAMES);
static SHADOWS_WORDS: [&str; Shadows::NAMES.len()] = words(&Shadows::NAMES);
static TRAILS_WORDS: [&str; Trails::NAMES.len()] = words(&Trails::NAMES);
static AXES_WORDS: [&str; ShownAxes::NAMES.len()] = words(&ShownAxes::NAMES);

pub(crate) const AZIMUTH: Key = Key::new("azimuth", Formula, "direction of the viewer, in degrees");
pub(crate) const ELEVATION: Key =
    Key::new("elevation", Formula, "height above the horizon, in degrees");
pub(crate) const PROJECTION: Key =
    Key::new("projection", Word(&PROJECTION_WORDS), "kind of projection");
pub(crate) const FOV: Key = Key::new("fov", Formula, "vertical angle of a perspective, degrees");
pub(crate) const FROM: Key = Key::new("from", Word(&FROM_WORDS), "direction by name");
pub(crate) const THEME: Key = Key::new("theme", Word(&THEME_WORDS), "colours around bodies");
pub(crate) const EDGES: Key = Key::new("edges", Word(&EDGES_WORDS), "lines between surfaces");
pub(crate) const SHADOWS: Key = Key::new("shadows", Word(&SHADOWS_WORDS), "where shadows fall");
pub(crate) const BACKGROUND: Key = Key::new("background", Colour, "in place of the theme's");
pub(crate) const TRAILS: Key =
    Key::new("trails", Word(&TRAILS_WORDS), "how traced paths are drawn");
pub(crate) const GHOSTS: Key =
    Key::new("ghosts", Formula, "number of earlier poses that are shown");
pub(crate) const ARROWS: Key = Key::new("arrows", Flag, "velocity arrows on traced points");
pub(crate) const AXES: Key = Key::new("axes", Word(&AXES_WORDS), "axes of frames");
pub(crate) const GAUGE: Key = Key::new("gauge", Flag, "gauges of the inputs");
pub(crate) const JOINTS: Key = Key::new("joints", Flag, "joints drawn by kind");
pub(crate) const SCALE: Key = Key::new("scale", Flag, "scale bar, or the pitch of the grid");
pub(crate) const ORBIT: Key = Key::new("orbit", Formula, "degrees that the camera turns");
pub(crate) const CAPTIONS: Key = Key::new(
    "captions",
    Flag,
    "title and inputs are written in the corners",
);

/// `[view]` of a scene.
pub static VIEW: Keys = Keys::new(
    "view",
    &[
        AZIMUTH,
        ELEVATION,
        Key::new("up", Word(&UP_WORDS), "the axis that points up"),
        PROJECTION,
        FOV,
        Key::new("margin", Formula, "free border, as a fraction"),
        FROM,
        THEME,
        EDGES,
        SHADOWS,
        BACKGROUND,
        Key::new("transparent", Flag, "no background, in PNG and APNG"),
        TRAILS,
        Key::new(
            "trail_length",
            Formula,
            "length of a fading trail in seconds",
        ),
        Key::new("ticks", Formula, "seconds between the marks on a path"),
        GHOSTS,
        Key::new(
            "ghost_times",
            Formulas(0),
            "shows the poses at these times in seconds",
        ),
        ARROWS,
        Key::new(
            "arrow_scale",
            Formula,
            "length of arrows, in seconds of motion",
        ),
        AXES,
        SCALE,
        GAUGE,
        JOINTS,
        Key::new(
            "ground",
            Formula,
            "\"auto\", \"none\", or a height along the up axis",
        ),
        ORBIT,
        Key::new("camera_path", Tables(&CAMERA), "keys of a moving camera"),
        Key::new("fps", Formula, "frames a second"),
        Key::new("bounce", Flag, "plays forwards, then backwards"),
        Key::new("pause", Formula, "seconds that the ends are shown for"),
        CAPTIONS,
    ],
);

static CAMERA: Keys = Keys::new(
    "camera key",
    &[
        Key::new("t", Formula, "seconds"),
        Key::new("azimuth", Formula, "degrees"),
        Key::new("elevation", Formula, "degrees"),
        Key::new("zoom", Formula, "1 where the whole motion just fits"),
        Key::new(
            "distance",
            Formula,
            "of the eye from the target, in place of zoom",
        ),
        Key::new(
            "target",
            Formulas(3),
            "the point in the middle of the picture",
        ),
    ],
);
