//! Linkages that draw straight lines, nearly or exactly, and other curves.

use super::motion::{Answer, Motion, Row};
use super::plane::{Point, along, apart, corner, meet, placed};
use std::f64::consts::PI;

pub fn rows() -> Vec<Row> {
    vec![
        watt(),
        chebyshev(),
        roberts(),
        hoecken_60(),
        hoecken_180(),
        hoecken_20(),
        scott_russell(),
        hart(),
        trammel(),
        cardan_gears(),
        pantograph(),
        jansen(),
    ]
}

/// A four-bar on the x axis with a traced point of its coupler; lengths crank, coupler, rocker, base.
fn four_bar(drive: &str, [a, b, c, d]: [&str; 4], point: &str, guess: &str) -> String {
    format!(
        "duration = 2\n[inputs]\nphi = \"{drive}\"\n[loops]\n\
         L = \"Rz(phi) Tx({a}) Rz(mu) Tx({b}) Rz(nu) Tx(-{c}) Rz(-psi) Tx(-{d})\"\n[guess]\n{guess}\n\
         [[bodies]]\nname = \"coupler\"\nframe = \"Rz(phi) Tx({a}) Rz(mu)\"\n\
         [[traces]]\nname = \"P\"\nbody = \"coupler\"\npoint = {point}\n"
    )
}

/// Watt's curve in polar coordinates about the middle of the base: rods b at ±a, coupler 2c.
fn watt() -> Row {
    Row {
        scene: four_bar(
            "0.5 + 0.4*sin(t)",
            ["12", "10", "12", "26"],
            "[5, 0, 0]",
            "mu = 0.8\npsi = 2.8",
        ),
        assemblies: Some(2),
        answers: |motion| {
            let (a, b, c) = (13.0_f64, 12.0_f64, 5.0_f64);
            motion.each(|at| {
                let [x, y] = [at.get("P.x") - a, at.get("P.y")];
                let theta = y.atan2(x);
                let root = (c * c - (a * theta.cos()).powi(2)).sqrt();
                let squares = [1.0, -1.0].map(|s| b * b - (a * theta.sin() + s * root).powi(2));
                let near = |r: &f64| (r - x * x - y * y).abs();
                let known = squares
                    .into_iter()
                    .min_by(|r, s| near(r).total_cmp(&near(s)));
                vec![("square of the radius", x * x + y * y, known.unwrap())]
            })
        },
        within: 1e-11,
        planted: Some(("[5, 0, 0]", "[5.001, 0, 0]")),
        ..Row::new(
            "Watt's parallel motion",
            "J. Watt 1784; Lockwood, *A Book of Curves*, 1961",
            "r² = b² − (a sin θ ± √(c² − a² cos² θ))²",
        )
    }
}

fn chebyshev() -> Row {
    Row {
        scene: four_bar(
            "0.75 + 0.9*sin(t)*sin(t)",
            ["5", "2", "5", "4"],
            "[1, 0, 0]",
            "mu = 2.2\npsi = 1.9",
        ),
        within: 1e-12,
        assemblies: Some(2),
        answers: |motion| {
            let mut all = motion.each(|at| {
                let pin = along([0.0, 0.0], 5.0, at.get("phi"));
                let other = meet(pin, 2.0, [4.0, 0.0], 5.0)[1];
                let middle = [0, 1].map(|k| 0.5 * (pin[k] + other[k]));
                vec![
                    ("x", at.get("P.x"), middle[0]),
                    ("y", at.get("P.y"), middle[1]),
                ]
            });
            let ends = motion.feasible(1.0);
            all.push(("fold".into(), ends[0], corner(5.0, 4.0, 3.0)));
            all.push(("fold".into(), ends[1], corner(5.0, 4.0, 7.0)));
            all
        },
        planted: Some(("Tx(2)", "Tx(2.000000001)")),
        ..Row::new(
            "Chebyshev's linkage 4:5:2",
            "Chebyshev 1854; Norton, *Design of Machinery*, ch. 3",
            "coupler middle by compass; the arm swings between cos φ = 4/5 and −1/5",
        )
    }
}

