//! The keys of the solids.

use super::Holds::{Colour, Flag, Formula, Formulas, Rows, Table, Text};
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
        shape_key("rod", Table(&EYED_ROD), "a bar with eyes about z"),
        shape_key("fork", Table(&FORK), "two cheeks about a pin along z"),
        shape_key("pin", Table(&PIN), "a pin along z with heads"),
        shape_key("bearing", Table(&BEARING), "a bearing about z on a foot"),
        shape_key("lathe", Table(&LATHE), "a turned part about z"),
        shape_key("frame", Formula, "constant chain from the body"),
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
        shape_key("center", Formulas(3), "its centre; the origin if absent"),
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
        shape_key("center", Formulas(3), "its centre; the origin if absent"),
        shape_key("size", Formulas(3), "its edges along x, y and z").required(),
    ],
);

static TORUS: Keys = Keys::new(
    "torus",
    &[
        shape_key("center", Formulas(3), "its centre; the origin if absent"),
        shape_key("axis", Formulas(3), "its axis; z if absent"),
        shape_key("ring", Formula, "radius of the centre circle").required(),
        shape_key("tube", Formula, "radius of the tube").required(),
    ],
);

static TUBE: Keys = Keys::new(
    "tube",
    &[
        shape_key("points", Rows(3), "corners of its centre line").required(),
        shape_key("radius", Formula, "its radius").required(),
        shape_key("closed", Flag, "the last point is joined to the first"),
    ],
);

static HALF_SPACE: Keys = Keys::new(
    "half-space",
    &[
        shape_key("point", Formulas(3), "a point of the plane"),
        shape_key("normal", Formulas(3), "out of the material; z if absent"),
        shape_key("size", Formula, "edge of the sheet that is drawn").required(),
    ],
);

static STL: Keys = Keys::new(
    "stl",
    &[
        shape_key("file", Text, "path, relative to the scene").required(),
        shape_key("scale", Formula, "scene units in one unit of the file"),
        shape_key("surface", Flag, "the triangles enclose nothing"),
    ],
);
