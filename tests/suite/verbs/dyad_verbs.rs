//! `dyads` and `intervals`: the mechanism of the source, its tables, and what is refused.

use crate::program::Workspace;
use serde_json::Value;

fn document(space: &Workspace, arguments: &[&str]) -> Value {
    let run = space.run(arguments).exits(0);
    serde_json::from_slice(&run.stdout).unwrap()
}

#[test]
fn the_row_of_the_scene_is_that_of_the_source() {
    let space = Workspace::new();
    let row = document(&space, &["dyads", "dyads", "--out", "-"]);
    assert_eq!(row["schema"], "mechanim-dyads/1");
    let dyads: Vec<String> = row["row"]
        .as_array()
        .unwrap()
        .iter()
        .map(|d| {
            let end = |k: usize| d["ends"][k].as_str().unwrap();
            format!("{};{},{}", d["point"].as_str().unwrap(), end(0), end(1))
        })
        .collect();
    let wanted = [
        "7;8,9", "6;7,4", "5;6,1", "4;5,10", "3;4,10", "2;3,8", "1;2,8", "0;1,5",
    ];
    assert_eq!(dyads, wanted);
    assert_eq!(row["lever"], serde_json::json!(["8", "9"]));
    assert_eq!(row["bars"].as_array().unwrap().len(), 17);
    let heads = serde_json::json!(["8", "7", "6", "5", "4", "3", "2", "1"]);
    assert_eq!(row["columns"], heads);
    let of = |name: &str| {
        let points = row["points"].as_array().unwrap();
        points.iter().find(|p| p["name"] == name).unwrap().clone()
    };
    for (name, velocity) in [
        ("0", [1.427881086484795, -15.219787068799338]),
        ("8", [-5.609640136817703, -26.645790649884088]),
    ] {
        for (axis, wanted) in velocity.into_iter().enumerate() {
            let found = of(name)["velocity"][axis].as_f64().unwrap();
            assert!((found - wanted).abs() < 1e-11, "{name}: {found}");
        }
    }
    assert!(row["conjugate_positions_off"].as_f64().unwrap() < 1e-9);
    assert!(row["printed_signs_off"].as_f64().unwrap() > 10.0);
    let range = &row["ranges"]["exact"];
    assert!((range[0][0].as_f64().unwrap() + 2.379385241572).abs() < 1e-11);
    assert!((range[1][1].as_f64().unwrap() - 5.715026151381).abs() < 1e-11);
}

/// The same mechanism as points and bars: bars of the scene, one of a link, and bodies that are only drawn.
#[test]
fn bars_of_a_scene_are_the_row_of_its_loops() {
    let space = Workspace::new();
    let [loops, bars] = ["dyads", "dyads-bars"]
        .map(|scene| document(&space, &["dyads", scene, "--at", "1.3", "--out", "-"]));
    let sorted = |row: &Value, key: &str| {
        let mut all: Vec<String> = row[key]
            .as_array()
            .unwrap()
            .iter()
            .map(Value::to_string)
            .collect();
        all.sort();
        all
    };
    assert_eq!(loops["lever"], bars["lever"]);
    assert_eq!(loops["columns"], bars["columns"]);
    assert_eq!(bars["bars"].as_array().unwrap().len(), 17);
    let ends = |row: &Value| -> Vec<String> {
        let all = row["row"].as_array().unwrap().iter();
        let mut all: Vec<String> = all
            .map(|d| format!("{};{}", d["point"], d["ends"]))
            .collect();
        all.sort();
        all
    };
    assert_eq!(ends(&loops), ends(&bars));
    let names = |row: &Value| sorted(row, "points").len();
    assert_eq!(names(&loops), names(&bars));
    for point in loops["points"].as_array().unwrap() {
        let others = bars["points"].as_array().unwrap();
        let other = others.iter().find(|p| p["name"] == point["name"]).unwrap();
        for axis in 0..2 {
            let [a, b] = [point, other].map(|p| p["velocity"][axis].as_f64().unwrap());
            assert!((a - b).abs() < 1e-10, "{}: {a} {b}", point["name"]);
        }
    }
    // A slider, a free equation and a point without freedom of its own are no dyads.
    for (bar, words) in [
        (
            "a = { from = [\"s\", 0], to = \"crank\", length = 90 }",
            "nor free in the plane",
        ),
        (
            "a = { from = [\"x\", \"y\"], to = \"crank\", length = 90 }\n[equations]\ntie = \"x + y - 40\"",
            "equation `tie` is no bar",
        ),
    ] {
        let scene = format!(
            "duration = 1\n[inputs]\nphi = \"t\"\n[chains]\ncrank = \"Rz(phi) Tx(40)\"\n[bars]\n{bar}\n[guess]\ns = 100\nx = 100\ny = -60\n\
             [[bodies]]\nname = \"crank\"\nframe = \"crank\"\n"
        );
        let guess = if bar.contains("\"s\"") {
            scene.replace("x = 100\ny = -60\n", "")
        } else {
            scene.replace("s = 100\n", "")
        };
        space.write("no.toml", &guess);
        let run = space.run(&["dyads", "no.toml"]).exits(2);
        assert!(run.stderr.contains(words), "{}", run.stderr);
    }
}

