//! Rows of eight designs at once: what the rows with certificates say, whatever stands beside them.

use super::{cells, column, run};
use crate::program::Workspace;

/// Designs of which many do not close.
const WIDE: &str =
    "four-bar --design grid:crank=20..150:14,ex=0..90:5 --outputs K.x,K.y --samples 24";

fn rows(space: &Workspace, rest: &str) -> Vec<u8> {
    run(space, &format!("sweep {rest} --out -")).exits(0).stdout
}

/// A four-bar that turns for all its numbers, whose rocker has a kink on the way from the file's values to half of the
/// designs, with measures along a track that begins elsewhere than the drive, along the drive, and of other measures.
const KINKED: &str = r#"
duration = 1
units = { length = "m", angle = "deg" }
[parameters]
x = 3
coupler = 2.6
share = 0.5
rocker = "abs(x - coupler) + 1 + 2*share*(min(x, coupler) - 1)"
[inputs]
phi = "360*t"
[loops]
A = "Rz(phi) Tx(1) Rz(alpha) Tx(coupler) Rz(mu) inv(Tx(x) Rz(psi) Tx(rocker))"
[guess]
alpha = 60
psi = 90
mu = 70
[tracks]
half = { samples = 90, inputs = { phi = [40, 220] } }
[measures]
swing = { track = "half", of = "psi", take = "range" }
transmission = { of = "abs(sin(mu))", take = "min", min = 0.3 }
both = "swing*transmission"
"#;

/// What a table says, and what the same says without certificates; the least number of rows made side by side.
fn compared(space: &Workspace, line: &str, poses: usize, least: usize) -> Vec<Vec<String>> {
    let proved = cells(&rows(space, line));
    let unproved = cells(&rows(space, &format!("{line} --unproved")));
    assert_eq!(proved[0], unproved[0]);
    let [status, feasible] = ["status", "feasible"].map(|name| column(&proved, name));
    assert_eq!(column(&unproved, "status"), status);
    assert_eq!(column(&unproved, "feasible"), feasible);
    let last = proved[0].len() - 3;
    let mut quick = 0;
    for (a, b) in proved[1..].iter().zip(&unproved[1..]) {
        let number = |cell: &String| cell.parse::<f64>().unwrap_or(f64::NAN);
        if b[last + 1].is_empty() && b[1] == "ok" {
            quick += 1;
            assert_eq!(b[last + 2], poses.to_string());
            assert!(number(&b[last]) < 1e-13, "{}", b[last]);
            for (a, b) in a[3..last].iter().zip(&b[3..last]) {
                let (a, b) = (number(a), number(b));
                assert!((a - b).abs() <= 1e-10 * a.abs().max(1.0), "{a} {b}");
            }
        } else {
            // Left to the ordinary way, with its certificates.
            assert_eq!(a, b);
        }
    }
    assert!(quick >= least, "{line}: {quick}");
    proved
}

#[test]
fn rows_without_certificates_say_what_the_others_say() {
    let space = Workspace::new();
    let proved = compared(&space, WIDE, 24, 10);
    assert_eq!(proved.len(), 71);
    let status = column(&proved, "status");
    assert!(status.iter().any(|s| s == "not-closed"), "{status:?}");
}

#[test]
fn measures_without_certificates_are_what_the_others_are() {
    let space = Workspace::new();
    space.write("kinked.toml", KINKED);
    let line = "kinked.toml --design lhs:60,x=1.2..6,coupler=1.2..6,share=0.05..0.95 --samples 50";
    let proved = compared(&space, line, 140, 55);
    let feasible = column(&proved, "feasible");
    for word in ["0", "1"] {
        assert!(feasible.iter().any(|f| f == word), "{feasible:?}");
    }
}

/// A dimension that jumps, however little, is not passed on the way to a design.
#[test]
fn jumps_are_not_passed_without_certificates() {
    let space = Workspace::new();
    for jump in [
        "0.001*floor(p)",
        "15*floor(p)",
        "0.001*mod(p, 1)",
        "0.1*atan2(sin(p), cos(p))",
    ] {
        let text = format!(
            "duration = 1\n[parameters]\np = 2.5\nq = 60\n[inputs]\nphi = \"2*pi*t\"\n[loops]\n\
             A = \"Rz(phi) Tx(20) Rz(alpha) Tx(q + {jump}) Rz(mu) Tx(-h)\"\n[guess]\nh = 80\n"
        );
        space.write("jump.toml", text);
        let line = "jump.toml --design lhs:40,p=0..4,q=50..90 --outputs h --samples 12";
        let proved = compared(&space, line, 12, 1);
        let status = column(&proved, "status");
        assert!(status.iter().any(|s| s == "ok"), "{jump}: {status:?}");
        assert!(
            status.iter().any(|s| s == "not-reached"),
            "{jump}: {status:?}"
        );
    }
}

