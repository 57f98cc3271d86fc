//! Constant parts of chains against products of 30 digits: what every stored pose says of its own error holds.

use crate::draws::Draws;
use mechanim::diag::Source;
use mechanim::model::chain::ChainStep;
use mechanim::model::fixed::FixedPose;
use mechanim::numbers::double_double::DoubleDouble;
use mechanim::scene::{Overrides, load_scene};
use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt::Write;

/// A number of about 31 digits.
type Long = DoubleDouble;

/// Columns of the rotation, then the translation.
type Exact = [[Long; 3]; 4];

fn long(v: f64) -> Long {
    Long::from(v)
}

/// The shortest decimal of a number, as decimal: its digits times a power of ten.
fn decimal(stored: f64) -> Long {
    // What is left out here is below all that is compared.
    if stored.abs() < 1e-200 {
        return long(stored);
    }
    let text = format!("{stored:e}");
    let (digits, power) = text.split_once('e').unwrap();
    let fraction = digits.split_once('.').map_or(0, |(_, behind)| behind.len());
    let power = power.parse::<i32>().unwrap() - fraction as i32;
    let whole: i64 = digits.replace('.', "").parse().unwrap();
    let upper = whole as f64;
    let whole = Long::sum(upper, (whole - upper as i64) as f64);
    let tens = |count: i32| {
        let two = [count.min(20), (count - 20).max(0)];
        Long::product(10.0_f64.powi(two[0]), 10.0_f64.powi(two[1]))
    };
    if power < 0 {
        quotient(whole, tens(-power))
    } else {
        whole * tens(power)
    }
}

/// Sine and cosine by their Taylor series: for angles up to ten the terms cancel to 27 digits.
fn sin_cos(angle: Long) -> [Long; 2] {
    let mut sums = [long(0.0), long(1.0)];
    let mut term = long(1.0);
    for k in 1..70 {
        term = quotient(term * angle, long(f64::from(k)));
        let signed = if k % 4 < 2 { term } else { -term };
        let sum = &mut sums[usize::from(k % 2 == 0)];
        *sum = *sum + signed;
    }
    sums
}

fn quotient(a: Long, b: Long) -> Long {
    let first = a.hi / b.hi;
    let rest = a - b * first;
    let second = rest.hi / b.hi;
    Long::sum(first, second) + long((rest - b * second).hi / b.hi)
}

fn root(square: Long) -> Long {
    let near = square.hi.sqrt();
    let next = Long::sum(near, (square - Long::product(near, near)).hi / (2.0 * near));
    next + long((square - next * next).hi / (2.0 * near))
}

fn product(a: &Exact, b: &Exact) -> Exact {
    let turned = |v: [Long; 3]| [0, 1, 2].map(|i| a[0][i] * v[0] + a[1][i] * v[1] + a[2][i] * v[2]);
    let moved = turned(b[3]);
    let shift = [0, 1, 2].map(|i| moved[i] + a[3][i]);
    [turned(b[0]), turned(b[1]), turned(b[2]), shift]
}

