//! Rows are what the scene gives with these values, whichever thread makes them.

use super::{SWEEP, cells, column, run};
use crate::program::{LEAVES, STILL, Workspace};
use mechanim::study::ToleranceOptions;
use mechanim::{Samples, Scene};

fn number(cell: &str) -> f64 {
    cell.parse().expect(cell)
}

#[test]
fn values_are_those_of_the_scene_with_these_parameters() {
    let space = Workspace::new();
    let line = "sweep four-bar --design grid:crank=20..50:3,ex=0..90:3 --outputs K.x,mu --at 0,1.3,2 --out rows.csv";
    run(&space, line).exits(0);
    let table = cells(&space.read("rows.csv"));
    assert_eq!(table.len(), 10);
    assert_eq!(column(&table, "status"), ["ok"; 9]);
    assert_eq!(column(&table, "unproved"), ["0"; 9]);
    let scene = Scene::builtin("four-bar").unwrap();
    for row in 0..9 {
        let cell = |name: &str| number(&column(&table, name)[row]);
        let own = scene.with_parameter("crank", cell("crank")).unwrap();
        let own = own.with_parameter("ex", cell("ex")).unwrap();
        let motion = own.solve(Samples::At(vec![0.0, 1.3, 2.0])).unwrap();
        for name in ["K.x", "mu"] {
            let values = motion.values(name).unwrap();
            for (time, value) in ["0", "1.3", "2"].iter().zip(values) {
                let found = cell(&format!("{name}@{time}"));
                assert!(
                    (found - value).abs() < 1e-9,
                    "{row} {name}: {found} {value}"
                );
            }
        }
        assert!(cell("error_bound") > 0.0 && cell("error_bound") < 1e-9);
    }
}

#[test]
fn measures_are_those_of_a_study() {
    let space = Workspace::new();
    let line = "sweep gearshift --design grid:ZR1=250..290:3,L6s=90..130:2 --out rows.csv";
    run(&space, line).exits(0);
    let table = cells(&space.read("rows.csv"));
    let options = ToleranceOptions {
        tolerance: Some(1e-6),
        pieces: 1,
        ..Default::default()
    };
    let scene = Scene::builtin("gearshift").unwrap();
    for row in [0, 5] {
        let cell = |name: &str| number(&column(&table, name)[row]);
        let own = scene.with_parameter("ZR1", cell("ZR1")).unwrap();
        let own = own.with_parameter("L6s", cell("L6s")).unwrap();
        let study = own.study().vary(&["ZR1"]).tolerance(&options).unwrap();
        for measure in study.measures() {
            let found = cell(&measure.name);
            let off = (found - measure.nominal).abs();
            assert!(off < 1e-8 * (1.0 + found.abs()), "{} {off}", measure.name);
        }
    }
}

/// Bytes do not depend on threads, nor on whether they go through a file.
#[test]
fn bytes_are_the_same_on_any_number_of_threads() {
    let space = Workspace::new();
    let designs = [
        SWEEP,
        "four-bar --design lhs:300,crank=20..40,ey=10..60 --outputs K.x --samples 9 --seed 5",
        "gearshift --design sobol:64",
    ];
    for design in designs {
        let one = run(&space, &format!("sweep {design} --threads 1 --out -")).exits(0);
        for threads in [2, 5] {
            let line = format!("sweep {design} --threads {threads} --out rows.csv");
            run(&space, &line).exits(0);
            assert!(space.read("rows.csv") == one.stdout, "{design} {threads}");
        }
        let line = format!("sweep {design} --threads 3 --out rows.jsonl");
        run(&space, &line).exits(0);
        let text = String::from_utf8(space.read("rows.jsonl")).unwrap();
        let rows: Vec<serde_json::Value> = text
            .lines()
            .map(|l| serde_json::from_str(l).unwrap())
            .collect();
        let table = cells(&one.stdout);
        assert_eq!(rows.len(), table.len() - 1);
        for (k, row) in rows.iter().enumerate() {
            assert_eq!(row["design"], k as u64);
            assert_eq!(row["status"], column(&table, "status")[k].as_str());
        }
        assert_eq!(space.files(), ["rows.csv", "rows.jsonl"]);
    }
}

