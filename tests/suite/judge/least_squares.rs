//! Small dense least squares in f64: Householder with column pivoting.

/// Columns of a matrix, factorised.
pub struct Factors {
    /// Reflectors below, the triangle on and above the diagonal.
    columns: Vec<Vec<f64>>,
    order: Vec<usize>,
    weights: Vec<f64>,
    pub rank: usize,
}

/// Diagonal entries below this share of the first count as zero.
const RANK: f64 = 1e-13;

impl Factors {
    pub fn new(mut columns: Vec<Vec<f64>>) -> Self {
        let count = columns.len();
        let rows = columns.first().map_or(0, Vec::len);
        let mut order: Vec<usize> = (0..count).collect();
        let (mut weights, mut first, mut rank) = (Vec::new(), 0.0, 0);
        for k in 0..count.min(rows) {
            let rest = |c: &Vec<f64>| c[k..].iter().map(|v| v * v).sum::<f64>();
            let pivot = (k..count)
                .max_by(|a, b| rest(&columns[*a]).total_cmp(&rest(&columns[*b])))
                .unwrap();
            columns.swap(k, pivot);
            order.swap(k, pivot);
            let norm = rest(&columns[k]).sqrt();
            first = if k == 0 { norm } else { first };
            if norm <= RANK * first {
                break;
            }
            let head = columns[k][k];
            let diagonal = if head > 0.0 { -norm } else { norm };
            columns[k][k] = head - diagonal;
            let reflector = columns[k][k..].to_vec();
            let weight = -1.0 / (diagonal * (head - diagonal));
            for column in &mut columns[k + 1..] {
                reflect(&reflector, weight, &mut column[k..]);
            }
            weights.push(weight);
            rank = k + 1;
            // The reflector stays below; its head is kept beside the diagonal.
            columns[k].push(diagonal);
        }
        Self {
            columns,
            order,
            weights,
            rank,
        }
    }

    /// The smallest correction of a matrix of full column rank: min |A x - b|.
    pub fn solve(&self, b: &[f64]) -> Vec<f64> {
        let mut b = b.to_vec();
        let rows = b.len();
        for (k, weight) in self.weights.iter().enumerate() {
            reflect(&self.columns[k][k..rows], *weight, &mut b[k..]);
        }
        let mut x = vec![0.0; self.columns.len()];
        for k in (0..self.rank).rev() {
            let known: f64 = (k + 1..self.rank)
                .map(|j| self.columns[j][k] * x[self.order[j]])
                .sum();
            x[self.order[k]] = (b[k] - known) / self.columns[k][rows];
        }
        x
    }
}

/// v - weight (u·v) u
fn reflect(u: &[f64], weight: f64, v: &mut [f64]) {
    let product: f64 = u.iter().zip(&*v).map(|(a, b)| a * b).sum();
    for (v, u) in v.iter_mut().zip(u) {
        *v -= weight * product * u;
    }
}
