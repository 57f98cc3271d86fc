//! A scene: read, resolved, analysed, ready to be solved as often as wanted.

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

/// A mechanism with its drive, bodies and view, read from the text of a scene.
///
/// Values of parameters, drives and start values can be changed; that gives a new scene and leaves the old one as it is.
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
    /// Its name in the scene.
    pub name: String,
    /// The unit that its values are given in; empty for plain numbers.
    pub unit: String,
}

impl Scene {
    /// A scene that comes with the crate.
    ///
    /// Errors: there is none of that name; the hints list them.
    ///
    /// ```
    /// assert_eq!(mechanim::Scene::builtin("four-bar")?.bodies().len(), 4);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn builtin(name: &str) -> Result<Self, Error> {
        match builtin::find_builtin(name) {
            Some(text) => Self::load(text, Overrides::default()),
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

    /// The scene in the file at `path`; meshes are looked for beside it.
    ///
    /// Errors: a file that cannot be read, or has mistakes: the error lists them, each with line and column.
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
        Self::load(source::open_source(path)?, overrides)
    }

    /// The scene that `text` describes, called `name` in messages.
    ///
    /// Errors: mistakes, likewise.
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
        Self::load(text, Overrides::default())
    }

    /// The same, with the meshes that it names looked for in `folder`.
    ///
    /// Errors: mistakes, likewise.
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
        Self::load(text, overrides)
    }

    /// The scene with a parameter changed: to a number in the scene's units, or a formula.
    ///
    /// Errors: no such parameter; values that the mechanism does not allow.
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

    /// The scene with an input driven otherwise: a formula of the time `t` in seconds.
    ///
    /// Errors: no such input; a formula that cannot be read.
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

    /// The scene driven through rows of values: row `k` is met at `times[k]` seconds, and the way between is straight.
    /// Every input of the scene has a column, in the scene's units.
    ///
    /// Errors: an input without a column, a column for none; columns of other lengths than the times, which ascend from
    /// zero or later.
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

    /// The scene with a start value for an unknown: the assembly nearest to the named start values is taken.
    ///
    /// Errors: no such unknown.
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

    fn load(text: Source, overrides: Overrides) -> Result<Self, Error> {
        let loaded = Arc::new(Loaded::new(text, overrides)?);
        Ok(Self { loaded })
    }

    /// The same text with other values put in place of its own.
    fn changed(&self, change: impl FnOnce(&mut Overrides)) -> Result<Self, Error> {
        let mut overrides = self.loaded.overrides.clone();
        change(&mut overrides);
        Self::load(self.loaded.text.clone(), overrides)
    }

    /// Its title.
    ///
    /// ```
    /// assert!(!mechanim::Scene::builtin("bennett")?.title().is_empty());
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn title(&self) -> &str {
        &self.loaded.scene.mechanism.title
    }

    /// What messages call it: the name of a built-in scene, a path, or what was given with the text.
    ///
    /// ```
    /// assert_eq!(mechanim::Scene::builtin("bennett")?.name(), "bennett");
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn name(&self) -> &str {
        &self.loaded.text.name
    }

    /// The text that it was read from, without the values put in place of its own.
    ///
    /// ```
    /// assert!(mechanim::Scene::builtin("bennett")?.text().contains("[loops]"));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn text(&self) -> &str {
        &self.loaded.text.text
    }

    /// What is odd in the text, but usable: one line each with its place.
    ///
    /// ```
    /// assert!(mechanim::Scene::builtin("gearshift")?.warnings().is_empty());
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn warnings(&self) -> Vec<String> {
        let sorted = self.loaded.scene.warnings.sorted();
        sorted.iter().map(|d| line(&self.loaded.text, d)).collect()
    }

    /// How long the motion lasts, in seconds.
    ///
    /// ```
    /// assert!(mechanim::Scene::builtin("gearshift")?.duration() > 0.0);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn duration(&self) -> f64 {
        self.loaded.scene.actuation.duration
    }

    /// What is driven.
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

    /// What the loops determine.
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

    /// Every value that a pose has by name: inputs, unknowns, traced points as `name.x`, outputs.
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

    /// Names of the bodies.
    ///
    /// ```
    /// assert!(mechanim::Scene::builtin("bennett")?.bodies().len() >= 3);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn bodies(&self) -> Vec<&str> {
        let bodies = self.loaded.scene.mechanism.bodies.iter();
        bodies.map(|body| body.name.as_str()).collect()
    }

    /// The motion along the drive. Samples without a pose are part of it: see [`Motion::is_whole`].
    ///
    /// Errors: times outside the motion, or out of order.
    ///
    /// ```
    /// let motion = mechanim::Scene::builtin("gearshift")?.solve(mechanim::Samples::Even(20))?;
    /// assert!(motion.is_whole() && motion.closure_error() < 1e-12);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn solve(&self, samples: Samples) -> Result<Motion, Error> {
        self.solve_until(samples, &|| false)
    }

    /// The same, given up as soon as `cancelled` says so, which is asked between the steps; the motion ends there, with fewer
    /// samples.
    ///
    /// Errors: times outside the motion, or out of order.
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

    /// Checks all that the scene asks for: that the loops close, proofs, measures within their limits, clearances.
    ///
    /// Errors: samples that do not fit the motion. What fails is no error: see [`Check::passed`].
    ///
    /// ```
    /// let check = mechanim::Scene::builtin("slider-crank")?.check(&Default::default())?;
    /// assert!(check.passed(), "{}", check.text());
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn check(&self, options: &CheckOptions) -> Result<Check, Error> {
        Check::run(Arc::clone(&self.loaded), options)
    }

    /// The measures of the scene as functions of its parameters.
    ///
    /// ```
    /// let study = mechanim::Scene::builtin("slider-crank")?.study();
    /// assert!(study.sensitivity().is_err(), "the scene measures nothing");
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn study(&self) -> Study {
        Study::new(Arc::clone(&self.loaded))
    }

    /// The assemblies at the inputs of a time, as far as a search from many starts finds them.
    ///
    /// Errors: an input without a value there.
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
