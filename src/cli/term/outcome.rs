//! The outcome of a command, and its exit code.

use crate::diag::{SceneError, name_hint};
use crate::export::{ExportError, finished_count};
use crate::import::ImportError;
use crate::kinematics::structure::block::StructureError;
use crate::limits::LimitExceeded;
use crate::parts::PartsError;
use crate::render::RenderError;
use crate::report::verdict::Status;
use crate::scene::source::SourceError;
use std::path::Path;

/// Done.
pub const DONE: i32 = 0;
/// A check failed, or a requested proof failed; a motion was abandoned undecided, or no pose was found.
pub const CHECK_FAILED: i32 = 1;
/// Bad usage, bad scene, or a file that cannot be read or written.
pub const BAD_USAGE: i32 = 2;
/// No usable graphics adapter.
pub const NO_ADAPTER: i32 = 3;
/// Some instants provably have no pose, or the motion ends at a fold.
pub const NOT_CLOSED: i32 = 4;
/// An internal error.
pub const INTERNAL: i32 = 70;
/// Stopped by the user.
pub const INTERRUPTED: i32 = 130;

/// A command that ran to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Success.
    Done,
    /// A check failed, or a requested proof failed.
    CheckFailed,
    /// Results were written, but some instants have no pose.
    NotClosed,
    /// Results were written, but the motion was abandoned where poses may exist.
    Undecided,
}

impl From<Status> for Outcome {
    fn from(status: Status) -> Self {
        match status {
            Status::Skipped | Status::Passed => Self::Done,
            // A scene that cannot be checked comes with a [`Failure`], whose exit code is its own.
            Status::Failed | Status::NotProved | Status::Unreadable => Self::CheckFailed,
            Status::NotClosed => Self::NotClosed,
        }
    }
}

impl Outcome {
    /// The worse of two: not closed before failed, failed before done.
    pub fn worse(self, other: Self) -> Self {
        let rank = |outcome: Self| match outcome {
            Self::Done => 0,
            Self::Undecided => 1,
            Self::CheckFailed => 2,
            Self::NotClosed => 3,
        };
        match rank(other) > rank(self) {
            true => other,
            false => self,
        }
    }

    /// Its exit code.
    pub const fn code(self) -> i32 {
        match self {
            Self::Done => DONE,
            Self::CheckFailed | Self::Undecided => CHECK_FAILED,
            Self::NotClosed => NOT_CLOSED,
        }
    }
}

