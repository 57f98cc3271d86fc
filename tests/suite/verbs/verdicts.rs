//! Exit code, text, JSON and JUnit of a check say the same, whatever is wrong with the scene.

use crate::program::{CHANGES, Run, Workspace};
use mechanim::scene::builtin;
use serde_json::Value;
use xml::reader::{EventReader, XmlEvent};

/// Crank and rod, 40 and 80 mm, with a measure that has a limit and a pair of bodies that is judged.
const CRANK: &str = r#"title = "crank"
units = { length = "mm", angle = "rad" }
duration = 1
[inputs]
phi = "0.2 + t"
[loops]
A = "Rz(phi) Tx(40) Rz(alpha) Tx(80) Rz(beta) Tx(-h)"
[guess]
h = 120
[measures]
stroke = { of = "h", take = "range", max = 60, why = "the cylinder is short" }
[[bodies]]
name = "crank"
frame = "Rz(phi)"
shapes = [{ capsule = { from = [0, 0, 0], to = [40, 0, 0], radius = 5 } }]
[[bodies]]
name = "slider"
frame = "Tx(h)"
shapes = [{ sphere = { radius = 5 } }]
[clearance]
minimum = 1
"#;

/// A question of a JUnit file: its name and what its element holds.
struct Case {
    group: String,
    name: String,
    /// `failure`, `error`, `skipped` or `system-out`.
    answer: String,
    /// Text inside, or the message.
    text: String,
}

struct Junit {
    /// Of the suite.
    name: String,
    /// Tests, failures, errors, skipped.
    totals: [usize; 4],
    cases: Vec<Case>,
}

fn read_junit(bytes: &[u8]) -> Junit {
    let mut junit = Junit {
        name: String::new(),
        totals: [0; 4],
        cases: Vec::new(),
    };
    let mut suites = 0;
    for event in EventReader::new(bytes) {
        match event.unwrap() {
            XmlEvent::StartElement {
                name, attributes, ..
            } => {
                let of = |wanted: &str| {
                    let mut list = attributes.iter();
                    let found = list.find(|a| a.name.local_name == wanted);
                    found.map(|a| a.value.clone())
                };
                match name.local_name.as_str() {
                    "testsuites" | "testsuite" => {
                        let number = |name: &str| of(name).unwrap().parse::<usize>().unwrap();
                        let totals = ["tests", "failures", "errors", "skipped"].map(number);
                        assert!(suites == 0 || totals == junit.totals);
                        assert!(of("time").unwrap().parse::<f64>().unwrap() >= 0.0);
                        junit.totals = totals;
                        junit.name = of("name").unwrap_or_default();
                        suites += 1;
                    }
                    "testcase" => {
                        if let Some(time) = of("time") {
                            assert!(time.parse::<f64>().unwrap() >= 0.0);
                        }
                        junit.cases.push(Case {
                            group: of("classname").unwrap(),
                            name: of("name").unwrap(),
                            answer: String::new(),
                            text: String::new(),
                        });
                    }
                    answer => {
                        let case = junit.cases.last_mut().unwrap();
                        assert_eq!(case.answer, "", "two answers");
                        case.answer = answer.to_owned();
                        case.text = of("message").unwrap_or_default();
                    }
                }
            }
            XmlEvent::Characters(text) => {
                let case = junit.cases.last_mut().unwrap();
                assert!(case.text.is_empty() || case.text == text);
                case.text = text;
            }
            _ => {}
        }
    }
    assert_eq!(suites, 2);
    junit
}

/// What one check said in all four ways, found to agree.
struct Said {
    code: i32,
    word: String,
    json: Value,
    junit: Junit,
}

impl Said {
    fn case(&self, name: &str) -> &Case {
        let mut cases = self.junit.cases.iter();
        cases.find(|c| c.name == name).unwrap_or_else(|| {
            let names: Vec<&str> = self.junit.cases.iter().map(|c| c.name.as_str()).collect();
            panic!("no case `{name}`: {names:?}")
        })
    }

