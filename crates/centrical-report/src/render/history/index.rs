//! The first page of a store: models and stations with what was found of them, and the list of all calibrations.

use std::fmt::Write;

use centrical_session::{Date, HistoryLine, HistoryList, StationHistoryReport, UnitsHistoryReport};

use super::frame::{PageKind, linked_serial, page, verdict};
use crate::number::counted;
use crate::plot::Escaped;
use crate::render::frame::Column::{Number, Words};
use crate::render::frame::{Column, sortable};

/// A model of units or a station in its list.
#[derive(Debug, Clone, PartialEq)]
pub struct Indexed<R> {
    /// What was found of it.
    pub report: R,
    /// Whether a control chart gives a signal.
    pub has_signals: bool,
}

/// The first page, with a link to each unit's file for which `has_page` holds, and to the list of due dates in the file `due`.
pub fn history_index(
    list: &HistoryList,
    models: &[Indexed<UnitsHistoryReport>],
    stations: &[Indexed<StationHistoryReport>],
    due: Option<&str>,
    has_page: impl Fn(&str) -> bool,
) -> String {
    let failed = list.failed();
    let mut body = format!(
        "<header><p class=\"kind\">Calibrations</p><h1>{}</h1><p>{}, {}</p></header>\n",
        Escaped(&list.store),
        counted(list.calibrations.len() - failed, "calibration"),
        counted(failed, "failed session")
    );
    if let Some(file) = due {
        let _ = writeln!(body, "<p><a href=\"{file}\">due dates of all units</a></p>");
    }
    indexed(&mut body, "Models", &OF_MODELS, models, model_row);
    indexed(&mut body, "Stations", &OF_STATIONS, stations, station_row);
    body.push_str(
        "<h2>Calibrations</h2>\n\
         <form class=\"filters\" role=\"search\"><label>Serial <input id=\"serial\" type=\"search\"></label>\
         <label>Model or station <input id=\"words\" type=\"search\"></label>\
         <label>from <input id=\"from\" type=\"date\"></label><label>to <input id=\"to\" type=\"date\"></label>\
         <label>Verdict <select id=\"verdict\"><option value=\"\">all</option><option>acceptable</option><option>not acceptable</option>\
         <option>failed</option></select></label><output id=\"count\"></output></form>\n",
    );
    let columns =
        [Words("date"), Words("model"), Words("serial"), Words("station"), Number("chi^2/nu"), Words("verdict")];
    sortable(&mut body, "list", &columns, |body| {
        for line in &list.calibrations {
            row(body, line, &linked_serial(&line.unit_model, &line.unit_serial, &has_page));
        }
    });
    page("Calibrations", &body)
}

/// A table of models or stations, if there are any.
fn indexed<T>(body: &mut String, title: &str, columns: &[Column], list: &[T], row: fn(&mut String, &T)) {
    if !list.is_empty() {
        let _ = writeln!(body, "<h2>{title}</h2>");
        sortable(body, "", columns, |body| list.iter().for_each(|item| row(body, item)));
    }
}

/// Columns of [`model_row`].
const OF_MODELS: [Column; 8] = [
    Words("model"),
    Number("units"),
    Number("calibrations"),
    Words("units alike"),
    Number("least Cpk"),
    Words("of"),
    Words("batches that differ"),
    Words("control charts"),
];

/// Columns of [`station_row`].
const OF_STATIONS: [Column; 8] = [
    Words("station"),
    Number("calibrations"),
    Number("units"),
    Words("first"),
    Words("last"),
    Words("machine"),
    Words("changed"),
    Words("control charts"),
];

fn model_row(body: &mut String, Indexed { report, has_signals }: &Indexed<UnitsHistoryReport>) {
    let capability = report.parameters.iter().filter_map(|p| Some((p.name.as_str(), p.capability.as_ref()?.cpk)));
    let least = capability.min_by(|a, b| a.1.total_cmp(&b.1));
    let differ: Vec<&str> = report.parameters.iter().filter(|p| p.batches_differ).map(|p| p.name.as_str()).collect();
    let _ = writeln!(
        body,
        "<tr><th scope=\"row\"><a href=\"{}\">{}</a></th><td class=\"number\">{}</td><td class=\"number\">{}</td>{}\
             <td class=\"number\">{}</td><td>{}</td><td>{}</td>{}</tr>",
        PageKind::Model.file(&[&report.unit_model]),
        Escaped(&report.unit_model),
        report.units,
        report.sessions,
        if report.is_sound && !report.is_tested {
            not_tested()
        } else {
            verdict(report.is_sound, "alike", "not alike")
        },
        least.map_or_else(String::new, |(_, cpk)| format!("{cpk:.2}")),
        Escaped(least.map_or("", |(name, _)| name)),
        Escaped(&differ.join(", ")),
        signals(*has_signals),
    );
}

fn station_row(body: &mut String, Indexed { report, has_signals }: &Indexed<StationHistoryReport>) {
    let name = if report.station.is_empty() { "without a name" } else { &report.station };
    let changed: Vec<&str> = report.parameters.iter().filter(|p| p.changes).map(|p| p.name.as_str()).collect();
    let _ = writeln!(
        body,
        "<tr><th scope=\"row\"><a href=\"{}\">{}</a></th><td class=\"number\">{}</td><td class=\"number\">{}</td><td>{}</td><td>{}</td>{}\
             <td>{}</td>{}</tr>",
        PageKind::Station.file(&[&report.station]),
        Escaped(name),
        report.sessions,
        report.units,
        report.first,
        report.last,
        report.is_steady.map_or_else(not_tested, |is_steady| verdict(is_steady, "steady", "not steady")),
        Escaped(&changed.join(", ")),
        signals(*has_signals),
    );
}

/// No test, no colour.
fn not_tested() -> String {
    "<td>not tested</td>".to_owned()
}

/// A signal may be false: it has no colour.
fn signals(has_signals: bool) -> &'static str {
    if has_signals { "<td>signals</td>" } else { "<td></td>" }
}

fn row(body: &mut String, line: &HistoryLine, serial: &str) {
    let (verdict, class) = match line.acceptable {
        Some(true) => ("acceptable", "good"),
        Some(false) => ("not acceptable", "bad"),
        None => ("failed", "bad"),
    };
    let has_day = line.acceptable.is_none() || line.date.parse::<Date>().is_ok();
    let day = if has_day { line.date.clone() } else { format!("{} (no day: in no history)", line.date) };
    let why = line.message.clone().unwrap_or_else(|| line.objections.join(", "));
    let _ = writeln!(
        body,
        "<tr><td>{}</td><td>{}</td><td>{serial}</td><td>{}</td><td class=\"number\">{}</td><td class=\"{class}\">{verdict}<span>{}</span></td></tr>",
        Escaped(&day),
        Escaped(&line.unit_model),
        Escaped(&line.station),
        line.ratio().map_or_else(String::new, |ratio| format!("{ratio:.3}")),
        Escaped(&why)
    );
}
