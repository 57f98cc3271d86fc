//! `mechanim optimise --film`: one frame per improvement, with the mechanism and its paths as they are then, and the
//! paths of the start.

use crate::analysis::study::LoadedStudy;
use crate::analysis::study::optimum::Improvement;
use crate::cli::args::files::{FileArgs, ProgressArg};
use crate::cli::files::sinks;
use crate::cli::files::sinks::OpenFilm;
use crate::cli::pictures::paths;
use crate::cli::pictures::paths::PathLine;
use crate::cli::term::Term;
use crate::cli::term::outcome::Failure;
use crate::kinematics::measures::poses_of;
use crate::kinematics::motion::continuation::solve_motion;
use crate::kinematics::motion::sampling::even_times;
use crate::kinematics::results::trajectory::{Sample, Trajectory};
use crate::kinematics::structure::system::System;
use crate::model::view::Trails;
use crate::plot::primitive::LineStyle;
use crate::plot::theme::Dashes;
use crate::report::cells::six_digits;
use crate::scene::Scene;
use crate::staging::shared_camera::SharedCamera;
use crate::staging::{PictureOptions, Staging};
use glam::DVec3;
use image::RgbaImage;
use std::path::Path;
use std::sync::Arc;

/// Size and sampling of the film.
const OPTIONS: PictureOptions = PictureOptions {
    size: [640, 480],
    samples: 4,
};

/// Maximum number of improvements shown; of more, some are left out evenly.
const MOST_FRAMES: usize = 100;

/// Frames per second, and number of frames for which the last one stays.
const FPS: f64 = 6.0;
const LAST: usize = 12;

/// Poses of the path where the scene has no tracks.
const DRIVE_SAMPLES: usize = 120;

/// Colour of the start's paths.
const GHOST: [u8; 4] = [0x59, 0x63, 0x6e, 190];

/// A traced path and its colour.
type ColouredPath = (Vec<DVec3>, [u8; 3]);

/// One frame: the scene with the values of an improvement, at the start of its drive.
struct Shot {
    scene: Scene,
    trajectory: Trajectory,
    paths: Vec<ColouredPath>,
    text: String,
}

/// The requested file; whether it can hold a film is checked before the search.
pub fn film_file(out: &Path) -> Result<FileArgs, Failure> {
    let args = FileArgs {
        out: out.to_path_buf(),
        format: None,
        quality: None,
        compression: None,
        dpi: None,
        chroma: None,
        repeat: None,
        threads: None,
        progress: ProgressArg::None,
    };
    let format = sinks::film_format(&args)?;
    if format.is_still() || format.is_model() {
        return Err(Failure::usage(
            format!("{} cannot contain an animation", out.display()),
            vec![
                "write a .gif, .apng, .y4m, a folder, or a pattern such as frame-%04d.png"
                    .to_owned(),
            ],
        ));
    }
    Ok(args)
}

/// Draws and writes the film.
pub fn write_search_film(
    args: &FileArgs,
    study: &LoadedStudy,
    improvements: &[Improvement],
    term: &Term,
) -> Result<(), Failure> {
    let chosen = thin_improvements(improvements);
    let shots: Vec<Shot> = chosen
        .iter()
        .map(|i| improvement_shot(study, i))
        .collect::<Result<_, _>>()?;
    let Some(first) = shots.first() else {
        return Ok(());
    };
    let moving = shots.iter().map(|s| (&s.scene, &s.trajectory));
    let Some(outlook) = SharedCamera::over(moving, OPTIONS) else {
        return Ok(());
    };
    let draw = |frame: usize, image: &mut RgbaImage| -> Result<(), Failure> {
        let shot = &shots[frame.min(shots.len() - 1)];
        let staging = Staging::new(&shot.scene, &shot.trajectory, OPTIONS).seen_as(&outlook);
        let dashed = |points: &Vec<DVec3>| PathLine {
            points: points.clone(),
            stroke: LineStyle {
                colour: GHOST,
                width: 1.4,
                dashes: Dashes::Long,
            },
        };
        let mut lines: Vec<PathLine> = first.paths.iter().map(|(p, _)| dashed(p)).collect();
        lines.extend(shot.paths.iter().map(|(points, [r, g, b])| PathLine {
            points: points.clone(),
            stroke: LineStyle::solid([*r, *g, *b, 255], 2.4),
        }));
        let text = [shot.text.clone()];
        paths::draw_paths(&staging, 0, &lines, &text, image)?;
        Ok(())
    };
    let format = sinks::film_format(args)?;
    let threads = crate::jobs::core_count();
    let mut workers: Vec<_> = (0..threads).map(|_| draw).collect();
    let count = shots.len() + LAST;
    let film = OpenFilm::new(args, &format, OPTIONS.size, count, FPS)
        .with_needed_colours(vec![first.scene.view.background]);
    let destination = sinks::open_sink(args, &format)?;
    let prepared = film.sink(destination, &mut workers, term)?;
    let summary = film.write(prepared, workers, term)?;
    film.tell(&summary, "", term);
    Ok(())
}

/// The first, the last, and some evenly between.
fn thin_improvements(improvements: &[Improvement]) -> Vec<&Improvement> {
    let count = improvements.len().min(MOST_FRAMES);
    let last = improvements.len().saturating_sub(1);
    (0..count)
        .map(|k| &improvements[k * last / (count - 1).max(1)])
        .collect()
}

fn improvement_shot(study: &LoadedStudy, improvement: &Improvement) -> Result<Shot, Failure> {
    let mut scene = study.scene_at(&improvement.values)?;
    let view = Arc::make_mut(&mut scene.view);
    view.decor.trails = Trails::None;
    // Labels on a trace need the whole drive; the path is drawn beside it.
    view.labels.clear();
    let system = System::new(Arc::clone(&scene.mechanism), &scene.actuation)?;
    let paths = coloured_paths(&scene, &system);
    let trajectory = solve_motion(&system, &scene.actuation, &[0.0]);
    let (name, unit) = (study.objective_name(), study.objective_unit());
    let text = format!(
        "{name} = {}   iteration {}",
        six_digits(improvement.objective * unit),
        improvement.iteration
    );
    Ok(Shot {
        scene,
        trajectory,
        paths,
        text,
    })
}

/// Paths of all traced points along all tracks, or along the drive where there are none.
fn coloured_paths(scene: &Scene, system: &System) -> Vec<ColouredPath> {
    let (mechanism, actuation) = (&scene.mechanism, &scene.actuation);
    let mut rows: Vec<Vec<Sample>> = Vec::new();
    for track in &scene.measures.tracks {
        rows.push(poses_of(system, actuation, track));
    }
    if rows.is_empty() {
        let times = even_times(mechanism, actuation, DRIVE_SAMPLES);
        rows.push(solve_motion(system, actuation, &times).samples);
    }
    let traces = mechanism.traces.iter().enumerate();
    let paths = traces.flat_map(|(index, trace)| {
        rows.iter().map(move |row| {
            let poses = row.iter().filter_map(|s| s.pose.as_ref());
            (poses.map(|p| p.traces[index]).collect(), trace.colour)
        })
    });
    paths.collect()
}
