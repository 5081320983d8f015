//! The unknowns of extensions in an experiment.

use centrical_compensate::Monomial;

use super::course::{BIAS, Course, Facts, Law};
use super::effect::{Effect, Scope};
use super::error_model::{ErrorModel, Term};
use super::experiment::{Experiment, PairRelation};
use super::group::Group;
use super::parameter::{Kind, Parameter, coefficient, parameter};

pub fn mounting_shift(axis: usize, mounting: usize) -> Parameter {
    let name = format!("mounting_shift_{}[{}]", axis + 1, mounting + 1);
    effect(name, "m", Group::MountingShift, Effect::MountingShift { axis, mounting }, 5e-4)
}

pub fn mounting_turn(axis: usize, mounting: usize) -> Parameter {
    let name = format!("mounting_turn_{}[{}]", axis + 1, mounting + 1);
    effect(name, "rad", Group::MountingTurn, Effect::MountingTurn { axis, mounting }, 1e-3)
}

/// The bias of a newtonometer in one mounting [m/s^2].
pub fn mounting_bias(axis: usize, mounting: usize) -> Parameter {
    let name = format!("mounting_bias_{}[{}]", axis + 1, mounting + 1);
    effect(name, "m/s^2", Group::MountingBias, Effect::bias_of_mounting(axis, mounting), BIAS)
}

/// The scale of a newtonometer in one mounting, relative.
pub fn mounting_scale(axis: usize, mounting: usize) -> Parameter {
    let name = format!("mounting_scale_{}[{}]", axis + 1, mounting + 1);
    effect(name, "1", Group::MountingScale, Effect::scale_of_mounting(axis, mounting), 1e-3)
}

pub fn other_unit(term: &Term, mounting: usize) -> Parameter {
    let Term { axis, monomial, .. } = *term;
    let name = format!("{}[{}]", term.name, mounting + 1);
    let effect = Effect::Monomial { axis, monomial, scope: Scope::Mounting(mounting) };
    Parameter { name, kind: Kind::Effect(effect), ..coefficient(term) }
}

/// The terms of the error model that are `asked` for, with their axes, in the rests of each switch-on but the reference.
pub fn of_rests(
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
pub fn angle_tilts(experiment: &Experiment) -> Vec<Parameter> {
    let angles = experiment.rest_angles();
    let tilts = |n: usize, first: usize| {
        tilts("angle_tilt", &(n + 1).to_string(), Group::AngleTilt, |axis| Effect::AngleTilt { axis, first })
    };
    angles.into_iter().enumerate().skip(1).flat_map(|(n, (first, _))| tilts(n, first)).collect()
}

/// Two tilts for each rest in a known attitude.
pub fn rest_tilts(experiment: &Experiment) -> Vec<Parameter> {
    let tilts = |position: usize| {
        let id = &experiment.positions[position].id;
        tilts("rest_tilt", id, Group::Attitude, |axis| Effect::RestTilt { axis, position })
    };
    in_known_attitudes(experiment).into_iter().flat_map(tilts).collect()
}

/// Two tilts for each known attitude of several rests.
pub fn attitude_tilts(experiment: &Experiment) -> Vec<Parameter> {
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
pub fn disturbance(name: String, axis: usize, follows: Course) -> Parameter {
    let Facts { unit, typical, .. } = follows.facts();
    effect(name, unit, Group::Disturbance, Effect::Disturbance { axis, follows }, typical)
}

/// The coordinates of proof masses that are taken as exact [m].
pub fn coordinates(experiment: &Experiment) -> Vec<Parameter> {
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
pub fn by_position(experiment: &Experiment, unknown: impl Fn(usize, usize, &str) -> Parameter) -> Vec<Parameter> {
    let on_arm = experiment.positions.iter().enumerate().filter(|(_, position)| !position.is_free);
    on_arm
        .flat_map(|(k, position)| (0..3).map(move |axis| (axis, k, &position.id)))
        .map(|(axis, k, id)| unknown(axis, k, id))
        .collect()
}

/// Unknowns for each mounting that is not the first of those it is `shared` with.
pub fn by_mounting(
    experiment: &Experiment,
    axes: usize,
    shared: impl Fn(usize, usize) -> bool,
    unknown: impl Fn(usize, usize) -> Parameter,
) -> Vec<Parameter> {
    let on_arm = |m: &usize| experiment.is_on_arm(*m);
    let further = experiment.mountings_on_arm().filter(|&m| (0..m).filter(on_arm).any(|first| shared(first, m)));
    further.flat_map(|m| (0..axes).map(move |axis| (axis, m))).map(|(axis, m)| unknown(axis, m)).collect()
}

pub fn shares_shift(experiment: &Experiment, a: usize, b: usize) -> bool {
    let [one, other] = [a, b].map(|m| experiment.mountings[m].position);
    one == other
        || (experiment.pair_relation != PairRelation::Free
            && experiment.positions[one].pair == experiment.positions[other].pair)
}

/// Displacements of every position that has the `dR` of another.
pub fn position_shifts(experiment: &Experiment) -> Vec<Parameter> {
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
pub fn seats(experiment: &Experiment) -> impl Iterator<Item = (usize, f64)> + '_ {
    experiment.seats().map(|m| (m, experiment.mountings[m].arm_y.x))
}

/// A displacement of every seat but the first.
pub fn seat_places(experiment: &Experiment, stem: &str, axis: usize) -> Vec<Parameter> {
    let place = |(seat, radius): (usize, f64)| {
        let name = format!("{stem}[{radius}]");
        effect(name, "m", Group::Seat, Effect::SeatPlace { axis, seat: Some(seat) }, 5e-4)
    };
    seats(experiment).skip(1).map(place).collect()
}

pub fn three(unknown: impl Fn(usize) -> Parameter) -> Vec<Parameter> {
    (0..3).map(unknown).collect()
}

pub fn stretch(name: String, law: Law, seat: Option<usize>) -> Parameter {
    per_law(name, Group::ArmStretch, law, Effect::ArmStretch { law, seat })
}

/// A deformation per unit of its law.
pub fn per_law(name: String, group: Group, law: Law, deformation: Effect) -> Parameter {
    let power_of_acceleration = if law == Law::Load { -1 } else { 0 };
    let unknown = effect(name, law.unit_of_inverse(), group, deformation, 1e-3 / law.full_scale());
    Parameter { power_of_acceleration, ..unknown }
}

pub fn effect(name: String, unit: &str, group: Group, effect: Effect, typical: f64) -> Parameter {
    parameter(name, unit, group, Kind::Effect(effect), typical)
}
