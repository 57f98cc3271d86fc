//! The order of the rooms, and that no files use each other in a circle.

use std::collections::BTreeSet;

use super::graph::{Graph, circles, describe, graph};
use super::source::{Source, sources};

/// The floors of the house, lowest first: folders and files under `src/`. A room uses itself and the rooms of lower
/// floors; rooms of one floor know nothing of each other. A room in a room is named apart.
const FLOORS: &[&[&str]] = &[
    &["sorting.rs"],
    &[
        "diag/", "limits/", "math.rs", "jobs.rs", "weld.rs", "linalg/",
    ],
    &["numbers/"],
    &["intervals/"],
    &["model/"],
    &["geometry/", "distance/"],
    &["scene/"],
    &["kinematics/results/", "kinematics/structure/"],
    // Ball joints are found in a structure and are part of a system.
    &["kinematics/ball/run.rs"],
    &["kinematics/ball/joint.rs"],
    &["kinematics/structure/system.rs"],
    &["kinematics/ball/", "kinematics/loops/"],
    &["kinematics/solve/"],
    &["kinematics/abreast/", "kinematics/rates/"],
    &[
        "kinematics/freedoms/",
        "kinematics/certificate/",
        "kinematics/enclosure/",
    ],
    &["kinematics/assemblies/"],
    &["kinematics/motion/tracker/"],
    &["kinematics/motion/"],
    &["kinematics/measures/"],
    &["kinematics/mod.rs"],
    &["clearance/"],
    &["analysis/"],
    &["render/", "export/", "import/"],
    &["plot/", "staging/", "compare/"],
    &["report/"],
    &["parts/", "sweep/"],
    &["pictures/"],
    &["charts/", "diagram/", "snapshot/"],
    &["page/"],
    &["api/"],
    &["cli/"],
    &["lib.rs", "main.rs"],
];

/// Rooms that use no more of lower floors than this: none of them knows a mechanism.
const NARROW: &[(&str, &[&str])] = &[
    ("numbers/", &["math.rs"]),
    (
        "intervals/",
        &["linalg/", "math.rs", "numbers/", "sorting.rs"],
    ),
    (
        "geometry/",
        &[
            "diag/",
            "limits/",
            "math.rs",
            "sorting.rs",
            "weld.rs",
            "model/shape.rs",
        ],
    ),
    (
        "render/",
        &["limits/", "math.rs", "sorting.rs", "weld.rs", "geometry/"],
    ),
    (
        "export/",
        &["math.rs", "geometry/", "numbers/decimal.rs", "sorting.rs"],
    ),
    ("import/", &["limits/", "sorting.rs"]),
    ("parts/", &["export/", "sorting.rs"]),
    (
        "plot/",
        &[
            "diag/",
            "math.rs",
            "numbers/decimal.rs",
            "render/text/",
            "sorting.rs",
        ],
    ),
    ("compare/", &["import/"]),
];

/// The room of a file and its floor: the longest entry that its name begins with.
fn room(name: &str) -> Option<(&'static str, usize)> {
    let floors = FLOORS.iter().enumerate();
    let rooms = floors.flat_map(|(floor, rooms)| rooms.iter().map(move |room| (*room, floor)));
    rooms
        .filter(|(room, _)| name.starts_with(room))
        .max_by_key(|(room, _)| room.len())
}

/// The arrows that do not lead to a lower floor, and the files without a room.
fn arrows_up(graph: &Graph) -> Vec<String> {
    let mut faults = Vec::new();
    for (file, used) in graph {
        let Some((from, floor)) = room(file) else {
            faults.push(format!("{file}: in no room"));
            continue;
        };
        for other in used {
            if room(other).is_some_and(|(to, below)| to != from && below >= floor) {
                faults.push(format!("{file} uses {other}"));
            }
        }
    }
    faults
}

/// The arrows out of the narrow rooms that lead to other places than theirs.
fn wide_arrows(graph: &Graph) -> Vec<String> {
    let mut faults = Vec::new();
    for (file, used) in graph {
        let narrow = NARROW.iter().find(|(room, _)| file.starts_with(room));
        let Some((room, places)) = narrow else {
            continue;
        };
        let allowed = |other: &&String| {
            let mut all = places.iter().chain([room]);
            all.any(|place| other.starts_with(place))
        };
        let wide = used.iter().filter(|other| !allowed(other));
        faults.extend(wide.map(|other| format!("{file} uses {other}")));
    }
    faults
}

fn all_circles(graph: &Graph) -> Vec<String> {
    let circles = circles(graph);
    circles.iter().map(|c| describe(graph, c)).collect()
}

