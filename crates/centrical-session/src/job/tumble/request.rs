//! Which records, and what is to be made of them.

use std::path::{Path, PathBuf};

use centrical_table::{ColumnName, unit_of_word};

use crate::experiment::{Folder, MOST_DISTANT, RAW_OUTPUT, StatedAttitudes};
use crate::quantity::{Dimension, NotThatQuantity, Quantity};

/// Records of a unit that rested in attitudes that only gravity shows, and what is to be made of them.
#[derive(Debug, Clone, PartialEq)]
pub struct TumbleRequest {
    /// The records, in any format.
    pub files: Vec<PathBuf>,
    /// Where they are.
    pub folder: Folder,
    /// Column of time [s].
    pub time: ColumnName,
    /// Sampling rate of records without a column of time [Hz].
    pub rate: Option<f64>,
    /// Columns of newtonometers 1, 2, 3.
    pub readings: [ColumnName; 3],
    /// Unit of the readings: one of acceleration, `V` or `counts`.
    pub unit: String,
    /// Gravity at the place [m/s^2].
    pub gravity: f64,
    /// Its standard uncertainty [m/s^2].
    pub gravity_uncertainty: f64,
    /// Attitudes in which the unit was laid down, where they are known.
    pub attitudes: Option<StatedAttitudes>,
    /// Largest distance of the proof masses from the axis of rotation [m]: slow rotation counts as rests. `None`: it does not count.
    pub turning_radius: Option<f64>,
    /// Terms of the error model, as in `[model]`.
    pub terms: Vec<String>,
    /// Model of the unit; empty if it is not stated.
    pub model: String,
    /// Serial number of the unit.
    pub serial: String,
    /// Date of the records, as written.
    pub date: String,
}

impl TumbleRequest {
    /// Bias, scale and misalignment: what a unit shows at 1 g.
    pub const USUAL_TERMS: [&'static str; 9] =
        ["df_1", "df_2", "df_3", "G0_11", "G0_21", "G0_22", "G0_31", "G0_32", "G0_33"];

    /// The unit of readings: one of acceleration, `V` or `counts`, in the spelling of settings.
    ///
    /// # Errors
    /// What was found and expected.
    pub fn unit(text: &str) -> Result<String, String> {
        let unit = unit_of_word(text).unwrap_or(text);
        let is_raw = RAW_OUTPUT.iter().any(|(_, raw, _)| *raw == unit);
        if is_raw || Dimension::Acceleration.factor(unit).is_some() {
            return Ok(unit.to_owned());
        }
        Err(format!(
            "found {text:?}, expected a unit of acceleration such as \"m/s^2\" or \"g\", or \"counts\" or \"V\""
        ))
    }

    /// The largest distance of the proof masses from an axis of rotation [m].
    ///
    /// # Errors
    /// [`NotThatQuantity`] if it is negative or beyond 10 m.
    pub fn turning_radius(distance: &Quantity) -> Result<f64, NotThatQuantity> {
        distance.within(Dimension::Length, 0.0..=MOST_DISTANT, &format!("a distance of 0 to {MOST_DISTANT} m"))
    }

    /// All files that are read: the records, and that of the attitudes.
    pub fn inputs(&self) -> impl Iterator<Item = &Path> {
        let attitudes = self.attitudes.iter().flat_map(|attitudes| &attitudes.file);
        self.files.iter().chain(attitudes).map(PathBuf::as_path)
    }

    /// Standard uncertainty of the gravity of an unknown place on Earth [m/s^2]: rectangular from 9.764 to 9.834 m/s^2.
    pub const GRAVITY_ANYWHERE: f64 = 0.02;
}
