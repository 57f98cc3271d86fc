//! The options of `mechanim render` that change the scene's `[view]`.

use super::section::{explosion_factor, section_plane};
use super::values::{hex_colour, named_word};
use crate::cli::term::outcome::Failure;
use crate::diag::shown_number;
use crate::export::Format;
use crate::model::section::SectionPlane;
use crate::model::theme::Theme;
use crate::model::view::{
    EdgeLines, Ghosts, HiddenSolids, NamedView, Playback, Shadows, ShownAxes, Trails,
    ViewProjection,
};
use crate::model::view_change::ViewChange;
use crate::scene::Scene;
use crate::scene::resolve::camera::MOST_ORBIT;
use crate::scene::resolve::choices::MOST_GHOSTS;
use clap::Args;
use std::sync::Arc;

/// How the scene is looked at; each replaces a key of its `[view]`.
#[derive(Debug, Args)]
#[command(next_help_heading = "View")]
pub struct ViewArgs {
    /// Look from a named direction, in parallel projection; `four` shows top, front and side with the scene's view.
    #[arg(long, value_parser = named_word(&NamedView::NAMES))]
    pub view: Option<NamedView>,
    /// Direction of the viewer about the up axis, in degrees.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, value_parser = azimuth_angle)]
    pub azimuth: Option<f64>,
    /// Height of the viewer above the horizon, in degrees, -90 to 90.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, value_parser = elevation_angle)]
    pub elevation: Option<f64>,
    /// Degrees that the camera turns about the up axis during the motion, in place of the scene's camera path.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, value_parser = orbit_angle)]
    pub orbit: Option<f64>,
    /// Kind of projection.
    #[arg(long = "projection", value_name = "PROJECTION", value_parser = named_word(&ViewProjection::NAMES))]
    pub parallel: Option<bool>,
    /// Light or dark: colours of background, text and ground.
    #[arg(long, value_parser = named_word(&Theme::NAMES))]
    pub theme: Option<Theme>,
    /// Lines between surfaces: around bodies, at creases as well, or none.
    #[arg(long, value_parser = named_word(&EdgeLines::NAMES))]
    pub edges: Option<EdgeLines>,
    /// Shadows on bodies and on the ground, on the ground only, or none.
    #[arg(long, value_parser = named_word(&Shadows::NAMES))]
    pub shadows: Option<Shadows>,
    /// Colour of the background.
    #[arg(long, value_name = "#rrggbb", value_parser = hex_colour)]
    pub background: Option<[u8; 3]>,
    /// No background, in PNG and APNG.
    #[arg(long, conflicts_with = "background")]
    pub transparent: bool,
    /// Show this many earlier poses as translucent bodies.
    #[arg(long, value_name = "N", value_parser = ghost_count)]
    pub ghosts: Option<usize>,
    /// Show the poses at these earlier times in seconds as translucent bodies.
    #[arg(
        long,
        value_name = "T,T,…",
        value_delimiter = ',',
        value_parser = instant_seconds,
        conflicts_with = "ghosts"
    )]
    pub ghost_times: Option<Vec<f64>>,
    /// How traced paths are drawn.
    #[arg(long, value_parser = named_word(&Trails::NAMES))]
    pub trails: Option<Trails>,
    /// Length of fading trails in seconds.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = positive_scale)]
    pub trail_length: Option<f64>,
    /// Velocity arrows on traced points.
    #[arg(long)]
    pub arrows: bool,
    /// Length of velocity arrows, in seconds of motion.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = positive_scale)]
    pub arrow_scale: Option<f64>,
    /// Axes of frames.
    #[arg(long, value_parser = named_word(&ShownAxes::NAMES))]
    pub axes: Option<ShownAxes>,
    /// Marks on the traced paths at equal times, this many seconds apart: wider spacing means higher speed.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = positive_scale)]
    pub ticks: Option<f64>,
    /// A scale bar in parallel projections; in a perspective, the pitch of the ground's grid.
    #[arg(long)]
    pub scale: bool,
    /// Cut the bodies at a plane: `x=10` removes what is beyond x = 10, `-x=10` what is before it. Or POINT/NORMAL, as in
    /// `0,0,10/0,1,1`; the normal points to the side that is removed. Scenes choose bodies with `[view] section`.
    #[arg(long, value_name = "PLANE", allow_hyphen_values = true, value_parser = section_plane)]
    pub section: Option<SectionPlane>,
    /// Move the bodies apart, by this multiple of the distance of their centres from the common centre.
    #[arg(long, value_name = "FACTOR", allow_negative_numbers = true, value_parser = explosion_factor)]
    pub explode: Option<f64>,
    /// Play the motion forwards, then backwards.
    #[arg(long)]
    pub bounce: bool,
    /// Show the first and the last pose for this much longer.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = pause_seconds)]
    pub pause: Option<f64>,
    /// Show the inputs as gauges with their ranges instead of numbers.
    #[arg(long)]
    pub gauge: bool,
    /// Draw joint symbols by kind, and the ground.
    #[arg(long)]
    pub joints: bool,
    /// Leave out title and input values.
    #[arg(long)]
    pub no_captions: bool,
    /// Leave out a body, or its solids of one kind (BODY.torus). May be repeated.
    #[arg(long, value_name = "BODY")]
    pub hide: Vec<String>,
}

