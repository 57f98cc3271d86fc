//! The scene file as typed: all sections and keys except those of shapes and plots, with their positions, before any
//! name is looked up.

use super::bars::{BarFile, BarParts, read_bar};
use super::bodies::{BodyFile, LabelFile, TraceFile, read_body, read_label, read_trace};
use super::clearance::{self, ClearanceFile, DistanceFile};
use super::contacts::{ContactFile, read_surfaces};
use super::keys::linkage::{BAR, CONTACT};
use super::keys::results::{DISTANCE, MEASURE, TRACK};
use super::keys::tables::{INPUT, SCENE};
use super::measures::{MeasureFile, TrackFile, measure_formula, read_measure, read_track};
use super::plots::{PlotFile, read_plot};
use super::reader::{FoundValue, NamedFormula, Spanned, TableReader, read_table};
use super::shown_dimensions::{ShownDimensionFile, read_shown_dimension};
use super::studies::{StudyFile, read_study};
use super::syntax::parse_tables;
use super::values::{FormulaText, formula_of};
use super::views::{ViewFile, read_view};
use crate::diag::{Diagnostic, Diagnostics, Source};
use toml::de::DeValue;

/// A scene file.
#[derive(Clone, Debug, Default)]
pub struct SceneFile {
    /// `title`
    pub title: Option<String>,
    /// `description`: one line for lists.
    pub description: Option<String>,
    /// `units.length`
    pub length_unit: Option<String>,
    /// `units.angle`
    pub angle_unit: Option<Spanned<String>>,
    /// `duration` in seconds
    pub duration: Option<FormulaText>,
    /// `[parameters]`
    pub parameters: Vec<NamedFormula>,
    /// What the command line replaces in them.
    pub replaced: Vec<(String, FormulaText)>,
    /// `[inputs]`
    pub inputs: Vec<(Spanned<String>, InputFile)>,
    /// `[chains]`
    pub chains: Vec<NamedFormula>,
    /// `[loops]`
    pub loops: Vec<NamedFormula>,
    /// `[equations]`
    pub equations: Vec<NamedFormula>,
    /// `[bars]`
    pub bars: Vec<BarFile>,
    /// `[contacts]`
    pub contacts: Vec<ContactFile>,
    /// `[guess]`
    pub guess: Vec<NamedFormula>,
    /// `[[bodies]]`
    pub bodies: Vec<BodyFile>,
    /// `[[traces]]`
    pub traces: Vec<TraceFile>,
    /// `[outputs]` that are formulas.
    pub outputs: Vec<NamedFormula>,
    /// `[outputs]` that are distances of bodies.
    pub distances: Vec<DistanceFile>,
    /// `[tracks]`
    pub tracks: Vec<TrackFile>,
    /// `[measures]`
    pub measures: Vec<MeasureFile>,
    /// `[[labels]]`
    pub labels: Vec<LabelFile>,
    /// `[[dimensions]]`
    pub dimensions: Vec<ShownDimensionFile>,
    /// `[clearance]`
    pub clearance: Option<ClearanceFile>,
    /// `[[plots]]`
    pub plots: Vec<PlotFile>,
    /// `[view]`
    pub view: ViewFile,
    /// `[study]`
    pub study: Option<StudyFile>,
    /// Whole sections could not be read, so references to them cannot be checked.
    pub lacks_sections: bool,
}

/// The keys of a scene that are tables or lists of tables.
const SECTIONS: [&str; 16] = [
    "parameters",
    "inputs",
    "chains",
    "loops",
    "equations",
    "bars",
    "contacts",
    "guess",
    "bodies",
    "traces",
    "outputs",
    "tracks",
    "measures",
    "labels",
    "dimensions",
    "plots",
];

/// One entry of `[inputs]`.
#[derive(Clone, Debug)]
pub enum InputFile {
    /// A number or formula of `t`.
    Formula(FormulaText),
    /// Could not be read, which has been reported; the name is kept.
    Unread,
    /// `keys` and `ease`.
    Keys {
        /// Time and value of each key.
        keys: Spanned<Vec<[FormulaText; 2]>>,
        /// Name of the easing.
        ease: Option<Spanned<String>>,
    },
}

