//! The keys of machine parts.

use super::Holds::{Formula, Formulas, Rows};
use super::{Holds, Key, Keys};

const fn part_key(name: &'static str, holds: Holds, says: &'static str) -> Key {
    Key::new(name, holds, says).required()
}

/// A bar with eyes.
pub static EYED_ROD: Keys = Keys::new(
    "rod",
    &[
        part_key("from", Formulas(3), "middle of one eye"),
        part_key("to", Formulas(3), "middle of the other eye"),
        part_key("radius", Formula, "of the bar"),
        part_key("eye", Formula, "radius of the eyes"),
        part_key("width", Formula, "of the eyes along z"),
    ],
);

/// A fork.
pub static FORK: Keys = Keys::new(
    "fork",
    &[
        part_key("radius", Formula, "of its eyes"),
        part_key("gap", Formula, "between its cheeks"),
        part_key("depth", Formula, "from the pin to the bridge"),
        part_key("thickness", Formula, "of cheeks and bridge"),
    ],
);

/// A pin with heads.
pub static PIN: Keys = Keys::new(
    "pin",
    &[
        part_key("radius", Formula, "of its shank"),
        part_key("length", Formula, "between its heads"),
        part_key("head", Formula, "radius of its heads"),
    ],
);

/// A bearing on a foot.
pub static BEARING: Keys = Keys::new(
    "bearing",
    &[
        part_key("radius", Formula, "of its housing"),
        part_key("width", Formula, "of its housing along z"),
        part_key(
            "height",
            Formula,
            "of its axis above the lower side of its foot, at −y",
        ),
    ],
);

/// A turned part.
pub static LATHE: Keys = Keys::new(
    "lathe",
    &[part_key(
        "profile",
        Rows(2),
        "its outline `[[z, r], …]`, from place to place on the axis; repeating a `z` makes a step",
    )
    .at_least(2)],
);
