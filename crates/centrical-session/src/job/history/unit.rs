//! One unit over its calibrations.

use centrical::history::{Between, Curve, DAYS_IN_YEAR, Estimated, Evolution, Likely, Quantiles, Series};
use centrical::uncertainty::{Compensated, Estimates, Level, family_wise};
use centrical_compensate::Term;
use nalgebra::{DMatrix, Vector3};

use super::calibrated::{Basis, Calibrated, Finder, series, shared_changes, single, years};
use super::comparable::ComparedSessions;
use super::no_history::NoHistory;
use super::read::by_unit;
use crate::document::{
    DeviatingSession, DueDate, Program, ReadingHistory, SamenessSummary, UNIT_HISTORY_SCHEMA, UnitHistoryReport,
    UnitParameter, shown_readings,
};
use crate::quantity::Date;

/// The request for a unit's history.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnitHistoryRequest {
    /// Whether parameters may drift, which three calibrations show. Without that they scatter about a constant.
    pub trend: bool,
    /// The day of the forecast; a year after the last calibration if absent.
    pub until: Option<Date>,
    /// Largest error of a compensated reading [m/s^2], for the due date.
    pub limit: Option<f64>,
    /// The day on which that limit is to hold; that of the last calibration if absent or earlier.
    pub on: Option<Date>,
    /// Probability of all intervals, and that of a reading within its limit at the due date.
    pub coverage: f64,
}

impl Default for UnitHistoryRequest {
    /// A trend, the forecast of a year, and no limit.
    fn default() -> Self {
        Self { trend: true, until: None, limit: None, on: None, coverage: Self::COVERAGE }
    }
}

impl UnitHistoryRequest {
    /// The usual probability, as of an expanded uncertainty.
    pub const COVERAGE: f64 = 0.95;
}

/// Years after the last calibration up to which a due date is looked for.
const HORIZON: f64 = 20.0;

/// Forces at which a compensated reading is looked at, over the range.
const PARTS: [f64; 4] = [-1.0, -0.5, 0.5, 1.0];

/// Readings that are looked at: of three newtonometers at rest, and at forces along three axes.
const READINGS: usize = 3 * (1 + 3 * PARTS.len());

/// The history of the one unit of `serial` among `calibrations`, which are in the order of time; without a serial number all are of that unit. Those of
/// other units of its model give the component between sessions with it. The limit is to hold today, if no day is asked for.
///
/// # Errors
/// [`NoHistory`] for several units or none, for a day before the last calibration, and where fewer than two have a parameter in common.
pub fn unit_history_among(
    calibrations: Vec<Calibrated>,
    serial: Option<&str>,
    request: UnitHistoryRequest,
) -> Result<UnitHistoryReport, NoHistory> {
    let is_meant = |unit: &Vec<Calibrated>| serial.is_none_or(|wanted| wanted == unit[0].unit_serial);
    let (own, others): (Vec<_>, Vec<_>) = by_unit(calibrations).into_iter().partition(is_meant);
    let [own] = own.as_slice() else { return Err(NoHistory::of_units(&own)) };
    for (option, asked) in [("--on", request.on), ("--until", request.until)] {
        if let (Some(day), Some(last)) = (asked, own.last())
            && day < last.date
        {
            return Err(NoHistory::Early { option, day, last: last.date });
        }
    }
    let others: Vec<_> = others.into_iter().filter(|unit| unit[0].unit_model == own[0].unit_model).collect();
    let request = UnitHistoryRequest { on: request.on.or_else(|| Some(Date::today())), ..request };
    unit_history(own, &others, request).ok_or(NoHistory::Few(own.len()))
}

