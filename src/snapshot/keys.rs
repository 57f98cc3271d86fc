//! The keys of a list of golden pictures.

use crate::scene::keys::Holds::{Flag, Formula, Formulas, Table, Tables, Text};
use crate::scene::keys::{FORMULAS_BY_NAME, Holds, Key, Keys, view};

const fn snapshot_key(name: &'static str, holds: Holds, says: &'static str) -> Key {
    Key::new(name, holds, says)
}

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
        snapshot_key("samples", Formula, "samples per pixel"),
        snapshot_key("frame", Formula, "number of the frame"),
        snapshot_key("time", Formula, "time in seconds, in place of the frame"),
        snapshot_key(
            "tolerance",
            Formula,
            "allowed difference of a channel, in levels",
        ),
        snapshot_key(
            "pixels",
            Formula,
            "number of pixels that may differ by more",
        ),
        snapshot_key("parameters", FORMULAS_BY_NAME, "in place of the scene's"),
        snapshot_key("inputs", FORMULAS_BY_NAME, "in place of the scene's"),
        snapshot_key("guess", FORMULAS_BY_NAME, "in place of the scene's"),
        snapshot_key("view", Table(&VIEW), "in place of the scene's"),
    ],
);

static VIEW: Keys = Keys::new(
    "view",
    &[
        view::AZIMUTH,
        view::ELEVATION,
        view::FOV,
        view::ORBIT,
        view::PROJECTION,
        view::FROM,
        view::THEME,
        view::EDGES,
        view::SHADOWS,
        view::BACKGROUND,
        view::CAPTIONS,
        snapshot_key("ground", Flag, "the ground is drawn"),
        view::GHOSTS,
        view::TRAILS,
        view::ARROWS,
        view::AXES,
        view::GAUGE,
        view::JOINTS,
        snapshot_key(
            "section",
            Table(&SECTION),
            "a plane at which all bodies are cut; cut faces are drawn flat and hatched",
        ),
        view::EXPLODE,
    ],
);

static SECTION: Keys = Keys::new("section", &[view::SECTION_POINT, view::SECTION_NORMAL]);
