//! `mechanim render`: solves, stages, draws and encodes; or writes shapes and their motion.

use super::poster::{Poster, plan_poster};
use super::solve::up_to;
use super::{event_messages, models, plot};
use crate::cli::args::motion::{HighlightArg, RenderArgs, RendererArg};
use crate::cli::files::sinks;
use crate::cli::files::sinks::OpenFilm;
use crate::cli::interrupt::{is_interrupted, refuse_interrupted};
use crate::cli::io;
use crate::cli::open::planned::scene_arguments;
use crate::cli::open::scene::OpenScene;
use crate::cli::open::{inputs_table, scene as open_scene};
use crate::cli::pictures::clearance as clearance_picture;
use crate::cli::term::Term;
use crate::cli::term::clock::Clock;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::export::Format;
use crate::kinematics::motion::continuation::solve_until;
use crate::kinematics::motion::sampling::{self, even_times, frame_rate, frame_times, path_times};
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::solve::iterates::{iterate_film, record_iterates};
use crate::kinematics::structure::system::System;
use crate::limits::allow_picture;
use crate::model::printed::InputReading;
use crate::model::view::Ghosts;
use crate::pictures::frames::{DrawnBy, Pictures};
use crate::pictures::playback::PlayOrder;
use crate::pictures::texts::picture_texts;
use crate::render::BYTES_OF_DRAWN_PIXEL;
use crate::render::adapter::AdapterChoice;
use crate::render::open::RendererChoice;
use crate::render::text::missing_glyphs;
use crate::scene::Scene;
use crate::staging::marks::Marks;
use crate::staging::model::Facets;
use crate::staging::{PictureOptions, Staging, panes};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// Slow enough to show the effect of every step.
const ITERATES_A_SECOND: f64 = 1.0;

/// Runs the verb.
pub fn run_render(args: &RenderArgs, term: &Term) -> Result<Outcome, Failure> {
    let mut clock = Clock::new(args.timings);
    let format = kind_of_output(args)?;
    if args.resolution.is_some() && !format.is_model() {
        let message = format!("--resolution has no effect on {}", format.name());
        let hint = "it applies to GLB, STL and OBJ".to_owned();
        return Err(Failure::usage(message, vec![hint]));
    }
    io::refuse_input(&args.scene, &args.file.out)?;
    let OpenScene {
        mut scene, system, ..
    } = open_scene::open_scene(&args.scene, term)?;
    args.view.apply(&format, &mut scene)?;
    // Models hold no text.
    if !format.is_model() {
        warn_of_missing_glyphs(&scene, term);
    }
    let poster = plan_poster(args, &format, &drawn_by(args), scene.view.transparent)?;
    clock.end_stage("read");
    let (plan, trajectory, outcome) = if args.trace_iterations {
        trace_iterations(args, &system, &mut scene, &format)?
    } else {
        let plan = RenderPlan::new(args, &scene, &format)?;
        if !format.is_model() && poster.is_none() {
            let at_once = drawn_by(args).threads.min(plan.count).max(1);
            let bytes = at_once as f64 * BYTES_OF_DRAWN_PIXEL;
            allow_picture(args.size, bytes, "a picture of --size")?;
        }
        sampling::allow_samples(&scene.mechanism, plan.times.len())?;
        let proof = Some(InputReading::Numbers);
        let mut trajectory = solve_until(
            &system,
            &scene.actuation,
            &plan.times,
            proof,
            &is_interrupted,
        );
        refuse_interrupted()?;
        event_messages::note_moved_start(&system, &scene.actuation, &mut trajectory)?;
        let outcome = event_messages::tell_events(&system, &scene.actuation, &trajectory, term)?;
        (plan, trajectory, outcome)
    };
    let scene = scene;
    clock.end_stage("solve");
    let panel = args.panel.as_deref();
    let panel =
        panel.map(|title| plot::companion_film(title, (&scene, &system), &trajectory, args.size));
    let panel = panel.transpose()?;
    let options = PictureOptions {
        size: panel.as_ref().map_or(args.size, |p| p.animation),
        samples: args.samples,
    };
    let marks = match args.highlight {
        Some(HighlightArg::Clearance) => {
            clearance_picture::alarm_marks(&scene, &system, &trajectory)?
        }
        None => Marks::default(),
    };
    let views = if scene.view.four && !format.is_model() {
        panes::pane_scenes(&scene)
    } else {
        Vec::new()
    };
    let panes = panes::pane_stagings(&views, &trajectory, options, &marks);
    let staging = Staging::marked(&scene, &trajectory, options, marks);
    if staging.is_bare(plan.frame_range().start) {
        term.warning(
            "nothing is drawn: the scene has no links, bars or contacts, or all bodies are hidden",
        );
    }
    clock.end_stage("stage");
    if format.is_model() {
        let samples = plan.frame_range();
        models::write_model(
            (&args.file, args.resolution.unwrap_or(Facets::Tool)),
            &format,
            &scene,
            &trajectory,
            &staging,
            samples,
            term,
        )?;
        clock.end_stage("write");
    } else {
        let pictures = Pictures {
            scene: &scene,
            panes: &panes,
            staging: &staging,
            order: plan.order(&scene),
            panel: panel.as_ref(),
        };
        io::unless_reader_left(draw_film(
            args,
            (&format, poster),
            &plan,
            &trajectory,
            &pictures,
            &mut clock,
            term,
        ))?;
    }
    clock.print(term);
    Ok(outcome_of_frames(outcome, &trajectory, &plan))
}

