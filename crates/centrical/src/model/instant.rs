//! The exact model at one instant of any motion about the axis of rotation, ramps included: what a plateau's mean
//! over a revolution is the mean of.
//!
//! Newtonometer `i` stands at `r_i = r + B^T rho e_i` in arm axes and is ideally pulled by
//!
//! `f_i = e_i^T B ( g u + (Omega^2 + 2 Omega w_3) d r_i + dOmega/dt (e_3 x r_i) + 2 Omega (w_1 r_i1 + w_2 r_i2) e_3 )`,
//!
//! `d = -diag(1, 1, 0)`: gravity, the centripetal and tangential accelerations of the arm, and the Coriolis
//! acceleration under the Earth's rate `w`, whose components 1, 2 turn with the arm. Here `w_3` is that along the
//! tilted axis; the plateau model takes the plumb line's, `omega_E sin(latitude)`, which is `omega_E cos(latitude)`
//! times the tilt away: 0.3 ug for 1 mrad at 200 g, 0.5 m and 56 deg. Deformations follow `Omega` without delay.

use nalgebra::{Matrix3, Vector3};

use super::effect::Effect;
use super::exact::Geometry;
use super::experiment::{SetPoint, Site};
use super::frame::rotation;
use super::measurement::MeasurementModel;
use super::parameter::Parameter;

/// Where the arm is in its turn and how it moves; by default at rest at the angle zero.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct ArmMotion {
    /// Carousel angle `alpha_3` [rad].
    pub angle: f64,
    /// Angular speed `Omega` about the third arm axis [rad/s].
    pub speed: f64,
    /// `d Omega / dt` [rad/s^2].
    pub acceleration: f64,
}

/// The unit on the arm, deformed as it is at one speed: ideal readings as harmonics of the carousel angle.
#[derive(Debug, Clone)]
pub(crate) struct MountedUnit {
    /// Reaction to gravity: constant part, parts with `cos alpha_3` and `sin alpha_3` [m/s^2].
    weight: [Vector3<f64>; 3],
    /// Centripetal acceleration per unit of `Omega^2` [m].
    centripetal: Vector3<f64>,
    /// Tangential acceleration per unit of `d Omega / dt` [m].
    tangential: Vector3<f64>,
    /// Coriolis acceleration along the axis per unit of `Omega`: parts with `cos alpha_3`, `sin alpha_3` [m/s].
    coriolis: [Vector3<f64>; 2],
    /// Added to the square of the speed per unit of `Omega`: `2 w_3`, and twice an offset of the speeds [rad/s].
    per_speed: f64,
    /// `Omega^2` is this many times the square of the speed set.
    square_scale: f64,
    /// Added to the readings behind the error model [m/s^2].
    pub disturbance: Vector3<f64>,
}

impl MeasurementModel {
    /// Reading `f'` [m/s^2] of the unit in mounting `mounting` at the unknowns `x`, at one instant of the arm's motion: carousel angle [rad],
    /// angular speed [rad/s], and its derivative [rad/s^2].
    pub fn reading_at(&self, mounting: usize, x: &[f64], [angle, speed, acceleration]: [f64; 3]) -> Vector3<f64> {
        let motion = ArmMotion { angle, speed, acceleration };
        let unit = self.mounted_unit(mounting, x, &motion);
        let f = unit.specific_force(&motion);
        self.error_model.reading(self.parameters.coefficients(x), &f) + unit.disturbance
    }

