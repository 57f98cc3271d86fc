//! Destination of bytes: a file that appears only when complete, or a stream. Knows no format.

use super::error::ExportError;
use super::place::{folder_of, is_descriptor, link_end, open_directly};
use std::collections::HashSet;
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::Child;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::time::Duration;

/// Temporary files that have not been moved to their places.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// External programs that write unfinished files.
static WRITERS: Mutex<Vec<Weak<Mutex<Child>>>> = Mutex::new(Vec::new());

/// Registers a program that [`remove_unfinished`] ends, as long as `writer` exists.
pub(super) fn register_writer(writer: &Arc<Mutex<Child>>) {
    let mut writers = WRITERS.lock().unwrap_or_else(PoisonError::into_inner);
    writers.retain(|known| known.strong_count() > 0);
    writers.push(Arc::downgrade(writer));
}

/// Removes the temporary files of all targets, and ends the programs that write some, for a process that ends without dropping
/// them.
pub fn remove_unfinished() {
    let writers = WRITERS.lock().unwrap_or_else(PoisonError::into_inner);
    for writer in writers.iter().filter_map(Weak::upgrade) {
        // A program that has ended is already gone.
        let _ = writer.lock().unwrap_or_else(PoisonError::into_inner).kill();
    }
    // Folders were registered before their contents.
    for path in list_of_unfinished().drain(..).rev() {
        // A dropped target has already removed its file.
        let _ = if path.is_dir() {
            fs::remove_dir(path)
        } else {
            fs::remove_file(path)
        };
    }
}

/// Number of files, or sequences of files, that are complete and in their places.
static FINISHED: AtomicUsize = AtomicUsize::new(0);

/// How many files, or sequences of them, this process has finished by now.
pub fn finished_count() -> usize {
    FINISHED.load(Ordering::Relaxed)
}

/// Registers a file or folder to be removed, too, until it is part of something finished.
pub(crate) fn register_unfinished(path: &Path) {
    list_of_unfinished().push(path.to_owned());
}

/// Removes a registered file from the list and counts one more finished file.
pub(crate) fn finish_registered(paths: &[PathBuf]) {
    unregister_unfinished(paths);
    FINISHED.fetch_add(1, Ordering::Relaxed);
}

fn unregister_unfinished(paths: &[PathBuf]) {
    let finished: HashSet<&PathBuf> = paths.iter().collect();
    list_of_unfinished().retain(|path| !finished.contains(path));
}

fn list_of_unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Bytes between two system calls; frames are tens of kilobytes.
const BUFFER_BYTES: usize = 1 << 16;

/// A destination that takes effect as a whole: without `commit` it leaves nothing behind (as far as the destination
/// permits; a pipe cannot take bytes back).
pub trait Output: Write + Send {
    /// Name for messages.
    fn name(&self) -> &str;

    /// Writes all of `bytes`. Errors: the destination accepts no more.
    fn emit(&mut self, bytes: &[u8]) -> Result<(), ExportError> {
        let written = self.write_all(bytes);
        written.map_err(|source| ExportError::write(self.name(), source))
    }

    /// Makes what was written final. An error means nothing was replaced.
    fn commit(self: Box<Self>) -> Result<(), ExportError>;
}

/// An unfinished file next to its final place.
pub struct PendingFile {
    name: String,
    path: PathBuf,
    body: FileBody,
}

enum FileBody {
    /// An ordinary file: temporary until the rename.
    Atomic(BufWriter<fs::File>, tempfile::TempPath),
    /// A device or a pipe: renaming a file over `/dev/null` would replace the device.
    Direct(BufWriter<fs::File>),
}

impl PendingFile {
    /// Starts a file at `path`. Its folder must exist; a symbolic link is followed, also to what is not there yet; a device,
    /// a pipe or an open file of a process (`/dev/stdout`) is written directly. Mode and owner of a file that is replaced are
    /// kept, the owner where the system lets them be.
    pub fn create(path: &Path) -> Result<Self, ExportError> {
        let name = path.display().to_string();
        let place = link_end(path).map_err(|e| ExportError::create(path, e))?;
        let existing = match fs::metadata(&place) {
            // Checked now, not after the work.
            Err(e) if e.kind() == io::ErrorKind::InvalidFilename => {
                return Err(ExportError::create(path, e));
            }
            other => other.ok(),
        };
        if existing.as_ref().is_some_and(fs::Metadata::is_dir) {
            return Err(ExportError::IsFolder(path.to_owned()));
        }
        if is_descriptor(&place) || existing.as_ref().is_some_and(|m| !m.is_file()) {
            let file = open_directly(&place).map_err(|e| ExportError::create(path, e))?;
            let body = FileBody::Direct(BufWriter::with_capacity(BUFFER_BYTES, file));
            return Ok(Self {
                name,
                path: path.to_owned(),
                body,
            });
        }
        if existing
            .as_ref()
            .is_some_and(|m| m.permissions().readonly())
        {
            return Err(ExportError::ReadOnly(path.to_owned()));
        }
        let refused = |e| explain_error(path, &place, e);
        let (file, temporary) = temporary_beside(&place).map_err(refused)?.into_parts();
        if let Some(old) = &existing {
            copy_mode_and_owner(old, &file, folder_of(&place)).map_err(refused)?;
        }
        register_unfinished(&temporary);
        Ok(Self {
            name,
            path: place,
            body: FileBody::Atomic(BufWriter::with_capacity(BUFFER_BYTES, file), temporary),
        })
    }

