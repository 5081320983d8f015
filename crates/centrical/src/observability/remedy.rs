//! Remedies: additions to an experiment of short rank, tried one by one, and those that help, cheapest first.

use std::cmp::Reverse;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Matrix3, Vector3};

use super::addition::{Addition, new_id};
use super::rank::Observability;
use super::study::Study;
use crate::model::{Effect, Kind, PairRelation, Position, rotation};

/// Two angles, speeds or radii closer than this part of the largest are one: a schedule's "180 deg" is not a new angle
/// beside 3.1416 rad.
const SAME: f64 = 1e-3;

/// A dimension that is measured on purpose is known this much better than its kind usually is.
const MEASURED: f64 = 0.1;

/// Longest chain of additions: what needs more is another experiment.
const LONGEST_CHAIN: usize = 6;

/// Additions that raise the rank.
#[derive(Debug, Clone, PartialEq)]
pub struct Remedy {
    /// One or several additions in order.
    pub steps: Vec<Step>,
    /// What is seen after the last.
    pub after: Observability,
}

/// One addition of a remedy.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// What is added.
    pub addition: Addition,
    /// Number of lost combinations that it brings back.
    pub gain: usize,
    /// The addition in words.
    pub text: String,
}

impl Remedy {
    /// Whether nothing is lost any more after the last step.
    pub fn restores_rank(&self) -> bool {
        self.after.lost() == 0
    }

    /// Cost of the dearest step, then the number of steps and what they take.
    fn cost(&self) -> (u8, usize, usize) {
        let costs = self.steps.iter().map(|step| step.addition.cost());
        let dearest = costs.clone().map(|(kind, _)| kind).max().unwrap_or(0);
        (dearest, self.steps.len(), costs.map(|(_, count)| count).sum())
    }
}

impl Study {
    /// Remedies for a rank that is short: those that restore it cheapest first (see [`Addition`] for the order), then
    /// those that only raise it. Empty when nothing is lost or nothing in the catalogue helps.
    ///
    /// Of rests in free attitudes alone the catalogue is the best next attitude. Otherwise: rest at another angle and another speed (in one mounting if that does, otherwise in all), a prior
    /// on one dimension of each lost combination, another radius (in one position or in all), another position, another
    /// pair relation. When no single addition restores the rank, or only another pair relation, additions are chained,
    /// each the one that gains most and among these the cheapest, up to six.
    pub fn remedies(&self) -> Vec<Remedy> {
        if self.observability().lost() == 0 {
            return Vec::new();
        }
        let mut trials = self.helpful();
        let chain = (!trials.iter().any(|trial| trial.after.observability().lost() == 0)).then(|| self.chain(&trials));
        let relations = if self.model().experiment().has_arm() { relations(self) } else { Vec::new() };
        trials.extend(relations.into_iter().filter_map(|relation| Trial::of(self, relation)));
        let mut remedies: Vec<Remedy> = trials.into_iter().map(|trial| trial.into_remedy(self)).collect();
        remedies.extend(chain.flatten());
        remedies.sort_by_key(|remedy| (!remedy.restores_rank(), remedy.cost()));
        remedies
    }

    /// Additions one after another, from one of `first`, until nothing is lost or nothing helps; `None` when it would
    /// be one step or none.
    fn chain(&self, first: &[Trial]) -> Option<Remedy> {
        let mut remedy = best(first)?.clone().into_remedy(self);
        let mut study = best(first)?.after.clone();
        while remedy.steps.len() < LONGEST_CHAIN
            && let Some(next) = best(&study.helpful())
        {
            remedy.steps.push(next.step(&study));
            study = next.after.clone();
        }
        remedy.after = study.observability().clone();
        (remedy.steps.len() > 1).then_some(remedy)
    }

    /// Of each family of additions, which begins with the widest, the cheapest that gains as much as the widest.
    fn helpful(&self) -> Vec<Trial> {
        let of_family = |family: Vec<Addition>| {
            let mut family = family.into_iter();
            let widest = Trial::of(self, family.next()?)?;
            let narrower = family.filter_map(|addition| Trial::of(self, addition)).find(|t| t.gain == widest.gain);
            Some(narrower.unwrap_or(widest))
        };
        if self.observability().lost() == 0 {
            return Vec::new();
        }
        self.catalogue().into_iter().filter_map(of_family).collect()
    }

