//! `mechanim enclose`: proved bands of the motion and its measures for all pieces within their tolerances.

use crate::analysis::enclosure::{
    Enclosed, MeasureBand, PieceTolerances, SpanBands, TolerancePlan, allowed_motion,
    enclose_between, enclose_measures, enclose_motion, measures_at_all_times, shown_names,
};
use crate::analysis::study::{Nominal, ParametricMechanism};
use crate::charts::bands;
use crate::cli::args::enclose::EncloseArgs;
use crate::cli::files::chart::{PlotFormat, write_chart};
use crate::cli::interrupt::{CANCEL, refuse_interrupted};
use crate::cli::io;
use crate::cli::open::intervals::interval_middles;
use crate::cli::open::study::{nominal_source, open_pieces};
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::jobs::core_count;
use crate::kinematics::motion::sampling;
use crate::model::mechanism::Mechanism;
use crate::report::enclosure as report;
use crate::report::enclosure_between::{between_lines, between_objects};
use std::path::Path;

/// What `--show` and `--allow` name.
const SHOWN: &str = "unknown, traced point or output";

/// Refusals that are listed one by one.
const MOST_TOLD: usize = 5;

/// Runs the verb.
pub fn run_enclose(args: &EncloseArgs, term: &Term) -> Result<Outcome, Failure> {
    let reports = [
        ("--out", args.out.as_deref()),
        ("--plot", args.plot.as_deref()),
    ];
    let (scene, own) = interval_middles(&args.scene)?;
    io::refuse_clashes(&[&scene], &reports)?;
    let format = args.plot.as_deref().map(PlotFormat::of).transpose()?;
    let (source, overrides, drawn) = nominal_source(&scene, term)?;
    let asked = PieceTolerances {
        vary: &args.vary.vary,
        own: &own,
        tolerance: args.tolerance,
        otherwise: args.allow.as_ref().map(|_| 1.0),
        between: args.between,
    };
    let (family, tolerances) = open_pieces(&asked, "--tolerance", (&source, &overrides, &drawn))?;
    let plan = TolerancePlan::new(&family, &tolerances).until(&CANCEL);
    let times = enclose_times(args, &family)?;
    let threads = args.threads.unwrap_or_else(core_count);
    if let Some((name, limit)) = &args.allow {
        return allow_pieces(&plan, name, *limit, &times, threads, term);
    }
    let motion = enclose_motion(&plan, &times, threads, !args.no_search);
    let stretches = match args.between {
        true => enclose_between(&plan, &times, threads),
        false => Vec::new(),
    };
    let measures = measures_of(&plan)?;
    let measures =
        measures.map(|(poses, bands)| (poses, measures_at_all_times(&plan, bands, &stretches)));
    refuse_interrupted()?;
    if let Some(path) = &args.out {
        write_out(
            args,
            path,
            &plan,
            &motion,
            measures.as_ref().map(|m| &m.1[..]),
            &stretches,
        )?;
    }
    if let (Some(path), Some(format)) = (&args.plot, format) {
        let wanted = wanted_slots(&args.only, plan.family.mechanism())?;
        let chart = bands::band_chart(&plan, &motion, &wanted);
        let mut output = io::open_output(path)?;
        let written = write_chart(&chart, format, None, args.theme, output.as_mut());
        io::unless_reader_left(written.and_then(|()| Ok(output.commit()?)))?;
    }
    let mut text = report::enclosure_summary(&plan, &motion, !args.no_search);
    if let Some((poses, list)) = &measures {
        let lines = report::measure_lines(&plan, list);
        let more = match list.iter().any(|band| band.at_all_times) {
            true => ", extremes along the drive at all times",
            false => "",
        };
        text += &format!("\nMeasures over {poses} poses{more}\n{lines}");
    }
    let refused: Vec<String> = motion
        .iter()
        .filter_map(|e| report::refusal_text(&plan, e))
        .collect();
    if args.between {
        text += &between_lines(&plan, &stretches);
    }
    for line in refused.iter().take(MOST_TOLD) {
        text += &format!("\n  {line}");
    }
    if refused.len() > MOST_TOLD {
        text += &format!("\n  and at {} more samples", refused.len() - MOST_TOLD);
    }
    if !refused.is_empty() {
        text.push('\n');
    }
    io::print_beside(term, args.out.as_deref(), &text)?;
    if stretches.iter().any(|s| s.bands.is_err()) {
        return Ok(Outcome::CheckFailed);
    }
    Ok(enclose_outcome(
        &plan,
        &motion,
        measures.as_ref().map(|m| &m.1[..]),
    ))
}

