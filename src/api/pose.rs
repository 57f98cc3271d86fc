//! A closed pose and its properties.

use super::error::{Error, find_column};
use super::loaded::Loaded;
use crate::kinematics::results::certificate::Certificate;
use crate::kinematics::results::printed::printed_certificate;
use crate::kinematics::results::trajectory::{ClosedPose, Sample};
use crate::math;

/// A closed pose of a motion: values, placements of bodies, closure error, rank, condition, branch, certificate.
#[derive(Clone, Copy)]
pub struct Pose<'m> {
    loaded: &'m Loaded,
    sample: &'m Sample,
    pose: &'m ClosedPose,
}

impl<'m> Pose<'m> {
    pub(super) fn new(loaded: &'m Loaded, sample: &'m Sample, pose: &'m ClosedPose) -> Self {
        Self {
            loaded,
            sample,
            pose,
        }
    }

    /// The time of the pose in seconds.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let motion = Scene::builtin("four-bar")?.solve(Samples::Even(4))?;
    /// assert_eq!(motion.poses().next().map(|pose| pose.time()), Some(0.0));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn time(&self) -> f64 {
        self.sample.time
    }

    /// The value of an input, unknown, traced coordinate (`name.x`) or output, in the scene's units.
    ///
    /// Errors: no quantity of the scene has that name.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let motion = Scene::builtin("slider-crank")?.solve(Samples::Even(4))?;
    /// for pose in motion.poses() {
    ///     assert!(pose.value("h")? > 39.0);
    /// }
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn value(&self, name: &str) -> Result<f64, Error> {
        let mechanism = &self.loaded.scene.mechanism;
        let column = find_column(mechanism, name)?;
        Ok(column.value(mechanism, self.sample, self.pose))
    }

    /// Time derivative of an unknown for the rate of the drive, per second; NaN for an angle in gimbal lock.
    ///
    /// Errors: no unknown has that name.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let motion = Scene::builtin("slider-crank")?.solve(Samples::At(vec![0.0]))?;
    /// assert!(motion.poses().all(|pose| pose.rate("h").is_ok_and(f64::is_finite)));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn rate(&self, name: &str) -> Result<f64, Error> {
        let mechanism = &self.loaded.scene.mechanism;
        let unknowns = &mechanism.unknowns;
        let Some(index) = unknowns.iter().position(|c| c.name == name) else {
            let names = unknowns.iter().map(|c| c.name.as_str());
            return Err(Error::unknown_name("unknown", name, names));
        };
        Ok(self.pose.rates[index] * mechanism.file_units(unknowns[index].kind))
    }

    /// Position and orientation of a body: `world_from_body` as a homogeneous matrix by rows. The last column is the origin
    /// of the body's frame, in the scene's length unit.
    ///
    /// Errors: no body has that name.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let motion = Scene::builtin("bennett")?.solve(Samples::At(vec![0.0]))?;
    /// let pose = motion.pose(0).ok_or("no pose")?;
    /// let scene = Scene::builtin("bennett")?;
    /// let [x, y, z, last] = pose.placement(scene.bodies()[0])?;
    /// let determinant = x[0] * (y[1] * z[2] - y[2] * z[1]) - x[1] * (y[0] * z[2] - y[2] * z[0])
    ///     + x[2] * (y[0] * z[1] - y[1] * z[0]);
    /// assert!((determinant - 1.0).abs() < 1e-12 && last == [0.0, 0.0, 0.0, 1.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn placement(&self, body: &str) -> Result<[[f64; 4]; 4], Error> {
        let bodies = &self.loaded.scene.mechanism.bodies;
        let Some(index) = bodies.iter().position(|b| b.name == body) else {
            let names = bodies.iter().map(|b| b.name.as_str());
            return Err(Error::unknown_name("body", body, names));
        };
        Ok(placement(&self.pose.bodies[index]))
    }

    /// Position and orientation of every body, in the order of [`Scene::bodies`](crate::Scene::bodies).
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let scene = Scene::builtin("bennett")?;
    /// let motion = scene.solve(Samples::At(vec![0.0]))?;
    /// let pose = motion.pose(0).ok_or("no pose")?;
    /// assert_eq!(pose.placements()[1], pose.placement(scene.bodies()[1])?);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn placements(&self) -> Vec<[[f64; 4]; 4]> {
        self.pose.bodies.iter().map(placement).collect()
    }

    /// Largest closure error of any loop, relative to the mechanism's size, computed by an independent product.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let motion = Scene::builtin("seven-r")?.solve(Samples::At(vec![1.0]))?;
    /// assert!(motion.poses().all(|pose| pose.closure_error() < 1e-13));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn closure_error(&self) -> f64 {
        self.pose.closure_error
    }

    /// Smallest singular value of the Jacobian for scaled unknowns and residuals, without unit; zero at a singular pose.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let motion = Scene::builtin("four-bar")?.solve(Samples::Even(10))?;
    /// assert!(motion.poses().all(|pose| pose.sigma_min() > 0.0));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn sigma_min(&self) -> f64 {
        self.pose.sigma_min
    }

    /// Largest condition number (ratio of singular values) of the scaled Jacobian of any block of equations.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let motion = Scene::builtin("four-bar")?.solve(Samples::Even(10))?;
    /// assert!(motion.poses().all(|pose| pose.condition() >= 1.0));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn condition(&self) -> f64 {
        self.pose.condition
    }

    /// Rank of the Jacobian; the number of unknowns at a regular pose.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let scene = Scene::builtin("seven-r")?;
    /// let motion = scene.solve(Samples::At(vec![0.0]))?;
    /// assert!(motion.poses().all(|pose| pose.rank() == scene.unknowns().len()));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn rank(&self) -> usize {
        self.pose.rank
    }

    /// The assembly mode: one sign per block of equations. It can change only at singular poses.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let motion = Scene::builtin("four-bar")?.solve(Samples::Even(10))?;
    /// let branches: Vec<&str> = motion.poses().map(|pose| pose.branch()).collect();
    /// assert!(branches.windows(2).all(|pair| pair[0] == pair[1]));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn branch(&self) -> &'m str {
        &self.pose.branch
    }

    /// The proof: the distance to the exact pose and the radius within which it is the only one, or the reason why it
    /// failed. As in tables, the exact pose is that of the inputs read as the shortest decimals of their values in the
    /// scene's units, and the distance includes the rounding of the unknowns to `f64`.
    ///
    /// ```
    /// # use mechanim::{Certificate, Samples, Scene};
    /// let motion = Scene::builtin("seven-r")?.solve(Samples::Even(10))?;
    /// for pose in motion.poses() {
    ///     assert!(matches!(pose.certificate(), Certificate::Certified { error_bound, .. } if error_bound < 1e-9));
    /// }
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn certificate(&self) -> Certificate {
        printed_certificate(&self.loaded.scene.mechanism, self.pose)
    }
}

fn placement(world_from_body: &math::Pose) -> [[f64; 4]; 4] {
    let [x, y, z] = world_from_body.rotation.transpose().to_cols_array_2d();
    let t = world_from_body.translation;
    let row = |[a, b, c]: [f64; 3], shift: f64| [a, b, c, shift];
    [row(x, t.x), row(y, t.y), row(z, t.z), [0.0, 0.0, 0.0, 1.0]]
}
