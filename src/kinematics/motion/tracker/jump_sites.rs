//! Formulas of loops and equations that may jump, and their behaviour between two poses.

use crate::model::chain::{Argument, ChainStep, ElementaryMotion};
use crate::model::expression::Expression;
use crate::model::mechanism::Mechanism;
use crate::numbers::constant::Constant;

/// A jump that changes by a larger share on the way may vanish at its place, as that of `floor(phi)*(phi - 1)` does.
const SAME_JUMP: f64 = 0.5;

/// A formula of a loop or an equation that may jump.
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
            .filter(|e| e.expression.has_jumps())
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
                    && formula.has_jumps()
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

    /// By how much it jumps between two places, as it is at either.
    fn jump(&self, from: &[f64], to: &[f64]) -> Option<[f64; 2]> {
        let jump = self.formula.jump_on_way(from, to)?;
        let sizes = jump.map(|jump| {
            let turn = Constant::PI * Constant::exact(2.0);
            let rest = match self.is_angle {
                true => jump - turn * Constant::exact((jump / turn).number().round()),
                false => jump,
            };
            let is_rounding = rest.number().abs() <= rest.error();
            if is_rounding { 0.0 } else { rest.number() }
        });
        (sizes != [0.0; 2]).then_some(sizes)
    }
}

/// The behaviour of formulas between two poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Way<'t> {
    /// They do not jump.
    Smooth,
    /// One may, or may not.
    Open,
    /// That of this loop or equation jumps.
    Jumps(&'t str),
}

impl<'t> Way<'t> {
    /// Their behaviour from one point to another.
    pub fn between(sites: &'t [JumpSite], from: &[f64], to: &[f64]) -> Self {
        let mut way = Self::Smooth;
        for site in sites {
            let Some([a, b]) = site.jump(from, to) else {
                continue;
            };
            let is_same = a.abs().min(b.abs()) >= SAME_JUMP * a.abs().max(b.abs());
            if is_same && (a < 0.0) == (b < 0.0) {
                return Self::Jumps(&site.name);
            }
            way = Self::Open;
        }
        way
    }
}
