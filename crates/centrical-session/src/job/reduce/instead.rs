//! What the record of a mounting should show; and what one fits instead: files or entries that are exchanged, a unit that was turned.

use centrical::Experiment;
use centrical::reduction::{ReductionError, ScheduledPlateau, Survey};
use nalgebra::{Matrix3, Vector3};

use crate::error::Instead;
use crate::experiment::{Session, axes_text};

/// What else has all plateaus of a record that was refused by its levels: another mounting of its session, another place, or another attitude; of
/// several the likeliest.
pub(crate) fn fits_instead(
    session: &Session,
    number: usize,
    survey: &Survey,
    refused: &ReductionError,
) -> Option<Instead> {
    if !matches!(refused, ReductionError::PlateauNotFound { .. } | ReductionError::Mistaken { .. }) {
        return None;
    }
    let experiment = &session.experiment;
    let likelihood = |schedule: Vec<ScheduledPlateau>| survey.locate(&schedule).ok()?.log_likelihood();
    let all = mountings(experiment, number).chain(places(experiment, number)).chain(attitudes(experiment, number));
    let fit = all.filter_map(|(instead, schedule)| Some((instead, likelihood(schedule)?)));
    let likelier = |best: (Instead, f64), next: (Instead, f64)| if next.1 > best.1 { next } else { best };
    fit.reduce(likelier).map(|(instead, _)| instead)
}

/// The first mounting of a session in each other position and place, with its plateaus.
fn mountings(experiment: &Experiment, number: usize) -> impl Iterator<Item = (Instead, Vec<ScheduledPlateau>)> {
    let all = &experiment.mountings;
    let is_other = move |k: usize| all[k] != all[number] && !all[..k].contains(&all[k]);
    all.iter().enumerate().filter(move |(k, _)| is_other(*k)).map(|(other, mounting)| {
        let position = experiment.positions[mounting.position].id.clone();
        let instead = Instead::Mounting { number: other + 1, position, arm: mounting.arm_y.into() };
        (instead, ScheduledPlateau::of_mounting(experiment, other))
    })
}

/// The other places of a session, with the plateaus that a mounting would have there.
fn places(experiment: &Experiment, number: usize) -> impl Iterator<Item = (Instead, Vec<ScheduledPlateau>)> {
    let all = &experiment.mountings;
    let is_first = move |k: usize| !all[..k].iter().any(|before| before.arm_y == all[k].arm_y);
    let others = (0..all.len()).filter(move |k| is_first(*k) && all[*k].arm_y != all[number].arm_y);
    others.map(move |other| {
        let arm_y = all[other].arm_y;
        let mut experiment = experiment.clone();
        experiment.mountings[number].arm_y = arm_y;
        (Instead::Arm { arm: arm_y.into() }, ScheduledPlateau::of_mounting(&experiment, number))
    })
}

/// The 24 attitudes with every instrument axis along an arm axis, with the plateaus that a mounting would have in them.
fn attitudes(experiment: &Experiment, number: usize) -> impl Iterator<Item = (Instead, Vec<ScheduledPlateau>)> {
    let along = |k: usize| Vector3::ith(k / 2, if k.is_multiple_of(2) { 1.0 } else { -1.0 });
    let pairs = (0..36).map(move |k| (along(k / 6), along(k % 6))).filter(|(first, second)| first.dot(second) == 0.0);
    pairs.map(move |(first, second)| {
        let rows = [first, second, first.cross(&second)];
        let p_zy = Matrix3::from_rows(&rows.map(|row| row.transpose()));
        let mut experiment = experiment.clone();
        let position = experiment.mountings[number].position;
        experiment.positions[position].p_zy = p_zy;
        let axes = axes_text(&rows.map(|row| (row.iamax(), row.sum())));
        (Instead::Attitude { axes }, ScheduledPlateau::of_mounting(&experiment, number))
    })
}