/// Reads the text of a scene. Errors go to `diagnostics`; everything that could be read is returned.
pub fn read_scene(source: &Source, diagnostics: &mut Diagnostics) -> SceneFile {
    let Some(document) = parse_tables(&source.text, diagnostics) else {
        return SceneFile {
            lacks_sections: true,
            ..SceneFile::default()
        };
    };
    let table = document.get_ref();
    let found = FoundValue {
        table,
        text: &source.text,
        span: 0..source.text.len(),
    };
    let place = "the scene".to_owned();
    read_table(found, &SCENE, place, diagnostics, |r| {
        scene_tables(r, &source.text)
    })
}

fn scene_tables<'t>(r: &mut TableReader<'t, '_>, text: &'t str) -> SceneFile {
    let title = r.string("title").map(|s| s.value);
    let description = r.lines("description").map(|s| s.value);
    r.string("source");
    let units = r.table("units", |u| (u.string("length"), u.string("angle")));
    let (length_unit, angle_unit) = units.unwrap_or_default();
    let (outputs, distances) = read_outputs(r, text);
    SceneFile {
        title,
        description,
        length_unit: length_unit.map(|s| s.value),
        angle_unit,
        duration: r.formula("duration"),
        parameters: r.named_formulas("parameters"),
        replaced: Vec::new(),
        inputs: read_inputs(r, text),
        chains: r.named_formulas("chains"),
        loops: r.named_formulas("loops"),
        equations: r.named_formulas("equations"),
        bars: read_bars(r, text),
        contacts: read_contacts(r, text),
        guess: r.named_formulas("guess"),
        bodies: r
            .tables("bodies", read_body)
            .into_iter()
            .flatten()
            .collect(),
        traces: r
            .tables("traces", read_trace)
            .into_iter()
            .flatten()
            .collect(),
        outputs,
        distances,
        tracks: read_tracks(r, text),
        measures: read_measures(r, text),
        labels: r
            .tables("labels", read_label)
            .into_iter()
            .flatten()
            .collect(),
        dimensions: r.tables("dimensions", read_shown_dimension),
        clearance: r.table("clearance", clearance::read_clearance),
        plots: r.tables("plots", read_plot).into_iter().flatten().collect(),
        view: r.table("view", read_view).unwrap_or_default(),
        study: r.table("study", |s| read_study(s, text)),
        lacks_sections: r.lacks_sections(&SECTIONS),
    }
}

fn read_inputs<'t>(
    r: &mut TableReader<'t, '_>,
    text: &'t str,
) -> Vec<(Spanned<String>, InputFile)> {
    let mut list = Vec::new();
    for (name, value, span) in r.named("inputs") {
        let input = match value {
            DeValue::Table(table) => {
                let place = format!("input `{}`", name.value);
                let found = FoundValue { table, text, span };
                read_table(found, &INPUT, place, r.diagnostics, input_table)
            }
            other => {
                let formula = formula_of(other, span.clone(), text).map(InputFile::Formula);
                if formula.is_none() {
                    let message = format!(
                        "input `{}` must be a number, a formula of `t` or a table",
                        name.value
                    );
                    r.diagnostics.push(Diagnostic::error(message).at(span));
                }
                formula
            }
        };
        list.push((name, input.unwrap_or(InputFile::Unread)));
    }
    list
}

fn read_bars<'t>(r: &mut TableReader<'t, '_>, text: &'t str) -> Vec<BarFile> {
    let mut list = Vec::new();
    for (name, value, span) in r.named("bars") {
        let place = format!("bar `{}`", name.value);
        let parts = match value.as_table() {
            Some(table) => {
                let found = FoundValue { table, text, span };
                read_table(found, &BAR, place, r.diagnostics, read_bar)
            }
            None => {
                let message = format!("{place} must be a table with `from`, `to` and `length`");
                let hint = "such as { from = \"P\", to = [0, 0], length = 80 }";
                r.diagnostics
                    .push(Diagnostic::error(message).at(span).hint(hint));
                BarParts::default()
            }
        };
        list.push(BarFile { name, parts });
    }
    list
}

