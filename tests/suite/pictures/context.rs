//! What tells sizes and times in a picture: dimensions with their values, the scale bar, marks on paths, the order of a
//! film's pictures.

use crate::driven::{frame_times, solve};
use mechanim::diag::Source;
use mechanim::kinematics::results::trajectory::Trajectory;
use mechanim::model::view::{HiddenSolids, NamedView, Playback, ShownAxes};
use mechanim::pictures::playback::PlayOrder;
use mechanim::render::{Frame, Label};
use mechanim::scene::{Overrides, Scene, builtin, load_scene};
use mechanim::staging::{PictureOptions, Staging};
use std::sync::Arc;

/// The four-bar linkage with more in its file.
fn four_bar(more: &str) -> Source {
    let mut source = builtin::find_builtin("four-bar").unwrap();
    source.text = format!("{}\n{more}", source.text);
    source
}

fn solved(more: &str) -> (Scene, Trajectory) {
    let source = four_bar(more);
    let scene = load_scene(&source, &Overrides::default());
    let scene = scene.unwrap_or_else(|e| panic!("{more}: {:#?}", e.diagnostics));
    let trajectory = solve(&scene, &frame_times(&scene, 10.0)).unwrap();
    (scene, trajectory)
}

const SIZE: [u32; 2] = [640, 480];

fn staged<'a>(scene: &'a Scene, trajectory: &'a Trajectory) -> Staging<'a> {
    let options = PictureOptions {
        size: SIZE,
        samples: 4,
    };
    Staging::new(scene, trajectory, options)
}

fn label<'f>(frame: &'f Frame, begin: &str) -> Option<&'f Label> {
    frame.labels.iter().find(|l| l.text.starts_with(begin))
}

/// The value in a label such as `a = 12.5 mm`.
fn value(frame: &Frame, begin: &str) -> f64 {
    let text = &label(frame, begin).unwrap().text;
    let number = text.split(['=', '°']).nth(1).unwrap().trim();
    let number = number.split(' ').next().unwrap().replace('−', "-");
    number.parse().unwrap()
}

const DIMENSIONS: &str = r#"
[[dimensions]]
from = { point = [0, 0, 20] }
to = { point = ["ground", 0, 20] }
offset = [0, -40, 0]
text = "ground = {}"

[[dimensions]]
from = { trace = "K" }
to = { body = "rocker", point = [0, 0, 12] }
text = "far = {}"
digits = 4

[[dimensions]]
at = { point = [0, 0, 20] }
from = { point = [1, 0, 20] }
to = { body = "crank", point = [1, 0, 20] }
axis = [0, 0, 1]
text = "turn = {}"

[[dimensions]]
at = { body = "coupler", point = ["coupler", 0, 20] }
from = { body = "coupler", point = [0, 0, 20] }
to = { body = "rocker", point = [0, 0, 20] }
text = "open = {}"
"#;

/// Every dimension says what the pose amounts to, and follows it.
#[test]
fn dimensions_follow_the_motion() {
    let (scene, trajectory) = solved(DIMENSIONS);
    let staging = staged(&scene, &trajectory);
    for (index, sample) in trajectory.samples.iter().enumerate() {
        let pose = sample.pose.as_ref().unwrap();
        let frame = staging.frame(index);
        let time = sample.time;
        assert_eq!(value(&frame, "ground"), 105.0, "{time}");
        let far = pose.traces[0].distance(pose.bodies[3].transform_point((0.0, 0.0, 12.0).into()));
        assert!((value(&frame, "far") - far).abs() < 5.1e-5, "{time}");
        let turn = (90.0 * time).rem_euclid(360.0);
        let off = (value(&frame, "turn") - turn).rem_euclid(360.0);
        assert!(off.min(360.0 - off) < 0.051, "{time}");
        let joint = pose.bodies[2].transform_point((95.0, 0.0, 20.0).into());
        let to = |body: usize| pose.bodies[body].transform_point((0.0, 0.0, 20.0).into()) - joint;
        let open = to(2).angle_between(to(3)).to_degrees();
        assert!((value(&frame, "open") - open).abs() < 0.051, "{time}");
        // The lines of a length end at the projected places, to within the half of an arrow head.
        let camera = frame.camera(&staging.stage);
        let foot = camera.project((0.0, -40.0, 20.0).into(), SIZE).unwrap();
        let near = frame.strokes.iter().flat_map(|stroke| stroke.ends);
        let near = near.map(|end| (end[0] - foot[0]).hypot(end[1] - foot[1]));
        assert!(near.fold(f64::INFINITY, f64::min) < 0.01, "{time}");
    }
}

