//! The pictures of an APNG, each composed with those before it as the PNG specification, third edition, describes the chunk `fcTL`:
//! what `dispose_op` clears is cleared before the picture is kept for a later part that is taken back.

use super::picture::ImportError;
use image::{Pixel, Rgba, RgbaImage};
use png::{BlendOp, ColorType, Decoder, DisposeOp, FrameControl, Limits, Reader, Transformations};
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// What is done to a part's place before the next part is drawn.
enum Disposal {
    Cleared(FrameControl),
    /// The picture without the part.
    Restored(RgbaImage),
}

/// The pictures, one after another, with the seconds that each is shown.
pub(super) struct ApngPictures {
    path: PathBuf,
    reader: Reader<BufReader<File>>,
    canvas: RgbaImage,
    disposal: Option<Disposal>,
    part: Vec<u8>,
    left: u32,
}

impl ApngPictures {
    /// Reads the head; `most_bytes` of memory may be used beside the picture. `None` if the file is not animated.
    ///
    /// Errors: not a PNG, or one that is damaged.
    pub(super) fn open(
        path: &Path,
        file: BufReader<File>,
        most_bytes: usize,
    ) -> Result<Option<Self>, ImportError> {
        let refuse = |e| ImportError::decode(path, e);
        let mut decoder = Decoder::new_with_limits(file, Limits { bytes: most_bytes });
        decoder
            .set_transformations(Transformations::normalize_to_color8() | Transformations::ALPHA);
        let reader = decoder.read_info().map_err(refuse)?;
        let info = reader.info();
        let Some(animation) = info.animation_control else {
            return Ok(None);
        };
        Ok(Some(Self {
            path: path.to_owned(),
            canvas: RgbaImage::new(0, 0),
            disposal: None,
            part: Vec::new(),
            left: animation.num_frames,
            reader,
        }))
    }

    /// How often it plays; 0 is without end.
    pub(super) fn plays(&self) -> u32 {
        self.reader
            .info()
            .animation_control
            .map_or(1, |a| a.num_plays)
    }

    fn picture(&mut self) -> Result<(RgbaImage, f64), ImportError> {
        let control = self.next_part()?;
        // Made with the first picture, for which memory has been asked.
        if self.canvas.is_empty() {
            let info = self.reader.info();
            self.canvas = RgbaImage::new(info.width, info.height);
        }
        match self.disposal.take() {
            None => {}
            Some(Disposal::Restored(picture)) => self.canvas = picture,
            Some(Disposal::Cleared(place)) => {
                each_place(&place, |x, y, _| {
                    if let Some(pixel) = self.canvas.get_pixel_mut_checked(x, y) {
                        *pixel = Rgba([0; 4]);
                    }
                });
            }
        }
        self.disposal = match control.dispose_op {
            DisposeOp::None => None,
            DisposeOp::Background => Some(Disposal::Cleared(control)),
            DisposeOp::Previous => Some(Disposal::Restored(self.canvas.clone())),
        };
        let is_grey = self.reader.output_color_type().0 == ColorType::GrayscaleAlpha;
        let part = &self.part;
        each_place(&control, |x, y, k| {
            let new = match is_grey {
                true => part
                    .get(2 * k..2 * k + 2)
                    .map(|p| Rgba([p[0], p[0], p[0], p[1]])),
                false => part
                    .get(4 * k..4 * k + 4)
                    .map(|p| Rgba([p[0], p[1], p[2], p[3]])),
            };
            if let (Some(new), Some(pixel)) = (new, self.canvas.get_pixel_mut_checked(x, y)) {
                match control.blend_op {
                    BlendOp::Source => *pixel = new,
                    BlendOp::Over => pixel.blend(&new),
                }
            }
        });
        // No denominator stands for hundredths.
        let parts = if control.delay_den == 0 {
            100
        } else {
            control.delay_den
        };
        let seconds = f64::from(control.delay_num) / f64::from(parts);
        Ok((self.canvas.clone(), seconds))
    }

    /// Reads the next part of the animation; a first image without a place in it is passed over.
    fn next_part(&mut self) -> Result<FrameControl, ImportError> {
        loop {
            let size = self.reader.output_buffer_size().unwrap_or(0);
            self.part.resize(size, 0);
            let read = self.reader.next_frame(&mut self.part);
            read.map_err(|e| ImportError::decode(&self.path, e))?;
            if let Some(control) = self.reader.info().frame_control {
                return Ok(control);
            }
        }
    }
}

impl Iterator for ApngPictures {
    type Item = Result<(RgbaImage, f64), ImportError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.left = self.left.checked_sub(1)?;
        let picture = self.picture();
        if picture.is_err() {
            self.left = 0;
        }
        Some(picture)
    }
}

/// Calls `visit` with the place of every pixel of a part in the picture, and its number in the part.
fn each_place(part: &FrameControl, mut visit: impl FnMut(u32, u32, usize)) {
    for row in 0..part.height {
        for column in 0..part.width {
            let number = row as usize * part.width as usize + column as usize;
            visit(part.x_offset + column, part.y_offset + row, number);
        }
    }
}
