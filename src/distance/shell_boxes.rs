//! Boxes around the shells of a mesh, in a tree: finds those in which a point may lie.

use super::shell_surface::Parts;
use glam::DVec3;

/// Boxes in a leaf.
const LEAF: usize = 8;

/// The boxes of all shells.
pub(crate) struct ShellBoxes {
    /// Least and greatest corner of each.
    boxes: Vec<[DVec3; 2]>,
    /// The shells, those of one branch side by side; a branch is split in the middle.
    order: Vec<u32>,
    /// Boxes around branches, and the index of each one's second child; the first one follows.
    branches: Vec<([DVec3; 2], usize)>,
}

impl ShellBoxes {
    /// The boxes of the shells of these triangles.
    pub(crate) fn new(triangles: &[[DVec3; 3]], shells: &Parts) -> Self {
        let around = |shell: &[u32]| {
            let corners = shell.iter().flat_map(|k| triangles[*k as usize]);
            corners.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], p| {
                [low.min(p), high.max(p)]
            })
        };
        let boxes: Vec<[DVec3; 2]> = shells.each().map(around).collect();
        let mut tree = Self {
            order: (0..boxes.len() as u32).collect(),
            branches: Vec::new(),
            boxes,
        };
        tree.grow(0, tree.order.len());
        tree
    }

    fn grow(&mut self, start: usize, end: usize) {
        let part = &mut self.order[start..end];
        let all = part.iter().map(|k| self.boxes[*k as usize]);
        let around = all.fold(
            [DVec3::INFINITY, DVec3::NEG_INFINITY],
            |[low, high], [l, h]| [low.min(l), high.max(h)],
        );
        let index = self.branches.len();
        self.branches.push((around, index));
        if end - start <= LEAF {
            return;
        }
        let extent = around[1] - around[0];
        let axis = (0..3).fold(0, |k, j| if extent[j] > extent[k] { j } else { k });
        let key = |k: &u32| {
            let [low, high] = self.boxes[*k as usize];
            low[axis] + high[axis]
        };
        let middle = (end - start) / 2;
        part.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)));
        self.grow(start, start + middle);
        self.branches[index].1 = self.branches.len();
        self.grow(start + middle, end);
    }

    /// Calls `tell` with the shells whose boxes contain a point.
    pub(crate) fn each_around(&self, point: DVec3, tell: &mut impl FnMut(usize)) {
        self.walk(0, [0, self.order.len()], point, tell);
    }

    /// Goes through a branch over a range of the order.
    fn walk(
        &self,
        branch: usize,
        [start, end]: [usize; 2],
        point: DVec3,
        tell: &mut impl FnMut(usize),
    ) {
        let (around, second) = &self.branches[branch];
        if !holds(around, point) {
            return;
        }
        if end - start <= LEAF {
            let here = self.order[start..end].iter().map(|k| *k as usize);
            here.filter(|k| holds(&self.boxes[*k], point))
                .for_each(tell);
            return;
        }
        let middle = start + (end - start) / 2;
        self.walk(branch + 1, [start, middle], point, tell);
        self.walk(*second, [middle, end], point, tell);
    }
}

fn holds([low, high]: &[DVec3; 2], point: DVec3) -> bool {
    low.cmple(point).all() && high.cmpge(point).all()
}
