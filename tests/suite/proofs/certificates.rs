//! Certificates of poses: never below the true error, not far above it, and refused where there is nothing to prove.

use crate::driven::{Driven, Model, even_times, solve};
use mechanim::diag::Source;
use mechanim::kinematics::certificate::Certifier;
use mechanim::kinematics::certificate::pose::chain::{ArgumentDouble, LoopAtPose};
use mechanim::kinematics::results::certificate::{Certificate, Reason};
use mechanim::kinematics::structure::proof_chain::LoopPlan;

use mechanim::kinematics::results::trajectory::Trajectory;
use mechanim::kinematics::solve::branch::BranchWatch;
use mechanim::kinematics::solve::newton::Corrector;
use mechanim::model::drive::{Drive, Ease};
use mechanim::model::expression::Affine;

use crate::reference::{Table, drive_by_rows};
use mechanim::model::mechanism::Mechanism;
use mechanim::numbers::constant::Constant;
use mechanim::scene::{Overrides, Scene, builtin, load_scene};
use std::f64::consts::{PI, TAU};

fn read(text: &str) -> Scene {
    let source = Source {
        name: "test".into(),
        text: text.into(),
    };
    load_scene(&source, &Overrides::default()).unwrap_or_else(|e| panic!("{:#?}", e.diagnostics))
}

fn scene(name: &str) -> Scene {
    load_scene(&builtin::find_builtin(name).unwrap(), &Overrides::default()).unwrap()
}

fn slider_crank(r: f64, l: f64) -> Scene {
    read(&format!(
        "duration = 4\n[parameters]\nr = {r}\nL = {l}\n[inputs]\nphi = \"2*pi*t/4\"\n\
         [loops]\nA = \"Rz(phi) Tx(r) Rz(alpha) Tx(L) Rz(beta) Tx(-h)\"\n[guess]\nh = {}\n",
        r + l
    ))
}

/// The motion whose samples are the rows of a table.
fn solve_rows(mechanism: &mut Model, table: &Table) -> Trajectory {
    let times = drive_by_rows(mechanism, table);
    solve(mechanism, &times).unwrap()
}

/// Error bound and radius of uniqueness of every sample.
fn certified(trajectory: &Trajectory) -> Vec<(f64, f64)> {
    assert_eq!(trajectory.missing(), 0);
    let all = trajectory.poses().map(|pose| match pose.certificate {
        Certificate::Certified {
            error_bound,
            unique_radius,
        } => (error_bound, unique_radius),
        other => panic!("{other:?}, sigma {}", pose.sigma_min),
    });
    all.collect()
}

fn worst(bounds: &[(f64, f64)]) -> (f64, f64) {
    bounds
        .iter()
        .fold((0.0, f64::INFINITY), |(e, u), b| (b.0.max(e), b.1.min(u)))
}

/// The certificate of given coordinates, on the basis that those same coordinates choose.
fn certify(mechanism: &Model, coordinates: &[f64]) -> Certificate {
    let system = mechanism.system().unwrap();
    let mut watch = BranchWatch::default();
    let mut corrector = Corrector::new(&system);
    watch.observe(&system, &mut corrector, coordinates);
    Certifier::new(&system).certify(coordinates, &[], watch.bases())
}

/// Largest error of a sample's unknowns against a function of their names, in the measure of the bound.
fn error(
    mechanism: &Mechanism,
    unknowns: &[f64],
    mut truth: impl FnMut(&str) -> Option<f64>,
) -> f64 {
    let mut largest = 0.0_f64;
    for (k, coordinate) in mechanism.unknowns.iter().enumerate() {
        if let Some(expected) = truth(&coordinate.name) {
            let mut difference = (unknowns[k] - expected) / mechanism.scale_of(k);
            if mechanism.scale_of(k) == 1.0 {
                difference -= TAU * (difference / TAU).round();
            }
            largest = largest.max(difference.abs() * mechanism.size);
        }
    }
    largest
}

#[test]
fn built_in_motions_are_certified_throughout() {
    // The poses themselves are off by up to 1e-11 in this measure: a hundred units of an angle's last place times 1119 mm.
    for (name, error_bound, unique_radius) in [
        ("gearshift", 1e-12, 0.25),
        ("gearshift-optimised", 1e-11, 0.25),
        ("slider-crank", 1e-12, 1.0),
        ("seven-r", 2e-12, 1e-2),
        ("dyads", 1e-12, 0.7),
    ] {
        let mechanism = Model::from(scene(name));
        let trajectory = solve(&mechanism, &even_times(&mechanism, 300)).unwrap();
        let (e, u) = worst(&certified(&trajectory));
        assert!(e <= error_bound, "{name}: {e:e}");
        assert!(u >= unique_radius, "{name}: {u}");
    }
}

