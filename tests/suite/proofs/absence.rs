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
    // Six turns by 0.21 do not make up for one of 1.3; six angles are too many to be halved, and at once they say nothing.
    let joint = |name: &str| format!("Rz({name}) Rx(0.21) Tx(1)");
    let joints = ["a", "b", "c", "d", "e", "f"].map(joint).join(" ");
    let ring = format!("[inputs]\nphi = 0.7\n[loops]\nA = \"Rz(phi) Rx(1.3) Tx(1) {joints}\"\n");
    folder.write("ring.toml", &ring);
    let run = folder.run(&["solve", "ring.toml", "--out", "-"]).exits(1);
    run.says(&[
        "loop `A` does not close",
        "it is not proved that no pose exists",
        "give start values",
    ]);
    let run = folder.run(&["check", "ring.toml"]).exits(1);
    run.says(&["it is not proved that no pose exists"]);
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

/// Scenes that end, and scenes that do not, in each of the ways there are.
const ENDS: [(&str, &str); 7] = [
    (
        "root",
        "duration = 2\n[inputs]\nphi = \"1 - t\"\n[equations]\ne = \"x - sqrt(phi)\"\n[guess]\nx = 1\n",
    ),
    (
        "pole",
        "duration = 2\n[inputs]\nphi = \"1/(t - 1)\"\n[equations]\ne = \"x - phi\"\n",
    ),
    (
        "overflow",
        "duration = 2\n[inputs]\nphi = \"exp(1000*t)\"\n[equations]\ne = \"x - phi\"\n",
    ),
    (
        "step",
        "duration = 2\n[inputs]\nphi = \"t\"\n[equations]\ne = \"x - floor(phi)\"\n",
    ),
    (
        "fold",
        "duration = 2\n[inputs]\nphi = \"1 - t\"\n[equations]\ne = \"x^2 - phi\"\n[guess]\nx = 1\n",
    ),
    (
        "both",
        "duration = 2\n[inputs]\nphi = \"1 - t\"\n[equations]\na = \"y + x - phi\"\nb = \"x - sqrt(y)\"\n[guess]\nx = 0.6\ny = 0.4\n",
    ),
    (
        "never",
        "[inputs]\nphi = 0.3\n[equations]\ne = \"sqrt(-1 - x^2) + phi\"\n",
    ),
];

/// Whether a report says of some place, at which a motion ends or has no pose, that this is proved.
fn says_proved(document: &serde_json::Value) -> bool {
    let list = |key: &str| document[key].as_array().cloned().unwrap_or_default();
    let of_gap = |gap: &serde_json::Value| {
        ["ending", "beginning", "widest"]
            .iter()
            .any(|key| gap[key]["proved"] == true)
    };
    let of_event = |event: &serde_json::Value| event["proved"] == true && event["time"].is_number();
    list("gaps").iter().any(of_gap) || list("events").iter().any(of_event)
}

/// No built-in scene, no hard scene and none of the above is left with exit code 4 without a place and a proof.
#[test]
fn exit_code_4_comes_with_a_place_and_a_proof() {
    let folder = Workspace::new();
    let mut scenes: Vec<String> = Vec::new();
    for (name, text) in ENDS {
        let file = format!("{name}.toml");
        folder.write(&file, text);
        scenes.push(file);
    }
    for place in ["tests/hard", "scenes"] {
        let path = format!("{}/{place}", env!("CARGO_MANIFEST_DIR"));
        let files = std::fs::read_dir(path).unwrap();
        let files = files.map(|file| file.unwrap().path());
        let files = files.filter(|file| file.extension().is_some_and(|e| e == "toml"));
        scenes.extend(files.map(|file| file.to_str().unwrap().to_owned()));
    }
    let mut ended = 0;
    for scene in &scenes {
        let run = folder.run(&["solve", scene, "--out", "-", "--format", "json"]);
        // Without any pose there is no table: the message has the place and the proof.
        let (is_proved, is_said) = match serde_json::from_slice(&run.stdout) {
            Ok(document) => (says_proved(&document), run.stderr.contains("t = ")),
            Err(_) => {
                let is_proved = run.stderr.contains("no pose exists (proved)");
                (is_proved, run.stderr.contains("t = "))
            }
        };
        if run.code == 4 {
            ended += 1;
            assert!(is_proved && is_said, "{scene}: {}", run.stderr);
        } else {
            assert!(
                !is_proved,
                "{scene}: exit code {}: {}",
                run.code, run.stderr
            );
        }
        let check = folder.run(&["check", scene]);
        assert_eq!(check.code == 4, run.code == 4, "{scene}: {}", check.stderr);
    }
    assert!(ended >= 5, "{ended} of {}", scenes.len());
}

/// Verbs that find no pose say 4 only where none exists.
#[test]
fn verbs_that_find_no_pose_say_whether_none_exists() {
    let folder = Workspace::new();
    let short = slider_crank("20", 1.0);
    folder.write("short.toml", &short);
    let none = folder.run(&["modes", "short.toml", "--starts", "20"]);
    none.exits(4).says(&["no pose exists (proved)"]);
    let joint = |name: &str| format!("Rz({name}) Rx(0.21) Tx(1)");
    let joints = ["a", "b", "c", "d", "e", "f"].map(joint).join(" ");
    let ring = format!("[inputs]\nphi = 0.7\n[loops]\nA = \"Rz(phi) Rx(1.3) Tx(1) {joints}\"\n");
    folder.write("ring.toml", &ring);
    let open = folder.run(&["modes", "ring.toml", "--starts", "20"]);
    open.exits(1)
        .says(&["it is not proved that no pose exists"]);
    // Plain Newton proves nothing.
    let trace = ["solve", "short.toml", "--trace-iterations", "--out", "-"];
    folder.run(&trace).exits(1);
}

/// A row that hardly changes at the poses looked at is solved: somewhere it closes.
#[test]
fn a_loop_is_impossible_only_where_no_length_closes_it() {
    let folder = Workspace::new();
    let scene = |lift: &str| {
        format!(
            "duration = 1\n[inputs]\nphi = \"t\"\np = \"10000 + 0*t\"\n[loops]\n\
             A = \"Rz(phi) Tx(40) Rz(a) Tx(80) Rz(b) Tx(-h) Tz({lift})\"\n[guess]\nh = 120\n"
        )
    };
    folder.write("weak.toml", scene("1e-12*p - 1e-8"));
    let run = folder.run(&["solve", "weak.toml", "--out", "-"]);
    assert!(
        !run.stderr.contains("cannot close at any pose"),
        "{}",
        run.stderr
    );
    assert_ne!(run.code, 4);
    folder.write("lifted.toml", scene("1e-8 + 0*p"));
    let run = folder.run(&["solve", "lifted.toml", "--out", "-"]).exits(4);
    run.says(&["cannot close at any pose", "the translation along z"]);
}
