//! A row of the table, and the motion that its scene makes.

use crate::driven::{
    Driven, Model, add_derivatives, add_limits, even_times, feasible_inputs, solve,
};
use mechanim::diag::Source;
use mechanim::kinematics::assemblies::{DEFAULT_STARTS, Mode, Modes, find_modes};
use mechanim::kinematics::rates::columns::{RateColumns, RateVariable};
use mechanim::kinematics::results::trajectory::{ClosedPose, EventKind, Trajectory};
use mechanim::scene::{Overrides, load_scene};

/// What is compared: words, our number, the known one.
pub type Answer = (String, f64, f64);

/// How the poses of a row are proved.
#[derive(Clone, Copy)]
pub enum Proof {
    Certified,
    /// Over-constrained: redundant equations are bounded.
    Consistent,
}

/// One mechanism.
pub struct Row {
    pub name: &'static str,
    pub source: &'static str,
    /// The known answer in words or as a formula.
    pub answer: &'static str,
    pub scene: String,
    pub samples: usize,
    /// Largest difference of any answer.
    pub within: f64,
    /// Mobility by count.
    pub count: i64,
    /// Mobility by rank.
    pub rank: usize,
    /// Placements at the first sample, where the number is known.
    pub assemblies: Option<usize>,
    pub proof: Proof,
    pub answers: fn(&Motion) -> Vec<Answer>,
    /// A piece of the scene and what to replace it by, so that the known answer is missed.
    pub planted: Option<(&'static str, &'static str)>,
}

impl Row {
    /// A certified mechanism with one freedom and nine samples.
    pub fn new(name: &'static str, source: &'static str, answer: &'static str) -> Self {
        Self {
            name,
            source,
            answer,
            scene: String::new(),
            samples: 9,
            within: 1e-13,
            count: 1,
            rank: 1,
            assemblies: None,
            proof: Proof::Certified,
            answers: |_| Vec::new(),
            planted: None,
        }
    }
}

/// The solved motion of a row.
pub struct Motion {
    pub model: Model,
    pub trajectory: Trajectory,
}

impl Motion {
    pub fn of(row: &Row) -> Self {
        let source = Source {
            name: row.name.to_owned(),
            text: row.scene.clone(),
        };
        let loaded = load_scene(&source, &Overrides::default());
        let model = Model::from(loaded.unwrap_or_else(|e| panic!("{:#?}", e.diagnostics)));
        let mut trajectory = solve(&model, &even_times(&model, row.samples))
            .unwrap_or_else(|e| panic!("{}: {e}", row.name));
        let columns = RateColumns {
            order: 2,
            by: RateVariable::Input(0),
        };
        add_derivatives(&model, &mut trajectory, columns);
        Self { model, trajectory }
    }

    pub fn poses(&self) -> Vec<At<'_>> {
        let samples = self.trajectory.samples.iter();
        let pose = |k| At {
            motion: self,
            sample: k,
        };
        samples.enumerate().map(|(k, _)| pose(k)).collect()
    }

    /// The same comparison at every pose.
    pub fn each(&self, answers: impl Fn(At<'_>) -> Vec<(&'static str, f64, f64)>) -> Vec<Answer> {
        let mut all = Vec::new();
        for at in self.poses() {
            for (what, found, known) in answers(at) {
                all.push((format!("{what} at sample {}", at.sample), found, known));
            }
        }
        all
    }

    /// All assemblies at the first sample.
    pub fn modes(&self) -> Modes {
        let system = self.model.system().unwrap();
        let first = self.model.actuation.start_at(0.0);
        find_modes(&system, &first, &[], DEFAULT_STARTS, &|| false)
    }

    /// Whether some assembly has these unknowns, angles up to whole turns.
    pub fn has_mode(&self, modes: &Modes, wanted: &[(&str, f64)]) -> bool {
        let is = |mode: &Mode| {
            let near = |(name, value): &(&str, f64)| {
                turned(mode.coordinates[self.unknown(name).unwrap()] - value).abs() < 1e-9
            };
            wanted.iter().all(near)
        };
        modes.list.iter().any(is)
    }

    fn unknown(&self, name: &str) -> Option<usize> {
        self.model.unknowns.iter().position(|u| u.name == name)
    }

    /// Limit positions of a coordinate: input and value.
    pub fn limits(&self, coordinate: &str) -> Vec<[f64; 2]> {
        let mut trajectory = self.trajectory.clone();
        add_limits(&self.model, &mut trajectory);
        let events = trajectory.events.iter();
        let limits = events.filter_map(|event| match &event.kind {
            EventKind::LimitPosition { name, value, .. } if name == coordinate => {
                Some([event.inputs[0], *value])
            }
            _ => None,
        });
        limits.collect()
    }

    /// The feasible stretch of the first input that holds `value`.
    pub fn feasible(&self, value: f64) -> [f64; 2] {
        let found = feasible_inputs(&self.model);
        let stretch = found[0]
            .stretches
            .iter()
            .find(|s| s[0] <= value && value <= s[1]);
        *stretch.unwrap_or_else(|| panic!("{found:?}"))
    }
}

/// One pose of a motion.
#[derive(Clone, Copy)]
pub struct At<'m> {
    motion: &'m Motion,
    pub sample: usize,
}

impl At<'_> {
    pub fn pose(&self) -> &ClosedPose {
        self.motion.trajectory.samples[self.sample]
            .pose
            .as_ref()
            .unwrap()
    }

    /// An input, unknown or output by its name; `P.x` of a trace.
    pub fn get(&self, name: &str) -> f64 {
        let model = &self.motion.model;
        if let Some(k) = model.inputs.iter().position(|i| i.name == name) {
            return self.motion.trajectory.samples[self.sample].inputs[k];
        }
        if let Some(k) = self.motion.unknown(name) {
            return self.pose().unknowns[k];
        }
        if let Some((trace, axis)) = name.split_once('.') {
            let k = model.traces.iter().position(|t| t.name == trace).unwrap();
            return self.pose().traces[k]["xyz".find(axis).unwrap()];
        }
        let k = model.outputs.iter().position(|o| o.name == name);
        self.pose().outputs[k.unwrap_or_else(|| panic!("no `{name}`"))]
    }

    /// Transfer function of an unknown by the first input, of first or second order.
    pub fn rate(&self, name: &str, order: usize) -> f64 {
        self.pose().derivatives[2 * self.motion.unknown(name).unwrap() + order - 1]
    }
}

/// An angle less whole turns.
pub fn turned(angle: f64) -> f64 {
    angle - std::f64::consts::TAU * (angle / std::f64::consts::TAU).round()
}
