//! Frame sources: a PNG, an APNG, a GIF, or a folder of PNGs, read frame by frame.

use super::apng::ApngPictures;
use super::order::natural_order;
use super::picture::{ImportError, decoder_limits, open_head};
use super::rows::FramePicture;
use crate::limits::{Resource, allow_memory, current_limits};
use crate::sorting::sort_by;
use image::codecs::gif::GifDecoder;
use image::{AnimationDecoder, Frames, ImageDecoder, Limits};
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

/// First bytes of the files that are known.
const GIF_MAGIC: &[u8] = b"GIF8";
const PNG_MAGIC: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Memory per pixel for the next frame of an animation: the part drawn over the previous picture, and the result; for
/// the first frame also the previous picture.
const BYTES_OF_NEXT_PIXEL: f64 = 2.0 * 4.0;
const BYTES_OF_FIRST_PIXEL: f64 = 3.0 * 4.0;

/// Frames of fewer bytes are read without asking whether there is memory for them.
const WORTH_ASKING: f64 = 16e6;

/// How often an animation plays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plays {
    /// Without end.
    Forever,
    /// So many times.
    Times(u32),
}

/// One frame.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmFrame {
    /// The file's name in a folder; empty elsewhere.
    pub name: String,
    /// The visible picture, all parts composited.
    pub picture: FramePicture,
    /// Seconds it is shown; 0 where the format has no time.
    pub seconds: f64,
}

/// A row of pictures.
pub struct FilmReader {
    path: PathBuf,
    /// How often it plays; `None` where the format has no time.
    pub plays: Option<Plays>,
    /// What it is, for messages.
    pub kind: &'static str,
    frames: Box<dyn Iterator<Item = Result<FilmFrame, ImportError>>>,
    /// Pixels of a frame held in memory.
    held: f64,
    /// Pixels of the frames so far: a few bytes of a file can make a frame of any size.
    pixels: f64,
}

impl FilmReader {
    /// Opens a file or a folder; the file's contents decide what it is, not its name.
    ///
    /// Errors: it cannot be read, is none of the known kinds, or is a folder without PNG files.
    pub fn open(path: &Path) -> Result<Self, ImportError> {
        if path.is_dir() {
            return Self::of_folder(path);
        }
        let (mut file, size) = open_head(path)?;
        let start = file.fill_buf().map_err(|e| ImportError::read(path, e))?;
        if start.starts_with(GIF_MAGIC) {
            let film = Self::of_gif(path, file, decoder_limits(size))?;
            return Ok(film.held(size));
        }
        if start.starts_with(PNG_MAGIC) {
            return Self::of_png(path, file, size);
        }
        Err(ImportError::decode(path, "neither a PNG nor a GIF"))
    }

    /// Whose frames, of a size, are held in memory.
    fn held(mut self, [width, height]: [u64; 2]) -> Self {
        self.held = width as f64 * height as f64;
        self
    }

    /// Refuses a frame for which there is not enough memory.
    fn ask_for_memory(&self) -> Result<(), ImportError> {
        let bytes = match self.pixels {
            p if p > 0.0 => BYTES_OF_NEXT_PIXEL * self.held,
            _ => BYTES_OF_FIRST_PIXEL * self.held,
        };
        if bytes > WORTH_ASKING {
            allow_memory(bytes, &self.path.display())?;
        }
        Ok(())
    }

    /// Where it comes from.
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn new(
        path: &Path,
        kind: &'static str,
        plays: Option<Plays>,
        frames: impl Iterator<Item = Result<FilmFrame, ImportError>> + 'static,
    ) -> Self {
        Self {
            path: path.to_owned(),
            plays,
            kind,
            frames: Box::new(frames),
            held: 0.0,
            pixels: 0.0,
        }
    }

    fn of_gif(path: &Path, mut file: BufReader<File>, limits: Limits) -> Result<Self, ImportError> {
        let plays = gif_plays(&mut file).map_err(|e| ImportError::read(path, e))?;
        let mut decoder = GifDecoder::new(file).map_err(|e| ImportError::decode(path, e))?;
        let limited = decoder.set_limits(limits);
        limited.map_err(|e| ImportError::decode(path, e))?;
        let frames = timed_frames(path, decoder.into_frames());
        Ok(Self::new(path, "a GIF", Some(plays), frames))
    }

