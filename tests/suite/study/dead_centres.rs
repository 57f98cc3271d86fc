//! Pieces near a dead centre: those that move are counted, and only those.

use crate::program::Workspace;
use serde_json::Value;

/// A slider-crank with an offset of 1 turns fully if and only if the rod is longer than the crank by the offset.
fn crank(r: f64, rod: f64) -> String {
    format!(
        r#"units = {{ length = "mm" }}
duration = 4
[parameters]
r = {r:?}
L = {rod:?}
[inputs]
phi = "2*pi*t/4"
[chains]
crank = "Rz(phi) Tx(r)"
rod = "Rz(alpha) Tx(L)"
slide = "Rz(beta) Ty(-1) Tx(-h)"
[loops]
A = "crank rod slide"
[guess]
h = 150
[measures]
m = {{ of = "h", take = "max", min = 10 }}
"#
    )
}

#[test]
fn pieces_that_move_are_counted_whatever_the_nominal_one_is_next_to() {
    let w = Workspace::new();
    for (rod, tolerance) in [
        (78.501, 3.0),
        (78.52, 1.0),
        (78.6, 2.0),
        (80.0, 3.0),
        (84.0, 2.0),
    ] {
        w.write("s.toml", crank(77.5, rod));
        let tolerance_text = tolerance.to_string();
        let arguments = [
            "tolerance",
            "s.toml",
            "--vary",
            "L",
            "--tolerance",
            &tolerance_text,
        ];
        let more = ["--pieces", "800", "--json", "-", "--csv", "p.csv"];
        let run = w.run(&[&arguments[..], &more].concat()).exits(0);
        let report: Value = serde_json::from_slice(&run.stdout).unwrap();
        let failed = report["failed"].as_u64().unwrap();
        // As many as the closed form says, but for what 800 draws scatter by: four standard deviations.
        let share = ((78.5 - rod + tolerance) / (2.0 * tolerance)).clamp(0.0, 1.0);
        let scatter = 4.0 * (800.0 * share * (1.0 - share)).sqrt();
        let off = (failed as f64 - 800.0 * share).abs();
        assert!(off <= scatter, "{rod}: {failed} of 800, {share}");
        // Those that move are long enough: at phi = 0 the slider is at r + sqrt(L² - 1). Poses at 180 places miss dead centres
        // between them.
        let table = String::from_utf8(w.read("p.csv")).unwrap();
        let values = table
            .lines()
            .skip(1)
            .filter_map(|line| line.split(',').nth(1)?.parse::<f64>().ok());
        let mut moved = 0;
        for value in values {
            assert!((value - 77.5).hypot(1.0) > 78.49, "{rod}: {value}");
            moved += 1;
        }
        assert_eq!(moved + failed, 800);
    }
}

/// A parallelogram, which is folded flat at half time; its last angle turns through zero there.
const PARALLELOGRAM: &str = r#"units = { length = "mm", angle = "deg" }
duration = 1
[parameters]
a = 30
b = 80
c = 30
d = 80
[inputs]
phi = "20 + 320*t"
[loops]
A = "Rz(phi) Tx(a) Rz(alpha) Tx(b) Rz(beta) Tx(c) Rz(gamma) Tx(-d)"
[guess]
alpha = -20
beta = 200
gamma = 160
[measures.low]
of = "gamma"
take = "min"
"#;