/// Arms and sides of the coupler's triangle are alike, the base is twice the coupler.
fn roberts() -> Row {
    let height = "sqrt(1.44 - 0.25)";
    let keys = "{ keys = [[0, \"atan2(sqrt(0.44), 1)\"], [1, \"acos(0.5/1.2)\"], \
        [2, \"atan2(sqrt(0.44), 1) + 2*asin(0.5/1.2)\"]] }";
    let scene = four_bar(
        "KEYS",
        ["1.2", "1", "1.2", "2"],
        &format!("[0.5, \"-{height}\", 0]"),
        "mu = -1\npsi = 1.6",
    );
    Row {
        scene: scene.replace("\"KEYS\"", keys),
        assemblies: Some(2),
        answers: |motion| {
            let mut all = motion.each(|at| {
                let pin = along([0.0, 0.0], 1.2, at.get("phi"));
                let other = meet(pin, 1.0, [2.0, 0.0], 1.2)[0];
                let point = placed(pin, other, [0.5, -(1.44_f64 - 0.25).sqrt()]);
                vec![
                    ("x", at.get("P.x"), point[0]),
                    ("y", at.get("P.y"), point[1]),
                ]
            });
            let poses = motion.poses();
            for (sample, x) in [(0, 2.0), (4, 1.0), (8, 0.0)] {
                all.push(("x on the base".into(), poses[sample].get("P.x"), x));
                all.push(("y on the base".into(), poses[sample].get("P.y"), 0.0));
            }
            all
        },
        planted: Some(("[0.5,", "[0.5001,")),
        ..Row::new(
            "Roberts' linkage",
            "Roberts, before 1841; Kempe, *How to Draw a Straight Line*, 1877",
            "the apex is on the base line at its ends and its middle",
        )
    }
}

/// Way of the coupler point and its deviation in percent of it, over `range` degrees about the outer dead centre.
fn hoecken(range: f64, base: f64, arm: f64) -> [f64; 2] {
    let points = (0..=360).map(|k| {
        let phi = PI + range.to_radians() * (f64::from(k) / 360.0 - 0.5);
        let pin = along([0.0, 0.0], 1.0, phi);
        let joint = meet(pin, arm, [base, 0.0], arm)[0];
        [0, 1].map(|i| 2.0 * joint[i] - pin[i])
    });
    let points: Vec<Point> = points.collect();
    extent(&points)
}

fn extent(points: &[Point]) -> [f64; 2] {
    let span = |k: usize| {
        let values = points.iter().map(|p| p[k]);
        values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
    };
    [span(0), 100.0 * span(1) / span(0)]
}

fn hoecken_answers(
    motion: &Motion,
    [range, base, arm]: [f64; 3],
    printed: [f64; 4],
) -> Vec<Answer> {
    let points = motion
        .poses()
        .into_iter()
        .map(|at| [at.get("P.x"), at.get("P.y")]);
    let points: Vec<Point> = points.collect();
    let found = extent(&points);
    let own = hoecken(range, base, arm);
    let [way, way_digit, deviation, deviation_digit] = printed;
    // To half a unit of the last printed digit.
    let rounded = |v: f64, digit: f64| (v / digit).round() * digit;
    vec![
        ("way by compass".into(), found[0], own[0]),
        ("deviation by compass".into(), found[1], own[1]),
        ("printed way".into(), rounded(found[0], way_digit), way),
        (
            "printed deviation".into(),
            rounded(found[1], deviation_digit),
            deviation,
        ),
    ]
}

