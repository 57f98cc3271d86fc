//! The summary of a sweep: numbers of rows by status, and ranges of the values.

use super::row::{Row, RowStatus};
use super::swept_scene::Sweep;
use crate::report::cells::{aligned_rows, six_digits};
use crate::report::rounded::at_most_six;

/// Maximum number of values with a line of their own.
const MOST_LINES: usize = 12;

/// Counts rows and tracks their extremes, in memory that does not grow with the number of rows.
pub struct Summary<'s> {
    sweep: &'s Sweep,
    counts: [u64; RowStatus::ALL.len()],
    feasible: u64,
    /// Least and greatest value of the ok rows, each with the number of its design.
    extremes: Vec<[(f64, u64); 2]>,
    closure_error: f64,
    error_bound: f64,
    unproved: f64,
}

impl<'s> Summary<'s> {
    /// The summary before the first row.
    pub fn new(sweep: &'s Sweep) -> Self {
        let none = [(f64::INFINITY, 0), (f64::NEG_INFINITY, 0)];
        Self {
            sweep,
            counts: [0; RowStatus::ALL.len()],
            feasible: 0,
            extremes: vec![none; sweep.columns.len()],
            closure_error: 0.0,
            error_bound: f64::NAN,
            unproved: 0.0,
        }
    }

    /// Counts the row of design `item`.
    pub fn add(&mut self, item: u64, row: &Row) {
        let status = RowStatus::ALL.iter().position(|s| *s == row.status);
        self.counts[status.unwrap_or(0)] += 1;
        self.feasible += u64::from(row.is_feasible);
        if row.status != RowStatus::Ok {
            return;
        }
        self.closure_error = self.closure_error.max(row.closure_error);
        self.error_bound = self.error_bound.max(row.error_bound);
        self.unproved += row.unproved;
        for ([least, most], value) in self.extremes.iter_mut().zip(&row.values) {
            if *value < least.0 {
                *least = (*value, item);
            }
            if *value > most.0 {
                *most = (*value, item);
            }
        }
    }

    /// The lines of the summary.
    pub fn text(&self) -> String {
        let all: u64 = self.counts.iter().sum();
        let kinds = RowStatus::ALL.iter().zip(&self.counts);
        let kinds = kinds.filter(|(_, count)| **count > 0);
        let kinds: Vec<String> = kinds.map(|(s, n)| format!("{n} {}", s.word())).collect();
        let mut text = format!(
            "{}\n  {all} designs: {}; {} feasible{}\n",
            self.sweep.title(),
            kinds.join(", "),
            self.feasible,
            // `mechanim check` judges limits of the whole motion.
            if self.sweep.has_limits() {
                " at the samples"
            } else {
                ""
            },
        );
        if self.counts[0] > 0 {
            let proved = match self.error_bound.is_nan() {
                true => "no certificates".to_owned(),
                false => format!("certified error at most {}", at_most_six(self.error_bound)),
            };
            text.push_str(&format!(
                "  of the ok rows: closure error at most {}, {proved}, {} poses not proved\n\n",
                at_most_six(self.closure_error),
                self.unproved
            ));
            text.push_str(&aligned_rows(&self.lines()));
        }
        text
    }

    fn lines(&self) -> Vec<Vec<String>> {
        let heads = [
            "value",
            "unit",
            "least",
            "of design",
            "greatest",
            "of design",
        ];
        let mut rows = vec![heads.map(str::to_owned).to_vec()];
        let columns = self.sweep.columns.iter().zip(&self.extremes);
        for ((name, unit), [least, most]) in columns.take(MOST_LINES) {
            let found = |(value, item): (f64, u64)| match value.is_finite() {
                true => [six_digits(value), item.to_string()],
                false => ["-".to_owned(), "-".to_owned()],
            };
            let mut row = vec![name.clone(), unit.clone()];
            row.extend(found(*least));
            row.extend(found(*most));
            rows.push(row);
        }
        if self.sweep.columns.len() > MOST_LINES {
            let more = self.sweep.columns.len() - MOST_LINES;
            rows.push(vec![format!("and {more} more")]);
        }
        rows
    }
}
