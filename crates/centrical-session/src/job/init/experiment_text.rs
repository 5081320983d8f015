//! The draft of `experiment.toml`.

use std::path::Path;

use centrical_table::{ColumnName, DecimalSign, Error as TableError, TextForm};

use super::column_names::Label;
use super::draft::{Draft, InitRequest, UNKNOWN, relative};
use super::file_roles::FileColumns;
use super::findings::{Attitude, Findings, Set};
use super::output_unit::OutputUnit;
use super::sighting::{NOMINAL_RATE, Raw, SeenMounting};
use super::tumbled::{Tumbled, uncertainty};
use crate::error::Error;
use crate::settings::toml_text;

/// The six positions of the source: attitude and pair.
const SIX: &str = include_str!("six-positions.toml");

/// Drafts the file from what the mountings show, and a tumble of the unit.
///
/// # Errors
/// If the records are in another unit than the tumble.
pub(super) fn draft(
    mut mountings: Vec<SeenMounting>,
    tumbled: Option<&Tumbled>,
    unused: &[TableError],
    request: &InitRequest,
) -> Result<Draft, Error> {
    let findings = Findings::of(&mut mountings, tumbled)?;
    let mountings = mountings.as_slice();
    let mut draft = Draft::default();
    heading(&mut draft, mountings);
    for error in unused {
        draft.unused(&error.to_string());
    }
    draft.line("");
    session(&mut draft, tumbled);
    unit(&mut draft, &findings.unit, tumbled);
    machine(&mut draft);
    uncertainty(&mut draft, tumbled);
    columns(&mut draft, mountings, &findings.unit);
    let ids = positions(&mut draft, &findings.attitudes, request.six_positions);
    let is_common = findings.schedules.iter().all(|schedule| *schedule == findings.schedules[0]);
    if is_common {
        draft.line("[schedule]");
        plateaus(&mut draft, &mountings[0], &findings.schedules[0], "[schedule]");
        draft.line("");
    }
    for (m, mounting) in mountings.iter().enumerate() {
        draft.line("[[mounting]]");
        match &ids[m] {
            Some(id) => draft.found(&format!("position = \"{id}\""), "the attitude that the readings show"),
            None => {
                draft.fill_in(&format!("[[mounting]] {}", m + 1), "position = \"?\"", "which of the positions above");
            }
        }
        arm(&mut draft, m, findings.radii[m], findings.no_arm.as_deref());
        files(&mut draft, mounting, request.folder());
        if !is_common {
            plateaus(&mut draft, mounting, &findings.schedules[m], &format!("[[mounting]] {}", m + 1));
        }
        draft.line("");
    }
    if let Some(tumbled) = tumbled {
        tumbled.rests(&mut draft, request.folder());
    }
    draft.text.truncate(draft.text.trim_end().len());
    draft.text.push('\n');
    Ok(draft)
}

fn heading(draft: &mut Draft, mountings: &[SeenMounting]) {
    draft.line("#:schema ./experiment.schema.json");
    draft.line(
        "# Drafted by `centrical init`. FOUND: the files show it. GUESS: likely; check it. FILL IN: no file shows it.",
    );
    let forms: Vec<&TextForm> = mountings.iter().filter_map(|m| m.group.records[0].form.as_ref()).collect();
    if let Some(form) = forms.first() {
        let delimiter = match form.delimiter {
            '\t' => "tab".to_owned(),
            ' ' => "blanks".to_owned(),
            other => format!("`{other}`"),
        };
        let decimal = match form.decimal {
            DecimalSign::Point => ", decimal points",
            DecimalSign::Comma => ", decimal commas",
            DecimalSign::Unseen => "",
        };
        let above = match form.above.len() {
            0 => String::new(),
            count => format!(", {count} lines above the header"),
        };
        let units = form.units_line.map_or(String::new(), |line| format!(", units in line {line}"));
        draft.line(&format!(
            "# Records are text in {}, divided by {delimiter}{decimal}{above}{units}; read without a setting.",
            form.encoding
        ));
    }
    let is_timed = |m: &&SeenMounting| !m.group.records[0].is_counted();
    if let Some(rate) = mountings.iter().filter(is_timed).find_map(|m| m.rate) {
        draft.line(&format!("# {} records, {rate:.4} samples per second in the first.", mountings.len()));
    }
}

