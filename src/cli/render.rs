//! `mechanim render`: solve, stage, draw, encode.

use super::args::{RenderArgs, RendererArg, ShowArg};
use super::outcome::{Failure, Outcome};
use super::progress::Progress;
use super::solve::up_to;
use super::term::Term;
use super::{CANCEL, clearance_picture, inputs_table, open_scene, plot, report};
use crate::export::gif::{GifSettings, GifSink, Quality, sample_indices};
use crate::export::palette::Palette;
use crate::export::png::{SequenceSink, StillSink};
use crate::export::pump::{PumpError, Samples, draw_samples, pump};
use crate::export::timing::{FrameTimes, Schedule};
use crate::export::{ExportSummary, Format, FrameSink, Stream, Target};
use crate::kinematics::continuation::solve;
use crate::kinematics::sampling::{even_times, frame_times};
use crate::kinematics::trajectory::Trajectory;
use crate::plot::companion::Companion;
use crate::plot::raster::Painter;
use crate::render::adapter::AdapterChoice;
use crate::render::open::{RendererChoice, open};
use crate::render::overlay::Overlay;
use crate::render::{RenderError, Renderer};
use crate::scene::Scene;
use crate::staging::marks::Marks;
use crate::staging::{PictureOptions, Staging};
use image::RgbaImage;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Runs the verb.
pub fn run(args: &RenderArgs, term: &Term) -> Result<Outcome, Failure> {
    let mut clock = Clock::new(args.timings);
    let format = kind_of_output(args)?;
    if open_scene::is_scene_file(&args.scene, &args.out) {
        return Err(Failure::usage(
            format!("{} is an input of this command", args.out.display()),
            Vec::new(),
        ));
    }
    let scene = open_scene::open(&args.scene, term)?;
    clock.lap("read");
    let plan = Plan::new(args, &scene, &format)?;
    let trajectory = solve(&scene.mechanism, &plan.times)?;
    let outcome = report::events(&scene.mechanism, &trajectory, term)?;
    clock.lap("solve");
    let panel = args.panel.as_deref();
    let panel = panel.map(|title| plot::companion(title, &scene, &trajectory, args.size));
    let panel = panel.transpose()?;
    let options = PictureOptions {
        size: panel.as_ref().map_or(args.size, |p| p.animation),
        samples: args.samples,
    };
    let marks = match args.show {
        Some(ShowArg::Clearance) => clearance_picture::alarms(&scene, &trajectory)?,
        None => Marks::default(),
    };
    let staging = Staging::marked(&scene, &trajectory, options, marks);
    clock.lap("stage");
    let pictures = Pictures {
        staging: &staging,
        first: plan.first,
        panel: panel.as_ref(),
    };
    let mut workers = pictures.workers(args, term)?;
    clock.lap("renderer");
    let output = destination(args, &format)?;
    let (sink, samples) = sink(args, term, &plan, output, &pictures, &mut workers)?;
    clock.lap("palette");
    let progress = Progress::new(args.progress, term.quiet());
    let result = pump(
        workers,
        plan.count,
        samples,
        sink,
        &|done, all| progress.show(done, all),
        &CANCEL,
    );
    progress.end();
    let summary = result.map_err(failure)?;
    clock.lap("draw and encode");
    clock.print(term);
    tell(args, term, &trajectory, &summary);
    Ok(outcome_of_frames(outcome, &trajectory, &plan))
}

/// Which samples become pictures, and when they are shown.
struct Plan {
    times: Vec<f64>,
    /// First sample that is drawn.
    first: usize,
    count: usize,
    fps: f64,
}

impl Plan {
    fn new(args: &RenderArgs, scene: &Scene, format: &Format) -> Result<Self, Failure> {
        let mechanism = &scene.mechanism;
        let fps = args.fps.unwrap_or(scene.view.fps);
        let frames = match args.frames {
            Some(count) => even_times(mechanism, count),
            None if args.scene.table.is_some() => inputs_table::row_times(mechanism),
            None => frame_times(mechanism, fps),
        };
        // Frames asked for by number play in the scene's duration.
        let fps = args
            .frames
            .map_or(fps, |count| count as f64 / mechanism.duration);
        let still = match (args.at, args.frame) {
            (Some(at), _) => Some(at),
            (None, Some(frame)) => Some(frame_time(&frames, frame)?),
            (None, None) if *format == Format::Png => Some(0.0),
            (None, None) => None,
        };
        match still {
            None => Ok(Self {
                first: 0,
                count: frames.len(),
                times: frames,
                fps,
            }),
            Some(at) => {
                // The frames around it are solved too: the camera holds the whole motion in every still, and the
                // branch is the one that the motion reaches.
                let mut times = up_to(at, mechanism.duration, &frames)?;
                let first = times.len() - 1;
                times.extend(frames.iter().copied().filter(|t| *t > at));
                Ok(Self {
                    times,
                    first,
                    count: 1,
                    fps,
                })
            }
        }
    }
}

