//! Certificates of poses as they leave the program: with the rounding of the unknowns on the way to the reader.

use super::certificate::Certificate;
use super::trajectory::ClosedPose;
use crate::model::mechanism::{Kind, Mechanism};
use crate::model::printed::printing_unit;

/// The certificate of a pose whose unknowns are read in the scene's units, as f64 or as the shortest decimals of these.
pub fn printed_certificate(mechanism: &Mechanism, pose: &ClosedPose) -> Certificate {
    // The remaining rotation of three angles is at most the sum of their remainders.
    let angles = match pose.certificate {
        Certificate::Locked { .. } => 3.0,
        _ => 1.0,
    };
    let values = mechanism.unknowns.iter().zip(&pose.unknowns);
    let rounded = values.map(|(unknown, value)| {
        let rounded = printing_unit(*value, mechanism.unit_of(unknown.kind));
        match unknown.kind {
            Kind::Angle => rounded * mechanism.size * angles,
            Kind::Length | Kind::Number => rounded,
        }
    });
    pose.certificate.moved(rounded.fold(0.0, f64::max))
}
