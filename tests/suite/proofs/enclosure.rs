//! Bands of tolerances: attained ranges known to many digits, random pieces that must never leave them, and refusals.

use crate::program::Workspace;
use mechanim::analysis::enclosure::{
    BandObstacle, Enclosed, TolerancePlan, enclose_between, enclose_measures, enclose_motion,
    shown_names,
};
use mechanim::analysis::study::{Evaluator, ParametricMechanism};
use mechanim::diag::Source;
use mechanim::kinematics::loops::observed::observed_slots;
use mechanim::kinematics::motion::sampling::even_times;
use mechanim::kinematics::solve::newton::Pace;
use mechanim::kinematics::solve::pose_solver::PoseSolver;
use mechanim::scene::{Overrides, builtin, load_scene};
use serde_json::Value;
use std::collections::BTreeMap;

/// A scene, its dimensions with their tolerances in the file's units, and parameters and inputs in place of its own.
struct Case {
    source: Source,
    overrides: Overrides,
    tolerances: Vec<(String, f64)>,
}

impl Case {
    fn new(source: Source, tolerances: &[(&str, f64)]) -> Self {
        Self {
            source,
            overrides: Overrides::default(),
            tolerances: tolerances
                .iter()
                .map(|(n, t)| ((*n).to_owned(), *t))
                .collect(),
        }
    }

    fn builtin(name: &str, tolerances: &[(&str, f64)]) -> Self {
        Self::new(builtin::find_builtin(name).unwrap(), tolerances)
    }

    fn text(text: &str, tolerances: &[(&str, f64)]) -> Self {
        let (name, text) = ("case.toml".to_owned(), text.to_owned());
        Self::new(Source { name, text }, tolerances)
    }

    /// Every length and angle with tolerances of their own.
    fn all(name: &str, length: f64, angle: f64) -> Self {
        let mut case = Self::builtin(name, &[]);
        let scene = load_scene(&case.source, &case.overrides).unwrap();
        for name in scene.dimensions.iter() {
            let kind = scene.kinds.iter().find(|(n, _)| n == name).unwrap().1;
            let is_angle = kind == mechanim::model::mechanism::Kind::Angle;
            case.tolerances
                .push((name.clone(), if is_angle { angle } else { length }));
        }
        case
    }

    fn input(mut self, name: &str, formula: &str) -> Self {
        self.overrides
            .inputs
            .push((name.to_owned(), formula.to_owned()));
        self
    }

    fn family(&self) -> ParametricMechanism {
        let scene = load_scene(&self.source, &self.overrides).unwrap();
        let is_input = |n: &String| scene.mechanism.inputs.iter().any(|i| i.name == *n);
        let names: Vec<String> = self
            .tolerances
            .iter()
            .map(|(n, _)| n.clone())
            .filter(|n| !is_input(n))
            .collect();
        ParametricMechanism::varying(&self.source, &self.overrides, &names).unwrap()
    }
}

fn plan<'f>(case: &Case, family: &'f ParametricMechanism, factor: f64) -> TolerancePlan<'f> {
    let mechanism = family.mechanism();
    let inner: Vec<(String, f64)> = case
        .tolerances
        .iter()
        .map(|(name, t)| {
            let kind = mechanism
                .inputs
                .iter()
                .find(|i| i.name == *name)
                .unwrap()
                .kind;
            (name.clone(), factor * t * mechanism.unit_of(kind).number())
        })
        .collect();
    TolerancePlan::new(family, &inner)
}

fn times(family: &ParametricMechanism, count: usize) -> Vec<f64> {
    even_times(family.mechanism(), &family.actuation, count)
}

/// lo, hi, least, greatest of a quantity.
fn band(family: &ParametricMechanism, enclosed: &Enclosed, name: &str) -> [f64; 4] {
    let names = shown_names(family.mechanism());
    let index = names.iter().position(|(n, _)| n == name).unwrap();
    let bands = enclosed.bands.as_ref().unwrap_or_else(|e| panic!("{e:?}"));
    let band = bands.list[index];
    [band.lo, band.hi, band.found[0], band.found[1]]
}

/// The attained range is inside of the band, which is wider by `share` of it at most.
fn holds([lo, hi, least, greatest]: [f64; 4], attained: [f64; 2], share: f64, digits: f64) {
    let width = attained[1] - attained[0];
    // The attained ends are given with this many digits.
    assert!(
        lo <= attained[0] + digits && hi >= attained[1] - digits,
        "{lo} {hi} {attained:?}"
    );
    assert!(
        hi - lo <= (1.0 + share) * width,
        "{lo} {hi} {attained:?}: {}",
        (hi - lo) / width
    );
    assert!(lo <= least && greatest <= hi);
    // The search finds what is attained, or more than the table.
    let slack = 1e-4 * width + digits;
    assert!(
        least <= attained[0] + slack && greatest >= attained[1] - slack,
        "{least} {greatest} {attained:?}"
    );
}

