//! Sizes of texts and gaps, the measuring of texts, and the cells in which panels stand.

use super::chart::Chart;
use super::primitive::Rect;
use crate::render::text::{Face, set_text};

/// Width of a chart whose texts have their ordinary size, in pixels.
const USUAL_WIDTH: f64 = 800.0;

/// Height of a row of panels at that width; of one whose axes are equally scaled.
const ROW_HEIGHT: f64 = 250.0;
const EQUAL_ROW_HEIGHT: f64 = 470.0;

/// Smallest and largest scale of texts: below no letter can be read.
const SMALLEST: f64 = 0.8;
const LARGEST: f64 = 12.0;

/// Panels from which on two columns are used.
const TWO_COLUMNS_FROM: usize = 4;

/// Lengths in pixels that grow with the picture. Texts are measured by the height of their capitals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sizes {
    /// Numbers, labels, legend.
    pub text: f64,
    /// Words of events, notes.
    pub small: f64,
    /// Titles of panels.
    pub heading: f64,
    /// Title of the chart.
    pub title: f64,
    /// Between things that belong together.
    pub gap: f64,
    /// Tick marks.
    pub tick: f64,
    /// Curves.
    pub curve: f64,
    /// Axes and grid.
    pub hair: f64,
}

impl Sizes {
    /// For a chart of the given pixels.
    pub fn new(chart: &Chart, size: [u32; 2]) -> Self {
        let usual = usual_size(chart).map(f64::from);
        let scale = (f64::from(size[0]) / usual[0]).min(f64::from(size[1]) / usual[1]);
        let s = scale.clamp(SMALLEST, LARGEST);
        Self {
            text: 8.4 * s,
            small: 7.6 * s,
            heading: 8.8 * s,
            title: 10.5 * s,
            gap: 6.0 * s,
            tick: 4.0 * s,
            curve: 1.8 * s,
            hair: s.max(1.0),
        }
    }

    /// From one line of text to the next.
    pub fn line(&self, text: f64) -> f64 {
        text + 1.5 * self.gap
    }
}

/// The size in pixels that suits a chart.
pub fn usual_size(chart: &Chart) -> [u32; 2] {
    let columns = columns(chart, USUAL_WIDTH / ROW_HEIGHT);
    let rows = chart.panels.len().div_ceil(columns).max(1);
    let equal = chart.panels.iter().any(|p| p.equal);
    let row = if equal { EQUAL_ROW_HEIGHT } else { ROW_HEIGHT };
    let notes = 20.0 * chart.notes.len() as f64;
    [
        USUAL_WIDTH as u32,
        (40.0 + row * rows as f64 + notes) as u32,
    ]
}

/// Columns of panels in a picture `aspect` times as wide as high.
fn columns(chart: &Chart, aspect: f64) -> usize {
    if chart.panels.len() >= TWO_COLUMNS_FROM && aspect > 0.8 {
        2
    } else {
        1
    }
}

/// Measures texts in the face they are drawn in.
#[derive(Default)]
pub struct Ruler {
    face: Face,
}

impl Ruler {
    /// Width in pixels of a line whose capitals are `size` pixels high.
    pub fn width(&self, text: &str, size: f64) -> f64 {
        set_text(&self.face, text, size).width
    }
}

/// Where everything outside the panels stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// One cell per panel; columns share their edges.
    pub cells: Vec<Rect>,
    /// Column of each cell.
    pub columns: usize,
    /// Baseline of the title.
    pub title: f64,
    /// Baselines of the notes.
    pub notes: Vec<f64>,
    /// Left edge of titles and notes.
    pub left: f64,
}

impl Layout {
    /// Divides a picture.
    pub fn new(chart: &Chart, size: [u32; 2], sizes: &Sizes) -> Self {
        let [width, height] = size.map(f64::from);
        let border = 2.0 * sizes.gap;
        let mut top = border;
        let title = top + sizes.title;
        if !chart.title.is_empty() {
            top += sizes.title + 1.5 * sizes.gap;
        }
        let line = sizes.line(sizes.small);
        let below = line * chart.notes.len() as f64;
        let bottom = height - border - below;
        let notes = (0..chart.notes.len())
            .map(|k| bottom + line * k as f64 + 0.5 * border + sizes.small)
            .collect();
        let columns = columns(chart, width / height);
        let rows = chart.panels.len().div_ceil(columns).max(1);
        let (wide, high) = (
            (width - 2.0 * border - 2.0 * sizes.gap * (columns - 1) as f64) / columns as f64,
            (bottom - top) / rows as f64,
        );
        let cells = (0..chart.panels.len())
            .map(|k| {
                let left = border + (k % columns) as f64 * (wide + 2.0 * sizes.gap);
                let top = top + (k / columns) as f64 * high;
                Rect {
                    left,
                    top,
                    right: left + wide,
                    bottom: top + high,
                }
            })
            .collect();
        Self {
            cells,
            columns,
            title,
            notes,
            left: border,
        }
    }
}
