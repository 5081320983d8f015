//! What the residuals say of effects that the model leaves out, and what the result rests on.

use centrical::uncertainty::{RivalTest, Suspects, Unseen};
use centrical::{Experiment, Extension, Group, MeasurementModel, Rival};
use serde::{Deserialize, Serialize};

use crate::units::rpm;

/// In the formula of a speed, where its value stands.
const ONE_SET_SPEED: &str = "one set speed";

/// A rival that the residuals show.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RivalSummary {
    /// Its name, as `error_model` or `extensions` take it.
    pub name: String,
    /// What it adds to a reading.
    pub formula: String,
    /// Part of chi^2 that it explains.
    pub chi_squared: f64,
    /// Its degrees of freedom.
    pub degrees_of_freedom: usize,
    /// Probability of so large a part by chance among all rivals tested.
    pub probability: f64,
    /// Probability of as large a chi^2 as it leaves by the stated uncertainties; null in results of older programs.
    #[serde(default)]
    pub probability_of_rest: Option<f64>,
    /// Whether it explains most for its number of unknowns, or the data cannot tell it from the one that does.
    pub explains_most: bool,
    /// Sizes of its unknowns, where the residuals tell them from the unknowns of the fit.
    pub unknowns: Vec<RivalSize>,
}

/// The size of one unknown of a rival, as the residuals show it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RivalSize {
    /// Name of the unknown.
    pub name: String,
    /// Unit, SI.
    pub unit: String,
    /// The group it belongs to.
    #[serde(with = "crate::document::json")]
    pub group: Group,
    /// Size.
    pub value: Option<f64>,
    /// Its standard uncertainty.
    pub standard_uncertainty: Option<f64>,
}

/// An effect whose absence the result rests on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RestsOn {
    /// Name of the rival.
    pub name: String,
    /// Its unknown that does most harm unseen.
    pub unknown: String,
    /// Unit of the unknown, SI.
    pub unit: String,
    /// The group of the unknown.
    #[serde(with = "crate::document::json")]
    pub group: Group,
    /// Smallest size that the session shows with a probability of 80 %; null when it shows none.
    pub smallest_shown: Option<f64>,
    /// The parameter of the instrument that an effect of that size moves most; of typical size where no size shows.
    pub parameter: String,
    /// How far it moves it, SI.
    pub shift: f64,
    /// The same in standard uncertainties of the parameter.
    pub standard_uncertainties: f64,
    /// Largest error of a compensated reading at the forces of the session [m/s^2].
    pub reading: f64,
    /// Factor on the standard uncertainty of the parameter if the effect were an unknown of the fit; null when the data would
    /// then not determine every parameter of the instrument that they determine now.
    pub price_as_unknown: Option<f64>,
}

impl RivalSummary {
    pub(crate) fn all(suspects: &Suspects, experiment: &Experiment) -> Vec<Self> {
        let shown = suspects.shown.iter().enumerate();
        shown.map(|(n, test)| Self::new(test, n < suspects.alike, experiment)).collect()
    }

    fn new(test: &RivalTest, explains_most: bool, experiment: &Experiment) -> Self {
        let unknowns = test.sizes.iter().map(|(unknown, size)| RivalSize {
            name: unknown.name.clone(),
            unit: unknown.unit.clone(),
            group: unknown.group,
            value: size.map(|(value, _)| value),
            standard_uncertainty: size.map(|(_, u)| u),
        });
        Self {
            name: test.rival.name(),
            formula: formula(test.rival, experiment),
            chi_squared: test.statistic,
            degrees_of_freedom: test.degrees_of_freedom,
            probability: test.family_wise,
            probability_of_rest: Some(test.probability_of_rest),
            explains_most,
            unknowns: unknowns.collect(),
        }
    }

    /// The rival of the catalogue, unless the result is of a later program.
    pub fn rival(&self) -> Option<Rival> {
        Rival::named(&self.name)
    }
}

/// What a rival adds to a reading; of one set speed with its value.
fn formula(rival: Rival, experiment: &Experiment) -> String {
    let speeds = experiment.set_speeds();
    match rival {
        Rival::Effect(Extension::OneSpeed(speed) | Extension::Resonance(speed)) if speed < speeds.len() => {
            let omega = experiment.set_points[speeds[speed].0].omega.abs();
            rival.formula().replace(ONE_SET_SPEED, &format!("{:.2} rpm", rpm(omega)))
        }
        _ => rival.formula().to_owned(),
    }
}

impl RestsOn {
    pub(crate) fn all(model: &MeasurementModel, unseen: Vec<Unseen>) -> Vec<Self> {
        let parameters = model.parameters();
        let entry = |unseen: Unseen| Self {
            name: unseen.rival.name(),
            unknown: unseen.unknown.name,
            unit: unseen.unknown.unit,
            group: unseen.unknown.group,
            smallest_shown: unseen.size,
            parameter: parameters[unseen.parameter].name.clone(),
            shift: unseen.shift,
            standard_uncertainties: unseen.standard_uncertainties,
            reading: unseen.reading,
            price_as_unknown: unseen.price,
        };
        unseen.into_iter().map(entry).collect()
    }

    /// The rival of the catalogue, unless the result is of a later program.
    pub fn rival(&self) -> Option<Rival> {
        Rival::named(&self.name)
    }
}
