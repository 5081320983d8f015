//! What a tumble of the unit adds to the draft: scale and bias of a raw output, gravity, and the rests.

use std::path::Path;

use super::draft::{Draft, relative};
use super::sighting::Raw;
use crate::error::{Error, Place};
use crate::experiment::{KnownAttitudes, OutputUnit, RestTable, Session};
use crate::settings::toml_text;

/// A unit that was calibrated by gravity alone.
pub(super) struct Tumbled {
    /// The folder, as it is named.
    folder: String,
    /// Its model, empty if none is stated.
    pub model: String,
    /// Its serial number, empty if none is stated.
    pub serial: String,
    /// What it puts out.
    pub output_unit: OutputUnit,
    /// Nominal scale and bias of a raw output, by which the means of the rests were made.
    pub raw: Raw,
    gravity: f64,
    /// Standard uncertainty of gravity [m/s^2].
    gravity_uncertainty: f64,
    rests: Vec<RestTable>,
}

impl Tumbled {
    /// Reads the folder that `centrical tumble --out` wrote, or a file in it.
    ///
    /// # Errors
    /// If it can not be read, or its session has no rests or a centrifuge.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let folder = if path.is_file() { path.parent().unwrap_or(Path::new("")) } else { path };
        let session = Session::read(folder)?;
        // Rests that are planned have no means.
        let has_rests = session.rests().count() > 0 && session.rest_tables.iter().all(|table| !table.means.is_empty());
        if !has_rests || !session.mountings.is_empty() {
            let found = if has_rests { "a centrifuge session" } else { "a session without rests" };
            return Err(Error::content(path, Place::Whole, found, "the folder of a result of centrical tumble"));
        }
        let scale = |axis: usize| session.columns.f[axis].scale;
        Ok(Self {
            folder: folder.display().to_string(),
            model: session.unit_model.clone(),
            serial: session.unit_serial.clone(),
            output_unit: session.output_unit,
            raw: Raw { scale: [0, 1, 2].map(|j| 1.0 / scale(j).factor), bias: [0, 1, 2].map(|j| scale(j).offset) },
            gravity: session.experiment.site.gravity,
            gravity_uncertainty: session.type_b.gravity,
            rests: session.rest_tables,
        })
    }

    /// How a line of it was found.
    pub fn how(&self) -> String {
        format!("by the tumble in {}", self.folder)
    }

    /// The line of gravity, which is that of the same place.
    pub fn gravity(&self, draft: &mut Draft) {
        draft.guess(&format!("gravity = \"{:?} m/s^2\"", self.gravity), &format!("{}, if that was here", self.how()));
    }

    /// The nominal scale and bias under the key `name`, to their last digit: the means of the rests are made with them.
    pub fn raw_line(&self, name: &str) -> String {
        format!("{name} = {{ scale = {:?}, bias = {:?} }}", self.raw.scale, self.raw.bias)
    }

    /// The table of uncertainties with that of gravity, and whether the tumble states one.
    fn gravity_uncertainty(&self, draft: &mut Draft) -> bool {
        let is_stated = self.gravity_uncertainty > 0.0;
        if is_stated {
            draft.line("[uncertainty]");
            draft.found(&format!("gravity = \"{:?} m/s^2\"", self.gravity_uncertainty), &self.how());
        }
        is_stated
    }

    /// The tables of rests.
    pub fn rests(&self, draft: &mut Draft, folder: &Path) {
        for table in &self.rests {
            draft.line("[[tumble]]");
            for (key, file) in ["rests", "attitudes"].into_iter().zip(table.files()) {
                draft.found(&format!("{key} = {}", toml_text(&relative(file, folder))), &self.how());
            }
            if let Some(KnownAttitudes { uncertainty, .. }) = table.attitudes {
                draft.found(&format!("attitude_uncertainty = \"{uncertainty:?} rad\""), &self.how());
            }
            if let Some(turning) = table.turning {
                draft.found(&format!("turning = {}", turning.inline_table()), &self.how());
            }
            draft.line(BIAS_CHANGE);
            draft.line("");
        }
    }
}

/// What nobody states by default, and what it brings.
const BIAS_CHANGE: &str = "# bias_change = \"0 mg\"  # in one switch-on with the arm; or how far each bias may have moved: the rests then sharpen biases";

/// What counts as exact unless a laboratory states it, with examples of values, as lines to take the mark of a comment from.
const STATED: [&str; 7] = [
    "latitude = \"0.1 deg\"",
    "radius = \"0.1 mm\"",
    "radius_difference = \"10 um\"",
    "speed_scale = \"2 ppm\"",
    "rest_angle = \"10 arcsec\"",
    "proof_masses = \"0.1 mm\"",
    "attitude = \"20 arcsec\"",
];

/// The table of uncertainties, with that of gravity if the tumble states one.
pub(super) fn uncertainty(draft: &mut Draft, tumbled: Option<&Tumbled>) {
    draft.line("# Standard uncertainties of what the laboratory states (type B): without them these quantities count as exact.");
    let has_gravity = tumbled.is_some_and(|tumbled| tumbled.gravity_uncertainty(draft));
    if !has_gravity {
        draft.line("# [uncertainty]");
        draft.line("# gravity = \"2e-5 m/s^2\"");
    }
    for line in STATED {
        draft.line(&format!("# {line}"));
    }
    draft.line("");
}