    /// Where nothing is on an arm, another attitude is all that there is to add.
    fn catalogue(&self) -> Vec<Vec<Addition>> {
        if !self.model().experiment().has_arm() {
            return self.next_attitude().into_iter().map(|next| vec![Addition::Attitude(next.up_z)]).collect();
        }
        let families = [new_angle(self), new_speed(self), new_radius(self)];
        let mut catalogue: Vec<Vec<Addition>> = families.into_iter().flatten().map(widest_first).collect();
        catalogue.extend(priors(self).into_iter().map(|prior| vec![prior]));
        catalogue.extend(best_position(self).map(|position| vec![position]));
        catalogue
    }
}

/// An addition that helps.
#[derive(Clone)]
struct Trial {
    addition: Addition,
    gain: usize,
    after: Study,
}

impl Trial {
    /// Tries an addition; `None` if it brings nothing back.
    fn of(study: &Study, addition: Addition) -> Option<Self> {
        let after = addition.apply(study).ok()?;
        let gain = study.observability().lost().checked_sub(after.observability().lost())?;
        (gain > 0).then_some(Self { addition, gain, after })
    }

    fn step(&self, before: &Study) -> Step {
        Step { addition: self.addition.clone(), gain: self.gain, text: self.addition.text(before) }
    }

    fn into_remedy(self, before: &Study) -> Remedy {
        Remedy { steps: vec![self.step(before)], after: self.after.observability().clone() }
    }
}

/// The trial that gains most, the cheapest and first of those that gain the same.
fn best(trials: &[Trial]) -> Option<&Trial> {
    trials.iter().min_by_key(|trial| (Reverse(trial.gain), trial.addition.cost()))
}

/// Rest in every mounting at an angle where nothing was read at rest: the quarter turn farthest from those.
pub(super) fn new_angle(study: &Study) -> Option<Addition> {
    if !study.model().experiment().has_arm() {
        return None;
    }
    let experiment = study.model().experiment();
    let read: Vec<f64> = experiment.set_points.iter().filter(|s| s.is_rest()).map(|s| s.angle).collect();
    let apart = |a: f64, b: f64| ((a - b + PI).rem_euclid(TAU) - PI).abs();
    let distance = |angle: f64| read.iter().map(|&other| apart(angle, other)).fold(PI, f64::min);
    let (angle, distance) = [0.0, PI, FRAC_PI_2, -FRAC_PI_2]
        .map(|angle| (angle, distance(angle)))
        .into_iter()
        .reduce(|best, next| if next.1 > best.1 + SAME { next } else { best })?;
    (distance > SAME).then(|| Addition::Rest { mountings: (0..experiment.mountings.len()).collect(), angle })
}

/// A speed in every mounting in the widest gap of `Omega^2` below the fastest; none when nothing spins.
pub(super) fn new_speed(study: &Study) -> Option<Addition> {
    let experiment = study.model().experiment();
    let middle = widest_gap(experiment.set_points.iter().map(|s| s.omega * s.omega))?;
    let omega = experiment.centrifuge.rotation.sign() * middle.sqrt();
    Some(Addition::Speed { mountings: (0..experiment.mountings.len()).collect(), omega })
}

/// A radius in every position in the widest gap below the largest; none when nothing is off the axis.
pub(super) fn new_radius(study: &Study) -> Option<Addition> {
    let experiment = study.model().experiment();
    let radius = widest_gap(experiment.mountings.iter().map(|m| m.arm_y.x.abs()))?;
    Some(Addition::Radius { positions: (0..experiment.positions.len()).collect(), radius })
}

/// Middle of the widest gap between zero and the values, the highest of equally wide ones.
fn widest_gap(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.chain([0.0]).collect();
    values.sort_by(f64::total_cmp);
    let largest = values.last().copied()?;
    let gaps = values.windows(2).map(|pair| (pair[1] - pair[0], 0.5 * (pair[0] + pair[1])));
    let widest = gaps.reduce(|best, next| if next.0 > best.0 - SAME * largest { next } else { best })?;
    (widest.0 > SAME * largest).then_some(widest.1)
}

