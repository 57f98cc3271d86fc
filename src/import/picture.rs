//! Single pictures, and what can be wrong with a file.

use image::codecs::png::PngDecoder;
use image::{ImageDecoder, ImageFormat, ImageReader, Limits, RgbaImage};
use std::io;
use std::path::{Path, PathBuf};

/// Longest side and largest memory of a picture that is read; a small file can ask for terabytes.
const LONGEST_SIDE: u32 = 1 << 16;
const MOST_BYTES: u64 = 1 << 30;

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
    /// The contents are not a picture that is known.
    #[error("{}: {message}", .path.display())]
    Decode {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        message: String,
    },
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
    let file = std::fs::File::open(path).map_err(|e| ImportError::read(path, e))?;
    let mut reader = ImageReader::with_format(io::BufReader::new(file), ImageFormat::Png);
    reader.limits(limits());
    let picture = reader.decode().map_err(|e| ImportError::decode(path, e))?;
    Ok(picture.into_rgba8())
}

/// Whether a PNG has room for transparency, read off its head; its pixels may still all be opaque.
///
/// Errors: as [`read_png`].
pub fn has_alpha(path: &Path) -> Result<bool, ImportError> {
    let file = std::fs::File::open(path).map_err(|e| ImportError::read(path, e))?;
    let decoder = PngDecoder::with_limits(io::BufReader::new(file), limits());
    let decoder = decoder.map_err(|e| ImportError::decode(path, e))?;
    Ok(decoder.color_type().has_alpha())
}

/// The same for all formats.
pub(super) fn limits() -> Limits {
    let mut limits = Limits::default();
    limits.max_image_width = Some(LONGEST_SIDE);
    limits.max_image_height = Some(LONGEST_SIDE);
    limits.max_alloc = Some(MOST_BYTES);
    limits
}
