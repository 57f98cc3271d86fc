//! A scene that is read and analysed, and can be solved any number of times.

use super::assembly::Assembly;
use super::check::{Check, CheckOptions};
use super::error::{Error, line};
use super::loaded::Loaded;
use super::motion::{Motion, Samples};
use super::rows;
use super::study::Study;
use crate::diag::Source;
use crate::kinematics::results::columns::columns;
use crate::model::mechanism::Kind;
use crate::scene::{Overrides, builtin, source};
use std::fmt;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A mechanism with its drive, bodies and view, read from a scene.
///
/// Changing parameters, drives or start values returns a new scene and leaves the original unchanged.
/// Lengths are in the scene's own unit, angles in its angle unit (degrees or radians), times in seconds.
///
/// ```
/// use mechanim::{Samples, Scene};
///
/// let scene = Scene::builtin("slider-crank")?.with_parameter("L", 120)?;
/// let motion = scene.solve(Samples::Even(5))?;
/// for pose in motion.poses() {
///     println!("{:.3} s: h = {:.12}, {:?}", pose.time(), pose.value("h")?, pose.certificate());
/// }
/// # Ok::<(), mechanim::Error>(())
/// ```
#[derive(Clone)]
pub struct Scene {
    loaded: Arc<Loaded>,
}

impl fmt::Debug for Scene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Scene({})", self.loaded.text.name)
    }
}

/// A named value of a pose: an input, an unknown, a coordinate of a traced point, or an output.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Quantity {
    /// The name in the scene.
    pub name: String,
    /// The unit of the values; empty for plain numbers.
    pub unit: String,
}

