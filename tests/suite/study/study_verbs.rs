//! `sensitivity`, `tolerance` and `optimise` as their users meet them.

use crate::program::Workspace;
use serde_json::Value;

/// A slider-crank whose stroke is 2r, so that everything about the study is known in closed form.
const CRANK: &str = r#"title = "stroke"
duration = 1
units = { length = "mm", angle = "deg" }
[parameters]
r = 40
L = 80
half = "L/2"
turn = 360
[inputs]
phi = "turn*t"
[loops]
A = "Rz(phi) Tx(r) Rz(alpha) Tx(2*half) Rz(beta) Tx(-h)"
[guess]
h = 120
[tracks]
back = { samples = 181, inputs = { phi = [0, 180] } }
[measures]
stroke = { track = "back", of = "-h", take = "change" }
speed = { track = "back", of = "h", per = "phi", take = "largest" }
swing = { track = "back", of = "alpha", take = "max" }
miss = "(stroke - 100)^2"
[study]
minimise = "miss"
[study.variables]
r = { range = [20, 70], tolerance = 0.1 }
"#;

fn json(w: &Workspace, arguments: &[&str]) -> Value {
    serde_json::from_str(&w.run(arguments).exits(0).text()).unwrap()
}

fn workspace() -> Workspace {
    let w = Workspace::new();
    w.write("crank.toml", CRANK);
    w
}

#[test]
fn what_stands_beside_all_is_varied_too() {
    let w = workspace();
    let varied = |vary: &str| {
        let text = w
            .run(&["sensitivity", "crank.toml", "--vary", vary])
            .exits(0)
            .text();
        ["r ", "L ", "half "]
            .map(|name| text.lines().any(|line| line.trim_start().starts_with(name)))
    };
    assert_eq!(varied("all"), [true, true, false]);
    assert_eq!(varied("all,half,r"), [true, true, true]);
}

#[test]
fn sensitivities_of_the_stroke_are_two_and_nothing() {
    let w = workspace();
    let found = json(
        &w,
        &[
            "sensitivity",
            "crank.toml",
            "--rank",
            "stroke",
            "--scatter",
            "stroke=1",
            "--out",
            "-",
        ],
    );
    assert!((found["measures"]["stroke"].as_f64().unwrap() - 80.0).abs() < 1e-12);
    let rows = found["dimensions"].as_array().unwrap();
    let names: Vec<&str> = rows
        .iter()
        .map(|r| r["dimension"].as_str().unwrap())
        .collect();
    assert_eq!(
        names,
        ["r", "L"],
        "ranked, and only lengths and angles given as numbers"
    );
    let slope = |row: usize, measure: &str| rows[row]["derivatives"][measure].as_f64().unwrap();
    assert!((slope(0, "stroke") - 2.0).abs() < 1e-12 && slope(1, "stroke").abs() < 1e-12);
    // alpha falls from 0 to -180 degrees on the way.
    assert!((found["measures"]["swing"].as_f64().unwrap()).abs() < 1e-9);
    let text = w.run(&["sensitivity", "crank.toml"]).exits(0).text();
    assert!(
        text.contains("Exact derivatives, ranked by dmiss"),
        "{text}"
    );
    w.run(&["sensitivity", "crank.toml", "--out", "table.csv"])
        .exits(0);
    let table = std::fs::read_to_string(w.path("table.csv")).unwrap();
    assert!(
        table.starts_with("dimension,value,dstroke,dspeed,dswing,dmiss"),
        "{table}"
    );
}

