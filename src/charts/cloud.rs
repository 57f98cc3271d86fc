//! Chart of a cloud of paths: the paths of random pieces beside the path of the nominal mechanism.

use crate::analysis::cloud::{CloudSpread, PathCloud};
use crate::plot::chart::{Axis, Chart, ChartBand, Panel, PlotSeries};

/// Shares of the pieces that the bands hold, from their lower to their upper edge.
pub const BANDS: [[f64; 2]; 2] = [[0.001, 0.999], [0.05, 0.95]];

/// Most paths that are drawn one by one.
const MOST_LINES: usize = 60;

/// One panel a path: the deviation across it over the length along it.
pub fn cloud_chart(title: &str, unit: &str, clouds: &[PathCloud]) -> Chart {
    let panels: Vec<Panel> = clouds
        .iter()
        .map(|cloud| cloud_panel(cloud, unit))
        .collect();
    let pieces = clouds.first().map_or(0, |c| c.pieces.len());
    let lines = pieces.min(MOST_LINES);
    Chart {
        title: title.to_owned(),
        description: format!("Deviations of {pieces} random pieces across the traced paths"),
        panels,
        notes: vec![format!(
            "Across: where the pieces scatter most. Bands: 5 to 95 % and 0.1 to 99.9 % of {pieces} pieces; thin: {lines} of them."
        )],
    }
}

fn cloud_panel(cloud: &PathCloud, unit: &str) -> Panel {
    let CloudSpread { along, across } = cloud.spread();
    let line = |deviations: &[f64]| -> Vec<[f64; 2]> {
        along
            .iter()
            .copied()
            .zip(deviations.iter().copied())
            .map(<[f64; 2]>::from)
            .collect()
    };
    let at = |share: f64| line(&column_quantiles(&across, along.len(), share));
    let named = |name: &str, points: Vec<[f64; 2]>| PlotSeries {
        name: name.to_owned(),
        points: points.into_iter().map(Some).collect(),
        ..PlotSeries::default()
    };
    let bands = BANDS.map(|[low, high]| ChartBand {
        lower: at(low),
        upper: at(high),
    });
    Panel {
        title: format!("{} along {}", cloud.trace, cloud.track),
        x: Axis {
            label: "along the path".to_owned(),
            unit: unit.to_owned(),
            tight: true,
            ..Axis::default()
        },
        y: Axis {
            label: "across".to_owned(),
            unit: unit.to_owned(),
            ..Axis::default()
        },
        bands: bands.into(),
        cloud: across.iter().take(MOST_LINES).map(|d| line(d)).collect(),
        series: vec![
            named("median", at(0.5)),
            named("nominal", line(&vec![0.0; along.len()])),
        ],
        samples: along.clone(),
        ..Panel::default()
    }
}

/// The quantile of every column of `rows`.
fn column_quantiles(rows: &[Vec<f64>], columns: usize, share: f64) -> Vec<f64> {
    let of = |k: usize| {
        let mut values: Vec<f64> = rows.iter().map(|row| row[k]).collect();
        values.sort_unstable_by(f64::total_cmp);
        crate::analysis::tolerance::sorted_quantile(&values, share)
    };
    (0..columns).map(of).collect()
}
