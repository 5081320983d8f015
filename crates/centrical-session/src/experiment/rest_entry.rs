//! What an entry `[[tumble]]` states of its rests.

use std::path::Path;

use centrical::SwitchOn;

use super::folder::Folder;
use super::form::{AttitudeList, TumbleTable};
use super::stated_attitudes::{LEAST_UNCERTAIN, MOST_UNCERTAIN, StatedAttitudes, directions};
use super::toml_path::TomlPath;
use crate::error::Error;
use crate::quantity::Quantity;
use crate::units::Dimension;

/// When the unit was on in `[[tumble]]` number `n` from 0: a switch-on of its own, numbered from 1, or that of the first entry with the
/// same name. Its change of bias may be stated in any of them.
pub(super) fn switch_on(file: &Path, tables: &[TumbleTable], n: usize) -> Result<SwitchOn, Error> {
    let is_same = |other: &&(usize, &TumbleTable)| {
        other.0 == n || tables[n].switch_on.is_some() && other.1.switch_on == tables[n].switch_on
    };
    let tables: Vec<(usize, &TumbleTable)> = tables.iter().enumerate().collect();
    let number = tables.iter().find(is_same).map_or(n, |(first, _)| *first) + 1;
    let mut bias_change = None;
    for (other, table) in tables.iter().filter(is_same) {
        let Some(quantity) = &table.bias_change else { continue };
        let at = TomlPath::entry(file, "tumble", *other);
        // Beyond it a unit was mistaken.
        let meaning = "a standard uncertainty from 0 to 10 m/s^2";
        let stated = at.bounded("bias_change", quantity, Dimension::Acceleration, (0.0, 10.0), meaning)?;
        if bias_change.replace(stated).is_some_and(|before| before != stated) {
            let expected = "the same in all [[tumble]] of one switch_on";
            return Err(at.unexpected("bias_change", quantity.to_string(), expected));
        }
    }
    Ok(SwitchOn { number, bias_change, from_axes: 0.0 })
}

/// What has been measured lasted as long as it did.
pub(super) fn refuse_duration(at: &TomlPath, table: &TumbleTable) -> Result<(), Error> {
    for (key, is_there) in [("duration", table.duration.is_some()), ("durations", !table.durations.is_empty())] {
        if is_there {
            return Err(at.unexpected(key, "a duration", "no such key beside rests, which have been measured"));
        }
    }
    Ok(())
}

/// Attitudes that are known of measured rests, and their standard uncertainty [rad]; one without the other says nothing.
pub(super) fn known<'a>(at: &TomlPath, table: &'a TumbleTable) -> Result<Option<(&'a AttitudeList, f64)>, Error> {
    match (&table.attitudes, uncertainty(at, table.attitude_uncertainty.as_ref())?) {
        (None, None) => Ok(None),
        (Some(entry), Some(uncertainty)) => Ok(Some((entry, uncertainty))),
        (Some(_), None) => {
            let expected = "the standard uncertainty of the attitudes, such as \"0.1 deg\"";
            Err(at.unexpected("attitude_uncertainty", "no such key beside attitudes", expected))
        }
        (None, Some(_)) => {
            let expected = "a table of the attitudes that are this uncertain";
            Err(at.unexpected("attitudes", "no such key beside attitude_uncertainty", expected))
        }
    }
}

/// Attitudes of this standard uncertainty [rad] as the key `attitudes` has them; paths start from `folder`.
pub(super) fn stated(
    at: &TomlPath,
    folder: &Folder,
    entry: &AttitudeList,
    uncertainty: f64,
) -> Result<StatedAttitudes, Error> {
    let (up_b, file) = directions(at, folder, entry)?;
    Ok(StatedAttitudes { up_b, uncertainty, file })
}

/// The standard uncertainty of the attitudes [rad], if they are known.
pub(super) fn uncertainty(at: &TomlPath, stated: Option<&Quantity>) -> Result<Option<f64>, Error> {
    let bounds = (LEAST_UNCERTAIN, MOST_UNCERTAIN);
    let meaning = "a standard uncertainty of 1e-12 rad to 10 deg";
    let bounded = |q| at.bounded("attitude_uncertainty", q, Dimension::Angle, bounds, meaning);
    stated.map(bounded).transpose()
}