#[test]
fn random_pieces_do_not_depend_on_threads_or_on_how_they_are_shared() {
    let w = workspace();
    let limited = CRANK.replace("\"change\" }", "\"change\", min = 79.9, max = 80.1 }");
    w.write("limited.toml", limited);
    let run = |more: &[&str]| {
        let base = ["tolerance", "limited.toml", "--vary", "r", "--json", "-"];
        json(&w, &[&base[..], more].concat())
    };
    let one = run(&["--pieces", "1000", "--threads", "1"]);
    let two = run(&["--pieces", "1000", "--threads", "2"]);
    assert_eq!(one, two);
    let digest = |v: &Value| u64::from_str_radix(v["digest"].as_str().unwrap(), 16).unwrap();
    let (a, b) = (
        run(&["--pieces", "300"]),
        run(&["--pieces", "700", "--skip", "300"]),
    );
    assert_eq!(digest(&a).wrapping_add(digest(&b)), digest(&one));
    assert_eq!(
        a["good"].as_u64().unwrap() + b["good"].as_u64().unwrap(),
        one["good"].as_u64().unwrap()
    );
    // Uniform within ±0.1 of r: the stroke is uniform within ±0.2, so half the pieces keep ±0.1.
    let good = one["good"].as_f64().unwrap() / 1000.0;
    assert!((good - 0.5).abs() < 0.05, "{good}");
    let stroke = &one["measures"]["stroke"];
    let deviation = 0.2 / 3.0_f64.sqrt();
    assert!((stroke["linear_deviation"].as_f64().unwrap() - deviation).abs() < 1e-12);
    assert!((stroke["deviation"].as_f64().unwrap() - deviation).abs() < 0.006);
    assert!((stroke["linear_sum"].as_f64().unwrap() - 0.2).abs() < 1e-12);
    let other = run(&["--pieces", "1000", "--seed", "2"]);
    assert_ne!(digest(&other), digest(&one));
}

#[test]
fn all_methods_find_the_crank_and_write_a_scene() {
    let w = workspace();
    for method in ["bfgs", "nelder-mead", "evolution"] {
        let out = format!("{method}.toml");
        let found = json(
            &w,
            &[
                "optimise",
                "crank.toml",
                "--method",
                method,
                "--out",
                &out,
                "--json",
                "-",
            ],
        );
        let r = found["variables"][0]["to"].as_f64().unwrap();
        assert!((r - 50.0).abs() < 1e-3, "{method}: {r}");
        assert_eq!(found["verified"]["unproved"], 0);
        assert!((found["verified"]["measures"]["stroke"].as_f64().unwrap() - 100.0).abs() < 1e-2);
        w.run(&["check", &out]).exits(0);
        let text = std::fs::read_to_string(w.path(&out)).unwrap();
        assert!(
            text.contains("half = \"L/2\""),
            "the rest of the file is kept"
        );
    }
}

#[test]
fn candidates_that_cannot_turn_are_refused_not_taken() {
    let w = workspace();
    // A stroke of 200 needs r = 100 > L = 80, which does not reach a half-turn: the search stops at r = L.
    let text = CRANK
        .replace("stroke - 100", "stroke - 200")
        .replace("[20, 70]", "[20, 150]");
    w.write("far.toml", &text);
    let found = json(&w, &["optimise", "far.toml", "--json", "-"]);
    let r = found["variables"][0]["to"].as_f64().unwrap();
    assert!((79.0..80.0).contains(&r), "{r}");
    assert!(found["refused"]["not_reached"].as_u64().unwrap() > 0);
    let bounded = CRANK.replace(
        "[study]",
        "long = { track = \"back\", of = \"r\", take = \"max\", max = 45 }\n[study]",
    );
    w.write("bounded.toml", &bounded);
    let found = json(&w, &["optimise", "bounded.toml", "--json", "-"]);
    assert!(
        (found["variables"][0]["to"].as_f64().unwrap() - 45.0).abs() < 1e-4,
        "{found}"
    );
}

