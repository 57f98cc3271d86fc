//! Opening a sweep: the scene, the designs, the requested values, and the plan that identifies its rows.

use super::named_table::NamedTable;
use super::planned::{
    SCENE_FILE, cannot_read, mesh_bytes, mesh_folder, planned_text, refuse_table, scene_arguments,
};
use super::scene::text_of;
use super::study::nominal_of;
use crate::analysis::study::DRIVE_SAMPLES;
use crate::cli::args::sweep::SweepRequestArgs;
use crate::cli::term::Term;
use crate::cli::term::outcome::Failure;
use crate::diag::Source;
use crate::kinematics::motion::sampling::allow_samples;
use crate::model::study::{RANGE_ROUNDING, Variable};
use crate::parts::identity::identity;
use crate::parts::plan::{PartContent, StudyPlan, VERSION};
use crate::scene::source::open_input;
use crate::scene::{Overrides, Scene};
use crate::sweep::design::Design;
use crate::sweep::design_text::{OwnRange, is_written_out, read_design};
use crate::sweep::swept_scene::{Instants, RequestedValues, Sweep};
use std::io::Read;
use std::path::Path;

/// The verb, as plans name it.
pub const VERB: &str = "sweep";

/// Instants of values by default.
const OUTPUT_SAMPLES: usize = 60;

/// Name of the table of designs beside a plan.
pub const DESIGN_FILE: &str = "design.csv";

/// Maximum size in bytes of a table of designs, which is read before the run begins.
const LARGEST_TABLE: u64 = 1 << 30;

