//! The certified bound of every pose against its true error, known to 19 digits: more than a thousand poses.

use crate::driven::{Driven, Model, even_times, solve};
use mechanim::diag::Source;
use mechanim::kinematics::certificate::pose::chain::{ArgumentDouble, LoopAtPose};
use mechanim::kinematics::results::certificate::Certificate;
use mechanim::kinematics::structure::proof_chain::LoopPlan;

use mechanim::linalg::pivoted_qr::PivotedQr;
use mechanim::model::chain::Argument;
use mechanim::model::expression::Affine;

use mechanim::numbers::double_double::DoubleDouble;
use mechanim::numbers::sin_cos::sin_cos;
use mechanim::scene::{Overrides, builtin, load_scene};

fn scene(name: &str) -> Model {
    let source = builtin::find_builtin(name).unwrap();
    Model::from(load_scene(&source, &Overrides::default()).unwrap())
}

/// Error bound and stored unknowns, then inputs, of `count` samples.
fn poses(mechanism: &Model, count: usize) -> Vec<(f64, Vec<f64>)> {
    let trajectory = solve(mechanism, &even_times(mechanism, count)).unwrap();
    assert_eq!(trajectory.missing(), 0);
    let samples = trajectory.samples.iter().map(|sample| {
        let pose = sample.pose.as_ref().unwrap();
        let Certificate::Certified { error_bound, .. } = pose.certificate else {
            panic!("refused at {}", sample.time)
        };
        (error_bound, [&pose.unknowns[..], &sample.inputs].concat())
    });
    samples.collect()
}

/// A mechanism whose coordinates are sums of two numbers each, the second far below the first.
struct Refined<'m> {
    mechanism: &'m Model,
    forms: Vec<Affine>,
    plans: Vec<(LoopPlan, Vec<usize>)>,
    qr: PivotedQr,
}

impl<'m> Refined<'m> {
    fn new(mechanism: &'m Model) -> Self {
        let forms = mechanism.arguments.iter().map(|argument| {
            let Argument::Affine(affine) = argument else {
                panic!("only affine arguments here")
            };
            let halves = affine
                .terms
                .iter()
                .flat_map(|(s, c)| [(2 * s, *c), (2 * s + 1, *c)]);
            Affine {
                constant: affine.constant,
                terms: halves.collect(),
            }
        });
        let system = mechanism.system().unwrap();
        let parts = system.blocks().iter().flat_map(|block| &block.loops);
        let plans = parts.map(|part| {
            let steps = &mechanism.loops[part.index].chain.steps;
            (LoopPlan::new(steps, |a| a), part.components.clone())
        });
        Self {
            mechanism,
            forms: forms.collect(),
            plans: plans.collect(),
            qr: PivotedQr::default(),
        }
    }

    /// Newton's method on the loops' residuals of 31 digits; the largest difference of the unknowns from where they
    /// start, radians and sizes.
    fn true_error(&mut self, start: &[f64]) -> f64 {
        let n = self.mechanism.unknowns.len();
        let mut doubled: Vec<f64> = start.iter().flat_map(|v| [*v, 0.0]).collect();
        let mut last_step = f64::INFINITY;
        for _ in 0..4 {
            let (residual, jacobian) = self.linearised(&doubled);
            let mut step = vec![0.0; n];
            self.qr.factor(&jacobian, n, n, 1e-12);
            assert_eq!(self.qr.rank(), n);
            self.qr.solve(
                &mut residual.iter().map(|r| -r).collect::<Vec<_>>(),
                &mut step,
            );
            last_step = 0.0;
            for (k, step) in step.iter().enumerate() {
                let change = DoubleDouble::product(self.mechanism.scale_of(k), *step);
                let sum = DoubleDouble::sum(doubled[2 * k], 0.0)
                    + DoubleDouble::from(doubled[2 * k + 1])
                    + change;
                (doubled[2 * k], doubled[2 * k + 1]) = (sum.hi, sum.lo);
                last_step = step.abs().max(last_step);
            }
        }
        assert!(last_step < 1e-19, "{last_step:e}");
        let error = |k: usize| {
            let exact = DoubleDouble::from(doubled[2 * k]) + DoubleDouble::from(doubled[2 * k + 1]);
            ((exact - DoubleDouble::from(start[k])).hi / self.mechanism.scale_of(k)).abs()
        };
        (0..n).map(error).fold(0.0, f64::max)
    }

    /// Residual, and column-major Jacobian by the scaled unknowns.
    fn linearised(&self, doubled: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let n = self.mechanism.unknowns.len();
        let values: Vec<ArgumentDouble> = self
            .forms
            .iter()
            .map(|form| ArgumentDouble::new(form, doubled, &[]))
            .collect();
        let (mut residual, mut jacobian) = (Vec::new(), vec![0.0; n * n]);
        for (plan, components) in &self.plans {
            let mut at_pose = LoopAtPose::default();
            at_pose.evaluate(plan, &values, |_| 0.0, self.mechanism.size);
            for joint in &at_pose.joints {
                let column = at_pose.column(joint);
                for (slot, c) in self.forms[joint.argument].terms.iter().step_by(2) {
                    let unknown = slot / 2;
                    for (k, component) in components.iter().enumerate() {
                        if unknown < n {
                            jacobian[unknown * n + residual.len() + k] +=
                                c.number() * self.mechanism.scale_of(unknown) * column[*component];
                        }
                    }
                }
            }
            residual.extend(components.iter().map(|c| at_pose.residual[*c]));
        }
        assert_eq!(residual.len(), n);
        (residual, jacobian)
    }
}

