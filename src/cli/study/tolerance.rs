//! `mechanim tolerance`: linear scatter and random pieces of a study, with yield against the limits of its measures.

use crate::analysis::enclosure::{MOST_DIMENSIONS, MeasureBand, Plan, enclose_measures};
use crate::analysis::extremes::found_extremes;
use crate::analysis::study::{Evaluator, Gradients, Nominal, ParametricMechanism};
use crate::analysis::tolerance::{
    Distribution, Linear, Pieces, SampleBatch, linear_tolerance, sample_pieces,
};
use crate::cli::args::study::{DistributionArg, ToleranceArgs};
use crate::cli::interrupt::CANCEL;
use crate::cli::io;
use crate::cli::open::study::{Opened, open_study};
use crate::cli::pictures::tolerance_cloud as tolerance_picture;
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::cli::term::progress::Progress;
use crate::export::{ExportError, Output, Target};
use crate::jobs::core_count;
use crate::model::measure::Measure;
use crate::model::mechanism::Kind;
use crate::report::cells::{aligned_rows, quoted_cell, six_digits};
use crate::report::enclosure::{outer_end, rounded_end};
use serde_json::{Map, Value, json};
use std::io::Write;
use std::time::Instant;

/// Version of the JSON document.
const SCHEMA: u32 = 1;

/// Shares at which quantiles are given.
const SHARES: [f64; 5] = [0.001, 0.05, 0.5, 0.95, 0.999];

/// Runs the verb.
pub fn run_tolerance(args: &ToleranceArgs, term: &Term) -> Result<Outcome, Failure> {
    tolerance_picture::refuse_cloud(args)?;
    if args.first.checked_add(args.samples).is_none() {
        let message = "--first and --samples together are more numbers than there are";
        return Err(Failure::usage(message, Vec::new()));
    }
    let reports = [
        ("--json", args.json.as_deref()),
        ("--csv", args.csv.as_deref()),
        ("--picture", args.picture.as_deref()),
        ("--plot", args.plot.as_deref()),
    ];
    io::refuse_clashes(&[&args.scene], &reports)?;
    let opened = open_study(&args.scene, &args.vary, true, term)?;
    let family = &opened.family;
    let tolerances = dimension_tolerances(&opened, args.tolerance)?;
    let distribution = match args.distribution {
        DistributionArg::Uniform => Distribution::Uniform,
        DistributionArg::Normal => Distribution::Normal,
    };
    let batch = SampleBatch {
        samples: args.samples,
        first: args.first,
        seed: args.seed,
        distribution,
        threads: args.threads.unwrap_or_else(core_count),
    };
    let start = Instant::now();
    let mut evaluator = Evaluator::new(family);
    let drawn = family.nominal()?;
    let nominal = evaluator.nominal(drawn.poses.clone());
    let gradients = evaluator
        .gradients(&nominal)
        .map_err(|refusal| opened.refused(&evaluator, &nominal, &refusal))?;
    let corners = found_extremes(&mut evaluator, &nominal, &gradients, &tolerances);
    let bands = never_beyond(family, &drawn, &tolerances);
    let progress = Progress::new(args.progress, term.quiet()).counting("pieces");
    let watch = |done| progress.show(done, args.samples);
    // The pieces made so far are worth waiting for.
    crate::cli::interrupt::save_results(true);
    let made = sample_pieces(family, &nominal, &tolerances, batch, &CANCEL, &watch);
    progress.end();
    if made.made == 0 {
        return Err(Failure::Interrupted);
    }
    let is_whole = made.made == args.samples;
    if is_whole {
        tolerance_picture::write_cloud(args, &opened, &nominal, &tolerances, batch)?;
    }
    let result = ToleranceReport {
        opened: &opened,
        args,
        linear: linear_tolerance(&gradients, &tolerances, distribution),
        corners,
        bands,
        gradients,
        pieces: made,
        seconds: start.elapsed().as_secs_f64(),
    };
    if let Some(path) = &args.csv {
        let mut target = Target::create(&io::unless_complete(path, is_whole))?;
        let written = result.csv(&mut target);
        written.map_err(|source| ExportError::write(target.name(), source))?;
        target.commit()?;
    }
    if let Some(path) = &args.json {
        let path = io::unless_complete(path, is_whole);
        io::write_json(&args.scene, &path, &result.document())?;
    }
    io::print_beside(term, args.json.as_deref(), &result.text())?;
    if !is_whole {
        let done = result.pieces.made;
        return Err(Failure::Stopped(format!(
            "the report is that of the first {done} pieces"
        )));
    }
    Ok(Outcome::Done)
}