/// Warns of characters that cannot be drawn.
fn warn_of_missing_glyphs(scene: &Scene, term: &Term) {
    let mechanism = &scene.mechanism;
    let inputs = mechanism.inputs.iter().map(|input| input.name.as_str());
    let labels = scene.view.labels.iter().map(|label| label.text.as_str());
    let dimensions = scene.view.dimensions.iter();
    let dimensions = dimensions.filter_map(|dimension| dimension.text.as_deref());
    let texts: Vec<&str> = std::iter::once(mechanism.title.as_str())
        .chain(labels)
        .chain(dimensions)
        .chain(inputs)
        .collect();
    for text in texts {
        let missing = missing_glyphs(text);
        if !missing.is_empty() {
            let named = missing
                .iter()
                .map(|c| format!("`{}` (U+{:04X})", c.escape_debug(), u32::from(*c)));
            let named = named.collect::<Vec<_>>().join(", ");
            let text = text.escape_debug();
            term.warning(&format!("no glyph for {named} in `{text}`: drawn as a box"));
        }
    }
}

/// Newton's iterates instead of a motion; the earlier ones remain as ghosts.
fn trace_iterations(
    args: &RenderArgs,
    system: &System,
    scene: &mut Scene,
    format: &Format,
) -> Result<(RenderPlan, Trajectory, Outcome), Failure> {
    let mechanism = &scene.mechanism;
    let start = scene.actuation.start_at(0.0);
    let (list, closed) = record_iterates(system, &start);
    let trajectory = iterate_film(mechanism, &start[mechanism.unknowns.len()..], &list);
    let count = trajectory.samples.len();
    let times: Vec<f64> = trajectory.samples.iter().map(|s| s.time).collect();
    scene.actuation.duration = count as f64;
    Arc::make_mut(&mut scene.view).decor.ghosts = Ghosts::Times(times.clone());
    let still = format.is_still();
    let plan = RenderPlan {
        times,
        stride: 1,
        first: if still { count - 1 } else { 0 },
        count: if still { 1 } else { count },
        fps: args.fps.unwrap_or(ITERATES_A_SECOND),
    };
    let outcome = if closed {
        Outcome::Done
    } else {
        Outcome::Undecided
    };
    Ok((plan, trajectory, outcome))
}

/// Draws and encodes the frames of the plan, or the strips of a poster.
fn draw_film(
    args: &RenderArgs,
    (format, poster): (&Format, Option<Poster>),
    plan: &RenderPlan,
    trajectory: &Trajectory,
    pictures: &Pictures,
    clock: &mut Clock,
    term: &Term,
) -> Result<(), Failure> {
    let mut workers = match poster {
        Some(poster) => pictures.strip_workers(poster.strips, poster.workers)?,
        None => {
            let workers = pictures.workers(&drawn_by(args))?;
            if args.renderer == RendererArg::Gpu {
                term.note(&format!("drawing on {}", workers.name));
            }
            workers.list
        }
    };
    clock.end_stage("renderer");
    let destination = sinks::open_sink(&args.file, format)?;
    let count = match poster {
        Some(poster) => poster.strips.count(),
        None => pictures.order.pictures(),
    };
    let mut film = OpenFilm::new(&args.file, format, args.size, count, plan.fps)
        .with_needed_colours(pictures.staging.needed_colours())
        .with_texts(texts_of(args, &pictures.scene.mechanism.title))
        .with_alpha(pictures.scene.view.transparent);
    if let Some(poster) = poster {
        film = film.in_strips(poster.strips.rows);
    }
    let prepared = film.sink(destination, &mut workers, term)?;
    clock.end_stage("palette");
    let summary = film.write(prepared, workers, term)?;
    clock.end_stage("draw and encode");
    let worst = trajectory.closure_error();
    film.tell(
        &summary,
        &format!(", worst closure error {worst:.1e}"),
        term,
    );
    Ok(())
}

/// What a PNG says of itself: the title, the program, the scene and its changes.
fn texts_of(args: &RenderArgs, title: &str) -> Vec<(String, String)> {
    let scene = Path::new(&args.scene.scene);
    let source = scene.file_name().unwrap_or(scene.as_os_str());
    let changes = scene_arguments(&args.scene);
    picture_texts(title, &source.display().to_string(), &changes)
}

