//! Interval results for the velocities and positions of a sequence of dyads: in words and as documents.

use super::cells::{aligned_rows, six_digits};
use super::rounded::not_below;
use crate::analysis::dyads::{PlanarRow, Trials};
use crate::analysis::tolerance::sorted_quantile;
use crate::intervals::Kaucher;
use crate::intervals::formal::Formal;
use crate::intervals::paving::{Paving, PavingWindow};
use serde_json::{Value, json};
use std::f64::consts::PI;

/// Version of the JSON documents.
const SCHEMA: u32 = 1;

/// Shares at which quantiles are given.
const SHARES: [f64; 5] = [0.01, 0.05, 0.5, 0.95, 0.99];

/// Speeds, in multiples of the given one, below which shares of the trials are counted.
const SPEEDS: [f64; 4] = [2.0, 5.0, 10.0, 50.0];

/// The document's name.
pub fn document_schema() -> String {
    format!("mechanim-intervals/{SCHEMA}")
}

/// Names of the unknowns' components.
fn component_names(row: &PlanarRow, letter: &str) -> Vec<String> {
    let unknowns = row.chain.unknowns().into_iter();
    unknowns
        .flat_map(|k| {
            row.axes
                .map(|axis| format!("{letter}{}{axis}", row.names[k]))
        })
        .collect()
}

/// Quantiles of random trials.
pub fn trials_text(row: &PlanarRow, trials: &Trials, asked: usize, given: f64) -> String {
    let mut rows = vec![vec![String::new()]];
    rows[0].extend(SHARES.map(|s| format!("{} %", s * 100.0)));
    let lists = trials.velocities.iter().chain(&trials.positions).flatten();
    let names = [component_names(row, "v"), component_names(row, "p")].concat();
    for (name, list) in names.into_iter().zip(lists) {
        let cells = SHARES.map(|s| six_digits(sorted_quantile(list, s)));
        rows.push([name].into_iter().chain(cells).collect());
    }
    let speeds: Vec<String> = (SPEEDS.iter())
        .map(|k| format!("{k}: {:.1} %", 100.0 * trials.share_below(k * given)))
        .collect();
    format!(
        "{asked} trials, {} of them solved; the determinant has the sign of the pose in {:.1} %\n\
         {}\
         Largest speed at most so many times that of the given point: {}\n\
         |cos| between the lever and the velocity of its end: {} in half of the trials; zero where the lever keeps its length\n\
         Quantiles, not extremes: speeds have no largest value, since the determinant comes as near to zero as one likes\n",
        trials.solved,
        100.0 * trials.same_sign,
        aligned_rows(&rows),
        speeds.join(", "),
        six_digits(sorted_quantile(&trials.lever, 0.5)),
    )
}

/// The same for machines.
pub fn trials_document(row: &PlanarRow, trials: &Trials, given: f64) -> Value {
    let quantiles = |list: &Vec<f64>| SHARES.map(|s| sorted_quantile(list, s));
    let named = |letter: &str, lists: &[[Vec<f64>; 2]]| {
        let names = component_names(row, letter).into_iter();
        let pairs = names.zip(lists.iter().flatten().map(quantiles));
        pairs
            .map(|(name, q)| (name, json!(q)))
            .collect::<serde_json::Map<String, Value>>()
    };
    json!({
        "schema": document_schema(),
        "derived": "trials",
        "solved": trials.solved,
        "same_sign": trials.same_sign,
        "shares": SHARES,
        "velocities": named("v", &trials.velocities),
        "positions": named("p", &trials.positions),
        "speeds": SPEEDS.map(|k| json!({ "times": k, "share": trials.share_below(k * given) })),
        "lever": SHARES.map(|s| sorted_quantile(&trials.lever, s)),
    })
}

/// One formal solution: what it is, and what it proves.
fn formal_outcome(formal: &Formal, set: &str, is_inside: bool) -> String {
    match formal {
        Formal::Solved {
            steps, improper, ..
        } if improper.is_empty() => match is_inside {
            true => format!(
                "{steps} steps, proper: its box lies in the {set} set (tested with outward rounding)"
            ),
            false => format!(
                "{steps} steps, proper, but the test with outward rounding leaves open whether it lies in the {set} set"
            ),
        },
        Formal::Solved { steps, improper, x } => format!(
            "{steps} steps, improper in {} of {} unknowns: it proves nothing",
            improper.len(),
            x.len()
        ),
        Formal::Singular { steps } => {
            format!("D is singular after {steps} steps: the method says nothing about the system")
        }
        Formal::NotConverged => {
            "no convergence: the method says nothing about the system".to_owned()
        }
        Formal::NotSquare => "not as many rows as unknowns".to_owned(),
    }
}