/// What no piece within its tolerances is beyond; empty where that is not proved.
fn never_beyond(
    family: &ParametricMechanism,
    drawn: &Nominal,
    tolerances: &[f64],
) -> Vec<MeasureBand> {
    let variables = &family.study.variables;
    if !family.kept.is_empty() || variables.len() > MOST_DIMENSIONS {
        return Vec::new();
    }
    let named = variables.iter().map(|v| v.name.clone());
    let list: Vec<(String, f64)> = named.zip(tolerances.iter().copied()).collect();
    enclose_measures(&Plan::new(family, &list), drawn).unwrap_or_default()
}

/// Tolerance of every variable: the study's, else the one of the command line.
fn dimension_tolerances(opened: &Opened, general: Option<f64>) -> Result<Vec<f64>, Failure> {
    let variables = &opened.family.study.variables;
    let of = |v: &crate::model::study::Variable| {
        v.tolerance
            .or(general.map(|t| t / opened.family.units(v.kind)))
    };
    let list: Vec<Option<f64>> = variables.iter().map(of).collect();
    let missing: Vec<&str> = variables
        .iter()
        .zip(&list)
        .filter(|(_, t)| t.is_none())
        .map(|(v, _)| v.name.as_str())
        .collect();
    if !missing.is_empty() {
        return Err(Failure::usage(
            format!("no tolerance is known of {}", missing.join(", ")),
            vec![
                "give one for all with --tolerance 0.5, or each its own: \
                 `[study.variables]` NAME = { tolerance = 0.5 }"
                    .to_owned(),
            ],
        ));
    }
    Ok(list.into_iter().flatten().collect())
}

struct ToleranceReport<'a> {
    opened: &'a Opened,
    args: &'a ToleranceArgs,
    gradients: Gradients,
    linear: Vec<Linear>,
    /// Least and greatest value at corners of the tolerances.
    corners: Vec<[f64; 2]>,
    /// What no piece is beyond; empty where a pose of a track has no box.
    bands: Vec<MeasureBand>,
    pieces: Pieces,
    seconds: f64,
}

