//! Derivatives of a study's measures by its variables as a table for people, as CSV and as JSON.

use super::cells::{aligned_rows, six_digits};
use super::csv::{TableCell, push_header, push_row};
use crate::analysis::study::{DRIVE_SAMPLES, NominalStudy, ParametricMechanism};
use crate::sorting::sort_by;
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

    /// d(measure)/d(variable) in the file's units; NaN where there is none.
    pub fn slope(&self, measure: usize, variable: usize) -> f64 {
        let over = self.family.units(self.family.measures.list[measure].kind);
        let variables = &self.family.study.variables;
        let under = self.family.units(variables[variable].kind);
        let slope = self.nominal.gradients.rows[measure][variable] * over / under;
        match slope.is_finite() {
            true => slope,
            false => f64::NAN,
        }
    }

    /// Whether a measure has derivatives by all variables.
    pub fn has_derivatives(&self, measure: usize) -> bool {
        self.nominal.gradients.has_derivatives(measure)
    }

    /// The tolerances with which all dimensions that move the measure contribute equally to the allowed scatter; infinite for others.
    fn proposed_tolerance(&self, variable: usize) -> Option<f64> {
        let (measure, scatter) = self.allowed?;
        let row = &self.nominal.gradients.rows[measure];
        let moving = row.iter().filter(|d| **d != 0.0).count() as f64;
        let unit = self
            .family
            .units(self.family.study.variables[variable].kind);
        // Nothing adds to a scatter by nothing, whatever its tolerance.
        Some(match row[variable] {
            0.0 => f64::INFINITY,
            slope => scatter / (moving.sqrt() * slope.abs()) * unit,
        })
    }

    /// How much the proposed tolerances make of a scatter, in words.
    fn scatter_line(&self, measure: usize, scatter: f64) -> String {
        let shown = &self.family.measures.list[measure];
        let scatter = six_digits(self.family.shown(shown, scatter));
        let row = &self.nominal.gradients.rows[measure];
        let idle: Vec<&str> = (0..row.len())
            .filter(|k| row[*k] == 0.0)
            .map(|k| self.name(k))
            .collect();
        let name = &shown.name;
        if idle.len() == row.len() {
            return format!(
                "To first order no dimension changes {name}: the derivatives give no tolerances for a scatter of {scatter}.\n"
            );
        }
        let mut text = format!(
            "With these tolerances every dimension adds as much to a scatter of {scatter} of {name}"
        );
        match idle.is_empty() {
            true => text.push_str(".\n"),
            false => text.push_str(&format!(
                ", except those that do not change it to first order: {}.\n",
                idle.join(", ")
            )),
        }
        text
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

    fn name(&self, variable: usize) -> &str {
        &self.family.study.variables[variable].name
    }

    /// The numbers of a row: value, derivatives, tolerance.
    fn numbers(&self, variable: usize) -> impl Iterator<Item = f64> + '_ {
        let v = &self.family.study.variables[variable];
        let measures = 0..self.family.measures.list.len();
        std::iter::once(v.start * self.family.units(v.kind))
            .chain(measures.map(move |m| self.slope(m, variable)))
            .chain(self.proposed_tolerance(variable))
    }

    /// For people; `rank` is the measure that determines the order.
    pub fn text(&self, rank: usize) -> String {
        let list = &self.family.measures.list;
        let mut rows = vec![self.heads()];
        rows.extend(self.order.iter().map(|&v| {
            let name = std::iter::once(self.name(v).to_owned());
            name.chain(self.numbers(v).map(slope_cell)).collect()
        }));
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
        let without = self.nominal.names_without_derivatives(self.family);
        if !without.is_empty() {
            text.push_str(&format!(
                "Without derivatives by all dimensions: {}.\n",
                without.join(", ")
            ));
        }
        let one_sided = self.nominal.one_sided_names(self.family);
        if !one_sided.is_empty() {
            text.push_str(&format!(
                "Taken from one side only, at a kink of a formula or where several poses share an extreme: {}.\n",
                one_sided.join(", ")
            ));
        }
        let measures = list.iter().zip(&self.nominal.is_whole);
        let mut along_drive = measures.filter(|(measure, _)| measure.source.track().is_none());
        if along_drive.any(|(measure, is_whole)| *is_whole && measure.source.is_extreme()) {
            text.push_str(&format!(
                "Extremes along the drive are sought from {DRIVE_SAMPLES} poses on; a peak between two of them is not seen.\n"
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
            text.push_str(&self.scatter_line(measure, scatter));
        }
        text
    }

    /// One row a variable.
    pub fn csv(&self) -> String {
        let mut text = String::new();
        push_header(&mut text, &self.heads());
        for &variable in &self.order {
            let name = std::iter::once(TableCell::text(self.name(variable)));
            let numbers = self.numbers(variable).map(TableCell::Number);
            push_row(&mut text, name.chain(numbers));
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
            "without_derivatives": self.nominal.names_without_derivatives(self.family),
            "one_sided": self.nominal.one_sided_names(self.family),
            "of_poses": self.nominal.names_of_poses(self.family),
            "dimensions": rows.collect::<Vec<_>>(),
        })
    }
}

/// A derivative or a tolerance in a table for people.
fn slope_cell(value: f64) -> String {
    match value {
        _ if value.is_nan() => "none".to_owned(),
        _ if value.is_infinite() => "any".to_owned(),
        _ => six_digits(value),
    }
}

/// Variables by falling magnitude of their derivative.
fn row_ranking(row: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..row.len()).collect();
    sort_by(&mut order, |a, b| row[*b].abs().total_cmp(&row[*a].abs()));
    order
}
