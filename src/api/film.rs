//! Pictures and animations of a motion.

use super::error::{Error, ErrorKind};
use super::loaded::Loaded;
use crate::export::Format;
use crate::export::film::{Destination, FilmSettings};
use crate::export::gif::Quality;
use crate::kinematics::results::trajectory::Trajectory;
use crate::model::theme::Theme;
use crate::model::view_change::ViewChange;
use crate::pictures::frames::{DrawnBy, Pictures, with_pictures};
use crate::render::allow_drawing;
use crate::render::open::RendererChoice;
use crate::staging::PictureOptions;
use image::RgbaImage;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Frames per second for samples at arbitrary times.
const USUAL_RATE: f64 = 20.0;

/// Samples per pixel.
const SMOOTHNESS: u32 = 4;

/// Pictures of a motion: their appearance and their output. Returned by [`Motion::film`](crate::Motion::film).
#[derive(Clone)]
pub struct Film<'m> {
    loaded: &'m Loaded,
    trajectory: &'m Trajectory,
    size: [u32; 2],
    rate: f64,
    quality: Quality,
    theme: Option<Theme>,
    drawn_by: DrawnBy,
    cancel: Arc<AtomicBool>,
}

impl<'m> Film<'m> {
    pub(super) fn new(loaded: &'m Loaded, trajectory: &'m Trajectory) -> Self {
        let duration = loaded.scene.actuation.duration;
        let rate = trajectory.samples.len() as f64 / duration;
        Self {
            loaded,
            trajectory,
            size: [640, 480],
            rate: if rate.is_finite() && rate > 0.0 {
                rate
            } else {
                USUAL_RATE
            },
            quality: Quality::USUAL,
            theme: None,
            drawn_by: DrawnBy::default(),
            cancel: Arc::default(),
        }
    }

