//! A plan as a document: schema `centrical-plan/1`; and as the plan file of a session. The same input gives the same bytes.

use std::path::Path;

use centrical::plan::{
    Account, Candidates, Criterion, Effort, Goal, Plan, PlanError, Prediction, Reason, Robustness, Schedule, Visit,
    best_for_time, frontier, predict, shortest_for_goals,
};
use centrical::uncertainty::TypeB;
use centrical::{Experiment, MeasurementModel, SetPoint};
use serde::Serialize;

use crate::error::{Error, Place};
use crate::prediction::PredictionReport;
use crate::result::Program;
use crate::session::Planning;

/// Name of the schema's present version.
const SCHEMA: &str = "centrical-plan/1";

/// Levels `m` of [K5.5] on the frontier unless others are given.
pub const USUAL_LEVELS: [f64; 4] = [0.0, 1.0, 2.0, 3.0];

/// Type B is reckoned with this much above that of the plan before, so that the next one keeps within it.
const MARGIN: f64 = 1.01;

/// Speeds of a uniform plan at most, in each mounting.
const UNIFORM_SPEEDS: usize = 8;

/// What of a plan is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanRequest {
    /// Times of the frontier over that of the plan; none for no frontier.
    pub frontier: Vec<f64>,
    /// Levels `m` of [K5.5] to compare with.
    pub levels: Vec<f64>,
    /// Probability that expanded uncertainties are to cover.
    pub coverage: f64,
}

/// A plan with all that is said of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlanReport {
    /// `centrical-plan/1`.
    pub schema: &'static str,
    /// What made it.
    pub program: Program,
    /// Title.
    pub title: String,
    /// "I", "A", "D" or "worst".
    pub criterion: &'static str,
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
    /// Of a plan for goals: no schedule of the candidates that is shorter keeps them, with type B as in this plan [s].
    pub least_time: Option<f64>,
    /// Whether it is for a unit of typical errors, signs in turn: see [`Planning::plan`].
    pub for_typical: bool,
    /// Plateaus to choose from.
    pub candidates: usize,
    /// Time of the plan [s].
    pub time: f64,
    /// Time of measuring alone, of ramps and turns, of set-ups [s].
    pub time_by_use: [f64; 3],
    /// The mountings in their order.
    pub mountings: Vec<PlannedMounting>,
    /// What will be known.
    pub prediction: PredictionReport,
    /// Goals, for criterion "worst": name, wanted, predicted from noise and speeds, predicted with type B [SI].
    pub goals: Vec<GoalReport>,
    /// Time against uncertainty.
    pub frontier: Vec<FrontierRow>,
}

/// One mounting of a plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlannedMounting {
    /// Position.
    pub position: String,
    /// Radius [m].
    pub radius: f64,
    /// Why it is there.
    pub reason: ReasonReport,
    /// Its plateaus.
    pub plateaus: Vec<PlannedPlateau>,
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
    pub group: &'static str,
    /// Wanted standard uncertainty.
    pub wanted: f64,
    /// Predicted by noise, speeds and priors.
    pub type_a: Option<f64>,
    /// What the stated type B leaves, which no plan lowers by much.
    pub type_b: Option<f64>,
    /// Predicted with type B.
    pub combined: Option<f64>,
}

impl GoalReport {
    fn with_type_b(self) -> Self {
        let rest = |(all, a): (f64, f64)| (all * all - a * a).max(0.0).sqrt();
        Self { type_b: self.combined.zip(self.type_a).map(rest), ..self }
    }
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

impl Planning {
    /// The best plan for the time, or the shortest for the goals; `certify`: searched until its bound is within 0.25 % or all
    /// sets of mountings are done with.
    ///
    /// A plan that leaves combinations of unknowns open may keep its goals for a unit without errors and miss them for any other
    /// (see [`predict`]). One that does is planned again for a unit of typical errors, which `self` expects from then on.
    ///
    /// # Errors
    /// [`Error::Planning`] when there is none.
    pub fn plan(&mut self, certify: bool) -> Result<Plan, Error> {
        let effort = self.effort(certify);
        let expects_none = self.candidates.scenarios.iter().all(|s| s.nominal.iter().all(|value| *value == 0.0));
        if self.time.is_some() || !expects_none {
            return self.search(effort);
        }
        // A hasty plan shows mostly what a good one would.
        let hasty = self.search(Effort::QUICK)?;
        if self.keeps_goals(&hasty)? {
            let plan = self.search(effort)?;
            if self.keeps_goals(&plan)? {
                return Ok(plan);
            }
        }
        for scenario in &mut self.candidates.scenarios {
            scenario.nominal = scenario.model.parameters().typical_in_turn();
        }
        self.search(effort)
    }

