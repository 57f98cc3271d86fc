//! Mechanisms far from the origin, as in the coordinates of a map: they move as at the origin, as accurately as numbers of that
//! size permit, and what these do not permit is said.

use crate::program::Workspace;
use serde_json::Value;

/// The intersection of circles about (0, 0) and (d, 0) above the line between them.
fn apex(d: f64, first: f64, second: f64) -> (f64, f64) {
    let x = (d * d + first * first - second * second) / (2.0 * d);
    (x, (first * first - x * x).sqrt())
}

/// A dyad of bars between fixed points, one of them growing.
fn dyad([x, y]: [f64; 2]) -> String {
    format!(
        "units = {{ length = \"m\" }}\nduration = 1\n[parameters]\nX = {x:e}\nY = {y:e}\n[inputs]\nu = \"t\"\n[bars]\n\
         p = {{ from = [\"X\", \"Y\"], to = [\"x\", \"y\"], length = \"5 + u\" }}\n\
         q = {{ from = [\"X + 6\", \"Y\"], to = [\"x\", \"y\"], length = 5 }}\n\
         [guess]\nx = \"X + 3\"\ny = \"Y + 4\"\n[measures]\nx = {{ of = \"x\", take = \"last\" }}\ny = {{ of = \"y\", take = \"last\" }}\n"
    )
}

/// A crank that carries the end of a bar.
fn crank([x, y]: [f64; 2]) -> String {
    format!(
        "units = {{ length = \"m\" }}\nduration = 1\n[parameters]\nX = {x:e}\nY = {y:e}\n[inputs]\nu = \"t\"\n\
         [chains]\ncrank = \"T(X, Y, 0) Rz(2*pi*u) Tx(0.4)\"\n[bars]\n\
         p = {{ from = \"crank\", to = [\"x\", \"y\"], length = 2 }}\n\
         q = {{ from = [\"X + 2\", \"Y\"], to = [\"x\", \"y\"], length = 1.5 }}\n\
         [guess]\nx = \"X + 1\"\ny = \"Y + 1.5\"\n[measures]\nx = {{ of = \"x\", take = \"last\" }}\ny = {{ of = \"y\", take = \"last\" }}\n"
    )
}

/// A cam and its follower, spheres about points that are only apart by little.
fn cam([x, y]: [f64; 2]) -> String {
    format!(
        "units = {{ length = \"m\" }}\nduration = 1\n[parameters]\nX = {x:e}\nY = {y:e}\n[inputs]\nu = \"t\"\n\
         [chains]\ncam = \"T(X, Y, 0) Rz(pi/2*u) Tx(0.1)\"\nfollower = \"T(X + 0.05, Y, 0) Ty(s)\"\n\
         [contacts.c]\nfirst = {{ sphere = {{ radius = 0.5 }}, frame = \"cam\" }}\nsecond = {{ sphere = {{ radius = 0.2 }}, frame = \"follower\" }}\n\
         [guess]\ns = 0.7\n[measures]\nx = {{ of = \"s\", take = \"last\" }}\ny = {{ of = \"s\", take = \"last\" }}\n"
    )
}

struct Row {
    what: &'static str,
    scene: fn([f64; 2]) -> String,
    /// Its last pose, from the place.
    last: fn() -> (f64, f64),
    /// Whether its coordinates are those of the place.
    is_placed: bool,
}

const ROWS: [Row; 3] = [
    Row {
        what: "dyad",
        scene: dyad,
        last: || apex(6.0, 6.0, 5.0),
        is_placed: true,
    },
    Row {
        what: "crank",
        scene: crank,
        last: || {
            let (x, y) = apex(1.6, 2.0, 1.5);
            (x + 0.4, y)
        },
        is_placed: true,
    },
    Row {
        what: "cam",
        scene: cam,
        last: || {
            // The cam's centre is at (0, 0.1).
            let s = 0.1 + (0.7f64 * 0.7 - 0.05 * 0.05).sqrt();
            (s, s)
        },
        is_placed: false,
    },
];

const PLACES: [[f64; 2]; 7] = [
    [0.0, 0.0],
    [1e3, -1e3],
    [3e5, 3e5],
    [-1e5, 2e6],
    [5e5, 5.3e6],
    [5e5, 0.0],
    [0.0, -5.3e6],
];

#[test]
fn mechanisms_move_wherever_they_are() {
    let folder = Workspace::new();
    let mut wrong = Vec::new();
    for Row {
        what,
        scene,
        last,
        is_placed,
    } in &ROWS
    {
        for place in PLACES {
            folder.write("far.toml", scene(place));
            let run = folder.run(&["check", "far.toml", "--json", "r.json"]);
            if run.code != 0 {
                wrong.push(format!("{what} at {place:?}\n{}{}", run.text(), run.stderr));
                continue;
            }
            let report: Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
            let (x, y) = last();
            let far = place[0].abs().max(place[1].abs());
            // A few spacings of coordinates of this size; the dyads stretch them by little.
            let near = 1e-12 + 8.0 * f64::EPSILON * if *is_placed { far } else { 0.0 };
            for (k, known) in [x, y].into_iter().enumerate() {
                let found = report["measures"][k]["value"].as_f64().unwrap();
                let known = known + if *is_placed { place[k] } else { 0.0 };
                if (found - known).abs() > near {
                    wrong.push(format!("{what} at {place:?}: {found} for {known}"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Assemblies are the same, too: two for every dyad.
#[test]
fn assemblies_are_found_wherever_they_are() {
    let folder = Workspace::new();
    for (scene, count) in [(dyad as fn([f64; 2]) -> String, 2), (crank, 2), (cam, 2)] {
        for place in PLACES {
            folder.write("far.toml", scene(place));
            let run = folder
                .run(&["modes", "far.toml", "--json", "m.json"])
                .exits(0);
            let report: Value = serde_json::from_slice(&folder.read("m.json")).unwrap();
            assert_eq!(report["placements"], count, "{place:?}\n{}", run.text());
        }
    }
}

/// Where neighbouring numbers are farther apart than bars may be off, this is the reason that is given.
#[test]
fn places_that_are_too_far_are_called_so() {
    let folder = Workspace::new();
    for scene in [dyad, crank] {
        folder.write("far.toml", scene([1e9, 1e9]));
        let run = folder.run(&["check", "far.toml"]);
        assert_eq!(run.code, 1, "{}", run.text());
        let said = format!("{}{}", run.text(), run.stderr);
        assert!(said.contains("far from the origin"), "{said}");
    }
}
