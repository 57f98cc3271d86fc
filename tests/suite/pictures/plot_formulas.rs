//! Formulas of plots: derivatives as parts of them, against references that are not ours, and the units they stand in.

use crate::driven::{Driven, solve};
use crate::program::Workspace;
use crate::reference::Table;
use mechanim::charts::motion::motion_chart;
use mechanim::diag::Source;
use mechanim::plot::Chart;
use mechanim::scene::builtin::find_builtin;
use mechanim::scene::{Overrides, load_scene};

/// The charts of a built-in scene whose plots are replaced by one of these curves, at these times.
fn charted(name: &str, curves: &[&str], times: &[f64]) -> Chart {
    let mut text = find_builtin(name).unwrap().text;
    if let Some(plots) = text.find("[[plots]]") {
        let rest = text[plots..].to_owned();
        let end = rest
            .match_indices("\n[")
            .find(|(k, _)| !rest[*k..].starts_with("\n[[plots]]"))
            .map_or(rest.len(), |(k, _)| k + 1);
        text.replace_range(plots..plots + end, "");
    }
    text.push_str(&format!("\n[[plots]]\ny = {curves:?}\n"));
    let source = Source {
        name: name.to_owned(),
        text,
    };
    let scene = load_scene(&source, &Overrides::default()).unwrap_or_else(|e| panic!("{e}"));
    let trajectory = solve(&scene, times).unwrap();
    motion_chart(
        &scene.system().unwrap(),
        &scene.actuation,
        &scene.plots,
        &trajectory,
    )
}

/// The source's v = -R dφ/dt of the rope that leaves the drum, at all times of the table but the singular start.
#[test]
fn derivatives_are_parts_of_formulas() {
    let table = Table::read("drum");
    let times: Vec<f64> = (1..table.len()).map(|k| table.value(k, "t")).collect();
    let curves = [
        "v = -R*d(phi, t)",
        "a = -R*d(phi,t,2)",
        "power = d(phi, t)*d(phi,t,2) + 0*d(s,x)",
        "whole = d(R*phi, t) + 2*R*d(phi, x)*d(x, t)",
    ];
    let chart = charted("rope-drum", &curves, &times);
    let units: Vec<&str> = chart.panels.iter().map(|p| p.y.unit.as_str()).collect();
    assert_eq!(units, ["m/s", "m/s²", "rad²/s³"]);
    let values = |panel: usize, series: usize| -> Vec<f64> {
        let points = &chart.panels[panel].series[series].points;
        points.iter().map(|p| p.unwrap()[1]).collect()
    };
    let (speed, rate, power, whole) = (values(0, 0), values(1, 0), values(2, 0), values(0, 1));
    for (k, row) in (1..table.len()).enumerate() {
        let [omega, alpha] = ["omega", "alpha"].map(|name| table.value(row, name));
        assert!((speed[k] - table.value(row, "v_circ")).abs() < 1e-12, "{k}");
        assert!((whole[k] - 3.0 * omega).abs() < 1e-12, "{k}");
        assert!(
            (rate[k] + alpha).abs() < 1e-11 * alpha.abs().max(1.0),
            "{k}"
        );
        let exact = omega * alpha;
        assert!(
            (power[k] - exact).abs() < 1e-11 * exact.abs().max(1.0),
            "{k}"
        );
    }
}

/// Products and quotients have units of their own, in plots as among outputs.
#[test]
fn units_are_those_of_the_formula() {
    let times = [0.0, 1.0, 2.0];
    let cases = [
        ("lifting-arm", "transmission", "1/m"),
        ("lifting-arm", "l^2", "m²"),
        ("lifting-arm", "lift/l", ""),
        ("slider-crank", "sqrt(h^2 + r^2)", "mm"),
        ("slider-crank", "h*d(h, t)", "mm²/s"),
    ];
    for (scene, formula, unit) in cases {
        let chart = charted(scene, &[formula], &times);
        assert_eq!(chart.panels[0].y.unit, unit, "{scene}: {formula}");
    }
}

/// A mistake beside or inside a derivative keeps its place.
#[test]
fn mistakes_beside_derivatives_have_places() {
    let w = Workspace::new();
    let text = find_builtin("slider-crank").unwrap().text;
    for (formula, said) in [
        ("r*d(h, t) + hh", "`hh`"),
        ("r*d(h, u)", "`u` is not an input"),
        ("r*d(h)", "a derivative is written"),
        ("r*d(h, t, 99)", "the order of a derivative"),
        ("2*d(h, t", "expected `)`"),
    ] {
        w.write(
            "wrong.toml",
            format!("{text}\n[[plots]]\ny = [\"{formula}\"]\n"),
        );
        let run = w.run(&["plot", "wrong.toml", "--out", "x.svg"]).exits(2);
        run.says(&[said, "wrong.toml:", formula]);
    }
}

/// Curves end where the motion does, at poses that nobody asked for: they are not counted as samples.
#[test]
fn only_the_samples_that_are_asked_for_are_counted() {
    let w = Workspace::new();
    for (place, drive, missing) in [
        ("nowhere", "t + 1", 0),
        ("at the start", "t - 0.35", 4),
        ("in the middle", "(t - 0.5)^2 - 0.04 + 1e-3", 3),
        ("at the end", "0.65 - t", 4),
        ("at both ends", "0.0301 - (t - 0.5)^2", 8),
        ("in two places", "cos(4*pi*t) + 0.5", 4),
    ] {
        let text = format!(
            "duration = 1\n[inputs]\np = \"{drive}\"\n[equations]\ne = \"x^2 - p\"\n[guess]\nx = 1\n"
        );
        w.write("s.toml", &text);
        let run = ["plot", "s.toml", "--samples", "11", "--out", "-"];
        let run = w.run(&run).exits(if missing == 0 { 0 } else { 4 });
        let said = format!("{missing} of 11 samples have no pose");
        assert_eq!(
            run.stderr.contains(&said),
            missing > 0,
            "{place}: {}",
            run.stderr
        );
        let picture = run.text();
        assert_eq!(picture.contains(&said), missing > 0, "{place}");
        assert!(picture.contains("at 11 samples"), "{place}");
    }
}
