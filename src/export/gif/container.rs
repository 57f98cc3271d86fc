//! The GIF around the compressed pixels: the `gif` crate's container over an output of ours.

use crate::export::changed_area::PixelArea;
use crate::export::error::ExportError;
use crate::export::target::Output;
use gif::{DisposalMethod, Encoder, EncodingError, Frame, Repeat};
use std::borrow::Cow;
use std::io::{self, Write};

/// A GIF under construction.
pub(super) struct GifFile {
    encoder: Encoder<CountedOutput>,
}

/// A frame as it is stored.
#[derive(Clone, Debug)]
pub(super) struct GifBlock {
    /// The rectangle that it covers.
    pub(super) area: PixelArea,
    /// The size of the symbols in bits and the LZW stream.
    pub(super) codes: Vec<u8>,
    /// The transparent index, which leaves a pixel unchanged.
    pub(super) transparent: u8,
    /// Its local colour table, used instead of the global one.
    pub(super) table: Option<Vec<u8>>,
}

/// A table of 2^`bits` colours; unused entries are black.
pub(super) fn table(colours: &[[u8; 3]], bits: u8) -> Vec<u8> {
    let mut table = colours.as_flattened().to_vec();
    // Room for the transparent index, which may be the first after the colours.
    table.resize(3 << bits, 0);
    table
}

impl GifFile {
    /// Writes the header: screen of `size` pixels, global table of 2^`bits` colours (1 to 8), and, to play endlessly,
    /// the Netscape loop extension, which every viewer knows.
    pub(super) fn new(
        output: Box<dyn Output>,
        size: [u16; 2],
        colours: &[[u8; 3]],
        bits: u8,
        repeat: bool,
    ) -> Result<Self, ExportError> {
        let name = output.name().to_owned();
        let table = table(colours, bits);
        let file = CountedOutput {
            output,
            bytes: 0,
            open: true,
        };
        let start = || {
            let mut encoder = Encoder::new(file, size[0], size[1], &table)?;
            if repeat {
                encoder.set_repeat(Repeat::Infinite)?;
            }
            encoder.get_mut().open = false;
            Ok(encoder)
        };
        Ok(Self {
            encoder: start().map_err(|error| encoding_error(&name, error))?,
        })
    }

    /// Adds a frame, shown for `delay` hundredths and left in place.
    pub(super) fn add_frame(&mut self, block: &GifBlock, delay: u16) -> Result<(), ExportError> {
        let area = &block.area;
        let frame = Frame {
            delay,
            dispose: DisposalMethod::Keep,
            transparent: Some(block.transparent),
            palette: block.table.clone(),
            left: area.left as u16,
            top: area.top as u16,
            width: area.width as u16,
            height: area.height as u16,
            buffer: Cow::Borrowed(&block.codes),
            ..Frame::default()
        };
        self.encoder.get_mut().open = true;
        let written = self.encoder.write_lzw_pre_encoded_frame(&frame);
        let file = self.encoder.get_mut();
        file.open = false;
        written.map_err(|error| encoding_error(file.output.name(), error))
    }

    /// Ends the file and makes it final; returns its length in bytes.
    pub(super) fn commit(mut self) -> Result<u64, ExportError> {
        let name = self.encoder.get_ref().output.name().to_owned();
        self.encoder.get_mut().open = true;
        let file = self.encoder.into_inner();
        let file = file.map_err(|error| encoding_error(&name, error))?;
        file.output.commit()?;
        Ok(file.bytes)
    }
}

/// Converts an error of the container; errors that are not the file's fault cannot occur with the frames passed here.
fn encoding_error(name: &str, error: EncodingError) -> ExportError {
    let source = match error {
        EncodingError::Io(source) => source,
        other => io::Error::other(other),
    };
    ExportError::write(name, source)
}

/// The output below the container. It takes bytes only while a call of [`GifFile`] is at work: an encoder that is dropped
/// writes the end of the file, and a film that was cut short must not end like a whole one.
struct CountedOutput {
    output: Box<dyn Output>,
    bytes: u64,
    open: bool,
}

impl Write for CountedOutput {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if !self.open {
            return Ok(bytes.len());
        }
        let written = self.output.write(bytes)?;
        self.bytes += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.output.flush()
    }
}
