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

/// Two narrow peaks in different inputs, of which neither is at a sample; and many in a row.
#[test]
fn several_narrow_peaks_are_bounded() {
    let folder = Workspace::new();
    let arm = |u: &str, v: &str| {
        format!(
            "duration = 3.7\n[inputs]\nu = \"{u}+0.3*t\"\nv = \"{v}+0.15*t\"\n\
             [[bodies]]\nname = \"a\"\nframe = \"Rz(u) Tx(0.7) Ty(v)\"\nshapes = [{{ sphere = {{ radius = 0.05 }} }}]\n\
             [[bodies]]\nname = \"b\"\nframe = \"Tx(-0.7) Ty(2.3) Tz(-1)\"\nshapes = [{{ sphere = {{ radius = 0.3 }} }}]\n\
             [clearance]\nminimum = 0\npairs = [{{ pair = [\"a\", \"b\"], minimum = 1e-8 }}]\n"
        )
    };
    let crank = "duration = 2\n[inputs]\nphi = \"1.5*exp(-((mod(t,0.1)-0.037)/1e-05)^2)+0.3*t\"\n\
                 [chains]\nca = \"Rz(phi) Tx(0.5) Rz(x) Tx(1)\"\n[loops]\nl = \"Rz(phi) Tx(0.5) Rz(x) Tx(2) Rz(y) Tx(-s)\"\n\
                 [guess]\ns = 2.5\n[[bodies]]\nname = \"a\"\nframe = \"ca\"\nshapes = [{ sphere = { radius = 0.1 } }]\n\
                 [[bodies]]\nname = \"b\"\nshapes = [{ sphere = { center = [1.5, 2, 0.3], radius = 0.3 } }]\n\
                 [clearance]\nminimum = 0.001\n";
    let bell = |height: f64, at: f64, width: f64| format!("{height}*exp(-((t-{at})/{width})^2)");
    for (width, wide) in [(3.7e-6, 3.7e-6), (1e-7, 1e-7), (1e-6, 1e-4)] {
        folder.write(
            "arm.toml",
            arm(&bell(1.4, 2.5109, width), &bell(0.8, 1.6808, wide)),
        );
        for samples in ["2", "3", "17"] {
            folder
                .run(&["check", "arm.toml", "--samples", samples])
                .exits(0);
        }
    }
    folder.write("crank.toml", crank);
    for samples in ["2", "17", "60"] {
        folder
            .run(&["check", "crank.toml", "--samples", samples])
            .exits(0);
    }
}

/// A capsule that turns past a box, where halving a time once gains nothing.
#[test]
fn bounds_of_pieces_do_not_stall_above_the_minimum() {
    let folder = Workspace::new();
    folder.write(
        "stall.toml",
        "units = { length = \"mm\" }\nduration = 2.0\n[parameters]\np1 = 1.1670920194743855\np2 = -0.394468939280731\n\
         ox = -0.18581656076797265\noy = -1.5112486702335861\noz = 0.22102463194050348\n\
         [inputs]\nu = \"-0.6761511459533469+1.9943261633969405*sin(2.1851870401022655*t)\"\n\
         v = \"0.373573491877798+0.12793150340983436*t/2\"\n\
         [chains]\nca = \"Rz(u) Tx(p1) Ry(p2) Tz(v) Rx(0.5*u)\"\ncb = \"Tx(ox) Ty(oy) Tz(oz) Ry(0.4)\"\n\
         [[bodies]]\nname = \"a\"\nframe = \"ca\"\nshapes = [{ capsule = { from = [0.1570596812934042, -0.06808754982454313, \
         -0.2298400862324882], to = [-0.5412287755675699, -0.27789537227920585, 0.5136002390444488], radius = 0.14329114638016963 } }]\n\
         [[bodies]]\nname = \"b\"\nframe = \"cb\"\nshapes = [{ box = { center = [-0.04669970137409987, -0.05308036377408973, \
         -0.12471640461810609], size = [0.0017714309300494936, 0.2754559907021904, 0.4579324048889595] } }]\n\
         [clearance]\nminimum = 0\npairs = [{ pair = [\"a\", \"b\"], minimum = 0.1060 }]\n",
    );
    for samples in ["2", "3", "41", "60", "151"] {
        let args = [
            "check",
            "stall.toml",
            "--made-within",
            "0.0003",
            "--vary",
            "p1,ox,oy,oz",
            "--samples",
            samples,
        ];
        folder.run(&args).exits(0);
    }
}

/// Corners of drives are samples of a check, at binary fractions of the duration as elsewhere.
#[test]
fn corners_at_halves_are_sampled() {
    let workspace = Workspace::new();
    for corner in ["0.25", "0.5", "0.26", "0.75", "0.125", "0.2+0.05", "1/3"] {
        for drive in [
            "max(t, {})",
            "abs(t - ({}))",
            "min(t, {})",
            "floor(t + 1 - ({}))",
        ] {
            let drive = drive.replace("{}", corner);
            workspace.write("corner.toml", format!("duration = 1\n[inputs]\nu = \"{drive}\"\n[[bodies]]\nname = \"b\"\nframe = \"Tx(u)\"\n"));
            let run = workspace
                .run(&["check", "corner.toml", "--samples", "2"])
                .exits(0);
            let samples = run
                .text()
                .lines()
                .find_map(|line| line.trim().strip_prefix("samples").map(str::to_owned))
                .unwrap();
            let count: usize = samples.split_whitespace().next().unwrap().parse().unwrap();
            assert!(count >= 3, "{drive}: {count} samples");
        }
    }
}
