//! The sheet: what is shown, in which order, and the text below the drawing.

use super::arcs::{arc_level, draw_angle};
use super::bins::SpatialBins;
use super::ground::draw_ground;
use super::ink::{Ink, WantedLabel};
use super::labels::{PlacedLabel, place_labels};
use super::lengths::{draw_dimension, draw_vector};
use super::lettering::{QuantityLettering, source_colour, valued_name};
use super::links::{draw_links, is_one_spot, leaving_direction, number_links, sign_places};
use super::loops::{draw_frames, draw_loop};
use super::plane::{DrawingPlane, DrawnSpot, USUAL_WIDTH, facing_axes};
use super::scheme::{QuantitySource, Scheme, SchemeJoint, SchemeLength};
use super::surfaces::draw_surface;
use super::symbols::draw_joint;
use crate::model::joints::JointKind;
use crate::plot::Drawing;
use crate::plot::layout::{Ruler, Sizes};
use crate::plot::primitive::{DrawnPrimitive, Rect, TextAnchor};
use crate::plot::theme::{ChartTheme, Colour};
use crate::sorting::sort_by_number;
use crate::staging::quantity_names::written_names;
use glam::DMat3;

/// Height of capitals of labels, and of the lines under the drawing.
const LETTERS: f64 = 9.6;
const NOTES: f64 = 8.6;

/// What is shown in addition to links and joints.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DiagramParts {
    /// Axes of the links' frames.
    pub frames: bool,
    /// Numbers of the links.
    pub bodies: bool,
    /// Named lengths and constant angles.
    pub dimensions: bool,
    /// Loops.
    pub loops: bool,
    /// Names of the bodies under the drawing, and of traced points.
    pub names: bool,
    /// Named lengths as vectors instead of dimension lines.
    pub vectors: bool,
    /// Coordinates: angles as arcs, lengths as lines.
    pub angles: bool,
    /// Values behind the names.
    pub values: bool,
}

/// Turns something on.
type ShownSwitch = fn(&mut DiagramParts);

impl DiagramParts {
    /// The keywords of the command line, each with what it shows.
    pub const WORDS: [(&'static str, ShownSwitch); 8] = [
        ("frames", |s| s.frames = true),
        ("bodies", |s| s.bodies = true),
        ("dimensions", |s| s.dimensions = true),
        ("loops", |s| s.loops = true),
        ("names", |s| s.names = true),
        ("vectors", |s| s.vectors = true),
        ("angles", |s| s.angles = true),
        ("values", |s| s.values = true),
    ];

    /// What is shown by default.
    pub const USUAL: Self = Self {
        frames: false,
        bodies: true,
        dimensions: true,
        loops: true,
        names: true,
        vectors: false,
        angles: true,
        values: false,
    };
}

/// How a scheme is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct SheetOptions {
    /// Right, up, and towards the viewer; if absent, a planar mechanism is seen from its front.
    pub axes: Option<DMat3>,
    /// The axes for a spatial mechanism.
    pub spatial_axes: DMat3,
    /// Pixels.
    pub width: u32,
    /// Colours.
    pub theme: ChartTheme,
    /// What is shown.
    pub shown: DiagramParts,
    /// Above the drawing.
    pub title: String,
    /// Unit of lengths.
    pub length_unit: String,
    /// Unit of angles, and radians in one.
    pub angle_unit: (String, f64),
}

/// A scheme laid out.
#[derive(Clone, Debug, PartialEq)]
pub struct DiagramSheet {
    /// For the writers.
    pub drawing: Drawing,
    /// The labels on it.
    pub labels: Vec<PlacedLabel>,
    /// The lines under it.
    pub notes: Vec<String>,
}

/// Lays a scheme out.
pub fn draw_sheet(scheme: &Scheme, options: &SheetOptions) -> DiagramSheet {
    // A planar mechanism is seen along its normal, a spatial one from a usual direction.
    let normal = scheme.normal();
    let axes = options
        .axes
        .or(normal.map(facing_axes))
        .unwrap_or(options.spatial_axes);
    let width = f64::from(options.width);
    let plane = DrawingPlane::fitted(axes, scheme, width);
    let is_plane = normal.is_some_and(|n| plane.nearness(n).abs() > 0.999);
    let unit = width / USUAL_WIDTH;
    // Primitives, and the places that they cover, for lines and labels that avoid them.
    let mut ink = Ink {
        primitives: Vec::new(),
        bins: SpatialBins::new(unit),
        labels: Vec::new(),
        letters: Vec::new(),
        theme: options.theme,
        unit,
    };
    let lettering = QuantityLettering {
        size: LETTERS * unit,
        values: options.shown.values,
        length_unit: options.length_unit.clone(),
        angle_unit: options.angle_unit.clone(),
    };
    // The mechanism first, then quantities, loops and frames.
    draw_mechanism(
        scheme,
        &plane,
        is_plane,
        &lettering,
        options.shown,
        &mut ink,
    );
    let mut notes = Vec::new();
    let hidden = draw_quantities(scheme, &plane, &lettering, options, &mut ink);
    if options.shown.loops {
        for (k, item) in scheme.loops.iter().enumerate() {
            draw_loop(&item.name, &item.points, k, &plane, &lettering, &mut ink);
        }
    }
    if options.shown.frames {
        draw_frames(&scheme.links, &plane, &lettering, &mut ink);
    }
    // Labels last, when all that they must avoid is drawn.
    let folds = title_lines(options, &plane, unit).len().saturating_sub(1);
    let title_height = (4.0 + TITLE_LINE * folds as f64) * LETTERS * unit;
    let mut area = plane.inside(6.0 * unit);
    area.top += title_height;
    let (labels, left_out) = place_labels(&mut ink, area);
    if options.shown.names {
        notes.push(body_names(scheme));
    }
    notes.extend(note_line("not seen from here", hidden));
    notes.extend(note_line("without room", left_out));
    finished_sheet(ink, &plane, labels, notes, options)
}

