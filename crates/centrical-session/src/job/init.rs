//! `experiment.toml` from the files of a laboratory: what they show, what is guessed from them, and what only a person knows.
//!
//! Columns show the kind of a file: a record has a time and three readings (or one, with a file for each
//! newtonometer), telemetry a time and a speed. The telemetry shows the schedule. The readings show the attitude: at
//! rest the axis that reads `+-g` is vertical, while spinning the axis that reads most lies along the arm. Their ratio to
//! the square of the speed is the radius.

mod column_names;
mod draft;
mod experiment_text;
mod file_roles;
mod findings;
mod output_unit;
mod several_mountings;
mod sighting;
mod tumbled;

use std::path::{Path, PathBuf};

use centrical::OnProgress;

pub use self::column_names::time_column;
pub use self::draft::{Draft, InitRequest};
use self::tumbled::Tumbled;
use crate::error::{Error, Place};

/// Drafts an experiment file. `progress` is asked while records are read, with none done.
///
/// # Errors
/// [`Error`] when a file cannot be read, when none is a record, when one is of several mountings, when the experiment file is there, or when the tumble is of another unit of readings;
/// [`Error::Stopped`].
pub fn init(request: &InitRequest, progress: OnProgress) -> Result<Draft, Error> {
    request.refuse_existing()?;
    let (groups, unused) = file_roles::groups(&request.inputs)?;
    if groups.is_empty() {
        let inputs = request.inputs.first().map_or(Path::new("."), PathBuf::as_path);
        let table = "a table with a time and three readings, as text, Parquet, Arrow, NumPy, MATLAB or TDMS";
        let first = unused.first().map_or(String::new(), |error| format!(" ({error})"));
        let expected = format!("{table}{first}");
        return Err(Error::content(inputs, Place::Whole, "no record", expected));
    }
    let mountings = groups.into_iter().map(|group| sighting::sight(group, progress)).collect::<Result<Vec<_>, _>>()?;
    mountings.iter().try_for_each(several_mountings::refuse)?;
    let tumbled = request.tumble.as_deref().map(Tumbled::read).transpose()?;
    experiment_text::draft(mountings, tumbled.as_ref(), &unused, request)
}
