//! PNG: one still picture, or one file a frame. RGB, or RGBA where the frames are translucent.

use super::error::ExportError;
use super::format::FramePattern;
use super::target::{
    Output, PendingFile, finish_registered, register_unfinished, temporary_folder,
};
use super::{ExportSummary, FrameCoder, FrameSink};
use ::png::{
    BitDepth, ColorType, Compression, Encoder, EncodingError, Filter, PixelDimensions,
    SrgbRenderingIntent, Unit,
};
use image::RgbaImage;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Maximum side: PNG allows 2^31 - 1, memory does not.
pub(super) const LONGEST_SIDE: u32 = 1 << 16;

/// Metres of an inch.
const INCH: f64 = 0.0254;

/// Effort spent on a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// For sequences: about 1.3 ms for 640x480 pixels, a fifth larger.
    Fast,
    /// For a single still.
    Balanced,
    /// The smallest file, at two to three times the time of `Balanced`.
    Small,
}

/// Size and coding of PNG pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct PngSettings {
    /// Size in pixels.
    pub size: [u32; 2],
    /// Compression effort.
    pub effort: Effort,
    /// Whether the frames' alpha is kept.
    pub alpha: bool,
    /// Pixels of an inch on paper, as the file says.
    pub dpi: Option<f64>,
    /// Texts in the file, each with its keyword: Title, Software, Source, Comment.
    pub texts: Vec<(String, String)>,
}

/// Appends `image` as an RGB PNG file to `out`. The same image gives the same bytes.
///
/// Errors: a side of 0 or too long.
pub fn encode_png(image: &RgbaImage, effort: Effort, out: &mut Vec<u8>) -> Result<(), ExportError> {
    let settings = PngSettings {
        size: [image.width(), image.height()],
        effort,
        alpha: false,
        dpi: None,
        texts: Vec::new(),
    };
    encode_picture(image, &settings, out)
}

/// The same with settings, whose size is that of the image.
///
/// Errors: a side of 0 or too long.
pub fn encode_picture(
    image: &RgbaImage,
    settings: &PngSettings,
    out: &mut Vec<u8>,
) -> Result<(), ExportError> {
    if settings.alpha {
        return encode_bytes(image.as_raw(), settings, out);
    }
    let mut rgb = Vec::new();
    drop_alpha(image.as_raw(), &mut rgb);
    encode_bytes(&rgb, settings, out)
}

/// Appends the colours of RGBA pixels to `rgb`.
pub(super) fn drop_alpha(rgba: &[u8], rgb: &mut Vec<u8>) {
    rgb.reserve(rgba.len() / 4 * 3);
    rgb.extend(rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]));
}

/// Filters worth trying. Pictures of flat surfaces and text pack a sixth better without one, photographs far better
/// with one chosen row by row.
fn filter_types(effort: Effort) -> &'static [Filter] {
    match effort {
        Effort::Fast => &[Filter::Adaptive],
        Effort::Balanced | Effort::Small => &[Filter::NoFilter, Filter::Adaptive],
    }
}

/// Appends the smallest file that the effort finds.
fn encode_bytes(
    bytes: &[u8],
    settings: &PngSettings,
    out: &mut Vec<u8>,
) -> Result<(), ExportError> {
    check_size(settings.size)?;
    if let [only] = filter_types(settings.effort) {
        return encode_with(*only, bytes, settings, out);
    }
    let (_, file) = smallest_encoding(bytes, settings)?;
    out.extend_from_slice(&file);
    Ok(())
}

/// The filter that makes the smallest file, and the file.
pub(super) fn smallest_encoding(
    bytes: &[u8],
    settings: &PngSettings,
) -> Result<(Filter, Vec<u8>), ExportError> {
    let mut best = (Filter::Adaptive, Vec::new());
    for filter in filter_types(settings.effort) {
        let mut file = Vec::new();
        encode_with(*filter, bytes, settings, &mut file)?;
        if best.1.is_empty() || file.len() < best.1.len() {
            best = (*filter, file);
        }
    }
    Ok(best)
}

fn encode_with(
    filter: Filter,
    bytes: &[u8],
    settings: &PngSettings,
    out: &mut Vec<u8>,
) -> Result<(), ExportError> {
    let encoder = encoder_of(out, settings, filter)?;
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(bytes)?;
        writer.finish()
    });
    written.map_err(encoding_error)
}

/// The encoder of a picture: its colours are sRGB, and its size on paper is known if the settings say so.
///
/// Errors: a keyword that PNG does not allow.
pub(super) fn encoder_of<W: Write>(
    out: W,
    settings: &PngSettings,
    filter: Filter,
) -> Result<Encoder<'static, W>, ExportError> {
    let mut encoder = Encoder::new(out, settings.size[0], settings.size[1]);
    encoder.set_color(match settings.alpha {
        true => ColorType::Rgba,
        false => ColorType::Rgb,
    });
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(match settings.effort {
        Effort::Fast => Compression::Fast,
        Effort::Balanced => Compression::Balanced,
        Effort::Small => Compression::High,
    });
    encoder.set_filter(filter);
    encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    encoder.set_pixel_dims(settings.dpi.map(|dpi| {
        let of_metre = (dpi / INCH).round() as u32;
        PixelDimensions {
            xppu: of_metre,
            yppu: of_metre,
            unit: Unit::Meter,
        }
    }));
    for (keyword, text) in &settings.texts {
        let added = encoder.add_itxt_chunk(keyword.clone(), text.clone());
        added.map_err(encoding_error)?;
    }
    Ok(encoder)
}

pub(super) fn encoding_error(error: EncodingError) -> ExportError {
    ExportError::Encode {
        name: "PNG".to_owned(),
        message: error.to_string(),
    }
}

