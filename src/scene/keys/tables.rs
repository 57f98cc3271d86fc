//! The keys of a scene file.

use super::Holds::{
    Any, Colour, Flag, Formula, Formulas, Named, Rows, Table, Tables, Text, Texts, Word,
};
use super::shapes::SHAPE;
use super::view::VIEW;
use super::{Holds, Key, Keys, NONE, words};
use crate::model::drive::Ease;
use crate::model::measure::Taking;

const fn table_key(name: &'static str, holds: Holds, says: &'static str) -> Key {
    Key::new(name, holds, says)
}

static EASES: [&str; Ease::NAMES.len()] = words(&Ease::NAMES);
static TAKINGS: [&str; Taking::NAMES.len()] = words(&Taking::NAMES);

const FORMULAS_BY_NAME: Holds = Named(&[Formula]);

/// A whole scene.
pub static SCENE: Keys = Keys::new(
    "scene",
    &[
        table_key("title", Text, "text in the corner of the picture"),
        table_key("description", Text, "one line for lists"),
        table_key("source", Text, "where equations and dimensions come from"),
        table_key("units", Table(&UNITS), "units of lengths and angles"),
        table_key(
            "duration",
            Formula,
            "length of the motion in seconds; the last keyframe if absent",
        ),
        table_key(
            "parameters",
            FORMULAS_BY_NAME,
            "constants; each may use those above it",
        ),
        table_key(
            "inputs",
            Named(&[Formula, Table(&INPUT)]),
            "driven coordinates over the time t in seconds",
        ),
        table_key(
            "chains",
            FORMULAS_BY_NAME,
            "products of elementary transforms",
        ),
        table_key(
            "loops",
            FORMULAS_BY_NAME,
            "products that must be the identity",
        ),
        table_key("equations", FORMULAS_BY_NAME, "formulas that must be zero"),
        table_key(
            "bars",
            Named(&[Table(&BAR)]),
            "pairs of points that stay as far apart as they are",
        ),
        table_key(
            "contacts",
            Named(&[Table(&CONTACT)]),
            "pairs of surfaces that touch",
        ),
        table_key("guess", FORMULAS_BY_NAME, "start values of unknowns"),
        table_key("bodies", Tables(&BODY), "links with their solids"),
        table_key("traces", Tables(&TRACE), "points whose paths are kept"),
        table_key(
            "outputs",
            Named(&[Formula, Table(&DISTANCE)]),
            "named values of every pose",
        ),
        table_key(
            "tracks",
            Named(&[Table(&TRACK)]),
            "poses beside the drive, with inputs in equal steps",
        ),
        table_key(
            "measures",
            Named(&[Formula, Table(&MEASURE)]),
            "single numbers of a whole motion",
        ),
        table_key("labels", Tables(&LABEL), "texts in the picture"),
        table_key(
            "dimensions",
            Tables(&DIMENSION),
            "lengths and angles drawn with their values",
        ),
        table_key(
            "clearance",
            Table(&CLEARANCE),
            "distances that bodies must keep",
        ),
        table_key("plots", Tables(&PLOT), "what `mechanim plot` draws"),
        table_key("view", Table(&VIEW), "how the scene is seen"),
        table_key("study", Table(&STUDY), "what may vary, and its objective"),
    ],
);

static UNITS: Keys = Keys::new(
    "units",
    &[
        table_key("length", Text, "name of the unit of lengths"),
        table_key("angle", Word(&["rad", "deg"]), "unit of angles"),
    ],
);

/// An input that is not a plain formula.
pub static INPUT: Keys = Keys::new(
    "input",
    &[
        table_key("formula", Formula, "a formula of the time t"),
        table_key("keys", Rows(2), "time and value of every key"),
        table_key("ease", Word(&EASES), "how values change between keys"),
    ],
);

/// A bar between two points.
pub static BAR: Keys = Keys::new(
    "bar",
    &[
        table_key("from", END, "one end: a point, a chain or a trace").required(),
        table_key("to", END, "the other end").required(),
        table_key("length", Formula, "how far apart they are").required(),
    ],
);

const END: Holds = Any(&[Formula, Formulas(0)]);

/// A contact of two surfaces.
pub static CONTACT: Keys = Keys::new(
    "contact",
    &[
        table_key("first", Table(&SURFACE), "one surface").required(),
        table_key("second", Table(&SURFACE), "the other surface").required(),
    ],
);

