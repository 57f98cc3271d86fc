//! Solids whose shapes depend on the variables of a study: the scene is read again with other values, so that distances
//! of bodies follow their shapes as well as their placements.

use crate::diag::Source;
use crate::distance::solids::Rigid;
use crate::math::Pose;
use crate::model::distance::{NearestPoints, Solids};
use crate::model::mechanism::{Body, Mechanism, OutputSource};
use crate::model::study::Variable;
use crate::scene::{Overrides, load_scene};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// Number of shapes that are cached; a gradient needs two per variable.
const KEPT: usize = 64;

/// The scene of a study, as it is read with other values.
#[derive(Clone, Debug)]
pub(super) struct Reading {
    pub(super) source: Source,
    /// Without what is varied.
    pub(super) overrides: Overrides,
    /// What is varied, and from internal values to the file's.
    pub(super) variables: Vec<(Variable, f64)>,
    /// The coordinate of the first variable; the others follow.
    pub(super) first: usize,
}

impl Reading {
    fn bodies(&self, values: &[f64]) -> Option<Vec<Body>> {
        let mut overrides = self.overrides.clone();
        for ((variable, unit), value) in self.variables.iter().zip(values) {
            overrides
                .parameters
                .retain(|(name, _)| *name != variable.name);
            let text = format!("{:?}", value * unit);
            overrides.parameters.push((variable.name.clone(), text));
        }
        overrides.outside_ranges = true;
        let scene = load_scene(&self.source, &overrides).ok()?;
        Some(scene.mechanism.bodies.clone())
    }
}

/// Makes the distances of a mechanism follow the shapes of its bodies; `shaped_by` has for every body the variables that appear in
/// its shapes.
pub(super) fn follow(mechanism: &mut Mechanism, reading: &Reading, shaped_by: &[Vec<usize>]) {
    for output in &mut mechanism.outputs {
        let OutputSource::Distance(distance) = &mut output.source else {
            continue;
        };
        for gap in &mut distance.gaps {
            let both = gap.bodies.iter().filter_map(|body| shaped_by.get(*body));
            let mut own: Vec<usize> = both.flatten().map(|k| reading.first + k).collect();
            own.sort_unstable();
            own.dedup();
            if !own.is_empty() {
                gap.solids = Arc::new(Reshaped {
                    reading: reading.clone(),
                    bodies: gap.bodies,
                    shapes: gap.shapes.clone(),
                    shaped_by: own,
                    known: Mutex::default(),
                });
            }
        }
    }
}

/// Values, and the solids with them; none if the scene cannot be read.
type KnownSolids = (Vec<f64>, Option<Arc<Rigid>>);

/// Two bodies whose shapes follow the variables.
#[derive(Debug)]
struct Reshaped {
    reading: Reading,
    bodies: [usize; 2],
    shapes: Vec<[usize; 2]>,
    shaped_by: Vec<usize>,
    known: Mutex<VecDeque<KnownSolids>>,
}

impl Reshaped {
    fn solids(&self, values: &[f64]) -> Option<Arc<Rigid>> {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, solids)) = known.iter().find(|(other, _)| other == values) {
            return solids.clone();
        }
        let bodies = self.reading.bodies(values);
        let rigid = bodies.and_then(|all| Rigid::new(self.bodies.map(|k| &all[k]), &self.shapes));
        let solids = rigid.map(Arc::new);
        if known.len() == KEPT {
            known.pop_front();
        }
        known.push_back((values.to_vec(), solids.clone()));
        solids
    }
}

impl Solids for Reshaped {
    fn nearest(&self, coordinates: &[f64], first_from_second: &Pose) -> Option<NearestPoints> {
        let first = self.reading.first;
        let values = &coordinates[first..first + self.reading.variables.len()];
        self.solids(values)?.nearest(coordinates, first_from_second)
    }

    fn shaped_by(&self) -> &[usize] {
        &self.shaped_by
    }
}
