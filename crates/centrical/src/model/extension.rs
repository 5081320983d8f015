//! Effects as unknowns beyond the source's 49, each off by default.
//!
//! Where an effect belongs to a mounting, its unknowns are differences from the first mounting that shares the position (or
//! the shift): the shared unknown itself remains, and no direction is lost by counting it twice.

use std::ops::RangeInclusive;

use centrical_compensate::Monomial;

use super::course::{Course, Law};
use super::effect::Effect;
use super::error_model::ErrorModel;
use super::experiment::{Experiment, Site};
use super::group::Group;
use super::parameter::Parameter;
use super::unknowns::{
    angle_tilts, attitude_tilts, by_mounting, by_position, coordinates, disturbance, effect, mounting_bias,
    mounting_scale, mounting_shift, mounting_turn, of_rests, other_unit, per_law, position_shifts, rest_tilts,
    seat_places, seats, shares_shift, stretch, three,
};

/// Unknowns beyond the source's 49, each off by default.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extension {
    /// Elastic turn of the unit, three per position.
    ElasticTurn(Law),
    /// Stretch of the arm, one for all seats.
    ArmStretch(Law),
    /// Stretch of the arm, one per seat (distinct `R0`).
    SeatStretch(Law),
    /// One scale of all radii.
    RadiusScale,
    /// One scale of the square of all speeds.
    SpeedScale,
    /// One offset of all speeds.
    SpeedOffset,
    /// The Earth's rotation, where no latitude is stated.
    EarthRate,
    /// Local gravity.
    Gravity,
    /// Elastic turn of the arm's end, three for all positions.
    ArmTurn(Law),
    /// Radius of each seat but the first.
    SeatRadius,
    /// Lateral place of each seat but the first.
    SeatLateral,
    /// `dR` of every position, where the model shares it by pair.
    PositionShift,
    /// Shift of every mounting, two each.
    MountingShift,
    /// Turn of every mounting, three each.
    MountingTurn,
    /// Tilt of the axis in every mounting, two each.
    MountingTilt,
    /// Tilt of the axis at every angle of rest but the first, two each: a bearing that wobbles, or an angle other than stated.
    AngleTilt,
    /// Bias of every mounting, three each: a unit that is switched off to be moved, or gets warm.
    MountingBias,
    /// Scale of every mounting, three each: likewise.
    MountingScale,
    /// Bias of the rests of every other switch-on, three each, beside the change of it that is stated.
    RestsBias,
    /// Scale of the rests of every other switch-on, three each: at another temperature or gravity.
    RestsScale,
    /// Terms of first degree of the rests of every other switch-on: of another unit, or in another order of axes.
    RestsUnit,
    /// Tilts of the rests in known attitudes, two each, beyond what is stated of these.
    RestsTilt,
    /// The same of each stated attitude, where several rests share one: errors of the faces of a cube, or of a table's angles.
    AttitudesTilt,
    /// Turn of the unit while spinning against that at rest, three per position.
    SpinTurn,
    /// Coordinates of the proof masses that are taken as exact ([`Unit::is_coordinate_taken_as_exact`]).
    ProofMasses,
    /// A disturbance of the readings, one per newtonometer.
    Disturbance(Course),
    /// Biases that wander over the session: polynomials of first to third degree in the order of the plateaus, nine unknowns.
    BiasWander,
    /// A disturbance at one set speed, one per newtonometer, by the index of the speed as in [`Extension::OneSpeed`].
    Resonance(usize),
    /// One mounting, by its index, that differs from the others.
    OneMounting(Difference, usize),
    /// One set speed that is off, by its index among them, the lowest first ([`Experiment::set_speeds`]).
    OneSpeed(usize),
}

/// How one mounting may differ from the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Difference {
    /// Its place, two unknowns.
    Shift,
    /// Its attitude, three unknowns.
    Turn,
    /// The unit in it: as many unknowns as the error model has terms.
    Unit,
}

