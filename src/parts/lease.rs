//! Leases: a file states that a worker is processing a unit. Its holder touches it; a worker that finds a lease no
//! longer touched takes it over. Two workers on one unit only lose time: their parts are the same.

use super::error::PartsError;
use super::stored::read_text;
use std::collections::HashMap;
use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant, SystemTime};

/// Interval at which the holder of a lease touches it.
const TOUCH: Duration = Duration::from_secs(5);

/// A lease that has not been touched for this long is stale: six touches, for slow disks.
const STALE: Duration = Duration::from_secs(30);

/// Interval at which the holder's thread checks whether the work is done.
const LOOK: Duration = Duration::from_millis(20);

/// A lease that is held; released when dropped.
pub(super) struct Lease {
    path: PathBuf,
    is_done: std::sync::Arc<AtomicBool>,
    keeper: Option<JoinHandle<()>>,
}

/// The leases of others seen so far, with the times of their last touch and of the first sight of it by the clock of
/// this machine: the clocks of two machines may differ by any amount.
#[derive(Default)]
pub(super) struct LeaseSightings {
    others: HashMap<PathBuf, (SystemTime, Instant)>,
}

impl LeaseSightings {
    /// Takes the lease at `path`, or that of a holder who has gone.
    ///
    /// Errors: the folder cannot be written to.
    pub fn take(&mut self, path: &Path) -> Result<Option<Lease>, PartsError> {
        match create_lease(path) {
            Ok(lease) => return Ok(Some(lease)),
            Err(e) if e.kind() == ErrorKind::AlreadyExists => {}
            Err(e) => return Err(PartsError::io(path, e)),
        }
        if !self.is_left(path) {
            return Ok(None);
        }
        self.others.remove(path);
        let _ = fs::remove_file(path);
        match create_lease(path) {
            Ok(lease) => Ok(Some(lease)),
            // Another worker was faster.
            Err(e) if e.kind() == ErrorKind::AlreadyExists => Ok(None),
            Err(e) => Err(PartsError::io(path, e)),
        }
    }

    fn is_left(&mut self, path: &Path) -> bool {
        if read_text(path).is_ok_and(|holder| is_gone(&holder)) {
            return true;
        }
        let Ok(touched) = fs::metadata(path).and_then(|about| about.modified()) else {
            return false;
        };
        let known = self.others.entry(path.to_owned());
        let known = known.or_insert_with(|| (touched, Instant::now()));
        if known.0 != touched {
            *known = (touched, Instant::now());
        }
        known.1.elapsed() > STALE
    }
}

/// Creates a new lease and holds it.
fn create_lease(path: &Path) -> std::io::Result<Lease> {
    let mut file = fs::OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(path)?;
    let _ = file.write_all(process_name().as_bytes());
    let is_done = std::sync::Arc::new(AtomicBool::new(false));
    let (done, place) = (std::sync::Arc::clone(&is_done), path.to_owned());
    let keep = move || {
        let mut touched = Instant::now();
        while !done.load(Ordering::Relaxed) {
            std::thread::sleep(LOOK);
            if touched.elapsed() > TOUCH {
                let own = fs::OpenOptions::new().write(true).open(&place);
                let _ = own.and_then(|file| file.set_modified(SystemTime::now()));
                touched = Instant::now();
            }
        }
    };
    // Without a thread the lease goes stale, and the unit may be done twice.
    let keeper = std::thread::Builder::new().spawn(keep).ok();
    Ok(Lease {
        path: path.to_owned(),
        is_done,
        keeper,
    })
}

impl Drop for Lease {
    fn drop(&mut self) {
        self.is_done.store(true, Ordering::Relaxed);
        if let Some(keeper) = self.keeper.take() {
            let _ = keeper.join();
        }
        let _ = fs::remove_file(&self.path);
    }
}

/// Where Linux lists the processes, and identifies the current boot of the system.
const PROCESSES: &str = "/proc";
const BOOT: &str = "/proc/sys/kernel/random/boot_id";

/// The name of this process in a lease.
fn process_name() -> String {
    format!("{} {}", boot_identity(), std::process::id())
}

fn boot_identity() -> String {
    let text = fs::read_to_string(BOOT).unwrap_or_default();
    text.trim().to_owned()
}

/// Whether a holder was a process of this machine that has ended. Nothing is known about other machines.
fn is_gone(holder: &str) -> bool {
    let Some((machine, process)) = holder.split_once(' ') else {
        return false;
    };
    let is_here = !machine.is_empty() && machine == boot_identity();
    is_here && !Path::new(PROCESSES).join(process.trim()).exists()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_lease_is_held_by_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("unit-0");
        let lease = LeaseSightings::default().take(&path).unwrap();
        assert!(lease.is_some());
        assert!(LeaseSightings::default().take(&path).unwrap().is_none());
        drop(lease);
        assert!(LeaseSightings::default().take(&path).unwrap().is_some());
    }

    /// A clock that is an hour slow makes no lease stale: only a lease that remains unchanged for a while is stale.
    #[test]
    fn clocks_of_others_do_not_matter() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("unit-0");
        fs::write(&path, "another-machine 1").unwrap();
        let file = fs::OpenOptions::new().write(true).open(&path).unwrap();
        let hour = Duration::from_secs(3600);
        file.set_modified(SystemTime::now() - hour).unwrap();
        let mut seen = LeaseSightings::default();
        assert!(seen.take(&path).unwrap().is_none());
        let back = Instant::now().checked_sub(STALE + TOUCH).unwrap();
        seen.others.get_mut(&path).unwrap().1 = back;
        file.set_modified(SystemTime::now() + hour).unwrap();
        assert!(seen.take(&path).unwrap().is_none());
        seen.others.get_mut(&path).unwrap().1 = back;
        assert!(seen.take(&path).unwrap().is_some());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn what_a_process_left_that_was_killed_is_taken_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("unit-0");
        fs::write(&path, format!("{} 4294967295", boot_identity())).unwrap();
        assert!(LeaseSightings::default().take(&path).unwrap().is_some());
    }
}