fn note_line(what: &str, list: Vec<String>) -> Option<String> {
    (!list.is_empty()).then(|| format!("{what}: {}", list.join(", ")))
}

/// Between the items of a list.
const BETWEEN_ITEMS: &str = "  ·  ";

/// `1 frame · 2 crank`
fn body_names(scheme: &Scheme) -> String {
    let mut named: Vec<(usize, String)> = scheme
        .links
        .iter()
        .filter(|link| link.is_shown && !link.names.is_empty())
        .map(|link| (link.number, link.names.join(", ")))
        .collect();
    named.sort();
    let texts: Vec<String> = named
        .into_iter()
        .map(|(k, names)| format!("{k} {names}"))
        .collect();
    texts.join(BETWEEN_ITEMS)
}

/// Links, signs, ground, numbers.
fn draw_mechanism(
    scheme: &Scheme,
    plane: &DrawingPlane,
    is_plane: bool,
    lettering: &QuantityLettering,
    shown: DiagramParts,
    ink: &mut Ink,
) {
    let signs = sign_places(scheme, plane, ink.unit);
    for surface in &scheme.surfaces {
        draw_surface(surface, scheme.size, plane, ink);
    }
    draw_links(scheme, &signs, plane, is_plane, ink);
    let (mut grounds, mut standing): (Vec<DrawnSpot>, Vec<DrawnSpot>) = (Vec::new(), Vec::new());
    for (joint, sign) in scheme.joints.iter().zip(&signs) {
        // Links that meet at one fixed pin share its ground.
        let is_there = |other: &DrawnSpot| is_one_spot(*other, *sign);
        let is_pin = joint.from == joint.at;
        if joint.links.contains(&0) && !(is_pin && standing.iter().any(is_there)) {
            grounds.push(draw_ground(joint, *sign, plane, ink));
            standing.push(*sign);
        }
    }
    // Blocks hide what lies under them, such as a pin at the same place.
    let is_block =
        |joint: &SchemeJoint| matches!(joint.kind, JointKind::Prismatic | JointKind::Planar);
    let (blocks, others): (Vec<usize>, Vec<usize>) =
        (0..scheme.joints.len()).partition(|k| is_block(&scheme.joints[*k]));
    for k in blocks.into_iter().chain(others) {
        draw_joint(
            &scheme.joints[k],
            signs[k],
            leaving_direction(scheme, k, &signs, plane),
            plane,
            ink,
        );
    }
    for (name, at, _) in &scheme.points {
        let spot = plane.spot(*at);
        ink.circle(spot, 3.2, ink.theme.text, ink.theme.text, 0.5);
        ink.reserve_circle(spot, 6.0);
        if shown.names {
            let colour = ink.theme.text;
            push_label(
                ink,
                written_names(name),
                spot,
                [0.7, -0.7],
                1.15 * lettering.size,
                colour,
            );
        }
    }
    if shown.bodies {
        number_links(
            scheme,
            (&signs, &grounds),
            (plane, is_plane),
            lettering,
            ink,
        );
    }
    if shown.angles {
        for (joint, sign) in scheme
            .joints
            .iter()
            .zip(&signs)
            .filter(|(j, _)| !j.names.is_empty())
        {
            let names: Vec<String> = joint.names.iter().map(|n| written_names(n)).collect();
            let source = match joint.is_driven {
                true => QuantitySource::Input,
                false => QuantitySource::Unknown,
            };
            let colour = source_colour(source, &ink.theme);
            push_label(
                ink,
                names.join(", "),
                *sign,
                [0.8, 0.6],
                lettering.size,
                colour,
            );
        }
    }
}

fn push_label(
    ink: &mut Ink,
    text: String,
    anchor: DrawnSpot,
    wish: DrawnSpot,
    size: f64,
    colour: Colour,
) {
    ink.labels.push(WantedLabel {
        text,
        anchor,
        wish,
        size,
        colour,
        ringed: false,
        least: 9.0,
    });
}

