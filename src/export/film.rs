//! Writes frames to a picture file of any format: opens the sink that the format needs, and passes all frames through
//! it.

use super::apng::{ApngSettings, ApngSink};
use super::colour_histogram::Histogram;
use super::error::{ExportError, PipelineError};
use super::format::FramePattern;
use super::frame_pipeline::write_frames;
use super::gif::{GifSettings, GifSink, Quality, sample_indices};
use super::palette::{MOST_COLOURS, Palette};
use super::png::{Effort, PngSettings, SequenceSink, StillSink};
use super::png_strips::StripSink;
use super::raw::{Chroma, RawKind, RawSink};
use super::sampled_frames::{DrawnSamples, draw_samples, look_at};
use super::timing::{FrameTimes, Schedule};
use super::video::{VideoFile, VideoSink};
use super::{ExportSummary, Format, FrameSink, Output, PendingFile};
use image::RgbaImage;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, PoisonError};

/// The destination; opened before anything is drawn, so that a bad path is reported at once.
pub enum Destination {
    /// One file.
    File(Box<dyn Output>),
    /// One file per frame.
    Sequence(FramePattern),
    /// A video that an encoder writes.
    Video(VideoFile),
}

impl Destination {
    /// A file or a sequence of files at `path`.
    ///
    /// Errors: a folder that does not exist or cannot be written to.
    pub fn at(path: &Path, format: &Format) -> Result<Self, ExportError> {
        Ok(match format {
            Format::PngSequence(pattern) => Self::Sequence(pattern.clone()),
            Format::Video(kind) => Self::Video(VideoFile::create(path, *kind)?),
            _ => Self::File(Box::new(PendingFile::create(path)?)),
        })
    }
}

/// The frames to be written, and how.
#[derive(Clone, Debug)]
pub struct FilmSettings<'a> {
    /// The format.
    pub format: &'a Format,
    /// Size of every frame in pixels.
    pub size: [u32; 2],
    /// Number of frames.
    pub count: usize,
    /// Frames a second.
    pub fps: f64,
    /// Colours that a palette must hold exactly.
    pub needed_colours: Vec<[u8; 3]>,
    /// Frames are cheap to draw twice: a palette is made from all of them.
    pub at_hand: bool,
    /// Whether frames may be translucent.
    pub alpha: bool,
    /// Trade-off between a GIF's fidelity and its size.
    pub quality: Quality,
    /// Compression of PNG and APNG; `None` is balanced, and fast for sequences.
    pub effort: Option<Effort>,
    /// Pixels of an inch on paper, in PNGs.
    pub dpi: Option<f64>,
    /// Texts in PNGs, each with its keyword.
    pub texts: Vec<(String, String)>,
    /// Rows of the strips of a PNG whose frames are the strips of one picture.
    pub strip_rows: Option<u32>,
    /// Colour of a y4m video.
    pub chroma: Chroma,
    /// Whether a GIF or APNG repeats forever; otherwise it plays once.
    pub repeat: bool,
}

/// An open sink, and the frames drawn already for its palette.
pub struct Prepared {
    sink: Box<dyn FrameSink>,
    samples: DrawnSamples,
    /// Number of frames that a GIF omits, because it cannot show them as fast as requested.
    pub left_out: usize,
}

impl Prepared {
    fn plain(sink: Box<dyn FrameSink>) -> Self {
        Self {
            sink,
            samples: Vec::new(),
            left_out: 0,
        }
    }
}

impl<'a> FilmSettings<'a> {
    /// Opaque frames that are drawn once each, with the usual encoding.
    pub fn new(format: &'a Format, size: [u32; 2], count: usize, fps: f64) -> Self {
        Self {
            format,
            size,
            count,
            fps,
            needed_colours: Vec::new(),
            at_hand: false,
            alpha: false,
            quality: Quality::USUAL,
            effort: None,
            dpi: None,
            texts: Vec::new(),
            strip_rows: None,
            chroma: Chroma::Full,
            repeat: true,
        }
    }
}

