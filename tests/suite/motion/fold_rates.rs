//! Rates at and beside folds of any order: what is printed is the derivative of a closed form, one-sided at the fold itself,
//! or nothing.
//!
//! In every case the quantities are functions of the way s from the fold, most of them powers, so that all derivatives are known.

use crate::driven::{Driven, Model, add_derivatives, solve};
use crate::reference::mechanism;
use mechanim::diag::Source;
use mechanim::kinematics::rates::columns::{RateColumns, RateVariable};

/// The k-th derivative by s at s.
type Exact = Box<dyn Fn(usize, f64) -> f64>;

/// Where rates are looked at, as ways from the fold.
const WAYS: [f64; 9] = [0.0, 1e-15, 1e-13, 1e-12, 1e-9, 1e-6, 1e-3, 0.3, 0.5];

/// Highest order.
const ORDER: usize = 4;

/// `factor` times the power of s.
fn power(factor: f64, exponent: f64) -> Exact {
    Box::new(move |k, s| {
        let falling: f64 = (0..k).map(|j| exponent - j as f64).product();
        if falling == 0.0 {
            return 0.0;
        }
        factor * falling * s.powf(exponent - k as f64)
    })
}

/// A case: a scene, how s follows from the time, and what its columns are.
struct Case {
    name: String,
    text: String,
    /// s = origin + sign t.
    origin: f64,
    sign: f64,
    columns: Vec<(&'static str, Exact)>,
    /// Columns that must have all their finite rates at the fold, too.
    given: Vec<&'static str>,
}

/// The scene's rates at the ways from the fold: (s, values by name and order).
fn checked(case: &Case) -> usize {
    let source = Source {
        name: case.name.clone(),
        text: case.text.clone(),
    };
    let model: Model = mechanism(&source, &[]);
    let columns = RateColumns {
        order: ORDER,
        by: RateVariable::Time,
    };
    let mut times: Vec<f64> = WAYS.map(|s| (s - case.origin) / case.sign).to_vec();
    times.sort_by(f64::total_cmp);
    let mut trajectory = solve(&model, &times).unwrap();
    add_derivatives(&model, &mut trajectory, columns);
    let names: Vec<String> = columns
        .headings(model.mechanism())
        .into_iter()
        .map(|(name, _)| name)
        .collect();
    let mut seen = 0;
    for sample in &trajectory.samples {
        let Some(pose) = &sample.pose else { continue };
        let s = (case.origin + case.sign * sample.time).max(0.0);
        for (column, exact) in &case.columns {
            for k in 1..=ORDER {
                let digit = if k == 1 { String::new() } else { k.to_string() };
                let wanted = format!("d{digit}({column})/dt{digit}");
                let index = names.iter().position(|n| *n == wanted).unwrap();
                let value = pose.derivatives.get(index).copied().unwrap_or(f64::NAN);
                let exact = exact(k, s) * case.sign.powi(k as i32);
                let at = format!("{}: {wanted} at s = {s:e}: {value} {exact}", case.name);
                if value.is_nan() {
                    // Nothing may be missing away from the fold, nor what is said to be there.
                    assert!(s < 1e-5, "{at}");
                    let is_due = exact.is_finite() && case.given.contains(column) && s == 0.0;
                    assert!(!is_due, "{at}");
                    continue;
                }
                seen += 1;
                // A pose is closed to rounding, of which its rates get so much more, the nearer the fold is.
                let size =
                    exact.abs() + (0..=ORDER).map(|j| exact_at(case, column, j)).sum::<f64>();
                // What is finite is left of terms that grow as their order's power of the way, and has their rounding.
                let beside = if s > 0.0 { s.powi(-(k as i32)) } else { 0.0 };
                let allowed =
                    size * (1e-7 + 1e-14 * beside) + exact.abs() * 1e-13 * k as f64 / s.max(1e-300);
                assert!(
                    value.is_finite() && (value - exact).abs() <= allowed,
                    "{at}"
                );
            }
        }
    }
    seen
}

/// How large a column's finite rates are away from the fold.
fn exact_at(case: &Case, column: &str, order: usize) -> f64 {
    let exact = &case
        .columns
        .iter()
        .find(|(name, _)| *name == column)
        .unwrap()
        .1;
    exact(order, 0.5).abs()
}

/// `x^n = c s`, for s rising and falling in time and ending in the middle of a motion.
fn powers() -> Vec<Case> {
    let mut cases = Vec::new();
    for n in [2, 3, 4] {
        for c in [1e-6, 1.0, 1e6] {
            for (way, origin, sign, s) in [
                ("start", 0.0, 1.0, "t"),
                ("end", 0.5, -1.0, "(0.5 - t)"),
                ("middle", 0.5, -1.0, "(0.5 - t)"),
            ] {
                let duration = if way == "middle" { 1.0 } else { 0.5 };
                let guess = 0.7 * f64::powf(c, 1.0 / n as f64);
                let guess = if way == "start" { 1e-3 * guess } else { guess };
                let text = format!(
                    "duration = {duration}\n[inputs]\np = \"{c:e}*{s}\"\n[equations]\n\
                     e = \"x^{n} - p\"\n[guess]\nx = {guess:e}\n[outputs]\nz = \"x^{n}\"\n\
                     w = \"x^{}\"\nu = \"x^{}\"\n",
                    2 * n,
                    n + 1
                );
                let share = |m: i32| {
                    let exponent = f64::from(m) / n as f64;
                    power(f64::powf(c, exponent), exponent)
                };
                cases.push(Case {
                    name: format!("x^{n} = {c:e} s, {way}"),
                    text,
                    origin,
                    sign,
                    columns: vec![
                        ("x", share(1)),
                        ("z", share(n)),
                        ("w", share(2 * n)),
                        ("u", share(n + 1)),
                    ],
                    given: if n == 2 { vec!["z", "w"] } else { Vec::new() },
                });
            }
        }
    }
    cases
}

/// Planar loops: two equal bars with one unknown, and a crank driven by its slider, in millimetres, metres and worse.
fn loops() -> Vec<Case> {
    let mut cases = Vec::new();
    for (unit, r) in [("mm", 40.0), ("m", 0.04), ("m", 4e-5), ("mm", 4e7)] {
        let head = format!("duration = 0.5\nunits = {{ length = \"{unit}\", angle = \"rad\" }}\n");
        // h = 2 r cos phi.
        cases.push(Case {
            name: format!("two bars of {r:e} {unit}"),
            text: format!(
                "{head}[inputs]\nh = \"{r:e}*(2 - t)\"\n[loops]\n\
                 A = \"Rz(phi) Tx({r:e}) Rz(-2*phi) Tx({r:e}) Rz(phi) Tx(-h)\"\n[guess]\nphi = 0.1\n\
                 [outputs]\nc = \"cos(phi)\"\nodd = \"sin(phi)\"\n"
            ),
            origin: 0.0,
            sign: 1.0,
            columns: vec![
                ("c", Box::new(|k, s| [1.0 - 0.5 * s, -0.5][k.min(1)] * f64::from(u8::from(k < 2)))),
                // A semicircle: y = sqrt(s - s²/4), two derivatives of it.
                (
                    "odd",
                    Box::new(semicircle),
                ),
            ],
            given: vec!["c"],
        });
        // x = h/2 + (r² - L²)/(2 h), L = 2 r, h = r (3 - s).
        cases.push(Case {
            name: format!("crank of {r:e} {unit}"),
            text: format!(
                "{head}[inputs]\nh = \"{r:e}*(3 - t)\"\n[loops]\n\
                 A = \"Rz(phi) Tx({r:e}) Rz(alpha) Tx({l:e}) Rz(beta) Tx(-h)\"\n[guess]\nphi = 0.1\n\
                 [outputs]\nx = \"cos(phi)\"\nfast = \"sin(1e4*phi)\"\n",
                l = 2.0 * r
            ),
            origin: 0.0,
            sign: 1.0,
            columns: vec![
                (
                    "x",
                    Box::new(|k, s| {
                        let h = 3.0 - s;
                        let factorial: f64 = (1..=k).map(|j| j as f64).product();
                        let straight = [0.5 * h, -0.5].get(k).copied().unwrap_or(0.0);
                        straight - 1.5 * factorial / h.powi(k as i32 + 1)
                    }),
                ),
            ],
            given: vec!["x"],
        });
    }
    cases
}

/// Derivatives of sqrt(s - s²/4) up to the fourth: y y' = (1 - s/2)/2 and so on.
fn semicircle(k: usize, s: f64) -> f64 {
    let mut y = vec![(s - 0.25 * s * s).sqrt()];
    let square = [s - 0.25 * s * s, 1.0 - 0.5 * s, -0.5, 0.0, 0.0];
    let binomial =
        |n: usize, j: usize| (0..j).fold(1.0, |b, i| b * (n - i) as f64 / (i + 1) as f64);
    for n in 1..=k {
        let known: f64 = (1..n).map(|j| binomial(n, j) * y[j] * y[n - j]).sum();
        y.push((square[n] - known) / (2.0 * y[0]));
    }
    match y[k].is_nan() {
        true => f64::INFINITY,
        false => y[k],
    }
}

/// Two blocks at one instant, beside each other and in a row; drives that rest there; crossings.
fn others() -> Vec<Case> {
    let case = |name: &str, text: &str, columns: Vec<(&'static str, Exact)>| Case {
        name: name.to_owned(),
        text: format!("duration = 0.5\n{text}"),
        origin: 0.0,
        sign: 1.0,
        columns,
        given: Vec::new(),
    };
    vec![
        case(
            "two folds beside each other",
            "[inputs]\np = \"t\"\n[equations]\ne = \"x^2 - p\"\nf = \"y^2 - 2*p\"\n[guess]\nx = 0.01\ny = 0.01\n\
             [outputs]\nz = \"x*y\"\n",
            vec![
                ("x", power(1.0, 0.5)),
                ("y", power(2f64.sqrt(), 0.5)),
                ("z", power(2f64.sqrt(), 1.0)),
            ],
        ),
        case(
            "a fold behind a fold",
            "[inputs]\np = \"t\"\n[equations]\ne = \"x^2 - p\"\nf = \"y^2 - x\"\n[guess]\nx = 0.01\ny = 0.1\n\
             [outputs]\nz = \"y^4\"\n",
            vec![
                ("x", power(1.0, 0.5)),
                ("y", power(1.0, 0.25)),
                ("z", power(1.0, 1.0)),
            ],
        ),
        case(
            "a drive at rest",
            "[inputs]\np = \"t^2\"\n[equations]\ne = \"x^2 - p\"\n[guess]\nx = 0.01\n[outputs]\nz = \"x^2\"\n",
            vec![("x", power(1.0, 1.0)), ("z", power(1.0, 2.0))],
        ),
        case(
            "a drive at rest to the third order",
            "[inputs]\np = \"t^3\"\n[equations]\ne = \"x^2 - p\"\n[guess]\nx = 0.01\n[outputs]\nz = \"x^2\"\n",
            vec![("x", power(1.0, 1.5)), ("z", power(1.0, 3.0))],
        ),
        case(
            "a steep equation that is regular",
            "[inputs]\np = \"t\"\n[equations]\ne = \"x - 1e9*p\"\nf = \"y - 1e-9*p\"\n",
            vec![("x", power(1e9, 1.0)), ("y", power(1e-9, 1.0))],
        ),
    ]
}

#[test]
fn printed_rates_are_those_of_the_closed_form_or_empty() {
    let cases = powers().into_iter().chain(loops()).chain(others());
    let (mut faults, mut seen) = (Vec::new(), 0);
    for case in cases {
        let run = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| checked(&case)));
        match run {
            Ok(found) => seen += found,
            Err(panic) => {
                let text = panic.downcast_ref::<String>().cloned();
                faults.push(text.unwrap_or_else(|| case.name.clone()));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(seen > 1500, "{seen}");
}
