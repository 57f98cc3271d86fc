//! Workers that draw any sample of a motion: panes drawn and laid side by side, captions and plots added.

use super::playback::PlayOrder;
use crate::kinematics::motion::continuation::solve_motion;
use crate::kinematics::motion::sampling::path_times;
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::system::System;
use crate::plot::companion::Companion;
use crate::plot::raster::ChartPainter;
use crate::render::adapter::AdapterChoice;
use crate::render::open::{RendererChoice, open_renderer, open_strip_renderers};
use crate::render::overlay::Overlay;
use crate::render::strips::Strips;
use crate::render::{RenderError, Renderer, Stage, allow_drawing, matte};
use crate::scene::Scene;
use crate::staging::marks::Marks;
use crate::staging::{PictureOptions, Staging, panes};
use image::{GenericImage, RgbaImage};
use std::sync::Arc;

/// Draws samples of the motion by the index of their picture.
#[derive(Clone, Copy)]
pub struct Pictures<'a> {
    /// The scene, for its theme.
    pub scene: &'a Scene,
    /// The whole picture.
    pub staging: &'a Staging<'a>,
    /// Parts of it that are views of their own, with their top left pixels; empty for one view.
    pub panes: &'a [([u32; 2], Staging<'a>)],
    /// The sample that each picture shows.
    pub order: PlayOrder,
    /// A plot beside the motion.
    pub panel: Option<&'a Companion>,
}

/// Stages a motion with its panes, and hands the pictures of its samples to `draw`. The paths in them go through more poses, where
/// the samples are far apart.
pub fn with_pictures<T>(
    scene: &Scene,
    (system, samples): (&System, &Trajectory),
    options: PictureOptions,
    draw: impl FnOnce(Pictures) -> T,
) -> T {
    let times: Vec<f64> = samples.samples.iter().map(|s| s.time).collect();
    let (times, stride) = path_times(&scene.mechanism, &scene.actuation, &times);
    let finer = (stride > 1).then(|| solve_motion(system, &scene.actuation, &times));
    let trajectory = finer.as_ref().unwrap_or(samples);
    let views = match scene.view.four {
        true => panes::pane_scenes(scene),
        false => Vec::new(),
    };
    let panes = panes::pane_stagings(&views, trajectory, options, &Marks::default());
    let staging = Staging::new(scene, trajectory, options);
    draw(Pictures {
        scene,
        staging: &staging,
        panes: &panes,
        order: PlayOrder::plain(0, samples.samples.len()).divided(stride),
        panel: None,
    })
}

/// Draws a picture by its index.
pub type FrameWorker<'a> =
    Box<dyn FnMut(usize, &mut RgbaImage) -> Result<(), RenderError> + Send + 'a>;

/// What draws the pictures.
#[derive(Clone, Debug)]
pub struct DrawnBy {
    /// Kind of renderer.
    pub renderer: RendererChoice,
    /// Which adapter, where it is one.
    pub adapter: AdapterChoice,
    /// Most workers at a time.
    pub threads: usize,
}

impl Default for DrawnBy {
    fn default() -> Self {
        let renderer = RendererChoice::Auto;
        Self {
            renderer,
            adapter: renderer.default_adapter(),
            threads: crate::jobs::core_count(),
        }
    }
}

/// Workers, and the name of what draws.
pub struct Workers<'a> {
    /// All of them draw alike.
    pub list: Vec<FrameWorker<'a>>,
    /// Name of the renderer or its adapter.
    pub name: String,
}

