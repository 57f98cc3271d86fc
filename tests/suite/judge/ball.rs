//! Ball joints in gimbal lock: their angles have no bound, but their rotation has.

use super::chain::{Motion, Step};
use super::number::Precise;
use super::scene::{Coordinate, Scene};
use super::value::Formula;

/// Three angles in a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball(pub [usize; 3]);

/// The unknown that a step turns by, and whether backwards.
fn turns_by(step: &Step, unknowns: usize) -> Option<(usize, bool)> {
    match (&step.motion, &step.argument) {
        (Motion::Turn(_), Formula::Coordinate(k)) if *k < unknowns => Some((*k, false)),
        (Motion::Turn(_), Formula::Negative(inner)) => match inner.as_ref() {
            Formula::Coordinate(k) if *k < unknowns => Some((*k, true)),
            _ => None,
        },
        _ => None,
    }
}

/// Ball joints of the loops: three turns with at most constant turns between them.
pub fn balls(scene: &Scene) -> Vec<Ball> {
    let mut found = Vec::new();
    for steps in &scene.loops {
        let mut row: Vec<(usize, bool)> = Vec::new();
        for step in steps {
            match turns_by(step, scene.unknowns.len()) {
                Some(turn) if row.first().is_none_or(|first| first.1 == turn.1) => row.push(turn),
                Some(turn) => row = vec![turn],
                None if step.known.is_some() && matches!(step.motion, Motion::Turn(_)) => {}
                None => row.clear(),
            }
            if let [.., a, b, c] = row.as_slice() {
                let angles = if a.1 {
                    [c.0, b.0, a.0]
                } else {
                    [a.0, b.0, c.0]
                };
                if !found.contains(&Ball(angles)) {
                    found.push(Ball(angles));
                }
                row.clear();
            }
        }
    }
    found
}

/// Sine of the angle between the first and the last axis of a ball joint.
pub fn distance_from_lock(scene: &Scene, ball: Ball, coordinates: &[Precise]) -> f64 {
    let Ball([first, _, last]) = ball;
    let unknowns = scene.unknowns.len();
    let place = |steps: &[Step], k| {
        steps
            .iter()
            .position(|s| turns_by(s, unknowns).is_some_and(|t| t.0 == k))
    };
    let chain = scene.loops.iter().find_map(|steps| {
        let (a, c) = (place(steps, first)?, place(steps, last)?);
        Some(&steps[a.min(c)..=a.max(c)])
    });
    let steps = chain.unwrap();
    let axis = |step: &Step| match step.motion {
        Motion::Turn(axis) => axis,
        _ => unreachable!(),
    };
    let frame = super::chain::Frame::at(&steps[..steps.len() - 1], coordinates);
    let column = frame.columns[axis(&steps[steps.len() - 1])]
        .each_ref()
        .map(Precise::rounded);
    let along = axis(&steps[0]);
    [(along + 1) % 3, (along + 2) % 3]
        .map(|k| column[k])
        .iter()
        .fold(0.0, |s: f64, v| s.hypot(*v))
}

/// The scene with a small rotation behind the ball joint: three new unknowns, which follow the old ones.
pub fn loosened(scene: Scene, ball: Ball) -> Scene {
    let old = scene.unknowns.len();
    let shifted = |steps: Vec<Step>| -> Vec<Step> {
        let own = |step: &Step| turns_by(step, old).filter(|t| t.0 == ball.0[2]);
        let mut all = Vec::new();
        for step in steps {
            let turn = own(&step);
            let mut step = step;
            step.argument = moved(step.argument, old);
            if let Motion::Screw(axis, pitch) = step.motion {
                step.motion = Motion::Screw(axis, moved(pitch, old));
            }
            let small = |axis: usize| Formula::Coordinate(old + axis);
            let back = |axis: usize| Formula::Negative(Box::new(small(axis)));
            if turn.is_some_and(|t| t.1) {
                all.extend([2, 1, 0].map(|axis| Step::new(Motion::Turn(axis), back(axis))));
            }
            all.push(step);
            if turn.is_some_and(|t| !t.1) {
                all.extend([0, 1, 2].map(|axis| Step::new(Motion::Turn(axis), small(axis))));
            }
        }
        all
    };
    let mut unknowns = scene.unknowns;
    unknowns.extend((0..3).map(|_| Coordinate {
        name: "rotation of a ball joint".to_owned(),
        unit: Precise::of(1.0),
        is_angle: true,
        guess: Precise::of(0.0),
    }));
    Scene {
        unknowns,
        inputs: scene.inputs,
        loops: scene.loops.into_iter().map(shifted).collect(),
        points: scene.points.into_iter().map(shifted).collect(),
        distances: scene
            .distances
            .into_iter()
            .map(|(sides, sum)| (sides.map(shifted), moved(sum, old)))
            .collect(),
        equations: scene.equations.into_iter().map(|e| moved(e, old)).collect(),
        shown: scene.shown,
    }
}

/// The formula with inputs three places further on.
fn moved(formula: Formula, from: usize) -> Formula {
    let boxed = |f: Box<Formula>| Box::new(moved(*f, from));
    match formula {
        Formula::Coordinate(k) if k >= from => Formula::Coordinate(k + 3),
        Formula::Negative(a) => Formula::Negative(boxed(a)),
        Formula::Power(a, n) => Formula::Power(boxed(a), n),
        Formula::Binary(sign, a, b) => Formula::Binary(sign, boxed(a), boxed(b)),
        Formula::Call(f, all) => {
            Formula::Call(f, all.into_iter().map(|a| moved(a, from)).collect())
        }
        leaf => leaf,
    }
}
