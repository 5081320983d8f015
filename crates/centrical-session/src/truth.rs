//! The truth file of a simulation: the unit's true parameters and the equipment's errors. Equipment that is not given is perfect.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use centrical::simulate::{Equipment, Simulation};
use centrical::{Extension, MeasurementModel, Parameter};
use schemars::JsonSchema;
use serde::Deserialize;

use crate::error::Error;
use crate::experiment::{Session, SpeedSource, Speeds, TomlPath};
use crate::quantity::Quantity;
use crate::settings::{from_toml, read_settings};
use crate::units::Dimension;
use crate::units::Dimension::{Acceleration, Angle, Frequency, Ratio, Speed, Time};

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

/// A quantity that may be left out.
#[derive(Debug, Default, Deserialize, JsonSchema)]
struct Given(Option<Quantity>);

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
struct MachineTable {
    plateau: Given,
    plateau_spread: Given,
    ramp: Given,
    speed_error: Given,
    settling: Given,
    settling_time: Given,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
struct SensorTable {
    white: Given,
    coloured: ColouredTable,
    bias_instability: Given,
    /// Per square root of a second.
    random_walk: Given,
    /// Per second.
    drift: Given,
    quantum: Given,
    range: Option<Quantity>,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
struct ColouredTable {
    deviation: Given,
    time: Given,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
struct RecorderTable {
    rate: Given,
    spikes: SpikesTable,
    gaps: GapsTable,
    repeats: Given,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
struct SpikesTable {
    probability: Given,
    size: Given,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
struct GapsTable {
    probability: Given,
    /// Samples.
    length: Given,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
struct TachometerTable {
    rate: Given,
    clock_offset: Given,
    clock_drift: Given,
    noise: Given,
    quantum: Given,
    measures: Option<bool>,
    scale_error: Given,
    plateau_error: Given,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
struct CounterTable {
    jitter: Given,
    scale_error: Given,
    plateau_error: Given,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
struct HandTable {
    /// Rests where the plan states no attitudes.
    rests: Option<usize>,
    rest: Given,
    rest_spread: Given,
    turn: Given,
    turn_spread: Given,
    shake: Given,
    tremor: TremorTable,
    bumps: BumpsTable,
    bias_change: Given,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
struct TremorTable {
    deviation: Given,
    time: Given,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
struct BumpsTable {
    /// Per rest.
    probability: Given,
    size: Given,
}

/// A number of the equipment: table and key in a truth file, its dimension, where the form has it, and where the simulation.
type Setting = (&'static str, Dimension, fn(&TruthForm) -> &Option<Quantity>, fn(&mut Equipment) -> &mut f64);

/// All numbers that a truth file may give.
const SETTINGS: [Setting; 40] = [
    ("counter.jitter", Time, |f| &f.counter.jitter.0, |e| &mut e.counter.jitter),
    ("counter.scale_error", Ratio, |f| &f.counter.scale_error.0, |e| &mut e.counter.scale_error),
    ("counter.plateau_error", Ratio, |f| &f.counter.plateau_error.0, |e| &mut e.counter.plateau_error),
    ("machine.plateau", Time, |f| &f.machine.plateau.0, |e| &mut e.machine.plateau),
    ("machine.plateau_spread", Time, |f| &f.machine.plateau_spread.0, |e| &mut e.machine.plateau_spread),
    ("machine.ramp", Time, |f| &f.machine.ramp.0, |e| &mut e.machine.ramp),
    ("machine.speed_error", Ratio, |f| &f.machine.speed_error.0, |e| &mut e.machine.speed_error),
    ("machine.settling", Ratio, |f| &f.machine.settling.0, |e| &mut e.machine.settling),
    ("machine.settling_time", Time, |f| &f.machine.settling_time.0, |e| &mut e.machine.settling_time),
    ("sensor.white", Acceleration, |f| &f.sensor.white.0, |e| &mut e.sensor.white),
    (
        "sensor.coloured.deviation",
        Acceleration,
        |f| &f.sensor.coloured.deviation.0,
        |e| &mut e.sensor.coloured.deviation,
    ),
    ("sensor.coloured.time", Time, |f| &f.sensor.coloured.time.0, |e| &mut e.sensor.coloured.time),
    ("sensor.bias_instability", Acceleration, |f| &f.sensor.bias_instability.0, |e| &mut e.sensor.bias_instability),
    ("sensor.random_walk", Acceleration, |f| &f.sensor.random_walk.0, |e| &mut e.sensor.random_walk),
    ("sensor.drift", Acceleration, |f| &f.sensor.drift.0, |e| &mut e.sensor.drift),
    ("sensor.quantum", Acceleration, |f| &f.sensor.quantum.0, |e| &mut e.sensor.quantum),
    // Unlimited is infinite, which JSON writes as null.
    ("sensor.range", Acceleration, |f| &f.sensor.range, |e| e.sensor.range.get_or_insert(f64::INFINITY)),
    ("recorder.rate", Frequency, |f| &f.recorder.rate.0, |e| &mut e.recorder.rate),
    (
        "recorder.spikes.probability",
        Ratio,
        |f| &f.recorder.spikes.probability.0,
        |e| &mut e.recorder.spikes.probability,
    ),
    ("recorder.spikes.size", Acceleration, |f| &f.recorder.spikes.size.0, |e| &mut e.recorder.spikes.size),
    ("recorder.gaps.probability", Ratio, |f| &f.recorder.gaps.probability.0, |e| &mut e.recorder.gaps.probability),
    ("recorder.gaps.length", Ratio, |f| &f.recorder.gaps.length.0, |e| &mut e.recorder.gaps.size),
    ("recorder.repeats", Ratio, |f| &f.recorder.repeats.0, |e| &mut e.recorder.repeats),
    ("tachometer.rate", Frequency, |f| &f.tachometer.rate.0, |e| &mut e.tachometer.rate),
    ("tachometer.clock_offset", Time, |f| &f.tachometer.clock_offset.0, |e| &mut e.tachometer.clock_offset),
    ("tachometer.clock_drift", Ratio, |f| &f.tachometer.clock_drift.0, |e| &mut e.tachometer.clock_drift),
    ("tachometer.noise", Speed, |f| &f.tachometer.noise.0, |e| &mut e.tachometer.noise),
    ("tachometer.quantum", Speed, |f| &f.tachometer.quantum.0, |e| &mut e.tachometer.quantum),
    ("tachometer.scale_error", Ratio, |f| &f.tachometer.scale_error.0, |e| &mut e.tachometer.scale_error),
    ("tachometer.plateau_error", Ratio, |f| &f.tachometer.plateau_error.0, |e| &mut e.tachometer.plateau_error),
    ("hand.rest", Time, |f| &f.hand.rest.0, |e| &mut e.hand.rest),
    ("hand.rest_spread", Time, |f| &f.hand.rest_spread.0, |e| &mut e.hand.rest_spread),
    ("hand.turn", Time, |f| &f.hand.turn.0, |e| &mut e.hand.turn),
    ("hand.turn_spread", Time, |f| &f.hand.turn_spread.0, |e| &mut e.hand.turn_spread),
    ("hand.shake", Acceleration, |f| &f.hand.shake.0, |e| &mut e.hand.shake),
    ("hand.tremor.deviation", Angle, |f| &f.hand.tremor.deviation.0, |e| &mut e.hand.tremor.deviation),
    ("hand.tremor.time", Time, |f| &f.hand.tremor.time.0, |e| &mut e.hand.tremor.time),
    ("hand.bumps.probability", Ratio, |f| &f.hand.bumps.probability.0, |e| &mut e.hand.bumps.probability),
    ("hand.bumps.size", Acceleration, |f| &f.hand.bumps.size.0, |e| &mut e.hand.bumps.size),
    ("hand.bias_change", Acceleration, |f| &f.hand.bias_change.0, |e| &mut e.hand.bias_change),
];

impl Truth {
    /// Reads the truth of a session that follows `plan`. `seed` is the session's.
    ///
    /// # Errors
    /// If the file cannot be read or does not follow the form. If a quantity has another dimension, a setting is out of range, or a
    /// parameter belongs neither to the plan nor to an extension.
    pub fn read(file: &Path, plan: &Session, seed: u64) -> Result<Self, Error> {
        let text = read_settings(file, "a truth file")?;
        let form: TruthForm = from_toml(file, &text)?;
        let equipment = equipment(file, &form, &plan.speeds, plan.type_b.bias_change)?;
        let attitudes = |number| Simulation::draw_attitudes(equipment.hand.rests, seed, number);
        let tables = plan.rest_tables.iter().enumerate();
        let rests = tables.map(|(number, table)| table.as_planned(|| attitudes(number))).collect();
        let plan = plan.clone().with_rest_tables(rests);
        let (model, sources) = model(&plan, &form);
        let values = values(file, &form, &model, sources, seed)?;
        Ok(Self { file: file.to_owned(), plan, model, values, equipment })
    }
}

/// The equipment as the form gives it. Plateaus' speeds err as `speeds` states that they are set, and measured speeds as it states that
/// they are measured, unless the form says otherwise. So do biases change between the arm and rests, by `bias_change` [m/s^2].
fn equipment(file: &Path, form: &TruthForm, speeds: &Speeds, bias_change: f64) -> Result<Equipment, Error> {
    let mut equipment = Equipment::default();
    // Where the plateaus state measured speeds, the plan's are those.
    equipment.machine.speed_error =
        if speeds.is_in_files() { speeds.set_uncertainty } else { speeds.expected_uncertainty() };
    equipment.hand.bias_change = bias_change;
    let of = |source| speeds.measured.filter(|measured| measured.source == source);
    if let Some(reported) = of(SpeedSource::Telemetry) {
        equipment.tachometer.measures = true;
        equipment.tachometer.plateau_error = reported.uncertainty;
    }
    if let Some(counted) = of(SpeedSource::Pulses) {
        equipment.counter.per_revolution = counted.pulses_per_revolution;
        equipment.counter.plateau_error = counted.uncertainty;
    }
    equipment.tachometer.measures = form.tachometer.measures.unwrap_or(equipment.tachometer.measures);
    equipment.hand.rests = form.hand.rests.unwrap_or(equipment.hand.rests);
    for (name, dimension, given, number) in SETTINGS {
        if let (Some(quantity), Some((table, key))) = (given(form), name.split_once('.')) {
            *number(&mut equipment) = TomlPath::table(file, table).finite(key, quantity, dimension)?;
        }
    }
    equipment.check().map_err(|source| Error::Simulation { file: file.to_owned(), source })?;
    Ok(equipment)
}

/// The numbers of the equipment by table and key of a truth file, SI.
pub(crate) fn settings(mut equipment: Equipment) -> impl Iterator<Item = (&'static str, f64)> {
    SETTINGS.into_iter().map(move |(name, _, _, number)| (name, *number(&mut equipment)))
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
