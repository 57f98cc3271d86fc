//! Events and gaps of a motion as sentences, with values in the scene's units.

use super::rounded::at_most;
use crate::diag::decimals_of;
use crate::kinematics::results::trajectory::{Ending, Event, EventKind, Instant, MotionGap};
use crate::model::mechanism::{Kind, Mechanism};

/// Angles above this are not rounding errors of zero.
const SEEN_ANGLE: f64 = 5e-7;

/// Angles this close to gimbal lock count as locked: the rest is rounding.
const LOCKED: f64 = 1e-9;

/// A number of things: `1 mode`, `3 modes`.
pub fn counted_things(number: usize, thing: &str) -> String {
    format!("{number} {thing}{}", if number == 1 { "" } else { "s" })
}

/// What a reader of a scene in degrees must know of the value of an equation.
pub fn angles_note(mechanism: &Mechanism) -> &'static str {
    match mechanism.angle_unit.radians.number() == 1.0 {
        true => "",
        false => ", angles in radians",
    }
}

/// An interval without a pose as a sentence: the feasible interval of the drive ends and begins at its ends.
pub fn gap_sentence(mechanism: &Mechanism, gap: &MotionGap) -> String {
    let at = |i: &Instant| {
        format!(
            "t = {} s ({})",
            decimals_of(i.time, 9),
            input_sentence(mechanism, &i.inputs)
        )
    };
    let stretch = match (&gap.from, &gap.until) {
        (Some(from), Some(until)) => format!("between {} and {}", at(from), at(until)),
        (Some(from), None) => format!("beyond {}", at(from)),
        (None, Some(until)) => format!("before {}", at(until)),
        (None, None) => "at any sample".to_owned(),
    };
    let lack = gap.widest.as_ref().map_or_else(String::new, |lack| {
        let at = input_sentence(mechanism, &lack.at.inputs);
        let words = lack_words(mechanism, &at, &lack.name, [lack.angle, lack.distance]);
        format!("; {words}")
    });
    let ends = [("ends", &gap.ending), ("begins again", &gap.beginning)];
    let ends = ends.map(|(verb, ending)| {
        let ending = ending.as_ref();
        ending.map_or_else(String::new, |e| format!("; it {verb} {}", ending_words(e)))
    });
    let found = match &gap.ending {
        // There are poses on both sides.
        Some(Ending::Jump { .. }) => "the motion is broken",
        None => "no pose was found",
        Some(_) if gap.is_undecided() => "no pose was found",
        Some(_) => "the motion has no pose",
    };
    let proof = match gap.widest.as_ref().map(|lack| lack.proved) {
        Some(true) => "; no pose exists there (proved)",
        Some(false) => "; other assemblies may have one",
        None => "",
    };
    format!("{found} {stretch}{}{lack}{proof}", ends.concat())
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
        Ending::NotFound => "undecided: poses may exist".to_owned(),
    }
}

