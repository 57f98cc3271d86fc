//! `[bars]`: the same motions as with joint unknowns, the same proofs, and what is refused.

use crate::driven::{Model, even_times, solve};
use mechanim::diag::Source;
use mechanim::kinematics::results::certificate::Certificate;
use mechanim::scene::{Overrides, builtin, load_scene};

fn builtin_scene(name: &str) -> Model {
    let source = builtin::find_builtin(name).unwrap();
    Model::from(load_scene(&source, &Overrides::default()).unwrap())
}

fn scene_of(text: &str) -> Model {
    let source = Source {
        name: "bars".to_owned(),
        text: text.to_owned(),
    };
    Model::from(
        load_scene(&source, &Overrides::default()).unwrap_or_else(|e| panic!("{e}\n{text}")),
    )
}

#[test]
fn bars_move_as_the_loops_of_the_same_mechanism() {
    let [bars, loops] = ["dyads-bars", "dyads"].map(builtin_scene);
    let times = even_times(&loops, 145);
    let [bars_moved, loops_moved] = [&bars, &loops].map(|m| solve(m, &times).unwrap());
    assert_eq!(bars_moved.missing() + loops_moved.missing(), 0);
    let mut compared = 0;
    for (a, b) in bars_moved.poses().zip(loops_moved.poses()) {
        for (k, trace) in bars.traces.iter().enumerate() {
            let other = loops.traces.iter().position(|t| t.name == trace.name);
            let off = a.traces[k].distance(b.traces[other.unwrap()]);
            // Rounding of lengths of 300 mm, and what the angles of the loops carry of it.
            assert!(off < 2e-12, "{}: {off:e}", trace.name);
            compared += 1;
        }
        let is_proved = matches!(
            a.certificate,
            Certificate::Certified { error_bound, .. } if error_bound < 1e-12
        );
        assert!(is_proved, "{:?}", a.certificate);
    }
    assert_eq!(compared, 145 * 11);
}

/// A mechanism with bars, the same by other means, and the columns of both that agree; in one unit of length.
struct Pair {
    what: &'static str,
    bars: &'static str,
    other: &'static str,
    columns: &'static [&'static str],
}

