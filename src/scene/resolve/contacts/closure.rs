//! Translates parsed contacts into loops and equations, and into the scalars that formulas of outputs may use:
//! `c.point.x`, `c.normal.x`, `c.pressure_angle`.

use super::super::super::contacts::ContactSurface;
use super::super::super::formula::compile::{compile_formula, constant_node, exact_constant};
use super::super::super::formula::expansion::Factor;
use super::super::super::formula::node::{FormulaNode, NodeKind};
use super::super::bars::ends::shift_along;
use super::super::joints::FoldedJoints;
use super::super::names::{Meaning, Names};
use super::super::symbolic::{
    Drafted, Formulas, SymbolicTerm, cross_product, dot_product, vector_difference,
};
use super::chains::{ContactClosure, ParsedContact};
use super::parallel::factors_across;
use crate::diag::{Diagnostic, Diagnostics, shown_number};
use crate::model::chain::{Argument, Chain, ChainStep, ElementaryMotion};
use crate::model::expression::Expression;
use crate::model::mechanism::{AxisCrossing, Closes, Equation, Kind, Loop};
use crate::model::walk::{Triple, add_vectors};
use crate::numbers::constant::Constant;
use crate::numbers::scalar::Ring;

/// The contribution of contacts to the mechanism.
#[derive(Default)]
pub struct Contacts {
    pub loops: Vec<Loop>,
    pub equations: Vec<Equation>,
    /// Cylinders that may cross at any angle.
    pub crossings: Vec<AxisCrossing>,
    /// Full names of the scalars, with their formulas in the coordinates, or the reason why there is none.
    pub scalars: Vec<(String, Kind, Result<Expression, String>)>,
}

impl Contacts {
    /// The scalar of that name.
    pub fn scalar(&self, name: &str) -> Option<&(String, Kind, Result<Expression, String>)> {
        self.scalars.iter().find(|(known, ..)| known == name)
    }

    /// Resolves all contacts.
    pub fn resolve(
        contacts: &[ParsedContact],
        names: &Names,
        joints: &mut FoldedJoints,
        diagnostics: &mut Diagnostics,
    ) -> Self {
        let mut all = Self::default();
        for contact in contacts {
            // Both the sizes and the frames are checked, so that all errors are reported.
            let sound = is_sound(contact, names, diagnostics);
            let chains = contact
                .sides
                .each_ref()
                .map(|s| joints.chain(&s.frame, diagnostics));
            let [Some(first), Some(second)] = chains else {
                continue;
            };
            if !sound {
                continue;
            }
            // A contact of two fixed surfaces determines nothing.
            let moves = |chain: &Chain| {
                chain
                    .steps
                    .iter()
                    .any(|s| matches!(s, ChainStep::Joint { .. }))
            };
            if !moves(&first) && !moves(&second) {
                let name = &contact.name;
                diagnostics.push(
                    Diagnostic::error(format!("neither surface of contact `{}` moves", name.value))
                        .at(name.span.clone())
                        .hint("give one of them the `frame` of a link"),
                );
                continue;
            }
            // The equation or loop that keeps the surfaces in contact.
            all.close(contact, names, joints, [&first, &second], diagnostics);
            // Crossing cylinders: their axes may become parallel, where the contact point is not determined.
            let is_free = |what| names.meaning(&format!("{}.{what}", contact.name.value));
            if let (Some(factors), Some(Meaning::Unknown(_))) =
                (factors_across(contact), is_free("w2"))
            {
                let across = joints.chain(&factors, diagnostics);
                let contact = contact.name.value.clone();
                let crossing = across.map(|across| AxisCrossing { contact, across });
                all.crossings.extend(crossing);
            }
            // The scalars that outputs may use.
            let frame = contact.frame.as_ref();
            let frame = frame.and_then(|f| joints.chain(f, diagnostics));
            all.describe(
                contact,
                names,
                &joints.arguments,
                frame.as_ref(),
                [&first, &second],
            );
        }
        all
    }

    fn close(
        &mut self,
        contact: &ParsedContact,
        names: &Names,
        joints: &mut FoldedJoints,
        frames: [&Chain; 2],
        diagnostics: &mut Diagnostics,
    ) {
        let name = contact.name.value.clone();
        let (factors, closes) = match &contact.closure {
            ContactClosure::Frame(factors) => (factors, Closes::Frame),
            ContactClosure::Point(factors) => (factors, Closes::Point),
            // Two spheres: one equation for the distance of their centres, which may be points of loops of their own.
            ContactClosure::Distance => {
                let formulas = Formulas::default();
                let own = closed_chains(contact, names, joints);
                let ends = match &own {
                    Some(own) => own.each_ref(),
                    None => frames,
                };
                let [a, b] = ends.map(|c| formulas.walk(c, &joints.arguments).0.origin);
                let distance = formulas.length(vector_difference(b, a));
                let gap = distance - sum_of_radii(&formulas, contact, names);
                self.equations.push(Equation {
                    name,
                    expression: formulas.expression(gap),
                    length_exponent: 1.0,
                    weight: 1.0,
                });
                return;
            }
        };
        self.loops
            .extend(joints.closing(&name, factors, closes, diagnostics));
    }

