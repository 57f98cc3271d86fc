//! Data shared by a scene, its motions and its checks.

use super::error::Error;
use crate::diag::Source;
use crate::kinematics::structure::system::System;
use crate::scene::{OtherDrives, Overrides, Scene, load_scene};
use std::sync::Arc;

/// A scene that has been read, with its analysed mechanism.
pub(super) struct Loaded {
    pub(super) text: Arc<Source>,
    pub(super) overrides: Overrides,
    pub(super) scene: Scene,
    pub(super) system: Arc<System>,
}

impl Loaded {
    /// Errors: errors in the scene; an under-determined mechanism.
    pub(super) fn new(text: Arc<Source>, overrides: Overrides) -> Result<Self, Error> {
        let scene = load_scene(&text, &overrides)?;
        let system = System::new(Arc::clone(&scene.mechanism), &scene.actuation)?;
        Ok(Self {
            text,
            overrides,
            scene,
            system: Arc::new(system),
        })
    }

    /// The same mechanism with another drive; nothing is read or analysed again.
    pub(super) fn driven(&self, drives: OtherDrives) -> Self {
        let mut scene = self.scene.clone();
        drives.replace_in(&mut scene.actuation);
        let mut overrides = self.overrides.clone();
        overrides.drives = Some(drives);
        Self {
            text: Arc::clone(&self.text),
            overrides,
            scene,
            system: Arc::clone(&self.system),
        }
    }
}
