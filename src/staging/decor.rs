//! Additions to the bodies in a picture: trails, ghosts, arrows, axes and joint symbols.

use super::arrows::Arrows;
use super::axes::{self, AxisSigns};
use super::body_meshes::StagedPart;
use super::joint_symbols::JointSymbols;
use super::ticks::{self, TickMarks};
use super::trails::{self, TracePart, TrailLook};
use super::{bounds, ghosts, joints};
use crate::kinematics::results::trajectory::{ClosedPose, Trajectory};
use crate::render::{Instance, Label, StageMesh};
use crate::scene::Scene;
use glam::DVec3;

/// A scene and its motion.
type MovingDecor<'a> = (&'a Scene, &'a Trajectory);

/// Everything drawn in addition to the bodies; empty if the scene requests nothing.
pub struct DecorParts {
    extent: f64,
    joints: JointSymbols,
    axes: AxisSigns,
    traces: Vec<TracePart>,
    ticks: Vec<TickMarks>,
    arrows: Option<Arrows>,
    ghosts: Vec<usize>,
}

impl DecorParts {
    /// Additions that need space in the picture; adds their points to `bounds`.
    pub fn before_camera(
        (scene, trajectory): MovingDecor,
        (bounds, up): (&mut Vec<DVec3>, DVec3),
        meshes: &mut Vec<StageMesh>,
    ) -> Self {
        let (mechanism, decor) = (&scene.mechanism, &scene.view.decor);
        let extent = bounds::box_of(bounds).map_or(1.0, |[low, high]| (high - low).length());
        // A scene without bodies draws its joints and links instead.
        let are_shown = decor.joints || mechanism.has_no_shapes();
        let joints = JointSymbols::new((scene, are_shown), trajectory, (extent, up), meshes);
        bounds.extend(joints.still_points());
        if let Some(length) = axes::world_length(decor.axes, extent) {
            bounds.extend(DVec3::AXES.map(|axis| axis * length));
            bounds.push(DVec3::ZERO);
        }
        Self {
            extent,
            joints,
            axes: AxisSigns::new(decor.axes, extent, meshes),
            traces: Vec::new(),
            ticks: Vec::new(),
            arrows: None,
            ghosts: ghosts::ghost_samples(&decor.ghosts, trajectory, scene.actuation.duration),
        }
    }

    /// Additions with a thickness in pixels; `pixel` is the size of one in a picture `height` pixels high.
    pub fn after_camera(
        &mut self,
        (scene, trajectory): MovingDecor,
        (pixel, height): (f64, f64),
        meshes: &mut Vec<StageMesh>,
    ) {
        let view = &scene.view;
        let look = TrailLook {
            trails: view.decor.trails,
            background: view.background,
            pixel,
            height,
        };
        self.traces = trails::of_traces(scene, trajectory, look, meshes);
        self.ticks = ticks::of_traces(scene, trajectory, &view.decor, look, meshes);
        self.arrows = Arrows::new(scene, trajectory, [self.extent, pixel], meshes);
    }

    /// Colours that appear as they are.
    pub fn flat_colours(&self) -> impl Iterator<Item = [u8; 3]> + '_ {
        self.traces.iter().flat_map(TracePart::colours)
    }

    /// Colours of signs, before any light falls on them.
    pub fn lit_colours(&self) -> impl Iterator<Item = [u8; 3]> + '_ {
        self.axes.colours()
    }

    /// The additions at sample `index`, which shows the pose `pose` of sample `shown`; in an exploded view the bodies are
    /// drawn where they are in `drawn`.
    pub fn instances(
        &self,
        (scene, trajectory): MovingDecor,
        parts: &[StagedPart],
        (index, shown): (usize, usize),
        (pose, drawn): (&ClosedPose, &ClosedPose),
        meshes: &[StageMesh],
    ) -> Vec<Instance> {
        let mut all: Vec<Instance> = self
            .traces
            .iter()
            .flat_map(|trace| trace.instances(index))
            .collect();
        all.extend(self.ticks.iter().map(|ticks| ticks.instance(index)));
        let now = (shown, pose);
        all.extend(ghosts::ghost_instances(
            parts,
            &self.ghosts,
            trajectory,
            now,
            meshes,
        ));
        all.extend(self.axes.instances(drawn, meshes));
        if let Some(arrows) = &self.arrows {
            all.extend(arrows.instances(shown, &pose.traces, meshes));
        }
        if !self.joints.is_empty() {
            let sample = &trajectory.samples[shown];
            let at = joints::PlacedLinks::new(&scene.mechanism, sample, pose);
            all.extend(self.joints.instances(&at, meshes));
        }
        all
    }

    /// Letters at the axes, for a picture `height` pixels high.
    pub fn letters(&self, height: f64) -> Vec<Label> {
        self.axes.letters(height)
    }
}
