//! Joints and links of scenes against tables by hand.
#![allow(clippy::unwrap_used, clippy::panic)]

use super::JointKind::*;
use super::{JointKind, Joints};
use crate::diag::Source;
use crate::scene::{Overrides, builtin, load_scene};

fn read(text: &str) -> Joints {
    let source = Source {
        name: "joints".to_owned(),
        text: text.to_owned(),
    };
    let scene = load_scene(&source, &Overrides::default());
    let scene = scene.unwrap_or_else(|e| panic!("{:#?}", e.diagnostics));
    scene.mechanism.joints.clone()
}

fn kinds(joints: &Joints) -> Vec<JointKind> {
    joints.list.iter().map(|joint| joint.kind).collect()
}

/// A scene, its links, and how many joints of each kind it has.
type Counted = (&'static str, usize, &'static [(JointKind, usize)]);

#[test]
fn joints_and_links_of_built_in_scenes() {
    // Name; links, the frame among them; how many joints of which kind.
    let table: [Counted; 10] = [
        ("bennett", 4, &[(Revolute, 4)]),
        ("bricard", 6, &[(Revolute, 6)]),
        ("slider-crank", 4, &[(Revolute, 3), (Prismatic, 1)]),
        ("feeder", 4, &[(Revolute, 3), (Prismatic, 1)]),
        ("dyads", 8, &[(Revolute, 10)]),
        ("peaucellier", 8, &[(Revolute, 10)]),
        ("hooke-joint", 4, &[(Revolute, 4)]),
        (
            "gearshift",
            8,
            &[
                (Cylindrical, 1),
                (Revolute, 4),
                (Universal, 1),
                (Spherical, 4),
            ],
        ),
        (
            "gearshift-left",
            14,
            &[
                (Cylindrical, 1),
                (Revolute, 7),
                (Universal, 4),
                (Spherical, 7),
            ],
        ),
        (
            "twin-steer",
            12,
            &[(Revolute, 6), (Universal, 5), (Spherical, 5)],
        ),
    ];
    for (name, links, wanted) in table {
        let joints = read(&builtin::find_builtin(name).unwrap().text);
        let found = kinds(&joints);
        for (kind, count) in wanted {
            let found = found.iter().filter(|k| *k == kind).count();
            assert_eq!(found, *count, "{name}: {kind:?}");
        }
        let all: usize = wanted.iter().map(|(_, count)| count).sum();
        assert_eq!(
            (joints.links.len(), found.len()),
            (links, all),
            "{name}: {found:?}"
        );
        assert!(joints.closes.iter().all(|closes| *closes), "{name}");
    }
}

/// Chains of a body, with all coordinates as inputs.
fn body(chain: &str) -> Vec<JointKind> {
    let names = ["a", "b", "c", "d", "e", "f"];
    let used = names.iter().filter(|name| chain.contains(*name));
    let inputs: String = used.map(|name| format!("{name} = 0\n")).collect();
    kinds(&read(&format!(
        "duration = 1\n[parameters]\nL = 5\n[inputs]\n{inputs}[[bodies]]\nname = \"x\"\nframe = \"Tz(L) {chain}\"\n"
    )))
}

#[test]
fn motions_in_a_row_are_one_joint_where_their_axes_fit() {
    let cases: [(&str, &[JointKind]); 19] = [
        ("Rz(a)", &[Revolute]),
        ("Tx(e)", &[Prismatic]),
        ("Rz(a) Rx(b)", &[Universal]),
        ("Rz(a) Tz(L) Rx(b)", &[Universal]),
        ("Rz(a) Tx(L) Rx(b)", &[Universal]),
        ("Rz(a) Ty(L) Rx(b)", &[Revolute, Revolute]),
        ("Rz(a) Rz(b)", &[Revolute, Revolute]),
        ("Rz(a) Rx(b) Rz(c)", &[Spherical]),
        ("Rz(a) Rx(1) Rz(b) Rx(1) Rz(c)", &[Spherical]),
        ("Rz(a) Rx(b) Tz(L) Rz(c)", &[Spherical]),
        ("Rz(a) Rx(b) Ty(L) Rz(c)", &[Universal, Revolute]),
        ("Rz(a) Tz(e)", &[Cylindrical]),
        ("Tz(e) Tx(L) Rz(a)", &[Cylindrical]),
        ("Rz(a) Tx(e)", &[Revolute, Prismatic]),
        ("Hz(5, a)", &[Helical]),
        ("Tx(e) Ty(f) Rz(c)", &[Planar]),
        ("Tx(e) Rz(c) Ty(f)", &[Planar]),
        ("Tz(e) Tx(f) Rz(c)", &[Prismatic, Prismatic, Revolute]),
        ("Rx(a) Ry(b) Rz(c) Rx(d)", &[Spherical, Revolute]),
    ];
    for (chain, wanted) in cases {
        assert_eq!(body(chain), wanted, "{chain}");
    }
}

#[test]
fn coordinates_that_stand_elsewhere_part_a_joint() {
    assert_eq!(body("Rz(a) Rx(b) Ty(L) Rz(a + b)"), [Revolute; 3]);
    assert_eq!(body("Rz(a) Rx(a)"), [Revolute; 2]);
    let text = "duration = 1\n[inputs]\nu = 0.1\n[loops]\n\
        A = \"Rx(a) Ry(b) Tz(5) Ry(-b) Rx(-a) Tz(-5) Tx(h)\"\n[equations]\ne = \"a - u\"\n[guess]\nh = 1\n";
    assert!(!kinds(&read(text)).contains(&Universal));
}

#[test]
fn a_loop_that_says_nothing_new_closes_nothing() {
    let crank = "Rz(phi) Tx(40) Rz(a) Tx(80) Rz(b) Tx(-h)";
    let back = "Tx(h) Rz(-b) Tx(-80) Rz(-a) Tx(-40) Rz(-phi)";
    let joints = read(&format!(
        "duration = 1\n[inputs]\nphi = \"t\"\n[loops]\nA = \"{crank}\"\nB = \"{back}\"\n[guess]\nh = 120\n"
    ));
    assert_eq!(joints.closes, [true, false]);
    assert_eq!(joints.list.len(), 4);
}

/// The same links are found whether a body's frame goes one way around a loop or the other.
#[test]
fn links_are_the_same_by_either_way_around_a_loop() {
    let scene = |rod: &str| {
        read(&format!(
            "duration = 1\n[inputs]\nphi = \"t\"\n[loops]\nA = \"Rz(phi) Tx(40) Rz(a) Tx(80) Rz(b) Tx(-h)\"\n[guess]\nh = 120\n\
             [[bodies]]\nname = \"rod\"\nframe = \"{rod}\"\n[[bodies]]\nname = \"crank\"\nframe = \"Rz(phi)\"\n"
        ))
    };
    for rod in [
        "Rz(phi) Tx(40) Rz(a)",
        "Tx(h) Rz(-b)",
        "Tx(h) Rz(-b) Tx(-80) Rz(1)",
    ] {
        let joints = scene(rod);
        assert_eq!(
            joints.between(0, 1).map(|j| j.kind),
            Some(Revolute),
            "{rod}"
        );
        assert_eq!((joints.links.len(), joints.list.len()), (4, 4), "{rod}");
    }
}
