//! Sizes of texts and gaps, the measuring of texts, and the cells of panels.

use super::chart::Chart;
use super::primitive::Rect;
use crate::render::text::{FontFace, set_text};

/// Width of a chart whose texts have their ordinary size, in pixels.
const USUAL_WIDTH: f64 = 800.0;

/// Height of a row of panels at that width; of one whose axes are equally scaled.
const ROW_HEIGHT: f64 = 250.0;
const EQUAL_ROW_HEIGHT: f64 = 470.0;

/// Smallest and largest scale of texts; below the smallest they are unreadable.
const SMALLEST: f64 = 0.8;
const LARGEST: f64 = 12.0;

/// Width and height, relative to the usual ones, below which texts shrink with the shorter side.
const LEAST_SHARE: [f64; 2] = [0.6, 0.8];

/// Panels from which on the usual size has two columns.
const TWO_COLUMNS_FROM: usize = 4;

/// Most columns of panels.
const MOST_COLUMNS: usize = 4;

/// Width of a panel that looks best with these heights.
const BEST_WIDTH: f64 = 550.0;

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
        let [width, height] = size.map(f64::from);
        // The width counts twice: it is what numbers and legends compete for.
        let (wide, high) = (width / usual[0], height / usual[1]);
        let s = libm::cbrt(wide * wide * high)
            .min(wide / LEAST_SHARE[0])
            .min(high / LEAST_SHARE[1])
            .clamp(SMALLEST, LARGEST);
        Self::scaled(s)
    }

    /// The usual lengths times `s`.
    pub fn scaled(s: f64) -> Self {
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
    let columns = if chart.panels.len() >= TWO_COLUMNS_FROM {
        2
    } else {
        1
    };
    let rows: f64 = row_heights(chart, columns).iter().sum();
    let notes = 20.0 * chart.notes.len() as f64;
    [
        USUAL_WIDTH as u32,
        (40.0 + rows.max(ROW_HEIGHT) + notes) as u32,
    ]
}

/// Usual heights of the rows of panels; a row is as high as its highest panel.
fn row_heights(chart: &Chart, columns: usize) -> Vec<f64> {
    let rows = chart.panels.chunks(columns);
    rows.map(|row| {
        if row.iter().any(|p| p.equal) {
            EQUAL_ROW_HEIGHT
        } else {
            ROW_HEIGHT
        }
    })
    .collect()
}

/// Number of columns that gives the panels of a picture of this size the best proportions.
fn column_count(chart: &Chart, [width, height]: [f64; 2]) -> usize {
    let fault = |columns: usize| {
        let high: f64 = row_heights(chart, columns).iter().sum();
        let best = columns as f64 * BEST_WIDTH / high.max(ROW_HEIGHT);
        libm::log(width / height / best).abs()
    };
    let all = 1..=chart.panels.len().clamp(1, MOST_COLUMNS);
    all.min_by(|a, b| fault(*a).total_cmp(&fault(*b)))
        .unwrap_or(1)
}

/// Measures texts in the face they are drawn in.
#[derive(Default)]
pub struct Ruler {
    face: FontFace,
}

impl Ruler {
    /// Width in pixels of a line whose capitals are `size` pixels high.
    pub fn width(&self, text: &str, size: f64) -> f64 {
        set_text(&self.face, text, size).width
    }
}

/// The layout of everything outside the panels.
#[derive(Clone, Debug, PartialEq)]
pub struct ChartLayout {
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

impl ChartLayout {
    /// Divides a picture.
    pub fn new(chart: &Chart, size: [u32; 2], sizes: &Sizes) -> Self {
        let [width, height] = size.map(f64::from);
        // What stands above and below the panels: title and notes.
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
        // As many columns as give the panels the best proportions.
        let columns = column_count(chart, [width, bottom - top]);
        let wide = (width - 2.0 * border - 2.0 * sizes.gap * (columns - 1) as f64) / columns as f64;
        let heights = row_heights(chart, columns);
        // Rows share the height in the ratio of their usual heights.
        let share = (bottom - top) / heights.iter().sum::<f64>();
        let mut edge = top;
        let mut cells = Vec::with_capacity(chart.panels.len());
        for (row, height) in chart.panels.chunks(columns).zip(&heights) {
            for column in 0..row.len() {
                let left = border + column as f64 * (wide + 2.0 * sizes.gap);
                cells.push(Rect {
                    left,
                    top: edge,
                    right: left + wide,
                    bottom: edge + height * share,
                });
            }
            edge += height * share;
        }
        Self {
            cells,
            columns,
            title,
            notes,
            left: border,
        }
    }
}
