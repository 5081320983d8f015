//! A calibration as its history needs it: what was determined, and which of its errors other sessions share.

mod errors;
mod kinds;
mod output;

use std::sync::Arc;

use centrical::history::{Point, Series};
use centrical::uncertainty::Estimates;
use centrical_compensate::Term;
use nalgebra::{DMatrix, DVector};

use self::errors::{OwnErrors, SharedErrors};
use self::kinds::Role;
pub use self::kinds::{CalibratedParameter, Kinds, Places};
use self::output::{Restated, in_changes, in_covariance, in_values};
use super::of_data::OfData;
use crate::document::{OutputSummary, PastSession};
use crate::quantity::Date;
use crate::store::{Row, SharedInfluence, packed};

/// One calibration.
#[derive(Debug, Clone)]
pub struct Calibrated {
    /// Where it is: a file, or its key in a store.
    pub source: String,
    /// Model of the unit.
    pub unit_model: String,
    /// Serial number of the unit.
    pub unit_serial: String,
    /// The centrifuge, as its sessions call it; empty where they do not.
    pub station: String,
    /// Gravity at the place, as stated [m/s^2]; NaN where it is not known.
    gravity: f64,
    /// Day of the session.
    pub date: Date,
    /// The same as its session states it, with the time if there is one.
    pub stamp: String,
    /// Whether no check raised an objection.
    pub acceptable: bool,
    /// The raw output that its coefficients are relative to, if it is raw.
    pub output: Option<OutputSummary>,
    /// Its parameters; calibrations of one kind share them.
    pub(crate) parameters: Arc<Vec<CalibratedParameter>>,
    /// Estimates, SI; NaN where the data do not determine a parameter.
    pub values: Vec<f64>,
    /// Combined standard uncertainties, SI.
    pub standard_uncertainties: Vec<f64>,
    /// Combined covariance, SI, the lower triangle by rows; empty where it was not asked for.
    covariance: Vec<f64>,
    /// What errors leave that sessions of one station share.
    shared: Vec<SharedInfluence>,
    /// Errors of this session alone in the parameters of its unit, in place of `covariance` and `shared`.
    errors: Option<OwnErrors>,
    /// What the data alone say, if parameters of the unit had priors.
    of_data: Option<OfData>,
    /// The error model with the names of its coefficients, if covariances were read; NaN where a coefficient is not determined.
    pub terms: Option<Vec<(String, Term)>>,
    /// Largest magnitude of a specific force on any axis [m/s^2].
    pub range: f64,
}

/// Finds one parameter in many calibrations. Most share their list of parameters, which is searched once.
pub struct Finder<'a> {
    name: &'a str,
    last: Option<(Arc<Vec<CalibratedParameter>>, Option<usize>)>,
}

impl<'a> Finder<'a> {
    /// Looks for the parameter `name`.
    pub fn new(name: &'a str) -> Self {
        Self { name, last: None }
    }

    /// Its place, if it is determined.
    pub fn place(&mut self, calibrated: &Calibrated) -> Option<usize> {
        let place = match &self.last {
            Some((parameters, place)) if Arc::ptr_eq(parameters, &calibrated.parameters) => *place,
            _ => {
                let place = calibrated.parameters.iter().position(|p| p.name == self.name);
                self.last = Some((Arc::clone(&calibrated.parameters), place));
                place
            }
        };
        place.filter(|&j| calibrated.values[j].is_finite())
    }
}

impl Calibrated {
    /// The calibration in a row of a store, or of a result that is called `source`; `None` if its session has no day for a date.
    pub fn of(source: String, row: Row, kinds: &mut Kinds) -> Option<Self> {
        let date = row.date.parse().ok()?;
        Some(Self::on(date, source, row, kinds))
    }

    /// The calibration in a row, as one of a day.
    pub fn on(date: Date, source: String, row: Row, kinds: &mut Kinds) -> Self {
        let terms = row.terms.iter().map(|term| {
            let place = row.index(&term.name)?;
            term.with_coefficient(*row.values.get(place)?).ok()
        });
        let of_data = OfData::of(&row);
        Self {
            output: OutputSummary::of_row(&row),
            errors: None,
            of_data,
            source,
            date,
            acceptable: row.acceptable,
            parameters: kinds.of(&row),
            // A text for each coefficient: for the values of 100,000 calibrations it would be most of the memory.
            terms: if row.covariance.is_empty() { None } else { terms.collect() },
            range: row.range.iter().copied().fold(0.0, f64::max),
            stamp: row.date,
            unit_model: row.unit_model,
            unit_serial: row.unit_serial,
            station: row.station,
            gravity: row.gravity,
            values: row.values,
            standard_uncertainties: row.standard_uncertainties,
            covariance: row.covariance,
            shared: row.shared,
        }
    }