impl<'a> Pictures<'a> {
    /// One worker a thread, or up to three for an adapter.
    ///
    /// Errors: no adapter of the kind asked for; a size that cannot be drawn.
    pub fn workers(self, by: &DrawnBy) -> Result<Workers<'a>, RenderError> {
        allow_drawing(self.staging.stage.size)?;
        let open = |stage| open_renderer(by.renderer, by.adapter.clone(), stage, by.threads);
        let (views, name) = self.open_views(&open)?;
        let list = views.into_iter().map(|views| self.worker(views));
        Ok(Workers {
            list: list.collect(),
            name,
        })
    }

    /// Up to `workers` workers that draw the first picture in strips, by their index. Always the built-in renderer.
    ///
    /// Errors: a size that cannot be drawn; a plot beside the motion, which is drawn as a whole.
    pub fn strip_workers(
        self,
        strips: Strips,
        workers: usize,
    ) -> Result<Vec<FrameWorker<'a>>, RenderError> {
        if self.panel.is_some() {
            let message = "a picture with a plot is not drawn in strips".to_owned();
            return Err(RenderError::Size(message));
        }
        let (views, _) = self.open_views(&|stage| open_strip_renderers(stage, workers))?;
        let list = views.into_iter().map(|views| {
            let mut draw = self.drawing(views);
            let worker: FrameWorker = Box::new(move |strip, image| {
                let first = strips.first_row(strip);
                draw(self.order.sample(0), Some(first), image)
            });
            worker
        });
        Ok(list.collect())
    }

    /// For every worker its views, and the name of what draws them.
    fn open_views(&self, open: Opener) -> Result<(Vec<Vec<FrameView<'a>>>, String), RenderError> {
        let parts = self.panes.iter().map(|(corner, pane)| (*corner, pane));
        let mut views: Vec<_> = parts.collect();
        if views.is_empty() {
            views.push(([0, 0], self.staging));
        }
        let view = &self.scene.view;
        let mut workers: Vec<Vec<FrameView<'a>>> = Vec::new();
        for (corner, staging) in views {
            let layers = open_layers(open, staging, view.transparent)?;
            workers.resize_with(layers.len(), Vec::new);
            for (worker, layers) in workers.iter_mut().zip(layers) {
                worker.push(FrameView::new(corner, staging, layers, view.background));
            }
        }
        let first = workers.first().and_then(|views| views.first());
        let name = first.map_or_else(String::new, |view| view.layers[0].name().to_owned());
        Ok((workers, name))
    }

    /// Draws a sample as a whole, or the rows from one on.
    fn drawing(
        self,
        mut views: Vec<FrameView<'a>>,
    ) -> impl FnMut(usize, Option<u32>, &mut RgbaImage) -> Result<(), RenderError> + Send + 'a {
        let mut captions = Overlay::new(self.scene.view.background);
        // The same picture before black, where one is needed.
        let mut on_black = RgbaImage::new(0, 0);
        let is_transparent = self.scene.view.transparent;
        move |sample, first, image| {
            if is_transparent && on_black.dimensions() != image.dimensions() {
                on_black = RgbaImage::new(image.width(), image.height());
            }
            let mut layers = Vec::from([&mut *image]);
            if is_transparent {
                layers.push(&mut on_black);
            }
            if self.panes.is_empty() {
                let mut views = views.iter_mut();
                views.try_for_each(|view| view.draw(sample, first, &mut layers))?;
            } else {
                for view in &mut views {
                    view.draw_into(sample, first, &mut layers)?;
                }
                let stage = &self.staging.stage;
                let frame = panes::frame_over(self.scene, self.staging, sample);
                let rows = [first.unwrap_or(0), stage.size[1]];
                for layer in &mut layers {
                    captions.draw_strip(&frame, &stage.camera, rows, layer);
                }
            }
            if is_transparent {
                matte::extract_alpha(image, &on_black);
            }
            Ok(())
        }
    }

    fn worker(self, views: Vec<FrameView<'a>>) -> FrameWorker<'a> {
        let [width, height] = self.staging.stage.size;
        let mut draw = self.drawing(views);
        let Some(panel) = self.panel else {
            return Box::new(move |picture, image| draw(self.order.sample(picture), None, image));
        };
        let (mut motion, mut painter) = (RgbaImage::new(width, height), ChartPainter::default());
        Box::new(move |picture, image| {
            let sample = self.order.sample(picture);
            draw(sample, None, &mut motion)?;
            panel.compose_frame(&motion, sample, &mut painter, image);
            Ok(())
        })
    }
}

