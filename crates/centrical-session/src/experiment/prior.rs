//! Priors: standard uncertainties of parameters and groups, with their units.

use std::collections::BTreeMap;
use std::path::Path;

use centrical::{MeasurementModel, PriorError};

use super::form::PriorValue;
use super::terms::ASKEW;
use super::toml_path::TomlPath;
use crate::error::Error;
use crate::quantity::Quantity;

/// How far a standard uncertainty may be from the typical magnitude of its parameter, either way.
const FIRMEST: f64 = 1e12;

/// A prior as written.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PriorEntry {
    name: String,
    value: PriorValue,
}

impl PriorEntry {
    /// That of a misalignment which the terms of rests leave out.
    pub fn askew(name: String) -> Self {
        let standard_uncertainty = Quantity::Text(ASKEW.to_owned());
        Self { name, value: PriorValue { mean: None, standard_uncertainty } }
    }

    /// Whether the name stands for a parameter of the model.
    pub fn is_of(&self, model: &MeasurementModel) -> bool {
        !model.parameters().select(&self.name).is_empty()
    }
}

/// The entries of the table `[prior]`, by name.
pub(crate) fn entries(table: &BTreeMap<String, PriorValue>) -> Vec<PriorEntry> {
    let entry = |(name, value): (&String, &PriorValue)| PriorEntry { name: name.clone(), value: value.clone() };
    table.iter().map(entry).collect()
}

/// The model with the priors.
pub(crate) fn with_priors(
    file: &Path,
    mut model: MeasurementModel,
    entries: &[PriorEntry],
) -> Result<MeasurementModel, Error> {
    let at = TomlPath::table(file, "prior");
    for entry in entries {
        let PriorEntry { name, value: PriorValue { mean, standard_uncertainty } } = entry;
        let sigma = in_si(&at, &model, name, standard_uncertainty)?;
        within_reason(&at, &model, name, standard_uncertainty, sigma)?;
        let mean = mean.as_ref().map_or(Ok(0.0), |mean| in_si(&at, &model, name, mean))?;
        model = model.with_prior_about(name, mean, sigma).map_err(|error| refusal(&at, name, error))?;
    }
    Ok(model)
}

/// A standard uncertainty of what `name` selects, in the unit of its parameters.
pub(crate) fn uncertainty_of(
    at: &TomlPath,
    model: &MeasurementModel,
    name: &str,
    quantity: &Quantity,
) -> Result<f64, Error> {
    let value = in_si(at, model, name, quantity)?;
    within_reason(at, model, name, quantity, value)?;
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(at.unexpected(name, quantity.to_string(), "a standard uncertainty above 0"))
    }
}

/// Refuses an uncertainty whose squares or quotients overflow. One that is not positive is left to others.
fn within_reason(
    at: &TomlPath,
    model: &MeasurementModel,
    name: &str,
    quantity: &Quantity,
    sigma: f64,
) -> Result<(), Error> {
    let selected = model.parameters().select(name);
    let typical = selected.iter().map(|j| model.parameters()[*j].typical).fold(0.0, f64::max);
    let (least, most) = (typical / FIRMEST, typical * FIRMEST);
    if sigma <= 0.0 || (least..=most).contains(&sigma) {
        return Ok(());
    }
    let expected = format!("a standard uncertainty from {least:.0e} to {most:.0e} (SI)");
    Err(at.unexpected(name, quantity.to_string(), expected))
}

/// The uncertainty in the unit of the parameters that are meant.
fn in_si(at: &TomlPath, model: &MeasurementModel, name: &str, quantity: &Quantity) -> Result<f64, Error> {
    let Some(first) = model.parameters().select(name).first().map(|&j| &model.parameters()[j]) else {
        let unknown = PriorError::Unknown { name: name.to_owned(), example: model.parameters()[0].name.clone() };
        return Err(refusal(at, name, unknown));
    };
    at.of_parameter(name, quantity, first)
}

fn refusal(at: &TomlPath, name: &str, error: PriorError) -> Error {
    let (found, expected) = match error {
        PriorError::Unknown { example, .. } => {
            ("no such parameter or group".to_owned(), format!("a name such as {example}, or the stem of several, dR"))
        }
        PriorError::MixedUnits { units, .. } => {
            (format!("parameters in {} and in {}", units[0], units[1]), "parameters of one unit".to_owned())
        }
        PriorError::NotPositive { found, .. } => {
            (format!("a standard uncertainty of {found}"), "a positive number".to_owned())
        }
        PriorError::Mean { found, .. } => (format!("a mean of {found}"), "a finite number".to_owned()),
        PriorError::Duplicate { parameter, .. } => (format!("a second prior on {parameter}"), "one".to_owned()),
    };
    at.unexpected(name, found, expected)
}
