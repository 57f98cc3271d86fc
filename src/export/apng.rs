//! Animated PNG: every colour, changed rectangles, exact delays. Source: PNG specification, third edition, W3C 2025.

use super::changed_area::PixelArea;
use super::error::ExportError;
use super::png::{Effort, PngSettings, check_size, smallest_encoding};
use super::spool::Spool;
use super::target::Output;
use super::timing::{FrameTimes, Schedule, rate_fraction};
use super::{ExportSummary, FrameCoder, FrameSink};
use ::png::{BitDepth, BlendOp, ColorType, Compression, DisposeOp, Encoder, Filter, Writer};
use image::RgbaImage;

/// Both numbers of a delay are 16-bit fields.
const LARGEST_NUMBER: u32 = u16::MAX as u32;

/// Ticks per second for unevenly spaced frames: finer than any display.
const UNEVEN_TICKS: u32 = 10_000;

/// A transparent pixel, which shows the previous frame. Runs of it compress to half the bytes of the colours
/// themselves, and a quarter better still without a filter, which would smear their borders.
const LEFT_OUT: [u8; 4] = [0; 4];

/// The options of an APNG.
#[derive(Clone, Debug)]
pub struct ApngSettings {
    /// Size in pixels.
    pub size: [u32; 2],
    /// When each frame is shown.
    pub times: FrameTimes,
    /// Repeats forever; else plays once.
    pub repeat: bool,
    /// Compression effort.
    pub effort: Effort,
    /// Whether frames are translucent; otherwise their alpha must be 255 everywhere.
    pub alpha: bool,
}

/// Writes an APNG frame by frame. Memory does not grow with the number of frames.
pub struct ApngSink {
    output: Box<dyn Output>,
    /// Output of the encoder that has not been written yet.
    spool: Spool,
    writer: Writer<Spool>,
    size: [u32; 2],
    schedule: Schedule,
    ticks: u16,
    effort: Effort,
    alpha: bool,
    /// The previous frame, RGBA; empty before the first.
    shown: Vec<[u8; 4]>,
    /// Pixels of the rectangle being written.
    bytes: Vec<u8>,
    summary: ExportSummary,
}

impl ApngSink {
    /// Writes the header.
    ///
    /// Errors: a side of 0 or too long, no frames, times that do not rise, a failed write.
    pub fn new(output: Box<dyn Output>, settings: ApngSettings) -> Result<Self, ExportError> {
        check_size(settings.size)?;
        let count = settings.times.count();
        let frames = u32::try_from(count).ok().filter(|n| *n > 0);
        let frames = frames.ok_or(ExportError::FrameCount {
            format: "an APNG",
            needed: "one frame or more",
            got: count,
        })?;
        let ticks = ticks_per_second(&settings.times);
        let schedule = Schedule::in_ticks(settings.times, u32::from(ticks))?;
        let spool = Spool::default();
        let [width, height] = settings.size;
        let mut encoder = Encoder::new(spool.clone(), width, height);
        encoder.set_color(ColorType::Rgba);
        encoder.set_depth(BitDepth::Eight);
        encoder.set_compression(match settings.effort {
            Effort::Fast => Compression::Fast,
            // For the changes between frames the highest level saves nothing; the choice of filter does.
            Effort::Balanced | Effort::Small => Compression::Balanced,
        });
        // With blending, an unchanged pixel can be omitted; a translucent one would show the pixel below.
        let blend = if settings.alpha {
            BlendOp::Source
        } else {
            BlendOp::Over
        };
        let plays = u32::from(!settings.repeat);
        let writer = encoder
            .set_animated(frames, plays)
            .and_then(|()| encoder.set_blend_op(blend))
            .and_then(|()| encoder.set_dispose_op(DisposeOp::None))
            .and_then(|()| encoder.write_header());
        let mut sink = Self {
            output,
            spool,
            writer: writer.map_err(encoder_error)?,
            size: settings.size,
            schedule,
            ticks,
            effort: settings.effort,
            alpha: settings.alpha,
            shown: Vec::new(),
            bytes: Vec::new(),
            summary: ExportSummary::default(),
        };
        sink.drain_output()?;
        Ok(sink)
    }

    /// Passes the encoder's output on.
    fn drain_output(&mut self) -> Result<(), ExportError> {
        let bytes = self.spool.take();
        self.output.emit(&bytes)?;
        self.summary.bytes += bytes.len() as u64;
        self.spool.give_back(bytes);
        Ok(())
    }

    /// Chooses the filter for the pending bytes, pixels of a rectangle of `size`.
    fn choose_filter(&mut self, size: [u32; 2]) -> Result<(), ExportError> {
        let filter = match self.effort {
            Effort::Fast => Filter::Adaptive,
            Effort::Balanced if self.is_mostly_left_out() => Filter::NoFilter,
            Effort::Balanced => Filter::Adaptive,
            Effort::Small => {
                let settings = PngSettings {
                    size,
                    effort: Effort::Balanced,
                    alpha: true,
                    dpi: None,
                    texts: Vec::new(),
                };
                smallest_encoding(&self.bytes, &settings)?.0
            }
        };
        self.writer.set_filter(filter);
        Ok(())
    }

