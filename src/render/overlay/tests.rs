//! Tests of the overlay on small pictures.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use super::*;
use crate::math::Pose;
use crate::render::Projection;
use glam::DVec3;
use image::Rgba;

const GREY: [u8; 3] = [90, 100, 110];

fn camera() -> Camera {
    Camera {
        world_from_camera: Pose::from_translation(DVec3::new(0.0, 0.0, 10.0)),
        projection: Projection::Orthographic { height: 10.0 },
        near: 0.1,
        far: 100.0,
    }
}

fn picture(width: u32, height: u32) -> RgbaImage {
    RgbaImage::from_pixel(width, height, Rgba([GREY[0], GREY[1], GREY[2], 255]))
}

fn label(text: &str, anchor: LabelAnchor) -> Label {
    Label {
        text: text.to_owned(),
        anchor,
        size: 12.0,
        colour: [255, 255, 255],
        plate: false,
        yields: false,
    }
}

fn drawn(width: u32, height: u32, labels: Vec<Label>, no_pose: bool) -> RgbaImage {
    let frame = Frame {
        labels,
        no_pose,
        ..Frame::default()
    };
    let mut image = picture(width, height);
    Overlay::new([20, 30, 40]).draw(&frame, &camera(), &mut image);
    image
}

/// Columns and rows of the pixels that are no longer grey: first and last of each.
fn changed(image: &RgbaImage) -> Option<[u32; 4]> {
    let mut found: Option<[u32; 4]> = None;
    for (x, y, pixel) in image.enumerate_pixels() {
        if pixel.0[..3] != GREY {
            let b = found.get_or_insert([x, y, x, y]);
            *b = [b[0].min(x), b[1].min(y), b[2].max(x), b[3].max(y)];
        }
    }
    found
}

#[test]
fn a_world_label_is_centred_on_its_point() {
    // The world's (2, 1) is 10 pixels an unit right of and above the middle.
    let at = LabelAnchor::World(DVec3::new(2.0, 1.0, 0.0));
    let image = drawn(160, 100, vec![label("HH", at)], false);
    let [x0, y0, x1, y1] = changed(&image).unwrap();
    assert!((f64::from(x0 + x1 + 1) / 2.0 - 100.0).abs() <= 1.0);
    assert!((f64::from(y0 + y1 + 1) / 2.0 - 40.0).abs() <= 1.0);
    assert_eq!(
        y1 - y0 + 1,
        12 + 2,
        "the capitals and one pixel of seam on either side"
    );
    // The seam has the background's colour, the letters their own.
    assert!(image.pixels().any(|p| p.0[..3] == [20, 30, 40]));
    assert!(image.pixels().any(|p| p.0[..3] == [255, 255, 255]));
}

#[test]
fn a_label_that_yields_is_left_out_where_another_stands() {
    let at = |x: f64| LabelAnchor::World(DVec3::new(x, 0.0, 0.0));
    let alone = drawn(160, 100, vec![label("A", at(0.0))], false);
    for (x, yields, same) in [(0.5, true, true), (0.5, false, false), (4.0, true, false)] {
        let second = Label {
            yields,
            ..label("B", at(x))
        };
        let both = drawn(160, 100, vec![label("A", at(0.0)), second], false);
        assert_eq!(both == alone, same, "{x} {yields}");
    }
}

#[test]
fn a_leader_reaches_from_the_point_to_the_text() {
    let point = DVec3::new(-2.0, -1.0, 0.0);
    let image = drawn(
        160,
        100,
        vec![label("H", LabelAnchor::Beside(point))],
        false,
    );
    let [x0, y0, x1, y1] = changed(&image).unwrap();
    // The world's (-2, -1) is at the pixel (60, 60); the text stands right of and above it.
    assert!(x0.abs_diff(60) <= 2 && y1.abs_diff(60) <= 2, "{x0} {y1}");
    assert!(x1 > 80 && y0 < 45, "{x1} {y0}");
    // The line is there all the way: every column has ink.
    let ink = |x: u32| (0..100).any(|y| image.get_pixel(x, y).0[..3] != GREY);
    // It ends two pixels before the text, which begins 2.2 heights of its capitals away.
    assert!((60..83).all(ink));
    // Near the border the text stays in the picture.
    let near = LabelAnchor::Beside(DVec3::new(7.0, 0.0, 0.0));
    let [left, ..] = changed(&drawn(160, 100, vec![label("HHHH", near)], false)).unwrap();
    assert!(left < 130, "{left}");
}

