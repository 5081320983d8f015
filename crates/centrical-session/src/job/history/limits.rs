//! Limits of parameters by a laboratory's file, for many calibrations.

use std::collections::BTreeMap;
use std::path::Path;

use super::calibrated::{Calibrated, CalibratedParameter};
use crate::error::Error;
use crate::laboratory::{Laboratory, Limitable, Limited};

/// Limits of parameters by name, SI: lowest and highest value.
pub type ParameterLimits = BTreeMap<String, (Option<f64>, Option<f64>)>;

/// The limits of parameters in the decision of the laboratory's `file`, for the parameters of `calibrations`. Limits of the compensated reading
/// are passed over.
///
/// # Errors
/// [`Error`] when the file is wrong, or a limit names no parameter of any of the calibrations.
pub fn read_limits(file: &Path, calibrations: &[Calibrated]) -> Result<ParameterLimits, Error> {
    let laboratory = Laboratory::read(file)?;
    let mut by_name: BTreeMap<&str, &CalibratedParameter> = BTreeMap::new();
    for calibrated in calibrations {
        by_name.extend(calibrated.parameters.iter().map(|p| (p.name.as_str(), p)));
    }
    let parameters = by_name.values().map(|p| Limitable { name: &p.name, unit: &p.unit, group: p.group });
    let limits = laboratory.limits(file, &parameters.collect::<Vec<_>>())?;
    let of_parameter = limits.into_iter().filter_map(|limit| match limit.of {
        Limited::Parameter(name) => Some((name, (limit.low.map(|end| end.si), limit.high.map(|end| end.si)))),
        Limited::CompensatedReading(_) => None,
    });
    Ok(of_parameter.collect())
}