/// Formal solutions of A x = b and dual A x = b with their outcome.
pub struct FormalPair<'a> {
    /// For the tolerable set, and whether it lies there.
    pub tolerable: (&'a Formal, bool),
    /// For the united set, likewise.
    pub united: (&'a Formal, bool),
    /// Bound of the spectral radius of |mid A⁻¹| rad A.
    pub spectral: f64,
}

impl FormalPair<'_> {
    fn regularity_line(&self) -> String {
        let shown = match self.spectral.is_finite() {
            true => six_digits(self.spectral),
            false => "unbounded".to_owned(),
        };
        match self.spectral < 1.0 {
            true => format!(
                "spectral radius of |mid A^-1| rad A: {shown} < 1: every matrix in A is regular (proved)"
            ),
            false => format!(
                "spectral radius of |mid A^-1| rad A: {shown}: it is not proved that every matrix in A is regular"
            ),
        }
    }

    /// For people.
    pub fn text(&self, row: &PlanarRow) -> String {
        let names = component_names(row, "v");
        let mut text = format!("{}\n", self.regularity_line());
        let both = [
            ("A x = b", "tolerable", self.tolerable),
            ("dual A x = b", "united", self.united),
        ];
        for (equation, set, (formal, is_inside)) in both {
            text += &format!("{equation}: {}\n", formal_outcome(formal, set, is_inside));
            if let Formal::Solved { x, .. } = formal {
                let rows: Vec<Vec<String>> = names
                    .iter()
                    .zip(x)
                    .map(|(name, k)| vec![name.clone(), six_digits(k.lo), six_digits(k.hi)])
                    .collect();
                text += &aligned_rows(&rows);
            }
        }
        text
    }

    /// For machines.
    pub fn document(&self) -> Value {
        let of = |(formal, is_inside): (&Formal, bool), set: &str| {
            let x = match formal {
                Formal::Solved { x, .. } => {
                    Some(x.iter().map(|k| [k.lo, k.hi]).collect::<Vec<_>>())
                }
                _ => None,
            };
            json!({ "set": set, "x": x, "outcome": formal_outcome(formal, set, is_inside), "inside": is_inside })
        };
        json!({
            "schema": document_schema(),
            "derived": "formal",
            "spectral_radius": self.spectral.is_finite().then_some(self.spectral),
            "formal": [of(self.tolerable, "tolerable"), of(self.united, "united")],
        })
    }

    /// Whether one of them proves anything.
    pub fn proves(&self) -> bool {
        self.tolerable.1 || self.united.1
    }
}

/// Widths that differ by no more than this share are the same but for rounding.
const SAME_WIDTH: f64 = 1e-9;

/// The cube of the method of the centre; `sides` are the half widths of the right-hand sides, least and greatest.
pub fn centre_text(tolerance: f64, radius: f64, united: f64, sides: [f64; 2]) -> String {
    let [side, widest] = sides;
    let lines = [
        match widest > side * (1.0 + SAME_WIDTH) {
            true => format!(
                "right sides are {} wide on either side, and up to {} where they hold the given velocity times uncertain coefficients",
                six_digits(side),
                six_digits(widest)
            ),
            false => format!(
                "all right sides are {} wide on either side",
                six_digits(side)
            ),
        },
        match radius > 0.0 {
            true => format!(
                "tolerable set: the cube of half width {} about the centre lies in it",
                not_below(radius, 9)
            ),
            false => format!(
                "tolerable set: the centre is not in it (functional {}), and there is no cube",
                six_digits(tolerance)
            ),
        },
        match united > 0.0 {
            true => format!(
                "united set: a cube of half width {} lies in it, of coefficients that are independent of each other",
                not_below(united, 9)
            ),
            false => "united set: no cube was found by the test of rows, which is sufficient only"
                .to_owned(),
        },
    ];
    lines.join("\n") + "\n"
}

/// One point's paved sets.
pub struct PavedPoint {
    /// Index of the point.
    pub point: usize,
    /// With all others as drawn.
    pub section: Paving,
    /// For some positions of the others.
    pub projection: Paving,
}

