//! PNG files row by row, as RGBA with 8 bits per channel: a large picture need not be held in memory.

use super::picture::{BESIDE_PIXELS, ImportError, open_head};
use crate::limits::allow_memory;
use image::RgbaImage;
use png::{BitDepth, ColorType, Decoder, Limits, Reader, Transformations};
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// Maximum memory per pixel of one row: as packed in the file, twice, with 16 bits per channel, and as RGBA.
const BYTES_OF_ROW_PIXEL: u64 = 3 * 8 + 4;

/// Bytes of an RGBA pixel.
const RGBA: usize = 4;

/// A picture read sequentially from its first row to its last.
pub struct PictureRows<'p> {
    source: RowSource<'p>,
    size: [u32; 2],
    /// The last row read.
    row: Vec<u8>,
    /// How many were.
    count: u32,
}

enum RowSource<'p> {
    Held(&'p RgbaImage),
    File(PathBuf, Box<Reader<BufReader<File>>>),
    /// The rows of an interlaced file are spread all over it: reading the first row decodes all of them, in the file's
    /// pixel format.
    Interlaced(PathBuf, Box<Reader<BufReader<File>>>, Vec<u8>),
}

impl<'p> PictureRows<'p> {
    /// Of a picture in memory.
    pub fn of_picture(picture: &'p RgbaImage) -> Self {
        Self::new(RowSource::Held(picture), picture.dimensions().into())
    }

    /// Of a PNG; of an animated one its still picture.
    ///
    /// Errors: the file cannot be read, is no PNG, or is too large. That it is damaged farther on is seen there.
    pub fn open(path: &Path) -> Result<Self, ImportError> {
        let refuse = |e: png::DecodingError| ImportError::decode(path, e);
        let (file, [width, _]) = open_head(path)?;
        let needed = BESIDE_PIXELS + width.saturating_mul(BYTES_OF_ROW_PIXEL);
        allow_memory(needed as f64, &path.display())?;
        let bytes = usize::try_from(needed).unwrap_or(usize::MAX);
        let mut decoder = Decoder::new_with_limits(file, Limits { bytes });
        decoder.set_transformations(Transformations::EXPAND);
        decoder.set_ignore_text_chunk(true);
        decoder.set_ignore_iccp_chunk(true);
        let reader = decoder.read_info().map_err(refuse)?;
        let size = reader.info().size().into();
        let source = match reader.info().interlaced {
            true => RowSource::Interlaced(path.to_owned(), Box::new(reader), Vec::new()),
            false => RowSource::File(path.to_owned(), Box::new(reader)),
        };
        Ok(Self::new(source, size))
    }

    fn new(source: RowSource<'p>, size: [u32; 2]) -> Self {
        Self {
            source,
            size,
            row: Vec::new(),
            count: 0,
        }
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Whether pixels have room for transparency; they may still all be opaque.
    pub fn has_alpha(&self) -> bool {
        match &self.source {
            RowSource::Held(_) => true,
            RowSource::File(_, reader) | RowSource::Interlaced(_, reader, _) => matches!(
                reader.output_color_type().0,
                ColorType::Rgba | ColorType::GrayscaleAlpha
            ),
        }
    }

    /// The next row; `None` behind the last.
    ///
    /// Errors: the file is damaged, or is interlaced and takes more memory than the run may use.
    pub fn next_row(&mut self) -> Result<Option<&[u8]>, ImportError> {
        let index = self.count as usize;
        self.count = self.count.saturating_add(1);
        let width = RGBA * self.size[0].max(1) as usize;
        match &mut self.source {
            RowSource::Held(picture) => Ok(picture.as_raw().chunks_exact(width).nth(index)),
            RowSource::File(path, reader) => {
                let kind = reader.output_color_type();
                let row = reader.next_row();
                let row = row.map_err(|e| ImportError::decode(path, e))?;
                Ok(row.map(|row| {
                    rgba_of(row.data(), kind, &mut self.row);
                    &self.row[..]
                }))
            }
            RowSource::Interlaced(path, reader, pixels) => {
                if index == 0 {
                    *pixels = all_rows(path, reader)?;
                }
                let bytes = pixels.len() / self.size[1].max(1) as usize;
                let row = pixels.chunks_exact(bytes.max(1)).nth(index);
                Ok(row.map(|row| {
                    rgba_of(row, reader.output_color_type(), &mut self.row);
                    &self.row[..]
                }))
            }
        }
    }
}

/// All rows of a file, one after the other.
fn all_rows(path: &Path, reader: &mut Reader<BufReader<File>>) -> Result<Vec<u8>, ImportError> {
    let bytes = reader.output_buffer_size().unwrap_or(usize::MAX);
    allow_memory(bytes as f64, &path.display())?;
    let mut pixels = vec![0; bytes];
    let found = reader.next_frame(&mut pixels);
    found.map_err(|e| ImportError::decode(path, e))?;
    Ok(pixels)
}

/// The pixels of a row as RGBA.
fn rgba_of(row: &[u8], (kind, depth): (ColorType, BitDepth), rgba: &mut Vec<u8>) {
    rgba.clear();
    match depth {
        BitDepth::Sixteen => {
            let wide = row.chunks_exact(2);
            let wide = wide.map(|b| u32::from(u16::from_be_bytes([b[0], b[1]])));
            // To the nearest level: 65535 is 255.
            push_pixels(wide.map(|level| ((level + 128) / 257) as u8), kind, rgba);
        }
        _ => push_pixels(row.iter().copied(), kind, rgba),
    }
}

fn push_pixels(mut levels: impl Iterator<Item = u8>, kind: ColorType, rgba: &mut Vec<u8>) {
    while let Some(first) = levels.next() {
        let mut next = || levels.next().unwrap_or(255);
        rgba.extend(match kind {
            // A palette is expanded by the decoder.
            ColorType::Grayscale | ColorType::Indexed => [first, first, first, 255],
            ColorType::GrayscaleAlpha => [first, first, first, next()],
            ColorType::Rgb => [first, next(), next(), 255],
            ColorType::Rgba => [first, next(), next(), next()],
        });
    }
}

/// The pixels of a frame: in memory, or in a file that is read whenever they are needed.
#[derive(Clone, Debug, PartialEq)]
pub enum FramePicture {
    /// In memory.
    Held(RgbaImage),
    /// In a PNG of a size.
    File(PathBuf, [u32; 2]),
}

impl FramePicture {
    /// That of a PNG, of which the head is read.
    ///
    /// Errors: as [`PictureRows::open`].
    pub(super) fn of_png(path: &Path) -> Result<Self, ImportError> {
        Ok(Self::File(path.to_owned(), PictureRows::open(path)?.size()))
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        match self {
            Self::Held(picture) => picture.dimensions().into(),
            Self::File(_, size) => *size,
        }
    }

