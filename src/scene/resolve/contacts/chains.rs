//! Translates a contact into its equivalent chain of lower pairs, with generated names for the unknowns. No names are
//! looked up here.
//!
//! Each surface is a chain from its frame to a frame at the contact point whose x axis is the outward normal. For a
//! torus: rotation about its axis, radius of the ring, rotation about the centre line of the tube, radius of the tube.
//! The two contact frames meet with opposite normals, rotated about them by `spin`. The arbitrary orientation of a
//! sphere is not an unknown: its centre keeps its radius as distance from the other surface. A cylinder touches a plane
//! along a line, so it has no coordinate along that line.

use super::super::super::contacts::{ContactFile, ContactSurface, SurfaceFile};
use super::super::super::formula::chain::{Item, Transform, parse_chain};
use super::super::super::formula::expansion::Factor;
use super::super::super::formula::node::{FormulaNode, NodeKind};
use super::super::super::reader::Spanned;
use crate::diag::Diagnostics;
use crate::model::chain::ElementaryMotion;
use crate::numbers::constant::Constant;
use crate::scene::resolve::parsing::{NamedChains, note_diagnostic, parsed_expression};

/// A contact, parsed.
pub struct ParsedContact {
    pub name: Spanned<String>,
    pub sides: [ContactSide; 2],
    pub closure: ContactClosure,
    /// World to the contact point, x along the normal from the first surface to the second.
    pub frame: Option<Vec<Factor>>,
}

impl ParsedContact {
    /// Whether both surfaces are spheres.
    pub fn is_of_spheres(&self) -> bool {
        matches!(self.closure, ContactClosure::Distance)
    }

    /// Changes every factor.
    pub fn visit_factors(&mut self, change: &dyn Fn(&mut Factor)) {
        let closing = match &mut self.closure {
            ContactClosure::Frame(factors) | ContactClosure::Point(factors) => Some(factors),
            ContactClosure::Distance => None,
        };
        let frames = self.sides.iter_mut().map(|side| &mut side.frame);
        let all = frames.chain(closing).chain(&mut self.frame);
        all.flatten().for_each(change);
    }

    /// Changes every size.
    pub fn visit_sizes(&mut self, change: &dyn Fn(&mut FormulaNode)) {
        for side in &mut self.sides {
            let changed = side.surface.try_map(|node| {
                let mut node = node.clone();
                change(&mut node);
                Some(node)
            });
            if let Some(surface) = changed {
                side.surface = surface;
            }
        }
    }

    /// Every factor whose names may be unknowns.
    pub fn factors(&self) -> impl Iterator<Item = &Factor> {
        let closing = match &self.closure {
            ContactClosure::Frame(factors) | ContactClosure::Point(factors) => factors.as_slice(),
            ContactClosure::Distance => &[],
        };
        let frames = self.sides.iter().flat_map(|side| &side.frame);
        frames.chain(closing)
    }
}

/// One surface with the chain to its frame.
pub struct ContactSide {
    pub surface: ContactSurface<FormulaNode>,
    pub frame: Vec<Factor>,
}

/// What must hold.
pub enum ContactClosure {
    /// The product must be the identity.
    Frame(Vec<Factor>),
    /// The product must map the origin to itself.
    Point(Vec<Factor>),
    /// The distance of the two origins is the sum of the radii.
    Distance,
}

/// Items of a contact before expansion.
pub struct ContactItems {
    pub name: Spanned<String>,
    surfaces: [(ContactSurface<FormulaNode>, Vec<Item>); 2],
}

impl ContactItems {
    /// Parses the formulas of a contact.
    pub fn parse(contact: &ContactFile, diagnostics: &mut Diagnostics) -> Option<Self> {
        let [first, second] = contact.surfaces.as_ref()?;
        let mut side = |file: &SurfaceFile| {
            let surface = file
                .surface
                .try_map(|text| parsed_expression(text, diagnostics));
            let frame = match &file.frame {
                None => Some(vec![Item::Identity]),
                Some(text) => note_diagnostic(parse_chain, text, diagnostics),
            };
            Some((surface?, frame?))
        };
        let (first, second) = (side(first), side(second));
        Some(Self {
            name: contact.name.clone(),
            surfaces: [first?, second?],
        })
    }

    /// The chain to the contact point, x along the normal from the first surface to the second. Two spheres have none.
    pub fn frame(&self) -> Option<Vec<Item>> {
        let [(first, _), (second, _)] = &self.surfaces;
        if !matches!(first, ContactSurface::Sphere { .. }) {
            return Some(self.to_point(0, None));
        }
        if matches!(second, ContactSurface::Sphere { .. }) {
            return None;
        }
        let mut items = self.to_point(1, None);
        items.push(self.turn(1, Constant::PI));
        Some(items)
    }

    /// Expands the contact with the named chains.
    pub fn expand(
        self,
        chains: &NamedChains,
        diagnostics: &mut Diagnostics,
    ) -> Option<ParsedContact> {
        let closure = match self.closing_items() {
            (_, None) => Some(ContactClosure::Distance),
            (true, Some(items)) => chains
                .expand(&items, diagnostics)
                .map(ContactClosure::Frame),
            (false, Some(items)) => chains
                .expand(&items, diagnostics)
                .map(ContactClosure::Point),
        };
        let frame = self.frame();
        let frame = frame.map(|items| chains.expand(&items, diagnostics));
        let sides = self.surfaces.map(|(surface, items)| {
            let frame = chains.expand(&items, diagnostics)?;
            Some(ContactSide { surface, frame })
        });
        let [first, second] = sides;
        Some(ParsedContact {
            name: self.name,
            sides: [first?, second?],
            closure: closure?,
            frame: frame.flatten(),
        })
    }

