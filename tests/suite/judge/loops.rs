//! Random closed loops as scenes: joints, links and formulas of all kinds, with a last link of named decimals.

use super::chain::Frame;
use super::dual::Dual;
use super::number::Number;
use super::scene::Scene;
use crate::draws::Draws;

/// A loop in the making.
struct Draft<'a> {
    draws: &'a mut Draws,
    is_in_degrees: bool,
    /// Lengths are plain and short numbers.
    is_whole: bool,
    /// Lengths are of this size.
    scale: f64,
    chain: Vec<String>,
    guess: Vec<String>,
}

/// The scene of a random loop: every second one in degrees, every third planar, every fourth of another size.
pub fn random_loop(draws: &mut Draws, number: usize) -> String {
    let scale = if number % 4 == 3 {
        10f64.powi(draws.below(13) as i32 - 6)
    } else {
        10.0
    };
    let mut draft = Draft {
        draws,
        is_in_degrees: number % 2 == 1,
        is_whole: number % 5 == 4,
        scale,
        chain: vec!["Rz(phi)".to_owned()],
        guess: Vec::new(),
    };
    if number.is_multiple_of(3) {
        draft.planar()
    } else {
        draft.spatial()
    }
    let start = draft.angle(1.0);
    let swing = if draft.is_in_degrees { "10" } else { "0.2" };
    draft.closed(&start, &format!("\"{start} + {swing}*sin(t)\""))
}

