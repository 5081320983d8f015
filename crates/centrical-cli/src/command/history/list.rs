//! `centrical history list STORE`: the calibrations of a store.

use std::path::PathBuf;

use centrical_report::history_list_text;
use centrical_session::{Error, Selection, list_store};

use crate::outcome::Outcome;
use crate::printing::Printing;

/// List the calibrations of a store by unit and day.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical history list store --serial 0001")]
pub struct Arguments {
    /// Folder of the store
    store: PathBuf,
    /// Of units of this model alone
    #[arg(long)]
    model: Option<String>,
    /// Of units of this serial number alone
    #[arg(long)]
    serial: Option<String>,
    /// Of this station alone
    #[arg(long)]
    station: Option<String>,
    #[command(flatten)]
    printing: Printing,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let selection = Selection {
        unit_model: arguments.model.clone(),
        unit_serial: arguments.serial.clone(),
        station: arguments.station.clone(),
        ..Selection::default()
    };
    let list = list_store(&arguments.store, selection)?;
    arguments.printing.show(|| history_list_text(&list), || list.to_json())?;
    Ok(Outcome::Done)
}