    /// Cases with this answer.
    fn answers(&self, answer: &str) -> Vec<&str> {
        let cases = self.junit.cases.iter().filter(|c| c.answer == answer);
        cases.map(|c| c.name.as_str()).collect()
    }
}

/// Checks `scene` and holds everything that is said against each other.
fn check(w: &Workspace, what: &str, scene: &str, options: &[&str]) -> Said {
    let fixed = ["check", scene, "--json", "r.json", "--junit", "r.xml"];
    let run = w.run(&[&fixed[..], options].concat());
    let json: Value = serde_json::from_slice(&w.read("r.json")).unwrap();
    let junit = read_junit(&w.read("r.xml"));
    let word = json["result"].as_str().unwrap().to_owned();
    agree(what, &run, &word, &json, &junit);
    // Without files nothing changes.
    let plain = w.run(&[&["check", scene], options].concat());
    assert_eq!(plain.code, run.code, "{what}");
    Said {
        code: run.code,
        word,
        json,
        junit,
    }
}

fn agree(what: &str, run: &Run, word: &str, json: &Value, junit: &Junit) {
    let codes = [
        ("passed", 0),
        ("failed", 1),
        ("not proved", 1),
        ("not closed over the whole motion", 4),
    ];
    let expected = codes.iter().find(|(known, _)| *known == word);
    let said = format!("{what}: {word}, {}\n{}", run.code, run.text());
    assert_eq!(expected.map(|c| c.1), Some(run.code), "{said}");
    // The text: nothing where there is nothing to report on, which standard error says.
    match run.text().lines().find(|l| l.trim().starts_with("result")) {
        Some(line) => {
            let line = line.trim().trim_start_matches("result");
            let line = line.trim_start_matches(':').trim();
            let first = line.split([':', ';']).next().unwrap();
            assert_eq!(first, word, "{said}");
        }
        None => assert!(
            run.stdout.is_empty() && run.stderr.contains("error"),
            "{said}"
        ),
    }
    // Cases one by one.
    let checks = json["checks"].as_array().unwrap();
    assert_eq!(checks.len(), junit.cases.len(), "{said}");
    for (check, case) in checks.iter().zip(&junit.cases) {
        assert_eq!(check["group"], case.group.as_str(), "{said}");
        let answer = match check["status"].as_str().unwrap() {
            "passed" => "system-out",
            "skipped" => "skipped",
            "not proved" => "error",
            "failed" | "not closed over the whole motion" => "failure",
            other => panic!("{other}"),
        };
        assert_eq!(answer, case.answer, "{said}{}", case.name);
    }
    let count = |answer: &str| junit.cases.iter().filter(|c| c.answer == answer).count();
    let counted = [count("failure"), count("error"), count("skipped")];
    assert_eq!(junit.totals[0], junit.cases.len(), "{said}");
    assert_eq!(junit.totals[1..], counted, "{said}");
    assert_eq!(run.code == 0, counted[0] + counted[1] == 0, "{said}");
    assert_eq!(
        word == "not proved",
        counted[0] == 0 && counted[1] > 0,
        "{said}"
    );
    // The parts of the JSON report.
    let is_bad = |group: &str| {
        let mut cases = junit.cases.iter().filter(|c| c.group == group);
        cases.any(|c| c.answer == "failure" || c.answer == "error")
    };
    if let Some(passed) = json["clearance"]["passed"].as_bool() {
        assert_eq!(passed, !is_bad("clearance"), "{said}");
    }
    if let Some(measures) = json["measures"].as_array() {
        let all = measures.iter().all(|m| m["holds"] == true);
        assert_eq!(all, !is_bad("measures"), "{said}");
    }
}

