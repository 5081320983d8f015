//! `tumble`: a unit that was turned by hand or on a table, calibrated by gravity alone.

use std::path::{Path, PathBuf};

use centrical_report::{Language, refuse_outputs, write_all_documents};
use centrical_session::{Dimension, Error, Folder, Quantity, StatedAttitudes, TumbleRequest, claim_folder};
use nalgebra::Vector3;
use pyo3::prelude::*;

use crate::given::GivenFile;
use crate::progress::{self, Shown};
use crate::result::CalibrationResult;
use crate::words::{Amount, GivenColumn, column, refused};

/// Attitudes in which the unit was laid down.
#[derive(FromPyObject)]
pub enum Attitudes {
    /// A table of them, or `"cube"`.
    Table(PathBuf),
    /// Where up is, axes of the case, of any length.
    Directions(Vec<[f64; 3]>),
}

/// The result of records; into the folder `out` as well, with the rests as a session and the report, if one is given.
#[pyfunction]
pub fn tumble(
    py: Python,
    records: Vec<GivenFile>,
    time: GivenColumn,
    rate: Option<Amount>,
    readings: [GivenColumn; 3],
    unit: String,
    gravity: [Option<Amount>; 2],
    attitudes: Option<(Attitudes, Option<Amount>)>,
    turning_radius: Option<Amount>,
    terms: Option<Vec<String>>,
    model: String,
    serial: String,
    date: String,
    out: Option<PathBuf>,
    shown: Shown,
) -> PyResult<CalibrationResult> {
    let [first, second, third] = readings;
    let [gravity, uncertainty] = gravity;
    let gravity = Amount::checked(gravity, "gravity", Quantity::gravity)?;
    let uncertainty = Amount::optional(uncertainty, "gravity_uncertainty", Dimension::Acceleration)?;
    if gravity.is_none() && uncertainty.is_some() {
        return Err(refused("gravity_uncertainty", "found without gravity, expected both"));
    }
    let [gravity, gravity_uncertainty] = TumbleRequest::gravity(gravity, uncertainty);
    let (mut files, mut folder) = (Vec::new(), Folder::default());
    for record in records {
        let file;
        (file, folder) = record.in_folder(folder);
        files.push(file);
    }
    let mut request = TumbleRequest {
        files,
        folder,
        time: column("time", time)?,
        rate: Amount::checked(rate, "rate", Quantity::sampling_rate)?,
        readings: [column("readings", first)?, column("readings", second)?, column("readings", third)?],
        unit: TumbleRequest::unit(&unit).map_err(|wrong| refused("unit", wrong))?,
        gravity,
        gravity_uncertainty,
        attitudes: None,
        turning_radius: Amount::checked(turning_radius, "turning_radius", TumbleRequest::turning_radius)?,
        terms: terms.unwrap_or_else(|| TumbleRequest::USUAL_TERMS.map(str::to_owned).to_vec()),
        model,
        serial,
        date: TumbleRequest::date(&date).map_err(|wrong| refused("date", wrong))?,
    };
    let attitudes = attitudes.map(|(attitudes, uncertainty)| checked(attitudes, uncertainty)).transpose()?;
    let result = progress::run(py, &shown, |work| {
        request.attitudes = attitudes.map(|(attitudes, uncertainty)| stated(attitudes, uncertainty)).transpose()?;
        let folder = out.as_deref().unwrap_or(Path::new(""));
        let claim = out.as_deref().map(claim_folder).transpose()?;
        if out.is_some() {
            let inputs: Vec<&Path> = request.inputs().collect();
            let unit = [request.model.as_str(), &request.serial];
            refuse_outputs(Some(&folder.join("result.json")), Some(folder), &inputs, unit)?;
        }
        let tumble = centrical_session::tumble(&request, folder, &|bytes| work.advance(bytes))?;
        if out.is_some() {
            tumble.write(&request, folder)?;
            write_all_documents(&tumble.result, None, Language::English, folder)?;
        }
        drop(claim);
        Ok(tumble.result)
    })?;
    Ok(result.into())
}

/// Rows that are not directions, and a missing uncertainty, are errors of the call.
fn checked(attitudes: Attitudes, uncertainty: Option<Amount>) -> PyResult<(Attitudes, f64)> {
    let uncertainty = Amount::optional(uncertainty, "attitude_uncertainty", Dimension::Angle)?;
    let missing =
        || refused("attitude_uncertainty", "found None beside attitudes, expected an angle such as \"0.1 deg\"");
    if let Attitudes::Directions(directions) = &attitudes {
        let is_direction = |up_b: &[f64; 3]| up_b.iter().all(|c| c.is_finite()) && up_b.iter().any(|c| *c != 0.0);
        if let Some(wrong) = directions.iter().find(|up_b| !is_direction(up_b)) {
            return Err(refused(
                "attitudes",
                format!("found {wrong:?}, expected a direction of finite numbers, not all zero"),
            ));
        }
    }
    Ok((attitudes, uncertainty.ok_or_else(missing)?))
}

fn stated(attitudes: Attitudes, uncertainty: f64) -> Result<StatedAttitudes, Error> {
    match attitudes {
        Attitudes::Table(table) => StatedAttitudes::named(&table, uncertainty),
        Attitudes::Directions(directions) => {
            let up_b = directions.into_iter().map(|up_b| Vector3::from(up_b).normalize()).collect();
            Ok(StatedAttitudes { up_b, uncertainty, file: None })
        }
    }
}
