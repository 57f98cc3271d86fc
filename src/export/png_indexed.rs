//! PNG files with a palette: two thirds of the bytes, and few colours.

use super::error::ExportError;
use super::gif::index_mapper::Mapper;
use super::palette::Palette;
use super::png::{check_size, encoding_error};
use ::png::{BitDepth, ColorType, Compression, Encoder, Filter, SrgbRenderingIntent};
use image::RgbaImage;
use std::sync::Arc;

/// Colours of a picture: with four times as many the file is a fifth larger, and the mean difference half a level less.
const COLOURS: usize = 64;

/// Appends `image`, without its alpha, in up to 64 colours of its own. The same image gives the same bytes.
///
/// Errors: a side of 0 or too long.
pub fn encode_indexed(image: &RgbaImage, out: &mut Vec<u8>) -> Result<(), ExportError> {
    check_size([image.width(), image.height()])?;
    let palette = Arc::new(Palette::from_samples([image], &[], COLOURS));
    let mut pixels = Vec::new();
    Mapper::new(Arc::clone(&palette)).map(image, &mut pixels);
    let indices: Vec<u8> = pixels.as_chunks().0.iter().map(|[_, _, _, i]| *i).collect();
    let mut encoder = Encoder::new(out, image.width(), image.height());
    encoder.set_color(ColorType::Indexed);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_palette(palette.colours().as_flattened());
    // It chooses a filter, too; but a difference of indices says nothing.
    encoder.set_compression(Compression::High);
    encoder.set_filter(Filter::NoFilter);
    encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(&indices)?;
        writer.finish()
    });
    written.map_err(encoding_error)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use image::Rgba;

    /// Colours by their place: `steps` along each side, or one for all.
    fn picture(steps: u32) -> RgbaImage {
        RgbaImage::from_fn(96, 64, |x, y| {
            let level = |at: u32, side: u32| (at * steps / side * 255 / steps.max(1)) as u8;
            Rgba([level(x, 96), level(y, 64), 200, 255])
        })
    }

    fn read(file: &[u8]) -> RgbaImage {
        image::load_from_memory_with_format(file, image::ImageFormat::Png)
            .unwrap()
            .into_rgba8()
    }

    #[test]
    fn few_colours_are_exact_and_many_are_near() {
        for (steps, farthest) in [(0, 0), (7, 0), (64, 32)] {
            let drawn = picture(steps);
            let mut file = Vec::new();
            encode_indexed(&drawn, &mut file).unwrap();
            let shown = read(&file);
            assert_eq!(shown.dimensions(), drawn.dimensions());
            let off = drawn.as_raw().iter().zip(shown.as_raw());
            let off = off.map(|(a, b)| a.abs_diff(*b)).max().unwrap();
            assert!(off <= farthest, "{steps} steps: {off} levels off");
        }
        assert!(encode_indexed(&RgbaImage::new(0, 4), &mut Vec::new()).is_err());
    }
}
