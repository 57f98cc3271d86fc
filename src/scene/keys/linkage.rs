//! The keys of bars and contacts.

use super::Holds::{Any, Chain, Formula, Formulas, Table};
use super::{Holds, Key, Keys, NONE};

const fn link_key(name: &'static str, holds: Holds, says: &'static str) -> Key {
    Key::new(name, holds, says)
}

/// A bar between two points.
pub static BAR: Keys = Keys::new(
    "bar",
    &[
        link_key(
            "from",
            END,
            "one end: a point, a chain whose origin it is, or the name of a trace",
        )
        .required(),
        link_key("to", END, "the other end").required(),
        link_key(
            "length",
            Formula,
            "positive; a number, a formula, an input, or an unknown",
        )
        .required(),
    ],
);

const END: Holds = Any(&[Chain, Formulas(2), Formulas(3)]);

/// A contact of two surfaces.
pub static CONTACT: Keys = Keys::new(
    "contact",
    &[
        link_key("first", Table(&SURFACE), "one surface").required(),
        link_key("second", Table(&SURFACE), "the other surface").required(),
    ],
);

static SURFACE: Keys = Keys::with_one_of(
    "surface",
    &[
        link_key("torus", Table(&RING), "about the z axis"),
        link_key("sphere", Table(&POINTLIKE), "about the origin"),
        link_key("cylinder", Table(&ROUND), "about the z axis, without ends"),
        link_key(
            "plane",
            Table(&NONE),
            "the xy plane, `plane = {}`; the other body is on the side of +z",
        ),
        link_key(
            "frame",
            Chain,
            "the chain from the world to the surface; default: the world",
        ),
    ],
    &["torus", "sphere", "cylinder", "plane"],
);

static RING: Keys = Keys::new(
    "torus surface",
    &[
        link_key("ring", Formula, "radius of the centre circle").required(),
        link_key("tube", Formula, "may be larger than the ring").required(),
    ],
);

static POINTLIKE: Keys = Keys::new(
    "sphere surface",
    &[link_key("radius", Formula, "zero for a point").required()],
);

static ROUND: Keys = Keys::new(
    "cylinder surface",
    &[link_key("radius", Formula, "its radius").required()],
);
