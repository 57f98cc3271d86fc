//! Comparison of a picture with its golden file. A golden is never written unless requested, and a missing one is a
//! failure.

use crate::compare::film::AllowedDifference;
use crate::compare::triptych::TriptychRows;
use crate::compare::{Comparison, Difference, compare_rows};
use crate::export::png::{Effort, encode_png};
use crate::export::png_rows::write_rows;
use crate::export::{ExportError, Output, PendingFile};
use crate::import::{FramePicture, ImportError, PictureRows};
use image::RgbaImage;
use std::path::{Path, PathBuf};

/// Every pixel exactly as in the golden: for the built-in renderer.
pub const EXACT: AllowedDifference = AllowedDifference {
    tolerance: 0,
    pixels: 0,
};

/// Which goldens are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Update {
    /// None: compare only.
    Never,
    /// Those that are missing.
    New,
    /// Those that are missing or fail.
    Failing,
    /// All.
    All,
}

/// What came of a picture.
#[derive(Clone, Debug, PartialEq)]
pub enum GoldenVerdict {
    /// It equals its golden within the tolerance.
    Passed(Difference),
    /// The golden was written.
    Written,
    /// It differs; the actual picture and, if there is a golden, both with their difference are written beside it.
    Failed {
        /// Why, in one line.
        reason: String,
        /// The difference, if the sizes agree.
        difference: Option<Difference>,
    },
}

/// Compares `actual` with the file `golden`. On failure `NAME.new.png` and, where there is a readable golden,
/// `NAME.diff.png` are written beside it; on success they are removed.
///
/// Errors: a file cannot be written.
pub fn judge_picture(
    golden: &Path,
    actual: &RgbaImage,
    allowed: AllowedDifference,
    update: Update,
) -> Result<GoldenVerdict, ExportError> {
    let (is_missing, outcome) = (!golden.exists(), held_against(golden, actual, allowed));
    let [drawn, difference] = ["new", "diff"].map(|kind| path_beside(golden, kind));
    for stale in [&drawn, &difference] {
        // There is nothing to remove after a success before this one.
        std::fs::remove_file(stale).ok();
    }
    let writes = match update {
        Update::Never => false,
        Update::New => is_missing,
        Update::Failing => outcome.is_err(),
        Update::All => true,
    };
    if writes {
        // What a link leads to may be anything: the link goes, not the file behind it.
        if golden.is_symlink() {
            std::fs::remove_file(golden).ok();
        }
        save_picture(golden, actual)?;
        return Ok(GoldenVerdict::Written);
    }
    match outcome {
        Ok(found) => Ok(GoldenVerdict::Passed(found)),
        Err(failure) => {
            save_picture(&drawn, actual)?;
            if let Some(size) = failure.expected {
                let expected = FramePicture::File(golden.to_owned(), size);
                let actual = FramePicture::Held(actual.clone());
                save_triptych([&expected, &actual], allowed.tolerance, &difference)?;
            }
            Ok(GoldenVerdict::Failed {
                reason: failure.reason,
                difference: failure.difference,
            })
        }
    }
}

/// `a.png` to `a.KIND.png`.
pub fn path_beside(golden: &Path, kind: &str) -> PathBuf {
    golden.with_extension(format!("{kind}.png"))
}

struct Mismatch {
    reason: String,
    /// Size of the golden, if it can be read.
    expected: Option<[u32; 2]>,
    difference: Option<Difference>,
}

fn held_against(
    golden: &Path,
    actual: &RgbaImage,
    allowed: AllowedDifference,
) -> Result<Difference, Mismatch> {
    let unreadable = |reason: String| Mismatch {
        reason,
        expected: None,
        difference: None,
    };
    if !golden.exists() {
        return Err(unreadable("the golden picture is missing".to_owned()));
    }
    let failed = |e: ImportError| unreadable(e.to_string());
    let expected = PictureRows::open(golden).map_err(failed)?;
    let size = expected.size();
    let drawn = PictureRows::of_picture(actual);
    let outcome = compare_rows(expected, drawn, allowed.tolerance).map_err(failed)?;
    let within = outcome.is_within(allowed.pixels);
    let reason = format!("{outcome} (allowed {})", allowed.pixels);
    match outcome {
        Comparison::SameSize(found) if within => Ok(found),
        Comparison::SameSize(found) => Err(Mismatch {
            reason,
            expected: Some(size),
            difference: Some(found),
        }),
        Comparison::SizeMismatch { .. } => Err(Mismatch {
            reason: outcome.to_string(),
            expected: Some(size),
            difference: None,
        }),
    }
}

/// Writes two pictures and their difference side by side.
///
/// Errors: a picture cannot be read, the file cannot be written.
pub fn save_triptych(
    [expected, actual]: [&FramePicture; 2],
    tolerance: u8,
    path: &Path,
) -> Result<(), ExportError> {
    let unreadable = |e: ImportError| ExportError::Encode {
        name: path.display().to_string(),
        message: e.to_string(),
    };
    let mut rows = TriptychRows::new(expected, actual, tolerance).map_err(unreadable)?;
    let size = rows.size();
    let mut output: Box<dyn Output> = Box::new(PendingFile::create(path)?);
    let next = |row: &mut Vec<u8>| {
        row.extend_from_slice(rows.next_row().map_err(unreadable)?.unwrap_or_default());
        Ok(())
    };
    write_rows(size, next, output.as_mut())?;
    output.commit()
}

fn save_picture(path: &Path, image: &RgbaImage) -> Result<(), ExportError> {
    let mut bytes = Vec::new();
    encode_png(image, Effort::Balanced, &mut bytes)?;
    let mut target = PendingFile::create(path)?;
    target.emit(&bytes)?;
    target.commit()
}
