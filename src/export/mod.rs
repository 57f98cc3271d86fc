//! Files from frames and models. Independent of mechanisms; the only room with image encoders.
//!
//! How a caller that can draw any frame by its index writes a file:
//!
//! 1. [`Format::from_path`] determines the kind of file.
//! 2. [`film::FilmSettings::open`] opens its sink. For a GIF it draws some frames on all cores and builds the palette
//!    from them; these frames are kept and not drawn again.
//! 3. [`film::FilmSettings::write`] draws, encodes and writes all frames, in order and in bounded memory. A file appears on
//!    disk only if this succeeds.

use image::RgbaImage;

pub mod apng;
mod changed_area;
mod colour_histogram;
pub mod error;
pub mod film;
pub mod format;
pub mod frame_pipeline;
pub mod gif;
pub mod glb;
mod glb_buffer;
mod kmeans;
pub mod model;
mod nearest_colour;
pub mod palette;
#[cfg(feature = "parquet")]
pub mod parquet;
pub mod place;
pub mod png;
pub mod png_indexed;
pub mod png_rows;
pub mod png_strips;
pub mod raw;
pub mod sampled_frames;
pub mod solid;
mod spool;
pub mod target;
pub mod timing;
pub mod video;

pub use error::ExportError;
pub use format::Format;
pub use place::{folder_of, link_end, names_folder};
pub use target::{Output, PendingFile, Stream, finished_count, remove_unfinished};

/// What was written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExportSummary {
    /// Frames handed over.
    pub frames: usize,
    /// Bytes written over all files.
    pub bytes: u64,
    /// Duration of the animation in seconds according to the file; 0 if the format has no time.
    pub seconds: f64,
}

/// Receives the frames of one file or one sequence, in order.
///
/// A frame is processed in two steps: a coder handles one frame independently, on many threads; `write` receives the
/// results of frames 0, 1, 2 … on one thread.
pub trait FrameSink: Send {
    /// Size every frame must have, in pixels.
    fn size(&self) -> [u32; 2];

    /// A coder for one worker thread. All coders of a sink make the same of the same frame.
    fn coder(&self) -> Box<dyn FrameCoder>;

    /// Writes what a coder made of frame `index`; called for 0, 1, 2 …
    fn write(&mut self, index: usize, coded: &[u8]) -> Result<(), ExportError>;

    /// Completes the file. A sink dropped without this leaves nothing behind.
    fn finish(self: Box<Self>) -> Result<ExportSummary, ExportError>;
}

/// The part of a sink that runs on worker threads, with its own scratch memory.
pub trait FrameCoder: Send {
    /// Reduces a frame to the sink's own form, replacing the contents of `coded`.
    ///
    /// Errors: a frame of another size than announced.
    fn code(&mut self, frame: &RgbaImage, coded: &mut Vec<u8>) -> Result<(), ExportError>;
}

/// The error for a frame that is not `expected` pixels wide and high.
fn check_frame(frame: &RgbaImage, expected: [u32; 2]) -> Result<(), ExportError> {
    let got = [frame.width(), frame.height()];
    if got == expected {
        return Ok(());
    }
    Err(ExportError::FrameSize { expected, got })
}
