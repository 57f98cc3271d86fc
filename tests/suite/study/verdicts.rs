//! Verdicts of studies against formulas: limits over the whole motion, limits of zero, shapes far from their start, variables at the
//! ends of their ranges.

use crate::program::Workspace;
use serde_json::Value;

/// A point on a slide: its coordinate is `chain` over the drive `q`.
fn slide(rest: &str) -> String {
    format!(
        "units = {{ length = \"mm\", angle = \"deg\" }}\nduration = 4\n{rest}\n\
         [[bodies]]\nname = \"b\"\nframe = \"CHAIN\"\n[[traces]]\nname = \"P\"\nbody = \"b\"\n"
    )
}

/// A parameter of a scene that a study wrote.
fn written(w: &Workspace, file: &str, name: &str) -> f64 {
    let text = String::from_utf8(w.read(file)).unwrap();
    let start = format!("{name} = ");
    let line = text.lines().find_map(|line| line.strip_prefix(&start));
    let number = line.and_then(|rest| rest.split_whitespace().next());
    number.unwrap().parse().unwrap()
}

/// The limit of a maximum holds at the samples of a study, not between them: nothing is proved then.
#[test]
fn limits_between_the_samples_are_limits() {
    let w = Workspace::new();
    let pulse =
        "{ keys = [[0, 0], [1.0003, 0], [1.001, 6], [1.0017, 0], [4, 0]], ease = \"linear\" }";
    let text = slide(&format!(
        "[parameters]\nr = 10\n[inputs]\nq = {pulse}\n[measures]\nm = {{ of = \"P.x\", take = \"max\", max = 20 }}\n\
         obj = \"-r\"\n[study]\nminimise = \"obj\"\n[study.variables]\nr = {{ range = [5, 40] }}"
    ))
    .replace("CHAIN", "Tx(r) Tx(q)");
    w.write("pulse.toml", &text);
    let run = w.run(&["synthesise", "pulse.toml", "--starts", "2"]);
    let said = run.text();
    assert!(
        run.code == 1 && !said.contains("proved: the mechanism"),
        "{said}"
    );
    // A ripple, with a limit of the measure and one of the study.
    for study in [false, true] {
        let limits = ["", ", max = 20"][usize::from(!study)];
        let of_study = ["", "[study.limits]\nm = { max = 20 }\n"][usize::from(study)];
        let text = slide(&format!(
            "[parameters]\nr = 10\ns = 4.2\n[inputs]\nphi = \"17 + 90*t\"\n[measures]\n\
             m = {{ of = \"P.x\", take = \"max\"{limits} }}\nobj = \"-r - s\"\n[study]\nminimise = \"obj\"\n\
             {of_study}[study.variables]\nr = {{ range = [5, 40] }}\ns = {{ range = [4, 4.5] }}"
        ))
        .replace("CHAIN", "Rz(phi) Tx(r) Rz(1440*phi) Tx(s)");
        w.write("ripple.toml", &text);
        for verb in [
            &["optimise", "ripple.toml"][..],
            &["synthesise", "ripple.toml", "--starts", "2"],
        ] {
            let run = w.run(verb);
            assert_eq!(run.code, 1, "{verb:?}: {}", run.text());
        }
    }
}

/// A limit of zero is judged by the size of the mechanism, in every unit of length.
#[test]
fn limits_of_zero_have_the_size_of_the_mechanism() {
    let w = Workspace::new();
    for unit in [1e-7, 1e-5, 1.0, 1e4] {
        let text = slide(&format!(
            "[parameters]\nr = {}\ns = {}\n[inputs]\nphi = \"360*t/4\"\n[measures]\n\
             m = {{ of = \"P.x\", take = \"max\", max = 0 }}\nobj = \"((s - {})/{})^2\"\n[study]\nminimise = \"obj\"\n\
             [study.variables]\ns = {{ range = [{}, {}] }}",
            unit,
            -1.5 * unit,
            3.0 * unit,
            unit,
            -10.0 * unit,
            10.0 * unit
        ))
        .replace("CHAIN", "Tx(s) Rz(phi) Tx(r)");
        w.write("zero.toml", &text);
        let run = w.run(&["optimise", "zero.toml", "--out", "best.toml"]);
        let said = run.exits(0).text();
        let s = written(&w, "best.toml", "s");
        assert!((s + unit).abs() < 1e-5 * unit, "{unit}: s = {s}: {said}");
    }
}

