//! A search made visible: the path before and after, the map, the points in between.

use crate::program::Workspace;

#[test]
fn a_search_leaves_its_paths_its_map_and_its_points() {
    let w = Workspace::new();
    let run = w.run(&[
        "optimise",
        "gearshift",
        "--method",
        "nelder-mead",
        "--plot",
        "paths.svg",
        "--map",
        "map.svg",
        "--history",
        "h.csv",
    ]);
    run.exits(0);
    let paths = String::from_utf8(w.read("paths.svg")).unwrap();
    for part in [
        "<title>start</title>",
        "<title>result</title>",
        "stroke-dasharray",
        ">R</text>",
        ">5</text>",
    ] {
        assert!(paths.contains(part), "{part}");
    }
    let history = String::from_utf8(w.read("h.csv")).unwrap();
    let rows: Vec<Vec<f64>> = history
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    assert_eq!(history.lines().next(), Some("iteration,F,L6s,ZR1"));
    assert_eq!(rows[0][2..], [110.0, 270.0], "the start comes first");
    assert!(
        rows.windows(2)
            .all(|pair| pair[1][1] <= pair[0][1] && pair[1][0] >= pair[0][0])
    );
    // What the lecture's method finds from its start.
    let last = &rows[rows.len() - 1];
    assert!((last[1] - 6.50998e-5).abs() < 1e-9, "{last:?}");
    assert!(
        (last[2] - 62.9127).abs() < 1e-3 && (last[3] - 236.431).abs() < 1e-2,
        "{last:?}"
    );
    let map = String::from_utf8(w.read("map.svg")).unwrap();
    assert!(map.contains("points of the search") && map.matches("<polyline").count() > 200);
}

#[test]
fn what_cannot_be_shown_of_a_search_is_said_before_it() {
    let w = Workspace::new();
    for (arguments, words) in [
        (
            &[
                "optimise",
                "gearshift",
                "--vary",
                "L6s,ZR1,L7",
                "--map",
                "m.svg",
            ][..],
            "a map has two variables",
        ),
        (
            &[
                "optimise",
                "torus-torus",
                "--method",
                "minimax",
                "--plot",
                "p.svg",
            ],
            "no plot of a path",
        ),
        (
            &["optimise", "gearshift", "--plot", "p.gif"],
            "unknown kind of plot",
        ),
        (
            &["optimise", "gearshift", "--plot", "a.svg", "--map", "a.svg"],
            "both go to",
        ),
    ] {
        w.run(arguments).exits(2).says(&[words]);
        assert!(w.files().is_empty());
    }
}