/// One event as a sentence.
pub fn event_sentence(mechanism: &Mechanism, event: &Event) -> String {
    let at = format!(
        "t = {} s ({})",
        decimals_of(event.time, 9),
        input_sentence(mechanism, &event.inputs)
    );
    match &event.kind {
        EventKind::MotionEnds(ending) => {
            format!("the motion ends at {at}, {}", ending_words(ending))
        }
        EventKind::MotionResumes { same_branch: true } => format!("poses exist again from {at} on"),
        EventKind::MotionResumes { same_branch: false } => {
            format!("poses exist again from {at} on, on another branch than before")
        }
        EventKind::SingularPosePassed => format!(
            "singular pose near {at}: the motion continues straight through it, but it is not proved that it stays on this branch"
        ),
        EventKind::SingularPoseMet => format!(
            "singular pose at {at}, where the drive turns back: the motion returns on its branch, though another one begins there"
        ),
        EventKind::BranchChosen { taken, others } if others.is_empty() => {
            format!("from {at} on the motion follows branch {taken}, the only one found there")
        }
        EventKind::BranchChosen { taken, others } => format!(
            "of the branches that meet at {at} the motion follows {taken}, the one nearest to the start values; --guess or --mode takes another ({})",
            others.join(", ")
        ),
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
        EventKind::InputUndefined { name, proved: true } => {
            format!(
                "input `{name}` has no value near t = {} s",
                decimals_of(event.time, 9)
            )
        }
        EventKind::InputUndefined {
            name,
            proved: false,
        } => {
            format!(
                "input `{name}` cannot be evaluated to a finite number at {at}; it is not proved that it has no value"
            )
        }
        EventKind::StartNotClosed {
            proved,
            name,
            angle,
            distance,
        } => {
            let lack = lack_words(mechanism, &at, name, [*angle, *distance]);
            match proved {
                true => format!("{lack}; no pose exists (proved)"),
                false => format!("{lack}; it is not proved that no pose exists"),
            }
        }
        EventKind::GimbalLock { names, distance } => {
            let [a, b, c] = names;
            let how = if *distance <= LOCKED {
                format!("gimbal-locked coordinates {a}, {b}, {c}")
            } else {
                format!(
                    "coordinates {a}, {b}, {c} within {} of gimbal lock",
                    at_most(*distance)
                )
            };
            format!(
                "{how} at {at}: only the sum or difference of {a} and {c} is determined there; positions are exact"
            )
        }
        EventKind::StartSingular => format!(
            "the motion starts at a singular pose at {at}: rates that are not given are infinite or not determined there, and assemblies may meet"
        ),
        EventKind::AxesParallel { contact } => format!(
            "the two cylinders of contact `{contact}` have parallel axes at {at}: they touch along a line, so the coordinates of the contact are not determined; if the centres stay in one plane, write `sphere` for both"
        ),
        EventKind::StartMoved {
            name,
            measure,
            wanted,
            found,
            nearer,
            mode,
        } => {
            let [wanted, found, nearer] =
                [wanted, found, nearer].map(|v| with_unit(mechanism, *measure, *v));
            format!(
                "the start value `{name}` = {wanted} led to {found} at {at}; --mode={mode} has {nearer}"
            )
        }
        EventKind::OtherStart => format!(
            "the start values lead to no pose at {at}; a perturbed start was used, which may be on another branch"
        ),
    }
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

/// `p = -17 mm, phi = 0.2 rad`.
pub fn input_sentence(mechanism: &Mechanism, values: &[f64]) -> String {
    let pairs = mechanism.inputs.iter().zip(values);
    let texts = pairs.map(|(input, value)| {
        let value = with_unit(mechanism, input.kind, *value);
        format!("{} = {value}", input.name)
    });
    let list = texts.collect::<Vec<_>>().join(", ");
    if list.is_empty() {
        "no inputs".to_owned()
    } else {
        list
    }
}

/// A value with its unit: `-17.000000000 mm`.
pub fn with_unit(mechanism: &Mechanism, kind: Kind, value: f64) -> String {
    let text = decimals_of(value * mechanism.file_units(kind), 9);
    beside_unit(text, mechanism.unit_name(kind))
}

/// A number and its unit, if it has one.
pub fn beside_unit(text: String, unit: &str) -> String {
    match unit {
        "" => text,
        unit => format!("{text} {unit}"),
    }
}

/// `1 of 41 samples has no pose`.
pub fn samples_without_pose(missing: usize, samples: usize) -> String {
    let verb = if missing == 1 { "has" } else { "have" };
    format!("{missing} of {samples} samples {verb} no pose")
}

/// The largest certified error of so many poses, some of them without a certificate.
pub fn certified_error([poses, unproved]: [usize; 2], bound: f64, unit: &str) -> String {
    match unproved {
        0 => format!("error at most {}", beside_unit(at_most(bound), unit)),
        _ if unproved >= poses => "no certified error".to_owned(),
        _ => format!(
            "error of the others at most {}",
            beside_unit(at_most(bound), unit)
        ),
    }
}
