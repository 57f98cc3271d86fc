//! The points and bars of a planar linkage, found from its joints, bars and traced points at a closed pose.
//!
//! A point is the axis of a revolute joint, an end of a bar, or a traced point of a link, projected along the axes. A
//! link with two points is a bar. A link with more is replaced by bars: every further point is connected by two bars to
//! earlier points that are not collinear with it.

use super::not_dyads::NotDyads;
use super::plane::{ProjectionPlane, SAME, cross_product, dot_product};
use crate::intervals::chain::DyadChain;
use crate::intervals::peeling::peel_dyads;
use crate::kinematics::rates::variation::Variation;
use crate::kinematics::structure::system::System;
use crate::model::bar_ends::BarEnds;
use crate::model::chain::Chain;
use crate::model::joints::{Joint, JointKind};
use crate::model::mechanism::{BarEnd, Mechanism};
use crate::model::outputs::output_arguments;
use crate::model::walk::WalkFrame;
use crate::numbers::hyper_dual::HyperDual;
use std::collections::BTreeMap;

/// A linkage as a sequence of dyads, with names.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanarRow {
    /// Positions, velocities and dyads in the plane of the mechanism.
    pub chain: DyadChain,
    /// Names of the points: that of the traced point at the same place, otherwise a letter.
    pub names: Vec<String>,
    /// All bars.
    pub bars: Vec<[usize; 2]>,
    /// Names of the plane's axes.
    pub axes: [&'static str; 2],
}

/// A point, with the links that carry it.
struct FoundPoint {
    name: Option<String>,
    /// None for the free end of a bar.
    links: Vec<usize>,
    /// A bar of the scene ends in it.
    is_end: bool,
    place: [f64; 2],
    velocity: [f64; 2],
}

/// The sequence of dyads at a closed pose (unknowns, then inputs), with the velocities for a unit rate of input
/// `moving`.
///
/// # Errors
/// A linkage that is not planar with hinges and one degree of freedom, or cannot be decomposed into dyads.
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
    let ends = BarEnds::new(mechanism);
    NotDyads::judge_equations(mechanism)?;
    let normal = common_axis(mechanism, &slots, &ends)?;
    let reader = LinkageReader {
        mechanism,
        slots: &slots,
        ends,
        plane: ProjectionPlane::square_to(normal),
    };
    let mut points = reader.points()?;
    let bars = reader.bars(&points)?;
    // For one unit of the file, as velocities are printed.
    let unit = mechanism.unit_of(mechanism.inputs[moving].kind).number();
    for point in &mut points {
        point.velocity = point.velocity.map(|v| v * unit);
    }
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

fn frame_of(mechanism: &Mechanism, slots: &[HyperDual], chain: &Chain) -> WalkFrame<HyperDual> {
    let values = output_arguments(mechanism, &chain.arguments(), slots);
    WalkFrame::at_end_of(&chain.steps, &values)
}

/// The frame at the base of a joint.
fn joint_frame(mechanism: &Mechanism, slots: &[HyperDual], joint: &Joint) -> WalkFrame<HyperDual> {
    frame_of(
        mechanism,
        slots,
        &mechanism.joints.world_from(&joint.before),
    )
}

