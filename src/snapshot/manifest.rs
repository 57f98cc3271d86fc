//! The list of golden pictures, `snapshots.toml`: which scene, which instant, which view, how much may differ.

use super::keys::LIST;
use crate::compare::film::AllowedDifference;
use crate::diag::{Diagnostic, Diagnostics, SceneError, Source, Span};
use crate::model::section::{MOST_EXPLODED, SectionPlane};
use crate::model::theme::Theme;
use crate::model::view::{
    EdgeLines, Ghosts, NamedView, Shadows, ShownAxes, Trails, ViewProjection,
};
use crate::model::view_change::ViewChange;
use crate::scene::reader::{FoundValue, Spanned, TableReader, read_table};
use crate::scene::resolve::camera::MOST_ORBIT;
use crate::scene::resolve::choices::{MOST_GHOSTS, chosen_word};
use crate::scene::resolve::range::in_range;
use crate::scene::syntax::parse_tables;
use crate::scene::values::FormulaText;
use glam::DVec3;
use std::collections::HashSet;
use std::path::PathBuf;

/// Name of the list in its folder.
pub const MANIFEST: &str = "snapshots.toml";

/// Default size and samples of a picture: small, since goldens are kept under version control.
const DEFAULT_SIZE: [u32; 2] = [192, 144];
const DEFAULT_SAMPLES: u32 = 4;

/// Longest side of a golden picture.
const LONGEST_SIDE: f64 = 4096.0;

/// Latest frame that may be requested.
const LAST_FRAME: f64 = 1e6;

/// The field of view, in degrees, of a list that asks for a perspective without one.
const DEFAULT_FOV_DEG: f64 = 24.0;

/// The list as read.
#[derive(Clone, Debug, PartialEq)]
pub struct Manifest {
    /// The pictures, in the order of the file.
    pub pictures: Vec<GoldenPicture>,
}

/// One picture.
#[derive(Clone, Debug, PartialEq)]
pub struct GoldenPicture {
    /// Name of the golden file in the folder of the list.
    pub file: String,
    /// Name of a built-in scene, or path of a scene file from the folder of the list.
    pub scene: String,
    /// Size in pixels.
    pub size: [u32; 2],
    /// Samples per pixel.
    pub samples: u32,
    /// When.
    pub instant: PictureInstant,
    /// What may differ.
    pub allowed: AllowedDifference,
    /// Replaced parameters, by name.
    pub parameters: Vec<(String, String)>,
    /// Replaced drives of inputs.
    pub inputs: Vec<(String, String)>,
    /// Replaced start values.
    pub guess: Vec<(String, String)>,
    /// How it is seen.
    pub view: ViewChange,
    /// Folders beside that of the list in which scenes and their meshes may lie. The list itself cannot set them.
    pub folders: Vec<PathBuf>,
}

/// An instant of the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PictureInstant {
    /// The frame with this number, counted from 0, at the scene's rate.
    Frame(usize),
    /// Seconds.
    Time(f64),
}

impl Manifest {
    /// Reads the list; the error contains every mistake found.
    pub fn read(source: &Source) -> Result<Self, Box<SceneError>> {
        let mut diagnostics = Diagnostics::default();
        let pictures = read_pictures(source, &mut diagnostics);
        if diagnostics.has_errors() {
            return Err(Box::new(SceneError {
                source_text: source.clone(),
                diagnostics,
            }));
        }
        Ok(Self { pictures })
    }
}

