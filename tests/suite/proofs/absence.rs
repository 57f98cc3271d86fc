//! That no pose exists is said where it is proved, and only there: against closed forms of where mechanisms reach.

use crate::draws::Draws;
use crate::driven::Driven;
use crate::program::Workspace;
use crate::reference::scenes::written;
use mechanim::kinematics::certificate::absence::has_no_pose;

/// Whether it is proved that a scene has no pose at its start.
fn is_refuted(text: &str) -> bool {
    let model = written(text);
    has_no_pose(&model.system().unwrap(), &model.actuation.inputs_at(0.0))
}

fn slider_crank(rod: &str, phi: f64) -> String {
    format!(
        "[inputs]\nphi = {phi:?}\n[loops]\nA = \"Rz(phi) Tx(40) Rz(a) Tx({rod}) Rz(b) Tx(-h)\"\n"
    )
}

/// A slider-crank closes if and only if the rod is as long as the crank's pin is high.
#[test]
fn slider_cranks_are_refuted_where_the_rod_is_too_short() {
    for phi in [0.3_f64, 1.0, 1.5, 2.5, 4.0, -1.2] {
        let height = 40.0 * phi.sin().abs();
        for share in [1e-13, 1e-9, 1e-3, 0.3] {
            let short = slider_crank(&format!("{:?}", height * (1.0 - share)), phi);
            let long = slider_crank(&format!("{:?}", height * (1.0 + share)), phi);
            assert!(is_refuted(&short), "{phi} {share}");
            assert!(!is_refuted(&long), "{phi} {share}");
        }
    }
}

/// A four-bar closes if and only if its three moving sides make a triangle.
#[test]
fn four_bars_are_refuted_where_there_is_no_triangle() {
    let mut draws = Draws(5);
    let (mut open, mut closed) = (0, 0);
    for _ in 0..300 {
        let [a, b, c, d, phi] = [0; 5].map(|_| 0.2 + 3.0 * draws.share());
        let diagonal = (a * phi.cos() - d).hypot(a * phi.sin());
        let sides = [diagonal, b, c];
        let sum: f64 = sides.iter().sum();
        let lack = sides.iter().fold(f64::MIN, |m, s| m.max(2.0 * s - sum));
        let text = format!(
            "[inputs]\nphi = {phi:?}\n[loops]\nA = \"Rz(phi) Tx({a:?}) Rz(u) Tx({b:?}) Rz(v) Tx({c:?}) Rz(w) Tx({d:?})\"\n"
        );
        let text = text.replace(&format!("Tx({d:?})"), &format!("Tx({:?})", -d));
        if lack.abs() > 1e-12 {
            assert_eq!(is_refuted(&text), lack > 0.0, "{text}");
            open += usize::from(lack > 0.0);
            closed += usize::from(lack < 0.0);
        }
    }
    assert!(open > 30 && closed > 30, "{open} {closed}");
}

/// What no polygon decides: a spherical four-bar, and two cranks whose inputs contradict each other.
#[test]
fn few_angles_are_halved_until_nothing_is_left() {
    let spherical = |coupler: f64| {
        format!(
            "[inputs]\nphi = 0.7\n[loops]\nA = \"Rz(phi) Rx(0.5) Rz(m) Rx({coupler}) Rz(n) Rx(0.9) Rz(psi) Rx(1.3)\"\n"
        )
    };
    assert!(is_refuted(&spherical(0.01)));
    assert!(!is_refuted(&spherical(1.1)));
    let twice = |second: f64| {
        format!(
            "[inputs]\np = 0.5\nq = {second}\n[loops]\nA = \"Rz(p) Tx(40) Rz(a) Tx(80) Rz(b) Tx(-h)\"\nB = \"Rz(p) Rz(-q)\"\n"
        )
    };
    assert!(is_refuted(&twice(0.7)));
    assert!(!is_refuted(&twice(0.5)));
    let equation =
        |right: f64| format!("[inputs]\np = 0.5\n[equations]\nE = \"sin(x) + p - {right}\"\n");
    assert!(is_refuted(&equation(1.6)));
    assert!(!is_refuted(&equation(1.4)));
}

#[test]
fn what_is_not_proved_has_words_and_an_exit_code_of_its_own() {
    let folder = Workspace::new();
    folder.write("short.toml", slider_crank("20", 1.0));
    let run = folder.run(&["solve", "short.toml", "--out", "-"]);
    run.exits(4)
        .says(&["loop `A` does not close", "no pose exists (proved)"]);
    // Six turns of nearly parallel axes do not make up for one of 1.3; six angles are too many to be halved.
    let joint = |name: &str| format!("Rz({name}) Rx(0.01) Tx(1)");
    let joints = ["a", "b", "c", "d", "e", "f"].map(joint).join(" ");
    let ring = format!("[inputs]\nphi = 0.7\n[loops]\nA = \"Rz(phi) Rx(1.3) Tx(1) {joints}\"\n");
    folder.write("ring.toml", &ring);
    let run = folder.run(&["solve", "ring.toml", "--out", "-"]).exits(1);
    run.says(&[
        "loop `A` does not close",
        "that no pose exists is not proved",
        "give start values",
    ]);
    let run = folder.run(&["check", "ring.toml"]).exits(1);
    run.says(&["that no pose exists is not proved"]);
}

/// Behind the end of a motion, too, what is proved is said; the exit code tells it from what is only located.
#[test]
fn no_pose_behind_a_fold_is_proved_at_the_widest_sample() {
    let folder = Workspace::new();
    let scene = slider_crank("20", 0.0).replace("phi = 0.0", "phi = \"0.2 + t\"");
    folder.write("ends.toml", format!("duration = 1\n{scene}"));
    let run = folder.run(&["solve", "ends.toml", "--samples", "9", "--out", "-"]);
    run.exits(4)
        .says(&["at a fold (proved)", "no pose exists there (proved)"]);
}