/// The history of a unit by its `calibrations`, two or more, in the order of time. With `others`, the calibrations of other units of its type, unit by
/// unit, the component between sessions is the one that all have in common. `None` where fewer than two calibrations have a parameter in common.
pub fn unit_history(
    calibrations: &[Calibrated],
    others: &[Vec<Calibrated>],
    request: UnitHistoryRequest,
) -> Option<UnitHistoryReport> {
    let last = calibrations.last()?;
    let ComparedSessions { calibrations: own, names, incomplete, left_out } = ComparedSessions::of(calibrations);
    let is_last_compared = own.last().is_some_and(|compared| std::ptr::eq(*compared, last));
    if own.len() < 2 || !is_last_compared {
        return None;
    }
    // One day has no line in time, whatever the number of its sessions.
    let has_days = own.iter().any(|calibrated| calibrated.date != own[0].date);
    let (zero, trend) = (own[0].date, request.trend && own.len() > 2 && has_days);
    let until = request.until.unwrap_or(last.date.after(DAYS_IN_YEAR));
    let on = request.on.map_or(last.date, |on| on.max(last.date));
    let job = Job {
        own: &own,
        others: &others.iter().map(|unit| unit.iter().collect()).collect::<Vec<Vec<&Calibrated>>>(),
        curve: if trend { Curve::Line } else { Curve::Constant },
        zero,
        ahead: years(zero, until),
        quantiles: Quantiles::default(),
        request,
    };
    let mut parameters: Vec<UnitParameter> = names.iter().filter_map(|name| job.parameter(name)).collect();
    let chances: Vec<f64> = parameters.iter().map(|p| p.probability.unwrap_or(1.0)).collect();
    for (parameter, chance) in parameters.iter_mut().zip(family_wise(&chances)) {
        parameter.scatters = parameter.probability.is_some() && Level::Reported.is_passed_by(chance);
    }
    let slopes: Vec<f64> = parameters.iter().map(|p| p.slope_probability.unwrap_or(1.0)).collect();
    for (parameter, chance) in parameters.iter_mut().zip(family_wise(&slopes)) {
        parameter.drifts = parameter.slope_probability.is_some() && Level::Reported.is_passed_by(chance);
        parameter.step = parameter.step.filter(|_| parameter.drifts || parameter.scatters);
    }
    let readings = job.readings();
    // Of some readings alone a day would pass for that of all. Where parameters may drift, two calibrations and those of a single day show no
    // drift, and say nothing of later days.
    let are_all = readings.len() == READINGS;
    let shows_drift = trend || !request.trend;
    let due = readings.iter().filter_map(|r| r.due.as_ref()).min_by_key(|due| due.date).cloned();
    let due = due.filter(|due| (are_all && shows_drift) || due.date <= on);
    Some(UnitHistoryReport {
        schema: UNIT_HISTORY_SCHEMA,
        program: Program::this(),
        unit_model: last.unit_model.clone(),
        unit_serial: last.unit_serial.clone(),
        sessions: own.iter().map(|calibrated| calibrated.past()).collect(),
        incomplete,
        left_out,
        not_in_last: not_in(last, &own),
        not_compared: last.determined().map(str::to_owned).filter(|name| !names.contains(name)).collect(),
        trend,
        coverage: request.coverage,
        units_together: 1 + others.len(),
        until,
        sameness: job.sameness(&names),
        parameters,
        range: last.range,
        limit: request.limit,
        is_within: request
            .limit
            .filter(|_| (are_all && (shows_drift || on == last.date)) || due.is_some())
            .map(|_| due.as_ref().is_none_or(|due| due.date > on)),
        on,
        // A station may be east of here.
        ahead: last.date > Date::today().after(1.0),
        due,
        due_after: request.limit.filter(|_| are_all && shows_drift).map(|_| last.date.after(HORIZON * DAYS_IN_YEAR)),
        readings,
    })
}

/// Parameters of the unit that other `calibrations` determine and the last one does not.
fn not_in(last: &Calibrated, calibrations: &[&Calibrated]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for name in calibrations.iter().flat_map(|calibrated| calibrated.determined()) {
        if last.place(name).is_none() && !names.iter().any(|known| known == name) {
            names.push(name.to_owned());
        }
    }
    names
}