fn read_pictures(source: &Source, diagnostics: &mut Diagnostics) -> Vec<GoldenPicture> {
    let Some(table) = parse_tables(&source.text, diagnostics) else {
        return Vec::new();
    };
    let whole = table.span();
    let place = "the list".to_owned();
    let found = FoundValue {
        table: table.get_ref(),
        text: &source.text,
        span: whole,
    };
    let list = read_table(found, &LIST, place, diagnostics, |r| {
        r.tables("picture", read_picture)
    });
    let pictures: Vec<(GoldenPicture, Span)> = list.into_iter().flatten().collect();
    if pictures.is_empty() && !diagnostics.has_errors() {
        diagnostics.push(
            Diagnostic::error("the list has no pictures")
                .hint("write a [[picture]] with `file` and `scene`"),
        );
    }
    let mut files = HashSet::new();
    for (picture, span) in &pictures {
        if !files.insert(&picture.file) {
            let message = format!("two pictures are kept in `{}`", picture.file);
            diagnostics.push(Diagnostic::error(message).at(span.clone()));
        }
    }
    pictures.into_iter().map(|(picture, _)| picture).collect()
}

fn read_picture(r: &mut TableReader) -> Option<(GoldenPicture, Span)> {
    let (file, scene) = (r.string("file"), r.string("scene"));
    for (key, value) in [("file", &file), ("scene", &scene)] {
        if value.is_none() {
            r.missing(key);
        }
    }
    let size = read_size(r);
    let samples = read_number(r, "samples", 1.0, 16.0).map_or(DEFAULT_SAMPLES, |n| n as u32);
    let instant = read_instant(r);
    let allowed = AllowedDifference {
        tolerance: read_number(r, "tolerance", 0.0, 255.0).map_or(0, |n| n as u8),
        pixels: read_number(r, "pixels", 0.0, 1e9).map_or(0, |n| n as u64),
    };
    let [parameters, inputs, guess] = ["parameters", "inputs", "guess"].map(|key| {
        let list = r.named_formulas(key);
        list.into_iter()
            .map(|(name, formula)| (name.value, formula.text))
            .collect()
    });
    let view = r.table("view", read_view).unwrap_or_default();
    let file = file.filter(|file| is_plain_png(r, file))?;
    Some((
        GoldenPicture {
            file: file.value,
            scene: scene?.value,
            size,
            samples,
            instant,
            allowed,
            parameters,
            inputs,
            guess,
            view,
            folders: Vec::new(),
        },
        file.span,
    ))
}

/// Goldens lie in the folder of the list, so that one look shows them all.
fn is_plain_png(r: &mut TableReader, file: &Spanned<String>) -> bool {
    let stem = file.value.strip_suffix(".png");
    let plain = stem.is_some_and(|stem| !stem.is_empty() && !stem.contains(['/', '\\', '.']));
    if !plain {
        let message = format!(
            "`{}` is not the name of a PNG file in this folder",
            file.value
        );
        r.diagnostics.push(
            Diagnostic::error(message)
                .at(file.span.clone())
                .hint("write a name such as `side-100.png`, with one dot and no folder"),
        );
    }
    plain
}

fn read_size(r: &mut TableReader) -> [u32; 2] {
    let Some(texts) = r.vector::<2>("size") else {
        return DEFAULT_SIZE;
    };
    let sides = texts.map(|text| whole_number(r, "a side", &text, 1.0, LONGEST_SIDE));
    [0, 1].map(|k| sides[k].map_or(DEFAULT_SIZE[k], |side| side as u32))
}

fn read_instant(r: &mut TableReader) -> PictureInstant {
    let frame = read_number(r, "frame", 0.0, LAST_FRAME);
    let time = r.formula("time");
    match (frame, time) {
        (Some(_), Some(time)) => {
            let message = "a picture shows a `frame` or a `time`, not both";
            r.diagnostics.push(Diagnostic::error(message).at(time.span));
            PictureInstant::Frame(0)
        }
        (_, Some(time)) => {
            let seconds = real_number(r, "the time", &time, 0.0, f64::MAX);
            PictureInstant::Time(seconds.unwrap_or(0.0))
        }
        (frame, None) => PictureInstant::Frame(frame.map_or(0, |frame| frame as usize)),
    }
}

