//! Ten thousand random starts on three mechanisms: what is returned closes by a product that this file forms itself, what
//! is not returned is refused with a reason. No loop closed up to a half-turn, no stretched link.

use crate::draws::Draws;
use crate::driven::{Driven, Model};
use crate::reference::{Table, hard, mechanism, slot, turned};
use glam::{DMat4, DVec3};
use mechanim::kinematics::solve::assembly::assemble_pose;
use mechanim::kinematics::solve::newton::Corrector;
use mechanim::model::chain::{Chain, ChainStep, ElementaryMotion};
use mechanim::model::mechanism::{Kind, Mechanism};
use mechanim::scene::builtin;
use std::collections::BTreeMap;
use std::f64::consts::PI;

const STARTS: u64 = 10_000;

/// Product of a chain with matrices and the platform's sine and cosine: nothing of the engine's own mathematics.
fn product(mechanism: &Mechanism, chain: &Chain, coordinates: &[f64]) -> DMat4 {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let factors = chain.steps.iter().map(|step| match *step {
        ChainStep::Fixed(pose) => DMat4::from_mat3_translation(pose.rotation, pose.translation),
        ChainStep::Joint {
            motion,
            axis,
            argument,
            sign,
        } => {
            let value = sign * mechanism.arguments[argument].value(coordinates, &mut Vec::new());
            match motion {
                ElementaryMotion::Translation => DMat4::from_translation(value * axes[axis]),
                ElementaryMotion::Rotation => DMat4::from_axis_angle(axes[axis], value),
            }
        }
    });
    factors.fold(DMat4::IDENTITY, |product, factor| product * factor)
}

/// Largest entry by which any loop differs from the identity, translations over the size.
fn gap(mechanism: &Mechanism, coordinates: &[f64]) -> f64 {
    let gaps = mechanism.loops.iter().map(|item| {
        let mut product = product(mechanism, &item.chain, coordinates);
        product.w_axis /= mechanism.size;
        product.w_axis.w = 1.0;
        (product - DMat4::IDENTITY)
            .to_cols_array()
            .into_iter()
            .fold(0.0, |m: f64, x| m.max(x.abs()))
    });
    gaps.fold(0.0, f64::max)
}

/// Poses reached from random starts; the rest is counted by the loop that stayed open.
fn run(mechanism: &Model) -> (Vec<Vec<f64>>, BTreeMap<String, usize>) {
    let system = mechanism.system().unwrap();
    let mut corrector = Corrector::new(&system);
    let (mut poses, mut refused) = (Vec::new(), BTreeMap::new());
    let inputs = mechanism.actuation.inputs_at(0.0);
    let mut draws = Draws(20_240_229);
    for _ in 0..STARTS {
        let mut start: Vec<f64> = mechanism
            .unknowns
            .iter()
            .map(|unknown| match unknown.kind {
                Kind::Angle => 2.0 * PI * draws.number(),
                _ => 3.0 * mechanism.size * draws.number(),
            })
            .collect();
        start.extend(&inputs);
        match assemble_pose(&system, &mut corrector, &start, false) {
            Ok(found) => {
                let left = gap(mechanism, &found.coordinates);
                assert!(left < 1e-11, "{}: open by {left:e}", mechanism.title);
                assert_eq!(&found.coordinates[mechanism.unknowns.len()..], inputs);
                poses.push(found.coordinates);
            }
            Err(open) => {
                assert!(!open.name.is_empty() && open.distance.is_finite());
                let amount = open.angle.max(open.distance / mechanism.size);
                assert!(amount > 1e-9, "{}: refused at {amount:e}", mechanism.title);
                *refused.entry(open.name).or_insert(0) += 1;
            }
        }
    }
    println!(
        "{}: {} closed, refused {refused:?}",
        mechanism.title,
        poses.len()
    );
    (poses, refused)
}

#[test]
fn the_slider_crank_returns_its_two_poses_only() {
    let mechanism = hard("h01-slider-crank", &[]);
    let (poses, refused) = run(&mechanism);
    let h = slot(&mechanism, "h");
    let count = |expected: f64| {
        let near = poses.iter().filter(|p| (p[h] - expected).abs() < 1e-10);
        near.count()
    };
    let (open, crossed) = (count(112.770810770233), count(-42.5642058190028));
    assert_eq!(open + crossed, poses.len());
    assert!(open > 1000 && crossed > 1000, "{open} {crossed}");
    let refused: usize = refused.values().sum();
    assert_eq!(poses.len() + refused, STARTS as usize);
    assert!(refused < 1000, "{refused}");
}

#[test]
fn the_arm_returns_its_sixteen_poses_only() {
    let mechanism = hard("h20-six-r", &[]);
    let (poses, _) = run(&mechanism);
    let table = Table::read("hard_6r16");
    let mut met = [0; 16];
    for pose in &poses {
        let row = (0..16).find(|row| {
            (1..=6).all(|k| {
                let expected = table.value(*row, &format!("theta{k}_rad"));
                turned(pose[slot(&mechanism, &format!("t{k}"))] - expected) < 1e-9
            })
        });
        met[row.unwrap_or_else(|| panic!("{pose:?} is none of the sixteen"))] += 1;
    }
    println!("{met:?}");
    assert!(met.iter().all(|count| *count > 10), "{met:?}");
    assert!(poses.len() > 2000, "{}", poses.len());
}

#[test]
fn the_gearshift_returns_closed_poses_only() {
    let mechanism = mechanism(&builtin::find_builtin("gearshift").unwrap(), &[]);
    let (poses, refused) = run(&mechanism);
    assert!(poses.len() > 1000, "{} {refused:?}", poses.len());
}