#[test]
fn the_slider_crank_attains_its_bands() {
    for (degrees, attained) in [
        ("30", [111.9237066153946, 112.2776509290156]),
        ("90", [69.10861017268398, 69.45502141674135]),
        ("135", [46.34444912981638, 46.75313203477262]),
        // Not monotone in r: the greatest stands at r = 40.05, at no corner.
        ("63.43494882292201", [89.3307581327326, 89.55452249886658]),
    ] {
        let case = Case::builtin("slider-crank", &[("r", 0.1), ("L", 0.1)]);
        let case = case.input("phi", &format!("{degrees}*pi/180"));
        let family = case.family();
        let motion = enclose_motion(&plan(&case, &family, 1.0), &[0.0], 1, true);
        holds(band(&family, &motion[0], "h"), attained, 0.02, 1e-12);
    }
}

/// The handle in gate 1 at ± 0.1: corners attain -7.288571 +7.141980, -2.845878 +2.844808, -3.036451 +2.917371.
#[test]
fn the_gearshift_attains_its_bands_in_22_dimensions() {
    let case = Case::all("gearshift", 0.1, 0.1);
    assert_eq!(case.tolerances.len(), 22, "xM, yM and zM are dimensions");
    let case = case.input("p", "17").input("phi", "0.2");
    let family = case.family();
    let nominal = [950.752865187, 217.739181450, 669.666495041];
    let reach = [
        [-7.288571, 7.141980],
        [-2.845878, 2.844808],
        [-3.036451, 2.917371],
    ];
    let motion = enclose_motion(&plan(&case, &family, 1.0), &[0.0], 1, true);
    for (k, axis) in ["M.x", "M.y", "M.z"].into_iter().enumerate() {
        let attained = reach[k].map(|r| nominal[k] + r);
        holds(band(&family, &motion[0], axis), attained, 0.02, 2e-6);
    }
    // Ten times less is ten times sharper, and more.
    let motion = enclose_motion(&plan(&case, &family, 0.1), &[0.0], 1, true);
    for (k, axis) in ["M.x", "M.y", "M.z"].into_iter().enumerate() {
        let [lo, hi, least, greatest] = band(&family, &motion[0], axis);
        assert!(lo <= least && greatest <= hi);
        let wider = (hi - lo) / (greatest - least);
        assert!(wider < 1.0005, "{axis}: {wider}");
        let width = 0.1 * (reach[k][1] - reach[k][0]);
        assert!(((greatest - least) / width - 1.0).abs() < 2e-3, "{axis}");
    }
}

/// The mechanism by its points, 22 coordinates of them at ± 0.1.
#[test]
fn the_loops_of_the_dyads_are_as_sharp_as_their_bars() {
    let case = Case::all("dyads", 0.1, 0.0);
    let family = case.family();
    let names = shown_names(family.mechanism());
    for enclosed in enclose_motion(&plan(&case, &family, 1.0), &times(&family, 4), 1, true) {
        for (name, _) in &names {
            let [lo, hi, least, greatest] = band(&family, &enclosed, name);
            assert!(lo <= least && greatest <= hi);
            assert!(
                hi - lo <= 1.02 * (greatest - least) + 1e-12,
                "{name}: {lo} {hi} {least} {greatest}"
            );
        }
    }
}

#[test]
fn the_dyads_attain_their_bands_in_17_bars() {
    let case = Case::all("dyads-bars", 0.05, 0.0).input("phi", "pi/2");
    assert_eq!(case.tolerances.len(), 17);
    // The start values are those of phi = 0.
    let case = Case {
        overrides: Overrides::default(),
        ..case
    };
    let family = case.family();
    let motion = enclose_motion(&plan(&case, &family, 1.0), &[0.0, 1.0], 1, true);
    let nominal = [180.390018041, 164.155711922];
    let reach = [[-0.405894, 0.406496], [-0.316007, 0.316066]];
    for (k, axis) in ["p0.x", "p0.y"].into_iter().enumerate() {
        let attained = reach[k].map(|r| nominal[k] + r);
        holds(band(&family, &motion[1], axis), attained, 0.02, 2e-6);
    }
}

/// Numbers from -1 to 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// Inside, often on a face or in a corner.
    fn place(&mut self) -> f64 {
        match self.next() {
            x if x < -0.4 => self.next().signum(),
            _ => self.next(),
        }
    }
}

/// Steps from the drawing to a piece.
const STEPS: usize = 4;

/// The slots of a piece, followed from the drawing by small steps; `None` where it does not close.
fn piece(
    family: &ParametricMechanism,
    solver: &mut PoseSolver,
    drawn: &[f64],
    dimensions: &[(usize, f64)],
) -> Option<Vec<f64>> {
    let mut coordinates = drawn.to_vec();
    for step in 1..=STEPS {
        for (slot, change) in dimensions {
            coordinates[*slot] = drawn[*slot] + change * (step as f64 / STEPS as f64);
        }
        if !solver.closed(&mut coordinates, Pace::Patient) {
            return None;
        }
    }
    Some(observed_slots(family.mechanism(), &coordinates))
}

