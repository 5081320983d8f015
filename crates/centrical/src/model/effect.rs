//! What acts on the readings beyond the source's unknowns, and how it enters a plateau: as a further unknown, as a stated uncertainty,
//! or as a rival that the residuals are asked for.

use centrical_compensate::Monomial;
use nalgebra::Vector3;

use super::course::{Course, Law};
use super::experiment::{Experiment, SetPoint, Site};

/// An effect on the readings, per unit of its size. Axes are 0, 1, 2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effect {
    /// Elastic turn of the unit in a position about an instrument axis, per unit of its law.
    ElasticTurn {
        /// What it grows with.
        law: Law,
        /// Instrument axis.
        axis: usize,
        /// Index of the position.
        position: usize,
    },
    /// Elastic turn of the arm's end about an arm axis, common to all positions, per unit of its law.
    ArmTurn {
        /// What it grows with.
        law: Law,
        /// Arm axis.
        axis: usize,
    },
    /// Turn of the unit in a position about an instrument axis [rad].
    PositionTurn {
        /// Instrument axis.
        axis: usize,
        /// Index of the position.
        position: usize,
    },
    /// The same while the centrifuge spins only [rad].
    SpinTurn {
        /// Instrument axis.
        axis: usize,
        /// Index of the position.
        position: usize,
    },
    /// Turn of the unit in one mounting about an instrument axis [rad].
    MountingTurn {
        /// Instrument axis.
        axis: usize,
        /// Index of the mounting.
        mounting: usize,
    },
    /// Tilt of the rotation axis in one mounting [rad], about reference axis 1 or 2; it shows at rest.
    MountingTilt {
        /// Reference axis, 0 or 1.
        axis: usize,
        /// Index of the mounting.
        mounting: usize,
    },
    /// Tilt of the rotation axis at one angle of rest [rad], about reference axis 1 or 2.
    AngleTilt {
        /// Reference axis, 0 or 1.
        axis: usize,
        /// Index of the first set point at rest at that angle.
        first: usize,
    },
    /// Tilt of a rest beyond what is stated of its attitude [rad], about reference axis 1 or 2.
    RestTilt {
        /// Reference axis, 0 or 1.
        axis: usize,
        /// Index of the position.
        position: usize,
    },
    /// The same of all rests whose attitude is stated alike: a face of a cube, an angle of a table.
    AttitudeTilt {
        /// Reference axis, 0 or 1.
        axis: usize,
        /// Index of the first position with that attitude.
        first: usize,
    },
    /// Relative stretch of the arm, `R_1 (1 + kappa law)` (IEEE Std 836), of one seat or of all.
    ArmStretch {
        /// What it grows with.
        law: Law,
        /// Index of the first mounting on the seat; `None` when all seats share one stretch.
        seat: Option<usize>,
    },
    /// One relative error of all radii: `R0 (1 + s)`.
    RadiusScale,
    /// Displacement of a seat along an arm axis [m], or of all seats.
    SeatPlace {
        /// Arm axis, 0 or 1.
        axis: usize,
        /// Index of the first mounting on the seat; `None` for all seats.
        seat: Option<usize>,
    },
    /// Displacement of the unit in a position along an arm axis [m].
    PositionShift {
        /// Arm axis, 0 or 1.
        axis: usize,
        /// Index of the position.
        position: usize,
    },
    /// Displacement of the unit in one mounting along an arm axis [m].
    MountingShift {
        /// Arm axis, 0 or 1.
        axis: usize,
        /// Index of the mounting.
        mounting: usize,
    },
    /// Coordinate of a proof mass in instrument axes [m].
    Coordinate {
        /// Instrument axis of the coordinate.
        coordinate: usize,
        /// The proof mass.
        mass: usize,
    },
    /// One relative error of the square of all speeds: `Omega^2 (1 + s)`.
    SpeedScale,
    /// One error of the amount of all speeds, `|Omega| + s` [rad/s]: the zero of a drive or of a tachometer, or digits that are cut off.
    SpeedOffset,
    /// A relative error of the square of one set speed.
    OneSpeed {
        /// Index of the first set point with that speed.
        first: usize,
    },
    /// Vertical component of the Earth's rotation, where no latitude is stated [rad/s].
    EarthRate,
    /// Local gravity [m/s^2].
    Gravity,
    /// Latitude [rad].
    Latitude,
    /// A term of the error model at the nominal specific force.
    Monomial {
        /// Newtonometer it acts on.
        axis: usize,
        /// What multiplies its coefficient.
        monomial: Monomial,
        /// Where it acts.
        scope: Scope,
    },
    /// A disturbance of one newtonometer's readings.
    Disturbance {
        /// Newtonometer.
        axis: usize,
        /// What it follows.
        follows: Course,
    },
    /// Coordinate of the proof masses from the axes of a slow rotation [m].
    Turning {
        /// Instrument axis of the coordinate.
        axis: usize,
        /// Number of the switch-on.
        switch_on: usize,
    },
    /// An error of rounding common to repeated rests of one mounting at one angle [m/s^2].
    Rounding {
        /// Newtonometer.
        axis: usize,
        /// Index of the first of the rests.
        first: usize,
    },
}

