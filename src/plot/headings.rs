//! The texts above a panel's area: its title, the label of the vertical axis with the legend, the words of events.
//!
//! None of them covers the curves.

use super::chart::{Panel, SeriesStyle};
use super::layout::{Ruler, Sizes};
use super::primitive::{DrawnPrimitive, LineStyle, Rect, TextAnchor};
use super::scale::Scale;
use super::theme::{ChartTheme, Dashes};

/// Most rows of words above an area; further words are omitted, but their lines are drawn.
const MOST_ROWS: usize = 3;

/// Length of the sample of a line in the legend, in heights of the capitals.
const SAMPLE: f64 = 2.4;

/// A legend's entry at its place.
struct HeadingEntry {
    left: f64,
    row: usize,
    series: usize,
}

/// The heading of a panel: its lines of text and where they stand.
pub struct Heading {
    label: String,
    entries: Vec<HeadingEntry>,
    rows: usize,
    has_title: bool,
}

impl Heading {
    /// Sets the label of the vertical axis and the legend into rows `width` wide.
    pub fn new(panel: &Panel, label: String, width: f64, ruler: &Ruler, sizes: &Sizes) -> Self {
        let mut entries = Vec::new();
        let (mut x, mut row) = (0.0, 0);
        if !label.is_empty() {
            x = ruler.width(&label, sizes.text) + 3.0 * sizes.gap;
        }
        if panel.series.len() > 1 {
            for (series, item) in panel.series.iter().enumerate() {
                let wide = SAMPLE * sizes.text + sizes.gap + ruler.width(&item.name, sizes.text);
                if x > 0.0 && x + wide > width {
                    (x, row) = (0.0, row + 1);
                }
                entries.push(HeadingEntry {
                    left: x,
                    row,
                    series,
                });
                x += wide + 2.5 * sizes.gap;
            }
        }
        let rows = if label.is_empty() && entries.is_empty() {
            0
        } else {
            row + 1
        };
        Self {
            label,
            entries,
            rows,
            has_title: !panel.title.is_empty(),
        }
    }

    /// Pixels it takes.
    pub fn height(&self, sizes: &Sizes) -> f64 {
        let title = if self.has_title {
            sizes.heading + 1.6 * sizes.gap
        } else {
            0.0
        };
        title + self.rows as f64 * sizes.line(sizes.text)
    }

    /// Draws it from `corner` (left, top) on.
    pub fn draw(
        &self,
        panel: &Panel,
        [left, top]: [f64; 2],
        sizes: &Sizes,
        theme: &ChartTheme,
        list: &mut Vec<DrawnPrimitive>,
    ) {
        let mut text = |x: f64, y: f64, size: f64, text: &str| {
            list.push(DrawnPrimitive::Text {
                at: [x, y],
                text: text.to_owned(),
                size,
                anchor: TextAnchor::Start,
                colour: theme.text,
            });
        };
        // From the top down: the title, then the label of the vertical axis.
        let mut baseline = top;
        if self.has_title {
            text(left, baseline + sizes.heading, sizes.heading, &panel.title);
            baseline += sizes.heading + 1.6 * sizes.gap;
        }
        baseline += sizes.text + 0.5 * sizes.gap;
        if !self.label.is_empty() {
            text(left, baseline, sizes.text, &self.label);
        }
        // The legend begins in the label's row: names, then samples of the lines.
        let row = |entry: &HeadingEntry| baseline + entry.row as f64 * sizes.line(sizes.text);
        let sample = SAMPLE * sizes.text;
        for entry in &self.entries {
            let x = left + entry.left + sample + sizes.gap;
            text(x, row(entry), sizes.text, &panel.series[entry.series].name);
        }
        for entry in &self.entries {
            let (x, y) = (left + entry.left, row(entry) - 0.45 * sizes.text);
            list.push(DrawnPrimitive::Line {
                points: vec![[x, y], [x + sample, y]],
                stroke: curve_stroke(panel, entry.series, sizes, theme),
                name: String::new(),
            });
        }
    }
}

/// The look of curve `index` of a panel.
pub fn curve_stroke(panel: &Panel, index: usize, sizes: &Sizes, theme: &ChartTheme) -> LineStyle {
    let style = panel.series.get(index).map(|series| series.style);
    LineStyle {
        colour: theme.colour(index),
        width: sizes.curve,
        dashes: match style {
            Some(SeriesStyle::Dashed) => Dashes::Long,
            _ => theme.dashes(index),
        },
    }
}

/// A word above the area at its place.
struct Word {
    text: String,
    middle: f64,
    row: usize,
}

/// The words of events above an area.
pub struct Words {
    list: Vec<Word>,
    rows: usize,
}

impl Words {
    /// Places each `(x, word)` above its position, in as few rows as possible, in the order of the list. `room` pixels
    /// are available.
    pub fn new(
        words: &[(f64, String)],
        scale: &Scale,
        room: f64,
        ruler: &Ruler,
        sizes: &Sizes,
    ) -> Self {
        let rows = (room / (0.9 * sizes.line(sizes.small))).floor();
        let rows = (rows.max(0.0) as usize).min(MOST_ROWS);
        let mut taken: Vec<Vec<[f64; 2]>> = vec![Vec::new(); rows];
        let mut list: Vec<Word> = Vec::new();
        for (x, text) in words {
            let Some(pixel) = scale.pixel(*x) else {
                continue;
            };
            if text.is_empty() {
                continue;
            }
            let half = 0.5 * ruler.width(text, sizes.small);
            let (first, last) = (
                scale.start + half,
                (scale.end - half).max(scale.start + half),
            );
            let middle = pixel.clamp(first, last);
            let [from, to] = [middle - half - sizes.gap, middle + half + sizes.gap];
            let is_free = |row: &Vec<[f64; 2]>| row.iter().all(|t| to < t[0] || t[1] < from);
            if let Some(row) = taken.iter().position(is_free) {
                taken[row].push([middle - half, middle + half]);
                list.push(Word {
                    text: text.clone(),
                    middle,
                    row,
                });
            }
        }
        let rows = list.iter().map(|w| w.row + 1).max().unwrap_or(0);
        Self { list, rows }
    }

    /// Pixels they take.
    pub fn height(&self, sizes: &Sizes) -> f64 {
        self.rows as f64 * sizes.line(sizes.small) * 0.9
    }

    /// Draws them right above `area`.
    pub fn draw(
        &self,
        area: &Rect,
        sizes: &Sizes,
        theme: &ChartTheme,
        list: &mut Vec<DrawnPrimitive>,
    ) {
        for word in &self.list {
            let up = word.row as f64 * sizes.line(sizes.small) * 0.9;
            list.push(DrawnPrimitive::Text {
                at: [word.middle, area.top - 0.8 * sizes.gap - up],
                text: word.text.clone(),
                size: sizes.small,
                anchor: TextAnchor::Middle,
                colour: theme.faint_text,
            });
        }
    }
}
