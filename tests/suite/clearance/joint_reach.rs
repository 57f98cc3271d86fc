//! What a joint hides: only the parts of two shapes that lie near it. Two bars of one joint that come to lie in each other are seen,
//! whatever else touches there, and whatever angle they have to the joint's axis.

use crate::program::Workspace;

/// Two bars from the origin, at an angle to the axis z, the second turned by `end` degrees in the end.
fn bars(tilt: f64, end: f64, hub: &str) -> String {
    let (sine, cosine) = tilt.to_radians().sin_cos();
    let (x, z) = (100.0 * sine, 100.0 * cosine);
    format!(
        r#"
units = {{ length = "mm", angle = "deg" }}
duration = 1
[inputs]
a = "{end}*t"
[[bodies]]
name = "frame"
shapes = [{hub}{{ capsule = {{ from = [0, 0, 0], to = [{}, 0, {z}], radius = 3 }} }}]
[[bodies]]
name = "arm"
frame = "Rz(a)"
shapes = [{{ capsule = {{ from = [0, 0, 0], to = [{x}, 0, {z}], radius = 3 }} }}]
[[bodies]]
name = "post"
shapes = [{{ sphere = {{ center = [0, 0, -300], radius = 3 }} }}]
[clearance]
minimum = 0
"#,
        -x
    )
}

const HUBS: [&str; 3] = [
    "",
    "{ cylinder = { from = [0, 0, -5], to = [0, 0, -2], radius = 40 } }, ",
    "{ sphere = { radius = 12 } }, { box = { center = [0, 0, -4], size = [60, 60, 4] } }, ",
];

#[test]
fn bars_that_meet_beyond_their_joint_are_seen() {
    let w = Workspace::new();
    for hub in HUBS {
        for tilt in [90.0, 60.0, 35.0, 25.0, 15.0, 8.0] {
            for left in [0.0, 6.0, 40.0] {
                w.write("bars.toml", bars(tilt, 180.0 - left, hub));
                let run = w.run(&["check", "bars.toml"]);
                // The angle between the bars, from that about the axis: below 30 degrees they are in each other outside of the
                // excluded parts.
                let radius: f64 = tilt.to_radians().sin();
                let between = 2.0 * (radius * (0.5_f64 * left.to_radians()).sin()).asin();
                let code = match between.to_degrees() {
                    between if between < 20.0 => 1,
                    between if between > 32.0 => 0,
                    _ => continue,
                };
                assert_eq!(
                    run.code,
                    code,
                    "{hub} tilted by {tilt}, {left} left: {}",
                    run.text()
                );
            }
        }
    }
}

/// Shapes that lie in each other away from their joint are no parts of it, wherever they begin, and at whatever distance they pass
/// it. The first angle counts, so that they touch in the assembled pose already.
#[test]
fn what_touches_away_from_the_joint_is_judged() {
    let w = Workspace::new();
    let capsule = |from: [f64; 3], to: [f64; 3]| {
        format!("{{ capsule = {{ from = {from:?}, to = {to:?}, radius = 1 }} }}")
    };
    let boxed = |x: f64| {
        format!(
            "{{ box = {{ center = [{}, 0, 0], size = [{}, 2, 2] }} }}",
            0.5 * (x + 120.0),
            120.0 - x
        )
    };
    let mut pairs = Vec::new();
    for start in [5.2, 9.0, 20.0, 60.0] {
        pairs.push([
            capsule([start, 0.0, 0.0], [120.0, 0.0, 0.0]),
            capsule([start, 0.0, 0.0], [120.0, 2.0, 0.0]),
        ]);
        pairs.push([boxed(start), capsule([start, 0.0, 0.0], [120.0, 1.0, 0.0])]);
    }
    // A rod beside the axis, crossed by a post that is parallel to it.
    pairs.push([
        capsule([60.0, -50.0, 0.0], [60.0, 50.0, 0.0]),
        capsule([60.0, 0.0, -50.0], [60.0, 0.0, 50.0]),
    ]);
    pairs.push([
        capsule([60.0, 0.0, -50.0], [60.0, 0.0, 50.0]),
        capsule([61.0, 0.0, -50.0], [61.0, 0.0, 50.0]),
    ]);
    for chain in [
        "Rz(phi)",
        "Rz(phi) Tz(lift)",
        "Rz(phi) Rx(nod)",
        "Rz(phi) Ry(tilt) Rx(nod)",
    ] {
        let others = ["lift", "nod", "tilt"]
            .into_iter()
            .filter(|input| chain.contains(input));
        let inputs: String = others
            .map(|input| format!("{input} = \"0.001*t\"\n"))
            .collect();
        // Beside one axis; a point on another one belongs to that.
        let single = chain.len() < "Rz(phi) Rx(nod)".len() || chain.contains("lift");
        let count = if single { pairs.len() } else { pairs.len() - 2 };
        for [first, second] in &pairs[..count] {
            let text = format!(
                "units = {{ length = \"mm\", angle = \"rad\" }}\nduration = 1\n[inputs]\nphi = \"0.01*t\"\n{inputs}\
                 [[bodies]]\nname = \"A\"\nshapes = [{{ sphere = {{ radius = 1 }} }}, {first}]\n\
                 [[bodies]]\nname = \"B\"\nframe = \"{chain}\"\n\
                 shapes = [{{ sphere = {{ radius = 1 }} }}, {second}]\n[clearance]\nminimum = 0\n"
            );
            w.write("away.toml", &text);
            let run = w.run(&["check", "away.toml"]);
            assert_eq!(run.code, 1, "{chain}: {first} and {second}: {}", run.text());
        }
    }
}

/// A shaft and what stands beside it are parts of their joint whether they are exactly parallel to its axis or nearly so.
#[test]
fn a_slight_tilt_changes_no_verdict() {
    let w = Workspace::new();
    for tilt in [0.0, 1e-7, 1e-5, 1e-3, 0.01, 0.1, 0.5] {
        let text = format!(
            "units = {{ length = \"mm\", angle = \"rad\" }}\nduration = 1\n[inputs]\nphi = \"0.5*t\"\n\
             [[bodies]]\nname = \"shaft\"\nshapes = [{{ cylinder = {{ from = [0, 0, -60], to = [0, 0, 60], radius = 10 }} }}]\n\
             [[bodies]]\nname = \"rod\"\nframe = \"Rz(phi)\"\n\
             shapes = [{{ capsule = {{ from = [12.1, 0, -20], to = [{}, 0, 20], radius = 2 }} }}]\n\
             [[bodies]]\nname = \"post\"\nshapes = [{{ sphere = {{ center = [0, 0, 200], radius = 3 }} }}]\n[clearance]\nminimum = 0.2\n",
            12.1 + tilt
        );
        w.write("tilt.toml", text);
        let run = w.run(&["check", "tilt.toml"]);
        assert_eq!(run.code, 0, "{tilt}: {}", run.text());
    }
}