    fn of_png(path: &Path, file: BufReader<File>, size: [u64; 2]) -> Result<Self, ImportError> {
        let beside = decoder_limits(size)
            .max_alloc
            .and_then(|bytes| usize::try_from(bytes).ok());
        let Some(pictures) = ApngPictures::open(path, file, beside.unwrap_or(usize::MAX))? else {
            let still = FilmFrame {
                name: String::new(),
                picture: FramePicture::of_png(path)?,
                seconds: 0.0,
            };
            return Ok(Self::new(path, "a PNG", None, std::iter::once(Ok(still))));
        };
        let plays = match pictures.plays() {
            0 => Plays::Forever,
            times => Plays::Times(times),
        };
        let frames = pictures.map(|picture| {
            let (picture, seconds) = picture?;
            Ok(FilmFrame {
                name: String::new(),
                picture: FramePicture::Held(picture),
                seconds,
            })
        });
        Ok(Self::new(path, "an APNG", Some(plays), frames).held(size))
    }

    fn of_folder(path: &Path) -> Result<Self, ImportError> {
        let files = png_files(path)?;
        if files.is_empty() {
            return Err(ImportError::decode(path, "the folder has no PNG files"));
        }
        let frames = files.into_iter().map(|file| {
            let name = file.file_name().unwrap_or_default();
            Ok(FilmFrame {
                name: name.to_string_lossy().into_owned(),
                picture: FramePicture::of_png(&file)?,
                seconds: 0.0,
            })
        });
        Ok(Self::new(path, "a folder", None, frames))
    }
}

impl FilmReader {
    /// The frame, unless the film has more pixels with it than it may.
    fn counted_frame(&mut self, frame: FilmFrame) -> Result<FilmFrame, ImportError> {
        let [width, height] = frame.picture.size().map(f64::from);
        self.pixels += width * height;
        let who = self.path.display();
        current_limits().allow(Resource::Film, self.pixels, &who)?;
        Ok(frame)
    }
}

impl Iterator for FilmReader {
    type Item = Result<FilmFrame, ImportError>;

    fn next(&mut self) -> Option<Self::Item> {
        if let Err(error) = self.ask_for_memory() {
            return Some(Err(error));
        }
        let frame = self.frames.next()?;
        Some(frame.and_then(|frame| self.counted_frame(frame)))
    }
}

/// The PNG files of a folder, counted as people do.
///
/// Errors: the folder cannot be read.
pub fn png_files(folder: &Path) -> Result<Vec<PathBuf>, ImportError> {
    let failed = |e| ImportError::read(folder, e);
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let is_png = path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("png"));
        if is_png && path.is_file() {
            files.push(path);
        }
    }
    sort_by(&mut files, |a, b| natural_order(a, b));
    Ok(files)
}

fn timed_frames(
    path: &Path,
    frames: Frames<'static>,
) -> impl Iterator<Item = Result<FilmFrame, ImportError>> + use<> {
    let path = path.to_owned();
    frames.map(move |frame| {
        let frame = frame.map_err(|e| ImportError::decode(&path, e))?;
        let (numerator, denominator) = frame.delay().numer_denom_ms();
        Ok(FilmFrame {
            name: String::new(),
            seconds: f64::from(numerator) / f64::from(denominator) / 1e3,
            picture: FramePicture::Held(frame.into_buffer()),
        })
    })
}

/// Number of times a GIF plays, read from its loop extension; then the file is rewound to its start.
///
/// The decoder knows the extension only once it has passed it, and takes a missing one for an endless loop.
fn gif_plays(file: &mut BufReader<File>) -> std::io::Result<Plays> {
    use std::io::{Read, Seek};
    /// The extension stands before the first picture: after a header of 13 bytes and at most 256 colours.
    const BEFORE_PICTURES: u64 = 13 + 3 * 256 + 4096;
    const NAME: &[u8] = b"\x21\xff\x0bNETSCAPE2.0\x03\x01";
    let mut start = Vec::new();
    file.by_ref()
        .take(BEFORE_PICTURES)
        .read_to_end(&mut start)?;
    file.rewind()?;
    let place = start.windows(NAME.len()).position(|w| w == NAME);
    let count = place.and_then(|p| start.get(p + NAME.len()..p + NAME.len() + 2));
    Ok(match count {
        None => Plays::Times(1),
        Some([0, 0]) => Plays::Forever,
        // The field is the number of repetitions after the first play.
        Some(count) => {
            let repeats = count.iter().rev().fold(0, |n, b| 256 * n + u32::from(*b));
            Plays::Times(repeats + 1)
        }
    })
}