#[test]
fn an_optimum_that_comes_too_near_is_not_taken() {
    let w = Workspace::new();
    // At 90 degrees the pin is r from the origin, the wall's face 55, the pin's face 3 nearer: 5 are left up to r = 47.
    let bodies = "[[bodies]]\nname = \"pin\"\nframe = \"Rz(phi) Tx(r) Rz(alpha)\"\n\
        shapes = [{ sphere = { radius = 3 } }]\n[[bodies]]\nname = \"wall\"\n\
        shapes = [{ sphere = { center = [0, 60, 0], radius = 5 } }]\n[clearance]\nminimum = 5\n";
    w.write("wall.toml", format!("{CRANK}{bodies}"));
    for method in ["bfgs", "nelder-mead"] {
        let run = [
            "optimise",
            "wall.toml",
            "--method",
            method,
            "--out",
            "kept.toml",
        ];
        let found = json(&w, &[&run[..], &["--json", "-"]].concat());
        let r = found["variables"][0]["to"].as_f64().unwrap();
        assert!((46.5..=47.0).contains(&r), "{method}: {r}");
        let miss = found["to"].as_f64().unwrap();
        assert!((miss - (2.0 * r - 100.0).powi(2)).abs() < 1e-9);
        assert_eq!(found["clearance"]["kept"], true);
        w.run(&["check", "kept.toml"]).exits(0);
    }
    let strict = format!("{CRANK}{}", bodies.replace("minimum = 5", "minimum = 15"));
    w.write("strict.toml", strict);
    let text = w.run(&["optimise", "strict.toml"]).exits(1).text();
    assert!(text.contains("Clearances are not kept"), "{text}");
}

#[test]
fn pairs_are_ranked() {
    let w = workspace();
    let found = json(
        &w,
        &[
            "optimise",
            "crank.toml",
            "--pairs",
            "--vary",
            "r,L",
            "--json",
            "-",
        ],
    );
    let pair = &found["pairs"][0];
    assert!(pair["objective"].as_f64().unwrap() < 1e-6, "{pair}");
    assert!((pair["values"][0].as_f64().unwrap() - 50.0).abs() < 1e-3);
}

#[test]
fn studies_start_from_other_assemblies_and_drives() {
    let w = workspace();
    // The slide on the other side: h is negative, and so is the stroke back.
    w.run(&[
        "optimise",
        "crank.toml",
        "--mode",
        "1",
        "--out",
        "one.toml",
        "--within",
        "50%",
    ])
    .exits(0);
    w.run(&[
        "optimise",
        "crank.toml",
        "--mode",
        "2",
        "--out",
        "two.toml",
        "--within",
        "0.5",
    ])
    .exits(0);
    let value = |scene: &str| {
        let found = json(&w, &["sensitivity", scene, "--out", "-"]);
        found["measures"]["speed"].as_f64().unwrap()
    };
    assert!((value("one.toml") - value("two.toml")).abs() < 1e-6);
    let start = |scene: &str| {
        let table = w
            .run(&["solve", scene, "--at", "0", "--out", "-"])
            .exits(0)
            .text();
        let mut rows = table
            .lines()
            .map(|l| l.split(',').map(str::to_owned).collect::<Vec<_>>());
        let heads = rows.next().unwrap();
        let h = heads.iter().position(|name| name == "h").unwrap();
        rows.next().unwrap()[h].parse::<f64>().unwrap()
    };
    assert!(
        start("one.toml") * start("two.toml") < 0.0,
        "two assemblies"
    );
    w.write("rows.csv", "phi\n0\n30\n60\n");
    w.run(&["sensitivity", "crank.toml", "--inputs", "rows.csv"])
        .exits(2)
        .says(&["--input-table would have no effect"]);
    let along = CRANK.replace("swing = { track = \"back\",", "swing = {");
    w.write(
        "along.toml",
        along.replace("take = \"max\"", "take = \"last\""),
    );
    let found = json(
        &w,
        &[
            "sensitivity",
            "along.toml",
            "--inputs",
            "rows.csv",
            "--out",
            "-",
        ],
    );
    // At 60 degrees: alpha = -60 - asin(sin 60 / 2).
    let alpha = -60.0 - (60f64.to_radians().sin() / 2.0).asin().to_degrees();
    let swing = found["measures"]["swing"].as_f64().unwrap();
    assert!((swing - alpha).abs() < 1e-9, "{swing} {alpha}");
}

