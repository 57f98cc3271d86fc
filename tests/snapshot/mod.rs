//! Golden images for tests: a picture must equal the PNG file kept beside the tests.
//!
//! `MECHANIM_BLESS=1` writes the goldens that fail, `MECHANIM_BLESS=force` all; neither is accepted in CI.
#![allow(dead_code, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use image::RgbaImage;
use mechanim::compare::{Comparison, compare, triptych};
use mechanim::export::png::{Effort, encode};
use std::path::Path;

/// What may differ: levels of a channel, and how many pixels may be over that.
#[derive(Clone, Copy, Debug)]
pub struct Allowed {
    /// Levels a channel may be off.
    pub tolerance: u8,
    /// Pixels that may be off by more.
    pub pixels: u64,
}

/// Every pixel exactly as in the golden: for the CPU renderer.
pub const EXACT: Allowed = Allowed {
    tolerance: 0,
    pixels: 0,
};

/// What to do with goldens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bless {
    /// Compare only.
    Never,
    /// Write those that fail.
    Failing,
    /// Write all.
    Force,
}

impl Bless {
    /// Reads the values of `MECHANIM_BLESS` and `CI`.
    pub fn parse(bless: Option<&str>, ci: Option<&str>) -> Result<Self, String> {
        let wish = match bless {
            None => return Ok(Self::Never),
            Some("1") => Self::Failing,
            Some("force") => Self::Force,
            Some(other) => {
                return Err(format!(
                    "MECHANIM_BLESS={other}: only 1 and force are known"
                ));
            }
        };
        match ci {
            Some(_) => Err(
                "MECHANIM_BLESS is refused in CI: a golden is looked at before it is kept"
                    .to_owned(),
            ),
            None => Ok(wish),
        }
    }

    fn from_environment() -> Result<Self, String> {
        let read = |name| std::env::var_os(name).map(|v| v.to_string_lossy().into_owned());
        Self::parse(read("MECHANIM_BLESS").as_deref(), read("CI").as_deref())
    }
}

/// Fails the test unless `actual` agrees with `tests/golden/NAME.png`.
pub fn assert_snapshot(name: &str, actual: &RgbaImage, allowed: Allowed) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    let outcome =
        Bless::from_environment().and_then(|bless| check(&folder, name, actual, allowed, bless));
    if let Err(message) = outcome {
        panic!("{message}");
    }
}

/// Compares with `folder/NAME.png`; on failure writes `NAME.new.png` and, where possible, `NAME.diff.png` beside it.
pub fn check(
    folder: &Path,
    name: &str,
    actual: &RgbaImage,
    allowed: Allowed,
    bless: Bless,
) -> Result<(), String> {
    let file = |suffix: &str| folder.join(format!("{name}{suffix}.png"));
    let save = |path: &Path, image: &RgbaImage| {
        let mut bytes = Vec::new();
        encode(image, Effort::Balanced, &mut bytes).expect("a picture with pixels");
        std::fs::create_dir_all(folder).expect("the folder of goldens");
        std::fs::write(path, bytes).expect("a writable folder of goldens");
    };
    let golden = file("");
    let verdict = judge(&golden, actual, allowed);
    let _ = std::fs::remove_file(file(".new"));
    let _ = std::fs::remove_file(file(".diff"));
    match (verdict, bless) {
        (Ok(()), Bless::Never | Bless::Failing) => Ok(()),
        (Ok(()), Bless::Force) | (Err(_), Bless::Failing | Bless::Force) => {
            save(&golden, actual);
            Ok(())
        }
        (Err((reason, expected)), Bless::Never) => {
            save(&file(".new"), actual);
            if let Some(expected) = expected {
                save(&file(".diff"), &triptych(&expected, actual));
            }
            Err(format!("snapshot {}: {reason}", golden.display()))
        }
    }
}

fn judge(
    golden: &Path,
    actual: &RgbaImage,
    allowed: Allowed,
) -> Result<(), (String, Option<RgbaImage>)> {
    let bytes = std::fs::read(golden).map_err(|e| (format!("missing or unreadable: {e}"), None))?;
    let expected = image::load_from_memory_with_format(&bytes, image::ImageFormat::Png);
    let expected = expected
        .map_err(|e| (format!("not a PNG: {e}"), None))?
        .to_rgba8();
    let outcome = compare(&expected, actual, allowed.tolerance);
    if outcome.is_within(allowed.pixels) {
        return Ok(());
    }
    let reason = match outcome {
        Comparison::SizeMismatch { a, b } => {
            format!("{}x{} expected, {}x{} drawn", a[0], a[1], b[0], b[1])
        }
        Comparison::SameSize(d) => format!(
            "{} of {} pixels off by more than {} (allowed {}), worst {} at {:?}, within {:?}",
            d.over, d.pixels, d.tolerance, allowed.pixels, d.worst, d.worst_at, d.bounds
        ),
    };
    Err((reason, Some(expected)))
}
