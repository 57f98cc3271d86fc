//! The keys of a list of golden pictures.

use crate::scene::keys::Holds::{
    Colour, Flag, Formula, Formulas, Named, Table, Tables, Text, Word,
};
use crate::scene::keys::{Holds, Key, Keys};

const fn key(name: &'static str, holds: Holds, says: &'static str) -> Key {
    Key::new(name, holds, says)
}

const FORMULAS_BY_NAME: Holds = Named(&[Formula]);

/// The whole list.
pub static LIST: Keys = Keys::new(
    "snapshots",
    &[key("picture", Tables(&PICTURE), "one golden picture")],
);

static PICTURE: Keys = Keys::new(
    "picture",
    &[
        key("file", Text, "name of the PNG in this folder").required(),
        key("scene", Text, "built-in name, or a path").required(),
        key("size", Formulas(2), "width and height in pixels"),
        key("samples", Formula, "samples a pixel"),
        key("frame", Formula, "number of the frame"),
        key("time", Formula, "time in seconds, in place of the frame"),
        key("tolerance", Formula, "levels that a channel may be off"),
        key("pixels", Formula, "pixels that may be off by more"),
        key("parameters", FORMULAS_BY_NAME, "in place of the scene's"),
        key("inputs", FORMULAS_BY_NAME, "in place of the scene's"),
        key("guess", FORMULAS_BY_NAME, "in place of the scene's"),
        key("view", Table(&VIEW), "in place of the scene's"),
    ],
);

static VIEW: Keys = Keys::new(
    "view",
    &[
        key("azimuth", Formula, "degrees"),
        key("elevation", Formula, "degrees"),
        key("fov", Formula, "vertical angle of a perspective, degrees"),
        key("orbit", Formula, "degrees that the camera turns"),
        key(
            "projection",
            Word(&["perspective", "orthographic"]),
            "kind of projection",
        ),
        key(
            "from",
            Word(&["iso", "front", "top", "side", "four"]),
            "direction by name",
        ),
        key("theme", Word(&["light", "dark"]), "colours around bodies"),
        key("background", Colour, "in place of the theme's"),
        key("captions", Flag, "title and inputs are written"),
        key("ground", Flag, "the ground is drawn"),
        key("ghosts", Formula, "how many earlier poses stay"),
        key(
            "trails",
            Word(&["full", "fading", "none"]),
            "how paths are drawn",
        ),
        key("arrows", Flag, "velocity arrows on traced points"),
        key(
            "axes",
            Word(&["none", "world", "bodies", "all"]),
            "axes of frames",
        ),
        key("gauge", Flag, "gauges of the inputs"),
        key("joints", Flag, "joints drawn by kind"),
    ],
);
