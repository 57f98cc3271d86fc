//! Animated GIF: one palette, changed rectangles, absolute times. The container, LZW and colour live next door.

use super::costs::{Loss, Pixel};
use super::delta::PixelArea;
use super::error::ExportError;
use super::gif_file::GifFile;
use super::mapping::Mapper;
use super::matching::Matcher;
use super::palette::Palette;
use super::screen::Screen;
use super::target::Output;
use super::timing::Schedule;
use super::{ExportSummary, FrameCoder, FrameSink};
use image::RgbaImage;
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

/// How closely the frames are followed, against the size of the file: 1 (small) to 100.
///
/// Below 100, and a little at 100, a pixel may show a palette colour other than its nearest where that shortens
/// the file. Animations of at most 255 colours are exact at any quality.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Quality(u8);

impl Quality {
    /// No visible difference to the best a GIF can do.
    pub const BEST: Self = Self(100);
    /// For mail and web pages.
    pub const SMALL: Self = Self(50);

    /// A quality of 1 to 100; `None` outside.
    pub fn new(value: u8) -> Option<Self> {
        (1..=100).contains(&value).then_some(Self(value))
    }

    /// Both double every 12.5 steps, from 3.5 (rounded) and 12 squared levels at 100.
    fn loss(self) -> Loss {
        let steps = f64::from(100 - self.0.min(100));
        let scale = libm::exp2(steps / 12.5);
        Loss {
            price: (3.5 * scale).round() as i32,
            limit: (12.0 * scale).round() as i32,
        }
    }
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
    /// Fidelity against size.
    pub quality: Quality,
}

/// Writes a GIF frame by frame. Memory does not grow with the number of frames.
pub struct GifSink {
    file: GifFile,
    settings: GifSettings,
    palette: Arc<Palette>,
    screen: Screen,
    matcher: Matcher,
    sent: Vec<u8>,
    /// The frame waiting for its delay, where and as LZW: equal frames that follow lengthen it.
    pending: (PixelArea, Vec<u8>),
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
        let frames = settings.schedule.count();
        if frames == 0 {
            return Err(ExportError::FrameCount {
                format: "a GIF",
                needed: "one frame or more",
                got: 0,
            });
        }
        let colours = palette.colours();
        // The first index after the colours means "as before"; there is always room for it.
        let bits = ((colours.len() + 1).next_power_of_two().trailing_zeros() as u8).clamp(1, 8);
        let loss = if palette.is_exact() {
            Loss::NONE
        } else {
            settings.quality.loss()
        };
        let size = settings.size.map(|s| s as u16);
        let file = GifFile::new(output, size, colours, bits, settings.repeat && frames > 1)?;
        let transparent = file.transparent();
        Ok(Self {
            file,
            screen: Screen::new(settings.size.map(|s| s as usize), transparent),
            // LZW needs two bits even where one would do.
            matcher: Matcher::new(colours, transparent, bits.max(2), loss),
            settings,
            palette,
            sent: Vec::new(),
            pending: (PixelArea::whole([1, 1]), Vec::new()),
            delay: 0,
            summary: ExportSummary::default(),
        })
    }

    /// Writes the waiting frame with all its delay; what exceeds the longest delay goes to frames that change
    /// nothing.
    fn flush_pending(&mut self) -> Result<(), ExportError> {
        while self.delay > 0 {
            let mut delay = self.delay.min(LONGEST_DELAY);
            // One hundredth left over would be shown for too long: leave two.
            if self.delay - delay == 1 {
                delay -= 1;
            }
            let (area, codes) = &self.pending;
            self.file.add_frame(area, delay as u16, codes)?;
            self.delay -= delay;
            if self.delay > 0 {
                self.keep_unchanged();
            }
        }
        Ok(())
    }

    /// Lets a frame of one transparent pixel wait.
    fn keep_unchanged(&mut self) {
        let (area, codes) = &mut self.pending;
        *area = PixelArea::whole([1, 1]);
        codes.clear();
        self.matcher
            .encode(&[Pixel::STRETCH], &mut self.sent, codes);
    }
}

impl FrameSink for GifSink {
    fn size(&self) -> [u32; 2] {
        self.settings.size
    }

    fn coder(&self) -> Box<dyn FrameCoder> {
        let mapper = Mapper::new(Arc::clone(&self.palette));
        Box::new(GifCoder {
            size: self.settings.size,
            mapper,
        })
    }

    fn write(&mut self, index: usize, coded: &[u8]) -> Result<(), ExportError> {
        let (pixels, _) = coded.as_chunks::<4>();
        // Whether there is anything to send decides if the waiting frame is complete.
        let changed = self.screen.changes(pixels).map(|(area, pixels)| {
            let mut codes = Vec::new();
            self.matcher.encode(pixels, &mut self.sent, &mut codes);
            (area, codes)
        });
        if let Some((area, codes)) = changed {
            self.screen.show(&area, &self.sent);
            self.flush_pending()?;
            self.pending = (area, codes);
        }
        let delay = self.settings.schedule.delay(index);
        self.delay = self.delay.saturating_add(delay);
        self.summary.frames += 1;
        self.summary.seconds += self.settings.schedule.delay_seconds(index);
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> Result<ExportSummary, ExportError> {
        self.flush_pending()?;
        self.summary.bytes = self.file.commit()?;
        Ok(self.summary)
    }
}

/// Maps frames to indices.
struct GifCoder {
    size: [u32; 2],
    mapper: Mapper,
}

impl FrameCoder for GifCoder {
    fn code(&mut self, frame: &RgbaImage, coded: &mut Vec<u8>) -> Result<(), ExportError> {
        super::check_frame(frame, self.size)?;
        self.mapper.map(frame, coded);
        Ok(())
    }
}
