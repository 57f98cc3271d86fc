//! The matrix of a clearance report: one cell a pair of bodies, in the colour of its class.

use crate::clearance::check::{ClearanceClass, ClearanceReport, PairReport};
use crate::model::mechanism::Mechanism;
use crate::numbers::decimal::fixed;
use crate::plot::matrix::{MatrixCell, MatrixChart};
use crate::plot::theme::Colour;
use crate::report::lengths::{CONTACT, at_least_length};
use crate::sorting::sort_by_key;
use std::collections::HashMap;

/// More bodies do not fit into one picture: those of the worst pairs are shown.
const MOST_BODIES: usize = 100;

/// Every class with its colour, the worst first. The colours remain distinguishable with colour-vision deficiency.
const CLASSES: [(ClearanceClass, Colour); 6] = [
    (ClearanceClass::Below, [0xd5, 0x5e, 0x00, 255]),
    (ClearanceClass::Separated, [0x00, 0x72, 0xb2, 255]),
    (ClearanceClass::NotProved, [0xcc, 0x79, 0xa7, 255]),
    (ClearanceClass::Near, [0xf0, 0xd0, 0x60, 255]),
    (ClearanceClass::Clear, [0x8f, 0xc8, 0xe8, 255]),
    (ClearanceClass::Excluded, [0xd8, 0xdc, 0xe0, 255]),
];

fn class_colour(class: ClearanceClass) -> Colour {
    let known = CLASSES.iter().find(|(c, _)| *c == class);
    known.map_or([0, 0, 0, 255], |(_, colour)| *colour)
}

/// All pairs; those within `band` of their minimum are near, without a band those within twice the minimum.
pub fn clearance_matrix(
    mechanism: &Mechanism,
    report: &ClearanceReport,
    band: Option<f64>,
) -> MatrixChart {
    let shown = judged_bodies(mechanism, report);
    let place: HashMap<usize, usize> = shown
        .iter()
        .enumerate()
        .map(|(k, body)| (*body, k))
        .collect();
    let cell = |pair: &PairReport| {
        let [a, b] = pair.pair.map(|body| place.get(&body).copied());
        let (a, b) = (a?, b?);
        Some(MatrixCell {
            place: [a.max(b), a.min(b)],
            fill: class_colour(pair.class(band)),
            text: cell_text(pair.worst_moment().distance, mechanism.size),
        })
    };
    // A pair that is checked except for the shapes at its joint is shown as checked.
    let judged = report.judged.iter().filter_map(cell);
    let mut cells: HashMap<[usize; 2], MatrixCell> = report
        .excluded
        .iter()
        .filter_map(cell)
        .map(|c| (c.place, c))
        .collect();
    cells.extend(judged.map(|c| (c.place, c)));
    let mut cells: Vec<MatrixCell> = cells.into_values().collect();
    sort_by_key(&mut cells, |c| c.place);
    let name = |body: &usize| mechanism.bodies[*body].name.clone();
    MatrixChart {
        title: mechanism.title.clone(),
        description: format!("Least distances of {} bodies, each with each", shown.len()),
        names: shown.iter().map(name).collect(),
        cells,
        legend: class_legends(report, band),
        notes: matrix_notes(mechanism, report, shown.len()),
    }
}

/// The bodies with shapes, those of the worst pairs if they are too many.
fn judged_bodies(mechanism: &Mechanism, report: &ClearanceReport) -> Vec<usize> {
    let all = 0..mechanism.bodies.len();
    let mut shown: Vec<usize> = all
        .filter(|k| !mechanism.bodies[*k].shapes.is_empty())
        .collect();
    if shown.len() > MOST_BODIES {
        let worst = report
            .judged
            .iter()
            .chain(&report.excluded)
            .flat_map(|p| p.pair);
        let mut list: Vec<usize> = Vec::new();
        for body in worst.chain(shown.iter().copied()) {
            if list.len() < MOST_BODIES && !list.contains(&body) {
                list.push(body);
            }
        }
        list.sort_unstable();
        shown = list;
    }
    shown
}

/// Every class with its number of pairs; separated pairs are rare, and named only if there are any.
fn class_legends(report: &ClearanceReport, band: Option<f64>) -> Vec<(Colour, String)> {
    let counted = CLASSES.map(|(class, colour)| (class, colour, class_count(report, class, band)));
    let shown = counted
        .iter()
        .filter(|(class, _, count)| *class != ClearanceClass::Separated || *count > 0);
    shown
        .map(|(class, colour, count)| (*colour, format!("{count} {}", class.word())))
        .collect()
}

fn class_count(report: &ClearanceReport, class: ClearanceClass, band: Option<f64>) -> usize {
    let pairs = report.judged.iter().chain(&report.excluded);
    let listed = pairs.filter(|p| p.class(band) == class).count();
    let rest: usize = match class {
        ClearanceClass::Excluded => report.counted.iter().map(|(_, count)| count).sum(),
        ClearanceClass::Clear => report
            .far
            .filter(|far| far.is_certified)
            .map_or(0, |far| far.count),
        ClearanceClass::NotProved => report
            .far
            .filter(|far| !far.is_certified)
            .map_or(0, |far| far.count),
        _ => 0,
    };
    listed + rest
}

fn matrix_notes(mechanism: &Mechanism, report: &ClearanceReport, shown: usize) -> Vec<String> {
    let unit = &mechanism.length_unit;
    let mut notes = vec![format!(
        "Least distances over the motion in {unit}, column by number; negative ones are depths."
    )];
    if report.judged.iter().any(|p| p.parted().is_some()) {
        notes.push(
            "Bodies that must touch: the largest gap where it is larger than the overlap."
                .to_owned(),
        );
    }
    notes.extend(report.far.map(|far| {
        format!(
            "Empty cells: {} pairs that stay at least {} {unit} apart, and pairs that are not looked at.",
            far.count,
            at_least_length(far.apart, mechanism.size, 3)
        )
    }));
    let all = mechanism
        .bodies
        .iter()
        .filter(|b| !b.shapes.is_empty())
        .count();
    if shown < all {
        notes.push(format!("{shown} of {all} bodies: those of the worst pairs"));
    }
    notes
}

/// A distance in about four signs in a mechanism of this `size`.
fn cell_text(distance: f64, size: f64) -> String {
    match distance.abs() {
        _ if distance == f64::NEG_INFINITY => "endless".to_owned(),
        least if least < 0.01 && least > CONTACT * size => format!("{distance:.0e}"),
        least if least < 10.0 => fixed(distance, 2),
        least if least < 100.0 => fixed(distance, 1),
        least if least < 1e5 => fixed(distance, 0),
        _ => format!("{distance:.0e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_show_distances_of_any_size() {
        for (distance, size, text) in [
            (12345.6, 300.0, "12346"),
            (123_456.0, 300.0, "1e5"),
            (12.34, 300.0, "12.3"),
            (1.234, 300.0, "1.23"),
            (0.0012, 300.0, "1e-3"),
            (-0.0012, 0.3, "-1e-3"),
            (-1e-9, 300.0, "0.00"),
        ] {
            assert_eq!(cell_text(distance, size), text);
        }
    }
}