/// The addition as it is, then in one mounting or position at a time.
fn widest_first(addition: Addition) -> Vec<Addition> {
    let narrower: Vec<Addition> = match &addition {
        Addition::Rest { mountings, angle } => {
            mountings.iter().map(|&m| Addition::Rest { mountings: vec![m], angle: *angle }).collect()
        }
        Addition::Speed { mountings, omega } => {
            mountings.iter().map(|&m| Addition::Speed { mountings: vec![m], omega: *omega }).collect()
        }
        Addition::Radius { positions, radius } => {
            positions.iter().map(|&k| Addition::Radius { positions: vec![k], radius: *radius }).collect()
        }
        _ => Vec::new(),
    };
    std::iter::once(addition).chain(narrower).collect()
}

/// A prior on one dimension of each lost combination: the one most easily measured. Never on the instrument, which
/// is what is being calibrated.
fn priors(study: &Study) -> Vec<Addition> {
    let parameters = study.model().parameters();
    let mut chosen: Vec<usize> = Vec::new();
    for direction in study.observability().null_directions() {
        let measurable = direction.terms().iter().filter_map(|&(j, _)| Some((ease(parameters[j].kind)?, j)));
        if let Some((_, j)) = measurable.filter(|(_, j)| !chosen.contains(j)).min() {
            chosen.push(j);
        }
    }
    let prior = |j: usize| Addition::Prior {
        parameter: parameters[j].name.clone(),
        standard_uncertainty: MEASURED * parameters[j].typical,
    };
    chosen.into_iter().map(prior).collect()
}

/// How easily a dimension is measured by other means, 0 easiest: a proof mass by the unit's drawing, a seat by a
/// coordinate machine, the tilt by a level, turns by an autocollimator, deformations by computation.
fn ease(kind: Kind) -> Option<u8> {
    match kind {
        Kind::ProofMass(_) => Some(0),
        Kind::Shift { .. } => Some(1),
        Kind::Tilt(_) => Some(2),
        Kind::Effect(
            Effect::RadiusScale
            | Effect::SpeedScale
            | Effect::SpeedOffset
            | Effect::OneSpeed { .. }
            | Effect::EarthRate
            | Effect::Gravity,
        ) => Some(3),
        Kind::Turn { .. } | Kind::CaseTurn(_) => Some(4),
        Kind::Effect(_) => Some(5),
        // Nothing but the unit itself shows how it lay in a hand.
        Kind::Term(_) | Kind::Attitude { .. } => None,
    }
}

/// The new position that gains most, the simplest of those that gain the same.
fn best_position(study: &Study) -> Option<Addition> {
    let additions = new_positions(study).into_iter().map(Addition::Position);
    let trials: Vec<Trial> = additions.filter_map(|addition| Trial::of(study, addition)).collect();
    best(&trials).map(|trial| trial.addition.clone())
}

/// The attitudes along the arm axes that the experiment has not, then each of its own turned by 45 deg about the arm
/// axes 3, 1 and 2.
fn new_positions(study: &Study) -> Vec<Position> {
    let known = &study.model().experiment().positions;
    let turned = (known.iter()).flat_map(|position| {
        [Vector3::z(), Vector3::x(), Vector3::y()].map(|axis| position.p_zy * rotation(&(axis * (0.25 * PI))))
    });
    let id = new_id(known);
    let mut attitudes: Vec<Matrix3<f64>> = known.iter().map(|position| position.p_zy).collect();
    let mut new = Vec::new();
    for p_zy in axis_attitudes().into_iter().chain(turned) {
        if attitudes.iter().all(|other| (other - p_zy).amax() > SAME) {
            attitudes.push(p_zy);
            new.push(Position::on_arm(id.clone(), p_zy, id.clone()));
        }
    }
    new
}

/// The 24 attitudes whose axes lie along the arm axes.
pub(super) fn axis_attitudes() -> Vec<Matrix3<f64>> {
    let axes: Vec<Vector3<f64>> = (0..3).flat_map(|j| [Vector3::ith(j, 1.0), Vector3::ith(j, -1.0)]).collect();
    let first_two = axes.iter().flat_map(|first| axes.iter().map(move |second| (first, second)));
    let right_handed = first_two.filter(|(first, second)| first.dot(second) == 0.0);
    right_handed
        .map(|(first, second)| {
            let rows = [first.transpose(), second.transpose(), first.cross(second).transpose()];
            Matrix3::from_rows(&rows)
        })
        .collect()
}

fn relations(study: &Study) -> Vec<Addition> {
    let present = study.model().experiment().pair_relation;
    let all = [PairRelation::Common, PairRelation::Opposite, PairRelation::Free];
    all.into_iter().filter(|relation| *relation != present).map(Addition::Relation).collect()
}
