//! The points and bars of a planar linkage, found from its joints and traced points at a closed pose.
//!
//! A point is the axis of a revolute joint, or a traced point of a link, seen along the axes. A link with two of them is a bar, one with
//! more is held by bars: every further point by two to points before it that are not in line with it.

use crate::intervals::chain::DyadChain;
use crate::intervals::peeling::{NoDyads, peel_dyads};
use crate::kinematics::rates::variation::Variation;
use crate::kinematics::structure::system::System;
use crate::model::chain::Chain;
use crate::model::joints::{Joint, JointKind};
use crate::model::mechanism::Mechanism;
use crate::model::outputs::output_arguments;
use crate::model::walk::WalkFrame;
use crate::numbers::hyper_dual::HyperDual;

/// Axes are parallel, points are one, and three are in line, within this (radians, sizes of the mechanism): what folded constants are
/// rounded by, far below what anybody draws.
const SAME: f64 = 1e-9;

/// Why a mechanism is no row of dyads.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotDyads {
    /// A joint that is no hinge.
    #[error("not a chain of dyads: {0}, and bars turn in hinges only")]
    Joint(String),
    /// Axes that are not parallel.
    #[error("not a chain of dyads: the axes are not parallel, {0}")]
    NotPlanar(String),
    /// Points of a link in one line.
    #[error(
        "not a chain of dyads: the points {0} of a link are in one line, which bars do not hold"
    )]
    InLine(String),
    /// No joint at all.
    #[error("not a chain of dyads: there are no hinges")]
    NoHinges,
    /// The bars do not come apart.
    #[error("not a chain of dyads: {0}")]
    Bars(#[from] NoDyads),
    /// Not one degree of freedom.
    #[error("not a chain of dyads with one degree of freedom: it has {0}")]
    Freedoms(usize),
    /// Bars in line.
    #[error("the bars of dyad {0} are in line here: its matrices have a pole")]
    Pole(String),
}

/// A linkage as a row of dyads, with names.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanarRow {
    /// Places, velocities and dyads, in the plane of the mechanism.
    pub chain: DyadChain,
    /// Names of the points: that of the traced point there, else a letter.
    pub names: Vec<String>,
    /// All bars.
    pub bars: Vec<[usize; 2]>,
    /// Names of the plane's axes.
    pub axes: [&'static str; 2],
}

/// A point that was found, with the links that carry it.
struct FoundPoint {
    name: Option<String>,
    links: Vec<usize>,
    place: [f64; 2],
    velocity: [f64; 2],
}

/// The row of dyads at a closed pose (unknowns, then inputs), with the velocities for input number `moving` at unit rate.
///
/// # Errors
/// What is no planar chain of hinges with one degree of freedom, or does not come apart into dyads.
pub fn planar_row(system: &System, pose: &[f64], moving: usize) -> Result<PlanarRow, NotDyads> {
    let mechanism = system.mechanism();
    let mut rates = Vec::new();
    Variation::new(system).tangent(pose, moving, &mut rates);
    let changing = |(value, rate): (&f64, &f64)| HyperDual {
        value: *value,
        first: *rate,
        ..HyperDual::default()
    };
    let slots: Vec<HyperDual> = pose.iter().zip(&rates).map(changing).collect();
    let normal = common_axis(mechanism, &slots)?;
    let reader = LinkageReader {
        mechanism,
        slots: &slots,
        plane: SeenPlane::square_to(normal),
    };
    let mut points = reader.points();
    // For one unit of the file, as velocities are printed.
    let unit = mechanism.unit_of(mechanism.inputs[moving].kind).number();
    for point in &mut points {
        point.velocity = point.velocity.map(|v| v * unit);
    }
    let bars = reader.bars(&points)?;
    let names = names_of(&points);
    let fixed: Vec<usize> = (0..points.len())
        .filter(|k| points[*k].links.contains(&0))
        .collect();
    let peeled = peel_dyads(points.len(), &fixed, &bars)?;
    let [lever] = peeled.levers[..] else {
        return Err(NotDyads::Freedoms(peeled.levers.len()));
    };
    let chain = DyadChain {
        points: points.iter().map(|p| p.place).collect(),
        velocities: points.iter().map(|p| p.velocity).collect(),
        fixed,
        dyads: peeled.dyads,
        lever,
    };
    let axes = reader.plane.names;
    let row = PlanarRow {
        chain,
        names,
        bars,
        axes,
    };
    let poles = row.chain.dyads.iter().find(|dyad| {
        let angle = row.chain.angle(dyad);
        libm::sin(angle).abs() < SAME
    });
    match poles {
        Some(dyad) => Err(NotDyads::Pole(row.names[dyad.point].clone())),
        None => Ok(row),
    }
}