fn hoecken_row(name: &'static str, answer: &'static str, [range, base, arm]: [&str; 3]) -> Row {
    Row {
        scene: four_bar(
            &format!("pi + {range}*pi/180*(t/2 - 0.5)"),
            ["1", arm, arm, base],
            &format!("[{}, 0, 0]", 2.0 * arm.parse::<f64>().unwrap()),
            "mu = -2.5\npsi = 2",
        ),
        samples: 361,
        within: 1e-11,
        assemblies: Some(2),
        ..Row::new(
            name,
            "Hoecken 1926; Norton, *Design of Machinery*, table 3-1",
            answer,
        )
    }
}

fn hoecken_60() -> Row {
    Row {
        answers: |motion| hoecken_answers(motion, [60.0, 2.9, 3.85], [1.763, 1e-3, 2.7e-4, 1e-5]),
        ..hoecken_row(
            "Hoecken's linkage, 60°",
            "travel 1.763 cranks, deviation 0.00027 % of it",
            ["60", "2.9", "3.85"],
        )
    }
}

fn hoecken_180() -> Row {
    Row {
        answers: |motion| hoecken_answers(motion, [180.0, 2.2, 2.8], [4.181, 1e-3, 0.096, 1e-3]),
        ..hoecken_row(
            "Hoecken's linkage, 180°",
            "travel 4.181 cranks, deviation 0.096 % of it",
            ["180", "2.2", "2.8"],
        )
    }
}

fn hoecken_20() -> Row {
    Row {
        answers: |motion| hoecken_answers(motion, [20.0, 2.975, 3.9625], [0.601, 1e-3, 1e-5, 1e-5]),
        ..hoecken_row(
            "Hoecken's linkage, 20°",
            "travel 0.601 cranks, deviation 0.00001 % of it (erratum below)",
            ["20", "2.975", "3.9625"],
        )
    }
}

fn scott_russell() -> Row {
    Row {
        scene: "duration = 2\n[inputs]\nphi = \"0.3 + t/2\"\n[loops]\n\
            L = \"Rz(phi) Tx(3) Rz(mu) Tx(3) Rz(nu) Tx(-h)\"\n[guess]\nh = 6\n\
            [[bodies]]\nname = \"rod\"\nframe = \"Rz(phi) Tx(3) Rz(mu)\"\n\
            [[traces]]\nname = \"P\"\nbody = \"rod\"\npoint = [-3, 0, 0]\n"
            .into(),
        answers: |motion| {
            motion.each(|at| {
                let phi = at.get("phi");
                vec![
                    ("x", at.get("P.x"), 0.0),
                    ("y", at.get("P.y"), 6.0 * phi.sin()),
                    ("slider", at.get("h"), 6.0 * phi.cos()),
                ]
            })
        },
        assemblies: Some(2),
        planted: Some(("[-3, 0, 0]", "[-3.000001, 0, 0]")),
        ..Row::new(
            "Scott Russell's linkage",
            "Evans 1801, Scott Russell 1803; Kempe 1877",
            "x = 0, y = 2 r sin φ",
        )
    }
}

/// Three points of an antiparallelogram on a line along its diagonals: with one fixed, the others are inverse to each other.
fn hart() -> Row {
    Row {
        scene: "duration = 2\n[parameters]\na = 4\nb = 2.5\nm = 0.4\ne = 1\n\
            [inputs]\nth = \"1.4 + 0.4*sin(3*t)\"\n[chains]\nab = \"Rz(s)\"\nad = \"ab Tx(-m*a) Rz(u)\"\n\
            bc = \"ab Tx((1-m)*a) Rz(x)\"\n[loops]\nR = \"ad Tx(b) Rz(v) Tx(a) Rz(w) Tx(b) inv(bc)\"\n\
            C = \"bc Tx(-(1-m)*b) inv(Tx(e) Rz(th) Tx(e) Rz(y))\"\n\
            [guess]\ns = 1.37\nu = 1.21\nv = -2.5\nw = 1.93\nx = 0.64\n\
            [[bodies]]\nname = \"short\"\nframe = \"ad\"\n[[bodies]]\nname = \"other\"\nframe = \"bc\"\n\
            [[traces]]\nname = \"Q\"\nbody = \"short\"\npoint = [\"m*b\", 0, 0]\n\
            [[traces]]\nname = \"P\"\nbody = \"other\"\npoint = [\"-(1-m)*b\", 0, 0]\n"
            .into(),
        answers: |motion| {
            let power = 0.4 * 0.6 * (16.0 - 6.25);
            motion.each(|at| {
                let [p, q] = ["P", "Q"].map(|n| [at.get(&format!("{n}.x")), at.get(&format!("{n}.y"))]);
                vec![
                    ("product", apart(p, [0.0; 2]) * apart(q, [0.0; 2]), power),
                    ("straight line", q[0], -power / 2.0),
                ]
            })
        },
        planted: Some(("m = 0.4", "m = 0.401")),
        ..Row::new(
            "Hart's inversor",
            "Hart 1874; Kempe 1877",
            "OP·OQ = m (1 − m)(a² − b²); P on a circle through O, Q on a line",
        )
    }
}