/// Where an effect acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scope {
    /// On all plateaus.
    Session,
    /// In a position, by its index.
    Position(usize),
    /// In the rests with the stated attitude of a position, by its index.
    Attitude(usize),
    /// On a seat, by its first mounting.
    Seat(usize),
    /// In a mounting, by its index.
    Mounting(usize),
    /// In the rests of a switch-on, by its number.
    SwitchOn(usize),
}

impl Scope {
    /// Whether a mounting is in it.
    pub(crate) fn has(self, experiment: &Experiment, mounting: usize) -> bool {
        let position = experiment.mountings[mounting].position;
        match self {
            Self::Session => true,
            Self::Position(k) => k == position,
            Self::Attitude(k) => experiment.positions[k].shares_attitude(&experiment.positions[position]),
            Self::Seat(seat) => seat == experiment.seat_of(mounting),
            Self::Mounting(m) => m == mounting,
            Self::SwitchOn(number) => number == experiment.positions[position].switch_on.number,
        }
    }
}

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

impl Effect {
    /// The scale of a newtonometer in one mounting, relative.
    pub(super) fn scale_of_mounting(axis: usize, mounting: usize) -> Self {
        Self::Monomial { axis, monomial: Monomial::power(axis, 1), scope: Scope::Mounting(mounting) }
    }

    /// The bias of a newtonometer in one mounting [m/s^2].
    pub(super) fn bias_of_mounting(axis: usize, mounting: usize) -> Self {
        Self::Monomial { axis, monomial: Monomial::ONE, scope: Scope::Mounting(mounting) }
    }

    /// Change of the bias of a newtonometer from the switch-on of the arm, or of the first rest, to another one [m/s^2].
    pub fn change_of_bias(axis: usize, switch_on: usize) -> Self {
        Self::Monomial { axis, monomial: Monomial::ONE, scope: Scope::SwitchOn(switch_on) }
    }

    /// Whether it depends on what came before a plateau.
    pub(super) fn is_of_history(self) -> bool {
        matches!(self, Self::Disturbance { follows, .. } if follows.facts().is_of_history)
    }

    /// Whether it is a deformation that grows with the square of the speed.
    pub(crate) fn is_elastic(self) -> bool {
        matches!(self, Self::ElasticTurn { .. } | Self::ArmTurn { .. } | Self::ArmStretch { .. })
    }

    /// Whether it acts otherwise at another speed, through more than the rate.
    pub(crate) fn changes_with_speed(self) -> bool {
        let is_disturbance = matches!(self, Self::Disturbance { .. } | Self::Monomial { .. });
        let is_of_sense = matches!(self, Self::SpeedOffset);
        let is_of_rest = matches!(self, Self::SpinTurn { .. } | Self::MountingTilt { .. } | Self::AngleTilt { .. });
        self.is_elastic() || is_disturbance || is_of_sense || is_of_rest
    }

    /// Whether it acts through the arm, its machine or its seats: not on a rest in a free attitude, whose own attitude is
    /// unknown.
    pub(super) fn is_of_arm(self) -> bool {
        match self {
            Self::Gravity
            | Self::Monomial { .. }
            | Self::Disturbance { .. }
            | Self::RestTilt { .. }
            | Self::AttitudeTilt { .. }
            | Self::Turning { .. }
            | Self::Rounding { .. } => false,
            Self::ElasticTurn { .. }
            | Self::ArmTurn { .. }
            | Self::PositionTurn { .. }
            | Self::SpinTurn { .. }
            | Self::MountingTurn { .. }
            | Self::MountingTilt { .. }
            | Self::AngleTilt { .. }
            | Self::ArmStretch { .. }
            | Self::RadiusScale
            | Self::SeatPlace { .. }
            | Self::PositionShift { .. }
            | Self::MountingShift { .. }
            | Self::Coordinate { .. }
            | Self::SpeedScale
            | Self::SpeedOffset
            | Self::OneSpeed { .. }
            | Self::EarthRate
            | Self::Latitude => true,
        }
    }

