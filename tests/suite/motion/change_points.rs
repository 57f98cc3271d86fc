//! Passages through change points, where two motions cross: wherever a row is on the other motion than the row before, an
//! event or a gap stands between them, no tube is proved over the place, and the place is told. Few samples and many, drives
//! that go through evenly, come to rest there, and come back.

use crate::driven::{Driven, Model, even_times, solve, solve_unproved};
use crate::reference::{hard, slot};
use mechanim::kinematics::certificate::tube::certify_motion;
use mechanim::kinematics::results::trajectory::{EventKind, Trajectory};
use std::f64::consts::{FRAC_PI_2, PI};

/// Two motions of an unknown that cross where the first input is at `place`.
struct Crossing {
    scene: &'static str,
    input: &'static str,
    unknown: &'static str,
    /// Where, and how far the drive goes to either side, in the file's unit.
    place: f64,
    reach: f64,
    /// The same in radians.
    unit: f64,
    /// The unknown on either motion; it starts on the first one.
    motions: [fn(f64) -> f64; 2],
}

const CROSSINGS: [Crossing; 2] = [
    Crossing {
        scene: "h31-platform",
        input: "phi",
        unknown: "yaw",
        place: FRAC_PI_2,
        reach: 1.3,
        unit: 1.0,
        motions: [|phi| phi, |phi| PI - phi],
    },
    Crossing {
        scene: "h03-change-point",
        input: "phi",
        unknown: "h",
        place: 90.0,
        reach: 70.0,
        unit: PI / 180.0,
        motions: [|phi| 160.0 * phi.cos(), |_| 0.0],
    },
];

/// From -1 to 1 in a second: evenly, at rest in the middle, slow at the ends, out of the middle of the time; and there and back.
const DRIVES: [&str; 6] = [
    "2*t - 1",
    "(2*t - 1)^3",
    "(2*t - 1)^5",
    "-cos(pi*t)",
    "2*t^2 - 1",
    "-cos(2*pi*t)",
];

impl Crossing {
    fn driven(&self, drive: &str) -> Model {
        let formula = format!("{} + {}*({drive})", self.place, self.reach);
        let start = (self.motions[0])((self.place - self.reach) * self.unit);
        let guess = format!("{start:?}");
        let changes = [
            ("input", self.input, formula.as_str()),
            ("guess", self.unknown, guess.as_str()),
        ];
        let mut model = hard(self.scene, &changes);
        model.actuation.duration = 1.0;
        model
    }

    /// Which of the two motions a row is on; `None` near their crossing.
    fn motion_of(&self, input: f64, value: f64) -> Option<usize> {
        let [a, b] = self.motions.map(|motion| (value - motion(input)).abs());
        let apart = (self.motions[0](input) - self.motions[1](input)).abs();
        if apart < 1e-3 {
            return None;
        }
        assert!(a.min(b) < 1e-6, "{}: {input} {value}", self.scene);
        Some(usize::from(b < a))
    }

    fn judge(&self, label: &str, model: &Model, trajectory: &Trajectory) {
        let unknown = slot(model, self.unknown);
        let place = self.place * self.unit;
        let passed = trajectory.events.iter().filter(|event| {
            matches!(
                event.kind,
                EventKind::SingularPosePassed | EventKind::SingularPoseMet
            )
        });
        let mut told: Vec<f64> = Vec::new();
        for event in passed {
            assert!((0.0..=1.0).contains(&event.time), "{label}: {event:?}");
            let off = (event.inputs[0] - place).abs();
            assert!(off < 5e-3, "{label}: {event:?}");
            told.push(event.time);
        }
        let is_told = |from: f64, to: f64| {
            let in_gap = trajectory.gaps.iter().any(|gap| {
                let begins = gap.from.as_ref().map_or(0.0, |at| at.time);
                let ends = gap.until.as_ref().map_or(1.0, |at| at.time);
                begins <= to && ends >= from
            });
            in_gap || told.iter().any(|time| (from..=to).contains(time))
        };
        let rows = trajectory.samples.iter().filter_map(|sample| {
            let value = sample.pose.as_ref()?.unknowns[unknown];
            let motion = self.motion_of(sample.inputs[0], value)?;
            Some((sample.time, sample.inputs[0] - place, motion))
        });
        let rows: Vec<(f64, f64, usize)> = rows.collect();
        assert!(rows.len() + 2 >= trajectory.samples.len() / 2, "{label}");
        for pair in rows.windows(2) {
            let [(from, before, old), (to, behind, new)] = pair else {
                continue;
            };
            // Through the place, or onto the other motion.
            if before * behind < 0.0 || old != new {
                assert!(
                    is_told(*from, *to),
                    "{label}: {from} {to} {:?}",
                    trajectory.events
                );
            }
        }
    }
}

#[test]
fn no_motion_is_exchanged_for_another_in_silence() {
    for crossing in CROSSINGS {
        for drive in DRIVES {
            let model = crossing.driven(drive);
            for samples in [2, 3, 4, 5, 6, 9, 14, 33] {
                let times = even_times(&model, samples);
                let trajectory = solve_unproved(&model, &times).unwrap();
                let label = format!("{} along {drive}, {samples}", crossing.scene);
                crossing.judge(&label, &model, &trajectory);
            }
        }
    }
}

#[test]
fn no_tube_is_proved_through_a_change_point() {
    for crossing in CROSSINGS {
        for drive in &DRIVES[..3] {
            let model = crossing.driven(drive);
            for samples in [2, 3, 6] {
                let trajectory = solve(&model, &even_times(&model, samples)).unwrap();
                let system = model.system().unwrap();
                let tubes = certify_motion(&system, model.actuation(), &trajectory);
                // All of these drives are at the place in the middle of the time.
                let pairs = trajectory.samples.windows(2).zip(&tubes);
                for (pair, tube) in pairs {
                    let holds = (pair[0].time..=pair[1].time).contains(&0.5);
                    let label = format!("{} along {drive}, {samples}", crossing.scene);
                    assert!(!holds || tube.refused.is_some(), "{label}");
                }
            }
        }
    }
}

/// x² = φ⁴: two motions that touch. Whichever is taken behind the touch, it is said that it was passed, or that nothing is
/// known of it.
#[test]
fn a_touch_of_two_motions_is_told_at_any_number_of_samples() {
    for start in ["t - 1", "t - 0.7", "1.3*t - 1", "1e-3*(t - 1)"] {
        for samples in [2, 3, 4, 5, 7, 12] {
            let model = crate::reference::scenes::written(&format!(
                "duration = 2\n[inputs]\nphi = \"{start}\"\n[equations]\ne = \"x^2 - phi^4\"\n[guess]\nx = 1\n"
            ));
            let trajectory = solve(&model, &even_times(&model, samples)).unwrap();
            let label = format!("{start}, {samples}: {:?}", trajectory.events);
            for pair in trajectory.samples.windows(2) {
                let [from, to] = [&pair[0], &pair[1]];
                if from.inputs[0] * to.inputs[0] >= 0.0 {
                    continue;
                }
                let within = |time: f64| (from.time..=to.time).contains(&time);
                let mut events = trajectory.events.iter();
                assert!(events.any(|event| within(event.time)), "{label}");
            }
            for (sample, pose) in trajectory.samples.iter().zip(trajectory.poses()) {
                let (x, phi) = (pose.unknowns[0], sample.inputs[0]);
                assert!((x.abs() - phi * phi).abs() < 1e-7, "{label}");
            }
        }
    }
}
