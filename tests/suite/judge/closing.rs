//! Closes a scene with 96 digits, beside given coordinates.

use super::chain::Frame;
use super::dual::Dual;
use super::least_squares::Factors;
use super::number::{Number, Precise};
use super::scene::Scene;

/// Corrections below this share of the size end a closing.
const CLOSED: f64 = 1e-40;
/// Steps with one Jacobian. It has 15 digits, and each step gains that many, less what the condition number takes.
const STEPS: usize = 6;
/// Jacobians that a closing may take.
const ROUNDS: usize = 5;

/// Everything that must vanish, lengths over `size`.
fn residual<N: Number>(scene: &Scene, size: f64, coordinates: &[N]) -> Vec<N> {
    let scale = N::of_precise(&Precise::of(1.0).over(&Precise::of(size)));
    let half = N::of_precise(&Precise::of(0.5));
    let mut rows = Vec::new();
    for steps in &scene.loops {
        let frame = Frame::at(steps, coordinates);
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            rows.push(frame.columns[i][j].minus(&frame.columns[j][i]).times(&half));
        }
        rows.extend(frame.origin.iter().map(|c| c.times(&scale)));
    }
    for steps in &scene.points {
        rows.extend(
            Frame::at(steps, coordinates)
                .origin
                .iter()
                .map(|c| c.times(&scale)),
        );
    }
    for (sides, sum) in &scene.distances {
        let [a, b] = sides
            .each_ref()
            .map(|steps| Frame::at(steps, coordinates).origin);
        let apart = [0, 1, 2].map(|k| b[k].minus(&a[k]));
        let distance = super::chain::dot(&apart, &apart).root();
        rows.push(distance.minus(&sum.at(coordinates)).times(&scale));
    }
    rows.extend(
        scene
            .equations
            .iter()
            .map(|equation| equation.at(coordinates)),
    );
    rows
}

/// Whether a loop is turned by pi, where the residual vanishes, too.
fn is_turned(scene: &Scene, coordinates: &[Precise]) -> bool {
    scene.loops.iter().any(|steps| {
        let frame = Frame::at(steps, coordinates);
        (0..3).any(|k| frame.columns[k][k].rounded() < 0.5)
    })
}

/// Derivatives of the residual by the unknowns in `free`, each per angle of one or length of `size`, and what the rows
/// are multiplied by: equations are brought to the size of the rest.
fn jacobian(
    scene: &Scene,
    size: f64,
    coordinates: &[Precise],
    free: &[usize],
) -> (Vec<Vec<f64>>, Vec<f64>) {
    let rounded: Vec<f64> = coordinates.iter().map(Precise::rounded).collect();
    let column = |j: &usize| {
        let unit = if scene.unknowns[*j].is_angle {
            1.0
        } else {
            size
        };
        let moving = |(k, value): (usize, &f64)| Dual {
            value: *value,
            slope: if k == *j { unit } else { 0.0 },
        };
        let at: Vec<Dual> = rounded.iter().enumerate().map(moving).collect();
        residual(scene, size, &at)
            .iter()
            .map(|r| r.slope)
            .collect::<Vec<f64>>()
    };
    let mut columns: Vec<Vec<f64>> = free.iter().map(column).collect();
    let rows = columns.first().map_or(0, Vec::len);
    let mut scales = vec![1.0; rows];
    for row in rows - scene.equations.len().min(rows)..rows {
        let largest = columns.iter().map(|c| c[row].abs()).fold(0.0, f64::max);
        scales[row] = if largest > 0.0 { 1.0 / largest } else { 1.0 };
        columns.iter_mut().for_each(|c| c[row] *= scales[row]);
    }
    (columns, scales)
}

/// Unknowns that remain if `idle` ones may keep their values, as long as they say nothing that others do not.
/// None where the rest is not determined.
pub fn free_unknowns(
    scene: &Scene,
    size: f64,
    coordinates: &[Precise],
    idle: &[usize],
) -> Option<Vec<usize>> {
    let rank = |free: &[usize]| Factors::new(jacobian(scene, size, coordinates, free).0).rank;
    let mut free: Vec<usize> = (0..scene.unknowns.len()).collect();
    let whole = rank(&free);
    for k in idle {
        if free.len() == whole {
            break;
        }
        let fewer: Vec<usize> = free.iter().copied().filter(|j| j != k).collect();
        if rank(&fewer) == whole {
            free = fewer;
        }
    }
    (free.len() == whole).then_some(free)
}

/// What came of a closing.
pub struct Closed {
    pub coordinates: Vec<Precise>,
    /// Largest row that did not vanish, as a share of the size.
    pub left: f64,
    pub is_turned: bool,
}

/// Newton's method from `start` in the unknowns `free`, by least squares where there are more rows. Where these
/// contradict each other, something is left. None where the steps leave the numbers.
pub fn close(scene: &Scene, size: f64, start: &[Precise], free: &[usize]) -> Option<Closed> {
    let mut at = start.to_vec();
    for _ in 0..ROUNDS {
        let (columns, scales) = jacobian(scene, size, &at, free);
        let factors = Factors::new(columns);
        let mut largest = f64::INFINITY;
        for _ in 0..STEPS {
            let step = factors.solve(&scaled(&residual(scene, size, &at), &scales));
            if step.iter().any(|v| !v.is_finite()) {
                return None;
            }
            for (j, v) in free.iter().zip(&step) {
                let unit = if scene.unknowns[*j].is_angle {
                    1.0
                } else {
                    size
                };
                let change = Precise::of(*v).times(&Precise::of(unit));
                at[*j] = at[*j].minus(&change);
            }
            largest = step.iter().fold(0.0, |m, v| m.max(v.abs()));
            if largest < CLOSED {
                break;
            }
        }
        if largest < CLOSED {
            break;
        }
    }
    let (_, scales) = jacobian(scene, size, &at, free);
    let left = scaled(&residual(scene, size, &at), &scales);
    Some(Closed {
        left: left.iter().fold(0.0, |m, v| m.max(v.abs())),
        is_turned: is_turned(scene, &at),
        coordinates: at,
    })
}

fn scaled(rows: &[Precise], scales: &[f64]) -> Vec<f64> {
    rows.iter()
        .zip(scales)
        .map(|(row, scale)| row.rounded() * scale)
        .collect()
}
