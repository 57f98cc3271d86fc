//! Signed bars in a table: a row for each name, a column for each quantity, every column with a scale of its own.

use super::drawing::Drawing;
use super::layout::{Ruler, Sizes};
use super::primitive::{DrawnPrimitive, LineStyle, Rect, TextAnchor};
use super::theme::{ChartTheme, Colour};
use crate::numbers::decimal::{significant, with_minus};

/// What a picture of bars shows.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct BarChart {
    /// Title of the whole.
    pub title: String,
    /// One sentence for readers who do not see the picture.
    pub description: String,
    /// Blocks of rows below each other; the values of different blocks are not comparable.
    pub blocks: Vec<BarBlock>,
    /// Lines under the bars.
    pub notes: Vec<String>,
}

/// Rows whose values have the same units.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct BarBlock {
    /// What stands above the names.
    pub heading: String,
    /// Names of the rows, from top to bottom.
    pub rows: Vec<String>,
    /// Quantities, from left to right.
    pub columns: Vec<BarColumn>,
}

/// One quantity of all rows.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct BarColumn {
    /// Its name, with the unit.
    pub label: String,
    /// One value a row.
    pub values: Vec<f64>,
}

/// Width of a column, and the least of a whole picture, in heights of the capitals.
const COLUMN: f64 = 15.5;
const LEAST_WIDTH: f64 = 64.0;

/// Height of a row, and of a bar in it, in heights of the capitals.
const ROW: f64 = 2.3;
const BAR: f64 = 1.3;

/// Room of a bar's number right of the bars, in heights of the capitals.
const NUMBER: f64 = 5.6;

/// The size in pixels that suits a picture of bars.
pub fn usual_size(chart: &BarChart) -> [u32; 2] {
    let [width, height] = natural_size(chart, &Sizes::scaled(1.0), &Ruler::default());
    [width.ceil() as u32, height.ceil() as u32]
}

/// Lays `chart` out in `size` pixels.
pub fn draw_bars(chart: &BarChart, size: [u32; 2], theme: ChartTheme) -> Drawing {
    let ruler = Ruler::default();
    // All sizes scale with the picture: the tighter side decides.
    let usual = natural_size(chart, &Sizes::scaled(1.0), &ruler);
    let shares = [0, 1].map(|k| f64::from(size[k]) / usual[k]);
    let sizes = Sizes::scaled(shares[0].min(shares[1]));
    // One column for the names, as wide as the longest; `top` moves down as things are drawn.
    let mut table = BarTable {
        sizes,
        theme,
        list: Vec::new(),
        names: names_width(chart, &sizes, &ruler),
        width: f64::from(size[0]) - 4.0 * sizes.gap,
        top: 2.0 * sizes.gap,
    };
    // Background, title, blocks, notes.
    let whole = Rect {
        left: 0.0,
        top: 0.0,
        right: f64::from(size[0]),
        bottom: f64::from(size[1]),
    };
    let fill = theme.background;
    table.list.push(DrawnPrimitive::Area { rect: whole, fill });
    if !chart.title.is_empty() {
        let at = [2.0 * sizes.gap, table.top + sizes.title];
        table.text(at, &chart.title, sizes.title, TextAnchor::Start, theme.text);
        table.top += sizes.title + 3.0 * sizes.gap;
    }
    for block in &chart.blocks {
        table.block(block);
    }
    for note in &chart.notes {
        let at = [2.0 * sizes.gap, table.top + sizes.small];
        table.text(at, note, sizes.small, TextAnchor::Start, theme.faint_text);
        table.top += sizes.line(sizes.small);
    }
    Drawing {
        size,
        title: chart.title.clone(),
        description: chart.description.clone(),
        primitives: table.list,
        areas: Vec::new(),
        theme,
        sizes,
    }
}

fn names_width(chart: &BarChart, sizes: &Sizes, ruler: &Ruler) -> f64 {
    let texts = |b: &BarBlock| [&b.rows[..], std::slice::from_ref(&b.heading)].concat();
    let names = chart.blocks.iter().flat_map(texts);
    let widest = names
        .map(|n| ruler.width(&n, sizes.text))
        .fold(0.0, f64::max);
    widest + 2.0 * sizes.gap
}

fn natural_size(chart: &BarChart, sizes: &Sizes, ruler: &Ruler) -> [f64; 2] {
    let columns = chart.blocks.iter().map(|b| b.columns.len()).max();
    let columns = columns.unwrap_or(0) as f64;
    let wide = names_width(chart, sizes, ruler) + columns * COLUMN * sizes.text;
    let notes = chart.notes.iter().map(|n| ruler.width(n, sizes.small));
    let wide = notes.fold(wide.max(LEAST_WIDTH * sizes.text), f64::max);
    let block = |b: &BarBlock| (b.rows.len() as f64 + 1.0) * ROW * sizes.text + 3.0 * sizes.gap;
    let title = match chart.title.is_empty() {
        true => 0.0,
        false => sizes.title + 3.0 * sizes.gap,
    };
    let notes = sizes.line(sizes.small) * chart.notes.len() as f64;
    let high = title + chart.blocks.iter().map(block).sum::<f64>() + notes;
    [wide + 4.0 * sizes.gap, high + 4.0 * sizes.gap]
}

/// The primitives laid out so far.
struct BarTable {
    sizes: Sizes,
    theme: ChartTheme,
    list: Vec<DrawnPrimitive>,
    /// Width of the names.
    names: f64,
    /// Width of everything.
    width: f64,
    /// Position of the next element.
    top: f64,
}

