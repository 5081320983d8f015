//! The experiment file of rests that were found in records.

use std::fmt::Write as _;

use centrical::reduction::{CoarseScale, Rests};

use super::request::TumbleRequest;
use crate::experiment::{ASKEW, RAW_OUTPUT, Turning, misalignments_left_out};
use crate::settings::toml_text;

/// Name of the table of rests.
pub(super) const TABLE: &str = "rests.csv";

/// Name of the table of their attitudes.
pub(super) const ATTITUDES: &str = "attitudes.csv";

/// The experiment file of rests in a table beside it, of readings with this coarse scale where they are in no unit of acceleration.
pub(super) fn session_text(request: &TumbleRequest, coarse: Option<&CoarseScale>, rests: &Rests) -> String {
    let mut text = String::new();
    let mut line = |line: String| {
        // Writing to a String does not fail.
        let _ = writeln!(text, "{line}");
    };
    let names: Vec<String> = request.files.iter().map(|file| file.display().to_string()).collect();
    line("# Rests in attitudes of their own, found by `centrical tumble`.".to_owned());
    let title = toml_text(&format!("Rests of {}", names.join(", ")));
    line(format!("[session]\ntitle = {title}\ndate = {}\n", toml_text(&request.date)));
    line(format!("[site]\ngravity = \"{:?} m/s^2\"\n", request.gravity));
    line(format!("[uncertainty]\ngravity = \"{:?} m/s^2\"\n", request.gravity_uncertainty));
    line("[unit]".to_owned());
    // An empty name names nothing: without one the file is as it was.
    if !request.model.is_empty() {
        line(format!("model = {}", toml_text(&request.model)));
    }
    line(format!("serial = {}", toml_text(&request.serial)));
    let raw = RAW_OUTPUT.into_iter().find(|(_, unit, _)| *unit == request.unit);
    match coarse.zip(raw) {
        Some((CoarseScale { scale, bias }, (_, unit, key))) => {
            line(format!("output_unit = \"{unit}\""));
            line(format!("{key} = {{ scale = {:?}, bias = {:?} }}\n", scale.as_slice(), bias.as_slice()));
        }
        None => line(format!("output_unit = {}\n", toml_text(&request.unit))),
    }
    let askew = misalignments_left_out(&request.terms);
    let terms: Vec<String> = request.terms.iter().chain(&askew).map(|term| toml_text(term)).collect();
    line(format!("[model]\nerror_model = [{}]\n", terms.join(", ")));
    if !askew.is_empty() {
        let priors: Vec<String> = askew.iter().map(|name| format!("{name} = {ASKEW:?}\n")).collect();
        line(format!("# Of what the terms leave out.\n[prior]\n{}", priors.concat()));
    }
    line(format!("[[tumble]]\nrests = {TABLE:?}"));
    if rests.noise_at_most > 1.0 {
        line(format!("noise_at_most = {:?}", rests.noise_at_most));
    }
    let turning = request.turning_radius.and_then(|radius| Turning::of(rests.means.iter().flatten(), radius));
    if let Some(turning) = turning {
        line(format!("turning = {}", turning.inline_table()));
    }
    if let Some(attitudes) = &request.attitudes {
        let uncertainty = attitudes.uncertainty;
        line(format!("attitudes = {ATTITUDES:?}\nattitude_uncertainty = \"{uncertainty:?} rad\""));
    }
    text
}
