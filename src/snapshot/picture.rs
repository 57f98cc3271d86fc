//! A picture of the list, drawn by the built-in renderer (the same bytes on every machine) or by another one.

use super::manifest::{GoldenPicture, PictureInstant};
use crate::diag::SceneError;
use crate::kinematics::motion::continuation::solve_motion;
use crate::kinematics::motion::sampling::{allow_samples, frame_times, path_times};
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::block::StructureError;
use crate::kinematics::structure::system::System;
use crate::render::cpu::CpuRenderer;
use crate::render::overlay::Overlay;

use crate::limits::{LimitExceeded, allow_picture};
use crate::render::BYTES_OF_DRAWN_PIXEL;
use crate::render::{RenderError, Renderer, Stage};
use crate::scene::source::{open_source, place_below};
use crate::scene::{Overrides, Scene, builtin, load_scene};
use crate::staging::marks::Marks;
use crate::staging::{PictureOptions, Staging, panes};
use image::RgbaImage;
use std::path::Path;
use std::sync::Arc;

/// Why a picture of the list could not be drawn.
#[derive(Debug, thiserror::Error)]
pub enum DrawError {
    /// The scene cannot be read.
    #[error("{why}; the scene `{name}` is neither a built-in one nor a file beside the list")]
    Missing {
        /// Its name in the list.
        name: String,
        /// In words.
        why: String,
    },
    /// It needs more than the limits allow.
    #[error(transparent)]
    Limit(#[from] LimitExceeded),
    /// The scene has mistakes.
    #[error("the scene has errors")]
    Scene(#[from] Box<SceneError>),
    /// The mechanism is ill-posed.
    #[error(transparent)]
    Structure(#[from] StructureError),
    /// There is no such instant.
    #[error("{0}")]
    Instant(String),
    /// The renderer refused.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// Opens a renderer of a stage.
pub type OpenRenderer<'a> = &'a dyn Fn(Arc<Stage>) -> Result<Box<dyn Renderer>, RenderError>;

/// Draws `picture` with the built-in renderer; scenes that are files are looked for in `folder`. Where no pose exists the
/// picture says so.
///
/// Errors: a scene that cannot be read or has mistakes, an instant outside its motion, a size that cannot be drawn.
pub fn draw_picture(picture: &GoldenPicture, folder: &Path) -> Result<RgbaImage, DrawError> {
    draw_with(picture, folder, &|stage| {
        Ok(Box::new(CpuRenderer::new(stage)?))
    })
}

/// The same with renderers that `open` opens, one for each view.
pub fn draw_with(
    picture: &GoldenPicture,
    folder: &Path,
    open: OpenRenderer,
) -> Result<RgbaImage, DrawError> {
    let scene = picture_scene(picture, folder)?;
    let (frames, frame) = picture_times(&scene, picture.instant)?;
    let (times, stride) = path_times(&scene.mechanism, &scene.actuation, &frames);
    let index = frame * stride;
    allow_picture(picture.size, BYTES_OF_DRAWN_PIXEL, &picture.file)?;
    allow_samples(&scene.mechanism, times.len())?;
    let system = System::new(Arc::clone(&scene.mechanism), &scene.actuation)?;
    let trajectory = solve_motion(&system, &scene.actuation, &times);
    let options = PictureOptions {
        size: picture.size,
        samples: picture.samples,
    };
    let whole = Staging::new(&scene, &trajectory, options);
    if scene.view.four {
        return draw_four(&scene, &trajectory, &whole, index, open);
    }
    draw_one(&whole, index, open)
}

/// One view.
fn draw_one(staging: &Staging, index: usize, open: OpenRenderer) -> Result<RgbaImage, DrawError> {
    let stage = &staging.stage;
    let mut renderer = open(Arc::clone(stage))?;
    let frame = staging.frame(index);
    let mut image = RgbaImage::new(stage.size[0], stage.size[1]);
    renderer.draw(&frame, &mut image)?;
    Overlay::new(stage.background).draw(&frame, &frame.camera(stage), &mut image);
    Ok(image)
}

/// Four views in one picture, as `render --view four` lays them out.
fn draw_four(
    scene: &Scene,
    trajectory: &Trajectory,
    whole: &Staging,
    index: usize,
    open: OpenRenderer,
) -> Result<RgbaImage, DrawError> {
    let stage = &whole.stage;
    let options = PictureOptions {
        size: stage.size,
        samples: stage.samples,
    };
    let scenes = panes::pane_scenes(scene);
    let mut image = RgbaImage::new(stage.size[0], stage.size[1]);
    for ([x, y], pane) in panes::pane_stagings(&scenes, trajectory, options, &Marks::default()) {
        let view = draw_one(&pane, index, open)?;
        image::imageops::replace(&mut image, &view, x.into(), y.into());
    }
    let frame = panes::frame_over(scene, whole, index);
    Overlay::new(stage.background).draw(&frame, &stage.camera, &mut image);
    Ok(image)
}

fn picture_scene(picture: &GoldenPicture, folder: &Path) -> Result<Scene, DrawError> {
    let path = folder.join(&picture.scene);
    let missing = |why| DrawError::Missing {
        name: picture.scene.clone(),
        why,
    };
    let source = match builtin::find_builtin(&picture.scene) {
        Some(source) => source,
        None => {
            let own = (folder, "list's");
            place_below(&picture.scene, own, &picture.folders).map_err(missing)?;
            open_source(&path).map_err(|e| missing(e.message))?
        }
    };
    let overrides = Overrides {
        parameters: picture.parameters.clone(),
        inputs: picture.inputs.clone(),
        guess: picture.guess.clone(),
        folder: path.parent().unwrap_or(folder).to_owned(),
        allowed_folders: picture.folders.clone(),
        ..Overrides::default()
    };
    let mut scene = load_scene(&source, &overrides).map_err(Box::new)?;
    picture.view.apply(Arc::make_mut(&mut scene.view));
    Ok(scene)
}

/// The times that are solved, as `render` does: the whole motion frames the picture and leads to its branch.
fn picture_times(scene: &Scene, instant: PictureInstant) -> Result<(Vec<f64>, usize), DrawError> {
    let duration = scene.actuation.duration;
    let mut times = frame_times(&scene.mechanism, &scene.actuation, scene.view.fps);
    match instant {
        PictureInstant::Frame(index) if index < times.len() => Ok((times, index)),
        PictureInstant::Frame(index) => {
            let last = times.len() - 1;
            let message = format!("the motion has frames 0 to {last}, {index} is outside");
            Err(DrawError::Instant(message))
        }
        PictureInstant::Time(time) if (0.0..=duration).contains(&time) => {
            let index = times.partition_point(|t| *t < time);
            if times.get(index) != Some(&time) {
                times.insert(index, time);
            }
            Ok((times, index))
        }
        PictureInstant::Time(time) => {
            let message = format!("the motion lasts from 0 to {duration} s, {time} is outside");
            Err(DrawError::Instant(message))
        }
    }
}
