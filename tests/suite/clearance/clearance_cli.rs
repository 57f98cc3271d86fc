//! `mechanim check` and `render --highlight clearance` as their users meet them: exit codes, files, pictures, warnings.

use crate::program::{LEAVES, SLIDER, Workspace};

const SWING: &str = r#"title = "swing"
duration = 1
units = { length = "mm" }
[inputs]
a = "t"
b = "-t"
[[bodies]]
name = "arm"
frame = "Rz(a)"
shapes = [{ capsule = { from = [0, 0, 0], to = [50, 0, 0], radius = 2 } }]
[[bodies]]
name = "post"
frame = "Tx(0) Tx(80) Rz(b) Tx(1) Rz(b)"
shapes = [{ cylinder = { from = [0, 0, -5], to = [0, 0, 5], radius = 3 } }]
[clearance]
minimum = MINIMUM
"#;

fn swing(minimum: f64) -> String {
    SWING.replace("MINIMUM", &minimum.to_string())
}

#[test]
fn a_violation_fails_and_is_in_every_report() {
    let w = Workspace::new();
    w.write("good.toml", swing(1.0));
    w.write("bad.toml", swing(30.0));
    let text = w.run(&["check", "good.toml"]).exits(0).text();
    assert!(
        text.contains("arm / post") && text.contains("passed"),
        "{text}"
    );
    let run = w.run(&[
        "check",
        "bad.toml",
        "--samples",
        "20",
        "--json",
        "r.json",
        "--junit",
        "r.xml",
        "--csv",
        "r.csv",
        "--plot",
        "r.svg",
        "--render",
        "r.png",
    ]);
    let text = run.exits(1).text();
    assert!(text.contains("failed     arm / post"), "{text}");
    let read = |name: &str| std::fs::read(w.path(name)).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&read("r.json")).unwrap();
    let pair = &json["clearance"]["pairs"][0];
    assert_eq!(pair["verdict"], "failed");
    let distance = pair["distance"].as_f64().unwrap();
    // The arm's tip and the post come to face each other at the start: 81 - 50 - 2 - 3.
    assert!((distance - 26.0).abs() < 1e-9, "{distance}");
    assert_eq!(pair["time"], 0.0);
    assert!(pair["bound"].as_f64().unwrap() <= distance);
    let junit = String::from_utf8(read("r.xml")).unwrap();
    assert!(junit.contains("failures=\"1\" errors=\"0\""), "{junit}");
    assert!(
        junit.contains("message=\"failed: `arm` (capsule 1) and `post` (cylinder 1)"),
        "{junit}"
    );
    let svg = String::from_utf8(read("r.svg")).unwrap();
    for words in ["arm / post", "26.0000 mm", "come nearest", "clearance [mm]"] {
        assert!(svg.contains(words), "{words}: {svg}");
    }
    let csv = String::from_utf8(read("r.csv")).unwrap();
    assert_eq!(csv.lines().count(), 21);
    let first: Vec<f64> = csv
        .lines()
        .nth(1)
        .unwrap()
        .split(',')
        .map(|c| c.parse().unwrap())
        .collect();
    assert!(
        first[0] == 0.0 && (first[1] - 26.0).abs() < 1e-9,
        "{first:?}"
    );
    // The picture holds the alarm colours of the pair.
    let picture = image::load_from_memory(&read("r.png")).unwrap().to_rgb8();
    let red = picture
        .pixels()
        .filter(|p| p.0[0] > 120 && p.0[1] < 90 && p.0[2] < 90)
        .count();
    let blue = picture
        .pixels()
        .filter(|p| p.0[2] > 120 && p.0[0] < 90)
        .count();
    assert!(red > 500 && blue > 200, "{red} {blue}");
}

#[test]
fn bodies_that_are_too_near_turn_red() {
    let w = Workspace::new();
    w.write("good.toml", swing(1.0));
    w.write("bad.toml", swing(30.0));
    let red = |scene: &str, at: &str| {
        w.run(&[
            "render",
            scene,
            "--highlight",
            "clearance",
            "--renderer",
            "cpu",
            "--at",
            at,
            "--out",
            "p.png",
        ])
        .exits(0);
        let picture = image::open(w.path("p.png")).unwrap().to_rgb8();
        picture
            .pixels()
            .filter(|p| p.0[0] > 110 && p.0[1] < 70 && p.0[2] < 75)
            // A line over orange is dark orange, no red.
            .filter(|p| p.0[0] > 3 * p.0[1])
            .count()
    };
    assert!(red("bad.toml", "0") > 500);
    assert_eq!(red("bad.toml", "0.9"), 0, "apart by then");
    assert_eq!(red("good.toml", "0"), 0);
}

#[test]
fn what_was_not_closed_is_not_passed() {
    let w = Workspace::new();
    let text = LEAVES.to_owned() + SLIDER;
    w.write("leaves.toml", text);
    let out = w.run(&["check", "leaves.toml"]).exits(4).text();
    assert!(out.contains("not checked from t = "), "{out}");
}