#[test]
fn pieces_go_on_from_a_change_point_as_they_move() {
    let w = Workspace::new();
    w.write("s.toml", PARALLELOGRAM);
    let arguments = [
        "tolerance",
        "s.toml",
        "--vary",
        "a,b,c,d",
        "--tolerance",
        "0.01",
    ];
    let more = ["--pieces", "400", "--json", "-", "--csv", "p.csv"];
    let run = w.run(&[&arguments[..], &more].concat()).exits(0);
    let report: Value = serde_json::from_slice(&run.stdout).unwrap();
    assert_eq!(report["passes_singular_pose"], true);
    assert!(report["measures"]["low"]["never_beyond"].is_null());
    // The crank turns fully if crank and ground together are shorter than the other two: half of all pieces.
    let failed = report["failed"].as_u64().unwrap();
    assert!((160..=240).contains(&failed), "{failed}");
    // A piece that turns is never flat: its last angle keeps its sign.
    let table = String::from_utf8(w.read("p.csv")).unwrap();
    let values = table
        .lines()
        .skip(1)
        .filter_map(|line| line.split(',').nth(1)?.parse::<f64>().ok());
    let values: Vec<f64> = values.collect();
    assert_eq!(values.len() as u64 + failed, 400);
    assert!(
        values.iter().all(|low| (0.0..20.0).contains(low)),
        "{values:?}"
    );
}

#[test]
fn bands_end_at_a_change_point() {
    let w = Workspace::new();
    w.write("s.toml", PARALLELOGRAM);
    let arguments = "enclose s.toml --vary a,b,c,d --tolerance 0.0001 --samples 20 --out b.csv";
    for between in [&[][..], &["--between"]] {
        let words: Vec<&str> = arguments
            .split(' ')
            .chain(between.iter().copied())
            .collect();
        w.run(&words).exits(1);
        let table = String::from_utf8(w.read("b.csv")).unwrap();
        let words = table.lines().skip(1).map(|line| line.rsplit(',').next());
        let words: Vec<&str> = words.flatten().collect();
        assert!(
            words[..10].iter().all(|word| *word == "enclosed"),
            "{words:?}"
        );
        let behind = |word: &&str| *word == "behind-singular-pose";
        assert!(words[10..].iter().all(behind), "{words:?}");
    }
}

/// A four-bar that is nearly a kite: its ground is longer than its crank by less than the other two bars differ, or by more.
const KITE: &str = r#"units = { length = "mm", angle = "deg" }
duration = 4
[parameters]
d = 40.1
[inputs]
phi = "90*t"
[chains]
T13 = "Rz(phi) Tx(40) Rz(alpha)"
T14 = "Tx(d) Rz(psi)"
[loops]
A = "T13 Tx(80) Rz(mu) inv(T14 Tx(79.95))"
[guess]
psi = 60
mu = 0.06
[measures]
mx = { of = "mu", take = "max" }
"#;

#[test]
fn pieces_beyond_a_change_point_are_found_from_their_other_poses() {
    let w = Workspace::new();
    w.write("s.toml", KITE);
    for start in ["90*t", "90+90*t"] {
        let input = format!("phi={start}");
        let arguments = ["tolerance", "s.toml", "--vary", "d", "--tolerance", "0.25"];
        let more = ["--pieces", "600", "--json", "-", "--input", &input];
        let run = w.run(&[&arguments[..], &more].concat()).exits(0);
        let report: Value = serde_json::from_slice(&run.stdout).unwrap();
        // Only those with |d - 40| < 0.05 are folded at 0: a fifth, four standard deviations on either side.
        let failed = report["failed"].as_u64().unwrap();
        assert!((81..=159).contains(&failed), "{start}: {failed}");
    }
}

