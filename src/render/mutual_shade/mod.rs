//! Shades between bodies: the shadow of the key light, and the ambient light that bodies hide from each other.
//!
//! Two small maps are computed on the CPU once per frame and read by both renderers: [`KeyMap`] contains the surfaces
//! nearest to the key light, [`SkyMap`] the openness of the visible surfaces. Positions and normals are in camera
//! space. Nothing is random: static parts do not change.

mod caster;
mod key_map;
mod rays;
mod scan;
mod sky_map;

pub use key_map::{KEY_MAP_SIDE, KeyMap, LIFT, RAMP};
pub use sky_map::{SkyMap, UNKNOWN};

use super::look::LightShare;
use super::{Camera, Frame, MeshList, Stage, StageMesh};
use caster::Caster;
use glam::DVec3;
use rays::Rays;
use std::sync::Arc;

/// The shades of a stage's frames. Keeps its memory between frames.
#[derive(Clone, Debug)]
pub struct MutualShade {
    meshes: Arc<[StageMesh]>,
    /// The box in which bodies shade each other.
    room: [DVec3; 2],
    /// What the key light sees.
    pub key: KeyMap,
    /// How open the nearest surfaces are.
    pub sky: SkyMap,
}

impl MutualShade {
    /// The shades of a stage; `None` where bodies do not shade each other.
    pub fn new(stage: &Stage) -> Option<Self> {
        let room = stage.mutual_shade.filter(|[low, high]| {
            let extent = (*high - *low).length();
            low.is_finite() && high.is_finite() && extent > 0.0 && extent.is_finite()
        })?;
        Some(Self {
            meshes: Arc::clone(&stage.meshes),
            room,
            key: KeyMap::new(),
            sky: SkyMap::new(stage.size, (room[1] - room[0]).length()),
        })
    }

    /// Makes the maps of a frame that is seen through `camera`.
    pub fn cast(&mut self, frame: &Frame, camera: &Camera) {
        let rays = Rays::new(camera, self.sky.picture());
        self.key.lay_map(self.room, camera);
        self.sky.clear();
        let eye = camera.eye(self.sky.picture());
        let meshes = MeshList::new(&self.meshes, &frame.meshes);
        for (number, instance) in frame.instances.iter().enumerate() {
            let mesh = meshes.get(instance.mesh);
            let Some(caster) = mesh.and_then(|mesh| Caster::new(instance, number, mesh, &eye))
            else {
                continue;
            };
            self.key.add(&caster);
            self.sky.add(&caster, &rays);
        }
        self.key.finish();
        self.sky.finish(&rays);
    }

    /// The light that reaches a surface at `place`, shown at pixel coordinates `at`; `normal` is on the visible side,
    /// with a length near 1.
    #[inline(always)]
    pub fn on(&self, at: [f32; 2], place: [f32; 3], normal: [f32; 3]) -> LightShare {
        [self.key.lit(place, normal), self.sky.open(at, -place[2])]
    }
}

#[cfg(test)]
mod tests;
