//! Cranks, slides, wheels, cams and steering gears: one turn into another motion.

use super::motion::{Row, turned};
use super::plane::corner;
use std::f64::consts::{PI, TAU};

pub fn rows() -> Vec<Row> {
    vec![
        offset_slider_crank(),
        whitworth(),
        scotch_yoke(),
        geneva_four(),
        geneva_six(),
        eccentric(),
        swash_plate(),
        ferguson(),
        differential_screw(),
        davis(),
        freudenstein(),
        crank_rocker(),
    ]
}

fn offset_slider_crank() -> Row {
    Row {
        scene: "duration = 2\n[inputs]\nphi = \"0.3 + pi*t\"\n[loops]\n\
            L = \"Rz(phi) Tx(3) Rz(mu) Tx(8) Rz(nu) Ty(-2) Tx(-h)\"\n[guess]\nh = 9\n"
            .into(),
        samples: 37,
        assemblies: Some(2),
        answers: |motion| {
            let mut all = motion.each(|at| {
                let (s, c) = at.get("phi").sin_cos();
                let h = 3.0 * c + (64.0 - (2.0 - 3.0 * s).powi(2)).sqrt();
                vec![("slider", at.get("h"), h)]
            });
            let mut limits = motion.limits("h");
            limits.sort_by(|a, b| a[1].total_cmp(&b[1]));
            assert_eq!(limits.len(), 2);
            let inner = (25.0_f64 - 4.0).sqrt();
            let outer = (121.0_f64 - 4.0).sqrt();
            let stroke = limits[1][1] - limits[0][1];
            all.push(("stroke".into(), stroke, outer - inner));
            // The crank turns by 180° and the angle between the two lines of the rod.
            let turn = (limits[0][0] - limits[1][0]).rem_euclid(TAU);
            let known = PI + (2.0_f64 / 5.0).asin() - (2.0_f64 / 11.0).asin();
            all.push(("time of the return".into(), turn, known.rem_euclid(TAU)));
            all
        },
        within: 1e-9,
        planted: Some(("Ty(-2)", "Ty(-2.00001)")),
        ..Row::new(
            "Offset slider-crank",
            "Norton, *Design of Machinery*, ch. 3",
            "stroke √((l+r)² − e²) − √((l−r)² − e²), time ratio from asin e/(l ± r)",
        )
    }
}

fn whitworth() -> Row {
    Row {
        scene: "duration = 2\n[inputs]\nphi = \"pi*t + pi/2\"\n[loops]\n\
            L = \"Rz(phi) Tx(5) Rz(psi - phi) Tx(-q) Rz(-psi) Ty(2)\"\n[guess]\nq = 7\npsi = 1.5\n"
            .into(),
        samples: 8,
        assemblies: Some(2),
        within: 1e-12,
        answers: |motion| {
            let mut all = motion.each(|at| {
                let (s, c) = at.get("phi").sin_cos();
                let lever = (5.0 * s + 2.0).atan2(5.0 * c);
                vec![
                    ("lever", turned(at.get("psi") - lever), 0.0),
                    ("slide", at.get("q"), (29.0 + 20.0 * s).sqrt()),
                ]
            });
            let poses = motion.poses();
            for (sample, ratio) in [(0, 5.0 / 7.0), (4, 5.0 / 3.0)] {
                all.push(("speed ratio".into(), poses[sample].rate("psi", 1), ratio));
            }
            all
        },
        planted: Some(("Ty(2)", "Ty(2.00001)")),
        ..Row::new(
            "Whitworth's quick return",
            "Whitworth 1849; Norton, ch. 3",
            "tan ψ = (r sin φ + d)/(r cos φ); speed ratios r/(r ± d)",
        )
    }
}

fn scotch_yoke() -> Row {
    Row {
        scene: "duration = 2\n[inputs]\nphi = \"3*t\"\n[loops]\nL = \"Rz(phi) Tx(4) Rz(-phi) Ty(-v) Tx(-x)\"\n".into(),
        assemblies: Some(1),
        answers: |motion| {
            motion.each(|at| {
                let phi = at.get("phi");
                vec![
                    ("x", at.get("x"), 4.0 * phi.cos()),
                    ("speed", at.rate("x", 1), -4.0 * phi.sin()),
                    ("acceleration", at.rate("x", 2), -4.0 * phi.cos()),
                ]
            })
        },
        planted: Some(("Tx(4)", "Tx(4.000001)")),
        ..Row::new(
            "Scotch yoke",
            "Norton, ch. 2 (inversion of the slider-crank)",
            "x = r cos φ, v = −r ω sin φ, a = −r ω² cos φ",
        )
    }
}

