//! `check --made-within`: clearances of all pieces within their tolerances.

use crate::analysis::enclosure::{PieceTolerances, TolerancePlan, enclose_clearances};
use crate::clearance::part::{JudgedPart, PieceReport};
use crate::cli::args::motion::CheckArgs;
use crate::cli::interrupt::{CANCEL, refuse_interrupted};
use crate::cli::open::scene::OpenScene;
use crate::cli::open::study::open_pieces;
use crate::cli::term::outcome::Failure;
use crate::jobs::core_count;
use crate::limits::search_deadline;
use crate::model::carried::CarriedShape;
use crate::scene::{Overrides, load_scene};

/// Tolerances apply to a motion.
pub fn refuse_without_motion(args: &CheckArgs, own: &[(String, f64)]) -> Result<(), Failure> {
    let other = [
        ("--pose", !args.pose.is_empty()),
        ("--inputs-box", !args.inputs_box.is_empty()),
    ];
    let other = other.into_iter().find(|(_, is_given)| *is_given);
    match (other, own.first()) {
        (Some((option, _)), Some((name, _))) => Err(Failure::usage(
            format!("{option} uses fixed dimensions, and `{name}` is an interval"),
            vec![format!(
                "without {option} the motion is checked for all pieces"
            )],
        )),
        _ if !args.vary.vary.is_empty() && args.made_within.is_none() && own.is_empty() => {
            Err(Failure::usage(
                "--vary names dimensions with a tolerance, and no tolerance is given",
                vec!["add --made-within 0.1".to_owned()],
            ))
        }
        _ => Ok(()),
    }
}

/// The clearances of `parts` for all pieces, from the first to the last of `times`.
pub fn all_pieces(
    args: &CheckArgs,
    own: &[(String, f64)],
    opened: &OpenScene,
    times: &[f64],
    parts: &[JudgedPart],
) -> Result<PieceReport, Failure> {
    let (source, overrides) = opened.text_as_opened(&args.scene);
    let asked = PieceTolerances {
        vary: &args.vary.vary,
        own,
        tolerance: args.made_within,
        otherwise: None,
        between: true,
    };
    let overrides = Overrides {
        carries_shapes: true,
        ..overrides
    };
    // The parameters of solids are dimensions, too.
    let drawn = load_scene(&source, &overrides).map_err(Box::new)?;
    let (family, tolerances) = open_pieces(&asked, "--made-within", (&source, &overrides, &drawn))?;
    refuse_stiff(&family.carried, parts)?;
    let plan = TolerancePlan::new(&family, &tolerances)
        .until(&CANCEL)
        .by(search_deadline());
    let list = enclose_clearances(&plan, parts, times, args.asked.tolerance, core_count());
    refuse_interrupted()?;
    let mechanism = family.mechanism();
    let dimensions = plan.dimensions.iter();
    let dimensions =
        dimensions.map(|d| (d.name.clone(), d.tolerance * mechanism.file_units(d.kind)));
    Ok(PieceReport {
        dimensions: dimensions.collect(),
        list,
    })
}

/// Directions and scales of solids are not tracked.
fn refuse_stiff(carried: &[CarriedShape], parts: &[JudgedPart]) -> Result<(), Failure> {
    let judged = |shape: &&CarriedShape| parts.iter().any(|p| p.bodies.contains(&shape.body));
    let mut stiff = carried
        .iter()
        .filter(judged)
        .filter_map(|s| s.stiff.as_ref());
    match stiff.next() {
        None => Ok(()),
        Some(name) => Err(Failure::usage(
            format!(
                "`{name}` determines the direction or the scale of a solid, where its tolerance would be ignored"
            ),
            vec!["leave it out with --vary, or write the number there".to_owned()],
        )),
    }
}
