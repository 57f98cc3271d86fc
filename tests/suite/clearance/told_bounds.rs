//! A bound that tells nothing is said in words, in every report: no number is printed that is lower than any distance of the two
//! bodies can be, and none of them passes a pair.

use crate::program::Workspace;
use serde_json::Value;

/// A ball on an arm of length `1 + v` at the angle `u`, and a post.
fn scene(u: &str, v: &str, post: &str) -> String {
    format!(
        r#"
duration = 2
[inputs]
u = "{u}"
v = "{v}"
[[bodies]]
name = "ball"
frame = "Rz(u) Tx(1 + v)"
shapes = [{{ sphere = {{ radius = 0.1 }} }}]
[[bodies]]
name = "post"
shapes = [{{ {post} }}]
[clearance]
minimum = 0.1
pairs = [{{ pair = ["ball", "post"], minimum = 0.1 }}]
"#
    )
}

const POST: &str = "sphere = { center = [0, 0, 3], radius = 0.1 }";

/// Drives and posts, and whether nothing is known of the pair.
const CASES: [(&str, &str, &str, bool); 8] = [
    // So fast that no stretch of the motion is bounded well.
    ("exp(20*t)", "0", POST, true),
    ("sin(exp(9*t))", "0", POST, true),
    ("0", "sin(1e6*t)", POST, true),
    // So far away at the end that rounding of that place is larger than the bodies.
    ("0", "exp(200*(t - 1))", POST, true),
    (
        "sin(exp(9*t))",
        "0",
        "half_space = { point = [0, 0, -3], normal = [0, 0, 1], size = 1 }",
        true,
    ),
    // Of these something is known: they pass, and a depth.
    ("0.5*sin(t)", "0", POST, false),
    (
        "0.5*sin(t)",
        "0",
        "sphere = { center = [1, 0, 0], radius = 0.1 }",
        false,
    ),
    (
        "0.5*sin(t)",
        "0.1*t",
        "half_space = { point = [0, 0, -3], normal = [0, 0, 1], size = 1 }",
        false,
    ),
];

#[test]
fn bounds_that_tell_nothing_are_said_in_words_in_every_report() {
    let w = Workspace::new();
    for (u, v, post, is_unknown) in CASES {
        w.write("scene.toml", scene(u, v, post));
        for samples in ["2", "9", "40"] {
            let said = w.run(&[
                "check",
                "scene.toml",
                "--samples",
                samples,
                "--json",
                "r.json",
                "--csv",
                "r.csv",
                "--junit",
                "r.xml",
            ]);
            let (code, text) = (said.code, said.text());
            let told = format!("{u}, {v}, {post}, {samples} samples: {text}");
            let json: Value = serde_json::from_slice(&w.read("r.json")).expect("JSON");
            let pair = &json["clearance"]["pairs"][0];
            let read = |name: &str| String::from_utf8(w.read(name)).expect("text");
            let (csv, junit) = (read("r.csv"), read("r.xml"));
            let last = csv.lines().nth(1).and_then(|row| row.rsplit(',').next());
            let bound = pair["bound"].as_f64();
            // No ball of the two is larger than 0.1, and the half-space is no farther than 3 and the ball's way.
            assert!(bound.is_none_or(|bound| bound > -7.0), "{told}");
            let cell: Option<f64> = last.and_then(|cell| cell.parse().ok());
            assert_eq!(bound.is_some(), cell.is_some(), "{told}");
            let off = bound.zip(cell).map_or(0.0, |(a, b)| (a - b).abs());
            assert!(off < 1e-12, "{told}");
            let is_apart = pair["distance"].as_f64().expect("a distance") > 0.0;
            let is_told = [&text, &junit].map(|words| words.contains("no bound"));
            if is_unknown {
                assert_eq!((code, bound, is_told), (1, None, [true; 2]), "{told}");
            } else {
                assert_eq!(bound.is_some(), is_apart, "{told}");
                assert_eq!(code, i32::from(!is_apart), "{told}");
            }
            // The same numbers in sentences and in the table.
            let row = text.lines().find(|line| line.ends_with("ball / post"));
            let cell = row.and_then(|row| row.split_whitespace().nth(1));
            let sentences = junit.split("never below ").skip(1);
            let words = sentences.filter_map(|rest| rest.split(' ').next());
            for word in words.chain(cell) {
                let number: Option<f64> = word.trim_start_matches('~').parse().ok();
                assert!(number.is_none_or(|bound| bound > -7.0), "{told}");
            }
        }
    }
}

/// Where a pair comes far from each other at other times, a cut is one nevertheless.
#[test]
fn a_long_way_hides_no_cut() {
    let w = Workspace::new();
    for (v, code) in [
        // 0.05 in each other at the beginning, a billion away at the end.
        ("0.15 + 1e9*max(0, t - 1)", 1),
        ("0.15 + 1e9*(t/2)^6", 1),
        ("0.35 + 1e6*max(0, t - 1)", 0),
    ] {
        let post = "sphere = { center = [1, 0, 0], radius = 0.1 }";
        w.write("scene.toml", scene("0", v, post));
        for samples in ["2", "9", "40"] {
            let said = w.run(&["check", "scene.toml", "--samples", samples]);
            assert_eq!(said.code, code, "{v}, {samples}: {}", said.text());
        }
    }
}

