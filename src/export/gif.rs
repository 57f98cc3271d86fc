//! Animated GIF: one palette, changed rectangles, absolute times. Holds the block layout; LZW and colour live next door.

use super::delta::Area;
use super::error::ExportError;
use super::lzw::{self, Dictionary};
use super::mapping::Mapper;
use super::palette::Palette;
use super::target::Output;
use super::timing::Schedule;
use super::{ExportSummary, FrameCoder, FrameSink};
use image::RgbaImage;
use std::io::Write;
use std::sync::Arc;

/// Greatest side of a GIF, a 16-bit field.
const LONGEST_SIDE: u32 = u16::MAX as u32;

/// Longest delay of one GIF frame in hundredths, a 16-bit field.
const LONGEST_DELAY: u32 = u16::MAX as u32;

/// Frames looked at for the palette. More than 12 did not lower the error measurably.
const SAMPLES: usize = 12;

/// Indices of the frames to build the palette from: spread over the animation, first and last included.
pub fn sample_indices(frame_count: usize) -> Vec<usize> {
    let samples = frame_count.min(SAMPLES);
    let last = frame_count.saturating_sub(1);
    (0..samples)
        .map(|k| k * last / (samples.max(2) - 1))
        .collect()
}

/// What a GIF should be like.
#[derive(Clone, Debug)]
pub struct GifSettings {
    /// Size in pixels.
    pub size: [u32; 2],
    /// When each frame is shown.
    pub schedule: Schedule,
    /// Repeats forever; else plays once.
    pub repeat: bool,
}

/// Writes a GIF frame by frame.
pub struct GifSink {
    output: Box<dyn Output>,
    settings: GifSettings,
    palette: Arc<Palette>,
    /// The frame waiting for its delay: equal frames that follow lengthen it.
    pending: Vec<u8>,
    delay: u32,
    summary: ExportSummary,
}

impl GifSink {
    /// Writes the header. The palette's samples should be frames of this animation.
    ///
    /// Errors: a side of 0 or above 65535, no frames, a failed write.
    pub fn new(
        output: Box<dyn Output>,
        settings: GifSettings,
        palette: Arc<Palette>,
    ) -> Result<Self, ExportError> {
        let [width, height] = settings.size;
        if ![width, height]
            .iter()
            .all(|s| (1..=LONGEST_SIDE).contains(s))
        {
            return Err(ExportError::Size {
                format: "GIF",
                width,
                height,
                limit: LONGEST_SIDE,
            });
        }
        if settings.schedule.count() == 0 {
            return Err(ExportError::FrameCount {
                format: "a GIF",
                needed: "one frame or more",
                got: 0,
            });
        }
        let mut sink = Self {
            output,
            settings,
            palette,
            pending: Vec::new(),
            delay: 0,
            summary: ExportSummary::default(),
        };
        sink.put(&sink.header())?;
        Ok(sink)
    }

    /// Signature, screen, global colours, and the loop extension that browsers know by Netscape's name.
    fn header(&self) -> Vec<u8> {
        let [width, height] = self.settings.size.map(|s| (s as u16).to_le_bytes());
        let bits = table_bits(&self.palette);
        let mut bytes = b"GIF89a".to_vec();
        bytes.extend(width);
        bytes.extend(height);
        bytes.extend([0xf0 | (bits - 1), 0, 0]);
        let colours = self.palette.colours();
        bytes.extend(colours.iter().flatten());
        bytes.resize(bytes.len() + 3 * ((1 << bits) - colours.len()), 0);
        if self.settings.repeat && self.settings.schedule.count() > 1 {
            bytes.extend(b"\x21\xff\x0bNETSCAPE2.0\x03\x01\0\0\0");
        }
        bytes
    }

    fn put(&mut self, bytes: &[u8]) -> Result<(), ExportError> {
        let written = self.output.write_all(bytes);
        written.map_err(|e| ExportError::write(self.output.name(), e))?;
        self.summary.bytes += bytes.len() as u64;
        Ok(())
    }