/// A crank longer than its rod stops short of the square position and is feasible again behind it, on either branch: none of
/// the samples falls into the gap, but no motion leads across it.
#[test]
fn a_track_with_a_gap_between_two_samples_is_no_motion() {
    let w = Workspace::new();
    let parted = CRANK
        .replace("r = 40", "r = 80.02")
        .replace("turn = 360", "turn = 1.5")
        .replace("samples = 181", "samples = 60")
        .replace("[0, 180]", "[1.5, 178.5]")
        .replace("[20, 70]", "[20, 90]");
    w.write("parted.toml", &parted);
    for arguments in [
        &["sensitivity", "parted.toml"][..],
        &["tolerance", "parted.toml"],
        &["optimise", "parted.toml", "--out", "found.toml"],
    ] {
        w.run(arguments)
            .exits(1)
            .says(&["track `back`", "no motion was found that leads to pose 31"]);
    }
    let text = w.run(&["check", "parted.toml"]).exits(1).text();
    assert!(text.contains("stroke           no value"), "{text}");
    // A crank that is shorter than the rod goes round.
    let short = parted.replace("r = 80.02", "r = 79.9");
    w.write("short.toml", &short);
    let found = json(&w, &["sensitivity", "short.toml", "--out", "-"]);
    assert!(found["measures"]["stroke"].as_f64().unwrap() > 159.0);
}

#[test]
fn mistakes_of_a_study_are_said_with_their_place() {
    let w = Workspace::new();
    for (from, to, says) in [
        ("[20, 70]", "[70, 20]", "the range of `r` must ascend"),
        ("[20, 70]", "[50, 70]", "`r` starts outside its range"),
        (
            "tolerance = 0.1",
            "tolerance = -1",
            "a tolerance must not be negative",
        ),
        ("per = \"phi\"", "per = \"psi\"", "`psi` is not one"),
        (
            "take = \"largest\"",
            "take = \"norm\", power = 0.5",
            "at least 1",
        ),
        (
            "take = \"max\"",
            "take = \"norms\"",
            "`norms` cannot be taken",
        ),
        (
            "minimise = \"miss\"",
            "minimise = \"mist\"",
            "there is no measure `mist`",
        ),
        (
            "[study.variables]\nr =",
            "[study.variables]\ns =",
            "`s` is not one",
        ),
        (
            "{ range = [20, 70], tolerance = 0.1 }",
            "[20, 70]",
            "must be a table",
        ),
        (
            "[study.variables]",
            "[study.variablez]",
            "unknown key `variablez`",
        ),
    ] {
        assert!(CRANK.contains(from), "{from}");
        w.write("bad.toml", CRANK.replace(from, to));
        w.run(&["solve", "bad.toml", "--out", "-"])
            .exits(2)
            .says(&[says, "bad.toml:"]);
    }
    w.write("crank.toml", CRANK);
    w.write(
        "numbers.toml",
        "duration = 1\n[inputs]\nphi = \"360*t\"\n[outputs]\nx = \"40*cos(phi)\"\n",
    );
    for (arguments, says) in [
        (
            &["sensitivity", "crank.toml", "--vary", "q"][..],
            "no such parameter",
        ),
        (
            &["sensitivity", "crank.toml", "--rank", "q"],
            "no measure `q`",
        ),
        (
            &["tolerance", "crank.toml", "--vary", "all"],
            "there is no tolerance for L",
        ),
        (
            &["tolerance", "crank.toml", "--vary", "q"],
            "no such parameter",
        ),
        (
            &["enclose", "crank.toml", "--vary", "q"],
            "no such parameter",
        ),
        (
            &["tolerance", "crank.toml", "--pieces", "0"],
            "whole number",
        ),
        (
            &["tolerance", "crank.toml", "--pieces", "1000000000000"],
            "whole number",
        ),
        (&["optimise", "crank.toml", "--vary", "r,r"], "varied twice"),
        (
            &["optimise", "slider-crank"],
            "there is nothing to vary: name parameters",
        ),
        (
            &["optimise", "numbers.toml"],
            "there is nothing to vary: the scene has no parameters",
        ),
        (
            &["tolerance", "numbers.toml", "--tolerance", "0.1"],
            "there is nothing to vary: the scene has no parameters",
        ),
        (
            &["optimise", "crank.toml", "--out", "crank.toml"],
            "is an input",
        ),
    ] {
        w.run(arguments).exits(2).says(&[says]);
    }
    w.write(
        "nothing.toml",
        CRANK.replace("(stroke - 100)^2", "sqrt(-stroke)"),
    );
    w.run(&["optimise", "nothing.toml"])
        .exits(2)
        .says(&["`miss` has no value: sqrt of -80"]);
    let faulty = CRANK.replace("of = \"alpha\"", "of = \"ln(h - 80)\"");
    w.write("faulty.toml", &faulty);
    let minimised = &["optimise", "--minimise", "swing"];
    for verb in [&["sensitivity"][..], &["tolerance"], minimised] {
        w.run(&[verb, &["faulty.toml"]].concat()).exits(2).says(&[
            "`swing` has no value: ln of ",
            "at pose ",
            " of back",
        ]);
    }
    // What is neither minimised nor limited does not matter to a search.
    let text = w.run(&["optimise", "faulty.toml"]).exits(0).text();
    assert!(text.contains("no value"), "{text}");
    // No stroke of 500 is within reach: what comes nearest is shown, with the limit that it breaks.
    let far = CRANK.replace("\"change\" }", "\"change\", min = 500 }");
    w.write("far.toml", far);
    let text = w.run(&["optimise", "far.toml"]).exits(1).text();
    assert!(
        text.contains("The search found no candidate that keeps all constraints; with this one `stroke` misses its bound by 7.20e1 %"),
        "{text}"
    );
}

