//! `mechanim sensitivity`: the exact derivative of every measure by every dimension, ranked; tolerances proposed.

use crate::analysis::study::{Evaluator, Gradients};
use crate::cli::args::study::SensitivityArgs;
use crate::cli::io;
use crate::cli::open::study::{Opened, aligned, open, six};
use crate::cli::pictures::sensitivity_bars as sensitivity_plot;
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use serde_json::{Map, Value, json};

/// Version of the JSON document.
const SCHEMA: u32 = 1;

/// Runs the verb.
pub fn run(args: &SensitivityArgs, term: &Term) -> Result<Outcome, Failure> {
    let plot = args.plot.as_deref();
    let plot = plot.map(|path| sensitivity_plot::open(&args.scene, path));
    let plot = plot.transpose()?;
    let opened = open(&args.scene, &args.vary, true, term)?;
    let family = &opened.family;
    let mut evaluator = Evaluator::new(family);
    let nominal = family.nominal()?;
    let stand = evaluator.nominal(nominal.poses);
    let gradients = evaluator
        .gradients(&stand)
        .map_err(|refusal| opened.refused(&evaluator, &stand, &refusal))?;
    let rank = match &args.rank {
        Some(name) => opened.measure(name)?,
        None => family.study.objective.unwrap_or(0),
    };
    let allowed = match &args.allow {
        Some((name, scatter)) => {
            let measure = opened.measure(name)?;
            let unit = opened.units(opened.measures()[measure].kind);
            Some((measure, scatter / unit))
        }
        None => None,
    };
    let table = Table {
        opened: &opened,
        gradients: &gradients,
        order: ranking(&gradients.rows[rank]),
        allowed,
    };
    if let Some(plot) = plot {
        plot.write(&table, rank)?;
    }
    let document = table.document();
    match &args.out {
        Some(path)
            if path
                .extension()
                .is_some_and(|e| e.eq_ignore_ascii_case("csv")) =>
        {
            io::write_text(&args.scene, path, &table.csv())?;
        }
        Some(path) => io::write_json(&args.scene, path, &document)?,
        None => {}
    }
    io::print_beside(args.out.as_deref(), &table.text(rank))?;
    Ok(Outcome::Done)
}

/// Variables by falling magnitude of their derivative.
fn ranking(row: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..row.len()).collect();
    order.sort_by(|a, b| row[*b].abs().total_cmp(&row[*a].abs()));
    order
}

/// Derivatives of all measures.
pub struct Table<'a> {
    /// The scene.
    pub opened: &'a Opened,
    gradients: &'a Gradients,
    /// Variables, the most important first.
    pub order: Vec<usize>,
    /// A measure and the scatter that is allowed to it.
    allowed: Option<(usize, f64)>,
}

impl Table<'_> {
    /// d(measure)/d(variable) in the file's units.
    pub fn slope(&self, measure: usize, variable: usize) -> f64 {
        let over = self.opened.units(self.opened.measures()[measure].kind);
        let variables = &self.opened.family.study.variables;
        let under = self.opened.units(variables[variable].kind);
        self.gradients.rows[measure][variable] * over / under
    }

    /// The tolerance that lets every dimension contribute as much to the allowed scatter.
    fn proposal(&self, variable: usize) -> Option<f64> {
        let (measure, scatter) = self.allowed?;
        let row = &self.gradients.rows[measure];
        let moving = row.iter().filter(|d| **d != 0.0).count() as f64;
        let unit = self
            .opened
            .units(self.opened.family.study.variables[variable].kind);
        Some(scatter / (moving.sqrt() * row[variable].abs()) * unit)
    }

    fn heads(&self) -> Vec<String> {
        let measures = self
            .opened
            .measures()
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
        let study = &self.opened.family.study;
        let v = &study.variables[variable];
        let mut row = vec![v.name.clone(), shown(v.start * self.opened.units(v.kind))];
        row.extend((0..self.opened.measures().len()).map(|m| shown(self.slope(m, variable))));
        row.extend(self.proposal(variable).map(shown));
        row
    }

    fn text(&self, rank: usize) -> String {
        let list = self.opened.measures();
        let mut rows = vec![self.heads()];
        rows.extend(self.order.iter().map(|v| self.row(*v, &six)));
        let measures: Vec<String> = list
            .iter()
            .zip(&self.gradients.measures)
            .map(|(m, v)| format!("{} = {}", m.name, six(self.opened.shown(m, *v))))
            .collect();
        let title = &self.opened.family.mechanism().title;
        let ranked = &list[rank].name;
        let mut text = format!("{title}\n  {}\n\n", measures.join(", "));
        text.push_str(&aligned(&rows));
        text.push_str(&format!("\nExact derivatives, ranked by d{ranked}.\n"));
        if let Some((measure, scatter)) = self.allowed {
            let measure = &list[measure];
            text.push_str(&format!(
                "With these tolerances every dimension adds as much to a scatter of {} of {}.\n",
                six(self.opened.shown(measure, scatter)),
                measure.name
            ));
        }
        text
    }

    fn csv(&self) -> String {
        let mut text = self.heads().join(",") + "\n";
        for variable in &self.order {
            text.push_str(&self.row(*variable, &|v| format!("{v:?}")).join(","));
            text.push('\n');
        }
        text
    }

    fn document(&self) -> Value {
        let study = &self.opened.family.study;
        let mut measures = Map::new();
        for (m, v) in self.opened.measures().iter().zip(&self.gradients.measures) {
            measures.insert(m.name.clone(), json!(self.opened.shown(m, *v)));
        }
        let rows = self.order.iter().map(|&variable| {
            let mut slopes = Map::new();
            for (m, measure) in self.opened.measures().iter().enumerate() {
                slopes.insert(measure.name.clone(), json!(self.slope(m, variable)));
            }
            let v = &study.variables[variable];
            json!({
                "dimension": v.name,
                "value": v.start * self.opened.units(v.kind),
                "derivatives": slopes,
                "tolerance": self.proposal(variable),
            })
        });
        json!({
            "schema": format!("mechanim-sensitivity-{SCHEMA}"),
            "title": self.opened.family.mechanism().title,
            "measures": measures,
            "dimensions": rows.collect::<Vec<_>>(),
        })
    }
}
