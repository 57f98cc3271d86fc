//! The destination of a file: the target of its links, its folder, whether it is an ordinary file or a folder of files.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Maximum number of links that lead to each other.
const MOST_LINKS: usize = 40;

/// The target of a path when its links are followed, whether it exists or not; an open file of a process, which looks
/// like a link, is a target.
///
/// Errors: the links form a cycle.
pub fn link_end(path: &Path) -> io::Result<PathBuf> {
    let mut place = path.to_owned();
    for _ in 0..MOST_LINKS {
        if is_descriptor(&place) {
            return Ok(place);
        }
        match fs::read_link(&place) {
            // A relative link is resolved from its own folder.
            Ok(next) => place = folder_of(&place).join(next),
            Err(_) => return Ok(place),
        }
    }
    Err(io::Error::other("its symbolic links lead in a circle"))
}

/// Whether a path is an open file of a process (`/dev/fd/3`, `/proc/self/fd/3`). What it seems to link to need not be a
/// path, and a file that is put in the place of one loses what others have written to it.
pub fn is_descriptor(path: &Path) -> bool {
    let name = path.file_name().and_then(|name| name.to_str());
    let is_number = name.is_some_and(|name| name.parse::<u32>().is_ok());
    let is_list = |folder: PathBuf| folder.starts_with("/proc") && folder.ends_with("fd");
    is_number && folder_of(path).canonicalize().is_ok_and(is_list)
}

/// Opens a file that is not an ordinary one; an open file is appended to.
pub fn open_directly(place: &Path) -> io::Result<fs::File> {
    let mut options = fs::OpenOptions::new();
    match is_descriptor(place) {
        true => options.append(true),
        false => options.write(true),
    };
    options.open(place)
}

/// Whether files belong into `path`: a folder that exists, or any path that ends with a separator.
pub fn names_folder(path: &Path) -> bool {
    path.is_dir() || path.to_string_lossy().ends_with(std::path::is_separator)
}

/// The folder that holds `path`: `.` for a bare name.
pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}
