//! A judge of printed tables that shares no code with the engine. It reads a scene and a table as texts, closes every
//! row with 96 digits beside the printed numbers, and says how far these are off, as shares of the printed
//! `error_bound`. Inputs and dimensions are the decimals as they stand.

mod ball;
mod chain;
mod closing;
mod contact;
mod draft;
mod dual;
mod file;
mod formula;
mod least_squares;
pub mod loops;
mod number;
mod scene;
pub mod table;
mod units;
mod value;

use chain::Frame;
use closing::{close, free_unknowns};
use number::{Number, Precise};
use scene::{Scene, What};
use std::collections::HashMap;
use table::Table;

/// What is left of an equation of a closed pose, as a share of the size; far above 96 digits, far below any f64.
const VANISHED: f64 = 1e-35;
/// Sine between the outer axes of a ball joint below which its rotation may be judged in place of its angles.
const NEAR_LOCK: f64 = 1e-6;
/// Differences of printed start values to those in the file.
const SAME: f64 = 1e-12;

/// What a row is.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    NoPose,
    /// Without an error bound.
    Unproved,
    Judged {
        /// Distance to the closed pose over the printed bound.
        ratio: f64,
        /// The unknown that is farthest off.
        unknown: String,
        /// By rotations of ball joints in gimbal lock.
        is_locked: bool,
    },
    /// A bound is printed, and the judge finds no closed pose there, for this reason.
    Broken(String),
}

impl Verdict {
    /// What is wrong with the row.
    pub fn complaint(&self) -> Option<String> {
        match self {
            Self::Judged { ratio, unknown, .. } if *ratio > 1.0 => {
                Some(format!("{unknown} is off by {ratio:.4} bounds"))
            }
            Self::Broken(reason) => Some(reason.clone()),
            _ => None,
        }
    }
}

type Row = HashMap<String, String>;

/// Judges every row of a table of the scene; `size` is the mechanism's, which measures angles.
pub fn judge(scene: &str, table: &Table, size: f64) -> Vec<Verdict> {
    let scene_text = scene;
    let scene = Scene::read(scene_text);
    let idle: Vec<usize> = (0..scene.unknowns.len())
        .filter(|k| rests(&scene, *k, table))
        .collect();
    let verdicts = table.rows.iter().map(|row| {
        if row["status"] == "no-pose" {
            return Verdict::NoPose;
        }
        if row["error_bound"].is_empty() {
            return Verdict::Unproved;
        }
        let bound = table::number(row, "error_bound").rounded();
        let plain = judge_row(&scene, row, size, bound, &idle);
        if plain.complaint().is_none() {
            return plain;
        }
        locked(scene_text, row, size, bound, &idle).unwrap_or(plain)
    });
    verdicts.collect()
}

/// Share of its bound by which a printed traced coordinate or output is off: row by row, those that have a bound.
/// `angles` names the outputs that are angles.
pub fn judge_shown(scene: &str, table: &Table, size: f64, angles: &[String]) -> Vec<(String, f64)> {
    let scene = Scene::read_with(scene, angles);
    let idle: Vec<usize> = (0..scene.unknowns.len())
        .filter(|k| rests(&scene, *k, table))
        .collect();
    let mut all = Vec::new();
    for row in table.rows.iter().filter(|row| row["status"] != "no-pose") {
        let start = printed(&scene, row);
        let closed = free_unknowns(&scene, size, &start, &idle)
            .and_then(|free| close(&scene, size, &start, &free));
        let Some(closed) = closed.filter(|c| c.left <= VANISHED && !c.is_turned) else {
            continue;
        };
        let exact = shown(&scene, closed.coordinates);
        for (shown, exact) in scene.shown.iter().zip(exact) {
            let bound = &row[&format!("bound({})", shown.name)];
            if let (Some(exact), false) = (exact, bound.is_empty()) {
                let off = table::number(row, &shown.name)
                    .times(&shown.unit)
                    .minus(&exact);
                let bound = Precise::of_decimal(bound).times(&shown.unit).rounded();
                all.push((shown.name.clone(), off.rounded().abs() / bound));
            }
        }
    }
    all
}

