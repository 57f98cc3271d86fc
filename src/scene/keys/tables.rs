//! The keys of a scene file.

use super::Holds::{
    Any, Colour, Flag, Formula, Formulas, Named, Rows, Table, Tables, Text, Texts, Word,
};
use super::shapes::SHAPE;
use super::{Holds, Key, Keys, NONE};

const fn key(name: &'static str, holds: Holds, says: &'static str) -> Key {
    Key::new(name, holds, says)
}

const FORMULAS_BY_NAME: Holds = Named(&[Formula]);

/// A whole scene.
pub static SCENE: Keys = Keys::new(
    "scene",
    &[
        key("title", Text, "text in the corner of the picture"),
        key("description", Text, "one line for lists"),
        key("source", Text, "where equations and dimensions come from"),
        key("units", Table(&UNITS), "units of lengths and angles"),
        key(
            "duration",
            Formula,
            "length of the motion in seconds; the last keyframe if absent",
        ),
        key(
            "parameters",
            FORMULAS_BY_NAME,
            "constants, from the top down",
        ),
        key(
            "inputs",
            Named(&[Formula, Table(&INPUT)]),
            "driven coordinates over the time t in seconds",
        ),
        key(
            "chains",
            FORMULAS_BY_NAME,
            "products of elementary transforms",
        ),
        key(
            "loops",
            FORMULAS_BY_NAME,
            "products that must be the identity",
        ),
        key("equations", FORMULAS_BY_NAME, "formulas that must be zero"),
        key(
            "contacts",
            Named(&[Table(&CONTACT)]),
            "pairs of surfaces that touch",
        ),
        key("guess", FORMULAS_BY_NAME, "start values of unknowns"),
        key("bodies", Tables(&BODY), "links with their solids"),
        key("traces", Tables(&TRACE), "points whose paths are kept"),
        key(
            "outputs",
            Named(&[Formula, Table(&DISTANCE)]),
            "named values of every pose",
        ),
        key(
            "tracks",
            Named(&[Table(&TRACK)]),
            "poses beside the drive, with inputs in equal steps",
        ),
        key(
            "measures",
            Named(&[Formula, Table(&MEASURE)]),
            "single numbers of a whole motion",
        ),
        key("labels", Tables(&LABEL), "texts in the picture"),
        key(
            "clearance",
            Table(&CLEARANCE),
            "distances that bodies must keep",
        ),
        key("plots", Tables(&PLOT), "what `mechanim plot` draws"),
        key("view", Table(&VIEW), "how the scene is seen"),
        key("study", Table(&STUDY), "what may vary, and what is asked"),
    ],
);

static UNITS: Keys = Keys::new(
    "units",
    &[
        key("length", Text, "name of the unit of lengths"),
        key("angle", Word(&["rad", "deg"]), "unit of angles"),
    ],
);

/// An input that is no plain formula.
pub static INPUT: Keys = Keys::new(
    "input",
    &[
        key("formula", Formula, "a formula of the time t"),
        key("keys", Rows(2), "time and value of every key"),
        key(
            "ease",
            Word(&["linear", "smooth", "smoother", "step"]),
            "how values change between keys",
        ),
    ],
);

/// A contact of two surfaces.
pub static CONTACT: Keys = Keys::new(
    "contact",
    &[
        key("first", Table(&SURFACE), "one surface").required(),
        key("second", Table(&SURFACE), "the other surface").required(),
    ],
);

static SURFACE: Keys = Keys::with_one_of(
    "surface",
    &[
        key("torus", Table(&RING), "about the z axis"),
        key("sphere", Table(&BALL), "about the origin"),
        key("cylinder", Table(&BALL), "about the z axis, without ends"),
        key(
            "plane",
            Table(&NONE),
            "the xy plane, with the other body above it",
        ),
        key(
            "frame",
            Formula,
            "chain from the world; the world if absent",
        ),
    ],
    &["torus", "sphere", "cylinder", "plane"],
);

