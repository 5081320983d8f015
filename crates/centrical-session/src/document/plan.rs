//! A plan as a JSON document: schema `centrical-plan/1`. The same input gives the same bytes.

use centrical::Group;
use serde::Serialize;

use crate::document::prediction::PredictionReport;
use crate::document::result::Program;

/// Name of the schema's present version.
pub(crate) const PLAN_SCHEMA: &str = "centrical-plan/1";

/// A plan with all that is said of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlanReport {
    /// `centrical-plan/1`.
    pub schema: &'static str,
    /// What made it.
    pub program: Program,
    /// Title.
    pub title: String,
    /// What the plan is to make small.
    pub criterion: CriterionName,
    /// Value of the criterion as an uncertainty: square root of the variance it is [m/s^2 for I, else 1].
    pub value: f64,
    /// The value in each scenario, if there are several: the expected one first.
    pub by_scenario: Vec<f64>,
    /// "mean" or "worst": how they are one.
    pub against: &'static str,
    /// No schedule of the candidates in this time has a lower value.
    pub bound: f64,
    /// The continuous design on the mountings of the plan: its value, and the part by which the equivalence theorem leaves it
    /// above the optimum.
    pub continuous: f64,
    /// That part, of the uncertainty.
    pub continuous_gap: f64,
    /// Nodes of the branch and bound over sets of mountings.
    pub nodes: usize,
    /// Of a plan for goals: no schedule of the candidates that is shorter meets them, with type B as in this plan [s].
    pub least_time: Option<f64>,
    /// Whether it is for a unit with typical errors of alternating sign: see [`centrical::plan::Task::plan`].
    pub for_typical: bool,
    /// Plateaus to choose from.
    pub candidates: usize,
    /// Time of the plan [s].
    pub time: f64,
    /// Time of measuring alone, of ramps and turns, of set-ups [s].
    pub time_by_use: [f64; 3],
    /// The mountings on the arm in their order.
    pub mountings: Vec<PlannedMounting>,
    /// The rests beside the arm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rests: Option<ChosenRests>,
    /// What will be known.
    pub prediction: PredictionReport,
    /// Goals, for criterion "worst": name, wanted, predicted from noise and speeds, predicted with type B [SI].
    pub goals: Vec<GoalReport>,
    /// Time against uncertainty.
    pub frontier: Vec<FrontierRow>,
}

/// What a plan is to make small.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum CriterionName {
    /// Mean uncertainty of the compensated reading.
    I,
    /// Mean uncertainty of the parameters.
    A,
    /// Volume of their joint uncertainty.
    D,
    /// Worst uncertainty over its goal.
    #[serde(rename = "worst")]
    Worst,
}

/// One mounting of a plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlannedMounting {
    /// Position.
    pub position: String,
    /// Radius [m].
    pub radius: f64,
    /// Its time with its set-up [s]: the times of all mountings, and of rests beside the arm, are that of the plan.
    pub time: f64,
    /// Why it is there.
    pub reason: ReasonReport,
    /// Its plateaus.
    pub plateaus: Vec<PlannedPlateau>,
}

/// The rests beside the arm of a plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChosenRests {
    /// Why they are there, all together.
    pub reason: ReasonReport,
    /// Standard uncertainty of the attitudes about each horizontal axis, where they are known [rad].
    pub attitude_uncertainty: Option<f64>,
    /// The rests in their order.
    pub rests: Vec<ChosenRest>,
}

/// One rest beside the arm.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChosenRest {
    /// Where up is, axes of the case, of length 1.
    pub up: [f64; 3],
    /// Duration [s].
    pub duration: f64,
    /// Why it is there.
    pub reason: ReasonReport,
}

/// One kind of visit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlannedPlateau {
    /// Speed [rad/s], 0 at rest.
    pub speed: f64,
    /// Carousel angle at rest [rad].
    pub angle: f64,
    /// Duration of a visit [s].
    pub duration: f64,
    /// Why one visit is there.
    pub reason: ReasonReport,
}

/// What is lost without a part of the plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReasonReport {
    /// By which part the criterion rises, as an uncertainty.
    pub rise: f64,
    /// Time that it takes [s].
    pub time: f64,
    /// The parameter of the instrument that suffers most.
    pub parameter: String,
    /// Its uncertainty without it over that with it.
    pub factor: f64,
}

/// A wanted uncertainty.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GoalReport {
    /// Parameter, or "reading".
    pub name: String,
    /// SI unit.
    pub unit: String,
    /// Group of the parameter.
    #[serde(serialize_with = "crate::document::json::serialize")]
    pub group: Group,
    /// Wanted standard uncertainty.
    pub wanted: f64,
    /// Predicted by noise, speeds and priors.
    pub type_a: Option<f64>,
    /// What the stated type B leaves, which no plan lowers by much.
    pub type_b: Option<f64>,
    /// Predicted with type B.
    pub combined: Option<f64>,
}

/// One time of the frontier. Values are uncertainties as in [`PlanReport::value`].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FrontierRow {
    /// Time [s].
    pub time: f64,
    /// The best plan found.
    pub best: f64,
    /// Bound.
    pub bound: f64,
    /// The uniform plan, if there is time for it.
    pub uniform: Option<f64>,
    /// [K5.5], if there is time for it.
    pub normalised: Option<f64>,
}

impl PlanReport {
    /// Whether all coefficients of the instrument are determined and every goal is met.
    pub fn is_acceptable(&self) -> bool {
        let is_missed = |goal: &GoalReport| goal.combined.is_none_or(|u| u > goal.wanted * (1.0 + 1e-6));
        self.prediction.reading.is_some() && !self.goals.iter().any(is_missed)
    }
}
