//! What changed between two frames.

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PixelArea {
    pub(super) left: usize,
    pub(super) top: usize,
    pub(super) width: usize,
    pub(super) height: usize,
}

impl PixelArea {
    /// The whole of a picture.
    pub(super) fn whole(size: [usize; 2]) -> Self {
        Self {
            left: 0,
            top: 0,
            width: size[0],
            height: size[1],
        }
    }

    /// The smallest rectangle outside which `before` and `after`, `width` pixels a row, are equal; `None` if they
    /// are equal everywhere.
    pub(super) fn changed<P: PartialEq>(before: &[P], after: &[P], width: usize) -> Option<Self> {
        let rows = || before.chunks_exact(width).zip(after.chunks_exact(width));
        let top = rows().position(|(a, b)| a != b)?;
        let bottom = rows().rposition(|(a, b)| a != b)?;
        let (mut left, mut right) = (width, 0);
        for (a, b) in rows().take(bottom + 1).skip(top) {
            if a[..left] != b[..left] {
                left = a.iter().zip(b).position(|(a, b)| a != b).unwrap_or(left);
            }
            if a[right..] != b[right..] {
                let last = a.iter().zip(b).rposition(|(a, b)| a != b);
                right = last.map_or(right, |last| last + 1);
            }
        }
        Some(Self {
            left,
            top,
            width: right - left,
            height: bottom + 1 - top,
        })
    }

    /// The rows of this rectangle in a picture of `width` pixels a row.
    pub(super) fn rows<'a, P>(
        &self,
        picture: &'a [P],
        width: usize,
    ) -> impl Iterator<Item = &'a [P]> {
        let (from, to) = (self.left, self.left + self.width);
        let rows = picture.chunks_exact(width).skip(self.top).take(self.height);
        rows.map(move |row| &row[from..to])
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    #[test]
    fn the_rectangle_is_the_tightest_one() {
        let (w, h) = (9, 7);
        let before = vec![0; w * h];
        for (x0, y0, x1, y1) in [
            (0, 0, 0, 0),
            (8, 6, 8, 6),
            (2, 1, 5, 4),
            (0, 3, 8, 3),
            (7, 0, 7, 6),
        ] {
            // Two opposite corners, in both diagonals.
            for flip in [false, true] {
                let mut after = before.clone();
                let (ya, yb) = if flip { (y1, y0) } else { (y0, y1) };
                after[ya * w + x0] = 1;
                after[yb * w + x1] = 1;
                let area = PixelArea::changed(&before, &after, w).unwrap();
                assert_eq!(
                    area,
                    PixelArea {
                        left: x0,
                        top: y0,
                        width: x1 - x0 + 1,
                        height: y1 - y0 + 1
                    }
                );
            }
        }
        assert_eq!(PixelArea::changed(&before, &before, w), None);
    }
}
