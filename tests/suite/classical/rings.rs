//! Over-constrained rings: they move although the count says that they cannot.

use super::motion::{Proof, Row, turned};
use super::space::{Vector, dot, turn};
use std::f64::consts::{FRAC_PI_2, PI};

pub fn rows() -> Vec<Row> {
    vec![goldberg(), myard(), schatz(), line_symmetric()]
}

/// What neighbouring angles of a Bennett ring with twists `a` and `b` are tied by: the product of their tangents.
fn bennett(a: f64, b: f64) -> f64 {
    (0.5 * (b + a)).sin() / (0.5 * (b - a)).sin()
}

fn tangent(angle: f64) -> f64 {
    (0.5 * angle).tan()
}

fn goldberg() -> Row {
    Row {
        scene: "units = { length = \"m\", angle = \"deg\" }\nduration = 4\n[inputs]\nt1 = \"60 + 60*t/4\"\n[loops]\n\
            G = \"Rz(t1) Tx(1) Rx(30) Rz(t2) Tx(sqrt(3)) Rx(60) Rz(s) Tx(sqrt(2)) Rx(45) Rz(u2) Tx(1) Rx(30) Rz(u3) Tx(sqrt(2)+sqrt(3)) Rx(105)\"\n\
            [guess]\nt2 = 156\ns = -410\nu2 = 24\nu3 = 174\n"
            .into(),
        count: -1,
        within: 1e-12,
        proof: Proof::Consistent,
        answers: |motion| {
            let (first, second) = (
                bennett(30_f64.to_radians(), 60_f64.to_radians()),
                bennett(30_f64.to_radians(), 45_f64.to_radians()),
            );
            motion.each(|at| {
                let t2 = 2.0 * (first / tangent(at.get("t1"))).atan();
                let u3 = 2.0 * (second / tangent(PI - t2)).atan();
                vec![
                    ("t2", turned(at.get("t2") - t2), 0.0),
                    ("u2", turned(at.get("u2") - (PI - t2)), 0.0),
                    ("u3", turned(at.get("u3") - u3), 0.0),
                    ("s", turned(at.get("s") + at.get("t1") + u3 - PI), 0.0),
                ]
            })
        },
        planted: Some(("Tx(sqrt(2)+sqrt(3))", "Tx(3.14627)")),
        ..Row::new(
            "Goldberg's 5R ring",
            "Goldberg 1943; Bennett 1903",
            "two Bennett rings: tan ½t₁ tan ½t₂ = sin ½(β+α)/sin ½(β−α), and the sums of their angles",
        )
    }
}

fn myard() -> Row {
    Row {
        scene: "duration = 1\n[parameters]\nb = 2\nA = 0.6\na = \"b*sin(A)\"\n[inputs]\nt1 = \"0.8 + t\"\n[loops]\n\
            M = \"Rz(t1) Tx(a) Rx(A) Rz(t2) Tx(b) Rx(pi/2) Rz(t3) Rx(pi-2*A) Rz(t4) Tx(b) Rx(pi/2) Rz(t5) Tx(a) Rx(pi-A)\"\n\
            [guess]\nt2 = 1.8\nt3 = 1.2\nt4 = -2\nt5 = -1.8\n"
            .into(),
        count: -1,
        proof: Proof::Consistent,
        answers: |motion| {
            let product = bennett(0.6, FRAC_PI_2);
            motion.each(|at| {
                let t3 = FRAC_PI_2 - 0.5 * at.get("t1");
                let t2 = 2.0 * (product * tangent(t3)).atan();
                vec![
                    ("t3", turned(at.get("t3") - t3), 0.0),
                    ("t4", turned(at.get("t4") + PI - t3), 0.0),
                    ("t2", turned(at.get("t2") - t2), 0.0),
                    ("t5", turned(at.get("t5") + t2), 0.0),
                ]
            })
        },
        planted: Some(("Rx(pi-2*A)", "Rx(pi-2.0001*A)")),
        ..Row::new(
            "Myard's 5R ring",
            "Myard 1931; Baker 1979",
            "a mirror image of itself: t₃ = ½(π − t₁), tan ½t₂ = tan ½t₃ · sin ½(β+α)/sin ½(β−α), t₅ = −t₂",
        )
    }
}

