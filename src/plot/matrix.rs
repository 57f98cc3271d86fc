//! A triangle of coloured cells: one for every pair of names.

use super::drawing::Drawing;
use super::layout::{Ruler, Sizes};
use super::primitive::{DrawnPrimitive, Rect, TextAnchor};
use super::theme::{ChartTheme, Colour};

/// What a matrix shows.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct MatrixChart {
    /// Title of the whole.
    pub title: String,
    /// One sentence for readers who do not see the picture.
    pub description: String,
    /// Names of the rows, which are those of the columns.
    pub names: Vec<String>,
    /// One cell per pair; pairs without one stay empty.
    pub cells: Vec<MatrixCell>,
    /// Colours and what they mean.
    pub legend: Vec<(Colour, String)>,
    /// Lines under the matrix.
    pub notes: Vec<String>,
}

/// A cell.
#[derive(Clone, Debug, PartialEq)]
pub struct MatrixCell {
    /// Row and column, the row the larger one.
    pub place: [usize; 2],
    /// Colour.
    pub fill: Colour,
    /// What stands in it, where cells are large enough.
    pub text: String,
}

/// Edge of a cell in heights of the capitals, and the number of names up to which it is that large.
const EDGES: [(usize, f64); 3] = [(16, 6.0), (48, 2.4), (usize::MAX, 1.0)];

/// Texts stand in cells of at least this edge.
const READABLE: f64 = 6.0;

/// A name is no higher than this part of its row.
const NAME: f64 = 0.7;

/// Gap of cells, in their edges.
const GAP: f64 = 0.06;

/// A patch of the legend in heights of the capitals.
const PATCH: f64 = 1.4;

fn cell_edge(chart: &MatrixChart) -> f64 {
    let fits = |(most, _): &&(usize, f64)| chart.names.len() <= *most;
    EDGES.iter().find(fits).map_or(1.0, |(_, edge)| *edge)
}

/// Height of the capitals of names.
fn name_size(chart: &MatrixChart, sizes: &Sizes) -> f64 {
    sizes.text.min(NAME * cell_edge(chart) * sizes.text)
}

/// The name of a row begins with its number, which is the column's.
fn row_name(chart: &MatrixChart, row: usize) -> String {
    format!("{} {}", row + 1, chart.names[row])
}

fn natural_size(chart: &MatrixChart, sizes: &Sizes, ruler: &Ruler) -> [f64; 2] {
    let side = (chart.names.len() as f64 + 1.0) * cell_edge(chart) * sizes.text;
    let legend: f64 = chart
        .legend
        .iter()
        .map(|(_, text)| entry_width(text, sizes, ruler))
        .sum();
    let notes = chart.notes.iter().map(|n| ruler.width(n, sizes.small));
    let title = ruler.width(&chart.title, sizes.title);
    let wide = notes.fold(
        (names_width(chart, sizes, ruler) + side)
            .max(legend)
            .max(title),
        f64::max,
    );
    let lines = 2.0 + chart.notes.len() as f64;
    let high = sizes.title + side + lines * sizes.line(sizes.text);
    [wide + 4.0 * sizes.gap, high + 8.0 * sizes.gap]
}

fn names_width(chart: &MatrixChart, sizes: &Sizes, ruler: &Ruler) -> f64 {
    let size = name_size(chart, sizes);
    let names = (0..chart.names.len()).map(|row| ruler.width(&row_name(chart, row), size));
    names.fold(0.0, f64::max) + 2.0 * sizes.gap
}

fn entry_width(text: &str, sizes: &Sizes, ruler: &Ruler) -> f64 {
    ruler.width(text, sizes.text) + (PATCH + 2.5) * sizes.text
}

/// The size in pixels that suits a matrix.
pub fn usual_size(chart: &MatrixChart) -> [u32; 2] {
    let [width, height] = natural_size(chart, &Sizes::scaled(1.0), &Ruler::default());
    [width.ceil() as u32, height.ceil() as u32]
}

