//! Pictures and tables of a live scene, byte by byte as the program writes them.

use super::following::motion_until;
use super::session::{LiveError, LiveScene, Opened};
use crate::export::film::{Destination, FilmSettings};
use crate::export::png::{Effort, PngSettings, encode_picture};
use crate::export::{Format, Stream};
use crate::kinematics::motion::proved::{Proofs, solve_proved};
use crate::kinematics::motion::sampling::frame_times;
use crate::kinematics::results::trajectory::Trajectory;
use crate::limits::{Resource, current_limits};
use crate::pictures::frames::{DrawnBy, Pictures, with_pictures};
use crate::pictures::texts::picture_texts;
use crate::render::adapter::AdapterChoice;
use crate::render::open::RendererChoice;
use crate::report::table::{TableColumns, write_csv};
use crate::scene::Overrides;
use crate::staging::PictureOptions;
use image::RgbaImage;
use std::fmt::Display;
use std::io::{Result as Written, Write};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, PoisonError};

/// Samples a pixel, as `render` takes them.
const SMOOTHNESS: u32 = 4;

/// The renderer whose pictures have the same bytes on every machine.
const DRAWN_BY: DrawnBy = DrawnBy {
    renderer: RendererChoice::Cpu,
    adapter: AdapterChoice::Software,
    threads: 1,
};

fn in_words(error: impl Display) -> LiveError {
    LiveError::Request(error.to_string())
}

impl LiveScene {
    /// Frames as `render` draws them; a pose moved by hand is a film of one frame.
    fn film(&self) -> Trajectory {
        let Opened { scene, system, .. } = &self.now;
        self.held().unwrap_or_else(|| {
            let times = frame_times(&scene.mechanism, &scene.actuation, scene.view.fps);
            motion_until(system, &scene.actuation, &times)
        })
    }

    /// The frame nearest to a time, of this size in pixels.
    ///
    /// Errors: a size that cannot be drawn.
    pub fn picture(&self, time: f64, size: [u32; 2]) -> Result<RgbaImage, LiveError> {
        let [width, height] = size.map(f64::from);
        current_limits().allow(Resource::Pixels, width * height, &"a picture")?;
        let film = self.film();
        let off = |k: &usize| (film.samples[*k].time - time).abs();
        let nearest = (0..film.samples.len()).min_by(|a, b| off(a).total_cmp(&off(b)));
        let frame = nearest.ok_or_else(|| LiveError::Request("no frame".to_owned()))?;
        self.drawn(&film, size, |pictures| {
            let mut image = RgbaImage::new(size[0], size[1]);
            let mut workers = pictures.workers(&DRAWN_BY).map_err(in_words)?.list;
            for draw in workers.iter_mut().take(1) {
                draw(frame, &mut image).map_err(in_words)?;
            }
            Ok(image)
        })
    }

    fn drawn<T>(&self, film: &Trajectory, size: [u32; 2], draw: impl FnOnce(Pictures) -> T) -> T {
        let samples = SMOOTHNESS;
        with_pictures(
            &self.now.scene,
            (&self.now.system, film),
            PictureOptions { size, samples },
            draw,
        )
    }

    /// A picture as PNG, with the texts that `render` writes into it.
    ///
    /// Errors: a size that cannot be drawn.
    pub fn png(&self, time: f64, size: [u32; 2]) -> Result<Vec<u8>, LiveError> {
        let file = Path::new(&self.source().name).file_name();
        let source = file.map_or(self.source().name.clone(), |name| {
            name.display().to_string()
        });
        let Overrides {
            parameters, guess, ..
        } = &self.overrides;
        let told = |option: &str, pairs: &[(String, String)]| -> Vec<String> {
            let pairs = pairs.iter();
            pairs
                .map(|(name, value)| format!("--{option}={name}={value}"))
                .collect()
        };
        let changes = [told("param", parameters), told("guess", guess)].concat();
        let settings = PngSettings {
            size,
            effort: Effort::Balanced,
            alpha: self.now.scene.view.transparent,
            dpi: None,
            texts: picture_texts(&self.mechanism().title, &source, &changes),
        };
        let mut png = Vec::new();
        encode_picture(&self.picture(time, size)?, &settings, &mut png).map_err(in_words)?;
        Ok(png)
    }

    /// The motion as an animated GIF.
    ///
    /// Errors: a size that cannot be drawn.
    pub fn gif(&self, size: [u32; 2]) -> Result<Vec<u8>, LiveError> {
        let film = self.film();
        let memory = FilmBuffer::default();
        self.drawn(&film, size, |mut pictures| {
            let view = &pictures.scene.view;
            pictures.order = pictures.order.played(view.playback, view.fps);
            let count = pictures.order.pictures();
            let settings = FilmSettings {
                needed_colours: pictures.staging.needed_colours(),
                alpha: pictures.scene.view.transparent,
                ..FilmSettings::new(&Format::Gif, size, count, self.now.scene.view.fps)
            };
            let never = AtomicBool::new(false);
            let file = Destination::File(Box::new(Stream::new("memory", memory.clone())));
            let mut workers = pictures.workers(&DRAWN_BY).map_err(in_words)?.list;
            let prepared = settings
                .open(file, &mut workers, &never)
                .map_err(in_words)?;
            let written = settings.write(prepared, workers, &|_, _| {}, &never);
            written.map(|_| ()).map_err(in_words)
        })?;
        Ok(memory.taken())
    }

    /// The table that `solve` writes.
    pub fn csv(&self) -> Vec<u8> {
        let Opened { scene, system, .. } = &self.now;
        let motion = self.held().unwrap_or_else(|| {
            // One row suffices for a mechanism that does not move.
            let moves = scene.actuation.drives.iter().any(|d| !d.is_constant());
            let times = match moves {
                true => frame_times(&scene.mechanism, &scene.actuation, scene.view.fps),
                false => vec![0.0],
            };
            solve_proved(system, &scene.actuation, &times, Proofs::Poses, &|| false)
        });
        let columns = TableColumns {
            redundant: system.redundant_rows() > 0,
            ..TableColumns::default()
        };
        let mut table = Vec::new();
        // Memory takes everything.
        let _ = write_csv(
            &scene.mechanism,
            &motion,
            columns,
            &mut Stream::new("memory", &mut table),
        );
        table
    }
}

/// A file in memory, to be taken when it is complete.
#[derive(Clone, Default)]
struct FilmBuffer(Arc<Mutex<Vec<u8>>>);

impl FilmBuffer {
    fn taken(&self) -> Vec<u8> {
        std::mem::take(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Write for FilmBuffer {
    fn write(&mut self, bytes: &[u8]) -> Written<usize> {
        let mut file = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        file.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Written<()> {
        Ok(())
    }
}
