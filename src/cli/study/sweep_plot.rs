//! The file of `mechanim sweep --plot`.

use crate::charts::sweep::SweepPlot;
use crate::cli::args::sweep::RowsArgs;
use crate::cli::files::chart::{PlotFormat, write_drawing};
use crate::cli::io;
use crate::cli::term::outcome::Failure;
use crate::diag::name_hint;
use crate::export::Output;
use crate::model::theme::Theme;
use crate::plot::{ChartTheme, draw_chart, usual_size};
use crate::sweep::row::Row;
use crate::sweep::swept_scene::{RequestedValues, Sweep};

/// Height of a map; its cells have the shape that its axes give them.
const MAP_HEIGHT: u32 = 600;

/// A file that is to hold the chart of a sweep.
pub struct SweepChartFile<'s> {
    plot: SweepPlot<'s>,
    format: PlotFormat,
    theme: ChartTheme,
    output: Box<dyn Output>,
}

impl<'s> SweepChartFile<'s> {
    /// Opens the file, if one is requested, before anything is computed.
    pub fn open(sweep: &'s Sweep, rows: &RowsArgs) -> Result<Option<Self>, Failure> {
        let Some(path) = &rows.plot else {
            return Ok(None);
        };
        let format = PlotFormat::of(path)?;
        let value = drawn_value(sweep, rows.only.as_deref())?;
        let plot = SweepPlot::new(sweep, value).ok_or_else(|| {
            let message = "--plot needs one or two parameters that vary, and the design varies another number of them";
            Failure::usage(message, Vec::new())
        })?;
        Ok(Some(Self {
            plot,
            format,
            theme: match rows.theme {
                Theme::Light => ChartTheme::LIGHT,
                Theme::Dark => ChartTheme::DARK,
            },
            output: io::open_output(path)?,
        }))
    }

    /// Adds the row of design `item`.
    pub fn add(&mut self, item: u64, row: &Row) {
        self.plot.add(item, row);
    }

    /// Draws.
    pub fn write(mut self) -> Result<(), Failure> {
        let (chart, bar) = self.plot.chart();
        let mut size = usual_size(&chart);
        if bar.is_some() {
            size[1] = MAP_HEIGHT;
        }
        let drawing = draw_chart(&chart, size, self.theme);
        let drawing = match bar {
            Some(bar) => bar.beside(drawing),
            None => drawing,
        };
        write_drawing(&drawing, self.format, self.output.as_mut())?;
        Ok(self.output.commit()?)
    }
}

/// The value of a row that is drawn.
fn drawn_value(sweep: &Sweep, only: Option<&str>) -> Result<usize, Failure> {
    let names = || sweep.columns.iter().map(|(name, _)| name.as_str());
    match only {
        Some(name) => names().position(|known| known == name).ok_or_else(|| {
            let message = format!("rows contain no value `{name}`");
            Failure::usage(message, vec![name_hint(name, names())])
        }),
        // For a check, the clearance says more than whether it passed.
        None if sweep.asked == RequestedValues::Check => Ok(1),
        None if matches!(sweep.asked, RequestedValues::Measures { .. }) => {
            Ok(sweep.family().study.objective.unwrap_or(0))
        }
        None => Ok(0),
    }
}