/// A pin that turns through one engagement with a wheel of `slots`, its centre ten away.
fn geneva(slots: &str) -> String {
    format!(
        "duration = 2\n[parameters]\nn = {slots}\na = 10\nr = \"a*sin(pi/n)\"\n\
         [inputs]\nphi = \"(pi/2 - pi/n)*(t - 1)\"\n[loops]\n\
         L = \"Rz(phi) Tx(r) Rz(-phi - psi) Tx(q) Rz(psi) Tx(-a)\"\n[guess]\nq = 5\n"
    )
}

fn geneva_row(name: &'static str, answer: &'static str, slots: &str) -> Row {
    Row {
        scene: geneva(slots),
        within: 1e-12,
        assemblies: Some(2),
        planted: Some(("r = \"a*sin(pi/n)\"", "r = \"1.00001*a*sin(pi/n)\"")),
        ..Row::new(
            name,
            "Bickford, *Mechanisms for Intermittent Motion*, 1972",
            answer,
        )
    }
}

/// Angle at entry, slot at entry, and the speed ratios at entry and in the middle.
fn geneva_answers(motion: &super::motion::Motion, n: f64) -> Vec<super::motion::Answer> {
    let poses = motion.poses();
    let (first, middle) = (&poses[0], &poses[4]);
    let share = (PI / n).sin();
    vec![
        ("index".into(), first.get("psi"), -PI / n),
        ("slot".into(), first.get("q"), 10.0 * (PI / n).cos()),
        ("ratio at entry".into(), first.rate("psi", 1), 0.0),
        (
            "acceleration at entry".into(),
            first.rate("psi", 2),
            (PI / n).tan(),
        ),
        (
            "largest ratio".into(),
            middle.rate("psi", 1),
            share / (1.0 - share),
        ),
    ]
}

fn geneva_four() -> Row {
    Row {
        answers: |motion| {
            let mut all = geneva_answers(motion, 4.0);
            let ratio = all.last().unwrap().1;
            all.push(("printed ratio".into(), (ratio * 1e3).round() / 1e3, 2.414));
            all
        },
        ..geneva_row(
            "Geneva wheel, four slots",
            "enters with zero speed and acceleration ω² tan 180°/n; largest speed ratio λ/(1 − λ) = 2.414, λ = sin 180°/n",
            "4",
        )
    }
}

fn geneva_six() -> Row {
    Row {
        answers: |motion| {
            let mut all = geneva_answers(motion, 6.0);
            let ratio = all.last().unwrap().1;
            all.push(("printed ratio".into(), ratio, 1.0));
            all
        },
        ..geneva_row(
            "Geneva wheel, six slots",
            "enters with zero speed; largest speed ratio 1",
            "6",
        )
    }
}

fn eccentric() -> Row {
    Row {
        scene: "duration = 2\n[inputs]\nphi = \"3*t\"\n[contacts.c]\n\
            first = { sphere = { radius = 5 }, frame = \"Rz(phi) Tx(2)\" }\n\
            second = { plane = {}, frame = \"Ty(s) Rx(pi/2)\" }\n[guess]\ns = 5\n"
            .into(),
        answers: |motion| {
            motion.each(|at| {
                let phi = at.get("phi");
                vec![
                    ("lift", at.get("s"), 5.0 + 2.0 * phi.sin()),
                    ("speed", at.rate("s", 1), 2.0 * phi.cos()),
                ]
            })
        },
        planted: Some(("radius = 5", "radius = 5.0001")),
        ..Row::new(
            "Eccentric under a flat follower",
            "Norton, ch. 8",
            "s = R + e sin φ: simple harmonic",
        )
    }
}

fn swash_plate() -> Row {
    Row {
        scene: "duration = 2\n[inputs]\nphi = \"3*t\"\n[contacts.c]\n\
            first = { plane = {}, frame = \"Rz(phi) Rx(0.3)\" }\n\
            second = { sphere = { radius = 0 }, frame = \"Tx(6) Tz(z)\" }\n"
            .into(),
        answers: |motion| {
            motion.each(|at| {
                let known = -6.0 * 0.3_f64.tan() * at.get("phi").sin();
                vec![("lift", at.get("z"), known)]
            })
        },
        planted: Some(("Rx(0.3)", "Rx(0.30001)")),
        ..Row::new(
            "Swash plate",
            "Ivantysyn and Ivantysynova, *Hydrostatic Pumps and Motors*, 2001",
            "z = −R tan β sin φ for a point piston: simple harmonic",
        )
    }
}

