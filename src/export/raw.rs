//! Uncompressed video for other programs: y4m with a header, or bare RGBA pixels. Meant for a pipe.

use super::apng::Pixels;
use super::error::ExportError;
use super::target::Output;
use super::timing::rate_fraction;
use super::{ExportSummary, FrameCoder, FrameSink};
use image::RgbaImage;

/// Greatest number in a y4m frame rate; programs read it as a 32-bit integer.
const LARGEST_RATE: u32 = 1_000_000;

/// The header of every frame of a y4m video.
const FRAME: &[u8] = b"FRAME\n";

/// Fractional bits of the colour conversion.
const BITS: u32 = 16;

/// Least value of luma, and the middle of the colour differences, in the limited range of 8 bits.
const BLACK: i32 = 16;
const GREY: i32 = 128;

/// Rows of the matrix from sRGB codes to Y, Cb, Cr of BT.709 in the limited range (ITU-R BT.709-6, item 3.4), times
/// 2^16: luma spans 219 codes, the differences 224.
const MATRIX: [[i32; 3]; 3] = [
    [11_966, 40_254, 4_064],
    [-6_596, -22_188, 28_784],
    [28_784, -26_145, -2_639],
];

/// Chroma subsampling of a y4m.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Chroma {
    /// Colour at every pixel (4:4:4).
    #[default]
    Full,
    /// One colour for two by two pixels, their mean, located at their centre (4:2:0), as players expect. At an odd side
    /// the last colour is that of fewer pixels.
    Quarter,
}

/// Layout of the pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RawKind {
    /// YUV4MPEG2 at `fps` frames a second: planes Y, Cb, Cr, BT.709, limited range. Alpha is dropped.
    Y4m {
        /// Frames a second, positive.
        fps: f64,
        /// Size of the planes Cb and Cr.
        chroma: Chroma,
    },
    /// Four bytes a pixel, top row first, frame after frame.
    Rgba {
        /// Frames a second, positive; only for the summary.
        fps: f64,
    },
}

/// Writes uncompressed frames.
pub struct RawSink {
    output: Box<dyn Output>,
    kind: RawKind,
    size: [u32; 2],
    summary: ExportSummary,
}

impl RawSink {
    /// Writes the header, if the layout has one.
    ///
    /// Errors: a failed write.
    pub fn new(
        output: Box<dyn Output>,
        kind: RawKind,
        size: [u32; 2],
    ) -> Result<Self, ExportError> {
        let mut sink = Self {
            output,
            kind,
            size,
            summary: ExportSummary::default(),
        };
        if let RawKind::Y4m { fps, chroma } = kind {
            let (frames, seconds) = rate_fraction(fps, LARGEST_RATE);
            let [width, height] = size;
            let planes = match chroma {
                Chroma::Full => "444",
                // As in JPEG files, chroma samples are located at the centre of their pixels.
                Chroma::Quarter => "420jpeg",
            };
            let header = format!(
                "YUV4MPEG2 W{width} H{height} F{frames}:{seconds} Ip A1:1 C{planes} XCOLORRANGE=LIMITED\n"
            );
            sink.put(header.as_bytes())?;
        }
        Ok(sink)
    }

    fn put(&mut self, bytes: &[u8]) -> Result<(), ExportError> {
        self.output.emit(bytes)?;
        self.summary.bytes += bytes.len() as u64;
        Ok(())
    }
}

impl FrameSink for RawSink {
    fn size(&self) -> [u32; 2] {
        self.size
    }

    fn coder(&self) -> Box<dyn FrameCoder> {
        let size = self.size;
        match self.kind {
            RawKind::Y4m { chroma, .. } => Box::new(Planes { size, chroma }),
            RawKind::Rgba { .. } => Box::new(Pixels { size }),
        }
    }

