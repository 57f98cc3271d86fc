//! The formulas of solids as typed: points, sizes, directions and scales.

use super::super::file::SceneFile;
use super::super::formula::node::FormulaNode;
use super::super::solids::SolidFile;
use super::parsing::parsed_expression;
use crate::diag::Diagnostics;
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