/// A sweep that is ready.
pub struct OpenSweep {
    /// The sweep.
    pub sweep: Sweep,
    /// Identifies its rows; a single unit at first.
    pub plan: StudyPlan,
    /// Files that belong beside the plan.
    pub files: Vec<(&'static str, Vec<u8>)>,
}

/// Opens the sweep described by the command line.
pub fn open_sweep(asked: &SweepRequestArgs, term: &Term) -> Result<OpenSweep, Failure> {
    let (source, overrides) = text_of(&asked.scene)?;
    let table = match is_written_out(&asked.design) {
        true => None,
        false => Some(read_table(Path::new(&asked.design))?),
    };
    open_source_of(asked, source, overrides, table, term)
}

/// Opens the sweep of a plan whose files lie in `folder`; its arguments were read from the plan.
pub fn open_planned(
    asked: &SweepRequestArgs,
    plan: &StudyPlan,
    folder: &Path,
    term: &Term,
) -> Result<OpenSweep, Failure> {
    let (source, overrides) = planned_text(&asked.scene, plan, folder)?;
    let table = match is_written_out(&asked.design) {
        true => None,
        false => Some(read_table(&folder.join(DESIGN_FILE))?),
    };
    open_source_of(asked, source, overrides, table, term)
}

fn open_source_of(
    asked: &SweepRequestArgs,
    source: Source,
    overrides: Overrides,
    table: Option<Vec<u8>>,
    term: &Term,
) -> Result<OpenSweep, Failure> {
    refuse_table(&asked.scene, "a sweep")?;
    let (source, overrides, nominal) = nominal_of(&asked.scene, source, overrides, term)?;
    let own = own_ranges(&nominal);
    let design = match &table {
        Some(bytes) => table_design(bytes, &asked.design)?,
        None => read_design(&asked.design, &own, asked.seed)
            .map_err(|why| Failure::usage(format!("--design {why}"), Vec::new()))?,
    };
    refuse_beyond(&design, &own)?;
    let wanted = asked_of(asked);
    refuse_instants(&wanted, &nominal)?;
    let arguments = arguments_of(asked);
    let scene_bytes = source.text.clone().into_bytes();
    let meshes = mesh_bytes(&nominal.mechanism);
    let joined = arguments.join("\n");
    let identity = identity(&[
        ("verb", VERB.as_bytes()),
        ("scene", &scene_bytes),
        ("meshes", &meshes),
        ("arguments", joined.as_bytes()),
        ("design", table.as_deref().unwrap_or_default()),
    ]);
    let meshes_folder = mesh_folder(&overrides);
    let mut files = vec![(SCENE_FILE, scene_bytes)];
    files.extend(table.map(|bytes| (DESIGN_FILE, bytes)));
    let name = source.name.clone();
    let sweep = Sweep::new(source, overrides, design, wanted)?;
    let plan = StudyPlan {
        verb: VERB.to_owned(),
        arguments,
        scene: name,
        meshes: meshes_folder,
        identity,
        version: VERSION.to_owned(),
        items: sweep.design.count(),
        unit: sweep.design.count(),
        keeps: PartContent::Items,
        width: sweep.width() as u64,
    };
    Ok(OpenSweep { sweep, plan, files })
}

fn asked_of(asked: &SweepRequestArgs) -> RequestedValues {
    if asked.check {
        return RequestedValues::Check;
    }
    if asked.outputs.is_empty() {
        return RequestedValues::Measures {
            samples: asked.samples.unwrap_or(DRIVE_SAMPLES),
            is_proved: !asked.unproved,
        };
    }
    let at = match asked.at.is_empty() {
        true => Instants::Even(asked.samples.unwrap_or(OUTPUT_SAMPLES)),
        false => Instants::At(asked.at.clone()),
    };
    RequestedValues::Outputs {
        names: asked.outputs.clone(),
        at,
        is_proved: !asked.unproved,
    }
}

/// Refuses instants outside of the motion, and more of them than the limits allow.
fn refuse_instants(asked: &RequestedValues, scene: &Scene) -> Result<(), Failure> {
    let last = scene.actuation.duration;
    let count = match asked {
        RequestedValues::Check => 1,
        RequestedValues::Measures { samples, .. } => *samples,
        RequestedValues::Outputs { at, .. } => match at {
            Instants::Even(count) => *count,
            Instants::At(times) => {
                let ascends = times.windows(2).all(|pair| pair[0] < pair[1]);
                if !ascends || times.iter().any(|t| !(0.0..=last).contains(t)) {
                    let message =
                        format!("the times of --at must increase, from 0 to {last} s at most");
                    return Err(Failure::usage(message, Vec::new()));
                }
                times.len()
            }
        },
    };
    Ok(allow_samples(&scene.mechanism, count)?)
}

/// The arguments on which rows depend, as they are read again; equivalent arguments give the same text.
fn arguments_of(asked: &SweepRequestArgs) -> Vec<String> {
    let mut list = scene_arguments(&asked.scene);
    let design = match is_written_out(&asked.design) {
        true => &asked.design,
        false => DESIGN_FILE,
    };
    list.push(format!("--design={design}"));
    list.push(format!("--seed={}", asked.seed));
    let asked = asked_of(asked);
    if !asked.is_proved() {
        list.push("--unproved".to_owned());
    }
    match asked {
        RequestedValues::Check => list.push("--check".to_owned()),
        RequestedValues::Measures { samples, .. } => list.push(format!("--samples={samples}")),
        RequestedValues::Outputs { names, at, .. } => {
            list.push(format!("--outputs={}", names.join(",")));
            list.push(match at {
                Instants::Even(count) => format!("--samples={count}"),
                Instants::At(times) => {
                    let times: Vec<String> = times.iter().map(|t| format!("{t:?}")).collect();
                    format!("--at={}", times.join(","))
                }
            });
        }
    }
    list
}

/// Ranges of the scene's study, in the file's units; infinite for a variable without one.
fn own_ranges(scene: &Scene) -> Vec<OwnRange> {
    let variables = scene.study.iter().flat_map(|study| &study.variables);
    let range = |v: &Variable| {
        let shown = |value: f64| scene.mechanism.file_value(v.kind, value);
        OwnRange {
            name: v.name.clone(),
            low: shown(v.lower),
            high: shown(v.upper),
        }
    };
    variables.map(range).collect()
}

fn refuse_beyond(design: &Design, own: &[OwnRange]) -> Result<(), Failure> {
    for axis in &design.axes {
        let Some(range) = own.iter().find(|range| range.name == axis.name) else {
            continue;
        };
        let slack = RANGE_ROUNDING * (range.high - range.low);
        if axis.low < range.low - slack || axis.high > range.high + slack {
            let message = format!(
                "the design takes `{}` from {} to {}, and the scene's study allows {} to {}",
                axis.name, axis.low, axis.high, range.low, range.high
            );
            let hint = "its range is defined in [study.variables]";
            return Err(Failure::usage(message, vec![hint.to_owned()]));
        }
    }
    Ok(())
}

fn read_table(path: &Path) -> Result<Vec<u8>, Failure> {
    let file = open_input(path).map_err(|e| {
        let known = "a design is grid:…, lhs:…, sobol:… or the name of a table";
        match cannot_read(path, &e) {
            Failure::Usage { message, .. } => Failure::usage(message, vec![known.to_owned()]),
            other => other,
        }
    })?;
    let mut bytes = Vec::new();
    let read = file.take(LARGEST_TABLE + 1).read_to_end(&mut bytes);
    read.map_err(|e| cannot_read(path, &e))?;
    if bytes.len() as u64 > LARGEST_TABLE {
        let message = format!("{} is larger than {LARGEST_TABLE} bytes", path.display());
        return Err(Failure::usage(message, Vec::new()));
    }
    Ok(bytes)
}

/// A table of designs: every column is a parameter, every cell a number.
fn table_design(bytes: &[u8], name: &str) -> Result<Design, Failure> {
    let mut table = NamedTable::read(name.to_owned(), Box::new(bytes))?;
    table.refuse_unclear_columns()?;
    let mut values = Vec::new();
    while let Some(row) = table.next_row()? {
        for column in 0..row.len() {
            values.push(table.number(&row, column)?);
        }
    }
    if values.is_empty() {
        let message = format!("{name} has no rows of designs below its header");
        return Err(Failure::usage(message, Vec::new()));
    }
    Ok(Design::table(table.header, values))
}
