//! Interlaced PNGs are read like others, and take no more memory than a run may use.

use crate::draws::Draws;
use crate::program::Workspace;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use mechanim::import::PictureRows;
use std::io::Write;
use std::path::Path;

/// Channels of the kinds of pixels, by the number that the head has for them.
const KINDS: [(u8, usize, &[usize]); 5] = [
    (0, 1, &[1, 2, 4, 8, 16]),
    (2, 3, &[8, 16]),
    (3, 1, &[1, 2, 4, 8]),
    (4, 2, &[8, 16]),
    (6, 4, &[8, 16]),
];

/// First column and row of the seven passes, and how far apart their columns and rows are.
const PASSES: [[usize; 4]; 7] = [
    [0, 0, 8, 8],
    [4, 0, 8, 8],
    [0, 4, 4, 8],
    [2, 0, 4, 4],
    [0, 2, 2, 4],
    [1, 0, 2, 2],
    [0, 1, 1, 2],
];

fn chunk(file: &mut Vec<u8>, name: &[u8], data: &[u8]) {
    file.extend((data.len() as u32).to_be_bytes());
    let mut sum = flate2::Crc::new();
    for part in [name, data] {
        file.extend(part);
        sum.update(part);
    }
    file.extend(sum.sum().to_be_bytes());
}

/// A PNG whose pixel at a column and a row is `bits` bits of a number, the highest first.
fn file_of(
    [width, height]: [usize; 2],
    (kind, channels, depth): (u8, usize, usize),
    is_interlaced: bool,
    pixel: impl Fn(usize, usize) -> u64,
) -> Vec<u8> {
    let bits = channels * depth;
    let mut packed = ZlibEncoder::new(Vec::new(), Compression::fast());
    let passes = match is_interlaced {
        true => &PASSES[..],
        false => &[[0, 0, 1, 1]],
    };
    for &[x, y, across, down] in passes {
        let columns: Vec<usize> = (x..width).step_by(across).collect();
        for row in (y..height).step_by(down).filter(|_| !columns.is_empty()) {
            let mut line = vec![0; 1 + (columns.len() * bits).div_ceil(8)];
            for (k, column) in columns.iter().enumerate() {
                let value = pixel(*column, row);
                for bit in 0..bits {
                    let at = k * bits + bit;
                    let one = value >> (bits - 1 - bit) & 1;
                    line[1 + at / 8] |= (one as u8) << (7 - at % 8);
                }
            }
            packed.write_all(&line).unwrap();
        }
    }
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    let mut head = Vec::new();
    for size in [width, height] {
        head.extend((size as u32).to_be_bytes());
    }
    head.extend([depth as u8, kind, 0, 0, u8::from(is_interlaced)]);
    chunk(&mut file, b"IHDR", &head);
    if kind == 3 {
        let colours: Vec<u8> = (0..3 << depth).map(|k| (k * 37 % 251) as u8).collect();
        chunk(&mut file, b"PLTE", &colours);
        chunk(&mut file, b"tRNS", &[0, 200]);
    }
    chunk(&mut file, b"IDAT", &packed.finish().unwrap());
    chunk(&mut file, b"IEND", b"");
    file
}

/// Width, height, and all pixels row by row.
fn pixels_of(path: &Path) -> ([u32; 2], Vec<u8>) {
    let mut rows = PictureRows::open(path).unwrap();
    let mut pixels = Vec::new();
    while let Some(row) = rows.next_row().unwrap() {
        pixels.extend_from_slice(row);
    }
    (rows.size(), pixels)
}

#[test]
fn an_interlaced_picture_is_the_same_as_one_that_is_not() {
    let w = Workspace::new();
    let mut draws = Draws(16);
    for (kind, channels, depths) in KINDS {
        for depth in depths {
            for size in [[1, 1], [2, 9], [5, 3], [33, 40]] {
                let values: Vec<u64> = (0..size[0] * size[1])
                    .map(|_| (draws.share() * 1.8e19) as u64)
                    .collect();
                let [plain, interlaced] = [false, true].map(|is_interlaced| {
                    let name = format!("{is_interlaced}.png");
                    let pixel = |x: usize, y: usize| values[y * size[0] + x];
                    w.write(
                        &name,
                        file_of(size, (kind, channels, *depth), is_interlaced, pixel),
                    );
                    pixels_of(&w.path(&name))
                });
                assert_eq!(plain.1.len(), 4 * size[0] * size[1]);
                assert!(plain == interlaced, "{kind} {depth} {size:?}");
            }
        }
    }
}

#[test]
fn an_interlaced_picture_is_held_once_or_refused() {
    let w = Workspace::new();
    let pixel = |x: usize, y: usize| 0xff00_0000 + (x / 512 + y / 512) as u64;
    for (name, is_interlaced) in [("plain.png", false), ("interlaced.png", true)] {
        w.write(name, file_of([4096, 4096], (6, 4, 8), is_interlaced, pixel));
    }
    let diff = ["diff", "plain.png", "interlaced.png"];
    let limited = |most: &str| w.run(&[&diff[..], &["--limits", most]].concat());
    // Four bytes a pixel are 64 MiB; a row of the other one is little.
    let refused = limited("memory=60M").exits(2);
    assert!(
        refused.stderr.contains("the limit `memory` is 60 MiB, and")
            && refused.stderr.contains("interlaced.png needs"),
        "{}",
        refused.stderr
    );
    limited("memory=110M").exits(0);
}
