//! Oddities and defects of the meshes of a check.

use crate::distance::bodies::BodyElements;
use crate::distance::mesh_tree::{MeshTree, ShellEnclosure};
use crate::distance::primitive::Primitive;
use crate::model::mechanism::Mechanism;

/// Every mesh of a body.
fn hull_meshes(hull: &BodyElements) -> impl Iterator<Item = &MeshTree> {
    hull.elements
        .iter()
        .filter_map(|element| match &element.core {
            Primitive::Mesh(tree, _) => Some(tree.as_ref()),
            _ => None,
        })
}

/// What is odd about a body's meshes.
pub(super) fn mesh_warnings(mechanism: &Mechanism, hulls: &[Option<BodyElements>]) -> Vec<String> {
    let mut list = Vec::new();
    for (body, hull) in mechanism.bodies.iter().zip(hulls) {
        for tree in hull.iter().flat_map(hull_meshes) {
            let mesh = format!("the mesh of `{}` ({})", body.name, tree.source);
            if tree.enclosure == ShellEnclosure::InsideOut {
                list.push(format!(
                    "{mesh} is inside out; the enclosed space counts as its inside all the same"
                ));
            }
            if tree.flaps > 0 {
                let flaps = match tree.flaps {
                    1 => "a triangle that belongs".to_owned(),
                    count => format!("{count} triangles that belong"),
                };
                list.push(format!(
                    "{mesh} has {flaps} to no closed shell: taken as a sheet that encloses nothing"
                ));
            }
        }
    }
    list
}

/// Meshes of judged bodies that should have an interior but have none: the body and the defect.
pub(super) fn without_inside(
    mechanism: &Mechanism,
    hulls: &[Option<BodyElements>],
    is_judged: impl Fn(usize) -> bool,
) -> Vec<(usize, String)> {
    let mut list = Vec::new();
    for (k, hull) in hulls.iter().enumerate() {
        let open = hull.iter().flat_map(hull_meshes);
        for tree in open {
            // The two kinds of shells that should have an inside and have none.
            let is_tangled = tree.enclosure == ShellEnclosure::Tangled;
            if !is_tangled && tree.enclosure != ShellEnclosure::Open {
                continue;
            }
            // Bodies that no requirement concerns need none.
            if !is_judged(k) {
                continue;
            }
            let (name, source) = (&mechanism.bodies[k].name, &tree.source);
            // What keeps the mesh from having one.
            let why = match tree.open_edges {
                _ if is_tangled => "too many of its shells are nested".to_owned(),
                0 => "its triangles enclose nothing".to_owned(),
                1 => "an edge has more triangles on one side than on the other".to_owned(),
                edges => format!("{edges} edges have more triangles on one side than on the other"),
            };
            let text = format!(
                "the mesh of `{name}` ({source}) has no inside: {why}; bodies inside it are not detected: repair the file, or write `surface = true` if it is a surface"
            );
            list.push((k, text));
        }
    }
    list
}