static RING: Keys = Keys::new(
    "torus surface",
    &[
        key("ring", Formula, "radius of the centre circle").required(),
        key("tube", Formula, "radius of the tube").required(),
    ],
);

static BALL: Keys = Keys::new(
    "round surface",
    &[key("radius", Formula, "radius").required()],
);

static BODY: Keys = Keys::new(
    "body",
    &[
        key("name", Text, "its name").required(),
        key(
            "frame",
            Formula,
            "the chain world_from_body; the world if absent",
        ),
        key("colour", Colour, "colour of its shapes"),
        key("opacity", Formula, "0 to 1; below 1 it is translucent"),
        key("shapes", Tables(&SHAPE), "its solids"),
    ],
);

static TRACE: Keys = Keys::new(
    "trace",
    &[
        key("name", Text, "its name").required(),
        key("body", Text, "the body that it belongs to").required(),
        key("point", Formulas(3), "in the body's frame"),
        key("colour", Colour, "colour of its path"),
        key("radius", Formula, "radius of the path as drawn"),
    ],
);

/// A track.
pub static TRACK: Keys = Keys::new(
    "track",
    &[
        key("samples", Formula, "number of poses").required(),
        key(
            "inputs",
            Named(&[Formula, Formulas(2)]),
            "each input's value, or its first and last value",
        ),
    ],
);

/// A measure that is no plain formula.
/// An output that is no formula.
pub static DISTANCE: Keys = Keys::new(
    "output",
    &[
        key(
            "distance",
            Texts,
            "two bodies; `*` at the end for all that begin so",
        )
        .required(),
        key(
            "shapes",
            Rows(2),
            "of the bodies, counted from 1: only these",
        ),
    ],
);

pub static MEASURE: Keys = Keys::new(
    "measure",
    &[
        key("track", Text, "over which poses; the drive if absent"),
        key(
            "of",
            Any(&[Formula, Formulas(0)]),
            "a formula; two for the path of chord and bow",
        )
        .required(),
        key("per", Text, "an input: the derivative by it is taken"),
        key(
            "take",
            Word(&[
                "first", "last", "change", "min", "max", "range", "largest", "positive", "sum",
                "mean", "norm", "chord", "bow",
            ]),
            "how one number is made of the row of values",
        )
        .required(),
        key("power", Formula, "of a norm; 2 if absent"),
        key("min", Formula, "lower limit"),
        key("max", Formula, "upper limit"),
        key("why", Text, "words for a broken limit"),
    ],
);

static LABEL: Keys = Keys::new(
    "label",
    &[
        key("text", Text, "what it says").required(),
        key("body", Text, "the body that it is fixed to"),
        key("point", Formulas(3), "its point in the body's frame"),
        key("trace", Text, "the trace that it stands on"),
        key("time", Formula, "where on the trace, in seconds"),
        key("colour", Colour, "its colour"),
        key("size", Formula, "as a fraction of the picture's height"),
        key("leader", Flag, "stands beside its point, with a line to it"),
        key("hides", Flag, "gone while another body hides its point"),
    ],
);

static CLEARANCE: Keys = Keys::new(
    "clearance",
    &[
        key("minimum", Formula, "least distance of any two bodies"),
        key("pairs", Tables(&PAIR), "minima of single pairs"),
        key("ignore", Tables(&IGNORED), "pairs that are not judged"),
        key(
            "touching",
            Tables(&TOUCHING),
            "pairs in contact all the time",
        ),
    ],
);

const BOTH: Key = key("pair", Texts, "names of two bodies").required();

static PAIR: Keys = Keys::new(
    "pair",
    &[
        BOTH,
        key("minimum", Formula, "their least distance").required(),
    ],
);

static IGNORED: Keys = Keys::new(
    "ignored pair",
    &[
        BOTH,
        key("reason", Text, "why they may come near").required(),
        key("shapes", Rows(2), "shapes that are left out, by number"),
        key("down_to", Formula, "distance that still passes, negative"),
    ],
);

