//! The defining points of a solid as chains that depend on its dimensions.

use super::chain::Chain;

/// A shape of a body whose numbers depend on the coordinates that represent dimensions.
#[derive(Clone, Debug)]
pub struct CarriedShape {
    /// Index of the body.
    pub body: usize,
    /// Index of the shape in the body's list.
    pub shape: usize,
    /// Chains from the world to its defining points, in their order, in the shape's directions.
    pub points: Vec<Chain>,
    /// Its radii and edges, each as a chain along x.
    pub sizes: Vec<Chain>,
    /// A dimension that determines its direction or scale, which no chain can represent.
    pub stiff: Option<String>,
}
