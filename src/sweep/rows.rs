//! The rows of a sweep: the evaluation of one design after another.

use super::abreast::{GROUP, RowGroup};
use super::posing::DesignStart;
use super::reread;
use super::row::Row;
use super::swept_scene::{Posed, Sweep};
use crate::model::actuation::Actuation;
use crate::model::drive::Drive;
use crate::model::measure::Measures;
use std::ops::Range;

/// Makes rows; one for each thread.
pub struct RowWorker<'s> {
    sweep: &'s Sweep,
    actuation: Actuation,
    measures: Measures,
    group: Option<RowGroup<'s>>,
}

impl<'s> RowWorker<'s> {
    /// Buffers for one thread.
    pub fn new(sweep: &'s Sweep) -> Self {
        Self {
            sweep,
            actuation: sweep.family().actuation.clone(),
            measures: sweep.family().measures.clone(),
            group: RowGroup::new(sweep),
        }
    }

    /// The rows of a set of designs, in order. A row does not depend on the others.
    pub fn rows(&mut self, items: Range<u64>) -> Vec<Row> {
        let mut rows = Vec::new();
        for first in items.clone().step_by(GROUP as usize) {
            let group = first..items.end.min(first + GROUP);
            let found = match &mut self.group {
                None => vec![None; (group.end - group.start) as usize],
                Some(made) => {
                    let sweep = self.sweep;
                    let values = |item| sweep.internal(&sweep.design.values(item));
                    made.rows(&group.clone().map(values).collect::<Vec<_>>())
                }
            };
            let found = group.zip(found);
            rows.extend(found.map(|(item, row)| row.unwrap_or_else(|| self.row(item))));
        }
        rows
    }

    /// The row of design `item`, by itself.
    fn row(&mut self, item: u64) -> Row {
        let sweep = self.sweep;
        let design = sweep.design.values(item);
        let values = sweep.internal(&design);
        if sweep.reads_anew() {
            return reread::row(sweep, &design, &values);
        }
        self.set(&values);
        let inputs = self.actuation.inputs_at(0.0);
        let DesignStart { unknowns, status } = match sweep.origin.start_at(&sweep.family, &inputs) {
            Ok(start) => start,
            Err(status) => return sweep.empty_row(status),
        };
        self.actuation.guess = unknowns;
        let posed = Posed {
            system: sweep.family.system(),
            actuation: &self.actuation,
            measures: &self.measures,
        };
        sweep.answer(&posed, status)
    }

    /// Replaces the values of the previous design.
    fn set(&mut self, values: &[f64]) {
        let first = self.sweep.family.own_inputs();
        for (k, value) in values.iter().enumerate() {
            self.actuation.drives[first + k] = Drive::constant(*value);
            for track in &mut self.measures.tracks {
                (track.from[first + k], track.to[first + k]) = (*value, *value);
            }
        }
        // The preferences for the first pose are those of the file's values.
        self.actuation.named.clear();
    }
}
