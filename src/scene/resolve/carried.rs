//! Solids that depend on the variables of a study: chains to their defining points, and their sizes, so that an
//! enclosure of all pieces knows their surfaces.

use super::super::file::SceneFile;
use super::super::formula::expansion::Factor;
use super::super::formula::node::FormulaNode;
use super::super::solids::ShapeFile;
use super::joints::FoldedJoints;
use super::parsed::Parsed;
use super::parsing::parsed_expression;
use super::solid_formulas::SolidFormulas;
use super::varied::Dependents;
use crate::diag::Diagnostics;
use crate::model::carried::CarriedShape;
use crate::model::chain::ElementaryMotion;
use crate::scene::values::FormulaText;

/// For every body the varied parameters, by their number, that appear in its shapes.
pub fn variables_of_shapes(
    (file, parsed): (&SceneFile, &Parsed),
    dependents: &Dependents,
) -> Vec<Vec<usize>> {
    let of_body = |shapes: &[ShapeFile]| {
        let mut used = Vec::new();
        let mut note = |mut node: FormulaNode| {
            dependents.expand(&mut node);
            dependents.note_used(&node, &mut used);
        };
        // Mistakes are reported where the solids are resolved.
        let silent = &mut Diagnostics::default();
        for shape in shapes {
            let typed = SolidFormulas::new(&shape.solid);
            let points = typed.points.iter().flat_map(|point| point.iter());
            let texts = points.chain(typed.sizes.iter().chain(&typed.fixed).copied());
            texts
                .filter_map(|text| parsed_expression(text, silent))
                .for_each(&mut note);
            let frame = shape.frame.as_ref();
            for factor in frame
                .and_then(|text| parsed.factors(text, silent))
                .into_iter()
                .flatten()
            {
                match factor {
                    Factor::Elementary(_, _, node) => note(node),
                    Factor::Direction(nodes, _) => nodes.into_iter().for_each(&mut note),
                }
            }
        }
        used
    };
    file.bodies
        .iter()
        .map(|body| of_body(&body.shapes))
        .collect()
}

/// The solids of all bodies, with chains that depend on the `dependents`.
pub fn carry_shapes(
    (file, parsed): (&SceneFile, &Parsed),
    dependents: &Dependents,
    joints: &mut FoldedJoints,
    diagnostics: &mut Diagnostics,
) -> Vec<CarriedShape> {
    let mut carried = Vec::new();
    for (body, typed_body) in file.bodies.iter().enumerate() {
        for (shape, typed_shape) in typed_body.shapes.iter().enumerate() {
            let typed = SolidFormulas::new(&typed_shape.solid);
            // The frame of the shape: that of its body, then its own.
            let mut frame = parsed.frames[body].clone();
            let own = typed_shape.frame.as_ref();
            let own = own.and_then(|text| parsed.factors(text, diagnostics));
            frame.extend(own.into_iter().flatten().map(|mut factor| {
                dependents.expand_factor(&mut factor);
                factor
            }));
            // Parameters computed from the variables are written out in every formula.
            let node = |text: &FormulaText, diagnostics: &mut Diagnostics| {
                let mut node = parsed_expression(text, diagnostics)?;
                dependents.expand(&mut node);
                Some(node)
            };
            // Chains from the world to the points; a shape without points uses the origin of its frame.
            let mut ways: Vec<Vec<Factor>> = Vec::new();
            for point in &typed.points {
                let mut way = frame.clone();
                for (axis, text) in point.iter().enumerate() {
                    way.extend(node(text, diagnostics).map(|node| translation_along(axis, node)));
                }
                ways.push(way);
            }
            if ways.is_empty() {
                ways.push(frame);
            }
            // A size is the length of a chain with a single translation.
            let lengths = typed.sizes.iter();
            let lengths = lengths
                .filter_map(|text| Some(vec![translation_along(0, node(text, diagnostics)?)]));
            let lengths: Vec<Vec<Factor>> = lengths.collect();
            // A direction or scale that depends on a variable is named, so that it can be refused.
            let fixed = typed.fixed.iter();
            let stiff = fixed.filter_map(|text| dependents.used_in(&node(text, diagnostics)?));
            let stiff = stiff.collect::<Vec<String>>().into_iter().next();
            let mut chains = |all: Vec<Vec<Factor>>, diagnostics: &mut Diagnostics| {
                let all = all.iter();
                all.filter_map(|factors| joints.chain(factors, diagnostics))
                    .collect()
            };
            carried.push(CarriedShape {
                body,
                shape,
                points: chains(ways, diagnostics),
                sizes: chains(lengths, diagnostics),
                stiff,
            });
        }
    }
    carried
}

/// A translation along an axis.
fn translation_along(axis: usize, node: FormulaNode) -> Factor {
    Factor::Elementary(ElementaryMotion::Translation, axis, node)
}