    /// Path of the temporary file, for a program that writes it; `None` for a device or a pipe.
    pub(super) fn temporary(&self) -> Option<&Path> {
        match &self.body {
            FileBody::Atomic(_, temporary) => Some(temporary),
            FileBody::Direct(_) => None,
        }
    }

    /// Flushes and moves the file to its place, replacing an existing file.
    pub fn commit(self) -> Result<(), ExportError> {
        self.move_to_place(true)
    }

    /// As [`Self::commit`], without waiting for the disk: for the many files of a sequence, which counts as one.
    pub(crate) fn commit_unsynced(self) -> Result<(), ExportError> {
        self.move_to_place(false)
    }

    /// Moves the file to `waiting` instead of its place, which is told; `None` where it has gone to its place, which is no
    /// ordinary file, or stands in another folder than `waiting` does.
    pub(crate) fn wait_at(mut self, waiting: &Path) -> Result<Option<PathBuf>, ExportError> {
        let beside = |path: &Path| folder_of(path).canonicalize().ok();
        let is_ordinary = matches!(self.body, FileBody::Atomic(..));
        let folder = folder_of(waiting);
        if !is_ordinary || beside(folder).is_none() || beside(folder) != beside(&self.path) {
            return self.commit_unsynced().map(|()| None);
        }
        let place = std::mem::replace(&mut self.path, waiting.to_owned());
        register_unfinished(waiting);
        self.commit_unsynced().map(|()| Some(place))
    }

    /// As [`Self::commit`], unless a file exists there by now, which is then kept: returns false.
    pub fn commit_new(self) -> Result<bool, ExportError> {
        let fail = |e| ExportError::write(&self.name, e);
        match self.body {
            FileBody::Direct(mut file) => file.flush().map_err(fail).map(|()| true),
            FileBody::Atomic(file, temporary) => {
                let file = file.into_inner().map_err(|e| fail(e.into_error()))?;
                sync_file(&file).map_err(fail)?;
                let known = temporary.to_path_buf();
                let linked = temporary.persist_noclobber(&self.path);
                unregister_unfinished(&[known]);
                match linked {
                    Ok(_) => {
                        FINISHED.fetch_add(1, Ordering::Relaxed);
                        Ok(true)
                    }
                    Err(e) if e.error.kind() == io::ErrorKind::AlreadyExists => Ok(false),
                    Err(e) => Err(fail(e.error)),
                }
            }
        }
    }

    fn move_to_place(self, wait: bool) -> Result<(), ExportError> {
        let fail = |e| ExportError::write(&self.name, e);
        match self.body {
            FileBody::Direct(mut file) => file.flush().map_err(fail),
            FileBody::Atomic(file, temporary) => {
                let file = file.into_inner().map_err(|e| fail(e.into_error()))?;
                if wait {
                    sync_file(&file).map_err(fail)?;
                }
                let known = temporary.to_path_buf();
                temporary.persist(&self.path).map_err(|e| fail(e.error))?;
                unregister_unfinished(&[known]);
                FINISHED.fetch_add(usize::from(wait), Ordering::Relaxed);
                Ok(())
            }
        }
    }
}

impl Write for PendingFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.body {
            FileBody::Atomic(file, _) | FileBody::Direct(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.body {
            FileBody::Atomic(file, _) | FileBody::Direct(file) => file.flush(),
        }
    }
}

impl Output for PendingFile {
    fn name(&self) -> &str {
        &self.name
    }

    fn commit(self: Box<Self>) -> Result<(), ExportError> {
        PendingFile::commit(*self)
    }
}

