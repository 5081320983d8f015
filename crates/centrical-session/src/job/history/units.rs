//! Units of one type beside each other.

use std::borrow::Borrow;
use std::collections::{BTreeMap, BTreeSet};

use centrical::history::{BatchTest, Between, Capability, Curve, Series, UnitDistance, UnitTrend};
use centrical::uncertainty::{Level, family_wise};
use rayon::prelude::*;

use super::calibrated::{Basis, Calibrated, Finder, Places, series, single};
use super::check::spelling;
use super::comparable::ComparedUnits;
use super::no_history::NoHistory;
use super::read::ParameterLimits;
use super::unit::{UnitHistoryRequest, common_names};
use crate::document::{
    BatchSummary, BatchWithoutUnit, BeyondLimit, CapabilitySummary, NotComparedParameter, OutlyingUnit, Program,
    UNITS_HISTORY_SCHEMA, UnitFinding, UnitFindingKind, UnitsHistoryReport, UnitsParameter, UntestedStation,
};

/// The request for a comparison of units.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct UnitsHistoryRequest {
    /// Limits of parameters.
    pub limits: ParameterLimits,
    /// Batch of a unit by its serial number.
    pub batches: BTreeMap<String, String>,
}

/// Family-wise level, which the kinds of findings share: batches that differ, units that are outlying, and those that drift or scatter.
const FAMILY: f64 = Level::Reported.probability();

/// Seed of the laws that are drawn.
const SEED: u64 = 1;

/// The history of units of one type by the calibrations that are compared.
///
/// # Errors
/// [`NoHistory`] without a parameter that these determine.
pub fn units_history(compared: &ComparedUnits, request: &UnitsHistoryRequest) -> Result<UnitsHistoryReport, NoHistory> {
    let ComparedUnits { units, left_out } = compared;
    let all: Vec<&Calibrated> = units.iter().flatten().collect();
    let names = common_names(&all);
    let lasts: Vec<&Calibrated> = units.iter().filter_map(|unit| unit.last()).collect();
    if names.is_empty() {
        return Err(NoHistory::NothingInCommon);
    }
    let stations = by_station(units);
    let at_one = of_batches(&stations, &lasts, request);
    let (mut parameters, mut beyond_limits) = (Vec::new(), Vec::new());
    for name in &names {
        let means = unit_means(units.iter().map(Vec::as_slice), name);
        let batches = batches(&at_one, &lasts, name, request);
        parameters.extend(parameter(&lasts, name, &means, batches, request));
        beyond_limits.extend(beyond_limit(&lasts, name, &means, &request.limits));
    }
    let by_parameter = by_parameter(&stations, &lasts, &names, &all);
    let (tested, few): (Vec<&AtStation>, Vec<&AtStation>) =
        stations.iter().partition(|units| units.len() >= UnitDistance::FEWEST_UNITS);
    let is_by_batch = parameters.iter().any(|p| p.batch_probability.is_some());
    let is_over_time = by_parameter.iter().any(|of| !of.findings.is_empty());
    let kinds = [!tested.is_empty(), is_over_time, is_by_batch].into_iter().filter(|is_tested| *is_tested).count();
    let level = FAMILY / kinds.max(1) as f64;
    let batches: Vec<f64> = parameters.iter().map(|p| p.batch_probability.unwrap_or(1.0)).collect();
    for (parameter, chance) in parameters.iter_mut().zip(family_wise(&batches)) {
        parameter.batches_differ = chance < level;
    }
    let outlying = outlying(&tested, &lasts, &by_parameter, level);
    let findings = over_time(by_parameter, level);
    let batches_differ = parameters.iter().any(|p| p.batches_differ);
    let are_compared = request.batches.is_empty() || is_by_batch;
    Ok(UnitsHistoryReport {
        schema: UNITS_HISTORY_SCHEMA,
        program: Program::this(),
        unit_model: lasts[0].unit_model.clone(),
        units: units.len(),
        sessions: all.len(),
        not_acceptable: all.iter().filter(|calibrated| !calibrated.acceptable).count(),
        left_out: left_out.clone(),
        not_compared: not_compared(&all, &names),
        is_tested: few.is_empty(),
        untested: few.into_iter().map(|units| untested(units, &lasts)).collect(),
        is_sound: outlying.is_empty()
            && findings.is_empty()
            && beyond_limits.is_empty()
            && !batches_differ
            && are_compared,
        batches_not_compared: !are_compared,
        batches_at: at_one.first().map(|(_, unit)| unit[0].station.clone()).filter(|_| stations.len() > 1),
        beyond_limits,
        outlying,
        findings,
        without_unit: without_unit(&request.batches, &lasts),
        parameters,
    })
}

