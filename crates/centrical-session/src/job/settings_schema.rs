//! JSON Schemas of the files that people write, from the forms that read them.

use schemars::JsonSchema;
use schemars::generate::SchemaSettings;

use crate::error::Error;
use crate::experiment::{ExperimentForm, PlanForm};
use crate::laboratory::Laboratory;
use crate::truth::TruthForm;

/// A file that people write.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SettingsForm {
    /// `experiment.toml` of a session.
    Experiment,
    /// A plan: the form of a session with candidates in place of mountings, or a preset experiment.
    Plan,
    /// The truth file of a simulation.
    Truth,
    /// `laboratory.toml`.
    Laboratory,
}

/// JSON Schema of a form, draft 7, which editors of TOML read. The schema knows keys and their types; units, names and
/// relations between keys are checked when the file is read.
///
/// # Errors
/// [`Error::Json`] when the schema has no place in JSON.
pub fn settings_schema(form: SettingsForm) -> Result<String, Error> {
    match form {
        SettingsForm::Experiment => schema_of::<ExperimentForm>("experiment.toml"),
        SettingsForm::Plan => schema_of::<PlanForm>("plan"),
        SettingsForm::Truth => schema_of::<TruthForm>("truth.toml"),
        SettingsForm::Laboratory => schema_of::<Laboratory>("laboratory.toml"),
    }
}

fn schema_of<T: JsonSchema>(title: &str) -> Result<String, Error> {
    let mut schema = SchemaSettings::draft07().into_generator().into_root_schema_for::<T>();
    schema.insert("title".to_owned(), title.into());
    let text = serde_json::to_string_pretty(&schema).map_err(|source| Error::Json { document: "schema", source })?;
    Ok(text + "\n")
}