    fn effort(&self, certify: bool) -> Effort {
        let usual = Effort::usual(self.candidates.len());
        match (certify, self.time) {
            (true, Some(_)) => Effort::CERTIFIED,
            (true, None) => Effort { visit_nodes: 0, ..Effort::CERTIFIED },
            (false, Some(_)) => usual,
            // The shortest plan is sought by a search for each of some times.
            (false, None) => Effort { mounting_nodes: 2 + usual.mounting_nodes / 6, visit_nodes: 0, ..usual },
        }
    }

    /// Whether every goal is kept as predicted, type B included.
    fn keeps_goals(&self, plan: &Plan) -> Result<bool, Error> {
        let goals = self.goals_of(&self.predict(&plan.schedule)?);
        Ok(goals.iter().all(|goal| goal.combined.is_some_and(|u| u <= goal.wanted)))
    }

    fn search(&self, effort: Effort) -> Result<Plan, Error> {
        let Criterion::Worst(goals) = &self.criterion else { return self.best(&self.criterion, effort) };
        if self.type_b == TypeB::default() {
            return self.best(&self.criterion, effort);
        }
        // Type B hardly depends on the plan: what it leaves of the goals for type A settles in a few plans.
        let mut floors = self.floors(&self.everything())?;
        for (goal, floor) in goals.iter().zip(&floors).filter(|_| self.time.is_none()) {
            let (name, wanted) = named(goal);
            if *floor >= wanted {
                return Err(self.failed(PlanError::BelowTypeB { name: name.to_owned(), factor: floor / wanted }));
            }
        }
        for now in [Effort::QUICK, Effort::QUICK, Effort::QUICK, effort, effort] {
            let plan = self.best(&Criterion::Worst(for_type_a(goals, &floors)), now)?;
            let there = self.floors(&plan.schedule)?;
            let is_settled = there.iter().zip(&floors).all(|(there, floor)| there <= floor);
            floors.iter_mut().zip(there).for_each(|(floor, there)| *floor = floor.max(MARGIN * there));
            // A shortest plan that keeps the goals is one, whatever it was reckoned with.
            let is_kept = self.time.is_none() && self.keeps_goals(&plan)?;
            if (is_settled || is_kept) && now == effort {
                return Ok(plan);
            }
        }
        self.best(&Criterion::Worst(for_type_a(goals, &floors)), effort)
    }

    fn best(&self, criterion: &Criterion, effort: Effort) -> Result<Plan, Error> {
        let plan = match self.time {
            Some(time) => best_for_time(&self.candidates, criterion, time, effort),
            None => shortest_for_goals(&self.candidates, criterion, 0.01, effort),
        };
        plan.map_err(|source| self.failed(source))
    }

    /// Every plateau as often and as long as may be.
    fn everything(&self) -> Schedule {
        let candidates = &self.candidates;
        let longest = candidates.durations.last().copied().unwrap_or(0.0);
        let visit = |n: usize| Visit { plateau: n % candidates.len(), duration: longest };
        candidates.schedule((0..candidates.len() * candidates.repeats).map(visit).collect())
    }

    /// What the stated type B leaves of each goal with a schedule, none where it is lost altogether.
    fn floors(&self, schedule: &Schedule) -> Result<Vec<f64>, Error> {
        let floor = |goal: &GoalReport| goal.type_b.unwrap_or(0.0);
        Ok(self.goals_of(&self.predict(schedule)?).iter().map(floor).collect())
    }