/// The plane that everything is seen in.
struct SeenPlane {
    axes: [[f64; 3]; 2],
    names: [&'static str; 2],
}

impl SeenPlane {
    /// With two axes of the world where the normal is the third one.
    fn square_to(normal: [f64; 3]) -> Self {
        let unit = |k: usize| [0, 1, 2].map(|i| if i == k { 1.0 } else { 0.0 });
        let along = (0..3).find(|k| normal[*k].abs() > 1.0 - SAME);
        match along {
            Some(k) => {
                let (a, b) = ([1, 0, 0][k], [2, 2, 1][k]);
                let names = ["x", "y", "z"];
                Self {
                    axes: [unit(a), unit(b)],
                    names: [names[a], names[b]],
                }
            }
            None => {
                // The world's axis that is farthest from the normal, turned into the plane.
                let far = (0..3).min_by(|a, b| normal[*a].abs().total_cmp(&normal[*b].abs()));
                let start = unit(far.unwrap_or(0));
                let part = dot_product(start, normal);
                let inside = [0, 1, 2].map(|i| start[i] - part * normal[i]);
                let length = dot_product(inside, inside).sqrt();
                let first = inside.map(|v| v / length);
                Self {
                    axes: [first, cross_product(normal, first)],
                    names: ["u", "v"],
                }
            }
        }
    }
}

fn dot_product(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross_product(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        a[i] * b[j] - a[j] * b[i]
    })
}

fn frame_of(mechanism: &Mechanism, slots: &[HyperDual], chain: &Chain) -> WalkFrame<HyperDual> {
    let values = output_arguments(mechanism, &chain.arguments(), slots);
    WalkFrame::at_end_of(&chain.steps, &values)
}

/// The frame in which a joint begins.
fn joint_frame(mechanism: &Mechanism, slots: &[HyperDual], joint: &Joint) -> WalkFrame<HyperDual> {
    frame_of(
        mechanism,
        slots,
        &mechanism.joints.world_from(&joint.before),
    )
}

/// The direction of all hinges.
fn common_axis(mechanism: &Mechanism, slots: &[HyperDual]) -> Result<[f64; 3], NotDyads> {
    let mut common: Option<([f64; 3], String)> = None;
    for joint in &mechanism.joints.list {
        let name = joint_name(mechanism, joint);
        if joint.kind != JointKind::Revolute {
            return Err(NotDyads::Joint(format!(
                "{name} is a {}",
                joint.kind.words()
            )));
        }
        let Some(hinge) = joint.steps.iter().find_map(|step| step.joint()) else {
            continue;
        };
        let frame = joint_frame(mechanism, slots, joint);
        let axis = frame.axes[hinge.axis].map(|c| c.value);
        match &common {
            None => common = Some((axis, name)),
            Some((first, of)) => {
                let off = cross_product(*first, axis);
                if dot_product(off, off).sqrt() > SAME {
                    return Err(NotDyads::NotPlanar(format!("{of} and {name}")));
                }
            }
        }
    }
    common.map(|(axis, _)| axis).ok_or(NotDyads::NoHinges)
}

/// The bodies that a joint connects.
fn joint_name(mechanism: &Mechanism, joint: &Joint) -> String {
    let link = |index: usize| {
        let bodies = &mechanism.joints.links[index].bodies;
        match bodies.first() {
            Some(body) => format!("`{}`", mechanism.bodies[*body].name),
            None if index == 0 => "the frame".to_owned(),
            None => format!("link {index}"),
        }
    };
    format!(
        "the joint of {} and {}",
        link(joint.before.link),
        link(joint.after.link)
    )
}

struct LinkageReader<'m> {
    mechanism: &'m Mechanism,
    slots: &'m [HyperDual],
    plane: SeenPlane,
}