/// A crank of 80: closes up to 1.2 rad only with a rod of at least 74.6.
#[test]
fn a_design_that_does_not_close_says_so() {
    let space = Workspace::new();
    let text = LEAVES.replace("[inputs]", "[parameters]\nrod = 60\n[inputs]");
    space.write("leaves.toml", text.replace("Tx(60)", "Tx(rod)"));
    let line =
        "sweep leaves.toml --design grid:rod=70..80:11 --outputs h --samples 5 --out rows.csv";
    run(&space, line).exits(0);
    let table = cells(&space.read("rows.csv"));
    for (rod, status) in column(&table, "rod").iter().zip(column(&table, "status")) {
        let closes = number(rod) > 80.0 * 1.2_f64.sin();
        assert_eq!(status, if closes { "ok" } else { "not-closed" }, "{rod}");
    }
    // Values that there are stand there, the others are empty.
    assert!(column(&table, "h@0").iter().all(|h| !h.is_empty()));
    assert_eq!(column(&table, "h@1")[0], "");
    assert_eq!(column(&table, "feasible")[0], "0");
}

/// A rod of negative length is the other assembly by its numbers; on the way there the loop opens.
#[test]
fn no_row_is_silently_of_another_assembly() {
    let space = Workspace::new();
    let text = STILL.replace("[inputs]", "[parameters]\nrod = 80\n[inputs]");
    space.write("still.toml", text.replace("Tx(80)", "Tx(rod)"));
    let line = "sweep still.toml --design grid:rod=-80..80:5 --outputs h --at 0 --out rows.csv";
    run(&space, line).exits(0);
    let table = cells(&space.read("rows.csv"));
    let status = column(&table, "status");
    assert_eq!(status[3..], ["ok", "ok"]);
    assert!(["not-closed", "undecided"].contains(&status[2].as_str()));
    for word in &status[..2] {
        assert!(
            ["other-branch", "not-reached"].contains(&word.as_str()),
            "{word}"
        );
    }
}

/// A parameter in the drive is read anew for every row.
#[test]
fn a_parameter_of_the_drive_counts() {
    let space = Workspace::new();
    let text = STILL.replace("phi = 0.3", "phi = \"top*t\"");
    space.write(
        "still.toml",
        text.replace(
            "[inputs]",
            "duration = 1\n[parameters]\ntop = 0.3\n[inputs]",
        ),
    );
    let line =
        "sweep still.toml --design grid:top=0.1..0.7:3 --outputs phi,h --at 1 --out rows.csv";
    run(&space, line).exits(0);
    let table = cells(&space.read("rows.csv"));
    for (top, h) in column(&table, "top").iter().zip(column(&table, "h@1")) {
        let phi = number(top);
        let wanted = 40.0 * phi.cos() + (6400.0 - (40.0 * phi.sin()).powi(2)).sqrt();
        assert!((number(&h) - wanted).abs() < 1e-9, "{top}: {h} {wanted}");
    }
    assert_eq!(column(&table, "phi@1"), column(&table, "top"));
}

#[test]
fn a_check_of_a_design_is_that_of_the_program() {
    let space = Workspace::new();
    let line = "sweep four-bar --design grid:crank=25..47:3 --check --out rows.csv";
    run(&space, line).exits(0);
    let table = cells(&space.read("rows.csv"));
    for (crank, passed) in column(&table, "crank").iter().zip(column(&table, "passed")) {
        let code = run(&space, &format!("check four-bar --param crank={crank}")).code;
        assert_eq!(passed == "1", code == 0, "{crank}: {passed} {code}");
    }
    let [found, proved] = ["clearance_margin", "proved_margin"].map(|name| column(&table, name));
    // Where bodies are in each other nothing is proved of their distance.
    for (found, proved) in found.iter().zip(proved).filter(|(_, p)| !p.is_empty()) {
        assert!(number(&proved) <= number(found));
    }
}

