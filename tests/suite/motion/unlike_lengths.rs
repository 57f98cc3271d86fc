//! Loops whose lengths are many powers of ten apart, in one mechanism: each is solved, judged and proved as if it stood alone.

use crate::driven::{Driven, Model, even_times, solve};
use mechanim::diag::Source;
use mechanim::kinematics::freedoms::mobility::Mobility;
use mechanim::kinematics::results::certificate::Certificate;
use mechanim::kinematics::structure::block::StructureError;
use mechanim::scene::{Overrides, load_scene};

fn read(text: &str) -> Model {
    let source = Source {
        name: "test".into(),
        text: text.into(),
    };
    let scene = load_scene(&source, &Overrides::default());
    Model::from(scene.unwrap_or_else(|e| panic!("{:#?}", e.diagnostics)))
}

/// Two slider-cranks on one drive, or the second on the first one's rod angle; crank 1.1 and rod 2.3 times `scale`.
fn cranks(scale: f64, second_drive: &str) -> String {
    let [r, l] = [1.1, 2.3].map(|v| v * scale);
    let k = 3.0 * scale;
    format!(
        "units = {{ length = \"mm\", angle = \"rad\" }}\nduration = 1\ninputs = {{ phi = \"0.4 + 5*t\" }}\n[loops]\n\
         A = \"Rz(phi) Tx(1.1) Rz(a) Tx(2.3) Rz(b) Tx(-h)\"\n\
         B = \"Rz({second_drive}) Tx({r:e}) Rz(c) Tx({l:e}) Rz(d) Tx(-k)\"\n\
         [guess]\na = -0.5\nb = 0.1\nh = 3\nc = -0.5\nd = 0.1\nk = {k:e}\n"
    )
}

/// Where the slider is, crank and rod being 1.1 and 2.3 times `scale`.
fn slider(phi: f64, scale: f64) -> f64 {
    let (sine, cosine) = phi.sin_cos();
    scale * (1.1 * cosine + (2.3_f64 * 2.3 - 1.1 * 1.1 * sine * sine).sqrt())
}

#[test]
fn both_of_two_slider_cranks_are_right_however_far_their_sizes_are_apart() {
    for power in (-12..=12).step_by(3) {
        let scale = 10_f64.powi(power);
        for drive in ["phi", "b"] {
            let model = read(&cranks(scale, drive));
            let system = model.system().unwrap();
            assert!(system.structure().held.is_empty(), "1e{power} {drive}");
            let trajectory = solve(&model, &even_times(&model, 21)).unwrap();
            assert_eq!(trajectory.missing(), 0, "1e{power} {drive}");
            let place = |name: &str| model.unknowns.iter().position(|u| u.name == name).unwrap();
            let [h, k, b] = ["h", "k", "b"].map(place);
            for sample in &trajectory.samples {
                let pose = sample.pose.as_ref().unwrap();
                let phi = sample.inputs[0];
                let second = if drive == "b" { pose.unknowns[b] } else { phi };
                let off = |place: usize, phi: f64, scale: f64| {
                    (pose.unknowns[place] / slider(phi, scale) - 1.0).abs()
                };
                assert!(off(h, phi, 1.0) < 1e-14, "1e{power} {drive}");
                assert!(off(k, second, scale) < 1e-13, "1e{power} {drive}");
                assert!(
                    pose.closure_error < 1e-14,
                    "1e{power}: {}",
                    pose.closure_error
                );
                let Certificate::Certified { error_bound, .. } = pose.certificate else {
                    panic!("1e{power} {drive}: {:?}", pose.certificate)
                };
                // The documented measure: angles as radians times the whole mechanism's size.
                assert!(error_bound < 1e-14 * model.size, "1e{power}: {error_bound}");
                assert!(error_bound > off(k, second, scale) * 1e-3 * scale.min(1.0) * 1e-16);
            }
            let mobility = Mobility::new(&system, &model.actuation);
            let numeric = mobility.at_start.unwrap();
            assert_eq!(
                (numeric.mobility, numeric.rank),
                (1, 6),
                "1e{power} {drive}"
            );
        }
    }
}

#[test]
fn a_free_link_of_a_tiny_loop_is_no_spin_about_a_line() {
    for power in [-12, -9, -6, 0, 6, 9, 12] {
        let s = 10_f64.powi(power);
        let text = cranks(s, "phi").replace("Rz(d)", &format!("Rz(e) Tx({:e}) Rz(d)", 1.2 * s));
        let Err(StructureError::UnderDetermined { freedoms, names }) = read(&text).system() else {
            panic!("1e{power}")
        };
        assert_eq!((freedoms, names.len()), (1, 4), "1e{power}: {names:?}");
    }
}

#[test]
fn a_tiny_loop_that_cannot_close_is_open_by_its_own_measure() {
    for power in [-12, -9, -3, 0, 9] {
        let s = 10_f64.powi(power);
        // A crank longer than the rod: the slider cannot follow all the way.
        let text = cranks(s, "phi").replace(
            &format!("Tx({:e}) Rz(c)", 1.1 * s),
            &format!("Tx({:e}) Rz(c)", 3.1 * s),
        );
        let model = read(&text);
        let trajectory = solve(&model, &even_times(&model, 21)).unwrap();
        assert!(trajectory.missing() > 0, "1e{power}");
    }
}
