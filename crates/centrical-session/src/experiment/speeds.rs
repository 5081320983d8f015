//! What `[centrifuge]` says of speeds: how well they are set, and how they are measured if they are.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::form::{CentrifugeTable, MeasuredTable, PresetCentrifugeTable};
use super::toml_path::TomlPath;
use crate::error::{Error, quoted};
use crate::quantity::Quantity;
use crate::units::Dimension;

/// How the speeds of plateaus are known.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Speeds {
    /// Relative standard uncertainty with which a speed is set.
    pub set_uncertainty: f64,
    /// Relative standard uncertainty of the scale of the telemetry, for its comparison with the schedule.
    pub tachometer_uncertainty: Option<f64>,
    /// How speeds are measured; `None` if they are only set.
    pub measured: Option<Measured>,
}

/// A measurement of speeds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// By what.
    pub source: SpeedSource,
    /// Relative standard uncertainty of each plateau's speed beyond its scatter.
    pub uncertainty: f64,
    /// Relative standard uncertainty of the common scale, if it is stated here.
    pub scale: Option<f64>,
    /// Pulses in a revolution.
    pub pulses_per_revolution: f64,
}

/// By what speeds are measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SpeedSource {
    /// The telemetry of each mounting.
    Telemetry,
    /// Times of the pulses of an index mark or an encoder.
    Pulses,
    /// The plateaus themselves state their measured speeds: in the schedule, or in the table of plateaus.
    Plateaus,
}

impl SpeedSource {
    const ALL: [Self; 3] = [Self::Telemetry, Self::Pulses, Self::Plateaus];

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Telemetry => "telemetry",
            Self::Pulses => "pulses",
            Self::Plateaus => "plateaus",
        }
    }
}

impl Speeds {
    /// Relative standard uncertainty of the speed of a plateau as far as it is known before any record is read.
    pub fn expected_uncertainty(&self) -> f64 {
        self.measured.map_or(self.set_uncertainty, |measured| measured.uncertainty)
    }

    /// Relative standard uncertainty of the common scale of measured speeds, 0 if none is stated.
    pub fn scale(&self) -> f64 {
        self.measured.and_then(|measured| measured.scale).unwrap_or(0.0)
    }

    /// Whether speeds are measured by a counter of pulses.
    pub fn counts_pulses(&self) -> bool {
        self.measured.is_some_and(|measured| measured.source == SpeedSource::Pulses)
    }

    /// Whether the speeds of plateaus come from files beside the records.
    pub fn is_in_files(&self) -> bool {
        self.measured.is_some_and(|measured| measured.source != SpeedSource::Plateaus)
    }
}

/// The speeds of a session or a plan.
pub(crate) fn speeds(file: &Path, table: &CentrifugeTable) -> Result<Speeds, Error> {
    let at = TomlPath::table(file, "centrifuge");
    let tachometer = table.tachometer_uncertainty.as_ref();
    Ok(Speeds {
        set_uncertainty: ratio(&at, "speed_uncertainty", &table.speed_uncertainty)?,
        tachometer_uncertainty: tachometer.map(|q| ratio(&at, "tachometer_uncertainty", q)).transpose()?,
        measured: table.measured.as_ref().map(|table| measured(&at, table)).transpose()?,
    })
}

/// The speeds of a preset plan, exact if it states nothing.
pub(crate) fn preset_speeds(file: &Path, table: &PresetCentrifugeTable) -> Result<Speeds, Error> {
    let at = TomlPath::table(file, "centrifuge");
    let set = table.speed_uncertainty.as_ref().map(|q| ratio(&at, "speed_uncertainty", q)).transpose()?;
    let measured = table.measured.as_ref().map(|table| measured(&at, table)).transpose()?;
    Ok(Speeds { set_uncertainty: set.unwrap_or(0.0), tachometer_uncertainty: None, measured })
}

/// The uncertainty of one plateau's measured speed.
pub(crate) fn of_plateau(at: &TomlPath, key: &str, quantity: &Quantity) -> Result<f64, Error> {
    ratio(at, key, quantity)
}

fn measured(at: &TomlPath, table: &MeasuredTable) -> Result<Measured, Error> {
    let source = SpeedSource::ALL.into_iter().find(|source| source.name() == table.from).ok_or_else(|| {
        let known = SpeedSource::ALL.map(|source| format!("{:?}", source.name())).join(", ");
        at.unexpected("measured.from", quoted(table.from.as_bytes()), format!("one of {known}"))
    })?;
    let pulses = table.pulses_per_revolution.unwrap_or(1.0);
    if !(1.0..=1e7).contains(&pulses) || pulses.fract() != 0.0 {
        let expected = "a whole number of pulses, 1 to 1e7";
        return Err(at.unexpected("measured.pulses_per_revolution", pulses.to_string(), expected));
    }
    Ok(Measured {
        source,
        uncertainty: ratio(at, "measured.uncertainty", &table.uncertainty)?,
        scale: table.scale.as_ref().map(|q| ratio(at, "measured.scale", q)).transpose()?,
        pulses_per_revolution: pulses,
    })
}

fn ratio(at: &TomlPath, key: &str, quantity: &Quantity) -> Result<f64, Error> {
    let meaning = "a relative standard uncertainty, zero or more and below 1";
    at.bounded(key, quantity, Dimension::Ratio, (0.0, 1.0), meaning)
}