/// The direction of all hinges.
fn common_axis(
    mechanism: &Mechanism,
    slots: &[HyperDual],
    ends: &BarEnds,
) -> Result<[f64; 3], NotDyads> {
    let mut common: Option<([f64; 3], String)> = None;
    // All joints must be hinges, and their axes parallel.
    let real = mechanism.joints.list.iter();
    for joint in real.filter(|joint| !ends.place_joint(joint)) {
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
    // Without hinges the bars alone must determine the plane.
    match common {
        Some((axis, _)) => Ok(axis),
        None => bar_normal(mechanism, slots, ends).ok_or(NotDyads::NoHinges),
    }
}

/// The world axis along which no bar extends and no end moves; the last if there are several.
fn bar_normal(mechanism: &Mechanism, slots: &[HyperDual], ends: &BarEnds) -> Option<[f64; 3]> {
    let mut flat = [ends.bars().next().is_some(); 3];
    for bar in ends.bars() {
        let [a, b] = bar
            .each_ref()
            .map(|end| frame_of(mechanism, slots, &end.point).origin);
        for (axis, flat) in flat.iter_mut().enumerate() {
            let rests = a[axis].first == 0.0 && b[axis].first == 0.0;
            let apart = (a[axis].value - b[axis].value).abs();
            *flat &= rests && apart <= SAME * mechanism.size;
        }
    }
    let normal = flat.iter().rposition(|flat| *flat)?;
    Some([0, 1, 2].map(|k| if k == normal { 1.0 } else { 0.0 }))
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
    ends: BarEnds<'m>,
    plane: ProjectionPlane,
}

impl LinkageReader<'_> {
    /// Traced points first, in their order, then hinges and ends of bars without a traced point.
    fn points(&self) -> Result<Vec<FoundPoint>, NotDyads> {
        let mechanism = self.mechanism;
        let mut hinges: Vec<FoundPoint> = Vec::new();
        for joint in &mechanism.joints.list {
            if self.ends.place_joint(joint) {
                continue;
            }
            let origin = joint_frame(mechanism, self.slots, joint).origin;
            let links = [joint.before.link, joint.after.link];
            self.add_point(&mut hinges, None, &links, origin);
        }
        for end in self.ends.bars().flatten() {
            let place = self.end_place(end);
            let link = self.ends.link_of(end);
            let index = self.add_point(&mut hinges, None, link.as_slice(), place);
            hinges[index].is_end = true;
        }
        let mut points: Vec<FoundPoint> = Vec::new();
        for trace in &mechanism.traces {
            let chain = &mechanism.bodies[trace.body].world_from_body;
            let frame = frame_of(mechanism, self.slots, chain);
            let link = mechanism.joints.of_body[trace.body];
            // Bodies that are only drawn at the ends of bars provide their names.
            let is_drawn = self.ends.place_link(link);
            let links = if is_drawn { vec![] } else { vec![link] };
            let place = frame.point(trace.point.to_array());
            match self.find_point(&hinges, &links, place) {
                Some(hinge) => points.push(hinges.remove(hinge)),
                None if is_drawn && self.find_point(&points, &links, place).is_none() => continue,
                None => {}
            }
            self.add_point(&mut points, Some(&trace.name), &links, place);
        }
        points.extend(hinges);
        // A traced point of the frame that no bar can reach is ignored.
        points.retain(|p| p.is_end || p.links != [0]);
        self.judge_free_ends(&points)?;
        Ok(points)
    }

    fn end_place(&self, end: &BarEnd) -> [HyperDual; 3] {
        frame_of(self.mechanism, self.slots, &end.point).origin
    }

    /// Every free end has two coordinates of its own.
    fn judge_free_ends(&self, points: &[FoundPoint]) -> Result<(), NotDyads> {
        let names = names_of(points);
        let mut owners: BTreeMap<usize, usize> = BTreeMap::new();
        for end in self.ends.bars().flatten() {
            let link = self.ends.link_of(end);
            let found = self.find_point(points, link.as_slice(), self.end_place(end));
            let (Some(point), None) = (found, link) else {
                continue;
            };
            // With two coordinates it is free in its plane.
            let slots = self.ends.unknowns_of(end);
            if slots.len() != 2 {
                return Err(NotDyads::Point(names[point].clone()));
            }
            for slot in slots {
                if *owners.entry(slot).or_insert(point) != point {
                    return Err(NotDyads::Point(names[point].clone()));
                }
            }
        }
        Ok(())
    }

    /// The point at that position on one of the links; of free ends, the one that moves identically.
    fn find_point(
        &self,
        points: &[FoundPoint],
        links: &[usize],
        place: [HyperDual; 3],
    ) -> Option<usize> {
        let here = self.seen_along(place, |c| c.value);
        let velocity = self.seen_along(place, |c| c.first);
        points.iter().position(|p| {
            let is_free = p.links.is_empty() && links.is_empty();
            let is_on = p.links.iter().any(|l| links.contains(l));
            self.are_one(p.place, here) && (is_on || is_free && self.are_one(p.velocity, velocity))
        })
    }

    /// Adds a point, or adds its name and links to an existing one; returns its index.
    fn add_point(
        &self,
        points: &mut Vec<FoundPoint>,
        name: Option<&str>,
        links: &[usize],
        place: [HyperDual; 3],
    ) -> usize {
        let known = self.find_point(points, links, place);
        // Of two names of one point the shorter one is kept.
        let shorter = |old: &Option<String>| {
            let name = name.map(str::to_owned);
            match (old, name) {
                (Some(old), Some(new)) if new.len() >= old.len() => Some(old.clone()),
                (old, None) => old.clone(),
                (_, new) => new,
            }
        };
        match known {
            // A known point gains the links that meet there.
            Some(index) => {
                let point = &mut points[index];
                point.name = shorter(&point.name);
                for link in links {
                    if !point.links.contains(link) {
                        point.links.push(*link);
                    }
                }
                index
            }
            None => {
                points.push(FoundPoint {
                    name: shorter(&None),
                    links: links.to_vec(),
                    is_end: false,
                    place: self.seen_along(place, |c| c.value),
                    velocity: self.seen_along(place, |c| c.first),
                });
                points.len() - 1
            }
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

    /// Bars that make every moving link rigid, and those of the scene.
    fn bars(&self, points: &[FoundPoint]) -> Result<Vec<[usize; 2]>, NotDyads> {
        let mut bars = Vec::new();
        // Every moving link is made rigid: its second point by one bar, each further one by two.
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
        // Bars of the scene, unless a link has provided the same one.
        for ends in self.ends.bars() {
            let [a, b] = ends.each_ref().map(|end| {
                let link = self.ends.link_of(end);
                self.find_point(points, link.as_slice(), self.end_place(end))
            });
            if let (Some(a), Some(b)) = (a, b)
                && !bars.iter().any(|bar| *bar == [a, b] || *bar == [b, a])
            {
                bars.push([a, b]);
            }
        }
        Ok(bars)
    }

    /// The two points from which a third has the largest angle of sight; `None` if all are collinear.
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

/// Names of points; only the numbers if all names are one letter and a number, such as p0 to p10.
fn names_of(points: &[FoundPoint]) -> Vec<String> {
    // Unnamed points get letters that no point has yet, then numbered ones.
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
    // If all names are one letter and a number, the number suffices.
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
