//! The effect of tolerances on the measures of a study: in words, as CSV and as a JSON document.

use super::cells::{aligned_rows, six_digits};
use super::csv::{TableCell, push_header, push_row};
use super::enclosure::{bounded_end, outer_end};
use crate::analysis::study::ParametricMechanism;
use crate::analysis::tolerance::{PieceSummary, Pieces};
use crate::analysis::tolerance_study::ToleranceStudy;
use crate::model::measure::Measure;
use crate::model::mechanism::Kind;
use crate::scene::columns::PIECE;
use serde_json::{Map, Value, json};
use std::io::Write;

/// Version of the JSON document.
const SCHEMA: u32 = 1;

/// Shares at which quantiles are given.
pub const SHARES: [f64; 5] = [0.001, 0.05, 0.5, 0.95, 0.999];

/// Heads of the table.
const HEADS: [&str; 15] = [
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

/// The meaning of the table's columns.
const LEGEND: &str = "
RSS and linear sum: effect of the tolerances by the linear rule; pieces can exceed them. Deviation: that of the pieces, and what \
the linear rule expects.
Found: extremes of the pieces and of corners of the tolerances. Never beyond: proved for all pieces within their tolerances, at the \
poses of the measures.
";

/// The meaning of a quantile's two ends if pieces were counted in bins.
const COUNTED: &str = "Quantiles lie between two numbers: values were counted in bins, and the 64 most extreme ones on either side were kept.\n";

/// A study with the statistics of its random pieces at [`SHARES`].
pub struct ToleranceReport<'a> {
    /// The study.
    pub study: &'a ToleranceStudy<'a>,
    /// What the pieces tell.
    pub pieces: &'a PieceSummary,
    /// Number of the first piece.
    pub first: u64,
    /// Their time, if it is reported.
    pub seconds: Option<f64>,
}