/// One view of the motion and what draws it: once, or before white and before black.
struct FrameView<'a> {
    corner: [u32; 2],
    staging: &'a Staging<'a>,
    layers: Vec<Box<dyn Renderer>>,
    overlay: Overlay,
    /// Its own pictures, layer by layer, where it is a part of larger ones.
    own: Vec<RgbaImage>,
}

impl<'a> FrameView<'a> {
    fn new(
        corner: [u32; 2],
        staging: &'a Staging<'a>,
        layers: Vec<Box<dyn Renderer>>,
        background: [u8; 3],
    ) -> Self {
        Self {
            corner,
            staging,
            overlay: Overlay::new(background),
            own: vec![RgbaImage::new(0, 0); layers.len()],
            layers,
        }
    }

    /// Draws a sample as a whole, or the rows from `first` on, layer by layer.
    fn draw(
        &mut self,
        sample: usize,
        first: Option<u32>,
        images: &mut [&mut RgbaImage],
    ) -> Result<(), RenderError> {
        let rows = [first.unwrap_or(0), self.staging.stage.size[1]];
        let frame = self.staging.frame(sample);
        let camera = &frame.camera(&self.staging.stage);
        for (renderer, image) in self.layers.iter_mut().zip(images) {
            match first {
                None => renderer.draw(&frame, image)?,
                Some(first) => renderer.draw_strip(&frame, first, image)?,
            }
            self.overlay.draw_strip(&frame, camera, rows, image);
        }
        Ok(())
    }

    /// Draws into its part of larger pictures, which are whole or the rows from `first` on.
    fn draw_into(
        &mut self,
        sample: usize,
        first: Option<u32>,
        images: &mut [&mut RgbaImage],
    ) -> Result<(), RenderError> {
        let [width, height] = self.staging.stage.size;
        let [left, top] = self.corner;
        let rows = images.first().map_or(0, |image| image.height());
        // The rows that the view and the images have in common, as rows of the whole picture.
        let start = first.unwrap_or(0);
        let end = (start + rows).min(top + height);
        let from = start.max(top);
        if from >= end {
            return Ok(());
        }
        let mut own = std::mem::take(&mut self.own);
        for part in &mut own {
            if part.dimensions() != (width, end - from) {
                *part = RgbaImage::new(width, end - from);
            }
        }
        let mut parts: Vec<&mut RgbaImage> = own.iter_mut().collect();
        let drawn = self.draw(sample, first.map(|_| from - top), &mut parts);
        let mut pairs = images.iter_mut().zip(&own);
        let copied = pairs.try_for_each(|(image, part)| image.copy_from(part, left, from - start));
        self.own = own;
        drawn?;
        copied.map_err(|error| RenderError::Size(error.to_string()))
    }
}

/// Opens the renderers of a stage, one for each worker.
type Opener<'o> = &'o dyn Fn(Arc<Stage>) -> Result<Vec<Box<dyn Renderer>>, RenderError>;

/// For every worker its renderers of one view.
fn open_layers(
    open: Opener,
    staging: &Staging,
    transparent: bool,
) -> Result<Vec<Vec<Box<dyn Renderer>>>, RenderError> {
    let stages = if transparent {
        let grounds = [matte::WHITE, matte::BLACK];
        grounds.map(|ground| staging.stage_on(ground)).to_vec()
    } else {
        vec![Arc::clone(&staging.stage)]
    };
    let mut workers: Vec<Vec<Box<dyn Renderer>>> = Vec::new();
    for stage in stages {
        let renderers = open(stage)?;
        workers.resize_with(renderers.len(), Vec::new);
        for (worker, renderer) in workers.iter_mut().zip(renderers) {
            worker.push(renderer);
        }
    }
    Ok(workers)
}
