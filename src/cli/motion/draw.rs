//! `mechanim draw`: the kinematic diagram of a pose.

use crate::cli::args::board::DrawArgs;
use crate::cli::files::chart::{PlotFormat, chart_theme, write_drawing};
use crate::cli::io;
use crate::cli::open::pose::{coordinates_along, coordinates_at};
use crate::cli::open::scene::{OpenScene, open_changed};
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::diagram::scheme::Scheme;
use crate::diagram::sheet::{DiagramParts, SheetOptions, draw_sheet};
use crate::diagram::walk::scheme_at;
use crate::model::view::{UpAxis, View};
use crate::render::camera::ViewDirection;
use crate::scene::Scene;
use glam::{DMat3, DVec3};

/// Runs the verb.
pub fn run_draw(args: &DrawArgs, term: &Term) -> Result<Outcome, Failure> {
    let format = PlotFormat::of(&args.out)?;
    io::refuse_input(&args.scene, &args.out)?;
    let open = open_changed(&args.scene, |overrides| overrides.notation = true, term)?;
    let scene = &open.scene;
    let scheme = chosen_scheme(&open, args.at)?;
    if scheme.places().next().is_none() {
        term.warning("nothing is drawn: the scene has no links, bars or contacts");
    }
    let sheet = draw_sheet(&scheme, &sheet_options(args, scene));
    let mut output = io::open_output(&args.out)?;
    let written = write_drawing(&sheet.drawing, format, output.as_mut());
    io::unless_reader_left(written.and_then(|()| Ok(output.commit()?)))?;
    Ok(Outcome::Done)
}

/// Poses among which the default one is chosen.
const POSES: usize = 24;

/// The scheme at the requested instant, else at the pose whose loops enclose most.
fn chosen_scheme(open: &OpenScene, at: Option<f64>) -> Result<Scheme, Failure> {
    let scene = &open.scene;
    let notation = scene.notation.clone().unwrap_or_default();
    let scheme = |coordinates: &Vec<f64>| scheme_at(&scene.mechanism, &notation, coordinates);
    if at.is_none() {
        let poses = coordinates_along(open, POSES)?;
        let most = poses
            .iter()
            .map(scheme)
            .max_by(|a, b| a.spread().total_cmp(&b.spread()));
        if let Some(most) = most {
            return Ok(most);
        }
    }
    Ok(scheme(&coordinates_at(open, at.unwrap_or(0.0))?))
}

fn sheet_options(args: &DrawArgs, scene: &Scene) -> SheetOptions {
    let mechanism = &scene.mechanism;
    let mut view = View::clone(&scene.view);
    if let Some(named) = args.view {
        view.look_from(named);
    }
    view.azimuth = args.azimuth.map_or(view.azimuth, f64::to_radians);
    view.elevation = args.elevation.map_or(view.elevation, f64::to_radians);
    let is_asked = args.view.is_some() || args.azimuth.is_some() || args.elevation.is_some();
    let axes = view_axes(&view);
    SheetOptions {
        axes: is_asked.then_some(axes),
        spatial_axes: axes,
        width: args.width,
        theme: chart_theme(args.theme),
        shown: args.show.unwrap_or(DiagramParts::USUAL),
        title: mechanism.title.clone(),
        length_unit: mechanism.length_unit.clone(),
        angle_unit: (
            mechanism.angle_unit.name.clone(),
            mechanism.angle_unit.radians.number(),
        ),
    }
}

/// Right, up, and towards the viewer, from a view.
fn view_axes(view: &View) -> DMat3 {
    let up = match view.up {
        UpAxis::X => DVec3::X,
        UpAxis::Y => DVec3::Y,
        UpAxis::Z => DVec3::Z,
    };
    let direction = ViewDirection {
        azimuth: view.azimuth,
        elevation: view.elevation,
        up,
    };
    direction.axes()
}
