//! What a scene, its motions and its checks share.

use crate::kinematics::structure::system::System;
use crate::scene::Scene;

/// A scene as read, and its mechanism as analysed.
pub(super) struct Loaded {
    pub(super) scene: Scene,
    pub(super) system: System,
}
