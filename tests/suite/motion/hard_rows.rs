//! Long rows of loops, written as a user would generate them: nothing is lost on the way to the hundredth.
// Published numbers keep the digits they were published with.
#![allow(clippy::excessive_precision)]

use crate::driven::{Driven, Model, even_times, solve};
use mechanim::diag::Source;
use mechanim::kinematics::results::certificate::Certificate;

use mechanim::kinematics::rates::higher_order::higher_rates;

use crate::reference::{hard, mechanism, slot, turned};
use mechanim::numbers::series::TaylorSeries;
use std::fmt::Write;

fn written(text: String) -> Model {
    let name = "row".to_owned();
    mechanism(&Source { name, text }, &[])
}

/// The output angle of a drag link a = 100, b = 90, c = 80 on a base of 40.
fn drag(phi: f64) -> f64 {
    let (x, y) = (100.0 * phi.cos() - 40.0, 100.0 * phi.sin());
    let reach = x.hypot(y);
    y.atan2(x) - ((reach * reach + 6400.0 - 8100.0) / (160.0 * reach)).acos()
}

/// `n` drag links in a row from phi = 1 on, with start values right to a tenth.
fn drag_links(n: usize, drive: &str) -> Model {
    let mut text = format!("duration = 4\n[inputs]\nphi = \"{drive}\"\n[loops]\n");
    let (mut guess, mut before, mut input) = (String::new(), "phi".to_owned(), 1.0_f64);
    for k in 1..=n {
        writeln!(
            text,
            "L{k} = \"Rz({before}) Tx(100) Rz(m{k}) Tx(90) Rz(n{k}) Tx(-80) Rz(-t{k}) Tx(-40)\""
        )
        .unwrap();
        let output = drag(input);
        let (x, y) = (
            80.0 * output.cos() + 40.0 - 100.0 * input.cos(),
            80.0 * output.sin() - 100.0 * input.sin(),
        );
        let coupler = y.atan2(x);
        writeln!(
            guess,
            "m{k} = {:.1}\nn{k} = {:.1}\nt{k} = {output:.1}",
            coupler - input,
            output - coupler
        )
        .unwrap();
        before = format!("t{k}");
        input = output;
    }
    written(format!("{text}[guess]\n{guess}"))
}

#[test]
fn a_hundred_drag_links_keep_their_digits() {
    // 30-digit recursion.
    let known = [
        (1, 0.255739992962489226),
        (10, -1.92567891584058661),
        (100, -3.19927685644873479),
    ];
    for (n, expected) in known {
        let row = drag_links(n, "1");
        let trajectory = solve(&row, &[0.0]).unwrap();
        let pose = trajectory.samples[0].pose.as_ref().unwrap();
        let error = turned(pose.unknowns[slot(&row, &format!("t{n}"))] - expected);
        assert!(error < 1e-12, "{n}: {error:e}");
        let Certificate::Certified { error_bound, .. } = pose.certificate else {
            panic!("{n}: {:?}", pose.certificate)
        };
        assert!(
            error_bound >= 100.0 * error && error_bound < 1e-9,
            "{error_bound:e}"
        );
        assert_eq!(row.system().unwrap().blocks().len(), n);
    }
    for (scene, n) in [("h28-four-bar-1", 1), ("h28-four-bars-10", 10)] {
        let row = hard(scene, &[]);
        let trajectory = solve(&row, &even_times(&row, 37)).unwrap();
        assert_eq!(trajectory.missing(), 0);
        for sample in &trajectory.samples {
            let exact = (0..n).fold(sample.inputs[0], |angle, _| drag(angle));
            let pose = sample.pose.as_ref().unwrap();
            let error = turned(pose.unknowns[slot(&row, &format!("t{n}"))] - exact);
            assert!(error < 1e-12, "{scene} {}: {error:e}", sample.inputs[0]);
        }
    }
}

#[test]
fn a_hundred_drag_links_turn_all_the_way_round() {
    let row = drag_links(100, "1 + 2*pi*t/4");
    for samples in [12, 90] {
        let trajectory = solve(&row, &even_times(&row, samples)).unwrap();
        assert_eq!(trajectory.missing(), 0, "{:?}", trajectory.events);
        for sample in &trajectory.samples {
            let exact = (0..100).fold(sample.inputs[0], |angle, _| drag(angle));
            let angle = sample.pose.as_ref().unwrap().unknowns[slot(&row, "t100")];
            assert!(turned(angle - exact) < 1e-11, "{}", sample.inputs[0]);
        }
    }
}

/// `n` scissor cells with half bars of 50, all driven by the first one's angle.
fn lazy_tongs(n: usize, drive: &str) -> Model {
    let mut text = format!("duration = 4\n[inputs]\nu = \"{drive}\"\n[loops]\n");
    let mut reach = "2*50*cos(u)".to_owned();
    let (mut a, mut b) = ("u".to_owned(), "(-u)".to_owned());
    for k in 2..=n {
        let (next_a, next_b) = (format!("a{k}"), format!("b{k}"));
        writeln!(
            text,
            "C{k} = \"Rz({a}) Tx(50) Rz({next_b} - {a}) Tx(50) Rz({next_a} - {next_b}) Tx(-50) \
             Rz({b} - {next_a}) Tx(-50) Rz(-{b})\""
        )
        .unwrap();
        write!(reach, " + 50*(cos({next_a}) + cos({next_b}))").unwrap();
        (a, b) = (next_a, next_b);
    }
    text.push_str("[guess]\n");
    for k in 2..=n {
        writeln!(text, "a{k} = 0.5\nb{k} = -0.5").unwrap();
    }
    writeln!(text, "[outputs]\nreach = \"{reach}\"").unwrap();
    written(text)
}

#[test]
fn lazy_tongs_reach_as_far_as_their_angle_says() {
    for n in [2, 10, 100] {
        let row = lazy_tongs(n, "pi/6 + 0.8*t/4");
        let full = 100.0 * n as f64;
        let trajectory = solve(&row, &even_times(&row, 9)).unwrap();
        assert_eq!(trajectory.missing(), 0, "{:?}", trajectory.events);
        for sample in &trajectory.samples {
            let pose = sample.pose.as_ref().unwrap();
            let error = pose.outputs[0] - full * sample.inputs[0].cos();
            assert!(error.abs() < 1e-11 * full, "{n}: {error:e}");
        }
        let system = row.system().unwrap();
        assert_eq!(system.blocks().len(), n - 1);
        let first = &trajectory.samples[0];
        let unknowns = &first.pose.as_ref().unwrap().unknowns;
        let coordinates = [unknowns.as_slice(), &first.inputs].concat();
        let input = TaylorSeries::linear(first.inputs[0], 1.0, 1);
        let series = higher_rates(&system, &coordinates, &[input], 1).unwrap();
        let u = first.inputs[0];
        let slope: f64 = (2..=n)
            .flat_map(|k| [format!("a{k}"), format!("b{k}")])
            .map(|name| {
                let angle = &series[slot(&row, &name)];
                -50.0 * angle.derivative(0).sin() * angle.derivative(1)
            })
            .sum();
        let error = slope - 100.0 * u.sin() + full * u.sin();
        assert!(error.abs() < 1e-11 * full, "{n}: {error:e}");
    }
    let small = hard("h29-lazy-tongs-3", &[]);
    for sample in solve(&small, &even_times(&small, 5)).unwrap().samples {
        let reach = sample.pose.unwrap().outputs[0];
        assert!((reach - 300.0 * sample.inputs[0].cos()).abs() < 1e-11);
    }
}