/// What rounding of a solved piece amounts to beside the bands.
const ROUNDING: f64 = 2e-11;

/// Pieces that leave their bands, and how many were looked at. `bands` says what they are held against.
fn leaving(
    case: &Case,
    factor: f64,
    samples: usize,
    pieces: usize,
    bands: impl Fn(&TolerancePlan, &[f64]) -> Vec<Enclosed>,
) -> (usize, usize) {
    let family = case.family();
    let plan = plan(case, &family, factor);
    let motion = bands(&plan, &times(&family, samples));
    let mut solver = PoseSolver::new(family.system());
    let mut random = Random(0x9e37_79b9_7f4a_7c15 ^ pieces as u64);
    let unknowns = family.mechanism().unknowns.len();
    let (mut left, mut seen) = (0, 0);
    for item in 0..pieces {
        let enclosed = &motion[item % motion.len()];
        let Ok(bands) = &enclosed.bands else { continue };
        let drawn: Vec<f64> = bands.list[..unknowns].iter().map(|b| b.nominal).collect();
        let drawn = [drawn, enclosed.inputs.clone()].concat();
        let changes: Vec<(usize, f64)> = plan
            .dimensions
            .iter()
            .map(|d| (d.slot, d.tolerance * random.place()))
            .collect();
        let Some(slots) = piece(&family, &mut solver, &drawn, &changes) else {
            continue;
        };
        seen += 1;
        let shown = slots[..unknowns].iter().chain(&slots[drawn.len()..]);
        let is_out = shown.zip(&bands.list).any(|(value, band)| {
            let slack = ROUNDING * (value.abs() + family.mechanism().size);
            *value < band.lo - slack || *value > band.hi + slack || !band.nominal.is_finite()
        });
        left += usize::from(is_out);
    }
    (left, seen)
}

/// Dimensions that stand in several places, computed ones, angles in degrees, an input with a tolerance.
const FOUR_BAR: &str = r#"
title = "four-bar"
duration = 1
units = { length = "mm", angle = "deg" }
[parameters]
a = 30
b = 80
tilt = 15
c = "b*sqrt(2)/2"
d = "a + c"
[inputs]
phi = "360*t"
[loops]
A = "Rz(phi) Tx(a) Rz(alpha) Tx(b) Rz(beta) Tx(c) Rz(gamma) Tx(-d) Rz(-tilt) Ry(tilt) Ry(-tilt)"
[guess]
alpha = 60
beta = 60
gamma = 150
[[bodies]]
name = "coupler"
frame = "Rz(phi) Tx(a) Rz(alpha) Rx(tilt)"
[[traces]]
name = "C"
body = "coupler"
point = ["b/2", "c/3", 10]
[outputs]
way = "hypot(C.x, C.y)/(1 + a/b)"
turn = "atan2(C.y - 200, C.x + 300) + alpha"
"#;

/// An open chain: nothing to solve, and the point moves with its dimensions all the same.
const OPEN: &str = r#"
title = "arm"
duration = 1
units = { length = "mm", angle = "deg" }
[parameters]
a = 100
tilt = 20
[inputs]
u = "90*t"
[[bodies]]
name = "arm"
frame = "Rz(u + tilt) Tx(a) Ry(tilt) Tx(2*a)"
[[traces]]
name = "T"
body = "arm"
point = ["a", 0, "a/3"]
"#;

/// An unknown that stands in a formula only, and a formula as an argument.
const FORMULA: &str = r#"
title = "cam"
duration = 1
units = { length = "mm", angle = "rad" }
[parameters]
e = 12
R = 40
[inputs]
u = "2*pi*t"
[equations]
lift = "s - R - e*sin(u) - (s/200)^2*e"
angle = "sin(w) - e/R*cos(u)"
[guess]
s = 40
[[bodies]]
name = "follower"
frame = "Tz(s + e*w) Rz(w*exp(e/R))"
[[traces]]
name = "F"
body = "follower"
point = ["R", 0, 0]
"#;

/// Kinks inside the tolerances: of outputs, and of an equation.
const KINKED: &str = r#"
title = "kinks"
duration = 1
[parameters]
K = 1
c = 0.5
[inputs]
u = "t"
[equations]
stop = "s - max(K*u, c) - 0.1*abs(s - 0.7)"
[guess]
s = 0.5
[outputs]
x = "abs(K*u - c)"
y = "abs(sin(3*u*K)) * max(u - K*c, 0) + min(s, 0.8*K)"
z = "max(abs(s - K*u), c - 0.45) - hypot(s, c)"
[[bodies]]
name = "slide"
frame = "Tx(max(s, K*u + 0.05))"
[[traces]]
name = "P"
body = "slide"
"#;

