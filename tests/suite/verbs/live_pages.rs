//! `mechanim report --live`: what the engine of a live page answers is what the program says of the same scene, digit by digit;
//! sliders follow the mechanism and stop where it does. In a browser, as WebAssembly, it is tested by `.ci/browsers`.

use crate::program::Workspace;
use base64::prelude::{BASE64_STANDARD, Engine as _};
use mechanim::page::live::{PageScenes, STAMP};
use mechanim::scene::builtin;
use serde_json::{Value, json};

const CRANK: &str = include_str!("../../../scenes/slider-crank.toml");

/// One scene of a live page.
struct Live {
    scenes: PageScenes,
    opened: Value,
}

impl Live {
    fn open(text: &str) -> Self {
        let mut scenes = PageScenes::default();
        let question =
            json!({ "ask": "open", "source": "scene.toml", "text": text, "shapes": true });
        let opened = read(&scenes.answer(&question.to_string()));
        Self { scenes, opened }
    }

    fn bytes(&mut self, question: Value) -> Vec<u8> {
        let answer = self.scenes.answer(&question.to_string());
        assert_eq!(answer[0], b'=', "{}", String::from_utf8_lossy(&answer));
        answer[1..].to_vec()
    }

    fn ask(&mut self, question: Value) -> Value {
        read(&self.scenes.answer(&question.to_string()))
    }

    fn table(&mut self) -> String {
        String::from_utf8(self.bytes(json!({ "ask": "csv" }))).unwrap()
    }

    fn slide(&mut self, name: &str, value: f64) -> Value {
        self.ask(json!({ "ask": "move", "name": name, "value": value.to_string() }))
    }

    fn toml(&mut self) -> String {
        self.ask(json!({ "ask": "toml" }))["text"]
            .as_str()
            .unwrap()
            .to_owned()
    }
}

fn read(answer: &[u8]) -> Value {
    serde_json::from_slice(answer).unwrap()
}

/// The table that the program writes.
fn solved(w: &Workspace, arguments: &[&str]) -> String {
    let arguments = [&["solve"], arguments, &["--out", "-", "--quiet"]].concat();
    w.run(&arguments).text()
}