/// The parameters that some of the calibrations determine and others do not, by name.
fn not_compared(all: &[&Calibrated], names: &[String]) -> Vec<NotComparedParameter> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    all.iter().flat_map(|calibrated| calibrated.determined()).for_each(|name| *counts.entry(name).or_default() += 1);
    let not_in_all = counts.into_iter().filter(|(name, _)| !names.iter().any(|of_all| of_all == name));
    not_in_all.map(|(name, sessions)| NotComparedParameter { name: name.to_owned(), sessions }).collect()
}

/// Mean of one parameter over the calibrations of each unit; all determine it.
pub fn unit_means<'a, C: Borrow<Calibrated> + 'a>(units: impl Iterator<Item = &'a [C]>, name: &str) -> Vec<f64> {
    let mut finder = Finder::new(name);
    let mean = |unit: &[C]| {
        let values = unit.iter().map(Borrow::borrow).filter_map(|c| finder.place(c).map(|place| c.values[place]));
        values.sum::<f64>() / unit.len() as f64
    };
    units.map(mean).collect()
}

fn parameter(
    lasts: &[&Calibrated],
    name: &str,
    values: &[f64],
    batches: BTreeMap<&str, Vec<f64>>,
    request: &UnitsHistoryRequest,
) -> Option<UnitsParameter> {
    let of = lasts[0];
    let place = of.place(name)?;
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let (low, high) = request.limits.get(name).copied().unwrap_or_default();
    let capability =
        Capability::of(values, low, high, UnitHistoryRequest::COVERAGE).map(|(cp, cpk)| CapabilitySummary {
            low,
            high,
            cp: cp.map(|cp| cp.value),
            cp_interval: cp.map(|cp| cp.interval),
            cpk: cpk.value,
            cpk_interval: cpk.interval,
        });
    Some(UnitsParameter {
        name: name.to_owned(),
        unit: of.parameters[place].unit.clone(),
        group: of.parameters[place].group,
        mean,
        deviation: deviation(values),
        least: sorted[0],
        median: 0.5 * (sorted[(sorted.len() - 1) / 2] + sorted[sorted.len() / 2]),
        largest: sorted[sorted.len() - 1],
        capability,
        batch_probability: BatchTest::of(&batches.values().cloned().collect::<Vec<_>>()).map(|test| test.probability),
        batches: batches.into_iter().map(|(batch, values)| summary(batch, &values)).collect(),
        batches_differ: false,
    })
}

/// The sessions of units at one station, each unit by its number. Type B that these share would separate units of two stations.
type AtStation<'a> = Vec<(usize, Vec<&'a Calibrated>)>;

/// The sessions of `units`, station by station.
fn by_station(units: &[Vec<Calibrated>]) -> Vec<AtStation<'_>> {
    let mut stations: BTreeMap<&str, BTreeMap<usize, Vec<&Calibrated>>> = BTreeMap::new();
    for (number, unit) in units.iter().enumerate() {
        for calibrated in unit {
            stations.entry(&calibrated.station).or_default().entry(number).or_default().push(calibrated);
        }
    }
    stations.into_values().map(|units| units.into_iter().collect()).collect()
}

/// A station with too few units for a law of their distances.
fn untested(units: &AtStation, lasts: &[&Calibrated]) -> UntestedStation {
    UntestedStation {
        station: units[0].1[0].station.clone(),
        units: units.iter().map(|(number, _)| lasts[*number].unit_serial.clone()).collect(),
    }
}

/// The units whose `means` of one parameter, or last values, are beyond a limit, if there are any.
fn beyond_limit(lasts: &[&Calibrated], name: &str, means: &[f64], limits: &ParameterLimits) -> Option<BeyondLimit> {
    let (low, high) = limits.get(name).copied()?;
    let is_beyond = |value: f64| low.is_some_and(|low| value < low) || high.is_some_and(|high| value > high);
    let is_last_beyond = |last: &Calibrated| last.place(name).is_some_and(|place| is_beyond(last.values[place]));
    let beyond = means.iter().zip(lasts).filter(|(mean, last)| is_beyond(**mean) || is_last_beyond(last));
    let units: Vec<String> = beyond.map(|(_, last)| last.unit_serial.clone()).collect();
    (!units.is_empty()).then(|| BeyondLimit { parameter: name.to_owned(), units })
}

