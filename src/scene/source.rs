//! The text of a scene: a built-in one by name, a file by path, or any reader.

use super::builtin;
use crate::diag::{Source, name_hint, shown_text};
use std::ffi::OsStr;
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::{Component, Path, PathBuf};
use std::time::Duration;

/// Largest scene that is read: a hundred times the largest hand-written one.
pub const MAX_SCENE_BYTES: u64 = 4 << 20;

/// Why the text could not be read.
#[derive(Debug, thiserror::Error)]
#[error("{message}")]
pub struct SourceError {
    /// The message.
    pub message: String,
    /// How to fix it.
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
/// Errors: neither exists; the file cannot be read, is too large, or is not UTF-8.
pub fn find_source(name: &OsStr) -> Result<Source, SourceError> {
    match name.to_str().and_then(builtin::find_builtin) {
        Some(source) => Ok(source),
        None => open_source(Path::new(name)),
    }
}

/// The text of a file. Errors: the file cannot be read, is too large, or is not UTF-8.
pub fn open_source(path: &Path) -> Result<Source, SourceError> {
    let name = path.to_string_lossy();
    match open_input(path) {
        Ok(file) => read_source(file, &name),
        Err(error) => Err(missing_source(&name, &error)),
    }
}

/// The text from `reader`, called `name` in messages.
///
/// Errors: a failed read, more than [`MAX_SCENE_BYTES`], not UTF-8.
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
    error.message = format!("there is no scene `{name}`");
    let beside = format!("{name}.toml");
    if Path::new(&beside).is_file() {
        error.hints = vec![format!("did you mean the file `{beside}`?")];
    }
    let files = "`mechanim scenes` lists the built-in scenes; others need the path of a .toml file";
    error.hints.push(files.to_owned());
    error
}

/// The message that there is no built-in scene of that name, with a list of those that exist.
pub fn no_builtin(name: &str) -> SourceError {
    let names = builtin::ALL.map(|scene| scene.name);
    SourceError {
        message: format!("there is no built-in scene `{name}`"),
        hints: vec![name_hint(name, names)],
    }
}

/// The folder to which relative file names in a scene refer.
pub fn folder_of(path: &Path) -> std::path::PathBuf {
    let parent = path.parent();
    parent.map(Path::to_path_buf).unwrap_or_default()
}

/// How long to wait for a pipe that nobody has opened for writing.
const PATIENCE: Duration = Duration::from_secs(5);

/// Opens a file that the user has named. If a pipe or a device does not open, waiting ends with an error.
///
/// # Errors
/// The error of the system; [`ErrorKind::TimedOut`].
pub fn open_input(path: &Path) -> std::io::Result<File> {
    let about = std::fs::metadata(path)?;
    if about.is_file() || about.is_dir() {
        return File::open(path);
    }
    let (sender, receiver) = std::sync::mpsc::channel();
    let place = path.to_owned();
    // If no data arrive, the thread remains; it owns nothing else.
    let wait = std::thread::Builder::new();
    wait.spawn(move || drop(sender.send(File::open(place))))?;
    receiver.recv_timeout(PATIENCE).unwrap_or_else(|_| {
        let message = format!("nothing was written to it for {} s", PATIENCE.as_secs());
        Err(std::io::Error::new(ErrorKind::TimedOut, message))
    })
}
/// The real path of a file named in a text, if it is allowed: below the folder of that text, called `whose`, or below
/// one of `allowed`. The message does not reveal whether a file exists elsewhere.
///
/// Errors: a text that says which folders are allowed.
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
        // Reading it reports why it cannot be read.
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