/// The tied set.
pub struct TiedReport<'a> {
    /// The row.
    pub row: &'a PlanarRow,
    /// What was asked.
    pub window: PavingWindow,
    /// Half the side of the proved cube of velocities, the given one kept.
    pub velocities: f64,
    /// Half the side of the proved cube of start positions.
    pub positions: f64,
    /// Every moving point.
    pub paved: Vec<PavedPoint>,
    /// Unit of length.
    pub unit: String,
}

impl TiedReport<'_> {
    /// The dyad whose bars are closest to collinear, and its angle.
    fn narrowest_dyad(&self) -> Option<(String, f64)> {
        let chain = &self.row.chain;
        let angle = |k: usize| {
            let a = chain.angle(&chain.dyads[k]);
            a.min(PI - a)
        };
        let least = (0..chain.dyads.len()).min_by(|a, b| angle(*a).total_cmp(&angle(*b)))?;
        Some((
            self.row.names[chain.dyads[least].point].clone(),
            angle(least),
        ))
    }

    /// For people.
    pub fn text(&self) -> String {
        let least = self.window.least * 180.0 / PI;
        let mut text = format!(
            "Start positions for which the bars of every dyad are at least {} deg from one line\n",
            six_digits(least)
        );
        if let Some((name, angle)) = self.narrowest_dyad() {
            let degrees = angle * 180.0 / PI;
            let word = match angle < self.window.least {
                true => ": the pose itself is not in the set",
                false => "",
            };
            text += &format!("  narrowest at the pose: dyad {name} with {degrees:.4} deg{word}\n");
        }
        let cube = |half: f64| match half > 0.0 {
            true => format!("half width {} about those of the pose", not_below(half, 7)),
            false => "none".to_owned(),
        };
        text += &format!(
            "  proved cube of velocities: {}\n  proved cube of positions [{}]: {}\n",
            cube(self.velocities),
            self.unit,
            cube(self.positions)
        );
        let heads = [
            "point",
            "section inside",
            "edge",
            "projection inside",
            "edge",
        ];
        let mut rows = vec![heads.map(str::to_owned).to_vec()];
        for paved in &self.paved {
            let shares = [paved.section.shares(), paved.projection.shares()];
            let cells = shares
                .iter()
                .flatten()
                .map(|v| format!("{:.2} %", 100.0 * v));
            let name = self.row.names[paved.point].clone();
            rows.push([name].into_iter().chain(cells).collect());
        }
        text += &format!(
            "Squares of {} {} about every point, paved: inside is proved, and so is outside; the edge is open\n{}\
             Section: the other points as drawn. Projection: the others anywhere in their squares, some place of them suffices.\n",
            six_digits(2.0 * self.window.reach),
            self.unit,
            aligned_rows(&rows)
        );
        text
    }

    /// For machines.
    pub fn document(&self) -> Value {
        let cells = |paving: &Paving| {
            let list = |cells: &[crate::intervals::paving::PavedSquare]| {
                let rows = cells.iter().map(|c| [c.middle[0], c.middle[1], c.half]);
                rows.collect::<Vec<_>>()
            };
            json!({ "inner": list(&paving.inner), "edge": list(&paving.edge), "shares": paving.shares() })
        };
        let paved = self.paved.iter().map(|p| {
            json!({
                "point": self.row.names[p.point],
                "section": cells(&p.section),
                "projection": cells(&p.projection),
            })
        });
        json!({
            "schema": document_schema(),
            "derived": "tied",
            "least": self.window.least,
            "reach": self.window.reach,
            "cube_of_velocities": self.velocities,
            "cube_of_positions": self.positions,
            "paved": paved.collect::<Vec<_>>(),
        })
    }
}

/// A cube as intervals, for the document of the method of the centre.
pub fn centre_document(
    centre: &[f64],
    tolerance: f64,
    (radius, united): (f64, f64),
    sides: [f64; 2],
) -> Value {
    let cube = |r: f64| {
        (r > 0.0).then(|| {
            let sides = centre.iter().map(|c| Kaucher::new(c - r, c + r));
            sides.map(|k| [k.lo, k.hi]).collect::<Vec<_>>()
        })
    };
    json!({
        "schema": document_schema(),
        "derived": "centre",
        "half_widths_of_sides": sides,
        "centre": centre,
        "functional": tolerance,
        "tolerable_radius": radius,
        "tolerable_cube": cube(radius),
        "united_radius": united,
        "united_cube": cube(united),
    })
}
