//! Four views of one motion in one picture: top, front and side at one scale, and the scene's own view.

use super::marks::Marks;
use super::{PictureOptions, Staging};
use crate::kinematics::trajectory::Trajectory;
use crate::model::theme::Theme;
use crate::model::view::NamedView;
use crate::render::{Anchor, Label, Patch, Projection, Stage};
use crate::scene::Scene;
use std::sync::Arc;

/// Names of the panes, row by row, and how they look; top stands above front, so that their x axes agree.
const PANES: [(&str, Option<NamedView>); 4] = [
    ("top", Some(NamedView::Top)),
    ("", None),
    ("front", Some(NamedView::Front)),
    ("side", Some(NamedView::Side)),
];

/// Free border of the panes, which captions and names need.
const MARGIN: f64 = 0.12;

/// Height of the names as a share of the picture's.
const NAME_SIZE: f64 = 0.026;

/// The scene as each pane looks at it.
pub fn scenes(scene: &Scene) -> Vec<Scene> {
    let panes = PANES.iter().map(|(_, named)| {
        let mut pane = scene.clone();
        let view = &mut pane.view;
        view.captions = false;
        view.decor.gauge = false;
        view.margin = view.margin.max(MARGIN);
        if let Some(named) = named {
            view.look_from(*named);
        }
        pane
    });
    panes.collect()
}

/// Stagings of the panes with their top left pixels; the parallel ones at one scale.
pub fn stagings<'a>(
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
    let heights = panes.iter().filter_map(|(_, pane)| height_of(&pane.stage));
    let tallest = heights.fold(0.0, f64::max);
    for (_, pane) in &mut panes {
        if let Projection::Orthographic { .. } = pane.stage.camera.projection
            && let Some(stage) = Arc::get_mut(&mut pane.stage)
        {
            stage.camera.projection = Projection::Orthographic { height: tallest };
        }
    }
    panes
}

fn height_of(stage: &Stage) -> Option<f64> {
    match stage.camera.projection {
        Projection::Orthographic { height } => Some(height),
        Projection::Perspective { .. } => None,
    }
}

/// Lines between the panes and their names, over a picture of `size` pixels.
pub fn frame(theme: Theme, size: [u32; 2]) -> (Vec<Patch>, Vec<Label>) {
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
    let names = PANES.iter().enumerate().map(|(k, (name, _))| Label {
        text: (*name).to_owned(),
        anchor: Anchor::Screen([
            0.5 * (k % 2) as f64 + 0.02 * height / width,
            // Below the title in the first pane.
            0.5 * (k / 2) as f64 + if k == 0 { 0.085 } else { 0.02 },
        ]),
        size: NAME_SIZE * height,
        colour: theme.faint_ink(),
        plate: false,
    });
    (patches, names.collect())
}
