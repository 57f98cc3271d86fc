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

/// Opens renderers of a stage: `workers` (at least one) of the built-in kind, or one on an adapter.
///
/// Errors: no adapter for [`RendererChoice::Gpu`]; a device that fails; a picture beyond the adapter's limits.
/// `Auto` falls back to the built-in renderer in all these cases.
pub fn open(
    choice: RendererChoice,
    adapter: AdapterChoice,
    stage: Arc<Stage>,
    workers: usize,
) -> Result<Vec<Box<dyn Renderer>>, RenderError> {
    match choice {
        RendererChoice::Cpu => open_cpu(&stage, workers),
        RendererChoice::Gpu => Ok(vec![open_gpu(stage, adapter)?]),
        RendererChoice::Auto => match open_gpu(Arc::clone(&stage), adapter) {
            Ok(renderer) => Ok(vec![renderer]),
            Err(_) => open_cpu(&stage, workers),
        },
    }
}

/// The adapters of this machine, best first; empty without drivers or in a build without the `gpu` feature.
pub fn list_adapters() -> Vec<AdapterInfo> {
    #[cfg(feature = "gpu")]
    return super::gpu::adapter::list();
    #[cfg(not(feature = "gpu"))]
    return Vec::new();
}

fn open_cpu(stage: &Arc<Stage>, workers: usize) -> Result<Vec<Box<dyn Renderer>>, RenderError> {
    (0..workers.max(1))
        .map(|_| {
            let renderer = CpuRenderer::new(Arc::clone(stage))?;
            Ok(Box::new(renderer) as Box<dyn Renderer>)
        })
        .collect()
}

#[cfg(feature = "gpu")]
fn open_gpu(stage: Arc<Stage>, adapter: AdapterChoice) -> Result<Box<dyn Renderer>, RenderError> {
    Ok(Box::new(super::gpu::GpuRenderer::open(stage, adapter)?))
}

#[cfg(not(feature = "gpu"))]
fn open_gpu(_: Arc<Stage>, adapter: AdapterChoice) -> Result<Box<dyn Renderer>, RenderError> {
    Err(RenderError::NoAdapter(format!(
        "this build has no gpu renderer, so no {} can be used; build with the default features, or use \
         `--renderer cpu`",
        adapter.wanted()
    )))
}