/// Gives a new file the mode and the owner of the one that it will replace, and finds out now whether it may replace it.
#[cfg(unix)]
fn copy_mode_and_owner(old: &fs::Metadata, new: &fs::File, folder: &Path) -> io::Result<()> {
    use std::os::unix::fs::{MetadataExt, PermissionsExt, fchown};
    /// Only owners may move files in such a folder.
    const STICKY: u32 = 0o1000;
    let (own, folder) = (new.metadata()?, fs::metadata(folder)?);
    let is_others = |about: &fs::Metadata| about.uid() != own.uid();
    if own.uid() != 0 && folder.mode() & STICKY != 0 && is_others(old) && is_others(&folder) {
        return Err(io::ErrorKind::PermissionDenied.into());
    }
    // A user who may not change the owner keeps it; the group first, since that is allowed more often.
    let _ = fchown(new, None, Some(old.gid()));
    let _ = fchown(new, Some(old.uid()), None);
    new.set_permissions(fs::Permissions::from_mode(old.mode() & 0o777))
}

#[cfg(not(unix))]
fn copy_mode_and_owner(_: &fs::Metadata, _: &fs::File, _: &Path) -> io::Result<()> {
    Ok(())
}

/// Any writer as an output, for example standard output; what was written cannot be taken back.
pub struct Stream<W: Write + Send> {
    name: String,
    writer: W,
}

impl<W: Write + Send> Stream<W> {
    /// Wraps `writer`; `name` is used in messages.
    pub fn new(name: &str, writer: W) -> Self {
        Self {
            name: name.to_owned(),
            writer,
        }
    }
}

impl<W: Write + Send> Write for Stream<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.writer.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}

impl<W: Write + Send> Output for Stream<W> {
    fn name(&self) -> &str {
        &self.name
    }

    fn commit(mut self: Box<Self>) -> Result<(), ExportError> {
        let result = self.writer.flush();
        result.map_err(|e| ExportError::write(&self.name, e))
    }
}

/// Names of temporary files.
const PREFIX: &str = ".mechanim-";
const SUFFIX: &str = ".part";

/// A temporary file younger than this may not be locked yet.
const YOUNG: Duration = Duration::from_secs(2);

/// A new hidden file in the folder of `place`, with the permissions of an ordinary new file. It is locked while it is
/// open: the unlocked files of a killed run are removed.
fn temporary_beside(place: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // tempfile's own default is for secrets (0o600); the umask still applies to this.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let folder = folder_of(place);
    let file = builder.tempfile_in(folder)?;
    // On a file system without locks no file is regarded as abandoned.
    let _ = file.as_file().try_lock();
    remove_left_behind(folder);
    Ok(file)
}

/// A new hidden folder in `folder`, where files wait. It is locked while the second value is open, like the files.
pub(crate) fn temporary_folder(folder: &Path) -> io::Result<(tempfile::TempDir, Option<fs::File>)> {
    let made = tempfile::Builder::new()
        .prefix(PREFIX)
        .suffix(SUFFIX)
        .tempdir_in(folder)?;
    let lock = fs::File::open(made.path()).ok();
    let _ = lock.as_ref().map(fs::File::try_lock);
    register_unfinished(made.path());
    Ok((made, lock))
}

/// Removes the temporary files of runs that were killed, once for a folder.
fn remove_left_behind(folder: &Path) {
    static SEEN: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());
    let mut seen = SEEN.lock().unwrap_or_else(PoisonError::into_inner);
    if seen.iter().any(|known| known == folder) {
        return;
    }
    seen.push(folder.to_owned());
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let is_ours = name.starts_with(PREFIX) && name.ends_with(SUFFIX);
        if is_ours && is_left_behind(&entry.path()) {
            let _ = fs::remove_file(entry.path()).or_else(|_| fs::remove_dir_all(entry.path()));
        }
    }
}

fn is_left_behind(path: &Path) -> bool {
    let is_old = |about: fs::Metadata| {
        let age = about.modified().ok().and_then(|time| time.elapsed().ok());
        (about.is_file() || about.is_dir()) && age.is_some_and(|age| age > YOUNG)
    };
    let is_free = || fs::File::open(path).is_ok_and(|file| file.try_lock().is_ok());
    fs::symlink_metadata(path).is_ok_and(is_old) && is_free()
}

/// The cause of a failed creation as far as the file system reports it.
fn explain_error(path: &Path, place: &Path, error: io::Error) -> ExportError {
    let folder = folder_of(place);
    if !folder.exists() {
        return ExportError::MissingFolder {
            path: path.to_owned(),
            folder: folder.to_owned(),
        };
    }
    // tempfile puts the temporary name into its text, which would point the reader at the wrong file.
    let plain = match error.raw_os_error() {
        Some(code) => io::Error::from_raw_os_error(code),
        None => io::Error::from(error.kind()),
    };
    ExportError::create(path, plain)
}

/// Reports late write errors (quota, network disks) before the rename.
fn sync_file(file: &fs::File) -> io::Result<()> {
    match file.sync_all() {
        // Some file systems cannot sync; there is nothing to wait for then.
        Err(e)
            if matches!(
                e.kind(),
                io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported
            ) =>
        {
            Ok(())
        }
        other => other,
    }
}