    fn write(&mut self, _index: usize, coded: &[u8]) -> Result<(), ExportError> {
        let (RawKind::Y4m { fps, .. } | RawKind::Rgba { fps }) = self.kind;
        if matches!(self.kind, RawKind::Y4m { .. }) {
            self.put(FRAME)?;
        }
        self.put(coded)?;
        self.summary.frames += 1;
        self.summary.seconds = self.summary.frames as f64 / fps;
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<ExportSummary, ExportError> {
        self.output.commit()?;
        Ok(self.summary)
    }
}

/// Turns frames into three planes.
struct Planes {
    size: [u32; 2],
    chroma: Chroma,
}

impl FrameCoder for Planes {
    fn code(&mut self, frame: &RgbaImage, coded: &mut Vec<u8>) -> Result<(), ExportError> {
        super::check_frame(frame, self.size)?;
        coded.clear();
        for (row, offset) in MATRIX.into_iter().zip([BLACK, GREY, GREY]) {
            let (pixels, _) = frame.as_raw().as_chunks::<4>();
            if offset == GREY && self.chroma == Chroma::Quarter {
                let width = self.size[0] as usize;
                let pairs = pixels.chunks(2 * width);
                coded.extend(pairs.flat_map(|rows| quarter_row(row, rows, width)));
            } else {
                coded.extend(
                    pixels
                        .iter()
                        .map(|pixel| luma_component(row, offset, *pixel)),
                );
            }
        }
        Ok(())
    }
}

/// A row of colour differences of two by two pixels; `rows` are two rows of pixels, or the last one alone.
fn quarter_row(matrix: [i32; 3], rows: &[[u8; 4]], width: usize) -> impl Iterator<Item = u8> {
    (0..width).step_by(2).map(move |x| {
        let own = rows
            .chunks(width)
            .flat_map(|row| &row[x..(x + 2).min(width)]);
        let (mut sum, mut count) = (0, 0);
        for [r, g, b, _] in own {
            let codes = [*r, *g, *b].map(i32::from);
            sum += (0..3).map(|k| matrix[k] * codes[k]).sum::<i32>();
            count += 1;
        }
        // Rounded to the nearest, as a single pixel is.
        let unit = count << BITS;
        ((sum + unit / 2).div_euclid(unit) + GREY).clamp(0, 255) as u8
    })
}

/// One component of a pixel, rounded to the nearest code.
fn luma_component(row: [i32; 3], offset: i32, [r, g, b, _]: [u8; 4]) -> u8 {
    let sum = row[0] * i32::from(r) + row[1] * i32::from(g) + row[2] * i32::from(b);
    let half = 1 << (BITS - 1);
    (((sum + half) >> BITS) + offset).clamp(0, 255) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    /// BT.709 in floating point: luma weights, differences scaled to half of the range.
    fn exact([r, g, b]: [u8; 3]) -> [f64; 3] {
        let [r, g, b] = [r, g, b].map(|c| f64::from(c) / 255.0);
        let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        let cb = (b - y) / 1.8556;
        let cr = (r - y) / 1.5748;
        [16.0 + 219.0 * y, 128.0 + 224.0 * cb, 128.0 + 224.0 * cr]
    }

    #[test]
    fn every_colour_is_the_nearest_code_of_the_standard() {
        for r in (0..=255).step_by(5) {
            for g in (0..=255).step_by(5) {
                for b in (0..=255).step_by(3) {
                    let exact = exact([r, g, b]);
                    for k in 0..3 {
                        let offset = if k == 0 { BLACK } else { GREY };
                        let code = f64::from(luma_component(MATRIX[k], offset, [r, g, b, 255]));
                        assert!(
                            (code - exact[k]).abs() < 0.505,
                            "{r} {g} {b}: {code} {exact:?}"
                        );
                    }
                }
            }
        }
    }

    /// Two by two pixels are averaged, also at odd sides; grey stays grey and a uniform colour is unchanged.
    #[test]
    fn a_quarter_of_the_colour_is_a_mean() {
        let frame = RgbaImage::from_fn(5, 3, |x, y| {
            image::Rgba([40 * x as u8, 90 * y as u8, 200, 255])
        });
        let planes = |chroma| {
            let mut coded = Vec::new();
            let size = [5, 3];
            assert!(Planes { size, chroma }.code(&frame, &mut coded).is_ok());
            coded
        };
        let (full, quarter) = (planes(Chroma::Full), planes(Chroma::Quarter));
        assert_eq!(full.len(), 3 * 15);
        assert_eq!(quarter.len(), 15 + 2 * 3 * 2);
        assert_eq!(quarter[..15], full[..15]);
        for (plane, (x, y)) in
            (0..2).flat_map(|p| [(p, (0, 0)), (p, (2, 0)), (p, (1, 1)), (p, (2, 1))])
        {
            let found = f64::from(quarter[15 + 6 * plane + 3 * y + x]);
            let own = (2 * x..(2 * x + 2).min(5))
                .flat_map(|u| (2 * y..(2 * y + 2).min(3)).map(move |v| (u, v)));
            let codes: Vec<f64> = own
                .map(|(u, v)| f64::from(full[15 * (plane + 1) + 5 * v + u]))
                .collect();
            let mean = codes.iter().sum::<f64>() / codes.len() as f64;
            assert!(
                (found - mean).abs() <= 1.0,
                "{plane} {x} {y}: {found} {mean}"
            );
        }
    }

    #[test]
    fn greys_have_no_colour_and_the_ends_are_the_standards() {
        let all = |c| {
            [0, 1, 2].map(|k| {
                let offset = if k == 0 { BLACK } else { GREY };
                luma_component(MATRIX[k], offset, [c, c, c, 255])
            })
        };
        assert_eq!([all(0), all(255)], [[16, 128, 128], [235, 128, 128]]);
        assert!((0..=255).all(|c| all(c)[1..] == [128, 128]));
    }
}
