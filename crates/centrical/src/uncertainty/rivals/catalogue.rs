//! The columns of every rival that a model leaves out.

use nalgebra::DMatrix;

use super::columns::{Column, Columns, Seen, columns_of};
use super::scatter::Scatter;
use crate::fit::Calibration;
use crate::model::{FitError, Kind, MeasurementModel, Parameter, Rival};
use crate::progress::{OnProgress, advance};

/// The rivals of a calibration that act on its observations.
pub struct Rivals<'c> {
    pub(super) calibration: &'c Calibration<'c>,
    pub(super) list: Vec<Suspect>,
    pub(in crate::uncertainty) scatter: Scatter,
}

/// One rival with its columns.
pub(in crate::uncertainty) struct Suspect {
    pub rival: Rival,
    /// Its unknowns, one per column.
    pub unknowns: Vec<Parameter>,
    pub columns: Columns,
    /// Above which square a combination of them is seen.
    pub least: DMatrix<f64>,
    /// What is seen of `s^T s`.
    pub seen: Seen,
}

impl Suspect {
    /// Part of chi^2 that the rival explains.
    pub fn statistic(&self) -> f64 {
        self.seen.statistic(&self.columns.along)
    }
}

impl<'c> Rivals<'c> {
    /// The rivals that the model of `calibration` leaves out. `progress` is called again and again.
    ///
    /// # Errors
    /// [`FitError`] when numbers overflow or the caller stops.
    pub fn of(calibration: &'c Calibration<'c>, progress: OnProgress<()>) -> Result<Self, FitError> {
        let left_out = calibration.data().model().left_out();
        let (terms, effects): (Vec<Rival>, Vec<Rival>) =
            left_out.into_iter().partition(|rival| matches!(rival, Rival::Terms(_)));
        let mut list = suspects(calibration, &terms, progress)?;
        list.extend(suspects(calibration, &effects, progress)?);
        Ok(Self { calibration, list, scatter: Scatter::of(calibration)? })
    }
}

/// The columns of `rivals`, all terms or all effects, that act on the observations.
fn suspects(calibration: &Calibration, rivals: &[Rival], progress: OnProgress<()>) -> Result<Vec<Suspect>, FitError> {
    let (gain, data) = (calibration.gain()?, calibration.data());
    let model = data.model();
    let richer = model.with_rivals(rivals);
    let first = first_further(model, &richer);
    let x = widened(calibration.fit().state(), first, &richer);
    let further: Vec<usize> = (first..richer.parameters().len()).collect();
    let mut further = columns_of(&further, (&richer, &x), data.observations(), progress)?.into_iter();
    let attitudes = attitude_uncertainties(calibration);
    let mut list = Vec::new();
    for &rival in rivals {
        advance(progress, ())?;
        let unknowns = rival.parameters(model.experiment(), model.error_model());
        let own: Vec<Column> = further.by_ref().take(unknowns.len()).collect();
        if own.iter().any(|column| !column.is_empty()) {
            let columns = Columns::new(gain, own);
            let least = columns.least(|n| attitudes[n]);
            let seen = Seen::of(columns.redundancy(), &least);
            list.push(Suspect { rival, unknowns, columns, least, seen });
        }
    }
    Ok(list)
}

/// Standard uncertainty of the attitude of each observation [rad]: of both tilts of a rest, 1 where one is undetermined, zero on the arm.
fn attitude_uncertainties(calibration: &Calibration) -> Vec<f64> {
    let (fit, model) = (calibration.fit(), calibration.data().model());
    let experiment = model.experiment();
    let mut squares = vec![0.0; experiment.positions.len()];
    for (j, parameter) in model.parameters().iter().enumerate() {
        if let Kind::Attitude { position, .. } = parameter.kind {
            squares[position] += fit.standard_uncertainty(j).unwrap_or(1.0).powi(2);
        }
    }
    let position = |n: usize| experiment.mountings[experiment.set_points[n].mounting].position;
    calibration.data().observations().iter().map(|o| squares[position(o.set_point)].sqrt()).collect()
}

/// Where the further unknowns of a richer model begin: behind the terms if it has further terms, else at the end.
fn first_further(model: &MeasurementModel, richer: &MeasurementModel) -> usize {
    let terms = model.error_model().terms.len();
    let is_of_terms = richer.error_model().terms.len() > terms;
    if is_of_terms { model.parameters().first_term() + terms } else { model.parameters().len() }
}

/// The state `x` of a fit among the unknowns of a richer model, whose further ones, from `first`, are zero.
fn widened(x: &[f64], first: usize, richer: &MeasurementModel) -> Vec<f64> {
    let further = richer.parameters().len() - x.len();
    let mut wide = x.to_vec();
    wide.splice(first..first, std::iter::repeat_n(0.0, further));
    wide
}
