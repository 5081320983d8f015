//! What is to be planned: candidates, costs and targets, in the form of a session without mountings.

use std::path::{Path, PathBuf};

use centrical::plan::{Candidates, Costs, Criterion, Goal, Noise, PlanError, Robustness, Scenario, Task};
use centrical::{Experiment, MeasurementModel, STANDARD_GRAVITY, SetPoint};

use super::extensions::named_extensions;
use super::folder::Folder;
use super::form::{self, CandidatesTable, Form, MountingTable, Steps};
use super::plan::{ExpectedValues, earlier, expected_of, noise, noise_density, noise_floor};
use super::prior;
use super::rests::RestTable;
use super::schedule::{FASTEST, duration};
use super::session::{Session, experiment_file, read_text};
use super::toml_path::TomlPath;
use crate::error::{Error, quoted};
use crate::quantity::{NotThatQuantity, Quantity};
use crate::settings::from_toml;
use crate::units::Dimension;

/// Beyond these no centrifuge has time, and no search either.
const MOST_PLATEAUS: usize = 20_000;
const MOST_DURATIONS: usize = 10;
const MOST_REPEATS: usize = 20;

/// What may be available for a plan [s].
const AVAILABLE: (f64, f64) = (1.0, 1e9);
const AVAILABLE_TIME: &str = "a time from 1 s to 1e9 s";

/// Over what a compensated reading is judged on an arm unless something else is said: the field's 200 g. Rests alone show 1 g.
const USUAL_RANGE: f64 = 200.0 * STANDARD_GRAVITY;

/// What is to be planned.
#[derive(Debug, Clone, PartialEq)]
pub struct Planning {
    /// The plan file.
    pub file: PathBuf,
    /// Title, as in a session.
    pub title: String,
    /// What can be chosen, what is made small, and within what time.
    pub task: Task,
    /// Largest specific force over which a compensated reading is judged [m/s^2].
    pub range: f64,
    /// The rests beside the arm that can be chosen: the last of the candidates, in this order.
    pub(crate) rests: Option<RestTable>,
    /// The earlier result that `[plan]` names.
    pub earlier: Option<PathBuf>,
}

impl Planning {
    /// Reads what is to be planned, for a unit without errors. A `time` available [s] takes the place of the one in the file.
    ///
    /// # Errors
    /// If the file cannot be read, does not follow the form or makes no sense, or has no `[candidates]`.
    pub fn read(path: &Path, time: Option<f64>) -> Result<Self, Error> {
        let path = &experiment_file(path);
        let mut form = from_toml::<Form>(path, &read_text(path)?)?.with_schedules();
        let at = TomlPath::table(path, "candidates");
        form.mounting = mountings(&at, &form)?;
        form.position.retain(|position| form.mounting.iter().any(|mounting| mounting.position == position.id));
        form.target.time = time.map(Quantity::Number).or(form.target.time);
        let form = form;
        let table = stated(&at, &form)?;
        let mut session = Session::without_plateaus(path, Folder::of(path), &form)?;
        if session.experiment.has_arm() {
            session.experiment.set_points = set_points(&at, table, &session.experiment)?;
        }
        session.rest_tables = rests(path, &at, table)?;
        session.add_rests();
        session.state_uncertainties(&form)?;
        let scenarios = scenarios(path, &form, &session)?;
        let candidates = Candidates {
            scenarios,
            robustness: robustness(path, &form)?,
            durations: durations(&at, table)?,
            repeats: repeats(&at, table)?,
            costs: costs(path, &form)?,
        };
        let (criterion, time, range) = target(path, &form, &candidates.scenarios[0].model)?;
        Ok(Self {
            file: path.to_owned(),
            title: session.title.clone(),
            task: Task { candidates, criterion, time },
            range,
            rests: session.rest_tables.pop(),
            earlier: earlier(path, form.plan.as_ref()),
        })
    }

    /// Takes the unknowns to be as expected.
    pub(crate) fn expect(&mut self, expected: &ExpectedValues) {
        for scenario in &mut self.task.candidates.scenarios {
            scenario.nominal = expected_of(&scenario.model, expected);
        }
    }

    pub(crate) fn failed(&self, source: PlanError) -> Error {
        Error::planning(&self.file, source)
    }
}

/// The time available for a plan [s], where it is stated beside the plan file.
///
/// # Errors
/// If it is not a time that a plan can take.
pub fn available_time(time: &Quantity) -> Result<f64, NotThatQuantity> {
    let (shortest, longest) = AVAILABLE;
    match time.si(Dimension::Time)? {
        seconds if (shortest..=longest).contains(&seconds) => Ok(seconds),
        _ => Err(NotThatQuantity { found: time.to_string(), expected: AVAILABLE_TIME.to_owned() }),
    }
}