fn read_contacts<'t>(r: &mut TableReader<'t, '_>, text: &'t str) -> Vec<ContactFile> {
    let mut list = Vec::new();
    for (name, value, span) in r.named("contacts") {
        let place = format!("contact `{}`", name.value);
        let surfaces = match value.as_table() {
            Some(table) => {
                let found = FoundValue { table, text, span };
                read_table(found, &CONTACT, place, r.diagnostics, read_surfaces)
            }
            None => {
                let message = format!("{place} must be a table with `first` and `second`");
                r.diagnostics.push(Diagnostic::error(message).at(span));
                None
            }
        };
        list.push(ContactFile { name, surfaces });
    }
    list
}

fn read_tracks<'t>(r: &mut TableReader<'t, '_>, text: &'t str) -> Vec<TrackFile> {
    let mut list = Vec::new();
    for (name, value, span) in r.named("tracks") {
        let place = format!("track `{}`", name.value);
        let Some(table) = value.as_table() else {
            let message = format!("{place} must be a table with `samples` and `inputs`");
            r.diagnostics.push(Diagnostic::error(message).at(span));
            continue;
        };
        let read = |r: &mut TableReader<'t, '_>| read_track(r, name);
        let found = FoundValue { table, text, span };
        list.push(read_table(found, &TRACK, place, r.diagnostics, read));
    }
    list
}

/// Outputs: formulas, and tables that ask for a distance.
fn read_outputs<'t>(
    r: &mut TableReader<'t, '_>,
    text: &'t str,
) -> (Vec<NamedFormula>, Vec<DistanceFile>) {
    let asks = |value: &DeValue| value.as_table().is_some_and(|t| t.contains_key("distance"));
    let entries = r.named("outputs").into_iter();
    let (tables, formulas): (Vec<_>, Vec<_>) = entries.partition(|(_, value, _)| asks(value));
    let mut distances = Vec::new();
    for (name, value, span) in tables {
        let Some(table) = value.as_table() else {
            continue;
        };
        let place = format!("output `{}`", name.value);
        let found = FoundValue { table, text, span };
        let read = |r: &mut TableReader<'t, '_>| clearance::read_distance(r, name);
        distances.extend(read_table(found, &DISTANCE, place, r.diagnostics, read));
    }
    (r.formulas_of(formulas), distances)
}

fn read_measures<'t>(r: &mut TableReader<'t, '_>, text: &'t str) -> Vec<MeasureFile> {
    let mut list = Vec::new();
    for (name, value, span) in r.named("measures") {
        let place = format!("measure `{}`", name.value);
        if let Some(table) = value.as_table() {
            let read = |r: &mut TableReader<'t, '_>| read_measure(r, name);
            let found = FoundValue { table, text, span };
            list.push(read_table(found, &MEASURE, place, r.diagnostics, read));
        } else if let Some(formula) = formula_of(value, span.clone(), text) {
            list.push(measure_formula((name, formula)));
        } else {
            let message = format!("{place} must be a formula of measures, or a table");
            r.diagnostics.push(Diagnostic::error(message).at(span));
        }
    }
    list
}

fn input_table(r: &mut TableReader) -> Option<InputFile> {
    let before = r.diagnostics.count();
    let formula = r.formula("formula");
    let keys = r.rows::<2>("keys");
    let ease = r.string("ease");
    match (formula, keys) {
        (Some(formula), None) => Some(InputFile::Formula(formula)),
        (None, Some(keys)) => Some(InputFile::Keys { keys, ease }),
        (None, None) => {
            if r.diagnostics.count() == before {
                r.missing("keys` or `formula");
            }
            None
        }
        (Some(formula), Some(_)) => {
            r.diagnostics.push(
                Diagnostic::error("an input has either `keys` or a `formula`").at(formula.span),
            );
            None
        }
    }
}
