//! Pictures of clearances: the worst instant of a check, and bodies that change colour in an animation.

use crate::clearance::check::{ClearanceEffort, ClearanceReport, PairReport, check_clearance};
use crate::cli::args::motion::CheckArgs;
use crate::cli::io;
use crate::cli::open::scene::OpenScene;
use crate::cli::term::Term;
use crate::cli::term::outcome::Failure;
use crate::diag::decimals_of;
use crate::export::png::{Effort, PngSettings, StillSink};
use crate::export::{Format, FrameSink, PendingFile};
use crate::kinematics::motion::continuation::solve_motion;
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::system::System;
use crate::model::mechanism::Mechanism;
use crate::render::open::{RendererChoice, open_renderer};
use crate::render::overlay::Overlay;
use crate::report::clearance::{asked_words, body_names, verdict_words};
use crate::report::lengths::distance_words;
use crate::scene::Scene;
use crate::staging::marks::{DimensionMark, Marks};
use crate::staging::{PictureOptions, Staging};
use image::RgbaImage;
use std::path::Path;
use std::sync::Arc;

/// Size and sampling of the picture.
const OPTIONS: PictureOptions = PictureOptions {
    size: [960, 720],
    samples: 4,
};

/// Accuracy of the bound where only the samples count.
const COARSE: f64 = 1.0;

/// Draws the worst pair at its worst instant.
pub fn write_worst_pair(
    args: &CheckArgs,
    opened: &OpenScene,
    motion: &Trajectory,
    report: &ClearanceReport,
    path: &Path,
    term: &Term,
) -> Result<(), Failure> {
    let OpenScene { scene, system, .. } = opened;
    let Some(worst) = report.worst() else {
        term.warning("no pair is judged: there is nothing to draw");
        return Ok(());
    };
    if Format::from_path(path).ok() != Some(Format::Png) {
        return Err(Failure::unknown_kind(path, "picture", "known kind: .png"));
    }
    io::refuse_input(&args.scene, path)?;
    let least = worst.worst_moment();
    // All samples are solved: the camera frames the whole motion.
    let mut all: Vec<f64> = motion.samples.iter().map(|s| s.time).collect();
    let index = all.partition_point(|t| *t < least.time);
    if all.get(index) != Some(&least.time) {
        all.insert(index, least.time);
    }
    let trajectory = solve_motion(system, &scene.actuation, &all);
    let unit = &scene.mechanism.length_unit;
    let marks = Marks {
        measure: Some(DimensionMark {
            bodies: worst.pair,
            points: least.points,
            text: distance_words(least.distance, 3, unit),
            caption: pair_caption(&scene.mechanism, worst),
            is_alarm: !worst.judgement.is_kept(),
        }),
        ..Marks::default()
    };
    let staging = Staging::marked(scene, &trajectory, OPTIONS, marks);
    let choice = RendererChoice::Cpu;
    let stage = Arc::clone(&staging.stage);
    let mut image = RgbaImage::new(OPTIONS.size[0], OPTIONS.size[1]);
    let frame = staging.frame(index);
    for mut renderer in open_renderer(choice, choice.default_adapter(), stage, 1)? {
        renderer.draw(&frame, &mut image)?;
    }
    Overlay::new(staging.stage.background).draw(&frame, &frame.camera(&staging.stage), &mut image);
    let settings = PngSettings {
        size: OPTIONS.size,
        effort: Effort::Balanced,
        alpha: false,
        dpi: None,
        texts: Vec::new(),
    };
    let mut sink = StillSink::new(Box::new(PendingFile::create(path)?), settings)?;
    let mut coded = Vec::new();
    sink.coder().code(&image, &mut coded)?;
    sink.write(0, &coded)?;
    Box::new(sink).finish()?;
    Ok(())
}

/// The bodies, the time, and the requirement.
fn pair_caption(mechanism: &Mechanism, pair: &PairReport) -> Vec<String> {
    let unit = &mechanism.length_unit;
    let who = format!(
        "{}: {}",
        body_names(mechanism, pair).join(" / "),
        verdict_words(pair, unit)
    );
    let (shown, minimum) = (pair.worst_moment(), |minimum| {
        format!("minimum {} {unit}", decimals_of(minimum, 4))
    });
    let when = format!(
        "{} at t = {} s, {}",
        distance_words(shown.distance, 4, unit),
        decimals_of(shown.time, 4),
        asked_words(pair, minimum)
    );
    vec![who, when]
}

/// For every sample, the bodies that are nearer to another one than the scene permits.
pub fn alarm_marks(
    scene: &Scene,
    system: &System,
    trajectory: &Trajectory,
) -> Result<Marks, Failure> {
    let Some(rules) = &scene.clearance else {
        return Err(Failure::without_clearance(
            "the scene has no section [clearance]",
        ));
    };
    let times: Vec<f64> = trajectory.samples.iter().map(|s| s.time).collect();
    let actuation = &scene.actuation;
    let report = check_clearance(
        system,
        actuation,
        rules,
        trajectory,
        ClearanceEffort::to(COARSE),
        &|_, _| {},
    );
    let alarmed = times.iter().map(|time| report.offenders(*time)).collect();
    Ok(Marks {
        alarmed,
        ..Marks::default()
    })
}
