//! From a solved scene to the input of a renderer: meshes, camera and ground once, then a draw list per sample.
//!
//! A frame depends only on the trajectory and the index of a sample. No pixels are computed here.

mod arrows;
mod axes;
mod axis_places;
mod bar_symbols;
mod body_meshes;
mod bounds;
mod cameras;
mod captions;
mod context;
mod decor;
mod dimension_lines;
mod explode;
mod fitting;
mod floating;
mod gauge;
mod ghosts;
mod ground;
mod joint_places;
mod joint_symbols;
pub mod joints;
pub mod label_placement;
mod link_symbols;
pub mod marks;
pub mod model;
mod occlusion;
pub mod panes;
mod placed_labels;
pub mod quantity_names;
mod round_steps;
mod section;
pub mod shared_camera;
mod sign_solids;
mod solids;
mod spherical_links;
mod ticks;
mod trails;
mod value_text;

use crate::kinematics::results::trajectory::{ClosedPose, Trajectory};
use crate::model::theme::Theme;
use crate::model::view::{EdgeLines, LabelPlace, SceneLabel, Shadows, ShownAxes, View};
use crate::render::edges::EdgeStyle;
use crate::render::look::Rim;
use crate::render::overlay::border;
use crate::render::ramp::shaded_ramp;
use crate::render::{Camera, Frame, Instance, Label, Stage, StageMesh};
use crate::scene::Scene;
use body_meshes::StagedPart;
use cameras::Cameras;
use captions::Captions;
use context::{ContextRoom, ContextSigns};
use decor::DecorParts;
use dimension_lines::DimensionLook;
use explode::ExplodedView;
use glam::DVec3;
use label_placement::Rectangle;
use marks::Marks;
use placed_labels::Letters;
use section::SectionCut;
use std::sync::Arc;

/// Size and sampling of the pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureOptions {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Samples per pixel.
    pub samples: u32,
}

/// Everything needed to list the contents of any frame.
pub struct Staging<'a> {
    /// Everything that is the same in all frames; shared by all renderers.
    pub stage: Arc<Stage>,
    scene: &'a Scene,
    trajectory: &'a Trajectory,
    /// One per sample if the camera moves, otherwise none.
    cameras: Vec<Camera>,
    parts: Vec<StagedPart>,
    exploded: ExplodedView,
    section: Option<SectionCut>,
    marks: Marks,
    /// Mesh of the marked distance.
    measure: Option<usize>,
    decor: DecorParts,
    captions: Captions,
    context: ContextSigns,
    /// Extent of the motion.
    extent: f64,
    /// Size of the signs relative to their usual size.
    enlarged: f64,
    /// The scene's labels, one entry per label.
    letters: Vec<Letters>,
    /// For every sample the sample whose pose is drawn: itself, or the nearest one with a pose.
    shown: Vec<Option<usize>>,
}

/// Opacity of the bodies when joints are shown, so that the joints inside them are visible.
const FADED_BY_JOINTS: f64 = 0.35;

impl<'a> Staging<'a> {
    /// Prepares the stage for all samples of `trajectory`.
    pub fn new(scene: &'a Scene, trajectory: &'a Trajectory, options: PictureOptions) -> Self {
        Self::marked(scene, trajectory, options, Marks::default())
    }

    /// The same with bodies and a distance highlighted.
    pub fn marked(
        scene: &'a Scene,
        trajectory: &'a Trajectory,
        options: PictureOptions,
        marks: Marks,
    ) -> Self {
        // All that must be in the picture; what needs room adds its points before the camera is fitted.
        let mut bounds = bounds::moving_points(scene, trajectory);
        let view = &*cameras::view_of(scene, &bounds);
        let up = view.up.axis();
        let mut meshes = Vec::new();
        let moving = (scene, trajectory);
        let mut decor = DecorParts::before_camera(moving, (&mut bounds, up), &mut meshes);
        let aspect = picture_aspect(options);
        let times: Vec<f64> = trajectory.samples.iter().map(|s| s.time).collect();
        let duration = scene.actuation.duration;
        let ground = ground::view_ground(view, &bounds, up);
        let extent = bounds::box_of(&bounds).map_or(1.0, |[low, high]| (high - low).length());
        bounds.extend(dimension_lines::held_points(scene, trajectory, extent));
        // With the camera the size of a pixel is known, which sets the facets and all widths.
        let cameras = Cameras::new(view, up, &bounds, aspect, (&times, duration));
        let pixel = body_meshes::pixel_size(cameras.all(), options.size, &bounds);
        let mut parts = body_meshes::of_bodies(scene, pixel, &mut meshes);
        let height = f64::from(options.size[1]);
        decor.after_camera(moving, (pixel, height), &mut meshes);
        let measure = marks.mesh(pixel, &mut meshes);
        let exploded = ExplodedView::new(moving, (pixel, height), &mut meshes);
        let offsets = exploded.offsets();
        for part in &mut parts {
            part.move_by(offsets[part.body()]);
        }
        let section = SectionCut::new(view, (&parts, offsets), &meshes, (pixel, height));
        // What is the same in all frames, shared by the renderers.
        let stage = Stage {
            meshes: meshes.into(),
            size: options.size,
            samples: options.samples,
            camera: cameras.first,
            background: view.background,
            rim: match view.theme {
                Theme::Light => Rim::DARK,
                Theme::Dark => Rim::LIGHT,
            },
            ground,
            edges: edge_style(view),
            mutual_shade: bounds::box_of(&bounds).filter(|_| view.shadows == Shadows::All),
        };
        // What the frames differ by.
        let mut staging = Self {
            stage: Arc::new(stage),
            scene,
            trajectory,
            cameras: cameras.moving,
            parts,
            exploded,
            section,
            marks,
            measure,
            decor,
            captions: Captions::new(scene, trajectory, options.size),
            context: ContextSigns {
                scale: view.decor.scale,
                triad: view.decor.axes == ShownAxes::Corner,
                unit: scene.mechanism.length_unit.clone(),
                theme: view.theme,
            },
            extent,
            enlarged: 1.0,
            letters: Vec::new(),
            shown: shown_samples(trajectory),
        };
        staging.place_letters(&[]);
        staging
    }

