//! Observability of an experiment, as a JSON document: schema `centrical-observability/1`. The same design gives the
//! same bytes.

use std::path::PathBuf;

use centrical::observability::{Condition, CorrelatedGroup, Need, Reason, Remedy};
use centrical::plan::Prediction;
use centrical::{Combination, Experiment, Group, MeasurementModel, Study, Weight};
use serde::Serialize;
use serde_json::{Map, Value};

use crate::document::prediction::PredictionReport;
use crate::document::result::{PriorSummary, Program};
use crate::error::{Error, Place};
use crate::experiment::PlannedSession;

/// Name of the schema's present version.
pub(crate) const OBSERVABILITY_SCHEMA: &str = "centrical-observability/1";

/// A design with its weights: a plan, or a session with those of its data.
#[derive(Debug, Clone, PartialEq)]
pub struct Subject {
    /// The file it was read from.
    pub file: PathBuf,
    /// Title.
    pub title: String,
    /// Where the weights are from, in words.
    pub weighted_by: String,
    /// What is set, and what is unknown.
    pub model: MeasurementModel,
    /// Expected unknowns, about which uncertainties are predicted; zero where nothing is expected.
    pub nominal: Vec<f64>,
    /// How well each mean is known, or will be.
    pub weights: Vec<Weight>,
}

impl Subject {
    /// What weighs the plateaus of a session.
    pub(crate) const DATA: &str = "the noise of its data";

    /// The budget to be expected of a calibration, and the uncertainty of the compensated reading up to the largest load of
    /// the experiment.
    fn prediction(&self) -> Result<PredictionReport, Error> {
        let prediction = Prediction::of(&self.model, &self.weights, &self.nominal)
            .map_err(|source| Error::fit(&self.file, source))?;
        PredictionReport::of(&prediction, largest_force(self.model.experiment()), PredictionReport::COVERAGE)
            .map_err(|source| Error::fit(&self.file, source))
    }

    /// Studies the design at zero unknowns, where its structure is exact.
    ///
    /// # Errors
    /// [`Error::Fit`] when a weight or the design is beyond all measure.
    pub fn study(&self) -> Result<Study, Error> {
        Study::at_zero(self.model.clone(), self.weights.clone()).map_err(|source| Error::fit(&self.file, source))
    }
}

/// The largest nominal specific force of an experiment [m/s^2].
pub(crate) fn largest_force(experiment: &Experiment) -> f64 {
    experiment.set_points.iter().map(|s| experiment.nominal(s).norm()).fold(0.0, f64::max)
}

impl From<PlannedSession> for Subject {
    fn from(plan: PlannedSession) -> Self {
        Self {
            weighted_by: plan.weighted_by(),
            file: plan.file,
            title: plan.title,
            model: plan.model,
            nominal: plan.nominal,
            weights: plan.weights,
        }
    }
}

/// Observability of an experiment: rank, undetermined combinations, their causes and remedies.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ObservabilityReport {
    /// `centrical-observability/1`.
    pub schema: &'static str,
    /// What made it.
    pub program: Program,
    /// Title of the session or plan.
    pub title: String,
    /// Where the weights are from.
    pub weighted_by: String,
    /// "common", "opposite" or "free".
    pub pair_relation: &'static str,
    /// Plateaus.
    pub plateaus: usize,
    /// Rank of the weighted, column-scaled subject.
    pub rank: usize,
    /// Number of unknowns.
    pub columns: usize,
    /// Singular values below this part of the largest count as zero.
    pub tolerance: f64,
    /// Whether a singular value lies within two decades of the tolerance.
    pub doubtful: bool,
    /// Largest singular value over the smallest that counts.
    pub condition_number: Option<f64>,
    /// Singular values, falling.
    pub singular_values: Vec<f64>,
    /// The unknowns in order.
    pub parameters: Vec<ObservedParameter>,
    /// What is lost.
    pub lost: Vec<LostCombination>,
    /// Groups of correlated parameters.
    pub correlated_groups: Vec<GroupReport>,
    /// The source's sufficient conditions.
    pub conditions: Vec<ConditionReport>,
    /// What would bring back what is lost, cheapest first.
    pub remedies: Vec<RemedyReport>,
    /// The combinations that were asked for.
    pub combinations: Vec<CombinationReport>,
    /// Standard and expanded uncertainties to be expected, type A and B, of the parameters and of the compensated reading.
    pub prediction: PredictionReport,
}

