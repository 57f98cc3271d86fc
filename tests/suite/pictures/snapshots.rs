//! Golden pictures: whatever is wrong with one must fail, and nothing is written unasked.

use crate::snapshot;
use image::{Rgba, RgbaImage};
use mechanim::diag::Source;
use mechanim::snapshot::{
    AllowedDifference, EXACT, GoldenVerdict, Manifest, Update, judge_picture,
};
use std::path::Path;

fn picture(level: u8) -> RgbaImage {
    RgbaImage::from_fn(8, 6, |x, y| Rgba([level, x as u8 * 20, y as u8 * 20, 255]))
}

fn outcome(
    golden: &Path,
    image: &RgbaImage,
    allowed: AllowedDifference,
    update: Update,
) -> Result<bool, String> {
    match judge_picture(golden, image, allowed, update).unwrap() {
        GoldenVerdict::Passed(_) => Ok(false),
        GoldenVerdict::Written => Ok(true),
        GoldenVerdict::Failed { reason, .. } => Err(reason),
    }
}

#[test]
fn missing_wrongly_sized_and_undecodable_goldens_fail() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let fails = |name: &str, image: &RgbaImage, reason: &str| {
        let golden = at(&format!("{name}.png"));
        let message = outcome(&golden, image, EXACT, Update::Never).unwrap_err();
        assert!(message.contains(reason), "{message}");
        assert!(at(&format!("{name}.new.png")).exists());
    };
    fails("none", &picture(1), "missing");
    assert!(!at("none.png").exists());
    std::fs::write(at("broken.png"), b"\x89PNG not really").unwrap();
    fails("broken", &picture(1), "broken.png");
    outcome(&at("size.png"), &picture(1), EXACT, Update::Failing).unwrap();
    fails("size", &RgbaImage::new(8, 7), "8x6 expected, 8x7 found");
    assert!(at("size.diff.png").exists());
}

#[test]
fn planted_faults_are_found_with_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let golden = folder.path().join("a.png");
    outcome(&golden, &picture(90), EXACT, Update::New).unwrap();
    let mut pixel = picture(90);
    pixel.get_pixel_mut(7, 5).0[2] += 1;
    let shifted = RgbaImage::from_fn(8, 6, |x, y| *picture(90).get_pixel(x.saturating_sub(1), y));
    let mut swapped = picture(90);
    swapped.pixels_mut().for_each(|p| p.0.swap(1, 2));
    for (fault, says) in [
        (
            pixel,
            "1 of 48 pixels off by more than 0, worst 1 at (7, 5)",
        ),
        (shifted, "42 of 48"),
        (swapped, "within (0, 0) to (7, 5)"),
    ] {
        let message = outcome(&golden, &fault, EXACT, Update::Never).unwrap_err();
        assert!(message.contains(says), "{message}");
    }
}

#[test]
fn a_pixel_over_the_tolerance_fails_and_a_pass_removes_the_traces() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let golden = at("a.png");
    assert_eq!(
        outcome(&golden, &picture(100), EXACT, Update::Failing),
        Ok(true)
    );
    assert_eq!(
        outcome(&golden, &picture(100), EXACT, Update::Never),
        Ok(false)
    );
    let mut off = picture(100);
    off.get_pixel_mut(2, 3).0[0] = 103;
    let lenient = |tolerance, pixels| {
        outcome(
            &golden,
            &off,
            AllowedDifference { tolerance, pixels },
            Update::Never,
        )
    };
    assert!(lenient(2, 0).unwrap_err().contains("worst 3 at (2, 3)"));
    assert!(at("a.diff.png").exists());
    lenient(3, 0).unwrap();
    lenient(2, 1).unwrap();
    assert!(!at("a.new.png").exists() && !at("a.diff.png").exists());
}

#[test]
fn blessing_is_asked_for_in_words_and_never_in_ci() {
    use snapshot::wish;
    assert_eq!(wish(None, None), Ok(Update::Never));
    assert_eq!(wish(None, Some("true")), Ok(Update::Never));
    assert_eq!(wish(Some("new"), None), Ok(Update::New));
    assert_eq!(wish(Some("1"), None), Ok(Update::Failing));
    assert_eq!(wish(Some("force"), None), Ok(Update::All));
    for other in ["0", "true", "yes", ""] {
        assert!(wish(Some(other), None).is_err());
    }
    assert!(wish(Some("1"), Some("1")).is_err());
}

