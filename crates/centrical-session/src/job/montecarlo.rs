//! The whole calibration repeated on drawn readings, of a session or of a plan.

use std::path::{Path, PathBuf};

use centrical::plan::Prediction;
use centrical::uncertainty::{MonteCarlo, Settings};
use centrical::{Calibration, Data, FitError, MeasurementModel, Observation, OnProgress, STANDARD_GRAVITY, Weight};
use nalgebra::Vector3;

use super::calibrate::Problem;
use crate::document::{MonteCarloReport, Subject};
use crate::error::{Error, Place};
use crate::experiment::{PlannedSession, Session};

/// How often what is repeated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MonteCarloRequest {
    /// Calibrations.
    pub runs: usize,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Probability that the intervals are to cover, in (0, 1).
    pub coverage: f64,
    /// Whether the linear fit of [K5.3] alone is repeated.
    pub linear: bool,
}

impl MonteCarloRequest {
    /// A number of calibrations: two at least, since one has no spread, and no more than can be repeated: ten million take an hour.
    ///
    /// # Errors
    /// What was found and expected.
    pub fn runs(runs: usize) -> Result<usize, String> {
        let is_number = (2..=10_000_000).contains(&runs);
        is_number.then_some(runs).ok_or_else(|| format!("found {runs}, expected 2 to 10,000,000 calibrations"))
    }

    fn settings(&self) -> Settings {
        Settings { runs: self.runs, seed: self.seed, coverage: self.coverage, is_linear: self.linear }
    }
}

/// What is drawn from.
#[derive(Debug, Clone, PartialEq)]
pub struct MonteCarloCase {
    /// The model.
    pub model: MeasurementModel,
    /// True values of the unknowns, SI.
    pub truth: Vec<f64>,
    /// Which noise is drawn, in words.
    pub weighted_by: String,
    file: PathBuf,
    /// Their means are not used.
    observations: Vec<Observation>,
}

impl MonteCarloCase {
    /// A session: the estimates of its own calibration are true. `progress` is called with the number of bytes read, from
    /// any thread; most bytes are read twice.
    ///
    /// # Errors
    /// [`Error`] naming the file, the place, what was found and what was expected.
    pub fn measured(session: &Session, progress: OnProgress) -> Result<Self, Error> {
        let Problem { model, reduced, .. } = Problem::as_stated(session, progress)?;
        let (observations, file) = (reduced.observations(), session.file.clone());
        let truth = estimated(&model, observations.clone()).map_err(|source| Error::fit(&file, source))?;
        Ok(Self { model, truth, weighted_by: Subject::DATA.to_owned(), file, observations })
    }

    /// A plan: the unit that it is predicted for. `noise` is the white noise of every mean in micro-g, in place of the
    /// plan's own.
    ///
    /// # Errors
    /// [`Error::Fit`] when a weight is invalid.
    pub fn planned(plan: PlannedSession, noise: Option<f64>) -> Result<Self, Error> {
        let weighted_by =
            noise.map_or_else(|| plan.weighted_by(), |noise| format!("a noise of {noise} ug of every mean"));
        let PlannedSession { file, model, nominal, weights, .. } = plan;
        let truth = Prediction::unit_of(&model, &weights, &nominal).map_err(|source| Error::fit(&file, source))?;
        let equal = |noise: f64| Weight::equal(weights.len(), noise * 1e-6 * STANDARD_GRAVITY);
        let weights = noise.map_or_else(|| weights.clone(), equal);
        let observation =
            |Weight { set_point, covariance }| Observation { set_point, mean: Vector3::zeros(), covariance };
        let observations = weights.into_iter().map(observation).collect();
        Ok(Self { model, truth, weighted_by, file, observations })
    }

    /// Refuses `noise` for a session, whose means have their own.
    ///
    /// # Errors
    /// [`Error::Content`] if there is some.
    pub fn refuse_noise(session: &Path, noise: Option<f64>) -> Result<(), Error> {
        let expected = "no noise, as the means of a session have their own, or a plan";
        noise.map_or(Ok(()), |ug| Err(Error::content(session, Place::Whole, format!("a noise of {ug} ug"), expected)))
    }

    /// Takes a unit of typical errors with alternating signs for the true one.
    #[must_use]
    pub fn of_typical_unit(mut self) -> Self {
        self.truth = self.model.parameters().typical_alternating();
        self
    }

    /// Repeats the calibration. `progress` is called with the number of calibrations that were done.
    ///
    /// # Errors
    /// [`Error::Fit`] when a weight is invalid; [`Error::Stopped`].
    pub fn run(&self, request: &MonteCarloRequest, progress: OnProgress<usize>) -> Result<MonteCarlo, Error> {
        Data::new(&self.model, self.observations.clone())
            .and_then(|data| MonteCarlo::of(&data, &self.truth, &request.settings(), progress))
            .map_err(|source| Error::fit(&self.file, source))
    }

    /// What the runs of `request` show, as a JSON document.
    pub fn report(&self, request: &MonteCarloRequest, monte_carlo: &MonteCarlo) -> MonteCarloReport {
        MonteCarloReport::of(self.model.parameters(), &self.truth, &self.weighted_by, &request.settings(), monte_carlo)
    }
}

fn estimated(model: &MeasurementModel, observations: Vec<Observation>) -> Result<Vec<f64>, FitError> {
    let data = Data::new(model, observations)?;
    Ok(Calibration::exact(&data)?.fit().state().to_vec())
}
