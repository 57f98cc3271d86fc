//! Errors of a study's folder.

use crate::export::ExportError;
use std::io;
use std::path::{Path, PathBuf};

/// Why a study cannot be planned, run or merged.
#[derive(Debug, thiserror::Error)]
pub enum PartsError {
    /// The folder contains no study.
    #[error("{} is not a study: it has no plan.json", .0.display())]
    NoStudy(PathBuf),
    /// The path already exists.
    #[error("{} exists already", .0.display())]
    Exists(PathBuf),
    /// The plan is invalid.
    #[error("{}: {why}", .path.display())]
    BadPlan {
        /// The plan.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
    },
    /// The study was planned by another program, or its files have changed since.
    #[error("{}: {why}", .path.display())]
    Foreign {
        /// The file that does not belong here.
        path: PathBuf,
        /// The reason.
        why: String,
    },
    /// A file or folder could not be read or created.
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
    /// The parts cannot be merged; one line for every reason.
    #[error("{}", .0.join("\n"))]
    Faulty(Vec<String>),
}

impl PartsError {
    /// The system's message about a path.
    pub(super) fn io(path: &Path, source: io::Error) -> Self {
        Self::Io {
            path: path.to_owned(),
            source,
        }
    }
}