#[test]
fn angles_of_pieces_next_to_a_fold_have_not_turned() {
    let w = Workspace::new();
    // The slider drives: the crank comes within a hundredth of its dead centre.
    w.write(
        "s.toml",
        r#"units = { length = "mm", angle = "deg" }
duration = 2
[parameters]
r = 40
L = 100
[inputs]
h = { keys = [[0, 80], [2, 139.999]] }
[loops]
A = "Rz(q) Tx(r) Rz(a) Tx(L) Rz(b) Tx(-h)"
[guess]
q = 60
[measures]
q1 = { of = "q", take = "last", max = 10 }
"#,
    );
    let arguments = [
        "tolerance",
        "s.toml",
        "--vary",
        "r,L",
        "--tolerance",
        "0.01",
    ];
    let more = ["--pieces", "1000", "--json", "-", "--csv", "p.csv"];
    let run = w.run(&[&arguments[..], &more].concat()).exits(0);
    let report: Value = serde_json::from_slice(&run.stdout).unwrap();
    let table = String::from_utf8(w.read("p.csv")).unwrap();
    let values: Vec<f64> = table
        .lines()
        .skip(1)
        .filter_map(|line| line.split(',').nth(1)?.parse().ok())
        .collect();
    // cos q = (h² + r² - L²)/(2 h r): below two degrees for all pieces that reach so far.
    assert!(values.iter().all(|q| (0.0..2.0).contains(q)), "{values:?}");
    assert_eq!(
        values.len() as u64 + report["failed"].as_u64().unwrap(),
        1000
    );
}

#[test]
fn intervals_are_refused_where_numbers_are_meant() {
    let w = Workspace::new();
    for text in ["L=80+-0.5", "L=80±0.5", "L=79..81"] {
        for verb in ["tolerance", "sensitivity", "modes"] {
            let run = w.run(&[verb, "slider-crank", "--param", text]).exits(2);
            let told = &run.stderr;
            assert!(told.contains("is an interval"), "{verb} {text}: {told}");
        }
        w.run(&["enclose", "slider-crank", "--samples", "3", "--param", text])
            .exits(0);
    }
}

#[test]
fn the_end_of_a_turn_counts_for_angles() {
    let w = Workspace::new();
    let scene = crank(30.0, 80.0).replace(
        "[measures]",
        "[measures]\nturned = { of = \"phi\", take = \"max\", max = 6 }\nway = { of = \"phi\", take = \"range\" }",
    );
    w.write("s.toml", scene);
    let full = std::f64::consts::TAU;
    let arguments = ["tolerance", "s.toml", "--vary", "L", "--tolerance", "0.1"];
    let run = w
        .run(&[&arguments[..], &["--pieces", "8", "--json", "-"]].concat())
        .exits(0);
    let report: Value = serde_json::from_slice(&run.stdout).unwrap();
    for name in ["turned", "way"] {
        let nominal = report["measures"][name]["nominal"].as_f64().unwrap();
        assert!((nominal - full).abs() < 1e-12, "{name}: {nominal}");
    }
    assert_eq!(report["good"], 0);
    let run = w.run(&[
        "enclose",
        "s.toml",
        "--vary",
        "L",
        "--tolerance",
        "0.1",
        "--samples",
        "3",
    ]);
    run.exits(1);
}

/// A parallelogram that starts folded flat.
const FOLDED: &str = r#"units = { length = "mm" }
duration = 4
[parameters]
a = 40
b = 100
c = 40
d = 100
[inputs]
phi = "2*pi*t/4"
[chains]
T1 = "Rz(phi) Tx(a) Rz(alpha) Tx(b)"
T2 = "Tx(d) Rz(psi) Tx(c)"
[loops]
A = "T1 Rz(mu) inv(T2)"
[guess]
psi = 0
[measures]
low = { of = "sin(psi)", take = "min" }
[study.variables]
c = { range = [1, 500], tolerance = 0.1 }
"#;

#[test]
fn pieces_begin_where_the_known_poses_are_however_flat_the_start() {
    let w = Workspace::new();
    // From the fold, and along a track that lies wholly behind the next one.
    let behind = FOLDED
        .replace("duration = 4", "duration = 1")
        .replace("2*pi*t/4", "0.5 + 4.5*t")
        .replace("psi = 0\n", "psi = 0.5\nalpha = -0.5\nmu = 0.5\n")
        .replace(
            "[measures]\nlow = { of = \"sin(psi)\", take = \"min\" }",
            "[tracks.R]\nsamples = 11\ninputs = { phi = [4, 5] }\n[measures]\nh = { track = \"R\", of = \"psi\", take = \"first\" }",
        );
    let starts = ["0", "0.1", "0.4", "0.8"]
        .map(|psi| FOLDED.replace("psi = 0\n", &format!("psi = {psi}\n")));
    for scene in starts.iter().chain([&behind]) {
        w.write("s.toml", scene);
        let arguments = ["tolerance", "s.toml", "--pieces", "100", "--json", "-"];
        let report: Value = serde_json::from_slice(&w.run(&arguments).exits(0).stdout).unwrap();
        // Those turn fully whose last link is longer than the crank: half of them.
        let failed = report["failed"].as_u64().unwrap();
        assert!((30..=70).contains(&failed), "{scene}: {failed}");
    }
}