/// The search looks at instants: what it finds is judged over the whole motion, as `check` judges it.
#[test]
fn limits_of_an_optimum_are_those_of_the_whole_motion() {
    let wiper = |limits: &str, objective: &str| {
        format!(
            "duration = 2\nunits = {{ length = \"mm\", angle = \"deg\" }}\n[parameters]\ncrank = 30\ncoupler = 110\n[inputs]\n\
             phi = \"180*t\"\n[chains]\nrod = \"Rz(phi) Tx(crank) Rz(alpha)\"\narm = \"Tx(120) Rz(psi)\"\n[loops]\n\
             A = \"rod Tx(coupler) Rz(beta) inv(arm Tx(60))\"\n[guess]\npsi = 100\n[measures]\n\
             wiped = {{ of = \"psi\", take = \"range\", {limits} }}\nlost = \"100 - wiped\"\n[study]\nminimise = \"{objective}\"\n\
             [study.variables]\ncrank = {{ range = [20, 40] }}\ncoupler = {{ range = [100, 130] }}\n"
        )
    };
    let w = Workspace::new();
    // The range between the dead points is more than that of 180 instants: a least one is kept, a greatest one is not.
    for (objective, word, code) in [
        ("wiped", "its limits are kept (proved)", 0),
        ("lost", "its limits are missed between those poses", 1),
    ] {
        w.write("wiper.toml", wiper("min = 55, max = 60.4", objective));
        let search = ["optimise", "wiper.toml", "--out", "best.toml"];
        let report = [&search[..], &["--json", "best.json"]].concat();
        w.run(&report).exits(code);
        let text = w.run(&search).exits(code).text();
        for part in ["Over the whole motion `wiped` is ", word] {
            assert!(text.contains(part), "{text}");
        }
        let json: serde_json::Value = serde_json::from_slice(&w.read("best.json")).unwrap();
        let whole = &json["verified"]["whole_motion"][0];
        assert_eq!(whole["measure"], "wiped");
        assert_eq!(whole["kept"], code == 0, "{whole}");
        assert_eq!(whole["proved"], true, "{whole}");
        // `check` says the same of the scene that was written.
        let best = w
            .run(&["check", "best.toml", "--json", "-"])
            .exits(code)
            .text();
        let best: serde_json::Value = serde_json::from_str(&best).unwrap();
        let value = best["measures"][0]["value"].as_f64().unwrap();
        let told = whole["value"].as_f64().unwrap();
        assert!((value - told).abs() < 1e-6, "{value} {told}");
    }
}