fn session(draft: &mut Draft, tumbled: Option<&Tumbled>) {
    draft.line("[session]");
    draft.line("title = \"\"");
    draft.line("");
    draft.line("[site]");
    match tumbled {
        Some(tumbled) => tumbled.gravity(draft),
        None => draft.fill_in(
            "[site] gravity",
            &format!("gravity = {UNKNOWN}"),
            "such as \"9.81523 m/s^2\"; 1e-5 of it is 1e-5 of every scale factor",
        ),
    }
    draft.fill_in(
        "[site] latitude",
        &format!("latitude = {UNKNOWN}"),
        "such as \"55.7 deg\"; the turn of the Earth adds up to 2e-5 of a reading",
    );
    draft.line("");
}

fn unit(draft: &mut Draft, unit: &OutputUnit, tumbled: Option<&Tumbled>) {
    draft.line("[unit]");
    if let Some(tumbled) = tumbled.filter(|tumbled| !tumbled.model.is_empty()) {
        draft.found(&format!("model = {}", toml_text(&tumbled.model)), &tumbled.how());
    }
    if let Some(tumbled) = tumbled.filter(|tumbled| !tumbled.serial.is_empty()) {
        draft.found(&format!("serial = {}", toml_text(&tumbled.serial)), &tumbled.how());
    } else {
        let reason = "the number on the unit; results are filed by it";
        draft.fill_in("[unit] serial", &format!("serial = {UNKNOWN}"), reason);
    }
    match unit {
        OutputUnit::Named(name @ ("m/s^2" | "g")) => {
            draft.found(&format!("output_unit = \"{name}\""), "the unit in the header");
        }
        OutputUnit::Unnamed => draft.guess("output_unit = \"m/s^2\"", "no file names the unit, and no rest shows it"),
        OutputUnit::ByGravity(name @ ("m/s^2" | "g"), norm) => {
            draft.guess(&format!("output_unit = \"{name}\""), &format!("the readings at rest are {norm:.3} long"));
        }
        OutputUnit::Named(_) | OutputUnit::ByGravity(..) => draft.line("output_unit = \"m/s^2\""),
        OutputUnit::Raw { name, unit, coarse } => {
            let how = "the unit in the header, or readings at rest that are no gravity in m/s^2, g or mg";
            draft.guess(&format!("output_unit = \"{unit}\""), how);
            match tumbled {
                Some(tumbled) => {
                    let how =
                        format!("{}; scales of reversed axes are negative, which gravity does not show", tumbled.how());
                    draft.found(&tumbled.raw_line(name), &how);
                }
                None => raw(draft, name, coarse.as_ref()),
            }
        }
    }
    draft.fill_in(
        "[unit] proof_masses",
        "proof_masses = [[0, 0, 0], [\"?\", \"?\", \"?\"], [\"?\", \"?\", \"?\"]]",
        "places of the three proof masses in instrument axes, m; 0.5 mm is 1e-3 of a reading at 0.5 m",
    );
    draft.line("");
}

/// Nominal scale and bias of a raw output.
fn raw(draft: &mut Draft, name: &str, coarse: Option<&Raw>) {
    let list = |numbers: &[f64; 3]| numbers.map(|number| format!("{number:.3e}")).join(", ");
    match coarse {
        Some(Raw { scale, bias }) => draft.guess(
            &format!("{name} = {{ scale = [{}], bias = [{}] }}", list(scale), list(bias)),
            &format!("{name} per m/s^2 and {name} at no force, from the rests; take those of the data sheet"),
        ),
        None => draft.fill_in(
            &format!("[unit] {name}"),
            &format!(
                "{name} = {{ scale = [{UNKNOWN}, {UNKNOWN}, {UNKNOWN}], bias = [{UNKNOWN}, {UNKNOWN}, {UNKNOWN}] }}"
            ),
            &format!("nominal {name} per m/s^2 and {name} at no force, from the data sheet"),
        ),
    }
}

fn machine(draft: &mut Draft) {
    draft.line("[centrifuge]");
    draft.fill_in(
        "[centrifuge] speed_uncertainty",
        &format!("speed_uncertainty = {UNKNOWN}"),
        "such as \"10 ppm\": relative standard uncertainty of a set speed, from the certificate of the machine",
    );
    draft.guess("rotation = \"+3\"", "positive speeds turn right-handed about Up; the files do not show the sense");
    draft.line("");
    draft.line("[model]");
    draft.guess(
        "error_model = \"kozlov-2017\"",
        "bias, scale, misalignment, squares, cubes; `centrical models` compares others",
    );
    draft.guess(
        "pair_relation = \"common\"",
        "errors of place belong to the seat; \"opposite\" if they belong to the unit",
    );
    draft.line("");
}