    /// Writes the waiting frame with all its delay; what exceeds the longest delay goes to frames that change nothing.
    fn flush_pending(&mut self) -> Result<(), ExportError> {
        if self.pending.is_empty() {
            return Ok(());
        }
        let mut frame = std::mem::take(&mut self.pending);
        while self.delay > 0 {
            // A remainder below the shortest delay would be shown too long: leave enough for the next frame.
            let mut delay = self.delay.min(LONGEST_DELAY);
            if self.delay - delay == 1 {
                delay -= 1;
            }
            self.put(&control_block(delay as u16, transparent(&self.palette)))?;
            self.put(&frame)?;
            self.delay -= delay;
            if self.delay > 0 {
                frame = unchanged_frame(&self.palette);
            }
        }
        Ok(())
    }
}

impl FrameSink for GifSink {
    fn size(&self) -> [u32; 2] {
        self.settings.size
    }

    fn coder(&self) -> Box<dyn FrameCoder> {
        Box::new(GifCoder {
            size: self.settings.size,
            bits: table_bits(&self.palette),
            mapper: Mapper::new(Arc::clone(&self.palette)),
            dictionary: Dictionary::new(),
            pixels: Vec::new(),
        })
    }

    fn write(&mut self, index: usize, coded: &[u8]) -> Result<(), ExportError> {
        if !coded.is_empty() {
            self.flush_pending()?;
            self.pending.clear();
            self.pending.extend_from_slice(coded);
        }
        let delay = self.settings.schedule.delay(index);
        self.delay = self.delay.saturating_add(delay);
        self.summary.frames += 1;
        self.summary.seconds += f64::from(delay) / 100.0;
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> Result<ExportSummary, ExportError> {
        self.flush_pending()?;
        self.put(&[0x3b])?;
        self.output.commit()?;
        Ok(self.summary)
    }
}

/// Bits of an index: enough for the colours and the one that means "as before".
fn table_bits(palette: &Palette) -> u8 {
    let entries = palette.colours().len() + 1;
    (entries.next_power_of_two().trailing_zeros() as u8).clamp(1, 8)
}

/// The index that means "as before": the first after the colours.
fn transparent(palette: &Palette) -> u8 {
    palette.colours().len().min(255) as u8
}

/// Graphic control extension: keep the picture, `delay` hundredths, one transparent index.
fn control_block(delay: u16, transparent: u8) -> [u8; 8] {
    let [low, high] = delay.to_le_bytes();
    [0x21, 0xf9, 4, 0b0000_0101, low, high, transparent, 0]
}

fn push_descriptor(area: &Area, out: &mut Vec<u8>) {
    out.push(0x2c);
    for value in [area.left, area.top, area.width, area.height] {
        out.extend((value as u16).to_le_bytes());
    }
    out.push(0);
}

/// A frame of one transparent pixel.
fn unchanged_frame(palette: &Palette) -> Vec<u8> {
    let mut frame = Vec::new();
    push_descriptor(&Area::whole([1, 1]), &mut frame);
    let bits = table_bits(palette).max(2);
    lzw::encode(
        &mut Dictionary::new(),
        bits,
        &[transparent(palette)],
        &mut frame,
    );
    frame
}

/// Maps frames to indices and codes what changed.
struct GifCoder {
    size: [u32; 2],
    bits: u8,
    mapper: Mapper,
    dictionary: Dictionary,
    pixels: Vec<u8>,
}

impl FrameCoder for GifCoder {
    fn prepare(&mut self, frame: &RgbaImage, prepared: &mut Vec<u8>) -> Result<(), ExportError> {
        let got = [frame.width(), frame.height()];
        if got != self.size {
            return Err(ExportError::FrameSize {
                expected: self.size,
                got,
            });
        }
        self.mapper.map(frame, prepared);
        Ok(())
    }

    fn code(
        &mut self,
        previous: Option<&[u8]>,
        current: &[u8],
        coded: &mut Vec<u8>,
    ) -> Result<(), ExportError> {
        coded.clear();
        let size = self.size.map(|s| s as usize);
        let area = match previous {
            None => Area::whole(size),
            Some(previous) => match Area::changed(previous, current, size[0]) {
                Some(area) => area,
                None => return Ok(()),
            },
        };
        self.pixels.clear();
        area.cut(current, size[0], &mut self.pixels);
        push_descriptor(&area, coded);
        lzw::encode(&mut self.dictionary, self.bits.max(2), &self.pixels, coded);
        Ok(())
    }
}
