//! The keys of `[view]` for everything drawn in addition to the bodies.

use super::super::views::ViewFile;
use super::body_constants::BodyConstants;
use super::choices::{MOST_GHOSTS, chosen_word};
use crate::diag::{Diagnostic, Diagnostics, shown_number};
use crate::model::view::{Decor, Ghosts, ShownAxes, Trails};
use crate::scene::values::FormulaText;

/// Resolves them; errors are reported and skipped.
pub fn resolve_decor(
    view: &ViewFile,
    constants: &BodyConstants,
    diagnostics: &mut Diagnostics,
) -> Decor {
    // Lengths, times and scales must be positive.
    let mut positive = |what: &str, text: &Option<FormulaText>| {
        let text = text.as_ref()?;
        constants.positive(what, text, diagnostics)
    };
    let length = positive("trail_length", &view.trail_length);
    let ticks = positive("ticks", &view.ticks);
    let arrow_scale = positive("arrow_scale", &view.arrow_scale);
    // Only fading trails have a length.
    let trails = match chosen_word(&view.trails, &Trails::NAMES, "kind of trails", diagnostics) {
        Trails::Fading(_) => Trails::Fading(length),
        other => other,
    };
    Decor {
        ghosts: resolve_ghosts(view, constants, diagnostics),
        trails,
        arrows: view.arrows.unwrap_or(false),
        arrow_scale,
        axes: chosen_word(&view.axes, &ShownAxes::NAMES, "choice of axes", diagnostics),
        scale: view.scale.unwrap_or(false),
        ticks,
        gauge: view.gauge.unwrap_or(false),
        joints: view.joints.unwrap_or(false),
    }
}

fn resolve_ghosts(
    view: &ViewFile,
    constants: &BodyConstants,
    diagnostics: &mut Diagnostics,
) -> Ghosts {
    // Ghosts at given times precede a number of them.
    if let Some(times) = &view.ghost_times {
        if times.value.len() > MOST_GHOSTS {
            let message = format!("at most {MOST_GHOSTS} ghosts");
            diagnostics.push(Diagnostic::error(message).at(times.span.clone()));
        }
        let times = times.value.iter();
        return Ghosts::Times(
            times
                .filter_map(|text| constants.value(text, diagnostics))
                .collect(),
        );
    }
    // Else a whole number; errors leave none.
    let none = Ghosts::Count(0);
    let Some(text) = &view.ghosts else {
        return none;
    };
    let Some(count) = constants.value(text, diagnostics) else {
        return none;
    };
    if (0.0..=MOST_GHOSTS as f64).contains(&count) && count.fract() == 0.0 {
        return Ghosts::Count(count as usize);
    }
    let count = shown_number(count);
    let message = format!("ghosts must be a whole number from 0 to {MOST_GHOSTS}, found {count}");
    diagnostics.push(Diagnostic::error(message).at(text.span.clone()));
    none
}
