//! What effects grow with and follow: the laws of deformations, and the courses of disturbances with what one course means.

use super::experiment::{Experiment, STANDARD_GRAVITY, SetPoint};
use super::nominal::Nominal;

/// What a disturbance follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Course {
    /// 1 while the centrifuge spins: an aliased line, rectified vibration of the drive.
    Spinning,
    /// `|Omega|` [rad/s]: rectified vibration of an imbalance below its resonance, or of bearings.
    Speed,
    /// `Omega^2` [rad^2/s^2]: rectified vibration that grows with the speed.
    SquaredSpeed,
    /// `Omega^4` [rad^4/s^4]: rectified vibration of an imbalance, whose force is one with `Omega^2`.
    FourthPowerOfSpeed,
    /// `Omega_i`, the angular rate about the newtonometer's own axis [rad/s]: a gyroscopic moment, or a field that is at rest in the room.
    OwnRate,
    /// `-M_ii f_i`: a proof mass that yields to its force, in open loop or a soft loop.
    Yield,
    /// The order of the plateaus in the session, -1/2 to 1/2.
    Time,
    /// The Legendre polynomial of that degree, 1 to 3, in twice that order.
    Wander(u8),
    /// 1 from the plateau of that index on.
    From(usize),
    /// The order of the plateaus times `f_i`: a scale that changes with time.
    TimeScale,
    /// 1 on the first plateau of a mounting, half as much on each that follows: a unit that is switched on with each mounting.
    WarmUp,
    /// The same times `f_i`.
    WarmUpScale,
    /// +1 after a rise of the speed, -1 after a fall.
    Rise,
    /// Heat that a mounting has gathered: the power of a drag that grows with the law, `|Omega|` times the law, summed over its plateaus
    /// before and half of this one, over that at full scale. A machine cools while the unit is mounted anew.
    Heat(Law),
    /// 1 on the plateaus with the set speed of the plateau of that index: vibration in resonance.
    AtSpeedOf(usize),
    /// The specific force of the plateaus before, each half as much as the next.
    Memory,
    /// Sense of the change of `f_i` since the plateau before, `d / hypot(d, 0.05 g)`: hysteresis.
    Turn,
}

/// What one course means beside its name and its value.
pub(super) struct Facts {
    /// Unit and typical magnitude of its unknowns.
    pub unit: &'static str,
    pub typical: f64,
    /// Whether it depends on what came before a plateau.
    pub is_of_history: bool,
    /// In the letters of `docs/notation.md`.
    pub formula: &'static str,
}

/// Typical magnitude of a bias [m/s^2].
pub(super) const BIAS: f64 = 5e-3 * STANDARD_GRAVITY;

impl Course {
    pub(super) fn facts(self) -> Facts {
        let square = Law::Speed.full_scale();
        let (unit, typical, is_of_history, formula) = match self {
            Self::Spinning => ("m/s^2", BIAS, false, "1 where Omega > 0"),
            Self::Speed => ("m/s", BIAS / square.sqrt(), false, "|Omega|"),
            Self::SquaredSpeed => ("m", BIAS / square, false, "Omega^2"),
            Self::FourthPowerOfSpeed => ("m s^2", BIAS / square.powi(2), false, "Omega^4"),
            Self::OwnRate => ("m/s", BIAS / square.sqrt(), false, "Omega_i"),
            Self::Yield => ("s^2", 5e-4 / Law::Load.full_scale(), false, "-M_ii f_i"),
            Self::Time => ("m/s^2", BIAS, true, "t"),
            Self::Wander(_) => ("m/s^2", BIAS, true, "P_1(2t), P_2(2t), P_3(2t)"),
            Self::From(_) => ("m/s^2", BIAS, true, "1 from one rest on"),
            Self::TimeScale => ("1", 1e-3, true, "t f_i"),
            Self::WarmUp => ("m/s^2", BIAS, true, "2^-n on plateau n of a mounting"),
            Self::WarmUpScale => ("1", 1e-3, true, "2^-n f_i on plateau n of a mounting"),
            Self::Rise => ("m/s^2", BIAS, true, "+1 after a rise of Omega, -1 after a fall"),
            Self::Heat(Law::Speed) => ("m/s^2", BIAS, true, "sum |Omega|^3 over plateaus of the mounting"),
            Self::Heat(Law::Load) => ("m/s^2", BIAS, true, "sum |Omega|^3 |R0_1| over plateaus of the mounting"),
            Self::AtSpeedOf(_) => ("m/s^2", BIAS, false, "1 at one set speed"),
            Self::Memory => ("1", 1e-3, true, "sum_n 2^-n f_i, n plateaus before"),
            Self::Turn => ("m/s^2", BIAS, true, "+1 after a rise of f_i, -1 after a fall"),
        };
        Facts { unit, typical, is_of_history, formula }
    }

    /// Value on a plateau for a newtonometer.
    pub(super) fn value(self, experiment: &Experiment, set_point: &SetPoint, axis: usize) -> f64 {
        let history = &set_point.history;
        let f0 = || experiment.nominal(set_point)[axis];
        match self {
            Self::Spinning => f64::from(u8::from(!set_point.is_rest())),
            Self::Speed => set_point.omega.abs(),
            Self::SquaredSpeed => set_point.omega.powi(2),
            Self::FourthPowerOfSpeed => set_point.omega.powi(4),
            Self::OwnRate => set_point.omega * experiment.position_of(set_point).p_zy[(axis, 2)],
            Self::Yield => -Nominal::of(experiment, set_point).m[(axis, axis)] * f0(),
            Self::Time => history.time,
            Self::Wander(degree) => legendre(degree, 2.0 * history.time),
            Self::From(first) => f64::from(u8::from(history.time >= experiment.set_points[first].history.time)),
            Self::TimeScale => history.time * f0(),
            Self::WarmUp => history.warm_up,
            Self::WarmUpScale => history.warm_up * f0(),
            Self::Rise => history.rise,
            Self::Heat(law) => {
                let radius = experiment.arm_of(set_point).x;
                history.heat * law.value(Law::Speed.full_scale(), radius) / law.full_scale()
            }
            Self::AtSpeedOf(first) => f64::from(u8::from(experiment.set_points[first].has_speed(set_point.omega))),
            Self::Memory => history.memory[axis],
            Self::Turn => history.turn[axis],
        }
    }
}

/// The Legendre polynomial of a degree of 1 to 3.
fn legendre(degree: u8, x: f64) -> f64 {
    match degree {
        1 => x,
        2 => 1.5 * x * x - 0.5,
        _ => x * (2.5 * x * x - 1.5),
    }
}

/// What an elastic deformation grows with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Law {
    /// `Omega^2` [rad^2/s^2].
    Speed,
    /// The load `Omega^2 |R0_1|` [m/s^2].
    Load,
}

impl Law {
    /// Value at a rate squared [rad^2/s^2] and a radius [m].
    pub fn value(self, omega_squared: f64, radius: f64) -> f64 {
        match self {
            Self::Speed => omega_squared,
            Self::Load => omega_squared * radius.abs(),
        }
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Speed => "speed",
            Self::Load => "load",
        }
    }

    pub(super) fn unit_of_inverse(self) -> &'static str {
        match self {
            Self::Speed => "s^2",
            Self::Load => "s^2/m",
        }
    }

    /// Largest value the machines of the field reach (10 rev/s, 200 g): what turns a deformation into a coefficient.
    pub(super) fn full_scale(self) -> f64 {
        match self {
            Self::Speed => (20.0 * std::f64::consts::PI).powi(2),
            Self::Load => 200.0 * STANDARD_GRAVITY,
        }
    }
}