/// The candidates that a plan file states.
fn stated<'f>(at: &TomlPath, form: &'f Form) -> Result<&'f CandidatesTable, Error> {
    let expected = "what the plan is chosen from";
    form.candidates.as_ref().ok_or_else(|| at.unexpected("radii", "no [candidates]", expected))
}

/// The rests beside the arm.
fn rests(file: &Path, at: &TomlPath, table: &CandidatesTable) -> Result<Vec<RestTable>, Error> {
    let folder = &Folder::of(file);
    let uncertain = table.attitude_uncertainty.as_ref();
    match (&table.attitudes, uncertain) {
        (Some(entry), _) => Ok(vec![RestTable::planned(at, folder, entry, uncertain)?]),
        (None, None) => Ok(Vec::new()),
        (None, Some(_)) => {
            let expected = "the attitudes that are this uncertain";
            Err(at.unexpected("attitudes", "no such key beside attitude_uncertainty", expected))
        }
    }
}

/// A mounting for every position and radius.
fn mountings(at: &TomlPath, form: &Form) -> Result<Vec<MountingTable>, Error> {
    let table = stated(at, form)?;
    if !form.mounting.is_empty() {
        let expected = "no [[mounting]]: the plan chooses them from positions and radii";
        return Err(at.unexpected("radii", format!("{} mountings", form.mounting.len()), expected));
    }
    if !form.tumble.is_empty() {
        let expected = "no [[tumble]]: the plan chooses rests from attitudes";
        return Err(at.unexpected("attitudes", "rests in [[tumble]]", expected));
    }
    if !form.has_arm() {
        return Ok(Vec::new());
    }
    if table.radii.is_empty() {
        return Err(at.unexpected("radii", "none", "at least one radius"));
    }
    let known: Vec<&str> = form.position.iter().map(|p| p.id.as_str()).collect();
    if let Some(unknown) = table.positions.iter().find(|id| !known.contains(&id.as_str())) {
        let found = format!("unknown position {}", quoted(unknown.as_bytes()));
        return Err(at.unexpected("positions", found, format!("some of {}", known.join(", "))));
    }
    let is_meant = |id: &&str| table.positions.is_empty() || table.positions.iter().any(|meant| meant == id);
    let mounting = |id: &str, radius: &Quantity| MountingTable {
        pulses: None,
        position: id.to_owned(),
        arm: [radius.clone(), Quantity::Number(0.0), Quantity::Number(0.0)],
        record: None,
        telemetry: None,
        plateaus: Vec::new(),
    };
    let meant = known.iter().filter(|id| is_meant(id));
    Ok(meant.flat_map(|id| table.radii.iter().map(move |radius| mounting(id, radius))).collect())
}

/// Every speed that the machine and the unit bear, and every angle at rest, in every mounting.
fn set_points(at: &TomlPath, table: &CandidatesTable, experiment: &Experiment) -> Result<Vec<SetPoint>, Error> {
    let largest = experiment.mountings.iter().map(|m| m.arm_y.x).fold(0.0, f64::max);
    for (n, mounting) in experiment.mountings.iter().enumerate().filter(|(_, m)| m.arm_y.x > 0.0) {
        if experiment.mountings[..n].contains(mounting) {
            return Err(at.unexpected("radii", format!("{} m twice", mounting.arm_y.x), "each radius once"));
        }
    }
    if table.speeds.is_some() && table.loads.is_some() {
        return Err(at.unexpected("loads", "loads beside speeds", "one of them"));
    }
    let mut speeds = Vec::new();
    if let Some(steps) = &table.speeds {
        speeds.extend(values(at, "speeds", steps, Dimension::Speed, FASTEST)?);
    }
    if let Some(steps) = &table.loads {
        let loads = values(at, "loads", steps, Dimension::Acceleration, 1e6 * STANDARD_GRAVITY)?;
        speeds.extend(loads.into_iter().map(|load| (load / largest).sqrt()));
    }
    speeds.sort_by(f64::total_cmp);
    speeds.dedup();
    let limit = |key: &str, quantity: &Option<Quantity>, dimension| {
        let meaning = "a limit above 0";
        let bounded = |q| at.bounded(key, q, dimension, (f64::MIN_POSITIVE, f64::MAX), meaning);
        quantity.as_ref().map_or(Ok(f64::INFINITY), bounded)
    };
    let fastest = limit("max_speed", &table.max_speed, Dimension::Speed)?;
    let most = limit("max_load", &table.max_load, Dimension::Acceleration)?;
    let angles = table.rest_angles.iter().map(|angle| at.finite("rest_angles", angle, Dimension::Angle));
    let angles = angles.collect::<Result<Vec<f64>, Error>>()?;
    let mut set_points = Vec::new();
    for (mounting, place) in experiment.mountings.iter().enumerate() {
        set_points.extend(angles.iter().map(|&angle| SetPoint::at_rest(mounting, angle)));
        let borne = speeds.iter().filter(|omega| **omega <= fastest && **omega * **omega * place.arm_y.x <= most);
        set_points
            .extend(borne.map(|omega| SetPoint::spinning(mounting, experiment.centrifuge.rotation.sign() * omega)));
    }
    if set_points.is_empty() || set_points.len() > MOST_PLATEAUS {
        let expected =
            format!("1 to {MOST_PLATEAUS} of them, by speeds, loads and rest_angles within max_speed and max_load");
        return Err(at.unexpected("speeds", format!("{} candidate plateaus", set_points.len()), expected));
    }
    Ok(set_points)
}

