//! Changes to the view of a scene from the command line or a list of pictures.

use super::camera_path::CameraPath;
use super::section::{Section, SectionPlane};
use super::theme::Theme;
use super::view::{
    EdgeLines, Ghosts, GroundPlace, NamedView, Shadows, ShownAxes, Trails, View, ViewProjection,
};

/// Changes; `None` keeps the scene's value.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ViewChange {
    /// A named direction, applied before everything else.
    pub from: Option<NamedView>,
    /// Radians.
    pub azimuth: Option<f64>,
    /// Radians.
    pub elevation: Option<f64>,
    /// Kind of projection with its angle.
    pub projection: Option<ViewProjection>,
    /// Parallel or not; a perspective keeps the scene's angle.
    pub parallel: Option<bool>,
    /// Theme, with its background.
    pub theme: Option<Theme>,
    /// Lines between surfaces.
    pub edges: Option<EdgeLines>,
    /// Shadows on bodies and on the ground.
    pub shadows: Option<Shadows>,
    /// sRGB.
    pub background: Option<[u8; 3]>,
    /// No background at all.
    pub transparent: Option<bool>,
    /// Title and input values.
    pub captions: Option<bool>,
    /// Whether there is a ground at all.
    pub ground: Option<bool>,
    /// Earlier poses.
    pub ghosts: Option<Ghosts>,
    /// Traced paths.
    pub trails: Option<Trails>,
    /// Velocity arrows.
    pub arrows: Option<bool>,
    /// Axes of frames.
    pub axes: Option<ShownAxes>,
    /// Seconds between marks on paths.
    pub ticks: Option<f64>,
    /// Scale bar, or pitch of the grid.
    pub scale: Option<bool>,
    /// Forwards, then backwards.
    pub bounce: Option<bool>,
    /// Seconds that the ends of a film are shown for.
    pub pause: Option<f64>,
    /// Gauges of the inputs.
    pub gauge: Option<bool>,
    /// Joints drawn by kind.
    pub joints: Option<bool>,
    /// Radians that the camera turns during the motion, in place of the scene's path.
    pub orbit: Option<f64>,
    /// Where bodies are cut; the scene's choice of bodies stays.
    pub section: Option<SectionPlane>,
    /// How far bodies are moved apart.
    pub explode: Option<f64>,
}

impl ViewChange {
    /// Changes `view`.
    pub fn apply(&self, view: &mut View) {
        // The perspective to return to, before a named view makes the projection parallel.
        let own = match view.projection {
            ViewProjection::Perspective { .. } => view.projection,
            ViewProjection::Orthographic => ViewProjection::DEFAULT,
        };
        // Direction: the named view, then the path, then angles, which replace those of its keys.
        if let Some(from) = self.from {
            view.look_from(from);
        }
        if let Some(orbit) = self.orbit {
            view.camera_path = CameraPath {
                keys: Vec::new(),
                orbit,
            };
        }
        let path = &mut view.camera_path;
        path.forget(self.azimuth.is_some(), self.elevation.is_some());
        view.is_aimed |= self.azimuth.is_some() || self.elevation.is_some();
        view.azimuth = self.azimuth.unwrap_or(view.azimuth);
        view.elevation = self.elevation.unwrap_or(view.elevation);
        // Projection: parallel or not, then one with its own angle.
        match self.parallel {
            Some(true) => view.projection = ViewProjection::Orthographic,
            Some(false) => view.projection = own,
            None => {}
        }
        view.projection = self.projection.unwrap_or(view.projection);
        // The theme before the background, which it sets.
        if let Some(theme) = self.theme {
            view.theme = theme;
            view.background = theme.background();
        }
        view.edges = self.edges.unwrap_or(view.edges);
        view.shadows = self.shadows.unwrap_or(view.shadows);
        view.background = self.background.unwrap_or(view.background);
        view.transparent = self.transparent.unwrap_or(view.transparent);
        view.captions = self.captions.unwrap_or(view.captions);
        if self.ground == Some(false) {
            view.ground = GroundPlace::None;
        }
        if let Some(plane) = self.section {
            let bodies = view.section.take().and_then(|section| section.bodies);
            view.section = Some(Section { plane, bodies });
        }
        view.explode = self.explode.unwrap_or(view.explode);
        // Everything else is independent: what is not given keeps the scene's value.
        let playback = &mut view.playback;
        playback.bounce = self.bounce.unwrap_or(playback.bounce);
        playback.pause = self.pause.unwrap_or(playback.pause);
        let decor = &mut view.decor;
        decor.ticks = self.ticks.or(decor.ticks);
        decor.scale = self.scale.unwrap_or(decor.scale);
        if let Some(ghosts) = &self.ghosts {
            decor.ghosts = ghosts.clone();
        }
        decor.trails = self.trails.unwrap_or(decor.trails);
        decor.arrows = self.arrows.unwrap_or(decor.arrows);
        decor.axes = self.axes.unwrap_or(decor.axes);
        decor.gauge = self.gauge.unwrap_or(decor.gauge);
        decor.joints = self.joints.unwrap_or(decor.joints);
    }
}