/// One parameter of all units over time.
struct OfParameter {
    name: String,
    /// Whether all units have an uncertainty.
    is_known: bool,
    /// Drift and scatter of each unit, each with its own probability.
    findings: Vec<UnitFinding>,
}

/// All parameters, each unit by its sessions at one station. Values are as stated: priors, if there are any, draw all units in the same way.
fn by_parameter<'u>(
    stations: &'u [AtStation<'u>],
    lasts: &[&Calibrated],
    names: &[String],
    all: &[&Calibrated],
) -> Vec<OfParameter> {
    let Some(zero) = all.iter().map(|c| c.date).min() else { return Vec::new() };
    let of_parameter = |name: &String| {
        let units = || stations.iter().flatten();
        let of_unit =
            |unit: &'u (usize, Vec<&'u Calibrated>)| Some((unit, series(&unit.1, &single(name), zero, Basis::Stated)?));
        let (compared, series): (Vec<_>, Vec<Series>) = units().filter_map(of_unit).unzip();
        OfParameter {
            name: name.clone(),
            is_known: series.len() == units().count(),
            findings: findings(&compared, &series, lasts, name),
        }
    };
    names.par_iter().map(of_parameter).collect()
}

/// Units whose robust distance sound units of their station would have with a probability below `level`.
fn outlying(
    stations: &[&AtStation],
    lasts: &[&Calibrated],
    by_parameter: &[OfParameter],
    level: f64,
) -> Vec<OutlyingUnit> {
    let names: Vec<&str> = by_parameter.iter().filter(|of| of.is_known).map(|of| of.name.as_str()).collect();
    if names.is_empty() {
        return Vec::new();
    }
    let at_station = |units: &&AtStation| -> Vec<OutlyingUnit> {
        let counts: Vec<usize> = units.iter().map(|(_, sessions)| sessions.len()).collect();
        let all = units.iter().flat_map(|(_, sessions)| sessions);
        let places = Places::of(all.map(|calibrated| &calibrated.parameters), &names);
        let session = |unit: usize, t: usize| {
            let calibrated = units[unit].1[t];
            calibrated.stated_estimates(places.in_list(&calibrated.parameters))
        };
        let numbers = units.iter().map(|(number, _)| *number);
        let distances = UnitDistance::of_all(&counts, &session, SEED).into_iter().flatten();
        let found = numbers.zip(distances).map(|(number, distance)| {
            let mut scores: Vec<(String, f64)> =
                names.iter().map(|&name| name.to_owned()).zip(distance.scores).collect();
            scores.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
            scores.truncate(3);
            OutlyingUnit {
                unit_serial: lasts[number].unit_serial.clone(),
                distance: distance.distance,
                probability: (stations.len() as f64 * distance.probability).min(1.0),
                most: scores,
            }
        });
        found.filter(|unit| unit.probability < level).collect()
    };
    let mut found: Vec<OutlyingUnit> = stations.iter().flat_map(at_station).collect();
    found.sort_by(|a, b| b.distance.total_cmp(&a.distance));
    let mut named = BTreeSet::new();
    found.retain(|unit| named.insert(unit.unit_serial.clone()));
    found
}

/// The drift and the scatter of `units`, each by its number and sessions, in one parameter.
fn findings(
    units: &[&(usize, Vec<&Calibrated>)],
    series: &[Series],
    lasts: &[&Calibrated],
    name: &str,
) -> Vec<UnitFinding> {
    let Some(between) = Between::of(series, Curve::Line, UnitHistoryRequest::COVERAGE) else { return Vec::new() };
    let trends = units.iter().zip(series).zip(UnitTrend::of_all(series, between.variance, FAMILY));
    let findings = trends.filter_map(|(((n, sessions), series), trend)| {
        let (n, trend) = (*n, trend?);
        // Family-wise a finding is no more probable: what is not found alone is not found.
        let is_found = trend.drift_probability.min(trend.scatter_probability) < FAMILY;
        let step = is_found
            .then(|| series.step())
            .flatten()
            .map(|place| [place - 1, place].map(|session| sessions[session].date));
        let finding = |kind, probability| UnitFinding {
            kind,
            unit_serial: lasts[n].unit_serial.clone(),
            parameter: name.to_owned(),
            slope_per_year: trend.slope,
            slope_uncertainty: trend.standard_uncertainty,
            variance_ratio: trend.variance_ratio,
            step,
            probability,
        };
        Some([
            finding(UnitFindingKind::Drifts, trend.drift_probability),
            finding(UnitFindingKind::Scatters, trend.scatter_probability),
        ])
    });
    findings.flatten().collect()
}

