//! Plans: the session form before anything is measured, or a preset experiment by name.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use centrical::ThirdPosition;
use centrical::plan::{Noise, Normalised};
use centrical::{Kind, MeasurementModel, Parameter, TypeB, Weight};
use nalgebra::Matrix3;
use serde::Deserialize;

use super::extensions::{extensions, pair_relation};
use super::folder::Folder;
use super::form::{Form, PlanTable, PresetForm, PresetTable};
use super::rests::{self, RestTable};
use super::session::{Session, experiment_file, read_text};
use super::speeds::preset_speeds;
use super::toml_path::TomlPath;
use super::uncertainty::ANY_BIAS;
use super::{prior, schedule, terms};
use crate::error::{Error, Place, quoted};
use crate::quantity::Quantity;
use crate::settings::from_toml;
use crate::units::{Dimension, MICRO_G};

/// Name of the source's normalised experiment [K5.5].
const NORMALISED: &str = "kozlov-2017-normalised";

/// Longest list of radii, levels or angles of a preset: beyond it the design is larger than any centrifuge has time for.
const LONGEST_LIST: usize = 100;

/// A planned experiment.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedSession {
    /// The plan file.
    pub file: PathBuf,
    /// Title, as in a session.
    pub title: String,
    /// The experiment, the unit's error model, extensions and priors.
    pub model: MeasurementModel,
    /// Expected unknowns, zero where nothing is expected: those of the earlier result once it is read.
    pub nominal: Vec<f64>,
    /// How well the mean of each set point will be known.
    pub weights: Vec<Weight>,
    /// The assumed noise.
    pub noise: Noise,
    /// The earlier result that `[plan]` names.
    pub earlier: Option<PathBuf>,
}

/// The noise unless a file says otherwise: 20 ug/sqrt(Hz) and no floor, an ordinary quartz newtonometer.
const USUAL_NOISE: Noise = Noise { density: 20e-6 * centrical::STANDARD_GRAVITY, floor: 0.0 };

/// Duration of a plateau unless a file says otherwise [s].
const USUAL_DURATION: f64 = 60.0;

/// As much of a file as tells a plan from a session, and which kind of plan.
#[derive(Deserialize)]
struct Probe {
    plateaus: Option<toml::Value>,
    plan: Option<ProbeTable>,
    #[serde(default)]
    mounting: Vec<ProbeMounting>,
    #[serde(default)]
    tumble: Vec<ProbeTumble>,
}

#[derive(Deserialize)]
struct ProbeTable {
    preset: Option<toml::Value>,
}

#[derive(Deserialize)]
struct ProbeMounting {
    record: Option<toml::Value>,
}

#[derive(Deserialize)]
struct ProbeTumble {
    rests: Option<toml::Value>,
    record: Option<toml::Value>,
}

impl Probe {
    /// Whether something is measured. Rests that are measured belong to a plan too, of an arm that is not.
    fn is_measured(&self) -> bool {
        let has_rests = self.tumble.iter().any(|tumble| tumble.rests.is_some() || tumble.record.is_some());
        self.plateaus.is_some()
            || self.mounting.iter().any(|mounting| mounting.record.is_some())
            || self.mounting.is_empty() && has_rests
    }
}

impl PlannedSession {
    /// Reads a plan, a file or the folder of one; `None` if it is a session with records or plateaus of its own. With `[plan]` it is a
    /// plan until the first of them is there: what was measured has its own noise.
    ///
    /// # Errors
    /// If the file cannot be read, does not follow the form or makes no sense, as for [`Session::read`]. Unlike a session
    /// a plan may rest all the time.
    pub fn read(path: &Path) -> Result<Option<Self>, Error> {
        let path = &experiment_file(path);
        let text = read_text(path)?;
        let probe: Probe = from_toml(path, &text)?;
        if probe.plan.as_ref().is_some_and(|plan| plan.preset.is_some()) {
            return Self::of_preset(path, &from_toml(path, &text)?).map(Some);
        }
        if probe.is_measured() && probe.plan.is_none() {
            return Ok(None);
        }
        let form = from_toml::<Form>(path, &text)?.with_schedules();
        if form.candidates.is_some() && form.mounting.is_empty() && !form.position.is_empty() {
            let expected = "a schedule in [[mounting]], which the command plan makes of candidates";
            return Err(Error::content(path, Place::Whole, "[candidates] without a schedule", expected));
        }
        let session = Session::without_plateaus(path, Folder::of(path), &form)?;
        if probe.is_measured() && (form.plateaus.is_some() || session.has_readings()) {
            return Ok(None);
        }
        Self::of_session(session, &form).map(Some)
    }