fn trammel() -> Row {
    Row {
        scene: "duration = 2\n[inputs]\nphi = \"0.2 + 3*t\"\n[loops]\n\
            L = \"Tx(u) Rz(phi) Tx(5) Rz(-phi) Ty(-v)\"\n\
            [[bodies]]\nname = \"rod\"\nframe = \"Tx(u) Rz(phi)\"\n\
            [[traces]]\nname = \"P\"\nbody = \"rod\"\npoint = [7, 0, 0]\n"
            .into(),
        answers: |motion| {
            motion.each(|at| {
                let [x, y] = [at.get("P.x") / 2.0, at.get("P.y") / 7.0];
                vec![("ellipse", x * x + y * y, 1.0)]
            })
        },
        assemblies: Some(1),
        planted: Some(("[7, 0, 0]", "[7, 0.00001, 0]")),
        ..Row::new(
            "Elliptic trammel",
            "Archimedes' trammel; Hartenberg and Denavit, *Kinematic Synthesis of Linkages*, 1964",
            "(x/2)² + (y/7)² = 1",
        )
    }
}

/// A wheel that rolls in a ring of twice its radius.
fn cardan_gears() -> Row {
    Row {
        scene: "duration = 2\n[parameters]\nr = 3\n[inputs]\nphi = \"4*t\"\n[equations]\n\
            mesh = \"2*r*phi - r*(phi + turn)\"\n\
            [[bodies]]\nname = \"wheel\"\nframe = \"Rz(phi) Tx(r) Rz(-phi - turn)\"\n\
            [[traces]]\nname = \"P\"\nbody = \"wheel\"\npoint = [\"r\", 0, 0]\n\
            [[traces]]\nname = \"Q\"\nbody = \"wheel\"\npoint = [1, 0, 0]\n"
            .into(),
        answers: |motion| {
            motion.each(|at| {
                let phi = at.get("phi");
                let [x, y] = [at.get("Q.x") / 4.0, at.get("Q.y") / 2.0];
                vec![
                    ("wheel", at.get("turn"), phi),
                    ("x", at.get("P.x"), 6.0 * phi.cos()),
                    ("y", at.get("P.y"), 0.0),
                    ("ellipse", x * x + y * y, 1.0),
                ]
            })
        },
        planted: Some(("r*(phi + turn)", "1.000001*r*(phi + turn)")),
        ..Row::new(
            "Cardan gears (Tusi couple)",
            "Cardano 1570; Hartenberg and Denavit 1964",
            "a rim point moves on a diameter, an inner one on an ellipse",
        )
    }
}