impl ViewArgs {
    fn change(&self) -> ViewChange {
        let yes = |flag: bool| flag.then_some(true);
        ViewChange {
            from: self.view,
            azimuth: self.azimuth.map(f64::to_radians),
            elevation: self.elevation.map(f64::to_radians),
            parallel: self.parallel,
            theme: self.theme,
            edges: self.edges,
            shadows: self.shadows,
            background: self.background,
            // A background that is asked for is drawn, whatever the scene says.
            transparent: yes(self.transparent).or(self.background.map(|_| false)),
            captions: self.no_captions.then_some(false),
            ghosts: self
                .ghosts
                .map(Ghosts::Count)
                .or_else(|| self.ghost_times.clone().map(Ghosts::Times)),
            trails: self.trails,
            arrows: yes(self.arrows),
            axes: self.axes,
            ticks: self.ticks,
            scale: yes(self.scale),
            bounce: yes(self.bounce),
            pause: self.pause,
            gauge: yes(self.gauge),
            joints: yes(self.joints),
            orbit: self.orbit.map(f64::to_radians),
            section: self.section,
            explode: self.explode,
            ..ViewChange::default()
        }
    }

    /// Applies the options to the view of `scene`.
    ///
    /// Errors: a transparent background in a format without alpha; a size of trails or arrows that are not drawn; too many
    /// ghosts, two at one time, or one outside the motion.
    pub fn apply(&self, format: &Format, scene: &mut Scene) -> Result<(), Failure> {
        self.hide
            .iter()
            .try_for_each(|name| hide_shapes(name, scene))?;
        let view = Arc::make_mut(&mut scene.view);
        self.change().apply(view);
        if let Ghosts::Times(times) = &view.decor.ghosts {
            refuse_ghosts(times, scene.actuation.duration)?;
        }
        match (self.trail_length, &mut view.decor.trails) {
            (None, _) => {}
            (Some(length), Trails::Fading(seconds)) => *seconds = Some(length),
            (Some(_), _) => {
                let message = "--trail-length is for trails that fade, and these do not";
                return Err(Failure::usage(
                    message,
                    vec!["add --trails fading".to_owned()],
                ));
            }
        }
        if self.arrow_scale.is_some() && !view.decor.arrows {
            let message = "--arrow-scale has no effect without arrows";
            return Err(Failure::usage(message, vec!["add --arrows".to_owned()]));
        }
        view.decor.arrow_scale = self.arrow_scale.or(view.decor.arrow_scale);
        let has_alpha = matches!(format, Format::Png | Format::Apng | Format::PngSequence(_));
        if view.transparent && !has_alpha && !format.is_model() {
            return Err(Failure::usage(
                format!("{} has no transparency", format.name()),
                vec![
                    "write a .png, an .apng or a folder of frames, or give a --background"
                        .to_owned(),
                ],
            ));
        }
        Ok(())
    }
}

