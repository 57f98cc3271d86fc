//! Events and gaps of a motion as sentences, with values in the scene's units.

use super::rounded::at_most;
use super::sentences::{angles_note, input_sentence, with_unit};
use crate::diag::decimals_of;
use crate::kinematics::results::trajectory::{Ending, Event, EventKind, Instant, MotionGap};
use crate::model::mechanism::Mechanism;

/// Angles above this are not rounding errors of zero.
const SEEN_ANGLE: f64 = 5e-7;

/// Angles this close to gimbal lock count as locked: the rest is rounding.
const LOCKED: f64 = 1e-9;

/// An interval without a pose as a sentence: the feasible interval of the drive ends and begins at its ends.
pub fn gap_sentence(mechanism: &Mechanism, gap: &MotionGap) -> String {
    let found = match &gap.ending {
        // There are poses on both sides.
        Some(Ending::Jump { .. }) => "the motion is broken",
        None => "no pose was found",
        Some(_) if gap.is_undecided() => "no pose was found",
        Some(_) => "the motion has no pose",
    };
    let stretch = stretch_words(mechanism, gap);
    let ends = [("ends", &gap.ending), ("begins again", &gap.beginning)];
    let ends = ends.map(|(verb, ending)| {
        let ending = ending.as_ref();
        ending.map_or_else(String::new, |e| format!("; it {verb} {}", ending_words(e)))
    });
    let lack = gap.widest.as_ref().map_or_else(String::new, |lack| {
        let at = input_sentence(mechanism, &lack.at.inputs);
        let words = lack_words(mechanism, &at, &lack.name, [lack.angle, lack.distance]);
        let proof = match lack.proved {
            true => "no pose exists there (proved)",
            false => "other assemblies may have one",
        };
        format!("; {words}; {proof}")
    });
    format!("{found} {stretch}{}{lack}", ends.concat())
}

/// Where a gap begins and ends.
fn stretch_words(mechanism: &Mechanism, gap: &MotionGap) -> String {
    let at = |i: &Instant| instant_words(mechanism, i.time, &i.inputs);
    match (&gap.from, &gap.until) {
        (Some(from), Some(until)) => format!("between {} and {}", at(from), at(until)),
        (Some(from), None) => format!("beyond {}", at(from)),
        (None, Some(until)) => format!("before {}", at(until)),
        (None, None) => "at any sample".to_owned(),
    }
}

/// What a motion ends at, after "ends".
fn ending_words(ending: &Ending) -> String {
    match ending {
        Ending::Fold { proved: true, .. } => "at a fold (proved)".to_owned(),
        Ending::Fold { proved: false, .. } => "at a fold (located, not proved)".to_owned(),
        Ending::NoValue { name, proved, .. } => {
            let how = if *proved {
                "proved"
            } else {
                "located, not proved"
            };
            format!("where equation `{name}` ceases to have a value ({how})")
        }
        Ending::InputUndefined { name, proved: true } => {
            format!("where input `{name}` ceases to have a value (proved)")
        }
        Ending::InputUndefined { name, .. } => {
            format!("where input `{name}` can no longer be evaluated to a finite number")
        }
        Ending::GivenUp { sigma_min } => format!(
            "undecided: steps became too small, or too many, near a smallest singular value of {sigma_min:.1e}, and poses may exist beyond"
        ),
        Ending::Jump { name } => format!("where a formula of `{name}` jumps"),
        Ending::AngleTooLarge => {
            "undecided: the angles are too large to close the loops within their own rounding"
                .to_owned()
        }
        Ending::PlaceTooFar => {
            "undecided: places are so far from the origin, beside the lengths there, that their own rounding leaves them open; put the origin nearer"
                .to_owned()
        }
        Ending::NotFound => "undecided: poses may exist".to_owned(),
    }
}

/// `t = 1.5 s (phi = 0.2 rad)`.
fn instant_words(mechanism: &Mechanism, time: f64, inputs: &[f64]) -> String {
    let inputs = input_sentence(mechanism, inputs);
    format!("t = {} s ({inputs})", decimals_of(time, 9))
}

