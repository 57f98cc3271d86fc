//! Derivatives of a study's measures by its variables as a table for people, as CSV and as JSON.

use super::cells::{aligned_rows, quoted_cell, six_digits};
use crate::analysis::study::{NominalStudy, ParametricMechanism};
use serde_json::{Map, Value, json};

/// Version of the JSON document.
const SCHEMA: u32 = 1;

/// Derivatives of all measures.
pub struct SensitivityTable<'a> {
    /// The study.
    pub family: &'a ParametricMechanism,
    nominal: &'a NominalStudy,
    /// Variables, the most important first.
    pub order: Vec<usize>,
    /// A measure and its allowed scatter.
    allowed: Option<(usize, f64)>,
}

impl<'a> SensitivityTable<'a> {
    /// Ranked by the derivatives of measure `rank`. `allowed` is a measure and the scatter it may have.
    pub fn new(
        family: &'a ParametricMechanism,
        nominal: &'a NominalStudy,
        rank: usize,
        allowed: Option<(usize, f64)>,
    ) -> Self {
        Self {
            family,
            nominal,
            order: row_ranking(&nominal.gradients.rows[rank]),
            allowed,
        }
    }

    /// d(measure)/d(variable) in the file's units.
    pub fn slope(&self, measure: usize, variable: usize) -> f64 {
        let over = self.family.units(self.family.measures.list[measure].kind);
        let variables = &self.family.study.variables;
        let under = self.family.units(variables[variable].kind);
        self.nominal.gradients.rows[measure][variable] * over / under
    }

    /// The tolerances with which all dimensions contribute equally to the allowed scatter.
    fn proposed_tolerance(&self, variable: usize) -> Option<f64> {
        let (measure, scatter) = self.allowed?;
        let row = &self.nominal.gradients.rows[measure];
        let moving = row.iter().filter(|d| **d != 0.0).count() as f64;
        let unit = self
            .family
            .units(self.family.study.variables[variable].kind);
        Some(scatter / (moving.sqrt() * row[variable].abs()) * unit)
    }

    fn heads(&self) -> Vec<String> {
        let measures = self
            .family
            .measures
            .list
            .iter()
            .map(|m| format!("d{}", m.name));
        let mut heads = vec!["dimension".to_owned(), "value".to_owned()];
        heads.extend(measures);
        if self.allowed.is_some() {
            heads.push("tolerance".to_owned());
        }
        heads
    }

    fn row(&self, variable: usize, shown: &dyn Fn(f64) -> String) -> Vec<String> {
        let study = &self.family.study;
        let v = &study.variables[variable];
        let mut row = vec![v.name.clone(), shown(v.start * self.family.units(v.kind))];
        row.extend((0..self.family.measures.list.len()).map(|m| shown(self.slope(m, variable))));
        row.extend(self.proposed_tolerance(variable).map(shown));
        row
    }

    /// For people; `rank` is the measure that determines the order.
    pub fn text(&self, rank: usize) -> String {
        let list = &self.family.measures.list;
        let mut rows = vec![self.heads()];
        rows.extend(self.order.iter().map(|v| self.row(*v, &six_digits)));
        let measures: Vec<String> = list
            .iter()
            .zip(&self.nominal.gradients.measures)
            .map(|(m, v)| format!("{} = {}", m.name, six_digits(self.family.shown(m, *v))))
            .collect();
        let title = &self.family.mechanism().title;
        let ranked = &list[rank].name;
        let mut text = format!("{title}\n  {}\n\n", measures.join(", "));
        text.push_str(&aligned_rows(&rows));
        text.push_str(&format!("\nExact derivatives, ranked by d{ranked}.\n"));
        let one_sided = self.nominal.one_sided_names(self.family);
        if !one_sided.is_empty() {
            text.push_str(&format!(
                "Of one side only, at a kink of a formula or where several poses share an extreme: {}.\n",
                one_sided.join(", ")
            ));
        }
        let of_poses = self.nominal.names_of_poses(self.family);
        if !of_poses.is_empty() {
            text.push_str(&format!(
                "Of {} poses, and of nothing between them: {}.\n",
                self.nominal.poses.poses.len(),
                of_poses.join(", ")
            ));
        }
        if let Some((measure, scatter)) = self.allowed {
            let measure = &list[measure];
            text.push_str(&format!(
                "With these tolerances every dimension adds as much to a scatter of {} of {}.\n",
                six_digits(self.family.shown(measure, scatter)),
                measure.name
            ));
        }
        text
    }

    /// One row a variable.
    pub fn csv(&self) -> String {
        let heads: Vec<String> = self.heads().iter().map(|head| quoted_cell(head)).collect();
        let mut text = heads.join(",") + "\n";
        for variable in &self.order {
            let row = self.row(*variable, &|v| format!("{v:?}"));
            let cells: Vec<String> = row.iter().map(|cell| quoted_cell(cell)).collect();
            text.push_str(&cells.join(","));
            text.push('\n');
        }
        text
    }

    /// For machines.
    pub fn document(&self) -> Value {
        let study = &self.family.study;
        let mut measures = Map::new();
        for (m, v) in self
            .family
            .measures
            .list
            .iter()
            .zip(&self.nominal.gradients.measures)
        {
            measures.insert(m.name.clone(), json!(self.family.shown(m, *v)));
        }
        let rows = self.order.iter().map(|&variable| {
            let mut slopes = Map::new();
            for (m, measure) in self.family.measures.list.iter().enumerate() {
                slopes.insert(measure.name.clone(), json!(self.slope(m, variable)));
            }
            let v = &study.variables[variable];
            json!({
                "dimension": v.name,
                "value": v.start * self.family.units(v.kind),
                "derivatives": slopes,
                "tolerance": self.proposed_tolerance(variable),
            })
        });
        json!({
            "schema": format!("mechanim-sensitivity/{SCHEMA}"),
            "title": self.family.mechanism().title,
            "measures": measures,
            "one_sided": self.nominal.one_sided_names(self.family),
            "of_poses": self.nominal.names_of_poses(self.family),
            "dimensions": rows.collect::<Vec<_>>(),
        })
    }
}

/// Variables by falling magnitude of their derivative.
fn row_ranking(row: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..row.len()).collect();
    order.sort_by(|a, b| row[*b].abs().total_cmp(&row[*a].abs()));
    order
}