/// Solids follow the variables that appear in them, though nothing changes near the start.
#[test]
fn shapes_change_far_from_the_start_as_well() {
    let text = r#"
units = { length = "mm", angle = "deg" }
duration = 4
[parameters]
w = 2
a = 0
b = 0
[inputs]
phi = "360*t/4"
[[bodies]]
name = "ball"
frame = "Rz(phi) Tx(10)"
shapes = [{ sphere = { radius = "max(3, w) + a*b" } }]
[[bodies]]
name = "wall"
frame = "T(30, 0, 0)"
shapes = [{ sphere = { radius = 2 } }]
[outputs]
g = { distance = ["ball", "wall"] }
[measures]
m = { of = "g", take = "min", min = 10 }
o = "-w"
[study]
minimise = "o"
[study.variables]
w = { range = [1, 12], tolerance = 5 }
"#;
    let w = Workspace::new();
    w.write("shapes.toml", text);
    for (design, of) in [
        (
            "grid:w=2..10:5",
            (|row| 18.0 - row[0].max(3.0)) as fn(&[f64]) -> f64,
        ),
        ("grid:a=0..2:3,b=0..2:3", |row| 15.0 - row[0] * row[1]),
    ] {
        let run = w.run(&["sweep", "shapes.toml", "--design", design, "--out", "-"]);
        let table = run.exits(0).text();
        let mut lines = table
            .lines()
            .map(|line| line.split(',').collect::<Vec<_>>());
        let heads = lines.next().unwrap();
        let of_name = |row: &[&str], name: &str| -> f64 {
            row[heads.iter().position(|head| *head == name).unwrap()]
                .parse()
                .unwrap()
        };
        let names: &[&str] = if design.contains("w=") {
            &["w"]
        } else {
            &["a", "b"]
        };
        let mut rows = 0;
        for row in lines {
            let values: Vec<f64> = names.iter().map(|name| of_name(&row, name)).collect();
            let expected = of(&values);
            assert!(
                (of_name(&row, "m") - expected).abs() < 1e-9,
                "{design}: {row:?} {expected}"
            );
            assert_eq!(
                of_name(&row, "feasible") == 1.0,
                expected >= 10.0,
                "{row:?}"
            );
            rows += 1;
        }
        assert!(rows >= 5);
    }
    let run = w.run(&["optimise", "shapes.toml", "--json", "best.json"]);
    assert_eq!(run.code, 0, "{}", run.text());
    let best: Value = serde_json::from_slice(&w.read("best.json")).unwrap();
    let found = best["variables"][0]["to"].as_f64().unwrap();
    assert!((found - 8.0).abs() < 1e-4, "{found}");
}

/// An angle that ends at an end of its range is written as the number that stands there.
#[test]
fn angles_at_the_ends_of_their_ranges_are_written() {
    let w = Workspace::new();
    for end in ["48", "23.7", "53", "71.3", "29.1"] {
        let text = slide(&format!(
            "[parameters]\na = 20\n[inputs]\nphi = \"360*t/4\"\n[measures]\nm = {{ of = \"P.y\", take = \"first\" }}\n\
             obj = \"-m\"\n[study]\nminimise = \"obj\"\n[study.variables]\na = {{ range = [10, {end}] }}"
        ))
        .replace("CHAIN", "Rz(phi + a) Tx(10)");
        w.write("end.toml", &text);
        let run = w.run(&["optimise", "end.toml", "--out", "best.toml"]);
        let said = run.exits(0).text();
        let value = written(&w, "best.toml", "a");
        assert_eq!(value, end.parse::<f64>().unwrap(), "{said}");
        w.run(&["check", "best.toml"]).exits(0);
        let run = w.run(&["sweep", "end.toml", "--design", "grid:a:3", "--out", "-"]);
        let last = run.exits(0).text();
        let last = last.lines().last().unwrap().to_owned();
        assert!(last.split(',').any(|cell| cell == end), "{last}");
    }
}

