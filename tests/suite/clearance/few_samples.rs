//! The verdict on a clearance does not depend on the number of samples: closed loops under fast drives, narrow peaks, drives with
//! kinks and jumps, and pieces with tolerances, judged at two samples and at many.

use crate::draws::Draws;
use crate::program::Workspace;
use serde_json::Value;

const CRANK: f64 = 30.0;
const ROD: f64 = 80.0;
const RADIUS: f64 = 2.0;

/// A drive of the crank, its first value, and the interval of all values that it has over a second, by its formula.
fn drive(kind: usize, draws: &mut Draws) -> (String, f64, [f64; 2]) {
    let (low, high) = (-0.8 - draws.share(), 0.7 + 1.5 * draws.share());
    let range = [low, high];
    match kind {
        // Many times from end to end.
        0 => {
            let rate = 20.0 + 800.0 * draws.share();
            let formula = format!("{low}+{}*(1-cos({rate}*t))/2", high - low);
            (formula, low, range)
        }
        // A peak, or the other way about.
        1 | 2 => {
            let width = 10f64.powf(-1.6 - 3.0 * draws.share());
            let middle = 0.2 + 0.6 * draws.share();
            let (from, to) = if kind == 1 { (low, high) } else { (high, low) };
            let formula = format!("{from}+{}*exp(-((t-{middle})/{width})^2)", to - from);
            (formula, from, range)
        }
        // There and back with a kink.
        3 => {
            let middle = 0.2 + 0.6 * draws.share();
            let slope = (high - low) / f64::max(middle, 1.0 - middle);
            let formula = format!("{high}-{slope}*abs(t-{middle})");
            (formula, high - slope * middle, range)
        }
        _ => (format!("{low}+{}*t", high - low), low, range),
    }
}

/// How near the slider comes to a ball 20 beside its way, between two angles of the crank on both sides of zero.
fn nearest(post: f64, [low, high]: [f64; 2]) -> f64 {
    let slider = |phi: f64| CRANK * phi.cos() + (ROD * ROD - (CRANK * phi.sin()).powi(2)).sqrt();
    let (most, least) = (slider(0.0), slider(low).min(slider(high)));
    let off = (post - most).max(least - post).max(0.0);
    off.hypot(20.0) - 2.0 * RADIUS
}

#[test]
fn verdicts_do_not_depend_on_the_number_of_samples() {
    let folder = Workspace::new();
    let mut draws = Draws(81);
    for k in 0..40 {
        let (phi, first, range) = drive(k % 5, &mut draws);
        // Nearer to the slider at its ends than in the middle, or on its way.
        let post = [45.0, 115.0, 95.0][k % 3];
        let truth = nearest(post, range);
        for (share, code) in [(0.98, 0), (1.001, 1)] {
            let minimum = share * truth;
            let text = format!(
                "units = {{ length = \"mm\", angle = \"rad\" }}\nduration = 1\n[inputs]\nphi = \"{phi}\"\n\
                 [loops]\nA = \"Rz(phi) Tx({CRANK}) Rz(a) Tx({ROD}) Rz(-a-phi) Tx(-s)\"\n[guess]\ns = 90\na = {}\n\
                 [[bodies]]\nname = \"slider\"\nframe = \"Tx(s)\"\nshapes = [{{ sphere = {{ radius = {RADIUS} }} }}]\n\
                 [[bodies]]\nname = \"post\"\nshapes = [{{ sphere = {{ center = [{post}, 20, 0], radius = {RADIUS} }} }}]\n\
                 [clearance]\nminimum = {minimum}\n",
                -first
            );
            folder.write("few.toml", &text);
            for samples in ["2", "3", "7", "40"] {
                let run = folder.run(&["check", "few.toml", "--samples", samples, "--json", "-"]);
                let said = format!("{text} at {samples}: {} {} {truth}", run.code, run.stderr);
                assert_eq!(run.code, code, "{said}");
                let report: Value = serde_json::from_slice(&run.stdout).unwrap();
                let bound = report["clearance"]["pairs"][0]["bound"].as_f64().unwrap();
                assert!(bound <= truth * (1.0 + 1e-12), "{bound} {said}");
            }
        }
    }
}

/// Pieces may be off by tolerances, whose effect is less than their sum.
#[test]
fn verdicts_on_pieces_do_not_depend_on_the_number_of_samples() {
    let folder = Workspace::new();
    let mut draws = Draws(82);
    for k in [0, 1, 3, 4] {
        let (phi, first, range) = drive(k, &mut draws);
        let truth = nearest(115.0, range);
        for (share, code) in [(0.97, 0), (1.001, 1)] {
            let minimum = share * truth;
            let text = format!(
                "units = {{ length = \"mm\", angle = \"rad\" }}\nduration = 1\n[parameters]\ncrank = {CRANK}\nrod = {ROD}\n\
                 [inputs]\nphi = \"{phi}\"\n[loops]\nA = \"Rz(phi) Tx(crank) Rz(a) Tx(rod) Rz(-a-phi) Tx(-s)\"\n\
                 [guess]\ns = 90\na = {}\n\
                 [[bodies]]\nname = \"slider\"\nframe = \"Tx(s)\"\nshapes = [{{ sphere = {{ radius = {RADIUS} }} }}]\n\
                 [[bodies]]\nname = \"post\"\nshapes = [{{ sphere = {{ center = [115, 20, 0], radius = {RADIUS} }} }}]\n\
                 [clearance]\nminimum = {minimum}\n",
                -first
            );
            folder.write("pieces.toml", &text);
            for samples in ["2", "3", "40"] {
                let args = [
                    "check",
                    "pieces.toml",
                    "--samples",
                    samples,
                    "--made-within",
                    "0.05",
                ];
                let run = folder.run(&args);
                let said = format!(
                    "{text} at {samples}: {} {} {}",
                    run.code,
                    run.stderr,
                    run.text()
                );
                assert_eq!(run.code, code, "{said}");
            }
        }
    }
}
