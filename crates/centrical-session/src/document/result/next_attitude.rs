//! Which attitude to add to rests that only gravity shows.

use centrical::observability::attitude_in_words;
use centrical::{Calibration, FitError, Study, Weight};
use serde::{Deserialize, Serialize};

/// The best attitude to add, of the faces, edges and corners of a cube.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NextAttitudeSummary {
    /// Where up is, instrument axes, of length 1.
    pub up: [f64; 3],
    /// In words.
    pub text: String,
    /// Number of lost combinations that it brings back.
    pub gain: usize,
    /// Standard uncertainties of the coefficients after it over those before, on average; 1 where a combination comes back.
    pub factor: f64,
    /// The coefficient that it improves most.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parameter: Option<String>,
    /// The same ratio of its uncertainty.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parameter_factor: Option<f64>,
}

impl NextAttitudeSummary {
    /// That of a calibration by rests alone; `None` where anything is on an arm.
    pub(super) fn of(calibration: &Calibration) -> Result<Option<Self>, FitError> {
        let (model, observations) = (calibration.data().model(), calibration.data().observations());
        if model.experiment().has_arm() {
            return Ok(None);
        }
        let study = Study::at_zero(model.clone(), observations.iter().map(Weight::from).collect())?;
        Ok(study.next_attitude().map(|next| Self {
            up: next.up_z.into(),
            text: attitude_in_words(&next.up_z),
            gain: next.gain,
            factor: next.factor,
            parameter: next.most.map(|(j, _)| model.parameters()[j].name.clone()),
            parameter_factor: next.most.map(|(_, factor)| factor),
        }))
    }
}