/// An unknown.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ObservedParameter {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// bias, scale, misalignment, ...
    #[serde(serialize_with = "crate::document::json::serialize")]
    pub group: Group,
    /// Whether it belongs to the instrument's error model.
    pub of_instrument: bool,
    /// Whether the experiment determines it.
    pub estimable: bool,
    /// Standard uncertainty to be expected, SI.
    pub standard_uncertainty: Option<f64>,
    /// Its prior, if any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prior: Option<PriorSummary>,
    /// Part of its variance that comes from priors; only where there are priors.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prior_share: Option<f64>,
    /// Whether it is determined only thanks to priors.
    pub rests_on_prior: bool,
}

/// A combination along which no reading changes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LostCombination {
    /// Parameter to component, SI.
    pub direction: Map<String, Value>,
    /// The direction as people write it.
    pub text: String,
    /// Why it is lost.
    pub reason: String,
    /// What the newtonometers feel of it.
    pub felt: Vec<SightReport>,
    /// Parameters of the instrument that take part.
    pub of_instrument: Vec<String>,
}

/// What one newtonometer feels of a lost combination.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SightReport {
    /// Newtonometer, 1 to 3.
    pub newtonometer: usize,
    /// Positions.
    pub positions: Vec<String>,
    /// Parameter to coefficient, SI, up to a common factor.
    pub sum: Map<String, Value>,
    /// Whether it is always the same sum.
    pub is_one_sum: bool,
}

/// Parameters that the data hardly separate.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GroupReport {
    /// Names.
    pub parameters: Vec<String>,
    /// Multiple correlation of each with all others.
    pub multiple_correlations: Vec<f64>,
    /// Pairs at 0.99 or more.
    pub pairs: Vec<PairReport>,
}

/// Two strongly correlated estimates.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairReport {
    /// Names.
    pub parameters: [String; 2],
    /// Correlation of the estimates.
    pub correlation: f64,
}

/// One of the source's conditions.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConditionReport {
    /// What the source asks for.
    pub requirement: &'static str,
    /// What the experiment has.
    pub found: String,
    /// Whether that is enough.
    pub is_met: bool,
    /// Whether this experiment needs it.
    pub is_needed: bool,
    /// How many combinations depend on it: lost without it, or brought back by it.
    pub combinations: usize,
}

/// Additions that bring back what is lost.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RemedyReport {
    /// Whether nothing is lost any more after the last step.
    pub restores_rank: bool,
    /// Condition number after the last step.
    pub condition_number: Option<f64>,
    /// The additions.
    pub steps: Vec<StepReport>,
}

/// An addition.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StepReport {
    /// In words.
    pub text: String,
    /// Number of combinations it brings back.
    pub gain: usize,
}

/// A combination that was asked for.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CombinationReport {
    /// As people write it.
    pub text: String,
    /// Whether the experiment determines it.
    pub estimable: bool,
    /// Standard uncertainty to be expected, SI.
    pub standard_uncertainty: Option<f64>,
}

impl ObservabilityReport {
    /// Whether every parameter of the instrument is estimable and the rank beyond doubt.
    pub fn is_acceptable(&self) -> bool {
        !self.doubtful && self.parameters.iter().all(|p| p.estimable || !p.of_instrument)
    }

    /// Studies a design, and the combinations that are asked for.
    ///
    /// # Errors
    /// [`Error`] when a combination is invalid, or as [`Subject::study`].
    pub fn of(subject: &Subject, combinations: &[String]) -> Result<Self, Error> {
        let study = subject.study()?;
        let seen = study.observability();
        let parse = |text: &String| combination(subject, &study, text);
        let count = seen.columns();
        Ok(Self {
            schema: OBSERVABILITY_SCHEMA,
            program: Program::this(),
            title: subject.title.clone(),
            weighted_by: subject.weighted_by.clone(),
            pair_relation: subject.model.experiment().pair_relation.name(),
            plateaus: subject.weights.len(),
            rank: seen.rank(),
            columns: count,
            tolerance: centrical::Observability::RANK_TOLERANCE,
            doubtful: seen.is_doubtful(),
            condition_number: seen.condition_number(),
            singular_values: seen.singular_values().to_vec(),
            parameters: (0..count).map(|j| observed(&study, j)).collect(),
            lost: study.reasons().iter().map(|reason| lost(&study, reason)).collect(),
            correlated_groups: seen.correlated_groups().iter().map(|group| correlated(&study, group)).collect(),
            conditions: study.conditions().into_iter().map(condition).collect(),
            remedies: study.remedies().iter().map(remedy).collect(),
            combinations: combinations.iter().map(parse).collect::<Result<_, _>>()?,
            prediction: subject.prediction()?,
        })
    }
}