#[test]
fn plots_are_curves_and_maps() {
    let space = Workspace::new();
    let curve = "sweep gearshift --design grid:ZR1=220..300:9 --plot curve.svg --only d_R1";
    let out = run(&space, curve).exits(0);
    assert!(out.text().contains("9 designs: 9 ok"), "{}", out.text());
    let text = String::from_utf8(space.read("curve.svg")).unwrap();
    assert!(text.contains("<svg") && text.contains("ZR1") && text.contains("d_R1"));
    let map = format!("sweep {SWEEP} --plot map.svg --only K.x@0");
    run(&space, &map).exits(0);
    let text = String::from_utf8(space.read("map.svg")).unwrap();
    assert!(
        text.matches("<rect").count() > 400,
        "{}",
        text.matches("<rect").count()
    );
    let three =
        "sweep four-bar --design sobol:8,crank=30..35,ex=0..9,ey=0..9 --outputs K.x --plot a.svg";
    run(&space, three).exits(2).says(&["one or two parameters"]);
}

/// An offset crank with a rod so short that the crank just turns: at some angles both assemblies are near.
const SHORT_ROD: &str = r#"units = { length = "mm", angle = "deg" }
duration = 4
[parameters]
L = 61
[inputs]
phi = "1+90*t"
[chains]
c = "Rz(phi) Tx(40) Rz(a) Tx(L) Rz(b)"
[loops]
A = "c inv(Tx(h) Ty(20))"
[guess]
h = 90
[measures]
ends = { of = "h", take = "change" }
"#;

#[test]
fn instants_lie_on_the_motion_from_the_start_of_the_drive() {
    let space = Workspace::new();
    space.write("s.toml", SHORT_ROD);
    // On the assembly with the slider on the positive side: h = x + sqrt(L² - (20 - y)²) at the crank's end (x, y).
    let truth = |time: f64, rod: f64| {
        let (y, x) = (1.0 + 90.0 * time).to_radians().sin_cos();
        let (x, y) = (40.0 * x, 40.0 * y);
        x + (rod * rod - (20.0 - y) * (20.0 - y)).sqrt()
    };
    for unproved in ["", " --unproved"] {
        for time in [1.0, 3.0, 3.5] {
            let line = format!(
                "sweep s.toml --design grid:L=61..70:4 --outputs h --at {time} --out rows.csv{unproved}"
            );
            run(&space, &line).exits(0);
            let table = cells(&space.read("rows.csv"));
            for row in 0..4 {
                let rod = number(&column(&table, "L")[row]);
                let found = number(&column(&table, &format!("h@{time}"))[row]);
                assert!(
                    (found - truth(time, rod)).abs() < 1e-9,
                    "{line}: {rod} {found}"
                );
            }
        }
    }
    // Nothing is told of motions that end: with this rod the crank does not pass 270°.
    run(&space, "sweep s.toml --design grid:L=59.99 --out rows.csv");
    let table = cells(&space.read("rows.csv"));
    assert_eq!(column(&table, "status"), ["not-closed"]);
    assert_eq!(column(&table, "ends"), [""]);
}

/// The columns that tables have besides a scene's names, as they are written, are names that no scene may give.
#[test]
fn columns_of_tables_are_no_names() {
    let space = Workspace::new();
    let lines = [
        "solve bennett --samples 3 --certify motion --out t.csv",
        "sweep bennett --design grid:a=100 --outputs t2 --at 0 --out t.csv",
        "sweep four-bar --design grid:crank=30 --check --out t.csv",
        "tolerance gearshift --tolerance 0.1 --pieces 2 --csv t.csv",
    ];
    let mut tried = 0;
    for line in lines {
        run(&space, line);
        let scene = line.split(' ').nth(1).unwrap();
        let text = run(&space, &format!("new copy.toml --from {scene}"));
        text.exits(0);
        let own = String::from_utf8(space.read("copy.toml")).unwrap();
        std::fs::remove_file(space.path("copy.toml")).unwrap();
        for column in &cells(&space.read("t.csv"))[0] {
            let is_word = column.chars().all(|c| c.is_alphanumeric() || c == '_');
            let is_own = own
                .split(|c: char| !c.is_alphanumeric() && c != '_')
                .any(|w| w == column);
            if !is_word || is_own {
                continue;
            }
            tried += 1;
            space.write(
                "n.toml",
                format!("[parameters]\n{column} = 2\n[loops]\nA = \"Tx({column}) Tx(-x)\"\n"),
            );
            run(&space, "check n.toml")
                .exits(2)
                .says(&["is a column of tables"]);
        }
    }
    assert!(tried > 20, "{tried}");
}