fn cases() -> Vec<(&'static str, Case, f64)> {
    vec![
        ("slider-crank", Case::all("slider-crank", 0.5, 0.0), 1.0),
        ("gearshift", Case::all("gearshift", 0.1, 0.0), 1.0),
        ("dyads", Case::all("dyads", 0.1, 0.0), 1.0),
        ("dyads-bars", Case::all("dyads-bars", 0.05, 0.0), 1.0),
        ("lifting-arm", Case::all("lifting-arm", 0.005, 0.0), 1.0),
        ("twin-steer", Case::all("twin-steer", 0.001, 0.00002), 1.0),
        ("seven-r", Case::all("seven-r", 0.0005, 0.0002), 1.0),
        ("rsrrr", Case::all("rsrrr", 0.0005, 0.0002), 1.0),
        ("hooke-joint", Case::all("hooke-joint", 0.1, 0.01), 1.0),
        (
            "four-bar",
            Case::text(
                FOUR_BAR,
                &[("a", 0.2), ("b", 0.4), ("tilt", 0.5), ("phi", 0.3)],
            ),
            1.0,
        ),
        (
            "open",
            Case::text(OPEN, &[("a", 1.0), ("tilt", 2.0), ("u", 1.0)]),
            1.0,
        ),
        (
            "kinks",
            Case::text(KINKED, &[("K", 0.05), ("c", 0.04)]),
            1.0,
        ),
        (
            "formula",
            Case::text(FORMULA, &[("e", 0.5), ("R", 1.0)]),
            1.0,
        ),
    ]
}

fn proved(plan: &TolerancePlan, times: &[f64]) -> Vec<Enclosed> {
    enclose_motion(plan, times, 1, false)
}

#[test]
fn no_piece_leaves_its_bands() {
    let wanted = std::env::var("MECHANIM_PIECES")
        .ok()
        .and_then(|n| n.parse().ok());
    let each = wanted.unwrap_or(10_000_usize) / cases().len();
    for (name, case, factor) in cases() {
        for share in [0.02, 1.0] {
            let (left, seen) = leaving(&case, factor * share, 12, each.div_ceil(2), proved);
            assert_eq!(left, 0, "{name} at {share}: of {seen}");
            assert!(
                seen > each / 8,
                "{name} at {share}: only {seen} pieces of {each}"
            );
        }
    }
}

/// The planted fault: what a function departs from its tangent by is left out. The same pieces find it.
#[test]
fn pieces_find_a_band_without_its_remainder() {
    let linear = |plan: &TolerancePlan, times: &[f64]| {
        let small = enclose_motion(&plan.scaled(1e-6), times, 1, false);
        let mut motion = small;
        for bands in motion.iter_mut().filter_map(|e| e.bands.as_mut().ok()) {
            for band in &mut bands.list {
                band.lo = band.nominal + 1e6 * (band.lo - band.nominal);
                band.hi = band.nominal + 1e6 * (band.hi - band.nominal);
            }
        }
        motion
    };
    let mut caught = 0;
    for (name, case, factor) in cases() {
        let (left, _) = leaving(&case, 4.0 * factor, 12, 800, linear);
        caught += usize::from(left > 0);
        println!("{name}: {left}");
    }
    assert!(caught >= 6, "{caught}");
}

/// Bands that end at the corner where one dimension, the one that counts most, has the wrong sign.
fn wrong_corners(case: &Case, plan: &TolerancePlan, times: &[f64]) -> Vec<Enclosed> {
    let family = case.family();
    let mut solver = PoseSolver::new(family.system());
    let unknowns = family.mechanism().unknowns.len();
    let mut motion = enclose_motion(plan, times, 1, false);
    for enclosed in &mut motion {
        let Ok(bands) = &mut enclosed.bands else {
            continue;
        };
        let drawn: Vec<f64> = bands.list[..unknowns].iter().map(|b| b.nominal).collect();
        let drawn = [drawn, enclosed.inputs.clone()].concat();
        let mut shown_at = |places: &[f64]| {
            let changes = plan.dimensions.iter().zip(places);
            let changes: Vec<(usize, f64)> =
                changes.map(|(d, p)| (d.slot, d.tolerance * p)).collect();
            let slots = piece(&family, &mut solver, &drawn, &changes).unwrap();
            [&slots[..unknowns], &slots[drawn.len()..]].concat()
        };
        let count = plan.dimensions.len();
        let middle = shown_at(&vec![0.0; count]);
        let rates: Vec<Vec<f64>> = (0..count)
            .map(|k| {
                let mut places = vec![0.0; count];
                places[k] = 0.01;
                let moved = shown_at(&places);
                moved.iter().zip(&middle).map(|(a, b)| a - b).collect()
            })
            .collect();
        for (index, band) in bands.list.iter_mut().enumerate() {
            let of_band: Vec<f64> = rates.iter().map(|r| r[index]).collect();
            let strongest =
                (0..count).max_by(|a, b| of_band[*a].abs().total_cmp(&of_band[*b].abs()));
            let mut corner: Vec<f64> = of_band.iter().map(|r| r.signum()).collect();
            corner[strongest.unwrap()] *= -1.0;
            band.hi = shown_at(&corner)[index];
            corner.iter_mut().for_each(|c| *c *= -1.0);
            band.lo = shown_at(&corner)[index];
        }
    }
    motion
}

