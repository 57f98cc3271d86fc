//! Single pictures, and the errors of reading a file.

use crate::limits::{LimitExceeded, Resource, allow_memory};
use image::{ImageFormat, ImageReader, Limits, RgbaImage};
use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};

/// Memory that a decoder may use besides the pixels: for profiles and texts, which a small file can expand to
/// gigabytes.
pub(super) const BESIDE_PIXELS: u64 = 16 << 20;

/// Bytes that a decoder and its reader hold of a pixel at most: 16 bits a channel, and again 8 bits a channel.
const BYTES_OF_PIXEL: u64 = 8 + 4;

/// Position of the sizes in the file headers: first byte of the width, bytes per number, whether it is big-endian.
const PNG_SIZE: (usize, usize, bool) = (16, 4, true);
const GIF_SIZE: (usize, usize, bool) = (6, 2, false);

/// Why a picture could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    /// The file cannot be opened or read.
    #[error("cannot read {}: {source}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The contents are not a picture of a supported format.
    #[error("{}: {message}", .path.display())]
    Decode {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        message: String,
    },
    /// It needs more memory than the run may use.
    #[error(transparent)]
    Limit(#[from] LimitExceeded),
    /// A frame of another size than the first.
    #[error("{}: {}x{} pixels, but the first frame has {}x{}", .path.display(), .got[0], .got[1], .expected[0], .expected[1])]
    Size {
        /// The file.
        path: PathBuf,
        /// Size of the first frame.
        expected: [u32; 2],
        /// Size of this one.
        got: [u32; 2],
    },
    /// A translucent frame where the output has no alpha.
    #[error("{} has transparent pixels, which {format} cannot hold", .path.display())]
    Transparent {
        /// The file.
        path: PathBuf,
        /// Name of the format, with an article.
        format: &'static str,
    },
}

impl ImportError {
    pub(super) fn read(path: &Path, source: io::Error) -> Self {
        Self::Read {
            path: path.to_owned(),
            source,
        }
    }

    pub(super) fn decode(path: &Path, message: impl ToString) -> Self {
        Self::Decode {
            path: path.to_owned(),
            message: message.to_string(),
        }
    }
}

/// Reads one PNG as RGBA; of an animated one the first frame.
///
/// Errors: the file cannot be read, is no PNG, or is damaged or too large.
pub fn read_png(path: &Path) -> Result<RgbaImage, ImportError> {
    let (file, limits) = open_picture(path)?;
    let mut reader = ImageReader::with_format(file, ImageFormat::Png);
    reader.limits(limits);
    let picture = reader.decode().map_err(|e| ImportError::decode(path, e))?;
    Ok(picture.into_rgba8())
}

/// Opens a picture file, and checks the memory that decoding it as a whole needs.
fn open_picture(path: &Path) -> Result<(BufReader<File>, Limits), ImportError> {
    let (file, size) = open_head(path)?;
    let needed = size[0] as f64 * size[1] as f64 * BYTES_OF_PIXEL as f64;
    allow_memory(needed, &path.display())?;
    Ok((file, decoder_limits(size)))
}

/// What decoding a picture of a size may take.
pub(super) fn decoder_limits([width, height]: [u64; 2]) -> Limits {
    let mut limits = Limits::default();
    let pixels = width.saturating_mul(height);
    limits.max_alloc = Some(BESIDE_PIXELS + pixels.saturating_mul(BYTES_OF_PIXEL));
    limits
}

/// Opens a picture file whose size, read off its head, is not above the limit; 0 x 0 where it is neither PNG nor GIF.
pub(super) fn open_head(path: &Path) -> Result<(BufReader<File>, [u64; 2]), ImportError> {
    let failed = |e| ImportError::read(path, e);
    if !std::fs::metadata(path).map_err(failed)?.is_file() {
        return Err(ImportError::decode(path, "it is not a regular file"));
    }
    let mut file = BufReader::new(File::open(path).map_err(failed)?);
    let head = file.fill_buf().map_err(failed)?;
    // A file of neither format is refused later, by the reader.
    let place = [(&b"GIF"[..], GIF_SIZE), (&b"\x89PNG"[..], PNG_SIZE)];
    let place = place.into_iter().find(|(magic, _)| head.starts_with(magic));
    let size = place.and_then(|(_, place)| size_at(head, place));
    let [width, height] = size.unwrap_or_default();
    let pixels = width as f64 * height as f64;
    crate::limits::current_limits().allow(Resource::Pixels, pixels, &path.display())?;
    Ok((file, [width, height]))
}

/// Width and height of a picture, if its head is long enough.
fn size_at(head: &[u8], (start, bytes, is_big): (usize, usize, bool)) -> Option<[u64; 2]> {
    let number = |k: usize| {
        let number = head.get(start + k * bytes..start + (k + 1) * bytes)?;
        let add = |n: u64, byte: &u8| 256 * n + u64::from(*byte);
        Some(match is_big {
            true => number.iter().fold(0, add),
            false => number.iter().rev().fold(0, add),
        })
    };
    Some([number(0)?, number(1)?])
}
