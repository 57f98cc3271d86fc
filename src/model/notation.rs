//! Chains as the scene writes them: every factor with its text, before constants are folded into poses and inverse
//! factors are cancelled. For drawings and written matrices; only poses are computed with them.

use super::chain::{Argument, ArgumentValue, ChainStep, ElementaryMotion};
use crate::math::Pose;

/// One factor of a written chain.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenFactor {
    /// Motion and axis (0 x, 1 y, 2 z); `None` for the rotation to the direction of a general axis.
    pub motion: Option<(ElementaryMotion, usize)>,
    /// Its argument as typed, with its sign.
    pub text: String,
    /// What it is; arguments are those of the [`Notation`].
    pub step: ChainStep,
    /// Its argument as a sum; empty for the direction of an axis.
    pub terms: Vec<WrittenTerm>,
    /// A constant whose argument contains a name.
    pub is_dimension: bool,
    /// The step of the mechanism's chain that it became; `None` for constants and cancelled factors.
    pub place: Option<usize>,
}

/// A term of a sum.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenTerm {
    /// As typed, without sign.
    pub text: String,
    /// Whether it is subtracted.
    pub is_negative: bool,
    /// Its value, among the terms of the [`Notation`].
    pub argument: usize,
}

/// A chain with its name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WrittenChain {
    /// Name in the scene.
    pub name: String,
    /// The chain as typed, with the names of other chains.
    pub text: String,
    /// All factors, from left to right.
    pub factors: Vec<WrittenFactor>,
    /// How many of them precede the start of the mechanism's loop.
    pub before: usize,
}

/// A surface of a contact.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenSurface {
    /// `torus`, `sphere`, `cylinder` or `plane`.
    pub word: &'static str,
    /// Its sizes: text and value.
    pub sizes: Vec<(String, f64)>,
    /// From the world to its frame.
    pub frame: WrittenChain,
}

/// A contact of two surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenContact {
    /// Name in the scene.
    pub name: String,
    /// Both surfaces.
    pub sides: [WrittenSurface; 2],
}

/// The length of a bar.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenLength {
    /// As typed.
    pub text: String,
    /// Whether it contains a name.
    pub has_name: bool,
}

/// All chains of a scene as written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Notation {
    /// Arguments of the moving factors. Slots: unknowns, then inputs.
    pub arguments: Vec<Argument>,
    /// Values of the terms of sums, with the same slots.
    pub terms: Vec<Argument>,
    /// One for each loop of the mechanism, in its order.
    pub loops: Vec<WrittenChain>,
    /// One for each body of the mechanism, in its order; empty for a body fixed to the world.
    pub bodies: Vec<WrittenChain>,
    /// The named chains.
    pub chains: Vec<WrittenChain>,
    /// From the frame of its body to each traced point.
    pub points: Vec<WrittenChain>,
    /// Contacts of surfaces.
    pub contacts: Vec<WrittenContact>,
    /// Lengths of the mechanism's bars, in their order.
    pub bar_lengths: Vec<WrittenLength>,
}

impl Notation {
    /// Values of all arguments at the given coordinates (unknowns, then inputs).
    pub fn values(&self, coordinates: &[f64]) -> Vec<ArgumentValue> {
        let mut scratch = Vec::new();
        let values = self.arguments.iter();
        values
            .map(|a| ArgumentValue::new(a.value(coordinates, &mut scratch)))
            .collect()
    }

    /// Values of the terms of sums at the given coordinates.
    pub fn term_values(&self, coordinates: &[f64]) -> Vec<f64> {
        let mut scratch = Vec::new();
        let terms = self.terms.iter();
        terms.map(|t| t.value(coordinates, &mut scratch)).collect()
    }

    /// The chain of that name: a named chain, a loop or a contact.
    pub fn find(&self, name: &str) -> Option<&WrittenChain> {
        let mut all = self.chains.iter().chain(&self.loops);
        all.find(|chain| chain.name == name)
    }
}

impl WrittenFactor {
    /// The factor at the given argument values.
    pub fn pose(&self, values: &[ArgumentValue]) -> Pose {
        let mut pose = Pose::IDENTITY;
        self.step.advance(&mut pose, values);
        pose
    }

    /// Value of an elementary motion: radians or the scene's length unit.
    pub fn value(&self, values: &[ArgumentValue]) -> f64 {
        if let Some(joint) = self.step.joint() {
            return joint.sign * values[joint.argument].value;
        }
        let pose = self.pose(values);
        match self.motion {
            Some((ElementaryMotion::Translation, axis)) => pose.translation[axis],
            Some((ElementaryMotion::Rotation, axis)) => {
                let turned = pose.rotation.col((axis + 1) % 3);
                libm::atan2(turned[(axis + 2) % 3], turned[(axis + 1) % 3])
            }
            None => 0.0,
        }
    }

    /// A constant without a name.
    pub fn is_number(&self) -> bool {
        self.step.joint().is_none() && !self.is_dimension
    }

    /// In the notation of a chain: `Tx(L4)`.
    pub fn written(&self) -> String {
        match self.motion {
            Some((motion, axis)) => {
                let letter = match motion {
                    ElementaryMotion::Translation => 'T',
                    ElementaryMotion::Rotation => 'R',
                };
                format!("{letter}{}({})", AXES[axis], self.text)
            }
            None => format!("Z({})", self.text),
        }
    }
}

/// Letters of the axes.
pub const AXES: [char; 3] = ['x', 'y', 'z'];

impl WrittenChain {
    /// The product at the given argument values.
    pub fn pose(&self, values: &[ArgumentValue]) -> Pose {
        let factors = self.factors.iter();
        factors.fold(Pose::IDENTITY, |pose, f| pose * f.pose(values))
    }
}

/// A text without its leading sign, if that belongs to the whole.
pub fn unsigned_text(text: &str) -> &str {
    let Some(rest) = text.strip_prefix('-') else {
        return text;
    };
    let inner = rest.strip_prefix('(').and_then(|r| r.strip_suffix(')'));
    match inner {
        Some(inner) if !inner.contains(['(', ')']) => inner,
        _ if rest.contains(" + ") || rest.contains(" - ") => text,
        _ => rest,
    }
}
