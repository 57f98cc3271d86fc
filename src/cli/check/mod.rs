//! `mechanim check`: do all loops close over the motion; is an offered pose a closed one.

pub mod clearance;

use super::args::motion::{CertifyArg, CheckArgs};
use super::motion::certify;
use super::motion::event_messages;
use super::open::inputs_table;
use super::open::scene::{self as open_scene, OpenScene};
use super::term::Term;
use super::term::outcome::{Failure, Outcome};
use crate::cli::io;
use crate::diag::nearest;
use crate::kinematics::freedoms::mobility::Mobility;
use crate::kinematics::motion::sampling::{even_times, frame_times, knots, only};
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::solve::pose_check::{OfferedLoop, Verdict, judge};
use crate::model::mechanism::Mechanism;
use crate::report::events::gaps;
use crate::report::measures;
use crate::report::measures::Measured;
use crate::report::proof::{MotionProof, PoseProofs, assumptions};
use crate::report::{freedoms, sentences};
use crate::scene::Scene;
use serde_json::{Value, json};

/// Runs the verb.
pub fn run(args: &CheckArgs, term: &Term) -> Result<Outcome, Failure> {
    if !(args.closure > 0.0 && args.closure.is_finite()) {
        return Err(Failure::usage(
            "the largest closure error must be a positive number",
            Vec::new(),
        ));
    }
    let opened = open_scene::open(&args.scene, term)?;
    let (text, document, outcome) = if args.pose.is_empty() {
        motion(args, &opened, term)?
    } else {
        pose(args, &opened.scene)?
    };
    if let Some(path) = &args.json {
        io::write_json(&args.scene, path, &document)?;
    }
    io::print_beside(args.json.as_deref(), &text)?;
    Ok(outcome)
}

type Report = (String, Value, Outcome);

/// Closure over the whole motion.
fn motion(args: &CheckArgs, opened: &OpenScene, term: &Term) -> Result<Report, Failure> {
    let OpenScene { scene, system } = opened;
    let (mechanism, actuation) = (&scene.mechanism, &scene.actuation);
    let times = match args.samples {
        Some(count) => even_times(mechanism, actuation, count),
        None if args.scene.table.is_some() => inputs_table::row_times(actuation),
        None => frame_times(mechanism, actuation, scene.view.fps),
    };
    // Tubes, which clearances are bounded by, join certified poses.
    let needed = match args.certify {
        CertifyArg::None if scene.clearance.is_some() => CertifyArg::Pose,
        asked => asked,
    };
    let mut trajectory = certify::motion(system, actuation, &knots(actuation, &times), needed)?;
    let mobility = Mobility::new(system, actuation);
    event_messages::note_moved_start(system, actuation, &mut trajectory)?;
    let closed = event_messages::tell(system, actuation, &trajectory, term)?;
    let worst = trajectory.closure_error();
    // Sums and means are over the samples that were asked for.
    let measured = measures::take(system, scene, &only(actuation, &trajectory, &times));
    let proves_motion = args.certify == CertifyArg::Motion;
    let motion = proves_motion.then(|| MotionProof::of(&trajectory));
    let clearances = clearance::run(args, opened, &trajectory, term)?;
    let fails = [
        worst > args.closure,
        !motion.as_ref().is_none_or(MotionProof::is_whole),
        !measured.iter().all(Measured::holds),
        clearances.as_ref().is_some_and(|part| !part.passed),
    ];
    let outcome = match closed {
        Outcome::Done if fails.contains(&true) => Outcome::CheckFailed,
        other => other,
    };
    let sigma = trajectory
        .poses()
        .map(|p| p.sigma_min)
        .fold(f64::INFINITY, f64::min);
    let condition = trajectory.poses().map(|p| p.condition).fold(0.0, f64::max);
    let branches = branches(&trajectory);
    let is_proof_asked = args.certify != CertifyArg::None;
    let proof = PoseProofs::of(&trajectory, is_proof_asked);
    let verdict = verdict(outcome);
    let lines = measured.iter().map(|m| format!("  {}\n", m.line()));
    let lines: String = lines.collect();
    let assumptions = match is_proof_asked {
        true => assumptions(system.structure()),
        false => Vec::new(),
    };
    let assumed = match assumptions.is_empty() {
        true => String::new(),
        false => format!("  assumed          {}\n", assumptions.join("; ")),
    };
    let motion_line = motion.as_ref().map_or_else(String::new, |proof| {
        format!(
            "  motion           {}\n",
            proof.sentence(mechanism, actuation)
        )
    });
    let text = format!(
        "{}\n  samples          {} ({} without a pose)\n  closure error    {worst:.2e} (allowed {:.0e}, relative to {} {})\n  \
         smallest sigma   {sigma:.4}\n  condition        {condition:.1}\n  branch           {}\n  certificate      {}\n{motion_line}{assumed}{}{lines}{}  result           {verdict}\n",
        mechanism.title,
        trajectory.samples.len(),
        trajectory.missing(),
        args.closure,
        mechanism.size,
        mechanism.length_unit,
        branches.join(" "),
        proof.sentence(mechanism),
        freedoms::text(mechanism, &mobility),
        clearances.as_ref().map_or("", |part| &part.text),
    );
    let document = json!({
        "schema": "mechanim-check/1",
        "title": mechanism.title,
        "samples": trajectory.samples.len(),
        "missing": trajectory.missing(),
        "closure_error": worst,
        "tolerance": args.closure,
        "size": mechanism.size,
        "sigma_min": if sigma.is_finite() { json!(sigma) } else { Value::Null },
        "condition": if condition.is_finite() { json!(condition) } else { Value::Null },
        "branches": branches,
        "error_bound": proof.certified().map(|p| p.error_bound),
        "unique_radius": proof.certified().map(|p| p.unique_radius),
        "refused": proof.refused,
        "refused_because": proof.reasons,
        "locked": proof.locked,
        "measures": measured.iter().map(Measured::json).collect::<Vec<_>>(),
        "assumed": assumptions,
        "motion": motion.as_ref().map(MotionProof::json),
        "mobility": freedoms::document(mechanism, &mobility),
        "events": trajectory.events.iter().map(|e| sentences::sentence(mechanism, e)).collect::<Vec<_>>(),
        "clearance": clearances.map(|part| part.document),
        "gaps": gaps(mechanism, &trajectory),
        "result": verdict,
    });
    Ok((text, document, outcome))
}

