//! Golden images for tests: the library's own comparison, and the wish to write them read from the environment.
//!
//! `MECHANIM_BLESS=new` writes the goldens that are missing, `1` also those that fail, `force` all; none is accepted
//! in CI.

use image::RgbaImage;
use mechanim::snapshot::{AllowedDifference, GoldenVerdict, Update, judge_picture};
use std::path::{Path, PathBuf};

/// Where the golden pictures of the tests are.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden")
}

/// What the values of `MECHANIM_BLESS` and `CI` ask for.
pub fn wish(bless: Option<&str>, ci: Option<&str>) -> Result<Update, String> {
    let wish = match bless {
        None => return Ok(Update::Never),
        Some("new") => Update::New,
        Some("1") => Update::Failing,
        Some("force") => Update::All,
        Some(other) => {
            return Err(format!(
                "MECHANIM_BLESS={other}: only new, 1 and force are known"
            ));
        }
    };
    match ci {
        Some(_) => {
            Err("MECHANIM_BLESS is refused in CI: a golden is looked at before it is kept".into())
        }
        None => Ok(wish),
    }
}

/// The wish of whoever runs the tests.
pub fn wish_of_environment() -> Result<Update, String> {
    let read = |name| std::env::var_os(name).map(|v| v.to_string_lossy().into_owned());
    wish(read("MECHANIM_BLESS").as_deref(), read("CI").as_deref())
}

/// Fails the test unless `actual` agrees with `tests/golden/NAME.png`.
pub fn assert_snapshot(name: &str, actual: &RgbaImage, allowed: AllowedDifference) {
    let golden = folder().join(format!("{name}.png"));
    let update = wish_of_environment().unwrap_or_else(|message| panic!("{message}"));
    if let GoldenVerdict::Failed { reason, .. } =
        judge_picture(&golden, actual, allowed, update).unwrap()
    {
        panic!("snapshot {}: {reason}", golden.display());
    }
}