fn schatz() -> Row {
    Row {
        scene: "duration = 1\n[inputs]\nt1 = \"0.8 + t\"\n[loops]\n\
            S = \"Rz(t1) Rx(pi/2) Rz(t2) Tx(1) Rx(pi/2) Rz(t3) Tx(1) Rx(pi/2) Rz(t4) Tx(1) Rx(pi/2) Rz(t5) Rx(pi/2) Rz(t6) Tx(sqrt(3))\"\n\
            [guess]\nt2 = 2.2\nt3 = -1.8\nt4 = -1.3\nt5 = -0.7\nt6 = 2.7\n"
            .into(),
        count: 0,
        proof: Proof::Consistent,
        answers: |motion| {
            motion.each(|at| {
                let [t1, t3, t6] = ["t1", "t3", "t6"].map(|n| at.get(n));
                // tan t1 tan t6 = −1/2, free of poles.
                let shafts = 2.0 * t1.sin() * t6.sin() + t1.cos() * t6.cos();
                vec![
                    ("shafts", shafts, 0.0),
                    ("middle", t3.cos(), 1.5 * t6.sin().powi(2) - 0.5),
                    ("t5", turned(at.get("t5") + 0.5 * t3 + FRAC_PI_2), 0.0),
                ]
            })
        },
        planted: Some(("Tx(sqrt(3))", "Tx(1.73206)")),
        ..Row::new(
            "Schatz' ring (Turbula)",
            "Schatz 1942; Baker, Duclong and Khoo 1982",
            "tan t₁ tan t₆ = −1/2, cos t₃ = 3/2 sin² t₆ − 1/2, t₅ = −½(t₃ + π)",
        )
    }
}

/// A vector through half of the ring, as of a direction (`is_point` false) or of a point.
fn half_ring(angles: [f64; 3], v: Vector, is_point: bool) -> Vector {
    let links = [(0.3, 1.0, 0.7), (-0.2, 1.3, 1.1), (0.4, 0.9, -0.8)];
    let mut w = v;
    for (angle, (offset, length, twist)) in angles.into_iter().zip(links).rev() {
        w = turn(0, twist, w);
        if is_point {
            w = [w[0] + length, w[1], w[2] + offset];
        }
        w = turn(2, angle, w);
    }
    w
}

fn line_symmetric() -> Row {
    let half = |k: [usize; 3]| {
        format!(
            "Rz(t{}) Tz(0.3) Tx(1) Rx(0.7) Rz(t{}) Tz(-0.2) Tx(1.3) Rx(1.1) Rz(t{}) Tz(0.4) Tx(0.9) Rx(-0.8)",
            k[0], k[1], k[2]
        )
    };
    Row {
        scene: format!(
            "duration = 1\n[inputs]\nt1 = \"0.8 + t/4\"\n[loops]\nL = \"{} {}\"\n\
             [guess]\nt2 = -2.6\nt3 = -1.4\nt4 = 0.8\nt5 = -2.6\nt6 = -1.4\n",
            half([1, 2, 3]),
            half([4, 5, 6])
        ),
        count: 0,
        proof: Proof::Consistent,
        answers: |motion| {
            motion.each(|at| {
                let angles = ["t1", "t2", "t3"].map(|n| at.get(n));
                let image = |v: Vector, is_point| half_ring(angles, v, is_point);
                let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
                let trace: f64 = axes.iter().map(|e| dot(*e, image(*e, false))).sum();
                // A half turn takes the image of the origin back to it.
                let back = image(image([0.0; 3], true), true);
                vec![
                    ("opposite t1", turned(at.get("t4") - at.get("t1")), 0.0),
                    ("opposite t2", turned(at.get("t5") - at.get("t2")), 0.0),
                    ("opposite t3", turned(at.get("t6") - at.get("t3")), 0.0),
                    ("half a turn", trace, -1.0),
                    ("and back", dot(back, back).sqrt(), 0.0),
                ]
            })
        },
        within: 1e-12,
        ..Row::new(
            "Bricard's line-symmetric ring",
            "Bricard 1897, 1927; Baker 1980",
            "opposite angles are equal, half of the ring is half a turn about a line",
        )
    }
}
