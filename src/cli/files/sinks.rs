//! From frames to a picture file: which format, whether it can hold what is asked, and the sink that writes it.

use crate::cli::args::files::{ChromaArg, Compression, FileArgs, PictureFormat, Repeat};
use crate::cli::interrupt::CANCEL;
use crate::cli::term::Term;
use crate::cli::term::outcome::Failure;
use crate::cli::term::progress::Progress;
use crate::export::apng::{ApngSettings, ApngSink};
use crate::export::format::FramePattern;
use crate::export::gif::{GifSettings, GifSink, Quality, sample_indices};
use crate::export::palette::Palette;
use crate::export::png::{Effort, PngSettings, SequenceSink, StillSink};
use crate::export::pump::{PumpError, Samples, draw_samples, pump};
use crate::export::raw::{Chroma, RawKind, RawSink};
use crate::export::timing::{FrameTimes, Schedule};
use crate::export::{ExportSummary, Format, FrameSink, Output, Stream, Target};
use image::RgbaImage;
use std::path::Path;
use std::sync::Arc;

/// One of the 256 entries of a GIF's palette stands for "unchanged".
const PALETTE_COLOURS: usize = 255;

/// The format that the options and the file name ask for.
///
/// Errors: an unknown extension; an option that this format has no use for.
pub fn format(args: &FileArgs) -> Result<Format, Failure> {
    let format = match args.format {
        Some(format) => named(format, &args.out)?,
        None if to_stdout(args) => Format::Gif,
        None => Format::from_path(&args.out)?,
    };
    let refuse = |option: &str, holders: &str| {
        let message = format!("{option} means nothing to {}", format.name());
        Err(Failure::usage(
            message,
            vec![format!("it is for {holders}")],
        ))
    };
    if args.quality.is_some() && format != Format::Gif {
        return refuse("--quality", "GIFs");
    }
    if args.compression.is_some() && !format.is_png() {
        return refuse("--compression", "PNG and APNG");
    }
    if args.repeat.is_some() && !matches!(format, Format::Gif | Format::Apng) {
        return refuse("--loop", "GIF and APNG");
    }
    if args.chroma.is_some() && format != Format::Y4m {
        return refuse("--chroma", "y4m videos");
    }
    Ok(format)
}

fn named(format: PictureFormat, out: &Path) -> Result<Format, Failure> {
    Ok(match format {
        PictureFormat::Gif => Format::Gif,
        PictureFormat::Apng => Format::Apng,
        // A folder or a pattern is told by its name only.
        PictureFormat::Png => match Format::from_path(out) {
            Ok(sequence @ Format::PngSequence(_)) => sequence,
            _ => Format::Png,
        },
        PictureFormat::Y4m => Format::Y4m,
        PictureFormat::Rgba => Format::Rgba,
        PictureFormat::Glb => Format::Glb,
        PictureFormat::Stl => Format::Stl,
        PictureFormat::Obj => Format::Obj,
    })
}

/// Whether the file goes to standard output.
pub fn to_stdout(args: &FileArgs) -> bool {
    args.out == Path::new("-")
}

/// Where the bytes go; opened before anything is drawn, so that a bad path is found at once.
pub enum Destination {
    /// One file.
    File(Box<dyn Output>),
    /// A file a frame.
    Sequence(FramePattern),
}

/// Opens the output.
pub fn open(args: &FileArgs, format: &Format) -> Result<Destination, Failure> {
    Ok(match format {
        Format::PngSequence(pattern) => Destination::Sequence(pattern.clone()),
        _ => Destination::File(open_file(args)?),
    })
}

/// Opens an output that is one file.
pub fn open_file(args: &FileArgs) -> Result<Box<dyn Output>, Failure> {
    if to_stdout(args) {
        return Ok(Box::new(Stream::new("standard output", std::io::stdout())));
    }
    Ok(Box::new(Target::create(&args.out)?))
}

/// Frames to be written.
pub struct Film<'a> {
    /// How.
    pub args: &'a FileArgs,
    /// Into what.
    pub format: &'a Format,
    /// Size of every frame in pixels.
    pub size: [u32; 2],
    /// Number of frames.
    pub count: usize,
    /// Frames a second.
    pub fps: f64,
    /// Colours that a palette must hold exactly.
    pub flat_colours: Vec<[u8; 3]>,
    /// Whether frames may be translucent.
    pub alpha: bool,
}

/// A sink, and the frames drawn already for its palette.
pub type Prepared = (Box<dyn FrameSink>, Samples);

