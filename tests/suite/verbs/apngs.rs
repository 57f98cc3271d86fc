//! APNGs as programs compare them: what is seen counts, however it is cut into parts and cleared between them.

use crate::draws::Draws;
use crate::program::Workspace;
use png::{BitDepth, BlendOp, ColorType, DisposeOp, Encoder};

/// Side of the pictures.
const SIDE: usize = 4;

type Pixels = Vec<[u8; 4]>;

/// A part of a picture, and what becomes of it.
#[derive(Clone, Debug)]
struct Part {
    place: [usize; 2],
    size: [usize; 2],
    pixels: Pixels,
    dispose: DisposeOp,
    blend: BlendOp,
}

fn file_of(parts: &[Part]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, SIDE as u32, SIDE as u32);
    encoder.set_color(ColorType::Rgba);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_animated(parts.len() as u32, 0).unwrap();
    encoder.set_frame_delay(1, 10).unwrap();
    let mut writer = encoder.write_header().unwrap();
    for part in parts {
        let [width, height] = part.size.map(|n| n as u32);
        writer.reset_frame_position().unwrap();
        writer.set_frame_dimension(width, height).unwrap();
        writer
            .set_frame_position(part.place[0] as u32, part.place[1] as u32)
            .unwrap();
        writer.set_dispose_op(part.dispose).unwrap();
        writer.set_blend_op(part.blend).unwrap();
        writer.write_image_data(part.pixels.as_flattened()).unwrap();
    }
    writer.finish().unwrap();
    bytes
}

/// The pictures by the words of the specification; parts are opaque or wholly transparent.
fn composed(parts: &[Part]) -> Vec<Pixels> {
    let mut canvas: Pixels = vec![[0; 4]; SIDE * SIDE];
    let mut seen = Vec::new();
    for part in parts {
        let before = canvas.clone();
        let places = || {
            (0..part.pixels.len()).map(|k| {
                (
                    k,
                    (part.place[1] + k / part.size[0]) * SIDE + part.place[0] + k % part.size[0],
                )
            })
        };
        for (k, at) in places() {
            let new = part.pixels[k];
            if part.blend == BlendOp::Source || new[3] == 255 {
                canvas[at] = new;
            }
        }
        seen.push(canvas.clone());
        match part.dispose {
            DisposeOp::None => {}
            DisposeOp::Background => places().for_each(|(_, at)| canvas[at] = [0; 4]),
            DisposeOp::Previous => canvas = before,
        }
    }
    seen
}

fn random_parts(draws: &mut Draws) -> Vec<Part> {
    let mut below = |n: usize| draws.below(n);
    (0..5)
        .map(|k| {
            let place = if k == 0 { [0, 0] } else { [below(3), below(3)] };
            let size = if k == 0 {
                [SIDE; 2]
            } else {
                place.map(|p| 1 + below(SIDE - p))
            };
            let colours = [[255, 0, 0, 255], [0, 200, 0, 255], [0, 0, 255, 255], [0; 4]];
            Part {
                place,
                size,
                pixels: (0..size[0] * size[1]).map(|_| colours[below(4)]).collect(),
                dispose: [DisposeOp::None, DisposeOp::Background, DisposeOp::Previous][below(3)],
                blend: [BlendOp::Source, BlendOp::Over][below(2)],
            }
        })
        .collect()
}

fn whole(pixels: &Pixels) -> Part {
    Part {
        place: [0, 0],
        size: [SIDE; 2],
        pixels: pixels.clone(),
        dispose: DisposeOp::None,
        blend: BlendOp::Source,
    }
}

/// Against whole frames composed here, and against the same with one pixel changed.
#[test]
fn parts_and_whole_frames_are_compared_by_what_is_seen() {
    let (workspace, mut draws) = (Workspace::new(), Draws(11));
    for round in 0..40 {
        let parts = random_parts(&mut draws);
        let seen = composed(&parts);
        let same: Vec<Part> = seen.iter().map(whole).collect();
        let mut other = same.clone();
        let frame = round % other.len();
        other[frame].pixels[round % 16] = [9, 9, 9, 255];
        workspace.write("parts.apng", file_of(&parts));
        workspace.write("same.apng", file_of(&same));
        workspace.write("other.apng", file_of(&other));
        let is_same = workspace.run(&["diff", "parts.apng", "same.apng"]);
        assert_eq!(is_same.code, 0, "{parts:#?}\n{}", is_same.text());
        let is_other = workspace.run(&["diff", "parts.apng", "other.apng"]);
        assert_eq!(is_other.code, 1, "{parts:#?}\n{}", is_other.text());
    }
}