/// The rotation about any axis, by the formula of Rodrigues.
fn about(axis: [Long; 3], angle: Long) -> Exact {
    let length = root(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    let u = axis.map(|c| quotient(c, length));
    let [sin, cos] = sin_cos(angle);
    let mut exact = [[long(0.0); 3]; 4];
    for j in 0..3 {
        for i in 0..3 {
            exact[j][i] = u[i] * u[j] * (long(1.0) - cos);
        }
        let (b, c) = ((j + 1) % 3, (j + 2) % 3);
        exact[j][j] = exact[j][j] + cos;
        exact[j][b] = exact[j][b] + u[c] * sin;
        exact[j][c] = exact[j][c] - u[b] * sin;
    }
    exact
}

/// Rotation and translation by which a stored pose differs.
fn off(stored: &FixedPose, exact: &Exact) -> [f64; 2] {
    let columns = stored.rotation.to_cols_array_2d();
    let mut squares = [0.0; 2];
    for (j, column) in exact.iter().enumerate() {
        for (i, entry) in column.iter().enumerate() {
            let own = columns.get(j).map_or(stored.translation[i], |c| c[i]);
            squares[j / 3] += (*entry - long(own)).hi.powi(2);
        }
    }
    squares.map(f64::sqrt)
}

impl Draws {
    /// Any angle up to a turn, or one at or near a multiple of a quarter turn.
    fn angle(&mut self) -> f64 {
        let quarter = FRAC_PI_2 * (self.below(9) as f64 - 4.0);
        match self.below(5) {
            0 => quarter,
            1 => quarter + 1e-9 * self.number(),
            2 => quarter.next_up(),
            3 => 1e-5 * self.number(),
            _ => 2.0 * PI * self.number(),
        }
    }

    /// A factor as text, and the exact one that its decimals say.
    fn factor(&mut self) -> (String, Exact) {
        let zero = long(0.0);
        let unit = |k: usize| [0, 1, 2].map(|i| long(f64::from(i == k)));
        let identity = [unit(0), unit(1), unit(2), [zero; 3]];
        let axis = self.below(3);
        let name = ["x", "y", "z"][axis];
        match self.below(5) {
            0 => {
                let length = 10.0_f64.powi(self.below(7) as i32 - 3) * self.number();
                let mut exact = identity;
                exact[3][axis] = decimal(length);
                (format!("T{name}({length:e})"), exact)
            }
            1 => {
                let [x, y, z] = [0; 3].map(|_| self.number());
                let angle = self.angle();
                let u = [x, y, z].map(decimal);
                let text = format!("R({x:e}, {y:e}, {z:e}, {angle:e})");
                (text, about(u, decimal(angle)))
            }
            _ => {
                let angle = self.angle();
                let exact = about(unit(axis), decimal(angle));
                (format!("R{name}({angle:e})"), exact)
            }
        }
    }
}

fn inverse(a: &Exact) -> Exact {
    let turned = |v: [Long; 3]| [0, 1, 2].map(|k| a[k][0] * v[0] + a[k][1] * v[1] + a[k][2] * v[2]);
    let mut back = *a;
    for (j, column) in a[..3].iter().enumerate() {
        for (i, entry) in column.iter().enumerate() {
            back[i][j] = *entry;
        }
    }
    back[3] = turned(a[3]).map(|c| -c);
    back
}

/// The one pose that constant chains are folded to while a scene is resolved.
fn resolved(chain: &str) -> Option<FixedPose> {
    let text = format!(
        "units = {{ angle = \"rad\" }}\nduration = 1\ninputs = {{ a = 0 }}\nchains = {{ C = \"{chain}\" }}\n\
         bodies = [{{ name = \"b\", frame = \"Rz(a) C\" }}, {{ name = \"i\", frame = \"Rz(a) inv(C)\" }}]\n"
    );
    let name = "constant parts".into();
    let scene = load_scene(&Source { name, text }, &Overrides::default()).unwrap();
    let steps = &scene.mechanism.bodies[0].world_from_body.steps;
    match steps[..] {
        [_, ChainStep::Fixed(pose)] => Some(pose),
        _ => None,
    }
}

#[test]
fn stored_poses_are_no_farther_from_the_exact_ones_than_they_say() {
    let mut draws = Draws(11);
    let (mut tightest, mut loosest) = ([0.0_f64; 2], [0.0_f64; 2]);
    for round in 0..3000 {
        let count = [1, 2, 3, 5, 9, 40][round % 6];
        let mut text = String::new();
        let mut exact: Option<Exact> = None;
        for _ in 0..count {
            let (factor, own) = draws.factor();
            write!(text, "{factor} ").unwrap();
            exact = Some(exact.map_or(own, |e| product(&e, &own)));
        }
        let stored = resolved(&text).unwrap();
        let exact = exact.unwrap();
        let back = stored.inverse();
        for (pose, exact) in [(stored, exact), (back, inverse(&exact))] {
            let error = [pose.error.rotation, pose.error.translation];
            let found = off(&pose, &exact);
            for k in 0..2 {
                assert!(
                    found[k] <= error[k] + 1e-25,
                    "{text}: {found:?} above {error:?}"
                );
                if error[k] > 0.0 {
                    tightest[k] = tightest[k].max(found[k] / error[k]);
                }
                loosest[k] = loosest[k].max(error[k]);
            }
        }
    }
    // The worst case is nearly met, and no bound is far from what numbers of a scene leave open: forty factors with
    // angles up to a turn and lengths up to a thousand.
    assert!(tightest.iter().all(|t| *t > 0.8), "{tightest:?}");
    assert!(
        loosest[0] < 40.0 * 6.3 * 2e-15 && loosest[1] < 1e-9,
        "{loosest:?}"
    );
}

/// What was assumed of all fixed poses alike, 8.9e-16 radians in one place and 6e-15 in another, holds for neither.
#[test]
fn long_runs_of_constants_are_open_by_more_than_any_constant() {
    let run = |count: usize| resolved(&"Rx(0.7) Ry(-1.1) Tz(2.3) ".repeat(count)).unwrap();
    let [few, many] = [run(1), run(200)].map(|pose| pose.error.rotation);
    assert!(few < 3e-15 && many > 100.0 * few, "{few:e} {many:e}");
}

#[test]
fn quarter_turns_of_whole_numbers_are_exact() {
    let pose = resolved("Tx(3) R(0, 0, 2, 0) Ty(-4) Rx(0)").unwrap();
    assert_eq!([pose.error.rotation, pose.error.translation], [0.0, 0.0]);
    let pose = resolved("Tx(0.1) Ty(3)").unwrap();
    assert_eq!(pose.error.rotation, 0.0);
    assert!(pose.error.translation > 0.0 && pose.error.translation < 1e-16);
}
