//! Uncompressed video for other programs: y4m with a header, or bare RGBA pixels. Meant for a pipe.

use super::apng::Pixels;
use super::error::ExportError;
use super::target::Output;
use super::timing::fraction;
use super::{ExportSummary, FrameCoder, FrameSink};
use image::RgbaImage;
use std::io::Write;

/// Greatest number in a y4m frame rate; programs read it as a 32-bit integer.
const LARGEST_RATE: u32 = 1_000_000;

/// What stands before every frame of a y4m video.
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

/// Layout of the pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RawKind {
    /// YUV4MPEG2 at `fps` frames a second: planes Y, Cb, Cr of full size, BT.709, limited range. Alpha is dropped.
    Y4m {
        /// Frames a second, positive.
        fps: f64,
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
        if let RawKind::Y4m { fps } = kind {
            let (frames, seconds) = fraction(fps, LARGEST_RATE);
            let [width, height] = size;
            let header = format!(
                "YUV4MPEG2 W{width} H{height} F{frames}:{seconds} Ip A1:1 C444 XCOLORRANGE=LIMITED\n"
            );
            sink.put(header.as_bytes())?;
        }
        Ok(sink)
    }

    fn put(&mut self, bytes: &[u8]) -> Result<(), ExportError> {
        let written = self.output.write_all(bytes);
        written.map_err(|e| ExportError::write(self.output.name(), e))?;
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
            RawKind::Y4m { .. } => Box::new(Planes { size }),
            RawKind::Rgba { .. } => Box::new(Pixels { size }),
        }
    }

    fn write(&mut self, _index: usize, coded: &[u8]) -> Result<(), ExportError> {
        let (RawKind::Y4m { fps } | RawKind::Rgba { fps }) = self.kind;
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
}

impl FrameCoder for Planes {
    fn code(&mut self, frame: &RgbaImage, coded: &mut Vec<u8>) -> Result<(), ExportError> {
        super::check_frame(frame, self.size)?;
        coded.clear();
        for (row, offset) in MATRIX.into_iter().zip([BLACK, GREY, GREY]) {
            let (pixels, _) = frame.as_raw().as_chunks::<4>();
            coded.extend(pixels.iter().map(|pixel| component(row, offset, *pixel)));
        }
        Ok(())
    }
}

/// One component of a pixel, rounded to the nearest code.
fn component(row: [i32; 3], offset: i32, [r, g, b, _]: [u8; 4]) -> u8 {
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
                        let code = f64::from(component(MATRIX[k], offset, [r, g, b, 255]));
                        assert!(
                            (code - exact[k]).abs() < 0.505,
                            "{r} {g} {b}: {code} {exact:?}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn greys_have_no_colour_and_the_ends_are_the_standards() {
        let all = |c| {
            [0, 1, 2].map(|k| {
                let offset = if k == 0 { BLACK } else { GREY };
                component(MATRIX[k], offset, [c, c, c, 255])
            })
        };
        assert_eq!([all(0), all(255)], [[16, 128, 128], [235, 128, 128]]);
        assert!((0..=255).all(|c| all(c)[1..] == [128, 128]));
    }
}
