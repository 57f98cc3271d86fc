//! Rates of any order against closed forms, against differences of solved poses, and as predictions.
// Published numbers keep the digits they were published with.
#![allow(clippy::excessive_precision)]

use crate::driven::{Driven, Model, add_derivatives, even_times, solve};
use mechanim::diag::Source;

use mechanim::kinematics::rates::columns::{RateColumns, RateVariable};
use mechanim::kinematics::rates::higher_order::higher_rates;
use mechanim::kinematics::results::trajectory::ClosedPose;
use mechanim::kinematics::solve::branch::BranchWatch;
use mechanim::kinematics::solve::newton::{Corrector, Pace};
use mechanim::kinematics::solve::predictor::{HIGHEST_ORDER, Predictor};
use mechanim::model::drive::Drive;

use crate::program::Workspace;
use crate::reference::{Table, mechanism};
use mechanim::model::mechanism::Mechanism;
use mechanim::numbers::series::TaylorSeries;
use mechanim::scene::builtin;
use std::f64::consts::FRAC_PI_2;

fn written(text: &str) -> Model {
    let source = Source {
        name: "test".to_owned(),
        text: text.to_owned(),
    };
    mechanism(&source, &[])
}

fn builtin_scene(name: &str, inputs: &[(&str, &str)]) -> Model {
    mechanism(&builtin::find_builtin(name).unwrap(), inputs)
}

fn slot(mechanism: &Mechanism, name: &str) -> usize {
    let unknowns = mechanism.unknowns.iter();
    unknowns.clone().position(|c| c.name == name).unwrap()
}

/// The pose at the start of the drive.
fn start(mechanism: &Model) -> Vec<f64> {
    let trajectory = solve(mechanism, &[0.0]).unwrap();
    let unknowns = &trajectory.samples[0].pose.as_ref().unwrap().unknowns;
    [unknowns.as_slice(), &mechanism.actuation.inputs_at(0.0)].concat()
}

/// Series of all coordinates by the first input at the start of the drive.
fn series_by_input(mechanism: &Model, order: usize) -> Vec<TaylorSeries> {
    let system = mechanism.system().unwrap();
    let value = mechanism.actuation.inputs_at(0.0)[0];
    let input = TaylorSeries::linear(value, 1.0, order);
    higher_rates(&system, &start(mechanism), &[input], order).unwrap()
}

fn binomial(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |b, j| b * (n - j) as f64 / (j + 1) as f64)
}

/// h = r cos phi + w with w² = L² - r² (1 - cos 2 phi) / 2, whose derivatives are cosines; those of w follow from
/// Leibniz' rule for w w.
fn stroke_derivatives(phi: f64, order: usize) -> Vec<f64> {
    let (r, rod) = (40.0_f64, 80.0_f64);
    let cosine = |frequency: f64, k: usize| {
        frequency.powi(k as i32) * (frequency * phi + k as f64 * FRAC_PI_2).cos()
    };
    let mut w = vec![(rod * rod - (r * phi.sin()).powi(2)).sqrt()];
    for k in 1..=order {
        let known: f64 = (1..k).map(|j| binomial(k, j) * w[j] * w[k - j]).sum();
        w.push((0.5 * r * r * cosine(2.0, k) - known) / (2.0 * w[0]));
    }
    (0..=order).map(|k| r * cosine(1.0, k) + w[k]).collect()
}

#[test]
fn the_slider_crank_has_the_derivatives_of_its_closed_form() {
    for phi in ["0.5", "2.0", "-1.3", "0"] {
        let mechanism = builtin_scene("slider-crank", &[("phi", phi)]);
        let series = series_by_input(&mechanism, 8);
        let h = &series[slot(&mechanism, "h")];
        let expected = stroke_derivatives(phi.parse().unwrap(), 8);
        for (k, expected) in expected.iter().enumerate() {
            let error = (h.derivative(k) - expected).abs();
            assert!(
                error < 1e-12 * 10.0_f64.powi(k as i32),
                "{phi} {k} {error:e}"
            );
        }
    }
}