const PAIRS: &[Pair] = &[
    Pair {
        what: "a coupler between a crank and a rocker",
        bars: r#"
            duration = 4
            [inputs]
            phi = "2*pi*t/4"
            [chains]
            crank = "Rz(phi)"
            rocker = "Tx(100) Rz(psi)"
            [bars]
            coupler = { from = "crank Tx(30)", to = "rocker Tx(70)", length = 90 }
            [guess]
            psi = 1.5
            [[bodies]]
            name = "rocker"
            frame = "rocker"
            [[traces]]
            name = "M"
            body = "rocker"
            point = [70, 10, 5]
        "#,
        other: r#"
            duration = 4
            [inputs]
            phi = "2*pi*t/4"
            [loops]
            A = "Rz(phi) Tx(30) Rz(a) Tx(90) Rz(b) inv(Tx(100) Rz(psi) Tx(70))"
            [guess]
            a = 0.5
            b = 1
            psi = 1.5
            [[bodies]]
            name = "rocker"
            frame = "Tx(100) Rz(psi)"
            [[traces]]
            name = "M"
            body = "rocker"
            point = [70, 10, 5]
        "#,
        columns: &["M"],
    },
    Pair {
        what: "a rod in space, in degrees, at a traced point and a point written down",
        bars: r#"
            duration = 4
            units = { angle = "deg" }
            [parameters]
            L = 90
            [inputs]
            phi = "360*t/4"
            [chains]
            crank = "T(0, 0, 10) Rz(phi)"
            [bars]
            rod = { from = "pin", to = "T(60, 60, 20) Rx(psi) T(0, 40, 0)", length = "L" }
            [guess]
            psi = 60
            [[bodies]]
            name = "crank"
            frame = "crank"
            [[bodies]]
            name = "lever"
            frame = "T(60, 60, 20) Rx(psi)"
            [[traces]]
            name = "pin"
            body = "crank"
            point = [25, 0, 4]
            [[traces]]
            name = "M"
            body = "lever"
            point = [0, 40, 0]
        "#,
        other: r#"
            duration = 4
            units = { angle = "deg" }
            [inputs]
            phi = "360*t/4"
            [contacts.c]
            first = { sphere = { radius = 50 }, frame = "T(0, 0, 10) Rz(phi) T(25, 0, 4)" }
            second = { sphere = { radius = 40 }, frame = "T(60, 60, 20) Rx(psi) T(0, 40, 0)" }
            [guess]
            psi = 60
            [[bodies]]
            name = "lever"
            frame = "T(60, 60, 20) Rx(psi)"
            [[traces]]
            name = "M"
            body = "lever"
            point = [0, 40, 0]
        "#,
        columns: &["M"],
    },
    Pair {
        what: "a strut whose length is driven",
        bars: r#"
            duration = 2
            [inputs]
            l = "80 + 20*t"
            [chains]
            arm = "Rz(psi)"
            [bars]
            strut = { from = [40, -50], to = "arm Tx(90)", length = "l" }
            [guess]
            psi = 0.3
            [[bodies]]
            name = "arm"
            frame = "arm"
            [[traces]]
            name = "M"
            body = "arm"
            point = [120, 0, 0]
        "#,
        other: r#"
            duration = 2
            [inputs]
            l = "80 + 20*t"
            [loops]
            A = "T(40, -50, 0) Rz(a) Tx(l) Rz(b) inv(Rz(psi) Tx(90))"
            [guess]
            a = 1
            b = -0.7
            psi = 0.3
            [[bodies]]
            name = "arm"
            frame = "Rz(psi)"
            [[traces]]
            name = "M"
            body = "arm"
            point = [120, 0, 0]
        "#,
        columns: &["M"],
    },
    Pair {
        what: "three rods that hold a point in space",
        bars: r#"
            duration = 2
            [inputs]
            a = "100 + 10*sin(3*t)"
            b = "110 - 5*t"
            c = "105 + 4*t"
            [bars]
            first = { from = [0, 0, 0], to = ["x", "y", "z"], length = "a" }
            second = { from = ["x", "y", "z"], to = [120, 0, 0], length = "b" }
            third = { from = [50, 90, 0], to = ["x", "y", "z"], length = "c" }
            [guess]
            x = 60
            y = 40
            z = 70
            [[bodies]]
            name = "point"
            frame = "T(x, y, z)"
            [[traces]]
            name = "M"
            body = "point"
        "#,
        other: r#"
            duration = 2
            [inputs]
            a = "100 + 10*sin(3*t)"
            b = "110 - 5*t"
            c = "105 + 4*t"
            [equations]
            first = "sqrt(x^2 + y^2 + z^2) - a"
            second = "sqrt((x - 120)^2 + y^2 + z^2) - b"
            third = "sqrt((x - 50)^2 + (y - 90)^2 + z^2) - c"
            [guess]
            x = 60
            y = 40
            z = 70
            [[bodies]]
            name = "point"
            frame = "T(x, y, z)"
            [[traces]]
            name = "M"
            body = "point"
        "#,
        columns: &["M"],
    },
];

#[test]
fn ends_on_links_are_carried_by_them() {
    for pair in PAIRS {
        let [bars, other] = [pair.bars, pair.other].map(scene_of);
        let times = even_times(&bars, 61);
        let [found, wanted] = [&bars, &other].map(|m| solve(m, &times).unwrap());
        assert_eq!([found.missing(), wanted.missing()], [0, 0], "{}", pair.what);
        for (a, b) in found.poses().zip(wanted.poses()) {
            for name in pair.columns {
                let place = |m: &Model| m.traces.iter().position(|t| t.name == *name).unwrap();
                let off = a.traces[place(&bars)].distance(b.traces[place(&other)]);
                assert!(off < 1e-11, "{}: {off:e}", pair.what);
            }
            let is_proved = matches!(a.certificate, Certificate::Certified { .. });
            assert!(is_proved, "{}: {:?}", pair.what, a.certificate);
        }
    }
}