/// Units that drift, or scatter more than the others, in any parameter, at a family-wise `level`.
fn over_time(by_parameter: Vec<OfParameter>, level: f64) -> Vec<UnitFinding> {
    let findings: Vec<UnitFinding> = by_parameter.into_iter().flat_map(|of| of.findings).collect();
    let chances: Vec<f64> = findings.iter().map(|finding| finding.probability).collect();
    let family_wise = family_wise(&chances);
    let with_family =
        findings.into_iter().zip(family_wise).map(|(finding, probability)| UnitFinding { probability, ..finding });
    with_family.filter(|finding| finding.probability < level).collect()
}

fn summary(batch: &str, values: &[f64]) -> BatchSummary {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    BatchSummary { batch: batch.to_owned(), units: values.len(), mean, deviation: deviation(values) }
}

/// Standard deviation of values; none of a single one.
fn deviation(values: &[f64]) -> Option<f64> {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (values.len() > 1).then(|| (squares / (n - 1.0)).sqrt())
}

/// Serial numbers with a batch that no unit has, those first that look like one.
fn without_unit(batches: &BTreeMap<String, String>, lasts: &[&Calibrated]) -> Vec<BatchWithoutUnit> {
    let serials: BTreeSet<&str> = lasts.iter().map(|unit| unit.unit_serial.as_str()).collect();
    let mut by_spelling: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for serial in &serials {
        by_spelling.entry(spelling(serial)).or_default().push((*serial).to_owned());
    }
    let without = batches.keys().filter(|serial| !serials.contains(serial.as_str()));
    let mut without: Vec<BatchWithoutUnit> = without
        .map(|serial| BatchWithoutUnit {
            unit_serial: serial.clone(),
            near: by_spelling.get(&spelling(serial)).cloned().unwrap_or_default(),
        })
        .collect();
    without.sort_by_key(|of| of.near.is_empty());
    without
}

/// The units of batches by their sessions at one station, where most of them can be compared: type B that sessions of a station share would
/// separate batches of two stations.
fn of_batches<'a>(stations: &[AtStation<'a>], lasts: &[&Calibrated], request: &UnitsHistoryRequest) -> AtStation<'a> {
    let with_batch = |units: &AtStation<'a>| -> AtStation<'a> {
        let has_batch =
            |(number, _): &&(usize, Vec<&Calibrated>)| request.batches.contains_key(&lasts[*number].unit_serial);
        units.iter().filter(has_batch).cloned().collect()
    };
    let number_compared = |units: &AtStation| {
        let mut sizes: BTreeMap<&str, usize> = BTreeMap::new();
        for (number, _) in units {
            *sizes.entry(&request.batches[&lasts[*number].unit_serial]).or_default() += 1;
        }
        let sizes: Vec<usize> = sizes.into_values().filter(|size| *size > 1).collect();
        if sizes.len() > 1 { sizes.iter().sum() } else { 0 }
    };
    // Of equals the first, by the names of the stations.
    let candidates = stations.iter().rev().map(with_batch);
    candidates.max_by_key(|units| (number_compared(units), units.len())).unwrap_or_default()
}

/// The means of the units of each batch, by its name.
fn batches<'a>(
    units: &AtStation,
    lasts: &[&Calibrated],
    name: &str,
    request: &'a UnitsHistoryRequest,
) -> BTreeMap<&'a str, Vec<f64>> {
    let means = unit_means(units.iter().map(|(_, sessions)| sessions.as_slice()), name);
    let mut batches: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for ((number, _), mean) in units.iter().zip(means) {
        if let Some(batch) = request.batches.get(&lasts[*number].unit_serial) {
            batches.entry(batch).or_default().push(mean);
        }
    }
    batches
}
