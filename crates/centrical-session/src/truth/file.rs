//! The truth file: the unit as it is, and the laboratory's equipment as it errs.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use centrical::simulate::{Equipment, Simulation};
use centrical::{Extension, MeasurementModel, Parameter};
use schemars::JsonSchema;
use serde::Deserialize;

use super::equipment::{CounterTable, HandTable, MachineTable, RecorderTable, SensorTable, TachometerTable, equipment};
use crate::error::Error;
use crate::experiment::{Session, TomlPath};
use crate::quantity::Quantity;
use crate::settings::{from_toml, read_settings};

/// What is simulated: the model with its unknowns, their true values, and the equipment.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    /// The truth file.
    pub file: PathBuf,
    /// The plan, each of its rests in an attitude.
    pub plan: Session,
    /// The measurement model, with the extensions whose parameters the file names.
    pub model: MeasurementModel,
    /// True values in the order of the model's parameters, SI.
    pub values: Vec<f64>,
    /// The equipment.
    pub equipment: Equipment,
}

/// The whole file. Every key is known here: one that is not is an error.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct TruthForm {
    /// Parameters that are not named are drawn.
    typical: Option<TypicalTable>,
    /// True values by name.
    #[serde(default)]
    parameters: BTreeMap<String, Quantity>,
    /// The centrifuge.
    #[serde(default)]
    machine: MachineTable,
    /// The newtonometers.
    #[serde(default)]
    sensor: SensorTable,
    /// The recorder of the readings.
    #[serde(default)]
    recorder: RecorderTable,
    /// The tachometer.
    #[serde(default)]
    tachometer: TachometerTable,
    /// The counter of pulses.
    #[serde(default)]
    counter: CounterTable,
    /// What turns the unit between rests.
    #[serde(default)]
    hand: HandTable,
}

/// Largest standard deviation of drawn parameters, in typical magnitudes.
const LARGEST_SIZE: f64 = 1e6;

/// Parameters that are not named are drawn from a normal law about zero.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct TypicalTable {
    /// Its standard deviation in typical magnitudes.
    size: f64,
    /// The session's own seed if absent.
    seed: Option<u64>,
}

impl Truth {
    /// Reads the truth of a session that follows `plan`. `seed` is the session's.
    ///
    /// # Errors
    /// If the file can not be read or does not follow the form, a quantity is not of its dimension, a setting makes no
    /// sense, or a parameter is not one of the plan's nor of an extension.
    pub fn read(file: &Path, plan: &Session, seed: u64) -> Result<Self, Error> {
        let text = read_settings(file, "a truth file")?;
        let form: TruthForm = from_toml(file, &text)?;
        let tables = (&form.machine, &form.sensor, &form.recorder, &form.tachometer, &form.counter, &form.hand);
        let equipment = equipment(file, tables, &plan.speeds, plan.type_b.bias_change)?;
        let attitudes = |number| Simulation::draw_attitudes(equipment.hand.rests, seed, number);
        let tables = plan.rest_tables.iter().enumerate();
        let rests = tables.map(|(number, table)| table.as_planned(|| attitudes(number))).collect();
        let plan = plan.clone().with_rest_tables(rests);
        let (model, sources) = model(&plan, &form);
        let values = values(file, &form, &model, sources, seed)?;
        Ok(Self { file: file.to_owned(), plan, model, values, equipment })
    }
}

/// The model with those extensions that have a parameter in the form, and the number of parameters without them.
fn model(plan: &Session, form: &TruthForm) -> (MeasurementModel, usize) {
    let with =
        |extensions: &[Extension]| MeasurementModel::new(plan.experiment.clone(), plan.error_model.clone(), extensions);
    let source = with(&[]);
    let is_named = |p: &Parameter| source.parameters().find(&p.name).is_none() && form.parameters.contains_key(&p.name);
    let extensions: Vec<Extension> =
        Extension::NAMED.iter().map(|(_, e)| *e).filter(|e| with(&[*e]).parameters().iter().any(is_named)).collect();
    (with(&extensions), source.parameters().len())
}

/// True values: as named; drawn if not named and among the source's, the first `sources` of them; zero otherwise.
fn values(
    file: &Path,
    form: &TruthForm,
    model: &MeasurementModel,
    sources: usize,
    seed: u64,
) -> Result<Vec<f64>, Error> {
    let at = TomlPath::table(file, "parameters");
    let parameters = model.parameters();
    let (size, seed) =
        form.typical.as_ref().map_or((0.0, seed), |typical| (typical.size, typical.seed.unwrap_or(seed)));
    if !(0.0..=LARGEST_SIZE).contains(&size) {
        let expected = "typical magnitudes, from 0 to a million of them";
        return Err(TomlPath::table(file, "typical").unexpected("size", format!("{size:?}"), expected));
    }
    let mut values = Simulation::draw_truth(model, size, seed);
    values[sources..].fill(0.0);
    for (name, quantity) in &form.parameters {
        let Some(j) = parameters.find(name) else {
            let known: Vec<&str> = parameters.iter().map(|p| p.name.as_str()).collect();
            let expected = format!("one of {}, or of an extension such as elastic_speed_1[..]", known.join(", "));
            return Err(at.unexpected(name, "an unknown parameter", expected));
        };
        values[j] = at.of_parameter(name, quantity, &parameters[j])?;
    }
    Ok(values)
}
