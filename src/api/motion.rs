//! A solved motion: its samples, events and values.

use super::error::{Error, ErrorKind, find_column};
use super::film::Film;
use super::loaded::Loaded;
use super::pose::Pose;
use crate::charts::motion::{default_plot, motion_chart};
use crate::export::{Output, Stream};
use crate::kinematics::measures::{DriveSamples, measure_motion};
use crate::kinematics::motion::proved::{Proofs, solve_proved};
use crate::kinematics::motion::sampling::{
    MAX_SAMPLES, allow_samples, even_times, frame_times, samples_at,
};
use crate::kinematics::results::trajectory::{Sample, Trajectory};
use crate::plot::svg::write_svg;
use crate::plot::{ChartTheme, draw_chart, usual_size};
use crate::report::event_sentences::{event_sentence, gap_sentence};
use crate::report::table::{TableColumns, write_csv, write_json};
use crate::scene::{PlotText, load_scene};
use std::fmt;
use std::sync::Arc;

/// The times at which a motion is sampled.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Samples {
    /// The frames at the scene's frame rate.
    #[default]
    Frames,
    /// This number of samples, spread evenly over the motion; the end of a cyclic motion is not sampled again.
    Even(usize),
    /// These times in seconds, not descending: one sample each. The motion is followed from its start to each of them.
    At(Vec<f64>),
}

impl Samples {
    /// The times to be kept, and the times to be solved.
    ///
    /// Errors: no times, too many for the limits of a run, times out of order or outside the motion.
    pub(super) fn times(&self, loaded: &Loaded) -> Result<[Vec<f64>; 2], Error> {
        let (mechanism, actuation) = (&loaded.scene.mechanism, &loaded.scene.actuation);
        let frames = || frame_times(mechanism, actuation, loaded.scene.view.fps);
        let kept = match self {
            Self::Frames => frames(),
            Self::Even(count) => even_times(mechanism, actuation, (*count).min(MAX_SAMPLES + 1)),
            Self::At(times) => times.clone(),
        };
        let refused = |why: String| Err(Error::new(ErrorKind::Argument, why, Vec::new()));
        let (Some(first), Some(last)) = (kept.first(), kept.last()) else {
            return refused("no samples are requested".to_owned());
        };
        if kept.len() > MAX_SAMPLES {
            return refused(format!("at most {MAX_SAMPLES} samples"));
        }
        let duration = actuation.duration;
        let is_inside = *first >= 0.0 && *last <= duration && kept.is_sorted();
        if !is_inside || kept.iter().any(|t| !t.is_finite()) {
            return refused(format!(
                "times of samples ascend from 0 to {duration} s at most"
            ));
        }
        let mut solved = kept.clone();
        if matches!(self, Self::At(_)) {
            solved.extend(frames().into_iter().filter(|t| t < last));
            solved.sort_by(f64::total_cmp);
            solved.dedup();
        }
        allow_samples(mechanism, solved.len())?;
        Ok([kept, solved])
    }
}

/// The motion of a scene along its drive. It is an independent value and remains valid without the scene.
pub struct Motion {
    pub(super) loaded: Arc<Loaded>,
    pub(super) trajectory: Trajectory,
    /// The end of the motion, where measures depend on it and it is no sample.
    end: Option<Sample>,
}

impl fmt::Debug for Motion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let title = &self.loaded.scene.mechanism.title;
        write!(f, "Motion({title}, {} samples)", self.len())
    }
}

impl Motion {
    pub(super) fn solve(
        loaded: Arc<Loaded>,
        samples: &Samples,
        cancelled: &dyn Fn() -> bool,
    ) -> Result<Self, Error> {
        let [kept, mut solved] = samples.times(&loaded)?;
        let actuation = &loaded.scene.actuation;
        let is_whole = !matches!(samples, Samples::At(_));
        let needs_end = is_whole && loaded.scene.measures.look_at_end();
        if needs_end && solved.last().is_some_and(|last| *last < actuation.duration) {
            solved.push(actuation.duration);
        }
        let all = solve_proved(&loaded.system, actuation, &solved, Proofs::Poses, cancelled);
        let end = all.samples.last().filter(|_| needs_end).cloned();
        let trajectory = match kept == solved {
            true => all,
            false => Trajectory {
                samples: samples_at(actuation, &all, &kept),
                ..all
            },
        };
        Ok(Self {
            loaded,
            trajectory,
            end,
        })
    }

