//! The keys of the solids.

use super::Holds::{Chain, Colour, Flag, Formula, Formulas, Rows, Table, Text};
use super::machine_parts::{BEARING, EYED_ROD, FORK, LATHE, PIN};
use super::{Holds, Key, Keys};

const fn shape_key(name: &'static str, holds: Holds, says: &'static str) -> Key {
    Key::new(name, holds, says)
}

/// A shape: one solid or part of a machine, and where it is.
pub static SHAPE: Keys = Keys::with_one_of(
    "shape",
    &[
        shape_key("sphere", Table(&SPHERE), "a ball"),
        shape_key("capsule", Table(&ROD), "a rod with round ends"),
        shape_key("cylinder", Table(&ROD), "a rod with flat ends"),
        shape_key("cone", Table(&CONE), "a cone, or a part of one"),
        shape_key("box", Table(&BOX), "a box along the axes"),
        shape_key("torus", Table(&TORUS), "a ring"),
        shape_key("tube", Table(&TUBE), "a round bar along a line"),
        shape_key("half_space", Table(&HALF_SPACE), "everything below a plane"),
        shape_key("stl", Table(&STL), "triangles from a file"),
        shape_key("rod", Table(&EYED_ROD), "a bar with an eye at both ends"),
        shape_key(
            "fork",
            Table(&FORK),
            "two cheeks with eyes about the origin, and a bridge at −x",
        ),
        shape_key(
            "pin",
            Table(&PIN),
            "a pin centred on the origin, with a head at each end",
        ),
        shape_key(
            "bearing",
            Table(&BEARING),
            "a housing about the origin for a shaft of up to three quarters of its radius, on a column with a bolted foot",
        ),
        shape_key("lathe", Table(&LATHE), "a turned part"),
        shape_key("frame", Chain, "a constant chain from the body"),
        shape_key("colour", Colour, "in place of the body's"),
        shape_key("opacity", Formula, "in place of the body's"),
    ],
    &[
        "sphere",
        "capsule",
        "cylinder",
        "cone",
        "box",
        "torus",
        "tube",
        "half_space",
        "stl",
        "rod",
        "fork",
        "pin",
        "bearing",
        "lathe",
    ],
);

static SPHERE: Keys = Keys::new(
    "sphere",
    &[
        shape_key("center", Formulas(3), "default: the origin"),
        shape_key("radius", Formula, "its radius").required(),
    ],
);

static ROD: Keys = Keys::new(
    "round bar",
    &[
        shape_key("from", Formulas(3), "one end of its axis").required(),
        shape_key("to", Formulas(3), "the other end").required(),
        shape_key("radius", Formula, "its radius").required(),
    ],
);

static CONE: Keys = Keys::new(
    "cone",
    &[
        shape_key("from", Formulas(3), "one end of its axis").required(),
        shape_key("to", Formulas(3), "the other end").required(),
        shape_key("radius_from", Formula, "radius at the one end").required(),
        shape_key("radius_to", Formula, "radius at the other end").required(),
    ],
);

static BOX: Keys = Keys::new(
    "box",
    &[
        shape_key("center", Formulas(3), "default: the origin"),
        shape_key("size", Formulas(3), "its edges along x, y and z").required(),
    ],
);

static TORUS: Keys = Keys::new(
    "torus",
    &[
        shape_key("center", Formulas(3), "default: the origin"),
        shape_key("axis", Formulas(3), "default: z"),
        shape_key("ring", Formula, "radius of the centre circle").required(),
        shape_key("tube", Formula, "radius of the tube").required(),
    ],
);

static TUBE: Keys = Keys::new(
    "tube",
    &[
        shape_key("points", Rows(3), "corners of its centre line")
            .at_least(2)
            .required(),
        shape_key("radius", Formula, "its radius").required(),
        shape_key("closed", Flag, "the last point is joined to the first"),
    ],
);

static HALF_SPACE: Keys = Keys::new(
    "half-space",
    &[
        shape_key("point", Formulas(3), "of the plane; default: the origin"),
        shape_key("normal", Formulas(3), "out of the material; default: z"),
        shape_key("size", Formula, "edge length of the sheet that is drawn").required(),
    ],
);

static STL: Keys = Keys::new(
    "stl",
    &[
        shape_key(
            "file",
            Text,
            "in or below the scene's folder, otherwise with `--allow-files DIR`",
        )
        .required(),
        shape_key(
            "scale",
            Formula,
            "scene units in one unit of the file; default: 1",
        ),
        shape_key("surface", Flag, "the triangles enclose nothing"),
    ],
);
