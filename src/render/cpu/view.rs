//! The data shared by all tiles of a frame.

use super::assembly::TriangleAssembly;
use super::backdrop::Backdrop;
use super::lens::Lens;
use crate::render::contact_shadow::ContactShadow;
use crate::render::look::Surroundings;
use crate::render::mutual_shade::MutualShade;

/// What is the same for all tiles of a frame.
#[derive(Clone, Copy)]
pub(super) struct RasterView<'a> {
    pub(super) assembly: &'a TriangleAssembly,
    pub(super) lens: &'a Lens,
    pub(super) backdrop: &'a Backdrop,
    pub(super) shadow: Option<&'a ContactShadow>,
    /// How bodies shade each other.
    pub(super) shade: Option<&'a MutualShade>,
    pub(super) around: Surroundings,
    /// Whether something may be below the ground.
    pub(super) below_ground: bool,
}
