//! The keys of a scene file: its sections, units and inputs.

use super::Holds::{Chain, Formula, Named, Rows, Table, Tables, Text, Word};
use super::bodies::{BODY, DIMENSION, LABEL, TRACE};
use super::linkage::{BAR, CONTACT};
use super::results::{CLEARANCE, DISTANCE, MEASURE, PLOT, STUDY, TRACK};
use super::view::VIEW;
use super::{FORMULAS_BY_NAME, Holds, Key, Keys, words};
use crate::model::drive::Ease;

const fn table_key(name: &'static str, holds: Holds, says: &'static str) -> Key {
    Key::new(name, holds, says)
}

static EASES: [&str; Ease::NAMES.len()] = words(&Ease::NAMES);

/// A whole scene.
pub static SCENE: Keys = Keys::new(
    "scene",
    &[
        table_key("title", Text, "text in the corner of the picture"),
        table_key("description", Text, "one line for `mechanim scenes`"),
        table_key("source", Text, "where equations and dimensions come from"),
        table_key("units", Table(&UNITS), "units of lengths and angles"),
        table_key(
            "duration",
            Formula,
            "length of the motion in seconds; default: the last keyframe",
        ),
        table_key(
            "parameters",
            FORMULAS_BY_NAME,
            "constants; each may use those above it",
        ),
        table_key(
            "inputs",
            Named(&[Formula, Table(&INPUT)]),
            "driven coordinates as functions of the time `t` in seconds",
        ),
        table_key(
            "chains",
            Named(&[Chain]),
            "products of elementary transforms",
        ),
        table_key(
            "loops",
            Named(&[Chain]),
            "products that must be the identity",
        ),
        table_key("equations", FORMULAS_BY_NAME, "formulas that must be zero"),
        table_key(
            "bars",
            Named(&[Table(&BAR)]),
            "pairs of points at a given distance",
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
            "poses other than those of the drive, with inputs in equal steps",
        ),
        table_key(
            "measures",
            Named(&[Formula, Table(&MEASURE)]),
            "single numbers of a whole motion, or formulas of earlier ones",
        ),
        table_key("labels", Tables(&LABEL), "texts in the picture; up to 200"),
        table_key(
            "dimensions",
            Tables(&DIMENSION),
            "lengths and angles drawn with their values; up to 200",
        ),
        table_key(
            "clearance",
            Table(&CLEARANCE),
            "distances that bodies must keep; nothing is checked without it",
        ),
        table_key("plots", Tables(&PLOT), "what `mechanim plot` draws"),
        table_key("view", Table(&VIEW), "how the scene is seen"),
        table_key("study", Table(&STUDY), "what may vary, and the objective"),
    ],
);

static UNITS: Keys = Keys::new(
    "units",
    &[
        table_key(
            "length",
            Text,
            "a name such as \"mm\"; lengths are never converted",
        ),
        table_key("angle", Word(&["rad", "deg"]), "default: \"rad\""),
    ],
);

/// An input that is not a plain formula.
pub static INPUT: Keys = Keys::with_one_of(
    "input",
    &[
        table_key("formula", Formula, "a formula of the time `t`"),
        table_key("keys", Rows(2), "time and value of every key; times ascend").at_least(1),
        table_key(
            "ease",
            Word(&EASES),
            "how values change between keys; default: `linear`",
        ),
    ],
    &["formula", "keys"],
);
