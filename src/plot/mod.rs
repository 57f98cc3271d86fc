//! Charts: from values to SVG, PDF or pixels. Independent of mechanisms, files and 3-D pictures.
//!
//! A [`Chart`] describes the content; [`draw_chart`] turns it into a [`Drawing`], a list of lines, areas and texts with
//! positions in pixels; [`svg`], [`pdf`] and [`raster`] write that list.

mod area;
pub mod bars;
pub mod chart;
pub mod colour_bar;
pub mod companion;
mod coverage;
mod curves;
pub mod drawing;
mod frame;
mod headings;
pub mod layout;
pub mod matrix;
pub mod pdf;
mod pdf_text;
pub mod playhead;
pub mod primitive;
pub mod raster;
pub mod scale;
pub mod svg;
pub mod theme;
pub mod ticks;

pub use chart::{
    Axis, Chart, ChartBand, EventMark, MapTile, Panel, PlotSeries, PointWord, SeriesStyle, Shade,
};
pub use drawing::{Drawing, draw_chart};
pub use layout::usual_size;
pub use scale::ScaleKind;
pub use theme::ChartTheme;