    /// Finds the places of the scene's labels, clear of the rectangles `reserved` (pixels).
    fn place_letters(&mut self, reserved: &[Rectangle]) {
        if self.scene.view.labels.is_empty() {
            return;
        }
        let points = bounds::moving_points(self.scene, self.trajectory);
        let moving = (self.scene, self.trajectory);
        let cameras = |index: usize| self.cameras.get(index).copied();
        let camera = |index: usize| cameras(index).unwrap_or(self.stage.camera);
        let mut captions = Frame::default();
        self.add_captions(0, &mut captions);
        let height = f64::from(self.stage.size[1]);
        captions.labels.extend(self.marks.labels(height));
        self.add_context(&camera(0), true, &mut captions);
        let taken = (&captions, reserved);
        self.letters =
            placed_labels::place_letters(moving, &camera, self.stage.size, taken, &points);
    }

    /// Colours of texts and background.
    pub fn theme(&self) -> Theme {
        self.scene.view.theme
    }

    /// Number of frames: one per sample.
    pub fn frame_count(&self) -> usize {
        self.trajectory.samples.len()
    }

    /// Colours that a palette must contain, in however few frames they appear: those unaffected by light, and the
    /// shades of highlight colours.
    pub fn needed_colours(&self) -> Vec<[u8; 3]> {
        let theme = self.theme();
        let mut colours = vec![self.stage.background, theme.ink(), theme.faint_ink()];
        colours.extend(self.decor.flat_colours());
        colours.extend(self.exploded.flat_colours());
        let section = self.section.iter();
        colours.extend(section.flat_map(|section| section.flat_colours(&self.parts)));
        colours.extend(gauge::flat_colours(self.scene.view.decor.gauge));
        colours.extend(self.context.flat_colours());
        colours.extend(dimension_lines::flat_colours(self.scene));
        if self.trajectory.samples.iter().any(|s| s.pose.is_none()) {
            colours.extend(border::COLOURS);
        }
        let lit = self
            .marks
            .colours()
            .into_iter()
            .chain(self.decor.lit_colours());
        colours.extend(lit.flat_map(|colour| shaded_ramp(colour, self.stage.rim)));
        colours
    }

    /// The same stage with another background.
    pub fn stage_on(&self, background: [u8; 3]) -> Arc<Stage> {
        Arc::new(Stage {
            background,
            ..Stage::clone(&self.stage)
        })
    }

    /// What is drawn for sample `index`.
    pub fn frame(&self, index: usize) -> Frame {
        let sample = &self.trajectory.samples[index];
        let mut frame = Frame {
            no_pose: sample.pose.is_none(),
            camera: self.cameras.get(index).copied(),
            ..Frame::default()
        };
        if let Some(pose) = self.shown[index].and_then(|k| self.trajectory.samples[k].pose.as_ref())
        {
            let moved = self.exploded.moved(pose);
            let drawn = moved.as_ref().unwrap_or(pose);
            frame.instances = self.instances(index, (pose, drawn), &mut frame.meshes);
            let camera = frame.camera(&self.stage);
            frame.labels = self.labels((pose, drawn), &camera);
            let look = DimensionLook {
                camera,
                size: self.stage.size,
                background: self.stage.background,
                extent: self.extent,
                enlarged: self.enlarged,
            };
            // Between bodies that are moved apart there are no true lengths.
            if moved.is_none() {
                dimension_lines::add_dimensions(self.scene, pose, look, &mut frame);
            }
        }
        let has_pose = !frame.no_pose;
        self.add_context(&frame.camera(&self.stage), has_pose, &mut frame);
        self.add_captions(index, &mut frame);
        frame
    }

