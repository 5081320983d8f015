//! The unit of the readings, by the files, by gravity or by a tumble.

use centrical::STANDARD_GRAVITY;

use super::sighting::{Extremes, Raw, SeenMounting};
use super::tumbled::Tumbled;
use crate::error::{Error, Place};
use crate::experiment::OutputUnit as Output;
use crate::units::Dimension;

/// The unit of the readings: its name and how it was recognised.
pub(super) enum OutputUnit {
    Named(&'static str),
    ByGravity(&'static str, f64),
    /// No file names it, and no rest shows it.
    Unnamed,
    Raw {
        name: &'static str,
        unit: &'static str,
        coarse: Option<Raw>,
    },
}

/// The unit that the files name.
fn named(mountings: &[SeenMounting]) -> Result<Option<&'static str>, Error> {
    let files = mountings.iter().flat_map(|m| &m.group.records);
    let mut units = files.flat_map(|file| file.readings.iter().filter_map(move |label| Some((file, label.unit?))));
    let Some((_, first)) = units.next() else { return Ok(None) };
    match units.find(|(_, unit)| *unit != first) {
        None => Ok(Some(first)),
        Some((file, other)) => {
            let found = format!("readings in {other} beside readings in {first}");
            Err(Error::content(&file.path, Place::Whole, found, "one unit of all readings"))
        }
    }
}

impl OutputUnit {
    /// By the unit that the files name, else by the magnitude of the readings at rest.
    ///
    /// # Errors
    /// If the files name several.
    pub fn of(mountings: &[SeenMounting], extremes: &[Option<Extremes>]) -> Result<Self, Error> {
        Ok(match named(mountings)? {
            Some("V") => Self::Raw { name: "volts", unit: "V", coarse: Raw::by_gravity(extremes) },
            Some("counts") => Self::Raw { name: "counts", unit: "counts", coarse: Raw::by_gravity(extremes) },
            Some(unit) => Self::Named(unit),
            None => Self::by_gravity(extremes),
        })
    }

    fn by_gravity(extremes: &[Option<Extremes>]) -> Self {
        let Some(seen) = extremes.iter().flatten().next() else { return Self::Unnamed };
        let norm = seen.rest.iter().map(|f| f * f).sum::<f64>().sqrt();
        let is_near = |unit: &&str| {
            let factor = Dimension::Acceleration.factor(unit).unwrap_or(f64::NAN);
            (norm * factor / STANDARD_GRAVITY - 1.0).abs() < 0.1
        };
        match ["m/s^2", "g", "mg"].into_iter().find(is_near) {
            Some(unit) => Self::ByGravity(unit, norm),
            None => Self::Raw { name: "counts", unit: "counts", coarse: Raw::by_gravity(extremes) },
        }
    }

    /// Takes scale and bias of a raw output from a tumble.
    pub fn agree_with(&mut self, tumbled: &Tumbled, mountings: &[SeenMounting]) -> Result<(), Error> {
        let is_same = match self {
            Self::Raw { unit: "counts", .. } => tumbled.output_unit == Output::Counts,
            Self::Raw { .. } => tumbled.output_unit == Output::Volts,
            Self::Named(_) | Self::ByGravity(..) | Self::Unnamed => tumbled.output_unit == Output::Acceleration,
        };
        match self {
            _ if !is_same => {
                let record = &mountings[0].group.records[0].path;
                let found = format!("readings in {}", self.name());
                Err(Error::content(record, Place::Whole, found, "the unit of the tumble, which is another"))
            }
            Self::Raw { coarse, .. } => {
                *coarse = Some(tumbled.raw);
                Ok(())
            }
            Self::Named(_) | Self::ByGravity(..) | Self::Unnamed => Ok(()),
        }
    }

    fn name(&self) -> &'static str {
        match self {
            Self::Named(unit) | Self::ByGravity(unit, _) | Self::Raw { unit, .. } => unit,
            Self::Unnamed => "m/s^2",
        }
    }

    /// What takes readings to m/s^2, if it is known.
    pub fn raw(&self) -> Option<Raw> {
        match self {
            Self::Named(unit) | Self::ByGravity(unit, _) => {
                Dimension::Acceleration.factor(unit).map(|factor| Raw { scale: [1.0 / factor; 3], bias: [0.0; 3] })
            }
            Self::Unnamed => Some(Raw { scale: [1.0; 3], bias: [0.0; 3] }),
            Self::Raw { coarse, .. } => *coarse,
        }
    }
}