#[test]
fn the_table_is_written_in_three_ways() {
    let space = Workspace::new();
    for (name, head, mark) in [
        (
            "t.csv",
            ",v8x,v8y,v7x,v7y,v6x,v6y",
            "\"7; 8, 9 x\",-0.43942133",
        ),
        ("t.md", "|  | v8x | v8y | v7x", "|---|---|"),
        ("t.tex", " & v8x & v8y & v7x", "\\end{tabular}"),
    ] {
        space.run(&["dyads", "dyads", "--out", name]).exits(0);
        let text = String::from_utf8(space.read(name)).unwrap();
        assert!(text.contains(head), "{text}");
        assert!(text.contains(mark), "{text}");
        let rows = text.lines().filter(|l| l.contains("; ")).count();
        assert_eq!(rows, 16, "{text}");
    }
    space
        .run(&["dyads", "dyads", "--out", "t.xls"])
        .exits(2)
        .says(&["unknown kind of table", ".tex"]);
}

#[test]
fn other_poses_and_linkages_come_apart_too() {
    let space = Workspace::new();
    let text = space.run(&["dyads", "four-bar"]).exits(0).text();
    assert!(text.contains("and the lever"), "{text}");
    let text = space
        .run(&["dyads", "dyads", "--at", "1.5"])
        .exits(0)
        .text();
    assert!(text.contains("at t = 1.5 s"), "{text}");
}

#[test]
fn what_is_no_row_of_dyads_is_refused_with_its_reason() {
    let space = Workspace::new();
    for (scene, reason) in [
        ("slider-crank", "prismatic joint"),
        ("gearshift", "joint"),
        ("bennett", "not parallel"),
        ("sarrus", "not"),
    ] {
        space
            .run(&["dyads", scene])
            .exits(2)
            .says(&["not a chain of dyads", reason])
            .prints_nothing();
    }
    for (arguments, reason) in [
        (
            &["dyads", "dyads", "--delta", "170..10"][..],
            "is above the upper end",
        ),
        (
            &["dyads", "dyads", "--per", "psi"],
            "the scene has no input `psi`",
        ),
        (&["dyads", "dyads", "--at", "9"], "lasts from 0 to 4 s"),
        (
            &[
                "intervals",
                "dyads",
                "--derive",
                "formal",
                "--delta",
                "0..180",
            ],
            "can be in line",
        ),
        (
            &["intervals", "dyads", "--derive", "formal", "--spread", "7"],
            "can be in line",
        ),
        (
            &[
                "intervals",
                "dyads",
                "--derive",
                "trials",
                "--plot",
                "a.svg",
            ],
            "--derive tied",
        ),
        (
            &[
                "intervals",
                "dyads",
                "--derive",
                "tied",
                "--delta",
                "190..350",
            ],
            "from an angle to its supplement",
        ),
        (
            &[
                "intervals",
                "dyads",
                "--derive",
                "tied",
                "--delta",
                "100..170",
            ],
            "from an angle to its supplement",
        ),
        (
            &["intervals", "dyads", "--derive", "tied", "--spread", "1"],
            "--spread has an effect with",
        ),
        (
            &["intervals", "dyads", "--derive", "formal", "--trials", "5"],
            "--trials has an effect with --derive trials only",
        ),
    ] {
        space.run(arguments).exits(2).says(&[reason]);
    }
}

