//! Reads the files of a study's folder, whoever put them there: regular files of a bounded size.

use std::fs;
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

/// Largest text in the folder, a plan or a lease: a plan holds a command line.
const MOST_TEXT: u64 = 16 << 20;

/// Opens a regular file; a pipe that nobody writes to would be waited for, and a device never ends.
pub(super) fn open_regular(path: &Path) -> Result<fs::File> {
    if fs::metadata(path)?.is_file() {
        return fs::File::open(path);
    }
    Err(Error::new(
        ErrorKind::InvalidInput,
        "it is not a regular file",
    ))
}

/// The text of a regular file.
pub(super) fn read_text(path: &Path) -> Result<String> {
    let mut text = String::new();
    let mut file = open_regular(path)?.take(MOST_TEXT + 1);
    if file.read_to_string(&mut text)? as u64 > MOST_TEXT {
        let message = format!("it has more than {MOST_TEXT} bytes");
        return Err(Error::new(ErrorKind::InvalidData, message));
    }
    Ok(text)
}