#[test]
fn a_screen_label_starts_at_its_corner() {
    let image = drawn(
        160,
        100,
        vec![label("H", LabelAnchor::Screen([0.25, 0.5]))],
        false,
    );
    let [x0, y0, ..] = changed(&image).unwrap();
    assert!((40..=42).contains(&x0), "{x0}");
    assert_eq!(y0, 50);
}

#[test]
fn a_point_behind_the_camera_has_no_label() {
    let perspective = Camera {
        projection: Projection::Perspective { fov_y: 0.5 },
        ..camera()
    };
    for (z, seen) in [(11.0, false), (9.95, false), (5.0, true)] {
        let frame = Frame {
            labels: vec![label("H", LabelAnchor::World(DVec3::Z * z))],
            ..Frame::default()
        };
        let mut image = picture(80, 60);
        Overlay::new([0; 3]).draw(&frame, &perspective, &mut image);
        assert_eq!(changed(&image).is_some(), seen, "{z}");
    }
}

#[test]
fn labels_are_cut_at_every_edge() {
    let places = [
        [-0.05, 0.5],
        [0.97, 0.5],
        [0.5, -0.05],
        [0.5, 0.97],
        [1e30, 0.0],
        [f64::NAN, 0.0],
    ];
    for place in places {
        let whole = drawn(
            400,
            300,
            vec![label("Hq漢", LabelAnchor::Screen([0.5, 0.5]))],
            false,
        );
        let cut = drawn(
            100,
            80,
            vec![label("Hq漢", LabelAnchor::Screen(place))],
            false,
        );
        let ink = |i: &RgbaImage| i.pixels().filter(|p| p.0[..3] != GREY).count();
        assert!(ink(&cut) < ink(&whole), "{place:?}");
    }
}

#[test]
fn one_pixel_pictures_and_odd_sizes_are_fine() {
    for size in [0.0, -3.0, f64::NAN, f64::INFINITY, 1e300, 1e-300, 7.3] {
        let mut one = label("Wj\n漢", LabelAnchor::Screen([0.0, 0.0]));
        one.size = size;
        one.plate = true;
        let image = drawn(1, 1, vec![one], true);
        assert_eq!(image.get_pixel(0, 0).0[3], 255);
    }
}

#[test]
fn drawing_twice_gives_the_same_bytes() {
    let labels = || {
        vec![
            label(
                "p = −17.0 mm\nφ = 0.2 rad",
                LabelAnchor::Screen([0.02, 0.03]),
            ),
            label("M", LabelAnchor::World(DVec3::ZERO)),
        ]
    };
    assert_eq!(
        drawn(200, 150, labels(), true).into_raw(),
        drawn(200, 150, labels(), true).into_raw()
    );
}

#[test]
fn a_plate_takes_the_background_colour_without_hiding_what_is_below() {
    let mut with_plate = label("H", LabelAnchor::Screen([0.25, 0.25]));
    with_plate.plate = true;
    let image = drawn(160, 120, vec![with_plate], false);
    // Just inside the left edge, where there is no ink: between the picture's grey and the plate's colour.
    let pixel = image.get_pixel(42, 40).0;
    for (c, plate) in [20, 30, 40].into_iter().enumerate() {
        assert!(pixel[c] < GREY[c] && pixel[c] > plate, "{pixel:?}");
    }
    assert_eq!(image.get_pixel(40, 30).0[..3], GREY, "the corner is round");
}

#[test]
fn the_border_is_amber_and_leaves_the_middle() {
    let image = drawn(120, 90, Vec::new(), true);
    let amber = image
        .enumerate_pixels()
        .filter(|(_, _, p)| p.0[0] > 200 && p.0[2] < 80)
        .count();
    let band_pixels = 120 * 90 - 112 * 82;
    assert!(
        amber * 10 > band_pixels * 3 && amber * 10 < band_pixels * 7,
        "{amber} of {band_pixels}"
    );
    assert_eq!(image.get_pixel(60, 45).0[..3], GREY);
    assert_eq!(changed(&image), Some([0, 0, 119, 89]));
}
