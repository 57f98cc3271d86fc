//! What the verbs on studies share: opening a family, and its variables as parameters of the scene file.

use super::{inputs_table, mode, scene as open_scene};
use crate::analysis::study::{Evaluator, FamilyError, ParametricMechanism, Rejection, TrackPoses};
use crate::cli::args::scene::SceneArgs;
use crate::cli::args::study::VaryArgs;
use crate::cli::term::Term;
use crate::cli::term::outcome::Failure;
use crate::diag::Source;
use crate::kinematics::structure::system::System;
use crate::model::measure::{Measure, MeasureSource};
use crate::scene::{OtherDrives, Overrides, Scene, load_scene};
use std::sync::Arc;

/// A scene that is to be studied.
pub struct Opened {
    /// Its text.
    pub source: Source,
    /// What the command line changes in it.
    pub overrides: Overrides,
    /// With its variables as inputs.
    pub family: ParametricMechanism,
}

/// Stands for every dimension.
const ALL: &str = "all";

/// Reads the scene; `all_by_default` decides what is varied where nothing is said.
pub fn open_study(
    scene: &SceneArgs,
    vary: &VaryArgs,
    all_by_default: bool,
    term: &Term,
) -> Result<Opened, Failure> {
    let (source, overrides, nominal) = nominal_source(scene, term)?;
    let names = varied_names(vary, all_by_default, nominal)?;
    let family = ParametricMechanism::load(&source, &overrides, &names)?;
    Ok(Opened {
        source,
        overrides,
        family,
    })
}

/// The scene as it is without variables.
pub fn nominal_source(
    scene: &SceneArgs,
    term: &Term,
) -> Result<(Source, Overrides, Scene), Failure> {
    let (source, mut overrides) = open_scene::text_of(scene)?;
    let mut nominal = load_scene(&source, &overrides).map_err(Box::new)?;
    apply_variables(scene, &mut nominal, &mut overrides)?;
    term.diagnostics(&source, &nominal.warnings);
    Ok((source, overrides, nominal))
}

/// What `--vary` names.
pub fn varied_names(
    vary: &VaryArgs,
    all_by_default: bool,
    nominal: Scene,
) -> Result<Vec<String>, Failure> {
    let all = vary.vary.iter().any(|v| v == ALL) || (vary.vary.is_empty() && all_by_default);
    let mut names = if all { nominal.dimensions } else { Vec::new() };
    // What stands beside `all` may be one of them.
    let named = vary.vary.iter().filter(|name| *name != ALL);
    let more: Vec<_> = named.filter(|n| !(all && names.contains(n))).collect();
    names.extend(more.into_iter().cloned());
    for (k, name) in names.iter().enumerate() {
        if names[..k].contains(name) {
            return Err(Failure::usage(
                format!("`{name}` is to be varied twice"),
                Vec::new(),
            ));
        }
    }
    Ok(names)
}

/// `--inputs` and `--mode` as changes of the scene, so that they hold wherever it is read again.
fn apply_variables(
    args: &SceneArgs,
    scene: &mut Scene,
    overrides: &mut Overrides,
) -> Result<(), Failure> {
    let (mechanism, actuation) = (&scene.mechanism, &mut scene.actuation);
    if let Some(path) = &args.table {
        let along_drive = |m: &Measure| matches!(m.source, MeasureSource::Over { track: None, .. });
        if !scene.measures.list.iter().any(along_drive) {
            return Err(Failure::usage(
                "all measures of the scene look along tracks: --inputs would change nothing",
                vec!["a measure without `track` looks along the drive".to_owned()],
            ));
        }
        inputs_table::apply_inputs(mechanism, actuation, path)?;
        overrides.drives = Some(OtherDrives {
            drives: actuation.drives.clone(),
            duration: actuation.duration,
        });
    }
    if let Some(choice) = &args.mode {
        let system = System::new(Arc::clone(mechanism), actuation)?;
        let guess = mode::start_of(&system, actuation, choice)?;
        let start = mechanism.unknowns.iter().zip(&guess);
        overrides.guess = start
            .map(|(unknown, value)| {
                let value = value * mechanism.file_units(unknown.kind);
                (unknown.name.clone(), format!("{value:?}"))
            })
            .collect();
    }
    Ok(())
}

impl From<FamilyError> for Failure {
    fn from(error: FamilyError) -> Self {
        match error {
            FamilyError::Scene(error) => Self::Scene(error),
            FamilyError::Structure(error) => Self::Structure(error),
            FamilyError::Lacks(message) => Self::usage(message, Vec::new()),
            FamilyError::Track { .. } => Self::NeverClosed {
                message: error.to_string(),
                hints: vec![
                    "`mechanim solve` and `mechanim modes` show where the mechanism closes"
                        .to_owned(),
                ],
            },
        }
    }
}

impl Opened {
    /// What is said of a stand that cannot be studied.
    pub fn refused(
        &self,
        evaluator: &Evaluator,
        stand: &TrackPoses,
        refusal: &Rejection,
    ) -> Failure {
        let why = match refusal {
            Rejection::NoValue(name) => evaluator.why(stand, name),
            Rejection::NotReached { .. } | Rejection::Torn { .. } => String::new(),
        };
        let message = format!("at the file's own values: {refusal}{why}");
        Failure::usage(message, Vec::new())
    }

    /// Index of the measure of that name.
    pub fn measure(&self, name: &str) -> Result<usize, Failure> {
        let measures = &self.family.measures.list;
        measures.iter().position(|m| m.name == name).ok_or_else(|| {
            let names: Vec<&str> = measures.iter().map(|m| m.name.as_str()).collect();
            Failure::usage(
                format!("the scene has no measure `{name}`"),
                vec![format!("measures: {}", names.join(", "))],
            )
        })
    }

    /// Values of the variables as formulas of the file, with what the command line replaced before them.
    pub fn parameters(&self, values: &[f64]) -> Vec<(String, String)> {
        let mut list = self.overrides.parameters.clone();
        for (variable, value) in self.family.study.variables.iter().zip(values) {
            list.retain(|(name, _)| *name != variable.name);
            let value = value * self.family.units(variable.kind);
            list.push((variable.name.clone(), format!("{value:?}")));
        }
        list
    }
}
