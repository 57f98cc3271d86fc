//! From frames to a picture file: the format, whether it can hold what is requested, and the sink that writes it.

use crate::cli::args::files::{ChromaArg, Compression, FileArgs, PictureFormat, Repeat};
use crate::cli::interrupt::CANCEL;
use crate::cli::term::Term;
use crate::cli::term::outcome::Failure;
use crate::cli::term::progress::Progress;
use crate::export::error::PipelineError;
use crate::export::film::{Destination, FilmSettings, Prepared};
use crate::export::format::VideoKind;
use crate::export::gif::Quality;
use crate::export::png::Effort;
use crate::export::raw::Chroma;
use crate::export::{ExportError, ExportSummary, Format, Output, PendingFile, Stream};
use image::RgbaImage;
use std::path::Path;

/// The format that the options and the file name select.
///
/// Errors: an unknown extension; an option that does not apply to this format.
pub fn film_format(args: &FileArgs) -> Result<Format, Failure> {
    let format = match args.format {
        Some(format) => named_format(format, &args.out)?,
        None if to_stdout(args) => Format::Gif,
        None => Format::from_path(&args.out)?,
    };
    let refuse = |option: &str, holders: &str| {
        let message = format!("{option} has no effect on {}", format.name());
        Err(Failure::usage(
            message,
            vec![format!("it applies to {holders}")],
        ))
    };
    if args.quality.is_some() && format != Format::Gif {
        return refuse("--quality", "GIFs");
    }
    if args.compression.is_some() && !format.is_png() {
        return refuse("--compression", "PNG and APNG");
    }
    if args.dpi.is_some() && !matches!(format, Format::Png | Format::PngSequence(_)) {
        return refuse("--dpi", "PNGs");
    }
    if args.repeat.is_some() && !matches!(format, Format::Gif | Format::Apng) {
        return refuse("--loop", "GIF and APNG");
    }
    if args.chroma.is_some() && format != Format::Y4m {
        return refuse("--chroma", "y4m videos");
    }
    Ok(format)
}