/// A time that stands in the list more than once.
fn twice_in(times: &[f64]) -> Option<f64> {
    let mut sorted = times.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted
        .windows(2)
        .find(|two| two[0] == two[1])
        .map(|two| two[0])
}

fn refuse_ghosts(times: &[f64], last: f64) -> Result<(), Failure> {
    let outside = times.iter().find(|time| !(0.0..=last).contains(*time));
    let message = match outside {
        _ if times.len() > MOST_GHOSTS => format!("at most {MOST_GHOSTS} ghosts"),
        Some(time) => format!(
            "a ghost at {} s: the motion lasts from 0 to {} s",
            shown_number(*time),
            shown_number(last)
        ),
        None => match twice_in(times) {
            Some(time) => format!("two ghosts at {} s", shown_number(time)),
            None => return Ok(()),
        },
    };
    Err(Failure::usage(message, Vec::new()))
}

/// Takes a body's solids out of the pictures; its motion stays.
fn hide_shapes(name: &str, scene: &mut Scene) -> Result<(), Failure> {
    let mechanism = &scene.mechanism;
    let whole = mechanism.bodies.iter().position(|body| body.name == name);
    let (body, kind) = match (whole, name.rsplit_once('.')) {
        (Some(body), _) => (Some(body), None),
        (None, Some((name, kind))) => {
            let body = mechanism.bodies.iter().position(|body| body.name == name);
            (body, Some(kind))
        }
        (None, None) => (None, None),
    };
    let Some(body) = body else {
        let names = mechanism.bodies.iter().map(|body| body.name.as_str());
        return Err(Failure::unknown_name("body", name, names));
    };
    let mut shown = scene.view.shown_shapes(mechanism, body);
    if let Some(kind) = kind
        && !shown.any(|shape| shape.solid.word() == kind)
    {
        let message = format!("body `{}` has no {kind}", mechanism.bodies[body].name);
        return Err(Failure::usage(message, Vec::new()));
    }
    drop(shown);
    let kind = kind.map(str::to_owned);
    let view = Arc::make_mut(&mut scene.view);
    view.hidden.push(HiddenSolids { body, kind });
    Ok(())
}

/// Degrees about the up axis.
pub fn azimuth_angle(text: &str) -> Result<f64, String> {
    angle_between(text, -720.0, 720.0)
}

fn orbit_angle(text: &str) -> Result<f64, String> {
    angle_between(text, -MOST_ORBIT, MOST_ORBIT)
}

/// Degrees above the horizon.
pub fn elevation_angle(text: &str) -> Result<f64, String> {
    angle_between(text, -90.0, 90.0)
}

fn angle_between(text: &str, low: f64, high: f64) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (low..=high).contains(&value) => Ok(value),
        _ => Err(format!("between {low} and {high} degrees")),
    }
}

fn positive_scale(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("a positive number of seconds".to_owned()),
    }
}

fn pause_seconds(text: &str) -> Result<f64, String> {
    let most = Playback::LONGEST_PAUSE;
    match text.parse::<f64>() {
        Ok(value) if (0.0..=most).contains(&value) => Ok(value),
        _ => Err(format!("between 0 and {most} seconds")),
    }
}

fn instant_seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value >= 0.0 && value.is_finite() => Ok(value),
        _ => Err("a time in seconds, 0 or later".to_owned()),
    }
}

fn ghost_count(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(count) if count <= MOST_GHOSTS => Ok(count),
        _ => Err(format!("between 0 and {MOST_GHOSTS}")),
    }
}
