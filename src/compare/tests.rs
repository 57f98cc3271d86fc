//! The comparer against planted faults.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use super::triptych::TriptychRows;
use super::*;
use crate::import::FramePicture;
use image::Rgba;

const SIZE: [u32; 2] = [64, 48];

const FILL: Rgba<u8> = Rgba([255, 0, 255, 255]);

fn difference_triptych(expected: &RgbaImage, actual: &RgbaImage, tolerance: u8) -> RgbaImage {
    let [expected, actual] = [expected, actual].map(|p| FramePicture::Held(p.clone()));
    let mut rows = TriptychRows::new(&expected, &actual, tolerance).unwrap();
    let (size, mut pixels) = (rows.size(), Vec::new());
    while let Some(row) = rows.next_row().unwrap() {
        pixels.extend_from_slice(row);
    }
    RgbaImage::from_raw(size[0], size[1], pixels).unwrap()
}

/// A thin slanted line and a disc on a gradient: something of everything a renderer draws.
fn picture(with_line: bool, shift: i32) -> RgbaImage {
    RgbaImage::from_fn(SIZE[0], SIZE[1], |x, y| {
        let (u, v) = (x as i32 - shift, y as i32);
        let on_line = with_line && u == 10 + v / 3;
        let on_disc = (u - 40).pow(2) + (v - 24).pow(2) < 150;
        match (on_line, on_disc) {
            (true, _) => Rgba([20, 20, 20, 255]),
            (_, true) => Rgba([200, 90, 30, 255]),
            _ => Rgba([240, 240, 250 - y as u8, 255]),
        }
    })
}

fn difference(b: &RgbaImage, tolerance: u8) -> Difference {
    match compare_pictures(&picture(true, 0), b, tolerance) {
        Comparison::SameSize(difference) => difference,
        other => panic!("{other:?}"),
    }
}

#[test]
fn equal_pictures_have_no_difference() {
    let d = difference(&picture(true, 0), 0);
    assert_eq!(
        (d.over, d.over_ladder, d.rmse, d.worst),
        (0, [0; 8], 0.0, 0)
    );
    assert_eq!((d.psnr, d.worst_at, d.bounds), (f64::INFINITY, None, None));
    assert!(compare_pictures(&picture(true, 0), &picture(true, 0), 0).is_within(0));
}

#[test]
fn one_pixel_is_found_with_its_place_and_size() {
    let mut b = picture(true, 0);
    b.get_pixel_mut(63, 47).0[1] -= 9;
    let d = difference(&b, 2);
    assert_eq!((d.over, d.worst, d.worst_at), (1, 9, Some([63, 47])));
    assert_eq!(d.bounds, Some([63, 47, 63, 47]));
    assert_eq!(d.over_ladder, [1, 1, 1, 1, 1, 0, 0, 0]);
    let mean = 81.0 / (3.0 * 64.0 * 48.0);
    assert!((d.rmse - f64::sqrt(mean)).abs() < 1e-12);
    assert!((d.psnr - 10.0 * (65025.0 / mean).log10()).abs() < 1e-9);
    // At the tolerance it passes, one below it does not.
    assert_eq!(difference(&b, 9).over, 0);
    assert_eq!(difference(&b, 8).over, 1);
}

#[test]
fn a_shift_by_one_pixel_shows_at_every_edge() {
    let d = difference(&picture(true, 1), 16);
    // The line moves as a whole (twice 48 pixels), and the disc's two sides.
    assert!(d.over >= 96 + 40, "{}", d.over);
    assert_eq!(d.worst, 230);
}

#[test]
fn swapped_channels_show_on_every_coloured_pixel() {
    let mut b = picture(true, 0);
    b.pixels_mut().for_each(|p| p.0.swap(0, 2));
    let d = difference(&b, 64);
    let disc = picture(true, 0).pixels().filter(|p| p.0[0] == 200).count() as u64;
    assert_eq!((d.over, d.worst), (disc, 170));
}

#[test]
fn a_missing_thin_line_is_not_lost_in_the_mean() {
    let b = picture(false, 0);
    let d = difference(&b, 32);
    assert_eq!(d.over, 48);
    assert_eq!(d.bounds, Some([10, 0, 25, 47]));
    assert!(!compare_pictures(&picture(true, 0), &b, 32).is_within(47));
}

#[test]
fn a_changed_alpha_counts_as_a_difference() {
    let mut b = picture(true, 0);
    b.get_pixel_mut(5, 5).0[3] = 250;
    assert_eq!(difference(&b, 4).over, 1);
}

#[test]
fn another_size_is_a_result_of_its_own() {
    let b = RgbaImage::new(64, 47);
    let outcome = compare_pictures(&picture(true, 0), &b, 255);
    assert_eq!(
        outcome,
        Comparison::SizeMismatch {
            a: SIZE,
            b: [64, 47]
        }
    );
    assert!(!outcome.is_within(u64::MAX));
}

#[test]
fn the_triptych_shows_both_pictures_and_marks_what_one_lacks() {
    let a = picture(true, 0);
    let mut b = RgbaImage::from_fn(60, 50, |x, y| *a.get_pixel(x, y.min(47)));
    b.get_pixel_mut(3, 4).0[0] -= 5;
    let t = difference_triptych(&a, &b, 0);
    assert_eq!(t.dimensions(), (3 * 64 + 8, 50));
    assert_eq!(t.get_pixel(3, 4), a.get_pixel(3, 4));
    assert_eq!(t.get_pixel(68 + 3, 4), &Rgba([40, 0, 0, 255]));
    assert_eq!(t.get_pixel(136 + 3, 4), b.get_pixel(3, 4));
    assert_eq!(t.get_pixel(68 + 62, 4), &FILL);
    assert_eq!(t.get_pixel(10, 49), &FILL);
    assert_eq!(t.get_pixel(65, 10), &FILL);
}

#[test]
fn one_pixel_in_a_triptych_has_a_mark_around_it() {
    let a = picture(true, 0);
    let mut b = a.clone();
    b.get_pixel_mut(30, 20).0[1] ^= 1;
    let marked = |tolerance| {
        let t = difference_triptych(&a, &b, tolerance);
        let panel = (0..48).flat_map(|y| (0..64).map(move |x| (x, y)));
        panel
            .filter(|(x, y)| *t.get_pixel(68 + x, *y) == FILL)
            .collect::<Vec<_>>()
    };
    let ring = |(x, y): &(u32, u32)| x.abs_diff(30).max(y.abs_diff(20)) == 3;
    assert_eq!(marked(0).len(), 24);
    assert!(marked(0).iter().all(ring));
    assert!(marked(1).is_empty());
    // The mark does not cover what it marks.
    assert_eq!(
        difference_triptych(&a, &b, 0).get_pixel(68 + 30, 20),
        &Rgba([0, 8, 0, 255])
    );
}
