//! The chart of bands over time: how far pieces can be from the motion as drawn, and how far some were found to be.

use crate::analysis::enclosure::{Enclosed, TolerancePlan, ValueBand, shown_names};
use crate::plot::chart::{Axis, Chart, ChartBand, Panel, PlotSeries, Shade};

/// One panel a quantity; `wanted` are their indices.
pub fn band_chart(plan: &TolerancePlan, motion: &[Enclosed], wanted: &[usize]) -> Chart {
    let mechanism = plan.family.mechanism();
    let names = shown_names(mechanism);
    let panels = wanted.iter().filter_map(|index| {
        let (name, kind) = names.get(*index)?;
        let unit = mechanism.file_units(*kind);
        Some(band_panel(
            name,
            mechanism.unit_name(*kind),
            unit,
            motion,
            *index,
        ))
    });
    Chart {
        title: mechanism.title.clone(),
        description: "Bands that no piece within its tolerances leaves".to_owned(),
        panels: panels.collect(),
        notes: vec![
            "Relative to the nominal motion. Bands: no piece leaves them (proved at every sample); lines: pieces that were found."
                .to_owned(),
        ],
    }
}

fn band_panel(name: &str, unit: &str, factor: f64, motion: &[Enclosed], index: usize) -> Panel {
    let band = |enclosed: &Enclosed| enclosed.bands.as_ref().ok()?.list.get(index).copied();
    // Bands are drawn one for each run of samples that have them.
    let mut areas: Vec<ChartBand> = Vec::new();
    let mut shades = Vec::new();
    let mut is_open = false;
    for enclosed in motion {
        let Some(b) = band(enclosed).filter(|b| b.lo.is_finite() && b.hi.is_finite()) else {
            is_open = false;
            continue;
        };
        if !is_open {
            areas.push(ChartBand::default());
            is_open = true;
        }
        if let Some(area) = areas.last_mut() {
            area.lower
                .push([enclosed.time, (b.lo - b.nominal) * factor]);
            area.upper
                .push([enclosed.time, (b.hi - b.nominal) * factor]);
        }
    }
    for pair in motion.windows(2) {
        if pair.iter().any(|e| e.bands.is_err()) {
            shades.push(Shade {
                from: pair[0].time,
                to: pair[1].time,
                word: "no band".to_owned(),
            });
        }
    }
    let line = |of: &dyn Fn(&ValueBand) -> f64| {
        let points = motion.iter().map(|enclosed| {
            let band = band(enclosed)?;
            Some([enclosed.time, (of(&band) - band.nominal) * factor])
        });
        points.collect::<Vec<_>>()
    };
    let series = |name: &str, points| PlotSeries {
        name: name.to_owned(),
        points,
        ..PlotSeries::default()
    };
    Panel {
        title: name.to_owned(),
        x: Axis {
            label: "t".to_owned(),
            unit: "s".to_owned(),
            tight: true,
            ..Axis::default()
        },
        y: Axis {
            label: format!("{name}, pieces less drawing"),
            unit: unit.to_owned(),
            ..Axis::default()
        },
        bands: areas,
        series: vec![
            series("least found", line(&|b| b.found[0])),
            series("greatest found", line(&|b| b.found[1])),
        ],
        shades,
        samples: motion.iter().map(|e| e.time).collect(),
        ..Panel::default()
    }
}