/// Rounding turns no angle of zero into a full one, whichever way it falls.
#[test]
fn an_angle_without_its_last_digit_is_no_full_turn() {
    for off in ["0", "1e-15", "-1e-15", "3e-14", "-3e-14"] {
        let more = format!(
            "[[dimensions]]\nat = {{ body = \"crank\" }}\nfrom = {{ body = \"crank\", point = [9, 0, 0] }}\n\
             to = {{ body = \"crank\", point = [7, {off}, 0] }}\naxis = [0, 0, 1]\ntext = \"none = {{}}\"\n"
        );
        let (scene, trajectory) = solved(&more);
        let staging = staged(&scene, &trajectory);
        for index in 0..trajectory.samples.len() {
            assert_eq!(value(&staging.frame(index), "none"), 0.0, "{off}: {index}");
        }
    }
}

/// A parallel view shows only the dimensions that can be read in it.
#[test]
fn parallel_views_leave_out_what_they_foreshorten() {
    let (mut scene, trajectory) = solved(DIMENSIONS);
    for (named, ground, open) in [
        (NamedView::Front, true, true),
        (NamedView::Side, false, false),
        (NamedView::Top, false, false),
    ] {
        Arc::make_mut(&mut scene.view).look_from(named);
        // Up is y here: the front looks along z.
        let frame = staged(&scene, &trajectory).frame(3);
        assert_eq!(label(&frame, "ground").is_some(), ground, "{named:?}");
        assert_eq!(label(&frame, "open").is_some(), open, "{named:?}");
    }
}

#[test]
fn what_a_dimension_lacks_is_said() {
    let table: [(&str, &str); 9] = [
        ("from = { point = [0, 0, 0] }", "needs `to`"),
        ("from = {}\nto = { body = \"rot\" }", "no body `rot`"),
        ("from = {}\nto = { trace = \"L\" }", "no trace `L`"),
        (
            "from = {}\nto = { trace = \"K\", body = \"rocker\" }",
            "not on both",
        ),
        (
            "from = {}\nto = { trace = \"K\" }\nradius = 3",
            "`radius` belongs to an angle",
        ),
        (
            "from = {}\nto = { trace = \"K\" }\naxis = [0, 0, 1]",
            "`axis` belongs to an angle",
        ),
        (
            "from = {}\nto = { trace = \"K\" }\nat = {}\noffset = [0, 0, 1]",
            "no `offset`",
        ),
        (
            "from = {}\nto = { trace = \"K\" }\nat = {}\naxis = [0, 0, 0]",
            "must not be zero",
        ),
        (
            "from = {}\nto = { trace = \"K\" }\ndigits = 1.5",
            "whole number",
        ),
    ];
    for (entry, said) in table {
        let source = four_bar(&format!("[[dimensions]]\n{entry}"));
        let error = load_scene(&source, &Overrides::default()).unwrap_err();
        let text = format!("{:?}", error.diagnostics);
        assert!(text.contains(said), "{entry}: {text}");
    }
}

/// The bar is as long as it says, in every size and at every zoom; a perspective names the pitch of its grid.
#[test]
fn the_scale_bar_is_as_long_as_it_says() {
    let (mut scene, trajectory) = solved("");
    let view = Arc::make_mut(&mut scene.view);
    view.decor.scale = true;
    view.decor.axes = ShownAxes::Corner;
    let frame = staged(&scene, &trajectory).frame(0);
    assert_eq!(label(&frame, "grid").unwrap().text, "grid 20 mm");
    for (named, margin) in [
        (NamedView::Front, 0.05),
        (NamedView::Iso, 0.05),
        (NamedView::Top, 0.3),
    ] {
        let view = Arc::make_mut(&mut scene.view);
        view.look_from(named);
        view.margin = margin;
        let staging = staged(&scene, &trajectory);
        let frame = staging.frame(0);
        let said = frame.labels.iter().find(|l| l.text.ends_with(" mm"));
        let said: f64 = said.unwrap().text.trim_end_matches(" mm").parse().unwrap();
        let camera = frame.camera(&staging.stage);
        let [from, to] = frame.strokes[0].ends;
        let long = (to[0] - from[0]) / camera.pixels_per_unit(SIZE);
        assert!(
            (long - said).abs() < 1e-9 * said,
            "{named:?}: {long} {said}"
        );
    }
}

