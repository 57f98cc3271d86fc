//! Large stills: whether a picture is drawn and written in strips, and in how many at a time.

use crate::cli::args::motion::RenderArgs;
use crate::cli::args::values::{MAX_PIXELS, pixels_of, too_many_pixels_of_poster};
use crate::cli::term::outcome::Failure;
use crate::export::Format;
use crate::limits::allow_poster;
use crate::pictures::frames::DrawnBy;
use crate::render::BYTES_OF_DRAWN_PIXEL;
use crate::render::adapter::AdapterChoice;
use crate::render::open::RendererChoice;
use crate::render::strips::Strips;

/// Stills with more pixels are drawn in strips: as a whole they would take half a gigabyte and one processor.
const MOST_AT_ONCE: u64 = 16_000_000;

/// A still that is never in memory as a whole.
#[derive(Clone, Copy)]
pub struct Poster {
    /// Its parts.
    pub strips: Strips,
    /// Number of strips that are drawn at the same time.
    pub workers: usize,
}

/// How a large still is divided; `None` for all other output. `transparent` pictures are drawn twice.
///
/// Errors: more pixels than this output may have, or than the limits of the run permit.
pub fn plan_poster(
    args: &RenderArgs,
    format: &Format,
    by: &DrawnBy,
    transparent: bool,
) -> Result<Option<Poster>, Failure> {
    let pixels = pixels_of(args.size);
    if *format != Format::Png {
        return match pixels {
            0..=MAX_PIXELS => Ok(None),
            _ => Err(Failure::usage(
                format!("--size: {}", too_many_pixels_of_poster()),
                Vec::new(),
            )),
        };
    }
    // An adapter that is asked for by name, or by its kind, draws the whole picture.
    let built_in = match by.renderer {
        RendererChoice::Cpu => true,
        RendererChoice::Auto => by.adapter == AdapterChoice::Hardware,
        RendererChoice::Gpu => false,
    };
    let hint = match (built_in, args.panel.is_some()) {
        (true, false) if pixels <= MOST_AT_ONCE => return Ok(None),
        (true, false) => {
            let layers = if transparent { 2 } else { 1 };
            let (strips, workers) = Strips::plan(args.size, layers, by.threads);
            let pixels = pixels_of([strips.size[0], strips.rows]) as f64;
            let bytes = pixels * BYTES_OF_DRAWN_PIXEL * (layers * workers) as f64;
            allow_poster(args.size, bytes, "a picture of --size")?;
            return Ok(Some(Poster { strips, workers }));
        }
        _ if pixels <= MAX_PIXELS => return Ok(None),
        (_, true) => "leave out --panel, or choose a smaller --size",
        (false, _) => "leave out --renderer and --adapter, or choose a smaller --size",
    };
    let millions = MAX_PIXELS / 1_000_000;
    let message = format!(
        "pictures of more than {millions} million pixels are drawn by the built-in renderer, without a plot"
    );
    Err(Failure::usage(message, vec![hint.to_owned()]))
}