#[test]
fn bounds_hold_against_the_references_of_seventeen_digits() {
    let printed = 1e-16;
    for (name, file) in [
        ("gearshift", "gearshift_orig_30"),
        ("gearshift-optimised", "gearshift_opt_30"),
    ] {
        let table = Table::read(file);
        let mut mechanism = Model::from(scene(name));
        let trajectory = solve_rows(&mut mechanism, &table);
        let bounds = certified(&trajectory);
        for (row, pose) in trajectory.poses().enumerate() {
            let e = error(&mechanism, &pose.unknowns, |n| Some(table.value(row, n)));
            let bound = bounds[row].0;
            assert!(
                e <= bound + printed * mechanism.size,
                "{file} row {row}: {e:e} {bound:e}"
            );
            // Half a unit in the last place of a radian is the least that any f64 pose is off by.
            assert!(
                bound <= 1e4 * 1.1e-16 * mechanism.size,
                "{file} row {row}: {bound:e}"
            );
        }
    }
    let table = Table::read("crank_cycle");
    let mut mechanism = Model::from(scene("slider-crank"));
    let trajectory = solve_rows(&mut mechanism, &table);
    for (row, (pose, bound)) in trajectory.poses().zip(certified(&trajectory)).enumerate() {
        let e = error(&mechanism, &pose.unknowns, |n| {
            Some(table.value(row, &format!("{n}_open")))
        });
        // Inputs and angles of up to 2 pi are known to half a unit, 4.5e-16 each, from their decimals.
        let rounded = 1e-15 * mechanism.size;
        assert!(e <= bound.0 + rounded, "row {row}: {e:e} {:e}", bound.0);
    }
}

#[test]
fn bounds_hold_against_the_torus_pair() {
    let table = Table::read("torus_ref");
    let mut mechanism = Model::from(scene("seven-r"));
    let rows: Vec<usize> = (0..table.len())
        .filter(|r| table.text(*r, "mechanism") == "torus-torus")
        .collect();
    let times: Vec<f64> = rows.iter().map(|r| *r as f64).collect();
    mechanism.actuation.drives = vec![Drive::Keys {
        times: times.clone(),
        values: rows
            .iter()
            .map(|r| table.value(*r, "beta1_deg").to_radians())
            .collect(),
        ease: Ease::Linear,
    }];
    mechanism.actuation.duration = times[times.len() - 1];
    let trajectory = solve(&mechanism, &times).unwrap();
    for (row, (pose, bound)) in rows
        .iter()
        .zip(trajectory.poses().zip(certified(&trajectory)))
    {
        let e = error(&mechanism, &pose.unknowns, |name| {
            ["beta2", "theta1", "theta2"]
                .contains(&name)
                .then(|| table.value(*row, &format!("{name}_deg")).to_radians())
        });
        // The driver's degrees and the reference's degrees are rounded once when they become radians.
        let rounded = 1e-15 * mechanism.size;
        assert!(e <= bound.0 + rounded, "row {row}: {e:e} {:e}", bound.0);
    }
}

#[test]
fn bounds_hold_against_the_closed_form_of_the_slider_crank() {
    let mechanism = Model::from(slider_crank(40.0, 80.0));
    let trajectory = solve(&mechanism, &even_times(&mechanism, 1200)).unwrap();
    let bounds = certified(&trajectory);
    let (mut ratio, mut count) = (0.0_f64, 0);
    for (sample, bound) in trajectory.samples.iter().zip(bounds) {
        let phi = sample.inputs[0];
        let beta = (0.5 * phi.sin()).asin();
        let e = error(&mechanism, &sample.pose.as_ref().unwrap().unknowns, |n| {
            Some(match n {
                "beta" => beta,
                "alpha" => -phi - beta,
                _ => 40.0 * phi.cos() + 80.0 * (1.0 - (0.5 * phi.sin()).powi(2)).sqrt(),
            })
        });
        // The closed form in f64 is itself off by a few units of 120, and by one of the angle alpha, up to 8.
        let own = 4e-14 + 2e-15 * mechanism.size;
        assert!(e <= bound.0 + own, "phi {phi}: {e:e} {:e}", bound.0);
        ratio = ratio.max(bound.0 / (1.1e-16 * mechanism.size));
        count += 1;
    }
    assert_eq!(count, 1200);
    assert!(ratio < 1e4, "{ratio}");
}