#[test]
fn every_fault_is_said_in_all_four_ways() {
    let w = Workspace::new();
    let broken = |text: &str| text.replace("max = 60", "max = 20");
    let cut = |text: &str| text.replace("minimum = 1", "minimum = 70");
    let leaves = |text: &str| text.replace("Tx(80)", "Tx(30)");
    let nothing = |text: &str| {
        text.to_owned()
            + "ignore = [{ pair = [\"crank\", \"slider\"], reason = \"nobody looks\" }]\n"
    };
    let kinked = |text: &str| text.replace("\"0.2 + t\"", "\"0.2 + sqrt((t - 0.377)^2)\"");
    let no_value = |text: &str| {
        text.replace("take = \"range\"", "take = \"max\"")
            .replace("of = \"h\"", "of = \"h*(phi - 0.2)/(phi - 0.2)\"")
    };
    let plain = |text: &str| text.split("[measures]").next().unwrap().to_owned();
    let limited =
        CHANGES.to_owned() + "[measures]\nwidest = { of = \"h\", take = \"max\", max = 1 }\n";
    let at_the_singular_pose: &[&str] = &["--samples", "3"];
    let none: &[&str] = &[];
    // What is wrong, the scene, options, exit code, failures, errors.
    type Case<'a> = (&'a str, String, &'a [&'a str], i32, usize, usize);
    let cases: [Case; 20] = [
        ("nothing", CRANK.to_owned(), none, 0, 0, 0),
        (
            "nothing, with a proof",
            CRANK.to_owned(),
            &["--certify", "motion"],
            0,
            0,
            0,
        ),
        (
            "nothing, without a proof",
            CRANK.to_owned(),
            &["--certify", "none"],
            0,
            0,
            0,
        ),
        ("nothing, and little is asked", plain(CRANK), none, 0, 0, 0),
        ("a broken measure", broken(CRANK), none, 1, 1, 0),
        ("a measure without a value", no_value(CRANK), none, 1, 1, 0),
        ("a cut pair", cut(CRANK), none, 1, 1, 0),
        (
            "a closure error",
            CRANK.to_owned(),
            &["--closure", "1e-30"],
            1,
            1,
            0,
        ),
        ("missing poses", plain(&leaves(CRANK)), none, 4, 1, 0),
        (
            "a refused pose",
            CHANGES.to_owned(),
            at_the_singular_pose,
            1,
            0,
            1,
        ),
        (
            "a refused pose that nobody asked to prove",
            CHANGES.to_owned(),
            &["--samples", "3", "--certify", "none"],
            0,
            0,
            0,
        ),
        (
            "a refused motion",
            CHANGES.to_owned(),
            &["--samples", "4", "--certify", "motion"],
            1,
            0,
            1,
        ),
        (
            "a refused motion that nobody asked to prove",
            CHANGES.to_owned(),
            &["--samples", "4"],
            0,
            0,
            0,
        ),
        ("nothing judged", nothing(CRANK), none, 1, 0, 1),
        // The stroke and the pair.
        ("an estimate", kinked(CRANK), none, 1, 0, 2),
        (
            "an estimate that is enough",
            kinked(CRANK),
            &["--certify", "none"],
            0,
            0,
            0,
        ),
        ("a measure and a pair", cut(&broken(CRANK)), none, 1, 2, 0),
        (
            "a measure and nothing judged",
            nothing(&broken(CRANK)),
            none,
            1,
            1,
            1,
        ),
        (
            "a measure and a refused pose",
            limited,
            at_the_singular_pose,
            1,
            1,
            1,
        ),
        // The measure has no value there, the pair is not proved, and the stretch is not looked at.
        ("missing poses and a stretch", leaves(CRANK), none, 4, 2, 2),
    ];
    for (what, text, options, code, failures, errors) in cases {
        w.write("s.toml", &text);
        let said = check(&w, what, "s.toml", options);
        assert_eq!(said.code, code, "{what}");
        let counts = (said.answers("failure"), said.answers("error"));
        assert_eq!(
            (counts.0.len(), counts.1.len()),
            (failures, errors),
            "{what}: {counts:?}"
        );
        assert!(
            said.junit.cases.iter().all(|c| !c.text.is_empty()),
            "{what}"
        );
    }
}

