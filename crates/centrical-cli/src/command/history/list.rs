//! `centrical history list STORE`: the calibrations of a store.

use std::path::PathBuf;

use centrical_report::history_list_text;
use centrical_session::{Error, Place, Selection, check_store, list_store, unwatched};

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
    /// Say what may not be meant: one unit under two names, one session twice, days to come, copies that are missing or changed
    #[arg(long)]
    check: bool,
    #[command(flatten)]
    printing: Printing,
}

/// Runs the command. Exit code 1 when a check finds something.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let selection = Selection {
        unit_model: arguments.model.clone(),
        unit_serial: arguments.serial.clone(),
        station: arguments.station.clone(),
        ..Selection::default()
    };
    let names_any = selection.names_any();
    let list = if arguments.check {
        check_store(&arguments.store, selection, &unwatched)?
    } else {
        list_store(&arguments.store, selection, &unwatched)?
    };
    if names_any && list.calibrations.is_empty() {
        let expected = "a calibration, as --model, --serial and --station ask for";
        return Err(Error::content(&arguments.store, Place::Whole, "no such calibration", expected));
    }
    arguments.printing.show(|| history_list_text(&list), || list.to_json())?;
    Ok(Outcome::acceptable(list.doubts.is_none_or(|doubts| doubts.is_empty())))
}
