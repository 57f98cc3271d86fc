//! A search that the time of a run cuts off: what is proved by then is reported, before the time is over.

use crate::program::Workspace;
use serde_json::Value;
use std::fmt::Write;

/// Seconds that the run may take.
const LIMIT: f64 = 8.0;

/// So many that no machine is done in this time: each takes most of a second.
const RINGS: usize = 40;

/// Boxes that tumble in rings, each pair far from the next one: nothing parts a box from a ring around it, and the proof that
/// it stays away takes long.
fn rings(count: usize) -> String {
    let mut text = String::from(
        "duration = 2\nunits = { length = \"mm\", angle = \"rad\" }\n\
         [inputs]\nu = \"90*t\"\nv = \"37*t\"\nw = \"3*sin(20*t)\"\n",
    );
    for k in 0..count {
        let x = 100 * k;
        let _ = write!(
            text,
            "[[bodies]]\nname = \"ring{k}\"\nframe = \"Tx({x})\"\n\
             shapes = [{{ torus = {{ ring = 20, tube = 3 }} }}]\n\
             [[bodies]]\nname = \"box{k}\"\nframe = \"Tx({x}) Rx(u) Ry(v) Tz(0.01*w)\"\n\
             shapes = [{{ box = {{ size = [10.5, 11, 12] }} }}, {{ torus = {{ ring = 7, tube = 2 }} }}]\n"
        );
    }
    text + "[clearance]\nminimum = 7.293\n"
}

/// One after the other: each shares its time with as little as can be.
#[test]
fn what_is_proved_when_the_time_is_over_is_reported() {
    what_is_proved_of_rings_is_reported();
    what_is_proved_of_all_pieces_is_reported();
}

fn what_is_proved_of_rings_is_reported() {
    let w = Workspace::new();
    w.write("scene.toml", rings(RINGS));
    let limit = format!("time={LIMIT}s");
    let said = w.run(&[
        "check",
        "scene.toml",
        "--limits",
        &limit,
        "--json",
        "r.json",
    ]);
    // A run that its time ends exits with 2.
    let said = said.exits(1);
    assert!(
        said.stderr.contains("cut off the search"),
        "{}",
        said.stderr
    );
    assert!(said.text().contains("not proved"), "{}", said.text());
    let Ok(json) = serde_json::from_slice::<Value>(&w.read("r.json")) else {
        panic!("{}", said.text());
    };
    let Some(pairs) = json["clearance"]["pairs"].as_array() else {
        panic!("{json}");
    };
    let name = |pair: &Value, k: usize| pair["bodies"][k].as_str().map(str::to_owned);
    let mut searched = 0;
    for pair in pairs {
        let own = [0, 1].map(|k| name(pair, k).map(|name| name.replace("ring", "box")));
        // What is far from each other is proved at once, however long others take.
        match own[0] == own[1] {
            false => assert_eq!(pair["verdict"], "passed", "{pair}"),
            true => {
                assert!(pair["verdict"] != "failed", "{pair}");
                searched += 1;
            }
        }
    }
    assert_eq!(searched, RINGS, "{json}");
}

/// The clearances of all pieces take the gearshift far longer.
fn what_is_proved_of_all_pieces_is_reported() {
    let w = Workspace::new();
    let said = w.run(&[
        "check",
        "gearshift",
        "--made-within",
        "0.05",
        "--limits",
        "time=5s",
        "--json",
        "r.json",
    ]);
    // A run that is not over by then ends with exit code 2.
    let said = said.exits(1);
    let Ok(json) = serde_json::from_slice::<Value>(&w.read("r.json")) else {
        panic!("{}", said.text());
    };
    let Some(pairs) = json["clearance"]["pieces"]["pairs"].as_array() else {
        panic!("{json}");
    };
    // Nothing is said of a pair that was not proved all the time.
    let is_cut_off = |pair: &&Value| pair["refused"].to_string().contains("`time`");
    assert!(pairs.iter().any(|pair| is_cut_off(&pair)), "{json}");
    for pair in pairs.iter().filter(is_cut_off) {
        assert_eq!(pair["verdict"], "undecided", "{pair}");
    }
}

/// Whatever of its proof the time leaves, no bound of a measure is below the value that the whole motion has.
#[test]
fn bounds_of_measures_hold_when_the_time_is_over() {
    let w = Workspace::new();
    let measures = |limits: &[&str]| {
        let run = [&["check", "twin-steer", "--json", "r.json"][..], limits].concat();
        let said = w.run(&run);
        let report = (said.code != 2).then(|| w.read("r.json"))?;
        let Ok(json) = serde_json::from_slice::<Value>(&report) else {
            panic!("{}", said.text());
        };
        Some((json["measures"].as_array()?.clone(), said.text()))
    };
    let Some((whole, _)) = measures(&[]) else {
        panic!("no report without a limit");
    };
    for milliseconds in [1, 10, 30, 60, 100, 150, 250, 400, 800] {
        let limit = format!("time={milliseconds}ms");
        // A run that its time ends before the report is written exits with 2.
        let Some((cut, text)) = measures(&["--limits", &limit]) else {
            continue;
        };
        for (whole, cut) in whole.iter().zip(&cut) {
            assert_eq!(whole["cut_off"], false, "{whole}");
            let bound = cut["bound"].as_f64().unwrap_or(f64::INFINITY);
            assert!(bound >= whole["value"].as_f64().unwrap_or(0.0), "{cut}");
            let is_told = !bound.is_infinite() || text.contains("the limit `time` ended");
            assert!(is_told, "{text}");
            assert!(!bound.is_infinite() || cut["cut_off"] == true, "{cut}");
        }
    }
}