#[test]
fn wrong_pose_is_seen_by_its_bound() {
    for name in ["gearshift", "seven-r", "slider-crank"] {
        let mechanism = Model::from(scene(name));
        let trajectory = solve(&mechanism, &[0.0]).unwrap();
        let sample = &trajectory.samples[0];
        let good = [&sample.pose.as_ref().unwrap().unknowns[..], &sample.inputs].concat();
        for k in 0..mechanism.unknowns.len() {
            let mut coordinates = good.clone();
            coordinates[k] += 1e-6 * mechanism.scale_of(k);
            let Certificate::Certified { error_bound, .. } = certify(&mechanism, &coordinates)
            else {
                panic!("{name} {k}: a millionth off is well within the radius")
            };
            let least = 1e-6 * mechanism.size * (1.0 - 1e-7);
            assert!(
                error_bound >= least && error_bound < 30.0 * least,
                "{name} {k}: {error_bound:e}"
            );
        }
    }
}

#[test]
fn half_turn_and_far_poses_are_refused() {
    let mut mechanism = Model::from(scene("slider-crank"));
    mechanism.actuation.drives = vec![Drive::Keys {
        times: vec![0.0],
        values: vec![0.5],
        ease: Ease::Linear,
    }];
    let half_turn = [
        2.883_662_637_077_099,
        -0.242_069_983_487_306_2,
        42.564_205_819_002_81,
        0.5,
    ];
    let refused = |reason| Certificate::Refused { reason };
    assert_eq!(certify(&mechanism, &half_turn), refused(Reason::HalfTurn));
    assert_eq!(
        certify(&mechanism, &[0.5, 0.1, 60.0, 0.5]),
        refused(Reason::Singular)
    );
}

#[test]
fn change_point_is_refused_and_its_surroundings_lose_digits() {
    let mechanism = Model::from(slider_crank(80.0, 80.0));
    let trajectory = solve(&mechanism, &even_times(&mechanism, 80)).unwrap();
    let mut refused = 0;
    for sample in &trajectory.samples {
        let distance = (sample.inputs[0] - 0.5 * PI)
            .abs()
            .min((sample.inputs[0] - 1.5 * PI).abs());
        let pose = sample.pose.as_ref().unwrap();
        match pose.certificate {
            Certificate::Refused { reason } => {
                assert_eq!(reason, Reason::Singular);
                assert!(distance < 1e-6, "{distance}");
                refused += 1;
            }
            Certificate::Certified { error_bound, .. } => {
                assert!(distance > 1e-6, "{distance}");
                let e = (pose.unknowns[2] - 160.0 * sample.inputs[0].cos()).abs();
                assert!(e <= error_bound + 1e-13, "{e:e} {error_bound:e}");
            }
            other => panic!("no ball joint and no redundant row is here: {other:?}"),
        }
    }
    assert_eq!(refused, 2, "at 90 and 270 degrees");
    for distance in [1e-2, 1e-4, 1e-6] {
        let phi = 0.5 * PI - distance;
        let pose = [-2.0 * phi, phi, 160.0 * phi.cos(), phi];
        let Certificate::Certified {
            error_bound,
            unique_radius,
        } = certify(&mechanism, &pose)
        else {
            panic!("{distance}")
        };
        let error = error_bound / mechanism.size;
        assert!(error < 4e-15 / distance, "{distance}: {error:e}");
        // The other branch, h = 0, meets this one at ninety degrees: it is 2 d away in angle.
        let radius = unique_radius / mechanism.size;
        assert!(
            radius > 0.05 * distance && radius < 2.0 * distance,
            "{distance}: {radius}"
        );
    }
}

#[test]
fn formulas_are_proved_but_for_kinks_and_so_are_affine_equations() {
    // What the argument of the second turn is, and the exact unknown.
    for (formula, exact) in [
        ("sin(q)", 0.2_f64.asin()),
        ("q^3 - q", 1.088_033_914_691_289_4),
        ("exp(q) - 1", 1.2_f64.ln()),
        ("hypot(q, 0.1)", 0.03_f64.sqrt()),
        ("atan2(q, 2)", 2.0 * 0.2_f64.tan()),
    ] {
        let mechanism = Model::from(read(&format!(
            "[inputs]\nphi = 0.3\n[loops]\nA = \"Rz(phi) Rz({formula}) Rz(-0.5)\"\n[guess]\nq = {}\n",
            exact + 0.01
        )));
        let trajectory = solve(&mechanism, &[0.0]).unwrap();
        let (bound, radius) = certified(&trajectory)[0];
        let off = (trajectory.poses().next().unwrap().unknowns[0] - exact).abs();
        assert!(
            off <= bound * mechanism.size + 3e-16,
            "{formula}: {off:e} {bound:e}"
        );
        assert!(
            bound < 1e-13 && radius > 1e-3,
            "{formula}: {bound:e} {radius}"
        );
    }
    let kink =
        read("[inputs]\nphi = 0\n[loops]\nA = \"Rz(phi) Rz(abs(q) + 2*q)\"\n[guess]\nq = 0.001\n");
    let trajectory = solve(&kink, &[0.0]).unwrap();
    let reason = Reason::Formula;
    let pose = trajectory.poses().next().unwrap();
    assert_eq!(pose.certificate, Certificate::Refused { reason });
    let affine = read(
        "[inputs]\nphi = 1\n[loops]\nquad = \"Rz(q) Tx(40) Rz(a) Tx(100) Rz(b) Tx(70) Rz(c) Tx(-90)\"\n\
         [equations]\nhold = \"q - phi/3\"\n[guess]\nq = 0.3\na = 0.3\nb = -1\n",
    );
    let trajectory = solve(&affine, &[0.0]).unwrap();
    let (error, _) = worst(&certified(&trajectory));
    assert!(error < 1e-12, "{error:e}");
    let q = trajectory.poses().next().unwrap().unknowns[0];
    assert!((q - 1.0 / 3.0).abs() * affine.mechanism.size <= error);
}