#[test]
fn the_hooke_joint_has_the_derivatives_of_its_closed_form() {
    let mechanism = written(
        "units = { angle = \"rad\" }\n[inputs]\nt1 = 1\n[loops]\nA = \"Rz(t1) Ry(b) Rx(a) Rz(-t2) Ry(-pi/6)\"\n\
         [guess]\nb = 0.5\nt2 = 0.9\n",
    );
    let order = 6;
    let series = series_by_input(&mechanism, order);
    let (t, beta) = (1.0_f64, std::f64::consts::FRAC_PI_6);
    let (c, q) = (beta.cos(), beta.sin().powi(2));
    // t2' (1 - q/2 + q/2 cos 2t) = cos beta, differentiated by Leibniz' rule.
    let divisor = |k: i32| {
        let wave = 0.5 * q * 2.0_f64.powi(k) * (2.0 * t + f64::from(k) * FRAC_PI_2).cos();
        wave + if k == 0 { 1.0 - 0.5 * q } else { 0.0 }
    };
    let mut expected = vec![(c * t.tan()).atan(), c / divisor(0)];
    for k in 1..order {
        let known: f64 = (1..=k)
            .map(|j| binomial(k, j) * divisor(j as i32) * expected[k - j + 1])
            .sum();
        expected.push(-known / divisor(0));
    }
    for (k, expected) in expected.iter().enumerate() {
        let error = series[slot(&mechanism, "t2")].derivative(k) - expected;
        assert!(
            error.abs() < 1e-13 * 3.0_f64.powi(k as i32),
            "{k} {error:e}"
        );
    }
}

/// psi' = w with w sin psi = l / (a d), the cosine rule differentiated once; higher orders by Leibniz' rule.
fn arm_derivatives(l: f64, order: usize) -> Vec<f64> {
    let (a, b, h) = (1.0_f64, 2.0_f64, 0.5_f64);
    let d = b.hypot(h);
    let cosine = (a * a + d * d - l * l) / (2.0 * a * d);
    let psi = cosine.acos();
    let (mut s, mut c) = (vec![psi.sin()], vec![cosine]);
    let mut w = vec![l / (a * d * s[0])];
    for k in 1..order {
        let chain = |f: &[f64]| -> f64 {
            (0..k)
                .map(|j| binomial(k - 1, j) * f[j] * w[k - 1 - j])
                .sum()
        };
        let (next_s, next_c) = (chain(&c), -chain(&s));
        s.push(next_s);
        c.push(next_c);
        let known: f64 = (1..=k).map(|j| binomial(k, j) * s[j] * w[k - j]).sum();
        let right = if k == 1 { 1.0 / (a * d) } else { 0.0 };
        w.push((right - known) / s[0]);
    }
    let start = psi - h.atan2(b);
    [&[start], &w[..]].concat()
}

#[test]
fn the_lifting_arm_has_the_derivatives_of_its_closed_form() {
    for l in [1.3, 1.6128, 2.0, 2.9] {
        let mechanism = written(&format!(
            "units = {{ angle = \"rad\" }}\n[parameters]\na = 1\nb = 2\nh = 0.5\n[inputs]\nl = {l}\n[equations]\n\
             triangle = \"(a*cos(phi)-b)^2 + (a*sin(phi)+h)^2 - l^2\"\n[guess]\nphi = 1\n"
        ));
        let series = series_by_input(&mechanism, 6);
        let expected = arm_derivatives(l, 6);
        assert_eq!(expected.len(), 7);
        for (k, expected) in expected.iter().enumerate() {
            let error = (series[0].derivative(k) - expected).abs() / expected.abs().max(1.0);
            assert!(error < 1e-12 * 3.0_f64.powi(k as i32), "{l} {k} {error:e}");
        }
    }
    // At t = 0.28 of l = 8 t (1 - t), 17 digits.
    let known = arm_derivatives(1.6128, 2);
    assert!((known[0] - 0.62813072950769069).abs() < 1e-15);
    assert!((known[1] - 1.0208691411164752).abs() < 1e-14);
}

