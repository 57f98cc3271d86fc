//! From one frame to the next with a still camera: only what moved is transformed and sorted into tiles again.

use super::super::lens::{Lens, OUTSIDE};
use super::super::mask::PixelMask;
use super::super::samples::SamplePattern;
use super::super::window::Window;
use super::tiles::ScreenTriangle;
use super::{InstancePlace, TriangleAssembly, on_screen};
use crate::render::last_frame::Change;
use crate::render::{Frame, MeshList};
use std::ops::Range;

/// Without lines, pixels cost so little that everything is done again if triangles of still instances are no more than this
/// share of all.
const LEAST_SHARE: f64 = 0.1;

impl TriangleAssembly {
    /// Whether it takes less time to renew the lists of the last frame than to make new ones.
    pub(super) fn is_worth_it(&self, changes: &[Change]) -> bool {
        let (mut still, mut all) = (0.0, 0.0);
        for (place, change) in self.places.iter().zip(changes) {
            let triangles = f64::from(place.triangles);
            all += triangles;
            still += if *change == Change::Moved {
                0.0
            } else {
                triangles
            };
        }
        self.apron > 0 || still > LEAST_SHARE * all
    }

    /// Turns the lists of the last frame into those of `frame`, whose instances have changed so. Returns false, with lists
    /// that are of no use, if this cannot be done.
    pub(super) fn renew<const G: usize>(
        &mut self,
        frame: &Frame,
        solids: MeshList,
        lens: &Lens,
        pattern: &SamplePattern<G>,
        mut changes: Vec<Change>,
    ) -> bool {
        // What is where, by the numbers of vertices and facets: those of still instances stay.
        let before = std::mem::take(&mut self.places);
        self.list_instances(frame, solids);
        if !self.keep_places(&before, &mut changes) {
            return false;
        }
        let listed = |index: usize| solids.get(frame.instances[index].mesh);
        for (index, change) in changes.iter_mut().enumerate() {
            // A mesh with all its triangles is drawn in another way than a part of it.
            let is_closed = listed(index).is_some_and(|solid| solid.closed);
            if matches!(change, Change::Grown(_)) && is_closed {
                *change = Change::Moved;
            }
        }
        self.remove_moved(&changes);
        // Vertices of moved instances anew. A shape that is cut off at the camera has vertices that it had not before.
        let shapes = frame.instances.iter().enumerate();
        let shapes = shapes.filter_map(|(index, i)| Some((index, i, solids.get(i.mesh)?)));
        for (index, instance, solid) in shapes.clone() {
            let is_inside = changes[index] != Change::Moved || {
                let own = self.places[index].vertices.clone();
                let own = &mut self.vertices[own.start as usize..own.end as usize];
                let placed = own.iter_mut().zip(on_screen(index, instance, solid, lens));
                placed.fold(true, |inside, (place, vertex)| {
                    *place = vertex;
                    inside & (vertex.x != OUTSIDE)
                })
            };
            if !is_inside {
                return false;
            }
        }
        // Facets of moved instances anew, and the new ones of those that have grown.
        for (index, instance, solid) in shapes {
            let from = match changes[index] {
                Change::Still => continue,
                Change::Grown(from) => from,
                Change::Moved => 0,
            };
            self.next = self.places[index].facets.end as usize;
            self.sweep_shape(index, instance, solid, lens, pattern, from);
            self.places[index].facets.end = self.next as u32;
        }
        // Facets are drawn in their order, which is that of the instances.
        for bin in self.bins.iter_mut().filter(|bin| !bin.changed.is_empty()) {
            bin.opaque.sort_unstable();
            bin.translucent.sort_unstable();
        }
        true
    }

    /// Takes over where the facets are; false if vertices or facets are numbered in another way. What has got other surfaces
    /// counts as moved.
    fn keep_places(&mut self, before: &[InstancePlace], changes: &mut [Change]) -> bool {
        let pairs = self.places.iter_mut().zip(before).zip(changes);
        let mut is_alike = true;
        for ((place, was), change) in pairs {
            is_alike &= place.vertices == was.vertices && place.triangles == was.triangles;
            place.facets = was.facets.clone();
            if place.surface != was.surface {
                *change = Change::Moved;
            }
        }
        is_alike
    }

    /// Takes the facets of moved instances out of the bins.
    fn remove_moved(&mut self, changes: &[Change]) {
        let moved = self.places.iter_mut().zip(changes);
        let moved = moved.filter(|(_, change)| **change == Change::Moved);
        let gone: Vec<Range<u32>> = moved
            .map(|(place, _)| {
                let start = place.facets.start;
                std::mem::replace(&mut place.facets, start..start)
            })
            .collect();
        // Where they were, lines and borders change too.
        let windows: Vec<Window> = (0..self.bins.len())
            .map(|tile| self.with_apron(self.window(tile)))
            .collect();
        for (bin, window) in self.bins.iter_mut().zip(windows) {
            bin.changed = PixelMask::NONE;
            for list in [&mut bin.opaque, &mut bin.translucent] {
                remove_ranges(list, &gone, |number| {
                    let facet = &self.facets[number as usize];
                    let triangle = ScreenTriangle::new(facet, &self.vertices);
                    triangle.mark(window.corner(), &mut bin.changed);
                });
            }
        }
    }
}

/// Removes the numbers within any of the ranges, and shows them; all are in rising order.
fn remove_ranges(list: &mut Vec<u32>, ranges: &[Range<u32>], mut show: impl FnMut(u32)) {
    let mut rest = ranges;
    list.retain(|number| {
        while let [first, others @ ..] = rest
            && first.end <= *number
        {
            rest = others;
        }
        let is_gone = rest.first().is_some_and(|range| range.contains(number));
        if is_gone {
            show(*number);
        }
        !is_gone
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_removed() {
        let mut list = vec![0, 3, 4, 9, 12, 13, 40];
        let mut removed = Vec::new();
        let ranges = [0..1, 4..4, 4..10, 13..14, 20..30];
        remove_ranges(&mut list, &ranges, |number| removed.push(number));
        assert_eq!(list, [3, 12, 40]);
        assert_eq!(removed, [0, 4, 9, 13]);
    }
}
