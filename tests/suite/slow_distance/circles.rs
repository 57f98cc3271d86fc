//! The signed distance of a circle from any core: the least over its angle.
//!
//! The circle is sampled densely: a distance changes by no more than the way along the circle, so that between two
//! samples that are high enough nothing is hidden, and all others come to lie 1/8192 of a turn apart. Around every dip
//! the least is bracketed by the golden section, first in f64, then in the longer arithmetic.

use super::number::{Number, Vector};
use super::solids::{Circle, Solid};
use mechanim::numbers::double_double::DoubleDouble;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

const COARSEST: usize = 128;
const FINEST: usize = 8_192;

/// Distances along a circle have at most eight stationary points a pair of circles, a few more for edges; more dips than
/// this are rounding.
const MOST_DIPS: usize = 12;

/// The golden section.
const SHARE: f64 = 0.618_033_988_749_894_9;

/// Brackets in radians that f64 still tells apart by the values, and that the longer arithmetic ends with.
const BRACKETS: [f64; 2] = [1e-5, 1e-17];

/// The point of a circle that lies by `by` (the tangent of an angle) farther than an angle.
fn point<N: Number>(circle: &Circle<N>, angle: f64, by: N) -> Vector<N> {
    let (sin, cos) = angle.sin_cos();
    let (sin, cos) = (N::from(sin), N::from(cos));
    let (x, y) = (cos - sin * by, sin + cos * by);
    let scale = circle.radius.over((x * x + y * y).root());
    circle.centre + circle.across[0] * (x * scale) + circle.across[1] * (y * scale)
}

/// Steps of the golden section after which both places are taken anew: what rounding shifts them grows with every step.
const STEPS: usize = 12;

/// Narrows a bracket; returns it with the least value met.
fn golden<N: Number>([mut low, mut high]: [N; 2], width: f64, f: impl Fn(N) -> N) -> ([N; 2], N) {
    let share = N::from(SHARE);
    let mut least = f((low + high) * N::from(0.5));
    while (high - low).rounded() > width {
        let mut p = high - (high - low) * share;
        let mut q = low + (high - low) * share;
        let (mut at_p, mut at_q) = (f(p), f(q));
        for _ in 0..STEPS {
            least = least.lesser(at_p).lesser(at_q);
            if at_p.is_below(at_q) {
                (high, q, at_q) = (q, p, at_p);
                p = high - (high - low) * share;
                at_p = f(p);
            } else {
                (low, p, at_p) = (p, q, at_q);
                q = low + (high - low) * share;
                at_q = f(q);
            }
        }
    }
    ([low, high], least)
}

/// Values at places of the finest grid, where they are wanted.
struct Samples<'a> {
    known: BTreeMap<usize, f64>,
    f: &'a dyn Fn(f64) -> f64,
}

impl Samples<'_> {
    fn at(&mut self, place: usize) -> f64 {
        let f = self.f;
        let place = place % FINEST;
        *self
            .known
            .entry(place)
            .or_insert_with(|| f(TAU * place as f64 / FINEST as f64))
    }
}

/// Places on the finest grid that are lower than both neighbours and may be the least, the lowest first.
fn dips(radius: f64, f: &dyn Fn(f64) -> f64) -> Vec<usize> {
    let known = BTreeMap::new();
    let mut samples = Samples { known, f };
    let mut stride = FINEST / COARSEST;
    let mut starts: Vec<usize> = (0..COARSEST).map(|k| k * stride).collect();
    loop {
        let mut low = f64::INFINITY;
        for start in &starts {
            low = low.min(samples.at(*start));
        }
        let way = radius * TAU * stride as f64 / FINEST as f64;
        starts.retain(|k| {
            let (a, b) = (samples.at(*k), samples.at(*k + stride));
            0.5 * (a + b - way) <= low
        });
        if stride == 1 {
            break;
        }
        stride /= 2;
        starts = starts.iter().flat_map(|k| [*k, *k + stride]).collect();
    }
    let mut places: Vec<usize> = starts
        .iter()
        .flat_map(|k| [*k, (*k + 1) % FINEST])
        .collect();
    places.sort_unstable();
    places.dedup();
    places.retain(|k| {
        let here = samples.at(*k);
        here <= samples.at(*k + FINEST - 1) && here <= samples.at(*k + 1)
    });
    places.sort_by(|a, b| samples.at(*a).total_cmp(&samples.at(*b)));
    places.truncate(MOST_DIPS);
    places
}

/// The least signed distance of a circle's points from another core.
pub fn least(
    circle: &Circle<f64>,
    exact: &Circle<DoubleDouble>,
    other: &Solid<f64>,
    other_exact: &Solid<DoubleDouble>,
) -> DoubleDouble {
    let f = |angle: f64| other.to_point(point(circle, angle, 0.0));
    let around = TAU / FINEST as f64;
    let found: Vec<(f64, [f64; 2], f64)> = dips(circle.radius, &f)
        .into_iter()
        .map(|place| {
            let angle = around * place as f64;
            let f = |by: f64| other.to_point(point(circle, angle, by));
            let (bracket, value) = golden([-around, around], BRACKETS[0], f);
            (angle, bracket, value)
        })
        .collect();
    let low = found.iter().map(|d| d.2).fold(f64::INFINITY, f64::min);
    let mut least: Option<DoubleDouble> = None;
    for (angle, [from, to], value) in found {
        let pad = to - from;
        // No value of the bracket is lower by more than the way through it.
        if value - circle.radius * pad > low {
            continue;
        }
        let f = |by: DoubleDouble| other_exact.to_point(point(exact, angle, by));
        let bracket = [from - pad, to + pad].map(DoubleDouble::from);
        let (_, value) = golden(bracket, BRACKETS[1], f);
        least = Some(least.map_or(value, |least| least.lesser(value)));
    }
    let Some(least) = least else {
        panic!("a circle has a lowest sample");
    };
    least
}