    /// Where it acts.
    pub(crate) fn scope(self) -> Scope {
        match self {
            Self::ElasticTurn { position, .. }
            | Self::PositionTurn { position, .. }
            | Self::SpinTurn { position, .. }
            | Self::RestTilt { position, .. }
            | Self::PositionShift { position, .. } => Scope::Position(position),
            Self::MountingTurn { mounting, .. }
            | Self::MountingTilt { mounting, .. }
            | Self::MountingShift { mounting, .. } => Scope::Mounting(mounting),
            Self::ArmStretch { seat, .. } | Self::SeatPlace { seat, .. } => seat.map_or(Scope::Session, Scope::Seat),
            Self::AttitudeTilt { first, .. } => Scope::Attitude(first),
            Self::Turning { switch_on, .. } => Scope::SwitchOn(switch_on),
            Self::Monomial { scope, .. } => scope,
            Self::ArmTurn { .. }
            | Self::AngleTilt { .. }
            | Self::RadiusScale
            | Self::Coordinate { .. }
            | Self::SpeedScale
            | Self::SpeedOffset
            | Self::OneSpeed { .. }
            | Self::EarthRate
            | Self::Gravity
            | Self::Latitude
            | Self::Disturbance { .. }
            | Self::Rounding { .. } => Scope::Session,
        }
    }

    /// How one unit of it enters a plateau.
    pub(super) fn share(self, experiment: &Experiment, set_point: &SetPoint) -> Share {
        let here = set_point.mounting;
        let is_off_arm = self.is_of_arm() && !experiment.is_on_arm(here);
        if is_off_arm || !self.scope().has(experiment, here) {
            return Share::None;
        }
        let r0_y = experiment.arm_of(set_point);
        let omega_squared = set_point.omega * set_point.omega;
        let only = |condition: bool, share: Share| if condition { share } else { Share::None };
        let along = |axis: usize| Vector3::ith(axis, 1.0);
        match self {
            Self::ElasticTurn { law, axis, .. } => Share::Turn(Vector3::ith(axis, law.value(omega_squared, r0_y.x))),
            Self::ArmTurn { law, axis } => {
                let turn_y = Vector3::ith(axis, law.value(omega_squared, r0_y.x));
                Share::Turn(experiment.position_of(set_point).p_zy * turn_y)
            }
            Self::PositionTurn { axis, .. } | Self::MountingTurn { axis, .. } => Share::Turn(along(axis)),
            Self::SpinTurn { axis, .. } => only(!set_point.is_rest(), Share::Turn(along(axis))),
            Self::MountingTilt { axis, .. } => only(set_point.is_rest(), Share::Tilt(axis)),
            Self::AngleTilt { axis, first } => {
                only(set_point.rests_at(experiment.set_points[first].angle), Share::Tilt(axis))
            }
            Self::RestTilt { axis, .. } | Self::AttitudeTilt { axis, .. } => Share::Tilt(axis),
            Self::ArmStretch { law, .. } => Share::Arm(Vector3::x() * (r0_y.x * law.value(omega_squared, r0_y.x))),
            Self::RadiusScale => Share::Arm(*r0_y),
            Self::SeatPlace { axis, .. } | Self::PositionShift { axis, .. } | Self::MountingShift { axis, .. } => {
                Share::Arm(along(axis))
            }
            Self::Coordinate { coordinate, mass } => Share::Coordinate { coordinate, mass },
            Self::SpeedScale => Share::Rate(omega_squared),
            // Its square is below 1e-8 of the square of the speed.
            Self::SpeedOffset => Share::Rate(set_point.omega.abs() * 2.0),
            Self::OneSpeed { first } => {
                only(experiment.set_points[first].has_speed(set_point.omega), Share::Rate(omega_squared))
            }
            Self::EarthRate => Share::Rate(set_point.omega * 2.0),
            Self::Gravity => Share::Gravity,
            Self::Latitude => {
                let cosine = experiment.site.latitude.map_or(0.0, f64::cos);
                Share::Rate(set_point.omega * 2.0 * Site::EARTH_RATE * cosine)
            }
            Self::Monomial { axis, monomial, .. } => {
                Share::Reading(Vector3::ith(axis, monomial.value(experiment.nominal(set_point).into())))
            }
            Self::Disturbance { axis, follows } => {
                Share::Reading(Vector3::ith(axis, follows.value(experiment, set_point, axis)))
            }
            Self::Turning { axis, .. } => {
                // Only the acceleration along the vertical counts: that across it turns the specific force.
                let position = experiment.position_of(set_point);
                Share::Reading(position.p_zy.column(2) * position.bend_z[axis])
            }
            Self::Rounding { axis, first } => {
                only(set_point.history.repeats == Some(first), Share::Reading(along(axis)))
            }
        }
    }
}