/// A formula in a joint, an equation, and a planar loop with more equations than unknowns.
#[test]
fn equations_and_formulas_take_part() {
    let mechanism = written(
        "units = { angle = \"rad\" }\n[inputs]\nphi = 0.7\n[equations]\nE = \"x*x - 4 - sin(phi)\"\n\
         [loops]\nA = \"Tx(3*exp(phi/3)) Rz(asin(phi/2)) Rz(-a) Tx(-y)\"\n[guess]\nx = 2\ny = 1\n",
    );
    let series = series_by_input(&mechanism, 3);
    let at = |name: &str, k: usize| series[slot(&mechanism, name)].derivative(k);
    let (phi, x) = (0.7_f64, (4.0 + 0.7_f64.sin()).sqrt());
    let first = phi.cos() / (2.0 * x);
    let second = (-phi.sin() - 2.0 * first * first) / (2.0 * x);
    let grown = 3.0 * (phi / 3.0).exp();
    let root = (1.0 - phi * phi / 4.0).sqrt();
    let expected = [
        ("x", 1, first),
        ("x", 2, second),
        ("x", 3, (-phi.cos() - 6.0 * first * second) / (2.0 * x)),
        ("y", 1, grown / 3.0),
        ("y", 3, grown / 27.0),
        ("a", 1, 0.5 / root),
        ("a", 2, phi / (8.0 * root.powi(3))),
    ];
    for (name, k, expected) in expected {
        let error = at(name, k) - expected;
        assert!(error.abs() < 1e-14, "{name} {k} {error:e}");
    }
}

/// The error of the polynomial of order 8 falls with the ninth power of the step.
#[test]
fn eight_orders_predict_solved_poses() {
    for (name, input, step) in [("slider-crank", "phi", 0.2), ("seven-r", "beta1", 0.1)] {
        let mechanism = builtin_scene(name, &[(input, "0")]);
        let series = series_by_input(&mechanism, 8);
        let radians = mechanism.angle_unit.radians.number();
        let error = |h: f64| {
            let text = format!("{:e}*t", h / radians);
            let moving = builtin_scene(name, &[(input, &text)]);
            let trajectory = solve(&moving, &[0.0, 1.0]).unwrap();
            let reached = &trajectory.samples[1].pose.as_ref().unwrap().unknowns;
            let errors = reached
                .iter()
                .enumerate()
                .map(|(k, q)| (series[k].value_at(h) - q).abs() / mechanism.scale_of(k));
            errors.fold(0.0, f64::max)
        };
        let (whole, half) = (error(step), error(0.5 * step));
        assert!(half > 1e-14 && whole < 1e-4, "{name}: {whole:e} {half:e}");
        let power = (whole / half).log2();
        assert!((8.0..10.5).contains(&power), "{name}: {whole:e} {half:e}");
    }
}

#[test]
fn the_gearshift_agrees_with_differences_of_its_motion() {
    let mechanism = builtin_scene("gearshift", &[]);
    let (time, h) = (0.5, 2e-3);
    let times: Vec<f64> = (-2..=2).map(|k| time + f64::from(k) * h).collect();
    let mut trajectory = solve(&mechanism, &[&[0.0], &times[..]].concat()).unwrap();
    let (order, by) = (2, RateVariable::Time);
    let columns = RateColumns { order, by };
    add_derivatives(&mechanism, &mut trajectory, columns);
    let headings = columns.headings(&mechanism);
    let poses: Vec<&ClosedPose> = trajectory.poses().skip(1).collect();
    let shown = |pose: &ClosedPose| -> Vec<f64> {
        let places = pose.traces.iter().flat_map(|p| p.to_array()).collect();
        [pose.unknowns.clone(), places, pose.outputs.clone()].concat()
    };
    let values: Vec<Vec<f64>> = poses.iter().map(|p| shown(p)).collect();
    let derivatives = &poses[2].derivatives;
    assert_eq!(derivatives.len(), headings.len());
    assert_eq!(derivatives.len(), 2 * values[0].len());
    for k in 0..values[0].len() {
        let f = |i: usize| values[i][k];
        let first = (f(0) - 8.0 * f(1) + 8.0 * f(3) - f(4)) / (12.0 * h);
        let second = (16.0 * (f(1) + f(3)) - 30.0 * f(2) - f(0) - f(4)) / (12.0 * h * h);
        for (j, difference) in [first, second].into_iter().enumerate() {
            let exact = derivatives[2 * k + j];
            let error = (exact - difference).abs() / (1.0 + exact.abs());
            assert!(
                error < 1e-6,
                "{}: {exact} {difference}",
                headings[2 * k + j].0
            );
        }
    }
    for (k, rate) in poses[2].rates.iter().enumerate() {
        assert!((rate - derivatives[2 * k]).abs() < 1e-6 * (1.0 + rate.abs()));
    }
}