fn columns(draft: &mut Draft, mountings: &[SeenMounting], unit: &OutputUnit) {
    let records = &mountings[0].group.records;
    let telemetry = mountings.iter().find_map(|m| m.group.telemetry.as_ref());
    draft.line("[columns]");
    let timed = mountings.iter().find(|m| !m.is_counted && m.group.telemetry.is_some());
    time(draft, "time", &records[0], "the records have", timed.and_then(|m| m.rate));
    let readings: Vec<&Label> = if records.len() == 3 {
        records.iter().map(|r| &r.readings[0]).collect()
    } else {
        records[0].readings.iter().collect()
    };
    let unit_of_reading = match unit {
        OutputUnit::Named(name) | OutputUnit::ByGravity(name, _) if !["m/s^2", "g"].contains(name) => Some(*name),
        _ => None,
    };
    let name = |label: &&Label| match unit_of_reading {
        Some(unit) => format!("{{ column = {}, unit = \"{unit}\" }}", column(&label.column)),
        None => column(&label.column),
    };
    let line = format!("f = [{}]", readings.iter().map(name).collect::<Vec<_>>().join(", "));
    draft.shown(readings.iter().find_map(|label| label.guess), &line, "the three readings");
    if let Some(telemetry) = telemetry {
        of_telemetry(draft, telemetry, records[0].time.as_ref());
    }
    draft.line("");
}

fn of_telemetry(draft: &mut Draft, telemetry: &FileColumns, of_records: Option<&Label>) {
    if telemetry.time.as_ref() != of_records || telemetry.is_counted() {
        time(draft, "telemetry_time", telemetry, "the telemetry has", None);
    }
    if let Some(speed) = &telemetry.speed {
        let line = format!("speed = {}", column(&speed.column));
        draft.shown(speed.guess, &line, "speed");
        if let Some(unit) = speed.unit {
            draft.shown(speed.unit_guess, &format!("speed_unit = \"{unit}\""), "the unit in the header");
        } else {
            draft.guess("speed_unit = \"rad/s\"", "the file names no unit; \"rpm\" and \"deg/s\" are others");
        }
    }
}

/// The time of a file; where it has none but a count of samples, their rate is to be filled in, which may be about `rate` [Hz].
fn time(draft: &mut Draft, key: &str, file: &FileColumns, whose: &str, rate: Option<f64>) {
    let about = rate.map_or(String::new(), |rate| format!("; by the length of the telemetry about {rate:.1} Hz"));
    let mut rate_of = |entry: &str, why: &str| {
        let reason = format!("such as \"1 kHz\": {whose} {why}{about}");
        draft.fill_in(&format!("[columns] {key}"), &format!("{key} = {{ {entry}rate = {UNKNOWN} }}"), &reason);
    };
    match &file.time {
        None => match &file.unread_time {
            Some(name) => rate_of("", &format!("no time that is read: {name} is neither numbers nor timestamps")),
            None => rate_of("", "no time"),
        },
        Some(label) if label.is_count() => {
            rate_of(&format!("column = {}, ", column(&label.column)), "no time but a count of samples");
        }
        Some(label) => {
            let how = if key == "time" { "time" } else { "time of the telemetry" };
            draft.shown(label.guess.or(label.unit_guess), &format!("{key} = {}", written(label, "s")), how);
        }
    }
}

/// A column, with its unit if that is not the usual one.
fn written(label: &Label, usual: &str) -> String {
    match label.unit.filter(|unit| *unit != usual) {
        Some(unit) => format!("{{ column = {}, unit = \"{unit}\" }}", column(&label.column)),
        None => column(&label.column),
    }
}

fn column(name: &ColumnName) -> String {
    match name {
        ColumnName::Name(name) => toml_text(name),
        ColumnName::Number(number) => number.to_string(),
        ColumnName::DateAndTime(parts) => format!("{{ date = {}, column = {} }}", column(&parts[0]), column(&parts[1])),
        ColumnName::Row => "\"\"".to_owned(),
    }
}