    /// The unit on the arm in mounting `mounting` as the speed of `motion` deforms it, and at rest the angle tilts it.
    pub(crate) fn mounted_unit(&self, mounting: usize, x: &[f64], motion: &ArmMotion) -> MountedUnit {
        let set_point = SetPoint { angle: motion.angle, ..SetPoint::spinning(mounting, motion.speed) };
        let geometry = self.geometry(&set_point, x);
        let scales = |effect: Effect| match effect {
            Effect::SpeedScale => true,
            Effect::OneSpeed { first } => self.experiment.set_points[first].has_speed(motion.speed),
            _ => false,
        };
        let size_of = |is_of: &dyn Fn(Effect) -> bool| {
            self.acting(x).filter(|(effect, _)| is_of(*effect)).map(|(_, size)| size).sum::<f64>()
        };
        let square_scale = 1.0 + size_of(&scales);
        let vertical = size_of(&|effect| effect == Effect::EarthRate);
        let offset = size_of(&|effect| effect == Effect::SpeedOffset);
        let earth_rate_x = earth_rate(&self.experiment.site) + Vector3::new(0.0, 0.0, vertical);
        let unit = MountedUnit::new(&geometry, &earth_rate_x, square_scale);
        let per_speed = unit.per_speed + 2.0 * offset * motion.speed.signum();
        MountedUnit { per_speed, disturbance: self.disturbance(&set_point, x), ..unit }
    }

    /// Whether anything but the rate changes with the speed.
    pub(crate) fn changes_with_speed(&self) -> bool {
        self.parameters.effects().any(|(_, effect)| effect.changes_with_speed())
    }

    /// A parameter that acts at `x` through what came before a plateau: at an instant of a motion it has no meaning.
    pub fn of_history(&self, x: &[f64]) -> Option<&Parameter> {
        let effects = self.parameters.effects();
        let mut acting = effects.filter(|(column, effect)| x[*column] != 0.0 && effect.is_of_history());
        acting.next().map(|(column, _)| &self.parameters[column])
    }
}

impl MountedUnit {
    fn new(geometry: &Geometry, earth_rate_x: &Vector3<f64>, square_scale: f64) -> Self {
        let c_zy = geometry.c_zy;
        let axis_z = c_zy.column(2).into_owned();
        let tilt = rotation(&geometry.tilt);
        let up = tilt * Vector3::z() * geometry.gravity;
        let w = tilt * earth_rate_x;
        // Column i: proof mass i in arm axes.
        let r_y = Matrix3::from_columns(&[geometry.arm_y; 3]) + c_zy.transpose() * geometry.rho_z;
        // carousel(alpha_3) takes (v_1, v_2) to cos (v_1, v_2) + sin (v_2, -v_1).
        let [cosine, sine] = [Vector3::new(up.x, up.y, 0.0), Vector3::new(up.y, -up.x, 0.0)];
        let along_axis =
            |w_1: f64, w_2: f64| Vector3::from_fn(|i, _| 2.0 * axis_z[i] * (w_1 * r_y[(0, i)] + w_2 * r_y[(1, i)]));
        Self {
            weight: [axis_z * up.z, c_zy * cosine, c_zy * sine],
            centripetal: geometry.pull_by_rate(),
            tangential: Vector3::from_fn(|i, _| c_zy[(i, 1)] * r_y[(0, i)] - c_zy[(i, 0)] * r_y[(1, i)]),
            coriolis: [along_axis(w.x, w.y), along_axis(w.y, -w.x)],
            per_speed: 2.0 * w.z,
            square_scale,
            disturbance: Vector3::zeros(),
        }
    }

    /// Ideal readings `f` [m/s^2] at an instant.
    pub fn specific_force(&self, motion: &ArmMotion) -> Vector3<f64> {
        let ArmMotion { angle, speed: omega, acceleration } = *motion;
        let (sine, cosine) = angle.sin_cos();
        let [constant, by_cosine, by_sine] = &self.weight;
        constant
            + (by_cosine + self.coriolis[0] * omega) * cosine
            + (by_sine + self.coriolis[1] * omega) * sine
            + self.centripetal * (omega * (self.square_scale * omega + self.per_speed))
            + self.tangential * acceleration
    }
}

/// The Earth's rate in reference axes [rad/s]; zero when no latitude is given.
fn earth_rate(site: &Site) -> Vector3<f64> {
    site.latitude
        .map_or_else(Vector3::zeros, |latitude| Vector3::new(0.0, latitude.cos(), latitude.sin()) * Site::EARTH_RATE)
}
