//! The measurement model: an experiment, the unit's error model, and the unknowns that follow from the two.

use nalgebra::Matrix3;

use super::course::Course;
use super::effect::Effect;
use super::error_model::{ErrorModel, Extra};
use super::experiment::{Experiment, SetPoint};
use super::extension::{Difference, Extension};
use super::frame::carousel;
use super::history;
use super::parameters::Parameters;
use super::prior::{self, Prior, PriorError};
use super::rival::Rival;
use super::stated::{Influence, TypeB};

/// Mountings that are asked one by one whether they differ from the others: each brings two dozen unknowns to be tried.
const MOST_SINGLE: usize = 100;

/// Unknowns of a rival at most: its test takes time with their cube, and memory with their square.
const MOST_UNKNOWNS: usize = 3 * MOST_SINGLE;

/// An experiment, the unit's error model, and the unknowns that follow from the two.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasurementModel {
    pub(super) experiment: Experiment,
    pub(super) error_model: ErrorModel,
    extensions: Vec<Extension>,
    pub(super) parameters: Parameters,
    priors: Vec<Prior>,
    stated: TypeB,
    influences: Vec<Influence>,
    /// What the influences are off by, in standard uncertainties; empty when they are not.
    deviations: Vec<f64>,
    /// Turns of the carousel over which a reading is averaged while spinning.
    pub(super) revolution: Vec<Matrix3<f64>>,
}

impl MeasurementModel {
    /// Model of `experiment` with the unknowns of [K5.4] and `extensions`, and priors of the attitudes that the experiment knows.
    pub fn new(mut experiment: Experiment, error_model: ErrorModel, extensions: &[Extension]) -> Self {
        history::fill(&mut experiment);
        let parameters = Parameters::new(&experiment, &error_model, extensions);
        let priors = prior::of_known_attitudes(&experiment, &parameters);
        let revolution = revolution(&error_model);
        Self {
            experiment,
            error_model,
            extensions: extensions.to_vec(),
            parameters,
            priors,
            stated: TypeB::default(),
            influences: Vec::new(),
            deviations: Vec::new(),
            revolution,
        }
    }

    /// The same unit, extensions and priors in another experiment. A prior on a parameter that the other experiment
    /// does not have falls away.
    #[must_use]
    pub fn in_experiment(&self, experiment: Experiment) -> Self {
        self.carried_to(Self::new(experiment, self.error_model.clone(), &self.extensions))
    }

    /// The same experiment, extensions and priors with another error model. A prior about zero on a coefficient that it lacks falls away; `None`
    /// where such a prior is about another value, which zero contradicts: the chi^2 of both would not be of the same data.
    pub(crate) fn with_error_model(&self, error_model: ErrorModel) -> Option<Self> {
        let other = Self::new(self.experiment.clone(), error_model, &self.extensions);
        let is_kept = |prior: &Prior| other.parameters.find(&self.parameters[prior.parameter].name).is_some();
        let is_same = self.priors.iter().all(|prior| prior.mean == 0.0 || is_kept(prior));
        is_same.then(|| self.carried_to(other))
    }

    /// The model with what the laboratory states of the quantities that it takes as exact.
    #[must_use]
    pub fn with_stated(mut self, stated: TypeB) -> Self {
        self.influences = stated.influences(&self.experiment, &self.error_model);
        self.stated = stated;
        self
    }

    /// The model as it is if its influences are off by `deviations` standard uncertainties, in their order.
    #[must_use]
    pub fn deviated(mut self, deviations: Vec<f64>) -> Self {
        self.deviations = deviations;
        self
    }

    /// The rivals that the model leaves out, neither unknown nor stated: of the session, of each of its mountings, and of each speed that is set
    /// more than once and not measured. Where there are more than a hundred mountings, or speeds, single ones are not asked for. Rests alone are
    /// asked for a step before each of up to a hundred, and a wander of the biases: on an arm each mounting is asked. They are
    /// not asked for squares and further terms of third degree of other components: at 1 g errors of the attitudes look like them and are far
    /// larger.
    pub fn left_out(&self) -> Vec<Rival> {
        let common = Rival::COMMON.into_iter().zip(self.stated.effects).filter(|(_, u)| *u == 0.0);
        let of_mounting = |mounting: usize| {
            let differences = [Difference::Shift, Difference::Turn, Difference::Unit];
            differences.map(|difference| Rival::Effect(Extension::OneMounting(difference, mounting)))
        };
        let count = self.experiment.mountings_on_arm().count();
        let mountings = self.experiment.mountings_on_arm().filter(|_| count <= MOST_SINGLE).flat_map(of_mounting);
        let speeds = self.experiment.set_speeds();
        let of_speed = |k: usize| [Extension::OneSpeed(k), Extension::Resonance(k)].map(Rival::Effect);
        let is_asked = |k: &usize| speeds.len() <= MOST_SINGLE && speeds[*k].1 > 1;
        let speeds = (0..speeds.len()).filter(is_asked).flat_map(of_speed);
        let has_arm = self.experiment.has_arm();
        let plateaus = self.experiment.set_points.len();
        let steps = (1..plateaus).filter(|_| !has_arm && plateaus <= MOST_SINGLE);
        let step = |first: usize| Rival::Effect(Extension::Disturbance(Course::From(first)));
        let is_of_other = |rival: &Rival| match rival {
            Rival::Terms(Extra::CrossSquares | Extra::CrossCubes | Extra::CubicProducts) => !has_arm,
            Rival::Effect(Extension::BiasWander) => has_arm,
            _ => false,
        };
        let is_small = |rival: &Rival| rival.parameters(&self.experiment, &self.error_model).len() <= MOST_UNKNOWNS;
        let common = common.map(|(rival, _)| rival).filter(|rival| !is_of_other(rival)).filter(is_small);
        let all = common.chain(mountings).chain(speeds).chain(steps.map(step));
        all.filter(|rival| !rival.is_in(&self.error_model, &self.extensions)).collect()
    }