impl Scene {
    /// A scene that is built into the crate.
    ///
    /// Errors: no scene has that name; the hints list the built-in scenes.
    ///
    /// ```
    /// assert_eq!(mechanim::Scene::builtin("four-bar")?.bodies().len(), 4);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn builtin(name: &str) -> Result<Self, Error> {
        match builtin::find_builtin(name) {
            Some(text) => Self::load(Arc::new(text), Overrides::default()),
            None => Err(source::no_builtin(name).into()),
        }
    }

    /// Names of the built-in scenes.
    ///
    /// ```
    /// assert!(mechanim::Scene::builtin_names().contains(&"gearshift"));
    /// ```
    pub fn builtin_names() -> Vec<&'static str> {
        builtin::ALL.map(|scene| scene.name).to_vec()
    }

    /// Reads the scene file at `path`; mesh files are relative to it.
    ///
    /// Errors: a file that cannot be read or has errors; the message lists them, each with line and column. A mechanism that
    /// is not determined.
    ///
    /// ```
    /// let scene = mechanim::Scene::open("scenes/peaucellier.toml")?;
    /// assert_eq!(scene.inputs().len(), 1);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn open(path: impl AsRef<Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        let overrides = Overrides {
            folder: source::folder_of(path),
            ..Overrides::default()
        };
        Self::load(Arc::new(source::open_source(path)?), overrides)
    }

    /// Reads a scene from `text`; messages call it `name`.
    ///
    /// Errors: errors in the text; the message lists them, each with line and column. A mechanism that is not determined.
    ///
    /// ```
    /// let text = r#"
    /// duration = 1
    /// [chains]
    /// A = "Rz(phi) Tx(40) Rz(alpha) Tx(120) Rz(beta) Tx(-s)"
    /// [loops]
    /// crank = "A"
    /// [inputs]
    /// phi = "2*pi*t"
    /// [guess]
    /// s = 150
    /// "#;
    /// let scene = mechanim::Scene::parse("crank", text)?;
    /// assert_eq!(scene.unknowns().len(), 3);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn parse(name: &str, text: &str) -> Result<Self, Error> {
        let text = Source {
            name: name.to_owned(),
            text: text.to_owned(),
        };
        Self::load(Arc::new(text), Overrides::default())
    }

    /// The same, with mesh files relative to `folder`.
    ///
    /// Errors: as for [`parse`](Self::parse).
    ///
    /// ```
    /// let text = std::fs::read_to_string("scenes/four-bar.toml").unwrap_or_default();
    /// let scene = mechanim::Scene::parse_in("scenes", "four-bar", &text)?;
    /// assert_eq!(scene.text(), text);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn parse_in(folder: impl Into<PathBuf>, name: &str, text: &str) -> Result<Self, Error> {
        let text = Source {
            name: name.to_owned(),
            text: text.to_owned(),
        };
        let overrides = Overrides {
            folder: folder.into(),
            ..Overrides::default()
        };
        Self::load(Arc::new(text), overrides)
    }

    /// The scene with a changed parameter: a number in the scene's units, or a formula.
    ///
    /// Errors: no parameter has that name; an invalid formula; the mechanism does not allow the value.
    ///
    /// ```
    /// let scene = mechanim::Scene::builtin("slider-crank")?;
    /// assert!(scene.with_parameter("r", "120/3").is_ok());
    /// assert!(scene.with_parameter("q", 1).is_err());
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn with_parameter(&self, name: &str, value: impl Display) -> Result<Self, Error> {
        self.changed(|overrides| set(&mut overrides.parameters, name, &value))
    }

    /// The scene with another drive for an input: a formula of the time `t` in seconds.
    ///
    /// Errors: no input has that name; the formula is invalid.
    ///
    /// ```
    /// let scene = mechanim::Scene::builtin("slider-crank")?.with_input("phi", "pi/4")?;
    /// let motion = scene.solve(mechanim::Samples::At(vec![0.0]))?;
    /// assert!((motion.values("phi")?[0] - 45f64.to_radians()).abs() < 1e-15);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn with_input(&self, name: &str, formula: impl Display) -> Result<Self, Error> {
        self.changed(|overrides| set(&mut overrides.inputs, name, &formula))
    }

    /// The scene driven by a table: row `k` applies at `times[k]` seconds, with linear interpolation in between. Every
    /// input of the scene needs a column, in the scene's units.
    ///
    /// Errors: an input without a column, or a column without an input; columns whose length differs from that of the
    /// times; times that are negative or not ascending.
    ///
    /// ```
    /// let scene = mechanim::Scene::builtin("slider-crank")?;
    /// let driven = scene.with_rows(&[0.0, 1.0, 2.0], &[("phi", &[0.0, 0.4, 0.6])])?;
    /// let motion = driven.solve(mechanim::Samples::At(vec![0.5, 2.0]))?;
    /// assert_eq!(motion.values("phi")?, [0.2, 0.6]);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn with_rows(&self, times: &[f64], columns: &[(&str, &[f64])]) -> Result<Self, Error> {
        let drives = rows::drives(&self.loaded.scene.mechanism, times, columns)?;
        let loaded = Arc::new(self.loaded.driven(drives));
        Ok(Self { loaded })
    }

    /// The scene with a start value for an unknown, a number in the scene's units or a formula; the assembly closest to the
    /// named start values is used.
    ///
    /// Errors: no unknown has that name; an invalid formula.
    ///
    /// ```
    /// let scene = mechanim::Scene::builtin("four-bar")?;
    /// let unknown = &scene.unknowns()[0].name;
    /// assert!(scene.with_guess(unknown, 0.5).is_ok());
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn with_guess(&self, name: &str, value: impl Display) -> Result<Self, Error> {
        self.changed(|overrides| set(&mut overrides.guess, name, &value))
    }

    fn load(text: Arc<Source>, overrides: Overrides) -> Result<Self, Error> {
        let loaded = Arc::new(Loaded::new(text, overrides)?);
        Ok(Self { loaded })
    }

    /// The same text with replaced values.
    fn changed(&self, change: impl FnOnce(&mut Overrides)) -> Result<Self, Error> {
        let mut overrides = self.loaded.overrides.clone();
        change(&mut overrides);
        Self::load(Arc::clone(&self.loaded.text), overrides)
    }

    /// The title of the scene.
    ///
    /// ```
    /// assert!(!mechanim::Scene::builtin("bennett")?.title().is_empty());
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn title(&self) -> &str {
        &self.loaded.scene.mechanism.title
    }

    /// The name used in messages: that of a built-in scene, a path, or the name given with the text.
    ///
    /// ```
    /// assert_eq!(mechanim::Scene::builtin("bennett")?.name(), "bennett");
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn name(&self) -> &str {
        &self.loaded.text.name
    }

    /// The text from which the scene was read, without replaced values.
    ///
    /// ```
    /// assert!(mechanim::Scene::builtin("bennett")?.text().contains("[loops]"));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn text(&self) -> &str {
        &self.loaded.text.text
    }

    /// Warnings about the text, one line each, with positions.
    ///
    /// ```
    /// assert!(mechanim::Scene::builtin("gearshift")?.warnings().is_empty());
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn warnings(&self) -> Vec<String> {
        let sorted = self.loaded.scene.warnings.sorted();
        sorted.iter().map(|d| line(&self.loaded.text, d)).collect()
    }

    /// The duration of the motion in seconds.
    ///
    /// ```
    /// assert!(mechanim::Scene::builtin("gearshift")?.duration() > 0.0);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn duration(&self) -> f64 {
        self.loaded.scene.actuation.duration
    }

    /// The inputs: the driven coordinates.
    ///
    /// ```
    /// assert_eq!(mechanim::Scene::builtin("slider-crank")?.inputs()[0].unit, "rad");
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn inputs(&self) -> Vec<Quantity> {
        let mechanism = &self.loaded.scene.mechanism;
        let inputs = mechanism.inputs.iter();
        inputs.map(|c| self.quantity(&c.name, c.kind)).collect()
    }

    /// The unknowns: the coordinates determined by the loops.
    ///
    /// ```
    /// assert_eq!(mechanim::Scene::builtin("seven-r")?.unknowns().len(), 6);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn unknowns(&self) -> Vec<Quantity> {
        let mechanism = &self.loaded.scene.mechanism;
        let unknowns = mechanism.unknowns.iter();
        unknowns.map(|c| self.quantity(&c.name, c.kind)).collect()
    }

    /// All named values of a pose: inputs, unknowns, traced points as `name.x`, outputs.
    ///
    /// ```
    /// let scene = mechanim::Scene::builtin("peaucellier")?;
    /// assert!(scene.quantities().len() > scene.inputs().len() + scene.unknowns().len());
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn quantities(&self) -> Vec<Quantity> {
        let all = columns(&self.loaded.scene.mechanism).into_iter();
        all.map(|(name, _, kind)| self.quantity(&name, kind))
            .collect()
    }

    fn quantity(&self, name: &str, kind: Kind) -> Quantity {
        Quantity {
            name: name.to_owned(),
            unit: self.loaded.scene.mechanism.unit_name(kind).to_owned(),
        }
    }

    /// The names of the bodies.
    ///
    /// ```
    /// assert!(mechanim::Scene::builtin("bennett")?.bodies().len() >= 3);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn bodies(&self) -> Vec<&str> {
        let bodies = self.loaded.scene.mechanism.bodies.iter();
        bodies.map(|body| body.name.as_str()).collect()
    }

    /// Solves the motion along the drive. It may contain samples without a pose: see [`Motion::is_whole`].
    ///
    /// Errors: no times, times outside the motion or out of order; more samples than the limits allow.
    ///
    /// ```
    /// let motion = mechanim::Scene::builtin("gearshift")?.solve(mechanim::Samples::Even(20))?;
    /// assert!(motion.is_whole() && motion.closure_error() < 1e-12);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn solve(&self, samples: Samples) -> Result<Motion, Error> {
        self.solve_until(samples, &|| false)
    }

    /// The same, but ends as soon as `cancelled` returns true. It is called between the steps; the motion then has
    /// fewer samples.
    ///
    /// Errors: no times, times outside the motion or out of order; more samples than the limits allow.
    ///
    /// ```
    /// let scene = mechanim::Scene::builtin("gearshift")?;
    /// let motion = scene.solve_until(mechanim::Samples::Even(20), &|| true)?;
    /// assert!(motion.len() < 20);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn solve_until(
        &self,
        samples: Samples,
        cancelled: &dyn Fn() -> bool,
    ) -> Result<Motion, Error> {
        Motion::solve(Arc::clone(&self.loaded), &samples, cancelled)
    }

    /// Checks all requirements of the scene: loop closure, proofs, limits of measures, clearances.
    ///
    /// Errors: samples that do not fit the motion. A failed check is not an error: see [`Check::passed`].
    ///
    /// ```
    /// let check = mechanim::Scene::builtin("slider-crank")?.check(&Default::default())?;
    /// assert!(check.passed(), "{}", check.text());
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn check(&self, options: &CheckOptions) -> Result<Check, Error> {
        Check::run(Arc::clone(&self.loaded), options)
    }

    /// A study of the scene's measures as functions of its parameters.
    ///
    /// ```
    /// let study = mechanim::Scene::builtin("slider-crank")?.study();
    /// assert!(study.sensitivity().is_err(), "the scene measures nothing");
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn study(&self) -> Study {
        Study::new(Arc::clone(&self.loaded))
    }

    /// The assembly modes for the inputs at `time` (s), as far as a search from many starts finds them.
    ///
    /// Errors: an input that has no value at this time.
    ///
    /// ```
    /// let found = mechanim::Scene::builtin("four-bar")?.assemblies(0.1)?;
    /// assert_eq!(found.len(), 2);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn assemblies(&self, time: f64) -> Result<Vec<Assembly>, Error> {
        Assembly::search(&self.loaded, time)
    }
}

/// Replaces or adds a value by name.
fn set(list: &mut Vec<(String, String)>, name: &str, value: &impl Display) {
    list.retain(|(other, _)| other != name);
    list.push((name.to_owned(), value.to_string()));
}