    /// The same with coefficients relative to another `output` of the same unit. Where the error model lacks a bias or a scale that other
    /// nominal values ask for, the coefficients of the axis are not determined.
    pub fn restate(&mut self, output: &OutputSummary) {
        let Some(own) = self.output.as_ref().filter(|own| *own != output && own.unit == output.unit) else { return };
        let has = |axis: usize, role: Role| self.parameters.iter().any(|p| p.coefficient == Some((axis, role)));
        let is_possible = [0, 1, 2].map(|axis| {
            let asks = |role| own.restated(output, axis, role).shift != 0.0 && !has(axis, role);
            !asks(Role::Bias) && !asks(Role::Scale)
        });
        let restated = |p: &CalibratedParameter| match p.coefficient {
            None => Restated { gain: 1.0, shift: 0.0 },
            Some((axis, role)) if is_possible[axis] => own.restated(output, axis, role),
            Some(_) => Restated { gain: f64::NAN, shift: 0.0 },
        };
        let restated: Vec<Restated> = self.parameters.iter().map(restated).collect();
        let of_unit: Vec<Restated> = self
            .parameters
            .iter()
            .zip(&restated)
            .filter(|(p, _)| p.is_of_unit)
            .map(|(_, restated)| *restated)
            .collect();
        in_values(&mut self.values, &restated);
        in_changes(&mut self.standard_uncertainties, &restated);
        in_covariance(&mut self.covariance, &restated);
        self.shared.iter_mut().for_each(|influence| in_changes(&mut influence.changes, &restated));
        if let Some(errors) = &mut self.errors {
            in_changes(&mut errors.deviations, &of_unit);
        }
        if let Some(data) = &mut self.of_data {
            in_values(&mut data.values, &restated);
            in_covariance(&mut data.covariance, &restated);
            data.shared.iter_mut().for_each(|influence| in_changes(&mut influence.changes, &restated));
        }
        let places: Vec<Option<usize>> =
            self.terms.iter().flatten().map(|(name, _)| self.parameters.iter().position(|p| p.name == *name)).collect();
        for ((_, term), place) in self.terms.iter_mut().flatten().zip(places) {
            term.coefficient = place.map_or(f64::NAN, |place| self.values[place]);
        }
        self.output = Some(output.clone());
    }

    /// What a history says of it.
    pub fn past(&self) -> PastSession {
        PastSession {
            source: self.source.clone(),
            unit_model: self.unit_model.clone(),
            unit_serial: self.unit_serial.clone(),
            station: self.station.clone(),
            date: self.date,
            stamp: Some(self.stamp.clone()).filter(|stamp| *stamp != self.date.to_string()),
            gravity: Some(self.gravity).filter(|gravity| gravity.is_finite()),
            acceptable: self.acceptable,
        }
    }

    /// The parameters of its unit, determined or not.
    pub fn listed(&self) -> impl Iterator<Item = &str> {
        self.parameters.iter().filter(|p| p.is_of_unit).map(|p| p.name.as_str())
    }

    /// The parameters of its unit that it determines.
    pub fn determined(&self) -> impl Iterator<Item = &str> {
        let own = self.parameters.iter().zip(&self.values).filter(|(p, value)| p.is_of_unit && value.is_finite());
        own.map(|(parameter, _)| parameter.name.as_str())
    }

    /// The same with the errors of its unit's parameters alone in place of all covariances, and as its result states it.
    #[must_use]
    pub fn condensed(self) -> Self {
        let errors = if self.covariance.is_empty() { None } else { Some(self.own_errors()) };
        Self { errors, covariance: Vec::new(), shared: Vec::new(), of_data: None, terms: None, ..self }
    }

    fn own_errors(&self) -> OwnErrors {
        let places: Vec<usize> = (0..self.parameters.len()).filter(|&j| self.parameters[j].is_of_unit).collect();
        let seen = self.seen(Basis::Stated);
        OwnErrors::of(places.len(), |a, b| seen.own_covariance(places[a], places[b]))
    }

