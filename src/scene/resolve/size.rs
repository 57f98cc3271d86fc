//! The characteristic length of a mechanism, to which tolerances are relative.

use super::names::Names;
use crate::model::actuation::{Actuation, INSTANTS};
use crate::model::chain::{Argument, ChainStep, ElementaryMotion};
use crate::model::drive::Drive;
use crate::model::equation_terms::finite_or_zero;
use crate::model::expression::Expression;
use crate::model::mechanism::{Closes, Equation, Kind, Loop, Mechanism};
use crate::numbers::interval::Interval;

/// Values at a few instants are taken for a drive's largest unless it is proved to be able to exceed them this many times:
/// a short pulse may lie between all of them.
const FAR_BEYOND: f64 = 100.0;

/// Places this many times as far from the origin as any length between joints is long say where the mechanism is, not how large.
const FAR_PLACE: f64 = 1024.0;

/// Most parts of time that are looked at for the largest value.
const MOST_PARTS: usize = 400;

/// The characteristic length: the longest bar or fixed offset between two joints of its loops; otherwise the largest
/// length parameter, driven length, constant of a chain or known term of an equation between lengths; otherwise the largest term
/// of such an equation at the start values; otherwise the largest lead of a screw; otherwise one.
pub(super) fn mechanism_size(
    mechanism: &Mechanism,
    (actuation, poses): (&Actuation, &[Vec<f64>]),
    names: &Names,
) -> f64 {
    // Fixed offsets and bars are the most reliable lengths: they do not depend on a pose.
    let bars = || mechanism.bars.iter().filter_map(|bar| bar.length);
    let [all, own] = [true, false].map(|with_places| {
        let loops = mechanism.loops.iter();
        let fixed = loops.flat_map(|item| fixed_offsets(item, with_places));
        fixed.chain(bars()).fold(0.0, f64::max)
    });
    let is_far = own > 0.0 && all > FAR_PLACE * own;
    let longest = if is_far { own } else { all };
    if longest > 0.0 {
        return longest;
    }
    // Without them: length parameters, driven lengths, and constants in chains, bars of variable length and equations.
    let parameters = names
        .parameters
        .iter()
        .filter(|p| p.kind == Some(Kind::Length))
        .map(|p| p.value.number().abs());
    let drives = mechanism.inputs.iter().zip(&actuation.drives);
    let driven = drives.filter(|(c, _)| c.kind == Kind::Length);
    let inputs = driven.map(|(_, drive)| largest_driven(drive, actuation.duration));
    let bare: Vec<Vec<f64>> = poses.iter().map(|pose| unmoved(mechanism, pose)).collect();
    let known = parameters
        .chain(inputs)
        .chain(chain_constants(mechanism))
        .chain(equation_lengths(
            mechanism,
            &bare,
            Equation::largest_summand,
        ));
    let finite = known.filter(|v| v.is_finite());
    let longest = finite.fold(0.0, f64::max);
    if longest > 0.0 {
        return longest;
    }
    // Contacts and bars alone, with their radii and lengths in formulas.
    let longest = equation_lengths(mechanism, poses, Equation::terms).fold(0.0, f64::max);
    if longest > 0.0 {
        return longest;
    }
    // A mechanism of screws alone has no length but its leads.
    let longest = screw_leads(mechanism).fold(0.0, f64::max);
    if longest > 0.0 { longest } else { 1.0 }
}

/// The lengths of the fixed offsets in a loop. That between the origin and a point whose coordinates lead the loop is a place.
fn fixed_offsets(item: &Loop, with_places: bool) -> impl Iterator<Item = f64> {
    let slides = item.chain.steps.iter().map_while(|step| match step {
        ChainStep::Joint {
            motion: ElementaryMotion::Translation,
            axis,
            ..
        } => Some(*axis),
        _ => None,
    });
    let slides: Vec<usize> = match (with_places, item.closes) {
        (false, Closes::Point) => slides.collect(),
        _ => Vec::new(),
    };
    let place = slides.len();
    let steps = item.chain.steps.iter().enumerate();
    steps.filter_map(move |(k, step)| match step {
        ChainStep::Fixed(pose) => {
            let mut offset = pose.translation;
            if k == place {
                slides.iter().for_each(|axis| offset[*axis] = 0.0);
            }
            Some(offset.length())
        }
        ChainStep::Joint { .. } => None,
    })
}

/// Lengths written as numbers in chains: fixed offsets of bodies, and constants added to variable ones.
fn chain_constants(mechanism: &Mechanism) -> impl Iterator<Item = f64> {
    let loops = mechanism.loops.iter().map(|l| &l.chain);
    let chains = loops.chain(mechanism.bodies.iter().map(|b| &b.world_from_body));
    chains.flat_map(|chain| chain.written_lengths(&mechanism.arguments))
}

/// A pose with its inputs, and all unknowns zero: what is left of an equation does not depend on start values.
fn unmoved(mechanism: &Mechanism, pose: &[f64]) -> Vec<f64> {
    let mut pose = pose.to_vec();
    pose[..mechanism.unknowns.len()].fill(0.0);
    pose
}

/// The largest terms of the equations at some poses, as lengths.
fn equation_lengths(
    mechanism: &Mechanism,
    poses: &[Vec<f64>],
    terms: fn(&Equation, &mut [f64]) -> f64,
) -> impl Iterator<Item = f64> {
    let of_lengths = mechanism
        .equations
        .iter()
        .filter(|e| e.length_exponent > 0.0);
    let pairs = of_lengths.flat_map(|equation| poses.iter().map(move |pose| (equation, pose)));
    pairs.map(move |(equation, pose)| {
        let terms = terms(equation, &mut pose.clone());
        libm::pow(terms, 1.0 / equation.length_exponent)
    })
}

