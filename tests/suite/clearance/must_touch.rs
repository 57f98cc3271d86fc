//! Bodies that must touch and do not: every report has the least distance, the largest gap, and which of the two is wrong.

use crate::program::Workspace;
use serde_json::Value;

/// A ball of radius 1 beside another one: they touch where `u` is zero, part where it is positive and overlap where it is negative.
fn scene(u: &str) -> String {
    format!(
        "title = \"balls\"\nunits = {{ length = \"mm\", angle = \"rad\" }}\nduration = 1\n[inputs]\nu = \"{u}\"\n\
         [[bodies]]\nname = \"A\"\nframe = \"Tx(2 + u)\"\nshapes = [{{ sphere = {{ radius = 1 }} }}]\n\
         [[bodies]]\nname = \"B\"\nshapes = [{{ sphere = {{ radius = 1 }} }}]\n\
         [clearance]\ntouching = [{{ pair = [\"A\", \"B\"] }}]\n"
    )
}

/// A drive, the number of samples, the least and the largest distance, the class, and what every report says.
struct Row {
    u: &'static str,
    samples: &'static str,
    ends: [f64; 2],
    class: &'static str,
    words: &'static [&'static str],
}

const ROWS: [Row; 6] = [
    Row {
        u: "0*t",
        samples: "5",
        ends: [0.0, 0.0],
        class: "clear",
        words: &["must touch and do at all samples"],
    },
    Row {
        u: "t",
        samples: "5",
        ends: [0.0, 1.0],
        class: "separated",
        words: &["must touch, but are 1.000000 mm apart at t = 1.000000 s; no more than"],
    },
    Row {
        u: "1e-5*t",
        samples: "5",
        ends: [0.0, 1e-5],
        class: "separated",
        words: &["must touch, but are 1.000e-5 mm apart at t = 1.000000 s"],
    },
    Row {
        u: "-0.1*t",
        samples: "5",
        ends: [-0.1, 0.0],
        class: "below",
        words: &["must touch, but overlap by 0.100000 mm at t = 1.000000 s"],
    },
    Row {
        u: "0.6*t - 0.3",
        samples: "5",
        ends: [-0.3, 0.3],
        class: "below",
        words: &[
            "must touch, but are 0.300000 mm apart at t = 1.000000 s and overlap by 0.300000 mm at t = 0.000000 s",
        ],
    },
    // They touch at all samples, and are deepest halfway between two of them.
    Row {
        u: "-0.1*sin(5*pi*t)^2",
        samples: "5",
        ends: [-0.1, 0.0],
        class: "below",
        words: &["must touch, but overlap by 0.100000 mm at t = 0."],
    },
];

#[test]
fn every_report_says_what_bodies_that_must_touch_do() {
    let w = Workspace::new();
    let files = ["r.xml", "r.md", "p.svg", "r.sarif", "m.svg", "r.html"];
    for row in ROWS {
        w.write("scene.toml", scene(row.u));
        let code = i32::from(row.class != "clear");
        let asked = "check scene.toml --json r.json --junit r.xml --sarif r.sarif --summary r.md --matrix m.svg --plot p.svg --samples";
        let asked: Vec<&str> = asked.split(' ').chain([row.samples]).collect();
        let text = w.run(&asked).exits(code).text();
        w.run(&[
            "report",
            "scene.toml",
            "--samples",
            row.samples,
            "--out",
            "r.html",
        ]);
        let read = |name: &str| String::from_utf8(w.read(name)).unwrap();
        let json: Value = serde_json::from_str(&read("r.json")).unwrap();
        let pair = &json["clearance"]["pairs"][0];
        let said = format!("{}: {pair:#}\n{text}", row.u);
        // The numbers.
        let number = |value: &Value| value.as_f64().expect(&said);
        let (least, touching) = (number(&pair["distance"]), &pair["touching"]);
        let apart = number(&touching["apart"]);
        let [low, high] = row.ends;
        assert!(
            (least - low).abs() < 1e-6 && (apart - high).abs() < 1e-9,
            "{said}"
        );
        assert!(
            number(&pair["bound"]) <= least && number(&pair["farthest"]) >= apart,
            "{said}"
        );
        assert_eq!(pair["class"], row.class, "{said}");
        let allowed = number(&touching["allowed"]);
        assert_eq!(touching["parted"], apart > allowed, "{said}");
        assert_eq!(touching["overlaps"], least < -allowed, "{said}");
        // The words, in every report; nothing is asked of a minimum.
        let is_wrong = row.class != "clear";
        for name in files.iter().filter(|name| is_wrong || **name == "r.xml") {
            let report = read(name);
            let words = report.replace("&#61;", "=").replace("\\", "");
            if *name == "m.svg" {
                let of_class = format!("1 {}", row.class);
                assert!(words.contains(&of_class), "{name}, {said}");
                continue;
            }
            for part in row.words {
                assert!(words.contains(part), "{name}: {part}, {said}");
            }
            assert!(!words.contains("the minimum is"), "{name}, {said}");
        }
        assert!(row.words.iter().all(|part| text.contains(part)), "{said}");
        assert!(!read("m.svg").contains("0 separated"), "{said}");
    }
}

#[test]
fn a_box_of_inputs_tells_where_bodies_that_must_touch_part() {
    let w = Workspace::new();
    w.write("scene.toml", scene("t"));
    let box_of = |range: &str| {
        let asked = [
            "check",
            "scene.toml",
            "--inputs-box",
            range,
            "--json",
            "r.json",
        ];
        let run = w.run(&asked);
        let json: Value = serde_json::from_slice(&w.read("r.json")).unwrap();
        (run.text(), json["inputs_box"]["pairs"][0].clone())
    };
    let (text, pair) = box_of("u=0:0.5");
    let said = format!("{text} {pair:#}");
    assert!(
        text.contains("failed: they must touch, but are 0.500000 mm apart at u = 0.5"),
        "{said}"
    );
    assert_eq!(pair["touching"]["inputs"][0], 0.5, "{said}");
    assert!(
        (pair["touching"]["apart"].as_f64().unwrap() - 0.5).abs() < 1e-9,
        "{said}"
    );
    assert!(pair["distance"].as_f64().unwrap().abs() < 1e-9, "{said}");
}
