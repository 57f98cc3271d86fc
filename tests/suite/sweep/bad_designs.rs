//! Designs that cannot be meant, and places that cannot be written to: refused before anything is computed.

use super::run;
use crate::program::Workspace;

#[test]
fn designs_that_cannot_be_meant_are_refused() {
    let space = Workspace::new();
    for (design, why) in [
        ("grid:crank=50..20:5", "reversed"),
        ("grid:crank=20..50", "number of values"),
        ("grid:crank=nan..50:5", "not a finite number"),
        ("grid:crank=0..1e400:5", "not a finite number"),
        ("lhs:1e19,crank=1..2", "whole number"),
        ("lhs:10000000000000000000,crank=1..2", "whole number"),
        ("sobol:0,crank=1..2", "whole number"),
        ("grid:crank=1..2:1e9,ex=0..1:1e9", "more than"),
        ("lhs:8", "needs parameters"),
        ("grid:crnak=20..50:5", "no such parameter"),
        ("nowhere.csv", "cannot read"),
        ("grid", "cannot read"),
    ] {
        let line = format!("sweep four-bar --design {design} --outputs K.x --out rows.csv");
        run(&space, &line).exits(2).says(&[why]);
    }
    let line = "sweep four-bar --design grid:crank=1..2:3 --outputs K.w --out rows.csv";
    run(&space, line)
        .exits(2)
        .says(&["no value `K.w`", "`K.z`"]);
    let line = "sweep four-bar --design grid:crank=1..2:3 --out rows.csv";
    run(&space, line).exits(2).says(&["no `[measures]`"]);
    let line = "sweep gearshift --design grid:ZR1=100..300:3 --out rows.csv";
    run(&space, line)
        .exits(2)
        .says(&["the scene's study allows 200 to 340"]);
    let line = "sweep gearshift --design grid:ZR1=240..300:3 --out rows.ods";
    run(&space, line).exits(2).says(&["unknown kind of table"]);
    // A variable whose value is zero has no range of its own, and is not left out without a word.
    let text = "duration = 1\n[parameters]\na = 2\nb = 0\n[inputs]\np = \"t + a + b\"\n[equations]\ne = \"x - p - a - b\"\n\
                [measures]\nm = { of = \"x\", take = \"last\" }\n[study.variables]\na = {}\nb = {}\n";
    space.write("zero.toml", text.replace("t + a + b", "t"));
    for design in ["lhs:3", "grid:b:2"] {
        let line = format!("sweep zero.toml --design {design} --out rows.csv");
        run(&space, &line).exits(2).says(&["b", "range"]);
    }
    run(&space, "sweep zero.toml --design lhs:3,a,b=0..1 --out -").exits(0);
    std::fs::remove_file(space.path("zero.toml")).unwrap();
    if cfg!(not(feature = "parquet")) {
        let line = "sweep gearshift --design grid:ZR1=240..300:3 --out rows.parquet";
        run(&space, line).exits(2).says(&["built without Parquet"]);
    }
    let line = "sweep four-bar --design grid:crank=1..2:3 --outputs K.x --inputs t.csv";
    run(&space, line)
        .exits(2)
        .says(&["--input-table cannot be used"]);
    assert!(space.files().is_empty(), "{:?}", space.files());
}

#[test]
fn tables_that_cannot_be_meant_are_refused() {
    let space = Workspace::new();
    for (table, why) in [
        ("crank,crnk\n30,1\n", "no such parameter"),
        ("crank\nnan\n", "finite"),
        ("crank\ninf\n", "finite"),
        ("crank\n\"\"\n", "empty"),
        (
            "crank,ex\n30\n",
            "designs.csv:2:3: 1 cell where the header has 2",
        ),
        (
            "crank,crank\n30,31\n",
            "designs.csv:1:7: there are two columns `crank`",
        ),
        (
            "crank,\n30,31\n",
            "designs.csv:2:4: 2 cells where the header has 1",
        ),
        (",crank\n30,31\n", "designs.csv:1:1: column 1 has no name"),
        ("crank\nlong\n", "a cell must be a number"),
        (
            "crank\nlong\n",
            "designs.csv:2:1: `long` is not a value for `crank`",
        ),
        ("crank\n", "no rows"),
        ("", "designs.csv is empty"),
    ] {
        space.write("designs.csv", table);
        let line = "sweep four-bar --design designs.csv --outputs K.x --out rows.csv";
        run(&space, line).exits(2).says(&[why]);
    }
    space.write("designs.csv", "crank;ex\n30,5;1\n31;2,5\n");
    let line = "sweep four-bar --design designs.csv --outputs K.x --at 0 --out -";
    let text = run(&space, line).exits(0).text();
    assert!(
        text.contains("\n0,ok,1,30.5,1,") && text.contains("\n1,ok,1,31,2.5,"),
        "{text}"
    );
    // Spreadsheets write an empty last column.
    space.write("designs.csv", "crank;ex;\n30,5;1;\n31;2,5;\n");
    assert_eq!(run(&space, line).exits(0).text(), text);
}

#[test]
fn folders_that_are_something_else_are_refused() {
    let space = Workspace::new();
    let sweep = "sweep four-bar --design grid:crank=30..35:3 --outputs K.x";
    std::fs::create_dir(space.path("rows.csv.parts")).unwrap();
    let line = format!("{sweep} --out rows.csv --resume");
    run(&space, &line)
        .exits(2)
        .says(&["no sweep that could be continued"]);
    let line = format!("{sweep} --out rows.csv");
    run(&space, &line).exits(2).says(&["left from a run"]);
    run(&space, "study run rows.csv.parts")
        .exits(2)
        .says(&["is not a study"]);
    space.write("plan.json", "{}");
    run(&space, "study run .").exits(2).says(&["is not a plan"]);
    let line = format!("{sweep} --out nowhere/rows.csv");
    run(&space, &line).exits(2).says(&["nowhere"]);
}

/// A folder that a run of other arguments, another scene or another version has left.
#[test]
fn nothing_goes_on_with_the_rows_of_another_study() {
    let space = Workspace::new();
    let plan = "study plan sweep four-bar --design grid:crank=30..35:3 --outputs K.x --units 3";
    run(&space, &format!("{plan} --out rows.csv.parts")).exits(0);
    let other = "sweep four-bar --design grid:crank=30..35:4 --outputs K.x --out rows.csv --resume";
    run(&space, other).exits(2).says(&["rows of another scene"]);
    run(&space, &format!("{plan} --out rows.csv.parts"))
        .exits(2)
        .says(&["exists already"]);
    let path = space.path("rows.csv.parts/plan.json");
    let text = std::fs::read_to_string(&path).unwrap();
    let version = format!("\"version\": \"{}\"", env!("CARGO_PKG_VERSION"));
    assert!(text.contains(&version));
    std::fs::write(&path, text.replace(&version, "\"version\": \"0.0.7\"")).unwrap();
    run(&space, "study run rows.csv.parts")
        .exits(2)
        .says(&["planned by version 0.0.7"]);
    std::fs::write(&path, &text).unwrap();
    let scene = space.path("rows.csv.parts/scene.toml");
    let changed = std::fs::read_to_string(&scene)
        .unwrap()
        .replace("crank = 35", "crank = 36");
    std::fs::write(&scene, changed).unwrap();
    run(&space, "study run rows.csv.parts")
        .exits(2)
        .says(&["rows of another scene"]);
}
