//! The clearance report as cases of a verdict, in sentences and as CSV. All numbers are computed elsewhere.

use super::csv::{TableCell, push_header, push_row};
use super::lengths::at_least_length;
use super::pieces::piece_cases;
use super::rounded::{at_least_three, at_most, at_most_three, not_above, not_below};
use super::sentences::counted_things;
use super::verdict::{CLEARANCE, Case, CheckRequirements, Status};
use crate::clearance::check::{ClearanceReport, FarPairs, Judgement, PairReport, Violation};
use crate::diag::decimals_of;
use crate::model::mechanism::Mechanism;
use crate::model::shape::Solid;

/// Most intervals of violation listed in texts. JSON has all of them.
const MOST_INTERVALS: usize = 4;

/// Most decimals of a time in seconds.
const MOST_DECIMALS: f64 = 15.0;

/// Gaps below this are told with an exponent, where six decimals would hide them.
const SMALL_GAP: f64 = 1e-3;

/// For bodies that are known to be apart, and nothing more.
pub const NO_BOUND: &str = "no bound";

/// The word of a judgement in reports.
pub fn judgement_word(judgement: &Judgement) -> &'static str {
    match judgement {
        Judgement::Passed => "passed",
        Judgement::Estimated => "estimated",
        Judgement::Failed => "failed",
        Judgement::Undecided => "undecided",
        Judgement::Neighbours(_) => "neighbours",
        Judgement::Ignored(_) => "ignored",
    }
}

/// Names of a pair's bodies.
pub fn body_names<'m>(mechanism: &'m Mechanism, pair: &PairReport) -> [&'m str; 2] {
    pair.pair.map(|body| mechanism.bodies[body].name.as_str())
}

/// `capsule 2`: the kind of a body's shape and its number, from 1.
pub fn shape_name(mechanism: &Mechanism, body: usize, shape: usize) -> String {
    let solid = mechanism.bodies[body].shapes.get(shape).map(|s| &s.solid);
    let kind = match solid {
        Some(Solid::Sphere { .. }) => "sphere",
        Some(Solid::Capsule { .. }) => "capsule",
        Some(Solid::Cylinder { .. }) => "cylinder",
        Some(Solid::Cone { .. }) => "cone",
        Some(Solid::Box { .. }) => "box",
        Some(Solid::Torus { .. }) => "torus",
        Some(Solid::Tube { .. }) => "tube",
        Some(Solid::HalfSpace { .. }) => "half-space",
        Some(Solid::Triangles(_)) => "mesh",
        None => "shape",
    };
    format!("{kind} {}", shape + 1)
}

pub(super) fn shape_names(mechanism: &Mechanism, pair: &PairReport) -> [String; 2] {
    [0, 1].map(|k| shape_name(mechanism, pair.pair[k], pair.least.shapes[k]))
}

/// The times of violation, in words; `None` if they are unknown.
pub(super) fn violations_sentence(p: &PairReport, has_gaps: bool) -> Option<String> {
    let violations = p.violations.as_ref()?;
    let sure = match violations.is_certified {
        true => "proved",
        false => "estimated",
    };
    let one = |v: &Violation| match v.is_seen {
        true => format!("t = {}", violation_interval(v)),
        false => format!("perhaps t = {}", violation_interval(v)),
    };
    let shown = violations.list.iter().take(MOST_INTERVALS).map(one);
    let shown = shown.collect::<Vec<_>>().join(", ");
    let more = match violations.list.len().saturating_sub(MOST_INTERVALS) {
        0 => String::new(),
        more => format!(" and {}", counted_things(more, "more time")),
    };
    (!violations.list.is_empty()).then(|| {
        let other = if has_gaps {
            "times that were checked"
        } else {
            "times"
        };
        format!("below its minimum at {shown}{more}; kept at all other {other} ({sure})")
    })
}

/// An interval of time that encloses the given one, with as many decimals as a thousandth of it needs, at least six.
fn violation_interval(v: &Violation) -> String {
    let needed = (3.0 - libm::log10(v.to - v.from)).ceil();
    let decimals = needed.clamp(6.0, MOST_DECIMALS) as usize;
    let [from, to] = [not_below(v.from, decimals), not_above(v.to, decimals)];
    format!("{from} to {to} s")
}

/// One sentence about a pair.
pub fn pair_sentence(mechanism: &Mechanism, p: &PairReport) -> String {
    let unit = &mechanism.length_unit;
    let shapes = p.worst_moment().shapes;
    let [first, second] = [0, 1].map(|k| shape_name(mechanism, p.pair[k], shapes[k]));
    let [a, b] = body_names(mechanism, p);
    let who = format!("`{a}` ({first}) and `{b}` ({second})");
    match touching_words(mechanism, p) {
        Some(words) => format!("{who} must touch{words}"),
        None => format!(
            "{who} {}; the minimum is {} {unit}",
            nearest_words(p, unit),
            decimals_of(p.minimum, 6)
        ),
    }
}