/// Whether everything requested is proved.
fn enclose_outcome(
    plan: &TolerancePlan,
    motion: &[Enclosed],
    measures: Option<&[MeasureBand]>,
) -> Outcome {
    let is_refused = |e: &Enclosed| e.bands.is_err();
    let list = plan.family.measures.list.iter();
    let mut limited = list.zip(measures.into_iter().flatten());
    let breaks = limited.any(|(measure, band)| {
        let is_limited = measure.min.is_some() || measure.max.is_some();
        is_limited && !(measure.allows(band.lo) && measure.allows(band.hi))
    });
    match breaks || motion.iter().any(is_refused) {
        true => Outcome::CheckFailed,
        false => Outcome::Done,
    }
}

/// The bands of the measures and the number of poses that they cover; `None` if the scene has no measures, or a pose of
/// a track has no box.
fn measures_of(plan: &TolerancePlan) -> Result<Option<(usize, Vec<MeasureBand>)>, Failure> {
    if plan.family.measures.list.is_empty() {
        return Ok(None);
    }
    let nominal: Nominal = plan.family.nominal()?;
    let poses = nominal.poses.len();
    match enclose_measures(plan, &nominal) {
        Ok(bands) => Ok(Some((poses, bands))),
        Err(_) => {
            let count = plan.family.measures.list.len();
            let unknown = MeasureBand {
                lo: f64::NEG_INFINITY,
                hi: f64::INFINITY,
                at_all_times: false,
            };
            Ok(Some((poses, vec![unknown; count])))
        }
    }
}

/// The requested samples.
fn enclose_times(args: &EncloseArgs, family: &ParametricMechanism) -> Result<Vec<f64>, Failure> {
    let mut times = args.at.clone();
    let last = family.actuation.duration;
    if let Some(bad) = times.iter().find(|t| !(0.0..=last).contains(*t)) {
        let message = format!("--at {bad}: the motion lasts from 0 to {last} s");
        return Err(Failure::usage(message, Vec::new()));
    }
    times.sort_by(f64::total_cmp);
    times.dedup();
    if times.is_empty() {
        times = sampling::even_times(family.mechanism(), &family.actuation, args.samples);
    }
    sampling::allow_samples(family.mechanism(), times.len())?;
    Ok(times)
}

fn write_out(
    args: &EncloseArgs,
    path: &Path,
    plan: &TolerancePlan,
    motion: &[Enclosed],
    measures: Option<&[MeasureBand]>,
    stretches: &[SpanBands],
) -> Result<(), Failure> {
    let searched = !args.no_search;
    let is_json = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("json"));
    if !is_json {
        return io::write_text(
            &args.scene,
            path,
            &report::enclosure_csv(plan, motion, searched),
        );
    }
    let mut document = report::enclosure_document(plan, motion, measures, searched);
    if args.between {
        document["stretches"] = between_objects(plan, stretches);
    }
    io::write_json(&args.scene, path, &document)
}

/// Indices of the quantities that are drawn.
fn wanted_slots(only: &[String], mechanism: &Mechanism) -> Result<Vec<usize>, Failure> {
    let names: Vec<String> = shown_names(mechanism).into_iter().map(|(n, _)| n).collect();
    if only.is_empty() {
        let unknowns = mechanism.unknowns.len();
        let all = if names.len() > unknowns {
            unknowns..names.len()
        } else {
            0..unknowns
        };
        return Ok(all.collect());
    }
    let mut wanted = Vec::new();
    for name in only {
        let part = format!("{name}.");
        let found = names.iter().enumerate();
        let before = wanted.len();
        wanted.extend(
            found
                .filter(|(_, n)| *n == name || n.starts_with(&part))
                .map(|(k, _)| k),
        );
        if wanted.len() == before {
            let known = names.iter().map(String::as_str);
            return Err(Failure::unknown_name(SHOWN, name, known));
        }
    }
    Ok(wanted)
}

/// `--allow`: how large all tolerances may be together.
fn allow_pieces(
    plan: &TolerancePlan,
    name: &str,
    limit: f64,
    times: &[f64],
    threads: usize,
    term: &Term,
) -> Result<Outcome, Failure> {
    let found = allowed_motion(plan, name, limit, times, threads)?;
    refuse_interrupted()?;
    let Some(found) = found else {
        let names = shown_names(plan.family.mechanism())
            .into_iter()
            .map(|(n, _)| n);
        let measures = plan.family.measures.list.iter().map(|m| m.name.clone());
        let all: Vec<String> = names.chain(measures).collect();
        let all = all.iter().map(String::as_str);
        return Err(Failure::unknown_name(SHOWN, name, all));
    };
    io::print_beside(
        term,
        None,
        &report::allowed_lines(plan, name, limit, &found),
    )?;
    Ok(match found.factor > 0.0 {
        true => Outcome::Done,
        false => Outcome::CheckFailed,
    })
}