/// |e| and what is made of it have no derivative at e = 0, nor has an extreme that two poses share; the others have.
#[test]
fn derivatives_of_one_side_are_told() {
    let w = Workspace::new();
    let text = |e: f64| {
        format!(
            "units = {{ length = \"mm\" }}\nduration = 1\n[parameters]\nr = 40\nL = 95\ne = {e}\nq = 40\n[inputs]\nphi = \"2*pi*t\"\n\
             [loops]\nA = \"Rz(phi) Tx(r) Rz(alpha) Tx(L) Rz(beta) T(-h, -e, 0)\"\n[guess]\nh = 120\n\
             [outputs]\nwidth = \"abs(e)\"\n[measures]\n\
             swing = {{ of = \"beta\", take = \"largest\" }}\nsize = {{ of = \"width\", take = \"mean\" }}\n\
             twice = \"2*size\"\nmost = {{ of = \"max(r, q)\", take = \"last\" }}\nstep = {{ of = \"mod(r, 40)\", take = \"first\" }}\n\
             stroke = {{ of = \"h\", take = \"range\" }}\nsquare = {{ of = \"e^2 + h\", take = \"mean\" }}\nreach = {{ of = \"h\", take = \"first\" }}\n"
        )
    };
    let rows: [(f64, &[&str]); 2] = [
        (0.0, &["swing", "size", "twice", "most", "step"]),
        (0.5, &["most", "step"]),
    ];
    for (e, known) in rows {
        w.write("kink.toml", text(e));
        let run = w
            .run(&["sensitivity", "kink.toml", "--out", "s.json"])
            .exits(0);
        let report: Value = serde_json::from_slice(&w.read("s.json")).unwrap();
        let told: Vec<&str> = report["one_sided"]
            .as_array()
            .unwrap()
            .iter()
            .filter_map(Value::as_str)
            .collect();
        assert_eq!(told, known, "{e}\n{}", run.text());
        assert!(
            run.text()
                .contains(&format!("share an extreme: {}.", known.join(", ")))
        );
    }
}

/// The table tells the measures as drawn even if no piece can be assembled.
#[test]
fn measures_are_told_where_no_piece_can_be_assembled() {
    let w = Workspace::new();
    // The measure has a value for the file's dimension alone.
    let text = "units = { length = \"mm\" }\nduration = 1\n[parameters]\nd = 10\n[inputs]\nphi = \"0.1*t\"\n\
                [loops]\nA = \"Rz(phi) Tx(d) Rz(alpha) Tx(20) Rz(beta) Tx(-h)\"\n[guess]\nh = 30\n\
                [measures]\nreach = { of = \"h + sqrt(-(d - 10)^2)\", take = \"first\" }\n";
    w.write("never.toml", text);
    let run = w.run(&[
        "tolerance",
        "never.toml",
        "--vary",
        "d",
        "--tolerance",
        "1e-3",
        "--pieces",
        "2",
    ]);
    let table = run.text();
    assert!(table.contains("  reach "), "{table}");
}

/// The minimum follows the other of two equal numbers than the maximum: the derivative of their sum is that of both.
#[test]
fn the_derivatives_of_equal_numbers_add_up() {
    let w = Workspace::new();
    w.write(
        "equal.toml",
        "duration = 1\n[parameters]\nr = 40\nq = 40\n[inputs]\nx = \"t\"\n[chains]\na = \"Tx(x + r) Ty(q)\"\n[[bodies]]\nname = \"a\"\nframe = \"a\"\n\
         [measures]\nboth = { of = \"max(r, q) + min(r, q)\", take = \"first\" }\nnone = { of = \"abs(r - q) - abs(q - r)\", take = \"first\" }\n\
         m1 = { of = \"2*r + q\", take = \"first\" }\nm2 = { of = \"q + 2*r\", take = \"last\" }\nsame = \"max(m1, m2)\"\n",
    );
    let run = w
        .run(&[
            "sensitivity",
            "equal.toml",
            "--vary",
            "r,q",
            "--out",
            "s.json",
        ])
        .exits(0);
    let report: Value = serde_json::from_slice(&w.read("s.json")).unwrap();
    for row in report["dimensions"].as_array().unwrap() {
        assert_eq!(row["derivatives"]["both"], 1.0, "{}", run.text());
    }
    // Where the sides that are taken contradict each other that is told; equal numbers with equal derivatives have no kink.
    assert_eq!(
        report["one_sided"],
        serde_json::json!(["none"]),
        "{}",
        run.text()
    );
}