/// Whether `last` determines each term that a calibration does.
fn is_part(calibrated: &Calibrated, last: &Calibrated) -> bool {
    let is_determined = |name: &str| calibrated.place(name).is_some();
    calibrated.terms.iter().flatten().all(|(name, _)| !is_determined(name) || last.place(name).is_some())
}

/// Those of `calibrations` that determine all of a combination.
fn with_all<'a>(calibrations: &[&'a Calibrated], combination: &[(String, f64)]) -> Vec<&'a Calibrated> {
    let has_all = |calibrated: &&&Calibrated| combination.iter().all(|(name, _)| calibrated.place(name).is_some());
    calibrations.iter().filter(has_all).copied().collect()
}

/// Parameters of the unit that all calibrations determine.
pub fn common_names(calibrations: &[&Calibrated]) -> Vec<String> {
    let Some(last) = calibrations.last() else { return Vec::new() };
    let of_unit = last.parameters.iter().filter(|p| p.is_of_unit);
    let in_all = |name: &str| {
        let mut finder = Finder::new(name);
        calibrations.iter().all(|calibrated| finder.place(calibrated).is_some())
    };
    of_unit.filter(|p| in_all(&p.name)).map(|p| p.name.clone()).collect()
}

/// The error of a compensated reading as a combination of parameters.
struct Combination {
    force: Vector3<f64>,
    axis: usize,
    shares: Vec<(String, f64)>,
}

struct Job<'a> {
    own: &'a [&'a Calibrated],
    others: &'a [Vec<&'a Calibrated>],
    curve: Curve,
    zero: Date,
    ahead: f64,
    quantiles: Quantiles,
    request: UnitHistoryRequest,
}

