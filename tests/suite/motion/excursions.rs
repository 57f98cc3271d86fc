//! What a drive does between two samples: turns past folds, excursions out of the reach of a linkage, lengths below zero. The
//! reference is the triangle inequality of a four-bar, looked at closely.

use crate::draws::Draws;
use crate::program::Workspace;

/// Crank, coupler, rocker, ground.
type Lengths = [f64; 4];

fn four_bar([a, b, c, d]: Lengths, duration: f64, phi: &str, theta: f64) -> String {
    format!(
        "units = {{ length = \"mm\", angle = \"deg\" }}\nduration = {duration}\n[inputs]\nphi = \"{phi}\"\n\
         [loops]\nA = \"Rz(phi) Tx({a}) Rz(mu) Tx({b}) Rz(nu) Tx({}) Rz(-theta) Tx({})\"\n[guess]\ntheta = {theta}\n",
        -c, -d
    )
}

/// Whether coupler and rocker reach from the pin of the crank to that of the rocker.
fn closes([a, b, c, d]: Lengths, phi: f64) -> bool {
    let squared = a * a + d * d - 2.0 * a * d * phi.to_radians().cos();
    ((b - c).powi(2)..=(b + c).powi(2)).contains(&squared)
}

#[test]
fn folds_within_one_turn_are_seen_however_few_the_samples() {
    let folder = Workspace::new();
    let mut draws = Draws(11);
    let mut passed = [0, 0];
    for _ in 0..40 {
        let off = 10f64.powf(-6.0 + 2.0 * draws.share());
        let lengths = [49.0, 132.0 * (1.0 + off), 49.0, 132.0];
        let (from, turn) = (20.0 + 140.0 * draws.share(), 100.0 + 600.0 * draws.share());
        let text = four_bar(lengths, 0.1, &format!("{from}+{}*t", 10.0 * turn), from);
        folder.write("turn.toml", text);
        // A gap lies about every whole turn.
        let meets = from + turn > 360.0 + 2.0;
        let misses = from + turn < 360.0 - 2.0;
        assert!(!closes(lengths, 360.0) && closes(lengths, 358.0) && closes(lengths, 180.0));
        for samples in ["2", "3", "5"] {
            let run = folder.run(&["check", "turn.toml", "--samples", samples]);
            let said = format!(
                "{off:e} {from} {turn} at {samples}: {} {}",
                run.code, run.stderr
            );
            assert!(!meets || [1, 4].contains(&run.code), "{said}");
            // The change point at half a turn is passed straight on.
            assert!(!misses || run.code == 0, "{said}");
            passed[usize::from(meets)] += 1;
        }
    }
    assert!(passed.iter().all(|count| *count > 15), "{passed:?}");
}

#[test]
fn excursions_of_a_drive_between_samples_are_followed() {
    let folder = Workspace::new();
    let mut draws = Draws(12);
    let lengths = [60.0, 60.0, 60.0, 110.0];
    assert!(closes(lengths, 84.3) && !closes(lengths, 84.4));
    for _ in 0..40 {
        let sharp = 10f64.powf(1.0 + 4.5 * draws.share());
        let middle = 0.1 + 0.8 * draws.share();
        let peak = 10.0 + 80.0 * draws.share();
        let bell = format!("60+{peak}*exp(-((t-{middle})*{sharp})^2)");
        let tent = format!("60+{peak}*max(0, 1-{sharp}*abs(t-{middle}))");
        let stepped = format!("{bell}+0.5*floor(2.2*t)");
        for phi in [bell, tent, stepped] {
            folder.write("pulse.toml", four_bar(lengths, 1.0, &phi, 120.0));
            // With one step up at 1/2.2, which is no sample.
            let steps = phi.contains("floor") && 2.2 * middle > 1.0;
            let leaves = 60.0 + peak + if steps { 0.5 } else { 0.0 } > 84.348_072_1;
            for samples in ["2", "7", "21"] {
                let run = folder.run(&["check", "pulse.toml", "--samples", samples]);
                let said = format!("{phi} at {samples}: {} {}", run.code, run.stderr);
                match leaves {
                    true => assert!([1, 4].contains(&run.code), "{said}"),
                    false => assert_eq!(run.code, 0, "{said}"),
                }
            }
        }
    }
    // In step with the samples.
    for duration in [1.0, 2.0, 4.0] {
        let text = four_bar(lengths, duration, "60+50*(1-cos(360*20*t))", 120.0);
        folder.write("wave.toml", text);
        folder.run(&["check", "wave.toml"]).exits(4);
    }
}

#[test]
fn no_pose_has_a_bar_of_negative_length() {
    let folder = Workspace::new();
    let lengths = [
        ("-5-t", false),
        ("-5", false),
        ("5-9.7*t", false),
        ("5-5.1*sin(180*t)", false),
        ("(t-0.5)^2-0.01", false),
        ("5+t", true),
        ("5-4*t", true),
    ];
    for (length, is_positive) in lengths {
        // As an input, and as a formula of one.
        for (input, used) in [(length.to_owned(), "l"), (format!("-({length})"), "-l")] {
            let text = format!(
                "units = {{ length = \"mm\", angle = \"deg\" }}\nduration = 1\n[inputs]\nl = \"{input}\"\n\
                 [chains]\nP = \"T(x,0,0)\"\n[guess]\nx = 5\n\
                 [bars]\nb = {{ from = \"P\", to = [0, 0], length = \"{used}\" }}\n"
            );
            folder.write("bar.toml", &text);
            for options in [&["--samples", "2"][..], &[], &["--certify", "motion"]] {
                let run = folder.run(&[&["check", "bar.toml"][..], options].concat());
                let said = format!("{text}{options:?}: {} {}", run.code, run.stderr);
                match is_positive {
                    true => assert_eq!(run.code, 0, "{said}"),
                    false => assert!([1, 4].contains(&run.code), "{said}"),
                }
            }
        }
    }
}
