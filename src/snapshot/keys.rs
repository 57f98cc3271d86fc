//! The keys of a list of golden pictures.

use crate::scene::keys::Holds::{
    Colour, Flag, Formula, Formulas, Named, Table, Tables, Text, Word,
};
use crate::scene::keys::{Holds, Key, Keys};

const fn snapshot_key(name: &'static str, holds: Holds, says: &'static str) -> Key {
    Key::new(name, holds, says)
}

const FORMULAS_BY_NAME: Holds = Named(&[Formula]);

/// The whole list.
pub static LIST: Keys = Keys::new(
    "snapshots",
    &[snapshot_key(
        "picture",
        Tables(&PICTURE),
        "one golden picture",
    )],
);

static PICTURE: Keys = Keys::new(
    "picture",
    &[
        snapshot_key("file", Text, "name of the PNG in this folder").required(),
        snapshot_key("scene", Text, "built-in name, or a path").required(),
        snapshot_key("size", Formulas(2), "width and height in pixels"),
        snapshot_key("samples", Formula, "samples a pixel"),
        snapshot_key("frame", Formula, "number of the frame"),
        snapshot_key("time", Formula, "time in seconds, in place of the frame"),
        snapshot_key("tolerance", Formula, "levels that a channel may be off"),
        snapshot_key("pixels", Formula, "pixels that may be off by more"),
        snapshot_key("parameters", FORMULAS_BY_NAME, "in place of the scene's"),
        snapshot_key("inputs", FORMULAS_BY_NAME, "in place of the scene's"),
        snapshot_key("guess", FORMULAS_BY_NAME, "in place of the scene's"),
        snapshot_key("view", Table(&VIEW), "in place of the scene's"),
    ],
);

static VIEW: Keys = Keys::new(
    "view",
    &[
        snapshot_key("azimuth", Formula, "degrees"),
        snapshot_key("elevation", Formula, "degrees"),
        snapshot_key("fov", Formula, "vertical angle of a perspective, degrees"),
        snapshot_key("orbit", Formula, "degrees that the camera turns"),
        snapshot_key(
            "projection",
            Word(&["perspective", "orthographic"]),
            "kind of projection",
        ),
        snapshot_key(
            "from",
            Word(&["iso", "front", "top", "side", "four"]),
            "direction by name",
        ),
        snapshot_key("theme", Word(&["light", "dark"]), "colours around bodies"),
        snapshot_key(
            "edges",
            Word(&["all", "outline", "none"]),
            "lines between surfaces",
        ),
        snapshot_key("background", Colour, "in place of the theme's"),
        snapshot_key("captions", Flag, "title and inputs are written"),
        snapshot_key("ground", Flag, "the ground is drawn"),
        snapshot_key("ghosts", Formula, "how many earlier poses stay"),
        snapshot_key(
            "trails",
            Word(&["whole", "grow", "fading", "none"]),
            "how paths are drawn",
        ),
        snapshot_key("arrows", Flag, "velocity arrows on traced points"),
        snapshot_key(
            "axes",
            Word(&["none", "world", "bodies", "all"]),
            "axes of frames",
        ),
        snapshot_key("gauge", Flag, "gauges of the inputs"),
        snapshot_key("joints", Flag, "joints drawn by kind"),
    ],
);