    /// The scalars of a contact.
    fn describe(
        &mut self,
        contact: &ParsedContact,
        names: &Names,
        arguments: &[Argument],
        frame: Option<&Chain>,
        [first, second]: [&Chain; 2],
    ) {
        let formulas = Formulas::default();
        let (point, normal) = match frame {
            Some(chain) => {
                // The frame at the contact point: its x axis is the normal.
                let (frame, _) = formulas.walk(chain, arguments);
                (frame.origin, frame.axes[0])
            }
            None => {
                // Two spheres: the normal is the direction of the centres, and the point a radius from the first.
                let [a, b] = [first, second].map(|c| formulas.walk(c, arguments).0.origin);
                let apart = vector_difference(b, a);
                let distance = formulas.length(apart);
                let normal = apart.map(|component| component / distance);
                let radius = sizes_of(contact).next();
                let radius = radius.map(|node| formula_size(&formulas, node, names));
                let radius = radius.unwrap_or(SymbolicTerm::Constant(Constant::exact(0.0)));
                (add_vectors(a, normal.map(|c| c * radius)), normal)
            }
        };
        let name = &contact.name.value;
        // Components as formulas of the coordinates.
        for (what, vector, kind) in [
            ("point", point, Kind::Length),
            ("normal", normal, Kind::Number),
        ] {
            for (component, term) in ["x", "y", "z"].iter().zip(vector) {
                let full = format!("{name}.{what}.{component}");
                self.scalars
                    .push((full, kind, Ok(formulas.expression(term))));
            }
        }
        // This one exists only if a single coordinate moves the second body.
        let angle = pressure_angle(&formulas, names, (second, arguments), point, normal);
        self.scalars
            .push((format!("{name}.pressure_angle"), Kind::Angle, angle));
    }
}

/// The frames of a contact's surfaces relative to the last frame that carries both, and to the place at which the first begins:
/// what both have in common, however far away, is not subtracted at every pose.
fn closed_chains(
    contact: &ParsedContact,
    names: &Names,
    joints: &mut FoldedJoints,
) -> Option<[Chain; 2]> {
    let [first, second] = contact.sides.each_ref().map(|side| &side.frame);
    let pairs = first.iter().zip(second);
    let shared = pairs.take_while(|(a, b)| a.is_alike(b)).count();
    let [first, second] = [&first[shared..], &second[shared..]];
    let stands = |factor: &&Factor| match factor {
        Factor::Elementary(ElementaryMotion::Translation, _, node) => is_constant(node, names),
        _ => false,
    };
    // Displacements commute, and the differences of numbers are exact to 31 digits.
    let [a, b] = [first, second].map(|side| side.iter().take_while(stands).count());
    let ends = match a > 0 && b > 0 {
        true => [
            first[a..].to_vec(),
            between_places(&first[..a], &second[..b], &second[b..]),
        ],
        false => [first.to_vec(), second.to_vec()],
    };
    // Errors in the frames have been reported.
    let mut chain = |factors: &[Factor]| joints.chain(factors, &mut Diagnostics::default());
    Some([chain(&ends[0])?, chain(&ends[1])?])
}

/// The displacement from one place to another, and the rest of a chain.
fn between_places(from: &[Factor], to: &[Factor], rest: &[Factor]) -> Vec<Factor> {
    let span = to[0].place();
    let shift = |axis: usize| {
        let [a, b] = [from, to].map(|place| Box::new(shift_along(place, axis, &span)));
        let kind = NodeKind::Binary('-', b, a);
        let span = span.clone();
        Factor::Elementary(
            ElementaryMotion::Translation,
            axis,
            FormulaNode { kind, span },
        )
    };
    (0..3).map(shift).chain(rest.iter().cloned()).collect()
}

/// Whether a formula has the same value at every pose.
fn is_constant(node: &FormulaNode, names: &Names) -> bool {
    let node = names.in_radians(node.clone(), Some(Kind::Length));
    exact_constant(&node, &|n, s| names.constant(n, s)).is_ok()
}