#[test]
fn values_and_limits_are_in_the_cases() {
    let w = Workspace::new();
    w.write(
        "bad.toml",
        CRANK
            .replace("max = 60", "max = 20")
            .replace("minimum = 1", "minimum = 70"),
    );
    let said = check(&w, "two faults", "bad.toml", &[]);
    let holds = |name: &str, parts: &[&str]| {
        let case = said.case(name);
        for part in parts {
            assert!(case.text.contains(part), "{part}: {}", case.text);
        }
    };
    holds(
        "stroke",
        &[
            "is above the limit 20",
            "the cylinder is short",
            "at most 20 mm",
        ],
    );
    holds(
        "crank / slider",
        &[
            "failed",
            "the minimum is 70.000000 mm",
            "never below",
            "proved",
        ],
    );
    holds("motion closes", &["21 samples, all with a pose"]);
    holds("pose certificates", &["error at most", "refused 0 of 21"]);
    w.write("leaves.toml", CRANK.replace("Tx(80)", "Tx(30)"));
    let said = check(&w, "missing poses", "leaves.toml", &[]);
    let closes = said.case("motion closes");
    assert!(
        closes.text.contains("samples have no pose"),
        "{}",
        closes.text
    );
    assert!(
        said.answers("error")
            .iter()
            .any(|name| name.starts_with("t = "))
    );
    assert_eq!(said.json["clearance"]["passed"], false);
}

#[test]
fn a_motion_that_never_closes_is_reported_all_the_same() {
    let w = Workspace::new();
    // No pose at any sample; and a loop that closes nowhere, which is seen before anything is solved.
    let crank = CRANK.split("[measures]").next().unwrap();
    let far = crank.replace("Rz(beta) Tx(-h)", "Rz(beta) Tx(-130) Rz(h)");
    let skew = crank.replace("Rz(beta)", "Rz(beta) Tz(3)");
    for (what, text, words) in [
        ("far", far, "21 of 21 samples have no pose"),
        ("skew", skew, "always differs by 3"),
    ] {
        w.write("never.toml", text);
        let said = check(&w, what, "never.toml", &["--input", "phi=2"]);
        assert_eq!(said.code, 4, "{what}");
        assert!(said.case("motion closes").text.contains(words), "{what}");
    }
}

#[test]
fn offered_poses_are_judged_with_their_equations() {
    let w = Workspace::new();
    w.write(
        "s.toml",
        CRANK.split("[measures]").next().unwrap().replace(
            "[guess]",
            "[equations]\nrope = \"k - 2*h\"\n[guess]\nk = 240",
        ),
    );
    // The crank at 0.2 rad.
    let beta = -(0.2_f64 + (-(40.0 * 0.2_f64.sin()) / 80.0).asin() - 0.2);
    let alpha = -0.2 - beta;
    let h = 40.0 * 0.2_f64.cos() + 80.0 * beta.cos();
    for (what, k, turn, code) in [
        ("closed", 2.0 * h, 0.0, 0),
        ("the equation is open", 2.0 * h + 3.0, 0.0, 1),
        ("the loop is open", 2.0 * h, 0.1, 1),
    ] {
        let pose = format!("alpha={},beta={},h={h},k={k}", alpha + turn, beta);
        let said = check(&w, what, "s.toml", &["--pose", &pose]);
        assert_eq!(said.code, code, "{what}");
    }
    for option in ["--csv", "--plot", "--render"] {
        w.run(&["check", "s.toml", "--pose", "h=1", option, "x.png"])
            .exits(2);
    }
}

#[test]
fn odd_names_stay_readable() {
    let w = Workspace::new();
    let odd = r#"a < b & \"c\" > 'd' \u0007 \u0085 é ]]> \t \uFFFE"#;
    let text = CRANK
        .replace("title = \"crank\"", &format!("title = \"{odd}\""))
        .replace("name = \"slider\"", &format!("name = \"slider {odd}\""))
        .replace("the cylinder is short", odd)
        .replace("max = 60", "max = 20");
    w.write("odd.toml", text);
    let said = check(&w, "odd", "odd.toml", &[]);
    let seen = "a < b & \"c\" > 'd' \\u{7} \\u{85} é ]]> \\t \u{fffd}";
    assert_eq!(said.junit.name, seen);
    assert!(
        said.case("stroke").text.contains(seen),
        "{}",
        said.case("stroke").text
    );
    let names: Vec<&str> = said.junit.cases.iter().map(|c| c.name.as_str()).collect();
    assert!(
        names.contains(&format!("crank / slider {seen}").as_str()),
        "{names:?}"
    );
}

