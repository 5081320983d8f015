//! Which calibrations are meant.

use std::collections::BTreeSet;
use std::path::PathBuf;

use centrical_session::{Calibrated, Depth, Error, Place, Selection, read_calibrations, spelling, unwatched};

/// Results, and what they have to be of.
#[derive(Debug, Clone, clap::Args)]
pub struct Choice {
    /// Stores, results of calibrations, or folders of results: each result.json at any depth
    #[arg(required = true, value_name = "STORE|RESULT|FOLDER")]
    pub results: Vec<PathBuf>,
    /// Model of the unit
    #[arg(long)]
    pub model: Option<String>,
    /// Serial number of the unit
    #[arg(long)]
    pub serial: Option<String>,
    /// Centrifuge, as its sessions call it
    #[arg(long)]
    pub station: Option<String>,
}

impl Choice {
    /// The calibrations, in the order of time, read to a depth.
    pub fn read(&self, depth: Depth) -> Result<Vec<Calibrated>, Error> {
        let selection = Selection {
            depth,
            unit_model: self.model.clone(),
            unit_serial: self.serial.clone(),
            station: self.station.clone(),
            ..Selection::default()
        };
        let calibrations = read_calibrations(&self.results, &selection, &unwatched)?;
        if calibrations.is_empty() {
            let found = format!("no such calibration{}", self.alike());
            return Err(self.refuse(found, "results, as --model, --serial and --station ask for"));
        }
        Ok(calibrations)
    }

    /// Serial numbers that differ from the one asked for in spaces, hyphens, case or Cyrillic letters alone.
    fn alike(&self) -> String {
        let Some(wanted) = self.serial.as_deref().map(spelling) else { return String::new() };
        let all = read_calibrations(&self.results, &Selection::default(), &unwatched).unwrap_or_default();
        let alike = all.iter().map(|c| c.unit_serial.as_str()).filter(|serial| spelling(serial) == wanted);
        let alike: BTreeSet<String> = alike.map(|serial| format!("\"{serial}\"")).collect();
        let listed = alike.into_iter().collect::<Vec<_>>().join(", ");
        if listed.is_empty() { listed } else { format!(" but those of serial {listed}") }
    }

    /// What all have in common.
    ///
    /// # Errors
    /// [`Error`] if they do not.
    pub fn only<'a>(
        &self,
        calibrations: &'a [Calibrated],
        of: impl Fn(&'a Calibrated) -> &'a str,
        option: &str,
    ) -> Result<(), Error> {
        let names: BTreeSet<&str> = calibrations.iter().map(of).collect();
        if names.len() < 2 {
            return Ok(());
        }
        let listed = names.iter().take(8).map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
        let more = if names.len() > 8 { format!(" and {} more", names.len() - 8) } else { String::new() };
        Err(self.refuse(format!("{listed}{more}"), &format!("one, by {option}")))
    }

    /// An error of the choice as a whole.
    pub fn refuse(&self, found: String, expected: &str) -> Error {
        Error::content(&self.results[0], Place::Whole, found, expected)
    }
}
