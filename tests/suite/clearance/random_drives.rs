//! Random drives, smooth ones and ones with kinks and jumps, as texts and as functions.

use glam::{DMat3, DVec3};

/// Reproducible numbers.
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn unit(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let mut x = self.0;
        x ^= x >> 33;
        x = x.wrapping_mul(0xff51_afd7_ed55_8ccd);
        x ^= x >> 33;
        (x >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(super) fn range(&mut self, low: f64, high: f64) -> f64 {
        // Few digits: the scene's text has them all.
        (1e4 * (low + (high - low) * self.unit())).round() / 1e4
    }

    pub(super) fn pick(&mut self, count: usize) -> usize {
        ((self.unit() * count as f64) as usize).min(count - 1)
    }

    pub(super) fn vector(&mut self, reach: f64) -> DVec3 {
        DVec3::from_array([(); 3].map(|()| self.range(-reach, reach)))
    }
}

/// A drive: its text, its value, and times at which it has kinks or jumps.
pub(super) struct Drive {
    pub(super) text: String,
    pub(super) value: Box<dyn Fn(f64) -> f64>,
    /// It changes quickly near these times.
    pub(super) places: Vec<f64>,
}

impl Drive {
    /// As the scene has it.
    pub(super) fn toml(&self) -> String {
        match self.text.starts_with('{') {
            true => self.text.clone(),
            false => format!("\"{}\"", self.text),
        }
    }
}

/// Of every scene.
pub(super) const DURATION: f64 = 2.0;

/// A drive that is smooth, or has kinks or jumps.
pub(super) fn drive(random: &mut Random) -> Drive {
    let (a, w, p) = (
        random.range(0.2, 1.5),
        random.range(0.5, 9.0),
        random.range(-3.0, 3.0),
    );
    let at = random.range(0.2, 1.8);
    match random.pick(12) {
        0 => Drive {
            text: format!("{p} + {w}*t"),
            value: Box::new(move |t| p + w * t),
            places: vec![],
        },
        1 => Drive {
            text: format!("{a}*sin({w}*t + {p})"),
            value: Box::new(move |t| a * (w * t + p).sin()),
            places: vec![],
        },
        2 => Drive {
            text: format!("{p} + {a}*abs(t - {at})"),
            value: Box::new(move |t| p + a * (t - at).abs()),
            places: vec![at],
        },
        3 => Drive {
            text: format!("min({a}, max(-{a}, {w}*(t - {at})))"),
            value: Box::new(move |t| (w * (t - at)).clamp(-a, a)),
            places: vec![at - a / w, at, at + a / w],
        },
        4 => Drive {
            text: format!("{p} + {a}*exp(-(60*(t - {at}))^2)"),
            value: Box::new(move |t| p + a * (-(60.0 * (t - at)).powi(2)).exp()),
            places: vec![at],
        },
        5 => Drive {
            text: format!("{p} + {a}*floor({w}*t + 0.5)"),
            value: Box::new(move |t| p + a * (w * t + 0.5).floor()),
            places: (0..40)
                .map(|k| (f64::from(k) + 0.5) / w)
                .filter(|t| *t < DURATION)
                .collect(),
        },
        // The values at the jumps are those before them, at the very beginning as well.
        6 => Drive {
            text: format!("{p} - {a}*floor(-{w}*t)"),
            value: Box::new(move |t| p - a * (-w * t).floor()),
            places: (0..40)
                .map(|k| f64::from(k) / w)
                .filter(|t| *t < DURATION)
                .collect(),
        },
        7 => Drive {
            text: format!("{p} + mod({w}*t, {a})"),
            value: Box::new(move |t| p + (w * t).rem_euclid(a)),
            places: (1..200)
                .map(|k| f64::from(k) * a / w)
                .filter(|t| *t < DURATION)
                .collect(),
        },
        // What kinks or jumps of what kinks or jumps.
        8 => Drive {
            text: format!("{p} + {a}*mod(floor({w}*t), 2)"),
            value: Box::new(move |t| p + a * (w * t).floor().rem_euclid(2.0)),
            places: (1..40)
                .map(|k| f64::from(k) / w)
                .filter(|t| *t < DURATION)
                .collect(),
        },
        9 => Drive {
            text: format!("{a}*abs(abs(t - {at}) - 0.3)"),
            value: Box::new(move |t| a * ((t - at).abs() - 0.3).abs()),
            places: vec![at - 0.3, at, at + 0.3],
        },
        10 => Drive {
            text: format!("max({a}*sin({w}*t), {a}*cos(3*t + {p}))"),
            value: Box::new(move |t| a * (w * t).sin().max((3.0 * t + p).cos())),
            places: vec![],
        },
        _ => keys(random, a),
    }
}

/// Two drives that jump at the same instants, which their texts say in different ways.
pub(super) fn joint_drives(random: &mut Random) -> [Drive; 2] {
    let (digits, first) = (2000 + random.pick(7000), random.pick(4));
    let second = (first + 1 + random.pick(3)) % 4;
    [first, second].map(|form| jumping(random, digits, form))
}

/// A drive that jumps whenever a time of so many tenths of a millisecond has passed again.
fn jumping(random: &mut Random, digits: usize, form: usize) -> Drive {
    let (p, a) = (random.range(-3.0, 3.0), random.range(0.2, 1.5));
    let long = format!("{}.{:03}", digits / 1000, digits % 1000);
    let time = |k: usize| format!("{}.{:04}", k * digits / 10_000, k * digits % 10_000);
    let (step, count) = (digits as f64 / 1e4, 20_000 / digits);
    // Just before a jump is a billionth of a second before it.
    let passed = move |t: f64| (t / step + 1e-9).floor();
    let (text, value): (String, Box<dyn Fn(f64) -> f64>) = match form {
        0 => (
            format!("{p} + {a}*floor(t/{})", time(1)),
            Box::new(move |t| p + a * passed(t)),
        ),
        1 => (
            format!("{p} - {a}*floor(10*t/{long})"),
            Box::new(move |t| p - a * passed(t)),
        ),
        2 => (
            format!("{p} + {a}*mod(3*t, 3*{})", time(1)),
            Box::new(move |t| p + 3.0 * a * (t - step * passed(t))),
        ),
        _ => {
            let values: Vec<f64> = (0..=count).map(|_| random.range(-a, a)).collect();
            let keys = values.iter().enumerate();
            let keys: Vec<String> = keys.map(|(k, v)| format!("[{}, {v}]", time(k))).collect();
            (
                format!("{{ keys = [{}], ease = \"step\" }}", keys.join(", ")),
                Box::new(move |t| values[(passed(t).max(0.0) as usize).min(count)]),
            )
        }
    };
    Drive {
        text,
        value,
        places: (1..=count).map(|k| step * k as f64).collect(),
    }
}

/// Straight lines or steps between a few keys.
fn keys(random: &mut Random, size: f64) -> Drive {
    let mut times: Vec<f64> = (0..3).map(|_| random.range(0.1, 1.9)).collect();
    times.extend([0.0, DURATION]);
    times.sort_by(f64::total_cmp);
    times.dedup();
    let values: Vec<f64> = times.iter().map(|_| random.range(-size, size)).collect();
    let is_step = random.pick(2) == 0;
    let pairs: Vec<String> = std::iter::zip(&times, &values)
        .map(|(t, v)| format!("[{t}, {v}]"))
        .collect();
    let ease = if is_step { "step" } else { "linear" };
    let places = times.clone();
    let value = move |t: f64| {
        // A little before the first key it is held.
        let t = t.max(0.0);
        let next = times.partition_point(|key| *key <= t);
        if next == times.len() {
            return values[next - 1];
        }
        let share = (t - times[next - 1]) / (times[next] - times[next - 1]);
        let share = if is_step { 0.0 } else { share };
        values[next - 1] + share * (values[next] - values[next - 1])
    };
    Drive {
        text: format!("{{ keys = [{}], ease = \"{ease}\" }}", pairs.join(", ")),
        value: Box::new(value),
        places,
    }
}

/// About an axis of the frame.
pub(super) fn turn(axis: usize, angle: f64) -> DMat3 {
    match axis {
        0 => DMat3::from_rotation_x(angle),
        1 => DMat3::from_rotation_y(angle),
        _ => DMat3::from_rotation_z(angle),
    }
}

/// How many are asked for by hand.
pub(super) fn asked(name: &str, usual: u64) -> u64 {
    std::env::var(name)
        .ok()
        .and_then(|v| v.parse().ok())
        .unwrap_or(usual)
}