static SURFACE: Keys = Keys::with_one_of(
    "surface",
    &[
        table_key("torus", Table(&RING), "about the z axis"),
        table_key("sphere", Table(&BALL), "about the origin"),
        table_key("cylinder", Table(&BALL), "about the z axis, without ends"),
        table_key(
            "plane",
            Table(&NONE),
            "the xy plane, with the other body above it",
        ),
        table_key(
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
        table_key("ring", Formula, "radius of the centre circle").required(),
        table_key("tube", Formula, "radius of the tube").required(),
    ],
);

static BALL: Keys = Keys::new(
    "round surface",
    &[table_key("radius", Formula, "radius").required()],
);

static BODY: Keys = Keys::new(
    "body",
    &[
        table_key("name", Text, "its name").required(),
        table_key(
            "frame",
            Formula,
            "the chain world_from_body; the world if absent",
        ),
        table_key("colour", Colour, "colour of its shapes"),
        table_key("opacity", Formula, "0 to 1; below 1 it is translucent"),
        table_key("shapes", Tables(&SHAPE), "its solids"),
    ],
);

static TRACE: Keys = Keys::new(
    "trace",
    &[
        table_key("name", Text, "its name").required(),
        table_key("body", Text, "the body that it belongs to").required(),
        table_key("point", Formulas(3), "in the body's frame"),
        table_key("colour", Colour, "colour of its path"),
        table_key("radius", Formula, "radius of the path as drawn"),
    ],
);

/// A track.
pub static TRACK: Keys = Keys::new(
    "track",
    &[
        table_key("samples", Formula, "number of poses").required(),
        table_key(
            "inputs",
            Named(&[Formula, Formulas(2)]),
            "each input's value, or its first and last value",
        ),
    ],
);

/// A measure that is not a plain formula. An output that is not a formula.
pub static DISTANCE: Keys = Keys::new(
    "output",
    &[
        table_key(
            "distance",
            Texts,
            "two bodies; `*` at the end stands for any rest of a name",
        )
        .required(),
        table_key(
            "shapes",
            Rows(2),
            "of the bodies, counted from 1: only these",
        ),
    ],
);

pub static MEASURE: Keys = Keys::new(
    "measure",
    &[
        table_key(
            "track",
            Text,
            "the track whose poses are used; the drive if absent",
        ),
        table_key(
            "of",
            Any(&[Formula, Formulas(0)]),
            "a formula; two for the path of chord and bow",
        )
        .required(),
        table_key(
            "per",
            Text,
            "an input: the derivative with respect to it is used",
        ),
        table_key(
            "take",
            Word(&TAKINGS),
            "how the values are reduced to one number",
        )
        .required(),
        table_key("power", Formula, "of a norm; 2 if absent"),
        table_key("min", Formula, "lower limit"),
        table_key("max", Formula, "upper limit"),
        table_key("why", Text, "text that is printed if a limit is violated"),
    ],
);

static LABEL: Keys = Keys::new(
    "label",
    &[
        table_key("text", Text, "what it says").required(),
        table_key("body", Text, "the body that it is fixed to"),
        table_key("point", Formulas(3), "its point in the body's frame"),
        table_key("trace", Text, "the trace that it is placed on"),
        table_key("time", Formula, "where on the trace, in seconds"),
        table_key("colour", Colour, "its colour"),
        table_key("size", Formula, "as a fraction of the picture's height"),
        table_key("leader", Flag, "placed beside its point, with a line to it"),
        table_key(
            "hides",
            Flag,
            "hidden while another body is in front of its point",
        ),
    ],
);

static DIMENSION: Keys = Keys::new(
    "dimension",
    &[
        table_key("from", Table(&PLACE), "where it begins").required(),
        table_key("to", Table(&PLACE), "where it ends").required(),
        table_key("at", Table(&PLACE), "vertex: makes it an angle"),
        table_key("axis", Formulas(3), "the angle is counted about it"),
        table_key("radius", Formula, "of the arc of an angle"),
        table_key("offset", Formulas(3), "shift of the line of a length"),
        table_key("text", Text, "what it says, with {} for the value"),
        table_key("digits", Formula, "digits behind the point"),
        table_key("colour", Colour, "its colour"),
    ],
);

static PLACE: Keys = Keys::new(
    "place",
    &[
        table_key("body", Text, "a body that it moves with"),
        table_key("trace", Text, "a traced point, in place of a body"),
        table_key("point", Formulas(3), "its place in the body's frame"),
    ],
);

static CLEARANCE: Keys = Keys::new(
    "clearance",
    &[
        table_key("minimum", Formula, "smallest distance of any two bodies"),
        table_key("pairs", Tables(&PAIR), "minima of single pairs"),
        table_key("ignore", Tables(&IGNORED), "pairs that are not judged"),
        table_key(
            "touching",
            Tables(&TOUCHING),
            "pairs that are always in contact",
        ),
    ],
);

const BOTH: Key = table_key("pair", Texts, "names of two bodies").required();

static PAIR: Keys = Keys::new(
    "pair",
    &[
        BOTH,
        table_key("minimum", Formula, "their smallest distance").required(),
    ],
);

static IGNORED: Keys = Keys::new(
    "ignored pair",
    &[
        BOTH,
        table_key("reason", Text, "why they may touch").required(),
        table_key("shapes", Rows(2), "shapes that are left out, by number"),
        table_key("down_to", Formula, "distance that still passes, negative"),
    ],
);

static TOUCHING: Keys = Keys::new("touching pair", &[BOTH]);

static PLOT: Keys = Keys::new(
    "plot",
    &[
        table_key("title", Text, "text above the plot"),
        table_key("x", Formula, "what the curves are drawn against"),
        table_key("y", Formulas(0), "the curves").required(),
        table_key("equal", Flag, "the same scale on both axes"),
        table_key("angle", Word(&["rad", "deg"]), "unit of angles in it"),
        table_key("marks", Rows(2), "reference points"),
        table_key("lines", Rows(4), "reference lines"),
    ],
);

static STUDY: Keys = Keys::new(
    "study",
    &[
        table_key(
            "variables",
            Named(&[Table(&VARIABLE)]),
            "parameters that may change",
        ),
        table_key("minimise", Text, "the measure to minimise"),
        table_key(
            "limits",
            Named(&[Table(&LIMIT)]),
            "limits of measures in the study",
        ),
        table_key(
            "printed",
            FORMULAS_BY_NAME,
            "values of measures printed in the source",
        ),
        table_key("note", Text, "one line about what is studied"),
    ],
);

/// A variable of a study.
pub static VARIABLE: Keys = Keys::new(
    "variable",
    &[
        table_key("range", Formulas(2), "smallest and largest value"),
        table_key("tolerance", Formula, "tolerance (±), in its unit"),
    ],
);

/// A limit of a study.
pub static LIMIT: Keys = Keys::new(
    "limit",
    &[
        table_key("min", Formula, "lower limit"),
        table_key("max", Formula, "upper limit"),
    ],
);