    /// Estimates at `places` as the result states them, with the covariance of the errors that belong to this session alone; where covariances
    /// were not read, with their variances.
    pub fn stated_estimates(&self, places: &[usize]) -> Estimates {
        let seen = self.seen(Basis::Stated);
        let numbers: Option<Vec<usize>> = places.iter().map(|&place| self.number_in_unit(place)).collect();
        let n = places.len();
        let mut covariance = match (&self.errors, &numbers) {
            (Some(errors), Some(numbers)) => errors.covariances(numbers),
            _ => DMatrix::from_fn(n, n, |a, b| seen.own_covariance(places[a], places[b])),
        };
        let stated = covariance.diagonal();
        let variance = |(own, &j): (&f64, &usize)| own.max(CERTAIN * self.standard_uncertainties[j].powi(2));
        if !covariance.iter().all(|value| value.is_finite()) {
            covariance.fill(0.0);
        }
        covariance.set_diagonal(&DVector::from_iterator(n, stated.iter().zip(places).map(variance)));
        Estimates { values: DVector::from_fn(n, |a, _| self.values[places[a]]), covariance }
    }

    /// The number of a parameter among those of the unit.
    fn number_in_unit(&self, place: usize) -> Option<usize> {
        let is_of_unit = |place: usize| self.parameters[place].is_of_unit;
        is_of_unit(place).then(|| (0..place).filter(|&j| is_of_unit(j)).count())
    }

    /// The place of a parameter, if it is determined.
    pub fn place(&self, name: &str) -> Option<usize> {
        self.parameters.iter().position(|p| p.name == name).filter(|&j| self.values[j].is_finite())
    }

    /// What distinguishes units.
    pub fn unit(&self) -> (&str, &str) {
        (&self.unit_model, &self.unit_serial)
    }

    /// `sum_n c_n x_n` as the result states it.
    pub fn value(&self, combination: &[(usize, f64)]) -> f64 {
        combination.iter().map(|(j, c)| c * self.values[*j]).sum()
    }

    /// Combined variance of `sum_n c_n x_n` as the result states it.
    pub fn variance(&self, combination: &[(usize, f64)]) -> f64 {
        variance(combination, |i, j| self.covariance(i, j))
    }

    /// Whether the parameter at `place` is determined by priors alone.
    pub fn rests_on_priors(&self, place: usize) -> bool {
        self.of_data.as_ref().is_some_and(|data| data.rests_on_priors[place])
    }

    /// What a history takes of this session: the data alone; as it is stated, where that is asked for or it has no priors.
    fn seen(&self, basis: Basis) -> Seen<'_> {
        match (&self.of_data, basis) {
            (Some(data), Basis::Data) => {
                Seen { values: &data.values, covariance: Some(&data.covariance), shared: &data.shared, of: self }
            }
            _ => Seen { values: &self.values, covariance: None, shared: &self.shared, of: self },
        }
    }

    /// Values of `names` by the data and the covariance of the errors that belong to this session alone; `None` if one is not determined.
    pub fn own_estimates(&self, names: &[String]) -> Option<Estimates> {
        let places: Vec<usize> = names.iter().map(|name| self.place(name)).collect::<Option<_>>()?;
        let seen = self.seen(Basis::Data);
        let own = |a: usize, b: usize| seen.own_covariance(places[a], places[b]);
        let values = DVector::from_iterator(places.len(), places.iter().map(|&j| seen.values[j]));
        Some(Estimates { values, covariance: DMatrix::from_fn(places.len(), places.len(), own) })
    }

    /// Of a calibration without covariances only the variances are known.
    fn covariance(&self, i: usize, j: usize) -> f64 {
        let variance = || if i == j { self.standard_uncertainties[i].powi(2) } else { f64::NAN };
        self.covariance.get(packed(i, j)).copied().unwrap_or_else(variance)
    }
}

/// What a history takes of a session with priors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Basis {
    /// What its data alone say.
    Data,
    /// What its result states.
    Stated,
}

/// Estimates of a session, on one basis.
struct Seen<'a> {
    values: &'a [f64],
    covariance: Option<&'a [f64]>,
    shared: &'a [SharedInfluence],
    of: &'a Calibrated,
}

