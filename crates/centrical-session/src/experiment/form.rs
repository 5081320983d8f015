//! The form of `experiment.toml` and of plans as it is written.

mod entries;
mod tables;

use std::path::Path;

use serde::de::DeserializeOwned;

pub(crate) use self::entries::{ColumnEntry, ColumnTable, PriorValue, TermEntry, TermList, TermTable};
pub(crate) use self::tables::{
    CandidatesTable, CentrifugeTable, ColumnsTable, CountsTable, Form, MeasuredTable, ModelTable, MountingTable,
    PlanTable, PlateauEntry, PositionTable, PresetCentrifugeTable, PresetForm, PresetTable, SiteTable, Steps,
    UnitTable,
};
use crate::error::{Error, Place};

/// Reads a form from the text of `file`.
pub(crate) fn parse<T: DeserializeOwned>(file: &Path, text: &str) -> Result<T, Error> {
    toml::from_str(text).map_err(|error| Error::Form {
        file: file.to_owned(),
        place: error.span().map_or(Place::Whole, |span| Place::of_byte(text, span.start)),
        message: error.message().trim().replace('\n', ", "),
    })
}