/// The branch signatures met, in order.
fn branches(trajectory: &Trajectory) -> Vec<String> {
    let mut list: Vec<String> = trajectory.poses().map(|p| p.branch.clone()).collect();
    list.dedup();
    list
}

fn verdict(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Done => "passed",
        Outcome::CheckFailed => "failed",
        Outcome::NotClosed => "not closed over the whole motion",
        Outcome::Undecided => "undecided: the motion was given up",
    }
}

/// Judges the pose given with `--pose`.
fn pose(args: &CheckArgs, scene: &Scene) -> Result<Report, Failure> {
    let mechanism = &scene.mechanism;
    let coordinates = offered(args, scene)?;
    let loops = judge(mechanism, &coordinates, args.closure);
    let outcome = if loops.iter().all(|l| l.verdict == Verdict::Closed) {
        Outcome::Done
    } else {
        Outcome::CheckFailed
    };
    let mut text = format!("{}\n", mechanism.title);
    for item in &loops {
        text.push_str(&format!(
            "  loop {}: {}\n",
            item.name,
            sentence(item, mechanism)
        ));
    }
    text.push_str(&format!("  result: {}\n", verdict(outcome)));
    let list: Vec<Value> = loops.iter().map(|l| {
        json!({ "loop": l.name, "angle": l.angle, "distance": l.distance, "verdict": word(l.verdict) })
    }).collect();
    let document = json!({
        "schema": "mechanim-pose/1",
        "title": mechanism.title,
        "tolerance": args.closure,
        "loops": list,
        "result": verdict(outcome),
    });
    Ok((text, document, outcome))
}

fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Closed => "closed",
        Verdict::HalfTurn => "half-turn",
        Verdict::Open => "open",
    }
}

fn sentence(item: &OfferedLoop, mechanism: &Mechanism) -> String {
    let gap = format!(
        "{:.6} rad and {:.6} {}",
        item.angle, item.distance, mechanism.length_unit
    );
    match item.verdict {
        Verdict::Closed => format!(
            "closed (off by {:.1e} rad and {:.1e} {})",
            item.angle, item.distance, mechanism.length_unit
        ),
        Verdict::HalfTurn => format!(
            "half-turn, not closed: the ends meet turned by π ({gap}); a residual of off-diagonal entries takes this for a solution"
        ),
        Verdict::Open => format!("open by {gap}"),
    }
}

/// Coordinates of the offered pose: all unknowns from `--pose`, inputs at the start of the drive.
fn offered(args: &CheckArgs, scene: &Scene) -> Result<Vec<f64>, Failure> {
    let mechanism = &scene.mechanism;
    let mut values = vec![None; mechanism.unknowns.len()];
    for (name, text) in &args.pose {
        let Some(index) = mechanism.unknowns.iter().position(|c| c.name == *name) else {
            let names: Vec<&str> = mechanism.unknowns.iter().map(|c| c.name.as_str()).collect();
            let mut hints = vec![format!("its unknowns are: {}", names.join(", "))];
            hints.extend(
                nearest(name, names.iter().copied()).map(|near| format!("did you mean `{near}`?")),
            );
            return Err(Failure::usage(
                format!("the scene has no unknown `{name}`"),
                hints,
            ));
        };
        let value = text.parse::<f64>().ok().filter(|v| v.is_finite());
        let value = value.ok_or_else(|| {
            Failure::usage(format!("`{text}` is not a value for `{name}`"), Vec::new())
        })?;
        values[index] = Some(value / mechanism.file_units(mechanism.unknowns[index].kind));
    }
    let missing: Vec<&str> = mechanism
        .unknowns
        .iter()
        .zip(&values)
        .filter(|(_, v)| v.is_none())
        .map(|(c, _)| c.name.as_str())
        .collect();
    if !missing.is_empty() {
        return Err(Failure::usage(
            format!("the pose lacks {}", missing.join(", ")),
            Vec::new(),
        ));
    }
    let mut coordinates: Vec<f64> = values.into_iter().flatten().collect();
    coordinates.extend(scene.actuation.inputs_at(0.0));
    Ok(coordinates)
}
