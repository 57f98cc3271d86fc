//! Charts of a sweep: a curve over one parameter, or a map over two with the region in which all limits are met.
//!
//! Rows arrive one after another and are not kept: the chart stores no more cells than a picture can show.

use crate::plot::colour_bar::ColourBar;
use crate::plot::theme::Colour;
use crate::plot::{Axis, Chart, MapTile, Panel, PlotSeries};
use crate::sweep::row::{Row, RowStatus};
use crate::sweep::swept_scene::Sweep;

/// Most places along an axis of a map, and of a curve.
const MOST_TILES: usize = 160;
const MOST_POINTS: usize = 2000;

/// Colours of a map from the smallest value to the largest, dark to light, distinguishable with colour-vision
/// deficiency and in greyscale (cividis: Nuñez, Anderton, Renslow, PLoS ONE 2018).
const ENDS: [[f64; 3]; 5] = [
    [0.0, 34.0, 78.0],
    [66.0, 78.0, 108.0],
    [124.0, 123.0, 120.0],
    [184.0, 170.0, 104.0],
    [253.0, 234.0, 69.0],
];

/// Steps of these.
const COLOURS: usize = 48;

/// Where no row is ok.
const NOTHING: Colour = [0xd9, 0xd9, 0xd9, 255];

/// Share of the background in colours outside of the feasible region.
const FADED: f64 = 0.62;

/// Content of a cell: the first valid row that falls into it.
#[derive(Clone, Copy, Debug, Default)]
struct MapPlace {
    is_met: bool,
    value: Option<f64>,
    is_feasible: bool,
}

/// One value of a sweep over one or two of its parameters.
pub struct SweepPlot<'s> {
    sweep: &'s Sweep,
    /// Which value.
    value: usize,
    /// Parameters along the axes: those that change.
    axes: Vec<usize>,
    counts: Vec<usize>,
    places: Vec<MapPlace>,
}

impl<'s> SweepPlot<'s> {
    /// Starts a chart without rows; `value` is the number of the value drawn. `None` unless one or two parameters vary.
    pub fn new(sweep: &'s Sweep, value: usize) -> Option<Self> {
        let all = sweep.design.axes.iter().enumerate();
        let axes: Vec<usize> = all
            .filter(|(_, a)| a.low < a.high)
            .map(|(k, _)| k)
            .collect();
        let most = match axes.len() {
            1 => MOST_POINTS,
            2 => MOST_TILES,
            _ => return None,
        };
        // A grid gets one cell per value, as far as a picture can show them; other designs are binned.
        let count = |axis: &usize| match sweep.design.axes[*axis].count {
            1 => most.min(libm::pow(sweep.design.count() as f64, 1.0 / axes.len() as f64) as usize),
            steps => usize::try_from(steps).unwrap_or(most).min(most),
        };
        let counts: Vec<usize> = axes.iter().map(|axis| count(axis).max(1)).collect();
        Some(Self {
            places: vec![MapPlace::default(); counts.iter().product()],
            sweep,
            value,
            axes,
            counts,
        })
    }

    /// Notes the row of design `item`.
    pub fn add(&mut self, item: u64, row: &Row) {
        let design = self.sweep.design.values(item);
        let mut index = 0;
        for (axis, count) in self.axes.iter().zip(&self.counts) {
            let range = &self.sweep.design.axes[*axis];
            let share = (design[*axis] - range.low) / (range.high - range.low);
            // On a grid, the middle of a cell is its value.
            let place = match range.count {
                1 => share * *count as f64,
                _ => share * (*count - 1) as f64 + 0.5,
            };
            index = index * count + (place as usize).min(count - 1);
        }
        let place = &mut self.places[index];
        place.is_met = true;
        let value = row.values.get(self.value).copied();
        let value = value.filter(|v| row.status == RowStatus::Ok && v.is_finite());
        if place.value.is_none() && value.is_some() {
            *place = MapPlace {
                value,
                is_feasible: row.is_feasible,
                ..*place
            };
        }
    }

    /// The chart, and the bar of colours of a map.
    pub fn chart(&self) -> (Chart, Option<ColourBar>) {
        let (panel, bar) = match self.axes.len() {
            1 => (self.curve_panel(), None),
            _ => {
                let bar = self.value_bar();
                (self.map(&bar), Some(bar))
            }
        };
        let (name, _) = &self.sweep.columns[self.value];
        let along: Vec<&str> = panel_names(&panel, bar.is_some());
        let chart = Chart {
            title: self.sweep.title().to_owned(),
            description: format!("{name} over {}", along.join(" and ")),
            notes: self.chart_notes(bar.is_some()),
            panels: vec![panel],
        };
        (chart, bar)
    }

    fn chart_notes(&self, is_map: bool) -> Vec<String> {
        let count = self.sweep.design.count();
        let what = match is_map {
            true => "faded: limits are broken; grey: no row is ok",
            false => "gaps: no row is ok",
        };
        vec![format!("{count} designs; {what}")]
    }

    fn plot_axis(&self, k: usize) -> Axis {
        let name = &self.sweep.design.axes[self.axes[k]].name;
        let variables = &self.sweep.family().study.variables;
        let kind = variables.iter().find(|v| v.name == *name).map(|v| v.kind);
        let mechanism = self.sweep.family().mechanism();
        Axis {
            label: name.clone(),
            unit: kind.map_or("", |kind| mechanism.unit_name(kind)).to_owned(),
            tight: true,
            ..Axis::default()
        }
    }

