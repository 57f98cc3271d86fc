//! Arms and platforms.

use super::motion::Row;
use super::plane::{along, apart, meet, placed};
use super::space::{Vector, dot, turn};
use std::f64::consts::{FRAC_PI_3, TAU};

pub fn rows() -> Vec<Row> {
    vec![planar_platform(), puma(), delta(), three_rps(), stewart()]
}

const LEGS: [f64; 3] = [20.0, 17.0, 13.0];

/// Gap of the third leg where the first one stands at `angle` and the second is on one side.
fn gap(angle: f64, side: usize) -> f64 {
    let first = along([0.0, 0.0], LEGS[0], angle);
    let second = meet(first, 15.0, [19.0, 0.0], LEGS[1])[side];
    let third = placed(first, second, [20.0, 7.0]);
    apart(third, [5.0, 13.0]) - LEGS[2]
}

/// First leg's angles of all assemblies: changes of sign along a turn, halved to the last digit.
fn planar_assemblies() -> Vec<f64> {
    const STEPS: usize = 3600;
    let angle = |k: usize| TAU * k as f64 / STEPS as f64;
    let mut roots = Vec::new();
    for side in [0, 1] {
        for k in 0..STEPS {
            let (mut low, mut high) = (angle(k), angle(k + 1));
            let sign = gap(low, side);
            // Where the second leg does not reach, there is no number and no change of sign.
            if sign * gap(high, side) < 0.0 {
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    let half = if sign * gap(middle, side) > 0.0 {
                        &mut low
                    } else {
                        &mut high
                    };
                    *half = middle;
                }
                roots.push(low);
            }
        }
    }
    roots
}

fn planar_platform() -> Row {
    Row {
        scene: "[inputs]\nl = 20\n[chains]\nplate = \"Rz(a) Tx(l) Rz(b)\"\n[loops]\n\
            A = \"plate Tx(15) Rz(c) Tx(-17) Rz(-e) Tx(-19)\"\n\
            B = \"plate T(20, 7, 0) Rz(f) Tx(-13) Rz(-g) T(-5, -13, 0)\"\n\
            [[bodies]]\nname = \"plate\"\nframe = \"plate\"\n"
            .into(),
        samples: 1,
        within: 1e-12,
        assemblies: Some(6),
        answers: |motion| {
            let modes = motion.modes();
            let roots = planar_assemblies();
            let met = roots
                .iter()
                .filter(|a| motion.has_mode(&modes, &[("a", **a)]));
            vec![
                ("assemblies by halving".into(), roots.len() as f64, 6.0),
                ("assemblies that agree".into(), met.count() as f64, 6.0),
            ]
        },
        planted: Some(("Tx(-13)", "Tx(-13.1)")),
        ..Row::new(
            "Planar platform 3-RPR",
            "Hunt 1983; Merlet, *Parallel Robots*, 2000, ch. 4",
            "a four-bar's coupler curve (sextic) meets a circle in at most 6 points; here in 6",
        )
    }
}

/// Wrist centre and hand of the arm: shoulder offset 0.15, upper arm 0.43, forearm 0.43 with an offset of 0.02.
const HAND: [f64; 3] = [0.35, 0.25, 0.3];

/// The eight sets of joint angles in closed form.
fn puma_by_hand() -> Vec<[f64; 6]> {
    let (offset, upper, forearm, drop) = (0.15_f64, 0.43_f64, 0.43_f64, 0.02_f64);
    let lower = forearm.hypot(drop);
    let [x, y, z] = HAND;
    let mut all = Vec::new();
    for shoulder in [1.0, -1.0] {
        let reach = shoulder * (x * x + y * y - offset * offset).sqrt();
        let t1 = y.atan2(x) - offset.atan2(reach);
        let square = reach * reach + z * z;
        for elbow in [1.0, -1.0] {
            let inner = (square - upper * upper - lower * lower) / (2.0 * upper * lower);
            let bend = elbow * inner.acos();
            // Turns about y lower the x axis; the forearm's end lies `drop` above its axis.
            let t3 = bend + drop.atan2(forearm);
            let t2 = (-z).atan2(reach) - (lower * bend.sin()).atan2(upper + lower * bend.cos());
            // The hand Rz(0.4) Ry(0.9) Rx(0.3), seen from the forearm.
            let seen = |v: Vector| {
                let v = turn(2, 0.4, turn(1, 0.9, turn(0, 0.3, v)));
                turn(1, -t2 - t3, turn(2, -t1, v))
            };
            let along_x = seen([1.0, 0.0, 0.0]);
            let rows = [seen([0.0, 1.0, 0.0])[0], seen([0.0, 0.0, 1.0])[0]];
            for flip in [1.0, -1.0] {
                let t5 = flip * along_x[0].acos();
                let s = t5.sin();
                let t4 = (along_x[1] / s).atan2(-along_x[2] / s);
                let t6 = (rows[0] / s).atan2(rows[1] / s);
                all.push([t1, t2, t3, t4, t5, t6]);
            }
        }
    }
    all
}

