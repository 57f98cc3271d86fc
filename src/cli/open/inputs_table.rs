//! `--inputs TABLE.csv`: rows of input values in place of the scene's drive, one sample a row.

use crate::cli::term::outcome::Failure;
use crate::diag::nearest;
use crate::model::actuation::Actuation;
use crate::model::drive::{Drive, Ease};
use crate::model::mechanism::Mechanism;
use std::path::Path;

/// Most rows that are read.
const MAX_ROWS: usize = crate::kinematics::motion::sampling::MAX_SAMPLES;

/// Replaces the drives: row k is met at second k. Columns are found by name, others are ignored.
pub fn apply(mechanism: &Mechanism, actuation: &mut Actuation, path: &Path) -> Result<(), Failure> {
    let name = path.display();
    let text = std::fs::read_to_string(path)
        .map_err(|error| Failure::usage(format!("cannot read {name}: {error}"), Vec::new()))?;
    let mut lines = text
        .lines()
        .enumerate()
        .filter(|(_, line)| !line.trim().is_empty());
    let Some((_, header)) = lines.next() else {
        return Err(Failure::usage(
            format!("{name} is empty"),
            vec!["the first line names the columns".to_owned()],
        ));
    };
    let header: Vec<&str> = header.split(',').map(str::trim).collect();
    let mut columns = Vec::new();
    for input in &mechanism.inputs {
        match header.iter().position(|h| *h == input.name) {
            Some(column) => columns.push(column),
            None => return Err(missing_column(&input.name, &header, path)),
        }
    }
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); columns.len()];
    for (number, line) in lines {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        for (k, column) in columns.iter().enumerate() {
            let cell = cells.get(*column).copied().unwrap_or("");
            let value = cell
                .parse::<f64>()
                .ok()
                .filter(|v| v.is_finite())
                .ok_or_else(|| {
                    let input = &mechanism.inputs[k].name;
                    Failure::usage(
                        format!(
                            "{name}:{}: `{cell}` is not a value for `{input}`",
                            number + 1
                        ),
                        Vec::new(),
                    )
                })?;
            values[k].push(value / mechanism.file_units(mechanism.inputs[k].kind));
        }
        if values.first().is_some_and(|v| v.len() > MAX_ROWS) {
            return Err(Failure::usage(
                format!("{name} has more than {MAX_ROWS} rows"),
                Vec::new(),
            ));
        }
    }
    let rows = values.first().map_or(0, Vec::len);
    if rows == 0 {
        return Err(Failure::usage(
            format!("{name} has no rows of values for the inputs"),
            Vec::new(),
        ));
    }
    let times: Vec<f64> = (0..rows).map(|k| k as f64).collect();
    actuation.drives = values
        .into_iter()
        .map(|values| Drive::Keys {
            times: times.clone(),
            values,
            ease: Ease::Linear,
        })
        .collect();
    actuation.duration = (rows - 1).max(1) as f64;
    Ok(())
}

/// The sample times that belong to a table: one per row.
pub fn row_times(actuation: &Actuation) -> Vec<f64> {
    match actuation.drives.first() {
        Some(Drive::Keys { times, .. }) => times.clone(),
        _ => vec![0.0],
    }
}

fn missing_column(input: &str, header: &[&str], path: &Path) -> Failure {
    let mut hints = vec![format!("its columns are: {}", header.join(", "))];
    if let Some(near) = nearest(input, header.iter().copied()) {
        hints.insert(0, format!("did you mean `{near}` to be `{input}`?"));
    }
    Failure::usage(
        format!("{} has no column for the input `{input}`", path.display()),
        hints,
    )
}