    /// Whether the product must be the identity, and its factors; none for two spheres.
    fn closing_items(&self) -> (bool, Option<Vec<Item>>) {
        use ContactSurface::{Plane, Sphere};
        let [(first, first_frame), (second, second_frame)] = &self.surfaces;
        let inverse = |items: Vec<Item>| Item::Inverse(items);
        match (first, second) {
            (Sphere { .. }, Sphere { .. }) => (false, None),
            // From the point at a distance of the sphere's radius from the other surface to the sphere's centre.
            (_, Sphere { radius }) => {
                let mut items = vec![inverse(self.to_point(0, Some(radius)))];
                items.extend(second_frame.iter().cloned());
                (false, Some(items))
            }
            (Sphere { radius }, _) => {
                let mut items = vec![inverse(self.to_point(1, Some(radius)))];
                items.extend(first_frame.iter().cloned());
                (false, Some(items))
            }
            (Plane, Plane) => {
                let mut items = first_frame.clone();
                items.extend(self.slides(0));
                items.push(self.rotation_about(2, "spin"));
                items.push(self.turn(0, Constant::PI));
                items.push(inverse(second_frame.clone()));
                (true, Some(items))
            }
            _ => {
                let mut items = self.to_point(0, None);
                items.push(self.rotation_about(0, "spin"));
                items.push(self.turn(1, Constant::PI));
                items.push(inverse(self.to_point(1, None)));
                (true, Some(items))
            }
        }
    }

    /// From the world to the contact point on one side, and `further` along the outward normal, which is the x axis.
    fn to_point(&self, side: usize, further: Option<&FormulaNode>) -> Vec<Item> {
        let (surface, frame) = &self.surfaces[side];
        let (other, _) = &self.surfaces[1 - side];
        let number = side + 1;
        // The last step along the normal: to the surface, or beyond it by a sphere's radius.
        let out = |size: &FormulaNode| match further {
            None => self.along_by(0, size.clone()),
            Some(more) => {
                let kind = NodeKind::Binary('+', Box::new(size.clone()), Box::new(more.clone()));
                let span = size.span.clone();
                self.along_by(0, FormulaNode { kind, span })
            }
        };
        let mut items = frame.clone();
        match surface {
            ContactSurface::Torus { ring, tube } => items.extend([
                self.rotation_about(2, &format!("theta{number}")),
                self.along_by(0, ring.clone()),
                self.rotation_about(1, &format!("phi{number}")),
                out(tube),
            ]),
            // Along a line of contact with a plane, the position has no effect and is omitted.
            ContactSurface::Cylinder { radius } => {
                items.push(self.rotation_about(2, &format!("theta{number}")));
                if !matches!(other, ContactSurface::Plane) {
                    items.push(self.along(2, &format!("w{number}")));
                }
                items.push(out(radius));
            }
            // The plane's normal is z; a quarter turn makes it the x axis of the contact frame.
            ContactSurface::Plane => {
                items.extend(self.slides(side));
                items.push(self.turn(1, -(Constant::PI / Constant::exact(2.0))));
                items.extend(further.map(|more| self.along_by(0, more.clone())));
            }
            ContactSurface::Sphere { .. } => {}
        }
        items
    }

    fn slides(&self, side: usize) -> [Item; 2] {
        let number = side + 1;
        [
            self.along(0, &format!("u{number}")),
            self.along(1, &format!("v{number}")),
        ]
    }

    /// Rotation about a coordinate axis by the unknown `NAME.what`.
    fn rotation_about(&self, axis: usize, what: &str) -> Item {
        self.elementary_item(ElementaryMotion::Rotation, axis, self.unknown(what))
    }

    /// Translation along a coordinate axis by the unknown `NAME.what`.
    fn along(&self, axis: usize, what: &str) -> Item {
        self.elementary_item(ElementaryMotion::Translation, axis, self.unknown(what))
    }

    fn along_by(&self, axis: usize, length: FormulaNode) -> Item {
        self.elementary_item(ElementaryMotion::Translation, axis, length)
    }

    /// Rotation by a fixed angle in radians.
    fn turn(&self, axis: usize, angle: Constant) -> Item {
        let kind = NodeKind::Radians(angle);
        let span = self.name.span.clone();
        self.elementary_item(ElementaryMotion::Rotation, axis, FormulaNode { kind, span })
    }

    fn unknown(&self, what: &str) -> FormulaNode {
        FormulaNode {
            kind: NodeKind::Name(format!("{}.{what}", self.name.value)),
            span: self.name.span.clone(),
        }
    }

    fn elementary_item(
        &self,
        motion: ElementaryMotion,
        axis: usize,
        argument: FormulaNode,
    ) -> Item {
        Item::Transform {
            transform: Transform::Elementary(motion, axis),
            arguments: vec![argument],
            span: self.name.span.clone(),
        }
    }
}