impl Job<'_> {
    fn sameness(&self, names: &[String]) -> Option<SamenessSummary> {
        let of_data = names.iter().filter(|name| !self.rests_on_priors(name)).cloned();
        let names: Vec<String> = of_data.collect();
        // What all sessions share cancels; what some share does not, as after a move to another station.
        let changes = shared_changes(self.own, &names, |count| count < self.own.len());
        let (mut own, mut sessions, mut quantities, mut shared) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for (calibrated, changes) in self.own.iter().zip(&changes) {
            let has: Vec<usize> = (0..names.len()).filter(|&i| calibrated.place(&names[i]).is_some()).collect();
            if has.is_empty() {
                continue;
            }
            let of_session: Vec<String> = has.iter().map(|&i| names[i].clone()).collect();
            sessions.push(calibrated.own_estimates(&of_session)?);
            own.push(*calibrated);
            shared.push(changes.select_rows(&has));
            quantities.push(has);
        }
        Estimates::sameness(&sessions, &quantities, &shared).map(|(test, farthest)| SamenessSummary {
            chi_squared: test.statistic,
            degrees_of_freedom: test.degrees_of_freedom,
            probability: test.probability,
            farthest: farthest.map(|farthest| DeviatingSession {
                source: own[farthest.session].source.clone(),
                date: own[farthest.session].date,
                probability: farthest.probability,
                probability_of_others: farthest.probability_of_others,
                probability_by_scatter: farthest.probability_by_scatter,
            }),
        })
    }

    /// The series of a combination over the sessions that determine it, this unit's first; with those of the other units, if the component is
    /// that of all. `None` below two sessions.
    fn combination(&self, combination: &[(String, f64)], basis: Basis) -> Option<Vec<Series>> {
        let of = |unit: &[&Calibrated]| {
            let with_all = with_all(unit, combination);
            if with_all.len() < 2 { None } else { series(&with_all, combination, self.zero, basis) }
        };
        let own = of(self.own)?;
        let others = self.others.iter().filter_map(|unit| of(unit));
        Some(std::iter::once(own).chain(others).collect())
    }

    fn rests_on_priors(&self, name: &str) -> bool {
        self.own.iter().any(|c| c.place(name).is_some_and(|place| c.rests_on_priors(place)))
    }

    /// The days of the sessions before and after a step, with `place` sessions before it.
    fn days_of_step(&self, name: &str, place: usize) -> Option<[Date; 2]> {
        let mut days = self.own.iter().filter(|c| c.place(name).is_some()).map(|c| c.date).skip(place - 1);
        Some([days.next()?, days.next()?])
    }

    fn between(&self, all: &[Series]) -> Option<Between> {
        Between::of(all, self.curve, self.request.coverage)
    }

    /// How the first series goes on.
    fn evolution<'s>(&self, all: &'s [Series], between: &Between) -> Option<Evolution<'s>> {
        let likely = Likely::of(all, self.curve, &self.quantiles)?;
        all.first()?.evolution(self.curve, between, &likely, &self.quantiles)
    }

    fn parameter(&self, name: &str) -> Option<UnitParameter> {
        // Sessions say nothing of a parameter that rests on priors: it has their stated values and no more.
        let rests_on_priors = self.rests_on_priors(name);
        let all = self.combination(&single(name), if rests_on_priors { Basis::Stated } else { Basis::Data })?;
        let (own, between) = (&all[0], self.between(&all).filter(|_| !rests_on_priors));
        let last = self.own.iter().rev().find(|calibrated| calibrated.place(name).is_some())?;
        let place = last.place(name)?;
        let evolution = between.as_ref().and_then(|between| self.evolution(&all, between));
        let slope = evolution.as_ref().and_then(Evolution::slope);
        let count = own.points().len();
        let e_n = |earlier: usize| {
            let (difference, u) = own.difference(earlier, count - 1);
            difference / (2.0 * u)
        };
        Some(UnitParameter {
            name: name.to_owned(),
            unit: last.parameters[place].unit.clone(),
            group: last.parameters[place].group,
            values: self.own.iter().map(|c| Some(c.values[c.place(name)?])).collect(),
            standard_uncertainties: self.own.iter().map(|c| Some(c.standard_uncertainties[c.place(name)?])).collect(),
            between: between.as_ref().map(|b| b.variance.sqrt()),
            between_interval: between.as_ref().map(|b| b.interval.map(f64::sqrt)),
            variance_ratio: between.as_ref().map(Between::variance_ratio),
            degrees_of_freedom: between.as_ref().map(|b| b.degrees_of_freedom),
            probability: between.as_ref().map(|b| b.probability),
            scatters: false,
            slope_per_year: slope.as_ref().map(|slope| slope.value),
            slope_uncertainty: slope.as_ref().map(|slope| slope.standard_uncertainty),
            slope_interval: slope.as_ref().map(|slope| slope.interval(self.request.coverage)),
            slope_probability: slope.as_ref().map(Estimated::probability),
            drifts: false,
            step: own.step().and_then(|place| self.days_of_step(name, place)),
            forecast: evolution.map(|evolution| evolution.forecast(self.ahead).interval(self.request.coverage)),
            e_n_previous: e_n(count - 2),
            e_n_first: e_n(0),
        })
    }

    /// What the history means for a reading that the last calibration compensates: at forces along the axes, over the range.
    fn readings(&self) -> Vec<ReadingHistory> {
        let read = self.combinations().into_iter().filter_map(|of| Some((self.reading(&of)?, of)));
        let (mut readings, combinations): (Vec<ReadingHistory>, Vec<Combination>) = read.unzip();
        for n in shown_readings(&readings) {
            let all = self.combination(&combinations[n].shares, Basis::Data);
            let likely = all.and_then(|all| Likely::of(&all, self.curve, &self.quantiles));
            let law = likely.map(|likely| likely.after_switch_on(readings[n].stated.powi(2)));
            readings[n].expanded_after_switch_on = law.map(|law| law.interval(self.request.coverage)[1]);
        }
        readings
    }

    /// Force, newtonometer, and what the error of its reading there is made of.
    fn combinations(&self) -> Vec<Combination> {
        let Some((last, terms)) = self.own.last().and_then(|last| Some((last, last.terms.clone()?))) else {
            return Vec::new();
        };
        // A term that is not determined has a share, for which the reading has no history; what it does to the shares of others is left out.
        let known = |(name, term): (String, Term)| {
            let coefficient = if term.coefficient.is_finite() { term.coefficient } else { 0.0 };
            (name, Term { coefficient, ..term })
        };
        let (names, terms): (Vec<String>, Vec<Term>) = terms.into_iter().map(known).unzip();
        // Only its sensitivity is asked for.
        let covariance = DMatrix::zeros(terms.len(), terms.len());
        let Some(compensated) = Compensated::new(terms, covariance) else { return Vec::new() };
        let along = |axis: usize| PARTS.map(|part| Vector3::ith(axis, part * last.range));
        let forces = std::iter::once(Vector3::zeros()).chain((0..3).flat_map(along));
        let mut combinations = Vec::new();
        for force in forces {
            let Some(sensitivity) = compensated.sensitivity(&force) else { continue };
            for axis in 0..3 {
                let row = sensitivity.row(axis);
                let shares = names.iter().zip(row.iter()).filter(|(_, c)| **c != 0.0);
                let shares = shares.map(|(name, c)| (name.clone(), *c)).collect();
                combinations.push(Combination { force, axis, shares });
            }
        }
        combinations
    }

    /// What terms that the last calibration lacks added to a reading, as the latest calibration that has them determined [m/s^2].
    fn missing(&self, force: Vector3<f64>, axis: usize) -> f64 {
        let Some(last) = self.own.last() else { return 0.0 };
        let latest = self.own.iter().rev().find(|calibrated| calibrated.terms.is_some() && !is_part(calibrated, last));
        let terms = latest.into_iter().flat_map(|calibrated| calibrated.terms.iter().flatten());
        let is_lacking = |(name, term): &&(String, Term)| {
            term.axis == axis && term.coefficient.is_finite() && last.place(name).is_none()
        };
        let lacking = terms.filter(is_lacking);
        lacking.map(|(_, term)| term.coefficient * term.monomial.value(force.into())).sum()
    }

    fn reading(&self, of: &Combination) -> Option<ReadingHistory> {
        let Combination { force, axis, ref shares } = *of;
        let all = self.combination(shares, Basis::Data)?;
        let between = self.between(&all)?;
        let last = *self.own.last()?;
        let places: Vec<(usize, f64)> =
            shares.iter().map(|(name, c)| Some((last.place(name)?, *c))).collect::<Option<_>>()?;
        let stated = last.variance(&places).max(0.0);
        let point = all[0].points().last()?;
        let due = self.request.limit.and_then(|limit| {
            let limit = (limit - self.missing(force, axis).abs()).max(0.0);
            let evolution = self.evolution(&all, &between)?;
            let from = point.time;
            let time = evolution.due(last.value(&places), limit, self.request.coverage, from, from + HORIZON)?;
            // The day before: until then the reading is within its limit.
            let days = ((time - from) * DAYS_IN_YEAR).floor();
            Some(DueDate { date: last.date.after(days), axis: axis + 1, force: force.into() })
        });
        Some(ReadingHistory {
            force: force.into(),
            axis: axis + 1,
            stated: stated.sqrt(),
            between: between.variance.sqrt(),
            between_interval: between.interval.map(f64::sqrt),
            // The session of the calibration deviates from the mean of all as the next one does.
            after_switch_on: (stated + 2.0 * between.variance).sqrt(),
            expanded_after_switch_on: None,
            due,
        })
    }
}