/// What is shown of a pose, where the judge knows it.
fn shown(scene: &Scene, coordinates: Vec<Precise>) -> Vec<Option<Precise>> {
    let mut slots = coordinates;
    let mut all = Vec::new();
    for shown in &scene.shown {
        let value = match &shown.what {
            What::Place(steps, axis) => Some(Frame::at(steps, &slots).origin[*axis].clone()),
            What::Value(formula) => Some(formula.at(&slots)),
            What::Unknown => None,
        };
        slots.push(value.clone().unwrap_or_else(|| Precise::of(0.0)));
        all.push(value);
    }
    all
}

/// Names of the unknowns, with the radians in one printed unit of angles.
pub fn unknowns(scene: &str) -> Vec<(String, Option<f64>)> {
    let unknowns = Scene::read(scene).unknowns.into_iter();
    unknowns
        .map(|u| (u.name, u.is_angle.then(|| u.unit.rounded())))
        .collect()
}

/// Whether an unknown keeps its start value in all rows, as idle ones do.
fn rests(scene: &Scene, k: usize, table: &Table) -> bool {
    let unknown = &scene.unknowns[k];
    let poses = table.rows.iter().filter(|row| row["status"] != "no-pose");
    let guess = &unknown.guess;
    poses
        .map(|row| table::number(row, &unknown.name).times(&unknown.unit))
        .all(|value| {
            let apart = value.minus(guess).rounded().abs();
            apart <= SAME * guess.rounded().abs().max(SAME)
        })
}

/// The printed coordinates in radians and lengths; small rotations that are printed nowhere are zero.
fn printed(scene: &Scene, row: &Row) -> Vec<Precise> {
    let coordinates = scene.unknowns.iter().chain(&scene.inputs);
    let value = |c: &scene::Coordinate| match row.contains_key(&c.name) {
        true => table::number(row, &c.name).times(&c.unit),
        false => Precise::of(0.0),
    };
    coordinates.map(value).collect()
}

fn judge_row(scene: &Scene, row: &Row, size: f64, bound: f64, idle: &[usize]) -> Verdict {
    let broken = |reason: &str| Verdict::Broken(reason.to_owned());
    let start = printed(scene, row);
    let Some(free) = free_unknowns(scene, size, &start, idle) else {
        return broken("the unknowns are not determined");
    };
    let Some(closed) = close(scene, size, &start, &free) else {
        return broken("the closing leaves the numbers");
    };
    if closed.left > VANISHED {
        return Verdict::Broken(format!(
            "does not close: {:.1e} of the size is left",
            closed.left
        ));
    }
    if closed.is_turned {
        return broken("is turned by pi");
    }
    let distance = |k: &usize| {
        let apart = closed.coordinates[*k].minus(&start[*k]).rounded().abs();
        if scene.unknowns[*k].is_angle {
            apart * size
        } else {
            apart
        }
    };
    let worst = free
        .iter()
        .copied()
        .max_by(|a, b| distance(a).total_cmp(&distance(b)));
    let (apart, unknown) = worst.map_or((0.0, String::new()), |k| {
        (distance(&k), scene.unknowns[k].name.clone())
    });
    Verdict::Judged {
        ratio: if apart == 0.0 { 0.0 } else { apart / bound },
        unknown,
        is_locked: false,
    }
}

/// Judges the row by the rotations of the ball joints that are locked there.
fn locked(text: &str, row: &Row, size: f64, bound: f64, idle: &[usize]) -> Option<Verdict> {
    let mut scene = Scene::read(text);
    let at = printed(&scene, row);
    let near = |ball: &ball::Ball| ball::distance_from_lock(&scene, *ball, &at) < NEAR_LOCK;
    let locked: Vec<ball::Ball> = ball::balls(&scene).into_iter().filter(near).collect();
    if locked.is_empty() {
        return None;
    }
    let mut held: Vec<usize> = locked.iter().flat_map(|ball| ball.0).collect();
    held.extend(idle);
    for ball in locked {
        scene = ball::loosened(scene, ball);
    }
    match judge_row(&scene, row, size, bound, &held) {
        Verdict::Judged { ratio, unknown, .. } => Some(Verdict::Judged {
            ratio,
            unknown,
            is_locked: true,
        }),
        _ => None,
    }
}
