//! A result restated in other axes: those that a form of the scale matrix, the case, or a file names.

use std::path::{Path, PathBuf};

use centrical::is_rotation;
use centrical::uncertainty::ScaleForm;
use nalgebra::{Matrix3, Matrix3xX};
use serde::Deserialize;

use crate::document::{Attitude, AxesName, AxesSummary, CalibrationResult};
use crate::error::{Error, NoErrorModel};
use crate::experiment::TomlPath;
use crate::quantity::Quantity;
use crate::settings::{from_toml, read_settings};
use crate::units::Dimension;

/// Axes to state a result in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Axes {
    /// Those in which the scale matrix has a form.
    Form(ScaleForm),
    /// Those of the case, by the turns of the instrument in its positions.
    Case,
    /// Those of a file.
    File(PathBuf),
}

impl From<&str> for Axes {
    /// `lower`, `upper`, `symmetric`, `case`; anything else is a file.
    fn from(text: &str) -> Self {
        match text {
            "lower" => Self::Form(ScaleForm::LowerTriangular),
            "upper" => Self::Form(ScaleForm::UpperTriangular),
            "symmetric" => Self::Form(ScaleForm::Symmetric),
            "case" => Self::Case,
            file => Self::File(file.into()),
        }
    }
}

/// `axes.toml`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct AxesFile {
    axes: AxesTable,
}

/// Axes that are fixed to others.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct AxesTable {
    /// What they are called.
    name: String,
    /// What they are fixed to.
    of: Base,
    /// Takes coordinates of the base to coordinates in these axes, by rows.
    matrix: [[f64; 3]; 3],
    /// Standard uncertainty of their turn about each axis.
    #[serde(default)]
    uncertainty: Option<Quantity>,
}

/// What axes of a file are fixed to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Base {
    /// The axes of the newtonometers.
    Instrument,
    /// The case.
    Case,
}

impl Axes {
    /// `result`, read from `file`, with its error model stated in these axes too: what compensates by it gives specific forces there.
    ///
    /// # Errors
    /// [`Error::ErrorModel`] when the data do not determine a coefficient, the scale matrix, or the turns of the case; [`Error`] when the file of
    /// axes is wrong.
    pub fn of(&self, result: CalibrationResult, file: &Path) -> Result<CalibrationResult, Error> {
        let failed = |source| Error::ErrorModel { file: file.to_owned(), source };
        let attitude = match self {
            Self::Form(form) => by_form(&result, *form).map_err(failed)?,
            Self::Case => result.of_case().map_err(failed)?,
            Self::File(path) => AxesTable::read(path)?.attitude(path, &result)?,
        };
        let axes = AxesSummary::new(&result, attitude).map_err(failed)?;
        Ok(CalibrationResult { axes: Some(axes), ..result })
    }
}

/// The axes in which the scale matrix has `form`.
fn by_form(result: &CalibrationResult, form: ScaleForm) -> Result<Attitude, NoErrorModel> {
    let terms = result.error_terms()?;
    let singular = || NoErrorModel::Axes { found: "a scale matrix that no turn brings to this form".to_owned() };
    let c_zb = form.attitude(&terms).ok_or_else(singular)?;
    let by_coefficient = form.turn_by_coefficient(&terms, &c_zb).ok_or_else(singular)?;
    let mut turn = Matrix3xX::zeros(result.parameters.len());
    for (term, column) in result.model.error_model.iter().zip(by_coefficient.column_iter()) {
        if let Some(j) = result.parameters.iter().position(|p| p.name == term.name) {
            turn.set_column(j, &column);
        }
    }
    let name = match form {
        ScaleForm::LowerTriangular => AxesName::LowerTriangular,
        ScaleForm::UpperTriangular => AxesName::UpperTriangular,
        ScaleForm::Symmetric => AxesName::Symmetric,
    };
    let (stated, scatter) = (Matrix3::zeros(), Matrix3::zeros());
    Ok(Attitude { name, c_zb, turn, stated, scatter, positions: None })
}

impl AxesTable {
    fn read(path: &Path) -> Result<Self, Error> {
        let text = read_settings(path, "a file of axes, or one of lower, upper, symmetric, case")?;
        Ok(from_toml::<AxesFile>(path, &text)?.axes)
    }

    /// Where the axes of the file at `path` lie.
    fn attitude(&self, path: &Path, result: &CalibrationResult) -> Result<Attitude, Error> {
        let at = TomlPath::table(path, "axes");
        let base = match self.of {
            Base::Instrument => Attitude {
                name: AxesName::LowerTriangular,
                c_zb: Matrix3::identity(),
                turn: Matrix3xX::zeros(result.parameters.len()),
                stated: Matrix3::zeros(),
                scatter: Matrix3::zeros(),
                positions: None,
            },
            Base::Case => result.of_case().map_err(|source| Error::ErrorModel { file: path.to_owned(), source })?,
        };
        let c_ba = Matrix3::from_fn(|i, j| self.matrix[i][j]);
        if !is_rotation(&c_ba) {
            let expected = "a right-handed rotation, its rows orthonormal to nine digits";
            return Err(at.unexpected("matrix", format!("{:?}", self.matrix), expected));
        }
        let uncertainty = self.uncertainty.as_ref().map_or(Ok(0.0), |quantity| {
            at.bounded("uncertainty", quantity, Dimension::Angle, (0.0, 1.0), "an angle from 0 to 1 rad")
        })?;
        Ok(Attitude {
            name: AxesName::Other(self.name.clone()),
            c_zb: base.c_zb * c_ba.transpose(),
            turn: c_ba * base.turn,
            stated: Matrix3::identity() * uncertainty.powi(2),
            scatter: c_ba * base.scatter * c_ba.transpose(),
            positions: base.positions,
        })
    }
}