    /// Where the weights are from, in words.
    pub(crate) fn weighted_by(&self) -> String {
        format!("a planned noise of {:.3} ug/sqrt(Hz)", self.noise.density / MICRO_G)
    }

    /// Takes the unknowns to be as expected.
    pub(crate) fn expect(&mut self, expected: &ExpectedValues) {
        self.nominal = expected_of(&self.model, expected);
    }

    /// The plan of a session without its set points.
    fn of_session(mut session: Session, form: &Form) -> Result<Self, Error> {
        let file = &session.file.clone();
        session.experiment.set_points =
            schedule::set_points(file, &form.mounting, session.experiment.centrifuge.rotation)?;
        session.durations = schedule::durations(file, &form.mounting)?;
        rests::refuse_records(file, &session.rest_tables)?;
        session.rest_tables.iter_mut().try_for_each(|table| table.read(&session.folder))?;
        session.add_rests();
        session.state_uncertainties(form)?;
        let table = form.plan.as_ref();
        let of_table = |key: fn(&PlanTable) -> &Option<Quantity>| table.and_then(|table| key(table).as_ref());
        let (noise, usual) = noise(file, of_table(|t| &t.noise), of_table(|t| &t.floor), of_table(|t| &t.duration))?;
        let durations = session.durations.iter().map(|duration| duration.unwrap_or(usual)).collect();
        let model = session.model()?;
        Ok(Self {
            file: file.to_owned(),
            title: session.title.clone(),
            nominal: vec![0.0; model.parameters().len()],
            model,
            weights: weights(&noise, durations, &session.rest_tables),
            noise,
            earlier: earlier(file, table),
        })
    }

    fn of_preset(file: &Path, form: &PresetForm) -> Result<Self, Error> {
        let table = &form.plan;
        if table.preset != NORMALISED {
            let found = quoted(table.preset.as_bytes());
            return Err(TomlPath::table(file, "plan").unexpected("preset", found, format!("{NORMALISED:?}")));
        }
        let plan = normalised(
            file,
            table,
            Normalised { pair_relation: pair_relation(file, &form.model)?, ..Normalised::default() },
        )?;
        let mut experiment = plan.experiment();
        let (noise, duration) = noise(file, table.noise.as_ref(), table.floor.as_ref(), table.duration.as_ref())?;
        let speeds = preset_speeds(file, &form.centrifuge)?;
        experiment.centrifuge.speed_uncertainty = speeds.expected_uncertainty();
        let folder = Folder::of(file);
        let mut rest_tables = RestTable::named(file, &folder, &form.tumble)?;
        rests::refuse_records(file, &rest_tables)?;
        rest_tables.iter_mut().try_for_each(|table| table.read(&folder))?;
        let mut durations = vec![duration; experiment.set_points.len()];
        durations.extend(rest_tables.iter().flat_map(RestTable::durations).map(|stated| stated.unwrap_or(duration)));
        rests::add_rests(&mut experiment, &rest_tables);
        let weights = weights(&noise, durations, &rest_tables);
        let error_model = terms::error_model(file, &form.model.error_model)?;
        let stated = TypeB { speed_scale: speeds.scale(), bias_change: ANY_BIAS, ..TypeB::default() };
        let model = MeasurementModel::new(experiment, error_model, &extensions(file, &form.model)?).with_stated(stated);
        Ok(Self {
            file: file.to_owned(),
            title: form.session.title.clone(),
            nominal: vec![0.0; model.parameters().len()],
            model: prior::with_priors(file, model, &prior::entries(&form.prior))?,
            weights,
            noise,
            earlier: None,
        })
    }
}

/// Values expected of unknowns, SI, by the names of the parameters: those of an earlier result.
pub type ExpectedValues = BTreeMap<String, f64>;

/// The earlier result that `[plan] nominal` names by its path from the folder of the file.
pub(crate) fn earlier(file: &Path, table: Option<&PlanTable>) -> Option<PathBuf> {
    let folder = file.parent().unwrap_or(Path::new(""));
    table.and_then(|table| table.nominal.as_ref()).map(|name| folder.join(name))
}

/// The unknowns of `model` as expected, zero where nothing is expected. A rest shares nothing but its number with one of an
/// earlier calibration.
pub(crate) fn expected_of(model: &MeasurementModel, expected: &ExpectedValues) -> Vec<f64> {
    let is_of_rest = |p: &Parameter| matches!(p.kind, Kind::Attitude { .. });
    let value = |p: &Parameter| if is_of_rest(p) { 0.0 } else { expected.get(&p.name).copied().unwrap_or(0.0) };
    model.parameters().iter().map(value).collect()
}

