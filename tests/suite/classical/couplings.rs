//! Couplings of shafts, and spatial four-bars.

use super::motion::{Row, turned};
use super::space::Dual;

pub fn rows() -> Vec<Row> {
    vec![
        oldham(),
        double_cardan(),
        clemens(),
        spherical(),
        rccc(),
        rssr(),
    ]
}

fn oldham() -> Row {
    Row {
        scene: "duration = 2\n[inputs]\nphi = \"0.3 + 3*t\"\n[loops]\n\
            L = \"Rz(phi) Tx(u) Ty(v) Rz(-psi) Tx(-4)\"\n\
            [[bodies]]\nname = \"disc\"\nframe = \"Rz(phi) Tx(u)\"\n\
            [[traces]]\nname = \"P\"\nbody = \"disc\"\npoint = [0, 0, 0]\n"
            .into(),
        answers: |motion| {
            motion.each(|at| {
                let phi = at.get("phi");
                let [x, y] = [at.get("P.x") - 2.0, at.get("P.y")];
                vec![
                    ("output", turned(at.get("psi") - phi), 0.0),
                    ("circle", x.hypot(y), 2.0),
                    ("twice as fast", turned(y.atan2(x) - 2.0 * phi), 0.0),
                ]
            })
        },
        planted: Some(("Tx(-4)", "Tx(-4.00001)")),
        ..Row::new(
            "Oldham coupling",
            "Oldham 1821; Willis 1841",
            "ratio 1; the disc's centre moves on a circle through both shafts, twice per turn",
        )
    }
}

/// Two universal joints at 0.5 each, in phase to `t3`, and out of phase to `t4`.
fn double_cardan() -> Row {
    Row {
        scene: "duration = 2\n[parameters]\nB = 0.5\n[inputs]\nt1 = \"3*t\"\n[chains]\nmiddle = \"Rz(B) Rx(t2)\"\n[loops]\n\
            A = \"Rx(t1) Rz(q1) Ry(q2) inv(middle)\"\n\
            C = \"middle Ry(p1) Rz(p2) inv(Rx(t3))\"\n\
            D = \"middle Rz(r1) Ry(r2) inv(Rx(t4))\"\n"
            .into(),
        answers: |motion| {
            let c = 0.5_f64.cos();
            motion.each(|at| {
                let (s1, c1) = at.get("t1").sin_cos();
                let single = (c * s1).atan2(c1);
                let double = (c * c * s1).atan2(c1);
                vec![
                    ("one joint", turned(at.get("t2") - single), 0.0),
                    ("in phase", turned(at.get("t3") - at.get("t1")), 0.0),
                    ("out of phase", turned(at.get("t4") - double), 0.0),
                ]
            })
        },
        within: 1e-12,
        planted: Some(("B = 0.5", "B = 0.50001")),
        ..Row::new(
            "Double Cardan shaft",
            "Poncelet 1824; Shigley and Uicker, *Theory of Machines and Mechanisms*, 1980",
            "in phase ratio 1; out of phase tan t₄ = tan t₁ cos² β",
        )
    }
}

/// R-R-S-R-R, a mirror image of itself in the plane that bisects the shafts.
fn clemens() -> Row {
    Row {
        scene: "duration = 2\n[parameters]\nB = 0.4\n[inputs]\nt1 = \"0.2 + 3*t\"\n[loops]\n\
            L = \"Ty(-2) Rx(-B) Ry(t1) Tx(1) Rz(a) Tx(3) Rx(s1) Ry(s2) Rz(s3) inv(Ty(2) Rx(B) Ry(t2) Tx(1) Rz(b) Tx(3))\"\n\
            [guess]\na = 0.7\nb = -0.7\nt2 = 0.2\n"
            .into(),
        answers: |motion| {
            motion.each(|at| {
                vec![
                    ("ratio", turned(at.get("t2") - at.get("t1")), 0.0),
                    ("mirror image", turned(at.get("a") + at.get("b")), 0.0),
                ]
            })
        },
        within: 1e-12,
        planted: Some(("Rz(b) Tx(3)", "Rz(b) Tx(3.0001)")),
        ..Row::new(
            "Clemens coupling",
            "Clemens 1869; Hunt, *Kinematic Geometry of Mechanisms*, 1978",
            "ratio 1 at every angle of the shafts",
        )
    }
}

const TWISTS: [f64; 4] = [0.5, 1.1, 0.9, 1.3];
const LENGTHS: [f64; 4] = [0.4, 1.2, 0.8, 1.5];

