//! Bars of derivatives: a row for each dimension, a column for each measure.

use crate::model::measure::Measure;
use crate::model::mechanism::{Kind, Mechanism};
use crate::plot::bars::{BarBlock, BarChart, BarColumn};
use crate::report::sensitivity::SensitivityTable;

/// The bars of a table; measure `rank` decides the order and comes first.
pub fn sensitivity_chart(table: &SensitivityTable, rank: usize) -> BarChart {
    let mechanism = &table.family.mechanism();
    let (measures, variables) = (&table.family.measures.list, &table.family.study.variables);
    let mut columns: Vec<usize> = (0..measures.len()).collect();
    columns.retain(|m| *m != rank && table.has_derivatives(*m));
    columns.insert(0, rank);
    let kinds = [Kind::Length, Kind::Angle, Kind::Number];
    let blocks = kinds.into_iter().filter_map(|kind| {
        let of_kind = |v: &&usize| variables[**v].kind == kind;
        let rows: Vec<usize> = table.order.iter().filter(of_kind).copied().collect();
        (!rows.is_empty()).then(|| BarBlock {
            heading: format!("per {}", kind_unit(mechanism, kind)),
            rows: rows.iter().map(|v| variables[*v].name.clone()).collect(),
            columns: columns
                .iter()
                .map(|m| BarColumn {
                    label: measure_label(mechanism, &measures[*m]),
                    values: rows.iter().map(|v| table.slope(*m, *v)).collect(),
                })
                .collect(),
        })
    });
    let blocks: Vec<BarBlock> = blocks.collect();
    let ranked = &measures[rank].name;
    BarChart {
        title: mechanism.title.clone(),
        description: format!("Derivatives of the measures by the dimensions, ranked by d{ranked}"),
        blocks,
        notes: vec![format!(
            "Exact derivatives, ranked by d{ranked}; every column has a scale of its own."
        )],
    }
}

fn kind_unit(mechanism: &Mechanism, kind: Kind) -> &str {
    match kind {
        Kind::Length => &mechanism.length_unit,
        Kind::Angle => &mechanism.angle_unit.name,
        Kind::Number => "1",
    }
}

fn measure_label(mechanism: &Mechanism, measure: &Measure) -> String {
    match measure.kind {
        Kind::Number => format!("d{}", measure.name),
        kind => format!("d{} [{}]", measure.name, kind_unit(mechanism, kind)),
    }
}