pub(super) fn check_size([width, height]: [u32; 2]) -> Result<(), ExportError> {
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
    settings: PngSettings,
    rgb: Vec<u8>,
}

impl PngCoder {
    fn boxed_coder(settings: PngSettings) -> Box<dyn FrameCoder> {
        let rgb = Vec::new();
        Box::new(Self { settings, rgb })
    }
}

impl FrameCoder for PngCoder {
    fn code(&mut self, frame: &RgbaImage, coded: &mut Vec<u8>) -> Result<(), ExportError> {
        super::check_frame(frame, self.settings.size)?;
        coded.clear();
        if self.settings.alpha {
            return encode_bytes(frame.as_raw(), &self.settings, coded);
        }
        self.rgb.clear();
        drop_alpha(frame.as_raw(), &mut self.rgb);
        encode_bytes(&self.rgb, &self.settings, coded)
    }
}

/// One picture.
pub struct StillSink {
    output: Box<dyn Output>,
    settings: PngSettings,
    summary: ExportSummary,
}

impl StillSink {
    /// A sink that takes exactly one frame.
    ///
    /// Errors: a side of 0 or too long.
    pub fn new(output: Box<dyn Output>, settings: PngSettings) -> Result<Self, ExportError> {
        check_size(settings.size)?;
        Ok(Self {
            output,
            settings,
            summary: ExportSummary::default(),
        })
    }
}

impl FrameSink for StillSink {
    fn size(&self) -> [u32; 2] {
        self.settings.size
    }

    fn coder(&self) -> Box<dyn FrameCoder> {
        PngCoder::boxed_coder(self.settings.clone())
    }

    fn write(&mut self, _index: usize, coded: &[u8]) -> Result<(), ExportError> {
        self.summary.frames += 1;
        if self.summary.frames > 1 {
            return Err(still_needs_one(self.summary.frames));
        }
        self.summary.bytes = coded.len() as u64;
        self.output.emit(coded)
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

/// One file per frame. Files that replace older ones wait until all are complete. Dropped before `finish`, it removes
/// the files it made and the folder, and leaves the older ones unchanged.
pub struct SequenceSink {
    pattern: FramePattern,
    settings: PngSettings,
    made: Vec<PathBuf>,
    made_folder: bool,
    waiting: Option<WaitingFrames>,
    summary: ExportSummary,
}

/// Complete frames in a hidden folder, each with the place that it is to have.
struct WaitingFrames {
    folder: tempfile::TempDir,
    /// Locked while files wait in it.
    _lock: Option<std::fs::File>,
    list: Vec<(PathBuf, PathBuf)>,
}

impl SequenceSink {
    /// Prepares the folder: it is made if its parent exists.
    ///
    /// Errors: a side of 0 or too long, no folder to make it in, a file in its place.
    pub fn new(pattern: FramePattern, settings: PngSettings) -> Result<Self, ExportError> {
        check_size(settings.size)?;
        let folder = pattern.folder().to_owned();
        let made_folder = !folder.is_dir();
        if made_folder {
            let parent = super::place::folder_of(&folder);
            if !parent.exists() {
                return Err(ExportError::MissingFolder {
                    path: folder.clone(),
                    folder: parent.to_owned(),
                });
            }
            match std::fs::create_dir(&folder) {
                // Another run was faster.
                Err(e) if e.kind() == std::io::ErrorKind::AlreadyExists && folder.is_dir() => {}
                made => made.map_err(|e| ExportError::create(&folder, e))?,
            }
            register_unfinished(&folder);
        }
        Ok(Self {
            pattern,
            settings,
            made: Vec::new(),
            made_folder,
            waiting: None,
            summary: ExportSummary::default(),
        })
    }

    /// Defers a frame that is to replace an older one.
    fn stage(&mut self, path: &Path, target: PendingFile) -> Result<(), ExportError> {
        let waiting = match &mut self.waiting {
            Some(waiting) => waiting,
            none => {
                let made = temporary_folder(self.pattern.folder());
                let (folder, _lock) = made.map_err(|e| ExportError::create(path, e))?;
                none.insert(WaitingFrames {
                    folder,
                    _lock,
                    list: Vec::new(),
                })
            }
        };
        let here = waiting.folder.path().join(waiting.list.len().to_string());
        if let Some(place) = target.wait_at(&here)? {
            waiting.list.push((here, place));
        }
        Ok(())
    }
}

impl FrameSink for SequenceSink {
    fn size(&self) -> [u32; 2] {
        self.settings.size
    }

    fn coder(&self) -> Box<dyn FrameCoder> {
        PngCoder::boxed_coder(self.settings.clone())
    }

    fn write(&mut self, index: usize, coded: &[u8]) -> Result<(), ExportError> {
        let path = self.pattern.path(index);
        let is_new = std::fs::symlink_metadata(&path).is_err();
        let mut target = PendingFile::create(&path)?;
        target.emit(coded)?;
        if is_new {
            target.commit_unsynced()?;
            register_unfinished(&path);
            self.made.push(path);
        } else {
            self.stage(&path, target)?;
        }
        self.summary.frames += 1;
        self.summary.bytes += coded.len() as u64;
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> Result<ExportSummary, ExportError> {
        let mut entered = std::mem::take(&mut self.made);
        entered.push(self.pattern.folder().to_owned());
        if let Some(waiting) = self.waiting.take() {
            entered.push(waiting.folder.path().to_owned());
            for (here, place) in waiting.list {
                let name = place.display().to_string();
                std::fs::rename(&here, place).map_err(|e| ExportError::write(&name, e))?;
                entered.push(here);
            }
        }
        finish_registered(&entered);
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