#[test]
fn all_mistakes_of_bars_are_named_at_their_places() {
    let text = r#"
duration = 1
[inputs]
phi = "t"
[parameters]
L = -3
[chains]
P = "T(x, y, 0)"
[bars]
short = { from = "P", to = [1, 2], length = 0 }
less = { from = "P", to = [3, 4], length = "L" }
still = { from = [0, 0], to = [5, 0, 0], length = 5 }
same = { from = "P", to = "P Rz(phi)", length = 5 }
lost = { from = "Q", to = "P", length = 5 }
flat = { from = [1], to = "P", length = 5 }
bare = { from = "P", to = [9, 9] }
odd = 5
more = { from = "P", to = [7, 7], length = 5, radius = 3 }
"#;
    let source = Source {
        name: "bars".to_owned(),
        text: text.to_owned(),
    };
    let error = load_scene(&source, &Overrides::default()).err().unwrap();
    let found: Vec<(String, &str)> = error
        .diagnostics
        .sorted()
        .into_iter()
        .map(|d| {
            let place = d.span.clone().map_or("", |span| &text[span]);
            (d.message.clone(), place)
        })
        .collect();
    let wanted = [
        ("the length of bar `short` must be positive, found 0", "0"),
        (
            "the length of bar `less` must be positive, found -3",
            "\"L\"",
        ),
        ("bar `still` is between two fixed points", "still"),
        (
            "bar `same` has the same point at both ends",
            "\"P Rz(phi)\"",
        ),
        ("there is no chain and no trace `Q`", "Q"),
        ("`from` must have 2 or 3 components, found 1", "[1]"),
        (
            "bar `odd` must be a table with `from`, `to` and `length`",
            "5",
        ),
    ];
    for (message, place) in wanted {
        let is_there = found
            .iter()
            .any(|(m, p)| m == message && p.trim_matches('"') == place.trim_matches('"'));
        assert!(is_there, "{message} at {place}:\n{found:#?}");
    }
    for part in ["length", "radius"] {
        assert!(
            found.iter().any(|(m, _)| m.contains(&format!("`{part}`"))),
            "{part}: {found:#?}"
        );
    }
}

/// A bar that does not fit is off by a length: the distance of its ends minus its own.
#[test]
fn a_bar_that_does_not_fit_is_off_by_a_length() {
    let w = crate::program::Workspace::new();
    for (place, off) in [
        (300.0, "200.000000 mm"),
        (200.0, "100.000000 mm"),
        (101.0, "1.000000 mm"),
    ] {
        w.write(
            "b.toml",
            format!(
                "units = {{ length = \"mm\" }}\nduration = 1\n[inputs]\nu = \"{place:?} + 0*t\"\n[bars]\n\
                 b = {{ from = [0, 0], to = \"T(u, y, 0)\", length = 100 }}\n"
            ),
        );
        let run = w.run(&["check", "b.toml"]);
        let said = run.text() + &run.stderr;
        assert!(said.contains(&format!("{off} off its length")), "{said}");
    }
    // A pose that is offered: the ends are 108.17 apart.
    w.write(
        "p.toml",
        "units = { length = \"mm\" }\nduration = 1\n[inputs]\nu = \"60 + 0*t\"\n[bars]\n\
         b = { from = [0, 0], to = \"T(u, y, 0)\", length = 100 }\n",
    );
    let run = w.run(&["check", "p.toml", "--input", "u=60", "--pose", "y=90"]);
    let said = run.text() + &run.stderr;
    assert!(said.contains("off by 8.2e0 mm"), "{said}");
}
