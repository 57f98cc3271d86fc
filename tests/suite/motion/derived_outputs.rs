//! Derivatives as parts of outputs and measures, against closed forms; places where none can stand.

use crate::driven::{Driven, Model, solve};
use crate::program::Workspace;
use crate::reference::mechanism;
use mechanim::diag::Source;
use mechanim::kinematics::measures::{DriveSamples, measure_motion};
use mechanim::scene::builtin::find_builtin;

/// x² = p = (1 + t)²: everything is a polynomial of the time or a quotient of two.
const SQUARE: &str = "duration = 3\n[parameters]\nk = 2\n[inputs]\np = \"(1 + t)^2\"\nq = \"k*t\"\n\
    [equations]\ne = \"x^2 - p\"\n[guess]\nx = 1\n";

fn written(text: &str) -> Model {
    let source = Source {
        name: "test".to_owned(),
        text: text.to_owned(),
    };
    mechanism(&source, &[])
}

#[test]
fn outputs_hold_derivatives() {
    type Exact = fn(f64) -> f64;
    let cases: [(&str, Exact); 9] = [
        ("d(x, t)", |_| 1.0),
        ("d(x, p)", |t| 0.5 / (1.0 + t)),
        ("d(x, p, 2)", |t| -0.25 / (1.0 + t).powi(3)),
        ("d(x^3, t, 2) + x", |t| 7.0 * (1.0 + t)),
        ("-k*d(q, t)*x", |t| -4.0 * (1.0 + t)),
        ("d(x*q, q)", |t| 1.0 + t),
        ("sin(d(x, time)) + d(p, t)/d(q, t)", |t| {
            1f64.sin() + 1.0 + t
        }),
        ("d(plain, p)*2", |t| 1.0 / (1.0 + t)),
        // An output that uses one with derivatives.
        ("first^2", |_| 1.0),
    ];
    for (formula, exact) in cases {
        let model = written(&format!(
            "{SQUARE}[outputs]\nplain = \"x\"\nfirst = \"d(x, t)\"\nout = \"{formula}\"\nlater = \"2*out\"\n"
        ));
        for sample in solve(&model, &[0.0, 0.7, 3.0]).unwrap().samples {
            let outputs = &sample.pose.as_ref().unwrap().outputs;
            let exact = exact(sample.time);
            let (found, later) = (outputs[2], outputs[3]);
            let allowed = 1e-12 * (1.0 + exact.abs());
            assert!(
                (found - exact).abs() < allowed,
                "{formula}: {found} {exact}"
            );
            assert_eq!(later, 2.0 * found, "{formula}");
        }
    }
}

/// v = -R dphi/dt of the drum: with u = 1 + v t/R its rim moves at sqrt(u² - 1)/u.
#[test]
fn the_rim_of_the_drum_has_the_speed_of_its_closed_form() {
    let scene = find_builtin("rope-drum").unwrap().text;
    let model = written(&scene.replace(
        "[outputs]\n",
        "[outputs]\nrim = \"-R*d(phi, t)\"\npull = \"-R*d(phi, x)\"\n",
    ));
    let rim = model.outputs.iter().position(|o| o.name == "rim").unwrap();
    for sample in solve(&model, &[0.0, 0.5, 1.0, 3.0]).unwrap().samples {
        let u = 1.0 + sample.time;
        let exact = (u * u - 1.0).sqrt() / u;
        let outputs = &sample.pose.as_ref().unwrap().outputs;
        for found in &outputs[rim..rim + 2] {
            assert!((found - exact).abs() < 1e-9, "{u}: {found} {exact}");
        }
    }
}

#[test]
fn measures_hold_derivatives() {
    let text = format!(
        "{SQUARE}[outputs]\nv = \"d(x, p)\"\n[tracks]\nway = {{ samples = 5, inputs = {{ p = [1, 4] }} }}\n[measures]\n\
         fastest = {{ of = \"v\", take = \"max\", max = 0.6 }}\n\
         half = {{ of = \"x*d(x, p)\", take = \"mean\" }}\n\
         last = {{ of = \"d(x^2, t)\", take = \"last\" }}\n\
         there = {{ track = \"way\", of = \"d(x, p)\", take = \"last\" }}\n\
         product = {{ track = \"way\", of = \"x*d(x, p)\", take = \"sum\" }}\n\
         used = {{ track = \"way\", of = \"v*x\", take = \"first\" }}\n\
         path = {{ of = [\"d(x, p)\", \"d(q, t)\"], take = \"chord\" }}\n\
         both = \"half + last\"\n"
    );
    let model = written(&text);
    let times: Vec<f64> = (0..7).map(|k| 0.5 * k as f64).collect();
    let trajectory = solve(&model, &times).unwrap();
    let system = model.system().unwrap();
    let found = measure_motion(
        &system,
        &model.actuation,
        &model.measures,
        DriveSamples::all(&trajectory.samples),
    );
    let exact = [0.5, 0.5, 8.0, 0.25, 2.5, 0.5, 0.375, 8.5];
    for ((found, exact), measure) in found.into_iter().zip(exact).zip(&model.measures.list) {
        let found = found.unwrap();
        assert!(
            (found - exact).abs() < 1e-12,
            "{}: {found} {exact}",
            measure.name
        );
    }
    // As a user sees them.
    let w = Workspace::new();
    w.write("s.toml", text);
    let run = w.run(&["check", "s.toml"]).exits(0);
    assert!(run.text().contains("fastest"), "{}", run.text());
    let table = w
        .run(&["solve", "s.toml", "--samples", "2", "--out", "-"])
        .exits(0);
    assert!(table.text().contains("0.5"), "{}", table.text());
}

