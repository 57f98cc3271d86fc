//! Formulas of loops and equations that may jump or have kinks, and their behaviour between two poses.

use crate::model::chain::{Argument, ChainStep, ElementaryMotion};
use crate::model::expression::Expression;
use crate::model::expression::sides::WayJump;
use crate::model::mechanism::Mechanism;
use crate::numbers::constant::Constant;

/// A jump that changes by a larger share on the way may vanish at its place, as that of `floor(phi)*(phi - 1)` does.
const SAME_JUMP: f64 = 0.5;

/// A formula of a loop or an equation that may jump or has a kink.
#[derive(Clone, Debug)]
pub(crate) struct JumpSite {
    formula: Expression,
    /// It is the angle of a rotation: whole turns are no jump.
    is_angle: bool,
    /// The loop or equation.
    name: String,
}

impl JumpSite {
    /// Those of a mechanism.
    pub fn all(mechanism: &Mechanism) -> Vec<Self> {
        let mut sites = Vec::new();
        for equation in mechanism
            .equations
            .iter()
            .filter(|e| e.expression.has_pieces())
        {
            sites.push(Self {
                formula: equation.expression.clone(),
                is_angle: false,
                name: equation.name.clone(),
            });
        }
        // Formulas inside joints: a jump of a rotation by whole turns is none.
        for item in &mechanism.loops {
            for step in &item.chain.steps {
                let ChainStep::Joint {
                    motion, argument, ..
                } = step
                else {
                    continue;
                };
                if let Argument::Formula(formula) = &mechanism.arguments[*argument]
                    && formula.has_pieces()
                {
                    sites.push(Self {
                        formula: formula.clone(),
                        is_angle: *motion == ElementaryMotion::Rotation,
                        name: item.name.clone(),
                    });
                }
            }
        }
        sites
    }

    /// What it does on the straight way between two places.
    fn way(&self, from: &[f64], to: &[f64]) -> FormulaBehaviour<'_> {
        // What does not jump by a known size is settled first.
        let sizes = match self.formula.jump_on_way(from, to) {
            None if self.formula.passes_kink([from, to]) => return FormulaBehaviour::Kink,
            None => return FormulaBehaviour::Smooth,
            Some(WayJump::Open) => return FormulaBehaviour::Open,
            Some(WayJump::By(sizes)) => sizes,
        };
        // The size at both ends; of an angle what it differs by from whole turns.
        let [a, b] = sizes.map(|jump| {
            let turn = Constant::PI * Constant::exact(2.0);
            let rest = match self.is_angle {
                true => jump - turn * Constant::exact((jump / turn).number().round()),
                false => jump,
            };
            // A jump within its own error bound is none.
            let is_rounding = rest.number().abs() <= rest.error();
            if is_rounding { 0.0 } else { rest.number() }
        });
        if a == 0.0 && b == 0.0 {
            return FormulaBehaviour::Smooth;
        }
        // A jump of like size and sign at both ends has not vanished between them.
        let is_same = a.abs().min(b.abs()) >= SAME_JUMP * a.abs().max(b.abs());
        match is_same && (a < 0.0) == (b < 0.0) {
            true => FormulaBehaviour::Jumps(&self.name),
            false => FormulaBehaviour::Open,
        }
    }
}

/// The behaviour of formulas between two poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum FormulaBehaviour<'t> {
    /// They neither jump nor have a kink.
    Smooth,
    /// One has a kink, and none jumps.
    Kink,
    /// One may, or may not.
    Open,
    /// That of this loop or equation jumps.
    Jumps(&'t str),
}

impl<'t> FormulaBehaviour<'t> {
    /// Their behaviour on the straight line from one point to another. A point on a jump may have a value of its own, so both
    /// halves of the line are examined.
    pub fn between(sites: &'t [JumpSite], from: &[f64], to: &[f64]) -> Self {
        if sites.is_empty() {
            return Self::Smooth;
        }
        let halves = from.iter().zip(to).map(|(a, b)| 0.5 * a + 0.5 * b);
        let middle: Vec<f64> = halves.collect();
        let mut way = Self::Smooth;
        for site in sites {
            for [a, b] in [[from, &middle], [&middle, to]] {
                match site.way(a, b) {
                    Self::Smooth => {}
                    Self::Kink if way == Self::Smooth => way = Self::Kink,
                    Self::Kink => {}
                    Self::Open => way = Self::Open,
                    jump @ Self::Jumps(_) => return jump,
                }
            }
        }
        way
    }
}