fn observed(study: &Study, j: usize) -> ObservedParameter {
    let parameter = &study.model().parameters()[j];
    let has_priors = !study.model().priors().is_empty();
    ObservedParameter {
        name: parameter.name.clone(),
        unit: parameter.unit.clone(),
        group: parameter.group,
        of_instrument: parameter.is_of_instrument(),
        estimable: study.observability().is_estimable(j),
        standard_uncertainty: study.standard_uncertainty(j),
        prior: study.prior_uses().iter().find(|(prior, _)| prior.parameter == j).map(PriorSummary::from),
        prior_share: study.prior_share(j).filter(|_| has_priors),
        rests_on_prior: study.rests_on_prior(j),
    }
}

fn lost(study: &Study, reason: &Reason) -> LostCombination {
    let (parameters, experiment) = (study.model().parameters(), study.model().experiment());
    let felt = reason.sights.iter().map(|sight| SightReport {
        newtonometer: sight.newtonometer + 1,
        positions: sight.positions.iter().map(|&k| experiment.positions[k].id.clone()).collect(),
        sum: named(study, &sight.terms),
        is_one_sum: sight.is_one_sum,
    });
    LostCombination {
        direction: named(study, reason.direction.terms()),
        text: reason.direction.text(parameters, experiment.site.gravity),
        reason: reason.sentence(study),
        felt: felt.collect(),
        of_instrument: names(study, &reason.of_instrument),
    }
}

fn correlated(study: &Study, group: &CorrelatedGroup) -> GroupReport {
    let name = |j: usize| study.model().parameters()[j].name.clone();
    let pair = |&(i, j, correlation): &(usize, usize, f64)| PairReport { parameters: [name(i), name(j)], correlation };
    GroupReport {
        parameters: names(study, &group.parameters),
        multiple_correlations: group.multiple_correlations.clone(),
        pairs: group.pairs.iter().map(pair).collect(),
    }
}

fn condition(condition: Condition) -> ConditionReport {
    let (is_needed, combinations) = match condition.need {
        Need::Holds(count) | Need::WouldBringBack(count) => (true, count),
        Need::Spare | Need::Dispensable => (false, 0),
    };
    ConditionReport {
        requirement: condition.requirement,
        found: condition.found,
        is_met: condition.is_met,
        is_needed,
        combinations,
    }
}

fn remedy(remedy: &Remedy) -> RemedyReport {
    let step = |step: &centrical::observability::Step| StepReport { text: step.text.clone(), gain: step.gain };
    RemedyReport {
        restores_rank: remedy.restores_rank(),
        condition_number: remedy.after.condition_number(),
        steps: remedy.steps.iter().map(step).collect(),
    }
}

fn combination(subject: &Subject, study: &Study, text: &str) -> Result<CombinationReport, Error> {
    let combination = Combination::parse(text, study.model().parameters()).map_err(|error| {
        let place = Place::Key { table: format!("combination {text:?}"), key: format!("character {}", error.at) };
        Error::content(&subject.file, place, error.found, error.expected)
    })?;
    Ok(CombinationReport {
        text: combination.text(study.model().parameters()),
        estimable: study.observability().sees(&combination),
        standard_uncertainty: study.observability().standard_uncertainty(&combination),
    })
}

fn names(study: &Study, indices: &[usize]) -> Vec<String> {
    indices.iter().map(|&j| study.model().parameters()[j].name.clone()).collect()
}

fn named(study: &Study, terms: &[(usize, f64)]) -> Map<String, Value> {
    let name = |j: usize| study.model().parameters()[j].name.clone();
    terms.iter().map(|&(j, component)| (name(j), component.into())).collect()
}