/// How near or how deep two bodies come, and when.
fn nearest_words(p: &PairReport, unit: &str) -> String {
    let least = &p.least;
    // A mesh is cut where the distance is as of bodies that touch.
    let cut = p
        .touching
        .as_ref()
        .and_then(|touching| touching.cut.filter(|_| least.distance >= -touching.allowed));
    let what = if least.is_enclosed {
        "lie one in the other".to_owned()
    } else if !least.has_end() {
        "overlap without end".to_owned()
    } else if let Some(shift) = cut {
        format!(
            "overlap, and neither shifts by {} {unit} nor smaller shapes part them,",
            at_least_three(shift)
        )
    } else if least.distance < 0.0 {
        format!("overlap by {} {unit}", gap_digits(-least.distance, p))
    } else {
        format!("come within {} {unit}", gap_digits(least.distance, p))
    };
    format!("{what} at t = {} s", decimals_of(least.time, 6))
}

/// Decimals, but for a gap of bodies that must touch: there a small one matters, too.
fn gap_digits(distance: f64, p: &PairReport) -> String {
    match p.touching.is_some() && distance > 0.0 && distance < SMALL_GAP {
        true => format!("{distance:.3e}"),
        false => decimals_of(distance + 0.0, 6),
    }
}

/// What bodies that must touch do instead: `, but are 1 mm apart at t = 1 s`; or that they touch where it was looked. `None`
/// for other pairs.
pub(super) fn touching_words(mechanism: &Mechanism, p: &PairReport) -> Option<String> {
    let (touching, unit) = (p.touching.as_ref()?, &mechanism.length_unit);
    let apart = p.parted().map(|apart| {
        format!(
            "are {} {unit} apart at t = {} s",
            gap_digits(apart.distance, p),
            decimals_of(apart.time, 6)
        )
    });
    let deep = p.is_pressed().then(|| nearest_words(p, unit));
    let faults: Vec<String> = apart.into_iter().chain(deep).collect();
    Some(match faults.is_empty() {
        true => " and do at all samples".to_owned(),
        false => format!(
            ", but {}; no more than {} {unit} is allowed",
            faults.join(" and "),
            at_most(touching.allowed)
        ),
    })
}

/// The judgement of a pair in a table or picture: of bodies that must touch with what is wrong.
pub fn verdict_words(p: &PairReport, unit: &str) -> String {
    let word = judgement_word(&p.judgement);
    let apart = p
        .parted()
        .map(|apart| format!("{} {unit} apart", gap_digits(apart.distance, p)));
    let deep = p.is_pressed().then(|| "they overlap".to_owned());
    let faults: Vec<String> = apart.into_iter().chain(deep).collect();
    match faults.is_empty() {
        true => word.to_owned(),
        false => format!("{word}: {}", faults.join(", ")),
    }
}

/// What is asked of a pair, where others have their minimum.
pub fn asked_words(p: &PairReport, minimum: impl Fn(f64) -> String) -> String {
    match p.touching.is_some() {
        true => "touching".to_owned(),
        false => minimum(p.minimum),
    }
}

/// Why a pair is not judged: the joint, or the reason in the scene.
pub fn judgement_reason(judgement: &Judgement) -> Option<&str> {
    match judgement {
        Judgement::Neighbours(joint) => Some(joint),
        Judgement::Ignored(reason) => Some(reason),
        _ => None,
    }
}

/// One case per pair, one for every time interval that was not checked and every mesh without an inside, and one if no
/// pair was judged. An estimate suffices if no proof is requested.
pub fn clearance_cases(
    mechanism: &Mechanism,
    report: &ClearanceReport,
    asked: CheckRequirements,
) -> Vec<Case> {
    let pairs = report.judged.iter().chain(&report.excluded);
    let has_gaps = !report.gaps.is_empty();
    let mut list: Vec<Case> = pairs
        .map(|p| pair_case(mechanism, p, asked, has_gaps).taking(p.seconds))
        .collect();
    list.extend(report.far.map(|far| {
        let text = far_sentence(mechanism, &far);
        let name = format!("{} far apart", counted_things(far.count, "pair"));
        Case::new(
            CLEARANCE,
            &name,
            judgement_status(&far.judgement(), asked),
            text,
        )
    }));
    list.extend(report.gaps.iter().map(|[from, to]| {
        let [from, to] = [from, to].map(|time| decimals_of(*time, 6));
        let name = format!("t = {from} s to {to} s");
        let text = "not checked: the motion could not be followed there";
        Case::new(CLEARANCE, &name, Status::NotProved, text)
    }));
    list.extend(report.without_inside.iter().map(|(body, text)| {
        let name = format!("mesh of {}", mechanism.bodies[*body].name);
        Case::new(CLEARANCE, &name, Status::NotProved, text)
    }));
    let pieces = report.pieces.iter();
    list.extend(pieces.flat_map(|pieces| piece_cases(mechanism, pieces)));
    if report.gaps.is_empty() && !asked.empty {
        let nothing = report.nothing_judged().into_iter();
        list.extend(
            nothing.map(|text| Case::new(CLEARANCE, "pairs of bodies", Status::NotProved, text)),
        );
    }
    list
}