fn named_format(format: PictureFormat, out: &Path) -> Result<Format, Failure> {
    Ok(match format {
        PictureFormat::Gif => Format::Gif,
        PictureFormat::Apng => Format::Apng,
        // A folder or a pattern is recognised by its name alone.
        PictureFormat::Png => match Format::from_path(out) {
            Ok(sequence @ Format::PngSequence(_)) => sequence,
            _ => Format::Png,
        },
        PictureFormat::Mp4 => Format::Video(VideoKind::Mp4),
        PictureFormat::Webm => Format::Video(VideoKind::Webm),
        PictureFormat::Webp => Format::Video(VideoKind::Webp),
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

/// Opens the output.
pub fn open_sink(args: &FileArgs, format: &Format) -> Result<Destination, Failure> {
    if matches!(format, Format::Video(_)) && to_stdout(args) {
        return Err(ExportError::NoSeek(args.out.clone()).into());
    }
    Ok(match to_stdout(args) {
        true => Destination::File(open_file(args)?),
        false => Destination::at(&args.out, format)?,
    })
}

/// Opens an output that is one file.
pub fn open_file(args: &FileArgs) -> Result<Box<dyn Output>, Failure> {
    if to_stdout(args) {
        return Ok(Box::new(Stream::new("standard output", std::io::stdout())));
    }
    Ok(Box::new(PendingFile::create(&args.out)?))
}

/// Frames to be written, with the options of the command line.
pub struct OpenFilm<'a> {
    /// Destination and encoding options.
    pub args: &'a FileArgs,
    /// Format.
    pub settings: FilmSettings<'a>,
}

impl<'a> OpenFilm<'a> {
    /// `count` opaque frames of pixels `size`, `fps` per second.
    pub fn new(
        args: &'a FileArgs,
        format: &'a Format,
        size: [u32; 2],
        count: usize,
        fps: f64,
    ) -> Self {
        let settings = FilmSettings {
            quality: args
                .quality
                .and_then(Quality::new)
                .unwrap_or(Quality::USUAL),
            effort: args.compression.map(|compression| match compression {
                Compression::Fast => Effort::Fast,
                Compression::Balanced => Effort::Balanced,
                Compression::Small => Effort::Small,
            }),
            dpi: args.dpi,
            chroma: match args.chroma {
                Some(ChromaArg::C420) => Chroma::Quarter,
                Some(ChromaArg::C444) | None => Chroma::Full,
            },
            repeat: args.repeat != Some(Repeat::Once),
            ..FilmSettings::new(format, size, count, fps)
        };
        Self { args, settings }
    }

    /// Colours that a palette must hold exactly.
    pub fn with_needed_colours(mut self, colours: Vec<[u8; 3]>) -> Self {
        self.settings.needed_colours = colours;
        self
    }

    /// Texts in PNGs, each with its keyword.
    pub fn with_texts(mut self, texts: Vec<(String, String)>) -> Self {
        self.settings.texts = texts;
        self
    }

    /// Makes the frames strips, of so many rows, of one picture.
    pub fn in_strips(mut self, rows: u32) -> Self {
        self.settings.strip_rows = Some(rows);
        self
    }

    /// Marks frames as cheap to draw twice.
    pub fn at_hand(mut self) -> Self {
        self.settings.at_hand = true;
        self
    }

    /// Marks frames as possibly translucent.
    pub fn with_alpha(mut self, alpha: bool) -> Self {
        self.settings.alpha = alpha;
        self
    }

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
        let prepared = self.settings.open(destination, workers, &CANCEL);
        let prepared = prepared.map_err(pipeline_failure)?;
        if prepared.left_out > 0 {
            term.warning(&format!(
                "a GIF shows at most 50 frames a second: {} of {} frames are left out; an .apng keeps them",
                prepared.left_out, self.settings.count
            ));
        }
        Ok(prepared)
    }

    /// Draws and writes all frames.
    pub fn write<W, E>(
        &self,
        prepared: Prepared,
        workers: Vec<W>,
        term: &Term,
    ) -> Result<ExportSummary, Failure>
    where
        W: FnMut(usize, &mut RgbaImage) -> Result<(), E> + Send,
        E: std::error::Error + Send + 'static,
        Failure: From<E>,
    {
        let mut progress = Progress::new(self.args.progress, term.quiet());
        if self.settings.strip_rows.is_some() {
            progress = progress.counting("strips");
        }
        let show = |done, all| progress.show(done, all);
        let result = self.settings.write(prepared, workers, &show, &CANCEL);
        progress.end();
        result.map_err(pipeline_failure)
    }

    /// Reports what was written, unless it went to standard output, and which older frames remain beside it.
    pub fn tell(&self, summary: &ExportSummary, more: &str, term: &Term) {
        if let Format::PngSequence(pattern) = &self.settings.format {
            let older = (self.settings.count..)
                .take_while(|k| pattern.path(*k).exists())
                .count();
            if older > 0 {
                let first = pattern.path(self.settings.count);
                term.warning(&format!(
                    "{} from {} on, which are not of this run",
                    match older {
                        1 => "an older frame remains,".to_owned(),
                        _ => format!("{older} older frames remain,"),
                    },
                    first.display()
                ));
            }
        }
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
        let [width, height] = self.settings.size;
        let megabytes = summary.bytes as f64 / 1e6;
        term.note(&format!(
            "{}: {frames} of {width}x{height}{time}, {megabytes:.2} MB{more}",
            self.args.out.display(),
        ));
    }
}

fn pipeline_failure<E>(error: PipelineError<E>) -> Failure
where
    E: std::error::Error + 'static,
    Failure: From<E>,
{
    match error {
        PipelineError::Draw { source, .. } => source.into(),
        PipelineError::Export(error) => error.into(),
        PipelineError::Cancelled => Failure::Interrupted,
        PipelineError::NoWorkers => Failure::Internal(error.to_string()),
    }
}
