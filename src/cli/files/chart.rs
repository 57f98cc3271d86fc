//! Charts as files: shapes or pixels.

use crate::cli::term::outcome::Failure;
use crate::export::Output;
use crate::export::png::{Effort, encode_png};
use crate::limits::allow_picture;
use crate::model::theme::Theme;
use crate::plot::raster::ChartPainter;
use crate::plot::{Chart, ChartTheme, Drawing, draw_chart, pdf, svg};
use std::path::Path;

/// Memory that a plot needs per pixel: colours, and the file. Measured, with a margin.
const BYTES_OF_PLOT_PIXEL: f64 = 8.0;

/// Content of a chart's file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlotFormat {
    /// SVG: shapes with text.
    Svg,
    /// PDF: shapes on a page.
    Pdf,
    /// Pixels.
    Png,
}

impl PlotFormat {
    /// By extension; standard output is SVG.
    pub fn of(path: &Path) -> Result<Self, Failure> {
        if path == Path::new("-") {
            return Ok(Self::Svg);
        }
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            Some("svg") => Ok(Self::Svg),
            Some("pdf") => Ok(Self::Pdf),
            Some("png") => Ok(Self::Png),
            _ => Err(Failure::unknown_kind(
                path,
                "plot",
                "known kinds: .svg, .pdf and .png",
            )),
        }
    }
}

/// Draws a chart and writes it.
pub fn write_chart(
    chart: &Chart,
    format: PlotFormat,
    size: Option<[u32; 2]>,
    theme: Theme,
    output: &mut dyn Output,
) -> Result<(), Failure> {
    let size = size.unwrap_or_else(|| crate::plot::usual_size(chart));
    write_drawing(&draw_chart(chart, size, chart_theme(theme)), format, output)
}

/// Colours of a drawing.
pub fn chart_theme(theme: Theme) -> ChartTheme {
    match theme {
        Theme::Light => ChartTheme::LIGHT,
        Theme::Dark => ChartTheme::DARK,
    }
}

/// Writes what has been laid out.
pub fn write_drawing(
    drawing: &Drawing,
    format: PlotFormat,
    output: &mut dyn Output,
) -> Result<(), Failure> {
    let bytes = match format {
        PlotFormat::Svg => svg::write_svg(drawing).into_bytes(),
        PlotFormat::Pdf => pdf::write_pdf(drawing),
        PlotFormat::Png => {
            allow_picture(drawing.size, BYTES_OF_PLOT_PIXEL, "a plot")?;
            let mut bytes = Vec::new();
            encode_png(
                &ChartPainter::default().picture(drawing),
                Effort::Balanced,
                &mut bytes,
            )?;
            bytes
        }
    };
    output.emit(&bytes)?;
    Ok(())
}
