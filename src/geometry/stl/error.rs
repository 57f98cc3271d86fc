//! Reasons why an STL file cannot be used, and limits on its size.

/// Most triangles read from one file: a picture could not resolve more, and they would fill the memory.
pub const MAX_STL_TRIANGLES: usize = 2_000_000;
/// Largest coordinate: pictures are computed in single precision, and squares of lengths must be representable.
pub(super) const LARGEST: f64 = 1e18;

/// Why an STL file could not be used.
#[derive(Debug, thiserror::Error)]
pub enum StlError {
    /// Missing, not readable, a folder.
    #[error("cannot read {path}: {source}")]
    Read {
        /// The file.
        path: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// No triangles at all.
    #[error("{path} contains no triangles")]
    Empty {
        /// The file.
        path: String,
    },
    /// The file ends before the triangles it announces.
    #[error("{path} is truncated or not an STL file: it is too short for its number of triangles")]
    Truncated {
        /// The file.
        path: String,
    },
    /// A folder, a device, a pipe.
    #[error("cannot read {path}: it is not a regular file")]
    NoFile {
        /// The file.
        path: String,
    },
    /// All triangles are points or lines.
    #[error("{path} contains no triangle with an area")]
    Flat {
        /// The file.
        path: String,
    },
    /// More than [`MAX_STL_TRIANGLES`].
    #[error("{path} contains more than {MAX_STL_TRIANGLES} triangles; reduce it first")]
    TooLarge {
        /// The file.
        path: String,
    },
    /// A coordinate that is infinite, not a number, or beyond `LARGEST`.
    #[error(
        "triangle {triangle} of {path} has a corner that is not a finite number, or beyond {LARGEST:e}"
    )]
    NotFinite {
        /// The file.
        path: String,
        /// Its number, from 1.
        triangle: usize,
    },
    /// Neither form of STL.
    #[error("{path} is not an STL file: {detail}")]
    Syntax {
        /// The file.
        path: String,
        /// What the reader says.
        detail: String,
    },
}
