//! The plane of a planar linkage.

/// Within this tolerance (radians, sizes of the mechanism), axes count as parallel, points as equal and three points as
/// collinear: the rounding of folded constants, far below any drawn difference.
pub const SAME: f64 = 1e-9;

/// The plane of projection.
pub struct ProjectionPlane {
    pub axes: [[f64; 3]; 2],
    pub names: [&'static str; 2],
}

impl ProjectionPlane {
    /// With two world axes if the normal is the third.
    pub fn square_to(normal: [f64; 3]) -> Self {
        let unit = |k: usize| [0, 1, 2].map(|i| if i == k { 1.0 } else { 0.0 });
        let along = (0..3).find(|k| normal[*k].abs() > 1.0 - SAME);
        match along {
            Some(k) => {
                let (a, b) = ([1, 0, 0][k], [2, 2, 1][k]);
                let names = ["x", "y", "z"];
                Self {
                    axes: [unit(a), unit(b)],
                    names: [names[a], names[b]],
                }
            }
            None => {
                // The world axis that is farthest from the normal, projected onto the plane.
                let far = (0..3).min_by(|a, b| normal[*a].abs().total_cmp(&normal[*b].abs()));
                let start = unit(far.unwrap_or(0));
                let part = dot_product(start, normal);
                let inside = [0, 1, 2].map(|i| start[i] - part * normal[i]);
                let length = dot_product(inside, inside).sqrt();
                let first = inside.map(|v| v / length);
                Self {
                    axes: [first, cross_product(normal, first)],
                    names: ["u", "v"],
                }
            }
        }
    }
}

/// a · b
pub fn dot_product(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a × b
pub fn cross_product(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        a[i] * b[j] - a[j] * b[i]
    })
}