    /// The model with `rivals` as unknowns: terms behind those of the error model, effects behind the extensions.
    #[must_use]
    pub fn with_rivals(&self, rivals: &[Rival]) -> Self {
        let (mut error_model, mut extensions) = (self.error_model.clone(), self.extensions.clone());
        for rival in rivals {
            rival.add_to(&mut error_model, &mut extensions);
        }
        self.carried_to(Self::new(self.experiment.clone(), error_model, &extensions))
    }

    fn carried_to(&self, mut other: Self) -> Self {
        let renamed = |prior: &Prior| {
            let parameter = other.parameters.find(&self.parameters[prior.parameter].name)?;
            Some(Prior { parameter, ..*prior })
        };
        let own = std::mem::take(&mut other.priors);
        let carried: Vec<Prior> = self.priors.iter().filter_map(renamed).collect();
        let is_carried = |own: &Prior| carried.iter().any(|prior| prior.parameter == own.parameter);
        let further: Vec<Prior> = own.into_iter().filter(|own| !is_carried(own)).collect();
        other.priors = [carried, further].concat();
        other.with_stated(self.stated)
    }

    /// The model with a prior of `standard_uncertainty` [the unit of the parameter] about zero on every parameter that
    /// `name` selects (see [`Parameters::select`]).
    ///
    /// # Errors
    /// [`PriorError`] when there is no such parameter, when the selected ones differ in unit, when one of them has a
    /// prior already, or when the uncertainty is not a positive number.
    pub fn with_prior(self, name: &str, standard_uncertainty: f64) -> Result<Self, PriorError> {
        self.with_prior_about(name, 0.0, standard_uncertainty)
    }

    /// [`MeasurementModel::with_prior`] about a `mean` that was measured.
    ///
    /// # Errors
    /// As [`MeasurementModel::with_prior`]; and when the mean is not finite.
    pub fn with_prior_about(mut self, name: &str, mean: f64, standard_uncertainty: f64) -> Result<Self, PriorError> {
        let priors = prior::select(&self.parameters, &self.priors, name, mean, standard_uncertainty)?;
        self.priors.extend(priors);
        Ok(self)
    }

    /// What is known beforehand.
    pub fn experiment(&self) -> &Experiment {
        &self.experiment
    }

    /// The unit's error model.
    pub fn error_model(&self) -> &ErrorModel {
        &self.error_model
    }

    /// The unknowns.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// The unknowns beyond the source's.
    pub fn extensions(&self) -> &[Extension] {
        &self.extensions
    }

    /// What the laboratory states.
    pub fn stated(&self) -> &TypeB {
        &self.stated
    }

    /// The same as independent influences on more than one plateau.
    pub fn influences(&self) -> &[Influence] {
        &self.influences
    }

    /// Effects that are there without being unknowns: the influences that are off, with their amounts.
    pub(super) fn deviating(&self) -> impl Iterator<Item = (Effect, f64)> + '_ {
        let pairs = self.influences.iter().zip(&self.deviations);
        pairs.map(|(influence, deviation)| (influence.effect, deviation * influence.standard_uncertainty))
    }

    /// Standard uncertainty of a plateau's own rounding [m/s^2].
    pub(super) fn own_rounding(&self, set_point: &SetPoint) -> f64 {
        self.stated.own_rounding(set_point)
    }

    /// The first set point whose reading is the same function of the unknowns, for each set point. Each stands alone where an unknown
    /// or a stated uncertainty follows the order of the session.
    pub(crate) fn alike(&self) -> Vec<usize> {
        let unknown = self.parameters.effects().map(|(_, effect)| effect);
        let mut effects = unknown.chain(self.influences.iter().map(|influence| influence.effect));
        let set_points = &self.experiment.set_points;
        if effects.any(Effect::is_of_history) { (0..set_points.len()).collect() } else { history::alike(set_points) }
    }

    /// What is known of the unknowns beforehand.
    pub fn priors(&self) -> &[Prior] {
        &self.priors
    }
}

/// Equal steps of the carousel over which the mean of every monomial is exact: one more than its degree.
fn revolution(error_model: &ErrorModel) -> Vec<Matrix3<f64>> {
    let degree = error_model.terms.iter().map(|t| t.monomial.degree()).max().unwrap_or(0).max(2);
    let steps = f64::from(degree) + 1.0;
    (0..=degree).map(|n| carousel(std::f64::consts::TAU * f64::from(n) / steps)).collect()
}