    /// Whether half of the pending bytes are unchanged pixels: then a filter does more harm than good.
    fn is_mostly_left_out(&self) -> bool {
        let (pixels, _) = self.bytes.as_chunks::<4>();
        let left_out = pixels.iter().filter(|p| **p == LEFT_OUT).count();
        !self.alpha && 2 * left_out >= pixels.len()
    }

    /// Encodes the pixels of `frame` inside `area`.
    fn put(&mut self, area: &PixelArea, frame: &[[u8; 4]], delay: u16) -> Result<(), ExportError> {
        self.bytes.clear();
        let width = self.size[0] as usize;
        if self.alpha || self.shown.is_empty() {
            let rows = area.rows(frame, width);
            rows.for_each(|row| self.bytes.extend(row.as_flattened()));
        } else {
            let rows = area.rows(frame, width).zip(area.rows(&self.shown, width));
            let pixels = rows.flat_map(|(new, old)| new.iter().zip(old));
            let kept = |(new, old): (&[u8; 4], &[u8; 4])| if new == old { LEFT_OUT } else { *new };
            self.bytes.extend(pixels.flat_map(kept));
        }
        self.choose_filter([area.width as u32, area.height as u32])?;
        let [left, top] = [area.left as u32, area.top as u32];
        let [width, height] = [area.width as u32, area.height as u32];
        let writer = &mut self.writer;
        // The encoder checks the new size at the old place, so the rectangle goes to the corner first.
        let done = writer
            .reset_frame_position()
            .and_then(|()| writer.set_frame_dimension(width, height))
            .and_then(|()| writer.set_frame_position(left, top))
            .and_then(|()| writer.set_frame_delay(delay, self.ticks))
            .and_then(|()| writer.write_image_data(&self.bytes));
        done.map_err(encoder_error)
    }
}

impl FrameSink for ApngSink {
    fn size(&self) -> [u32; 2] {
        self.size
    }

    fn coder(&self) -> Box<dyn FrameCoder> {
        Box::new(Pixels { size: self.size })
    }

    fn write(&mut self, index: usize, coded: &[u8]) -> Result<(), ExportError> {
        let (frame, _) = coded.as_chunks::<4>();
        let size = self.size.map(|s| s as usize);
        let area = if self.shown.is_empty() {
            PixelArea::whole(size)
        } else {
            // A frame without changes still needs a pixel to carry its delay.
            PixelArea::changed(&self.shown, frame, size[0]).unwrap_or(PixelArea::whole([1, 1]))
        };
        let delay = self.schedule.delay(index).min(LARGEST_NUMBER);
        self.put(&area, frame, delay as u16)?;
        self.shown.clear();
        self.shown.extend_from_slice(frame);
        self.summary.frames += 1;
        self.summary.seconds += self.schedule.delay_seconds(index);
        self.drain_output()
    }

    fn finish(self: Box<Self>) -> Result<ExportSummary, ExportError> {
        if self.summary.frames != self.schedule.count() {
            return Err(ExportError::FrameCount {
                format: "an APNG",
                needed: "as many frames as were announced",
                got: self.summary.frames,
            });
        }
        let Self {
            mut output,
            spool,
            writer,
            mut summary,
            ..
        } = *self;
        writer.finish().map_err(encoder_error)?;
        let end = spool.take();
        output.emit(&end)?;
        summary.bytes += end.len() as u64;
        output.commit()?;
        Ok(summary)
    }
}

/// Ticks per second for which every delay is a whole number, or as near to that as 16 bits allow.
fn ticks_per_second(times: &FrameTimes) -> u16 {
    let longest = (0..times.count())
        .map(|k| times.start(k + 1) - times.start(k))
        .fold(0.0, f64::max);
    let wanted = match times {
        FrameTimes::Uniform { fps, .. } => rate_fraction(*fps, LARGEST_NUMBER).0,
        FrameTimes::At { .. } => UNEVEN_TICKS,
    };
    let most = (f64::from(LARGEST_NUMBER) / longest.max(1.0)).floor();
    f64::from(wanted).min(most).max(1.0) as u16
}

fn encoder_error(error: ::png::EncodingError) -> ExportError {
    ExportError::Encode {
        name: "APNG".to_owned(),
        message: error.to_string(),
    }
}

/// Passes frames through unchanged.
pub(super) struct Pixels {
    pub(super) size: [u32; 2],
}

impl FrameCoder for Pixels {
    fn code(&mut self, frame: &RgbaImage, coded: &mut Vec<u8>) -> Result<(), ExportError> {
        super::check_frame(frame, self.size)?;
        coded.clear();
        coded.extend_from_slice(frame.as_raw());
        Ok(())
    }
}
