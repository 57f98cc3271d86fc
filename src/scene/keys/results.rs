//! The keys of what is computed of a motion: tracks, measures, distances, clearances, plots and studies.

use super::Holds::{Any, Flag, Formula, Formulas, Named, Rows, Table, Tables, Text, Texts, Word};
use super::{FORMULAS_BY_NAME, Holds, Key, Keys, words};
use crate::model::measure::Taking;

const fn result_key(name: &'static str, holds: Holds, says: &'static str) -> Key {
    Key::new(name, holds, says)
}

static TAKINGS: [&str; Taking::NAMES.len()] = words(&Taking::NAMES);

/// A track.
pub static TRACK: Keys = Keys::new(
    "track",
    &[
        result_key("samples", Formula, "number of poses, 2 to 10000").required(),
        result_key(
            "inputs",
            Named(&[Formula, Formulas(2)]),
            "the value of each input, or its first and last value; all other inputs keep their values at the start",
        ),
    ],
);

/// An output that is not a formula.
pub static DISTANCE: Keys = Keys::new(
    "output",
    &[
        result_key(
            "distance",
            Texts(2),
            "two bodies; a name that ends in `*` stands for all bodies whose names begin with the text before it",
        )
        .required(),
        result_key(
            "shapes",
            Rows(2),
            "only these pairs of shapes of the first and the second body, counted from 1",
        ),
    ],
);

/// A measure that is not a plain formula.
pub static MEASURE: Keys = Keys::new(
    "measure",
    &[
        result_key(
            "track",
            Text,
            "the track whose poses are used; default: the drive",
        ),
        result_key(
            "of",
            Any(&[Formula, Formulas(1), Formulas(2)]),
            "a formula as in `[outputs]`; two formulas for the path of `chord` and `bow`",
        )
        .required(),
        result_key(
            "per",
            Text,
            "an input: the measure uses the derivative of `of` with respect to it, with the other inputs constant; \
             angles count in radians",
        ),
        result_key(
            "take",
            Word(&TAKINGS),
            "how the values become one number, see below",
        )
        .required(),
        result_key("power", Formula, "of a norm; default: 2"),
        result_key("min", Formula, "lower limit, in the file's units"),
        result_key("max", Formula, "upper limit, in the file's units"),
        result_key("why", Text, "text that is printed if a limit is violated"),
    ],
);

pub(super) static CLEARANCE: Keys = Keys::new(
    "clearance",
    &[
        result_key(
            "minimum",
            Formula,
            "smallest distance of any two bodies; 0 lets them touch; default: 0",
        ),
        result_key("pairs", Tables(&PAIR), "minima of single pairs"),
        result_key("ignore", Tables(&IGNORED), "pairs that are not judged"),
        result_key(
            "touching",
            Tables(&TOUCHING),
            "pairs that are always in contact",
        ),
    ],
);

const BOTH: Key = result_key("pair", Texts(2), "names of two bodies").required();

static PAIR: Keys = Keys::new(
    "pair",
    &[
        BOTH,
        result_key("minimum", Formula, "their smallest distance").required(),
    ],
);

static IGNORED: Keys = Keys::new(
    "ignored pair",
    &[
        BOTH,
        result_key("reason", Text, "why they may touch").required(),
        result_key(
            "shapes",
            Rows(2),
            "only these pairs of shapes, counted from 1 as in reports",
        ),
        result_key(
            "down_to",
            Formula,
            "the deepest overlap that still passes, as a distance of 0 or below",
        ),
    ],
);

static TOUCHING: Keys = Keys::new("touching pair", &[BOTH]);

pub(super) static PLOT: Keys = Keys::new(
    "plot",
    &[
        result_key("title", Text, "text above the plot"),
        result_key(
            "x",
            Formula,
            "horizontal axis: `\"time\"` (default), or a name or formula",
        ),
        result_key("y", Formulas(0), "the curves")
            .at_least(1)
            .required(),
        result_key(
            "equal",
            Flag,
            "the same scale on both axes, for paths in a plane",
        ),
        result_key(
            "angle",
            Word(&["rad", "deg"]),
            "unit of angles in this plot; default: that of the scene",
        ),
        result_key(
            "marks",
            Rows(2),
            "reference points `[x, y]`, in the units of the axes",
        ),
        result_key("lines", Rows(4), "reference lines `[x1, y1, x2, y2]`"),
    ],
);

pub(super) static STUDY: Keys = Keys::new(
    "study",
    &[
        result_key(
            "variables",
            Named(&[Table(&VARIABLE)]),
            "parameters that may change",
        ),
        result_key(
            "minimise",
            Text,
            "the measure that `optimise` and `synthesise` make small",
        ),
        result_key(
            "limits",
            Named(&[Table(&LIMIT)]),
            "limits of measures in the study, in addition to their own",
        ),
        result_key(
            "printed",
            FORMULAS_BY_NAME,
            "values of measures printed in the source, shown beside the results",
        ),
        result_key("note", Text, "one line about the study"),
    ],
);

/// A variable of a study.
pub static VARIABLE: Keys = Keys::new(
    "variable",
    &[
        result_key(
            "range",
            Formulas(2),
            "smallest and largest value in a search; default: 20 % to both sides, none for a parameter of value 0",
        ),
        result_key("tolerance", Formula, "± in its own unit"),
    ],
);

/// A limit of a study.
pub static LIMIT: Keys = Keys::new(
    "limit",
    &[
        result_key("min", Formula, "lower limit"),
        result_key("max", Formula, "upper limit"),
    ],
);
