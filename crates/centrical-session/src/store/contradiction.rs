//! What in a row of a store contradicts itself: a part that was edited by hand or written by another program.

use std::collections::HashSet;

use centrical::{ErrorModel, Group, Term};
use centrical_compensate::Monomial;
use centrical_table::LARGEST_NUMBER;

use super::row::{Row, Status, TermSummary};
use super::schema::Depth;

/// Column, what was found there, and what was expected.
pub(crate) type Contradiction = (&'static str, String, String);

/// Relative difference of a variance from the square of a standard uncertainty that may be computed in another way: rounding makes some 1e-9 of it.
pub(crate) const ROUNDING: f64 = 1e-6;

/// The first contradiction in a row that was read so deep: lists have a number for each parameter, units are those of the groups, terms act as
/// their names say, and variances are the squares of the standard uncertainties.
pub(super) fn contradiction(row: &Row, depth: Depth) -> Option<Contradiction> {
    if row.status == Status::Failed || depth < Depth::Values {
        return None;
    }
    of_lists(row)
        .or_else(|| of_numbers(row))
        .or_else(|| of_units(row))
        .or_else(|| of_terms(&row.terms, |name| row.index(name).is_some()))
        .or_else(|| {
            let of_covariance = || of_covariance(row).or_else(|| of_changes(row));
            if depth >= Depth::Errors { of_covariance() } else { None }
        })
}

/// Lists have a number for each parameter, and a parameter stands once.
fn of_lists(row: &Row) -> Option<Contradiction> {
    let n = row.parameters.len();
    let mut names = HashSet::new();
    if let Some(twice) = row.parameters.iter().find(|name| !names.insert(*name)) {
        return Some(("parameters", format!("{twice:?} twice"), "each parameter once".to_owned()));
    }
    let lengths = [
        ("units", row.units.len()),
        ("groups", row.groups.len()),
        ("values", row.values.len()),
        ("standard_uncertainties", row.standard_uncertainties.len()),
    ];
    let (column, length) = lengths.into_iter().find(|(_, length)| *length != n)?;
    Some((column, format!("a list of {length}"), format!("{n}, the number of parameters")))
}

/// A parameter has a value and a standard uncertainty, or neither; scales of raw output are not zero.
fn of_numbers(row: &Row) -> Option<Contradiction> {
    let both = row.values.iter().zip(&row.standard_uncertainties).zip(&row.parameters);
    for ((value, uncertainty), name) in both {
        let wrong =
            |column, number: f64, expected: &str| Some((column, format!("{number:e} of {name}"), expected.to_owned()));
        if value.abs() > LARGEST_NUMBER {
            return wrong("values", *value, "a value of a calibration");
        }
        if *uncertainty < 0.0 || *uncertainty > LARGEST_NUMBER {
            return wrong("standard_uncertainties", *uncertainty, "zero or more");
        }
        if value.is_nan() != uncertainty.is_nan() {
            return wrong(
                "standard_uncertainties",
                *uncertainty,
                "a number where there is a value, and nothing elsewhere",
            );
        }
    }
    let is_raw = !row.output_unit.is_empty();
    let scales_are_whole = row.output_scale.len() == 3 && row.output_scale.iter().all(|scale| scale.is_normal());
    if is_raw && !scales_are_whole {
        return Some(("output_scale", format!("{:?}", row.output_scale), "three numbers other than zero".to_owned()));
    }
    (is_raw && row.output_bias.len() != 3)
        .then(|| ("output_bias", format!("{:?}", row.output_bias), "three numbers".to_owned()))
}

/// Units are those of the groups that have one.
fn of_units(row: &Row) -> Option<Contradiction> {
    let unit_of = |group: Group| {
        Some(match group {
            Group::Bias => "m/s^2",
            Group::Scale | Group::Misalignment => "1",
            Group::Quadratic => "s^2/m",
            Group::Cubic => "s^4/m^2",
            Group::Tilt | Group::Turn | Group::Attitude | Group::CaseTurn => "rad",
            Group::Shift | Group::ProofMass => "m",
            _ => return None,
        })
    };
    let mut all = row.units.iter().zip(&row.groups).zip(&row.parameters);
    all.find_map(|((unit, group), name)| {
        let expected = unit_of(*group).filter(|expected| expected != unit)?;
        Some(("units", format!("{unit:?} of {name}"), format!("{expected:?}")))
    })
}

/// Terms act as their names say, each once, and their coefficients are parameters.
pub(crate) fn of_terms(terms: &[TermSummary], is_parameter: impl Fn(&str) -> bool) -> Option<Contradiction> {
    let mut names = HashSet::new();
    terms.iter().find_map(|term| {
        let TermSummary { name, axis, powers, sign_of } = term;
        if let Some(other) = [axis].into_iter().chain(sign_of).find(|axis| !(1..=3).contains(*axis)) {
            return Some(("term_axes", format!("newtonometer {other} of {name}"), "1 to 3".to_owned()));
        }
        let monomial = Monomial { powers: *powers, sign_of: sign_of.map(|axis| axis - 1) };
        let known = ErrorModel::names(axis - 1, monomial);
        if !known.contains(name) {
            let of = Term::new(axis - 1, monomial).name;
            return Some((
                "term_powers",
                format!("{of} as the term {name}"),
                format!("the name {}", known.join(" or ")),
            ));
        }
        if !names.insert(name) {
            return Some(("terms", format!("{name:?} twice"), "each term once".to_owned()));
        }
        (!is_parameter(name)).then(|| ("terms", format!("{name:?}"), "one of the parameters".to_owned()))
    })
}

/// A covariance of all parameters with the squares of the standard uncertainties on its diagonal and no correlation above 1.
fn of_covariance(row: &Row) -> Option<Contradiction> {
    let (n, u) = (row.parameters.len(), &row.standard_uncertainties);
    let (length, expected) = (row.covariance.len(), n * (n + 1) / 2);
    if length != expected {
        return Some(("covariance", format!("a list of {length}"), format!("{expected}, for {n} parameters")));
    }
    let mut entries = (0..n).flat_map(|i| (0..=i).map(move |j| (i, j))).zip(&row.covariance);
    entries.find_map(|((i, j), entry)| {
        let most = u[i] * u[j];
        let is_possible =
            if i == j { (entry - most).abs() <= ROUNDING * most } else { entry.abs() <= (1.0 + ROUNDING) * most };
        (!is_possible && !entry.is_nan() && !most.is_nan()).then(|| {
            let found = format!("{entry:e} of {} and {}", row.parameters[i], row.parameters[j]);
            let at_most = if i == j { "" } else { " at most" };
            ("covariance", found, format!("{most:e}{at_most}, by the standard uncertainties"))
        })
    })
}

/// Influences and priors change each parameter.
fn of_changes(row: &Row) -> Option<Contradiction> {
    let n = row.parameters.len();
    let shared = row.shared.iter().map(|shared| ("shared_changes", shared.changes.len()));
    let priors = row.priors.iter().map(|prior| ("prior_changes", prior.changes.len()));
    let (column, length) = shared.chain(priors).find(|(_, length)| *length != n)?;
    Some((column, format!("{length} changes for each"), format!("{n}, the number of parameters")))
}