#[test]
fn rooms_use_lower_rooms_only() {
    let graph = graph(&sources());
    let faults = [arrows_up(&graph), wide_arrows(&graph)].concat();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    let held: BTreeSet<&str> = graph.keys().filter_map(|f| room(f)).map(|r| r.0).collect();
    let named: BTreeSet<&str> = FLOORS.iter().copied().flatten().copied().collect();
    assert_eq!(held, named, "rooms that hold no file");
    let arrows: usize = graph.values().map(BTreeSet::len).sum();
    assert!(arrows > 500, "only {arrows} uses found");
}

#[test]
fn the_map_shows_the_rooms_in_this_order() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/ARCHITECTURE.md");
    let map = std::fs::read_to_string(path).unwrap();
    let mut last = 0;
    for floor in FLOORS {
        // Files of a folder, and the two on top, are not on the map.
        let rooms = floor.iter().filter(|room| {
            let is_file = room.ends_with(".rs");
            !(is_file && (room.contains('/') || matches!(**room, "lib.rs" | "main.rs")))
        });
        let places: Vec<usize> = rooms
            .filter(|room| !room.ends_with("tracker/"))
            .map(|room| map.find(&format!("`src/{room}`")).expect(room))
            .collect();
        assert!(places.iter().all(|place| *place > last), "{floor:?}");
        last = places.into_iter().max().unwrap_or(last);
    }
}

#[test]
fn no_files_go_round_in_a_circle() {
    let faults = all_circles(&graph(&sources()));
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// The graph of a house of some files.
fn house(files: &[(&str, &str)]) -> Graph {
    let source = |(name, text): &(&str, &str)| Source {
        name: (*name).to_owned(),
        text: (*text).to_owned(),
    };
    graph(&files.iter().map(source).collect::<Vec<_>>())
}

#[test]
fn a_planted_arrow_up_is_found() {
    let plant = |line: &str| {
        arrows_up(&house(&[
            ("model/chain.rs", line),
            ("model/mod.rs", "pub mod chain;"),
            ("scene/mod.rs", "pub use file::A;"),
            (
                "scene/file.rs",
                "use crate::model::chain; use crate::model;",
            ),
            ("math.rs", ""),
            ("lib.rs", "pub mod math; pub mod model; pub mod scene;"),
        ]))
    };
    for up in [
        "use crate::scene::A;",
        "use crate::{math::Pose, scene::file::A};",
        "use crate::{\n    math::{self, Pose},\n    scene,\n};",
        "fn a(x: crate::scene::A) {}",
        "fn a() { super::super::scene::file::a() }",
        "use crate::scene as other; fn a() { other::file::a() }",
        "pub use crate::scene::*;",
    ] {
        assert!(!plant(up).is_empty(), "{up}");
    }
    for fine in [
        "use crate::math::Pose;",
        "use super::B;",
        "// crate::scene::A",
        "const A: &str = \"crate::scene::A\";",
        "#[cfg(test)]\nmod tests {\n    use crate::scene::A;\n}",
        "use scene::A;",
    ] {
        assert_eq!(plant(fine), Vec::<String>::new(), "{fine}");
    }
    let homeless = house(&[("attic/a.rs", "")]);
    assert_eq!(arrows_up(&homeless), ["attic/a.rs: in no room"]);
    let wide = house(&[
        (
            "plot/a.rs",
            "use crate::model::B; use crate::render::text::Face;",
        ),
        ("model/mod.rs", ""),
        ("render/text/mod.rs", ""),
    ]);
    assert_eq!(wide_arrows(&wide), ["plot/a.rs uses model/mod.rs"]);
    let twins = house(&[("math.rs", "use crate::weld::A;"), ("weld.rs", "")]);
    assert_eq!(arrows_up(&twins), ["math.rs uses weld.rs"]);
}

#[test]
fn a_planted_circle_is_found() {
    let two = house(&[
        ("a/b.rs", "use super::c::C;"),
        ("a/c.rs", "fn f() { super::b::g() }"),
        ("a/mod.rs", "pub mod b; pub mod c;"),
    ]);
    let found = all_circles(&two);
    assert_eq!(
        found,
        ["circle of 2 files:\n  a/b.rs -> a/c.rs\n  a/c.rs -> a/b.rs"]
    );
    // Through an item that `mod.rs` hands on.
    let three = |of_b: &str| {
        house(&[
            ("a/mod.rs", "mod b;\nmod c;\npub use c::C;"),
            ("a/b.rs", of_b),
            ("a/c.rs", "use super::b;"),
        ])
    };
    assert_eq!(circles(&three("use crate::a::C;"))[0].len(), 3);
    assert!(circles(&three("use crate::math::Pose;")).is_empty());
}
