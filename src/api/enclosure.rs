//! Proved bands that contain the motion of every piece within its tolerances.

use super::error::Error;
use super::loaded::Loaded;
use super::motion::Samples;
use crate::analysis::enclosure::{
    Enclosed, PieceTolerances, TolerancePlan, enclose_motion, shown_names,
};
use crate::jobs::core_count;
use crate::model::asked_ranges::TOLERANCE;
use crate::model::mechanism::{Kind, Mechanism};
use crate::report::enclosure::{enclosure_document, rounded_end};
use std::sync::atomic::AtomicBool;

/// Proved bands that contain the motion of every piece within its tolerances. Returned by
/// [`Study::enclose`](crate::Study::enclose).
///
/// ```
/// use mechanim::{Samples, Scene};
///
/// let study = Scene::builtin("slider-crank")?.study().vary(&["r", "L"]);
/// let enclosure = study.enclose(Some(0.1), Samples::Even(12))?;
/// let longer = Scene::builtin("slider-crank")?.with_parameter("L", 80.05)?.solve(Samples::Even(12))?;
/// for ([low, high], h) in enclosure.bands("h")?.iter().zip(longer.values("h")?) {
///     assert!(*low <= h && h <= *high);
/// }
/// # Ok::<(), mechanim::Error>(())
/// ```
pub struct Enclosure {
    names: Vec<String>,
    /// By name, then by sample: both ends of the band.
    bands: Vec<Vec<[f64; 2]>>,
    json: String,
}

impl Enclosure {
    pub(super) fn of(
        loaded: &Loaded,
        vary: &[String],
        (tolerance, samples): (Option<f64>, &Samples),
        cancel: &AtomicBool,
    ) -> Result<Self, Error> {
        if let Some(tolerance) = tolerance {
            Error::unless_in(&TOLERANCE, "tolerance", tolerance)?;
        }
        let asked = PieceTolerances {
            vary,
            own: &[],
            tolerance,
            otherwise: None,
            between: false,
        };
        let (family, tolerances) = asked.family(&loaded.text, &loaded.overrides, &loaded.scene)?;
        let plan = TolerancePlan::new(&family, &tolerances).until(cancel);
        let [times, _] = samples.times(loaded)?;
        let motion = enclose_motion(&plan, &times, core_count(), true);
        let mechanism = plan.family.mechanism();
        let shown = shown_names(mechanism);
        let bands = shown.iter().enumerate();
        let bands = bands.map(|(k, (_, kind))| bands_of(mechanism, &motion, k, *kind));
        let document = enclosure_document(&plan, &motion, None, true);
        Ok(Self {
            bands: bands.collect(),
            names: shown.into_iter().map(|(name, _)| name).collect(),
            json: format!("{document:#}\n"),
        })
    }

    /// The band `[low, high]` of an unknown, a coordinate `name.x` of a traced point, or an output at every sample, in
    /// the scene's units; NaN where nothing is proved.
    ///
    /// Errors: no quantity with a band has that name.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let study = Scene::builtin("slider-crank")?.study();
    /// let enclosure = study.enclose(Some(0.1), Samples::Even(3))?;
    /// let [low, high] = enclosure.bands("h")?[1];
    /// assert!(low < high && high - low < 1.0 && enclosure.bands("no such name").is_err());
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn bands(&self, name: &str) -> Result<Vec<[f64; 2]>, Error> {
        match self.names.iter().position(|n| n == name) {
            Some(k) => Ok(self.bands[k].clone()),
            None => {
                let names = self.names.iter().map(String::as_str);
                Err(Error::unknown_name("band", name, names))
            }
        }
    }

    /// All samples as a JSON document: values, bands, status, and the smallest and largest value of the solved pieces.
    /// For samples without bands it gives the reason and the dimension that brings the mechanism closest to the failure
    /// of the proof.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let study = Scene::builtin("slider-crank")?.study();
    /// let enclosure = study.enclose(Some(0.1), Samples::Even(3))?;
    /// assert!(enclosure.to_json().contains("mechanim-enclosure/1"));
    /// let wide = study.vary(&["r"]).enclose(Some(60.0), Samples::Even(8))?;
    /// assert!(wide.to_json().contains("within the tolerances, `r`"));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn to_json(&self) -> &str {
        &self.json
    }
}

/// The bands of one quantity in its unit at every sample, rounded outwards; NaN where there is none.
fn bands_of(mechanism: &Mechanism, motion: &[Enclosed], index: usize, kind: Kind) -> Vec<[f64; 2]> {
    let end = |value: f64, side: f64| rounded_end(value, kind, mechanism, side);
    let bands = motion
        .iter()
        .map(|e| e.bands.as_ref().ok()?.list.get(index));
    bands
        .map(|band| band.map_or([f64::NAN; 2], |b| [end(b.lo, -1.0), end(b.hi, 1.0)]))
        .collect()
}
