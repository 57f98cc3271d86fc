//! Pictures of a mechanism with paths drawn over it, and their writing as PNG.

use crate::cli::args::scene::SceneArgs;
use crate::cli::io;
use crate::cli::term::outcome::Failure;
use crate::export::Format;
use crate::plot::primitive::{DrawnPrimitive, LineStyle};
use crate::plot::raster::ChartPainter;
use crate::render::open::{RendererChoice, open_renderer};
use crate::render::overlay::Overlay;
use crate::render::{Label, LabelAnchor, RenderError};
use crate::staging::Staging;
use glam::DVec3;
use image::RgbaImage;
use std::path::Path;
use std::sync::Arc;

/// Height of the lines of text below the title, and where they begin, as fractions of the picture's height.
const LINE_SIZE: f64 = 0.024;
const FIRST_LINE: f64 = 0.085;
const NEXT_LINE: f64 = 0.042;
const INSET: f64 = 0.02;

/// A path in the world, drawn as a line of some pixels in front of everything.
pub struct PathLine {
    /// Its points.
    pub points: Vec<DVec3>,
    /// Style, widths in pixels.
    pub stroke: LineStyle,
}

/// Draws sample `index` with `paths` over it and `lines` of text below the title.
pub fn draw_paths(
    staging: &Staging,
    index: usize,
    paths: &[PathLine],
    lines: &[String],
    image: &mut RgbaImage,
) -> Result<(), RenderError> {
    let choice = RendererChoice::Cpu;
    let stage = &staging.stage;
    let mut frame = staging.frame(index);
    for mut renderer in open_renderer(choice, choice.default_adapter(), Arc::clone(stage), 1)? {
        renderer.draw(&frame, image)?;
    }
    let (camera, size) = (&frame.camera(stage), stage.size);
    let primitives: Vec<DrawnPrimitive> = paths
        .iter()
        .map(|path| {
            let points = path.points.iter().filter_map(|p| camera.project(*p, size));
            DrawnPrimitive::Line {
                points: points.map(|[x, y, _]| [x, y]).collect(),
                stroke: path.stroke,
                name: String::new(),
            }
        })
        .collect();
    ChartPainter::default().paint_primitives(&primitives, image);
    let [width, height] = size.map(f64::from);
    for (k, line) in lines.iter().enumerate() {
        frame.labels.push(Label {
            text: line.clone(),
            anchor: LabelAnchor::Screen([
                INSET * height / width,
                FIRST_LINE + NEXT_LINE * k as f64,
            ]),
            size: LINE_SIZE * height,
            colour: staging.theme().ink(),
            plate: false,
            yields: false,
        });
    }
    Overlay::new(stage.background).draw(&frame, camera, image);
    Ok(())
}

/// Refuses a picture that is not a PNG, or would overwrite an input of the command.
pub fn refuse_other(scene: &SceneArgs, path: &Path) -> Result<(), Failure> {
    if Format::from_path(path).ok() != Some(Format::Png) {
        return Err(Failure::unknown_kind(path, "picture", "known kind: .png"));
    }
    io::refuse_input(scene, path)
}