impl FilmSettings<'_> {
    /// Opens the sink; for a GIF some frames are drawn to find the palette.
    ///
    /// Errors: a format without pixels, a failed write, a worker's own error, the cancel flag.
    pub fn open<W, E>(
        &self,
        destination: Destination,
        workers: &mut [W],
        cancel: &AtomicBool,
    ) -> Result<Prepared, PipelineError<E>>
    where
        W: FnMut(usize, &mut RgbaImage) -> Result<(), E> + Send,
        E: std::error::Error + Send + 'static,
    {
        // Numbered pictures and videos are written by sinks of their own; ...
        let file = match destination {
            Destination::File(file) => file,
            Destination::Sequence(pattern) => {
                let sink = SequenceSink::new(pattern, self.png(Effort::Fast))?;
                return Ok(Prepared::plain(Box::new(sink)));
            }
            Destination::Video(file) => {
                let sink = VideoSink::new(file, self.fps, self.size)?;
                return Ok(Prepared::plain(Box::new(sink)));
            }
        };
        let (size, fps, chroma) = (self.size, self.fps, self.chroma);
        // ... all others are one file, in a format with pixels.
        let sink: Box<dyn FrameSink> = match self.format {
            Format::Gif => return self.gif(file, workers, cancel),
            Format::Apng => Box::new(ApngSink::new(file, self.apng())?),
            Format::Png | Format::PngSequence(_) => {
                let png = self.png(Effort::Balanced);
                match self.strip_rows {
                    Some(rows) => Box::new(StripSink::new(file, png, rows)?),
                    None => Box::new(StillSink::new(file, png)?),
                }
            }
            Format::Y4m => Box::new(RawSink::new(file, RawKind::Y4m { fps, chroma }, size)?),
            Format::Rgba => Box::new(RawSink::new(file, RawKind::Rgba { fps }, size)?),
            Format::Glb | Format::Stl | Format::Obj | Format::Video(_) => {
                return Err(PipelineError::Export(ExportError::NoPixels {
                    format: self.format.name(),
                }));
            }
        };
        Ok(Prepared::plain(sink))
    }

    /// Draws and writes all frames; `show` receives the number of finished frames and their total.
    ///
    /// Errors: a failed write, a worker's own error, the cancel flag; no file is left then.
    pub fn write<W, E>(
        &self,
        prepared: Prepared,
        workers: Vec<W>,
        show: &dyn Fn(usize, usize),
        cancel: &AtomicBool,
    ) -> Result<ExportSummary, PipelineError<E>>
    where
        W: FnMut(usize, &mut RgbaImage) -> Result<(), E> + Send,
        E: std::error::Error + Send + 'static,
    {
        let Prepared { sink, samples, .. } = prepared;
        write_frames(workers, self.count, samples, sink, show, cancel)
    }

    fn gif<W, E>(
        &self,
        file: Box<dyn Output>,
        workers: &mut [W],
        cancel: &AtomicBool,
    ) -> Result<Prepared, PipelineError<E>>
    where
        W: FnMut(usize, &mut RgbaImage) -> Result<(), E> + Send,
        E: std::error::Error + Send + 'static,
    {
        let (palette, samples) = self.palette(workers, cancel)?;
        let schedule = Schedule::new(self.times(), 0.0)?;
        let left_out = schedule.left_out();
        let settings = GifSettings {
            size: self.size,
            schedule,
            repeat: self.repeat,
            quality: self.quality,
        };
        let sink = GifSink::new(file, settings, Arc::new(palette))?;
        Ok(Prepared {
            sink: Box::new(sink),
            samples,
            left_out,
        })
    }

    /// The palette of the whole film, and the frames already drawn to find it.
    fn palette<W, E>(
        &self,
        workers: &mut [W],
        cancel: &AtomicBool,
    ) -> Result<(Palette, DrawnSamples), PipelineError<E>>
    where
        W: FnMut(usize, &mut RgbaImage) -> Result<(), E> + Send,
        E: std::error::Error + Send + 'static,
    {
        let indices = sample_indices(self.count);
        if !self.at_hand || indices.len() == self.count {
            let samples = draw_samples(workers, &indices, self.size, cancel)?;
            let drawn = samples.iter().map(|(_, image)| image);
            let palette = Palette::from_samples(drawn, &self.needed_colours, MOST_COLOURS);
            return Ok((palette, samples));
        }
        // Counts are whole numbers: their sums do not depend on the order.
        let histogram = Mutex::new(Histogram::new(MOST_COLOURS));
        let count = |_: usize, image: &mut RgbaImage| {
            let mut histogram = histogram.lock().unwrap_or_else(PoisonError::into_inner);
            histogram.add(image);
        };
        let all: Vec<usize> = (0..self.count).collect();
        look_at(workers, &all, self.size, cancel, &count)?;
        let histogram = histogram.into_inner();
        let histogram = histogram.unwrap_or_else(PoisonError::into_inner);
        let palette = Palette::from_histogram(histogram, &self.needed_colours, MOST_COLOURS);
        Ok((palette, DrawnSamples::new()))
    }

    fn times(&self) -> FrameTimes {
        FrameTimes::Uniform {
            fps: self.fps,
            count: self.count,
        }
    }

    fn apng(&self) -> ApngSettings {
        ApngSettings {
            size: self.size,
            times: self.times(),
            repeat: self.repeat,
            effort: self.effort.unwrap_or(Effort::Balanced),
            alpha: self.alpha,
        }
    }

    fn png(&self, usual: Effort) -> PngSettings {
        PngSettings {
            size: self.size,
            effort: self.effort.unwrap_or(usual),
            alpha: self.alpha,
            dpi: self.dpi,
            texts: self.texts.clone(),
        }
    }
}