/// Values above 0, one by one or at equal steps.
fn values(at: &TomlPath, key: &str, steps: &Steps, dimension: Dimension, most: f64) -> Result<Vec<f64>, Error> {
    let value = |quantity: &Quantity| {
        at.bounded(key, quantity, dimension, (f64::MIN_POSITIVE, most), "values above 0 and within reason")
    };
    match steps {
        Steps::List(list) => list.iter().map(value).collect(),
        Steps::Range(range) => {
            let (from, to) = (value(&range.from)?, value(&range.to)?);
            if range.count < 2 || range.count > MOST_PLATEAUS || to <= from {
                let found = format!("{} from {} to {}", range.count, range.from, range.to);
                return Err(at.unexpected(key, found, "two or more steps, rising"));
            }
            let step = (to - from) / (range.count - 1) as f64;
            Ok((0..range.count).map(|n| from + step * n as f64).collect())
        }
    }
}

fn durations(at: &TomlPath, table: &CandidatesTable) -> Result<Vec<f64>, Error> {
    let mut durations = Vec::new();
    for quantity in &table.durations {
        durations.extend(duration(at, "durations", Some(quantity))?);
    }
    durations.sort_by(f64::total_cmp);
    durations.dedup();
    if durations.is_empty() || durations.len() > MOST_DURATIONS {
        let expected = format!("1 to {MOST_DURATIONS} durations of a plateau");
        return Err(at.unexpected("durations", format!("{} of them", durations.len()), expected));
    }
    Ok(durations)
}

fn repeats(at: &TomlPath, table: &CandidatesTable) -> Result<usize, Error> {
    let repeats = table.repeats.unwrap_or(1);
    if (1..=MOST_REPEATS).contains(&repeats) {
        return Ok(repeats);
    }
    Err(at.unexpected("repeats", repeats.to_string(), format!("1 to {MOST_REPEATS} visits of a plateau")))
}

fn costs(file: &Path, form: &Form) -> Result<Costs, Error> {
    let at = TomlPath::table(file, "cost");
    let time = |key: &str, quantity: &Option<Quantity>| {
        let bounded = |q| at.bounded(key, q, Dimension::Time, (0.0, 1e7), "a time from 0 to 1e7 s");
        quantity.as_ref().map_or(Ok(0.0), bounded)
    };
    let costs = Costs {
        position: time("position", &form.cost.position)?,
        seat: time("seat", &form.cost.seat)?,
        ramp: time("ramp", &form.cost.ramp)?,
        turn: time("turn", &form.cost.turn)?,
        run_up: time("run_up", &form.cost.run_up)?,
        table: time("table", &form.cost.table)?,
        attitude: time("attitude", &form.cost.attitude)?,
    };
    if costs.seat > costs.position {
        let expected = "at most the cost of a change of position, which contains one";
        return Err(at.unexpected("seat", format!("{} s", costs.seat), expected));
    }
    Ok(costs)
}

