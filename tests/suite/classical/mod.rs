//! Classical mechanisms against the answers that books know, as one table. The answers are computed here, by formulas and
//! constructions that share no code with the engine; `docs/classical.md` is printed from the same rows.

mod couplings;
mod manipulators;
mod motion;
mod plane;
mod rings;
mod space;
mod straight_lines;
mod transmissions;

use crate::driven::Driven;
use mechanim::kinematics::freedoms::mobility::Mobility;
use mechanim::kinematics::results::certificate::Certificate;
use motion::{Motion, Proof, Row};
use std::collections::BTreeSet;
use std::fmt::Write;

fn rows() -> Vec<Row> {
    let groups = [
        straight_lines::rows(),
        transmissions::rows(),
        couplings::rows(),
        rings::rows(),
        manipulators::rows(),
    ];
    groups.into_iter().flatten().collect()
}

#[test]
fn every_row_has_the_known_answer() {
    let wrong: Vec<String> = rows().iter().flat_map(wrong_answers).collect();
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

/// What differs from the row.
fn wrong_answers(row: &Row) -> Vec<String> {
    let motion = Motion::of(row);
    if motion.trajectory.missing() > 0 {
        return vec![format!("{}: {:?}", row.name, motion.trajectory.events)];
    }
    let mut wrong = Vec::new();
    for (what, found, known) in (row.answers)(&motion) {
        let error = (found - known).abs();
        if error.is_nan() || error > row.within {
            wrong.push(format!("{what}: {found}, known {known}, off {error:e}"));
        }
    }
    wrong.extend(proof_fault(row, &motion));
    wrong.extend(freedom_fault(row, &motion));
    wrong.extend(assemblies_fault(row, &motion));
    let named = |fault: String| format!("{}: {fault}", row.name);
    wrong.into_iter().map(named).collect()
}

/// Every pose is proved, in the way that the row says.
fn proof_fault(row: &Row, motion: &Motion) -> Option<String> {
    let refused = motion.trajectory.poses().find(|pose| {
        let certificate = pose.certificate;
        let is_as_said = match row.proof {
            Proof::Certified => matches!(certificate, Certificate::Certified { .. }),
            Proof::Consistent => matches!(certificate, Certificate::Consistent { .. }),
        };
        !is_as_said || certificate.bounds().is_none_or(|b| b[0] > row.within)
    });
    refused.map(|pose| format!("{:?}", pose.certificate))
}

/// Mobility by count of joints, and by rank.
fn freedom_fault(row: &Row, motion: &Motion) -> Option<String> {
    let system = motion.model.system().unwrap();
    let mobility = Mobility::new(&system, &motion.model.actuation);
    let found = (
        mobility.count.freedoms(),
        mobility.generic.map(|n| n.mobility),
    );
    let known = (row.count, Some(row.rank));
    (found != known).then(|| format!("mobility {found:?}, known {known:?}"))
}

fn assemblies_fault(row: &Row, motion: &Motion) -> Option<String> {
    let known = row.assemblies?;
    let found = motion.modes().placements();
    (found != known).then(|| format!("{found} assemblies, known {known}"))
}

#[test]
fn names_are_unlike_and_there_are_enough() {
    let rows = rows();
    let names: BTreeSet<&str> = rows.iter().map(|row| row.name).collect();
    assert_eq!(names.len(), rows.len());
    assert!(rows.len() >= 20);
}

/// A number that is off by more than the tolerance is seen, whatever row it is in.
#[test]
fn a_wrong_dimension_is_found_in_every_row() {
    for row in rows() {
        let Some((from, to)) = row.planted else {
            continue;
        };
        let scene = row.scene.replace(from, to);
        assert_ne!(scene, row.scene, "{}", row.name);
        let faulty = Row { scene, ..row };
        assert!(!wrong_answers(&faulty).is_empty(), "{}", faulty.name);
    }
}

const HEAD: &str = "# Classical mechanisms

Mechanisms with textbook answers, compared with those of mechanim. `tests/suite/classical` solves every row, computes the known answer
with formulas of its own, and compares this page with its table. *Within* is a bound on the difference of every number of the row (lengths
of the order of 1 to 100, angles in radians) and on the proved error. *Freedoms* are determined by counting joints and by
rank; *assemblies* are those that `mechanim modes` finds at the first sample. Years are those of the first publication.

| mechanism | source | known answer | within | freedoms | assemblies | proof |
|---|---|---|---|---|---|---|
";

const NOTES: &str = "
## Errata

* Norton's table of Hoecken linkages prints the coupler ratio of its first row rounded to 3.963. With this value the
  coupler point deviates by 0.00036 % of the travel, not by the printed 0.00001 %; with 3.9625 it is 0.0000105 %. The other rows of our table
  agree with the printed numbers.
";

#[test]
fn the_document_is_this_table() {
    let mut text = HEAD.to_owned();
    for row in rows() {
        let assemblies = row.assemblies.map_or("–".to_owned(), |n| n.to_string());
        let proof = match row.proof {
            Proof::Certified => "certified",
            Proof::Consistent => "consistent",
        };
        writeln!(
            text,
            "| {} | {} | {} | {:.0e} | {} / {} | {assemblies} | {proof} |",
            row.name, row.source, row.answer, row.within, row.count, row.rank
        )
        .unwrap();
    }
    text += NOTES;
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/classical.md");
    if std::env::var_os("UPDATE_DOCUMENT").is_some() {
        std::fs::write(path, &text).unwrap();
    }
    let printed = std::fs::read_to_string(path).unwrap_or_default();
    assert!(
        printed == text,
        "docs/classical.md is out of date: run this test with UPDATE_DOCUMENT=1"
    );
}