/// Marks lie on the path at equal times, one at every step.
#[test]
fn marks_lie_where_the_point_is_at_equal_times() {
    let (mut scene, trajectory) = solved("");
    let plain = staged(&scene, &trajectory).frame(5).instances.len();
    Arc::make_mut(&mut scene.view).decor.ticks = Some(0.5);
    let staging = staged(&scene, &trajectory);
    assert_eq!(staging.frame(5).instances.len(), plain + 1);
    let marks = staging.stage.meshes.last().unwrap();
    // Ten samples a second: every fifth one, to 3.5 s of the 4.
    let places = trajectory.samples.iter().step_by(5);
    let places: Vec<_> = places.map(|s| s.pose.as_ref().unwrap().traces[0]).collect();
    assert_eq!(places.len(), 8);
    let mut vertices = [0usize; 8];
    for vertex in &marks.positions {
        let vertex = glam::DVec3::from(vertex.map(f64::from));
        let far = places.iter().map(|place| place.distance(vertex));
        let (nearest, far) = far.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        assert!(far < 3.0, "{far}");
        vertices[nearest] += 1;
    }
    assert!(
        vertices.iter().all(|count| *count == vertices[0]),
        "{vertices:?}"
    );
}

#[test]
fn films_play_in_order_back_and_with_pauses() {
    let order = |count: usize, bounce: bool, pause: f64| {
        let order = PlayOrder::plain(5, count).played(Playback { bounce, pause }, 10.0);
        let pictures = 0..order.pictures();
        pictures.map(|k| order.sample(k)).collect::<Vec<_>>()
    };
    assert_eq!(order(4, false, 0.0), [5, 6, 7, 8]);
    assert_eq!(order(4, true, 0.0), [5, 6, 7, 8, 7, 6]);
    assert_eq!(order(3, false, 0.2), [5, 5, 5, 6, 7, 7, 7]);
    assert_eq!(order(4, true, 0.1), [5, 5, 6, 7, 8, 8, 7, 6]);
    assert_eq!(order(2, true, 0.1), [5, 5, 6, 6]);
    assert_eq!(order(1, true, 0.3), [5]);
}

/// Triangles of the first picture.
fn drawn_triangles(scene: &Scene, trajectory: &Trajectory) -> usize {
    let staging = staged(scene, trajectory);
    let frame = staging.frame(0);
    let instances = frame.instances.iter().map(|instance| {
        let count = staging.stage.meshes[instance.mesh].triangles.len();
        let range = &instance.triangles;
        (range.end as usize).min(count) - (range.start as usize).min(count)
    });
    instances.sum()
}

#[test]
fn hidden_solids_leave_the_pictures_and_nothing_else() {
    let (scene, trajectory) = solved("");
    let all = drawn_triangles(&scene, &trajectory);
    let mechanism = &scene.mechanism;
    let body = |name: &str| {
        mechanism
            .bodies
            .iter()
            .position(|b| b.name == name)
            .unwrap()
    };
    let mut left = Vec::new();
    for (name, kind) in [
        ("crank", Some("cylinder")),
        ("crank", None),
        ("coupler", None),
    ] {
        let mut hidden = scene.clone();
        let solids = HiddenSolids {
            body: body(name),
            kind: kind.map(str::to_owned),
        };
        Arc::make_mut(&mut hidden.view).hidden.push(solids);
        assert!(Arc::ptr_eq(&hidden.mechanism, mechanism));
        let shapes = &mechanism.bodies[body(name)].shapes;
        let is_left = |word: &str| kind.is_some_and(|k| k != word);
        let expected = shapes.iter().filter(|s| is_left(s.solid.word())).count();
        let shown = hidden.view.shown_shapes(mechanism, body(name)).count();
        assert_eq!(shown, expected, "{name} {kind:?}");
        left.push(drawn_triangles(&hidden, &trajectory));
    }
    assert!(
        left[1] < left[0] && left[0] < all && left[2] < all,
        "{left:?}"
    );
}
