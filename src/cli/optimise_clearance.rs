//! Whether a found mechanism keeps the clearances that its scene asks for; if not, the last candidate that does.

use super::optimise_film::Improvement;
use super::outcome::Failure;
use super::study::{Opened, six};
use crate::analysis::optimise::Minimum;
use crate::clearance::check::check;
use crate::kinematics::sampling::frame_times;
use crate::scene::{Overrides, load};

/// Nearness of the bound where the instants between the samples count only roughly.
const COARSE: f64 = 1.0;

/// What the bodies do over the drive.
#[derive(Clone, Debug, PartialEq)]
pub struct Clearances {
    /// All pairs keep their minimum.
    pub kept: bool,
    /// The worst pair with its distance.
    pub worst: String,
    /// The candidate that was taken in place of the optimum, which comes too near: its iteration.
    pub instead: Option<usize>,
}

/// Judges the values; `None` if the scene asks for no clearances.
fn judge(opened: &Opened, values: &[f64]) -> Result<Option<Clearances>, Failure> {
    let overrides = Overrides {
        parameters: opened.parameters(values),
        ..opened.overrides.clone()
    };
    let scene = load(&opened.source, &overrides).map_err(Box::new)?;
    let Some(rules) = &scene.clearance else {
        return Ok(None);
    };
    let mechanism = &scene.mechanism;
    let times = frame_times(mechanism, scene.view.fps);
    let report = check(mechanism, rules, &times, COARSE, &|_, _| {})?;
    let worst = report.worst().map_or_else(String::new, |pair| {
        let [a, b] = pair.pair.map(|k| mechanism.bodies[k].name.as_str());
        let (distance, unit) = (six(pair.least.distance), &mechanism.length_unit);
        format!("{a} / {b}, {distance} {unit} ({} asked for)", pair.minimum)
    });
    Ok(Some(Clearances {
        kept: report.passed(),
        worst,
        instead: None,
    }))
}

/// Judges a minimum. Where it comes too near, the last of the improvements on the way that does not takes its place; if
/// none is found it stays and is not kept.
pub fn settle(
    opened: &Opened,
    minimum: &mut Minimum,
    improvements: &[Improvement],
) -> Result<Option<Clearances>, Failure> {
    let Some(found) = judge(opened, &minimum.x)? else {
        return Ok(None);
    };
    if found.kept {
        return Ok(Some(found));
    }
    // Halving: as a rule clearances are lost once on the way.
    let (mut low, mut high) = (0, improvements.len());
    let mut best = None;
    while low < high {
        let middle = (low + high) / 2;
        match judge(opened, &improvements[middle].values)? {
            Some(clearances) if clearances.kept => {
                best = Some((middle, clearances));
                low = middle + 1;
            }
            _ => high = middle,
        }
    }
    let Some((index, clearances)) = best else {
        return Ok(Some(found));
    };
    let taken = &improvements[index];
    (minimum.x, minimum.value) = (taken.values.clone(), taken.objective);
    Ok(Some(Clearances {
        instead: Some(taken.iteration),
        ..clearances
    }))
}

impl Clearances {
    /// As a line of a report.
    pub fn line(&self) -> String {
        let verdict = match (self.kept, self.instead) {
            (true, None) => "Clearances are kept".to_owned(),
            (true, Some(iteration)) => format!(
                "Later candidates come too near: iteration {iteration} is the last found that keeps the clearances"
            ),
            (false, _) => "Clearances are not kept".to_owned(),
        };
        format!("{verdict}; nearest: {}.\n", self.worst)
    }
}