#[test]
fn reports_of_clearances_need_a_section() {
    let w = Workspace::new();
    w.write(
        "plain.toml",
        swing(1.0).split("[clearance]").next().unwrap(),
    );
    w.run(&["check", "plain.toml"]).exits(0);
    for option in ["--csv", "--plot", "--render"] {
        let run = w.run(&["check", "plain.toml", option, "x.png"]);
        run.exits(2).says(&["the scene has no section [clearance]"]);
    }
    w.run(&["check", "plain.toml", "--junit", "x.xml"]).exits(0);
    w.run(&["check", "plain.toml", "--bound-tolerance", "0"])
        .exits(2);
    w.write("bad.toml", swing(30.0));
    w.run(&["check", "bad.toml", "--render", "x.gif"])
        .exits(2)
        .says(&["unknown kind of picture"]);
}

/// A closed ball of triangles in the text form, or one with a hole, or one inside out.
fn ball(fault: &str) -> String {
    let point = |i: usize, j: usize| {
        let (a, b) = (
            i as f64 * std::f64::consts::TAU / 24.0,
            j as f64 * std::f64::consts::PI / 12.0,
        );
        let round = |v: f64| (v * 1e4).round() / 1e4;
        let ring = if j == 0 || j == 12 {
            0.0
        } else {
            5.0 * b.sin()
        };
        let a = if i == 24 { 0.0 } else { a };
        format!(
            "vertex {} {} {}",
            round(ring * a.cos()) + 0.0,
            round(ring * a.sin()) + 0.0,
            round(5.0 * b.cos())
        )
    };
    let mut text = String::from("solid ball\n");
    for i in 0..24 {
        for j in 0..12 {
            let quad = [
                point(i, j),
                point(i, j + 1),
                point(i + 1, j + 1),
                point(i + 1, j),
            ];
            for mut t in [[0, 1, 2], [0, 2, 3]] {
                if fault == "open" && i == 3 && j == 5 {
                    continue;
                }
                if fault == "inside out" {
                    t.swap(0, 1);
                }
                if quad[t[0]] == quad[t[1]] || quad[t[1]] == quad[t[2]] || quad[t[2]] == quad[t[0]]
                {
                    continue;
                }
                let corners: Vec<&str> = t.iter().map(|k| quad[*k].as_str()).collect();
                text += &format!(
                    "facet normal 0 0 0\nouter loop\n{}\nendloop\nendfacet\n",
                    corners.join("\n")
                );
            }
        }
    }
    text + "endsolid\n"
}

#[test]
fn meshes_are_checked_and_odd_ones_are_named() {
    let w = Workspace::new();
    let scene = swing(1.0).replace(
        "cylinder = { from = [0, 0, -5], to = [0, 0, 5], radius = 3 }",
        "stl = { file = \"ball.stl\" }",
    );
    w.write("mesh.toml", scene.clone());
    let surface = scene.replace("ball.stl\"", "ball.stl\", surface = true");
    w.write("surface.toml", surface);
    for (scene, fault, said, code) in [
        ("mesh.toml", "none", "", 0),
        (
            "mesh.toml",
            "open",
            "has no inside: 4 edges have more triangles on one side than on the other",
            1,
        ),
        ("mesh.toml", "inside out", "is inside out", 0),
        ("surface.toml", "open", "", 0),
    ] {
        w.write("ball.stl", ball(fault));
        let options = ["check", scene, "--json", "r.json", "--certify", "none"];
        let run = w.run(&options).exits(code);
        if !said.is_empty() {
            run.says(&[said]);
        }
        let json: serde_json::Value =
            serde_json::from_slice(&std::fs::read(w.path("r.json")).unwrap()).unwrap();
        let distance = json["clearance"]["pairs"][0]["distance"].as_f64().unwrap();
        assert!((distance - 24.0).abs() < 0.05, "{fault}: {distance}");
    }
    // A ball of triangles around the arm's pin: nothing touches, but it is inside.
    w.write("ball.stl", ball("none"));
    let inside = scene
        .replace("to = [50, 0, 0], radius = 2", "to = [1, 0, 0], radius = 1")
        .replace("Tx(80)", "Tx(0)");
    w.write("inside.toml", inside);
    let text = w.run(&["check", "inside.toml"]).exits(1).text();
    assert!(text.contains("0.0000"), "{text}");
}

/// A mesh has no depth: what slides on it is never said to cut it.
#[test]
fn a_mesh_in_contact_is_not_cut() {
    let w = Workspace::new();
    w.write("ball.stl", ball("none"));
    let scene = swing(0.0)
        .replace("Rz(a)", "Tx(-40) Tx(d)")
        .replace("a = \"t\"", "d = \"0.01*sin(6*t)\"")
        .replace(
            "capsule = { from = [0, 0, 0], to = [50, 0, 0], radius = 2 }",
            "stl = { file = \"ball.stl\" }",
        )
        .replace("Tx(0) Tx(80) Rz(b) Tx(1) Rz(b)", "Tx(-40) Rz(b)")
        .replace(
            "cylinder = { from = [0, 0, -5], to = [0, 0, 5], radius = 3 }",
            "box = { center = [0, 0, -6], size = [9, 9, 2] }",
        );
    w.write(
        "table.toml",
        scene + "touching = [{ pair = [\"arm\", \"post\"] }]\n",
    );
    let text = w.run(&["check", "table.toml"]).exits(0).text();
    assert!(text.contains("passed     arm / post"), "{text}");
}