/// Each mistake is shown at its place in the file.
#[test]
fn derivatives_stand_where_they_have_a_value() {
    let w = Workspace::new();
    let measure = |of: &str| format!("[measures]\nm = {{ {of}, take = \"max\" }}\n");
    let track = "[tracks]\nway = { samples = 3, inputs = { p = [1, 4] } }\n";
    let cases = [
        (
            "[outputs]\nv = \"d(d(x, t), t)\"\n".to_owned(),
            "cannot be used here",
        ),
        (
            "[outputs]\nv = \"d(x, t)\"\nw = \"1 + d(2*v, t)\"\n".to_owned(),
            "contain another derivative",
        ),
        (
            "[outputs]\nv = \"d(x, y)\"\n".to_owned(),
            "`y` is not an input",
        ),
        (
            "[outputs]\nv = \"d(x)\"\n".to_owned(),
            "a derivative is written",
        ),
        (
            "[outputs]\nv = \"d(x, t, 0)\"\n".to_owned(),
            "the order of a derivative",
        ),
        (
            "[outputs]\nv = \"d(x, t, 9)\"\n".to_owned(),
            "the order of a derivative",
        ),
        ("[outputs]\nv = \"d(zz, t)\"\n".to_owned(), "`zz`"),
        (
            measure("of = \"x*d(x, p)\", per = \"p\""),
            "`per` cannot differentiate",
        ),
        (
            format!("{track}{}", measure("of = \"x*d(x, t)\", track = \"way\"")),
            "no time",
        ),
        (
            format!(
                "[outputs]\nv = \"d(x, t)\"\n{track}{}",
                measure("of = \"2*v\", track = \"way\"")
            ),
            "no time",
        ),
        (
            format!("{}n = \"d(m, t)\"\n", measure("of = \"x\"")),
            "cannot be used here",
        ),
    ];
    for (text, said) in cases {
        w.write("s.toml", format!("{SQUARE}{text}"));
        w.run(&["check", "s.toml"])
            .exits(2)
            .says(&[said, "s.toml:"]);
    }
    for (from, to) in [
        ("k = 2", "k = \"d(2, t)\""),
        ("x^2 - p", "x^2 - d(p, t)"),
        ("(1 + t)^2", "d(t, t)"),
    ] {
        w.write("s.toml", SQUARE.replace(from, to));
        let run = w.run(&["check", "s.toml"]).exits(2);
        run.says(&["a derivative cannot be used here", "s.toml:"]);
    }
    let chain = "duration = 1\n[inputs]\np = \"t\"\n[loops]\nA = \"Tx(d(p, t)) Tx(-x)\"\n";
    w.write("s.toml", chain);
    w.run(&["check", "s.toml"])
        .exits(2)
        .says(&["a derivative cannot be used here", "s.toml:"]);
}

/// Studies derive measures by parameters: they take a derivative by an input as it is, and say what else they cannot.
#[test]
fn studies_say_which_derivatives_they_cannot_derive() {
    let w = Workspace::new();
    let scene = |of: &str| {
        format!("{SQUARE}[measures]\nm = {{ {of}, take = \"max\" }}\n")
            .replace("k = 2\n", "k = 2\nc = 2\n")
            .replace("x^2 - p", "x^2 - c*p")
    };
    let arguments = ["sensitivity", "s.toml", "--vary", "c", "--out", "out.csv"];
    let table = |of: &str| {
        w.write("s.toml", scene(of));
        w.run(&arguments).exits(0);
        String::from_utf8(w.read("out.csv")).unwrap()
    };
    assert_eq!(table("of = \"d(x, p)\""), table("of = \"x\", per = \"p\""));
    for of in [
        "of = \"x*d(x, p)\"",
        "of = \"d(x, t)\"",
        "of = \"d(x, p, 2)\"",
    ] {
        w.write("s.toml", scene(of));
        w.run(&["check", "s.toml"]).exits(0);
        w.run(&arguments)
            .exits(2)
            .says(&["studies cannot differentiate", "s.toml:"]);
    }
}