/// A carrier whose planet of 20 teeth meshes with a fixed wheel of 100 and with wheels of 99 and 101.
fn ferguson() -> Row {
    Row {
        scene: "duration = 2\n[inputs]\ncarrier = \"2*pi*t/2\"\n[equations]\n\
            fixed = \"100*(0 - carrier) + 20*(planet - carrier)\"\n\
            fast = \"101*(slow - carrier) + 20*(planet - carrier)\"\n\
            same = \"100*(still - carrier) + 20*(planet - carrier)\"\n\
            less = \"99*(back - carrier) + 20*(planet - carrier)\"\n\
            [[bodies]]\nname = \"planet\"\nframe = \"Rz(carrier) Tx(60) Rz(planet - carrier)\"\n\
            [[bodies]]\nname = \"slow\"\nframe = \"Rz(slow)\"\n\
            [[bodies]]\nname = \"back\"\nframe = \"Rz(back)\"\n"
            .into(),
        within: 1e-12,
        answers: |motion| {
            motion.each(|at| {
                let turn = at.get("carrier");
                vec![
                    ("101 teeth", at.get("slow"), turn / 101.0),
                    ("100 teeth", at.get("still"), 0.0),
                    ("99 teeth", at.get("back"), -turn / 99.0),
                    ("planet", at.get("planet"), 6.0 * turn),
                ]
            })
        },
        planted: Some(("101*(", "102*(")),
        ..Row::new(
            "Ferguson's paradox",
            "Ferguson 1764; Willis, *Principles of Mechanism*, 1841",
            "per turn of the arm +1/101, 0 and −1/99 turns",
        )
    }
}

fn differential_screw() -> Row {
    Row {
        scene: "duration = 2\n[inputs]\nphi = \"2*pi*t\"\n[loops]\n\
            L = \"Hz(1.5, phi) inv(Hz(1.25, a)) Tz(-z)\"\n"
            .into(),
        answers: |motion| {
            motion.each(|at| vec![("advance", at.get("z"), 0.25 * at.get("phi") / TAU)])
        },
        planted: Some(("1.25", "1.2500001")),
        ..Row::new(
            "Differential screw",
            "Hunter 1781; Prony; Willis 1841",
            "advance of p₁ − p₂ per turn",
        )
    }
}

/// Two sliding blocks on a rack steer two bell cranks.
fn davis() -> Row {
    Row {
        scene: "duration = 2\n[parameters]\nalpha = \"atan(0.25)\"\n[inputs]\nx = \"2*t - 2\"\n\
            [loops]\nL = \"Tx(-5) Rz(pi/2 - alpha + left) Tx(p) Rz(u) Tx(-x) Tx(5 - 2) Ty(-8)\"\n\
            R = \"Tx(5) Rz(pi/2 + alpha + right) Tx(q) Rz(v) Tx(-x) Tx(-5 + 2) Ty(-8)\"\n\
            [guess]\np = 8\nq = 8\n"
            .into(),
        answers: |motion| {
            motion.each(|at| {
                let (left, right) = (at.get("left"), at.get("right"));
                // cot − cot = 2 tan alpha, free of poles.
                let [l, r] = [left.tan(), right.tan()];
                vec![("Ackermann", l - r, 2.0 * 0.25 * l * r)]
            })
        },
        planted: Some(("atan(0.25)", "atan(0.26)")),
        ..Row::new(
            "Davis steering gear",
            "Davis 1828; Theory of Machines (Rattan), ch. 6",
            "cot φ − cot θ = 2 tan α: exact at every angle",
        )
    }
}

/// Freudenstein's equation K1 cos ψ − K2 cos φ + K3 = cos(φ − ψ) at the three Chebyshev points of y = lg x, 1 ≤ x ≤ 2.
fn precision_points() -> [[f64; 3]; 3] {
    [0, 1, 2].map(|k| {
        let x = 1.5 - 0.5 * (PI * (2.0 * f64::from(k) + 1.0) / 6.0).cos();
        let (phi, psi) = (
            45_f64.to_radians() + (x - 1.0) * 60_f64.to_radians(),
            60_f64.to_radians() + x.log10() / 2_f64.log10() * 60_f64.to_radians(),
        );
        [x, phi, psi]
    })
}