/// Every order is the derivative of the one below: differences over nine points, whose error is of eighth order.
#[test]
fn six_orders_of_the_gearshift_agree_with_high_order_differences() {
    let mechanism = builtin_scene("gearshift", &[]);
    let (time, h) = (0.5, 8e-3);
    let times: Vec<f64> = (-4..=4).map(|k| time + f64::from(k) * h).collect();
    let mut trajectory = solve(&mechanism, &[&[0.0], &times[..]].concat()).unwrap();
    let (order, by) = (6, RateVariable::Time);
    let columns = RateColumns { order, by };
    add_derivatives(&mechanism, &mut trajectory, columns);
    let poses: Vec<&ClosedPose> = trajectory.poses().skip(1).collect();
    let weights = [-1.0 / 280.0, 4.0 / 105.0, -0.2, 0.8].map(|w| w / h);
    for unknown in 0..mechanism.unknowns.len() {
        let value = |i: usize, k: usize| match k {
            0 => poses[i].unknowns[unknown],
            _ => poses[i].derivatives[order * unknown + k - 1],
        };
        for k in 1..=order {
            let pairs = weights.iter().enumerate();
            let difference: f64 = pairs
                .map(|(j, w)| w * (value(5 + 3 - j, k - 1) - value(j, k - 1)))
                .sum();
            let exact = value(4, k);
            let largest = (0..9).map(|i| value(i, k).abs()).fold(1.0, f64::max);
            let error = (exact - difference).abs() / largest;
            let name = &mechanism.unknowns[unknown].name;
            assert!(error < 1e-7, "{name} {k}: {exact} {difference}");
        }
    }
}

#[test]
fn a_singular_pose_has_no_rates() {
    let mechanism = written(
        "units = { angle = \"rad\" }\n[inputs]\nphi = \"pi/2\"\n\
         [loops]\nA = \"Rz(phi) Tx(2) Rz(a) Tx(2) Rz(b) Tx(-h)\"\n[guess]\na = 3.1415926535897931\nb = -1.5707963267948966\n",
    );
    let system = mechanism.system().unwrap();
    let coordinates = [
        mechanism.actuation.guess.clone(),
        mechanism.actuation.inputs_at(0.0),
    ]
    .concat();
    let input = TaylorSeries::linear(FRAC_PI_2, 1.0, 2);
    assert_eq!(higher_rates(&system, &coordinates, &[input], 2), None);
}

/// beta2' by beta1 of the torus pair, 40-digit arithmetic; and second derivatives in the scene's own degrees.
#[test]
fn the_table_has_transfer_functions_in_the_units_of_the_scene() {
    let w = Workspace::new();
    let arguments = ["solve", "seven-r", "--out", "-", "--samples", "72"];
    let arguments = [
        &arguments[..],
        &["--format", "json", "--order", "2", "--per", "beta1"],
    ]
    .concat();
    let run = w.run(&arguments).exits(0);
    let document: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
    let samples = document["samples"].as_array().unwrap();
    let first = |k: usize| samples[k]["d(beta2)/d(beta1)"].as_f64().unwrap();
    let table = Table::read("torus_ref");
    let mut compared = 0;
    for row in 0..table.len() {
        let angle = table.value(row, "beta1_deg");
        if table.text(row, "mechanism") == "torus-torus" && angle % 5.0 == 0.0 && angle < 360.0 {
            let k = (angle / 5.0) as usize;
            assert!((first(k) - table.value(row, "k")).abs() < 1e-11, "{angle}");
            compared += 1;
        }
    }
    assert_eq!(compared, 72);
    // The central difference of the first derivative over ±5° is crude, but a factor of 57 stands out.
    let second = samples[10]["d2(beta2)/d(beta1)2"].as_f64().unwrap();
    let difference = (first(11) - first(9)) / 10.0;
    assert!(
        (second - difference).abs() < 0.1 * difference.abs(),
        "{second} {difference}"
    );
    let unknown = [
        "solve", "seven-r", "--out", "-", "--order", "1", "--per", "x",
    ];
    w.run(&unknown).exits(2).says(&["no input `x`", "beta1"]);
    w.run(&["solve", "seven-r", "--out", "-", "--order", "9"])
        .exits(2);
}