/// Values and derivatives of extremes are those of the whole motion, not of the nearest pose; what is of poses alone is told.
#[test]
fn extremes_of_a_sensitivity_are_those_of_the_whole_motion() {
    let w = Workspace::new();
    let (r, rod, e) = (40.0_f64, 100.0_f64, 15.0_f64);
    w.write(
        "stroke.toml",
        format!(
            "units = {{ length = \"mm\", angle = \"deg\" }}\nduration = 1\n[parameters]\nr = {r}\nL = {rod}\ne = {e}\n\
             [inputs]\nphi = \"360*t + 1\"\n[loops]\nA = \"Rz(phi) Tx(r) Rz(alpha) Tx(L) Rz(beta) T(-h, -e, 0)\"\n[guess]\nh = 130\n\
             [measures]\nmost = {{ of = \"h\", take = \"max\" }}\nleast = {{ of = \"h\", take = \"min\" }}\n\
             stroke = {{ of = \"h\", take = \"range\" }}\ndiff = \"most - least\"\n\
             fast = {{ of = \"h\", per = \"phi\", take = \"max\" }}\nmiddle = {{ of = \"h\", take = \"mean\" }}\n"
        ),
    );
    let run = w
        .run(&[
            "sensitivity",
            "stroke.toml",
            "--vary",
            "r,L,e",
            "--out",
            "s.json",
        ])
        .exits(0);
    let report: Value = serde_json::from_slice(&w.read("s.json")).unwrap();
    assert_eq!(report["of_poses"], serde_json::json!(["fast", "middle"]));
    assert!(run.text().contains("nothing between them: fast, middle."));
    // The stretched and the folded position by Pythagoras.
    let [far, near] = [rod + r, rod - r].map(|reach| (reach * reach - e * e).sqrt());
    let ends = [
        ("r", (rod + r) / far, -(rod - r) / near),
        ("L", (rod + r) / far, (rod - r) / near),
        ("e", -e / far, -e / near),
    ];
    let is_near = |found: &Value, known: f64| {
        let found = found.as_f64().unwrap();
        assert!(
            (found - known).abs() < 1e-9,
            "{found} {known}\n{}",
            run.text()
        );
    };
    is_near(&report["measures"]["most"], far);
    is_near(&report["measures"]["stroke"], far - near);
    for row in report["dimensions"].as_array().unwrap() {
        let (_, most, least) = ends.iter().find(|end| row["dimension"] == end.0).unwrap();
        let slopes = &row["derivatives"];
        is_near(&slopes["most"], *most);
        is_near(&slopes["least"], *least);
        is_near(&slopes["stroke"], most - least);
        is_near(&slopes["diff"], most - least);
    }
}

/// A tolerance that no dimension takes is refused, in every verb that has one.
#[test]
fn a_tolerance_without_effect_is_refused() {
    let w = Workspace::new();
    w.write(
        "gap.toml",
        "duration = 1\n[parameters]\nd = 10\ne = 1\n[inputs]\ns = \"t\"\n[[bodies]]\nname = \"slide\"\nframe = \"Tx(s) Ty(e)\"\n\
         shapes = [{ sphere = { radius = 1 } }]\n[[bodies]]\nname = \"stop\"\nframe = \"Tx(d)\"\nshapes = [{ sphere = { radius = 1 } }]\n\
         [measures]\nx = { of = \"s + e\", take = \"last\" }\n[study.variables]\ne = { tolerance = 0.01 }\n[clearance]\nminimum = 1\n",
    );
    for verb in [
        &["check", "gap.toml", "--made-within", "9"][..],
        &["enclose", "gap.toml", "--tolerance", "9"],
        &["tolerance", "gap.toml", "--tolerance", "9"],
    ] {
        w.run(verb)
            .exits(2)
            .says(&["applies to no dimension: only e"]);
    }
    // With a further dimension it has an effect: a stop 9 mm away collides.
    let run = w.run(&["check", "gap.toml", "--made-within", "9", "--vary", "d,e"]);
    let text = run.exits(1).text();
    assert!(text.contains("2 dimensions (d, e)"), "{text}");
}