impl Film<'_> {
    /// Opens the sink; for a GIF some frames are drawn to find the palette.
    pub fn sink<W, E>(
        &self,
        destination: Destination,
        workers: &mut [W],
        term: &Term,
    ) -> Result<Prepared, Failure>
    where
        W: FnMut(usize, &mut RgbaImage) -> Result<(), E> + Send,
        E: std::error::Error + Send + 'static,
        Failure: From<E>,
    {
        let file = match destination {
            Destination::File(file) => file,
            Destination::Sequence(pattern) => {
                let settings = self.png(Effort::Fast);
                return Ok((Box::new(SequenceSink::new(pattern, settings)?), Vec::new()));
            }
        };
        let (size, fps) = (self.size, self.fps);
        let sink: Box<dyn FrameSink> = match self.format {
            Format::Gif => return self.gif(file, workers, term),
            Format::Apng => Box::new(ApngSink::new(file, self.apng())?),
            Format::Png | Format::PngSequence(_) => {
                Box::new(StillSink::new(file, self.png(Effort::Balanced))?)
            }
            Format::Y4m => {
                let chroma = match self.args.chroma {
                    Some(ChromaArg::C420) => Chroma::Quarter,
                    Some(ChromaArg::C444) | None => Chroma::Full,
                };
                Box::new(RawSink::new(file, RawKind::Y4m { fps, chroma }, size)?)
            }
            Format::Rgba => Box::new(RawSink::new(file, RawKind::Rgba { fps }, size)?),
            Format::Glb | Format::Stl | Format::Obj => {
                let message = format!("{} holds no pixels", self.format.name());
                return Err(Failure::usage(message, Vec::new()));
            }
        };
        Ok((sink, Vec::new()))
    }

    /// Draws and writes all frames.
    pub fn write<W, E>(
        &self,
        (sink, samples): Prepared,
        workers: Vec<W>,
        term: &Term,
    ) -> Result<ExportSummary, Failure>
    where
        W: FnMut(usize, &mut RgbaImage) -> Result<(), E> + Send,
        E: std::error::Error + Send + 'static,
        Failure: From<E>,
    {
        let progress = Progress::new(self.args.progress, term.quiet());
        let show = |done, all| progress.show(done, all);
        let result = pump(workers, self.count, samples, sink, &show, &CANCEL);
        progress.end();
        result.map_err(failure)
    }

    /// Says what was written, unless it went to standard output.
    pub fn tell(&self, summary: &ExportSummary, more: &str, term: &Term) {
        if to_stdout(self.args) {
            return;
        }
        let frames = match summary.frames {
            1 => "1 frame".to_owned(),
            count => format!("{count} frames"),
        };
        let time = match summary.seconds {
            seconds if seconds > 0.0 => format!(", {seconds:.2} s"),
            _ => String::new(),
        };
        let [width, height] = self.size;
        let megabytes = summary.bytes as f64 / 1e6;
        term.note(&format!(
            "{}: {frames} of {width}x{height}{time}, {megabytes:.2} MB{more}",
            self.args.out.display(),
        ));
    }

    fn gif<W, E>(
        &self,
        file: Box<dyn Output>,
        workers: &mut [W],
        term: &Term,
    ) -> Result<Prepared, Failure>
    where
        W: FnMut(usize, &mut RgbaImage) -> Result<(), E> + Send,
        E: std::error::Error + Send + 'static,
        Failure: From<E>,
    {
        let indices = sample_indices(self.count);
        let samples = draw_samples(workers, &indices, self.size, &CANCEL).map_err(failure)?;
        let palette = Palette::from_samples(
            samples.iter().map(|(_, image)| image),
            &self.flat_colours,
            PALETTE_COLOURS,
        );
        let settings = GifSettings {
            size: self.size,
            schedule: self.schedule(term)?,
            repeat: self.repeats(),
            quality: self
                .args
                .quality
                .and_then(Quality::new)
                .unwrap_or(Quality::BEST),
        };
        let sink = GifSink::new(file, settings, Arc::new(palette))?;
        Ok((Box::new(sink), samples))
    }

    /// When the frames are shown; viewers of GIFs do not go beyond 50 a second.
    fn schedule(&self, term: &Term) -> Result<Schedule, Failure> {
        let schedule = Schedule::new(self.times(), 0.0)?;
        if let Some(clamp) = schedule.clamp() {
            term.warning(&format!(
                "a GIF shows at most 50 frames a second: it will last {:.2} s instead of {:.2} s; an .apng keeps its rate",
                clamp.written_seconds, clamp.asked_seconds
            ));
        }
        Ok(schedule)
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
            repeat: self.repeats(),
            effort: self.effort(Effort::Balanced),
            alpha: self.alpha,
        }
    }

    fn png(&self, usual: Effort) -> PngSettings {
        PngSettings {
            size: self.size,
            effort: self.effort(usual),
            alpha: self.alpha,
        }
    }

    fn effort(&self, usual: Effort) -> Effort {
        match self.args.compression {
            None => usual,
            Some(Compression::Fast) => Effort::Fast,
            Some(Compression::Balanced) => Effort::Balanced,
            Some(Compression::Small) => Effort::Small,
        }
    }

    fn repeats(&self) -> bool {
        self.args.repeat != Some(Repeat::Once)
    }
}

fn failure<E>(error: PumpError<E>) -> Failure
where
    E: std::error::Error + 'static,
    Failure: From<E>,
{
    match error {
        PumpError::Draw { source, .. } => source.into(),
        PumpError::Export(error) => error.into(),
        PumpError::Cancelled => Failure::Interrupted,
        PumpError::NoWorkers => Failure::Internal(error.to_string()),
    }
}