impl LinkageReader<'_> {
    /// Traced points first, in their order, then hinges without one.
    fn points(&self) -> Vec<FoundPoint> {
        let mechanism = self.mechanism;
        let mut hinges: Vec<FoundPoint> = Vec::new();
        for joint in &mechanism.joints.list {
            let origin = joint_frame(mechanism, self.slots, joint).origin;
            let links = [joint.before.link, joint.after.link];
            self.add_point(&mut hinges, None, &links, origin);
        }
        let mut points: Vec<FoundPoint> = Vec::new();
        for trace in &mechanism.traces {
            let chain = &mechanism.bodies[trace.body].world_from_body;
            let frame = frame_of(mechanism, self.slots, chain);
            let link = mechanism.joints.of_body[trace.body];
            let place = frame.point(trace.point.to_array());
            let [x, y] = self.seen_along(place, |c| c.value);
            let hinge = hinges
                .iter()
                .position(|h| h.links.contains(&link) && self.are_one(h.place, [x, y]));
            if let Some(hinge) = hinge {
                points.push(hinges.remove(hinge));
            }
            self.add_point(&mut points, Some(&trace.name), &[link], place);
        }
        points.extend(hinges);
        // A point that no bar can hold is not seen: a traced point of the frame alone.
        points.retain(|p| p.links != [0]);
        points
    }

    /// Adds a point, or its name and links to one that is there.
    fn add_point(
        &self,
        points: &mut Vec<FoundPoint>,
        name: Option<&str>,
        links: &[usize],
        place: [HyperDual; 3],
    ) {
        let here = self.seen_along(place, |c| c.value);
        let same = |p: &&mut FoundPoint| {
            p.links.iter().any(|l| links.contains(l)) && self.are_one(p.place, here)
        };
        let known = points.iter_mut().find(same);
        let shorter = |old: &Option<String>| {
            let name = name.map(str::to_owned);
            match (old, name) {
                (Some(old), Some(new)) if new.len() >= old.len() => Some(old.clone()),
                (old, None) => old.clone(),
                (_, new) => new,
            }
        };
        match known {
            Some(point) => {
                point.name = shorter(&point.name);
                for link in links {
                    if !point.links.contains(link) {
                        point.links.push(*link);
                    }
                }
            }
            None => points.push(FoundPoint {
                name: shorter(&None),
                links: links.to_vec(),
                place: here,
                velocity: self.seen_along(place, |c| c.first),
            }),
        }
    }

    fn seen_along(
        &self,
        place: [HyperDual; 3],
        part: impl Fn(HyperDual) -> f64 + Copy,
    ) -> [f64; 2] {
        let flat = place.map(part);
        self.plane.axes.map(|axis| dot_product(axis, flat))
    }

    fn are_one(&self, a: [f64; 2], b: [f64; 2]) -> bool {
        libm::hypot(a[0] - b[0], a[1] - b[1]) <= SAME * self.mechanism.size
    }

    /// Bars that hold the points of every moving link together.
    fn bars(&self, points: &[FoundPoint]) -> Result<Vec<[usize; 2]>, NotDyads> {
        let mut bars = Vec::new();
        for link in 1..self.mechanism.joints.links.len() {
            let own: Vec<usize> = (0..points.len())
                .filter(|k| points[*k].links.contains(&link))
                .collect();
            let mut held: Vec<usize> = Vec::new();
            for &point in &own {
                match held[..] {
                    [] => {}
                    [first] => bars.push([first, point]),
                    _ => {
                        let pair = self.widest_pair(points, &held, point);
                        let pair = pair.ok_or_else(|| {
                            let names = names_of(points);
                            let own: Vec<&str> = own.iter().map(|k| names[*k].as_str()).collect();
                            NotDyads::InLine(own.join(", "))
                        })?;
                        bars.extend(pair.map(|other| [other, point]));
                    }
                }
                held.push(point);
            }
        }
        Ok(bars)
    }

    /// The two points from which a third is seen at the largest angle; `None` if all are in line.
    fn widest_pair(
        &self,
        points: &[FoundPoint],
        held: &[usize],
        third: usize,
    ) -> Option<[usize; 2]> {
        let at = |k: usize| points[k].place;
        let sine = |a: usize, b: usize| {
            let [e, f] = [a, b].map(|k| [0, 1].map(|i| at(third)[i] - at(k)[i]));
            let lengths = libm::hypot(e[0], e[1]) * libm::hypot(f[0], f[1]);
            ((e[0] * f[1] - e[1] * f[0]) / lengths).abs()
        };
        let mut best: Option<([usize; 2], f64)> = None;
        for (k, a) in held.iter().enumerate() {
            for b in &held[k + 1..] {
                let wide = sine(*a, *b);
                if wide > SAME && best.is_none_or(|(_, known)| wide > known) {
                    best = Some(([*a, *b], wide));
                }
            }
        }
        best.map(|(pair, _)| pair)
    }
}

/// Names of points; numbers alone where all are one letter and a number, as p0 to p10.
fn names_of(points: &[FoundPoint]) -> Vec<String> {
    let taken = |letter: &char| {
        let mut names = points.iter().filter_map(|p| p.name.as_deref());
        names.any(|name| name == letter.to_string())
    };
    let mut letters = (b'A'..=b'Z').map(char::from).filter(|c| !taken(c));
    let mut unnamed = 0;
    let mut names: Vec<String> = (points.iter())
        .map(|point| match &point.name {
            Some(name) => name.clone(),
            None => {
                unnamed += 1;
                letters
                    .next()
                    .map_or_else(|| format!("A{unnamed}"), |c| c.to_string())
            }
        })
        .collect();
    let number = |name: &String| {
        let mut rest = name.chars();
        let letter = rest.next()?;
        let digits = rest.as_str();
        let is_number = !digits.is_empty() && digits.chars().all(|c| c.is_ascii_digit());
        is_number.then(|| (letter, digits.to_owned()))
    };
    let all: Option<Vec<(char, String)>> = names.iter().map(number).collect();
    if let Some(all) = all.filter(|all| all.iter().all(|(c, _)| *c == all[0].0)) {
        names = all.into_iter().map(|(_, digits)| digits).collect();
    }
    names
}