/// Both output angles of a spherical four-bar, in dual numbers those of an RCCC linkage (Yang and Freudenstein):
/// sin ψ s3 s1 sin φ − cos ψ s3 (c4 s1 cos φ + s4 c1) = c2 + c3 s4 s1 cos φ − c1 c3 c4.
fn outputs(phi: Dual, twists: [Dual; 4]) -> [Dual; 2] {
    let [s1, _, s3, s4] = twists.map(Dual::sin);
    let [c1, c2, c3, c4] = twists.map(Dual::cos);
    let (s, c) = (phi.sin(), phi.cos());
    let minus = |d: Dual| d.scaled(-1.0);
    let a = s3 * s1 * s;
    let b = minus(s3 * (c4 * s1 * c + s4 * c1));
    let right = c2 + c3 * s4 * s1 * c + minus(c1 * c3 * c4);
    // a sin ψ + b cos ψ = right
    let reach = (a * a + b * b).sqrt();
    let swing = (right / reach).acos();
    [1.0, -1.0].map(|side| a.atan2(b) + swing.scaled(side))
}

fn spherical() -> Row {
    Row {
        scene: "duration = 2\n[inputs]\nphi = \"0.3 + 3*t\"\n[loops]\n\
            L = \"Rz(phi) Rx(0.5) Rz(m) Rx(1.1) Rz(n) Rx(0.9) Rz(psi) Rx(1.3)\"\n"
            .into(),
        answers: |motion| {
            motion.each(|at| {
                let angles = TWISTS.map(|a| Dual(a, 0.0));
                let both = outputs(Dual(at.get("phi"), 0.0), angles);
                let errors = both.map(|known| turned(at.get("psi") - known.0).abs());
                vec![("output", errors[0].min(errors[1]), 0.0)]
            })
        },
        assemblies: Some(2),
        planted: Some(("Rx(1.1)", "Rx(1.10001)")),
        ..Row::new(
            "Spherical four-bar",
            "Chiang, *Kinematics of Spherical Mechanisms*, 1988",
            "A sin ψ + B cos ψ = C",
        )
    }
}

fn rccc() -> Row {
    Row {
        scene: "duration = 2\n[inputs]\nphi = \"0.3 + 3*t\"\n[loops]\n\
            L = \"Rz(phi) Tz(0.3) Tx(0.4) Rx(0.5) Rz(m) Tz(u) Tx(1.2) Rx(1.1) Rz(n) Tz(v) Tx(0.8) Rx(0.9) Rz(psi) Tz(s) Tx(1.5) Rx(1.3)\"\n"
            .into(),
        answers: |motion| {
            motion.each(|at| {
                let mut twists = [Dual(0.0, 0.0); 4];
                for (k, twist) in twists.iter_mut().enumerate() {
                    *twist = Dual(TWISTS[k], LENGTHS[k]);
                }
                let both = outputs(Dual(at.get("phi"), 0.3), twists);
                let error = |known: &Dual| turned(at.get("psi") - known.0).abs();
                let nearest = if error(&both[0]) < error(&both[1]) { both[0] } else { both[1] };
                vec![
                    ("angle", error(&nearest), 0.0),
                    ("shift", at.get("s"), nearest.1),
                ]
            })
        },
        within: 1e-12,
        assemblies: Some(2),
        planted: Some(("Tx(1.5)", "Tx(1.50001)")),
        ..Row::new(
            "RCCC linkage",
            "Yang and Freudenstein 1964 (dual numbers)",
            "the spherical equation in dual angles: output angle and shift",
        )
    }
}

/// Hartenberg and Denavit's four-bar with skew axes: a rod between two balls.
fn rssr() -> Row {
    Row {
        scene: "duration = 2\n[inputs]\nphi = \"0.2 + 3*t\"\n[loops]\n\
            L = \"Rz(phi) Tx(2) Rx(a) Ry(b) Rz(c) Tx(9) Rx(d) Ry(e) Rz(f) inv(T(5, 3, 1) Rx(pi/2) Rz(psi) Tx(6))\"\n\
            [guess]\npsi = 1.5\n[[bodies]]\nname = \"output\"\nframe = \"T(5, 3, 1) Rx(pi/2) Rz(psi)\"\n"
            .into(),
        count: 2,
        rank: 2,
        within: 1e-12,
        answers: |motion| {
            motion.each(|at| {
                let (s, c) = at.get("phi").sin_cos();
                // (5 + 6 cos ψ − 2 c)² + (3 − 2 s)² + (1 + 6 sin ψ)² = 81
                let [x, y, z] = [5.0 - 2.0 * c, 3.0 - 2.0 * s, 1.0];
                let right = (81.0 - x * x - y * y - z * z - 36.0) / 12.0;
                let swing = (right / f64::hypot(x, z)).acos();
                let both = [1.0, -1.0].map(|side| z.atan2(x) + side * swing);
                let errors = both.map(|known| turned(at.get("psi") - known).abs());
                vec![("output", errors[0].min(errors[1]), 0.0)]
            })
        },
        assemblies: Some(2),
        planted: Some(("Tx(9)", "Tx(9.0001)")),
        ..Row::new(
            "RSSR linkage at right angles",
            "Hartenberg and Denavit 1964, ch. 12",
            "A cos ψ + B sin ψ = C; the rod's spin is idle",
        )
    }
}
