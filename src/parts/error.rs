//! Errors of a study's folder.

use crate::export::ExportError;
use std::io;
use std::path::{Path, PathBuf};

/// Why a study cannot be planned, run or put together.
#[derive(Debug, thiserror::Error)]
pub enum PartsError {
    /// The folder holds no study.
    #[error("{} is not a study: it has no plan.json", .0.display())]
    NoStudy(PathBuf),
    /// There is something already.
    #[error("{} exists already", .0.display())]
    Exists(PathBuf),
    /// The plan is no plan.
    #[error("{}: {why}", .path.display())]
    BadPlan {
        /// The plan.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
    },
    /// The study was planned by another program, or its files are others by now.
    #[error("{}: {why}", .path.display())]
    Foreign {
        /// What does not belong here.
        path: PathBuf,
        /// Why.
        why: String,
    },
    /// A file or folder could not be read or made.
    #[error("{}: {source}", .path.display())]
    Io {
        /// Where.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A file could not be written.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// What is there cannot be put together; a line for every reason.
    #[error("{}", .0.join("\n"))]
    Faulty(Vec<String>),
}

impl PartsError {
    /// What the system said about a place.
    pub(super) fn io(path: &Path, source: io::Error) -> Self {
        Self::Io {
            path: path.to_owned(),
            source,
        }
    }
}