#[test]
fn rates_by_time_follow_the_drive() {
    let mut mechanism = builtin_scene("slider-crank", &[("phi", "0.5 + t*t")]);
    assert!(matches!(mechanism.actuation.drives[0], Drive::Formula(_)));
    mechanism.actuation.duration = 1.0;
    let mut trajectory = solve(&mechanism, &[0.0, 0.6]).unwrap();
    let (order, by) = (3, RateVariable::Time);
    add_derivatives(&mechanism, &mut trajectory, RateColumns { order, by });
    let pose = trajectory.poses().last().unwrap();
    let (k, d) = (slot(&mechanism, "h"), stroke_derivatives(0.5 + 0.36, 3));
    // Chain rule with phi' = 2t, phi'' = 2, phi''' = 0.
    let p = 1.2;
    let expected = [
        d[1] * p,
        d[2] * p * p + 2.0 * d[1],
        d[3] * p.powi(3) + 6.0 * d[2] * p,
    ];
    for (j, expected) in expected.iter().enumerate() {
        let error = pose.derivatives[3 * k + j] - expected;
        assert!(error.abs() < 1e-10, "{j} {error:e}");
    }
}

/// The rate of a drive is its derivative, not a difference, which a fast drive would show.
#[test]
fn rates_of_formula_drives_have_all_digits() {
    let mechanism = builtin_scene("slider-crank", &[("phi", "0.5 + 0.2*sin(200*t)")]);
    let trajectory = solve(&mechanism, &[0.0, 0.3, 0.6]).unwrap();
    let k = slot(&mechanism, "h");
    for sample in &trajectory.samples {
        let rate = sample.pose.as_ref().unwrap().rates[k];
        let expected =
            stroke_derivatives(sample.inputs[0], 1)[1] * 40.0 * (200.0 * sample.time).cos();
        let error = rate / expected - 1.0;
        assert!(error.abs() < 3e-13, "{error:e}");
    }
}

#[test]
fn a_mechanism_without_inputs_has_rates_of_zero() {
    let w = Workspace::new();
    w.write(
        "triangle.toml",
        "[loops]\nA = \"Tx(3) Rz(a) Tx(4) Rz(b) Tx(5) Rz(c)\"\n[guess]\na = 1.5\nb = 2\nc = 2\n",
    );
    let arguments = [
        "solve",
        "triangle.toml",
        "--order",
        "2",
        "--out",
        "-",
        "--format",
        "json",
    ];
    let run = w.run(&arguments).exits(0);
    let document: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
    for name in ["d(a)/dt", "d2(b)/dt2"] {
        assert_eq!(document["samples"][0][name].as_f64(), Some(0.0), "{name}");
    }
}

