//! Why calibrations have no history.

use std::collections::BTreeSet;
use std::path::PathBuf;

use super::calibrated::Calibrated;
use crate::error::{Error, Place};
use crate::quantity::Date;

/// Why calibrations have no history of the kind that is asked for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NoHistory {
    /// They are of several models of units, or of several stations.
    Several {
        /// The option that picks one.
        option: &'static str,
        /// Models or stations.
        names: BTreeSet<String>,
    },
    /// They are of several units, or of none: their number, and their names.
    Units(String),
    /// A day that is asked for is before that of the last calibration.
    Early {
        /// The option of the day.
        option: &'static str,
        /// The day.
        day: Date,
        /// That of the last calibration.
        last: Date,
    },
    /// Too few calibrations of a unit have a parameter in common: the number of all.
    Few(usize),
    /// No parameter is determined by calibrations of all units.
    NothingInCommon,
    /// There is no calibration.
    Nothing,
    /// No session determines the parameter of a chart.
    Unknown(String),
    /// Too few acceptable sessions for the limits of a chart.
    TooFew {
        /// How many there are.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
    /// Values of the acceptable sessions are equal: they give a chart no limits.
    Equal(usize),
}

/// Sessions with a range between them.
pub(super) const FEWEST: usize = 2;

impl NoHistory {
    /// What was found.
    pub fn found(&self) -> String {
        match self {
            Self::Several { names, .. } => listed(names.iter().map(|name| format!("\"{name}\""))),
            Self::Units(units) => units.clone(),
            Self::Early { option, day, .. } => format!("{option} {day}"),
            Self::Few(found) => format!("{found} calibration"),
            Self::NothingInCommon => "no parameter that all determine".to_owned(),
            Self::Nothing => "no calibration".to_owned(),
            Self::Unknown(name) => format!("no session that determines {name}"),
            Self::TooFew { found, .. } => counted(*found),
            Self::Equal(found) => format!("{} with one value in all", counted(*found)),
        }
    }

    /// What was expected.
    pub fn expected(&self) -> String {
        match self {
            Self::Several { option, .. } => format!("one, by {option}"),
            Self::Units(_) => "calibrations of one, by --serial and --model".to_owned(),
            Self::Early { last, .. } => format!("{last}, the day of the last calibration, or a later one"),
            Self::Few(_) => "two or more with a parameter in common".to_owned(),
            Self::NothingInCommon => "calibrations with one in common".to_owned(),
            Self::Nothing => "calibrations of one station".to_owned(),
            Self::Unknown(_) => "the name of a parameter in the results".to_owned(),
            Self::TooFew { expected, .. } if *expected <= FEWEST => {
                format!("{FEWEST} for the limits, or more by --accepted, or stated limits")
            }
            Self::TooFew { expected, .. } => {
                format!("{expected} for the limits, fewer by --accepted, or stated limits")
            }
            Self::Equal(_) => "values that scatter, or stated limits by --centre and --deviation".to_owned(),
        }
    }

    /// The error of the results that the calibrations were read from.
    pub fn of(&self, results: &[PathBuf]) -> Error {
        let first = results.first().cloned().unwrap_or_default();
        Error::content(&first, Place::Whole, self.found(), self.expected())
    }

    /// Refuses calibrations of several models of units.
    pub(super) fn refuse_several_models<'a>(all: impl Iterator<Item = &'a Calibrated>) -> Result<(), Self> {
        Self::refuse_several("--model", all.map(|calibrated| &calibrated.unit_model))
    }

    /// Refuses calibrations of several stations.
    pub(super) fn refuse_several_stations<'a>(all: impl Iterator<Item = &'a Calibrated>) -> Result<(), Self> {
        Self::refuse_several("--station", all.map(|calibrated| &calibrated.station))
    }

    fn refuse_several<'a>(option: &'static str, names: impl Iterator<Item = &'a String>) -> Result<(), Self> {
        let names: BTreeSet<&String> = names.collect();
        if names.len() < 2 {
            Ok(())
        } else {
            Err(Self::Several { option, names: names.into_iter().cloned().collect() })
        }
    }

    /// Of calibrations that are not all of one unit.
    pub(super) fn of_units(units: &[Vec<Calibrated>]) -> Self {
        let named = |unit: &Vec<Calibrated>| format!("model {:?} serial {:?}", unit[0].unit_model, unit[0].unit_serial);
        Self::Units(format!("{} units: {}", units.len(), listed(units.iter().map(named))))
    }
}

/// Names of a list.
const SHOWN: usize = 8;

/// The first of `names`, and the number of the others.
fn listed(names: impl ExactSizeIterator<Item = String>) -> String {
    let more = if names.len() > SHOWN { format!(" and {} more", names.len() - SHOWN) } else { String::new() };
    format!("{}{more}", names.take(SHOWN).collect::<Vec<_>>().join(", "))
}

fn counted(sessions: usize) -> String {
    format!("{sessions} acceptable session{}", if sessions == 1 { "" } else { "s" })
}