fn puma() -> Row {
    let arm = [
        "Tx(rail) Rz(t1)",
        "Ty(0.15) Ry(t2)",
        "Tx(0.43) Ry(t3)",
        "Tx(0.43) Tz(0.02) Rx(t4)",
        "Ry(t5)",
        "Rx(t6)",
    ];
    let links: String = (1..=5)
        .map(|k| {
            format!(
                "[[bodies]]\nname = \"{k}\"\nframe = \"{}\"\n",
                arm[..k].join(" ")
            )
        })
        .collect();
    Row {
        scene: format!(
            "[inputs]\nrail = 0\n[loops]\nA = \"{} inv(T({}, {}, {}) Rz(0.4) Ry(0.9) Rx(0.3))\"\n{links}",
            arm.join(" "),
            HAND[0],
            HAND[1],
            HAND[2]
        ),
        samples: 1,
        within: 1e-12,
        assemblies: Some(8),
        answers: |motion| {
            let modes = motion.modes();
            let names = ["t1", "t2", "t3", "t4", "t5", "t6"];
            let is_met = |angles: &[f64; 6]| {
                let wanted: Vec<(&str, f64)> = names.into_iter().zip(*angles).collect();
                motion.has_mode(&modes, &wanted)
            };
            let met = puma_by_hand().iter().filter(|a| is_met(a)).count();
            vec![("solutions that agree".into(), met as f64, 8.0)]
        },
        planted: Some(("Ty(0.15)", "Ty(0.151)")),
        ..Row::new(
            "PUMA arm with a spherical wrist",
            "Pieper 1968; Craig, *Introduction to Robotics*, 1986, ch. 4",
            "shoulder, elbow and wrist make 8 sets of angles, all in closed form",
        )
    }
}

/// The point at a distance from three others, below them (Clavel).
fn below(centres: [Vector; 3], radius: f64) -> Vector {
    let minus = |a: Vector, b: Vector| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let cross = |a: Vector, b: Vector| {
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    };
    let [u, v] = [minus(centres[1], centres[0]), minus(centres[2], centres[0])];
    let n = cross(u, v);
    let square = dot(n, n);
    // Centre of the circle through three points.
    let (p, q) = (cross(n, u), cross(v, n));
    let (uu, vv) = (dot(u, u), dot(v, v));
    let middle: Vec<f64> = (0..3)
        .map(|k| (vv * p[k] + uu * q[k]) / (2.0 * square))
        .collect();
    let flat: f64 = middle.iter().map(|m| m * m).sum();
    let height = ((radius * radius - flat) / square).sqrt() * n[2].signum();
    [0, 1, 2].map(|k| centres[0][k] + middle[k] - height * n[k])
}

fn delta() -> Row {
    let contact = |k: usize| {
        format!(
            "[contacts.c{k}]\nfirst = {{ sphere = {{ radius = 8 }}, frame = \"Rz({k}*2*pi/3) Tx(2) Ry(q{k}) Tx(3)\" }}\n\
             second = {{ sphere = {{ radius = 0 }}, frame = \"plate Rz({k}*2*pi/3) Tx(1)\" }}\n"
        )
    };
    Row {
        scene: format!(
            "duration = 2\n[inputs]\nq0 = \"0.3 + 0.5*sin(3*t)\"\nq1 = \"0.2 + 0.4*sin(2*t)\"\nq2 = \"0.5*cos(3*t)\"\n\
             [chains]\nplate = \"Tx(x) Ty(y) Tz(z)\"\n{}{}{}[guess]\nz = -8\n\
             [[bodies]]\nname = \"plate\"\nframe = \"plate\"\n",
            contact(0),
            contact(1),
            contact(2)
        ),
        count: 3,
        rank: 3,
        within: 1e-12,
        assemblies: Some(2),
        answers: |motion| {
            motion.each(|at| {
                let elbow = |k: usize| {
                    let q = at.get(["q0", "q1", "q2"][k]);
                    let arm = [1.0 + 3.0 * q.cos(), 0.0, -3.0 * q.sin()];
                    turn(2, TAU / 3.0 * k as f64, arm)
                };
                let known = below([elbow(0), elbow(1), elbow(2)], 8.0);
                vec![
                    ("x", at.get("x"), known[0]),
                    ("y", at.get("y"), known[1]),
                    ("z", at.get("z"), known[2]),
                ]
            })
        },
        planted: Some(("radius = 8", "radius = 8.0001")),
        ..Row::new(
            "Delta robot, forward",
            "Clavel 1988; Tsai, *Robot Analysis*, 1999, ch. 3",
            "the plate is where three spheres meet: 2 assemblies",
        )
    }
}

const PLATE: &str = "Tx(x) Ty(y) Tz(z) Rz(yaw) Ry(pitch) Rx(roll)";