fn frame_time(frames: &[f64], frame: usize) -> Result<f64, Failure> {
    frames.get(frame).copied().ok_or_else(|| {
        Failure::usage(
            format!(
                "the motion has frames 0 to {}, {frame} is outside",
                frames.len() - 1
            ),
            Vec::new(),
        )
    })
}

/// Draws samples of the motion by the index of their picture.
#[derive(Clone, Copy)]
struct Pictures<'a> {
    staging: &'a Staging<'a>,
    first: usize,
    panel: Option<&'a Companion>,
}

type Worker<'a> = Box<dyn FnMut(usize, &mut RgbaImage) -> Result<(), RenderError> + Send + 'a>;

impl<'a> Pictures<'a> {
    fn workers(self, args: &RenderArgs, term: &Term) -> Result<Vec<Worker<'a>>, Failure> {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let choice = match args.renderer {
            RendererArg::Auto => RendererChoice::Auto,
            RendererArg::Gpu => RendererChoice::Gpu,
            RendererArg::Cpu => RendererChoice::Cpu,
        };
        let stage = Arc::clone(&self.staging.stage);
        let renderers = open(
            choice,
            adapter(args, choice),
            stage,
            args.threads.unwrap_or(cores),
        )?;
        if let (RendererChoice::Gpu, Some(renderer)) = (choice, renderers.first()) {
            term.note(&format!("drawing on {}", renderer.name()));
        }
        Ok(renderers
            .into_iter()
            .map(|renderer| self.worker(renderer))
            .collect())
    }

    fn worker(self, mut renderer: Box<dyn Renderer>) -> Worker<'a> {
        let stage = &self.staging.stage;
        let mut overlay = Overlay::new(stage.background);
        let mut draw = move |sample: usize, image: &mut RgbaImage| {
            let frame = self.staging.frame(sample);
            renderer.draw(&frame, image)?;
            overlay.draw(&frame, &stage.camera, image);
            Ok(())
        };
        let Some(panel) = self.panel else {
            return Box::new(move |picture, image| draw(self.first + picture, image));
        };
        let [width, height] = panel.animation;
        let (mut motion, mut painter) = (RgbaImage::new(width, height), Painter::default());
        Box::new(move |picture, image| {
            let sample = self.first + picture;
            draw(sample, &mut motion)?;
            panel.compose(&motion, sample, &mut painter, image);
            Ok(())
        })
    }
}

/// The adapter asked for with `--adapter` or MECHANIM_ADAPTER, else the one that suits the renderer.
fn adapter(args: &RenderArgs, choice: RendererChoice) -> AdapterChoice {
    let from_environment = || {
        std::env::var("MECHANIM_ADAPTER")
            .ok()
            .filter(|name| !name.is_empty())
    };
    match args.adapter.clone().or_else(from_environment) {
        Some(name) if name == "software" => AdapterChoice::Software,
        Some(name) => AdapterChoice::Name(name),
        None => choice.default_adapter(),
    }
}

/// Where the bytes go; opened before anything is drawn, so that a bad path is found at once.
enum Destination {
    Gif(Box<dyn crate::export::Output>),
    Still(Box<dyn crate::export::Output>),
    Sequence(crate::export::format::FramePattern),
}

fn kind_of_output(args: &RenderArgs) -> Result<Format, Failure> {
    if args.out == Path::new("-") {
        return Ok(Format::Gif);
    }
    let format = Format::from_path(&args.out)?;
    let single = args.at.is_some() || args.frame.is_some();
    if format == Format::Png && args.frames.is_some_and(|n| n > 1) && !single {
        return Err(Failure::usage(
            format!("{} holds one picture", args.out.display()),
            vec![
                "for all frames write a .gif, a folder, or a pattern such as frame-%04d.png"
                    .to_owned(),
            ],
        ));
    }
    Ok(format)
}

fn destination(args: &RenderArgs, format: &Format) -> Result<Destination, Failure> {
    let open = || -> Result<Box<dyn crate::export::Output>, Failure> {
        if args.out == Path::new("-") {
            return Ok(Box::new(Stream::new("standard output", std::io::stdout())));
        }
        Ok(Box::new(Target::create(&args.out)?))
    };
    Ok(match format {
        Format::Gif => Destination::Gif(open()?),
        Format::Png => Destination::Still(open()?),
        Format::PngSequence(pattern) => Destination::Sequence(pattern.clone()),
    })
}

