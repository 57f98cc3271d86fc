//! The folder of a study: its plan, and its finished parts.

use super::error::PartsError;
use super::part::{PartFile, is_whole, part_name};
use super::plan::StudyPlan;
use super::stored::read_text;
use crate::export::PendingFile;
use crate::sorting::{sort, sort_by};
use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

const PLAN: &str = "plan.json";
const PARTS: &str = "parts";
const LEASES: &str = "leases";

/// Extension of a part's name.
const PART: &str = "part";

/// A study on disk.
#[derive(Clone, Debug)]
pub struct Folder {
    path: PathBuf,
    /// The plan of the study.
    pub plan: StudyPlan,
}

impl Folder {
    /// Creates the folder of the study `plan`, with further files in it.
    ///
    /// Errors: something of that name exists already, or it cannot be created.
    pub fn create(
        path: &Path,
        plan: StudyPlan,
        files: &[(&str, &[u8])],
    ) -> Result<Self, PartsError> {
        match fs::create_dir(path) {
            Err(e) if e.kind() == ErrorKind::AlreadyExists => {
                return Err(PartsError::Exists(path.to_owned()));
            }
            other => other.map_err(|e| PartsError::io(path, e))?,
        }
        for folder in [PARTS, LEASES] {
            let folder = path.join(folder);
            fs::create_dir(&folder).map_err(|e| PartsError::io(&folder, e))?;
        }
        for (name, bytes) in files {
            write_file(&path.join(name), bytes)?;
        }
        // The study exists once its plan does.
        let text = format!("{:#}\n", plan.document());
        write_file(&path.join(PLAN), text.as_bytes())?;
        Ok(Self {
            path: path.to_owned(),
            plan,
        })
    }

    /// Opens the folder of a study.
    ///
    /// Errors: there is none, or it belongs to another version of the program.
    pub fn open(path: &Path) -> Result<Self, PartsError> {
        let place = path.join(PLAN);
        let text = match read_text(&place) {
            Err(e) if matches!(e.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
                return Err(PartsError::NoStudy(path.to_owned()));
            }
            other => other.map_err(|e| PartsError::io(&place, e))?,
        };
        Ok(Self {
            plan: StudyPlan::read(&place, &text)?,
            path: path.to_owned(),
        })
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Folder of the parts.
    pub(super) fn parts_folder(&self) -> PathBuf {
        self.path.join(PARTS)
    }

    /// The lease of a unit.
    pub(super) fn lease(&self, unit: u64) -> PathBuf {
        self.path.join(LEASES).join(format!("unit-{unit}"))
    }

    /// Whether a unit is done: its part is there, is of this study and of these items, and its bytes are those that were written.
    pub fn has(&self, unit: u64) -> bool {
        let items = self.plan.items_of(unit);
        let path = self.parts_folder().join(part_name(&items));
        PartFile::open(&path, &self.plan).is_ok_and(|part| part.items == items) && is_whole(&path)
    }

    /// Files and folders that the study consists of, with those beside the plan.
    pub fn own_files(&self, files: &[&str]) -> Vec<PathBuf> {
        let names = [PLAN, PARTS, LEASES]
            .into_iter()
            .chain(files.iter().copied());
        names.map(|name| self.path.join(name)).collect()
    }

    /// Units without an undamaged part of their own, ascending.
    pub fn missing_units(&self) -> Vec<u64> {
        (0..self.plan.units())
            .filter(|unit| !self.has(*unit))
            .collect()
    }

    /// Units that a worker is processing, or was processing when it stopped.
    pub fn leased_units(&self) -> Vec<u64> {
        let units = 0..self.plan.units();
        units.filter(|unit| self.lease(*unit).is_file()).collect()
    }

    /// The times at which the parts were written, ascending.
    pub fn part_times(&self) -> Vec<SystemTime> {
        let entries = fs::read_dir(self.parts_folder()).into_iter().flatten();
        let times = entries.filter_map(|entry| entry.ok()?.metadata().ok()?.modified().ok());
        let mut times: Vec<SystemTime> = times.collect();
        sort(&mut times);
        times
    }

    /// All parts in the order of their items, and the faults of all other files beside them.
    pub(super) fn parts(&self) -> Result<(Vec<PartFile>, Vec<String>), PartsError> {
        let folder = self.parts_folder();
        let failed = |e| PartsError::io(&folder, e);
        let (mut parts, mut faults) = (Vec::new(), Vec::new());
        for entry in fs::read_dir(&folder).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            let is_hidden = path
                .file_name()
                .is_some_and(|name| name.to_string_lossy().starts_with('.'));
            // A name that begins with a point is a part that is still being written.
            if is_hidden || path.extension().is_none_or(|e| e != PART) {
                continue;
            }
            match PartFile::open(&path, &self.plan) {
                Ok(part) => parts.push(part),
                Err(error) => faults.push(error.to_string()),
            }
        }
        sort_by(&mut parts, |a, b| {
            (a.items.start, &a.path).cmp(&(b.items.start, &b.path))
        });
        sort(&mut faults);
        Ok((parts, faults))
    }

    /// Removes the folder with its contents.
    pub fn remove(self) -> Result<(), PartsError> {
        fs::remove_dir_all(&self.path).map_err(|e| PartsError::io(&self.path, e))
    }
}

fn write_file(path: &Path, bytes: &[u8]) -> Result<(), PartsError> {
    let mut target = PendingFile::create(path)?;
    let written = target.write_all(bytes);
    written.map_err(|e| PartsError::io(path, e))?;
    Ok(target.commit()?)
}
