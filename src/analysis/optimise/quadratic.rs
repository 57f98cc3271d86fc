//! Convex quadratic programmes of a few variables under many inequalities: min ½ zᵀQz + cᵀz, Gz ≤ g, by Mehrotra's
//! predictor-corrector interior-point method (Nocedal and Wright, Numerical Optimization, 2nd ed., 16.6). A linear
//! programme is one with Q = 0.

use nalgebra::{DMatrix, DVector};

/// A programme; its numbers should be of order one.
#[derive(Clone, Debug)]
pub struct QuadraticProgramme {
    /// Q, symmetric and positive semidefinite.
    pub bend: DMatrix<f64>,
    /// c
    pub cost: DVector<f64>,
    /// G; every variable must be bounded by its rows in directions without curvature.
    pub rows: DMatrix<f64>,
    /// g
    pub ends: DVector<f64>,
}

/// Its answer.
#[derive(Clone, Debug)]
pub struct QuadraticStep {
    /// z
    pub point: DVector<f64>,
    /// A multiplier for every row, none negative.
    pub multipliers: DVector<f64>,
}

/// Mean product of slack and multiplier, and largest residual, at which a point is good enough.
const GAP: f64 = 1e-11;
const RESIDUAL: f64 = 1e-9;

/// Residual up to which a stalled programme can still be used.
const USABLE: f64 = 1e-5;

const MOST_ITERATIONS: usize = 60;

/// Fraction of the distance to the boundary.
const INSIDE: f64 = 0.995;

/// A point with its slacks and multipliers.
struct InteriorPoint {
    z: DVector<f64>,
    slack: DVector<f64>,
    multipliers: DVector<f64>,
}

/// Right-hand sides of the Newton system: of the gradient, of the rows, of the products.
struct NewtonResiduals {
    dual: DVector<f64>,
    primal: DVector<f64>,
}

impl QuadraticProgramme {
    /// Solves from the point `start`; `None` if the iterates diverge.
    pub fn solve(&self, start: DVector<f64>) -> Option<QuadraticStep> {
        let rows = self.ends.len();
        let gap = &self.ends - &self.rows * &start;
        let mut here = InteriorPoint {
            slack: gap.map(|s| s.max(0.1)),
            multipliers: DVector::from_element(rows, 1.0 / (rows as f64).max(1.0)),
            z: start,
        };
        for _ in 0..MOST_ITERATIONS {
            // One predictor-corrector step from the residuals of the optimality conditions.
            let residuals = self.residuals(&here);
            if here.gap() < GAP && residuals.largest() < RESIDUAL {
                break;
            }
            let next = self.step(&here, &residuals)?;
            if !next.z.iter().all(|v| v.is_finite()) {
                return None;
            }
            here = next;
        }
        let usable = here.gap() < USABLE && self.residuals(&here).largest() < USABLE;
        usable.then_some(QuadraticStep {
            point: here.z,
            multipliers: here.multipliers,
        })
    }

    fn residuals(&self, here: &InteriorPoint) -> NewtonResiduals {
        let dual = &self.bend * &here.z + &self.cost + self.rows.tr_mul(&here.multipliers);
        NewtonResiduals {
            dual,
            primal: &self.rows * &here.z + &here.slack - &self.ends,
        }
    }

    fn step(&self, here: &InteriorPoint, residuals: &NewtonResiduals) -> Option<InteriorPoint> {
        let count = here.slack.len();
        let weights = here.multipliers.component_div(&here.slack);
        let mut weighted = self.rows.clone();
        for (k, mut row) in weighted.row_iter_mut().enumerate() {
            row *= weights[k];
        }
        let normal = (&self.bend + self.rows.tr_mul(&weighted)).cholesky()?;
        // Direction for the products s λ to become `wanted`.
        let direction = |wanted: &DVector<f64>| {
            let products = wanted - here.slack.component_mul(&here.multipliers);
            let shift = (here.multipliers.component_mul(&residuals.primal) + products)
                .component_div(&here.slack);
            let dz = normal.solve(&(-&residuals.dual - self.rows.tr_mul(&shift)));
            let ds = -&residuals.primal - &self.rows * &dz;
            let dl = (wanted
                - here.slack.component_mul(&here.multipliers)
                - here.multipliers.component_mul(&ds))
            .component_div(&here.slack);
            (dz, ds, dl)
        };
        let (_, ds, dl) = direction(&DVector::zeros(count));
        let (along_slack, along_multipliers) = (
            step_room(&here.slack, &ds),
            step_room(&here.multipliers, &dl),
        );
        let affine = (&here.slack + &ds * along_slack)
            .dot(&(&here.multipliers + &dl * along_multipliers))
            / count as f64;
        let centring = (affine / here.gap()).powi(3) * here.gap();
        let (dz, ds, dl) = direction(&ds.zip_map(&dl, |s, l| centring - s * l));
        let length = step_room(&here.slack, &ds).min(step_room(&here.multipliers, &dl));
        let length = (INSIDE * length).min(1.0);
        Some(InteriorPoint {
            z: &here.z + dz * length,
            slack: &here.slack + ds * length,
            multipliers: &here.multipliers + dl * length,
        })
    }
}

impl InteriorPoint {
    fn gap(&self) -> f64 {
        self.slack.dot(&self.multipliers) / (self.slack.len() as f64).max(1.0)
    }
}

impl NewtonResiduals {
    fn largest(&self) -> f64 {
        self.dual.amax().max(self.primal.amax())
    }
}

/// Longest step along `change` for which all `values` stay positive; at most a full step.
fn step_room(values: &DVector<f64>, change: &DVector<f64>) -> f64 {
    let pairs = values.iter().zip(change.iter());
    let limits = pairs.filter(|(_, d)| **d < 0.0).map(|(v, d)| -v / d);
    limits.fold(1.0 / INSIDE, f64::min).min(1.0 / INSIDE)
}
