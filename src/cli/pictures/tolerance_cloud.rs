//! The cloud of paths of `mechanim tolerance`: over the mechanism as a picture, unrolled as a plot.

use super::paths;
use super::paths::PathLine;
use crate::analysis::cloud::{PathCloud, path_clouds};
use crate::analysis::study::LoadedStudy;
use crate::analysis::tolerance::SampleBatch;
use crate::analysis::tolerance_study::ToleranceStudy;
use crate::charts::cloud::cloud_chart;
use crate::cli::args::study::ToleranceArgs;
use crate::cli::files::chart;
use crate::cli::files::chart::PlotFormat;
use crate::cli::interrupt::CANCEL;
use crate::cli::io;
use crate::cli::motion::solve::up_to;
use crate::cli::term::outcome::Failure;
use crate::kinematics::motion::continuation::solve_motion;
use crate::kinematics::motion::sampling::even_times;
use crate::kinematics::structure::system::System;
use crate::model::theme::Theme;
use crate::model::view::Trails;
use crate::plot::primitive::LineStyle;
use crate::scene::load_scene;
use crate::staging::{PictureOptions, Staging};
use glam::DVec3;
use image::RgbaImage;
use std::sync::Arc;

/// Size and sampling of the picture.
const OPTIONS: PictureOptions = PictureOptions {
    size: [960, 720],
    samples: 4,
};

/// Deviations are magnified to this fraction of a path's extent, so that they are visible.
const SEEN: f64 = 0.12;

/// Poses of the drive that the camera must frame.
const CAMERA_SAMPLES: usize = 32;

/// Opacity of a path, out of 255, where `pieces` of them overlap.
fn path_opacity(pieces: usize) -> u8 {
    (4000.0 / pieces.max(1) as f64).clamp(5.0, 90.0) as u8
}

/// Draws the requested files.
pub fn write_cloud(args: &ToleranceArgs, scattered: &ToleranceStudy) -> Result<(), Failure> {
    if args.picture.is_none() && args.plot.is_none() {
        return Ok(());
    }
    let (study, batch) = (scattered.study, scattered.batch());
    let family = &study.family;
    if family.mechanism().traces.is_empty() {
        return Err(Failure::usage(
            "the cloud is drawn around the paths of traced points, but the scene has none",
            vec!["name a point: [[traces]] with name, body and point".to_owned()],
        ));
    }
    let few = SampleBatch {
        samples: args.paths.min(batch.samples),
        ..batch
    };
    let found = path_clouds(
        family,
        &scattered.nominal.poses,
        &scattered.tolerances,
        few,
        &CANCEL,
    )
    .ok_or(Failure::Interrupted)?;
    if let Some(path) = &args.plot {
        let format = PlotFormat::of(path)?;
        let mechanism = family.mechanism();
        let chart = cloud_chart(&mechanism.title, &mechanism.length_unit, &found);
        let mut output = io::open_output(path)?;
        chart::write_chart(&chart, format, None, Theme::Light, output.as_mut())?;
        output.commit()?;
    }
    if let Some(path) = &args.picture {
        io::write_png(&cloud_picture(args, study, &found)?, path)?;
    }
    Ok(())
}

/// Refuses files that cannot be written, before anything is computed.
pub fn refuse_cloud(args: &ToleranceArgs) -> Result<(), Failure> {
    if let Some(path) = &args.picture {
        paths::refuse_other(&args.scatter.scene, path)?;
    }
    if let Some(path) = &args.plot {
        PlotFormat::of(path)?;
        io::refuse_input(&args.scatter.scene, path)?;
    }
    Ok(())
}

fn cloud_picture(
    args: &ToleranceArgs,
    study: &LoadedStudy,
    clouds: &[PathCloud],
) -> Result<RgbaImage, Failure> {
    let mut scene = load_scene(&study.source, &study.overrides).map_err(Box::new)?;
    Arc::make_mut(&mut scene.view).decor.trails = Trails::None;
    // The camera frames the whole motion; the pose is the one that the drive reaches.
    let even = even_times(&scene.mechanism, &scene.actuation, CAMERA_SAMPLES);
    let mut times = up_to(args.at, scene.actuation.duration, &even)?;
    let index = times.len() - 1;
    times.extend(even.into_iter().filter(|t| *t > args.at));
    let system = System::new(Arc::clone(&scene.mechanism), &scene.actuation)?;
    let trajectory = solve_motion(&system, &scene.actuation, &times);
    let staging = Staging::new(&scene, &trajectory, OPTIONS);
    let factor = args.enlarge.unwrap_or_else(|| {
        let all = clouds.iter().map(|c| c.enlargement(SEEN));
        all.fold(f64::INFINITY, f64::min)
    });
    let mut lines = Vec::new();
    for cloud in clouds {
        let [r, g, b] = cloud.colour;
        let stroke = LineStyle::solid([r, g, b, path_opacity(cloud.pieces.len())], 1.3);
        lines.extend(cloud.pieces.iter().map(|piece| PathLine {
            points: enlarge_piece(piece, &cloud.nominal, factor),
            stroke,
        }));
    }
    lines.extend(clouds.iter().map(|cloud| PathLine {
        points: cloud.nominal.clone(),
        stroke: LineStyle::solid([0x11, 0x13, 0x18, 255], 1.6),
    }));
    let pieces = clouds.first().map_or(0, |c| c.pieces.len());
    let mut text = vec![format!("paths of {pieces} random pieces")];
    if factor != 1.0 {
        text.push(format!("deviations {factor} times enlarged"));
    }
    let mut image = RgbaImage::new(OPTIONS.size[0], OPTIONS.size[1]);
    paths::draw_paths(&staging, index, &lines, &text, &mut image)?;
    Ok(image)
}

fn enlarge_piece(piece: &[DVec3], nominal: &[DVec3], factor: f64) -> Vec<DVec3> {
    let points = piece.iter().zip(nominal);
    points.map(|(p, n)| *n + (*p - *n) * factor).collect()
}