#[test]
fn a_singular_pose_takes_no_derivative_from_what_does_not_depend_on_it() {
    let w = Workspace::new();
    let measures = "[measures]\nq = { of = \"c\", take = \"first\" }\nv = { of = \"phi\", take = \"min\" }\nu = { of = \"psi\", take = \"first\" }";
    let scene = FOLDED.replace("2*pi*t/4", "t/2").replace(
        "[measures]\nlow = { of = \"sin(psi)\", take = \"min\" }",
        measures,
    );
    w.write("s.toml", &scene);
    let arguments = ["tolerance", "s.toml", "--pieces", "20", "--json", "-"];
    let report: Value = serde_json::from_slice(&w.run(&arguments).exits(0).stdout).unwrap();
    let sums = ["q", "v", "u"].map(|name| report["measures"][name]["linear_sum"].as_f64());
    assert_eq!(sums, [Some(0.1), Some(0.0), None]);
    // Asked for all derivatives, the one that does not exist is named and the others are told; by itself it ranks nothing.
    let arguments = ["sensitivity", "s.toml", "--out", "s.json"];
    let text = w.run(&arguments).exits(0).text();
    assert!(
        text.contains("Without derivatives by all dimensions: u.\n"),
        "{text}"
    );
    let report: Value = serde_json::from_slice(&w.read("s.json")).unwrap();
    assert_eq!(report["without_derivatives"], serde_json::json!(["u"]));
    for row in report["dimensions"].as_array().unwrap() {
        let slopes = &row["derivatives"];
        assert!(slopes["q"].is_number() && slopes["v"].is_number(), "{row}");
    }
    for option in [["--rank", "u"], ["--scatter", "u=1"]] {
        w.run(&[&["sensitivity", "s.toml"][..], &option].concat())
            .exits(2)
            .says(&["`u` has no derivative"]);
    }
}

/// A four-bar that folds flat where d = a: the search ends there, and its motion may go on in either assembly.
#[test]
fn an_optimum_at_a_change_point_is_not_confirmed() {
    let folder = Workspace::new();
    let four_bar = |d: f64| {
        format!(
            "units = {{ length = \"mm\" }}\nduration = 1\n[inputs]\nphi = \"1 + 2*pi*t\"\n[parameters]\na = 30\nb = 50\nc = 50\nd = {d}\n\
             [loops]\nA = \"Rz(phi) Tx(a) Rz(th) Tx(b) Rz(mu) Tx(-c) Rz(-ps) Tx(-d)\"\n[guess]\nth = -0.3\nps = 1\n\
             [measures]\nF = \"(d - 30)^2\"\nmx = {{ of = \"ps\", take = \"max\" }}\n[study]\nminimise = \"F\"\n\
             [study.variables]\nd = {{ range = [29.5, 40] }}\n"
        )
    };
    folder.write("change.toml", four_bar(33.0));
    let run = folder.run(&["optimise", "change.toml"]).exits(1);
    assert!(
        run.text()
            .contains("Not confirmed: the motion passes a singular pose"),
        "{}",
        run.text()
    );
    // Where the file's own motion passes one, its result may.
    folder.write("flat.toml", four_bar(30.0));
    folder.run(&["optimise", "flat.toml"]).exits(0);
}