    /// Its rows, from the first on.
    ///
    /// Errors: as [`PictureRows::open`].
    pub fn rows(&self) -> Result<PictureRows<'_>, ImportError> {
        match self {
            Self::Held(picture) => Ok(PictureRows::of_picture(picture)),
            Self::File(path, _) => PictureRows::open(path),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::picture::read_png;
    use super::*;
    use png::Encoder;

    /// A PNG of a kind whose bytes look random; a palette and a transparent colour where the kind can have them.
    fn file_of(path: &Path, (kind, depth): (ColorType, BitDepth), [width, height]: [u32; 2]) {
        let mut state = width * 31 + height;
        let mut byte = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        };
        let mut encoder = Encoder::new(File::create(path).unwrap(), width, height);
        encoder.set_color(kind);
        encoder.set_depth(depth);
        match kind {
            ColorType::Indexed => {
                encoder.set_palette((0..3 * 256).map(|_| byte()).collect::<Vec<u8>>());
                encoder.set_trns((0..200).map(|_| byte()).collect::<Vec<u8>>());
            }
            ColorType::Grayscale => encoder.set_trns(vec![0, 1]),
            ColorType::Rgb => encoder.set_trns(vec![0, 1, 0, 2, 0, 3]),
            _ => {}
        }
        let row = (width as usize * kind.samples() * depth as usize).div_ceil(8);
        let pixels: Vec<u8> = (0..row * height as usize).map(|_| byte()).collect();
        encoder
            .write_header()
            .unwrap()
            .write_image_data(&pixels)
            .unwrap();
    }

    #[test]
    fn rows_are_those_of_the_whole_picture() {
        let path = std::env::temp_dir().join(format!("mechanim-rows-{}.png", std::process::id()));
        use BitDepth::{Eight, Four, One, Sixteen, Two};
        let kinds = [
            (ColorType::Grayscale, &[One, Two, Four, Eight, Sixteen][..]),
            (ColorType::Indexed, &[One, Two, Four, Eight]),
            (ColorType::GrayscaleAlpha, &[Eight, Sixteen]),
            (ColorType::Rgb, &[Eight, Sixteen]),
            (ColorType::Rgba, &[Eight, Sixteen]),
        ];
        for (kind, depths) in kinds {
            for depth in depths {
                for size in [[1, 1], [7, 5], [64, 3], [33, 40]] {
                    file_of(&path, (kind, *depth), size);
                    let whole = read_png(&path).unwrap();
                    let mut rows = PictureRows::open(&path).unwrap();
                    assert_eq!(rows.size(), size);
                    let mut pixels = Vec::new();
                    while let Some(row) = rows.next_row().unwrap() {
                        pixels.extend_from_slice(row);
                    }
                    assert!(pixels == *whole.as_raw(), "{kind:?} {depth:?} {size:?}");
                    assert!(rows.has_alpha() || whole.pixels().all(|p| p.0[3] == 255));
                    assert!(rows.next_row().unwrap_or_default().is_none());
                }
            }
        }
        std::fs::remove_file(path).unwrap();
    }
}
