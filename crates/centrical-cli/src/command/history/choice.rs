//! The calibrations that a history is made of.

use std::collections::BTreeSet;
use std::path::PathBuf;

use centrical_report::{Emphasis, Screen};
use centrical_session::{Calibrated, Depth, Error, Past, Place, Selection, read_calibrations, spelling, unwatched};

use crate::output::remark;

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
        let Past { calibrations, undated } = read_calibrations(&self.results, &selection, &unwatched)?;
        remark_undated(&undated);
        if calibrations.is_empty() {
            let alike = self.alike();
            let but = if alike.is_empty() { alike } else { format!(" but those of serial {alike}") };
            let asked = "results, as --model, --serial and --station ask for";
            let expected = if selection.names_any() { asked } else { "results" };
            return Err(self.refuse(format!("no such calibration{but}"), expected));
        }
        Ok(calibrations)
    }

    /// Remarks that calibrations of other serial numbers may be of the unit that is asked for.
    pub fn remark_alike(&self) {
        let alike = self.alike();
        if !alike.is_empty() {
            let mut screen = Screen::default();
            let words = format!("calibrations of serial {alike} are not taken: expected one name for one unit");
            screen.marked(Emphasis::Warning, "SPELLING", &words);
            remark(&screen);
        }
    }

    /// Other serial numbers that differ from the one asked for in spaces, hyphens, case, leading zeros or Cyrillic letters alone.
    fn alike(&self) -> String {
        let Some(asked) = &self.serial else { return String::new() };
        let wanted = spelling(asked);
        let all = read_calibrations(&self.results, &Selection::default(), &unwatched).unwrap_or_default().calibrations;
        let alike =
            all.iter().map(|c| c.unit_serial.as_str()).filter(|serial| *serial != asked && spelling(serial) == wanted);
        let alike: BTreeSet<String> = alike.map(|serial| format!("\"{serial}\"")).collect();
        alike.into_iter().collect::<Vec<_>>().join(", ")
    }

    /// An error of the choice as a whole.
    pub fn refuse(&self, found: String, expected: &str) -> Error {
        Error::content(&self.results[0], Place::Whole, found, expected)
    }
}

/// Remarks that no history has calibrations without a day for a date.
fn remark_undated(undated: &[String]) {
    let mut screen = Screen::default();
    for calibration in undated {
        screen.marked(
            Emphasis::Warning,
            "NO DAY",
            &format!("{calibration}, expected a day such as 2026-10-05: left out"),
        );
    }
    remark(&screen);
}
