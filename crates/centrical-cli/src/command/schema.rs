//! `centrical schema FORM`: the JSON Schema of a file that people write.

use std::path::PathBuf;

use crate::output::{Outcome, print};
use centrical_session::{Error, SettingsForm, refuse_inputs, settings_schema, write_whole};
use clap::ValueEnum;

/// Print the JSON Schema of a settings file, for completion and checks in an editor.
///
/// With `#:schema experiment.schema.json` as its first line, editors of TOML (Taplo, Even Better TOML) complete and check the file.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical schema experiment --out experiment.schema.json")]
pub struct Arguments {
    /// The file that the schema describes
    form: FormName,
    /// Write the schema to a file
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Changes nothing: the schema is JSON
    #[arg(short, long)]
    json: bool,
    /// Changes nothing: no more than the schema is printed
    #[arg(short, long)]
    quiet: bool,
}

/// Files that people write.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum FormName {
    /// experiment.toml of a session
    Experiment,
    /// A plan, or a preset experiment
    Plan,
    /// The truth file of `simulate`
    Truth,
    /// laboratory.toml
    Laboratory,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let schema = settings_schema(match arguments.form {
        FormName::Experiment => SettingsForm::Experiment,
        FormName::Plan => SettingsForm::Plan,
        FormName::Truth => SettingsForm::Truth,
        FormName::Laboratory => SettingsForm::Laboratory,
    })?;
    match &arguments.out {
        Some(file) => {
            refuse_inputs(std::slice::from_ref(file), &[] as &[PathBuf])?;
            write_whole(file, schema.as_bytes())?;
        }
        None => print(&schema)?,
    }
    Ok(Outcome::Done)
}