/// Why a command could not run to its end.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The scene has mistakes.
    #[error(transparent)]
    Scene(#[from] Box<SceneError>),
    /// The command line, a table or a file does not fit what was requested.
    #[error("{message}")]
    Usage {
        /// What is wrong.
        message: String,
        /// A suggested remedy.
        hints: Vec<String>,
    },
    /// The mechanism is ill-posed.
    #[error(transparent)]
    Structure(#[from] StructureError),
    /// There is no pose at all.
    #[error("{message}")]
    NeverClosed {
        /// The loop, its gap, and the inputs.
        message: String,
        /// A suggested remedy.
        hints: Vec<String>,
    },
    /// No pose was found, but it is not proved that none exists.
    #[error("{message}")]
    Undecided {
        /// The loop, its gap, and the inputs.
        message: String,
        /// A suggested remedy.
        hints: Vec<String>,
    },
    /// A file could not be made.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// A picture could not be read.
    #[error(transparent)]
    Import(#[from] ImportError),
    /// The command needs more than the limits allow.
    #[error(transparent)]
    Limit(#[from] LimitExceeded),
    /// A picture could not be made.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The folder of a study is invalid.
    #[error(transparent)]
    Parts(#[from] PartsError),
    /// Standard output failed.
    #[error("cannot write to standard output: {0}")]
    Stdout(#[from] std::io::Error),
    /// Stopped by Ctrl-C.
    #[error("interrupted; {}", written_by_now())]
    Interrupted,
    /// Stopped by Ctrl-C; the results so far were kept.
    #[error("interrupted; {0}")]
    Stopped(String),
    /// An internal error.
    #[error("internal error: {0}")]
    Internal(String),
}

/// What an interrupted run has saved.
fn written_by_now() -> &'static str {
    match finished_count() {
        0 => "nothing was written",
        1 => "one file that was complete before is kept",
        _ => "files that were complete before are kept",
    }
}

impl From<SourceError> for Failure {
    fn from(error: SourceError) -> Self {
        Self::usage(error.message, error.hints)
    }
}

impl Failure {
    /// Why, in one line of text: of a scene its mistakes.
    pub fn told(&self) -> String {
        match self {
            Self::Scene(error) => error.told(),
            other => other.to_string(),
        }
    }

    /// Line of the scene that it is about, if it is about one.
    pub fn line(&self) -> Option<usize> {
        match self {
            Self::Scene(error) => error.line(),
            _ => None,
        }
    }

    /// There is no pose: proved, or none was found.
    pub fn without_pose(is_undecided: bool, message: String, hints: Vec<String>) -> Self {
        match is_undecided {
            true => Self::Undecided { message, hints },
            false => Self::NeverClosed { message, hints },
        }
    }

    /// A usage error with hints.
    pub fn usage(message: impl Into<String>, hints: Vec<String>) -> Self {
        Self::Usage {
            message: message.into(),
            hints,
        }
    }

    /// The scene has nothing of that name.
    pub fn unknown_name<'a>(
        what: &str,
        name: &str,
        known: impl IntoIterator<Item = &'a str>,
    ) -> Self {
        let message = format!("the scene has no {what} `{name}`");
        Self::usage(message, vec![name_hint(name, known)])
    }

    /// A search was stopped; `out` is the file that has its best result.
    pub fn best_so_far(out: Option<&Path>) -> Self {
        Self::Stopped(match out {
            None => "the best result so far was reported".to_owned(),
            Some(out) => format!("the best result so far was written to {}", out.display()),
        })
    }

    /// The extension of an output is not one that the command writes.
    pub fn unknown_kind(path: &Path, what: &str, known: &str) -> Self {
        let message = format!("{}: unknown kind of {what}", path.display());
        Self::usage(message, vec![known.to_owned()])
    }

    /// The scene requests no clearances.
    pub fn without_clearance(message: impl Into<String>) -> Self {
        let hint = "add a section: [clearance] with minimum = 0.5";
        Self::usage(message, vec![hint.to_owned()])
    }

    /// Its exit code.
    pub fn code(&self) -> i32 {
        match self {
            _ if self.is_broken_pipe() => DONE,
            Self::Undecided { .. } | Self::Parts(PartsError::Faulty(_)) => CHECK_FAILED,
            Self::Parts(_) => BAD_USAGE,
            Self::Scene(_) | Self::Usage { .. } | Self::Export(_) => BAD_USAGE,
            Self::Import(_) | Self::Stdout(_) | Self::Limit(_) => BAD_USAGE,
            Self::Structure(
                StructureError::UnderDetermined { .. }
                | StructureError::Unheld { .. }
                | StructureError::Limit(_),
            ) => BAD_USAGE,
            Self::Structure(StructureError::Impossible { .. }) | Self::NeverClosed { .. } => {
                NOT_CLOSED
            }
            Self::Render(RenderError::NoAdapter(_)) => NO_ADAPTER,
            Self::Render(RenderError::Size(_) | RenderError::Limit(_)) => BAD_USAGE,
            Self::Render(RenderError::Device(_)) => NO_ADAPTER,
            Self::Interrupted | Self::Stopped(_) => INTERRUPTED,
            Self::Internal(_) => INTERNAL,
        }
    }

    /// Whether the reader of standard output has closed it: the command ends silently.
    pub fn is_broken_pipe(&self) -> bool {
        match self {
            Self::Stdout(error) => error.kind() == std::io::ErrorKind::BrokenPipe,
            Self::Export(error) | Self::Parts(PartsError::Export(error)) => error.is_broken_pipe(),
            _ => false,
        }
    }
}