/// The planted fault of corners: a wrong sign. Few dimensions, so that pieces come near their corners at all.
#[test]
fn pieces_find_a_band_that_ends_at_a_wrong_corner() {
    for (name, case, factor) in cases() {
        if case.tolerances.len() > 4 {
            continue;
        }
        let wrong = |plan: &TolerancePlan, times: &[f64]| wrong_corners(&case, plan, times);
        let (left, seen) = leaving(&case, factor, 12, 400, wrong);
        assert!(10 * left > seen, "{name}: {left} of {seen}");
        assert_eq!(leaving(&case, factor, 12, 400, proved).0, 0, "{name}");
    }
}

#[test]
fn tolerances_that_reach_a_fold_are_refused() {
    // The servo is shortest at 1.0615528.
    let case = Case::builtin("lifting-arm", &[("l", 0.01)]).input("l", "1.07");
    let family = case.family();
    let motion = enclose_motion(&plan(&case, &family, 1.0), &[0.0], 1, true);
    match motion[0].bands {
        Err(BandObstacle::Test { dimension, .. }) => assert_eq!(dimension, Some(0)),
        ref other => panic!("{other:?}"),
    }
    // A tenth of it does not.
    let motion = enclose_motion(&plan(&case, &family, 0.1), &[0.0], 1, true);
    assert!(motion[0].bands.is_ok());
    // Next to a change point bands end where the parallelogram may turn over.
    let case = Case::builtin("slider-crank", &[("r", 0.1)]).input("phi", "pi/2");
    let case = Case {
        overrides: Overrides {
            parameters: vec![("r".to_owned(), "79.95".to_owned())],
            ..case.overrides
        },
        ..case
    };
    let family = case.family();
    let motion = enclose_motion(&plan(&case, &family, 1.0), &[0.0], 1, true);
    assert!(motion[0].bands.is_err());
}

#[test]
fn the_program_writes_bands_and_says_what_it_refuses() {
    let w = Workspace::new();
    let run = |arguments: &[&str]| w.run(arguments);
    let arguments = [
        "enclose",
        "slider-crank",
        "--param",
        "r=40+-0.1",
        "--param",
        "L=79.9..80.1",
        "--samples",
        "5",
    ];
    let table = run(&[&arguments[..], &["--out", "-"]].concat())
        .exits(0)
        .text();
    let mut rows = table
        .lines()
        .map(|line| line.split(',').collect::<Vec<_>>());
    let head = rows.next().unwrap();
    let rows: Vec<BTreeMap<&str, &str>> = rows
        .map(|row| head.iter().copied().zip(row).collect())
        .collect();
    assert_eq!(rows.len(), 5);
    for row in &rows {
        let number = |name: &str| row[name].parse::<f64>().unwrap();
        assert!(number("h.lo") < number("h.least") && number("h.greatest") < number("h.hi"));
        assert_eq!(row["status"], "enclosed");
    }
    w.run(
        &[
            &arguments[..],
            &["--out", "b.json", "--plot", "b.svg", "-q"],
        ]
        .concat(),
    )
    .exits(0);
    let document: Value = serde_json::from_slice(&w.read("b.json")).unwrap();
    assert_eq!(document["tolerances"]["r"], 0.1);
    assert_eq!(document["samples"].as_array().unwrap().len(), 5);
    for (arguments, part) in [
        (&["--param", "r=41..40"][..], "above the upper end"),
        (&["--param", "r=40+-x"], "is not a tolerance"),
        (&["--vary", "r"], "there is no tolerance for r"),
        (&["--vary", "q", "--tolerance", "1"], "no such parameter"),
        (
            &["--tolerance", "0.1", "--allow", "z=1"],
            "the scene has no unknown, traced point or output",
        ),
    ] {
        let all = [&["enclose", "slider-crank"][..], arguments].concat();
        run(&all).exits(2).says(&[part]);
    }
    let fold = run(&[
        "enclose",
        "lifting-arm",
        "--input",
        "l=1.07",
        "--vary",
        "l",
        "--tolerance",
        "0.01",
        "--samples",
        "1",
    ]);
    let text = fold.exits(1).text();
    assert!(
        text.contains("`l` brings the mechanism closest") && text.contains("t = 0 s"),
        "{text}"
    );
}

