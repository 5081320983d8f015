//! Effects as unknowns beyond the source's 49, each off by default.
//!
//! Where an effect belongs to a mounting, its unknowns are differences from the first mounting that shares the position (or
//! the shift): the shared unknown itself remains, and no direction is lost by counting it twice.

use centrical_compensate::Monomial;

use super::course::{BIAS, Course, Facts, Law};
use super::effect::{Effect, Scope};
use super::error_model::{ErrorModel, Term};
use super::experiment::{Experiment, PairRelation, Site};
use super::group::Group;
use super::parameter::{Kind, Parameter, coefficient, parameter};

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
    pub const NAMED: [(&'static str, Self); 41] = [
        ("elastic-turn-speed", Self::ElasticTurn(Law::Speed)),
        ("elastic-turn-load", Self::ElasticTurn(Law::Load)),
        ("arm-stretch-speed", Self::ArmStretch(Law::Speed)),
        ("arm-stretch-load", Self::ArmStretch(Law::Load)),
        ("seat-stretch-speed", Self::SeatStretch(Law::Speed)),
        ("seat-stretch-load", Self::SeatStretch(Law::Load)),
        ("radius-scale", Self::RadiusScale),
        ("speed-scale", Self::SpeedScale),
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
        ("yield", Self::Disturbance(Course::Yield)),
        ("bias-drift", Self::Disturbance(Course::Time)),
        ("bias-wander", Self::BiasWander),
        ("scale-drift", Self::Disturbance(Course::TimeScale)),
        ("warm-up", Self::Disturbance(Course::WarmUp)),
        ("warm-up-scale", Self::Disturbance(Course::WarmUpScale)),
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
                BIAS_STEP => Some(Self::Disturbance(Course::From(index))),
                _ => None,
            })
        };
        of_session.or_else(of_one)
    }

    /// Its name as written in sessions and plans.
    pub fn name(self) -> String {
        if let Self::OneMounting(difference, mounting) = self {
            let stem = Difference::NAMED.iter().find(|(_, known)| *known == difference).map_or("", |(name, _)| name);
            return format!("{stem}[{}]", mounting + 1);
        }
        if let Self::OneSpeed(speed) = self {
            return format!("{ONE_SPEED}[{}]", speed + 1);
        }
        if let Self::Disturbance(Course::From(first)) = self {
            return format!("{BIAS_STEP}[{}]", first + 1);
        }
        Self::NAMED.iter().find(|(_, extension)| *extension == self).map_or("", |(name, _)| name).to_owned()
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
            Self::OneSpeed(speed) => {
                let first = experiment.set_speeds().get(speed).map(|(first, _)| *first);
                let name = format!("one_speed[{}]", speed + 1);
                first
                    .map(|first| effect(name, "1", Group::SpeedScale, Effect::OneSpeed { first }, 1e-3))
                    .into_iter()
                    .collect()
            }
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

/// Names of the extensions of one set speed and of one plateau, before its number.
const ONE_SPEED: &str = "one-speed";
const BIAS_STEP: &str = "bias-step";

impl Difference {
    const NAMED: [(&'static str, Self); 3] =
        [("one-mounting-shift", Self::Shift), ("one-mounting-turn", Self::Turn), ("other-unit", Self::Unit)];
}

fn mounting_shift(axis: usize, mounting: usize) -> Parameter {
    let name = format!("mounting_shift_{}[{}]", axis + 1, mounting + 1);
    effect(name, "m", Group::MountingShift, Effect::MountingShift { axis, mounting }, 5e-4)
}

fn mounting_turn(axis: usize, mounting: usize) -> Parameter {
    let name = format!("mounting_turn_{}[{}]", axis + 1, mounting + 1);
    effect(name, "rad", Group::MountingTurn, Effect::MountingTurn { axis, mounting }, 1e-3)
}

/// The bias of a newtonometer in one mounting [m/s^2].
fn mounting_bias(axis: usize, mounting: usize) -> Parameter {
    let name = format!("mounting_bias_{}[{}]", axis + 1, mounting + 1);
    effect(name, "m/s^2", Group::MountingBias, Effect::bias_of_mounting(axis, mounting), BIAS)
}

/// The scale of a newtonometer in one mounting, relative.
fn mounting_scale(axis: usize, mounting: usize) -> Parameter {
    let name = format!("mounting_scale_{}[{}]", axis + 1, mounting + 1);
    effect(name, "1", Group::MountingScale, Effect::scale_of_mounting(axis, mounting), 1e-3)
}

fn other_unit(term: &Term, mounting: usize) -> Parameter {
    let Term { axis, monomial, .. } = *term;
    let name = format!("{}[{}]", term.name, mounting + 1);
    let effect = Effect::Monomial { axis, monomial, scope: Scope::Mounting(mounting) };
    Parameter { name, kind: Kind::Effect(effect), ..coefficient(term) }
}

/// The terms of the error model that are `asked` for, with their axes, in the rests of each switch-on but the reference.
fn of_rests(
    experiment: &Experiment,
    error_model: &ErrorModel,
    stem: &str,
    asked: impl Fn(&Monomial, usize) -> bool,
) -> Vec<Parameter> {
    let terms: Vec<&Term> = error_model.terms.iter().filter(|term| asked(&term.monomial, term.axis)).collect();
    let unknown = |number: usize, term: &Term| {
        let Term { axis, monomial, .. } = *term;
        let kind = Kind::Effect(Effect::Monomial { axis, monomial, scope: Scope::SwitchOn(number) });
        Parameter { name: format!("{stem}_{}[{number}]", term.name), kind, ..coefficient(term) }
    };
    let numbers = experiment.other_switch_ons().into_iter().map(|switch_on| switch_on.number);
    numbers.flat_map(|number| terms.iter().map(move |term| unknown(number, term))).collect()
}

/// Two tilts at every angle of rest but the first.
fn angle_tilts(experiment: &Experiment) -> Vec<Parameter> {
    let angles = experiment.rest_angles();
    let tilts = |n: usize, first: usize| {
        tilts("angle_tilt", &(n + 1).to_string(), Group::AngleTilt, |axis| Effect::AngleTilt { axis, first })
    };
    angles.into_iter().enumerate().skip(1).flat_map(|(n, (first, _))| tilts(n, first)).collect()
}

/// Two tilts for each rest in a known attitude.
fn rest_tilts(experiment: &Experiment) -> Vec<Parameter> {
    let tilts = |position: usize| {
        let id = &experiment.positions[position].id;
        tilts("rest_tilt", id, Group::Attitude, |axis| Effect::RestTilt { axis, position })
    };
    in_known_attitudes(experiment).into_iter().flat_map(tilts).collect()
}

/// Two tilts for each known attitude of several rests.
fn attitude_tilts(experiment: &Experiment) -> Vec<Parameter> {
    let (positions, known) = (&experiment.positions, in_known_attitudes(experiment));
    let share = |k: usize, others: &[usize]| others.iter().any(|&n| positions[n].shares_attitude(&positions[k]));
    let firsts = (0..known.len()).filter(|&i| !share(known[i], &known[..i]) && share(known[i], &known[i + 1..]));
    let tilts = |first: usize| {
        let id = &positions[first].id;
        tilts("attitude_tilt", id, Group::Attitude, |axis| Effect::AttitudeTilt { axis, first })
    };
    firsts.flat_map(|i| tilts(known[i])).collect()
}

/// Indices of the positions whose attitude is known.
fn in_known_attitudes(experiment: &Experiment) -> Vec<usize> {
    let positions = experiment.positions.iter().enumerate();
    positions.filter(|(_, position)| position.attitude_uncertainty.is_some()).map(|(k, _)| k).collect()
}

/// Tilts [rad] about both horizontal axes, named after a stem and what they are of.
fn tilts(stem: &str, of: &str, group: Group, tilt: impl Fn(usize) -> Effect) -> [Parameter; 2] {
    [0, 1].map(|axis| effect(format!("{stem}_{}[{of}]", axis + 1), "rad", group, tilt(axis), 1e-3))
}

/// A disturbance of one newtonometer.
fn disturbance(name: String, axis: usize, follows: Course) -> Parameter {
    let Facts { unit, typical, .. } = follows.facts();
    effect(name, unit, Group::Disturbance, Effect::Disturbance { axis, follows }, typical)
}

/// The coordinates of proof masses that are taken as exact [m].
fn coordinates(experiment: &Experiment) -> Vec<Parameter> {
    if !experiment.has_arm() {
        return Vec::new();
    }
    let all = (0..3).flat_map(|mass| (0..3).map(move |coordinate| (coordinate, mass)));
    let exact = all.filter(|&(coordinate, mass)| experiment.unit.is_coordinate_taken_as_exact(coordinate, mass));
    let unknown = |(coordinate, mass): (usize, usize)| {
        let name = format!("proof_mass_{}{}", coordinate + 1, mass + 1);
        effect(name, "m", Group::ProofMass, Effect::Coordinate { coordinate, mass }, 5e-4)
    };
    exact.map(unknown).collect()
}

/// An unknown for each instrument axis and position.
fn by_position(experiment: &Experiment, unknown: impl Fn(usize, usize, &str) -> Parameter) -> Vec<Parameter> {
    let on_arm = experiment.positions.iter().enumerate().filter(|(_, position)| !position.is_free);
    on_arm
        .flat_map(|(k, position)| (0..3).map(move |axis| (axis, k, &position.id)))
        .map(|(axis, k, id)| unknown(axis, k, id))
        .collect()
}

/// Unknowns for each mounting that is not the first of those it is `shared` with.
fn by_mounting(
    experiment: &Experiment,
    axes: usize,
    shared: impl Fn(usize, usize) -> bool,
    unknown: impl Fn(usize, usize) -> Parameter,
) -> Vec<Parameter> {
    let on_arm = |m: &usize| experiment.is_on_arm(*m);
    let further = experiment.mountings_on_arm().filter(|&m| (0..m).filter(on_arm).any(|first| shared(first, m)));
    further.flat_map(|m| (0..axes).map(move |axis| (axis, m))).map(|(axis, m)| unknown(axis, m)).collect()
}

fn shares_shift(experiment: &Experiment, a: usize, b: usize) -> bool {
    let [one, other] = [a, b].map(|m| experiment.mountings[m].position);
    one == other
        || (experiment.pair_relation != PairRelation::Free
            && experiment.positions[one].pair == experiment.positions[other].pair)
}

/// Displacements of every position that has the `dR` of another.
fn position_shifts(experiment: &Experiment) -> Vec<Parameter> {
    let positions = &experiment.positions;
    let is_further = |k: usize| {
        experiment.pair_relation != PairRelation::Free && (0..k).any(|first| positions[first].pair == positions[k].pair)
    };
    let unknown = |(axis, position): (usize, usize)| {
        let name = format!("position_shift_{}[{}]", axis + 1, positions[position].id);
        effect(name, "m", Group::Shift, Effect::PositionShift { axis, position }, 5e-4)
    };
    let further = (0..positions.len()).filter(|&k| is_further(k));
    further.flat_map(|k| (0..2).map(move |axis| (axis, k))).map(unknown).collect()
}

/// First mounting and radius [m] of each seat.
fn seats(experiment: &Experiment) -> impl Iterator<Item = (usize, f64)> + '_ {
    experiment.seats().map(|m| (m, experiment.mountings[m].arm_y.x))
}

/// A displacement of every seat but the first.
fn seat_places(experiment: &Experiment, stem: &str, axis: usize) -> Vec<Parameter> {
    let place = |(seat, radius): (usize, f64)| {
        let name = format!("{stem}[{radius}]");
        effect(name, "m", Group::Seat, Effect::SeatPlace { axis, seat: Some(seat) }, 5e-4)
    };
    seats(experiment).skip(1).map(place).collect()
}

fn three(unknown: impl Fn(usize) -> Parameter) -> Vec<Parameter> {
    (0..3).map(unknown).collect()
}

fn stretch(name: String, law: Law, seat: Option<usize>) -> Parameter {
    per_law(name, Group::ArmStretch, law, Effect::ArmStretch { law, seat })
}

/// A deformation per unit of its law.
fn per_law(name: String, group: Group, law: Law, deformation: Effect) -> Parameter {
    let power_of_acceleration = if law == Law::Load { -1 } else { 0 };
    let unknown = effect(name, law.unit_of_inverse(), group, deformation, 1e-3 / law.full_scale());
    Parameter { power_of_acceleration, ..unknown }
}

fn effect(name: String, unit: &str, group: Group, effect: Effect, typical: f64) -> Parameter {
    parameter(name, unit, group, Kind::Effect(effect), typical)
}