/// The normalised experiment with what the table says otherwise.
fn normalised(file: &Path, table: &PresetTable, mut plan: Normalised) -> Result<Normalised, Error> {
    let at = TomlPath::table(file, "plan");
    plan.third = match table.axis_1.as_deref() {
        None | Some("up") => ThirdPosition::AxisOneUp,
        Some("down") => ThirdPosition::AxisOneDown,
        Some(other) => return Err(at.unexpected("axis_1", quoted(other.as_bytes()), "\"up\" or \"down\"")),
    };
    if let Some(masses) = &table.proof_masses {
        plan.rho = Matrix3::from_fn(|i, j| masses[j][i] - masses[0][i]);
    }
    if let Some(radii) = &table.radii {
        plan.radii = list(&at, "radii", radii, (0.0, 1e6), "radii in units of R*, zero or more")?;
    }
    if let Some(levels) = &table.levels {
        plan.levels = list(&at, "levels", levels, (0.0, 1e6), "multiples of Omega*^2, zero or more")?;
    }
    if let Some(angles) = &table.rest_angles {
        let angles = angles.iter().map(|a| at.finite("rest_angles", a, Dimension::Angle));
        let angles = angles.collect::<Result<Vec<f64>, _>>()?;
        plan.rest_angles = list(&at, "rest_angles", &angles, (-1e6, 1e6), "angles, none of them millions of turns")?;
    }
    if let Some(arm) = &table.arm {
        plan.arm = at.bounded("arm", arm, Dimension::Length, (1e-3, 1e3), "R* from 1 mm to 1 km")?;
    }
    if let Some(gravity) = &table.gravity {
        let meaning = "gravity above 0 and below 100 m/s^2";
        plan.gravity = at.bounded("gravity", gravity, Dimension::Acceleration, (f64::MIN_POSITIVE, 100.0), meaning)?;
    }
    let rests = plan.levels.contains(&0.0) && !plan.rest_angles.is_empty();
    if !rests && plan.levels.iter().all(|m| *m == 0.0) {
        return Err(at.unexpected("levels", "no plateau at all", "a level above 0, or 0 with an angle at rest"));
    }
    Ok(plan)
}

/// A list of numbers within bounds, not empty and not longer than makes sense.
fn list(at: &TomlPath, key: &str, values: &[f64], (low, high): (f64, f64), meaning: &str) -> Result<Vec<f64>, Error> {
    if values.is_empty() || values.len() > LONGEST_LIST {
        return Err(at.unexpected(key, format!("{} of them", values.len()), format!("1 to {LONGEST_LIST} {meaning}")));
    }
    match values.iter().find(|v| !(low..=high).contains(*v)) {
        Some(wrong) => Err(at.unexpected(key, wrong.to_string(), meaning)),
        None => Ok(values.to_vec()),
    }
}

/// Noise, and the duration of a plateau for which no other is given [s].
pub(crate) fn noise(
    file: &Path,
    density: Option<&Quantity>,
    floor: Option<&Quantity>,
    per_plateau: Option<&Quantity>,
) -> Result<(Noise, f64), Error> {
    let at = TomlPath::table(file, "plan");
    let mut noise = USUAL_NOISE;
    if let Some(quantity) = density {
        noise.density = noise_density(&at, quantity)?;
    }
    if let Some(quantity) = floor {
        noise.floor = noise_floor(&at, quantity)?;
    }
    Ok((noise, schedule::duration(&at, "duration", per_plateau)?.unwrap_or(USUAL_DURATION)))
}

/// The density of noise under `noise` in a table.
pub(crate) fn noise_density(at: &TomlPath, density: &Quantity) -> Result<f64, Error> {
    let meaning = "a spectral density above 0 and below 1 m/s^2/sqrt(Hz)";
    at.bounded("noise", density, Dimension::NoiseDensity, (1e-15, 1.0), meaning)
}

/// The floor of noise under `floor` in a table.
pub(crate) fn noise_floor(at: &TomlPath, floor: &Quantity) -> Result<f64, Error> {
    at.bounded("floor", floor, Dimension::Acceleration, (0.0, 10.0), "an acceleration from 0 to 10 m/s^2")
}

/// The covariances of the means, the same on all axes; of rests that are measured their own.
fn weights(noise: &Noise, durations: Vec<f64>, rests: &[RestTable]) -> Vec<Weight> {
    let count = durations.len() - rests.iter().map(RestTable::count).sum::<usize>();
    let planned = |(set_point, duration)| noise.weight(set_point, duration);
    let mut weights: Vec<Weight> = durations.into_iter().enumerate().map(planned).collect();
    let mut of_rests = weights[count..].iter_mut();
    for table in rests {
        let own = of_rests.by_ref().take(table.count()).zip(&table.means);
        own.for_each(|(weight, rest)| weight.covariance = rest.covariance);
    }
    weights
}