    /// Number of samples.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let motion = Scene::builtin("four-bar")?.solve(Samples::Even(12))?;
    /// assert_eq!(motion.len(), 12);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn len(&self) -> usize {
        self.trajectory.samples.len()
    }

    /// Whether there are no samples: only if the solution was cancelled before the first.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// assert!(!Scene::builtin("four-bar")?.solve(Samples::Frames)?.is_empty());
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn is_empty(&self) -> bool {
        self.trajectory.samples.is_empty()
    }

    /// Whether a pose exists at every sample and, as far as is known, between them.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// assert!(Scene::builtin("seven-r")?.solve(Samples::Even(30))?.is_whole());
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn is_whole(&self) -> bool {
        self.trajectory.is_whole()
    }

    /// All poses in the order of time; samples without a pose are skipped.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let motion = Scene::builtin("bennett")?.solve(Samples::Even(8))?;
    /// assert!(motion.poses().all(|pose| pose.closure_error() < 1e-12));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn poses(&self) -> impl Iterator<Item = Pose<'_>> {
        (0..self.len()).filter_map(|index| self.pose(index))
    }

    /// The pose of sample `index`; `None` if the mechanism cannot be closed there, or beyond the last sample.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let motion = Scene::builtin("four-bar")?.solve(Samples::At(vec![0.25]))?;
    /// assert_eq!(motion.pose(0).map(|pose| pose.time()), Some(0.25));
    /// assert!(motion.pose(1).is_none());
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn pose(&self, index: usize) -> Option<Pose<'_>> {
        let sample = self.trajectory.samples.get(index)?;
        let pose = sample.pose.as_ref()?;
        Some(Pose::new(&self.loaded, sample, pose))
    }

    /// The times of the samples in seconds.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let motion = Scene::builtin("four-bar")?.solve(Samples::At(vec![0.0, 0.5]))?;
    /// assert_eq!(motion.times(), [0.0, 0.5]);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn times(&self) -> Vec<f64> {
        self.trajectory.samples.iter().map(|s| s.time).collect()
    }

    /// A named value at every sample, in the scene's units; NaN where there is no pose.
    ///
    /// Errors: no quantity of the scene has that name.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let motion = Scene::builtin("slider-crank")?.solve(Samples::Even(90))?;
    /// let h = motion.values("h")?;
    /// let [low, high] = [h.iter().copied().fold(f64::MAX, f64::min), h.iter().copied().fold(0.0, f64::max)];
    /// assert!((high - low - 80.0).abs() < 1e-9);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn values(&self, name: &str) -> Result<Vec<f64>, Error> {
        let mechanism = &self.loaded.scene.mechanism;
        let column = find_column(mechanism, name)?;
        let samples = self.trajectory.samples.iter();
        let values = samples.map(|sample| match &sample.pose {
            Some(pose) => column.value(mechanism, sample, pose),
            None => f64::NAN,
        });
        Ok(values.collect())
    }

    /// The scene's measures for this motion, by name, in the scene's units; `None` if a measure has no value.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let motion = Scene::builtin("feeder")?.solve(Samples::Frames)?;
    /// assert!(motion.measures().iter().all(|(_, value)| value.is_some()));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn measures(&self) -> Vec<(String, Option<f64>)> {
        let scene = &self.loaded.scene;
        let along = DriveSamples {
            samples: &self.trajectory.samples,
            end: self.end.as_ref(),
        };
        let (system, measures) = (&self.loaded.system, &scene.measures);
        let values = measure_motion(system, &scene.actuation, measures, along);
        let named = scene.measures.list.iter().zip(values);
        let units =
            |measure: &crate::model::measure::Measure| scene.mechanism.file_units(measure.kind);
        named
            .map(|(measure, value)| (measure.name.clone(), value.map(|v| v * units(measure))))
            .collect()
    }

    /// Events between the samples, one sentence each: gaps of the motion, singular poses, changes of branch.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let scene = Scene::builtin("slider-crank")?.with_parameter("L", 30)?;
    /// let motion = scene.solve(Samples::Even(40))?;
    /// assert!(!motion.is_whole() && motion.events()[0].contains("no pose"));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn events(&self) -> Vec<String> {
        let mechanism = &self.loaded.scene.mechanism;
        let gaps = self.trajectory.gaps.iter();
        let gaps = gaps.map(|gap| gap_sentence(mechanism, gap));
        let events = self.trajectory.events.iter();
        let events = events.filter(|event| !event.kind.is_told_by_gap());
        gaps.chain(events.map(|event| event_sentence(mechanism, event)))
            .collect()
    }

    /// Largest closure error of any loop over all poses, relative to the mechanism's size, computed by an independent
    /// product.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// assert!(Scene::builtin("bricard")?.solve(Samples::Even(10))?.closure_error() < 1e-12);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn closure_error(&self) -> f64 {
        self.trajectory.closure_error()
    }

    /// The table that `mechanim solve` writes, as CSV.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let table = Scene::builtin("four-bar")?.solve(Samples::Even(3))?.to_csv();
    /// assert!(table.starts_with("time,") && table.lines().count() == 4);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn to_csv(&self) -> String {
        let mechanism = &self.loaded.scene.mechanism;
        self.written(|output| write_csv(mechanism, &self.trajectory, self.columns(), output))
    }

    /// The same table as JSON, with events, gaps and units.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let table = Scene::builtin("four-bar")?.solve(Samples::Even(3))?.to_json();
    /// assert!(table.contains("mechanim-trajectory/1"));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn to_json(&self) -> String {
        let mechanism = &self.loaded.scene.mechanism;
        self.written(|output| write_json(mechanism, &self.trajectory, self.columns(), output))
    }

    fn columns(&self) -> TableColumns {
        TableColumns {
            redundant: self.loaded.system.redundant_rows() > 0,
            ..TableColumns::default()
        }
    }

    fn written<E>(&self, write: impl FnOnce(&mut dyn Output) -> Result<(), E>) -> String {
        let mut text = Vec::new();
        // Writing to memory cannot fail.
        let _ = write(&mut Stream::new("memory", &mut text));
        String::from_utf8(text).unwrap_or_default()
    }

    /// A plot of this motion as SVG. Curves are formulas as in the scene's `[[plots]]`, with derivatives as `d(h,
    /// phi)`, plotted against another formula or time. Without curves, the scene's plots are drawn, or its outputs if
    /// it has none.
    ///
    /// Errors: invalid formulas, all of them listed.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let motion = Scene::builtin("slider-crank")?.solve(Samples::Even(90))?;
    /// assert!(motion.plot(&["h", "d(h, phi)"], Some("phi"))?.starts_with("<svg"));
    /// assert!(motion.plot(&["no such name"], None).is_err());
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn plot(&self, curves: &[&str], against: Option<&str>) -> Result<String, Error> {
        let Loaded {
            scene,
            system,
            text,
            overrides,
        } = &*self.loaded;
        let mut plots = scene.plots.to_vec();
        if !curves.is_empty() {
            let mut overrides = overrides.clone();
            overrides.plot = Some(PlotText {
                x: against.map(str::to_owned),
                y: curves.iter().map(|curve| (*curve).to_owned()).collect(),
                equal: false,
            });
            plots = load_scene(text, &overrides)?.plots.to_vec();
        }
        if plots.is_empty() {
            plots = vec![default_plot(&scene.mechanism, &scene.actuation)];
        }
        let chart = motion_chart(system, &scene.actuation, &plots, &self.trajectory);
        let drawing = draw_chart(&chart, usual_size(&chart), ChartTheme::LIGHT);
        Ok(write_svg(&drawing))
    }

    /// Pictures of this motion.
    ///
    /// ```no_run
    /// # use mechanim::{Samples, Scene};
    /// let motion = Scene::builtin("gearshift")?.solve(Samples::Frames)?;
    /// motion.film().size(640, 480).write("anim.gif")?;
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn film(&self) -> Film<'_> {
        Film::new(&self.loaded, &self.trajectory)
    }
}
