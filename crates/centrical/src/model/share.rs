//! How an effect enters a plateau.

use nalgebra::Vector3;

use super::effect::Effect;
use super::experiment::{SetPoint, Site};
use super::measurement::MeasurementModel;

/// How one unit of an effect enters a plateau.
pub(super) enum Share {
    /// Not at all.
    None,
    /// Tilt of the rotation axis about a reference axis [rad per unit].
    Tilt(usize),
    /// Small turn of the unit, instrument axes [rad per unit].
    Turn(Vector3<f64>),
    /// Displacement in arm axes [m per unit].
    Arm(Vector3<f64>),
    /// Displacement of a coordinate of a proof mass [m per unit].
    Coordinate { coordinate: usize, mass: usize },
    /// Change of the rate squared `w` [rad^2/s^2 per unit].
    Rate(f64),
    /// Change of gravity [m/s^2 per unit].
    Gravity,
    /// Added to the readings [m/s^2 per unit].
    Reading(Vector3<f64>),
}

impl MeasurementModel {
    /// How one unit of `effect` enters a plateau.
    pub(super) fn share(&self, set_point: &SetPoint, effect: Effect) -> Share {
        let experiment = &self.experiment;
        let here = set_point.mounting;
        let is_off_arm = effect.is_of_arm() && !experiment.is_on_arm(here);
        if is_off_arm || !effect.scope().has(experiment, here) {
            return Share::None;
        }
        let r0_y = experiment.arm_of(set_point);
        let omega_squared = set_point.omega * set_point.omega;
        let only = |condition: bool, share: Share| if condition { share } else { Share::None };
        let along = |axis: usize| Vector3::ith(axis, 1.0);
        match effect {
            Effect::ElasticTurn { law, axis, .. } => Share::Turn(Vector3::ith(axis, law.value(omega_squared, r0_y.x))),
            Effect::ArmTurn { law, axis } => {
                let turn_y = Vector3::ith(axis, law.value(omega_squared, r0_y.x));
                Share::Turn(experiment.position_of(set_point).p_zy * turn_y)
            }
            Effect::PositionTurn { axis, .. } | Effect::MountingTurn { axis, .. } => Share::Turn(along(axis)),
            Effect::SpinTurn { axis, .. } => only(!set_point.is_rest(), Share::Turn(along(axis))),
            Effect::MountingTilt { axis, .. } => only(set_point.is_rest(), Share::Tilt(axis)),
            Effect::AngleTilt { axis, first } => {
                only(set_point.rests_at(experiment.set_points[first].angle), Share::Tilt(axis))
            }
            Effect::RestTilt { axis, .. } | Effect::AttitudeTilt { axis, .. } => Share::Tilt(axis),
            Effect::ArmStretch { law, .. } => Share::Arm(Vector3::x() * (r0_y.x * law.value(omega_squared, r0_y.x))),
            Effect::RadiusScale => Share::Arm(*r0_y),
            Effect::SeatPlace { axis, .. }
            | Effect::PositionShift { axis, .. }
            | Effect::MountingShift { axis, .. } => Share::Arm(along(axis)),
            Effect::Coordinate { coordinate, mass } => Share::Coordinate { coordinate, mass },
            Effect::SpeedScale => Share::Rate(omega_squared),
            Effect::OneSpeed { first } => {
                only(experiment.set_points[first].has_speed(set_point.omega), Share::Rate(omega_squared))
            }
            Effect::EarthRate => Share::Rate(set_point.omega * 2.0),
            Effect::Gravity => Share::Gravity,
            Effect::Latitude => {
                let cosine = experiment.site.latitude.map_or(0.0, f64::cos);
                Share::Rate(set_point.omega * 2.0 * Site::EARTH_RATE * cosine)
            }
            Effect::Monomial { axis, monomial, .. } => {
                Share::Reading(Vector3::ith(axis, monomial.value(experiment.nominal(set_point).into())))
            }
            Effect::Disturbance { axis, follows } => {
                Share::Reading(Vector3::ith(axis, follows.value(experiment, set_point, axis)))
            }
            Effect::Turning { axis, .. } => {
                // Only the acceleration along the vertical counts: that across it turns the specific force.
                let position = experiment.position_of(set_point);
                Share::Reading(position.p_zy.column(2) * position.bend_z[axis])
            }
            Effect::Rounding { axis, first } => {
                only(set_point.history.repeats == Some(first), Share::Reading(along(axis)))
            }
        }
    }
}