/// The angle between the normal and the velocity of the contact point as a point of the second body, in 0..90 degrees.
/// The direction of the velocity is known if a single joint moves that body.
fn pressure_angle<'l>(
    formulas: &'l Formulas,
    names: &Names,
    (second, arguments): (&Chain, &[Argument]),
    point: Triple<SymbolicTerm<'l>>,
    normal: Triple<SymbolicTerm<'l>>,
) -> Result<Expression, String> {
    let (_, joints) = formulas.walk(second, arguments);
    let mut slots: Vec<usize> = Vec::new();
    let mut velocity = [SymbolicTerm::Constant(Constant::exact(0.0)); 3];
    for Drafted {
        motion,
        axis,
        origin,
        argument,
    } in joints
    {
        let Argument::Affine(affine) = &arguments[argument] else {
            return Err("a formula drives the second body".to_owned());
        };
        // A variable of a study is constant along the motion.
        let moving = affine.terms.iter().filter(|(slot, _)| !names.rests(*slot));
        for (slot, coefficient) in moving.copied().collect::<Vec<_>>() {
            slots.push(slot);
            let share = match motion {
                ElementaryMotion::Translation => axis,
                ElementaryMotion::Rotation => cross_product(axis, vector_difference(point, origin)),
            };
            velocity = add_vectors(velocity, share.map(|c| c.scale_by(coefficient)));
        }
    }
    slots.sort_unstable();
    slots.dedup();
    if slots.len() != 1 {
        return Err(format!(
            "{} joint coordinates move the second body, and one must",
            slots.len()
        ));
    }
    let across = formulas.length(cross_product(normal, velocity));
    Ok(formulas.angle_of(across, dot_product(normal, velocity)))
}

/// Sizes must be constant and positive; the radius of a sphere may be zero.
fn is_sound(contact: &ParsedContact, names: &Names, diagnostics: &mut Diagnostics) -> bool {
    let mut sound = true;
    for side in &contact.sides {
        let surface = &side.surface;
        // Only a sphere may have radius zero: it is a point.
        let may_vanish = matches!(surface, ContactSurface::Sphere { .. });
        for (what, node) in surface.sizes() {
            let node = &names.in_radians(node.clone(), Some(Kind::Length));
            let message = match constant_node(node, &|n, s| names.constant(n, s)) {
                Ok(value) if value > 0.0 || (may_vanish && value == 0.0) => continue,
                Ok(value) => {
                    let word = surface.word();
                    let allowed = if may_vanish {
                        "must not be negative"
                    } else {
                        "must be positive"
                    };
                    let value_text = shown_number(value);
                    let message = format!("`{what}` of a {word} {allowed}, found {value_text}");
                    let diagnostic = Diagnostic::error(message).at(node.span.clone());
                    if what == "ring" && value == 0.0 {
                        diagnostic.hint(
                            "a torus without a ring is a sphere: write sphere = { radius = … }",
                        )
                    } else {
                        diagnostic
                    }
                }
                Err(diagnostic) => diagnostic,
            };
            diagnostics.push(message);
            sound = false;
        }
    }
    // The distance of two points of radius zero is a square root at zero, which has no derivative.
    if sound && contact.is_of_spheres() && radius_sum(contact, names) == 0.0 {
        let message = "two points cannot touch in one equation: one of the spheres needs a radius";
        diagnostics.push(Diagnostic::error(message).at(contact.name.span.clone()));
        return false;
    }
    sound
}

/// Sum of the radii of two spheres in the file.
fn radius_sum(contact: &ParsedContact, names: &Names) -> f64 {
    sizes_of(contact)
        .map(|node| constant_value(node, names).number())
        .sum()
}

/// The same as a formula, since a study may vary the radii.
fn sum_of_radii<'l>(
    formulas: &'l Formulas,
    contact: &ParsedContact,
    names: &Names,
) -> SymbolicTerm<'l> {
    let radii = sizes_of(contact).map(|node| formula_size(formulas, node, names));
    radii.fold(
        SymbolicTerm::Constant(Constant::exact(0.0)),
        |sum, radius| sum + radius,
    )
}

/// The sizes of both surfaces.
fn sizes_of(contact: &ParsedContact) -> impl Iterator<Item = &FormulaNode> {
    let sizes = contact.sides.iter().flat_map(|side| side.surface.sizes());
    sizes.map(|(_, node)| node)
}

/// A valid size as a formula.
fn formula_size<'l>(formulas: &'l Formulas, node: &FormulaNode, names: &Names) -> SymbolicTerm<'l> {
    let converted = names.in_radians(node.clone(), Some(Kind::Length));
    match compile_formula(&converted, &|n, s| names.coordinate(n, s)) {
        Ok(expression) => formulas.inline(&expression),
        Err(_) => SymbolicTerm::Constant(constant_value(node, names)),
    }
}

/// A valid size.
fn constant_value(node: &FormulaNode, names: &Names) -> Constant {
    let node = names.in_radians(node.clone(), Some(Kind::Length));
    exact_constant(&node, &|n, s| names.constant(n, s)).unwrap_or_default()
}
