//! Texts of pictures as rectangles: none covers another, none leaves the picture, whatever its size and view.

use crate::driven::{frame_times, solve};
use mechanim::model::view::{NamedView, ShownAxes};
use mechanim::render::overlay::Overlay;
use mechanim::scene::{Overrides, Scene, builtin, load_scene};
use mechanim::staging::marks::Marks;
use mechanim::staging::{PictureOptions, Staging, panes};
use std::sync::Arc;

fn scene(name: &str) -> Scene {
    let source = builtin::find_builtin(name).unwrap();
    load_scene(&source, &Overrides::default()).unwrap_or_else(|e| panic!("{:#?}", e.diagnostics))
}

/// The rectangles of a staging's texts at some frames.
fn check(name: &str, staging: &Staging) {
    let [width, height] = staging.stage.size.map(f64::from);
    let count = staging.frame_count();
    for index in (0..count).step_by(count.div_ceil(7)) {
        let frame = staging.frame(index);
        let camera = frame.camera(&staging.stage);
        let boxes = Overlay::text_rectangles(&frame, &camera, staging.stage.size);
        for (k, (text, own)) in boxes.iter().enumerate() {
            let inside = own[0] >= 0.0 && own[1] >= 0.0 && own[2] <= width && own[3] <= height;
            assert!(
                inside,
                "{name} {width}x{height} frame {index}: `{text}` {own:?}"
            );
            for (other_text, other) in &boxes[..k] {
                let apart = own[0] >= other[2]
                    || other[0] >= own[2]
                    || own[1] >= other[3]
                    || other[1] >= own[3];
                assert!(
                    apart,
                    "{name} {width}x{height} frame {index}: `{text}` covers `{other_text}`"
                );
            }
        }
    }
}

#[test]
fn texts_keep_apart_and_inside_in_all_scenes_sizes_and_views() {
    for entry in builtin::ALL {
        let mut scene = scene(entry.name);
        let trajectory = solve(&scene, &frame_times(&scene, 20.0)).unwrap();
        let plain = scene.view.clone();
        for (size, named, gauge) in [
            ([640, 480], None, false),
            ([400, 900], None, false),
            ([400, 900], None, true),
            ([640, 480], Some(NamedView::Front), false),
            ([640, 480], Some(NamedView::Side), false),
            ([500, 380], None, true),
        ] {
            scene.view = plain.clone();
            let view = Arc::make_mut(&mut scene.view);
            if let Some(named) = named {
                view.look_from(named);
            }
            view.decor.gauge = gauge;
            view.decor.scale = true;
            view.decor.axes = ShownAxes::Corner;
            let options = PictureOptions { size, samples: 4 };
            check(entry.name, &Staging::new(&scene, &trajectory, options));
        }
        scene.view = plain;
        Arc::make_mut(&mut scene.view).decor.scale = true;
        let options = PictureOptions {
            size: [640, 480],
            samples: 4,
        };
        let views = panes::pane_scenes(&scene);
        for (_, pane) in panes::pane_stagings(&views, &trajectory, options, &Marks::default()) {
            check(entry.name, &pane);
        }
    }
}

/// Every gate of the gearshift is nearer to the end of its own path than to that of any other.
#[test]
fn labels_stand_nearest_to_their_own_anchors() {
    let scene = scene("gearshift");
    let trajectory = solve(&scene, &frame_times(&scene, scene.view.fps)).unwrap();
    for size in [[640, 480], [1280, 960]] {
        let options = PictureOptions { size, samples: 4 };
        let staging = Staging::new(&scene, &trajectory, options);
        let frame = staging.frame(0);
        let camera = frame.camera(&staging.stage);
        let anchors: Vec<(String, [f64; 2])> = frame
            .labels
            .iter()
            .filter_map(|label| match label.anchor {
                mechanim::render::LabelAnchor::Placed { point, .. } => {
                    let [x, y, _] = camera.project(point, size)?;
                    Some((label.text.clone(), [x, y]))
                }
                _ => None,
            })
            .collect();
        assert_eq!(anchors.len(), 6);
        let boxes = Overlay::text_rectangles(&frame, &camera, size);
        for (text, own) in boxes.iter().filter(|(t, _)| t.chars().count() == 1) {
            let gap = |[x, y]: [f64; 2]| {
                let dx = (own[0] - x).max(x - own[2]).max(0.0);
                let dy = (own[1] - y).max(y - own[3]).max(0.0);
                dx.hypot(dy)
            };
            let nearest = anchors.iter().min_by(|a, b| gap(a.1).total_cmp(&gap(b.1)));
            assert_eq!(&nearest.unwrap().0, text);
        }
    }
}