impl BarTable {
    fn text(&mut self, at: [f64; 2], text: &str, size: f64, anchor: TextAnchor, colour: Colour) {
        self.list.push(DrawnPrimitive::Text {
            at,
            text: text.to_owned(),
            size,
            anchor,
            colour,
        });
    }

    fn block(&mut self, block: &BarBlock) {
        let (sizes, theme) = (self.sizes, self.theme);
        let (left, high) = (2.0 * sizes.gap, ROW * sizes.text);
        // The columns share what the names leave.
        let wide = (self.width - self.names) / block.columns.len().max(1) as f64;
        let baseline = |top: f64| top + 0.5 * (high + sizes.text);
        let head = [left, baseline(self.top)];
        self.text(
            head,
            &block.heading,
            sizes.text,
            TextAnchor::Start,
            theme.faint_text,
        );
        // Names of the rows, every other row on a tinted ground.
        let first = self.top + high;
        for (k, name) in block.rows.iter().enumerate() {
            let top = first + k as f64 * high;
            if k % 2 == 0 {
                let rect = Rect {
                    left,
                    top,
                    right: left + self.width,
                    bottom: top + high,
                };
                let [r, g, b, _] = theme.grid;
                let fill = [r, g, b, 120];
                self.list.push(DrawnPrimitive::Area { rect, fill });
            }
            self.text(
                [left, baseline(top)],
                name,
                sizes.text,
                TextAnchor::Start,
                theme.text,
            );
        }
        // Headings of the columns, and their bars.
        for (k, column) in block.columns.iter().enumerate() {
            let left = left + self.names + k as f64 * wide;
            let at = [left + sizes.gap, head[1]];
            self.text(at, &column.label, sizes.text, TextAnchor::Start, theme.text);
            self.bars(column, [left + sizes.gap, first], wide - 2.0 * sizes.gap);
        }
        self.top = first + block.rows.len() as f64 * high + 3.0 * sizes.gap;
    }

    /// The bars of a column from `corner` (left, top) on.
    fn bars(&mut self, column: &BarColumn, [left, top]: [f64; 2], wide: f64) {
        let (sizes, theme) = (self.sizes, self.theme);
        // Every column has a scale of its own, from its least to its greatest value, zero included.
        let finite = column.values.iter().filter(|v| v.is_finite());
        let (low, high) = finite.fold((0.0_f64, 0.0_f64), |(l, h), v| (l.min(*v), h.max(*v)));
        let room = wide - NUMBER * sizes.text;
        let unit = if high > low { room / (high - low) } else { 0.0 };
        let zero = left - low * unit;
        let row = ROW * sizes.text;
        for (k, value) in column.values.iter().enumerate() {
            let middle = top + (k as f64 + 0.5) * row;
            if value.is_finite() {
                // A bar from zero to the value, coloured by its sign.
                let end = zero + value * unit;
                let rect = Rect {
                    left: zero.min(end),
                    right: zero.max(end),
                    top: middle - 0.5 * BAR * sizes.text,
                    bottom: middle + 0.5 * BAR * sizes.text,
                };
                let fill = theme.colour(usize::from(*value < 0.0));
                self.list.push(DrawnPrimitive::Area { rect, fill });
            }
            let at = [left + wide, middle + 0.5 * sizes.small];
            self.text(
                at,
                &with_minus(&significant(*value, 3)),
                sizes.small,
                TextAnchor::End,
                theme.faint_text,
            );
        }
        // The line of zero through all rows.
        let bottom = top + column.values.len() as f64 * row;
        self.list.push(DrawnPrimitive::Line {
            points: vec![[zero, top], [zero, bottom]],
            stroke: LineStyle::solid(theme.axis, sizes.hair),
            name: String::new(),
        });
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn bars_of(drawing: &Drawing) -> Vec<(Rect, Colour)> {
        let theme = drawing.theme;
        let colours = [theme.colour(0), theme.colour(1)];
        let areas = drawing.primitives.iter().filter_map(|p| match p {
            DrawnPrimitive::Area { rect, fill } if colours.contains(fill) => Some((*rect, *fill)),
            _ => None,
        });
        areas.collect()
    }

    #[test]
    fn bars_are_as_long_as_their_values_and_inside_the_picture() {
        let column = |values: &[f64]| BarColumn {
            label: "dS".to_owned(),
            values: values.to_vec(),
        };
        let chart = BarChart {
            title: "t".to_owned(),
            blocks: vec![BarBlock {
                heading: "per mm".to_owned(),
                rows: ["a", "b", "c"].map(str::to_owned).to_vec(),
                columns: vec![column(&[2.0, -1.0, 0.5]), column(&[1e-6, 3e-6, f64::NAN])],
            }],
            notes: vec!["n".to_owned()],
            ..BarChart::default()
        };
        for scale in [1, 2] {
            let size = usual_size(&chart).map(|side| side * scale);
            let drawing = draw_bars(&chart, size, ChartTheme::LIGHT);
            let bars = bars_of(&drawing);
            assert_eq!(bars.len(), 5, "a value that is none has no bar");
            let long = |k: usize| bars[k].0.width();
            assert!(
                (long(0) / long(1) - 2.0).abs() < 1e-9 && (long(0) / long(2) - 4.0).abs() < 1e-9
            );
            assert!((long(4) / long(3) - 3.0).abs() < 1e-9);
            assert!(bars[0].1 != bars[1].1 && bars[0].1 == bars[2].1);
            // The negative bar ends where the positive ones begin.
            assert!((bars[1].0.right - bars[0].0.left).abs() < 1e-9);
            let inside = |r: &Rect| r.left >= 0.0 && r.right <= f64::from(size[0]);
            assert!(
                bars.iter()
                    .all(|(r, _)| inside(r) && r.bottom < f64::from(size[1]))
            );
        }
    }
}