/// Lengths and angles; those that are seen end-on or are zero, with their values.
fn draw_quantities(
    scheme: &Scheme,
    plane: &DrawingPlane,
    lettering: &QuantityLettering,
    options: &SheetOptions,
    ink: &mut Ink,
) -> Vec<String> {
    let shown = options.shown;
    let mut hidden = Vec::new();
    let is_shown = |source: QuantitySource| match source {
        QuantitySource::Constant => shown.dimensions,
        _ => shown.angles,
    };
    // Short ones next to what they measure, longer ones farther out.
    let mut lengths: Vec<&SchemeLength> = scheme.lengths.iter().collect();
    sort_by_number(&mut lengths, |a| a.from.distance(a.to));
    for length in lengths {
        let as_vector = shown.vectors && length.in_loop;
        let drawn = match as_vector {
            true => draw_vector(length, plane, lettering, ink),
            false if is_shown(length.source) => draw_dimension(length, plane, lettering, ink),
            false => continue,
        };
        if !drawn {
            hidden.push(valued_name(
                &length.name,
                length.value,
                &options.length_unit,
            ));
        }
    }
    for (k, angle) in scheme.angles.iter().enumerate() {
        if is_shown(angle.source) {
            let level = arc_level(&scheme.angles, k, plane, 6.0 * ink.unit);
            draw_angle(angle, level, plane, lettering, ink);
        }
    }
    hidden
}

/// Size of the title's letters, in that of the others.
const TITLE: f64 = 1.35;

/// Height of a line of the title, in letters.
const TITLE_LINE: f64 = 2.0;

/// The title, folded to the width.
fn title_lines(options: &SheetOptions, plane: &DrawingPlane, unit: f64) -> Vec<String> {
    let wide = plane.size[0] - 36.0 * unit;
    folded_lines(
        &options.title,
        wide,
        TITLE * LETTERS * unit,
        &Ruler::default(),
    )
}

/// Title, drawing and notes as one.
fn finished_sheet(
    mut ink: Ink,
    plane: &DrawingPlane,
    labels: Vec<PlacedLabel>,
    notes: Vec<String>,
    options: &SheetOptions,
) -> DiagramSheet {
    let (unit, theme) = (ink.unit, options.theme);
    let ruler = Ruler::default();
    let note_size = NOTES * unit;
    // The notes below, folded to the width, and the title above.
    let wide = plane.size[0] - 36.0 * unit;
    let lines: Vec<String> = notes
        .iter()
        .flat_map(|note| folded_lines(note, wide, note_size, &ruler))
        .collect();
    let line_height = 2.1 * note_size;
    let mut baseline = plane.size[1] + 0.9 * line_height;
    let left = 18.0 * unit;
    let letters = LETTERS * unit;
    for (k, line) in title_lines(options, plane, unit).iter().enumerate() {
        ink.text(
            [left, (2.6 + TITLE_LINE * k as f64) * letters],
            line,
            TITLE * letters,
            TextAnchor::Start,
            theme.text,
        );
    }
    for line in &lines {
        ink.text(
            [left, baseline],
            line,
            note_size,
            TextAnchor::Start,
            theme.faint_text,
        );
        baseline += line_height;
    }
    // The sheet ends below the last note; its colour lies under everything.
    let height = plane.size[1] + line_height * lines.len() as f64 + 0.8 * line_height;
    let size = [plane.size[0], height].map(|side| side.ceil() as u32);
    let rect = Rect {
        left: 0.0,
        top: 0.0,
        right: f64::from(size[0]),
        bottom: f64::from(size[1]),
    };
    let paper = DrawnPrimitive::Area {
        rect,
        fill: theme.background,
    };
    let mut primitives = vec![paper];
    primitives.append(&mut ink.primitives);
    // The labels in words, for readers who do not see the picture.
    let names: Vec<&str> = labels.iter().map(|l| l.text.as_str()).collect();
    DiagramSheet {
        drawing: Drawing {
            size,
            title: options.title.clone(),
            description: format!("kinematic diagram with the labels {}", names.join("; ")),
            primitives,
            areas: Vec::new(),
            theme,
            sizes: Sizes::scaled(unit),
        },
        labels,
        notes,
    }
}

/// A text in lines that are no wider than `wide`; a list is folded between its items.
fn folded_lines(text: &str, wide: f64, size: f64, ruler: &Ruler) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let is_narrow = |piece: &str| ruler.width(piece, size) <= wide;
    let is_list = text.contains(BETWEEN_ITEMS) && text.split(BETWEEN_ITEMS).all(is_narrow);
    let separator = if is_list { BETWEEN_ITEMS } else { " " };
    for word in text.split(separator) {
        let longer = lines.last().map(|line| format!("{line}{separator}{word}"));
        match (lines.last_mut(), longer) {
            (Some(line), Some(longer)) if is_narrow(&longer) => *line = longer,
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}
