//! Constructions with compass and ruler.

/// A point of the plane.
pub type Point = [f64; 2];

/// `distance` from `from` in a direction.
pub fn along(from: Point, distance: f64, direction: f64) -> Point {
    [
        from[0] + distance * direction.cos(),
        from[1] + distance * direction.sin(),
    ]
}

/// The two points at given distances from two others: left and right of the way from the first to the second.
pub fn meet(a: Point, ra: f64, b: Point, rb: f64) -> [Point; 2] {
    let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    let square = dx * dx + dy * dy;
    let share = 0.5 + (ra - rb) * (ra + rb) / (2.0 * square);
    let height = (ra * ra / square - share * share).sqrt();
    [1.0, -1.0].map(|side| {
        [
            a[0] + share * dx - side * height * dy,
            a[1] + share * dy + side * height * dx,
        ]
    })
}

/// The angle at a corner of a triangle between sides `a` and `b`, opposite `c`.
pub fn corner(a: f64, b: f64, c: f64) -> f64 {
    ((a * a + b * b - c * c) / (2.0 * a * b)).acos()
}

/// A point given in the frame at `origin` whose x axis leads to `towards`.
pub fn placed(origin: Point, towards: Point, local: Point) -> Point {
    let [dx, dy] = [towards[0] - origin[0], towards[1] - origin[1]];
    let length = dx.hypot(dy);
    let [ex, ey] = [dx / length, dy / length];
    [
        origin[0] + ex * local[0] - ey * local[1],
        origin[1] + ey * local[0] + ex * local[1],
    ]
}

/// Distance of two points.
pub fn apart(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