static TOUCHING: Keys = Keys::new("touching pair", &[BOTH]);

static PLOT: Keys = Keys::new(
    "plot",
    &[
        key("title", Text, "text above the plot"),
        key("x", Formula, "what the curves are drawn against"),
        key("y", Formulas(0), "the curves").required(),
        key("equal", Flag, "a unit is as long on both axes"),
        key("angle", Word(&["rad", "deg"]), "unit of angles in it"),
        key("marks", Rows(2), "reference points"),
        key("lines", Rows(4), "reference lines"),
    ],
);

static VIEW: Keys = Keys::new(
    "view",
    &[
        key("azimuth", Formula, "where the viewer stands, in degrees"),
        key("elevation", Formula, "height above the horizon, in degrees"),
        key("up", Word(&["z", "y", "x"]), "the axis that points up"),
        key(
            "projection",
            Word(&["perspective", "orthographic"]),
            "kind of projection",
        ),
        key("fov", Formula, "vertical angle of a perspective, degrees"),
        key("margin", Formula, "free border, as a fraction"),
        key(
            "from",
            Word(&["iso", "front", "top", "side", "four"]),
            "direction by name",
        ),
        key("theme", Word(&["light", "dark"]), "colours around bodies"),
        key("background", Colour, "in place of the theme's"),
        key("transparent", Flag, "no background, in PNG and APNG"),
        key(
            "trails",
            Word(&["full", "fading", "none"]),
            "how traced paths are drawn",
        ),
        key("trail_length", Formula, "seconds that a fading trail holds"),
        key("ghosts", Formula, "how many earlier poses stay"),
        key("ghost_times", Formulas(0), "poses at these seconds stay"),
        key("arrows", Flag, "velocity arrows on traced points"),
        key(
            "arrow_scale",
            Formula,
            "seconds of motion that an arrow is long",
        ),
        key(
            "axes",
            Word(&["none", "world", "bodies", "all"]),
            "axes of frames",
        ),
        key("gauge", Flag, "gauges of the inputs"),
        key("joints", Flag, "joints drawn by kind"),
        key(
            "ground",
            Formula,
            "\"auto\", \"none\", or a height along the up axis",
        ),
        key("orbit", Formula, "degrees that the camera turns"),
        key("camera_path", Tables(&CAMERA), "keys of a moving camera"),
        key("fps", Formula, "frames a second"),
        key(
            "captions",
            Flag,
            "title and inputs are written in the corners",
        ),
    ],
);

static CAMERA: Keys = Keys::new(
    "camera key",
    &[
        key("t", Formula, "seconds"),
        key("azimuth", Formula, "degrees"),
        key("elevation", Formula, "degrees"),
        key("zoom", Formula, "1 where the whole motion just fits"),
        key(
            "distance",
            Formula,
            "of the eye from the target, in place of zoom",
        ),
        key("target", Formulas(3), "the point in the picture's middle"),
    ],
);

static STUDY: Keys = Keys::new(
    "study",
    &[
        key(
            "variables",
            Named(&[Table(&VARIABLE)]),
            "parameters that may change",
        ),
        key("minimise", Text, "the measure that is made small"),
        key(
            "limits",
            Named(&[Table(&LIMIT)]),
            "what the study asks of measures",
        ),
        key(
            "printed",
            FORMULAS_BY_NAME,
            "what the source prints of measures",
        ),
        key("note", Text, "one line about what is studied"),
    ],
);

/// A variable of a study.
pub static VARIABLE: Keys = Keys::new(
    "variable",
    &[
        key("range", Formulas(2), "least and largest value"),
        key("tolerance", Formula, "by how much it may be off"),
    ],
);

/// A limit of a study.
pub static LIMIT: Keys = Keys::new(
    "limit",
    &[
        key("min", Formula, "lower limit"),
        key("max", Formula, "upper limit"),
    ],
);