/// One of the 256 entries of a GIF's palette stands for "unchanged".
const PALETTE_COLOURS: usize = 255;

type Prepared = (Box<dyn FrameSink>, Samples);

fn sink(
    args: &RenderArgs,
    term: &Term,
    plan: &Plan,
    destination: Destination,
    pictures: &Pictures,
    workers: &mut [Worker],
) -> Result<Prepared, Failure> {
    let size = args.size;
    match destination {
        Destination::Still(output) => Ok((Box::new(StillSink::new(output, size)?), Vec::new())),
        Destination::Sequence(pattern) => {
            Ok((Box::new(SequenceSink::new(pattern, size)?), Vec::new()))
        }
        Destination::Gif(output) => {
            let samples = draw_samples(workers, &sample_indices(plan.count), size, &CANCEL)
                .map_err(failure)?;
            let palette = Palette::from_samples(
                samples.iter().map(|(_, image)| image),
                &pictures.staging.flat_colours(),
                PALETTE_COLOURS,
            );
            let settings = GifSettings {
                size,
                schedule: schedule(plan, term)?,
                repeat: true,
                quality: Quality::new(args.quality).unwrap_or(Quality::BEST),
            };
            Ok((
                Box::new(GifSink::new(output, settings, Arc::new(palette))?),
                samples,
            ))
        }
    }
}

/// When the frames are shown; viewers of GIFs do not go beyond 50 a second.
fn schedule(plan: &Plan, term: &Term) -> Result<Schedule, Failure> {
    let times = FrameTimes::Uniform {
        fps: plan.fps,
        count: plan.count,
    };
    let schedule = Schedule::new(times, 0.0)?;
    if let Some(clamp) = schedule.clamp() {
        term.warning(&format!(
            "a GIF shows at most 50 frames a second: it will last {:.2} s instead of {:.2} s",
            clamp.written_seconds, clamp.asked_seconds
        ));
    }
    Ok(schedule)
}

fn failure(error: PumpError<RenderError>) -> Failure {
    match error {
        PumpError::Draw { source, .. } => source.into(),
        PumpError::Export(error) => error.into(),
        PumpError::Cancelled => Failure::Interrupted,
        PumpError::NoWorkers => Failure::Internal(error.to_string()),
    }
}

fn tell(args: &RenderArgs, term: &Term, trajectory: &Trajectory, summary: &ExportSummary) {
    if args.out == Path::new("-") {
        return;
    }
    let frames = if summary.frames == 1 {
        "1 frame".to_owned()
    } else {
        format!("{} frames", summary.frames)
    };
    let time = if summary.seconds > 0.0 {
        format!(", {:.2} s", summary.seconds)
    } else {
        String::new()
    };
    term.note(&format!(
        "{}: {frames} of {}x{}{time}, {:.2} MB, worst closure error {:.1e}",
        args.out.display(),
        args.size[0],
        args.size[1],
        summary.bytes as f64 / 1e6,
        trajectory.closure_error(),
    ));
}

/// Only frames that were drawn count.
fn outcome_of_frames(outcome: Outcome, trajectory: &Trajectory, plan: &Plan) -> Outcome {
    let drawn = &trajectory.samples[plan.first..plan.first + plan.count];
    if outcome == Outcome::NotClosed && drawn.iter().all(|sample| sample.pose.is_some()) {
        return Outcome::Done;
    }
    outcome
}

/// Wall time per stage, for `--timings`.
struct Clock {
    wanted: bool,
    start: Instant,
    laps: Vec<(&'static str, f64)>,
}

impl Clock {
    fn new(wanted: bool) -> Self {
        Self {
            wanted,
            start: Instant::now(),
            laps: Vec::new(),
        }
    }

    fn lap(&mut self, stage: &'static str) {
        let now = Instant::now();
        self.laps.push((stage, (now - self.start).as_secs_f64()));
        self.start = now;
    }

    fn print(&self, term: &Term) {
        if !self.wanted {
            return;
        }
        for (stage, seconds) in &self.laps {
            term.note(&format!("{:>9.1} ms  {stage}", seconds * 1e3));
        }
        let total: f64 = self.laps.iter().map(|(_, s)| s).sum();
        term.note(&format!("{:>9.1} ms  in all", total * 1e3));
    }
}
