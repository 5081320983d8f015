//! One centrifuge over all its sessions: what is of the machine, and not of the units that come and go.

use std::borrow::Borrow;
use std::collections::{BTreeMap, BTreeSet};

use centrical::Group;
use centrical::history::{Reading, StationTest};
use centrical::uncertainty::{Level, family_wise};

use super::calibrated::{Calibrated, CalibratedParameter, years};
use super::no_history::NoHistory;
use crate::document::{Program, STATION_HISTORY_SCHEMA, StationHistoryReport, StationParameter};

/// The history of the machine of `calibrations`.
///
/// # Errors
/// [`NoHistory`] without a calibration, and with those of several stations.
pub fn station_history(calibrations: &[impl Borrow<Calibrated>]) -> Result<StationHistoryReport, NoHistory> {
    let calibrations: Vec<&Calibrated> = calibrations.iter().map(Borrow::borrow).collect();
    NoHistory::refuse_several_stations(calibrations.iter().copied())?;
    let dates = || calibrations.iter().map(|calibrated| calibrated.date);
    let first = dates().min().ok_or(NoHistory::Nothing)?;
    let last = dates().max().ok_or(NoHistory::Nothing)?;
    let units: BTreeSet<(&str, &str)> = calibrations.iter().map(|c| c.unit()).collect();
    let number: BTreeMap<(&str, &str), usize> = units.iter().enumerate().map(|(n, unit)| (*unit, n)).collect();
    let mut by_name: BTreeMap<(&str, &str), Vec<(&Calibrated, Reading)>> = BTreeMap::new();
    let mut names: Vec<(&str, &str)> = Vec::new();
    for &calibrated in &calibrations {
        let all = calibrated.parameters.iter().zip(&calibrated.values);
        for (parameter, &value) in all.filter(|(p, value)| is_of_machine(p) && value.is_finite()) {
            let unit = number.get(&calibrated.unit()).copied().unwrap_or_default();
            let reading = Reading { time: years(first, calibrated.date), unit, value };
            let name = (parameter.name.as_str(), parameter.unit.as_str());
            if !by_name.contains_key(&name) {
                names.push(name);
            }
            by_name.entry(name).or_default().push((calibrated, reading));
        }
    }
    let mut parameters: Vec<StationParameter> =
        names.iter().filter_map(|name| parameter(*name, &by_name[name])).collect();
    let chances: Vec<f64> = parameters.iter().map(|p| p.probability.unwrap_or(1.0)).collect();
    for (parameter, chance) in parameters.iter_mut().zip(family_wise(&chances)) {
        parameter.changes = parameter.probability.is_some() && Level::Reported.is_passed_by(chance);
    }
    let is_tested = parameters.iter().any(|p| p.probability.is_some());
    Ok(StationHistoryReport {
        schema: STATION_HISTORY_SCHEMA,
        program: Program::this(),
        station: calibrations[0].station.clone(),
        sessions: calibrations.len(),
        units: units.len(),
        first,
        last,
        is_steady: is_tested.then(|| !parameters.iter().any(|p| p.changes)),
        parameters,
    })
}

/// Attitudes of rests are as the unit was laid down, and the turn against the case is the unit's.
fn is_of_machine(parameter: &CalibratedParameter) -> bool {
    !parameter.is_of_unit && !matches!(parameter.group, Group::Attitude | Group::CaseTurn)
}

fn parameter((name, unit): (&str, &str), sessions: &[(&Calibrated, Reading)]) -> Option<StationParameter> {
    let readings: Vec<Reading> = sessions.iter().map(|(_, reading)| *reading).collect();
    let (calibrated, _) = sessions.first()?;
    let place = calibrated.place(name)?;
    let values = readings.iter().map(|reading| reading.value);
    let mean = values.clone().sum::<f64>() / readings.len() as f64;
    let squares = sessions.iter().filter_map(|(c, _)| Some(c.standard_uncertainties[c.place(name)?].powi(2)));
    let stated = (squares.sum::<f64>() / readings.len() as f64).sqrt();
    let scatter = (values.map(|v| (v - mean).powi(2)).sum::<f64>() / (readings.len().max(2) - 1) as f64).sqrt();
    let found = StationTest::of(&readings);
    let test = found.filter(StationTest::has_power);
    let zero = sessions.iter().map(|(calibrated, _)| calibrated.date).min()?;
    let day = |time: f64| sessions.iter().map(|(c, _)| c.date).find(|date| years(zero, *date) == time);
    Some(StationParameter {
        name: name.to_owned(),
        unit: unit.to_owned(),
        group: calibrated.parameters[place].group,
        sessions: readings.len(),
        mean,
        scatter,
        slope_per_year: test.map(|test| test.slope),
        slope_uncertainty: test.map(|test| test.standard_uncertainty),
        slope_probability: test.map(|test| test.slope_probability),
        changed_after: test.and_then(|test| day(test.changed_after)),
        change: test.map(|test| test.change),
        change_probability: test.map(|test| test.change_probability),
        farthest: test.and_then(|test| day(test.farthest)),
        distance: test.map(|test| test.distance),
        farthest_probability: test.map(|test| test.farthest_probability),
        succession_probability: test.map(|test| test.succession_probability),
        scatter_ratio: scatter / stated,
        is_confounded: found.is_some() && test.is_none(),
        probability: test.map(|test| test.probability()),
        changes: false,
    })
}
