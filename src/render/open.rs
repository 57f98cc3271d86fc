//! The choice between the renderers.

use super::adapter::{AdapterChoice, AdapterInfo};
use super::cpu::CpuRenderer;
use super::{RenderError, Renderer, Stage};
use std::sync::Arc;

/// Which renderer is asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RendererChoice {
    /// The adapter asked for if there is one, else the built-in renderer. With the default
    /// [`AdapterChoice::Hardware`] a software adapter is never taken: the built-in renderer is faster.
    #[default]
    Auto,
    /// A graphics adapter, or an error that says what is missing.
    Gpu,
    /// The built-in renderer.
    Cpu,
}

impl RendererChoice {
    /// The adapter to use if none is named: `Auto` takes hardware only, `Gpu` also a software adapter.
    pub fn default_adapter(self) -> AdapterChoice {
        match self {
            Self::Gpu => AdapterChoice::Any,
            Self::Auto | Self::Cpu => AdapterChoice::Hardware,
        }
    }
}

/// Most renderers on one adapter: one draws, one reads back, one is being prepared.
#[cfg(feature = "gpu")]
const FRAMES_IN_FLIGHT: usize = 3;

/// Opens renderers of a stage: `workers` (at least one) of the built-in kind, or as many on an adapter, up to three.
///
/// Errors: no adapter of the requested kind; a device that fails; a picture that the renderer cannot draw. `Auto` with
/// [`AdapterChoice::Hardware`] falls back to the built-in renderer instead; any other adapter was requested explicitly,
/// so its absence is an error.
pub fn open_renderer(
    choice: RendererChoice,
    adapter: AdapterChoice,
    stage: Arc<Stage>,
    workers: usize,
) -> Result<Vec<Box<dyn Renderer>>, RenderError> {
    match choice {
        RendererChoice::Cpu => open_cpu(&stage, workers),
        RendererChoice::Gpu => open_gpu(stage, adapter, workers),
        RendererChoice::Auto => {
            let fall_back = adapter == AdapterChoice::Hardware;
            match open_gpu(Arc::clone(&stage), adapter, workers) {
                Ok(renderers) => Ok(renderers),
                Err(_) if fall_back => open_cpu(&stage, workers),
                Err(error) => Err(error),
            }
        }
    }
}

/// Opens `workers` (at least one) built-in renderers that draw pictures of a stage in strips.
///
/// Errors: a picture that the renderer cannot draw.
pub fn open_strip_renderers(
    stage: Arc<Stage>,
    workers: usize,
) -> Result<Vec<Box<dyn Renderer>>, RenderError> {
    let first = CpuRenderer::for_strips(stage)?;
    Ok(copies_of(first, workers))
}

/// The adapters of this machine, best first; empty without drivers or in a build without the `gpu` feature.
pub fn list_adapters() -> Vec<AdapterInfo> {
    #[cfg(feature = "gpu")]
    return super::gpu::adapter::list_adapters();
    #[cfg(not(feature = "gpu"))]
    return Vec::new();
}

fn open_cpu(stage: &Arc<Stage>, workers: usize) -> Result<Vec<Box<dyn Renderer>>, RenderError> {
    // Preparing the stage (closed meshes, the ground) is done by one renderer; the others copy it.
    let first = CpuRenderer::new(Arc::clone(stage))?;
    Ok(copies_of(first, workers))
}

fn copies_of(first: CpuRenderer, workers: usize) -> Vec<Box<dyn Renderer>> {
    let copies = (1..workers).map(|_| Box::new(first.clone()) as Box<dyn Renderer>);
    let mut renderers: Vec<Box<dyn Renderer>> = copies.collect();
    renderers.push(Box::new(first));
    renderers
}

#[cfg(feature = "gpu")]
fn open_gpu(
    stage: Arc<Stage>,
    adapter: AdapterChoice,
    workers: usize,
) -> Result<Vec<Box<dyn Renderer>>, RenderError> {
    let first = super::gpu::GpuRenderer::open(stage, adapter)?;
    let others = (1..workers.min(FRAMES_IN_FLIGHT)).map(|_| first.sibling());
    let others = others.collect::<Result<Vec<_>, _>>()?;
    let all = std::iter::once(first).chain(others);
    Ok(all.map(|one| Box::new(one) as Box<dyn Renderer>).collect())
}

#[cfg(not(feature = "gpu"))]
fn open_gpu(
    _: Arc<Stage>,
    adapter: AdapterChoice,
    _: usize,
) -> Result<Vec<Box<dyn Renderer>>, RenderError> {
    Err(RenderError::NoAdapter(format!(
        "this build has no gpu renderer, so no {} can be used; build with the default features, or use \
         `--renderer cpu`",
        adapter.wanted()
    )))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use crate::math::Pose;
    use crate::render::look::Rim;
    use crate::render::{Camera, Frame, Projection};
    use image::RgbaImage;

    fn stage() -> Arc<Stage> {
        Arc::new(Stage {
            meshes: Arc::default(),
            size: [9, 7],
            samples: 4,
            camera: Camera {
                world_from_camera: Pose::IDENTITY,
                projection: Projection::Perspective { fov_y: 0.5 },
                near: 0.1,
                far: 10.0,
            },
            background: [1, 2, 3],
            rim: Rim::DARK,
            ground: None,
            edges: None,
            mutual_shade: None,
        })
    }

    #[test]
    fn the_built_in_renderer_comes_in_the_asked_number() {
        for (workers, expected) in [(0, 1), (1, 1), (3, 3)] {
            let adapter = RendererChoice::Cpu.default_adapter();
            let renderers = open_renderer(RendererChoice::Cpu, adapter, stage(), workers).unwrap();
            assert_eq!(renderers.len(), expected);
            assert!(renderers.iter().all(|r| r.name() == "cpu"));
        }
    }

    #[test]
    fn auto_always_draws() {
        let adapter = RendererChoice::Auto.default_adapter();
        let mut renderers = open_renderer(RendererChoice::Auto, adapter, stage(), 2).unwrap();
        let mut image = RgbaImage::new(9, 7);
        renderers[0].draw(&Frame::default(), &mut image).unwrap();
        assert!(image.pixels().all(|p| p.0 == [1, 2, 3, 255]));
    }

    #[test]
    fn an_adapter_asked_for_by_name_is_not_replaced() {
        for choice in [RendererChoice::Auto, RendererChoice::Gpu] {
            let adapter = AdapterChoice::Name("no adapter has this name".to_owned());
            let opened = open_renderer(choice, adapter, stage(), 1);
            assert!(matches!(opened, Err(RenderError::NoAdapter(_))));
        }
    }
}