    /// What there is to say of a plan.
    ///
    /// # Errors
    /// [`Error`] when it cannot be predicted.
    pub fn report(&self, plan: &Plan, request: &PlanRequest) -> Result<PlanReport, Error> {
        let candidates = &self.candidates;
        let schedule = &plan.schedule;
        let account = Account::of(candidates, &self.criterion, schedule).map_err(|source| self.failed(source))?;
        let measuring: f64 = schedule.visits.iter().map(|v| v.duration).sum();
        let visits: f64 = schedule.visits.iter().map(|v| candidates.visit_time(v)).sum();
        let prediction = self.predict(schedule)?;
        Ok(PlanReport {
            schema: SCHEMA,
            program: Program { name: "centrical".to_owned(), version: env!("CARGO_PKG_VERSION").to_owned() },
            title: self.title.clone(),
            criterion: match self.criterion {
                Criterion::Determinant => "D",
                Criterion::Average => "A",
                Criterion::Reading(_) => "I",
                Criterion::Worst(_) => "worst",
            },
            value: plan.criterion.sqrt(),
            by_scenario: if plan.by_scenario.len() > 1 {
                plan.by_scenario.iter().map(|value| value.sqrt()).collect()
            } else {
                Vec::new()
            },
            against: match candidates.robustness {
                Robustness::Mean => "mean",
                Robustness::Worst => "worst",
            },
            bound: plan.bound.sqrt(),
            continuous: (0.5 * plan.continuous.value).exp(),
            continuous_gap: (1.0 + plan.continuous.gap()).sqrt() - 1.0,
            nodes: plan.nodes,
            least_time: plan.least_time,
            for_typical: candidates.scenarios[0].nominal == self.model().parameters().typical_in_turn(),
            candidates: candidates.len(),
            time: schedule.time,
            time_by_use: [measuring, visits - measuring, schedule.time - visits],
            mountings: self.mountings(plan, &account),
            goals: self.goals_of(&prediction),
            prediction: PredictionReport::of(&prediction, self.range, request.coverage),
            frontier: self.frontier(schedule.time, request)?,
        })
    }

    /// What a schedule will know in the first scenario.
    ///
    /// # Errors
    /// [`Error::Fit`] when its numbers are beyond all measure.
    pub fn predict(&self, schedule: &Schedule) -> Result<Prediction, Error> {
        let (experiment, weights) = self.candidates.experiment_of(schedule);
        let scenario = &self.candidates.scenarios[0];
        let model = scenario.model.in_experiment(experiment);
        let expected =
            |p: &centrical::Parameter| scenario.model.parameters().find(&p.name).map_or(0.0, |j| scenario.nominal[j]);
        let nominal: Vec<f64> = model.parameters().iter().map(expected).collect();
        predict(&model, &weights, scenario.speed_uncertainty, &self.type_b, &nominal)
            .map_err(|source| Error::Fit { file: self.file.clone(), source })
    }

    fn mountings(&self, plan: &Plan, account: &Account) -> Vec<PlannedMounting> {
        let experiment = self.candidates.experiment();
        let mut mountings = Vec::new();
        for (m, reason) in account.mountings.iter().enumerate() {
            let Some(reason) = reason else { continue };
            let there = |n: &usize| experiment.set_points[plan.schedule.visits[*n].plateau].mounting == m;
            let plateau = |n: usize| {
                let visit = &plan.schedule.visits[n];
                let SetPoint { omega, angle, .. } = experiment.set_points[visit.plateau];
                PlannedPlateau {
                    speed: omega.abs(),
                    angle,
                    duration: visit.duration,
                    reason: self.reason(&account.visits[n]),
                }
            };
            mountings.push(PlannedMounting {
                position: experiment.positions[experiment.mountings[m].position].id.clone(),
                radius: experiment.mountings[m].arm_y.x,
                reason: self.reason(reason),
                plateaus: (0..plan.schedule.visits.len()).filter(there).map(plateau).collect(),
            });
        }
        mountings
    }

    fn reason(&self, reason: &Reason) -> ReasonReport {
        ReasonReport {
            rise: (1.0 + reason.rise).sqrt() - 1.0,
            time: reason.time,
            parameter: self.model().parameters()[reason.parameter].name.clone(),
            factor: reason.factor,
        }
    }

    fn model(&self) -> &MeasurementModel {
        &self.candidates.scenarios[0].model
    }