/// Pairs of variables that cannot keep a limit come last, and are marked.
#[test]
fn pairs_that_miss_a_limit_are_marked() {
    let text = r#"
duration = 4
[parameters]
x = 1
y = 1
z = 1
[inputs]
phi = "2*pi*t/4"
[[bodies]]
name = "b"
frame = "Rz(phi) T(x, y, z)"
[[traces]]
name = "P"
body = "b"
[measures]
pz = { of = "P.z", take = "first", min = 2 }
F = "x^2 + y^2 + z"
[study]
minimise = "F"
[study.variables]
x = { range = [0, 3] }
y = { range = [0, 3] }
z = { range = [0, 3] }
"#;
    let w = Workspace::new();
    w.write("pairs.toml", text);
    let run = w.run(&["optimise", "pairs.toml", "--pairs", "--json", "pairs.json"]);
    run.exits(0);
    let found: Value = serde_json::from_slice(&w.read("pairs.json")).unwrap();
    let pairs = found["pairs"].as_array().unwrap();
    let kept: Vec<bool> = pairs
        .iter()
        .map(|pair| pair["limits_kept"].as_bool().unwrap())
        .collect();
    assert_eq!(kept, [true, true, false], "{found}");
    assert_eq!(pairs[2]["names"], serde_json::json!(["x", "y"]));
}

/// A measure whose minimum lies between the poses of a study: what is said of these poses says so, and `check`, which judges the whole
/// motion, fails.
#[test]
fn studies_say_that_they_are_of_poses() {
    let w = Workspace::new();
    w.write(
        "between.toml",
        "units = { length = \"mm\" }\nduration = 1\n[parameters]\na = 1\n[inputs]\nx = \"10*t\"\n[outputs]\ngap = \"abs(x - 5.02) + 0*a\"\n\
         [[bodies]]\nname = \"b\"\nframe = \"Tx(x) Ty(a)\"\n[measures]\nclear = { of = \"gap + a\", take = \"min\", min = 1.01 }\n",
    );
    // |x - 5.02| is zero at t = 0.502, which is none of 180 poses: the least value is a itself.
    w.run(&["check", "between.toml", "--param", "a=1.005"])
        .exits(1);
    let tolerance = [
        "tolerance",
        "between.toml",
        "--vary",
        "a",
        "--tolerance",
        "0.005",
        "--pieces",
        "100",
    ];
    let tolerance = w.run(&tolerance).exits(0).text();
    for words in [
        "measures are of 180 poses, and of nothing between them",
        "at these poses",
        "at the poses of the measures",
    ] {
        let plain = tolerance.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(plain.contains(words), "{words}: {tolerance}");
    }
    let sweep = w
        .run(&["sweep", "between.toml", "--design", "grid:a=0.99..1.02:3"])
        .exits(0)
        .text();
    assert!(sweep.contains("feasible at the samples"), "{sweep}");
    let judged = w
        .run(&[
            "sweep",
            "between.toml",
            "--design",
            "grid:a=0.99..1.02:3",
            "--check",
        ])
        .exits(0)
        .text();
    assert!(judged.contains("1 feasible\n"), "{judged}");
    let allowed = [
        "enclose",
        "four-bar",
        "--allow",
        "psi=1",
        "--vary",
        "crank,coupler",
        "--samples",
        "4",
    ];
    let allowed = w.run(&allowed).exits(0).text();
    assert!(
        allowed.contains("at 4 poses every piece keeps"),
        "{allowed}"
    );
}

/// Units of products of lengths and of their rates, by hand; what is told of is never a number's rate where it is an area's.
#[test]
fn products_of_lengths_have_their_units() {
    let w = Workspace::new();
    w.write(
        "units.toml",
        "units = { length = \"mm\" }\nduration = 1\n[inputs]\nx = \"10*t\"\n[outputs]\narea = \"x^2\"\ncurv = \"1/(x+5)\"\nvel = \"d(x, t)\"\nratio = \"x/(x+1)\"\n\
         [[bodies]]\nname = \"b\"\nframe = \"Tx(x)\"\n",
    );
    for (arguments, units) in [
        (
            &["--order", "1"][..],
            &[
                ("area", "mm²"),
                ("curv", "1/mm"),
                ("vel", "mm/s"),
                ("d(area)/dt", "mm²/s"),
                ("d(curv)/dt", "1/(mm·s)"),
                ("d(vel)/dt", "mm/s²"),
                ("d(ratio)/dt", "1/s"),
            ][..],
        ),
        (
            &["--order", "1", "--per", "x"],
            &[
                ("d(area)/d(x)", "mm"),
                ("d(curv)/d(x)", "1/mm²"),
                ("d(ratio)/d(x)", "1/mm"),
            ],
        ),
    ] {
        let all = [
            &[
                "solve",
                "units.toml",
                "--samples",
                "3",
                "--out",
                "rows.json",
            ],
            arguments,
        ]
        .concat();
        w.run(&all).exits(0);
        let document: Value = serde_json::from_slice(&w.read("rows.json")).unwrap();
        for (column, unit) in units {
            assert_eq!(document["column_units"][column], *unit, "{column}");
        }
    }
}