/// The expected state of affairs first, then those of `[robust]`, all of the same weight.
fn scenarios(file: &Path, form: &Form, session: &Session) -> Result<Vec<Scenario>, Error> {
    let plan = form.plan.as_ref();
    let given = |key: fn(&form::PlanTable) -> &Option<Quantity>| plan.and_then(|table| key(table).as_ref());
    let (expected, _) = noise(file, given(|t| &t.noise), given(|t| &t.floor), given(|t| &t.duration))?;
    let zeros = |model: &MeasurementModel| vec![0.0; model.parameters().len()];
    let scenario = |model: MeasurementModel, noise| Scenario { nominal: zeros(&model), model, noise, weight: 1.0 };
    let model = session.model()?;
    let mut scenarios = vec![scenario(model.clone(), expected)];
    let at = TomlPath::table(file, "robust");
    for density in &form.robust.noise {
        let density = noise_density(&at, density)?;
        scenarios.push(scenario(model.clone(), Noise { density, ..expected }));
    }
    for floor in &form.robust.floor {
        let floor = noise_floor(&at, floor)?;
        scenarios.push(scenario(model.clone(), Noise { floor, ..expected }));
    }
    if !form.robust.extensions.is_empty() {
        let mut with = session.clone();
        with.extensions.extend(named_extensions(&at, &form.robust.extensions)?);
        session.refuse_absent(&at, &with.extensions)?;
        scenarios.push(scenario(with.model()?, expected));
    }
    Ok(scenarios)
}

fn robustness(file: &Path, form: &Form) -> Result<Robustness, Error> {
    match form.robust.against.as_deref() {
        None | Some("mean") => Ok(Robustness::Mean),
        Some("worst") => Ok(Robustness::Worst),
        Some(other) => Err(TomlPath::table(file, "robust").unexpected(
            "against",
            quoted(other.as_bytes()),
            "\"mean\" or \"worst\"",
        )),
    }
}

/// Criterion, time and range; without a time the criterion is that of the goals.
fn target(file: &Path, form: &Form, model: &MeasurementModel) -> Result<(Criterion, Option<f64>, f64), Error> {
    let at = TomlPath::table(file, "target");
    let table = &form.target;
    let time = table.time.as_ref().map(|q| at.bounded("time", q, Dimension::Time, AVAILABLE, AVAILABLE_TIME));
    let time = time.transpose()?;
    let usual = if model.experiment().has_arm() { USUAL_RANGE } else { STANDARD_GRAVITY };
    let range = table.range.as_ref().map_or(Ok(usual), |q| {
        at.bounded("range", q, Dimension::Acceleration, (1e-3, 1e7), "a specific force from 1e-3 to 1e7 m/s^2")
    })?;
    let goals = goals(file, form, model, range)?;
    let name = table.criterion.as_deref().unwrap_or(if goals.is_empty() { "I" } else { "worst" });
    if ["I", "A", "D"].contains(&name) && !goals.is_empty() {
        let found = format!("criterion {name:?} beside [target.uncertainty]");
        return Err(at.unexpected(
            "criterion",
            found,
            "\"worst\", which the wanted uncertainties are for, or one of the two",
        ));
    }
    let criterion = match name {
        "I" => Criterion::Reading(range),
        "A" => Criterion::Average,
        "D" => Criterion::Determinant,
        "worst" if goals.is_empty() => {
            return Err(at.unexpected("uncertainty", "no goals", "a [target.uncertainty] for criterion \"worst\""));
        }
        "worst" => Criterion::Worst(goals),
        other => {
            let expected = "\"I\", \"A\", \"D\" or \"worst\"";
            return Err(at.unexpected("criterion", quoted(other.as_bytes()), expected));
        }
    };
    match (&criterion, time) {
        (Criterion::Worst(_), _) | (_, Some(_)) => Ok((criterion, time, range)),
        _ => Err(at.unexpected("time", "neither time nor uncertainty", "time = \"8 h\", or [target.uncertainty]")),
    }
}

fn goals(file: &Path, form: &Form, model: &MeasurementModel, range: f64) -> Result<Vec<Goal>, Error> {
    let at = TomlPath::table(file, "target.uncertainty");
    let mut goals = Vec::new();
    for (name, quantity) in &form.target.uncertainty {
        if name == "reading" {
            let meaning = "a standard uncertainty above 0";
            let bounds = (f64::MIN_POSITIVE, 10.0);
            let uncertainty = at.bounded(name, quantity, Dimension::Acceleration, bounds, meaning)?;
            goals.push(Goal::Reading { range, uncertainty });
            continue;
        }
        let uncertainty = prior::uncertainty_of(&at, model, name, quantity)?;
        for j in model.parameters().select(name) {
            let parameter = &model.parameters()[j];
            if !parameter.is_of_instrument() {
                let expected = "a parameter or group of the instrument, or \"reading\"";
                return Err(at.unexpected(name, format!("{} of the geometry", parameter.name), expected));
            }
            goals.push(Goal::Parameter { name: parameter.name.clone(), uncertainty });
        }
    }
    Ok(goals)
}
