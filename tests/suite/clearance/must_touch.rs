//! Bodies that must touch and do not: every report has the least distance, the largest gap, and which of the two is wrong.

use crate::program::Workspace;
use crate::solids::{BOX_TRIANGLES, box_corner, stl_text, v};
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

/// A mesh of a cube of side 10 about the origin of its body.
fn cube() -> String {
    stl_text(BOX_TRIANGLES.map(|side| side.map(|k| 5.0 * box_corner(k))))
}

/// A frame of four walls around a square hole at `x`: corners `inner` and `outer` from the axis, from `low` to `high` along it.
fn bush(inner: f64, outer: f64, [low, high]: [f64; 2], x: f64) -> String {
    let at = |a: f64, b: f64, z: f64| v(x + a, b, z);
    let ring = |r: f64, z: f64| [at(r, r, z), at(-r, r, z), at(-r, -r, z), at(r, -r, z)];
    let rings = [
        ring(inner, low),
        ring(outer, low),
        ring(outer, high),
        ring(inner, high),
    ];
    // Once around the section, from each edge to the next, at every corner.
    let sides = (0..4).flat_map(|k| (0..4).map(move |j| (k, j)));
    let triangles = sides.flat_map(|(k, j)| {
        let [a, b] = [&rings[k], &rings[(k + 1) % 4]];
        let next = (j + 1) % 4;
        [[a[j], b[next], b[j]], [a[j], a[next], b[next]]]
    });
    stl_text(triangles)
}

/// A pin that fits its bore touches it on all sides, and no shift parts them. Half the pin's width, where the bush stands and how it
/// is turned, and whether they overlap.
#[test]
fn pins_that_fit_their_bores_touch_them() {
    let w = Workspace::new();
    w.write("bush.stl", bush(5.0, 9.0, [-10.0, 10.0], 0.0));
    w.write("second.stl", bush(5.0, 9.0, [-10.0, 10.0], 60.0));
    // Another pin in another bore, far from the middle of both.
    let beside = ", { box = { center = [60, 0, 0], size = [10, 10, 30] } }";
    let mesh_pin = |half: f64| {
        stl_text(BOX_TRIANGLES.map(|side| side.map(|k| half * box_corner(k) * v(1.0, 1.0, 4.0))))
    };
    // A head that rests on the bush, too.
    let head = ", { box = { center = [0, 0, 12.5], size = [16, 16, 5] } }";
    for (half, place, overlaps) in [
        (5.0, "", false),
        (5.0, "Tx(1e5) Ry(0.4)", false),
        (4.999999, "", false),
        (5.01, "", true),
        (5.5, "Tx(1e5) Ry(0.4)", true),
    ] {
        w.write("pin.stl", mesh_pin(half));
        let width = 2.0 * half;
        let solid = format!("{{ box = {{ size = [{width:?}, {width:?}, 30] }} }}");
        let mesh = "{ stl = { file = \"pin.stl\" } }".to_owned();
        for (pin, motion) in [
            (mesh, "Tz(u)"),
            (solid.clone(), "Tz(u)"),
            (format!("{solid}{head}"), "Tz(0*u)"),
            (format!("{solid}{beside}"), "Tz(u)"),
        ] {
            w.write(
                "scene.toml",
                format!(
                    "title = \"pin\"\nunits = {{ length = \"mm\", angle = \"rad\" }}\nduration = 1\n[inputs]\nu = \"t\"\n\
                     [[bodies]]\nname = \"pin\"\nframe = \"{place} {motion}\"\nshapes = [{pin}]\n\
                     [[bodies]]\nname = \"bush\"\nframe = \"{place} Tz(0*u)\"\nshapes = [{{ stl = {{ file = \"bush.stl\" }} }}, {{ stl = {{ file = \"second.stl\" }} }}]\n\
                     [clearance]\ntouching = [{{ pair = [\"pin\", \"bush\"] }}]\n"
                ),
            );
            // A head rests on the bush, and the other pin fits.
            let is_loose = half < 5.0 && !pin.contains("center");
            let code = i32::from(overlaps || is_loose);
            let asked = ["check", "scene.toml", "--samples", "5", "--json", "r.json"];
            let text = w.run(&asked).exits(code).text();
            let json: Value = serde_json::from_slice(&w.read("r.json")).unwrap();
            let touching = &json["clearance"]["pairs"][0]["touching"];
            assert_eq!(
                touching["overlaps"], overlaps,
                "{half} {place} {pin}\n{text}"
            );
        }
    }
}

