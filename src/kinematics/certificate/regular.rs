//! Proofs that poses are regular, and that two of them nearby are not one.

use super::Certifier;
use crate::kinematics::results::certificate::Certificate;
use crate::kinematics::solve::branch::best_rows;
use crate::kinematics::solve::newton::Corrector;
use crate::kinematics::solve::turns::WholeTurns;
use crate::kinematics::structure::system::System;
use crate::model::mechanism::Kind;

/// Poses of one solution differ by no more than this, as fractions of the unknowns' scales: they need no proof, ...
const ONE: f64 = 1e-11;

/// ... and none whose unknowns differ by more than this are compared: they may be other values of the same angles.
const NEARBY: f64 = 1e-3;

/// Proves poses of one system.
pub struct RegularPoses<'s> {
    system: &'s System,
    certifier: Certifier<'s>,
    corrector: Corrector,
}

impl<'s> RegularPoses<'s> {
    /// Prepares the proofs.
    pub fn new(system: &'s System) -> Self {
        Self {
            system,
            certifier: Certifier::new(system),
            corrector: Corrector::new(system),
        }
    }

    /// How far the exact pose is at most, if its Jacobian is proved to be regular: lengths, and angles times the size.
    pub fn error_bound(&mut self, coordinates: &[f64]) -> Option<f64> {
        let rows = best_rows(self.system, &mut self.corrector, coordinates);
        match self.certifier.certify(coordinates, &[], &rows) {
            Certificate::Certified { error_bound, .. } => Some(error_bound),
            Certificate::Consistent { .. }
            | Certificate::Locked { .. }
            | Certificate::Refused { .. } => None,
        }
    }

    /// Whether two poses that seem to be equal are proved not to be. Those whose idle freedoms are held at different values are not
    /// compared.
    pub fn are_apart(&mut self, a: &[f64], b: &[f64]) -> bool {
        let mechanism = self.system.mechanism();
        let mut held = self.system.structure().held.iter().map(|h| h.unknown);
        if held.any(|slot| (a[slot] - b[slot]).abs() > ONE * mechanism.scale_of(slot)) {
            return false;
        }
        let turns = WholeTurns::between(mechanism, a, b);
        // The greatest difference, as a fraction of its scale and as bounds count it.
        let (mut share, mut apart) = (0.0_f64, 0.0_f64);
        for (slot, unknown) in mechanism.unknowns.iter().enumerate() {
            let off = (b[slot] - turns[slot] - a[slot]).abs();
            share = share.max(off / mechanism.scale_of(slot));
            apart = apart.max(match unknown.kind {
                Kind::Angle => off * mechanism.size,
                Kind::Length | Kind::Number => off,
            });
        }
        if share <= ONE || share > NEARBY {
            return false;
        }
        let bounds = [a, b].map(|pose| self.error_bound(pose));
        matches!(bounds, [Some(a), Some(b)] if apart > a + b)
    }
}