#[test]
fn a_dimension_that_stands_in_a_drive_is_refused() {
    let w = Workspace::new();
    w.write("drive.toml", FOUR_BAR.replace("360*t", "360*t + tilt"));
    w.run(&[
        "enclose",
        "drive.toml",
        "--vary",
        "tilt",
        "--tolerance",
        "1",
    ])
    .exits(2)
    .says(&["`tilt` appears in a drive"]);
}

#[test]
fn allowed_tolerances_keep_the_limit_and_larger_ones_do_not() {
    let w = Workspace::new();
    let text = w
        .run(&[
            "enclose",
            "slider-crank",
            "--vary",
            "r,L",
            "--allow",
            "h=0.5",
            "--samples",
            "24",
        ])
        .exits(0)
        .text();
    let of = |name: &str| -> f64 {
        let line = text
            .lines()
            .find(|l| l.trim_start().starts_with(name))
            .unwrap();
        line.split("+-")
            .nth(1)
            .unwrap()
            .split_whitespace()
            .next()
            .unwrap()
            .parse()
            .unwrap()
    };
    let tolerance = of("r ");
    assert_eq!(tolerance, of("L "));
    let widest = |t: f64| {
        let t = format!("{t}");
        let arguments = [
            "enclose",
            "slider-crank",
            "--vary",
            "r,L",
            "--tolerance",
            &t,
            "--samples",
            "24",
            "--out",
            "-",
            "--no-search",
        ];
        let table = w.run(&arguments).exits(0).text();
        let head: Vec<&str> = table.lines().next().unwrap().split(',').collect();
        let place = |name: &str| head.iter().position(|h| *h == name).unwrap();
        let number = |row: &str, name: &str| {
            row.split(',')
                .nth(place(name))
                .unwrap()
                .parse::<f64>()
                .unwrap()
        };
        let reach = |row: &str| {
            (number(row, "h.hi") - number(row, "h")).max(number(row, "h") - number(row, "h.lo"))
        };
        table.lines().skip(1).map(reach).fold(0.0, f64::max)
    };
    assert!(widest(tolerance) <= 0.5);
    assert!(widest(1.01 * tolerance) > 0.5);
}

/// Measures of corners and random pieces against what no piece is beyond: all kinds of takings.
#[test]
fn no_measure_of_a_piece_is_beyond_its_ends() {
    let takings = [
        "first", "last", "change", "min", "max", "range", "largest", "sum", "mean", "norm",
    ];
    let mut measures = String::from(
        "[tracks]\nturn = { samples = 31, inputs = { phi = [0, 300] } }\n[measures]\n",
    );
    for taking in takings {
        measures += &format!(
            "of_{taking} = {{ track = \"turn\", of = \"C.x - 20\", take = \"{taking}\" }}\n"
        );
    }
    for taking in ["chord", "bow"] {
        measures += &format!(
            "{taking} = {{ track = \"turn\", of = [\"C.x\", \"C.y\"], take = \"{taking}\" }}\n"
        );
    }
    measures += "sum_of = \"of_max^2/a + hypot(bow, chord)\"\n";
    let case = Case::text(
        &format!("{FOUR_BAR}{measures}"),
        &[("a", 0.2), ("b", 0.4), ("tilt", 0.5)],
    );
    let gearshift = Case::all("gearshift-optimised", 0.005, 0.0);
    for (case, pieces) in [(case, 300), (gearshift, 150)] {
        let family = case.family();
        let plan = plan(&case, &family, 1.0);
        let drawn = family.nominal().unwrap();
        let bands = enclose_measures(&plan, &drawn).unwrap();
        let mut evaluator = Evaluator::new(&family);
        let nominal = evaluator.nominal(drawn.poses);
        let mut random = Random(77);
        let mut found = vec![[f64::INFINITY, f64::NEG_INFINITY]; bands.len()];
        for _ in 0..pieces {
            let values: Vec<f64> = family
                .study
                .variables
                .iter()
                .map(|v| {
                    let dimension = plan.dimensions.iter().find(|d| d.name == v.name);
                    v.start + dimension.map_or(0.0, |d| d.tolerance * random.place())
                })
                .collect();
            let stand = evaluator.approach(&nominal, &values).unwrap();
            let measured = evaluator.measure(&stand).unwrap();
            for ((value, band), found) in measured.measures.iter().zip(&bands).zip(&mut found) {
                let slack = 1e-12 * value.abs().max(1.0);
                assert!(
                    *value >= band.lo - slack && *value <= band.hi + slack,
                    "{value} {band:?}"
                );
                *found = [found[0].min(*value), found[1].max(*value)];
            }
        }
        for ((measure, band), [least, greatest]) in
            family.measures.list.iter().zip(&bands).zip(found)
        {
            println!("{}: {band:?} found {least} {greatest}", measure.name);
            assert!(
                band.lo.is_finite() && band.hi.is_finite(),
                "{} is bounded",
                measure.name
            );
        }
    }
}