impl Extension {
    /// Every extension with its name as written in sessions and plans.
    pub const NAMED: [(&'static str, Self); 45] = [
        ("elastic-turn-speed", Self::ElasticTurn(Law::Speed)),
        ("elastic-turn-load", Self::ElasticTurn(Law::Load)),
        ("arm-stretch-speed", Self::ArmStretch(Law::Speed)),
        ("arm-stretch-load", Self::ArmStretch(Law::Load)),
        ("seat-stretch-speed", Self::SeatStretch(Law::Speed)),
        ("seat-stretch-load", Self::SeatStretch(Law::Load)),
        ("radius-scale", Self::RadiusScale),
        ("speed-scale", Self::SpeedScale),
        ("speed-offset", Self::SpeedOffset),
        ("earth-rate", Self::EarthRate),
        ("gravity", Self::Gravity),
        ("arm-turn-speed", Self::ArmTurn(Law::Speed)),
        ("arm-turn-load", Self::ArmTurn(Law::Load)),
        ("seat-radius", Self::SeatRadius),
        ("seat-lateral", Self::SeatLateral),
        ("position-shift", Self::PositionShift),
        ("mounting-shift", Self::MountingShift),
        ("mounting-turn", Self::MountingTurn),
        ("mounting-tilt", Self::MountingTilt),
        ("angle-tilt", Self::AngleTilt),
        ("mounting-bias", Self::MountingBias),
        ("mounting-scale", Self::MountingScale),
        ("rests-bias", Self::RestsBias),
        ("rests-scale", Self::RestsScale),
        ("rests-unit", Self::RestsUnit),
        ("rests-tilt", Self::RestsTilt),
        ("attitudes-tilt", Self::AttitudesTilt),
        ("spin-turn", Self::SpinTurn),
        ("proof-masses", Self::ProofMasses),
        ("spin-step", Self::Disturbance(Course::Spinning)),
        ("spin-speed", Self::Disturbance(Course::Speed)),
        ("spin-square", Self::Disturbance(Course::SquaredSpeed)),
        ("spin-fourth", Self::Disturbance(Course::FourthPowerOfSpeed)),
        ("own-rate", Self::Disturbance(Course::OwnRate)),
        ("yield", Self::Disturbance(Course::Yield)),
        ("bias-drift", Self::Disturbance(Course::Time)),
        ("bias-wander", Self::BiasWander),
        ("scale-drift", Self::Disturbance(Course::TimeScale)),
        ("warm-up", Self::Disturbance(Course::WarmUp)),
        ("warm-up-scale", Self::Disturbance(Course::WarmUpScale)),
        ("heating-speed", Self::Disturbance(Course::Heat(Law::Speed))),
        ("heating-load", Self::Disturbance(Course::Heat(Law::Load))),
        ("rise-fall", Self::Disturbance(Course::Rise)),
        ("memory", Self::Disturbance(Course::Memory)),
        ("hysteresis", Self::Disturbance(Course::Turn)),
    ];

    /// The extension of a name: one of [`Extension::NAMED`], or that of one mounting, set speed or plateau, counted from 1: `other-unit[7]`.
    pub fn named(name: &str) -> Option<Self> {
        let of_session = Self::NAMED.iter().find(|(known, _)| *known == name).map(|(_, extension)| *extension);
        let of_one = || {
            let (stem, number) = name.strip_suffix(']')?.split_once('[')?;
            let index = number.parse::<usize>().ok()?.checked_sub(1)?;
            let difference = Difference::NAMED.iter().find(|(known, _)| *known == stem);
            let of_mounting = difference.map(|(_, difference)| Self::OneMounting(*difference, index));
            of_mounting.or(match stem {
                ONE_SPEED => Some(Self::OneSpeed(index)),
                RESONANCE => Some(Self::Resonance(index)),
                BIAS_STEP => Some(Self::Disturbance(Course::From(index))),
                _ => None,
            })
        };
        of_session.or_else(of_one)
    }

    /// Its name as written in sessions and plans.
    pub fn name(self) -> String {
        let of_one = |stem: &str, index: usize| format!("{stem}[{}]", index + 1);
        match self {
            Self::OneMounting(difference, mounting) => {
                let mut named = Difference::NAMED.iter();
                of_one(named.find(|(_, known)| *known == difference).map_or("", |(name, _)| name), mounting)
            }
            Self::OneSpeed(speed) => of_one(ONE_SPEED, speed),
            Self::Resonance(speed) => of_one(RESONANCE, speed),
            Self::Disturbance(Course::From(first)) => of_one(BIAS_STEP, first),
            _ => Self::NAMED.iter().find(|(_, extension)| *extension == self).map_or("", |(name, _)| name).to_owned(),
        }
    }

    /// The numbers, from 1, that one of a mounting on the arm, of a set speed or of a plateau can have in `experiment`.
    pub fn numbers(self, experiment: &Experiment) -> Option<RangeInclusive<usize>> {
        match self {
            Self::OneMounting(..) => Some(1..=experiment.mountings_on_arm().count()),
            Self::OneSpeed(_) | Self::Resonance(_) => Some(1..=experiment.set_speeds().len()),
            Self::Disturbance(Course::From(_)) => Some(2..=experiment.set_points.len()),
            _ => None,
        }
    }

    /// Its unknowns in `experiment` beside an error model; none where the experiment has nothing that it could act on.
    pub fn parameters(self, experiment: &Experiment, error_model: &ErrorModel) -> Vec<Parameter> {
        match self {
            Self::ElasticTurn(law) => by_position(experiment, |axis, position, id| {
                let name = format!("elastic_{}_{}[{id}]", law.name(), axis + 1);
                per_law(name, Group::ElasticTurn, law, Effect::ElasticTurn { law, axis, position })
            }),
            Self::ArmStretch(law) => vec![stretch(format!("stretch_{}", law.name()), law, None)],
            Self::SeatStretch(law) => seats(experiment)
                .map(|(seat, radius)| stretch(format!("stretch_{}[{radius}]", law.name()), law, Some(seat)))
                .collect(),
            Self::RadiusScale => {
                vec![effect("radius_scale".to_owned(), "1", Group::RadiusScale, Effect::RadiusScale, 1e-3)]
            }
            Self::SpeedScale => {
                vec![effect("speed_scale".to_owned(), "1", Group::SpeedScale, Effect::SpeedScale, 1e-3)]
            }
            Self::SpeedOffset => {
                vec![effect("speed_offset".to_owned(), "rad/s", Group::SpeedOffset, Effect::SpeedOffset, 1e-3)]
            }
            Self::EarthRate if experiment.site.latitude.is_some() => Vec::new(),
            Self::EarthRate => {
                vec![effect("earth_rate".to_owned(), "rad/s", Group::EarthRate, Effect::EarthRate, Site::EARTH_RATE)]
            }
            Self::Gravity => vec![effect("gravity".to_owned(), "m/s^2", Group::Gravity, Effect::Gravity, 1e-3)],
            Self::ArmTurn(law) => three(|axis| {
                let name = format!("arm_turn_{}_{}", law.name(), axis + 1);
                per_law(name, Group::ArmTurn, law, Effect::ArmTurn { law, axis })
            }),
            Self::SeatRadius => seat_places(experiment, "seat_radius", 0),
            Self::SeatLateral => seat_places(experiment, "seat_lateral", 1),
            Self::PositionShift => position_shifts(experiment),
            Self::MountingShift => {
                let shared = |a: usize, b: usize| shares_shift(experiment, a, b);
                by_mounting(experiment, 2, shared, mounting_shift)
            }
            Self::MountingTurn => {
                let shared = |a: usize, b: usize| experiment.mountings[a].position == experiment.mountings[b].position;
                by_mounting(experiment, 3, shared, mounting_turn)
            }
            Self::MountingTilt => by_mounting(
                experiment,
                2,
                |_, _| true,
                |axis, mounting| {
                    let name = format!("mounting_tilt_{}[{}]", axis + 1, mounting + 1);
                    effect(name, "rad", Group::MountingTilt, Effect::MountingTilt { axis, mounting }, 1e-3)
                },
            ),
            Self::AngleTilt => angle_tilts(experiment),
            Self::MountingBias => by_mounting(experiment, 3, |_, _| true, mounting_bias),
            Self::MountingScale => by_mounting(experiment, 3, |_, _| true, mounting_scale),
            Self::RestsBias => of_rests(experiment, error_model, "rests_bias", |monomial, _| monomial.degree() == 0),
            Self::RestsScale => {
                of_rests(experiment, error_model, "rests_scale", |monomial, axis| *monomial == Monomial::power(axis, 1))
            }
            Self::RestsUnit => of_rests(experiment, error_model, "rests_unit", |monomial, _| monomial.degree() == 1),
            Self::RestsTilt => rest_tilts(experiment),
            Self::AttitudesTilt => attitude_tilts(experiment),
            Self::SpinTurn => by_position(experiment, |axis, position, id| {
                let name = format!("spin_turn_{}[{id}]", axis + 1);
                effect(name, "rad", Group::SpinTurn, Effect::SpinTurn { axis, position }, 1e-3)
            }),
            Self::ProofMasses => coordinates(experiment),
            Self::Disturbance(Course::From(first)) if first == 0 || first >= experiment.set_points.len() => Vec::new(),
            Self::Disturbance(Course::From(first)) => {
                let name = |axis: usize| format!("bias_step_{}[{}]", axis + 1, first + 1);
                three(|axis| disturbance(name(axis), axis, Course::From(first)))
            }
            Self::Disturbance(course) => {
                let stem = self.name().replace('-', "_");
                three(|axis| disturbance(format!("{stem}_{}", axis + 1), axis, course))
            }
            Self::BiasWander => {
                let of_degree = |degree: u8| {
                    let name = move |axis: usize| format!("bias_wander_{degree}_{}", axis + 1);
                    three(|axis| disturbance(name(axis), axis, Course::Wander(degree)))
                };
                (1..=3).flat_map(of_degree).collect()
            }
            Self::OneSpeed(speed) => of_set_speed(experiment, speed, |first| {
                let name = format!("one_speed[{}]", speed + 1);
                vec![effect(name, "1", Group::SpeedScale, Effect::OneSpeed { first }, 1e-3)]
            }),
            Self::Resonance(speed) => of_set_speed(experiment, speed, |first| {
                let name = |axis: usize| format!("resonance_{}[{}]", axis + 1, speed + 1);
                three(|axis| disturbance(name(axis), axis, Course::AtSpeedOf(first)))
            }),
            Self::OneMounting(_, mounting) if mounting >= experiment.mountings.len() => Vec::new(),
            Self::OneMounting(_, mounting) if !experiment.is_on_arm(mounting) => Vec::new(),
            Self::OneMounting(Difference::Shift, mounting) => {
                (0..2).map(|axis| mounting_shift(axis, mounting)).collect()
            }
            Self::OneMounting(Difference::Turn, mounting) => three(|axis| mounting_turn(axis, mounting)),
            Self::OneMounting(Difference::Unit, mounting) => {
                error_model.terms.iter().map(|term| other_unit(term, mounting)).collect()
            }
        }
    }
}

/// Unknowns of a set speed, by the index of its first set point; none where the experiment has fewer speeds.
fn of_set_speed(
    experiment: &Experiment,
    speed: usize,
    unknowns: impl FnOnce(usize) -> Vec<Parameter>,
) -> Vec<Parameter> {
    experiment.set_speeds().get(speed).map_or_else(Vec::new, |(first, _)| unknowns(*first))
}

/// Names of the extensions of one set speed and of one plateau, before its number.
const RESONANCE: &str = "resonance";
const ONE_SPEED: &str = "one-speed";
const BIAS_STEP: &str = "bias-step";

impl Difference {
    const NAMED: [(&'static str, Self); 3] =
        [("one-mounting-shift", Self::Shift), ("one-mounting-turn", Self::Turn), ("other-unit", Self::Unit)];
}