fn three_rps() -> Row {
    let leg = |k: usize| {
        format!(
            "L{k} = \"Rz({k}*2*pi/3) Tx(5) Ry(-a{k}) Tx(l{k}) Rx(b{k}) Ry(c{k}) Rz(d{k}) inv(plate Rz({k}*2*pi/3) Tx(3))\"\n"
        )
    };
    Row {
        scene: format!(
            "duration = 2\n[inputs]\nl0 = \"9 + sin(2*t)\"\nl1 = \"9 - 0.7*sin(3*t)\"\nl2 = \"9 + 0.5*sin(t)\"\n\
             [chains]\nplate = \"{PLATE}\"\n[loops]\n{}{}{}[guess]\nz = 9\na0 = 1.8\na1 = 1.8\na2 = 1.8\n\
             c0 = 1.8\nc1 = 1.8\nc2 = 1.8\n[[bodies]]\nname = \"plate\"\nframe = \"plate\"\n",
            leg(0),
            leg(1),
            leg(2)
        ),
        count: 3,
        rank: 3,
        within: 1e-12,
        answers: |motion| {
            motion.each(|at| {
                let [yaw, pitch, roll] = ["yaw", "pitch", "roll"].map(|n| at.get(n));
                let image = |v: Vector| turn(2, yaw, turn(1, pitch, turn(0, roll, v)));
                let (u, v) = (image([1.0, 0.0, 0.0]), image([0.0, 1.0, 0.0]));
                let place = ["x", "y", "z"].map(|n| at.get(n));
                let leg = |k: usize| {
                    let turned = |r: f64| turn(2, TAU / 3.0 * k as f64, [r, 0.0, 0.0]);
                    let (foot, pin) = (turned(5.0), image(turned(3.0)));
                    let way = [0, 1, 2].map(|i| place[i] + pin[i] - foot[i]);
                    dot(way, way).sqrt()
                };
                vec![
                    ("no twist", u[1], v[0]),
                    ("parasitic x", place[0], 1.5 * (u[0] - v[1])),
                    ("parasitic y", place[1], -3.0 * u[1]),
                    ("leg 0", leg(0), at.get("l0")),
                    ("leg 1", leg(1), at.get("l1")),
                    ("leg 2", leg(2), at.get("l2")),
                ]
            })
        },
        planted: Some(("Tx(3))\"\nL1", "Tx(3.001))\"\nL1")),
        ..Row::new(
            "3-RPS platform",
            "Hunt 1983; Lee and Shah 1988; Tsai 1999",
            "r₁₂ = r₂₁ and the parasitic shift x = ½ρ(r₁₁ − r₂₂), y = −ρ r₂₁",
        )
    }
}

/// Two triangles of legs; `d` is the difference of their squared lengths as a share of the largest: the sine of the yaw.
fn stewart() -> Row {
    let leg = |k: usize, side: i32| {
        let name = format!("{k}{}", if side > 0 { "p" } else { "m" });
        let (foot, pin) = (f64::from(side) * 0.2, f64::from(side) * (FRAC_PI_3 - 0.3));
        let base = TAU / 3.0 * k as f64;
        let sign = if side > 0 { "+" } else { "-" };
        format!(
            "L{name} = \"Rz({:?}) Tx(5) Rx(a{name}) Ry(b{name}) Tz(sqrt(98 {sign} 30*sin(pi/3 - 0.5)*d)) \
             Rx(c{name}) Ry(e{name}) Rz(f{name}) inv(plate Rz({:?}) Tx(3))\"\n",
            base + foot,
            base + pin
        )
    };
    let legs: String = (0..3).flat_map(|k| [leg(k, 1), leg(k, -1)]).collect();
    Row {
        scene: format!(
            "duration = 1\n[inputs]\nd = \"0.2 + 0.3*t\"\n[chains]\nplate = \"{PLATE}\"\n[loops]\n{legs}\
             [guess]\nz = 8\nyaw = 0.2\n[[bodies]]\nname = \"plate\"\nframe = \"plate\"\n"
        ),
        within: 1e-9,
        answers: |motion| {
            let mut all = motion.each(|at| {
                let yaw = at.get("d").asin();
                // Squares of the legs, added: 98 = 25 + 9 + z² − 30 cos(yaw) cos(lean).
                let height = (64.0 + 30.0 * yaw.cos() * (FRAC_PI_3 - 0.5).cos()).sqrt();
                vec![
                    ("yaw", at.get("yaw"), yaw),
                    ("height", at.get("z"), height),
                    ("tilt", at.get("pitch").hypot(at.get("roll")), 0.0),
                ]
            });
            let ends = motion.feasible(0.2);
            all.push(("quarter turn back".into(), ends[0], -1.0));
            all.push(("quarter turn".into(), ends[1], 1.0));
            all
        },
        planted: Some(("Tz(sqrt(98 +", "Tz(sqrt(98.0001 +")),
        ..Row::new(
            "Gough-Stewart platform to a quarter turn",
            "Fichter 1986; Merlet 2000, ch. 6",
            "symmetric platforms are singular at a yaw of ±90°: the difference of the legs is largest there",
        )
    }
}
