//! PNG from rows that arrive one after another: pictures that may be larger than the memory.

use super::error::ExportError;
use super::png::{check_size, drop_alpha};
use super::target::Output;
use png::{BitDepth, ColorType, Encoder, EncodingError, Filter};
use std::io::Write;

/// Writes RGBA rows as an RGB PNG; `next` fills a list with the next of them.
///
/// Errors: a side of 0 or too long, the file cannot be written, and those of `next`.
pub fn write_rows(
    size: [u32; 2],
    mut next: impl FnMut(&mut Vec<u8>) -> Result<(), ExportError>,
    output: &mut dyn Output,
) -> Result<(), ExportError> {
    check_size(size)?;
    let name = output.name().to_owned();
    let failed = |e: EncodingError| match e {
        EncodingError::IoError(source) => ExportError::write(&name, source),
        other => ExportError::Encode {
            name: name.clone(),
            message: other.to_string(),
        },
    };
    let mut encoder = Encoder::new(output, size[0], size[1]);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    // Such pictures are mostly flat.
    encoder.set_filter(Filter::NoFilter);
    let mut writer = encoder.write_header().map_err(failed)?;
    let mut stream = writer.stream_writer().map_err(failed)?;
    let (mut row, mut rgb) = (Vec::new(), Vec::new());
    for _ in 0..size[1] {
        row.clear();
        next(&mut row)?;
        rgb.clear();
        drop_alpha(&row, &mut rgb);
        let written = stream.write_all(&rgb);
        written.map_err(|e| ExportError::write(&name, e))?;
    }
    stream.finish().map_err(failed)?;
    writer.finish().map_err(failed)
}
