//! `mechanim encode`: encodes existing frames into one file, with the same encoders as rendered ones.

use super::sinks;
use super::sinks::OpenFilm;
use crate::cli::args::files::EncodeArgs;
use crate::cli::io;
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::export::Format;
use crate::import::film::png_files;
use crate::import::{ImportError, PictureRows, natural_order, read_png};
use crate::limits::allow_picture;
use crate::render::BYTES_OF_DRAWN_PIXEL;
use crate::sorting::sort_by;
use image::{Rgba, RgbaImage};
use std::path::{Path, PathBuf};

/// Runs the verb.
pub fn run_encode(args: &EncodeArgs, term: &Term) -> Result<Outcome, Failure> {
    let format = sinks::film_format(&args.file)?;
    if format.is_model() {
        let message = format!(
            "{} contains shapes, which pictures do not have",
            format.name()
        );
        return Err(Failure::usage(message, Vec::new()));
    }
    let paths = picture_paths(args)?;
    if let Some(path) = paths.iter().find(|path| is_same(path, &args.file.out)) {
        return Err(io::is_input(path));
    }
    if format == Format::Png && paths.len() > 1 {
        let message = format!("{} contains one picture", args.file.out.display());
        let hint =
            "for all frames write a .gif, .apng, a folder, or a pattern such as frame-%04d.png";
        return Err(Failure::usage(message, vec![hint.to_owned()]));
    }
    let size = PictureRows::open(&paths[0])?.size();
    let frames = Frames {
        paths: &paths,
        size,
        opaque: holds_no_alpha(&format).then(|| format.name()),
        background: args.background,
    };
    let cores = crate::jobs::core_count();
    let count = args.file.threads.unwrap_or(cores).min(paths.len()).max(1);
    // As many at a time as fit into memory.
    let allowed = |at_once: usize| {
        let bytes = at_once as f64 * BYTES_OF_DRAWN_PIXEL;
        allow_picture(frames.size, bytes, "a picture")
    };
    let count = (1..=count).rev().find(|n| allowed(*n).is_ok()).unwrap_or(1);
    allowed(count)?;
    let destination = sinks::open_sink(&args.file, &format)?;
    let alpha = frames.opaque.is_none() && frames.are_translucent()?;
    let film = OpenFilm::new(&args.file, &format, frames.size, paths.len(), args.fps);
    let film = film.with_alpha(alpha).at_hand();
    let mut workers: Vec<_> = (0..count)
        .map(|_| move |index: usize, image: &mut RgbaImage| frames.read(index, image))
        .collect();
    let prepared = film.sink(destination, &mut workers, term)?;
    let summary = film.write(prepared, workers, term)?;
    film.tell(&summary, "", term);
    Ok(Outcome::Done)
}

/// All files in order.
fn picture_paths(args: &EncodeArgs) -> Result<Vec<PathBuf>, Failure> {
    let mut paths = Vec::new();
    for path in &args.frames {
        if path.is_dir() {
            paths.extend(png_files(path)?);
        } else {
            paths.push(path.clone());
        }
    }
    if paths.is_empty() {
        return Err(Failure::usage(
            "there are no PNG files in the folder",
            Vec::new(),
        ));
    }
    if !args.no_sort {
        sort_by(&mut paths, |a, b| natural_order(a, b));
    }
    Ok(paths)
}

fn is_same(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

fn holds_no_alpha(format: &Format) -> bool {
    matches!(format, Format::Gif | Format::Y4m | Format::Video(_))
}

/// Reads frames by their number.
#[derive(Clone, Copy)]
struct Frames<'a> {
    paths: &'a [PathBuf],
    size: [u32; 2],
    /// Name of the format, if it cannot hold alpha.
    opaque: Option<&'static str>,
    background: Option<[u8; 3]>,
}

impl Frames<'_> {
    fn read(&self, index: usize, image: &mut RgbaImage) -> Result<(), ImportError> {
        let path = &self.paths[index];
        // The previous picture is dropped first.
        *image = RgbaImage::new(0, 0);
        let mut frame = read_png(path)?;
        let got = <[u32; 2]>::from(frame.dimensions());
        if got != self.size {
            let (path, expected) = (path.clone(), self.size);
            return Err(ImportError::Size {
                path,
                expected,
                got,
            });
        }
        if let Some(background) = self.background {
            lay_over(&mut frame, background);
        }
        if let Some(format) = self.opaque.filter(|_| is_translucent(&frame)) {
            let path = path.clone();
            return Err(ImportError::Transparent { path, format });
        }
        *image = frame;
        Ok(())
    }

    /// Whether any frame is translucent: then the file needs alpha from its first byte on.
    fn are_translucent(&self) -> Result<bool, ImportError> {
        if self.background.is_some() {
            return Ok(false);
        }
        for path in self.paths {
            let mut rows = PictureRows::open(path)?;
            if !rows.has_alpha() {
                continue;
            }
            while let Some(row) = rows.next_row()? {
                if row.as_chunks::<4>().0.iter().any(|p| p[3] < 255) {
                    return Ok(true);
                }
            }
        }
        Ok(false)
    }
}

fn is_translucent(image: &RgbaImage) -> bool {
    image.pixels().any(|p| p.0[3] < 255)
}

/// Blends the sRGB codes, as browsers do.
fn lay_over(image: &mut RgbaImage, background: [u8; 3]) {
    for Rgba([r, g, b, a]) in image.pixels_mut() {
        let share = u32::from(*a);
        for (code, below) in [r, g, b].into_iter().zip(background) {
            let mix = share * u32::from(*code) + (255 - share) * u32::from(below);
            *code = ((mix + 127) / 255) as u8;
        }
        *a = 255;
    }
}
