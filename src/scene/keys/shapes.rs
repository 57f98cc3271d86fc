//! The keys of the solids.

use super::Holds::{Colour, Flag, Formula, Formulas, Rows, Table, Text};
use super::{Holds, Key, Keys};

const fn key(name: &'static str, holds: Holds, says: &'static str) -> Key {
    Key::new(name, holds, says)
}

/// A shape: one solid, and where it is.
pub static SHAPE: Keys = Keys::with_one_of(
    "shape",
    &[
        key("sphere", Table(&SPHERE), "a ball"),
        key("capsule", Table(&ROD), "a rod with round ends"),
        key("cylinder", Table(&ROD), "a rod with flat ends"),
        key("cone", Table(&CONE), "a cone, or a part of one"),
        key("box", Table(&BOX), "a box along the axes"),
        key("torus", Table(&TORUS), "a ring"),
        key("tube", Table(&TUBE), "a round bar along a line"),
        key("half_space", Table(&HALF_SPACE), "everything below a plane"),
        key("stl", Table(&STL), "triangles from a file"),
        key("frame", Formula, "constant chain from the body"),
        key("colour", Colour, "in place of the body's"),
        key("opacity", Formula, "in place of the body's"),
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
    ],
);

static SPHERE: Keys = Keys::new(
    "sphere",
    &[
        key("center", Formulas(3), "its centre; the origin if absent"),
        key("radius", Formula, "its radius").required(),
    ],
);

static ROD: Keys = Keys::new(
    "rod",
    &[
        key("from", Formulas(3), "one end of its axis").required(),
        key("to", Formulas(3), "the other end").required(),
        key("radius", Formula, "its radius").required(),
    ],
);

static CONE: Keys = Keys::new(
    "cone",
    &[
        key("from", Formulas(3), "one end of its axis").required(),
        key("to", Formulas(3), "the other end").required(),
        key("radius_from", Formula, "radius at the one end").required(),
        key("radius_to", Formula, "radius at the other end").required(),
    ],
);

static BOX: Keys = Keys::new(
    "box",
    &[
        key("center", Formulas(3), "its centre; the origin if absent"),
        key("size", Formulas(3), "its edges along x, y and z").required(),
    ],
);

static TORUS: Keys = Keys::new(
    "torus",
    &[
        key("center", Formulas(3), "its centre; the origin if absent"),
        key("axis", Formulas(3), "its axis; z if absent"),
        key("ring", Formula, "radius of the centre circle").required(),
        key("tube", Formula, "radius of the tube").required(),
    ],
);

static TUBE: Keys = Keys::new(
    "tube",
    &[
        key("points", Rows(3), "corners of its centre line").required(),
        key("radius", Formula, "its radius").required(),
        key("closed", Flag, "the last point is joined to the first"),
    ],
);

static HALF_SPACE: Keys = Keys::new(
    "half-space",
    &[
        key("point", Formulas(3), "a point of the plane"),
        key("normal", Formulas(3), "out of the material; z if absent"),
        key("size", Formula, "edge of the sheet that is drawn").required(),
    ],
);

static STL: Keys = Keys::new(
    "stl",
    &[
        key("file", Text, "path, relative to the scene").required(),
        key("scale", Formula, "scene units in one unit of the file"),
        key("surface", Flag, "the triangles enclose nothing"),
    ],
);