/// Corners of the tolerances, followed by the signs of differences, reach the ends of every measure's band.
#[test]
fn measures_reach_the_ends_of_their_bands() {
    let case = Case::all("gearshift", 0.01, 0.0);
    let family = case.family();
    let plan = plan(&case, &family, 1.0);
    let drawn = family.nominal().unwrap();
    let bands = enclose_measures(&plan, &drawn).unwrap();
    let mut evaluator = Evaluator::new(&family);
    let nominal = evaluator.nominal(drawn.poses);
    let variables = &family.study.variables;
    let mut measured = |place: &[f64]| -> Vec<f64> {
        let pairs = variables.iter().zip(place);
        let values: Vec<f64> = pairs
            .map(|(v, d)| {
                let dimension = plan.dimensions.iter().find(|known| known.name == v.name);
                v.start + d * dimension.unwrap().tolerance
            })
            .collect();
        let stand = evaluator.approach(&nominal, &values).unwrap();
        evaluator.measure(&stand).unwrap().measures
    };
    let differences: Vec<Vec<f64>> = (0..variables.len())
        .map(|k| {
            let mut place = vec![0.0; variables.len()];
            place[k] = 0.1;
            let above = measured(&place);
            place[k] = -0.1;
            let below = measured(&place);
            above.iter().zip(below).map(|(a, b)| a - b).collect()
        })
        .collect();
    for (index, (measure, band)) in family.measures.list.iter().zip(&bands).enumerate() {
        let mut corner = |sign: f64| {
            let place = differences.iter().map(|d| sign * d[index].signum());
            measured(&place.collect::<Vec<_>>())[index]
        };
        let (least, greatest) = (corner(-1.0), corner(1.0));
        let name = &measure.name;
        assert!(
            band.lo <= least + 1e-9 && greatest <= band.hi + 1e-9,
            "{name}"
        );
        let wider = (band.hi - band.lo) / (greatest - least);
        println!("{name}: {wider}");
        assert!(wider <= 1.02, "{name}: {wider}");
    }
}

#[test]
fn bands_hold_between_the_samples() {
    for (name, case) in [
        ("slider-crank", Case::all("slider-crank", 0.5, 0.0)),
        (
            "four-bar",
            Case::text(
                FOUR_BAR,
                &[("a", 0.2), ("b", 0.4), ("tilt", 0.5), ("phi", 0.3)],
            ),
        ),
        ("lifting-arm", Case::all("lifting-arm", 0.002, 0.0)),
    ] {
        let family = case.family();
        let plan = plan(&case, &family, 1.0);
        let stretches = enclose_between(&plan, &times(&family, 60), 1);
        assert!(stretches.iter().all(|s| s.bands.is_ok()), "{name}");
        let mut random = Random(5);
        let mut solver = PoseSolver::new(family.system());
        let unknowns = family.mechanism().unknowns.len();
        for item in 0..400 {
            let stretch = &stretches[item % stretches.len()];
            let share = 0.5 + 0.5 * random.place();
            let time = stretch.from + share * (stretch.until - stretch.from);
            let drawn = enclose_motion(&plan.scaled(1e-9), &[0.5 * time, time], 1, false);
            let drawn = &drawn[1..];
            let bands = drawn[0].bands.as_ref().unwrap();
            let pose: Vec<f64> = bands.list[..unknowns].iter().map(|b| b.nominal).collect();
            let pose = [pose, drawn[0].inputs.clone()].concat();
            let changes: Vec<(usize, f64)> = plan
                .dimensions
                .iter()
                .map(|d| (d.slot, d.tolerance * random.place()))
                .collect();
            let slots = piece(&family, &mut solver, &pose, &changes).unwrap();
            let shown = slots[..unknowns].iter().chain(&slots[pose.len()..]);
            for (value, [lo, hi]) in shown.zip(stretch.bands.as_ref().unwrap()) {
                let slack = ROUNDING * (value.abs() + family.mechanism().size);
                assert!(
                    *value >= lo - slack && *value <= hi + slack,
                    "{name} at {time}: {value} {lo} {hi}"
                );
            }
        }
    }
}

#[test]
fn limits_of_measures_are_judged_on_the_bound() {
    let w = Workspace::new();
    let scene = |limit: &str| {
        format!(
            "{FOUR_BAR}[tracks]\nturn = {{ samples = 31, inputs = {{ phi = [0, 300] }} }}\n[measures]\nfar = {{ track = \"turn\", of = \"C.x\", take = \"max\", max = {limit} }}\n"
        )
    };
    for (limit, code, word) in [("100", 0, "kept by every piece"), ("50", 1, "not proved")] {
        w.write("limit.toml", scene(limit));
        let text = w
            .run(&[
                "enclose",
                "limit.toml",
                "--vary",
                "a,b",
                "--tolerance",
                "0.1",
                "--samples",
                "12",
                "--between",
            ])
            .exits(code)
            .text();
        assert!(
            text.contains(word) && text.contains("At all times"),
            "{text}"
        );
    }
}

