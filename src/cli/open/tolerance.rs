//! Opening a tolerance study that is divided into units: the scene, the varied dimensions, and the plan that identifies
//! its parts.

use super::planned::{
    SCENE_FILE, mesh_bytes, mesh_folder, planned_text, refuse_table, scene_arguments,
};
use super::scene::text_of;
use super::study::nominal_of;
use crate::analysis::piece_sums::PieceSums;
use crate::analysis::study::{DefaultVariables, LoadedStudy, varied_names};
use crate::analysis::tolerance::{Distribution, SampleBatch};
use crate::cli::args::study::{DistributionArg, ScatterArgs};
use crate::cli::term::Term;
use crate::cli::term::outcome::Failure;
use crate::diag::Source;
use crate::parts::identity::identity;
use crate::parts::plan::{PartContent, StudyPlan, VERSION};
use crate::scene::Overrides;
use std::path::Path;

/// The verb, as plans name it.
pub const VERB: &str = "tolerance";

/// A tolerance study that is ready.
pub struct OpenTolerance {
    /// The study.
    pub loaded: LoadedStudy,
    /// Default tolerance of the variables, in the file's units.
    pub general: Option<f64>,
    /// Distribution of the pieces; their numbers are those of a unit.
    pub batch: SampleBatch,
    /// Identifies its parts; a single unit at first.
    pub plan: StudyPlan,
    /// Files that belong beside the plan.
    pub files: Vec<(&'static str, Vec<u8>)>,
}

/// The distribution requested on the command line.
pub fn batch_of(
    scatter: &ScatterArgs,
    samples: usize,
    first: usize,
    threads: usize,
) -> SampleBatch {
    SampleBatch {
        samples,
        first,
        seed: scatter.seed,
        distribution: match scatter.distribution {
            DistributionArg::Uniform => Distribution::Uniform,
            DistributionArg::Normal => Distribution::Normal,
        },
        threads,
    }
}

/// Opens the study of `pieces` described by the command line.
pub fn open_tolerance(
    scatter: &ScatterArgs,
    pieces: u64,
    term: &Term,
) -> Result<OpenTolerance, Failure> {
    let (source, overrides) = text_of(&scatter.scene)?;
    open(scatter, source, overrides, pieces, term)
}

/// Opens the study of a plan whose files lie in `folder`; its arguments were read from the plan.
pub fn open_planned(
    scatter: &ScatterArgs,
    plan: &StudyPlan,
    folder: &Path,
    term: &Term,
) -> Result<OpenTolerance, Failure> {
    let (source, overrides) = planned_text(&scatter.scene, plan, folder)?;
    open(scatter, source, overrides, plan.items, term)
}

fn open(
    scatter: &ScatterArgs,
    source: Source,
    overrides: Overrides,
    pieces: u64,
    term: &Term,
) -> Result<OpenTolerance, Failure> {
    refuse_table(&scatter.scene, "a study in units")?;
    let (source, overrides, nominal) = nominal_of(&scatter.scene, source, overrides, term)?;
    let names = varied_names(
        &scatter.vary.vary,
        DefaultVariables::WithTolerance,
        &nominal,
    )?;
    let arguments = arguments_of(scatter);
    let scene_bytes = source.text.clone().into_bytes();
    // The number of pieces is not part of it: the first ones of a larger number are the same.
    let identity = identity(&[
        ("verb", VERB.as_bytes()),
        ("scene", &scene_bytes),
        ("meshes", &mesh_bytes(&nominal.mechanism)),
        ("arguments", arguments.join("\n").as_bytes()),
    ]);
    let (scene, meshes) = (source.name.clone(), mesh_folder(&overrides));
    let loaded = LoadedStudy::new(source, overrides, &names)?;
    let plan = StudyPlan {
        verb: VERB.to_owned(),
        arguments,
        scene,
        meshes,
        identity,
        version: VERSION.to_owned(),
        items: pieces,
        unit: pieces,
        keeps: PartContent::Sums,
        width: PieceSums::width(loaded.family.measures.list.len()) as u64,
    };
    Ok(OpenTolerance {
        loaded,
        general: scatter.tolerance,
        batch: batch_of(scatter, 0, 0, 1),
        plan,
        files: vec![(SCENE_FILE, scene_bytes)],
    })
}

/// The arguments on which the numbers of a piece depend, as they are read again.
fn arguments_of(scatter: &ScatterArgs) -> Vec<String> {
    let mut list = scene_arguments(&scatter.scene);
    if !scatter.vary.vary.is_empty() {
        list.push(format!("--vary={}", scatter.vary.vary.join(",")));
    }
    if let Some(tolerance) = scatter.tolerance {
        list.push(format!("--tolerance={tolerance:?}"));
    }
    let distribution = match scatter.distribution {
        DistributionArg::Uniform => "uniform",
        DistributionArg::Normal => "normal",
    };
    list.push(format!("--distribution={distribution}"));
    list.push(format!("--seed={}", scatter.seed));
    list
}