fn words(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

#[test]
fn every_built_in_scene_gives_the_numbers_of_the_program() {
    let w = Workspace::new();
    for scene in builtin::ALL {
        let mut live = Live::open(scene.text);
        assert_eq!(live.table(), solved(&w, &[scene.name]), "{}", scene.name);
        let class = words(&live.opened["proof"]["class"]);
        let code = w.run(&["check", scene.name, "--quiet"]).code;
        assert!(class == "passed" || code != 0, "{}: {class}", scene.name);
        assert!(
            words(&live.opened["proof"]["head"]).contains("closed to"),
            "{}",
            live.opened["proof"]
        );
    }
}

#[test]
fn a_slider_leads_to_what_the_program_solves_with_that_parameter() {
    let w = Workspace::new();
    for (name, parameter, values) in [
        ("slider-crank", "L", [90.0, 75.5]),
        ("gearshift", "ZR1", [240.0, 236.4]),
        ("four-bar", "crank", [31.0, 29.5]),
        ("torus-torus", "r2", [0.0, 0.0]),
    ] {
        let text = builtin::find_builtin(name).unwrap().text;
        let mut live = Live::open(&text);
        let dimensions = live.opened["sliders"]["dimensions"]
            .as_array()
            .unwrap()
            .clone();
        assert!(!dimensions.is_empty(), "{name} has no sliders");
        let known = dimensions.iter().find(|d| d["name"] == parameter);
        let (parameter, values) = match known {
            Some(_) => (parameter, values),
            // Whatever it is called: a little more than it is.
            None => {
                let value = dimensions[0]["value"].as_f64().unwrap();
                (words(&dimensions[0]["name"]), [1.01 * value, 0.99 * value])
            }
        };
        for value in values {
            let state = live.slide(parameter, value);
            assert!(state["stopped"].is_null(), "{name}: {}", state["stopped"]);
            w.write("live.toml", live.toml());
            assert_eq!(
                live.table(),
                solved(&w, &["live.toml"]),
                "{name}: its own text"
            );
            if state["guess"].as_array().is_some_and(Vec::is_empty) {
                let change = format!("{parameter}={value}");
                let own = solved(&w, &[name, "--param", &change]);
                assert_eq!(live.table(), own, "{name} --param {change}");
            }
        }
    }
}

#[test]
fn the_article_is_that_of_the_report() {
    let w = Workspace::new();
    w.write("scene.toml", CRANK);
    let mut live = Live::open(CRANK);
    live.slide("L", 90.0);
    let settled = live.ask(json!({ "ask": "settle", "number": 0, "depth": 2 }));
    w.run(&["report", "scene.toml", "--param", "L=90", "--out", "p.html"])
        .exits(0);
    let page = String::from_utf8(w.read("p.html")).unwrap();
    // The page counts its mechanisms from one.
    let sections = words(&settled["sections"]).replace("chart-0-", "chart-1-");
    assert!(page.contains(&sections), "{sections:.3000}");
    assert!(page.contains(words(&settled["result"])));
    assert!(sections.contains("<h2>Motion and its proof</h2>"));
}

#[test]
fn where_the_way_ends_the_last_pose_stays() {
    // At a right angle of the crank the rod reaches the slide while it is longer than the crank.
    let text = CRANK.replace("phi = \"2*pi*t/4\"", "phi = \"pi/2\"");
    let mut live = Live::open(&text);
    assert!(live.slide("L", 60.0)["stopped"].is_null());
    let before = (live.table(), live.toml());
    let state = live.slide("L", 30.0);
    let at = state["stopped"]["at"].as_f64().unwrap();
    assert!((at - 40.0).abs() < 1e-3, "{}", state["stopped"]);
    assert!(
        words(&state["stopped"]["why"]).starts_with("L = "),
        "{}",
        state["stopped"]
    );
    assert_eq!(state["parameters"]["L"], "60");
    assert_eq!((live.table(), live.toml()), before);
    // Whoever wants to go there all the same is told that there is no pose.
    let there = live.ask(json!({ "ask": "assemble", "name": "L", "value": "30" }));
    assert_eq!(there["proof"]["class"], "failed", "{}", there["proof"]);
    // And comes back from there.
    let back = live.slide("L", 80.0);
    assert_eq!(back["proof"]["class"], "passed", "{}", back["proof"]);
}

#[test]
fn the_assembly_that_is_shown_is_followed() {
    // Crossed: the slide is on the other side.
    let mut scenes = PageScenes::default();
    let guess = json!([["alpha", "2.9"], ["h", "-40"]]);
    let text = CRANK.replace("phi = \"2*pi*t/4\"", "phi = 0.5");
    let open = json!({ "ask": "open", "text": text, "guess": guess });
    let opened = read(&scenes.answer(&open.to_string()));
    let mut live = Live { scenes, opened };
    let h = |table: &str| -> f64 {
        let names: Vec<&str> = table.lines().next().unwrap().split(',').collect();
        let at = names.iter().position(|n| *n == "h").unwrap();
        table
            .lines()
            .nth(1)
            .unwrap()
            .split(',')
            .nth(at)
            .unwrap()
            .parse()
            .unwrap()
    };
    assert!(h(&live.table()) < -40.0);
    for value in [90.0, 200.0, 50.0] {
        assert!(live.slide("L", value)["stopped"].is_null());
        assert!(h(&live.table()) < 0.0, "L = {value}");
    }
    let w = Workspace::new();
    w.write("live.toml", live.toml());
    assert_eq!(live.table(), solved(&w, &["live.toml"]));
}

#[test]
fn inputs_are_led_by_hand_and_given_back_to_the_drive() {
    let mut live = Live::open(CRANK);
    let before = live.table();
    let state = live.ask(json!({ "ask": "drive", "time": 0.0, "inputs": [["phi", 1.0]] }));
    assert_eq!(state["held"], true);
    assert_eq!(state["times"].as_array().unwrap().len(), 1);
    let table = live.table();
    let row: Vec<f64> = table
        .lines()
        .nth(1)
        .unwrap()
        .split(',')
        .take(5)
        .map(|v| v.parse().unwrap())
        .collect();
    assert!(row.contains(&1.0), "{row:?}");
    // h = r cos phi + sqrt(L² - r² sin² phi)
    let h = 40.0 * 1f64.cos() + (6400.0 - 1600.0 * 1f64.sin().powi(2)).sqrt();
    assert!(row.iter().any(|v| (v - h).abs() < 1e-9), "{h}: {row:?}");
    // The rod is too short to go round.
    live.ask(json!({ "ask": "release" }));
    live.slide("L", 30.0);
    let state = live.ask(json!({ "ask": "drive", "time": 0.0, "inputs": [["phi", 1.5]] }));
    let at = state["stopped"]["at"].as_f64().unwrap();
    assert!(
        (at * 1.5 - 0.75f64.asin()).abs() < 1e-3,
        "{}",
        state["stopped"]
    );
    live.slide("L", 80.0);
    assert_eq!(live.table(), before);
}

/// The placement of a body at the only pose that a page shows: a quaternion (x, y, z, w) and a place, as 32-bit numbers.
fn placement(state: &Value, body: usize) -> (glam::DQuat, glam::DVec3) {
    let text = words(&state["motion"]["bodies"][body]["poses"]);
    let bytes = BASE64_STANDARD.decode(text).unwrap();
    let numbers = bytes.chunks_exact(4);
    let numbers: Vec<f64> = numbers
        .map(|b| f64::from(f32::from_le_bytes(b.try_into().unwrap())))
        .collect();
    (
        glam::DQuat::from_array([0, 1, 2, 3].map(|k| numbers[k])),
        glam::DVec3::from_array([4, 5, 6].map(|k| numbers[k])),
    )
}

/// A point of a link is pulled to where it is when the inputs are led there: the link follows, seen along any direction across
/// which the point moves.
#[test]
fn a_pulled_link_follows_the_pointer() {
    let along = glam::DVec3::new(0.3, -0.2, 1.0).normalize();
    for (scene, inputs, size) in [
        ("slider-crank", json!([["phi", 0.9]]), 120.0),
        ("four-bar", json!([["phi", 100.0]]), 100.0),
        ("seven-r", json!([["beta1", 25.0]]), 40.0),
        ("gearshift", json!([["p", 9.0], ["phi", 0.15]]), 900.0),
    ] {
        let text = builtin::find_builtin(scene).unwrap().text;
        let mut live = Live::open(&text);
        let bodies = live.opened["motion"]["bodies"].as_array().unwrap().len();
        let point = glam::DVec3::new(0.03, 0.05, -0.02) * size;
        for body in 0..bodies {
            let there = live.ask(json!({ "ask": "drive", "time": 0.0, "inputs": inputs }));
            let (turn, place) = placement(&there, body);
            let to = turn * point + place;
            live.ask(json!({ "ask": "release" }));
            let start = live.ask(json!({ "ask": "drive", "time": 0.0, "inputs": [] }));
            let miss = |state: &Value| {
                let (turn, place) = placement(state, body);
                (turn * point + place - to).reject_from(along).length()
            };
            let first = miss(&start);
            let question = json!({
                "ask": "pull", "time": 0.0, "body": body, "point": point.to_array(),
                "to": to.to_array(), "along": along.to_array(),
            });
            let mut last = first;
            for _ in 0..12 {
                let state = live.ask(question.clone());
                let now = miss(&state);
                assert!(
                    now <= last + 1e-5 * size,
                    "{scene}, body {body}: {now} after {last}"
                );
                last = now;
            }
            // Where the point does not move, it stays.
            assert!(
                last <= 2e-3 * size.min(first.max(1e-3 * size)) + 2e-4 * size,
                "{scene}, body {body}: {last} of {first}"
            );
            live.ask(json!({ "ask": "release" }));
        }
    }
}

/// The list of assemblies is that of `modes`, and whoever chooses one sees the motion that the program makes of the page's text.
#[test]
fn assemblies_are_those_of_modes_and_can_be_chosen() {
    let w = Workspace::new();
    for (scene, count) in [("slider-crank", 2), ("seven-r", 8)] {
        let text = builtin::find_builtin(scene).unwrap().text;
        let mut live = Live::open(&text);
        let found = live.ask(json!({ "ask": "assemblies", "number": 0 }));
        let list = found["assemblies"].as_array().unwrap();
        assert_eq!(list.len(), count, "{found}");
        w.write("modes.toml", &text);
        let told = w.run(&["modes", "modes.toml"]).text();
        assert!(told.contains(words(&found["headline"])), "{found}: {told}");
        assert_eq!(
            list.iter().filter(|a| a["now"] == true).count(),
            1,
            "{found}"
        );
        let mut tables = Vec::new();
        for assembly in list {
            let state = live.ask(json!({ "ask": "choose", "guess": assembly["guess"] }));
            assert!(state["mistakes"].is_null(), "{state}");
            w.write("chosen.toml", live.toml());
            let table = live.table();
            assert_eq!(table, solved(&w, &["chosen.toml"]), "{scene}: {assembly}");
            tables.push(table);
            // The sliders follow this assembly, not the scene's own.
            let again = live.ask(json!({ "ask": "assemblies" }));
            let now = again["assemblies"].as_array().unwrap().iter();
            let now: Vec<&Value> = now.filter(|a| a["now"] == true).collect();
            assert_eq!(words(&now[0]["label"]), words(&assembly["label"]));
        }
        tables.dedup();
        assert_eq!(tables.len(), count, "{scene}");
    }
}

/// Start values whose names have several dots are written so that they are read again.
#[test]
fn chosen_start_values_can_be_read_again() {
    let w = Workspace::new();
    let text = builtin::find_builtin("dyads-bars").unwrap().text;
    let mut live = Live::open(&text);
    let found = live.ask(json!({ "ask": "assemblies" }));
    let list = found["assemblies"].as_array().unwrap();
    let other = list.iter().find(|a| a["now"] == false).unwrap();
    let state = live.ask(json!({ "ask": "choose", "guess": other["guess"] }));
    assert!(state["mistakes"].is_null(), "{state}");
    w.write("chosen.toml", live.toml());
    assert_eq!(live.table(), solved(&w, &["chosen.toml"]));
}

/// The clearances that a page tells before the article is made are those of `check`.
#[test]
fn clearances_are_those_of_check() {
    let w = Workspace::new();
    for scene in ["four-bar", "torus-torus", "slider-crank"] {
        let text = builtin::find_builtin(scene).unwrap().text;
        let mut live = Live::open(&text);
        let told = live.ask(json!({ "ask": "clearance" }));
        w.write("scene.toml", &text);
        let checked = w.run(&["check", "scene.toml", "--json", "report.json"]);
        let report: Value = serde_json::from_slice(&w.read("report.json")).unwrap();
        let cases = report["checks"].as_array().unwrap().iter();
        let mut cases = cases.filter(|case| case["group"] == "clearance");
        let passed = !cases.any(|case| ["failed", "not proved"].contains(&words(&case["status"])));
        assert_eq!(
            told["clearance"]["class"] == "passed",
            passed,
            "{scene}: {told}"
        );
        let pair = &report["clearance"]["pairs"][0];
        let text = words(&told["clearance"]["text"]);
        for body in pair["bodies"].as_array().unwrap() {
            assert!(text.contains(words(body)), "{text}: {pair}");
        }
        assert_eq!(told["proof"]["class"], "passed", "{told}");
        drop(checked);
        // The article uses them, and says the same.
        let settled = live.ask(json!({ "ask": "settle" }));
        let again = live.ask(json!({ "ask": "settle" }));
        assert_eq!(settled, again, "{scene}");
    }
}

/// A move sends the meshes of those bodies whose shapes have changed, and of no others.
#[test]
fn only_changed_bodies_are_meshed_again() {
    let mut live = Live::open(CRANK);
    let all = live.opened["model"]["parts"].as_array().unwrap().len();
    let state = live.slide("L", 90.0);
    let replaced = state["model"]["replaced"].as_array().unwrap();
    // The rod alone is as long as L.
    let names = replaced.iter().map(|k| {
        let body = k.as_u64().unwrap() as usize;
        words(&live.opened["motion"]["bodies"][body]["name"])
    });
    assert_eq!(names.collect::<Vec<_>>(), ["rod"], "{replaced:?}");
    let parts = state["model"]["parts"].as_array().unwrap();
    assert!(!parts.is_empty() && parts.len() < all);
    assert!(parts.iter().all(|part| replaced.contains(&part["body"])));
    // A move that changes no shape sends none.
    let still = live.ask(json!({ "ask": "drive", "time": 0.0, "inputs": [["phi", 0.3]] }));
    assert!(still["model"].is_null());
}

#[test]
fn pictures_are_those_of_render() {
    let w = Workspace::new();
    for (name, moved) in [("gearshift", ("L4", 881.0)), ("torus-torus", ("r1", 1.75))] {
        let text = builtin::find_builtin(name).unwrap().text;
        let mut live = Live::open(&text);
        w.write("scene.toml", &text);
        let render = |change: &[&str]| {
            let still = [
                "--renderer",
                "cpu",
                "--frame",
                "7",
                "--out",
                "f.png",
                "--quiet",
            ];
            w.run(&[&["render", "scene.toml"], &still[..], change].concat())
                .exits(0);
        };
        render(&[]);
        let drawn = image::load_from_memory(&w.read("f.png"))
            .unwrap()
            .to_rgba8();
        let times = mechanim::Scene::builtin(name)
            .unwrap()
            .solve(mechanim::Samples::Frames)
            .unwrap()
            .times();
        let pixels = live.bytes(json!({ "ask": "picture", "time": times[7] }));
        assert!(drawn.into_raw() == pixels, "{name}");
        let png = live.bytes(json!({ "ask": "png", "time": times[7] }));
        assert!(png == w.read("f.png"), "{name}");
        // The file names what is changed.
        assert!(live.slide(moved.0, moved.1)["stopped"].is_null());
        let png = live.bytes(json!({ "ask": "png", "time": times[7] }));
        render(&["--param", &format!("{}={}", moved.0, moved.1)]);
        assert!(png == w.read("f.png"), "{name}, moved");
    }
    let mut live = Live::open(CRANK);
    w.write("crank.toml", CRANK);
    w.run(&[
        "render",
        "crank.toml",
        "--renderer",
        "cpu",
        "--size",
        "160x120",
        "--out",
        "a.gif",
    ])
    .exits(0);
    let gif = live.bytes(json!({ "ask": "gif", "size": [160, 120] }));
    assert!(gif == w.read("a.gif"));
}

#[test]
fn mistakes_have_places_and_change_nothing() {
    let mut live = Live::open(CRANK);
    let before = live.table();
    let text = CRANK.replace("Tx(r) Rz(alpha)", "Tx(r] Rz(alpha)");
    let told = live.ask(json!({ "ask": "open", "text": text }));
    let place = &told["mistakes"][0]["place"];
    let [from, to, line] = ["from", "to", "line"].map(|key| place[key].as_u64().unwrap() as usize);
    assert!(
        text.lines().nth(line - 1).unwrap().contains("Tx(r]"),
        "{told}"
    );
    assert!(from < to && text[..from].lines().count() == line, "{told}");
    assert_eq!(live.table(), before);
    for (question, part) in [
        (
            json!({ "ask": "move", "name": "L", "value": "1e" }),
            "is not a number",
        ),
        (json!({ "ask": "move", "name": "Q", "value": "1" }), "Q"),
        (json!({ "ask": "drive", "inputs": [["Q", 1]] }), "Q"),
        (json!({ "ask": "settle", "number": 7 }), "7"),
        (json!({ "ask": "pull", "body": 99 }), "no such body"),
        (json!({ "ask": "choose", "guess": [["h", "far"]] }), "`far`"),
        (json!({ "ask": "fly" }), "fly"),
    ] {
        let told = live.ask(question);
        assert!(
            words(&told["mistakes"][0]["message"]).contains(part),
            "{told}"
        );
    }
    assert_eq!(
        read(&live.scenes.answer("{"))["mistakes"]
            .as_array()
            .unwrap()
            .len(),
        1
    );
    assert_eq!(live.table(), before);
}

#[test]
fn a_live_page_holds_its_engine_and_a_stricter_word_for_it() {
    let w = Workspace::new();
    let engine = [b"\0asm\x01\0\0\0", STAMP.as_bytes()].concat();
    w.write("engine.wasm", &engine);
    let live = |out: &str| {
        [
            "report",
            "four-bar",
            "--live",
            "--wasm",
            "engine.wasm",
            "--out",
            out,
        ]
        .map(str::to_owned)
    };
    w.run(&live("p.html")).exits(0);
    let page = String::from_utf8(w.read("p.html")).unwrap();
    let policy = page
        .split("content=\"")
        .nth(1)
        .unwrap()
        .split('"')
        .next()
        .unwrap();
    assert!(
        policy.starts_with("default-src 'none'; img-src data:; style-src 'sha256-"),
        "{policy}"
    );
    assert!(
        policy.contains(" 'wasm-unsafe-eval'; worker-src blob:; base-uri 'none'"),
        "{policy}"
    );
    assert_eq!(policy.matches("'sha256-").count(), 5, "{policy}");
    assert!(!policy.contains("'unsafe"), "{policy}");
    assert_eq!(page.matches("<script").count(), 3);
    for id in ["engine", "packed"] {
        let packed = format!("<script type=\"application/octet-stream\" id=\"{id}\">");
        assert!(page.contains(&packed), "{id}");
    }
    // The page without sliders is the same but for these.
    w.run(&["report", "four-bar", "--out", "q.html"]).exits(0);
    let still = String::from_utf8(w.read("q.html")).unwrap();
    assert!(!still.contains("id=\"engine\"") && !still.contains("wasm-unsafe-eval"));
}

#[test]
fn without_its_engine_a_live_page_says_how_to_get_it() {
    let w = Workspace::new();
    let build = "cargo build --profile web --target wasm32-unknown-unknown -p mechanim-web";
    w.run(&[
        "report",
        "four-bar",
        "--live",
        "--wasm",
        "none.wasm",
        "--out",
        "p.html",
    ])
    .exits(2)
    .says(&["was not found", "none.wasm", build]);
    w.write("other.wasm", b"\0asm\x01\0\0\0mechanim-web 0.0.0\n");
    w.run(&[
        "report",
        "four-bar",
        "--live",
        "--wasm",
        "other.wasm",
        "--out",
        "p.html",
    ])
    .exits(2)
    .says(&["it is not the engine `mechanim-web", build]);
    w.write("text.wasm", "text");
    w.run(&[
        "report",
        "four-bar",
        "--live",
        "--wasm",
        "text.wasm",
        "--out",
        "p.html",
    ])
    .exits(2)
    .says(&["it is not WebAssembly"]);
    assert!(!w.path("p.html").exists());
}