/// Advance per turn of all translations that follow an angle.
fn screw_leads(mechanism: &Mechanism) -> impl Iterator<Item = f64> {
    let steps = mechanism.loops.iter().flat_map(|l| &l.chain.steps);
    let arguments = steps.filter_map(|step| match step {
        ChainStep::Joint {
            motion: ElementaryMotion::Translation,
            argument,
            ..
        } => Some(&mechanism.arguments[*argument]),
        _ => None,
    });
    let terms = arguments.flat_map(|argument| match argument {
        Argument::Affine(affine) => affine.terms.as_slice(),
        Argument::Formula(_) => &[],
    });
    let kind_of = |slot: usize| {
        let mut coordinates = mechanism.unknowns.iter().chain(&mechanism.inputs);
        coordinates.nth(slot).map(|c| c.kind)
    };
    terms
        .filter(move |(slot, _)| kind_of(*slot) == Some(Kind::Angle))
        .map(|(_, factor)| factor.number().abs() * std::f64::consts::TAU)
}

/// The largest value of a drive, but for a factor of a hundred: at a few instants, and where it may be far larger than there.
fn largest_driven(drive: &Drive, duration: f64) -> f64 {
    let at = |time: f64| finite_or_zero(drive.value(time));
    let known = INSTANTS.map(|share| at(share * duration));
    let sampled = known.into_iter().fold(0.0, f64::max);
    let largest = match drive {
        Drive::Formula(formula) => largest_found(formula, sampled, duration),
        Drive::Keys { .. } => {
            let values = drive.keys().iter().map(|time| at(*time));
            values.fold(sampled, f64::max)
        }
    };
    if largest > FAR_BEYOND * sampled {
        largest
    } else {
        sampled
    }
}

/// The largest value of a formula that is found where it may be far larger than is `known`.
fn largest_found(formula: &Expression, mut known: f64, duration: f64) -> f64 {
    // The part that may hold the largest value is halved, until no part may hold a far larger one than is known.
    let most = |[from, to]: [f64; 2]| {
        // Beside a kink nothing may be known of the range: it stays open until parts are short.
        let range = formula.range(&[Interval::new(from, to)]);
        let most = range.map_or(0.0, |range| range.magnitude());
        if most.is_nan() { f64::INFINITY } else { most }
    };
    let whole = [0.0, duration];
    let mut parts = vec![(most(whole), whole)];
    for _ in 0..MOST_PARTS {
        let place = (0..parts.len()).max_by(|a, b| parts[*a].0.total_cmp(&parts[*b].0));
        let Some(place) = place.filter(|place| parts[*place].0 > FAR_BEYOND * known) else {
            break;
        };
        let (_, [from, to]) = parts.swap_remove(place);
        let middle = 0.5 * from + 0.5 * to;
        known = known.max(finite_or_zero(formula.value_at_instant(middle)));
        parts.extend([[from, middle], [middle, to]].map(|part| (most(part), part)));
    }
    known
}

#[cfg(test)]
#[allow(clippy::panic)]
mod tests {
    use crate::diag::Source;
    use crate::scene::{Overrides, load_scene};

    /// Tolerances are relative to the size, so it must not depend on how a length is written.
    #[test]
    fn the_size_is_known_however_lengths_are_written() {
        let drive = "duration = 1\n[inputs]\nx = \"0.001*t\"\n";
        let body = |chain: &str| format!("{drive}[[bodies]]\nname = \"a\"\nframe = \"{chain}\"\n");
        let cases = [
            (body("Tx(2 + x)"), 2.0),
            (body("Tx(2) Tx(x)"), 2.0),
            (body("Tx(x) Ty(-3)"), 3.0),
            // Pulses between the instants at which lengths are looked at, and a key there.
            (
                body("Tx(x)").replace("0.001*t", "0.5*exp(-(1000*(t - 0.375))^2)"),
                0.5,
            ),
            (
                body("Tx(x)").replace("0.001*t", "7*max(0, 1 - 512*abs(t - 0.625))"),
                7.0,
            ),
            (
                body("Tx(x)").replace(
                    "\"0.001*t\"",
                    "{ keys = [[0, 0], [0.5, 6], [0.501, 0], [1, 0]], ease = \"step\" }",
                ),
                6.0,
            ),
            (body("Tx(a + x)") + "[parameters]\na = 5\n", 5.0),
            (
                format!("{drive}[loops]\nA = \"Tx(x) Tx(4) Tx(-y)\"\n[guess]\ny = 4\n"),
                4.0,
            ),
            (
                format!(
                    "{drive}[chains]\nP = \"Tx(y)\"\n[bars]\nb = {{ from = \"P\", to = [0, 0], length = \"8 + x\" }}\n"
                ),
                8.0,
            ),
            (
                format!(
                    "{drive}[bars]\nb = {{ from = \"P\", to = [0, 0], length = \"0.5 + x\" }}\n[chains]\nP = \"Tx(y) Ty(z)\"\n[equations]\ne = \"y^2 + z^2 - (9 + x)^2\"\n"
                ),
                9.0,
            ),
        ];
        for (text, wanted) in cases {
            let source = Source {
                name: "size".to_owned(),
                text: text.clone(),
            };
            let scene =
                load_scene(&source, &Overrides::default()).unwrap_or_else(|e| panic!("{e} {text}"));
            let size = scene.mechanism.size;
            assert!((size / wanted - 1.0).abs() < 1e-3, "{size} {text}");
        }
    }
}
