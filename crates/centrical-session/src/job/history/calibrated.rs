//! A calibration as its history needs it: what was determined, and which of its errors other sessions share.

use std::collections::BTreeMap;

use centrical::Group;
use centrical::history::{Point, Series};
use centrical_compensate::Term;
use nalgebra::{DMatrix, DVector};

use crate::document::{CalibrationResult, ParameterEstimate};
use crate::error::{Error, Place, quoted};
use crate::laboratory::Date;

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
    /// Day of the session.
    pub date: Date,
    /// Whether no check raised an objection.
    pub acceptable: bool,
    /// The parameters that the data determine.
    pub parameters: Vec<CalibratedParameter>,
    /// Their covariance, SI.
    pub covariance: DMatrix<f64>,
    /// Change of each by an error that sessions of one station share, at one standard uncertainty, with the name of its source.
    pub shared: Vec<(String, Vec<f64>)>,
    /// The error model with the names of its coefficients, if all of them are determined.
    pub terms: Option<Vec<(String, Term)>>,
    /// Largest magnitude of a plateau's mean reading on any axis [m/s^2].
    pub range: f64,
}

/// A parameter that is determined.
#[derive(Debug, Clone, PartialEq)]
pub struct CalibratedParameter {
    /// Name.
    pub name: String,
    /// Unit of SI.
    pub unit: String,
    /// bias, scale, misalignment, ...
    pub group: Group,
    /// Estimate, SI.
    pub value: f64,
    /// Whether it belongs to the unit, and not to the machine or how the unit was mounted.
    pub is_of_unit: bool,
}

impl Calibrated {
    /// The calibration in a `result.json` that is called `source`.
    ///
    /// # Errors
    /// [`Error`] if its session has no day for a date.
    pub fn of(source: &str, result: &CalibrationResult) -> Result<Self, Error> {
        let date = result.session.date.parse().map_err(|_| {
            let found = quoted(result.session.date.as_bytes());
            Error::content(
                source.as_ref(),
                Place::Key { table: "session".to_owned(), key: "date".to_owned() },
                found,
                "a day such as 2026-10-05",
            )
        })?;
        let determined: Vec<usize> =
            (0..result.parameters.len()).filter(|&j| result.parameters[j].value.is_some()).collect();
        let covariance =
            |a: usize, b: usize| result.covariance.get(determined[a])?.get(determined[b]).copied().flatten();
        let count = determined.len();
        let terms = &result.model.error_model;
        let is_of_unit =
            |p: &ParameterEstimate| p.group == Group::ProofMass || terms.iter().any(|term| term.name == p.name);
        let parameter = |&j: &usize| {
            let p = &result.parameters[j];
            CalibratedParameter {
                name: p.name.clone(),
                unit: p.unit.clone(),
                group: p.group,
                value: p.value.unwrap_or(f64::NAN),
                is_of_unit: is_of_unit(p),
            }
        };
        Ok(Self {
            source: source.to_owned(),
            unit_model: result.session.unit_model.clone(),
            unit_serial: result.session.unit_serial.clone(),
            station: String::new(),
            date,
            acceptable: result.objections().is_empty(),
            parameters: determined.iter().map(parameter).collect(),
            covariance: DMatrix::from_fn(count, count, |a, b| covariance(a, b).unwrap_or(f64::NAN)),
            shared: Vec::new(),
            terms: result
                .error_terms()
                .ok()
                .map(|found| terms.iter().map(|term| term.name.clone()).zip(found).collect()),
            range: result.calibrated_range(),
        })
    }

    /// The place of a parameter, if it is determined.
    pub fn place(&self, name: &str) -> Option<usize> {
        self.parameters.iter().position(|p| p.name == name)
    }

    /// What tells units apart.
    pub fn unit(&self) -> (&str, &str) {
        (&self.unit_model, &self.unit_serial)
    }

    /// `sum_n c_n x_n`, its variance by errors of this session alone, and its change by each shared error.
    fn combined(&self, combination: &[(usize, f64)]) -> (f64, f64, Vec<f64>) {
        let value = combination.iter().map(|(j, c)| c * self.parameters[*j].value).sum();
        let shared: Vec<f64> =
            self.shared.iter().map(|(_, changes)| combination.iter().map(|(j, c)| c * changes[*j]).sum()).collect();
        let all: f64 = (combination.iter())
            .flat_map(|(i, a)| combination.iter().map(move |(j, b)| (i, j, a * b)))
            .map(|(i, j, product)| product * self.covariance[(*i, *j)])
            .sum();
        // What rounding leaves of a session whose every error is shared is still no certainty.
        let own = (all - shared.iter().map(|s| s * s).sum::<f64>()).max(1e-12 * all);
        (value, own, shared)
    }

    /// Values of `names` and the covariance of the errors that belong to this session alone; `None` if one is not determined.
    pub fn own_estimates(&self, names: &[String]) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let places: Vec<usize> = names.iter().map(|name| self.place(name)).collect::<Option<_>>()?;
        let shared =
            |i: usize, j: usize| -> f64 { self.shared.iter().map(|(_, changes)| changes[i] * changes[j]).sum() };
        let own = |a: usize, b: usize| self.covariance[(places[a], places[b])] - shared(places[a], places[b]);
        let values = DVector::from_iterator(places.len(), places.iter().map(|&j| self.parameters[j].value));
        Some((values, DMatrix::from_fn(places.len(), places.len(), own)))
    }
}

/// The combination `sum_n c_n x_n` of named parameters in each of `calibrations`, in the order of time; `None` if one of them does not
/// determine it. Errors of one source are common to the sessions of one station.
pub fn series(calibrations: &[&Calibrated], combination: &[(String, f64)], zero: Date) -> Option<Series> {
    let mut columns: BTreeMap<(&str, &str, usize), usize> = BTreeMap::new();
    let (mut points, mut changes) = (Vec::new(), Vec::new());
    for calibrated in calibrations {
        let at = |(name, c): &(String, f64)| Some((calibrated.place(name)?, *c));
        let places: Vec<(usize, f64)> = combination.iter().map(at).collect::<Option<_>>()?;
        let (value, variance, shared) = calibrated.combined(&places);
        let mut seen: BTreeMap<&str, usize> = BTreeMap::new();
        let row = calibrated.shared.iter().zip(shared).map(|((source, _), change)| {
            let number = seen.entry(source).or_default();
            *number += 1;
            let next = columns.len();
            (*columns.entry((&calibrated.station, source, *number)).or_insert(next), change)
        });
        changes.push(row.collect::<Vec<(usize, f64)>>());
        points.push(Point { time: years(zero, calibrated.date), value, variance });
    }
    let mut shared = DMatrix::zeros(points.len(), columns.len());
    for (n, row) in changes.iter().enumerate() {
        for &(column, change) in row {
            shared[(n, column)] = change;
        }
    }
    Series::new(&points, &shared)
}

/// One parameter, as a combination.
pub fn single(name: &str) -> [(String, f64); 1] {
    [(name.to_owned(), 1.0)]
}

/// Years from a day to another.
pub fn years(from: Date, to: Date) -> f64 {
    to.days_since(from).map_or(f64::NAN, f64::from) / DAYS
}

/// Days in a year.
pub const DAYS: f64 = 365.25;