#[test]
fn bounds_are_never_below_the_true_error_and_close_to_it() {
    // Dimensions that are no whole numbers are open, and part of the bound: tight is only that of the gearshift.
    for (name, count, tight) in [
        ("gearshift", 600, 0.5),
        ("gearshift-optimised", 300, 1e-3),
        ("seven-r", 300, 1e-3),
    ] {
        let mechanism = scene(name);
        let mut refined = Refined::new(&mechanism);
        let (mut ratio, mut worst) = (0.0_f64, 0.0_f64);
        for (bound, coordinates) in poses(&mechanism, count) {
            let error = refined.true_error(&coordinates) * mechanism.size;
            assert!(error <= bound, "{name}: {error:e} above {bound:e}");
            ratio = ratio.max(error / bound);
            worst = worst.max(error);
        }
        // Half a unit in the last place of an angle up to four, and what moved with it.
        assert!(worst <= 4.5e-16 * mechanism.size, "{name}: {worst:e}");
        assert!(ratio > tight, "{name}: {ratio}");
    }
}

/// Six four-bars, the last of which drives the first: one block of 18 unknowns, more than fit into four groups.
fn ring() -> Model {
    let mut text = String::from("duration = 1\n[inputs]\nphi = \"1.9 + t/10\"\n[loops]\n");
    for k in 1..=6 {
        let driven_by = if k == 1 {
            "phi - y6".to_owned()
        } else {
            format!("y{}", k - 1)
        };
        text += &format!(
            "L{k} = \"Rz({driven_by}) Tx(40) Rz(a{k}) Tx(100) Rz(b{k}) inv(Tx(90) Rz(y{k}) Tx(70))\"\n"
        );
    }
    text += "[guess]\n";
    for k in 1..=6 {
        text += &format!("y{k} = 1.3\n");
    }
    let name = "a ring of four-bars".into();
    let scene = load_scene(&Source { name, text }, &Overrides::default());
    scene.unwrap().into()
}

#[test]
fn bounds_of_a_large_block_hold() {
    let mechanism = ring();
    let system = mechanism.system().unwrap();
    assert_eq!(system.blocks().len(), 1);
    assert_eq!(system.blocks()[0].unknowns.len(), 18);
    let mut refined = Refined::new(&mechanism);
    let mut ratio = 0.0_f64;
    for (bound, coordinates) in poses(&mechanism, 60) {
        let error = refined.true_error(&coordinates) * mechanism.size;
        assert!(error <= bound && bound < 1e-11, "{error:e} {bound:e}");
        ratio = ratio.max(error / bound);
    }
    assert!(ratio > 0.3, "{ratio}");
}

/// The root by Heron's method from that of f64.
fn root(square: DoubleDouble) -> DoubleDouble {
    let near = square.hi.sqrt();
    let rest = square - DoubleDouble::product(near, near);
    DoubleDouble::from(near) + DoubleDouble::from(rest.hi / (2.0 * near))
}

#[test]
fn bounds_of_the_slider_crank_hold_against_its_closed_form_with_more_digits() {
    let mechanism = scene("slider-crank");
    let mut tightest = 0.0_f64;
    for (bound, pose) in poses(&mechanism, 1000) {
        let place = |name: &str| {
            mechanism
                .unknowns
                .iter()
                .position(|u| u.name == name)
                .unwrap()
        };
        let value = |name: &str| pose[place(name)];
        let phi = DoubleDouble::from(pose[3]);
        let (sin, cos) = sin_cos(phi);
        // sin beta = sin phi / 2, alpha = - phi - beta, h = 40 cos phi + 80 cos beta.
        let half = sin.value() * 0.5;
        let cos_beta = root(DoubleDouble::from(1.0) - half * half);
        let stroke = cos.value() * 40.0 + cos_beta * 80.0;
        let by_stroke = (stroke - DoubleDouble::from(value("h"))).hi.abs();
        let (sin_beta, _) = sin_cos(DoubleDouble::from(value("beta")));
        let by_beta = ((sin_beta.value() - half).hi / cos_beta.hi).abs();
        let sum = DoubleDouble::from(value("alpha")) + phi + DoubleDouble::from(value("beta"));
        let turns = (sum.hi / std::f64::consts::TAU).round();
        let whole = DoubleDouble::product(turns, std::f64::consts::TAU)
            + DoubleDouble::product(turns, 2.0 * 1.224_646_799_147_353_2e-16);
        let by_alpha = ((sum - whole).hi.abs() - by_beta).max(0.0);
        let error = by_stroke.max(mechanism.size * by_beta.max(by_alpha));
        assert!(error <= bound, "phi {}: {error:e} above {bound:e}", phi.hi);
        tightest = tightest.max(error / bound);
    }
    assert!(tightest > 0.5, "{tightest}");
}