/// The inverse of a Newton step serves the pose it leads to; what is made with it is that of the pose itself.
#[test]
fn tangents_signs_and_singular_values_by_a_shared_inverse_are_those_of_the_pose() {
    let mechanism = builtin_scene("gearshift", &[]);
    let system = mechanism.system().unwrap();
    let trajectory = solve(&mechanism, &even_times(&mechanism, 300)).unwrap();
    let (n, first) = (mechanism.unknowns.len(), &trajectory.samples[0]);
    let mut here = [&first.pose.as_ref().unwrap().unknowns[..], &first.inputs].concat();
    let (mut shared, mut predictor) = (Corrector::new(&system), Predictor::default());
    let (mut watch, mut beside) = (BranchWatch::default(), 0);
    for sample in &trajectory.samples[1..] {
        let order = HIGHEST_ORDER;
        predictor.predict(&system, &mut shared, &mut here, &sample.inputs, order);
        assert!(shared.correct(&system, &mut here, Pace::Brisk).converged);
        let mut own = Corrector::new(&system);
        let state = watch.observe(&system, &mut shared, &here);
        let exact = BranchWatch::default().observe(&system, &mut own, &here);
        assert_eq!(state.signs, exact.signs);
        assert!((state.sigma_min / exact.sigma_min - 1.0).abs() < 2e-6);
        let tangent = |corrector: &mut Corrector| {
            let mut rates = vec![0.0; n + 2];
            rates[n..].copy_from_slice(&[1.0, 0.01]);
            corrector.tangent(&system, &here, &mut rates);
            rates
        };
        for (a, b) in tangent(&mut shared).iter().zip(tangent(&mut own)) {
            assert!((a - b).abs() < 1e-14, "{a} {b}");
        }
        let entry = |corrector: &Corrector, block| corrector.inverse(block).unwrap().at(0, 0);
        beside += (0..2)
            .filter(|b| entry(&shared, *b) != entry(&own, *b))
            .count();
    }
    assert!(beside > 300, "{beside}");
}

/// Rates of the columns at the first pose: NaN where there is none.
fn rates_at_start(mechanism: &Model, order: usize) -> Vec<(String, f64)> {
    let columns = RateColumns {
        order,
        by: RateVariable::Time,
    };
    let mut trajectory = solve(mechanism, &[0.0]).unwrap();
    add_derivatives(mechanism, &mut trajectory, columns);
    let names = columns.headings(&mechanism.mechanism).into_iter();
    let found = &trajectory.samples[0].pose.as_ref().unwrap().derivatives;
    names
        .map(|(name, _)| name)
        .zip(found.iter().copied())
        .collect()
}

/// Where the drive sets out from a dead centre unknowns go with the root of time; what is even in them has finite rates.
#[test]
fn rates_at_a_fold_are_one_sided_where_they_are_finite() {
    // x = r cos phi and h = r cos phi + sqrt(L^2 - r^2 sin^2 phi) are series in phi^2: dx/dh = 2/3, d2x/dh2 = -1/360.
    let crank = written(
        "duration = 1\nunits = { angle = \"rad\" }\n[inputs]\nh = \"120 - t\"\n\
         [loops]\nA = \"Rz(phi) Tx(40) Rz(alpha) Tx(80) Rz(beta) Tx(-h)\"\n[guess]\nphi = 0.1\n\
         [outputs]\nx = \"40*cos(phi)\"\nodd = \"sin(phi)\"\n",
    );
    let rates = rates_at_start(&crank, 2);
    let of = |name: &str| rates.iter().find(|(n, _)| n == name).unwrap().1;
    assert!((of("d(x)/dt") + 2.0 / 3.0).abs() < 1e-9, "{rates:?}");
    assert!((of("d2(x)/dt2") + 1.0 / 360.0).abs() < 1e-9, "{rates:?}");
    for infinite in ["d(phi)/dt", "d(alpha)/dt", "d2(beta)/dt2", "d(odd)/dt"] {
        assert!(of(infinite).is_nan(), "{infinite}: {rates:?}");
    }
    // The rope leaves the drum: phi' = -sqrt(u^2 - 1)/u vanishes at u = 1, and goes with the root of time.
    let drum = rates_at_start(&builtin_scene("rope-drum", &[]), 2);
    let of = |name: &str| drum.iter().find(|(n, _)| n == name).unwrap().1;
    assert!(of("d(phi)/dt").abs() < 1e-9, "{drum:?}");
    for infinite in ["d2(phi)/dt2", "d(gamma)/dt", "d(s)/dt"] {
        assert!(of(infinite).is_nan(), "{infinite}: {drum:?}");
    }
    // Where two branches cross, here the parallelogram and its crossed form, nothing is determined.
    let crossing = written(
        "duration = 1\nunits = { angle = \"rad\" }\n[inputs]\nphi = \"t\"\n\
         [loops]\nA = \"Rz(phi) Tx(40) Rz(a) Tx(100) Rz(b) Tx(-40) Rz(c) Tx(-100)\"\n",
    );
    assert!(rates_at_start(&crossing, 1).is_empty());
}
