//! Vectors, rotations and dual numbers, as short as the formulas of books need them.

/// A vector.
pub type Vector = [f64; 3];

/// Scalar product.
pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `v` turned about the coordinate axis `axis`.
pub fn turn(axis: usize, angle: f64, v: Vector) -> Vector {
    let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
    let (s, c) = angle.sin_cos();
    let mut w = v;
    w[j] = c * v[j] - s * v[k];
    w[k] = s * v[j] + c * v[k];
    w
}

/// One angle and one length: a + eps b with eps² = 0 (Clifford, Study).
#[derive(Clone, Copy)]
pub struct Dual(pub f64, pub f64);

impl Dual {
    pub fn sin(self) -> Self {
        Self(self.0.sin(), self.1 * self.0.cos())
    }

    pub fn cos(self) -> Self {
        Self(self.0.cos(), -self.1 * self.0.sin())
    }

    pub fn acos(self) -> Self {
        let slope = -1.0 / (1.0 - self.0 * self.0).sqrt();
        Self(self.0.acos(), self.1 * slope)
    }

    pub fn sqrt(self) -> Self {
        let root = self.0.sqrt();
        Self(root, self.1 / (2.0 * root))
    }

    /// The angle of the point (x, self).
    pub fn atan2(self, x: Self) -> Self {
        let square = x.0 * x.0 + self.0 * self.0;
        Self(self.0.atan2(x.0), (x.0 * self.1 - self.0 * x.1) / square)
    }

    pub fn scaled(self, by: f64) -> Self {
        Self(by * self.0, by * self.1)
    }
}

impl std::ops::Add for Dual {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0, self.1 + other.1)
    }
}

impl std::ops::Mul for Dual {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self(self.0 * other.0, self.0 * other.1 + self.1 * other.0)
    }
}

impl std::ops::Div for Dual {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.0 / other.0;
        Self(value, (self.1 - value * other.1) / other.0)
    }
}