impl Seen<'_> {
    fn covariance(&self, i: usize, j: usize) -> f64 {
        self.covariance.map_or_else(|| self.of.covariance(i, j), |triangle| triangle[packed(i, j)])
    }

    /// Covariance of the errors of this session alone.
    fn own_covariance(&self, i: usize, j: usize) -> f64 {
        let by_unit =
            |errors: &OwnErrors| Some(errors.covariance(self.of.number_in_unit(i)?, self.of.number_in_unit(j)?));
        self.of.errors.as_ref().and_then(by_unit).unwrap_or_else(|| {
            let shared: f64 = self.shared.iter().map(|of| of.changes[i] * of.changes[j]).sum();
            self.covariance(i, j) - shared
        })
    }

    /// `sum_n c_n x_n`, its variance by errors of this session alone, and its change by each shared error.
    fn combined(&self, combination: &[(usize, f64)]) -> (f64, f64, Vec<f64>) {
        let value = combination.iter().map(|(j, c)| c * self.values[*j]).sum();
        let change = |influence: &SharedInfluence| combination.iter().map(|(j, c)| c * influence.changes[*j]).sum();
        let shared: Vec<f64> = self.shared.iter().map(change).collect();
        let all = variance(combination, |i, j| self.covariance(i, j));
        let own = variance(combination, |i, j| self.own_covariance(i, j)).max(CERTAIN * all);
        (value, own, shared)
    }
}

/// What rounding leaves of a variance where every error of a session is shared: it is still no certainty.
const CERTAIN: f64 = 1e-12;

/// Variance of `sum_n c_n x_n`.
fn variance(combination: &[(usize, f64)], covariance: impl Fn(usize, usize) -> f64) -> f64 {
    let pairs = combination.iter().flat_map(|(i, a)| combination.iter().map(move |(j, b)| (*i, *j, a * b)));
    pairs.map(|(i, j, product)| product * covariance(i, j)).sum()
}

/// The combination `sum_n c_n x_n` of named parameters in each of `calibrations`, in the order of time; `None` if one of them does not
/// determine it. Errors of one source are common to the sessions of one station, those of priors to all.
pub fn series(calibrations: &[&Calibrated], combination: &[(String, f64)], zero: Date, basis: Basis) -> Option<Series> {
    let mut errors = SharedErrors::default();
    let (mut points, mut changes) = (Vec::new(), Vec::new());
    for calibrated in calibrations {
        let at = |(name, c): &(String, f64)| Some((calibrated.place(name)?, *c));
        let places: Vec<(usize, f64)> = combination.iter().map(at).collect::<Option<_>>()?;
        let seen = calibrated.seen(basis);
        let (value, variance, shared) = seen.combined(&places);
        changes.push(
            errors.of(&calibrated.station, calibrated.gravity, seen.shared).into_iter().zip(shared).collect::<Vec<_>>(),
        );
        points.push(Point { time: years(zero, calibrated.date), value, variance });
    }
    let mut shared = DMatrix::zeros(points.len(), errors.count());
    for (n, row) in changes.iter().enumerate() {
        for &(column, change) in row {
            shared[(n, column)] = change;
        }
    }
    Series::new(&points, &shared)
}

/// Changes of `names` in each of `calibrations` by the errors that sessions share, a column for each error; of those alone that as many
/// sessions have as is `wanted`.
pub fn shared_changes(
    calibrations: &[&Calibrated],
    names: &[String],
    wanted: impl Fn(usize) -> bool,
) -> Vec<DMatrix<f64>> {
    let mut errors = SharedErrors::default();
    let numbers: Vec<Vec<usize>> =
        calibrations.iter().map(|c| errors.of(&c.station, c.gravity, c.seen(Basis::Data).shared)).collect();
    let count = |error: usize| numbers.iter().filter(|of| of.contains(&error)).count();
    let columns: Vec<usize> = (0..errors.count()).filter(|&error| wanted(count(error))).collect();
    let changes = |(calibrated, numbers): (&&Calibrated, &Vec<usize>)| {
        let shared = calibrated.seen(Basis::Data).shared;
        DMatrix::from_fn(names.len(), columns.len(), |i, column| {
            let influence = numbers.iter().position(|number| *number == columns[column]).map(|at| &shared[at]);
            influence.zip(calibrated.place(&names[i])).map_or(0.0, |(influence, place)| influence.changes[place])
        })
    };
    calibrations.iter().zip(&numbers).map(changes).collect()
}

/// One parameter, as a combination.
pub fn single(name: &str) -> [(String, f64); 1] {
    [(name.to_owned(), 1.0)]
}

/// Years from a day to another.
pub fn years(from: Date, to: Date) -> f64 {
    to.years_since(from).unwrap_or(f64::NAN)
}
