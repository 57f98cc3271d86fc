//! One PNG from strips of rows that arrive one after another: a poster is never in memory as a whole.

use super::error::ExportError;
use super::png::{Effort, PngSettings, check_size, drop_alpha, encoder_of, encoding_error};
use super::spool::Spool;
use super::target::Output;
use super::{ExportSummary, FrameCoder, FrameSink};
use ::png::{Filter, StreamWriter};
use image::RgbaImage;
use std::io::Write;

/// Bytes of pixel data in each chunk of the file.
const CHUNK: usize = 1 << 16;

/// A PNG whose frames are the strips of one picture, from the top down. All have the same number of rows; those of the
/// last one that are below the picture are left out.
pub struct StripSink {
    output: Box<dyn Output>,
    /// Output of the encoder that has not been written yet.
    spool: Spool,
    stream: StreamWriter<'static, Spool>,
    settings: PngSettings,
    rows: u32,
    /// Bytes of pixels that are still to come.
    left: usize,
    bytes: u64,
}

impl StripSink {
    /// A sink of strips of `rows` rows.
    ///
    /// Errors: a side of 0 or too long, a failed write.
    pub fn new(
        output: Box<dyn Output>,
        settings: PngSettings,
        rows: u32,
    ) -> Result<Self, ExportError> {
        check_size(settings.size)?;
        let spool = Spool::default();
        let encoder = encoder_of(spool.clone(), &settings, filter_of(settings.effort))?;
        let stream = encoder
            .write_header()
            .and_then(|writer| writer.into_stream_writer_with_size(CHUNK));
        let [width, height] = settings.size.map(|side| side as usize);
        let mut sink = Self {
            output,
            spool,
            stream: stream.map_err(encoding_error)?,
            rows: rows.max(1),
            left: width * height * bytes_of_pixel(&settings),
            settings,
            bytes: 0,
        };
        sink.drain_output()?;
        Ok(sink)
    }

    /// Passes the encoder's output on.
    fn drain_output(&mut self) -> Result<(), ExportError> {
        let bytes = self.spool.take();
        self.output.emit(&bytes)?;
        self.bytes += bytes.len() as u64;
        self.spool.give_back(bytes);
        Ok(())
    }
}

/// The best filter cannot be found by trying, as for pictures in memory. Large drawn pictures are flat: they take less
/// without a filter, except with the fastest compression, which packs nothing but runs of zeros.
fn filter_of(effort: Effort) -> Filter {
    match effort {
        Effort::Fast => Filter::Adaptive,
        Effort::Balanced | Effort::Small => Filter::NoFilter,
    }
}

fn bytes_of_pixel(settings: &PngSettings) -> usize {
    if settings.alpha { 4 } else { 3 }
}

impl FrameSink for StripSink {
    fn size(&self) -> [u32; 2] {
        [self.settings.size[0], self.rows]
    }

    fn coder(&self) -> Box<dyn FrameCoder> {
        Box::new(StripCoder {
            size: self.size(),
            alpha: self.settings.alpha,
        })
    }

    fn write(&mut self, _index: usize, coded: &[u8]) -> Result<(), ExportError> {
        let own = &coded[..coded.len().min(self.left)];
        self.left -= own.len();
        // The encoder writes into memory, where nothing fails but the order of its calls.
        let written = self.stream.write_all(own);
        written.map_err(|error| encoding_error(error.into()))?;
        self.drain_output()
    }

    fn finish(self: Box<Self>) -> Result<ExportSummary, ExportError> {
        let Self {
            mut output,
            spool,
            stream,
            mut bytes,
            ..
        } = *self;
        // Rows that are missing are an error.
        stream.finish().map_err(encoding_error)?;
        let end = spool.take();
        output.emit(&end)?;
        bytes += end.len() as u64;
        output.commit()?;
        Ok(ExportSummary {
            frames: 1,
            bytes,
            seconds: 0.0,
        })
    }
}

/// Pixels of a strip as they are stored.
struct StripCoder {
    size: [u32; 2],
    alpha: bool,
}

impl FrameCoder for StripCoder {
    fn code(&mut self, frame: &RgbaImage, coded: &mut Vec<u8>) -> Result<(), ExportError> {
        super::check_frame(frame, self.size)?;
        coded.clear();
        match self.alpha {
            true => coded.extend_from_slice(frame.as_raw()),
            false => drop_alpha(frame.as_raw(), coded),
        }
        Ok(())
    }
}