    /// Width and height in pixels, 640 by 480 by default.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let motion = Scene::builtin("four-bar")?.solve(Samples::Even(4))?;
    /// assert_eq!(motion.film().size(160, 90).picture(0)?.dimensions(), (160, 90));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn size(mut self, width: u32, height: u32) -> Self {
        self.size = [width, height];
        self
    }

    /// Frames per second; by default, the film lasts as long as the motion.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// # let folder = tempfile::tempdir()?;
    /// # let path = folder.path().join("a.gif");
    /// let motion = Scene::builtin("four-bar")?.solve(Samples::Even(5))?;
    /// let bytes = motion.film().size(80, 60).rate(10.0).write(&path)?;
    /// assert_eq!(std::fs::metadata(&path)?.len(), bytes);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn rate(mut self, frames_a_second: f64) -> Self {
        self.rate = frames_a_second;
        self
    }

    /// Quality of a GIF, from 1 to 100, by default 88: lower values allow small colour errors for smaller files.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// # let folder = tempfile::tempdir()?;
    /// # let path = folder.path().join("a.gif");
    /// let motion = Scene::builtin("four-bar")?.solve(Samples::Even(5))?;
    /// let best = motion.film().size(160, 120).write(&path)?;
    /// let small = motion.film().size(160, 120).quality(30).write(&path)?;
    /// assert!(small < best);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn quality(mut self, quality: u8) -> Self {
        self.quality = Quality::new(quality.clamp(1, 100)).unwrap_or(Quality::BEST);
        self
    }

    /// Draws light bodies on a dark background.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let motion = Scene::builtin("four-bar")?.solve(Samples::Even(4))?;
    /// let corner = motion.film().size(80, 60).dark().picture(0)?.get_pixel(79, 0).0;
    /// assert!(corner[0] < 100);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn dark(mut self) -> Self {
        self.theme = Some(Theme::Dark);
        self
    }

    /// Uses the built-in renderer, which draws the same bytes on every machine. By default, a hardware graphics adapter
    /// draws if there is one.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let motion = Scene::builtin("four-bar")?.solve(Samples::Even(4))?;
    /// let film = motion.film().size(80, 60).built_in_renderer();
    /// assert_eq!(film.picture(1)?, film.picture(1)?);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn built_in_renderer(mut self) -> Self {
        self.drawn_by.renderer = RendererChoice::Cpu;
        self.drawn_by.adapter = RendererChoice::Cpu.default_adapter();
        self
    }

    /// A film that is abandoned as soon as `cancel` is set: [`Film::write`] then fails and leaves an existing file unchanged.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// # use std::sync::{Arc, atomic::AtomicBool};
    /// # let folder = tempfile::tempdir()?;
    /// # let path = folder.path().join("a.gif");
    /// let motion = Scene::builtin("four-bar")?.solve(Samples::Even(5))?;
    /// let raised = Arc::new(AtomicBool::new(true));
    /// assert!(motion.film().until(&raised).write(&path).is_err());
    /// assert!(!path.exists());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn until(mut self, cancel: &Arc<AtomicBool>) -> Self {
        self.cancel = Arc::clone(cancel);
        self
    }

    /// The picture of sample `index`. If there is no pose, the picture says so.
    ///
    /// Errors: no such sample; a size that cannot be drawn.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let motion = Scene::builtin("seven-r")?.solve(Samples::Even(4))?;
    /// let picture = motion.film().size(64, 48).picture(3)?;
    /// assert!(picture.pixels().any(|p| *p != picture[(0, 0)]));
    /// assert!(motion.film().picture(4).is_err());
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn picture(&self, index: usize) -> Result<RgbaImage, Error> {
        let samples = self.trajectory.samples.len();
        if index >= samples {
            let why = format!("there is no sample {index}: the motion has {samples}, from 0");
            return Err(Error::new(ErrorKind::Argument, why, Vec::new()));
        }
        allow_drawing(self.size)?;
        let one = DrawnBy {
            threads: 1,
            ..self.drawn_by.clone()
        };
        self.staged(|pictures| {
            let mut workers = pictures.workers(&one)?.list;
            let mut image = RgbaImage::new(self.size[0], self.size[1]);
            for worker in workers.iter_mut().take(1) {
                worker(index, &mut image)?;
            }
            Ok(image)
        })
    }

    /// Writes all samples to a file: .gif, .apng, .y4m, .rgba, a folder or a pattern such as `frame-%04d.png`; a .png
    /// contains the first sample. Returns the number of bytes. An existing file is replaced when the new one is
    /// complete.
    ///
    /// Errors: an unknown extension; a failed write; a size that cannot be drawn.
    ///
    /// ```no_run
    /// # use mechanim::{Samples, Scene};
    /// let motion = Scene::builtin("gearshift")?.solve(Samples::Frames)?;
    /// motion.film().size(800, 600).dark().write("gearshift.gif")?;
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn write(&self, path: impl AsRef<Path>) -> Result<u64, Error> {
        let path = path.as_ref();
        let format = Format::from_path(path)?;
        if format.is_model() {
            let why = format!("{} contains shapes, not pictures", format.name());
            return Err(Error::new(ErrorKind::File, why, Vec::new()));
        }
        let destination = Destination::at(path, &format)?;
        let count = if format.is_still() {
            1
        } else {
            self.trajectory.samples.len()
        };
        self.staged(|mut pictures| {
            let playback = pictures.scene.view.playback;
            pictures.order = pictures.order.shortened(count).played(playback, self.rate);
            let count = pictures.order.pictures();
            let settings = FilmSettings {
                needed_colours: pictures.staging.needed_colours(),
                alpha: pictures.scene.view.transparent,
                quality: self.quality,
                ..FilmSettings::new(&format, self.size, count, self.rate)
            };
            let mut workers = pictures.workers(&self.drawn_by)?.list;
            let prepared = settings.open(destination, &mut workers, &self.cancel)?;
            let summary = settings.write(prepared, workers, &|_, _| {}, &self.cancel)?;
            Ok(summary.bytes)
        })
    }

    /// Prepares the motion for drawing and passes its pictures to `draw`.
    fn staged<T>(&self, draw: impl FnOnce(Pictures) -> Result<T, Error>) -> Result<T, Error> {
        let mut scene = self.loaded.scene.clone();
        let change = ViewChange {
            theme: self.theme,
            ..ViewChange::default()
        };
        change.apply(Arc::make_mut(&mut scene.view));
        let options = PictureOptions {
            size: self.size,
            samples: SMOOTHNESS,
        };
        let motion = (&*self.loaded.system, self.trajectory);
        with_pictures(&scene, motion, options, draw)
    }
}
