//! The picture of the paved sets: the linkage as bars, and about every point where it may start.

use crate::analysis::dyads::PlanarRow;
use crate::intervals::paving::{PavedSquare, Paving};
use crate::plot::chart::{Axis, Chart, ChartBand, Panel, PlotSeries};
use crate::report::row_intervals::PavedPoint;

/// A panel of sections and one of projections, in the plane of the mechanism.
pub fn paving_chart(row: &PlanarRow, title: &str, unit: &str, paved: &[PavedPoint]) -> Chart {
    let panel = |name: &str, of: &dyn Fn(&PavedPoint) -> Paving| {
        let pavings: Vec<Paving> = paved.iter().map(of).collect();
        paving_panel(row, name, unit, &pavings)
    };
    Chart {
        title: title.to_owned(),
        description: "Squares of start positions about every point of the linkage".to_owned(),
        panels: vec![
            panel("Section: the other points as drawn", &|p| p.section.clone()),
            panel("Projection: some place of the others suffices", &|p| p.projection.clone()),
        ],
        notes: vec![
            "Filled: starts that keep the angles of all dyads, proved. Outlined squares: not decided. Elsewhere in a \
             window: proved not to keep them."
                .to_owned(),
        ],
    }
}

fn paving_panel(row: &PlanarRow, name: &str, unit: &str, pavings: &[Paving]) -> Panel {
    let axis = |k: usize| Axis {
        label: row.axes[k].to_owned(),
        unit: unit.to_owned(),
        ..Axis::default()
    };
    let points = &row.chain.points;
    let bars = row.bars.iter().map(|[a, b]| [points[*a], points[*b]]);
    let windows = pavings
        .iter()
        .zip(paved_points(row))
        .map(|(paving, point)| {
            let whole = PavedSquare {
                middle: points[point],
                half: paving.reach,
            };
            PlotSeries {
                name: row.names[point].clone(),
                points: cell_outline(&whole).into_iter().map(Some).collect(),
                ..PlotSeries::default()
            }
        });
    Panel {
        title: name.to_owned(),
        x: axis(0),
        y: axis(1),
        bands: pavings
            .iter()
            .flat_map(|p| p.inner.iter().map(filled_cell))
            .collect(),
        cloud: pavings
            .iter()
            .flat_map(|p| p.edge.iter().map(cell_outline))
            .collect(),
        series: windows.collect(),
        lines: bars.collect(),
        marks: points.clone(),
        equal: true,
        ..Panel::default()
    }
}

/// The moving points, in the order in which they are paved.
fn paved_points(row: &PlanarRow) -> impl Iterator<Item = usize> + '_ {
    (0..row.chain.points.len()).filter(|k| !row.chain.fixed.contains(k))
}

fn cell_corners(cell: &PavedSquare) -> [[f64; 2]; 2] {
    let [x, y] = cell.middle;
    [
        [x - cell.half, y - cell.half],
        [x + cell.half, y + cell.half],
    ]
}

fn filled_cell(cell: &PavedSquare) -> ChartBand {
    let [[left, low], [right, high]] = cell_corners(cell);
    ChartBand {
        lower: vec![[left, low], [right, low]],
        upper: vec![[left, high], [right, high]],
    }
}

fn cell_outline(cell: &PavedSquare) -> Vec<[f64; 2]> {
    let [[left, low], [right, high]] = cell_corners(cell);
    vec![
        [left, low],
        [right, low],
        [right, high],
        [left, high],
        [left, low],
    ]
}
