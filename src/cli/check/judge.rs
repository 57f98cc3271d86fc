//! The check of one scene: its motion, a given pose, or a box of its inputs.

use super::answer::CheckAnswer;
use super::{inputs_box, motion, pieces, pose};
use crate::cli::args::motion::CheckArgs;
use crate::cli::open::intervals::interval_middles;
use crate::cli::open::scene as open_scene;
use crate::cli::term::Term;
use crate::cli::term::outcome::Failure;
use crate::kinematics::structure::block::StructureError;

/// Runs the requested checks of the scene, and writes the files about this scene alone.
pub fn judge(args: &CheckArgs, term: &Term) -> Result<CheckAnswer, Failure> {
    let (scene, own) = interval_middles(&args.scene)?;
    let args = &CheckArgs {
        scene,
        ..args.clone()
    };
    pieces::refuse_without_motion(args, &own)?;
    match open_scene::open_scene(&args.scene, term) {
        Err(failure @ Failure::Structure(StructureError::Impossible { .. })) => Ok(
            CheckAnswer::closes_nowhere(&args.scene.scene.to_string_lossy(), failure),
        ),
        Err(failure) => Err(failure),
        Ok(opened) if !args.inputs_box.is_empty() => inputs_box::check(args, &opened),
        Ok(opened) if args.pose.is_empty() => motion::check_motion(args, &opened, &own, term),
        Ok(opened) => pose::check_pose(args, &opened.scene),
    }
}
