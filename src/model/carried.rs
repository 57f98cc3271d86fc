//! Where the points of a solid are, as chains that follow its dimensions.

use super::chain::Chain;

/// A shape of a body whose numbers follow the coordinates that stand for dimensions.
#[derive(Clone, Debug)]
pub struct CarriedShape {
    /// Index of the body.
    pub body: usize,
    /// Index of the shape in the body's list.
    pub shape: usize,
    /// Chains from the world to the points that it is made of, in their order, in the shape's directions.
    pub points: Vec<Chain>,
    /// Its radii and edges, each as a chain along x.
    pub sizes: Vec<Chain>,
    /// A dimension that its direction or its scale depends on, which no chain follows.
    pub stiff: Option<String>,
}
