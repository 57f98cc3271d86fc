//! The keys of bodies, of traced points, and of what is written beside them.

use super::Holds::{Chain, Colour, Flag, Formula, Formulas, Table, Tables, Text};
use super::shapes::SHAPE;
use super::{Holds, Key, Keys};

const fn body_key(name: &'static str, holds: Holds, says: &'static str) -> Key {
    Key::new(name, holds, says)
}

pub(super) static BODY: Keys = Keys::new(
    "body",
    &[
        body_key("name", Text, "its name").required(),
        body_key(
            "frame",
            Chain,
            "the chain `world_from_body`; default: the world",
        ),
        body_key("colour", Colour, "of its shapes"),
        body_key(
            "opacity",
            Formula,
            "0 to 1; below 1 the body is translucent",
        ),
        body_key("shapes", Tables(&SHAPE), "its solids"),
    ],
);

pub(super) static TRACE: Keys = Keys::new(
    "trace",
    &[
        body_key("name", Text, "its name").required(),
        body_key("body", Text, "the body that it belongs to").required(),
        body_key(
            "point",
            Formulas(3),
            "in the body's frame; default: the origin",
        ),
        body_key("colour", Colour, "of its path"),
        body_key("radius", Formula, "of the path as drawn"),
    ],
);

pub(super) static LABEL: Keys = Keys::with_one_of(
    "label",
    &[
        body_key("text", Text, "what it says").required(),
        body_key("body", Text, "the body that it is fixed to"),
        body_key(
            "point",
            Formulas(3),
            "in the body's frame; beside `trace` a shift. Default: zero",
        ),
        body_key("trace", Text, "the trace on which it is placed"),
        body_key("time", Formula, "of its place on the trace, in seconds"),
        body_key("colour", Colour, "of the text"),
        body_key(
            "size",
            Formula,
            "as a fraction of the picture's height; default: 0.035",
        ),
        body_key(
            "leader",
            Flag,
            "placed beside its point and connected to it by a line",
        ),
        body_key(
            "hides",
            Flag,
            "disappears while another body is in front of its point",
        ),
    ],
    &["body", "trace"],
);

pub(super) static DIMENSION: Keys = Keys::new(
    "dimension",
    &[
        body_key("from", Table(&PLACE), "where it begins").required(),
        body_key("to", Table(&PLACE), "where it ends").required(),
        body_key(
            "at",
            Table(&PLACE),
            "the vertex; makes it the angle between the directions to `from` and `to`",
        ),
        body_key(
            "axis",
            Formulas(3),
            "the angle is counted counter-clockwise about this direction of the world, from 0 to a full turn; without it, \
             from 0 to half a turn",
        )
        .beside("at"),
        body_key(
            "radius",
            Formula,
            "of the arc; default: 11 % of the motion's extent",
        )
        .beside("at"),
        body_key(
            "offset",
            Formulas(3),
            "shift of the dimension line of a length, in the world",
        )
        .without("at"),
        body_key(
            "text",
            Text,
            "text with `{}` for the value; default: the value alone",
        ),
        body_key(
            "digits",
            Formula,
            "behind the point, 0 to 9; default: as for inputs",
        ),
        body_key("colour", Colour, "default: the theme's ink"),
    ],
);

static PLACE: Keys = Keys::new(
    "place",
    &[
        body_key("body", Text, "a body with which it moves"),
        body_key("trace", Text, "a traced point").without("body"),
        body_key(
            "point",
            Formulas(3),
            "in the body's frame, or in the world without a body; beside `trace` a shift",
        ),
    ],
);