/// Writes the positions out; returns the id of each mounting's.
fn positions(draft: &mut Draft, attitudes: &[Option<Attitude>], six: bool) -> Vec<Option<String>> {
    let mut distinct: Vec<Attitude> = Vec::new();
    for attitude in attitudes.iter().flatten() {
        if !distinct.contains(attitude) {
            distinct.push(*attitude);
        }
    }
    if distinct.is_empty() {
        if six {
            draft.line(SIX);
        } else {
            draft.line("[[position]]");
            draft.line("id = \"1\"");
            let reason =
                "arm axes along which the instrument axes 1, 2, 3 point, such as \"+1 +2 +3\"; or use --positions six";
            draft.fill_in("[[position]] axes", &format!("axes = {UNKNOWN}"), reason);
            draft.line("pair = \"A\"");
            draft.line("");
        }
        return vec![None; attitudes.len()];
    }
    let mut verticals = Vec::new();
    for (k, attitude) in distinct.iter().enumerate() {
        let vertical = attitude.vertical();
        let pair = verticals.iter().position(|v| *v == vertical).unwrap_or_else(|| {
            verticals.push(vertical);
            verticals.len() - 1
        });
        draft.line("[[position]]");
        draft.line(&format!("id = \"{}\"", k + 1));
        draft.found(&format!("axes = \"{}\"", attitude.axes()), "gravity at rest, pull at speed, if the unit is right-handed and no axis reversed: the readings do not show it");
        let letter = char::from(b'A' + u8::try_from(pair % 26).unwrap_or(0));
        draft.guess(&format!("pair = \"{letter}\""), "positions with the same axis upwards share the errors of place");
        draft.line("");
    }
    let id = |a: &Option<Attitude>| a.and_then(|a| Some((distinct.iter().position(|d| *d == a)? + 1).to_string()));
    attitudes.iter().map(id).collect()
}

fn arm(draft: &mut Draft, mounting: usize, radius: Option<f64>, no_arm: Option<&str>) {
    let what = "radius of the reference point by the drawing, m";
    match radius {
        Some(radius) => {
            draft.guess(
                &format!("arm = [{radius:.3}, 0.0, 0.0]"),
                "from readings and speed, to 5 mm; take the radius of the drawing",
            );
        }
        None => draft.fill_in(
            &format!("[[mounting]] {} arm", mounting + 1),
            &format!("arm = [{UNKNOWN}, 0.0, 0.0]"),
            &no_arm.map_or(what.to_owned(), |why| format!("{what}; {why}")),
        ),
    }
}

fn files(draft: &mut Draft, mounting: &SeenMounting, folder: &Path) {
    let names: Vec<String> = mounting.records().map(|path| toml_text(&relative(path, folder))).collect();
    match names.as_slice() {
        [one] => draft.line(&format!("record = {one}")),
        three => draft.line(&format!("record = [{}]", three.join(", "))),
    }
    if let Some(telemetry) = &mounting.group.telemetry {
        draft.line(&format!("telemetry = {}", toml_text(&relative(&telemetry.path, folder))));
    }
}

/// The schedule; what no file shows is to be filled in.
fn plateaus(draft: &mut Draft, mounting: &SeenMounting, schedule: &[Set], table: &str) {
    draft.line("plateaus = [");
    for (index, (set, plateau)) in schedule.iter().zip(&mounting.plateaus).enumerate() {
        let seconds = plateau.window[1] - plateau.window[0];
        let length = if mounting.is_counted {
            format!("{:.0} samples", seconds * NOMINAL_RATE)
        } else {
            format!("{seconds:.0} s")
        };
        let key = format!("{table} plateau {}", index + 1);
        match set {
            Set::Rest => draft.fill_in(
                &key,
                "  { speed = 0, angle = \"?\" },",
                &format!("angle of the arm at rest, such as \"0 deg\"; seen for {length}"),
            ),
            Set::Speed(speed) => {
                let line = format!("  {{ speed = \"{speed}\" }},");
                draft.guess(&line, &format!("seen for {length}; write what was set"));
            }
            Set::Unknown => draft.fill_in(
                &key,
                "  { speed = \"?\" },",
                &format!("a plateau of the readings for {length}; no file has the speed"),
            ),
        }
    }
    draft.line("]");
}
