//! The text of a scene: a built-in one by its name, a file by its path, or any reader.

use super::builtin;
use crate::diag::{Source, nearest_name, shown_text};
use std::ffi::OsStr;
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::{Component, Path, PathBuf};
use std::time::Duration;

/// Largest scene that is read: a hundred times the largest hand-written one.
pub const MAX_SCENE_BYTES: u64 = 4 << 20;

/// Why there is no text.
#[derive(Debug, thiserror::Error)]
#[error("{message}")]
pub struct SourceError {
    /// What is wrong.
    pub message: String,
    /// How to mend it.
    pub hints: Vec<String>,
}

impl SourceError {
    fn unreadable(name: &str, why: &dyn std::fmt::Display) -> Self {
        Self {
            message: format!("cannot read {name}: {why}"),
            hints: Vec::new(),
        }
    }
}

/// The text of the built-in scene `name`, or of the file at that path.
///
/// Errors: there is neither; a file that cannot be read, is too large, or is no UTF-8.
pub fn find_source(name: &OsStr) -> Result<Source, SourceError> {
    match name.to_str().and_then(builtin::find_builtin) {
        Some(source) => Ok(source),
        None => open_source(Path::new(name)),
    }
}

/// The text of a file. Errors: likewise.
pub fn open_source(path: &Path) -> Result<Source, SourceError> {
    let name = path.to_string_lossy();
    match open_input(path) {
        Ok(file) => read_source(file, &name),
        Err(error) => Err(missing_source(&name, &error)),
    }
}

/// The text that `reader` gives, called `name` in messages.
///
/// Errors: a failed read, more than [`MAX_SCENE_BYTES`], no UTF-8.
pub fn read_source(reader: impl Read, name: &str) -> Result<Source, SourceError> {
    let mut bytes = Vec::new();
    reader
        .take(MAX_SCENE_BYTES + 1)
        .read_to_end(&mut bytes)
        .map_err(|error| SourceError::unreadable(name, &error))?;
    if bytes.len() as u64 > MAX_SCENE_BYTES {
        let why = format!("a scene has at most {MAX_SCENE_BYTES} bytes");
        return Err(SourceError::unreadable(name, &why));
    }
    let text = String::from_utf8(bytes);
    let text = text.map_err(|_| SourceError::unreadable(name, &"the file is not UTF-8 text"))?;
    Ok(Source {
        name: name.to_owned(),
        text,
    })
}

fn missing_source(name: &str, error: &std::io::Error) -> SourceError {
    let looks_like_path = name.contains(std::path::is_separator) || name.ends_with(".toml");
    if looks_like_path || error.kind() != ErrorKind::NotFound {
        return SourceError::unreadable(name, error);
    }
    let mut error = no_builtin(name);
    if let Some(hint) = error.hints.last_mut() {
        hint.push_str("; or give the path of a .toml file");
    }
    error
}

/// That there is no built-in scene of that name, and which there are.
pub fn no_builtin(name: &str) -> SourceError {
    let names = builtin::ALL.map(|scene| scene.name);
    let mut hints = Vec::new();
    if let Some(near) = nearest_name(name, names) {
        hints.push(format!("did you mean `{near}`?"));
    }
    hints.push(format!("built-in scenes: {}", names.join(", ")));
    SourceError {
        message: format!("there is no scene `{name}`"),
        hints,
    }
}

/// The folder that relative file names in a scene start from.
pub fn folder_of(path: &Path) -> std::path::PathBuf {
    let parent = path.parent();
    parent.map(Path::to_path_buf).unwrap_or_default()
}

/// How long a pipe is waited for that nobody has opened to write into.
const PATIENCE: Duration = Duration::from_secs(5);

/// Opens a file that somebody has named. Of a pipe or a device that does not open the wait ends with an error.
///
/// # Errors
/// What the system says; [`ErrorKind::TimedOut`].
pub fn open_input(path: &Path) -> std::io::Result<File> {
    let about = std::fs::metadata(path)?;
    if about.is_file() || about.is_dir() {
        return File::open(path);
    }
    let (sender, receiver) = std::sync::mpsc::channel();
    let place = path.to_owned();
    // The thread stays behind where nothing comes; it holds nothing else.
    let wait = std::thread::Builder::new();
    wait.spawn(move || drop(sender.send(File::open(place))))?;
    receiver.recv_timeout(PATIENCE).unwrap_or_else(|_| {
        let message = format!("nothing was written to it for {} s", PATIENCE.as_secs());
        Err(std::io::Error::new(ErrorKind::TimedOut, message))
    })
}
/// Where a file that a text names really stands, if it may: below the folder of that text, called `whose`, or below one of
/// `allowed`. What is elsewhere is not even said to exist.
///
/// Errors: where it may stand, in words.
pub fn place_below(
    name: &str,
    (own, whose): (&Path, &str),
    allowed: &[PathBuf],
) -> Result<PathBuf, String> {
    let refused = || {
        let name = shown_text(name);
        format!(
            "{name} is not in or below the {whose} folder; --allow-files DIR lets scenes read other folders"
        )
    };
    let Ok(place) = own.join(name).canonicalize() else {
        let is_inside = |part| matches!(part, Component::Normal(_) | Component::CurDir);
        // Reading it says why it cannot be read.
        return match Path::new(name).components().all(is_inside) {
            true => Ok(own.join(name)),
            false => Err(refused()),
        };
    };
    let here = match own.as_os_str().is_empty() {
        true => Path::new("."),
        false => own,
    };
    let mut folders = [here]
        .into_iter()
        .chain(allowed.iter().map(PathBuf::as_path));
    let is_below = |folder: &Path| folder.canonicalize().is_ok_and(|f| place.starts_with(f));
    match folders.any(is_below) {
        true => Ok(place),
        false => Err(refused()),
    }
}