#[test]
fn goldens_are_replaced_as_far_as_was_asked() {
    let folder = tempfile::tempdir().unwrap();
    let golden = folder.path().join("b.png");
    let allowed = AllowedDifference {
        tolerance: 5,
        pixels: 0,
    };
    let red = || image::open(&golden).unwrap().to_rgba8().get_pixel(0, 0).0[0];
    outcome(&golden, &picture(10), allowed, Update::New).unwrap();
    outcome(&golden, &picture(12), allowed, Update::Failing).unwrap();
    assert_eq!(red(), 10);
    outcome(&golden, &picture(12), allowed, Update::All).unwrap();
    assert_eq!(red(), 12);
    outcome(&golden, &picture(90), allowed, Update::New).unwrap_err();
    assert_eq!(red(), 12);
    outcome(&golden, &picture(90), allowed, Update::Failing).unwrap();
    assert_eq!(red(), 90);
}

fn list(text: &str) -> Result<Manifest, Vec<String>> {
    let source = Source {
        name: "snapshots.toml".into(),
        text: text.into(),
    };
    Manifest::read(&source).map_err(|error| {
        assert!(
            error
                .diagnostics
                .sorted()
                .iter()
                .all(|d| d.span.is_some() || d.message.contains("no pictures"))
        );
        error
            .diagnostics
            .sorted()
            .iter()
            .map(|d| d.message.clone())
            .collect()
    })
}

#[test]
fn a_list_says_all_its_mistakes_at_once() {
    for (text, expected) in [
        ("", &["the list has no pictures"][..]),
        (
            "[[picture]]\n",
            &["[[picture]] needs `file`", "[[picture]] needs `scene`"],
        ),
        (
            "[[pictures]]\nfile = \"a.png\"\n",
            &["unknown key `pictures` in the list"],
        ),
        ("picture = 3\n", &["`picture` must be a list of tables"]),
        ("[[picture]\n", &["not valid TOML"]),
    ] {
        let found = list(text).unwrap_err();
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for (found, expected) in found.iter().zip(expected) {
            assert!(found.contains(expected), "{found}");
        }
    }
    for (line, expected) in [
        ("size = [0, 10]", "a side must be between 1 and 4096"),
        ("size = [10]", "`size` must have 2 components"),
        ("tolerance = 256", "tolerance must be between 0 and 255"),
        ("tolerance = 0.5", "tolerance must be a whole number"),
        ("samples = \"many\"", "samples must be a number"),
        ("frame = 1\ntime = 2", "a `frame` or a `time`, not both"),
        ("time = -1", "the time must be at least 0"),
        (
            "view = { projection = \"flat\" }",
            "unknown projection `flat`",
        ),
        (
            "view = { elevation = 100 }",
            "elevation must be between -90 and 90",
        ),
        (
            "view = { explode = 101 }",
            "explode must be between 0 and 100",
        ),
        (
            "view = { section = { normal = [0, 0, 1] } }",
            "[section] needs `point`",
        ),
        (
            "view = { section = { point = [0, 0, \"x\"], normal = [0, 0, 1] } }",
            "point must be a number, found `x`",
        ),
        (
            "view = { section = { point = [0, 0, 0], normal = [0, 0, 0] } }",
            "the `normal` of a section has no direction",
        ),
        ("colour = 1", "unknown key `colour`"),
        (
            "[[picture]]\nfile = \"a.png\"\nscene = \"x\"",
            "two pictures are kept in `a.png`",
        ),
        (
            "[[picture]]\nfile = \"../a.png\"\nscene = \"x\"",
            "is not the name of a PNG file",
        ),
        (
            "[[picture]]\nfile = \"a.new.png\"\nscene = \"x\"",
            "is not the name of a PNG file",
        ),
    ] {
        let found = list(&format!(
            "[[picture]]\nfile = \"a.png\"\nscene = \"gearshift\"\n{line}\n"
        ))
        .unwrap_err();
        assert!(
            found.len() == 1 && found[0].contains(expected),
            "{line}: {found:?}"
        );
    }
}