    fn goals_of(&self, prediction: &Prediction) -> Vec<GoalReport> {
        let Criterion::Worst(goals) = &self.criterion else { return Vec::new() };
        let report = |goal: &Goal| match goal {
            Goal::Parameter { name, uncertainty } => {
                let parameters = prediction.model().parameters();
                let j = parameters.find(name);
                GoalReport {
                    name: name.clone(),
                    unit: j.map_or(String::new(), |j| parameters[j].unit.clone()),
                    group: j.map_or("", |j| parameters[j].group),
                    wanted: *uncertainty,
                    type_a: j.and_then(|j| prediction.type_a(j)),
                    type_b: None,
                    combined: j.and_then(|j| prediction.standard_uncertainty(j)),
                }
                .with_type_b()
            }
            Goal::Reading { range, uncertainty } => {
                let reading = prediction.reading(*range);
                GoalReport {
                    name: "reading".to_owned(),
                    unit: "m/s^2".to_owned(),
                    group: "bias",
                    wanted: *uncertainty,
                    type_a: reading.map(|[a, _]| a),
                    type_b: None,
                    combined: reading.map(|[_, all]| all),
                }
                .with_type_b()
            }
        };
        goals.iter().map(report).collect()
    }

    /// The frontier about `time`, with the uniform plan and [K5.5] beside it.
    fn frontier(&self, time: f64, request: &PlanRequest) -> Result<Vec<FrontierRow>, Error> {
        if request.frontier.is_empty() {
            return Ok(Vec::new());
        }
        let times: Vec<f64> = request.frontier.iter().map(|factor| factor * time).collect();
        let effort = Effort::usual(self.candidates.len());
        let points = frontier(&self.candidates, &self.criterion, &times, effort);
        let points = points.map_err(|source| self.failed(source))?;
        let uniform = with_set_points(&self.candidates, &uniform_set_points(self.candidates.experiment()));
        let normalised =
            with_set_points(&self.candidates, &normalised_set_points(self.candidates.experiment(), &request.levels));
        let of = |candidates: &Candidates, time: f64| {
            let found = candidates.uniform(&self.criterion, time).map_err(|source| self.failed(source))?;
            Ok::<_, Error>(found.map(|(_, value)| value.sqrt()))
        };
        points
            .into_iter()
            .map(|point| {
                Ok(FrontierRow {
                    time: point.time,
                    best: point.plan.criterion.sqrt(),
                    bound: point.plan.bound.sqrt(),
                    uniform: of(&uniform, point.time)?,
                    normalised: of(&normalised, point.time)?,
                })
            })
            .collect()
    }

    fn failed(&self, source: PlanError) -> Error {
        Error::Planning { file: self.file.clone(), source }
    }
}

impl PlanReport {
    /// The text of the document.
    pub fn to_json(&self) -> String {
        // Plain structs with text keys: serialisation has nothing to fail on.
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }

    /// The plan as the plan file of a session: the text that it was planned from, with mountings in place of candidates.
    ///
    /// # Errors
    /// [`Error`] when the file cannot be read any more.
    pub fn session_text(&self, file: &Path) -> Result<String, Error> {
        let text = std::fs::read_to_string(file).map_err(|source| Error::reading(file, source, "a plan"))?;
        let form = |error: toml_edit::TomlError| Error::Form {
            file: file.to_owned(),
            place: Place::Whole,
            message: error.message().to_owned(),
        };
        let mut document: toml_edit::DocumentMut = text.parse().map_err(form)?;
        for key in ["candidates", "cost", "target", "robust"] {
            document.remove(key);
        }
        // The plan may be written to another folder than the one it was read from.
        let nominal = document.get_mut("plan").and_then(|plan| plan.get_mut("nominal"));
        if let Some(nominal) = nominal.filter(|item| item.is_str()) {
            let from = file.parent().unwrap_or(Path::new("")).join(nominal.as_str().unwrap_or_default());
            let whole = std::path::absolute(&from).unwrap_or(from);
            *nominal = toml_edit::value(whole.to_string_lossy().into_owned());
        }
        // A position that is not used has no mounting, and no parameters.
        if let Some(toml_edit::Item::ArrayOfTables(positions)) = document.get_mut("position") {
            positions.retain(|table| {
                let id = table.get("id").map(|id| id.as_str().map_or_else(|| id.to_string(), str::to_owned));
                id.is_some_and(|id| self.mountings.iter().any(|m| m.position == id.trim()))
            });
        }
        let mut text = document.to_string();
        text.truncate(text.trim_end().len());
        text.push('\n');
        for mounting in &self.mountings {
            text.push_str(&mounting.text());
        }
        Ok(text)
    }
}

impl PlannedMounting {
    fn text(&self) -> String {
        let plateau = |p: &PlannedPlateau| {
            let angle = if p.speed == 0.0 { format!(", angle = {:?}", p.angle) } else { String::new() };
            format!("  {{ speed = {:?}{angle}, duration = {:?} }},\n", p.speed, p.duration)
        };
        let plateaus: String = self.plateaus.iter().map(plateau).collect();
        let (position, radius) = (&self.position, self.radius);
        format!("\n[[mounting]]\nposition = {position:?}\narm = [{radius:?}, 0, 0]\nplateaus = [\n{plateaus}]\n")
    }
}

/// Name and wanted standard uncertainty of a goal.
fn named(goal: &Goal) -> (&str, f64) {
    match goal {
        Goal::Parameter { name, uncertainty } => (name, *uncertainty),
        Goal::Reading { uncertainty, .. } => ("reading", *uncertainty),
    }
}

/// What is left of goals for type A, `sqrt(wanted^2 - floor^2)`; a goal that type B alone misses is sought as it stands.
fn for_type_a(goals: &[Goal], floors: &[f64]) -> Vec<Goal> {
    let left = |(goal, floor): (&Goal, &f64)| {
        let (_, wanted) = named(goal);
        let rest = (wanted - floor) * (wanted + floor);
        let uncertainty = if rest > 0.0 { rest.sqrt() } else { wanted };
        match goal {
            Goal::Parameter { name, .. } => Goal::Parameter { name: name.clone(), uncertainty },
            Goal::Reading { range, .. } => Goal::Reading { range: *range, uncertainty },
        }
    };
    goals.iter().zip(floors).map(left).collect()
}

/// The candidates with other plateaus in the same mountings.
fn with_set_points(candidates: &Candidates, set_points: &[SetPoint]) -> Candidates {
    let mut other = candidates.clone();
    for scenario in &mut other.scenarios {
        let experiment = Experiment { set_points: set_points.to_vec(), ..scenario.model.experiment().clone() };
        // The same positions and mountings have the same unknowns.
        scenario.model = scenario.model.in_experiment(experiment);
    }
    other
}

/// All rests, and of each mounting's speeds some at equal distances.
fn uniform_set_points(experiment: &Experiment) -> Vec<SetPoint> {
    let mut chosen = Vec::new();
    for m in 0..experiment.mountings.len() {
        let (rests, spins): (Vec<SetPoint>, Vec<SetPoint>) =
            experiment.set_points.iter().filter(|s| s.mounting == m).partition(|s| s.is_rest());
        chosen.extend(rests);
        let count = spins.len().min(UNIFORM_SPEEDS);
        chosen.extend((1..=count).map(|n| spins[n * spins.len() / count - 1]));
    }
    chosen
}

/// [K5.5] on the same mountings: `Omega^2 = 10 g m / R*`, `R*` the largest radius; rest at 0 and pi.
fn normalised_set_points(experiment: &Experiment, levels: &[f64]) -> Vec<SetPoint> {
    let largest = experiment.mountings.iter().map(|m| m.arm_y.x).fold(0.0, f64::max);
    let unit = (10.0 * experiment.site.gravity / largest).sqrt();
    let sign = if experiment.set_points.iter().any(|s| s.omega < 0.0) { -1.0 } else { 1.0 };
    let mut chosen = Vec::new();
    for mounting in 0..experiment.mountings.len() {
        for &m in levels {
            if m == 0.0 {
                chosen.extend([0.0, std::f64::consts::PI].map(|angle| SetPoint { mounting, omega: 0.0, angle }));
            } else {
                chosen.push(SetPoint { mounting, omega: sign * unit * m.sqrt(), angle: 0.0 });
            }
        }
    }
    chosen
}