/// The status of a judgement in the check.
fn judgement_status(judgement: &Judgement, asked: CheckRequirements) -> Status {
    match judgement {
        Judgement::Passed => Status::Passed,
        Judgement::Estimated if asked.estimates => Status::Passed,
        Judgement::Estimated | Judgement::Undecided => Status::NotProved,
        Judgement::Failed => Status::Failed,
        Judgement::Neighbours(_) | Judgement::Ignored(_) => Status::Skipped,
    }
}

/// Results about pairs that were not examined one by one.
fn far_sentence(mechanism: &Mechanism, far: &FarPairs) -> String {
    let sure = match far.is_certified {
        true => "proved",
        false => "estimated",
    };
    format!(
        "{}: their swept volumes stay apart: never below {} {} ({sure})",
        judgement_word(&far.judgement()),
        at_least_length(far.apart, mechanism.size, 6),
        mechanism.length_unit
    )
}

fn pair_case(
    mechanism: &Mechanism,
    p: &PairReport,
    asked: CheckRequirements,
    has_gaps: bool,
) -> Case {
    let status = judgement_status(&p.judgement, asked);
    let sentence = pair_sentence(mechanism, p);
    let text = match judgement_reason(&p.judgement) {
        Some(reason) => {
            let shapes = left_out(mechanism, p);
            format!(
                "{}: {reason}{shapes}; {sentence}",
                judgement_word(&p.judgement)
            )
        }
        None => {
            let times = violations_sentence(p, has_gaps).map(|times| format!("; {times}"));
            format!(
                "{}: {sentence}; {}{}",
                judgement_word(&p.judgement),
                bound_text(mechanism, p, has_gaps),
                times.unwrap_or_default()
            )
        }
    };
    let [a, b] = body_names(mechanism, p);
    Case::new(CLEARANCE, &format!("{a} / {b}"), status, text)
}

/// The pairs of shapes that are excluded around a joint: ` (capsule 1 / cylinder 2)`; empty for other pairs.
fn left_out(mechanism: &Mechanism, p: &PairReport) -> String {
    let pairs = left_out_shapes(mechanism, p);
    let names: Vec<String> = pairs.iter().map(|pair| pair.join(" / ")).collect();
    match names.is_empty() {
        true => String::new(),
        false => format!(" ({})", names.join(", ")),
    }
}

/// Names of the shapes that are left out around a joint.
pub(super) fn left_out_shapes(mechanism: &Mechanism, p: &PairReport) -> Vec<[String; 2]> {
    let name = |pair: &[usize; 2]| [0, 1].map(|k| shape_name(mechanism, p.pair[k], pair[k]));
    p.left_out.iter().map(name).collect()
}

/// Results about a pair between the samples.
pub(super) fn bound_text(mechanism: &Mechanism, p: &PairReport, has_gaps: bool) -> String {
    let (least, unit) = (&p.least, &mechanism.length_unit);
    let sure = match least.is_certified {
        true => "proved",
        false => "estimated",
    };
    if p.touching.is_some() {
        return match (p.known_bound(), p.known_farthest()) {
            (Some(bound), Some(farthest)) => format!(
                "between the samples from {} to {} {unit} apart ({sure})",
                at_least_three(bound),
                at_most_three(farthest)
            ),
            (None, Some(farthest)) => format!(
                "between the samples no more than {} {unit} apart ({sure}), the depth is not known",
                at_most_three(farthest)
            ),
            (Some(bound), None) => format!(
                "between the samples no deeper than {} {unit} ({sure}), the gap is not known",
                at_least_three(bound)
            ),
            (None, None) => "nothing is known between the samples".to_owned(),
        };
    }
    match p.known_bound() {
        Some(bound) => {
            let when = if has_gaps {
                " where the motion was checked"
            } else {
                ""
            };
            let bound = at_least_length(bound, mechanism.size, 6);
            format!("never below {bound} {unit}{when} ({sure})")
        }
        None if least.distance > 0.0 => NO_BOUND.to_owned(),
        // It is only known that the bodies overlap, not how deeply.
        None => "the depth of the overlap has no bound".to_owned(),
    }
}

/// CSV: time, then one column of distances per judged pair, then one with its lower bound, empty if unknown.
pub fn to_csv(mechanism: &Mechanism, report: &ClearanceReport) -> String {
    let names = report.judged.iter().map(|p| body_names(mechanism, p));
    let names: Vec<String> = names.map(|names| names.join(" / ")).collect();
    let bounds = names.iter().map(|name| format!("{name} never below"));
    let mut heads = vec!["time".to_owned()];
    heads.extend(names.iter().cloned().chain(bounds));
    let mut text = String::new();
    push_header(&mut text, &heads);
    for (row, time) in report.times.iter().enumerate() {
        let pairs = report.judged.iter();
        let distances = pairs.clone().map(|p| p.distances.get(row).copied());
        let bounds = pairs.map(PairReport::known_bound);
        let numbers = std::iter::once(Some(*time)).chain(distances).chain(bounds);
        push_row(&mut text, numbers.map(TableCell::of));
    }
    text
}
