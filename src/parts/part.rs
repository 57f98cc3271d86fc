//! A part: the numbers of consecutive items in one file, preceded by the identity of their study and followed by a
//! digest.
//!
//! A line of JSON, then eight bytes per number, little-endian, item after item (or those of all items together), then
//! 32 bytes of SHA-256.

use super::error::PartsError;
use super::identity::digest;
use super::plan::{StudyPlan, VERSION};
use super::stored::open_regular;
use crate::export::PendingFile;
use serde_json::{Value, json};
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Version of the file's layout.
const SCHEMA: &str = "mechanim-part/1";

/// Bytes of the digest.
const DIGEST: usize = 32;

/// Longest first line.
const LONGEST_HEAD: u64 = 1 << 12;

/// Processor and system: sums of products may differ between them in the last bit.
fn platform_name() -> String {
    format!("{}-{}", std::env::consts::ARCH, std::env::consts::OS)
}

/// A part in a folder, apparently complete.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct PartFile {
    pub path: PathBuf,
    pub items: Range<u64>,
}

/// The name of the part with these items.
pub(super) fn part_name(items: &Range<u64>) -> String {
    format!("items-{:012}-{:012}.part", items.start, items.end)
}

/// Whether the bytes of a file are those that were written: what was damaged since is to be made again.
pub(super) fn is_whole(path: &Path) -> bool {
    let content = fs::read(path).ok();
    content.is_some_and(|bytes| digested(&bytes).is_some())
}

/// The bytes before the digest at the end, if it is theirs.
fn digested(bytes: &[u8]) -> Option<&[u8]> {
    let (content, sum) = bytes.split_at_checked(bytes.len().checked_sub(DIGEST)?)?;
    (digest(content) == *sum).then_some(content)
}

/// Writes the part with these items into `folder`, completely or not at all. An existing one is kept unless it is damaged.
///
/// Errors: it cannot be written, or the existing one contains other numbers.
pub(super) fn write_part(
    folder: &Path,
    plan: &StudyPlan,
    items: &Range<u64>,
    numbers: &[f64],
) -> Result<(), PartsError> {
    let path = folder.join(part_name(items));
    let head = json!({
        "schema": SCHEMA,
        "identity": plan.identity,
        "first": items.start,
        "end": items.end,
        "width": plan.width,
        "version": VERSION,
        "platform": platform_name(),
    });
    let mut bytes = format!("{head}\n").into_bytes();
    bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
    let sum = digest(&bytes);
    bytes.extend_from_slice(&sum);
    let mut target = PendingFile::create(&path)?;
    let written = target.write_all(&bytes);
    written.map_err(|e| PartsError::io(&path, e))?;
    if path.is_file() && !is_whole(&path) {
        fs::remove_file(&path).map_err(|e| PartsError::io(&path, e))?;
    }
    if target.commit_new()? {
        return Ok(());
    }
    let other = PartFile::open(&path, plan)?.numbers()?;
    let bits = |numbers: &[f64]| numbers.iter().map(|n| n.to_bits()).collect::<Vec<_>>();
    match bits(&other) == bits(numbers) {
        true => Ok(()),
        false => Err(PartsError::Faulty(vec![format!(
            "{} was made twice, with other numbers: one of the machines, or one of the programs, is at fault",
            path.display()
        )])),
    }
}

impl PartFile {
    /// Checks the first line and the length of a file.
    ///
    /// Errors: it is not a part of this study, or is incomplete.
    pub fn open(path: &Path, plan: &StudyPlan) -> Result<Self, PartsError> {
        let foreign = |why: &str| PartsError::Foreign {
            path: path.to_owned(),
            why: why.to_owned(),
        };
        let failed = |e| PartsError::io(path, e);
        let file = open_regular(path).map_err(failed)?;
        let length = file.metadata().map_err(failed)?.len();
        let mut line = Vec::new();
        let mut head = BufReader::new(file).take(LONGEST_HEAD);
        head.read_until(b'\n', &mut line).map_err(failed)?;
        let head: Value = serde_json::from_slice(&line).map_err(|_| foreign("is not a part"))?;
        if head["schema"] != SCHEMA {
            return Err(foreign("is not a part"));
        }
        if head["identity"] != plan.identity.as_str() || head["width"] != plan.width {
            return Err(foreign("is a part of another study"));
        }
        if head["version"] != VERSION || head["platform"] != platform_name().as_str() {
            let why = format!(
                "was made by version {} on {}, this is {VERSION} on {}",
                head["version"],
                head["platform"],
                platform_name()
            );
            return Err(foreign(&why));
        }
        let ends = [head["first"].as_u64(), head["end"].as_u64()];
        let [Some(start), Some(end)] = ends else {
            return Err(foreign("is not a part"));
        };
        if start >= end || end > plan.items {
            return Err(foreign("contains items that the study does not have"));
        }
        let body = plan.numbers(end - start) * 8;
        if length != line.len() as u64 + body + DIGEST as u64 {
            return Err(foreign(
                "is broken: it is not as long as its items; a run makes damaged parts of units again",
            ));
        }
        Ok(Self {
            path: path.to_owned(),
            items: start..end,
        })
    }

    /// The numbers of all items.
    ///
    /// Errors: bytes have changed since it was written.
    pub fn numbers(&self) -> Result<Vec<f64>, PartsError> {
        let bytes = fs::read(&self.path).map_err(|e| PartsError::io(&self.path, e))?;
        let broken = || {
            PartsError::Foreign {
            path: self.path.clone(),
            why: "is broken: its bytes are not those that were written; a run makes damaged parts of units again"
                .to_owned(),
        }
        };
        let content = digested(&bytes).ok_or_else(broken)?;
        let head = content
            .iter()
            .position(|b| *b == b'\n')
            .ok_or_else(broken)?;
        let numbers = content[head + 1..].chunks_exact(8);
        let number = |bytes: &[u8]| bytes.try_into().map(f64::from_le_bytes);
        numbers
            .map(number)
            .collect::<Result<_, _>>()
            .map_err(|_| broken())
    }
}
