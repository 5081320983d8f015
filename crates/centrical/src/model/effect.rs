//! What acts on the readings beyond the source's unknowns: as a further unknown, as a stated uncertainty, or as a rival that
//! the residuals are asked for.

use centrical_compensate::Monomial;

use super::course::{Course, Law};
use super::experiment::Experiment;

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
    /// The same of the plateaus at one set speed.
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
        let is_of_rest = matches!(self, Self::SpinTurn { .. } | Self::MountingTilt { .. } | Self::AngleTilt { .. });
        self.is_elastic() || is_disturbance || is_of_rest
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
            | Self::OneSpeed { .. }
            | Self::EarthRate
            | Self::Gravity
            | Self::Latitude
            | Self::Disturbance { .. }
            | Self::Rounding { .. } => Scope::Session,
        }
    }
}