    /// Whether there is a pose at sample `index`, and nothing to see of it.
    pub fn is_bare(&self, index: usize) -> bool {
        let frame = self.frame(index);
        !frame.no_pose && frame.instances.is_empty() && self.letters.is_empty()
    }

    /// Title and values of sample `index` alone.
    pub fn captions(&self, index: usize) -> Frame {
        let mut frame = Frame::default();
        self.add_captions(index, &mut frame);
        frame
    }

    fn add_captions(&self, index: usize, frame: &mut Frame) {
        if let Some(sample) = self.trajectory.samples.get(index) {
            self.captions.add_captions(self.scene, sample, frame);
        }
    }

    /// Scale and triad.
    fn add_context(&self, camera: &Camera, has_pose: bool, frame: &mut Frame) {
        let height = f64::from(self.stage.size[1]);
        let needed = ContextSigns::WIDEST * height * self.enlarged;
        let room = ContextRoom {
            corner: self.captions.free_corner(self.scene, has_pose, needed),
            size: self.stage.size,
            enlarged: self.enlarged,
        };
        self.context
            .add(camera, self.stage.ground.as_ref(), room, frame);
    }

    /// What is drawn at a pose, with the bodies in their places and where they are drawn.
    fn instances(
        &self,
        index: usize,
        (pose, drawn): (&ClosedPose, &ClosedPose),
        of_frame: &mut Vec<StageMesh>,
    ) -> Vec<Instance> {
        let meshes = &self.stage.meshes;
        let solids = self.parts.iter().map(|part| {
            let mut instance = part.instance(pose, meshes);
            self.marks.colour(index, part.body(), &mut instance);
            if self.scene.view.decor.joints {
                instance.opacity *= FADED_BY_JOINTS;
            }
            instance
        });
        let line = self.measure.map(|mesh| Marks::line(mesh, meshes));
        let shown = (index, self.shown[index].unwrap_or(index));
        let decor = self.decor.instances(
            (self.scene, self.trajectory),
            &self.parts,
            shown,
            (pose, drawn),
            meshes,
        );
        let casts = self.scene.view.shadows != Shadows::None;
        let all = solids.chain(decor).chain(line);
        let all = all.map(|instance| Instance {
            casts_shadow: instance.casts_shadow && casts,
            ..instance
        });
        let mut all: Vec<Instance> = all.collect();
        if let Some(section) = &self.section {
            let solids = (self.parts.len(), &*drawn.bodies);
            all = section.apply(all, solids, of_frame);
        }
        // A body that is cut off as a whole has no leader.
        let is_shown = |body: u32| all.iter().any(|instance| instance.outline == Some(body));
        let leaders = self.exploded.instances(pose, meshes);
        let leaders = leaders.filter(|(body, _)| is_shown(*body));
        let leaders: Vec<Instance> = leaders.map(|(_, leader)| leader).collect();
        all.extend(leaders);
        all
    }

    fn labels(&self, (pose, drawn): (&ClosedPose, &ClosedPose), camera: &Camera) -> Vec<Label> {
        let height = f64::from(self.stage.size[1]);
        let theme = self.scene.view.theme;
        let labels = &self.scene.view.labels;
        labels
            .iter()
            .zip(&self.letters)
            .filter_map(|(label, letters)| {
                let point = captions::anchor(label, letters.on_trace, drawn)?;
                let is_seen = !label.hides || !self.is_hidden(label, point, pose, camera);
                is_seen.then(|| letters.label(label, point, height, theme))
            })
            .chain(self.decor.letters(height))
            .chain(self.marks.labels(height))
            .collect()
    }

    /// Whether a body hides a label's point.
    fn is_hidden(
        &self,
        label: &SceneLabel,
        point: DVec3,
        pose: &ClosedPose,
        camera: &Camera,
    ) -> bool {
        let own = match label.place {
            LabelPlace::OnBody { body, .. } => Some(body),
            LabelPlace::OnTrace { .. } => None,
        };
        let bodies = (&*self.parts, self.section.as_ref());
        occlusion::is_hidden(point, own, camera, bodies, pose, &self.stage.meshes)
    }
}

/// The sample drawn for each sample: the last one with a pose, or before it the first one with a pose.
fn shown_samples(trajectory: &Trajectory) -> Vec<Option<usize>> {
    let first = trajectory.samples.iter().position(|s| s.pose.is_some());
    let mut last = first;
    let samples = trajectory.samples.iter().enumerate();
    samples
        .map(|(index, sample)| {
            if sample.pose.is_some() {
                last = Some(index);
            }
            last
        })
        .collect()
}

/// Lines in the scene's colours.
fn edge_style(view: &View) -> Option<EdgeStyle> {
    let creases = match view.edges {
        EdgeLines::None => return None,
        EdgeLines::Outline => false,
        EdgeLines::All => true,
    };
    Some(EdgeStyle {
        creases,
        ink: view.theme.line(),
    })
}

/// Width over height.
fn picture_aspect(options: PictureOptions) -> f64 {
    f64::from(options.size[0]) / f64::from(options.size[1])
}