/// Lays `chart` out in `size` pixels.
pub fn draw_matrix(chart: &MatrixChart, size: [u32; 2], theme: ChartTheme) -> Drawing {
    let ruler = Ruler::default();
    let usual = natural_size(chart, &Sizes::scaled(1.0), &ruler);
    let shares = [0, 1].map(|k| f64::from(size[k]) / usual[k]);
    let sizes = Sizes::scaled(shares[0].min(shares[1]));
    let mut sheet = Sheet {
        sizes,
        theme,
        list: Vec::new(),
    };
    sheet.area([0.0, 0.0], size.map(f64::from), theme.background);
    let left = 2.0 * sizes.gap;
    let mut top = 2.0 * sizes.gap + sizes.title;
    sheet.text([left, top], &chart.title, sizes.title, TextAnchor::Start);
    top += 3.0 * sizes.gap;
    sheet.legend(chart, [left, top], &ruler);
    top += 2.0 * sizes.line(sizes.text);
    let corner = [left + names_width(chart, &sizes, &ruler), top];
    sheet.cells(chart, corner);
    top += (chart.names.len() as f64 + 1.0) * cell_edge(chart) * sizes.text + sizes.gap;
    for note in &chart.notes {
        top += sizes.line(sizes.small);
        sheet.text([left, top], note, sizes.small, TextAnchor::Start);
    }
    Drawing {
        size,
        title: chart.title.clone(),
        description: chart.description.clone(),
        primitives: sheet.list,
        areas: Vec::new(),
        theme,
        sizes,
    }
}

/// What has been laid out so far.
struct Sheet {
    sizes: Sizes,
    theme: ChartTheme,
    list: Vec<DrawnPrimitive>,
}

impl Sheet {
    fn text(&mut self, at: [f64; 2], text: &str, size: f64, anchor: TextAnchor) {
        self.list.push(DrawnPrimitive::Text {
            at,
            text: text.to_owned(),
            size,
            anchor,
            colour: self.theme.text,
        });
    }

    fn area(&mut self, [left, top]: [f64; 2], [width, height]: [f64; 2], fill: Colour) {
        let rect = Rect {
            left,
            top,
            right: left + width,
            bottom: top + height,
        };
        self.list.push(DrawnPrimitive::Area { rect, fill });
    }

    fn legend(&mut self, chart: &MatrixChart, [left, top]: [f64; 2], ruler: &Ruler) {
        let sizes = self.sizes;
        let patch = PATCH * sizes.text;
        let mut left = left;
        for (fill, text) in &chart.legend {
            self.area([left, top], [patch; 2], *fill);
            let at = [
                left + patch + 0.5 * sizes.text,
                top + 0.5 * (patch + sizes.text),
            ];
            self.text(at, text, sizes.text, TextAnchor::Start);
            left += entry_width(text, &sizes, ruler);
        }
    }

    /// Names, numbers of the columns, and the cells from `corner` (left, top) on.
    fn cells(&mut self, chart: &MatrixChart, [left, top]: [f64; 2]) {
        let sizes = self.sizes;
        let (side, size) = (cell_edge(chart) * sizes.text, name_size(chart, &sizes));
        let baseline = |row: usize| top + (row as f64 + 0.5) * side + 0.5 * size;
        for row in 0..chart.names.len() {
            let at = [left - sizes.gap, baseline(row)];
            self.text(at, &row_name(chart, row), size, TextAnchor::End);
            // A column's number stands on the diagonal, above its cells.
            let at = [left + (row as f64 + 0.5) * side, baseline(row)];
            self.text(at, &(row + 1).to_string(), size, TextAnchor::Middle);
        }
        let is_readable = cell_edge(chart) >= READABLE;
        for cell in &chart.cells {
            let [row, column] = cell.place;
            let at = [left + column as f64 * side, top + row as f64 * side];
            self.area(
                at.map(|v| v + 0.5 * GAP * side),
                [(1.0 - GAP) * side; 2],
                cell.fill,
            );
            if is_readable && !cell.text.is_empty() {
                let middle = [at[0] + 0.5 * side, baseline(row)];
                self.text(middle, &cell.text, sizes.small, TextAnchor::Middle);
            }
        }
    }
}
