//! Four views of one motion in one picture: top, front and side at one scale, and the scene's own view.

use super::marks::Marks;
use super::{PictureOptions, Staging};
use crate::kinematics::results::trajectory::Trajectory;
use crate::model::theme::Theme;
use crate::model::view::NamedView;
use crate::render::{Frame, Label, LabelAnchor, Patch, Projection, Stage};
use crate::scene::Scene;
use std::sync::Arc;

/// A pane: its name, its direction, and the fractions of its height kept free above and below for texts.
struct Pane {
    name: &'static str,
    look: Option<NamedView>,
    free: [f64; 2],
    /// The pane that determines the scale of all parallel ones.
    scaled: bool,
}

/// Row by row; top is above front, so that their x axes agree. The first has title and name in it, the third the values
/// of the inputs.
const PANES: [Pane; 4] = [
    Pane {
        name: "top",
        look: Some(NamedView::Top),
        free: [0.25, 0.05],
        scaled: false,
    },
    Pane {
        name: "",
        look: None,
        free: [0.16, 0.06],
        scaled: false,
    },
    Pane {
        name: "front",
        look: Some(NamedView::Front),
        free: [0.11, 0.17],
        scaled: false,
    },
    Pane {
        name: "side",
        look: Some(NamedView::Side),
        free: [0.11, 0.06],
        scaled: true,
    },
];

/// Labels of a pane over those of a whole picture, both as shares of their heights.
const LABELS: f64 = 1.6;

/// Height of the names as a share of the picture's.
const NAME_SIZE: f64 = 0.026;

/// The scene with the view of each pane.
pub fn pane_scenes(scene: &Scene) -> Vec<Scene> {
    let panes = PANES.iter().map(
        |Pane {
             look, free, scaled, ..
         }| {
            let mut pane = scene.clone();
            let view = Arc::make_mut(&mut pane.view);
            view.captions = false;
            view.decor.gauge = false;
            view.decor.scale &= *scaled;
            view.margin = view.margin.max(0.5 * (free[0] + free[1]));
            for label in &mut view.labels {
                label.size *= LABELS;
                label.yields = true;
            }
            if let Some(named) = look {
                view.look_from(*named);
            }
            pane
        },
    );
    panes.collect()
}

/// Stagings of the panes with their top left pixels; the parallel ones at one scale.
pub fn pane_stagings<'a>(
    scenes: &'a [Scene],
    trajectory: &'a Trajectory,
    options: PictureOptions,
    marks: &Marks,
) -> Vec<([u32; 2], Staging<'a>)> {
    let [width, height] = options.size;
    let half = [width / 2, height / 2];
    let panes = scenes.iter().enumerate().map(|(k, scene)| {
        let right = k % 2 == 1;
        let below = k / 2 == 1;
        let corner = [
            if right { half[0] } else { 0 },
            if below { half[1] } else { 0 },
        ];
        let size = [
            if right { width - half[0] } else { half[0] },
            if below { height - half[1] } else { half[1] },
        ];
        let options = PictureOptions { size, ..options };
        (
            corner,
            Staging::marked(scene, trajectory, options, marks.clone()),
        )
    });
    let mut panes: Vec<([u32; 2], Staging)> = panes.collect();
    let looks = panes
        .iter()
        .zip(&PANES)
        .filter(|(_, pane)| pane.look.is_some());
    let heights = looks.filter_map(|((_, pane), _)| height_of(&pane.stage));
    let tallest = heights.fold(0.0, f64::max);
    for ((_, pane), Pane { look, free, .. }) in panes.iter_mut().zip(&PANES) {
        if look.is_some()
            && let Some(stage) = Arc::get_mut(&mut pane.stage)
        {
            let camera = &mut stage.camera;
            camera.projection = Projection::Orthographic { height: tallest };
            let up = camera.world_from_camera.rotation.y_axis;
            camera.world_from_camera.translation += up * (0.5 * (free[0] - free[1]) * tallest);
        }
        let [width, height] = pane.stage.size.map(f64::from);
        pane.enlarged = LABELS;
        // Positions of the texts over the panes.
        let above = [0.0, 0.0, width, free[0] * height];
        let below = [0.0, height - free[1] * height, width, height];
        pane.place_letters(&[above, below]);
    }
    panes
}

fn height_of(stage: &Stage) -> Option<f64> {
    match stage.camera.projection {
        Projection::Orthographic { height } => Some(height),
        Projection::Perspective { .. } => None,
    }
}

/// The overlay of the panes at sample `index`: title, values, lines between them and their names. `whole` is the
/// staging of the whole picture.
pub fn frame_over(scene: &Scene, whole: &Staging, index: usize) -> Frame {
    let mut frame = whole.captions(index);
    let (patches, names) = pane_borders(scene.view.theme, whole.stage.size);
    frame.patches.extend(patches);
    frame.labels.extend(names);
    frame
}

/// Lines between the panes and their names, over a picture of `size` pixels.
fn pane_borders(theme: Theme, size: [u32; 2]) -> (Vec<Patch>, Vec<Label>) {
    let [width, height] = size.map(f64::from);
    let line = |corner, size| Patch {
        corner,
        size,
        colour: theme.faint_ink(),
        opacity: 0.5,
    };
    let patches = vec![
        line([0.5 - 0.5 / width, 0.0], [1.0 / width, 1.0]),
        line([0.0, 0.5 - 0.5 / height], [1.0, 1.0 / height]),
    ];
    let names = PANES.iter().enumerate().map(|(k, pane)| Label {
        text: pane.name.to_owned(),
        anchor: LabelAnchor::Screen([
            0.5 * (k % 2) as f64 + 0.02 * height / width,
            // Below the title in the first pane.
            0.5 * (k / 2) as f64 + if k == 0 { 0.085 } else { 0.02 },
        ]),
        size: NAME_SIZE * height,
        colour: theme.faint_ink(),
        plate: false,
        yields: false,
    });
    (patches, names.collect())
}
