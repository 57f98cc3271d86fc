//! The formulas of solids as typed: points, sizes, directions and scales.

use super::super::file::SceneFile;
use super::super::formula::expansion::Factor;
use super::super::formula::node::FormulaNode;
use super::super::solids::SolidFile;
use super::kinds_of_names::kind_of_motion;
use super::parsed::Parsed;
use super::parsing::parsed_expression;
use crate::diag::Diagnostics;
use crate::model::mechanism::Kind;
use crate::scene::values::FormulaText;

/// The formulas of a solid.
#[derive(Default)]
pub struct SolidFormulas<'f> {
    /// Its defining points.
    pub points: Vec<&'f [FormulaText; 3]>,
    /// Radii and edges.
    pub sizes: Vec<&'f FormulaText>,
    /// Directions and scales.
    pub fixed: Vec<&'f FormulaText>,
}

impl<'f> SolidFormulas<'f> {
    /// Those of a solid.
    pub fn new(solid: &'f SolidFile) -> Self {
        let typed = Self::default();
        let at = |centre: &'f Option<[FormulaText; 3]>| centre.iter().collect();
        let along = |axis: &'f Option<[FormulaText; 3]>| axis.iter().flatten().collect();
        // Points are followed by chains, sizes by lengths; directions and scales cannot be followed.
        match solid {
            SolidFile::Sphere { centre, radius } => Self {
                points: at(centre),
                sizes: vec![radius],
                ..typed
            },
            SolidFile::Capsule { from, to, radius } | SolidFile::Cylinder { from, to, radius } => {
                Self {
                    points: vec![from, to],
                    sizes: vec![radius],
                    ..typed
                }
            }
            SolidFile::Cone {
                from,
                to,
                radius_from,
                radius_to,
            } => Self {
                points: vec![from, to],
                sizes: vec![radius_from, radius_to],
                ..typed
            },
            SolidFile::Box { centre, size } => Self {
                points: at(centre),
                sizes: size.iter().collect(),
                ..typed
            },
            SolidFile::Torus {
                centre,
                axis,
                ring,
                tube,
            } => Self {
                points: at(centre),
                sizes: vec![ring, tube],
                fixed: along(axis),
            },
            SolidFile::Tube { points, radius, .. } => Self {
                points: points.value.iter().collect(),
                sizes: vec![radius],
                ..typed
            },
            SolidFile::HalfSpace { point, normal, .. } => Self {
                points: at(point),
                fixed: along(normal),
                ..typed
            },
            SolidFile::Stl { scale, .. } => Self {
                fixed: scale.iter().collect(),
                ..typed
            },
        }
    }
}

/// All formulas of solids but those of their frames.
pub fn formulas_of_solids(file: &SceneFile) -> Vec<FormulaNode> {
    let shapes = file.bodies.iter().flat_map(|body| &body.shapes);
    let mut nodes = Vec::new();
    for shape in shapes {
        let typed = SolidFormulas::new(&shape.solid);
        let points = typed.points.iter().flat_map(|point| point.iter());
        let texts = points.chain(typed.sizes.iter().chain(&typed.fixed).copied());
        // Errors in them are reported where the solids are resolved.
        nodes.extend(texts.filter_map(|text| parsed_expression(text, &mut Diagnostics::default())));
    }
    nodes
}

/// The formulas of solids whose kind is known: those of their points and sizes, and the motions of their frames.
pub fn dimensions_of_solids(file: &SceneFile, parsed: &Parsed) -> Vec<(FormulaNode, Kind)> {
    let shapes = file.bodies.iter().flat_map(|body| &body.shapes);
    let mut nodes = Vec::new();
    // Errors in them are reported where the solids are resolved.
    let silent = &mut Diagnostics::default();
    for shape in shapes {
        let typed = SolidFormulas::new(&shape.solid);
        let texts = typed.points.iter().flat_map(|point| point.iter());
        let lengths = texts
            .chain(typed.sizes.iter().copied())
            .filter_map(|text| parsed_expression(text, silent));
        nodes.extend(lengths.map(|node| (node, Kind::Length)));
        let frame = shape.frame.as_ref();
        let factors = frame.and_then(|text| parsed.factors(text, silent));
        nodes.extend(
            factors
                .into_iter()
                .flatten()
                .filter_map(|factor| match factor {
                    Factor::Elementary(motion, _, node) => Some((node, kind_of_motion(motion))),
                    Factor::Direction(..) => None,
                }),
        );
    }
    nodes
}
