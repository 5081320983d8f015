//! The units of a model or of a station, each with a link to its page.

use std::collections::BTreeMap;
use std::fmt::Write;

use centrical_session::{HistoryLine, UnitsHistoryReport};

use super::frame::{linked_serial, verdict};
use crate::plot::Escaped;
use crate::render::frame::Column::{Number, Words};
use crate::render::frame::sortable;
use crate::terminal::finding_mark;

/// A unit in a list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ListedUnit {
    /// Its model.
    pub model: String,
    /// Its serial number.
    pub serial: String,
    calibrations: usize,
    first: String,
    /// Date of its last calibration.
    pub last: String,
    is_last_acceptable: bool,
    /// The serial number with a link to the page of the unit, if it has one.
    pub(super) linked: String,
}

impl ListedUnit {
    /// The units of `lines`, which stand in the order of unit and day; `has_page` says by its file whether a unit has a page.
    pub fn all<'l>(lines: impl Iterator<Item = &'l HistoryLine>, has_page: impl Fn(&str) -> bool) -> Vec<Self> {
        let mut units: Vec<Self> = Vec::new();
        for line in lines {
            let Some(is_acceptable) = line.acceptable else { continue };
            match units.last_mut() {
                Some(unit) if unit.model == line.unit_model && unit.serial == line.unit_serial => {
                    unit.calibrations += 1;
                    unit.last.clone_from(&line.date);
                    unit.is_last_acceptable = is_acceptable;
                }
                _ => units.push(Self {
                    model: line.unit_model.clone(),
                    serial: line.unit_serial.clone(),
                    calibrations: 1,
                    first: line.date.clone(),
                    last: line.date.clone(),
                    is_last_acceptable: is_acceptable,
                    linked: linked_serial(&line.unit_model, &line.unit_serial, &has_page),
                }),
            }
        }
        units
    }
}

/// A table of `units`, with what `report` finds of each where it is of one model.
pub(super) fn units_table(body: &mut String, units: &[ListedUnit], report: Option<&UnitsHistoryReport>) {
    let found = report.map(findings).unwrap_or_default();
    let (kind, last) = if report.is_some() { (None, "found") } else { (Some(Words("model")), "") };
    let others = [Number("calibrations"), Words("first"), Words("last"), Words("last verdict"), Words(last)];
    let columns: Vec<_> = std::iter::once(Words("serial")).chain(kind).chain(others).collect();
    body.push_str("<h2>Its units</h2>\n");
    sortable(body, "", &columns, |body| {
        for unit in units {
            let model = if report.is_some() { String::new() } else { format!("<td>{}</td>", Escaped(&unit.model)) };
            let found = found.get(unit.serial.as_str()).map_or_else(String::new, |marks| marks.join(", "));
            let _ = writeln!(
                body,
                "<tr><th scope=\"row\">{}</th>{model}<td class=\"number\">{}</td><td>{}</td><td>{}</td>{}<td>{}</td></tr>",
                unit.linked,
                unit.calibrations,
                Escaped(&unit.first),
                Escaped(&unit.last),
                verdict(unit.is_last_acceptable, "acceptable", "not acceptable"),
                Escaped(&found)
            );
        }
    });
}

/// What was found of units, by their serial numbers.
fn findings(report: &UnitsHistoryReport) -> BTreeMap<&str, Vec<String>> {
    let outlying = report.outlying.iter().map(|unit| (unit.unit_serial.as_str(), "OUTLYING".to_owned()));
    let others = report.findings.iter().map(|finding| {
        (finding.unit_serial.as_str(), format!("{}: {}", finding_mark(finding.kind), finding.parameter))
    });
    let mut found: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for (serial, mark) in outlying.chain(others) {
        found.entry(serial).or_default().push(mark);
    }
    found
}