#[test]
fn over_determined_loops_are_proved_on_their_row_basis() {
    // Bennett: lengths 1, sqrt 3, twists 30, 60 degrees; tan(t1/2) tan(t2/2) = 1 + sqrt 3.
    let bennett = read(
        "[parameters]\na = 1\nb = 1.7320508075688772\n[inputs]\nphi = 1\n[loops]\n\
         A = \"Rz(phi) Tx(a) Rx(pi/6) Rz(t2) Tx(b) Rx(pi/3) Rz(t3) Tx(a) Rx(pi/6) Rz(t4) Tx(b) Rx(pi/3)\"\n\
         [guess]\nt2 = 2.7\nt3 = -1\nt4 = -2.7\n",
    );
    let trajectory = solve(&bennett, &[0.0]).unwrap();
    let pose = trajectory.poses().next().unwrap();
    let bounds = [pose.certificate.bounds().unwrap()];
    let closes_to = pose.certificate.closes_to().unwrap();
    assert!((1e-17..1e-13).contains(&closes_to), "{closes_to:e}");
    let t2 = 2.746_877_324_015_33;
    let e = (pose.unknowns[0] - t2).abs() * bennett.mechanism.size;
    assert!(
        e <= bounds[0][0] + 1e-14 && bounds[0][0] < 1e-12,
        "{e:e} {:e}",
        bounds[0][0]
    );
    assert!(bounds[0][1] > 1e-3);
}

#[test]
fn second_derivatives_are_bounded_as_said() {
    let slider = "[inputs]\nphi = 0.3\n[loops]\nA = \"Rz(phi) Tx(10) Ry(a) Tx(h) Rx(b) Tz(g) Rz(c) Tx(-30) Ry(d) Rx(e)\"\n\
                  [equations]\nhold = \"g - 5\"\n[guess]\nh = 20\ng = 5\n";
    let mut tightest = 0.0_f64;
    for mechanism in [
        Model::from(scene("gearshift")),
        Model::from(scene("seven-r")),
        Model::from(read(slider)),
    ] {
        let size = mechanism.size;
        let count = mechanism.arguments.len();
        let mut state = 0x1234_5678_9abc_def1_u64;
        let mut random = move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        // Every argument by itself as a coordinate; angles and lengths alike are of order one here.
        let value = |x: f64| {
            ArgumentDouble::new(
                &Affine {
                    constant: Constant::exact(0.0),
                    terms: vec![(0, Constant::exact(1.0))],
                },
                &[x],
                &[],
            )
        };
        for _ in 0..200 {
            let x: Vec<f64> = (0..count).map(|_| 2.0 * random()).collect();
            let h: Vec<f64> = (0..count).map(|_| 0.2 * random()).collect();
            let moved: Vec<f64> = x.iter().zip(&h).map(|(x, h)| x + h).collect();
            for item in &mechanism.loops {
                let plan = LoopPlan::new(&item.chain.steps, |a| a);
                let at = |x: &[f64]| {
                    let values: Vec<_> = x.iter().map(|x| value(*x)).collect();
                    let mut at_pose = LoopAtPose::default();
                    at_pose.evaluate(&plan, &values, |a| h[a].abs(), size);
                    at_pose
                };
                let (here, there) = (at(&x), at(&moved));
                let bounds = here.second_derivatives(|a| h[a].abs());
                let mut linear = here.residual;
                for joint in &here.joints {
                    for (sum, c) in linear.iter_mut().zip(here.column(joint)) {
                        *sum += c * h[joint.argument];
                    }
                }
                for k in 0..6 {
                    let rest = (there.residual[k] - linear[k]).abs();
                    let bound = 0.5 * bounds[k / 3];
                    assert!(rest <= bound + 1e-14, "row {k}: {rest} {bound}");
                    tightest = tightest.max(rest / bound);
                }
            }
        }
    }
    assert!(
        tightest > 0.2,
        "a bound that is never approached would prove little: {tightest}"
    );
}
