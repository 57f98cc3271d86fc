//! The errors between a drawn frame and a finished file, each with the path and the cause.

use std::io;
use std::path::{Path, PathBuf};

/// Why a file could not be made.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The folder that should hold the file is not there.
    #[error("cannot write {}: the folder {} does not exist", .path.display(), .folder.display())]
    MissingFolder {
        /// The file asked for.
        path: PathBuf,
        /// The folder that is missing.
        folder: PathBuf,
    },
    /// The target is a folder.
    #[error("cannot write {}: it is a folder", .0.display())]
    IsFolder(PathBuf),
    /// The file exists and is marked read-only.
    #[error("cannot write {}: the file is read-only", .0.display())]
    ReadOnly(PathBuf),
    /// The file could not be created.
    #[error("cannot write {}: {source}", .path.display())]
    Create {
        /// The file asked for.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A write, flush or rename failed after the file was created (disk full, broken pipe).
    #[error("writing {name} failed: {source}")]
    Write {
        /// The requested file, or `standard output`.
        name: String,
        /// What the system said.
        source: io::Error,
    },
    /// The path does not determine the format.
    #[error("{}: {reason}; known are .gif, .png, .apng, .mp4, .webm, .webp, .y4m, .rgba, .glb, .stl, .obj, and a folder or a pattern such as frame-%04d.png for single frames", .path.display())]
    UnknownFormat {
        /// The path asked for.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// Videos are written by another program, which cannot be run.
    #[error("cannot write {}: the program {program} writes such files, and it does not run ({source}); install it, or write a .gif, .apng or .y4m", .path.display())]
    NoEncoder {
        /// The file asked for.
        path: PathBuf,
        /// The program's name.
        program: &'static str,
        /// What the system said.
        source: io::Error,
    },
    /// A video must be an ordinary file, because its encoder seeks in it.
    #[error("cannot write {}: a video needs an ordinary file; a .y4m goes through pipes", .0.display())]
    NoSeek(PathBuf),
    /// The format contains shapes, not pictures.
    #[error("{format} contains no pixels")]
    NoPixels {
        /// Name of the format.
        format: &'static str,
    },
    /// The format cannot hold pictures of this size.
    #[error(
        "a {format} picture of {width}x{height} pixels is not possible: each side must be 1 to {limit}"
    )]
    Size {
        /// Name of the format.
        format: &'static str,
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
        /// Greatest side.
        limit: u32,
    },
    /// A frame does not have the size that was announced.
    #[error("a frame has {}x{} pixels where {}x{} were announced", .got[0], .got[1], .expected[0], .expected[1])]
    FrameSize {
        /// Size announced at the start.
        expected: [u32; 2],
        /// Size of the frame.
        got: [u32; 2],
    },
    /// There is no frame, or a still got more than one.
    #[error("{format} needs {needed}, got {got} frames")]
    FrameCount {
        /// Name of the format.
        format: &'static str,
        /// How many frames it takes.
        needed: &'static str,
        /// How many there were.
        got: usize,
    },
    /// A model without a surface.
    #[error("there is nothing to write: {format} needs a body with a solid")]
    NoTriangles {
        /// Name of the format.
        format: &'static str,
    },
    /// Frame times that are not finite numbers in rising order.
    #[error("the time of frame {frame} is not a finite number after the one before")]
    Times {
        /// Index of the offending frame.
        frame: usize,
    },
    /// The picture encoder refused; the text is its own.
    #[error("{name}: {message}")]
    Encode {
        /// The file asked for.
        name: String,
        /// What the encoder said.
        message: String,
    },
}

impl ExportError {
    /// A failed write to the output `name`.
    pub fn write(name: &str, source: io::Error) -> Self {
        Self::Write {
            name: name.to_owned(),
            source,
        }
    }

    /// Translates the failure to create `path` into its cause.
    pub(crate) fn create(path: &Path, source: io::Error) -> Self {
        Self::Create {
            path: path.to_owned(),
            source,
        }
    }

    /// Whether the reader of the output has closed it, which a command-line program ignores silently.
    pub fn is_broken_pipe(&self) -> bool {
        matches!(self, Self::Write { source, .. } if source.kind() == io::ErrorKind::BrokenPipe)
    }
}

/// Why no file came out.
#[derive(Debug, thiserror::Error)]
pub enum PipelineError<E: std::error::Error + 'static> {
    /// A frame could not be drawn.
    #[error("frame {frame}: {source}")]
    Draw {
        /// Its index.
        frame: usize,
        /// The worker's error.
        source: E,
    },
    /// The file could not be made.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// The cancel flag was raised.
    #[error("cancelled")]
    Cancelled,
    /// There are no workers.
    #[error("no worker was given to draw the frames")]
    NoWorkers,
}
