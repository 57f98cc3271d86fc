//! The shells of a mesh: its connected parts, whether each encloses space, and which side of it is outside.

use super::shell_boxes::ShellBoxes;
use super::shell_surface::{Parts, ShellSurface};
use super::triangle_tree::TriangleTree;
use super::two_sided::{halved, six_volumes};
use super::winding::turns_around;
use crate::model::shape::TriangleSoup;
use glam::DVec3;
use std::collections::HashMap;

/// How a file's triangles enclose space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShellEnclosure {
    /// Closed, with outward orientation.
    Solid,
    /// Closed, with inward orientation.
    InsideOut,
    /// It has edges with only one adjacent triangle.
    Open,
    /// Closed, but with too many nested shells to find which of them are walls of cavities.
    Tangled,
    /// The scene says that it is a surface, which has no inside.
    Surface,
}

/// Effort to distinguish walls of cavities from reversed shells, in triangles: a few seconds of work. Tens of thousands
/// of disjoint shells, and thousands of cavities in one, take far less.
const MOST_LOOKED_AT: usize = 20_000_000;

/// Shells of more triangles are queried with a tree, and count as this many.
const FEW: usize = 24;

/// The shells of a mesh.
pub struct Shells {
    /// Whether there is an inside.
    pub enclosure: ShellEnclosure,
    /// Edges that do not have equally many triangles on both sides, as the file orients them.
    pub open_edges: usize,
    /// A corner of every shell.
    pub points: Vec<DVec3>,
    /// The triangles, with closed shells oriented outwards.
    pub triangles: Vec<[DVec3; 3]>,
    /// Triangles that belong to no shell and enclose nothing, beside the others.
    pub flaps: Vec<[DVec3; 3]>,
}

impl Shells {
    /// The shells of triangles as stored in a file.
    pub fn new(soup: &TriangleSoup) -> Self {
        // Triangles that share edges; corners nearly at one place are welded if edges stay open.
        let mut surface = ShellSurface::new(soup);
        let mut edges = surface.edges();
        if edges.open().next().is_some() {
            surface.weld(&soup.vertices, &edges);
            drop(edges);
            edges = surface.edges();
        }
        let mut open_edges = edges.open().count();
        let corner = |k: u32| soup.vertices.get(k as usize).copied().unwrap_or_default();
        let mut triangles: Vec<[DVec3; 3]> = soup.triangles.iter().map(|t| t.map(corner)).collect();
        let parts = surface.parts();
        let points = parts.each().filter_map(|list| list.first());
        let points = points.map(|k| triangles[*k as usize][0]).collect();
        drop(parts);
        // What remains open may be flaps on closed shells.
        let mut flaps = Vec::new();
        if open_edges > 0 && surface.close(&edges, &mut triangles, &soup.vertices, &mut flaps) {
            open_edges = 0;
        }
        drop(edges);
        // A closed mesh has an inside; the sign of its volume says whether it is inside out.
        let is_hollow = !soup.is_surface && open_edges == 0 && !triangles.is_empty();
        if is_hollow {
            surface = halved(surface, &mut triangles);
        }
        let mut enclosure = match (soup.is_surface, is_hollow) {
            (true, _) => ShellEnclosure::Surface,
            (false, false) => ShellEnclosure::Open,
            (false, true) if six_volumes(triangles.iter()) < 0.0 => ShellEnclosure::InsideOut,
            (false, true) => ShellEnclosure::Solid,
        };
        if is_hollow && !turn_outside_out(&mut triangles, &surface.parts()) {
            enclosure = ShellEnclosure::Tangled;
        }
        Self {
            enclosure,
            open_edges,
            points,
            triangles,
            flaps,
        }
    }
}

/// Reverses closed shells with inward orientation, except walls of cavities; `false` if that would take too long.
fn turn_outside_out(triangles: &mut [[DVec3; 3]], shells: &Parts) -> bool {
    if six_volumes(triangles.iter()) < 0.0 {
        triangles.iter_mut().for_each(|t| t.swap(0, 1));
    }
    if shells.len() < 2 {
        return true;
    }
    let mut boxes = None;
    let mut trees: HashMap<usize, TriangleTree> = HashMap::new();
    let mut looked_at = 0;
    for (own, shell) in shells.each().enumerate() {
        if six_volumes(shell.iter().map(|k| &triangles[*k as usize])) >= 0.0 {
            continue;
        }
        let Some(point) = shell.first().map(|k| triangles[*k as usize][0]) else {
            continue;
        };
        // The wall of a cavity lies in another shell. A closed shell goes around nothing that is beside its box.
        let boxes = boxes.get_or_insert_with(|| ShellBoxes::new(triangles, shells));
        let mut turns = 0.0;
        boxes.each_around(point, &mut |other| {
            let part = shells.part(other);
            if other == own || looked_at > MOST_LOOKED_AT {
                return;
            }
            looked_at += part.len().min(FEW);
            let part_triangles = part.iter().map(|k| &triangles[*k as usize]);
            turns += match part.len() {
                ..=FEW => turns_around(part_triangles, point),
                _ => {
                    let tree = trees.entry(other);
                    let grow = || TriangleTree::new(part_triangles.copied().collect());
                    tree.or_insert_with(grow).turns(None, point)
                }
            };
        });
        if looked_at > MOST_LOOKED_AT {
            return false;
        }
        if turns.abs() < 0.5 {
            trees.remove(&own);
            shell.iter().for_each(|k| triangles[*k as usize].swap(0, 1));
        }
    }
    true
}
