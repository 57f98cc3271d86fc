//! The file of `mechanim sensitivity --plot`.

use crate::charts;
use crate::cli::args::scene::SceneArgs;
use crate::cli::files::chart;
use crate::cli::files::chart::PlotFormat;
use crate::cli::io;
use crate::cli::term::outcome::Failure;
use crate::export::Output;
use crate::plot::ChartTheme;
use crate::plot::bars::{draw_bars, usual_size};
use crate::report::sensitivity::SensitivityTable;
use std::path::Path;

/// A file for the bar chart.
pub struct BarChartFile {
    format: PlotFormat,
    output: Box<dyn Output>,
}

/// Opens the file before anything is computed.
pub fn open_bars(scene: &SceneArgs, path: &Path) -> Result<BarChartFile, Failure> {
    io::refuse_input(scene, path)?;
    Ok(BarChartFile {
        format: PlotFormat::of(path)?,
        output: io::open_output(path)?,
    })
}

impl BarChartFile {
    /// Draws the table; measure `rank` determines the order and comes first.
    pub fn write(mut self, table: &SensitivityTable, rank: usize) -> Result<(), Failure> {
        let chart = charts::sensitivity::sensitivity_chart(table, rank);
        let drawing = draw_bars(&chart, usual_size(&chart), ChartTheme::LIGHT);
        chart::write_drawing(&drawing, self.format, self.output.as_mut())?;
        self.output.commit()?;
        Ok(())
    }
}