impl ToleranceReport<'_> {
    fn text(&self) -> String {
        let study = &self.opened.family.study;
        let heads = [
            "measure",
            "nominal",
            "RSS",
            "linear sum",
            "deviation",
            "linear",
            "0.1 %",
            "5 %",
            "50 %",
            "95 %",
            "99.9 %",
            "least found",
            "greatest found",
            "never below",
            "never above",
        ];
        let mut rows = vec![heads.map(str::to_owned).to_vec()];
        for (index, measure) in self.opened.family.measures.list.iter().enumerate() {
            let unit = self.opened.family.units(measure.kind);
            let Linear {
                root_sum_square,
                linear_sum,
                deviation,
            } = self.linear[index];
            let nominal = self.gradients.measures[index];
            let Some(scatter) = self.pieces.scatter(index, &SHARES) else {
                continue;
            };
            let mut row = vec![measure.name.clone()];
            let numbers = [
                nominal,
                root_sum_square,
                linear_sum,
                scatter.deviation,
                deviation,
            ];
            let numbers = numbers.iter().chain(&scatter.quantiles);
            row.extend(numbers.map(|v| six_digits(v * unit)));
            row.extend(self.found(index).map(|v| six_digits(v * unit)));
            row.extend(self.never_beyond(index, measure.kind));
            rows.push(row);
        }
        let samples = self.pieces.made;
        let mut text = format!(
            "{}\n  {} dimensions scatter, {samples} pieces, {} of them cannot be assembled\n\n",
            self.opened.family.mechanism().title,
            study.variables.len(),
            self.pieces.failed,
        );
        text.push_str(&aligned_rows(&rows));
        text.push_str(
            "\nRSS and linear sum: of the tolerances, by the linear rule, which pieces can exceed. Deviation: of the pieces, and what \
             the linear rule expects.\nFound: of the pieces and of corners within the tolerances. Never beyond: proved for all pieces within their \
             tolerances.\n",
        );
        let limited = |m: &Measure| m.min.is_some() || m.max.is_some();
        if self.opened.family.measures.list.iter().any(limited) {
            let share = 100.0 * self.pieces.good as f64 / samples as f64;
            text.push_str(&format!(
                "Yield: {} of {samples} ({share:.3} %) keep the limits of all measures.\n",
                self.pieces.good
            ));
        }
        text.push_str(&format!(
            "Digest {:016x}; {:.2} s.\n",
            self.pieces.digest, self.seconds
        ));
        text
    }

    /// The least and greatest value of a measure among the pieces and the corners.
    fn found(&self, index: usize) -> [f64; 2] {
        let values = self.pieces.values.iter().skip(index);
        let values = values.step_by(self.pieces.measures.max(1));
        // The comparison leaves out pieces without a value.
        values.fold(self.corners[index], |[lo, hi], v| [v.min(lo), v.max(hi)])
    }

    /// The proved ends of a measure, rounded outwards.
    fn never_beyond(&self, index: usize, kind: Kind) -> [String; 2] {
        let mechanism = self.opened.family.mechanism();
        let band = self.bands.get(index);
        let ends = band.map_or([f64::NAN; 2], |b| [b.lo, b.hi]);
        [(ends[0], -1.0), (ends[1], 1.0)].map(|(end, side)| match end.is_finite() {
            true => outer_end(end, kind, mechanism, side),
            false => "not bounded".to_owned(),
        })
    }

    fn document(&self) -> Value {
        let study = &self.opened.family.study;
        let mut measures = Map::new();
        for (index, measure) in self.opened.family.measures.list.iter().enumerate() {
            let unit = self.opened.family.units(measure.kind);
            let linear = self.linear[index];
            let scatter = self.pieces.scatter(index, &SHARES);
            let quantiles = scatter.as_ref().map(|s| {
                let pairs = SHARES.iter().zip(&s.quantiles);
                let pairs = pairs.map(|(share, v)| (share.to_string(), json!(v * unit)));
                pairs.collect::<Map<String, Value>>()
            });
            measures.insert(
                measure.name.clone(),
                json!({
                    "nominal": self.gradients.measures[index] * unit,
                    "root_sum_square": linear.root_sum_square * unit,
                    "linear_sum": linear.linear_sum * unit,
                    "linear_deviation": linear.deviation * unit,
                    "mean": scatter.as_ref().map(|s| s.mean * unit),
                    "deviation": scatter.as_ref().map(|s| s.deviation * unit),
                    "quantiles": quantiles,
                    "found": self.found(index).map(|v| v * unit),
                    "never_beyond": self.proved(index, measure.kind),
                }),
            );
        }
        json!({
            "schema": format!("mechanim-tolerance/{SCHEMA}"),
            "title": self.opened.family.mechanism().title,
            "dimensions": study.variables.iter().map(|v| v.name.as_str()).collect::<Vec<_>>(),
            "samples": self.pieces.made,
            "first": self.args.first,
            "seed": self.args.seed,
            "failed": self.pieces.failed,
            "good": self.pieces.good,
            "digest": format!("{:016x}", self.pieces.digest),
            "measures": measures,
        })
    }

    /// The proved ends of a measure as numbers; null where it is not bounded.
    fn proved(&self, index: usize, kind: Kind) -> Value {
        let mechanism = self.opened.family.mechanism();
        let Some(band) = self
            .bands
            .get(index)
            .filter(|b| b.lo.is_finite() && b.hi.is_finite())
        else {
            return Value::Null;
        };
        let end = |v: f64, side: f64| rounded_end(v, kind, mechanism, side).parse::<f64>().ok();
        json!([end(band.lo, -1.0), end(band.hi, 1.0)])
    }

    fn csv(&self, target: &mut Target) -> std::io::Result<()> {
        let measures = &self.opened.family.measures.list;
        let names: Vec<String> = measures.iter().map(|m| quoted_cell(&m.name)).collect();
        writeln!(target, "piece,{}", names.join(","))?;
        for (item, piece) in self.pieces.values.chunks_exact(measures.len()).enumerate() {
            write!(target, "{}", self.args.first + item)?;
            for (measure, value) in measures.iter().zip(piece) {
                match value.is_nan() {
                    true => write!(target, ",")?,
                    false => write!(
                        target,
                        ",{:?}",
                        value * self.opened.family.units(measure.kind)
                    )?,
                }
            }
            writeln!(target)?;
        }
        Ok(())
    }
}
