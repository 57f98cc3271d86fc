//! PNG: one still picture, or one file a frame. RGB; the frames' alpha is 255 everywhere.

use super::error::ExportError;
use super::format::FramePattern;
use super::target::{Output, Target};
use super::{ExportSummary, FrameCoder, FrameSink};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, RgbaImage};
use std::io::Write;
use std::path::PathBuf;

/// Greatest side: PNG allows 2^31 - 1, memory does not.
const LONGEST_SIDE: u32 = 1 << 16;

/// How much time a picture is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// For sequences: about 1.3 ms for 640x480 pixels, a fifth larger.
    Fast,
    /// For a single still.
    Balanced,
}

/// Appends `image` as an RGB PNG file to `out`. The same image gives the same bytes.
///
/// Errors: a side of 0 or too long.
pub fn encode(image: &RgbaImage, effort: Effort, out: &mut Vec<u8>) -> Result<(), ExportError> {
    let mut rgb = Vec::new();
    drop_alpha(image, &mut rgb);
    encode_rgb(&rgb, [image.width(), image.height()], effort, out)
}

fn drop_alpha(image: &RgbaImage, rgb: &mut Vec<u8>) {
    rgb.clear();
    rgb.reserve(image.as_raw().len() / 4 * 3);
    rgb.extend(
        image
            .as_raw()
            .chunks_exact(4)
            .flat_map(|p| [p[0], p[1], p[2]]),
    );
}

fn encode_rgb(
    rgb: &[u8],
    size: [u32; 2],
    effort: Effort,
    out: &mut Vec<u8>,
) -> Result<(), ExportError> {
    check_size(size)?;
    let (compression, filter) = match effort {
        Effort::Fast => (CompressionType::Fast, FilterType::Adaptive),
        Effort::Balanced => (CompressionType::Default, FilterType::Adaptive),
    };
    let encoder = PngEncoder::new_with_quality(out, compression, filter);
    let done = encoder.write_image(rgb, size[0], size[1], ExtendedColorType::Rgb8);
    done.map_err(|e| ExportError::Encode {
        name: "PNG".to_owned(),
        message: e.to_string(),
    })
}

fn check_size([width, height]: [u32; 2]) -> Result<(), ExportError> {
    if [width, height]
        .iter()
        .all(|s| (1..=LONGEST_SIDE).contains(s))
    {
        return Ok(());
    }
    Err(ExportError::Size {
        format: "PNG",
        width,
        height,
        limit: LONGEST_SIDE,
    })
}

/// Turns frames into PNG files in memory.
struct PngCoder {
    size: [u32; 2],
    effort: Effort,
    rgb: Vec<u8>,
}

impl PngCoder {
    fn boxed(size: [u32; 2], effort: Effort) -> Box<dyn FrameCoder> {
        Box::new(Self {
            size,
            effort,
            rgb: Vec::new(),
        })
    }
}

impl FrameCoder for PngCoder {
    fn code(&mut self, frame: &RgbaImage, coded: &mut Vec<u8>) -> Result<(), ExportError> {
        super::check_frame(frame, self.size)?;
        drop_alpha(frame, &mut self.rgb);
        coded.clear();
        encode_rgb(&self.rgb, self.size, self.effort, coded)
    }
}

/// One picture.
pub struct StillSink {
    output: Box<dyn Output>,
    size: [u32; 2],
    summary: ExportSummary,
}

impl StillSink {
    /// A sink that takes exactly one frame of `size` pixels.
    ///
    /// Errors: a side of 0 or too long.
    pub fn new(output: Box<dyn Output>, size: [u32; 2]) -> Result<Self, ExportError> {
        check_size(size)?;
        Ok(Self {
            output,
            size,
            summary: ExportSummary::default(),
        })
    }
}

impl FrameSink for StillSink {
    fn size(&self) -> [u32; 2] {
        self.size
    }

    fn coder(&self) -> Box<dyn FrameCoder> {
        PngCoder::boxed(self.size, Effort::Balanced)
    }

    fn write(&mut self, _index: usize, coded: &[u8]) -> Result<(), ExportError> {
        self.summary.frames += 1;
        if self.summary.frames > 1 {
            return Err(still_needs_one(self.summary.frames));
        }
        self.summary.bytes = coded.len() as u64;
        let written = self.output.write_all(coded);
        written.map_err(|e| ExportError::write(self.output.name(), e))
    }

    fn finish(self: Box<Self>) -> Result<ExportSummary, ExportError> {
        if self.summary.frames != 1 {
            return Err(still_needs_one(self.summary.frames));
        }
        self.output.commit()?;
        Ok(self.summary)
    }
}

fn still_needs_one(got: usize) -> ExportError {
    ExportError::FrameCount {
        format: "a still PNG",
        needed: "exactly one frame",
        got,
    }
}

/// One file a frame. Dropped before `finish`, it removes the files it made (not those it replaced) and the folder.
pub struct SequenceSink {
    pattern: FramePattern,
    size: [u32; 2],
    made: Vec<PathBuf>,
    made_folder: bool,
    summary: ExportSummary,
}

impl SequenceSink {
    /// Prepares the folder: it is made if its parent exists.
    ///
    /// Errors: a side of 0 or too long, no folder to make it in, a file in its place.
    pub fn new(pattern: FramePattern, size: [u32; 2]) -> Result<Self, ExportError> {
        check_size(size)?;
        let folder = pattern.folder().to_owned();
        let made_folder = !folder.is_dir();
        if made_folder {
            let parent = super::target::folder_of(&folder);
            if !parent.exists() {
                return Err(ExportError::MissingFolder {
                    path: folder.clone(),
                    folder: parent.to_owned(),
                });
            }
            std::fs::create_dir(&folder).map_err(|e| ExportError::create(&folder, e))?;
        }
        Ok(Self {
            pattern,
            size,
            made: Vec::new(),
            made_folder,
            summary: ExportSummary::default(),
        })
    }
}

impl FrameSink for SequenceSink {
    fn size(&self) -> [u32; 2] {
        self.size
    }

    fn coder(&self) -> Box<dyn FrameCoder> {
        PngCoder::boxed(self.size, Effort::Fast)
    }

    fn write(&mut self, index: usize, coded: &[u8]) -> Result<(), ExportError> {
        let path = self.pattern.path(index);
        let is_new = std::fs::symlink_metadata(&path).is_err();
        let mut target = Target::create(&path)?;
        target
            .write_all(coded)
            .map_err(|e| ExportError::write(&path.display().to_string(), e))?;
        target.commit_unsynced()?;
        if is_new {
            self.made.push(path);
        }
        self.summary.frames += 1;
        self.summary.bytes += coded.len() as u64;
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> Result<ExportSummary, ExportError> {
        self.made.clear();
        self.made_folder = false;
        Ok(std::mem::take(&mut self.summary))
    }
}

impl Drop for SequenceSink {
    fn drop(&mut self) {
        // Best effort: what cannot be removed cannot be reported from here either.
        for path in &self.made {
            std::fs::remove_file(path).ok();
        }
        if self.made_folder {
            std::fs::remove_dir(self.pattern.folder()).ok();
        }
    }
}
