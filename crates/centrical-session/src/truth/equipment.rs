//! The tables of a truth file that say what the equipment is like. What is not given is perfect.

use std::path::Path;

use centrical::simulate::{
    Bumps, Coloured, Counter, Equipment, Hand, Losses, Machine, Recorder, Sensor, Spikes, Tachometer, Tremor,
};
use schemars::JsonSchema;
use serde::Deserialize;

use crate::error::Error;
use crate::experiment::{SpeedSource, Speeds, TomlPath};
use crate::quantity::Dimension::{Acceleration, Angle, Frequency, Ratio, Speed, Time};
use crate::quantity::{Dimension, Quantity};

/// A quantity that may be left out.
#[derive(Debug, Default, Deserialize, JsonSchema)]
struct Given(Option<Quantity>);

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct MachineTable {
    plateau: Given,
    plateau_spread: Given,
    ramp: Given,
    speed_error: Given,
    settling: Given,
    settling_time: Given,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct SensorTable {
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
pub(crate) struct RecorderTable {
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
pub(crate) struct TachometerTable {
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
pub(crate) struct CounterTable {
    jitter: Given,
    scale_error: Given,
    plateau_error: Given,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct HandTable {
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

impl Given {
    /// In SI, or `otherwise`.
    fn or(&self, otherwise: f64, at: &TomlPath, key: &str, dimension: Dimension) -> Result<f64, Error> {
        self.0.as_ref().map_or(Ok(otherwise), |quantity| at.finite(key, quantity, dimension))
    }
}

/// The tables of a truth file.
pub(crate) type Tables<'a> =
    (&'a MachineTable, &'a SensorTable, &'a RecorderTable, &'a TachometerTable, &'a CounterTable, &'a HandTable);

/// The equipment as the tables of `file` give it. Plateaus' speeds err as `speeds` states that they are set, and measured
/// speeds as it states that they are measured, unless the tables say otherwise. So do biases change between the arm and rests, by
/// `bias_change` [m/s^2].
pub(crate) fn equipment(
    file: &Path,
    (machine, sensor, recorder, tachometer, counter, hand): Tables,
    speeds: &Speeds,
    bias_change: f64,
) -> Result<Equipment, Error> {
    // Where the plateaus state measured speeds, the plan's are those.
    let speed_error = if speeds.is_in_files() { speeds.set_uncertainty } else { speeds.expected_uncertainty() };
    let of = |source| speeds.measured.filter(|measured| measured.source == source);
    let reported = of(SpeedSource::Telemetry);
    let usual = Tachometer {
        measures: reported.is_some(),
        plateau_error: reported.map_or(0.0, |measured| measured.uncertainty),
        ..Tachometer::default()
    };
    let counted = of(SpeedSource::Pulses).map_or_else(Counter::default, |measured| Counter {
        per_revolution: measured.pulses_per_revolution,
        plateau_error: measured.uncertainty,
        ..Counter::default()
    });
    let equipment = Equipment {
        counter: counter.read(&TomlPath::table(file, "counter"), &counted)?,
        machine: machine.read(&TomlPath::table(file, "machine"), &Machine { speed_error, ..Machine::default() })?,
        sensor: sensor.read(&TomlPath::table(file, "sensor"), &Sensor::default())?,
        recorder: recorder.read(&TomlPath::table(file, "recorder"), &Recorder::default())?,
        tachometer: tachometer.read(&TomlPath::table(file, "tachometer"), &usual)?,
        hand: hand.read(&TomlPath::table(file, "hand"), &Hand { bias_change, ..Hand::default() })?,
    };
    equipment.check().map_err(|source| Error::Simulation { file: file.to_owned(), source })?;
    Ok(equipment)
}

impl MachineTable {
    fn read(&self, at: &TomlPath, usual: &Machine) -> Result<Machine, Error> {
        Ok(Machine {
            plateau: self.plateau.or(usual.plateau, at, "plateau", Time)?,
            plateau_spread: self.plateau_spread.or(usual.plateau_spread, at, "plateau_spread", Time)?,
            ramp: self.ramp.or(usual.ramp, at, "ramp", Time)?,
            speed_error: self.speed_error.or(usual.speed_error, at, "speed_error", Ratio)?,
            settling: self.settling.or(usual.settling, at, "settling", Ratio)?,
            settling_time: self.settling_time.or(usual.settling_time, at, "settling_time", Time)?,
        })
    }
}

impl SensorTable {
    fn read(&self, at: &TomlPath, usual: &Sensor) -> Result<Sensor, Error> {
        let Coloured { deviation, time } = usual.coloured;
        Ok(Sensor {
            white: self.white.or(usual.white, at, "white", Acceleration)?,
            coloured: Coloured {
                deviation: self.coloured.deviation.or(deviation, at, "coloured.deviation", Acceleration)?,
                time: self.coloured.time.or(time, at, "coloured.time", Time)?,
            },
            bias_instability: self.bias_instability.or(usual.bias_instability, at, "bias_instability", Acceleration)?,
            random_walk: self.random_walk.or(usual.random_walk, at, "random_walk", Acceleration)?,
            drift: self.drift.or(usual.drift, at, "drift", Acceleration)?,
            quantum: self.quantum.or(usual.quantum, at, "quantum", Acceleration)?,
            range: self.range.as_ref().map(|range| at.finite("range", range, Acceleration)).transpose()?,
        })
    }
}

impl RecorderTable {
    fn read(&self, at: &TomlPath, usual: &Recorder) -> Result<Recorder, Error> {
        let Recorder { spikes, gaps, .. } = usual;
        Ok(Recorder {
            rate: self.rate.or(usual.rate, at, "rate", Frequency)?,
            spikes: Spikes {
                probability: self.spikes.probability.or(spikes.probability, at, "spikes.probability", Ratio)?,
                size: self.spikes.size.or(spikes.size, at, "spikes.size", Acceleration)?,
            },
            gaps: Losses {
                probability: self.gaps.probability.or(gaps.probability, at, "gaps.probability", Ratio)?,
                length: self.gaps.length.or(gaps.length, at, "gaps.length", Ratio)?,
            },
            repeats: self.repeats.or(usual.repeats, at, "repeats", Ratio)?,
        })
    }
}

impl TachometerTable {
    fn read(&self, at: &TomlPath, usual: &Tachometer) -> Result<Tachometer, Error> {
        Ok(Tachometer {
            rate: self.rate.or(usual.rate, at, "rate", Frequency)?,
            clock_offset: self.clock_offset.or(usual.clock_offset, at, "clock_offset", Time)?,
            clock_drift: self.clock_drift.or(usual.clock_drift, at, "clock_drift", Ratio)?,
            noise: self.noise.or(usual.noise, at, "noise", Speed)?,
            quantum: self.quantum.or(usual.quantum, at, "quantum", Speed)?,
            measures: self.measures.unwrap_or(usual.measures),
            scale_error: self.scale_error.or(usual.scale_error, at, "scale_error", Ratio)?,
            plateau_error: self.plateau_error.or(usual.plateau_error, at, "plateau_error", Ratio)?,
        })
    }
}

impl CounterTable {
    fn read(&self, at: &TomlPath, usual: &Counter) -> Result<Counter, Error> {
        Ok(Counter {
            per_revolution: usual.per_revolution,
            jitter: self.jitter.or(usual.jitter, at, "jitter", Time)?,
            scale_error: self.scale_error.or(usual.scale_error, at, "scale_error", Ratio)?,
            plateau_error: self.plateau_error.or(usual.plateau_error, at, "plateau_error", Ratio)?,
        })
    }
}

impl HandTable {
    fn read(&self, at: &TomlPath, usual: &Hand) -> Result<Hand, Error> {
        let Hand { tremor, bumps, .. } = usual;
        Ok(Hand {
            rests: self.rests.unwrap_or(usual.rests),
            rest: self.rest.or(usual.rest, at, "rest", Time)?,
            rest_spread: self.rest_spread.or(usual.rest_spread, at, "rest_spread", Time)?,
            turn: self.turn.or(usual.turn, at, "turn", Time)?,
            turn_spread: self.turn_spread.or(usual.turn_spread, at, "turn_spread", Time)?,
            shake: self.shake.or(usual.shake, at, "shake", Acceleration)?,
            tremor: Tremor {
                deviation: self.tremor.deviation.or(tremor.deviation, at, "tremor.deviation", Angle)?,
                time: self.tremor.time.or(tremor.time, at, "tremor.time", Time)?,
            },
            bumps: Bumps {
                probability: self.bumps.probability.or(bumps.probability, at, "bumps.probability", Ratio)?,
                size: self.bumps.size.or(bumps.size, at, "bumps.size", Acceleration)?,
            },
            bias_change: self.bias_change.or(usual.bias_change, at, "bias_change", Acceleration)?,
        })
    }
}