impl ToleranceReport<'_> {
    fn family(&self) -> &ParametricMechanism {
        &self.study.study.family
    }

    /// For people.
    pub fn text(&self) -> String {
        let (family, pieces) = (self.family(), self.pieces);
        let mut rows = vec![HEADS.map(str::to_owned).to_vec()];
        let list = family.measures.list.iter().enumerate();
        rows.extend(list.map(|(index, measure)| self.row(index, measure)));
        let samples = pieces.made;
        let varying = match family.study.variables.len() {
            1 => "1 dimension varies".to_owned(),
            count => format!("{count} dimensions vary"),
        };
        let mut text = format!(
            "{}\n  {}, {samples} pieces, {} of them cannot be assembled or lack a value\n  measures are of {} poses, \
             and of nothing between them\n\n",
            family.mechanism().title,
            varying,
            pieces.failed,
            self.study.nominal.poses.poses.len(),
        );
        if let Some(passage) = self.study.nominal.drawn.singular {
            let (track, pose) = family.place_of(passage.behind);
            text.push_str(&format!(
                "  the motion passes a singular pose before pose {pose} of {track}: every piece follows its own motion;\n  \
                 RSS, linear sum and linear hold for pieces that pass it as the file's dimensions do\n\n"
            ));
        }
        text.push_str(&aligned_rows(&rows));
        text.push_str(LEGEND);
        let one_sided = self.study.nominal.one_sided_names(family);
        if !one_sided.is_empty() {
            text.push_str(&format!(
                "Linear rules of one side only, at a kink of a formula or where several poses share an extreme: {}.\n",
                one_sided.join(", ")
            ));
        }
        let limited = |m: &Measure| m.min.is_some() || m.max.is_some();
        if family.measures.list.iter().any(limited) {
            let share = 100.0 * pieces.good as f64 / samples as f64;
            text.push_str(&format!(
                "Yield: {} of {samples} ({share:.3} %) keep the limits of all measures at these poses.\n",
                pieces.good
            ));
        }
        if !self.are_known() {
            text.push_str(COUNTED);
        }
        text.push_str(&format!("Digest {:016x}", pieces.digest));
        match self.seconds {
            Some(seconds) => text.push_str(&format!("; {seconds:.2} s.\n")),
            None => text.push_str(".\n"),
        }
        text
    }

    /// Whether quantiles are numbers; else intervals.
    fn are_known(&self) -> bool {
        let measures = self.pieces.measures.iter().flatten();
        measures
            .flat_map(|m| &m.quantiles)
            .all(|[low, high]| low == high)
    }

    /// A measure's row of the table; if no piece can be assembled, it has nothing about pieces.
    fn row(&self, index: usize, measure: &Measure) -> Vec<String> {
        let unit = self.family().units(measure.kind);
        let scatter = self.pieces.measures.get(index).and_then(Option::as_ref);
        let (study, linear) = (self.study, self.study.linear[index]);
        let numbers = [
            study.nominal.gradients.measures[index],
            linear.root_sum_square,
            linear.linear_sum,
            scatter.map_or(f64::NAN, |s| s.deviation),
            linear.deviation,
        ];
        // A measure of a singular pose has no derivative, one without pieces has none found.
        let shown = |v: f64| match v.is_finite() {
            true => six_digits(v * unit),
            false => "-".to_owned(),
        };
        let mut row = vec![measure.name.clone()];
        row.extend(numbers.map(shown));
        let unknown = [[f64::NAN; 2]; SHARES.len()];
        let quantiles = scatter.map_or(&unknown[..], |s| &s.quantiles[..]);
        row.extend(quantiles.iter().map(|ends| {
            let [low, high] = ends.map(shown);
            match low == high {
                true => low,
                false => format!("{low}..{high}"),
            }
        }));
        row.extend(study.found(index, scatter.map(|s| s.found)).map(shown));
        row.extend(self.never_beyond(index, measure.kind));
        row
    }

    /// The proved ends of a measure, rounded outwards.
    fn never_beyond(&self, index: usize, kind: Kind) -> [String; 2] {
        let mechanism = self.family().mechanism();
        let [lo, hi] = self.study.band(index);
        [(lo, -1.0), (hi, 1.0)].map(|(end, side)| match end.is_finite() {
            true => outer_end(end, kind, mechanism, side),
            false => "not bounded".to_owned(),
        })
    }

    /// The proved bounds of a measure as numbers in the file's unit, rounded outwards; `None` if one is unbounded.
    pub fn proved_ends(&self, index: usize, kind: Kind) -> Option<[f64; 2]> {
        let mechanism = self.family().mechanism();
        let [lo, hi] = self.study.band(index);
        let end = |v: f64, side: f64| bounded_end(v, kind, mechanism, side);
        Some([end(lo, -1.0)?, end(hi, 1.0)?])
    }

    /// For machines.
    pub fn document(&self) -> Value {
        let (family, pieces) = (self.family(), self.pieces);
        let list = family.measures.list.iter().enumerate();
        let measures = list.map(|(index, m)| (m.name.clone(), self.measure_object(index, m)));
        let variables = family.study.variables.iter();
        json!({
            "schema": format!("mechanim-tolerance/{SCHEMA}"),
            "title": family.mechanism().title,
            "dimensions": variables.map(|v| v.name.as_str()).collect::<Vec<_>>(),
            "samples": pieces.made,
            "complete": pieces.made == self.study.batch().samples as u64,
            "poses": self.study.nominal.poses.poses.len(),
            "one_sided": self.study.nominal.one_sided_names(family),
            "passes_singular_pose": self.study.nominal.drawn.singular.is_some(),
            "first": self.first,
            "seed": self.study.batch().seed,
            "failed": pieces.failed,
            "good": pieces.good,
            "digest": format!("{:016x}", pieces.digest),
            "measures": measures.collect::<Map<String, Value>>(),
        })
    }

    fn measure_object(&self, index: usize, measure: &Measure) -> Value {
        let unit = self.family().units(measure.kind);
        let linear = self.study.linear[index];
        let scatter = self.pieces.measures.get(index).and_then(Option::as_ref);
        let quantiles = scatter.map(|s| {
            let pairs = SHARES.iter().zip(&s.quantiles);
            let pairs = pairs.map(|(share, ends)| {
                let [low, high] = ends.map(|v| v * unit);
                let value = match self.are_known() {
                    true => json!(low),
                    false => json!([low, high]),
                };
                (share.to_string(), value)
            });
            pairs.collect::<Map<String, Value>>()
        });
        json!({
            "nominal": self.study.nominal.gradients.measures[index] * unit,
            "root_sum_square": linear.root_sum_square * unit,
            "linear_sum": linear.linear_sum * unit,
            "linear_deviation": linear.deviation * unit,
            "mean": scatter.map(|s| s.mean * unit),
            "deviation": scatter.map(|s| s.deviation * unit),
            "quantiles": quantiles,
            "found": self.study.found(index, scatter.map(|s| s.found)).map(|v| v * unit),
            "never_beyond": self.proved_ends(index, measure.kind),
        })
    }

    /// The measures of all `pieces`, one row each.
    ///
    /// # Errors
    /// Errors of writing.
    pub fn write_csv(&self, pieces: &Pieces, target: &mut dyn Write) -> std::io::Result<()> {
        let family = self.family();
        let measures = &family.measures.list;
        let mut heads = vec![PIECE];
        heads.extend(measures.iter().map(|m| m.name.as_str()));
        let mut line = String::new();
        push_header(&mut line, &heads);
        for (item, piece) in pieces.values.chunks_exact(measures.len()).enumerate() {
            target.write_all(line.as_bytes())?;
            line.clear();
            let values = measures.iter().zip(piece);
            let values = values.map(|(m, v)| TableCell::Number(family.shown(m, *v)));
            let number = TableCell::Whole(self.first + item as u64);
            push_row(&mut line, std::iter::once(number).chain(values));
        }
        target.write_all(line.as_bytes())
    }
}