/// A rod of 2.35 on a crank of 0.2, which a narrow bell turns far between samples: the slider is never behind the crank, whatever
/// the samples, and nothing is said of the assembly with the rod reversed.
#[test]
fn no_distance_or_measure_is_of_another_assembly() {
    let folder = Workspace::new();
    let loop_of = |phi: &str| {
        format!(
            "duration = 3.7\n[inputs]\nphi = \"{phi}\"\n[chains]\nsl = \"Tx(s)\"\n[loops]\n\
             l = \"Rz(phi) Tx(0.2) Rz(x) Tx(2.35) Rz(-x-phi) Tx(-s)\"\n[guess]\ns = 2.55\n"
        )
    };
    let pair = "[[bodies]]\nname = \"a\"\nframe = \"sl\"\nshapes = [{ sphere = { radius = 0.1 } }]\n[[bodies]]\nname = \"b\"\n\
                shapes = [{ sphere = { center = [-2.5, 0.3, 0], radius = 0.1 } }]\n[clearance]\nminimum = 0\n\
                pairs = [{ pair = [\"a\", \"b\"], minimum = 1 }]\n";
    let measure = "[measures]\nS = { of = \"s\", take = \"min\", min = 2 }\n";
    for width in ["4.4e-5", "3e-5", "1e-4", "1e-6"] {
        let phi = format!("2.4*exp(-((t-2.88962)/{width})^2)+0.48*t");
        for asked in [pair, measure] {
            folder.write("bell.toml", format!("{}{asked}", loop_of(&phi)));
            for samples in ["41", "150", "189", "300"] {
                let run = folder.run(&["check", "bell.toml", "--samples", samples]);
                let text = String::from_utf8_lossy(&run.stdout);
                let said = format!("{width} at {samples}: {} {text}", run.code);
                assert!([0, 1].contains(&run.code), "{said}");
                assert!(!text.contains("failed"), "{said}");
            }
        }
    }
}

/// Half-spaces whose planes intersect have no depth and no nearest points: no report has a number or a place for them.
#[test]
fn overlaps_without_end_have_no_number_and_no_points() {
    let w = Workspace::new();
    let text = "units = { length = \"mm\", angle = \"rad\" }\nduration = 1\n[inputs]\na = \"t\"\n\
         [[bodies]]\nname = \"A\"\nframe = \"Rx(a)\"\nshapes = [{ half_space = { point = [0, 0, -1], size = 3 } }]\n\
         [[bodies]]\nname = \"B\"\nshapes = [{ half_space = { point = [0, 0, 3], normal = [0, 0, -1], size = 3 } }]\n\
         [clearance]\npairs = [{ pair = [\"A\", \"B\"], minimum = 0.1 }]\n";
    w.write("scene.toml", text);
    let asked = "check scene.toml --json r.json --junit r.xml --summary r.md --csv r.csv --plot p.svg --matrix m.svg --render p.png";
    let asked: Vec<&str> = asked.split(' ').collect();
    let text = w.run(&asked).exits(1).text();
    w.run(&["report", "scene.toml", "--out", "r.html"]);
    assert!(text.contains("endless"), "{text}");
    let json: Value = serde_json::from_slice(&w.read("r.json")).unwrap();
    let pair = &json["clearance"]["pairs"][0];
    assert!(
        pair["points"].is_null() && pair["distance"].is_null(),
        "{pair:#}"
    );
    let read = |name: &str| String::from_utf8(w.read(name)).unwrap();
    for name in ["r.xml", "r.md"] {
        assert!(read(name).contains("overlap without end"), "{}", read(name));
        assert!(read(name).contains("has no bound"), "{}", read(name));
    }
    let page = read("r.html");
    let shown = &page[page.find("Pairs of bodies").unwrap()..];
    assert!(shown.contains("endless"), "{shown:.400}");
    for words in [
        text,
        read("r.xml"),
        read("r.md"),
        read("r.csv"),
        read("p.svg"),
        read("m.svg"),
    ] {
        let mut parts = words.split(|c: char| !c.is_alphanumeric());
        assert!(!parts.any(|part| part == "inf" || part == "NaN"), "{words}");
    }
}

/// A distance that is zero has a bound like any other, and no sign.
#[test]
fn the_bound_of_a_distance_that_is_zero_is_told() {
    let w = Workspace::new();
    for (height, value) in [
        ("1.5", "0 mm"),
        ("1.4", "-0.1000000000 mm"),
        ("1.6", "0.1000000000 mm"),
    ] {
        w.write(
            "scene.toml",
            format!(
                "units = {{ length = \"mm\", angle = \"rad\" }}\nduration = 1\n[inputs]\nu = \"4*t - 2\"\n\
                 [outputs]\nq = {{ distance = [\"A\", \"B\"] }}\n[measures]\nm = {{ of = \"q\", take = \"min\" }}\n\
                 [[bodies]]\nname = \"A\"\nframe = \"Tx(u) Tz({height})\"\nshapes = [{{ sphere = {{ radius = 0.5 }} }}]\n\
                 [[bodies]]\nname = \"B\"\nshapes = [{{ sphere = {{ radius = 1 }} }}]\n"
            ),
        );
        let text = w.run(&["check", "scene.toml", "--json", "r.json"]).text();
        let json: Value = serde_json::from_slice(&w.read("r.json")).unwrap();
        let measure = &json["measures"][0];
        let said = format!("{height}: {measure:#}\n{text}");
        let line = text
            .lines()
            .find(|line| line.starts_with("  m "))
            .expect(&said);
        let rest = line[3..].trim_start();
        assert!(rest.starts_with(value), "{said}");
        assert!(
            measure["value"].as_f64().unwrap().is_sign_positive() != value.starts_with('-'),
            "{said}"
        );
        // The same bound in both.
        let told = line
            .split("never below ")
            .nth(1)
            .and_then(|rest| rest.split(' ').next());
        let told: f64 = told.expect(&said).parse().unwrap();
        let bound = measure["bound"].as_f64().unwrap();
        assert!(told <= bound && told >= bound - 1e-8, "{said}");
    }
}