/// A mesh has no depth, but one that is in another body, or cut by it, does not merely touch it. The other body, how the cube moves
/// against it, and whether they touch, part, or overlap.
#[test]
fn meshes_that_are_in_other_bodies_do_not_pass_as_touching() {
    let w = Workspace::new();
    w.write("cube.stl", cube());
    let block = "{ box = { size = [90, 90, 90] } }";
    let plate = "{ box = { size = [90, 90, 1] } }";
    let ball = "{ sphere = { radius = 20 } }";
    let mesh = "{ stl = { file = \"cube.stl\" } }";
    // Resting on it, and sliding or turning there.
    let touching = ["Tz(50)", "Tx(0.3*u) Tz(50)", "Tz(50) Rz(0.2*u)"];
    let mut rows: Vec<(&str, String, [bool; 2])> = touching
        .map(|frame| (block, frame.to_owned(), [false, false]))
        .into();
    rows.push((ball, "Tz(25)".to_owned(), [false, false]));
    rows.push((mesh, "Tx(2*u) Tz(10)".to_owned(), [false, false]));
    // In it by any depth, down to wholly inside.
    for depth in ["0.01", "1", "9", "20", "40", "80"] {
        rows.push((block, format!("Tx(u) Tz(50 - {depth})"), [false, true]));
        rows.push((block, format!("Tz(50 - {depth}) Rx(0.01*u)"), [false, true]));
    }
    for depth in ["0.01", "4", "20"] {
        rows.push((ball, format!("Tx(0.1*u) Tz(25 - {depth})"), [false, true]));
        rows.push((mesh, format!("Tx(u) Tz(10 - 0.4*{depth})"), [false, true]));
    }
    // Cut through its middle, at some of the time, and between the samples only.
    rows.push((plate, "Tx(u)".to_owned(), [false, true]));
    rows.push((plate, "Tx(u) Ry(0.3)".to_owned(), [false, true]));
    rows.push((block, "Tz(50 + 0.5*sin(2*pi*u))".to_owned(), [true, true]));
    rows.push((
        block,
        "Tz(50 - 0.5*sin(4*pi*u)^2)".to_owned(),
        [false, true],
    ));
    rows.push((
        block,
        "Tz(50 + 0.5*sin(4*pi*u)^2)".to_owned(),
        [true, false],
    ));
    let rows = rows.into_iter();
    let alone = rows.map(|(own, frame, wanted)| (own.to_owned(), frame, mesh.to_owned(), wanted));
    // Other shapes of both that touch, or overlap by less than is allowed, hide nothing.
    let under = "{ box = { center = [0, 0, -50], size = [90, 90, 90] } }";
    let pad = |at: f64| format!("{{ sphere = {{ center = [200, 0, {at:?}], radius = 5 }} }}");
    let padded = [
        (under, 10.0, [false, false]),
        (plate, 10.0, [false, true]),
        (plate, 10.0 - 1e-10, [false, true]),
    ];
    let padded = padded.map(|(own, above, wanted)| {
        let [own, others] = [(own, 0.0), (mesh, above)].map(|(s, at)| format!("{s}, {}", pad(at)));
        (own, "Tx(0*u)".to_owned(), others, wanted)
    });
    for (own, frame, others, [parts, overlaps]) in alone.chain(padded) {
        w.write(
            "scene.toml",
            format!(
                "title = \"cube\"\nunits = {{ length = \"mm\", angle = \"rad\" }}\nduration = 1\n[inputs]\nu = \"t\"\n\
                 [[bodies]]\nname = \"A\"\nshapes = [{own}]\n\
                 [[bodies]]\nname = \"B\"\nframe = \"{frame}\"\nshapes = [{others}]\n\
                 [clearance]\ntouching = [{{ pair = [\"A\", \"B\"] }}]\n"
            ),
        );
        let code = i32::from(parts || overlaps);
        let asked = ["check", "scene.toml", "--samples", "5", "--json", "r.json"];
        let text = w.run(&asked).exits(code).text();
        let json: Value = serde_json::from_slice(&w.read("r.json")).unwrap();
        let pair = &json["clearance"]["pairs"][0];
        let said = format!("{own} {frame}: {pair:#}\n{text}");
        assert_eq!(pair["touching"]["overlaps"], overlaps, "{said}");
        assert_eq!(pair["touching"]["parted"], parts, "{said}");
        // What is said to be proved of a mesh that is deep in a body is that.
        let bound = pair["bound"].as_f64();
        assert!(
            !overlaps || bound.is_none_or(|bound| bound < -0.01),
            "{said}"
        );
    }
}
