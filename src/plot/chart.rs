//! The content of a chart: panels, series, marks. All numbers are in the units of the axes; pixels are unknown here.

use super::scale::ScaleKind;
use super::theme::Colour;

/// One or several panels under a title.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Chart {
    /// Title of the whole.
    pub title: String,
    /// One sentence for readers who do not see the picture.
    pub description: String,
    /// The panels, in reading order.
    pub panels: Vec<Panel>,
    /// Lines under the panels: further information for the reader.
    pub notes: Vec<String>,
}

/// One pair of axes and what is drawn in it.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Panel {
    /// Title of the panel; empty for none.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// Coloured rectangles of a map, behind everything else.
    pub tiles: Vec<MapTile>,
    /// Areas between two curves, behind all but tiles.
    pub bands: Vec<ChartBand>,
    /// Faint lines without a name, many of which make a cloud.
    pub cloud: Vec<Vec<[f64; 2]>>,
    /// The curves.
    pub series: Vec<PlotSeries>,
    /// Positions on the horizontal axis with a word.
    pub events: Vec<EventMark>,
    /// Ranges of the horizontal axis without values.
    pub shades: Vec<Shade>,
    /// Reference points.
    pub marks: Vec<[f64; 2]>,
    /// Reference lines, from point to point.
    pub lines: Vec<[[f64; 2]; 2]>,
    /// Words beside points.
    pub words: Vec<PointWord>,
    /// Whether both axes have the same scale.
    pub equal: bool,
    /// Position of every sample on the horizontal axis, with or without a point: for the playhead.
    pub samples: Vec<f64>,
}

/// An axis.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Axis {
    /// What it measures.
    pub label: String,
    /// Unit; empty for plain numbers.
    pub unit: String,
    /// Linear or logarithmic.
    pub scale: ScaleKind,
    /// Whether the axis ends where the values end, without a margin.
    pub tight: bool,
}

/// How the points of a series are joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum SeriesStyle {
    /// By a line.
    #[default]
    Line,
    /// By a line with a dot at every point.
    Dots,
    /// By a dashed line: the earlier state.
    Dashed,
}

/// A curve.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct PlotSeries {
    /// Name in the legend.
    pub name: String,
    /// Points in order; `None` interrupts the line.
    pub points: Vec<Option<[f64; 2]>>,
    /// Indices of points that are not joined to the previous one: an angle has jumped by a turn there.
    pub breaks: Vec<usize>,
    /// Joined how.
    pub style: SeriesStyle,
}

/// A word beside a point.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct PointWord {
    /// The point.
    pub at: [f64; 2],
    /// The word.
    pub text: String,
}

/// The area between two curves.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct ChartBand {
    /// From left to right.
    pub lower: Vec<[f64; 2]>,
    /// From left to right.
    pub upper: Vec<[f64; 2]>,
}

/// A rectangle of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapTile {
    /// The corner with the smaller numbers.
    pub from: [f64; 2],
    /// The corner with the larger ones.
    pub to: [f64; 2],
    /// Colour.
    pub fill: Colour,
}

/// A place on the horizontal axis.
#[derive(Clone, Debug, PartialEq)]
pub struct EventMark {
    /// Where.
    pub x: f64,
    /// What happens there.
    pub label: String,
}

/// A range of the horizontal axis without values.
#[derive(Clone, Debug, PartialEq)]
pub struct Shade {
    /// Begin.
    pub from: f64,
    /// End.
    pub to: f64,
    /// Why.
    pub word: String,
}

impl Axis {
    /// Label with its unit in brackets; `factor` is a power of ten taken out of the tick labels.
    pub fn heading(&self, factor: i32) -> String {
        let unit = match (factor, self.unit.as_str()) {
            (0, "") => String::new(),
            (0, unit) => format!(" [{unit}]"),
            (k, "") => format!(" [{}]", super::ticks::power_of_ten(k)),
            (k, unit) => format!(" [{} {unit}]", super::ticks::power_of_ten(k)),
        };
        format!("{}{unit}", self.label).trim().to_owned()
    }
}

impl Chart {
    /// Whether there is nothing to see but axes.
    pub fn is_bare(&self) -> bool {
        self.panels
            .iter()
            .all(|panel| panel.points().next().is_none())
    }
}

impl PlotSeries {
    /// Whether no point of it has a place.
    pub fn is_empty(&self) -> bool {
        let is_placed = |p: &[f64; 2]| p.iter().all(|v| v.is_finite());
        !self.points.iter().flatten().any(is_placed)
    }
}

impl Panel {
    /// All finite points of series, bands, clouds, tiles, marks and lines.
    pub fn points(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        let series = self.series.iter().flat_map(|s| s.points.iter().flatten());
        let lines = self.lines.iter().flatten();
        let bands = self
            .bands
            .iter()
            .flat_map(|b| b.lower.iter().chain(&b.upper));
        let spread = bands.chain(self.cloud.iter().flatten());
        let tiles = self.tiles.iter().flat_map(|tile| [&tile.from, &tile.to]);
        let all = series
            .chain(&self.marks)
            .chain(lines)
            .chain(spread)
            .chain(tiles)
            .copied();
        all.filter(|p| p[0].is_finite() && p[1].is_finite())
    }
}