/// The three ratios by Cramer's rule.
fn ratios() -> [f64; 3] {
    let rows = precision_points().map(|[_, phi, psi]| [psi.cos(), -phi.cos(), 1.0]);
    let right = precision_points().map(|[_, phi, psi]| (phi - psi).cos());
    let det = |m: [[f64; 3]; 3]| {
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
            - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
            + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    };
    [0, 1, 2].map(|k| {
        let mut replaced = rows;
        for i in 0..3 {
            replaced[i][k] = right[i];
        }
        det(replaced) / det(rows)
    })
}

fn freudenstein() -> Row {
    // K1 = d/a, K2 = d/c, K3 = (a² − b² + c² + d²)/(2 a c), base d = 1.
    let [k1, k2, k3] = ratios();
    let (a, c) = (1.0 / k1, 1.0 / k2);
    let b = (a * a + c * c + 1.0 - 2.0 * a * c * k3).sqrt();
    let [first, second, third] = precision_points();
    let coupler = (c * first[2].sin() - a * first[1].sin())
        .atan2(1.0 + c * first[2].cos() - a * first[1].cos());
    Row {
        scene: format!(
            "duration = 2\n[inputs]\nphi = {{ keys = [[0, {:?}], [1, {:?}], [2, {:?}]] }}\n[loops]\n\
             L = \"Rz(phi) Tx({a:?}) Rz(mu) Tx({b:?}) Rz(nu) Tx({:?}) Rz(-psi) Tx(-1)\"\n[guess]\npsi = {:?}\nmu = {:?}\n",
            first[1],
            second[1],
            third[1],
            -c,
            first[2],
            coupler - first[1]
        ),
        samples: 3,
        within: 1e-12,
        assemblies: Some(2),
        answers: |motion| {
            let points = precision_points();
            let poses = motion.poses();
            let answer = |k: usize| {
                let error = turned(poses[k].get("psi") - points[k][2]);
                ("precision point".to_owned(), error, 0.0)
            };
            (0..3).map(answer).collect()
        },
        ..Row::new(
            "Function generator y = lg x",
            "Freudenstein 1955; Hartenberg and Denavit, ch. 10",
            "the four-bar of Freudenstein's equation passes its three Chebyshev points",
        )
    }
}

/// Extremes of the transmission angle where crank and base are in line; of the rocker where crank and coupler are.
fn crank_rocker() -> Row {
    Row {
        scene: "duration = 2\n[inputs]\nphi = \"0.1 + pi*t\"\n[loops]\n\
            L = \"Rz(phi) Tx(2) Rz(mu) Tx(7) Rz(nu) Tx(-5) Rz(-psi) Tx(-6)\"\n[guess]\npsi = 1.5\n"
            .into(),
        samples: 37,
        within: 1e-9,
        assemblies: Some(2),
        answers: |motion| {
            let sorted = |name: &str| {
                let mut values: Vec<f64> = motion.limits(name).iter().map(|l| l[1]).collect();
                values.sort_by(f64::total_cmp);
                values
            };
            let (rocker, transmission) = (sorted("psi"), sorted("nu"));
            let known = [
                (rocker[0], PI - corner(5.0, 6.0, 9.0)),
                (rocker[1], PI - corner(5.0, 6.0, 5.0)),
                (transmission[0].abs(), corner(7.0, 5.0, 4.0)),
                (transmission[1].abs(), corner(7.0, 5.0, 8.0)),
            ];
            let swapped = transmission[0].abs() > transmission[1].abs();
            known
                .iter()
                .enumerate()
                .map(|(k, (found, known))| {
                    let known = match k {
                        2 if swapped => corner(7.0, 5.0, 8.0),
                        3 if swapped => corner(7.0, 5.0, 4.0),
                        _ => *known,
                    };
                    (format!("extreme {k}"), *found, known)
                })
                .collect()
        },
        planted: Some(("Tx(7)", "Tx(7.00001)")),
        ..Row::new(
            "Crank-rocker",
            "Alt 1932; Hall, *Kinematics and Linkage Design*, 1961",
            "rocker and transmission angle at their extremes by the law of cosines",
        )
    }
}
