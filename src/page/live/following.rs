//! Follows a mechanism from a pose at one value of a parameter to another value: the parameter becomes an input, so
//! that the assembly is kept, or the place where the motion ends is known.

use crate::analysis::study::{FamilyError, ParametricMechanism};
use crate::diag::Source;
use crate::kinematics::motion::continuation::solve_until;
use crate::kinematics::results::trajectory::{EventKind, Trajectory};
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::mechanism::{Kind, Mechanism};
use crate::model::printed::InputReading;
use crate::report::sentences::with_unit;
use crate::scene::Overrides;

/// The values of the unknowns of a pose by their names: radians, or the scene's unit of length.
pub(super) type NamedPose = Vec<(String, f64)>;

/// Where a way leads.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum FollowEnd {
    /// To the value asked for, in the same assembly.
    Reached(NamedPose),
    /// Only up to this value, with the reason.
    Stopped {
        /// In the file's unit.
        at: f64,
        /// In words.
        why: String,
    },
}

/// A mechanism with one of its parameters as an input, kept while the same slider is moved.
pub(super) struct Follower {
    name: String,
    /// Replaced values of other parameters.
    others: Vec<(String, String)>,
    family: ParametricMechanism,
}

impl Follower {
    /// Makes it.
    ///
    /// Errors: a parameter that cannot be an input of the mechanism.
    pub fn new(source: &Source, overrides: &Overrides, name: &str) -> Result<Self, FamilyError> {
        let names = [name.to_owned()];
        Ok(Self {
            name: name.to_owned(),
            others: other_overrides(overrides, name),
            family: ParametricMechanism::varying(source, overrides, &names)?,
        })
    }

    /// Whether it is for this parameter, with the other parameters unchanged.
    pub fn fits(&self, overrides: &Overrides, name: &str) -> bool {
        self.name == name && self.others == other_overrides(overrides, name)
    }

    /// Conversion factor from the file's unit.
    pub fn unit(&self) -> f64 {
        self.kind()
            .map_or(1.0, |kind| 1.0 / self.family.units(kind))
    }

    /// The parameter's own value, in radians for angles.
    pub fn start(&self) -> Option<f64> {
        self.family.study.variables.first().map(|v| v.start)
    }

    fn kind(&self) -> Option<Kind> {
        self.family.study.variables.first().map(|v| v.kind)
    }

    /// Follows a pose at `inputs` from one value of the parameter to another, in file units; `wanted` are the inputs there.
    pub fn way(
        &self,
        (inputs, pose): (&[f64], &NamedPose),
        [from, to]: [f64; 2],
        wanted: &[f64],
    ) -> FollowEnd {
        let mechanism = self.family.mechanism();
        let unit = self.unit();
        let ends = [(inputs, from), (wanted, to)]
            .map(|(inputs, value)| [inputs, &[value * unit]].concat());
        let guess = by_name(mechanism, pose);
        let way = Actuation::straight(&ends[0], &ends[1], guess);
        let motion = follow(self.family.system(), &way);
        match stop_of(&motion) {
            None => match motion.samples.last().and_then(|s| s.pose.as_ref()) {
                Some(end) => FollowEnd::Reached(named_values(mechanism, &end.unknowns)),
                None => self.stopped(from, "no pose was found"),
            },
            Some((share, why)) => self.stopped(from + share * (to - from), why),
        }
    }

    fn stopped(&self, at: f64, why: &str) -> FollowEnd {
        let mechanism = self.family.mechanism();
        let kind = self.kind().unwrap_or(Kind::Number);
        let value = with_unit(mechanism, kind, at * self.unit());
        FollowEnd::Stopped {
            at,
            why: format!("{} = {value}: {why}", self.name),
        }
    }
}

fn other_overrides(overrides: &Overrides, name: &str) -> Vec<(String, String)> {
    let list = overrides.parameters.iter();
    list.filter(|(other, _)| other != name).cloned().collect()
}

/// The values of the unknowns, which come first in `coordinates`, by their names.
pub(super) fn named_values(mechanism: &Mechanism, coordinates: &[f64]) -> NamedPose {
    let names = mechanism.unknowns.iter().map(|c| c.name.clone());
    names.zip(coordinates.iter().copied()).collect()
}

/// A pose's values in the order of a mechanism's unknowns; zero for those that it lacks.
pub(super) fn by_name(mechanism: &Mechanism, pose: &NamedPose) -> Vec<f64> {
    let value = |name: &String| {
        let found = pose.iter().find(|(other, _)| other == name);
        found.map_or(0.0, |(_, value)| *value)
    };
    mechanism.unknowns.iter().map(|c| value(&c.name)).collect()
}

/// A motion of one second, with its ends proved if possible.
pub(super) fn follow(system: &System, way: &Actuation) -> Trajectory {
    motion_until(system, way, &[0.0, 1.0])
}

/// A motion at these times, its poses proved if possible.
pub(super) fn motion_until(system: &System, way: &Actuation, times: &[f64]) -> Trajectory {
    let reading = Some(InputReading::Numbers);
    solve_until(system, way, times, reading, &|| false)
}

/// Where a motion of one second ends or changes its assembly, as a fraction of it, and why; `None` if it reaches its
/// end.
pub(super) fn stop_of(motion: &Trajectory) -> Option<(f64, &'static str)> {
    let why = |kind: &EventKind| match kind {
        EventKind::MotionEnds(ending) if ending.is_undecided() => {
            Some("it could not be followed farther")
        }
        EventKind::MotionEnds(_) => {
            Some("the motion ends here, and this assembly has no pose beyond")
        }
        EventKind::SingularPosePassed | EventKind::StartSingular => {
            Some("a singular pose, behind which another assembly may begin")
        }
        EventKind::InputUndefined { .. } => Some("an input has no value here"),
        EventKind::StartNotClosed { .. }
        | EventKind::OtherStart
        | EventKind::MotionResumes { .. } => Some("no pose was found"),
        _ => None,
    };
    let mut events = motion.events.iter();
    let stop = events.find_map(|event| Some((event.time, why(&event.kind)?)));
    let [first, last] = [motion.samples.first(), motion.samples.last()].map(|s| s?.pose.as_ref());
    match (stop, first, last) {
        (None, Some(first), Some(last)) if motion.is_whole() => {
            (first.branch != last.branch).then_some((0.0, "the assembly changes on the way"))
        }
        (Some(stop), ..) => Some(stop),
        (None, ..) => Some((0.0, "no pose was found")),
    }
}