/// Two long bars and two short ones; the tracing point goes through any curve, here a circle.
fn pantograph() -> Row {
    Row {
        scene: "duration = 2\n[inputs]\nphi = \"pi*t\"\n[chains]\nlong = \"Rz(s)\"\nsecond = \"long Tx(9) Rz(u)\"\n\
            [loops]\nT = \"second Tx(9) inv(T(8, 5, 0) Rz(phi) Tx(3) Rz(v))\"\n\
            P = \"long Tx(3) Rz(w) Tx(6) Rz(x) inv(second Tx(6) Rz(y) Tx(-6))\"\n\
            [guess]\ns = 1.26\nu = -1.67\nw = -1.67\ny = 1.67\n\
            [[bodies]]\nname = \"short\"\nframe = \"long Tx(3) Rz(w)\"\n\
            [[traces]]\nname = \"Q\"\nbody = \"short\"\npoint = [3, 0, 0]\n"
            .into(),
        answers: |motion| {
            motion.each(|at| {
                let pen = along([8.0, 5.0], 3.0, at.get("phi"));
                vec![
                    ("x", at.get("Q.x"), pen[0] / 3.0),
                    ("y", at.get("Q.y"), pen[1] / 3.0),
                ]
            })
        },
        planted: Some(("[3, 0, 0]", "[3.00001, 0, 0]")),
        ..Row::new(
            "Pantograph",
            "Scheiner 1631; Hartenberg and Denavit 1964",
            "the copy is a third of the drawing",
        )
    }
}

/// The leg with its eleven numbers, joint by joint: pins A (upper), C (left), D (lower), E (knee), F (foot).
fn jansen_by_compass(phi: f64, sides: [usize; 3]) -> Point {
    let ground = [0.0, 0.0];
    let crank = along([38.0, 7.8], 15.0, phi);
    let upper = meet(ground, 41.5, crank, 50.0)[sides[0]];
    let left = placed(
        ground,
        upper,
        along([0.0, 0.0], 40.1, corner(41.5, 40.1, 55.8)),
    );
    let lower = meet(ground, 39.3, crank, 61.9)[sides[1]];
    let knee = meet(left, 39.4, lower, 36.7)[sides[2]];
    let foot = along([0.0, 0.0], 49.0, corner(36.7, 49.0, 65.7));
    placed(lower, knee, foot)
}

fn jansen() -> Row {
    Row {
        scene: "duration = 2\n[parameters]\ndelta = \"acos((41.5^2 + 40.1^2 - 55.8^2)/(2*41.5*40.1))\"\n\
            eps = \"acos((36.7^2 + 49^2 - 65.7^2)/(2*36.7*49))\"\n[inputs]\nphi = \"0.4 + pi*t\"\n\
            [chains]\ncrank = \"T(38, 7.8, 0) Rz(phi) Tx(15)\"\nupper = \"Rz(b)\"\nlower = \"Rz(c)\"\n\
            knee = \"lower Tx(39.3) Rz(g)\"\n[loops]\nU = \"crank Rz(j) Tx(50) Rz(j2) inv(upper Tx(41.5))\"\n\
            D = \"crank Rz(k) Tx(61.9) Rz(k2) inv(lower Tx(39.3))\"\n\
            K = \"knee Tx(36.7) Rz(f2) inv(upper Rz(delta) Tx(40.1) Rz(f) Tx(39.4))\"\n\
            [guess]\nb = 1.7\nc = -2\ng = -1.6\n\
            [[bodies]]\nname = \"foot\"\nframe = \"knee\"\n\
            [[traces]]\nname = \"F\"\nbody = \"foot\"\npoint = [\"49*cos(eps)\", \"49*sin(eps)\", 0]\n"
            .into(),
        within: 1e-11,
        assemblies: Some(8),
        answers: |motion| {
            motion.each(|at| {
                let foot = jansen_by_compass(at.get("phi"), [0, 1, 1]);
                vec![
                    ("x", at.get("F.x"), foot[0]),
                    ("y", at.get("F.y"), foot[1]),
                ]
            })
        },
        planted: Some(("Tx(61.9)", "Tx(61.91)")),
        ..Row::new(
            "Jansen's leg",
            "Th. Jansen, *The Great Pretender*, 2007 (the eleven numbers)",
            "the foot by compass; three dyads have 2³ assemblies",
        )
    }
}
