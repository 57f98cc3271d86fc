//! Lines between surfaces: silhouettes, creases and borders between bodies; the part shared by both renderers.
//!
//! Every sample of a picture knows its surface. A sample is on a line if another surface is nearer to it than half the
//! line's width, or if the depth of its own surface jumps next to it. Lines are mixed in at samples: in linear light,
//! as a fraction of each pixel.

use crate::weld::number_first;

/// Width of a line in 480ths of the picture's height.
const WIDTH: f64 = 1.15;

/// Smallest half width in pixels with which samples of a pixel detect their neighbours: for 1, 2, 4 and more samples.
const LEAST_HALF_WIDTH: [(u32, f64); 4] = [(1, 1.01), (2, 0.75), (4, 0.6), (u32::MAX, 0.5)];

/// Greatest half width in pixels, which those of pictures of some 14 000 rows have.
const MOST_HALF_WIDTH: f64 = 8.0;

/// Fraction of a pixel's light that a line takes away where it covers all of it.
pub const STRENGTH: f32 = 0.82;

/// A step of one surface's depth within a line's half width is a silhouette from this many pixels on.
pub const JUMP: f32 = 8.0;

/// The surface of everything without lines, such as a trace.
pub const NO_LINES: u32 = 0;

/// The surface of the background.
pub const BACKDROP: u32 = 1;

/// The first surface of bodies; the number before it is reserved for the renderers.
pub const FIRST: u32 = 3;

/// Set in translucent surfaces. Lines of opaque surfaces are drawn first and are visible through them; over them only
/// lines with a translucent side are drawn.
pub const TRANSLUCENT: u32 = 1 << 31;

/// The first outline of cut faces: all faces of a body in one plane are one surface, whatever their patches and whichever
/// lines are drawn, so that hatching on them has no lines of its own.
pub const FIRST_CUT: u32 = 3 << 29;

/// The surface of the first patch of an instance of the body `outline`, and the step from patch to patch. With `creases`
/// patches are surfaces of their own, of which `before` belong to the instances before.
pub fn first_surface(outline: Option<u32>, opacity: f64, creases: bool, before: u32) -> [u32; 2] {
    let flag = if opacity < 1.0 { TRANSLUCENT } else { 0 };
    let number = |n: u32| ((n % (TRANSLUCENT - FIRST)) + FIRST) | flag;
    match outline {
        None => [NO_LINES, 0],
        Some(body) if creases && body < FIRST_CUT => [number(before), 1],
        Some(body) => [number(body), 0],
    }
}

/// The lines of a stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeStyle {
    /// Creases and the borders between the solids of a body as well, not only outlines of bodies.
    pub creases: bool,
    /// sRGB colour.
    pub ink: [u8; 3],
}

impl EdgeStyle {
    /// Half the width of the lines in pixels, in a picture `height` pixels high with `samples` a pixel.
    pub fn half_width(height: u32, samples: u32) -> f64 {
        let least = LEAST_HALF_WIDTH.iter().find(|(most, _)| samples <= *most);
        let least = least.map_or(0.0, |(_, least)| *least);
        (0.5 * WIDTH / 480.0 * f64::from(height)).clamp(least, MOST_HALF_WIDTH)
    }
}

/// The smooth patch that each of `count` vertices of a mesh belongs to, and the number of patches: two triangles belong
/// to one patch if a chain of common vertices connects them. At a crease, the two sides have separate vertices.
pub fn patches(count: usize, triangles: &[[u32; 3]]) -> (Vec<u32>, u32) {
    let mut parent: Vec<u32> = (0..count as u32).collect();
    for triangle in triangles {
        let [a, b, c] = triangle.map(|i| i as usize);
        if a.max(b).max(c) < count {
            join_sets(&mut parent, a, b);
            join_sets(&mut parent, b, c);
        }
    }
    // A root precedes all its members: one pass finds the root of each, and roots are numbered in place.
    for vertex in 0..count {
        parent[vertex] = parent[parent[vertex] as usize];
    }
    let number = number_first(&mut parent) as u32;
    (parent, number)
}

fn find_root(parent: &mut [u32], mut vertex: usize) -> usize {
    while parent[vertex] as usize != vertex {
        // Path halving for later look-ups.
        parent[vertex] = parent[parent[vertex] as usize];
        vertex = parent[vertex] as usize;
    }
    vertex
}

fn join_sets(parent: &mut [u32], a: usize, b: usize) {
    let (a, b) = (find_root(parent, a), find_root(parent, b));
    let (low, high) = (a.min(b), a.max(b));
    parent[high] = low as u32;
}

#[cfg(test)]
mod tests;
