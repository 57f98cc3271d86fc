//! Animated GIF: one palette and further ones for frames that it misses, changed rectangles, absolute times.

mod canvas;
mod colour_costs;
mod container;
pub mod index_mapper;
mod local_palette;
mod lzw;
mod string_search;

use crate::export::changed_area::PixelArea;
use crate::export::error::ExportError;
use crate::export::palette::Palette;
use crate::export::target::Output;
use crate::export::timing::Schedule;
use crate::export::{ExportSummary, FrameCoder, FrameSink};
use canvas::Screen;
use colour_costs::{Loss, Pixel};
use container::{GifBlock, GifFile, table};
use image::RgbaImage;
use index_mapper::Mapper;
use local_palette::{OwnTable, translation};
use std::sync::Arc;
use string_search::Matcher;

/// Greatest side of a GIF, a 16-bit field.
const LONGEST_SIDE: u32 = u16::MAX as u32;

/// Longest delay of one GIF frame in hundredths, a 16-bit field.
const LONGEST_DELAY: u32 = u16::MAX as u32;

/// Number of frames from which the palette is computed. More than 12 did not reduce the error measurably.
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
/// the file. Animations of at most 255 colours are exact at any quality: a frame with colours that no sample showed
/// brings a table of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Quality(u8);

impl Quality {
    /// The best that a GIF can do.
    pub const BEST: Self = Self(100);
    /// Close to it and smaller: `render gearshift` takes 5 % fewer bytes.
    pub const USUAL: Self = Self(88);
    /// For mail and web pages.
    pub const SMALL: Self = Self(50);

    /// A quality of 1 to 100; `None` outside.
    pub fn new(value: u8) -> Option<Self> {
        (1..=100).contains(&value).then_some(Self(value))
    }

    /// Both double every 12.5 steps, from 3.5 (rounded) and 12 squared levels at 100.
    fn loss_limits(self) -> Loss {
        let steps = f64::from(100 - self.0.min(100));
        let scale = libm::exp2(steps / 12.5);
        Loss {
            price: (3.5 * scale).round() as i32,
            limit: (12.0 * scale).round() as i32,
        }
    }
}

/// The options of a GIF.
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
    /// What is coded with the palette.
    table: ColourTable,
    screen: Screen,
    sent: Vec<u8>,
    /// The frame waiting for its delay: equal frames after it lengthen it.
    pending: GifBlock,
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
        // The format stores sides in 16 bits.
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
        // The palette of the whole animation; one index stands for unchanged pixels.
        let table = ColourTable::new(&palette, settings.quality);
        let size = settings.size.map(|s| s as u16);
        let repeat = settings.repeat && frames > 1;
        let file = GifFile::new(output, size, palette.colours(), table.bits, repeat)?;
        Ok(Self {
            file,
            screen: Screen::new(settings.size.map(|s| s as usize), table.transparent),
            pending: table.unchanged_block(),
            table,
            settings,
            palette,
            sent: Vec::new(),
            delay: 0,
            summary: ExportSummary::default(),
        })
    }

    /// Writes the waiting frame with all its delay; what exceeds the longest delay goes to frames that change
    /// nothing.
    fn flush_pending(&mut self) -> Result<(), ExportError> {
        while self.delay > 0 {
            let mut delay = self.delay.min(LONGEST_DELAY);
            // One remaining hundredth would be shown for too long: leave two.
            if self.delay - delay == 1 {
                delay -= 1;
            }
            self.file.add_frame(&self.pending, delay as u16)?;
            self.delay -= delay;
            if self.delay > 0 {
                self.keep_unchanged();
            }
        }
        Ok(())
    }

    /// Queues a frame of one transparent pixel.
    fn keep_unchanged(&mut self) {
        self.pending = self.table.unchanged_block();
        let codes = &mut self.pending.codes;
        let matcher = &mut self.table.matcher;
        matcher.encode(&[Pixel::of_run_to(1)], &mut self.sent, codes);
    }

    /// A frame in the colours of the palette; `None` if nothing changes.
    fn plain(&mut self, pixels: &[[u8; 4]]) -> Option<GifBlock> {
        let mut block = self.table.unchanged_block();
        let (area, pixels) = self.screen.changes(pixels, None)?;
        let matcher = &mut self.table.matcher;
        matcher.encode(pixels, &mut self.sent, &mut block.codes);
        self.screen.show(&area, &self.sent);
        Some(GifBlock { area, ..block })
    }

    /// A frame with its own colour table.
    fn with_table(&mut self, pixels: &[[u8; 4]], own: &OwnTable) -> Option<GifBlock> {
        let mut local = ColourTable::new(&own.palette, self.settings.quality);
        let (global, colours) = (self.palette.colours(), own.palette.colours());
        let into = translation(global, colours, local.transparent);
        self.screen.change_table(&into, local.transparent);
        let mut block = local.unchanged_block();
        let changes = self.screen.changes(pixels, Some(&own.nearest));
        let changed = changes.map(|(area, pixels)| {
            let matcher = &mut local.matcher;
            matcher.encode(pixels, &mut self.sent, &mut block.codes);
            area
        });
        if let Some(area) = &changed {
            self.screen.show(area, &self.sent);
        }
        let back = translation(colours, global, self.table.transparent);
        self.screen.change_table(&back, self.table.transparent);
        Some(GifBlock {
            area: changed?,
            table: Some(table(colours, local.bits)),
            ..block
        })
    }
}

/// A colour table and the encoder of its pixels.
struct ColourTable {
    matcher: Matcher,
    /// The first index after the colours, which means "unchanged"; there is always room for it.
    transparent: u8,
    /// The table has 2 to this power entries.
    bits: u8,
}

impl ColourTable {
    fn new(palette: &Palette, quality: Quality) -> Self {
        let colours = palette.colours();
        let transparent = colours.len().min(255) as u8;
        let bits = ((colours.len() + 1).next_power_of_two().trailing_zeros() as u8).clamp(1, 8);
        let loss = if palette.is_exact() {
            Loss::NONE
        } else {
            quality.loss_limits()
        };
        Self {
            // LZW needs two bits even where one would do.
            matcher: Matcher::new(colours, transparent, bits.max(2), loss),
            transparent,
            bits,
        }
    }

    /// A block of one pixel without codes.
    fn unchanged_block(&self) -> GifBlock {
        GifBlock {
            area: PixelArea::whole([1, 1]),
            codes: Vec::new(),
            transparent: self.transparent,
            table: None,
        }
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
        let delay = self.settings.schedule.delay(index);
        if delay == 0 {
            return Ok(());
        }
        let [width, height] = self.settings.size.map(|s| s as usize);
        let own = OwnTable::read(coded, width * height);
        let (pixels, _) = coded[..4 * width * height].as_chunks::<4>();
        // Whether there is anything to send decides if the waiting frame is complete.
        let block = match &own {
            Some(own) => self.with_table(pixels, own),
            None => self.plain(pixels),
        };
        if let Some(block) = block {
            self.flush_pending()?;
            self.pending = block;
        }
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
        crate::export::check_frame(frame, self.size)?;
        self.mapper.map(frame, coded);
        if let Some(missed) = self.mapper.missed() {
            OwnTable::new(frame, missed).append(coded);
        }
        Ok(())
    }
}
