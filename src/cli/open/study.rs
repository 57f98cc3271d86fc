//! Shared by the verbs on studies: opening a family, and its variables as parameters of the scene file.

use super::{inputs_table, mode, scene as open_scene};
use crate::analysis::enclosure::PieceTolerances;
use crate::analysis::study::{
    DefaultVariables, FamilyError, LoadedStudy, ParametricMechanism, varied_names,
};
use crate::cli::args::scene::SceneArgs;
use crate::cli::args::study::VaryArgs;
use crate::cli::term::Term;
use crate::cli::term::outcome::Failure;
use crate::diag::Source;
use crate::kinematics::structure::system::System;
use crate::model::measure::{Measure, MeasureSource};
use crate::scene::{Overrides, Scene, load_scene};
use std::sync::Arc;

/// Reads the scene; `all_by_default` decides what is varied by default.
pub fn open_study(
    scene: &SceneArgs,
    vary: &VaryArgs,
    default: DefaultVariables,
    term: &Term,
) -> Result<LoadedStudy, Failure> {
    open_search(scene, vary, (default, None), term)
}

/// The same for a study whose objective may differ from the file's.
pub fn open_search(
    scene: &SceneArgs,
    vary: &VaryArgs,
    (default, minimise): (DefaultVariables, Option<&str>),
    term: &Term,
) -> Result<LoadedStudy, Failure> {
    let (source, mut overrides) = open_scene::text_of(scene)?;
    overrides.minimise = minimise.map(str::to_owned);
    let (source, overrides, nominal) = nominal_of(scene, source, overrides, term)?;
    let names = varied_names(&vary.vary, default, &nominal)?;
    Ok(LoadedStudy::new(source, overrides, &names)?)
}

/// The scene without variables.
pub fn nominal_source(
    scene: &SceneArgs,
    term: &Term,
) -> Result<(Source, Overrides, Scene), Failure> {
    let (source, overrides) = open_scene::text_of(scene)?;
    nominal_of(scene, source, overrides, term)
}

/// The same for a text that has already been read.
pub fn nominal_of(
    scene: &SceneArgs,
    source: Source,
    mut overrides: Overrides,
    term: &Term,
) -> Result<(Source, Overrides, Scene), Failure> {
    let mut nominal = load_scene(&source, &overrides).map_err(Box::new)?;
    apply_variables(scene, &mut nominal, &mut overrides, term)?;
    term.diagnostics(&source, &nominal.warnings);
    Ok((source, overrides, nominal))
}

/// Applies `--input-table` and `--mode`.
fn apply_variables(
    args: &SceneArgs,
    scene: &mut Scene,
    overrides: &mut Overrides,
    term: &Term,
) -> Result<(), Failure> {
    let (mechanism, actuation) = (&scene.mechanism, &mut scene.actuation);
    if let Some(path) = &args.table {
        let along_drive = |m: &Measure| matches!(m.source, MeasureSource::Over { track: None, .. });
        if !scene.measures.list.iter().any(along_drive) {
            return Err(Failure::usage(
                "every measure follows a track, so --input-table would have no effect",
                vec!["a measure without `track` follows the drive".to_owned()],
            ));
        }
        let warning = inputs_table::apply_inputs(mechanism, actuation, path)?;
        warning.into_iter().for_each(|text| term.warning(&text));
    }
    if let Some(choice) = &args.mode {
        let system = System::new(Arc::clone(mechanism), actuation)?;
        actuation.guess = mode::start_of(&system, actuation, choice)?;
    }
    open_scene::keep_variables(args, scene, overrides);
    Ok(())
}

impl From<FamilyError> for Failure {
    fn from(error: FamilyError) -> Self {
        match error {
            FamilyError::Scene(error) => Self::Scene(error),
            FamilyError::Structure(error) => Self::Structure(error),
            FamilyError::NoTolerance(_) => without_tolerance(error.to_string(), "--tolerance 0.1"),
            FamilyError::Track { .. } => Self::Undecided {
                message: error.to_string(),
                hints: vec![
                    "`mechanim solve` and `mechanim modes` show where the mechanism closes"
                        .to_owned(),
                ],
            },
            other => Self::usage(other.to_string(), Vec::from_iter(other.hint())),
        }
    }
}

/// The family of all requested pieces, and their tolerances by name in internal units. `option` is the one that gives
/// all dimensions a tolerance.
pub fn open_pieces(
    asked: &PieceTolerances,
    option: &str,
    (source, overrides, drawn): (&Source, &Overrides, &Scene),
) -> Result<(ParametricMechanism, Vec<(String, f64)>), Failure> {
    let found = asked.family(source, overrides, drawn);
    found.map_err(|error| match error {
        FamilyError::NoTolerance(_) => {
            let ways = format!("{option} 0.1, one of them with --param NAME=880+-0.2");
            without_tolerance(error.to_string(), &ways)
        }
        other => other.into(),
    })
}

fn without_tolerance(message: String, ways: &str) -> Failure {
    let hint = format!(
        "give one for all with {ways}, or each its own: `[study.variables]` NAME = {{ tolerance = 0.1 }}"
    );
    Failure::usage(message, vec![hint])
}