fn read_view(r: &mut TableReader) -> ViewChange {
    let mut degrees = |key: &'static str, low: f64, high: f64| {
        let text = r.formula(key)?;
        real_number(r, key, &text, low, high).map(f64::to_radians)
    };
    let azimuth = degrees("azimuth", -720.0, 720.0);
    let elevation = degrees("elevation", -90.0, 90.0);
    let fov = degrees("fov", 1.0, 120.0);
    let orbit = degrees("orbit", -MOST_ORBIT, MOST_ORBIT);
    let projection = match read_word(r, "projection", &ViewProjection::NAMES) {
        Some(true) => Some(ViewProjection::Orthographic),
        Some(false) => Some(ViewProjection::Perspective {
            fov_y: fov.unwrap_or(DEFAULT_FOV_DEG.to_radians()),
        }),
        None => fov.map(|fov_y| ViewProjection::Perspective { fov_y }),
    };
    let from = read_word(r, "from", &NamedView::NAMES);
    let theme = read_word(r, "theme", &Theme::NAMES);
    let edges = read_word(r, "edges", &EdgeLines::NAMES);
    let shadows = read_word(r, "shadows", &Shadows::NAMES);
    ViewChange {
        from,
        azimuth,
        elevation,
        projection,
        theme,
        edges,
        shadows,
        background: r.colour("background"),
        captions: r.boolean("captions"),
        ground: r.boolean("ground"),
        ghosts: read_number(r, "ghosts", 0.0, MOST_GHOSTS as f64)
            .map(|n| Ghosts::Count(n as usize)),
        trails: read_word(r, "trails", &Trails::NAMES),
        arrows: r.boolean("arrows"),
        axes: read_word(r, "axes", &ShownAxes::NAMES),
        gauge: r.boolean("gauge"),
        joints: r.boolean("joints"),
        orbit,
        section: r.table("section", read_section).flatten(),
        explode: r
            .formula("explode")
            .and_then(|text| real_number(r, "explode", &text, 0.0, MOST_EXPLODED)),
        ..ViewChange::default()
    }
}

fn read_section(r: &mut TableReader) -> Option<SectionPlane> {
    let [point, normal] = ["point", "normal"].map(|key| {
        let Some(texts) = r.vector::<3>(key) else {
            r.missing(key);
            return None;
        };
        let values = texts.map(|text| real_number(r, key, &text, f64::MIN, f64::MAX));
        let [x, y, z] = values;
        Some(DVec3::new(x?, y?, z?))
    });
    let plane = SectionPlane::new(point?, normal?);
    if plane.is_none() {
        let message = "the `normal` of a section has no direction";
        r.diagnostics
            .push(Diagnostic::error(message).at(r.span.clone()));
    }
    plane
}

/// One of the words that `key` may have.
fn read_word<T: Copy>(r: &mut TableReader, key: &'static str, known: &[(&str, T)]) -> Option<T> {
    let word = r.string(key)?;
    chosen_word(&Some(word), known, key, r.diagnostics).into()
}

/// A whole number under `key`.
fn read_number(r: &mut TableReader, key: &'static str, low: f64, high: f64) -> Option<f64> {
    let text = r.formula(key)?;
    whole_number(r, key, &text, low, high)
}

fn whole_number(
    r: &mut TableReader,
    what: &str,
    text: &FormulaText,
    low: f64,
    high: f64,
) -> Option<f64> {
    let value = real_number(r, what, text, low, high)?;
    if value.fract() != 0.0 {
        let message = format!("{what} must be a whole number, found {value}");
        r.diagnostics
            .push(Diagnostic::error(message).at(text.span.clone()));
        return None;
    }
    Some(value)
}

fn real_number(
    r: &mut TableReader,
    what: &str,
    text: &FormulaText,
    low: f64,
    high: f64,
) -> Option<f64> {
    let value = text.text.parse::<f64>().ok().filter(|v| v.is_finite());
    let found = match value {
        Some(value) => in_range(what, value, [low, high], &text.span),
        None => {
            let message = format!("{what} must be a number, found `{}`", text.text);
            Err(Diagnostic::error(message).at(text.span.clone()))
        }
    };
    r.diagnostics.taken(found)
}