    /// Edges of cell `place` along axis `k`.
    fn place_edges(&self, k: usize, place: usize) -> [f64; 2] {
        let range = &self.sweep.design.axes[self.axes[k]];
        let count = self.counts[k];
        let (low, high) = match (range.count, count) {
            (1, _) | (_, 1) => (range.low, range.high),
            _ => {
                let half = 0.5 * (range.high - range.low) / (count - 1) as f64;
                (range.low - half, range.high + half)
            }
        };
        [place, place + 1].map(|edge| low + (high - low) * edge as f64 / count as f64)
    }

    fn curve_panel(&self) -> Panel {
        let middle = |place: usize| {
            let [from, to] = self.place_edges(0, place);
            0.5 * (from + to)
        };
        let points = |is_shown: &dyn Fn(&MapPlace) -> bool| -> Vec<Option<[f64; 2]>> {
            // A cell without a design is not a gap in the motion.
            let met = self.places.iter().enumerate().filter(|(_, p)| p.is_met);
            met.map(|(k, p)| p.value.filter(|_| is_shown(p)).map(|v| [middle(k), v]))
                .collect()
        };
        let (name, unit) = &self.sweep.columns[self.value];
        let named = |name: &str, points| PlotSeries {
            name: name.to_owned(),
            points,
            ..PlotSeries::default()
        };
        let mut series = vec![named("all limits kept", points(&|p| p.is_feasible))];
        if self
            .places
            .iter()
            .any(|p| p.value.is_some() && !p.is_feasible)
        {
            series.push(named("limits broken", points(&|p| !p.is_feasible)));
        }
        Panel {
            x: self.plot_axis(0),
            y: Axis {
                label: name.clone(),
                unit: unit.clone(),
                ..Axis::default()
            },
            series,
            ..Panel::default()
        }
    }

    fn value_bar(&self) -> ColourBar {
        let values = self.places.iter().filter_map(|p| p.value);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
            (l.min(v), h.max(v))
        });
        let (name, unit) = &self.sweep.columns[self.value];
        ColourBar {
            label: match unit.is_empty() {
                true => name.clone(),
                false => format!("{name} [{unit}]"),
            },
            low: if low <= high { low } else { 0.0 },
            high: if low <= high { high } else { 1.0 },
            colours: (0..COLOURS).map(map_colour).collect(),
        }
    }

    fn map(&self, bar: &ColourBar) -> Panel {
        let [across, up] = [self.counts[0], self.counts[1]];
        let mut tiles = Vec::new();
        for column in 0..across {
            for row in 0..up {
                let place = &self.places[column * up + row];
                let [x, y] = [self.place_edges(0, column), self.place_edges(1, row)];
                let fill = match place.value.and_then(|value| bar.colour(value)) {
                    _ if !place.is_met => continue,
                    None => NOTHING,
                    Some(colour) if place.is_feasible => colour,
                    Some(colour) => faded_colour(colour),
                };
                tiles.push(MapTile {
                    from: [x[0], y[0]],
                    to: [x[1], y[1]],
                    fill,
                });
            }
        }
        Panel {
            x: self.plot_axis(0),
            y: self.plot_axis(1),
            tiles,
            series: self.region_border(),
            ..Panel::default()
        }
    }

    /// The border of the feasible region, edge by edge.
    fn region_border(&self) -> Vec<PlotSeries> {
        let [across, up] = [self.counts[0], self.counts[1]];
        let is_inside = |column: usize, row: usize| {
            column < across && row < up && self.places[column * up + row].is_feasible
        };
        let mut points = Vec::new();
        let mut edge = |a: [f64; 2], b: [f64; 2]| points.extend([Some(a), Some(b), None]);
        for column in 0..across {
            for row in 0..up {
                let [x, y] = [self.place_edges(0, column), self.place_edges(1, row)];
                let is_own = is_inside(column, row);
                if column + 1 < across && is_own != is_inside(column + 1, row) {
                    edge([x[1], y[0]], [x[1], y[1]]);
                }
                if row + 1 < up && is_own != is_inside(column, row + 1) {
                    edge([x[0], y[1]], [x[1], y[1]]);
                }
            }
        }
        match points.is_empty() {
            true => Vec::new(),
            false => vec![PlotSeries {
                name: "border of the feasible region".to_owned(),
                points,
                ..PlotSeries::default()
            }],
        }
    }
}

fn panel_names(panel: &Panel, is_map: bool) -> Vec<&str> {
    match is_map {
        true => vec![&panel.x.label, &panel.y.label],
        false => vec![&panel.x.label],
    }
}

/// Step `k` of the colours.
fn map_colour(k: usize) -> Colour {
    let place = k as f64 / (COLOURS - 1) as f64 * (ENDS.len() - 1) as f64;
    let below = (place as usize).min(ENDS.len() - 2);
    let share = place - below as f64;
    let mix = |c: usize| ENDS[below][c] + (ENDS[below + 1][c] - ENDS[below][c]) * share;
    let [r, g, b] = [0, 1, 2].map(|c| mix(c).round() as u8);
    [r, g, b, 255]
}

fn faded_colour([r, g, b, a]: Colour) -> Colour {
    let mix = |c: u8| (f64::from(c) * (1.0 - FADED) + 255.0 * FADED).round() as u8;
    [mix(r), mix(g), mix(b), a]
}