impl Draft<'_> {
    /// A decimal of so many digits.
    fn decimal(&mut self, size: f64, digits: i32) -> String {
        let step = 10f64.powi(size.abs().log10().ceil() as i32 - digits);
        let count = (self.draws.number() * size / step).round();
        plain(count, step)
    }

    fn angle(&mut self, radians: f64) -> String {
        self.decimal(
            if self.is_in_degrees {
                57.3 * radians
            } else {
                radians
            },
            3,
        )
    }

    /// A length as a user may write it: decimals, differences, quotients, roots.
    fn length(&mut self) -> String {
        let scale = self.scale;
        let number = self.decimal(scale, if self.is_whole { 1 } else { 3 });
        match self.draws.below(if self.is_whole { 1 } else { 6 }) {
            _ if self.is_whole => number,
            0 => format!("{number}/3"),
            1 => format!("{number}*sqrt(2)"),
            2 => format!(
                "{} - {}",
                plain(10003.0, scale / 1000.0),
                plain(9602.0, scale / 1000.0)
            ),
            3 => format!("{number}*cos(30deg)"),
            _ => number,
        }
    }

    fn unknown(&mut self, start: String) -> String {
        let name = format!("q{}", self.guess.len());
        self.guess.push(format!("{name} = {start}"));
        name
    }

    /// One unknown turn: plain, backwards, or beside a constant.
    fn turn(&mut self, axis: char) {
        let start = self.angle(2.0);
        let name = self.unknown(start);
        let beside = self.angle(1.0);
        self.chain.push(match self.draws.below(4) {
            0 => format!("R{axis}(-{name})"),
            1 => format!("R{axis}({name} + {beside})"),
            _ => format!("R{axis}({name})"),
        });
    }

    fn slide(&mut self, axis: char) {
        let start = self.decimal(self.scale, 3);
        let name = self.unknown(start);
        self.chain.push(format!("T{axis}({name})"));
    }

    fn planar(&mut self) {
        let slider = self.draws.below(5);
        for k in 0..3 {
            let link = [self.length(), self.length()];
            self.chain.push(format!("T({}, {}, 0)", link[0], link[1]));
            if k == slider {
                self.slide('x')
            } else {
                self.turn('z')
            }
        }
    }

    fn spatial(&mut self) {
        let mut left = 6;
        let (mut slides, mut balls) = (0, 0);
        while left > 0 {
            self.link();
            let axis = ['x', 'y', 'z'][self.draws.below(3)];
            match self.draws.below(8) {
                0 | 1 if left >= 3 && balls == 0 => {
                    for _ in 0..3 {
                        let start = self.angle(1.0);
                        let name = self.unknown(start);
                        self.chain.push(format!(
                            "R{}({name})",
                            ['x', 'y', 'z'][self.guess.len() % 3]
                        ));
                    }
                    (left, balls) = (left - 2, 1);
                }
                2 if slides < 2 => {
                    self.slide(axis);
                    slides += 1;
                }
                3 => {
                    let (start, pitch) = (self.angle(2.0), self.decimal(self.scale, 3));
                    let name = self.unknown(start);
                    self.chain.push(format!("H{axis}({pitch}, {name})"));
                }
                4 => {
                    let start = self.angle(2.0);
                    let name = self.unknown(start);
                    let direction = [self.decimal(1.0, 2), self.decimal(1.0, 2)];
                    self.chain.push(format!(
                        "R({}, {}, 0.7, {name})",
                        direction[0], direction[1]
                    ));
                }
                _ => self.turn(axis),
            }
            left -= 1;
        }
        self.link();
    }

    fn link(&mut self) {
        let shift = [self.length(), self.length(), self.length()];
        self.chain
            .push(format!("T({}, {}, {})", shift[0], shift[1], shift[2]));
        let angles = [self.angle(2.0), self.angle(2.0)];
        let turn = match self.draws.below(4) {
            0 => format!("R(1, -2, 0.5, {})", angles[0]),
            1 if self.is_in_degrees => format!("Hz({}, {}deg)", self.length(), angles[0]),
            1 => format!("Hz({}, {})", self.length(), angles[0]),
            _ => format!("Rx({}) Rz({})", angles[0], angles[1]),
        };
        self.chain.push(turn);
    }

    /// The scene with a last link that closes it at the start values to six digits.
    fn closed(&self, start: &str, drive: &str) -> String {
        let unit = if self.is_in_degrees { "deg" } else { "rad" };
        let chain = self.chain.join(" ");
        let guess = self.guess.join("\n");
        let open = format!(
            "units = {{ angle = \"{unit}\" }}\n[parameters]\nphi = {start}\n[loops]\nA = \"{chain}\"\n[guess]\n{guess}\n"
        );
        let (columns, origin) = end(&open);
        let [x, y, z] = origin.map(|v| plain((v / self.scale * 1e6).round(), self.scale / 1e6));
        // Rz(c) Ry(b) Rx(a)
        let file = if self.is_in_degrees {
            180.0 / std::f64::consts::PI
        } else {
            1.0
        };
        let [a, b, c] = [
            columns[1][2].atan2(columns[2][2]),
            (-columns[0][2]).asin(),
            columns[0][1].atan2(columns[0][0]),
        ]
        .map(|v| plain((v * file * 1e6).round(), 1e-6));
        format!(
            "duration = 1\nunits = {{ length = \"mm\", angle = \"{unit}\" }}\n\
             [parameters]\nx = {x}\ny = {y}\nz = {z}\na = {a}\nb = {b}\nc = {c}\n[inputs]\nphi = {drive}\n\
             [loops]\nA = \"{chain} inv(T(x, y, z) Rz(c) Ry(b) Rx(a))\"\n[guess]\n{guess}\n"
        )
    }
}

/// `count` steps as a decimal.
fn plain(count: f64, step: f64) -> String {
    let exponent = step.log10().round() as i32;
    match exponent {
        -9..=-1 => format!("{:.*}", -exponent as usize, count * step),
        _ if count == 0.0 => "0".to_owned(),
        _ => format!("{count}e{exponent}"),
    }
}

/// Rotation, as columns, and place at the end of the only loop.
fn end(text: &str) -> ([[f64; 3]; 3], [f64; 3]) {
    let scene = Scene::read(text);
    let start: Vec<Dual> = scene
        .unknowns
        .iter()
        .map(|u| Dual::of_precise(&u.guess))
        .collect();
    let frame = Frame::at(&scene.loops[0], &start);
    let values = |v: [Dual; 3]| v.map(|c| c.value);
    (frame.columns.map(values), values(frame.origin))
}