#[test]
fn built_in_scenes_agree_with_themselves() {
    let w = Workspace::new();
    for scene in builtin::ALL.map(|s| s.name) {
        check(&w, scene, scene, &["--bound-tolerance", "0.01"]);
    }
}

/// Freedoms that nothing drives are refused, whether the count of equations shows them or closed poses only.
#[test]
fn undriven_freedoms_are_never_passed() {
    let w = Workspace::new();
    // A ring of six hinges (Bricard's of three planes): six equations, six unknowns, and it moves.
    let ring = r#"duration = 1
units = { length = "m", angle = "deg" }
[loops]
A = "Rz(t1) Tx(1) Rx(90) Rz(t2) Tx(1) Rx(-90) Rz(t3) Tx(1) Rx(90) Rz(t4) Tx(1) Rx(-90) Rz(t5) Tx(1) Rx(90) Rz(t6) Tx(1) Rx(-90)"
[guess]
t1 = 60
t2 = -100
t3 = 60
t4 = -100
t5 = 60
t6 = -100
"#;
    let five_bar =
        "[loops]\nA = \"Rz(a) Tx(2) Rz(b) Tx(3) Rz(c) Tx(3) Rz(d) Tx(2.5) Rz(e) Tx(2)\"\n";
    for text in [ring, five_bar] {
        w.write("free.toml", text);
        for verb in [
            &["check", "free.toml"][..],
            &["solve", "free.toml", "--out", "-"],
        ] {
            w.run(verb)
                .exits(2)
                .prints_nothing()
                .says(&[" free than the inputs drive"]);
        }
    }
    // Driven it is fine.
    let driven = ring.replace("Rz(t1)", "Rz(p)").replace("t1 = 60\n", "");
    w.write(
        "driven.toml",
        driven.replace("[loops]", "[inputs]\np = \"60 + t\"\n[loops]"),
    );
    w.run(&["check", "driven.toml"]).exits(0);
    // A stretched pair of bars is singular and does not move: it is not proved, but nothing is free.
    let flat = "[loops]\nA = \"Rz(a) Tx(1) Rz(b) Tx(1) Rz(c) Tx(-2)\"\n[guess]\na = 0.1\nb = -0.2\nc = 0.1\n";
    w.write("flat.toml", flat);
    let said = check(&w, "flat", "flat.toml", &[]);
    assert_eq!(said.word, "not proved");
}

#[test]
fn open_chains_have_no_singular_value_and_no_certificate() {
    let w = Workspace::new();
    let arm = r#"duration = 1
[inputs]
p = "t"
q = "2*t"
[[bodies]]
name = "hand"
frame = "Rz(p) Tx(1) Ry(q) Tx(1)"
"#;
    w.write("arm.toml", arm);
    let text = w.run(&["check", "arm.toml"]).exits(0).text();
    assert!(text.contains("open chain: 2 freedoms, 2 driven"), "{text}");
    for word in ["sigma", "inf", "certificate", "condition", "assumed"] {
        assert!(!text.contains(word), "{word}: {text}");
    }
    let said = check(&w, "arm", "arm.toml", &[]);
    for key in ["sigma_min", "condition", "error_bound", "unique_radius"] {
        assert!(said.json[key].is_null(), "{key}");
    }
    assert_eq!(said.answers("skipped"), ["pose certificates"]);
    let said = check(&w, "arm", "arm.toml", &["--certify", "motion"]);
    assert!(!said.case("motion certificate").text.contains("inf"));
}