/// The renderer: the adapter chosen with `--adapter` or MECHANIM_ADAPTER, else the default of the renderer.
fn drawn_by(args: &RenderArgs) -> DrawnBy {
    let renderer = match args.renderer {
        RendererArg::Auto => RendererChoice::Auto,
        RendererArg::Gpu => RendererChoice::Gpu,
        RendererArg::Cpu => RendererChoice::Cpu,
    };
    let from_environment = || {
        let name = std::env::var("MECHANIM_ADAPTER").ok();
        name.filter(|name| !name.is_empty())
    };
    let adapter = match args.adapter.clone().or_else(from_environment) {
        Some(name) if name == "software" => AdapterChoice::Software,
        Some(name) => AdapterChoice::Name(name),
        None => renderer.default_adapter(),
    };
    DrawnBy {
        renderer,
        adapter,
        threads: args.file.threads.unwrap_or_else(crate::jobs::core_count),
    }
}

/// The samples that become pictures, and when they are shown.
struct RenderPlan {
    times: Vec<f64>,
    /// Steps into which the interval between two frames is divided.
    stride: usize,
    /// First frame that is drawn.
    first: usize,
    count: usize,
    fps: f64,
}

impl RenderPlan {
    fn new(args: &RenderArgs, scene: &Scene, format: &Format) -> Result<Self, Failure> {
        let (mechanism, actuation) = (&scene.mechanism, &scene.actuation);
        let fps = frame_rate(actuation, args.fps.unwrap_or(scene.view.fps));
        let frames = match args.frames {
            Some(count) => even_times(mechanism, actuation, count),
            None if args.scene.table.is_some() => inputs_table::row_times(actuation),
            None => frame_times(mechanism, actuation, fps),
        };
        // Frames selected by number play in the scene's duration.
        let fps = args
            .frames
            .map_or(fps, |count| count as f64 / actuation.duration);
        let still = match (args.at, args.frame) {
            (Some(at), _) => Some(at),
            (None, Some(frame)) => Some(frame_time(&frames, frame)?),
            (None, None) if format.is_still() => Some(0.0),
            (None, None) => None,
        };
        let plan = match still {
            None => {
                let mut frames = frames;
                // A model is not shown frame by frame: its last key is the end of the drive, cyclic or not.
                if format.is_model() && frames.last().is_some_and(|t| *t < actuation.duration) {
                    frames.push(actuation.duration);
                }
                Self {
                    first: 0,
                    stride: 1,
                    count: frames.len(),
                    times: frames,
                    fps,
                }
            }
            Some(at) => {
                // The frames around it are solved too: the camera frames the whole motion in every still, and the
                // branch is the one that the motion reaches.
                let mut times = up_to(at, actuation.duration, &frames)?;
                let first = times.len() - 1;
                times.extend(frames.iter().copied().filter(|t| *t > at));
                Self {
                    times,
                    stride: 1,
                    first,
                    count: 1,
                    fps,
                }
            }
        };
        let (times, stride) = path_times(mechanism, actuation, &plan.times);
        Ok(Self {
            times,
            stride,
            ..plan
        })
    }
}

impl RenderPlan {
    /// Their timing.
    fn order(&self, scene: &Scene) -> PlayOrder {
        let order = PlayOrder::plain(self.first, self.count).divided(self.stride);
        order.played(scene.view.playback, self.fps)
    }

    /// The samples that are shown, and those between them.
    fn frame_range(&self) -> Range<usize> {
        let last = self.first + self.count.saturating_sub(1);
        self.first * self.stride..last * self.stride + 1
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

fn kind_of_output(args: &RenderArgs) -> Result<Format, Failure> {
    let format = sinks::film_format(&args.file)?;
    let single = args.at.is_some() || args.frame.is_some();
    let playing = [
        (args.view.bounce, "--bounce"),
        (args.view.pause.is_some(), "--pause"),
    ];
    if let Some((_, option)) = playing.iter().find(|(given, _)| *given)
        && (single || format.is_still())
    {
        return Err(Failure::usage(
            format!("{option} has no effect on a single picture"),
            vec!["it applies to animations".to_owned()],
        ));
    }
    if format.is_still() && args.frames.is_some_and(|n| n > 1) && !single {
        let out = args.file.out.display();
        let (message, hint) = if format.is_model() {
            let message = format!("{out}: {} contains one pose, not a motion", format.name());
            (
                message,
                "for the motion write a .glb; for one pose say --at SECONDS",
            )
        } else {
            let hint =
                "for all frames write a .gif, .apng, a folder, or a pattern such as frame-%04d.png";
            (format!("{out} contains one picture"), hint)
        };
        return Err(Failure::usage(message, vec![hint.to_owned()]));
    }
    Ok(format)
}

/// Only frames that were drawn count.
fn outcome_of_frames(outcome: Outcome, trajectory: &Trajectory, plan: &RenderPlan) -> Outcome {
    let mut drawn = trajectory.samples[plan.frame_range()]
        .iter()
        .step_by(plan.stride);
    match outcome {
        Outcome::NotClosed | Outcome::Undecided if drawn.all(|sample| sample.pose.is_some()) => {
            Outcome::Done
        }
        _ => outcome,
    }
}
