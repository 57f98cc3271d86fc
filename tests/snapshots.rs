//! The snapshot helper itself: whatever is wrong with a golden must fail, and nothing is written unasked.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod snapshot;

use image::{Rgba, RgbaImage};
use snapshot::{Allowed, Bless, EXACT, check};

fn picture(level: u8) -> RgbaImage {
    RgbaImage::from_fn(8, 6, |x, y| Rgba([level, x as u8 * 20, y as u8 * 20, 255]))
}

#[test]
fn missing_wrongly_sized_and_undecodable_goldens_fail() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let fails = |name: &str, image: &RgbaImage, reason: &str| {
        let message = check(path, name, image, EXACT, Bless::Never).unwrap_err();
        assert!(message.contains(reason), "{message}");
        assert!(path.join(format!("{name}.new.png")).exists());
    };
    fails("none", &picture(1), "missing");
    assert!(!path.join("none.png").exists());
    std::fs::write(path.join("broken.png"), b"\x89PNG not really").unwrap();
    fails("broken", &picture(1), "not a PNG");
    check(path, "size", &picture(1), EXACT, Bless::Failing).unwrap();
    fails("size", &RgbaImage::new(8, 7), "8x6 expected, 8x7 drawn");
    assert!(path.join("size.diff.png").exists());
}

#[test]
fn a_pixel_over_the_tolerance_fails_and_a_pass_removes_the_traces() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    check(path, "a", &picture(100), EXACT, Bless::Failing).unwrap();
    check(path, "a", &picture(100), EXACT, Bless::Never).unwrap();
    let mut off = picture(100);
    off.get_pixel_mut(2, 3).0[0] = 103;
    let lenient =
        |tolerance, pixels| check(path, "a", &off, Allowed { tolerance, pixels }, Bless::Never);
    assert!(
        lenient(2, 0)
            .unwrap_err()
            .contains("worst 3 at Some([2, 3])")
    );
    assert!(path.join("a.diff.png").exists());
    lenient(3, 0).unwrap();
    lenient(2, 1).unwrap();
    assert!(!path.join("a.new.png").exists() && !path.join("a.diff.png").exists());
}

#[test]
fn blessing_is_asked_for_in_two_words_and_never_in_ci() {
    assert_eq!(Bless::parse(None, None), Ok(Bless::Never));
    assert_eq!(Bless::parse(None, Some("true")), Ok(Bless::Never));
    assert_eq!(Bless::parse(Some("1"), None), Ok(Bless::Failing));
    assert_eq!(Bless::parse(Some("force"), None), Ok(Bless::Force));
    for other in ["0", "true", "yes", ""] {
        assert!(Bless::parse(Some(other), None).is_err());
    }
    assert!(Bless::parse(Some("1"), Some("1")).is_err());
}

#[test]
fn failing_goldens_are_replaced_and_passing_ones_only_by_force() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let allowed = Allowed {
        tolerance: 5,
        pixels: 0,
    };
    let red = || {
        image::open(path.join("b.png"))
            .unwrap()
            .to_rgba8()
            .get_pixel(0, 0)
            .0[0]
    };
    check(path, "b", &picture(10), allowed, Bless::Failing).unwrap();
    check(path, "b", &picture(12), allowed, Bless::Failing).unwrap();
    assert_eq!(red(), 10);
    check(path, "b", &picture(12), allowed, Bless::Force).unwrap();
    assert_eq!(red(), 12);
    check(path, "b", &picture(90), allowed, Bless::Failing).unwrap();
    assert_eq!(red(), 90);
}