/// What the poses at two samples do not show: a whole turn between them, and a drive that leaves and comes back.
#[test]
fn turns_and_ways_between_samples_are_not_stepped_over() {
    let space = Workspace::new();
    let turn = "duration = 1\nunits = { length = \"m\", angle = \"deg\" }\n[parameters]\np = 0.001\n[inputs]\nphi = \"90+360*t\"\n\
         [loops]\nA = \"Rz(phi) Tx(1) Rz(a) Tx(3) Rz(m) inv(Tx(3) Rz(psi) Tx(1+p))\"\n[guess]\na = -90\nm = 90\npsi = 90\n\
         [tracks]\nturn = { samples = 2, inputs = { phi = [90, 450] } }\n\
         [measures]\nend = { track = \"turn\", of = \"psi\", take = \"last\" }\n";
    space.write("turn.toml", turn);
    compared(&space, "turn.toml --design grid:p=0.002..0.02:7", 3, 0);
    let back = "duration = 1\n[parameters]\np = 0.5\n[inputs]\nh = \"3 + 2*sin(2*pi*t)\"\n[loops]\n\
         A = \"Rz(phi) Tx(1.4 + 0.01*p) Rz(alpha) Tx(2.5) Rz(mu) Tx(-h)\"\n[guess]\nphi = 0.9\n";
    space.write("back.toml", back);
    let line = "back.toml --design grid:p=0..1:3 --outputs phi --samples 2";
    let proved = compared(&space, line, 2, 0);
    assert_eq!(column(&proved, "status"), ["not-closed"; 3]);
}

#[test]
fn rows_do_not_depend_on_threads_company_and_cuts() {
    let space = Workspace::new();
    let line = format!("{WIDE} --unproved");
    let whole = rows(&space, &line);
    for threads in [1, 2, 7] {
        assert!(rows(&space, &format!("{line} --threads {threads}")) == whole);
    }
    for units in [7, 64] {
        let space = Workspace::new();
        let plan = format!("study plan sweep {line} --units {units} --out study");
        run(&space, &plan).exits(0);
        run(&space, "study run study").exits(0);
        run(&space, "study merge study --out rows.csv").exits(0);
        assert!(space.read("rows.csv") == whole, "{units}");
    }
    // Backwards, so that everybody has other neighbours in other lanes; and one by itself.
    let table = cells(&whole);
    let designs: Vec<String> = table[1..]
        .iter()
        .map(|row| format!("{},{}", row[3], row[4]))
        .collect();
    let backwards: Vec<&str> = designs.iter().rev().map(String::as_str).collect();
    space.write("back.csv", format!("crank,ex\n{}\n", backwards.join("\n")));
    let asked = "--outputs K.x,K.y --samples 24 --unproved";
    let found = cells(&rows(
        &space,
        &format!("four-bar --design back.csv {asked}"),
    ));
    for (row, other) in table[1..].iter().zip(found[1..].iter().rev()) {
        assert_eq!(row[1..], other[1..]);
    }
    space.write("one.csv", format!("crank,ex\n{}\n", designs[3]));
    let one = cells(&rows(&space, &format!("four-bar --design one.csv {asked}")));
    assert_eq!(one[1][1..], table[4][1..]);
}

/// Certificates are left out of values only: a check is nothing without them.
#[test]
fn certificates_of_checks_cannot_be_left_out() {
    let space = Workspace::new();
    let line = "sweep gearshift --design lhs:2 --check --unproved --out rows.csv";
    run(&space, line).exits(2).says(&["--check", "--unproved"]);
    let line = "sweep four-bar --design lhs:9,crank=20..40 --outputs K.x --samples 30 --unproved";
    let text = run(&space, line).exits(0).text();
    assert!(
        text.contains("no certificates, 270 poses not proved"),
        "{text}"
    );
}