/// An enclosure has no bound of what holds a derivative, and has searched nothing of it.
#[test]
fn enclosures_say_nothing_of_derivatives() {
    let w = Workspace::new();
    let text = SQUARE
        .replace("k = 2\n", "k = 2\nc = 2\n")
        .replace("x^2 - p", "x^2 - c*p");
    w.write("s.toml", format!("{text}[outputs]\nrate = \"d(x, t)\"\n"));
    let run = w.run(&[
        "enclose",
        "s.toml",
        "--param",
        "c=2+-0.01",
        "--samples",
        "3",
    ]);
    let said = run.exits(0).text();
    let row = said
        .lines()
        .find(|line| line.trim_start().starts_with("rate"));
    let words: Vec<&str> = row.unwrap().split_whitespace().collect();
    assert_eq!(
        words[1..6],
        ["unbounded", "unbounded", "-", "-", "-"],
        "{said}"
    );
}

/// What has no value at a pose has none after any function of it: an output is empty there, and a measure that needs it fails.
#[test]
fn what_is_undefined_stays_undefined() {
    let formulas = [
        "1/u",
        "min(1/u, 5)",
        "max(ln(abs(u)), -4)",
        "atan(1/u)",
        "exp(-1/u^2)",
        "1/(1/u)",
        "2^(-1/u^2)",
        "u^(-1)",
        "abs(u)^(-0.5)",
        "atan2(1, 1/u)",
        "atan2(u, u)",
        "hypot(1/u, 1)",
        "min(5, hypot(1/u, 1))",
        "mod(1, u)",
        "max(sqrt(u - 1), 0)",
        "0*(0/u)",
    ];
    let w = Workspace::new();
    for formula in formulas {
        let text = |limit: &str| {
            format!(
                "duration = 4\n[inputs]\nu = \"t - 2\"\n[outputs]\no = \"{formula}\"\n[measures]\nm = {{ of = \"o\", take = \"mean\" }}\n{limit}"
            )
        };
        w.write("undefined.toml", text(""));
        let value = |at: &str| {
            let run = w.run(&["solve", "undefined.toml", "--at", at, "--out", "-"]);
            let table = run.exits(0).text();
            let mut rows = table.lines().map(|line| line.split(','));
            let place = rows.next().unwrap().position(|name| name == "o").unwrap();
            rows.next().unwrap().nth(place).unwrap().to_owned()
        };
        assert_eq!(value("2"), "", "{formula}");
        assert!(value("3.5").parse::<f64>().is_ok(), "{formula}");
        w.write(
            "undefined.toml",
            text("most = { of = \"o\", take = \"max\", max = 1e9 }\n"),
        );
        let run = w.run(&["check", "undefined.toml"]);
        assert_ne!(run.code, 0, "{formula}");
    }
}

/// The same in drives, whatever the order of the arguments.
#[test]
fn drives_without_a_value_do_not_pass() {
    // The drive, and an instant at which it has no value.
    let drives = [
        ("max(0, sqrt(t - 1))", "0.5"),
        ("max(sqrt(t - 1), 0)", "0.5"),
        ("ln(t - 1)^0", "0.5"),
        ("sqrt(t - 1)^0", "0.5"),
        ("1^ln(t - 1)", "0.5"),
        ("(1/(t - 1))^0", "1"),
        ("max(0, ln(abs(t - 1)))", "1"),
        ("atan2(t - 1, t - 1)", "1"),
        ("min(3, 1/abs(t - 1))", "1"),
        ("atan(1/(t - 1))", "1"),
        ("0*ln((t - 1)^2)", "1"),
        ("floor(atan(1/(t - 1)))", "1"),
        ("(1/(0.9 - 0.3*t))^0", "3"),
        ("atan2(0.9 - 0.3*t, 0)", "3"),
        ("ln(0.9 - 0.3*t)", "3"),
    ];
    let w = Workspace::new();
    for (drive, at) in drives {
        w.write(
            "drive.toml",
            format!("duration = 3\n[inputs]\nu = \"{drive}\"\n[[bodies]]\nname = \"b\"\nframe = \"Tx(1 + u)\"\n"),
        );
        let run = w.run(&["check", "drive.toml", "--samples", "31"]);
        assert_ne!(run.code, 0, "{drive}");
        let run = w.run(&["solve", "drive.toml", "--at", at, "--out", "-"]);
        assert_ne!(run.code, 0, "{drive}");
    }
}

/// Derivatives of what has no value have none either.
#[test]
fn what_is_undefined_has_no_rate() {
    let scene = written(
        "duration = 2\n[inputs]\nx = \"t - 1\"\n[outputs]\ne = \"d((1/x)^0, x)\"\nf = \"d(max(0, 1/x), t)\"\n",
    );
    let trajectory = solve(&scene, &[0.0, 1.0, 2.0]).unwrap();
    let outputs = |k: usize| trajectory.samples[k].pose.as_ref().unwrap().outputs.clone();
    assert!(
        outputs(1).iter().all(|value| value.is_nan()),
        "{:?}",
        outputs(1)
    );
    assert_eq!(outputs(2), [0.0, -1.0]);
}
