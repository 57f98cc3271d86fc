//! The keys of `[view]` in scenes, and those of them that a list of pictures may replace.

use super::Holds::{Colour, Flag, Formula, Formulas, Table, Tables, Texts, Word};
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

pub(crate) const AZIMUTH: Key = Key::new(
    "azimuth",
    Formula,
    "direction of the viewer in degrees, counter-clockwise about the up axis: from x towards y with z up, from x towards −z \
     with y up, from −z towards y with x up; default: −60",
);
pub(crate) const ELEVATION: Key = Key::new(
    "elevation",
    Formula,
    "height of the viewer above the horizon in degrees; default: 22",
);
pub(crate) const PROJECTION: Key = Key::new(
    "projection",
    Word(&PROJECTION_WORDS),
    "default: `perspective`",
);
pub(crate) const FOV: Key = Key::new(
    "fov",
    Formula,
    "vertical field of view of a perspective, in degrees; default: 24",
);
pub(crate) const FROM: Key = Key::new(
    "from",
    Word(&FROM_WORDS),
    "a named direction, in parallel projection; `four`: top, front and side around the scene's own view, in one picture. \
     `azimuth`, `elevation` and `projection` have priority",
);
pub(crate) const THEME: Key = Key::new(
    "theme",
    Word(&THEME_WORDS),
    "colours of background, text and ground; default: `light`",
);
pub(crate) const EDGES: Key = Key::new(
    "edges",
    Word(&EDGES_WORDS),
    "lines between surfaces: silhouettes, creases and borders (`all`, the default), or only around bodies and where one \
     meets another (`outline`)",
);
pub(crate) const SHADOWS: Key = Key::new(
    "shadows",
    Word(&SHADOWS_WORDS),
    "`all`: also soft shadows of the key light on bodies, and darker regions where bodies are close to each other, which \
     takes longer to draw; default: `ground`. Translucent bodies cast a pale shadow on the ground and none on bodies",
);
pub(crate) const BACKGROUND: Key = Key::new("background", Colour, "default: the theme's");
pub(crate) const TRAILS: Key = Key::new(
    "trails",
    Word(&TRAILS_WORDS),
    "paths of traced points: the whole path thin and pale, with the part covered so far over it (`whole`, the default), only \
     the part covered so far (`grow`), or its last part, fading into the background",
);
pub(crate) const GHOSTS: Key = Key::new(
    "ghosts",
    Formula,
    "number of earlier poses that are shown as translucent bodies, evenly spread over the motion",
);
pub(crate) const ARROWS: Key = Key::new("arrows", Flag, "velocity arrows on traced points");
pub(crate) const AXES: Key = Key::new(
    "axes",
    Word(&AXES_WORDS),
    "x orange, y green, z blue; `corner`: directions of the world in the lower right corner. Default: `none`",
);
pub(crate) const GAUGE: Key = Key::new(
    "gauge",
    Flag,
    "shows the inputs as gauges with their ranges instead of numbers",
);
pub(crate) const JOINTS: Key = Key::new(
    "joints",
    Flag,
    "draws symbols of the joints in the chains, and hatched ground where they are fixed to the frame; bodies are faded",
);
pub(crate) const SCALE: Key = Key::new(
    "scale",
    Flag,
    "a scale bar in parallel projections; in a perspective, the pitch of the ground's grid",
);
pub(crate) const ORBIT: Key = Key::new(
    "orbit",
    Formula,
    "degrees by which the camera turns about the up axis during the motion, at constant speed; 360 gives a seamless loop",
);
pub(crate) const SECTION: Key = Key::new(
    "section",
    Table(&SECTION_KEYS),
    "a plane at which pictures cut bodies (3-D models stay whole); cut faces are drawn flat and hatched",
);
pub(crate) const SECTION_POINT: Key =
    Key::new("point", Formulas(3), "a point of the plane, in the world").required();
pub(crate) const SECTION_NORMAL: Key = Key::new(
    "normal",
    Formulas(3),
    "a direction across the plane; it points to the side that is removed",
)
.required();
pub(crate) const EXPLODE: Key = Key::new(
    "explode",
    Formula,
    "moves every body away from the middle of all bodies, by this many times the distance of its own middle from there at \
     the first pose; dashed lines lead to the true places. Traces and joint symbols stay, labels of bodies move with them, \
     dimensions are left out. Default: 0",
);
pub(crate) const CAPTIONS: Key = Key::new(
    "captions",
    Flag,
    "title and inputs are written in the corners; default: true",
);

/// `[view]` of a scene.
pub static VIEW: Keys = Keys::new(
    "view",
    &[
        AZIMUTH,
        ELEVATION,
        Key::new(
            "up",
            Word(&UP_WORDS),
            "the axis that points up; default: `z`",
        ),
        PROJECTION,
        FOV,
        Key::new(
            "margin",
            Formula,
            "free border, as a fraction; default: 0.06",
        ),
        FROM,
        THEME,
        EDGES,
        SHADOWS,
        BACKGROUND,
        Key::new("transparent", Flag, "no background; for PNG and APNG"),
        TRAILS,
        Key::new(
            "trail_length",
            Formula,
            "length of a fading trail in seconds; default: a quarter of the motion",
        ),
        Key::new(
            "ticks",
            Formula,
            "seconds between marks on the traced paths: wider spacing means higher speed. At most 1000 on a path",
        ),
        GHOSTS,
        Key::new(
            "ghost_times",
            Formulas(0),
            "shows the poses at these times in seconds once they have passed, in place of `ghosts`",
        ),
        ARROWS,
        Key::new(
            "arrow_scale",
            Formula,
            "length of the arrows, in seconds of motion; by default, the longest arrow is a sixth of the motion's extent",
        ),
        AXES,
        SCALE,
        GAUGE,
        JOINTS,
        Key::new(
            "ground",
            Formula,
            "`\"auto\"`, `\"none\"`, or a height along the up axis",
        ),
        SECTION,
        EXPLODE,
        ORBIT,
        Key::new("camera_path", Tables(&CAMERA), "keys of a moving camera"),
        Key::new("fps", Formula, "frames per second; default: 20"),
        Key::new("bounce", Flag, "plays the motion forwards, then backwards"),
        Key::new(
            "pause",
            Formula,
            "seconds for which the first and the last pose stay longer; at most 60",
        ),
        CAPTIONS,
    ],
);

static SECTION_KEYS: Keys = Keys::new(
    "section",
    &[
        SECTION_POINT,
        SECTION_NORMAL,
        Key::new(
            "bodies",
            Texts(0),
            "names of the bodies that are cut; default: all",
        ),
    ],
);

static CAMERA: Keys = Keys::new(
    "camera key",
    &[
        Key::new(
            "t",
            Formula,
            "seconds, increasing from key to key; a path with a single key (a fixed camera) needs none",
        ),
        Key::new(
            "azimuth",
            Formula,
            "degrees; azimuths that differ by 360 mean a full turn",
        ),
        Key::new("elevation", Formula, "degrees"),
        Key::new(
            "zoom",
            Formula,
            "1 if the whole motion just fits, 2 for twice that size",
        ),
        Key::new(
            "distance",
            Formula,
            "of the eye from the target, in the scene's unit; a parallel projection shows the height that a perspective of \
             24° would show at the target",
        )
        .without("zoom"),
        Key::new(
            "target",
            Formulas(3),
            "the point in the middle of the picture; default: the middle of the motion",
        ),
    ],
);