/// One event as a sentence.
pub fn event_sentence(mechanism: &Mechanism, event: &Event) -> String {
    let at = instant_words(mechanism, event.time, &event.inputs);
    match &event.kind {
        EventKind::MotionEnds(ending) => {
            format!("the motion ends at {at}, {}", ending_words(ending))
        }
        EventKind::MotionResumes { same_branch: true } => format!("poses exist again from {at} on"),
        EventKind::MotionResumes { same_branch: false } => {
            format!("poses exist again from {at} on, on another branch than before")
        }
        EventKind::BranchChosen { taken, others } => branch_sentence(&at, taken, others),
        EventKind::LimitPosition {
            name,
            measure,
            value,
            is_largest,
        } => {
            let extreme = if *is_largest { "maximum" } else { "minimum" };
            let value = with_unit(mechanism, *measure, *value);
            format!("`{name}` turns back at {at}: a local {extreme} of {value}")
        }
        EventKind::InputUndefined { name, proved } => {
            undefined_sentence(event.time, &at, name, *proved)
        }
        EventKind::StartNotClosed {
            proved,
            name,
            angle,
            distance,
        } => {
            let lack = lack_words(mechanism, &at, name, [*angle, *distance]);
            unclosed_sentence(&lack, *proved)
        }
        EventKind::GimbalLock { names, distance } => lock_sentence(&at, names, *distance),
        EventKind::StartMoved {
            name,
            measure,
            wanted,
            found,
            nearer,
            mode,
        } => {
            let values = [wanted, found, nearer].map(|v| with_unit(mechanism, *measure, *v));
            moved_sentence(&at, name, values, mode)
        }
        EventKind::AxesParallel { contact } => parallel_sentence(&at, contact),
        EventKind::SingularPosePassed => format!(
            "singular pose near {at}: the motion continues straight through it, but it is not proved that it stays on this branch"
        ),
        EventKind::SingularPoseMet => format!(
            "singular pose at {at}, where the drive turns back: the motion returns on its branch, though another one begins there"
        ),
        EventKind::StartSingular => format!(
            "the motion starts at a singular pose at {at}: rates that are not given are infinite or not determined there, and assemblies may meet"
        ),
        EventKind::OtherStart => format!(
            "the start values lead to no pose at {at}; a perturbed start was used, which may be on another branch"
        ),
    }
}

/// Which of the branches that meet at the start is followed.
fn branch_sentence(at: &str, taken: &str, others: &[String]) -> String {
    if others.is_empty() {
        return format!("from {at} on the motion follows branch {taken}, the only one found there");
    }
    let others = others.join(", ");
    format!(
        "of the branches that meet at {at} the motion follows {taken}, the one nearest to the start values; --guess or --mode takes another ({others})"
    )
}

fn undefined_sentence(time: f64, at: &str, name: &str, proved: bool) -> String {
    if proved {
        let time = decimals_of(time, 9);
        return format!("input `{name}` has no value near t = {time} s");
    }
    format!(
        "input `{name}` cannot be evaluated to a finite number at {at}; it is not proved that it has no value"
    )
}

fn lock_sentence(at: &str, [a, b, c]: &[String; 3], distance: f64) -> String {
    let how = match distance <= LOCKED {
        true => format!("gimbal-locked coordinates {a}, {b}, {c}"),
        false => format!(
            "coordinates {a}, {b}, {c} within {} of gimbal lock",
            at_most(distance)
        ),
    };
    format!(
        "{how} at {at}: only the sum or difference of {a} and {c} is determined there; positions are exact"
    )
}

/// The start value that was wanted, the one found, and the nearer one of another assembly.
fn moved_sentence(
    at: &str,
    name: &str,
    [wanted, found, nearer]: [String; 3],
    mode: &str,
) -> String {
    format!(
        "the start value `{name}` = {wanted} led to {found} at {at}; --mode={mode} has {nearer}"
    )
}

/// The start does not close, with what is lacking in words.
fn unclosed_sentence(lack: &str, proved: bool) -> String {
    match proved {
        true => format!("{lack}; no pose exists (proved)"),
        false => format!("{lack}; it is not proved that no pose exists"),
    }
}

fn parallel_sentence(at: &str, contact: &str) -> String {
    format!(
        "the two cylinders of contact `{contact}` have parallel axes at {at}: they touch along a line, so the coordinates of the contact are not determined; if the centres stay in one plane, write `sphere` for both"
    )
}

/// What does not close at the best pose found `at` some inputs, by how many radians and length units.
fn lack_words(mechanism: &Mechanism, at: &str, name: &str, [angle, distance]: [f64; 2]) -> String {
    let unit = &mechanism.length_unit;
    let left = shown_amount(distance);
    let best = "the best pose found leaves";
    if mechanism.contacts.iter().any(|c| c == name) {
        return format!(
            "contact `{name}` cannot be made at {at}: {best} {left} {unit} between the surfaces"
        );
    }
    if !distance.is_finite() {
        return format!("`{name}` has no value at {at} where the search ended");
    }
    if let Some(bar) = mechanism.bars.iter().find(|b| b.name == name) {
        // The equation of a variable length is one of squares.
        let off = match bar.length {
            Some(_) => format!("{left} {unit} off its length"),
            None => format!("with a squared length that is {left} {unit}² off"),
        };
        return format!("bar `{name}` does not fit at {at}: {best} it {off}");
    }
    if mechanism.equations.iter().any(|e| e.name == name) {
        let note = angles_note(mechanism);
        return format!(
            "equation `{name}` does not hold at {at}: {best} {left} instead of zero{note}"
        );
    }
    let turned = if angle > SEEN_ANGLE {
        format!(" and {} rad", shown_amount(angle))
    } else {
        String::new()
    };
    format!("loop `{name}` does not close at {at}: {best} {left} {unit}{turned}")
}

/// What is lacking.
fn shown_amount(value: f64) -> String {
    decimals_of(value, 6)
}