/// What has no bound keeps no limit, on whichever side it is.
#[test]
fn measures_without_a_bound_keep_no_limit() {
    let w = Workspace::new();
    for measure in [
        "{ of = \"C.x - 48\", take = \"positive\", max = 2 }",
        "{ of = \"C.x\", per = \"phi\", take = \"max\", max = 1e300 }",
        "{ of = \"exp(800*C.x)\", take = \"max\", max = 1e308 }",
    ] {
        w.write(
            "open.toml",
            format!("{FOUR_BAR}[measures]\nopen = {measure}\n"),
        );
        let run = w.run(&[
            "enclose",
            "open.toml",
            "--vary",
            "a",
            "--tolerance",
            "0.1",
            "--samples",
            "2",
        ]);
        let text = run.exits(1).text();
        assert!(!text.contains("kept by every piece"), "{measure}: {text}");
    }
}

/// Extremes between the poses of a measure: with `--between` they count, without they are said to be of the poses.
#[test]
fn limits_are_judged_at_all_times_where_that_is_asked() {
    let folder = Workspace::new();
    // h = r cos φ + √(L² - r² sin² φ) with a dip of 60 about t = 0.789, narrower than the poses of a measure are apart.
    let text = "units = { length = \"mm\" }\nduration = 1\n[inputs]\nphi = \"t\"\nd = \"60*exp(-((t - 0.789)/5e-4)^2)\"\n\
                [parameters]\nr = 40\n[loops]\nA = \"Rz(phi) Tx(r) Rz(alpha) Tx(80) Rz(beta) Tx(-h)\"\n[guess]\nh = 100\n\
                [outputs]\nleft = \"h - d\"\n[measures]\nleast = { of = \"left\", take = \"min\", min = 70 }\n\
                twice = \"2*least\"\nhigh = { of = \"h\", take = \"max\", max = 121 }\nmean = { of = \"h\", take = \"mean\" }\n";
    folder.write("dip.toml", text);
    let args = [
        "enclose",
        "dip.toml",
        "--tolerance",
        "0.1",
        "--samples",
        "21",
        "--out",
        "b.json",
    ];
    let read = || -> Value { serde_json::from_slice(&folder.read("b.json")).unwrap() };
    let run = folder.run(&args).exits(0);
    assert!(
        run.text().contains("kept by every piece at these poses"),
        "{}",
        run.text()
    );
    assert_eq!(read()["measures"]["least"]["at_all_times"], false);
    let run = folder.run(&[&args[..], &["--between"]].concat()).exits(1);
    let text = run.text();
    assert!(text.contains("at least 70.0000: not proved"), "{text}");
    assert!(
        text.contains("at most 121.000: kept by every piece at all times"),
        "{text}"
    );
    let measures = read()["measures"].clone();
    for (name, at_all_times) in [
        ("least", true),
        ("twice", true),
        ("high", true),
        ("mean", false),
    ] {
        assert_eq!(measures[name]["at_all_times"], at_all_times, "{name}");
    }
    // By hand: the least value as drawn, at the bottom of the dip to a thousandth.
    let (sine, cosine) = 0.789_f64.sin_cos();
    let drawn = 40.0 * cosine + (6400.0 - 1600.0 * sine * sine).sqrt() - 60.0;
    let ends = |name: &str| {
        [&measures[name]["lo"], &measures[name]["hi"]].map(|end| end.as_f64().unwrap())
    };
    assert!(
        ends("least")[0] < drawn && ends("least")[1] > drawn,
        "{measures}"
    );
    assert!(
        ends("twice")[0] < 2.0 * drawn && ends("twice")[1] > 2.0 * drawn,
        "{measures}"
    );
}

/// Where the tolerances come near a fold the proof ends, not the limit: that is said, and what is proved is no more than a bound.
#[test]
fn tolerances_that_the_proof_ends_are_told_from_those_that_the_limit_ends() {
    let w = Workspace::new();
    // At a right angle of the crank the rod of 40.5 closes only if it stays longer than the crank of 40.
    for (limit, is_ended_by_proof) in [("h=0.5", false), ("h=1000", true)] {
        let text = w
            .run(&[
                "enclose",
                "slider-crank",
                "--param",
                "r=40",
                "--param",
                "L=40.5+-0.1",
                "--allow",
                limit,
                "--at",
                "1",
            ])
            .exits(0)
            .text();
        let said = text.contains("with larger ones nothing is proved");
        assert_eq!(said, is_ended_by_proof, "{limit}: {text}");
        assert!(
            text.contains("its bound is") && !text.contains("reached"),
            "{text}"
        );
    }
}