#[test]
fn methods_answer_or_say_that_they_do_not() {
    let space = Workspace::new();
    fn with<'a>(rest: &[&'a str]) -> Vec<&'a str> {
        [&["intervals", "dyads", "--derive"], rest].concat()
    }
    // Improper: nothing is proved, and that is the answer.
    let run = space.run(&with(&["formal", "--spread", "0.1"])).exits(1);
    assert!(run.text().contains("improper in"), "{}", run.text());
    assert!(run.text().contains("every matrix in A is regular (proved)"));
    let run = space.run(&with(&["formal"])).exits(1);
    assert!(run.text().contains("D is singular"), "{}", run.text());
    let run = space.run(&with(&["centre", "--spread", "0.0001"])).exits(0);
    assert!(run.text().contains("half width 0.037"), "{}", run.text());
    let run = space.run(&with(&["centre", "--spread", "0.01"])).exits(1);
    assert!(run.text().contains("there is no cube"), "{}", run.text());
    let zero = [
        "centre",
        "--about-zero",
        "--velocity",
        "0,0",
        "--side",
        "0.1",
    ];
    let run = space.run(&with(&zero)).exits(0);
    assert!(run.text().contains("half width 0.00521"), "{}", run.text());
    let trials = ["trials", "--trials", "2000", "--velocity", "1,0.5"];
    let one = space.run(&with(&trials)).exits(0).text();
    assert!(one.contains("2000 trials, 2000 of them solved"), "{one}");
    let again = [&trials[..], &["--threads", "1"]].concat();
    assert_eq!(one, space.run(&with(&again)).exits(0).text());
}

#[test]
fn the_tied_set_is_paved_and_drawn() {
    let space = Workspace::new();
    let tied = |delta: &'static str| {
        vec![
            "intervals",
            "dyads",
            "--derive",
            "tied",
            "--delta",
            delta,
            "--reach",
            "10",
            "--halvings",
            "4",
            "--plot",
            "tied.svg",
        ]
    };
    let run = space.run(&tied("5..175")).exits(0);
    let text = run.text();
    assert!(
        text.contains("proved cube of velocities: half width 0.0596"),
        "{text}"
    );
    assert!(
        text.contains("narrowest at the pose: dyad 5 with 6.5266 deg"),
        "{text}"
    );
    let svg = String::from_utf8(space.read("tied.svg")).unwrap();
    assert!(svg.contains("Projection") && svg.matches("<polygon").count() > 10);
    // The pose itself has 6.53 degrees.
    let run = space.run(&tied("10..170")).exits(1);
    assert!(run.text().contains("the pose itself is not in the set"));
}

/// A point that only a part of the linkage moves determines nothing of the rest: no quantiles of rounding noise.
#[test]
fn trials_of_singular_equations_are_refused() {
    let space = Workspace::new();
    space.write("six.toml", SIX_BAR);
    for at in ["0", "1"] {
        let trials = ["intervals", "six.toml", "--derive", "trials", "--at", at];
        space
            .run(&trials)
            .exits(1)
            .prints_nothing()
            .says(&["the equations are singular"]);
        space.run(&["dyads", "six.toml", "--at", at]).exits(1);
    }
}

/// The four-bar with the traced point moves on its own; the other two bars hang on it.
const SIX_BAR: &str = r#"title = "Watt-ish six-bar"
units = { length = "cm", angle = "deg" }
duration = 2
[parameters]
a = 3
b = 8
c = 7
g = 9
p = 4
q = 3
l2 = 6
l3 = 5
[inputs]
phi = "40 + 30*t"
[chains]
cr = "Rz(phi) Tx(a)"
co = "cr Rz(al)"
ro = "Tx(g) Rz(psi)"
tr = "ro T(p, q, 0) Rz(u) Tx(l2)"
[loops]
A = "co Tx(b) Rz(m) inv(ro Tx(c))"
B = "tr Rz(v) inv(T(14,3,0) Rz(w) Tx(l3))"
[guess]
al = 10
psi = 100
m = 30
u = -30
w = 60
[[bodies]]
name = "co"
frame = "co"
[[traces]]
name = "K"
body = "co"
point = [4, 3, 0]
"#;
